/* spot_picture.h - the maps of spots that project a picture. */
#ifndef LC_SPOT_PICTURE_H
#define LC_SPOT_PICTURE_H

#include "image/mipmap.h"
#include "shade/light_spot.h"

/* Makes *map, whose to_light is set, a projection of the picture whose shorter side has an angle of fov
 * degrees, above 0 and below 180: allocates and fills its texels. half: half the picture's sides at a
 * distance of 1. *power: its luminance times solid angle, the sum over texels as in pbrt-v4. LC_ERR_MEMORY.
 */
lc_status lc_spot_project(const lc_context *ctx, const lc_mipmap *picture, double fov, lc_spot_map *map,
                          double half[2], double *power);
/* Moves the texels' greatest value of each channel into the intensity, so that kernels look up values of
 * 0..1. */
void lc_spot_normalise(lc_spot_map *map, lc_f3 *intensity);
/* The cone of a projection, of whose corners the widest has this cosine to the axis: its step lies outside
 * by more than the error of an estimate's cosine, so that the map alone bounds the frustum. */
void lc_spot_set_frustum(lc_light *light, double least_cos);

#endif
