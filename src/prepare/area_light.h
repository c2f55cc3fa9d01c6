/* area_light.h - turns emissive triangles into jittered oriented lights. */
#ifndef LC_AREA_LIGHT_H
#define LC_AREA_LIGHT_H

#include "scene/scene.h"

/* Appends about n_lights oriented lights for all emissive triangles of the scene together, distributed by
 * emitted power, at least one for each emitting side of a mesh. A light that stands for a k-th of a triangle
 * of area A and radiance L has the intensity L A / k along the emitting normal, so the sum of the flux is
 * exact for any n_lights. Sets scene->n_emissive_tris. LC_ERR_MEMORY. */
lc_status lc_area_lights_make(lc_scene *scene, uint32_t n_lights, uint64_t seed);

#endif
