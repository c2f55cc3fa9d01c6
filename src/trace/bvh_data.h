/* bvh_data.h - the bounding volume hierarchy as the kernels read it, and the table of the kernels over it;
 * sizes asserted. */
#ifndef LC_BVH_DATA_H
#define LC_BVH_DATA_H

#include "base/base.h"

/* A node has so many children, a block so many triangles. */
#define LC_BLOCK_LANES 8

/* Eight-wide BVH node. Lanes without a child have lo > hi. */
typedef struct lc_bvh_node {
    float lo[3][8], hi[3][8];
    uint32_t child[8]; /* node index, or LC_BVH_LEAF | block index */
    uint32_t pad[8];
} lc_bvh_node;
_Static_assert(sizeof(lc_bvh_node) == 4 * 64, "four cache lines");

/* Up to eight triangles, vertex by axis by lane. Lanes without a triangle have tri = LC_NONE and can't be
 * hit. */
typedef struct lc_tri_block {
    float v[3][3][8]; /* [vertex][axis][lane] */
    uint32_t tri[8];
} lc_tri_block;
_Static_assert(sizeof(lc_tri_block) == 5 * 64, "five cache lines");

#define LC_BVH_LEAF 0x80000000u

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

/* As lc_xform_point does it, so that an instance has a copy's vertices. */
static inline void lc_instance_point(const lc_instance *at, const float p[3], float out[3])
{
    const double *m = at->to_world, x = (double)p[0], y = (double)p[1], z = (double)p[2];
    for (int k = 0; k < 3; k++, m += 4) out[k] = (float)(m[0] * x + m[1] * y + m[2] * z + m[3]);
}

/* Instances. `boxes` is a BVH like others, but vertices 0 and 1 of a triangle are the corners of an
 * instance's box, and its number is the instance's. */
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
/* Factor of the distance to the far side of a box: 1 + 2 gamma(3), and more (Ize 2013, "Robust BVH ray traversal"). */
#define LC_FAR_SLACK (1 + 0x1p-20f)
/* Stack of the traversals: 7 entries a level, levels bounded by the builder. */
#define LC_BVH_MAX_DEPTH 96
#define LC_BVH_STACK (7 * LC_BVH_MAX_DEPTH + 8)

/* Kernels that trace rays, of one instruction set. */
typedef struct lc_trace_kernels {
    /* Nearest hit with 0 < t <= t_max; of equal t one of the world, then the lowest instance, then the lowest
     * triangle id. */
    void (*closest)(const lc_bvh_data *bvh, const float org[3], const float dir[3], float t_max, lc_hit *hit);
    /* hidden[i] = 1 if a triangle is met on org + t (target i - org) for t in (LC_SHADOW_EPS, 1 -
     * LC_SHADOW_EPS), or, if `far` is set, on org + t target at any t > 0: targets then are directions.
     * target: x, y, z arrays. block, unless NULL: where hidden, the block of such a triangle, LC_NONE if it
     * is an instance's; the same from all kernels. */
    void (*hidden)(const lc_bvh_data *bvh, const float org[3], uint32_t n, const float *const target[3],
                   bool far, uint8_t *hidden, uint32_t *block);
} lc_trace_kernels;

#endif
