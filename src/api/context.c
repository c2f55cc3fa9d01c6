/* context.c - creation of a context. */
#include "base/context.h"

#include "base/arena.h"
#include "base/cpu.h"
#include "base/desc.h"
#include "base/memory.h"
#include "isa/isa.h"

static const char *fault(const lc_context_desc *d)
{
    if (d->allocator && (!d->allocator->alloc || !d->allocator->free))
        return "allocator has no alloc or free";
    if (d->isa < LC_ISA_BEST || d->isa > LC_N_ISAS) return "isa is none of this build";
    if (d->n_threads > LC_MAX_THREADS) return "n_threads is too large";
    return d->bvh < LC_BVH_BEST || d->bvh >= LC_BVH_MODES ? "bvh is none of lc_bvh_mode" : NULL;
}

lc_status lc_context_create(const lc_context_desc *desc, lc_context **out)
{
    if (!out) return LC_ERR_ARG;
    *out = NULL;
    lc_context_desc d = LC_CONTEXT_DESC_INIT;
    if (desc && lc_desc_take(NULL, "lc_context_desc", &d, sizeof d, desc)) return LC_ERR_ARG;
    const char *wrong = fault(&d);
    if (wrong)
        return lc_fail(&(lc_context){ .log = d.log, .log_user = d.log_user }, LC_ERR_ARG,
                       "lc_context_create: %s", wrong);
    lc_context ctx = { .allocator = d.allocator ? *d.allocator : lc_allocator_libc(),
                       .log = d.log,
                       .log_user = d.log_user,
                       .stop = d.stop,
                       .stop_user = d.stop_user,
                       .n_threads = d.n_threads,
                       .bvh = d.bvh,
                       .isa = lc_isa_pick(d.isa) };
    if (!ctx.n_threads) ctx.n_threads = lc_cpu_threads();
    const lc_kernels *kernels = lc_isa_kernels(ctx.isa);
    ctx.shade_kernels = &kernels->shade;
    ctx.tree_kernels = &kernels->tree;
    ctx.trace_kernels = &kernels->trace;
    ctx.cut_kernels = &kernels->cut;
    lc_memory *memory = d.max_memory ? lc_alloc(&ctx, 1, sizeof *memory) : NULL;
    lc_context *c = !d.max_memory || memory ? lc_alloc(&ctx, 1, sizeof *c) : NULL;
    if (!c) {
        lc_free(&ctx, memory, 1, sizeof *memory);
        return LC_ERR_MEMORY;
    }
    if (memory) memory->limit = d.max_memory < SIZE_MAX ? (size_t)d.max_memory : SIZE_MAX;
    *c = ctx;
    c->memory = memory;
    *out = c;
    return LC_OK;
}

void lc_context_destroy(lc_context *ctx)
{
    if (!ctx) return;
    lc_context copy = *ctx;
    copy.memory = NULL;
    lc_free(&copy, ctx->memory, 1, sizeof *ctx->memory);
    lc_free(&copy, ctx, 1, sizeof *ctx);
}

lc_isa lc_context_isa(const lc_context *ctx) { return ctx->isa; }

uint32_t lc_context_threads(const lc_context *ctx) { return ctx->n_threads; }

const char *lc_status_name(lc_status status)
{
    switch (status) {
    case LC_OK: return "ok";
    case LC_ERR_ARG: return "argument out of range";
    case LC_ERR_MEMORY: return "out of memory";
    case LC_ERR_IO: return "input or output failed";
    case LC_ERR_PARSE: return "wrong input";
    case LC_ERR_UNSUPPORTED: return "not supported";
    case LC_ERR_CANCELLED: return "cancelled";
    }
    return "unknown status";
}
