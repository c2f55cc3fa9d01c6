/* poor.h - a context whose allocator fails after as many allocations as are left. Include it once a program. */
#ifndef POOR_H
#define POOR_H

#include "lightcuts.h"

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
    (void)user, (void)size;
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

#endif
