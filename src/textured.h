/* textured.h - what a hit takes from texture coordinates: material and tangent. */
#ifndef LC_TEXTURED_H
#define LC_TEXTURED_H

#include "bvh.h"
#include "scene.h"

/* The unit direction of growing u along the triangle, or 0 where the mesh has no uv or they don't give one. */
lc_f3 lc_textured_tangent(const lc_scene *scene, const lc_mesh *mesh, const lc_hit *hit);

/* The material at the hit; *n, the shading normal on the mesh's own side, is tilted by bump and normal maps. dir: of the ray,
 * unit; pixel: see surface.h. */
void lc_textured_material(const lc_scene *scene, const lc_mesh *mesh, const lc_hit *hit, lc_f3 dir, double pixel,
                          lc_material *m, lc_f3 *n);

#endif
