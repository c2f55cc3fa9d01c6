/* visibility.h - what cuts ask about shadows: an interface, so that they need not know what traces the rays.
 *
 * The scene's own is lc_bvh_visibility; a host with a ray tracer of its own fills in `hidden` and leaves the
 * rest NULL.
 */
#ifndef LC_VISIBILITY_H
#define LC_VISIBILITY_H

#include "trace/occluder.h"

typedef struct lc_visibility {
    /* hidden[i] = 1 where what lies between org and target i, or with `far` in the direction target i, stops
     * light; else 0. target: x, y, z arrays. blocker, unless NULL: where hidden, something that occluder_of
     * understands, or LC_NONE. Any thread may call it. */
    void (*hidden)(const void *scene, const float org[3], uint32_t n, const float *const target[3], bool far,
                   uint8_t *hidden, uint32_t *blocker);
    const void *scene;

    /* For proofs that whole clusters are hidden (cut/occlusion_proof.h). NULL, with occluders NULL: nothing
     * is ever proved. */
    uint32_t (*occluder_of)(const void *scene, uint32_t blocker, const float org[3],
                            const float dir[3]); /* that stops it; LC_NONE */
    const lc_occluders *occluders;
} lc_visibility;

struct lc_bvh;

/* Of the triangles of a BVH, with its occluders; the BVH stays the caller's, who keeps it. */
lc_visibility lc_bvh_visibility(const struct lc_bvh *bvh);

#endif
