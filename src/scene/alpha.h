/* alpha.h - what rays pass through: meshes with holes, by pbrt's alpha, and for shadow rays glass.
 *
 * A hit where alpha is 0 lets the ray continue; a hit where alpha is 1 stops it. In between, the hit stops
 * the ray with probability alpha: a hash of the triangle and the barycentric coordinates decides, so the same
 * hit always gives the same answer. For shadow rays alpha is multiplied by pbrt-v3's shadowalpha.
 *
 * Shadow rays go straight through glass and mixes with glass. Each boundary transmits kt (1 - F), a thin
 * sheet kt (1 - 2 F / (1 + F)), F by Fresnel's equations at the angle to the shading normal. The angle counts
 * as that on the outer side of a boundary, on leaving glass too: light that came in at that angle leaves at
 * it, through parallel faces and through a ball. So there is no total reflection, and the loss is the same in
 * both directions. What glass bends, caustics, is left out.
 */
#ifndef LC_ALPHA_H
#define LC_ALPHA_H

#include "scene/scene.h"

/* Sets scene->alpha and a bit for each triangle whose mesh has alpha or is glass. LC_ERR_MEMORY. */
lc_status lc_alpha_init(lc_scene *scene);

/* Implement those of lc_alpha. user is the scene. */
bool lc_alpha_opaque(const void *user, uint32_t tri, float u, float v);
bool lc_alpha_stops(const void *user, const lc_hit *hit, const float dir[3], uint64_t loss[3]);

/* The share of light that passes the glass at a hit straight on. */
lc_f3 lc_alpha_through(const lc_scene *scene, const lc_hit *hit, const float dir[3]);

#endif
