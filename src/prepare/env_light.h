/* env_light.h - turns environment maps into directional lights. */
#ifndef LC_ENV_LIGHT_H
#define LC_ENV_LIGHT_H

#include "scene/scene.h"

/* Appends n_lights lights for all maps of the scene together, at least one for each that is not black; fewer
 * where intensities vanish. Each map is cut into rectangles of equal power, power being the mean of R, G and
 * B, weighted by what directions give to what the camera sees (env_importance.h) where the scene has a BVH; a
 * light has its rectangle's irradiance, so that their sum is the map's whatever n_lights, and a direction out
 * of it, picked by power. max_depth: of camera rays. Sets scene->n_env_tried. */
lc_status lc_env_lights_make(lc_scene *scene, uint32_t n_lights, uint32_t max_depth, uint64_t seed);

#endif
