/* vpl.h - indirect light: virtual lights where light paths hit rough surfaces ([Keller97], [Walter05] 5). */
#ifndef LC_VPL_H
#define LC_VPL_H

#include "scene/scene.h"

/* Traces paths from all lights of the scene and appends virtual lights until there are n_lights: every path
 * is completed, so there may be a few more; there are fewer if paths hit nothing. max_depth counts as in
 * pbrt: a light after k surfaces is stored if k < max_depth. Needs joined lights and the BVH; sets
 * scene->indirect. The lights depend on the scene and the seed only, not on threads. LC_ERR_MEMORY. */
lc_status lc_vpl_make(lc_scene *scene, uint32_t n_lights, uint32_t max_depth, uint64_t seed);

#endif
