/* alpha.h - meshes with holes. Where alpha is 0 a ray goes on, where it is 1 it is stopped; of the hits
 * between, a share of alpha stops it, chosen by a hash of triangle and place. Shadow rays also look at
 * pbrt-v3's shadowalpha, whose share multiplies. */
#ifndef LC_ALPHA_H
#define LC_ALPHA_H

#include "scene/scene.h"

/* Marks the triangles of meshes that have alpha; lc_alpha_of says which of the scene's BVHs have to ask. */
lc_status lc_alpha_init(lc_scene *scene);
/* NULL: triangles first .. first + n - 1 are all opaque. */
const lc_alpha *lc_alpha_of(const lc_scene *scene, size_t first, size_t n);

/* lc_alpha.opaque; user: the scene. */
bool lc_alpha_opaque(const void *user, uint32_t tri, float u, float v, bool shadow);

#endif
