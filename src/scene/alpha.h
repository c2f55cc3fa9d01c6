/* alpha.h - meshes with holes, by pbrt's alpha.
 *
 * A hit where alpha is 0 lets the ray continue; a hit where alpha is 1 stops it. In between, the hit stops
 * the ray with probability alpha: a hash of the triangle and the barycentric coordinates decides, so the same
 * hit always gives the same answer. For shadow rays alpha is multiplied by pbrt-v3's shadowalpha.
 */
#ifndef LC_ALPHA_H
#define LC_ALPHA_H

#include "scene/scene.h"

/* Sets scene->alpha and a bit for each triangle whose mesh has alpha. LC_ERR_MEMORY. */
lc_status lc_alpha_init(lc_scene *scene);
/* The alpha test for a BVH over triangles first .. first + n - 1; NULL if all of them are opaque. */
const lc_alpha *lc_alpha_of(const lc_scene *scene, size_t first, size_t n);

/* Implements lc_alpha.opaque: true if the hit at (u, v) stops the ray. user is the scene. */
bool lc_alpha_opaque(const void *user, uint32_t tri, float u, float v, bool shadow);

#endif
