/* kernels.h - the kernels of one instruction set, and the table that picks them. */
#ifndef LC_KERNELS_H
#define LC_KERNELS_H

#include "cut_list.h"
#include "layout.h"
#include "lightcuts.h"
#include "ploc_list.h"

/* Triangles with holes: where a hit is not opaque the ray goes on. */
typedef struct lc_alpha {
    const uint32_t *bits; /* a bit for each triangle of the scene: may have holes */
    bool (*opaque)(const void *user, uint32_t tri, float u, float v, bool shadow);
    const void *user;
} lc_alpha;

struct lc_placed;

/* What BVH kernels read. n_nodes == 0: nothing can be hit. Node 0 is the root. */
typedef struct lc_bvh_data {
    const lc_bvh_node *nodes;
    const lc_tri_block *blocks;
    uint32_t n_nodes, n_blocks;
    uint32_t first_tri;             /* of the scene: the BVH's triangle 0 */
    const lc_alpha *alpha;          /* NULL: all triangles are opaque */
    const struct lc_placed *placed; /* what stands in the world besides, or NULL */
} lc_bvh_data;

/* An object in its place. Rows of affine maps. */
typedef struct lc_instance {
    double to_object[12];
    uint32_t object;
    bool mirrored;
    double to_world[12]; /* last: shadow rays don't want it */
} lc_instance;

/* Instances. `boxes` is a BVH like others, but vertices 0 and 1 of a triangle are the corners of an instance's box, and its
 * number is the instance's. */
typedef struct lc_placed {
    lc_bvh_data boxes;
    const lc_instance *instances;
    const lc_bvh_data *objects; /* in their own spaces; they have nothing placed in them */
} lc_placed;

typedef struct lc_hit {
    float t;           /* point = origin + t dir */
    float u, v;        /* weights of vertices 1 and 2; vertex 0 has 1 - u - v */
    uint32_t tri;      /* of the scene; LC_NONE: nothing hit */
    uint32_t instance; /* LC_NONE: a triangle of the world */
} lc_hit;

/* Share of a shadow segment that is left out at either end. */
#define LC_SHADOW_EPS 1e-4f
/* Stack of the traversals: 7 entries a level, levels bounded by the builder. */
#define LC_BVH_MAX_DEPTH 96
#define LC_BVH_STACK (7 * LC_BVH_MAX_DEPTH + 8)

/* Arrays that kernels write have room for their count rounded up to this; what they put past the count means nothing. */
#define LC_LANES 16

typedef struct lc_kernels {
    /* Bounds of nodes index[0 .. n), all of one kind, to ub; see bounds.h. */
    void (*bounds)(const lc_tree_data *tree, const uint32_t *index, uint32_t n, lc_light_kind kind, const lc_point *point,
                   float *ub);
    /* Transfers of lights index[0 .. n), or first .. first + n - 1 where index is NULL, all of one kind, as lc_shade_light
     * gives them: R G B to out[0 .. 2], the target of the shadow ray (position, or direction towards the light) to
     * out[3 .. 5]. */
    void (*estimate)(const lc_tree_data *tree, uint32_t first, const uint32_t *index, uint32_t n, lc_light_kind kind,
                     const lc_point *point, float *const out[6]);
    /* Puts children into the lists: above the limit to open, else to left, leaves to leaf, bounds of 0 nowhere. Returns
     * the change of the total's luminance. */
    double (*place)(const lc_cut_pairs *pairs, lc_cut_list *open, lc_cut_list *left, lc_cut_list *leaf);
    /* Moves the clusters of a list with a bound above the limit to one list, the others to another. Either may be the
     * list itself. */
    void (*partition)(lc_cut_list *from, float limit, lc_cut_list *above, lc_cut_list *rest);
    /* Nearest hit with 0 < t <= t_max; of equal t one of the world, then the lowest instance, then the lowest triangle id. */
    void (*closest)(const lc_bvh_data *bvh, const float org[3], const float dir[3], float t_max, lc_hit *hit);
    /* hidden[i] = 1 if a triangle is met on org + t (target i - org) for t in (LC_SHADOW_EPS, 1 - LC_SHADOW_EPS), or,
     * if `far` is set, on org + t target at any t > 0: targets then are directions. target: x, y, z arrays.
     * block, unless NULL: where hidden, the block of such a triangle, LC_NONE if it is an instance's; the same from all kernels. */
    void (*hidden)(const lc_bvh_data *bvh, const float org[3], uint32_t n, const float *const target[3], bool far,
                   uint8_t *hidden, uint32_t *block);
    /* offset[i] leads from position first + i of the list, i < n, to its nearest neighbour among the `radius` before and
     * behind it, or is 0 where it has none. grouped: of its group of LC_PLOC_GROUP positions only. */
    void (*nearest)(const lc_ploc_list *list, uint32_t first, uint32_t n, uint32_t radius, bool grouped, float *offset);
} lc_kernels;

const lc_kernels *lc_kernels_get(lc_isa isa); /* isa: one the CPU supports */

extern const lc_kernels lc_kernels_scalar, lc_kernels_sse4, lc_kernels_avx2, lc_kernels_avx512;

#endif
