/* view_grid.h - what the camera sees, as far as the making of lights asks: a grid of points, taken as grey.
 */
#ifndef LC_VPL_VIEW_H
#define LC_VPL_VIEW_H

#include "scene/scene.h"
#include "shade/tree_data.h"

#define LC_VIEW_SIDE LC_SIZE(16, 6) /* for virtual lights */

typedef struct lc_vpl_view {
    const lc_scene *scene;
    uint32_t n, side; /* points, at most side * side */
    lc_point *points;
    float (*org)[3]; /* where their shadow rays start */
} lc_vpl_view;

/* side * side camera rays over the whole film, whatever the crop. LC_ERR_MEMORY; free it also then. */
lc_status lc_vpl_view_init(lc_vpl_view *view, const lc_scene *scene, uint32_t side, uint32_t max_depth);
void lc_vpl_view_free(lc_vpl_view *view);

/* Luminance that a light of inverse square, or a directional one, gives to a point, shadows not counted. */
float lc_view_luminance(const lc_shade_kernels *kernels, const lc_point *p, const lc_light *light, const lc_light_rec *rec);

/* Mean luminance that an inverse-square light gives to LC_WORTH_POINTS of the points, shadows counted; hash
 * picks which. */
#define LC_WORTH_POINTS 16
double lc_vpl_worth(const lc_vpl_view *view, const lc_light *light, uint64_t hash);

/* Share of the light of the scene's lights from `first` on that their attenuation r^2 + d^2 in place of d^2
 * takes away, shadows counted. An estimate by all lights near each point and a sample of the others; nearer
 * than r / 4 distances count as that, for single dots would outweigh all else. 0 where nothing is lit. */
double lc_vpl_loss(const lc_vpl_view *view, size_t first, uint64_t seed);

#endif
