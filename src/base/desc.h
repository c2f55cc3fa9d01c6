/* desc.h - descriptors and info structs of a host whose header may be older or newer than the library. */
#ifndef LC_DESC_H
#define LC_DESC_H

#include "base/context.h"

#include <stdalign.h>
#include <string.h>

#define LC_MAX_DESC 4096 /* bytes: a larger size was never set */

/* Every such struct begins with its size and has no field that lies across a multiple of its alignment, so
 * that no size that is one cuts a field. */
static inline bool lc_desc_size_fits(size_t size)
{
    return size >= sizeof size && size <= LC_MAX_DESC && size % alignof(size_t) == 0;
}

/* Copies what the host gives over the defaults in `to`, whose first `size` bytes the library knows. Fields
 * that the host does not know keep their defaults; those that the library does not know must be 0.
 * LC_ERR_ARG, which names the struct. */
static inline lc_status lc_desc_take(const lc_context *ctx, const char *name, void *to, size_t size,
                                     const void *from)
{
    size_t given;
    memcpy(&given, from, sizeof given);
    bool fits = lc_desc_size_fits(given);
    for (size_t i = size; fits && i < given; i++) fits = !((const unsigned char *)from)[i];
    if (!fits)
        return ctx ? lc_fail(ctx, LC_ERR_ARG,
                             "%s: its size of %zu bytes is wrong, or a field that is set is "
                             "not known: its INIT sets the size",
                             name, given)
                   : LC_ERR_ARG;
    memcpy(to, from, given < size ? given : size);
    memcpy(to, &size, sizeof size);
    return LC_OK;
}

/* Copies `size` bytes, or as many as the host has room for by the size that it set, and zeros to the rest.
 * LC_ERR_ARG if it set none. */
static inline lc_status lc_desc_give(const lc_context *ctx, const char *name, void *to, const void *from,
                                     size_t size)
{
    size_t given;
    memcpy(&given, to, sizeof given);
    if (!lc_desc_size_fits(given))
        return lc_fail(ctx, LC_ERR_ARG, "%s: its size of %zu bytes is wrong: its INIT sets it", name, given);
    memcpy(to, from, given < size ? given : size);
    if (given > size) memset((unsigned char *)to + size, 0, given - size);
    memcpy(to, &given, sizeof given);
    return LC_OK;
}

#endif
