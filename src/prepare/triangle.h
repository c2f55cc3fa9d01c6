/* triangle.h - area and points of a scene's triangles, and where lights on them are; the box of a mesh. World
 * space.
 */
#ifndef LC_TRIANGLE_H
#define LC_TRIANGLE_H

#include "scene/scene.h"

/* The cross product of two edges, by winding order; returns its length, twice the area. */
double lc_tri_cross(const lc_scene *scene, size_t tri, double n[3]);
double lc_tri_area(const lc_scene *scene, size_t tri);
/* The point at b, the weights of vertices 1 and 2. */
lc_f3 lc_tri_point(const lc_scene *scene, size_t tri, const double b[2]);
/* Where a light that shines along the unit normal n of a triangle is: off the triangle's point p as rays are
 * that start there, so that its own lamp never lies before it. */
lc_f3 lc_tri_light_at(const lc_scene *scene, size_t tri, lc_f3 p, lc_f3 n);
lc_box lc_mesh_box(const lc_scene *scene, const lc_mesh *mesh);

#endif
