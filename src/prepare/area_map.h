/* area_map.h - lights of triangles whose emission is a picture, by uv. */
#ifndef LC_AREA_MAP_H
#define LC_AREA_MAP_H

#include "scene/scene.h"

/* Mean over the triangle's area of the picture's colours. */
void lc_area_map_mean(const lc_scene *scene, size_t tri, double rgb[3]);

/* Appends k lights of `base`'s kind and direction, whose intensities together are base->intensity, that of a
 * white picture, times the mean of the picture: each has the colour of its share of the triangle, shares
 * being of equal power, and lies in it at a place picked by power. */
lc_status lc_area_map_lights(lc_scene *scene, size_t tri, uint32_t k, const lc_light *base, uint64_t seed);

#endif
