/* arena.h - memory over the caller's allocator: checked arrays, growing arrays, and an arena freed whole.
 *
 * All blocks are 64-byte aligned. Sizes are checked for overflow before anything is asked for; on failure the
 * out-of-memory line is logged once, here.
 */
#ifndef LC_ARENA_H
#define LC_ARENA_H

#include "base/context.h"

/* n * size bytes, zeroed, or NULL (logged). n == 0 gives a valid 1-byte block. */
void *lc_alloc(const lc_context *ctx, size_t n, size_t size);
/* The same, not zeroed. */
void *lc_alloc_raw(const lc_context *ctx, size_t n, size_t size);
/* n and size as given to lc_alloc; NULL is fine. */
void lc_free(const lc_context *ctx, void *ptr, size_t n, size_t size);

/* Makes room for `need` elements in a growing array: *ptr has *cap elements, doubled until enough, new ones
 * zeroed. Free with lc_free(ctx, ptr, cap, size). */
lc_status lc_grow(const lc_context *ctx, void **ptr, size_t *cap, size_t need, size_t size);

typedef struct lc_arena_chunk lc_arena_chunk;
typedef struct lc_arena {
    const lc_context *ctx;
    lc_arena_chunk *top;
} lc_arena;

void lc_arena_init(lc_arena *arena, const lc_context *ctx);
/* n * size zeroed bytes that live as long as the arena, or NULL (logged). */
void *lc_arena_alloc(lc_arena *arena, size_t n, size_t size);
char *lc_arena_text(lc_arena *arena, const char *text, size_t len); /* a copy, zero-terminated */
void lc_arena_free(lc_arena *arena);

/* The C library's allocator, the default of a context. */
lc_allocator lc_allocator_libc(void);

#endif
