/* vpl_view.h - what the camera sees, as far as the making of virtual lights asks: a grid of points, taken as grey. */
#ifndef LC_VPL_VIEW_H
#define LC_VPL_VIEW_H

#include "layout.h"
#include "scene.h"

#define LC_VIEW_SIDE 16

typedef struct lc_vpl_view {
    const lc_scene *scene;
    uint32_t n; /* points */
    lc_point points[LC_VIEW_SIDE * LC_VIEW_SIDE];
    float org[LC_VIEW_SIDE * LC_VIEW_SIDE][3]; /* where their shadow rays start */
} lc_vpl_view;

/* The whole film, whatever the crop. */
void lc_vpl_view_init(lc_vpl_view *view, const lc_scene *scene, uint32_t max_depth);

/* Mean luminance that an inverse-square light gives to LC_WORTH_POINTS of the points, shadows counted; hash picks which. */
#define LC_WORTH_POINTS 16
double lc_vpl_worth(const lc_vpl_view *view, const lc_light *light, uint64_t hash);

/* Share of the light of the scene's lights from `first` on that their attenuation r^2 + d^2 in place of d^2 takes away, shadows
 * counted. An estimate by all lights near each point and a sample of the others; nearer than r / 4 distances count as that, for single dots
 * would outweigh all else. 0 where nothing is lit. */
double lc_vpl_loss(const lc_vpl_view *view, size_t first, uint64_t seed);

#endif
