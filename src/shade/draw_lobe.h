/* draw_lobe.h - directions drawn by a point's narrow lobe. */
#ifndef LC_DRAW_LOBE_H
#define LC_DRAW_LOBE_H

#include "shade/point.h"

/* A unit direction, which may be below the horizon, from numbers of the unit square. GGX: by the normals of
 * the facets that the viewer sees ([Heitz18]). Phong: by the lobe. Ward: by a power of the cosine to the
 * mirror direction that is about as wide. The point has one of these. */
lc_f3 lc_lobe_draw(const lc_point *p, const double u[2]);

/* What is left, beside the facets' reflectance, of light from a direction above the horizon that a GGX lobe
 * has drawn: the part that facets do not mask on the way in, G / G1. */
float lc_lobe_unmasked(const lc_point *p, lc_f3 dir);

/* The density of a unit direction, 1/sr. */
double lc_lobe_density(const lc_point *p, lc_f3 dir);

#endif
