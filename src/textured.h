/* textured.h - the material of a hit on a textured mesh. */
#ifndef LC_TEXTURED_H
#define LC_TEXTURED_H

#include "bvh.h"
#include "scene.h"

/* Overwrites in *m what has a texture. dir: of the ray, unit; pixel: see surface.h. */
void lc_textured_material(const lc_scene *scene, const lc_mesh *mesh, const lc_hit *hit, lc_f3 dir, double pixel,
                          lc_material *m);

#endif
