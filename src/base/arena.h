/* arena.h - memory from the host's allocator: checked arrays, growing arrays, and arenas, which are freed
 * whole.
 *
 * All blocks are 64-byte aligned. Sizes are checked for overflow before anything is allocated. A failure is
 * logged here, once.
 */
#ifndef LC_ARENA_H
#define LC_ARENA_H

#include "base/context.h"

/* n * size zeroed bytes; NULL on failure, which is logged. n == 0 gives a valid block of one byte. */
void *lc_alloc(const lc_context *ctx, size_t n, size_t size);
/* The same, but the bytes are not zeroed. */
void *lc_alloc_raw(const lc_context *ctx, size_t n, size_t size);
/* Frees a block of lc_alloc or lc_alloc_raw; n and size must be those it was allocated with. ptr may be
 * NULL. */
void lc_free(const lc_context *ctx, void *ptr, size_t n, size_t size);

/* Grows an array of *cap elements to at least `need` by doubling; new elements are zeroed. The array is freed
 * with lc_free(ctx, ptr, cap, size). LC_ERR_MEMORY leaves it as it was. */
lc_status lc_grow(const lc_context *ctx, void **ptr, size_t *cap, size_t need, size_t size);

typedef struct lc_arena_chunk lc_arena_chunk;
typedef struct lc_arena {
    const lc_context *ctx;
    lc_arena_chunk *top;
} lc_arena;

void lc_arena_init(lc_arena *arena, const lc_context *ctx);
/* n * size zeroed bytes that live as long as the arena; NULL on failure, which is logged. */
void *lc_arena_alloc(lc_arena *arena, size_t n, size_t size);
/* A zero-terminated copy of `len` bytes of text; NULL on failure, which is logged. */
char *lc_arena_text(lc_arena *arena, const char *text, size_t len);
void lc_arena_free(lc_arena *arena);

/* The allocator of a context by default: the C library's, with huge pages for large blocks. */
lc_allocator lc_allocator_libc(void);

#endif
