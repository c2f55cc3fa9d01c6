/* bvh_data.h - the BVH as the kernels read it, and the table of the kernels that trace rays.
 *
 *     lc_bvh_node                        lc_tri_block
 *     lo x8 lo y8 lo z8                  vertex 0: x8 y8 z8
 *     hi x8 hi y8 hi z8                  vertex 1: x8 y8 z8
 *     child8 -> node or block            vertex 2: x8 y8 z8
 *                                        tri8
 */
#ifndef LC_BVH_DATA_H
#define LC_BVH_DATA_H

#include "base/base.h"

/* A node has so many children, a block so many triangles. */
#define LC_BLOCK_LANES 8

/* A node with up to eight children, one a lane. Lanes without a child have lo > hi. */
typedef struct lc_bvh_node {
    float lo[3][8], hi[3][8];
    uint32_t child[8]; /* node index, or LC_BVH_LEAF | block index */
    uint32_t pad[8];
} lc_bvh_node;
_Static_assert(sizeof(lc_bvh_node) == 4 * 64, "four cache lines");

/* Up to eight triangles, one a lane. Lanes without a triangle have tri = LC_NONE and NaN vertices, which no
 * ray hits. */
typedef struct lc_tri_block {
    float v[3][3][8]; /* [vertex][axis][lane] */
    uint32_t tri[8];
} lc_tri_block;
_Static_assert(sizeof(lc_tri_block) == 5 * 64, "five cache lines");

#define LC_BVH_LEAF 0x80000000u

struct lc_hit;

/* Triangles behind which a ray may continue: holes by alpha, and for shadow rays glass. */
typedef struct lc_alpha {
    const uint32_t *bits; /* a bit for each triangle of the scene, set if it may let a ray pass */
    bool (*opaque)(const void *user, uint32_t tri, float u, float v); /* to camera rays */
    /* Whether a hit stops a shadow ray along dir (world space, any length). If not, loss is set to what the
     * ray loses of R, G, B; t of the hit is unused. */
    bool (*stops)(const void *user, const struct lc_hit *hit, const float dir[3], uint64_t loss[3]);
    const void *user;
} lc_alpha;

/* A loss is -ln of a transmittance in fixed point: integer sums do not depend on the order in which a ray
 * meets surfaces. Unit: 2^-32. Sums stay at LC_LOSS_ALL, which is a transmittance of 0. */
#define LC_LOSS_UNIT 0x1p-32
#define LC_LOSS_ALL ((uint64_t)1 << 62)

static inline uint64_t lc_loss_sum(uint64_t a, uint64_t b)
{
    return a + b < LC_LOSS_ALL ? a + b : LC_LOSS_ALL; /* both are at most 2^62 */
}

struct lc_placed;

/* What the kernels read of a BVH. Node 0 is the root. n_nodes == 0: there are no triangles. */
typedef struct lc_bvh_data {
    const lc_bvh_node *nodes;
    const lc_tri_block *blocks;
    uint32_t n_nodes, n_blocks;
    uint32_t first_tri;             /* the scene's id of the BVH's triangle 0 */
    const lc_alpha *alpha;          /* NULL: all triangles stop all rays */
    const struct lc_placed *placed; /* the instances, for the world's BVH; or NULL */
} lc_bvh_data;

/* A placement of an object. The maps are affine, 3 rows of 4. */
typedef struct lc_instance {
    double to_object[12]; /* world to object space */
    uint32_t object;
    bool mirrored;        /* the map inverts orientation */
    bool moves;           /* while the shutter is open: scene/motion.h */
    double to_world[12];  /* last, because shadow rays do not read it */
} lc_instance;

/* Transforms a point exactly as lc_xform_point does, so that an instance has the same vertices as a copy. */
static inline void lc_instance_point(const lc_instance *at, const float p[3], float out[3])
{
    const double *m = at->to_world, x = (double)p[0], y = (double)p[1], z = (double)p[2];
    for (int k = 0; k < 3; k++, m += 4) out[k] = (float)(m[0] * x + m[1] * y + m[2] * z + m[3]);
}

/* Top-level BVH over the instances; reuses lc_tri_block: v[0] = box min, v[1] = box max, tri = instance. */
typedef struct lc_placed {
    lc_bvh_data boxes;
    const lc_instance *instances;
    const lc_bvh_data *objects; /* in object space; objects contain no instances */
} lc_placed;

typedef struct lc_hit {
    float t;           /* the point is origin + t dir */
    float u, v;        /* barycentric weights of vertices 1 and 2; vertex 0 has 1 - u - v */
    uint32_t tri;      /* the scene's triangle id; LC_NONE: nothing was hit */
    uint32_t instance; /* LC_NONE: a triangle of the world */
} lc_hit;

/* The fraction of a shadow ray at each end in which triangles do not occlude; chosen. */
#define LC_SHADOW_EPS 1e-4f
/* Factor of the distance to the far side of a box: 1 + 2 gamma(3), and more (Ize 2013, "Robust BVH ray
 * traversal"). */
#define LC_FAR_SLACK (1 + 0x1p-20f)
/* Limits the depth of a BVH, which the builder keeps, and so the stack of the traversals: 7 entries a
 * level. */
#define LC_BVH_MAX_DEPTH 96
#define LC_BVH_STACK (7 * LC_BVH_MAX_DEPTH + 8)

/* The kernels of one instruction set that trace rays. */
typedef struct lc_trace_kernels {
    /* The nearest hit with 0 < t <= t_max. Among equal t: a triangle of the world first, then the lowest
     * instance, then the lowest triangle id. */
    void (*closest)(const lc_bvh_data *bvh, const float org[3], const float dir[3], float t_max, lc_hit *hit);
    /* Shadow rays: hidden[i] = 1 if a triangle occludes target i, else 0; glass does not. The ray is org + t
     * (target i - org) for t in (LC_SHADOW_EPS, 1 - LC_SHADOW_EPS), or if `far` is set, and targets are
     * directions, org + t target for t > 0. target: arrays of x, y, z. block may be NULL; for occluded
     * targets block[i] is the block of an occluding triangle, or LC_NONE if that belongs to an instance. All
     * instruction sets give the same results. */
    void (*hidden)(const lc_bvh_data *bvh, const float org[3], uint32_t n, const float *const target[3],
                   bool far, uint8_t *hidden, uint32_t *block);
    /* The same. loss[i] is also set: to the sum over the glass that the ray to target i crosses; if that is
     * occluded, to some value. */
    void (*dimmed)(const lc_bvh_data *bvh, const float org[3], uint32_t n, const float *const target[3],
                   bool far, uint8_t *hidden, uint32_t *block, uint64_t (*loss)[3]);
} lc_trace_kernels;

#endif
