/* instance.h - object instancing: many placements of an object share its triangles and one BVH.
 *
 *     world ray -> BVH over the world's own triangles
 *               -> BVH over the instances' boxes -> ray in object space -> the object's BVH
 *
 * The parameter t does not change under the transform: point = origin + t direction holds in both spaces.
 */
#ifndef LC_INSTANCE_H
#define LC_INSTANCE_H

#include "scene/scene.h"
#include "trace/bvh.h"

/* True if an object can be instanced by this map: affine, with a condition number of at most MAX_CONDITION,
 * scaling lengths by at most MAX_SCALE either way (instance.c). Under any other map the triangles must be
 * copied. */
bool lc_instance_fits(const lc_xform *to_world);

/* Builds the BVH of each object and the BVH over the instances, hangs them on scene->bvh, which must be
 * built, and extends scene->bounds by the instances. LC_ERR_MEMORY. */
lc_status lc_instances_build(lc_scene *scene);
void lc_instances_free(lc_scene *scene);
/* Bytes of the BVHs and of the instances. */
size_t lc_instances_bytes(const lc_scene *scene);
/* The number of triangles that the instances would have as copies. */
uint64_t lc_instanced_tris(const lc_scene *scene);

#endif
