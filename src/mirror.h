/* mirror.h - what a camera ray shows: the first surface, or past mirrors the first surface that is none.
 *
 *     camera -> mirror -> mirror -> surface: light reaches the camera times both reflectances
 *
 * A ray is reflected about the shading normal; where that would lead below the surface, it is turned up again by the same
 * angle, so that what a mirror shows has no jump there. Depth counts as in pbrt: after k mirrors a surface is lit when
 * k < max_depth, and shows its own emission when k <= max_depth. What leaves the scene shows its background.
 */
#ifndef LC_MIRROR_H
#define LC_MIRROR_H

#include "surface.h"

typedef struct lc_sight {
    lc_surface first;   /* what the camera ray meets, a mirror or not */
    lc_surface shaded;  /* what is to be lit, if `lit`; its t is the length of the whole way */
    lc_f3 view;         /* unit, from there towards where the ray came from */
    lc_f3 weight;       /* product of the mirrors' reflectances; 1 without */
    lc_f3 emission;     /* radiance of all that was met, weighted */
    uint32_t n_mirrors; /* that reflected the ray: so many rays went out beside the camera's */
    bool lit;
} lc_sight;

/* False: the camera ray leaves the scene. For the arguments see lc_surface_hit; max_depth: 1..LC_MAX_DEPTH. */
bool lc_sight_trace(const lc_scene *scene, lc_f3 org, lc_f3 dir, double pixel, uint32_t max_depth, lc_sight *out);

#endif
