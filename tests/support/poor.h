/* poor.h - a context whose allocator fails after as many allocations as are left. Include it once a program.
 */
#ifndef POOR_H
#define POOR_H

#include "scene/scene.h"

#include <stdlib.h>

static long allocations_left = -1; /* < 0: no end of them */

static inline void *counted_alloc(void *user, size_t size, size_t align)
{
    (void)user;
    if (!allocations_left) return NULL;
    if (allocations_left > 0) allocations_left--;
    return aligned_alloc(align, (size + align - 1) / align * align);
}

static inline void counted_free(void *user, void *ptr, size_t size)
{
    (void)user;
    (void)size;
    free(ptr);
}

static inline lc_context *poor_context(void)
{
    static const lc_allocator allocator = { counted_alloc, counted_free, NULL };
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    lc_context *ctx;
    desc.allocator = &allocator;
    if (lc_context_create(&desc, &ctx)) abort();
    return ctx;
}

/* Fills a new scene again and again, one allocation more at a time, until something else than memory decides.
 * Returns how often that took. */
static inline long fill_while_poor(lc_status (*fill)(lc_scene *scene), lc_status *st)
{
    lc_context *ctx = poor_context();
    long n = 0;
    *st = LC_ERR_MEMORY;
    for (; *st == LC_ERR_MEMORY && n < 1000; n++) {
        lc_scene *s;
        allocations_left = -1;
        if (lc_scene_create(ctx, &s)) abort();
        allocations_left = n;
        *st = fill(s);
        allocations_left = -1;
        lc_scene_destroy(s);
    }
    lc_context_destroy(ctx);
    return n;
}

/* The same of a scene that is loaded in a poor context. */
static inline long load_while_poor(lc_status (*load)(lc_context *ctx, lc_scene **scene), lc_status *st)
{
    lc_context *ctx = poor_context();
    long n = 0;
    *st = LC_ERR_MEMORY;
    for (; *st == LC_ERR_MEMORY && n < 2000; n++) {
        lc_scene *s = NULL;
        allocations_left = n;
        *st = load(ctx, &s);
        allocations_left = -1;
        lc_scene_destroy(s);
    }
    lc_context_destroy(ctx);
    return n;
}

#endif
