/* arena.c - the only file that calls malloc. */
#include "base/arena.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#define ALIGN 64
/* Bytes of an arena's chunk. For fuzzers it stays below the 128 KiB from which on ASan maps each block anew,
 * which takes half the time of a small scene. */
#define CHUNK LC_SIZE(256u << 10, 16u << 10)
#define HUGE ((size_t)2 << 20) /* bytes of a huge page */

struct lc_arena_chunk {
    lc_arena_chunk *below;
    size_t size, used; /* bytes, this header included */
    char pad[ALIGN - 3 * sizeof(size_t)];
};

/* Asks for huge pages for large blocks; measured: tests/results/shadow-rays.md. */
static void *libc_alloc(void *user, size_t size, size_t align)
{
    (void)user;
    bool huge = size >= HUGE;
    if (huge) align = HUGE;
    if (size > SIZE_MAX - align) return NULL;
    size = (size + align - 1) / align * align;
    void *p = aligned_alloc(align, size);
#ifdef MADV_HUGEPAGE
    if (p && huge) madvise(p, size, MADV_HUGEPAGE); /* may be refused */
#endif
    return p;
}

static void libc_free(void *user, void *ptr, size_t size)
{
    (void)user;
    (void)size;
    free(ptr);
}

lc_allocator lc_allocator_libc(void) { return (lc_allocator){ libc_alloc, libc_free, NULL }; }

/* The bytes of n elements, at least 1; SIZE_MAX if that overflows. */
static size_t bytes_of(size_t n, size_t size)
{
    size_t bytes;
    if (__builtin_mul_overflow(n, size, &bytes) || bytes > SIZE_MAX / 2) return SIZE_MAX;
    return bytes ? bytes : 1;
}

void *lc_alloc_raw(const lc_context *ctx, size_t n, size_t size)
{
    size_t bytes = bytes_of(n, size);
    if (bytes != SIZE_MAX && !lc_memory_take(ctx, bytes)) return NULL;
    void *p = bytes == SIZE_MAX ? NULL : ctx->allocator.alloc(ctx->allocator.user, bytes, ALIGN);
    if (!p && bytes != SIZE_MAX) lc_memory_give(ctx, bytes);
    if (!p) lc_fail(ctx, LC_ERR_MEMORY, "out of memory: %zu times %zu bytes", n, size);
    return p;
}

void *lc_alloc(const lc_context *ctx, size_t n, size_t size)
{
    void *p = lc_alloc_raw(ctx, n, size);
    return p ? memset(p, 0, bytes_of(n, size)) : NULL;
}

void lc_free(const lc_context *ctx, void *ptr, size_t n, size_t size)
{
    if (!ptr) return;
    ctx->allocator.free(ctx->allocator.user, ptr, bytes_of(n, size));
    lc_memory_give(ctx, bytes_of(n, size));
}

lc_status lc_grow(const lc_context *ctx, void **ptr, size_t *cap, size_t need, size_t size)
{
    if (need <= *cap) return LC_OK;
    size_t new_cap = *cap < 8 ? 8 : *cap;
    while (new_cap < need) new_cap = new_cap > SIZE_MAX / 2 ? need : new_cap * 2;
    void *p = lc_alloc(ctx, new_cap, size);
    if (!p) return LC_ERR_MEMORY;
    if (*cap) memcpy(p, *ptr, *cap * size);
    lc_free(ctx, *ptr, *cap, size);
    *ptr = p;
    *cap = new_cap;
    return LC_OK;
}

void lc_arena_init(lc_arena *arena, const lc_context *ctx)
{
    arena->ctx = ctx;
    arena->top = NULL;
}

void *lc_arena_alloc(lc_arena *arena, size_t n, size_t size)
{
    size_t bytes = bytes_of(n, size);
    if (bytes == SIZE_MAX) bytes = SIZE_MAX / 2;
    bytes = (bytes + ALIGN - 1) / ALIGN * ALIGN;
    lc_arena_chunk *top = arena->top;
    if (!top || top->size - top->used < bytes) {
        size_t chunk = bytes > CHUNK - sizeof *top ? bytes + sizeof *top : CHUNK;
        top = lc_alloc(arena->ctx, chunk, 1);
        if (!top) return NULL;
        top->below = arena->top;
        top->size = chunk;
        top->used = sizeof *top;
        arena->top = top;
    }
    void *p = (char *)top + top->used;
    top->used += bytes;
    return p;
}

char *lc_arena_text(lc_arena *arena, const char *text, size_t len)
{
    char *p = lc_arena_alloc(arena, len + 1, 1);
    if (p) memcpy(p, text, len);
    return p;
}

void lc_arena_free(lc_arena *arena)
{
    while (arena->top) {
        lc_arena_chunk *top = arena->top;
        arena->top = top->below;
        lc_free(arena->ctx, top, top->size, 1);
    }
}
