/* sight.h - what a camera ray shows: the first surface, or by way of mirrors and glass the first surfaces
 * that are neither.
 *
 *     camera -> mirror -> glass -> surface           light reaches the camera times all shares
 *                           `----> another surface
 *
 * Glass sends a ray on twice, reflected and refracted; a sheet (`thin`) lets it through without bending it,
 * and all reflections inside count as one. Radiance that enters a medium of index eta is divided by eta^2, as
 * in pbrt, and so multiplied on leaving. The strongest ray goes first. Left out are rays that show less than
 * LC_LEAST_SHARE beyond glass, what is left after LC_MAX_ROUGH rough surfaces, and the weaker side of glass
 * after LC_MAX_SPLITS.
 *
 * A ray is reflected about the shading normal; where that would lead below the surface, it is turned up again
 * by the same angle, so that what a mirror shows has no jump there; what is refracted likewise. Depth counts
 * as in pbrt: after k mirrors or glass surfaces another is lit when k < max_depth, and shows its own emission
 * when k <= max_depth. What leaves the scene shows its background. A surface that lets light through
 * diffusely is lit from both sides: twice in the list.
 */
#ifndef LC_MIRROR_H
#define LC_MIRROR_H

#include "scene/surface.h"

#define LC_MAX_ROUGH 8
#define LC_MAX_LIT (2 * LC_MAX_ROUGH)
#define LC_MAX_SPLITS 31
#define LC_LEAST_SHARE 1e-3f

/* A surface to be lit. */
typedef struct lc_lit {
    lc_surface surface; /* its t is the length of the whole way */
    lc_f3 view;         /* unit, from there towards where the ray came from */
    lc_f3 weight;       /* share of its radiance that reaches the camera; 1 without mirrors or glass */
    uint32_t n_mirrors; /* mirrors and glass surfaces on the way */
} lc_lit;

typedef struct lc_sight {
    lc_surface first;   /* what the camera ray meets, a mirror or not */
    lc_f3 emission;     /* radiance of all that was met, weighted */
    uint32_t n_rays;    /* beside the camera's */
    uint32_t n_lit;
    lc_lit lit[LC_MAX_LIT]; /* the strongest first */
} lc_sight;

/* False: the camera ray leaves the scene. For the arguments see lc_surface_hit; max_depth: 1..LC_MAX_DEPTH.
 */
bool lc_sight_trace(const lc_scene *scene, lc_f3 org, lc_f3 dir, double pixel, uint32_t max_depth,
                    lc_sight *out);

/* The direction in which a mirror sends light on that comes along dir. */
lc_f3 lc_mirror_leave(const lc_surface *s, lc_f3 dir);

/* What glass does with light that comes along dir. */
typedef struct lc_split {
    lc_f3 reflected, through; /* shares; through: of power, so radiance is that times `radiance` */
    lc_f3 out;                /* unit, where `through` goes */
    float radiance;
} lc_split;
void lc_glass_split(const lc_surface *s, lc_f3 dir, lc_split *split);

static inline bool lc_is_specular(const lc_material *m) { return m->mirror || m->glass; }

#endif
