/* update.h - puts what was set again into a committed scene, and makes again what follows from it.
 *
 *     changed      | BVH of   light tree  made of lamps,  virtual
 *                  | instances            environments    lights
 *     -------------+---------------------------------------------
 *     camera       |                      if any (1)      if any
 *     light        |          yes                         if any
 *     instance     | yes      (2)         if any (1)      if any
 *     emission     |          yes         yes             if any
 *     environment  |          yes         yes             if any
 *     frame        |          yes         yes             if any      pictures that are sequences
 *
 * With views (lc_load_desc) cameras count for nothing: lights are made for these.
 * (1) Lights of lamps are chosen for the view unless their number was given; those of environments always
 * are. (2) Where lights have a direction and the diagonal of the scene has changed. Where lights are made,
 * the tree is built. The BVHs of triangles stay in any case. Where camera or lights leave the range that the
 * boxes of instances were made for (instance.c), these are built, too.
 */
#ifndef LC_UPDATE_H
#define LC_UPDATE_H

#include "scene/scene.h"

/* Adds to what waits for lc_scene_apply; lc_change.at must be in range and the value checked. LC_ERR_MEMORY.
 */
lc_status lc_scene_change(lc_scene *scene, const lc_change *change);
/* Takes all that waits. The scene is then as if it had been committed so, bit for bit. keep: only that lights
 * made of lamps, environments and paths stay, though they were chosen for another view, which makes them
 * stale; without keep all that is stale is made again. On failure the scene
 * is as before, and the changes still wait. LC_ERR_PARSE: the camera is out of range; LC_ERR_MEMORY. */
lc_status lc_scene_apply(lc_scene *scene, bool keep);

#endif
