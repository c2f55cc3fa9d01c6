/* material_eval.h - what depends on texture coordinates at a hit: the material, its tangent and the emission.
 *
 *     hit, uv of the triangle -> lc_tex_point -> textures -> lc_material, tilted shading normal
 *
 * corner: the triangle's vertices in world space. dir: the ray's unit direction. pixel: side of the pixel's
 * footprint at distance 1, over which textures are filtered.
 */
#ifndef LC_MATERIAL_EVAL_H
#define LC_MATERIAL_EVAL_H

#include "scene/scene.h"
#include "trace/bvh.h"

/* dp/du, normalized; 0 if the mesh has no uv or they are degenerate on this triangle. */
lc_f3 lc_textured_tangent(const lc_scene *scene, const lc_mesh *mesh, const float *const corner[3],
                          const lc_hit *hit);

/* The texture point at barycentric coordinates (u, v), with a footprint of no extent: position, uv and
 * normal. */
lc_tex_point lc_textured_point(const lc_scene *scene, const lc_mesh *mesh, const float *const corner[3],
                               uint32_t tri, float u, float v);

/* The material at the hit. *n is the shading normal on the mesh's outer side; bump and normal maps tilt
 * it. */
void lc_textured_material(const lc_scene *scene, const lc_mesh *mesh, const float *const corner[3],
                          const lc_hit *hit, lc_f3 dir, double pixel, lc_material *m, lc_f3 *n);

/* The fraction of light that the material at the hit lets pass, per channel, where it is or mixes glass: the
 * mean over what a mix may be. Bump and normal maps do not count. cos_i: as for lc_transmittance. */
lc_f3 lc_textured_transmittance(const lc_scene *scene, const lc_mesh *mesh, const float *const corner[3],
                                const lc_hit *hit, float cos_i);

/* The value of the mesh's emission map at the hit, which multiplies the mesh's emission. */
lc_f3 lc_textured_emission(const lc_scene *scene, const lc_mesh *mesh, const float *const corner[3],
                           const lc_hit *hit, lc_f3 dir, double pixel);
/* The texture coordinates of vertex 0, 1 or 2 of a triangle. */
void lc_textured_uv(const lc_scene *scene, const lc_mesh *mesh, uint32_t tri, size_t vertex, double uv[2]);

#endif
