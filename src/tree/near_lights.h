/* near_lights.h - lights so near to a small surface that what they give changes across it. */
#ifndef LC_NEAR_LIGHTS_H
#define LC_NEAR_LIGHTS_H

#include "tree/light_tree.h"

/* A point of the surface. */
typedef struct lc_near_point {
    lc_f3 pos, n; /* world space; unit */
} lc_near_point;

/* No less than what all lights together that are within `reach` of the points' box, lie in front of the
 * surface at one of the points and shine towards one of them may add to its irradiance: the sum of
 * intensity / height^2 over the planes of the points, lower lights being taken as `least` high; luminance.
 * Not exact up to `enough`, nor above it: INFINITY there, and where the search would take too long. Of lights
 * at infinity none is near. Attenuation other than 1 / d^2 is taken as that. */
double lc_near_lights(const lc_light_tree *t, const lc_near_point *p, uint32_t n, float reach, float least,
                      double enough);

#endif
