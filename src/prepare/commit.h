/* commit.h - makes a complete scene ready to render.
 *
 * The room prepare/ turns everything that emits into the kinds of light that the light tree knows. In
 * goes a scene as the parser leaves it; out comes the same scene with all its lights, its BVH and its light
 * tree.
 *
 *     triangles, instances -> BVH, occluders
 *     emissive triangles   -> oriented lights     (lamp_lights.h, area_light.h, area_map.h)
 *     emissive spheres     -> balls               (ball_find.h)
 *     environment maps     -> lights of the sky   (env_light.h, scored by env_importance.h)
 *     light paths          -> virtual lights      (vpl.h, scored by view_grid.h, clamped by vpl_radius.h)
 *     all lights           -> light tree
 *
 * lighting.h has all but the first line; update.h does again what follows from what was set again.
 */
#ifndef LC_COMMIT_H
#define LC_COMMIT_H

#include "scene/scene.h"

/* Makes the film as large as the options of loading ask, once it and the sensors are known. */
void lc_scene_size_film(lc_scene *scene, const lc_load_desc *desc);
/* desc must have its defaults filled in. Must be called once; afterwards the scene is read-only, but
 * for update.h, and may be shared by threads. LC_ERR_PARSE without a camera or if it is out of range;
 * LC_ERR_MEMORY. */
lc_status lc_scene_commit(lc_scene *scene, const lc_load_desc *desc);

#endif
