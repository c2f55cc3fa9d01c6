/* visibility.h - the interface through which cuts test visibility, whatever traces the rays.
 *
 * A scene's is lc_bvh_visibility. A host with its own ray tracer fills in `hidden` and leaves the rest NULL.
 */
#ifndef LC_VISIBILITY_H
#define LC_VISIBILITY_H

#include "trace/bvh_data.h"
#include "trace/occluder.h"

typedef struct lc_visibility {
    /* Shadow rays: sets hidden[i] to 1 if target i is occluded from org, else to 0. With `far`, targets are
     * directions. target: arrays of x, y, z. blocker may be NULL; for occluded targets it is set to a value
     * for occluder_of, or to LC_NONE. Called from any thread. */
    void (*hidden)(const void *scene, const float org[3], uint32_t n, const float *const target[3], bool far,
                   uint8_t *hidden, uint32_t *blocker);
    /* The same where glass dims shadow rays: also sets through[k][i], k = R, G, B, to the fraction of light
     * that reaches org from target i, 0..1, 0 if it is occluded. NULL: nothing dims. */
    void (*dimmed)(const void *scene, const float org[3], uint32_t n, const float *const target[3], bool far,
                   uint8_t *hidden, uint32_t *blocker, float *const through[3]);
    const void *scene;
    const void *const *moments; /* in place of scene for points of each moment (scene/motion.h), or NULL */

    /* For proofs that whole clusters are occluded (cut/occlusion_proof.h): the occluder that blocks the ray
     * from org along dir, or LC_NONE. NULL, with occluders NULL: nothing is ever proved. */
    uint32_t (*occluder_of)(const void *scene, uint32_t blocker, const float org[3], const float dir[3]);
    const lc_occluders *occluders;
    /* For proofs that whole clusters are visible (cut/interval.h): holds all that may stop or dim a shadow
     * ray. NULL: nothing is ever proved. */
    const lc_bvh_data *all;
} lc_visibility;

struct lc_bvh;

/* The visibility by a BVH and its occluders. The BVH must outlive it. */
lc_visibility lc_bvh_visibility(const struct lc_bvh *bvh);

#endif
