/* env_light.h - turns environment maps into lights of the sky. */
#ifndef LC_ENV_LIGHT_H
#define LC_ENV_LIGHT_H

#include "scene/scene.h"

/* Appends n_lights lights for all environment maps of the scene together, at least one for each map that is
 * not black; fewer if an intensity underflows to 0. Each map is cut into rectangles of equal power: the mean
 * of R, G and B, times the importance of the direction for the picture (env_importance.h) if the scene has a
 * BVH. A light has the irradiance of its rectangle, so their sum is exactly the map's for any n_lights, and
 * is a disc about its mean direction. max_depth is that of camera rays. Sets scene->n_env_tried, and with a
 * BVH scene->sky_error. LC_ERR_MEMORY. */
lc_status lc_env_lights_make(lc_scene *scene, uint32_t n_lights, uint32_t max_depth, uint64_t seed);

/* n lights of the sky of equal power for one environment map, whatever the camera sees; n_made: n, or 0 if
 * it is black. LC_ERR_MEMORY. */
lc_status lc_env_lights_by_power(const lc_scene *scene, size_t env, uint32_t n, uint64_t seed,
                                 lc_light *lights, uint32_t *n_made);

#endif
