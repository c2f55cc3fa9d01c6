/* poor_update.h - changes of a committed scene when memory is short. */
#ifndef POOR_UPDATE_H
#define POOR_UPDATE_H

#include "support/rendered.h"
#include "support/watched_memory.h"

/* Changes a scene of a watched context by `change` and lc_scene_update: first all allocations fail, then some
 * succeed before the others fail, more from time to time, until both calls succeed, after more than `least`.
 * Until then the picture must be `before`, in the end `after`. */
static inline void update_without_memory(lc_context *own, lc_scene *s,
                                         lc_status (*change)(lc_scene *s, const void *user), const void *user,
                                         const lc_image *before, const lc_image *after, long least)
{
    lc_status st = LC_ERR_MEMORY;
    long n = 0;
    for (; st && n < 100000; n += 1 + n / 32) {
        allocations_left = n;
        st = change(s, user);
        if (!st) st = lc_scene_update(s, NULL);
        allocations_left = -1;
        CHECKF(!st || st == LC_ERR_MEMORY, "%s", lc_status_name(st));
        lc_image *image = rendered(own, s);
        CHECKF(same_planes(image, st ? before : after), "after %ld allocations", n);
        lc_image_destroy(image);
    }
    CHECKF(!st && n > least, "%ld allocations", n);
}

/* Ends a watched context whose scenes and images are destroyed. */
static inline void end_watched(lc_context *own)
{
    lc_context_destroy(own);
    CHECKF(!blocks_live && !guards_broken, "%ld blocks", (long)blocks_live);
}

#endif
