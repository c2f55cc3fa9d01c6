/* env_light.h - turns environment maps into directional lights. */
#ifndef LC_ENV_LIGHT_H
#define LC_ENV_LIGHT_H

#include "scene.h"

/* Appends n_lights lights for all maps of the scene together, at least one for each that is not black; fewer where intensities
 * vanish. Each map is cut into rectangles of equal power, power being the mean of R, G and B; a light has its rectangle's irradiance,
 * so that their sum is the map's whatever n_lights, and a direction out of it, picked by power. */
lc_status lc_env_lights_make(lc_scene *scene, uint32_t n_lights, uint64_t seed);

#endif
