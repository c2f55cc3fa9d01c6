/* ball_find.h - emissive meshes that are spheres, which one light can stand for. */
#ifndef LC_BALL_FIND_H
#define LC_BALL_FIND_H

#include "scene/scene.h"

/* Whether a mesh is a sphere that emits outwards, the same everywhere: all vertices as far from the middle of
 * their box to within 0.1 %, its outer sides out, and 80 % or more of the sphere's area. Sets light: a ball
 * with the power of the mesh. */
bool lc_ball_find(const lc_scene *scene, uint32_t mesh, lc_light *light);

#endif
