/* area_map.h - lights for triangles whose emission is an image over uv. */
#ifndef LC_AREA_MAP_H
#define LC_AREA_MAP_H

#include "scene/scene.h"

/* The mean R, G, B of the emission map over the triangle's area. */
void lc_area_map_mean(const lc_scene *scene, size_t tri, double rgb[3]);

/* R, G, B of the emission map at a point of the triangle, b: the weights of vertices 1 and 2. */
void lc_area_map_at(const lc_scene *scene, size_t tri, const double b[2], double rgb[3]);

/* Appends k lights of the kind and direction of `base`. Their intensities sum to base->intensity, which is
 * that for a white map, times the mean of the map. The triangle is cut into k parts of equal power; each
 * light has the colour of its part and a position in it chosen with a density proportional to power. */
lc_status lc_area_map_lights(lc_scene *scene, size_t tri, uint32_t k, const lc_light *base, uint64_t seed);

#endif
