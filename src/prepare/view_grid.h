/* view_grid.h - a grid of visible shading points for scoring generated lights.
 *
 *     side * side camera rays -> first rough surface of each -> lc_point with a grey diffuse material
 *
 * Lights made from environment maps and light paths are scored by what they contribute to these points,
 * shadows included, so that fewer are spent on what the picture does not show.
 */
#ifndef LC_VIEW_GRID_H
#define LC_VIEW_GRID_H

#include "scene/scene.h"
#include "shade/tree_data.h"

#define LC_VIEW_GRID_SIDE LC_SIZE(16, 6) /* points a side, for virtual lights */

typedef struct lc_view_grid {
    const lc_scene *scene;
    uint32_t n; /* points, at most `room`: rays that leave the scene give none */
    size_t room;
    lc_point *points; /* in the order of the picture's rows, one view after another */
    float (*org)[3];  /* n: origins of their shadow rays */
    float *lobe;      /* n: lc_lobe_angle of their surfaces */
} lc_view_grid;

/* Traces side * side camera rays over the whole film, whatever its crop, or of several views
 * lc_view_side(side) squared of each. LC_ERR_MEMORY, after which it must
 * be freed, too. */
lc_status lc_view_grid_init(lc_view_grid *view, const lc_scene *scene, uint32_t side, uint32_t max_depth);
void lc_view_grid_free(lc_view_grid *view);

/* About half the width of the narrowest lobe, rad; large for diffuse surfaces. */
float lc_lobe_angle(const lc_material *material);

/* Luminance that an inverse-square or directional light contributes to a point, shadows ignored. */
float lc_unoccluded_luminance(const lc_shade_kernels *kernels, const lc_point *p, const lc_light *light,
                              const lc_light_rec *rec);

/* The importance of an inverse-square light: the mean luminance that it contributes to LC_IMPORTANCE_POINTS
 * of the points, shadows included. hash chooses the points. */
#define LC_IMPORTANCE_POINTS 16
double lc_view_grid_importance(const lc_view_grid *view, const lc_light *light, uint64_t hash);

#endif
