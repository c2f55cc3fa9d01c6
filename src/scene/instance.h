/* instance.h - objects that stand in the world more than once and share their triangles.
 *
 *     top:     the world's BVH over its own triangles, then one over the boxes of instances
 *     objects: a BVH each, in the object's space; rays are transformed
 *
 * A ray keeps its t: point = origin + t direction holds in both spaces.
 */
#ifndef LC_INSTANCE_H
#define LC_INSTANCE_H

#include "scene/scene.h"
#include "trace/bvh.h"

/* May an object be placed by this? An affine map with an inverse that floats can do with: of condition at
 * most 10^3, growing or shrinking lengths by at most 10^6. Of others a copy of the triangles has to be made.
 */
bool lc_instance_fits(const lc_xform *to_world);

/* Objects' BVHs and that of the instances, for scene->bvh, which is built; adds the instances to the scene's
 * bounds. */
lc_status lc_instances_build(lc_scene *scene);
void lc_instances_free(lc_scene *scene);
size_t lc_instances_bytes(const lc_scene *scene); /* BVHs and instances */
uint64_t lc_instanced_tris(const lc_scene *scene); /* as copies there would be as many triangles */

#endif
