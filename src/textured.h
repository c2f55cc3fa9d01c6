/* textured.h - what a hit takes from texture coordinates: material and tangent. */
#ifndef LC_TEXTURED_H
#define LC_TEXTURED_H

#include "bvh.h"
#include "scene.h"

/* The unit direction of growing u along the triangle, or 0 where the mesh has no uv or they don't give one. */
lc_f3 lc_textured_tangent(const lc_scene *scene, const lc_mesh *mesh, const lc_hit *hit);

/* Overwrites in *m what has a texture. dir: of the ray, unit; pixel: see surface.h. */
void lc_textured_material(const lc_scene *scene, const lc_mesh *mesh, const lc_hit *hit, lc_f3 dir, double pixel,
                          lc_material *m);

/* Picture of the emission there. */
lc_f3 lc_textured_emission(const lc_scene *scene, const lc_mesh *mesh, const lc_hit *hit, lc_f3 dir, double pixel);
/* Texture coordinates of a vertex, 0..2, of a triangle. */
void lc_textured_uv(const lc_scene *scene, const lc_mesh *mesh, size_t tri, size_t vertex, double uv[2]);

#endif
