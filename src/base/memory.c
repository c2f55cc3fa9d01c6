/* memory.c - counts bytes of a context against its limit. */
#include "base/memory.h"

void lc_memory_step(const lc_context *ctx, const char *what)
{
    if (ctx->memory) atomic_store_explicit(&ctx->memory->step, what, memory_order_relaxed);
}

bool lc_memory_take(const lc_context *ctx, size_t bytes)
{
    lc_memory *m = ctx->memory;
    if (!m) return true;
    const size_t used = atomic_fetch_add_explicit(&m->used, bytes, memory_order_relaxed);
    if (used <= m->limit && bytes <= m->limit - used) return true;
    atomic_fetch_sub_explicit(&m->used, bytes, memory_order_relaxed);
    const char *step = atomic_load_explicit(&m->step, memory_order_relaxed);
    lc_fail(ctx, LC_ERR_MEMORY, "out of memory: %s needs %zu bytes more, and %zu of %zu are in use",
            step ? step : "this", bytes, used, m->limit);
    return false;
}

void lc_memory_give(const lc_context *ctx, size_t bytes)
{
    if (ctx->memory) atomic_fetch_sub_explicit(&ctx->memory->used, bytes, memory_order_relaxed);
}

uint64_t lc_memory_left(void) { return lc_memory_left_below(""); }
