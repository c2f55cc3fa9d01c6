/* lamp_find.h - the emissive meshes of a scene, and how far apart the lights made from them are. */
#ifndef LC_LAMP_FIND_H
#define LC_LAMP_FIND_H

#include "scene/scene.h"

/* Fills scene->lamps; lights first .. end - 1 of the scene are those made from emissive surfaces. */
void lc_lamps_find(lc_scene *scene, size_t first, size_t end);

#endif
