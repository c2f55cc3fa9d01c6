/* bvh_build.h - what the parts of the builder share; the way of the data:
 *
 *     triangles -> refs -> binary nodes -> better ones -> plan of eight-wide nodes -> lc_bvh_node[],
 * lc_tri_block[] bvh_split, bvh_build    bvh_reinsert   bvh_collapse
 *
 * Every step that threads share is cut up by the number of triangles, never by that of threads, and every
 * piece has its own place to write to, so the arrays are the same bytes for any number of threads.
 */
#ifndef LC_BVH_BUILD_H
#define LC_BVH_BUILD_H

#include "base/vec4.h"
#include "trace/bvh.h"

/* A triangle's box. -0 is stored as 0, so that minima don't depend on the order. */
typedef struct lc_bvh_ref {
    float lo[3];
    uint32_t tri;
    float hi[3];
    float one; /* keeps denormals out of the fourth lane of lo + hi */
} lc_bvh_ref;
_Static_assert(sizeof(lc_bvh_ref) == 32, "two f4");

/* Children are left and left + 1. The pair made by a split before ref `mid` may stand at 2 mid: no two splits
 * share one. */
typedef struct lc_bin_node {
    float lo[3];
    uint32_t left; /* LC_BIN_LEAF: first of its triangles in builder.order */
    float hi[3];
    uint32_t info; /* flags, count of triangles if at most eight, and the plan, see bvh_collapse.c */
} lc_bin_node;
_Static_assert(sizeof(lc_bin_node) == 32, "two f4");
#define LC_BIN_LEAF 0x80000000u
#define LC_BIN_TOP 0x40000000u   /* a range too large for one thread */
#define LC_BIN_BLOCK 0x20000000u /* with children, but as one child of a wide node it had better be a block */
#define LC_BIN_DIRTY 0x10000000u /* bvh_reinsert.c: to be planned again */
#define LC_BIN_COUNT_SHIFT 24

typedef struct lc_bvh_range {
    f4_box centroids; /* of lo + hi */
    uint32_t node, first, count, depth;
    uint32_t side; /* which of the builder's two arrays of refs it stands in */
} lc_bvh_range;

/* Least cost of a subtree as at most i + 1 children of an eight-wide node. */
typedef struct lc_bvh_costs {
    float at_most[7];
    uint32_t height; /* levels of binary nodes below */
} lc_bvh_costs;
_Static_assert(sizeof(lc_bvh_costs) == sizeof(lc_bvh_ref), "takes its place");

/* A range of the upper tree, and how it went on: the ranges it was split into, or a subtree made by one
 * thread. */
typedef struct lc_bvh_head {
    lc_bvh_range range;
    lc_bvh_costs costs;
    uint32_t left; /* heads left, left + 1; 0: subtree */
} lc_bvh_head;

typedef struct lc_bvh_builder {
    const lc_context *ctx;
    const float *pos;
    const uint32_t *index;
    size_t n_tris;
    uint32_t task_max;   /* refs of a subtree that one thread makes alone */
    lc_bvh_ref *refs[2]; /* a split moves a range from one to the other */
    uint32_t *order;     /* triangle ids in the order of the leaves */
    lc_bin_node *nodes;  /* 2 n_tris places, few of them used */
    uint32_t *parents;   /* of pairs: of nodes 2 i and 2 i + 1 */
    lc_bvh_head *heads;  /* parents before children */
    size_t n_heads, cap_heads;
} lc_bvh_builder;

/* Costs of a node but the root, in place of a ref of its subtree, or the last one left of it: once all leaves
 * are made refs are of no use. */
static inline lc_bvh_costs *lc_bvh_costs_of(const lc_bvh_builder *b, uint32_t node)
{
    return (lc_bvh_costs *)(void *)&b->refs[node % 2][node / 2 - 1];
}

/* ---- bvh_split.c ---- */

#define LC_BVH_BINS 32

typedef struct lc_bvh_bins {
    f4_box box[LC_BVH_BINS][3];
    int32_t count[LC_BVH_BINS][4]; /* by axis */
} lc_bvh_bins;

typedef struct lc_bvh_binning {
    f4 lo, scale; /* of lo + hi */
    uint32_t n;   /* bins */
} lc_bvh_binning;

typedef struct lc_bvh_split {
    float cost; /* blocks times area; FLT_MAX: all centroids are the same */
    uint32_t axis, bin, n_left;
    f4_box left, right;
} lc_bvh_split;

/* Refs of triangles first .. first + count - 1; their boxes' box and that of lo + hi. */
void lc_bvh_make_refs(const lc_bvh_builder *b, uint32_t first, uint32_t count, f4_box *box,
                      f4_box *centroids);
lc_bvh_binning lc_bvh_binning_of(const lc_bvh_range *range);
void lc_bvh_clear_bins(lc_bvh_bins *bins, uint32_t n);
void lc_bvh_join_bins(lc_bvh_bins *bins, const lc_bvh_bins *others, uint32_t n);
void lc_bvh_add_to_bins(lc_bvh_bins *bins, const lc_bvh_binning *by, const lc_bvh_ref *refs, uint32_t count);
lc_bvh_split lc_bvh_best_split(const lc_bvh_bins *bins, const lc_bvh_binning *by);
/* Of the refs in these bins, those left of a split. */
uint32_t lc_bvh_count_left(const lc_bvh_bins *bins, const lc_bvh_split *split);
/* Copies refs to *left and *right in their order and moves both past them. */
void lc_bvh_partition(const lc_bvh_binning *by, const lc_bvh_split *split, const lc_bvh_ref *refs,
                      uint32_t count, lc_bvh_ref **left, lc_bvh_ref **right);
f4_box lc_bvh_box_of(const lc_bvh_ref *refs, uint32_t count);
f4_box lc_bvh_centroids_of(const lc_bvh_ref *refs, uint32_t count);

/* ---- bvh_reinsert.c ---- */

/* All nodes have to be planned, and are after it. */
lc_status lc_bvh_reinsert(lc_bvh_builder *b);

/* ---- bvh_collapse.c ---- */

/* Plans a node whose children cost this; a leaf's are NULL. */
lc_bvh_costs lc_bvh_plan(lc_bin_node *node, const lc_bvh_costs *left, const lc_bvh_costs *right);
/* Nodes and blocks of bvh from the binary nodes, all planned. */
lc_status lc_bvh_collapse(lc_bvh_builder *b, lc_bvh *bvh);

#endif
