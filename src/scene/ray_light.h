/* ray_light.h - roughly how much light there is along a ray, by which the points of media on it are placed.
 *
 * A lamp next to a ray lights a short part of it by far the most, and a spot only the part in its cone;
 * points that are placed by what the medium scatters alone meet these by chance, which is seen as sparks
 * about the lamps. [Kulla12] places points by the angle in which one light sees the ray. Here the clusters of
 * the light tree that matter to the ray are looked for, and what they would shed, were nothing in the way, is
 * evaluated at places around where each is nearest, or shines on it.
 */
#ifndef LC_RAY_LIGHT_H
#define LC_RAY_LIGHT_H

#include "scene/media.h"

/* How far from a ray others are that share what is found. */
typedef struct lc_ray_spread {
    float pixel;       /* times the length; */
    float lens, focus; /* that of its radius, but for where it focuses; lens 0: a pinhole */
} lc_ray_spread;

/* What is found for the middle of a pixel, for its samples in turn. */
typedef struct lc_pixel_light {
    bool known; /* it is that of this pixel */
    uint32_t x, y, slot;
    lc_ray_light along;
} lc_pixel_light;

/* dir: unit. slot: of the representatives of clusters. */
void lc_ray_light_find(const lc_scene *scene, lc_f3 org, lc_f3 dir, const lc_ray_spread *spread,
                       uint32_t slot, lc_ray_light *out);

#endif
