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

/* The BVH over the instances, and what it was built for. */
typedef struct lc_top {
    lc_bvh *boxes;
    lc_box bounds; /* of the world's triangles and the instances */
    double reach;  /* of rays, world space */
} lc_top;

/* Builds it anew for where instances, camera and lights are now; LC_ERR_MEMORY. The scene keeps its own until
 * they are exchanged. moved: instances have moved. Otherwise *top is empty if the scene's own serves. */
lc_status lc_top_build(lc_scene *scene, bool moved, lc_top *top);
void lc_top_exchange(lc_scene *scene, lc_top *top);
/* The BVH over the instances of a copy of a committed scene, which has instances of its own, and what the
 * kernels read of them. LC_ERR_MEMORY. */
lc_status lc_instances_place(lc_scene *copy, lc_top *top, lc_placed *placed);
/* Bytes of the BVHs and of the instances. */
size_t lc_instances_bytes(const lc_scene *scene);
/* The number of triangles that the instances would have as copies. */
uint64_t lc_instanced_tris(const lc_scene *scene);

#endif
