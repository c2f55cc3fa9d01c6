/* area_light.h - turns emissive triangles into jittered oriented lights. */
#ifndef LC_AREA_LIGHT_H
#define LC_AREA_LIGHT_H

#include "scene/scene.h"

/* Appends about n_lights oriented lights for all emissive triangles of the scene together (at least one for
 * each triangle side that emits), spread by emitted power. A light of area A / k at a jittered point has I =
 * L A / k along the emitting normal, so that the sum of flux is exact whatever n_lights. */
lc_status lc_area_lights_make(lc_scene *scene, uint32_t n_lights, uint64_t seed);

#endif
