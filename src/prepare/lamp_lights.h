/* lamp_lights.h - lights for emissive triangles, as many as the picture needs. */
#ifndef LC_LAMP_LIGHTS_H
#define LC_LAMP_LIGHTS_H

#include "scene/scene.h"

/* Of the light of a visible point: lights that stand for more are divided. */
#define LC_LAMP_SHARE 0.002
/* Lights of lamps are no more than this beside one of each emitting side of a triangle. */
#define LC_LAMP_LIGHTS ((size_t)1 << 17)

/* Appends a ball, or parts of it, for each sphere that is small from where it is seen, and oriented lights
 * for other emitters: one for each emitting side of each triangle, or of the parts into which it has been
 * divided by four, again and again, where a light stood for more than LC_LAMP_SHARE of the light of a point
 * of the picture. Each has the intensity L A along the normal, for a part of area A and radiance L, so that
 * the sum of the flux is exact. Triangles with an emission map have lights distributed by its power. Sets
 * scene->n_emissive_tris, and unless there are such maps scene->lamp_error.
 * max_depth: of paths. LC_ERR_MEMORY. */
lc_status lc_lamp_lights_make(lc_scene *scene, uint32_t max_depth, uint64_t seed);

#endif
