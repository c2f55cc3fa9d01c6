/* vpl.h - indirect light: virtual lights where light paths meet rough surfaces ([Keller97], and [Walter05]
 * 5). */
#ifndef LC_VPL_H
#define LC_VPL_H

#include "scene/scene.h"

/* Appends virtual lights for the light of all lights that the scene has, until there are n_lights of them:
 * every path goes on to its end, so a few more, or fewer where paths meet nothing. max_depth as pbrt counts:
 * a light after k surfaces is stored for k < max_depth. Needs joined lights and the BVH; sets
 * scene->indirect. The lights depend on scene and seed only, not on threads. seed: of all random numbers. */
lc_status lc_vpl_make(lc_scene *scene, uint32_t n_lights, uint32_t max_depth, uint64_t seed);

#endif
