/* material_eval.h - what a hit takes from texture coordinates: material and tangent. corner: of the triangle,
 * world space. */
#ifndef LC_TEXTURED_H
#define LC_TEXTURED_H

#include "scene/scene.h"
#include "trace/bvh.h"

/* The unit direction of growing u along the triangle, or 0 where the mesh has no uv or they don't give one.
 */
lc_f3 lc_textured_tangent(const lc_scene *scene, const lc_mesh *mesh, const float *const corner[3],
                          const lc_hit *hit);

/* Position and uv, those of no area, at (u, v) of a triangle with these corners. */
lc_tex_point lc_textured_point(const lc_scene *scene, const lc_mesh *mesh, const float *const corner[3],
                               uint32_t tri, float u, float v);

/* The material at the hit; *n, the shading normal on the mesh's own side, is tilted by bump and normal maps.
 * dir: of the ray, unit; pixel: see surface.h. */
void lc_textured_material(const lc_scene *scene, const lc_mesh *mesh, const float *const corner[3],
                          const lc_hit *hit, lc_f3 dir, double pixel, lc_material *m, lc_f3 *n);

/* Picture of the emission there. */
lc_f3 lc_textured_emission(const lc_scene *scene, const lc_mesh *mesh, const float *const corner[3],
                           const lc_hit *hit, lc_f3 dir, double pixel);
/* Texture coordinates of a vertex, 0..2, of a triangle. */
void lc_textured_uv(const lc_scene *scene, const lc_mesh *mesh, uint32_t tri, size_t vertex, double uv[2]);

#endif
