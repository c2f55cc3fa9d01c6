/* bvh_build.h - what the steps of the BVH builder share.
 *
 *     triangles -> refs -> binary tree -> better tree -> plan -> eight-wide nodes and blocks of triangles
 *          bvh_split.c   bvh_build.c   bvh_reinsert.c  bvh_collapse.c
 *
 *     triangles -> keys -> binary tree, blocks of triangles -> plan -> eight-wide nodes
 *          bvh_fast.c                                          bvh_collapse.c
 *
 * Every parallel step is divided by the number of triangles, never by the number of threads, and every piece
 * writes to its own part of the arrays, so the result is the same bytes for any number of threads.
 */
#ifndef LC_BVH_BUILD_H
#define LC_BVH_BUILD_H

#include "base/vec.h"
#include "base/vec4.h"
#include "trace/bvh.h"

/* A reference to a triangle: its box and id. -0 is stored as 0, so that minima do not depend on the order. */
typedef struct lc_bvh_ref {
    float lo[3];
    uint32_t tri;
    float hi[3];
    float one; /* 1: keeps denormals out of the fourth lane of lo + hi */
} lc_bvh_ref;
_Static_assert(sizeof(lc_bvh_ref) == 32, "two f4");

/* A node of the binary tree. Its children are nodes left and left + 1. The pair made by a split before ref
 * `mid` can be stored at 2 mid, as no two splits have the same mid. */
typedef struct lc_bin_node {
    float lo[3];
    uint32_t left; /* in a leaf: the first of its triangles in builder.order; fast: its block */
    float hi[3];
    uint32_t info; /* flags, the number of triangles if at most eight, and the plan of bvh_collapse.c */
} lc_bin_node;
_Static_assert(sizeof(lc_bin_node) == 32, "two f4");
#define LC_BIN_LEAF 0x80000000u
#define LC_BIN_TOP 0x40000000u   /* the range is too large for one thread */
#define LC_BIN_BLOCK 0x20000000u /* not a leaf, but cheaper as a block if it is one child of a wide node */
#define LC_BIN_DIRTY 0x10000000u /* bvh_reinsert.c: must be planned again */
#define LC_BIN_COUNT_SHIFT 24

/* Consecutive refs that become a subtree. */
typedef struct lc_bvh_range {
    f4_box centroids; /* the box of lo + hi over the refs: twice the centroids */
    uint32_t node, first, count, depth;
    uint32_t side;    /* which of the builder's two arrays holds the refs */
} lc_bvh_range;

/* at_most[i]: the least cost of a subtree as at most i + 1 children of an eight-wide node. */
typedef struct lc_bvh_costs {
    float at_most[7];
    uint32_t height; /* levels of binary nodes below this one */
} lc_bvh_costs;
_Static_assert(sizeof(lc_bvh_costs) == sizeof(lc_bvh_ref), "stored in place of a ref");

/* A range of the upper tree: either split into two more, or a subtree that one thread builds. */
typedef struct lc_bvh_head {
    lc_bvh_range range;
    lc_bvh_costs costs;
    uint32_t left;  /* split into heads left and left + 1; 0: a subtree */
    uint32_t block; /* fast: first the number of its leaves, then the block of the first one */
} lc_bvh_head;

typedef struct lc_bvh_builder {
    const lc_context *ctx;
    const float *pos;
    const uint32_t *index;
    size_t n_tris;
    uint32_t task_max;   /* limits the refs of a subtree that one thread builds */
    bool many;           /* so many triangles that every loop over them is worth threads */
    char *memory;        /* of few triangles, all arrays below but heads: one block has few pages to clear */
    size_t taken;        /* bytes of it */
    bool fast;           /* made by bvh_fast.c: no refs, order, parents */
    lc_bvh_ref *refs[2]; /* n_tris each; a split moves a range from one array to the other */
    uint32_t *order;     /* n_tris: triangle ids in the order of the leaves */
    lc_bin_node *nodes;  /* 2 n_tris, of which few are used */
    uint32_t *parents;   /* n_tris: the parent of nodes 2 i and 2 i + 1 */
    lc_bvh_head *heads;  /* parents before their children */
    size_t n_heads, cap_heads;
} lc_bvh_builder;

/* The costs of a node other than the root. They overwrite a ref of its subtree, or the last one before it,
 * which no leaf needs any more. */
static inline lc_bvh_costs *lc_bvh_costs_of(const lc_bvh_builder *b, uint32_t node)
{
    return (lc_bvh_costs *)(void *)&b->refs[node % 2][node / 2 - 1];
}

/* Memory for n elements until the end of the build, or of many triangles until it is given back; NULL on
 * failure. */
void *lc_bvh_take(lc_bvh_builder *b, size_t n, size_t size);
void lc_bvh_give(const lc_bvh_builder *b, void *ptr, size_t n, size_t size);

static inline f4_box lc_bvh_tri_box(const lc_bvh_builder *b, size_t tri)
{
    const f4 p = f4_load3(lc_tri_vertex(b->pos, b->index, tri, 0)),
             q = f4_load3(lc_tri_vertex(b->pos, b->index, tri, 1)),
             r = f4_load3(lc_tri_vertex(b->pos, b->index, tri, 2));
    return (f4_box){ f4_min(f4_min(p, q), r), f4_max(f4_max(p, q), r) };
}

/* ---- bvh_split.c ---- */

#define LC_BVH_BINS 32

typedef struct lc_bvh_bins {
    f4_box box[LC_BVH_BINS][3];
    int32_t count[LC_BVH_BINS][4]; /* by axis */
} lc_bvh_bins;

typedef struct lc_bvh_binning {
    f4 lo, scale; /* the bin of a ref on each axis is (lo + hi of the ref - lo) * scale */
    uint32_t n;   /* bins */
} lc_bvh_binning;

typedef struct lc_bvh_split {
    float cost;                 /* area times blocks, summed over both sides; FLT_MAX: there is no split */
    uint32_t axis, bin, n_left; /* bins below `bin` go left, with n_left refs in all */
    f4_box left, right;
} lc_bvh_split;

/* Makes the refs of triangles first .. first + count - 1; *box and *centroids are the boxes around their
 * boxes and around their lo + hi. */
void lc_bvh_make_refs(const lc_bvh_builder *b, uint32_t first, uint32_t count, f4_box *box,
                      f4_box *centroids);
lc_bvh_binning lc_bvh_binning_of(const lc_bvh_range *range);
void lc_bvh_clear_bins(lc_bvh_bins *bins, uint32_t n);
void lc_bvh_join_bins(lc_bvh_bins *bins, const lc_bvh_bins *others, uint32_t n);
void lc_bvh_add_to_bins(lc_bvh_bins *bins, const lc_bvh_binning *by, const lc_bvh_ref *refs, uint32_t count);
lc_bvh_split lc_bvh_best_split(const lc_bvh_bins *bins, const lc_bvh_binning *by);
/* The number of refs in these bins to the left of a split. */
uint32_t lc_bvh_count_left(const lc_bvh_bins *bins, const lc_bvh_split *split);
/* Copies refs to *left and *right, keeping their order, and advances both pointers past them. */
void lc_bvh_partition(const lc_bvh_binning *by, const lc_bvh_split *split, const lc_bvh_ref *refs,
                      uint32_t count, lc_bvh_ref **left, lc_bvh_ref **right);
f4_box lc_bvh_box_of(const lc_bvh_ref *refs, uint32_t count);
f4_box lc_bvh_centroids_of(const lc_bvh_ref *refs, uint32_t count);

/* ---- bvh_fast.c ---- */

/* Makes and plans the binary tree, and bvh's blocks, which its leaves are. LC_ERR_MEMORY. */
lc_status lc_bvh_fast_tree(lc_bvh_builder *b, lc_bvh *bvh);

/* ---- bvh_reinsert.c ---- */

/* Optimizes the upper tree. All nodes must have their plans, before and after. LC_ERR_MEMORY. */
lc_status lc_bvh_reinsert(lc_bvh_builder *b);

/* ---- bvh_collapse.c ---- */

/* Plans a node from the costs of its children, NULL for a leaf; returns its costs. */
lc_bvh_costs lc_bvh_plan(lc_bin_node *node, const lc_bvh_costs *left, const lc_bvh_costs *right);
/* Fills a block of n triangles, whose ids it holds; returns the box around them. */
f4_box lc_bvh_fill_block(const lc_bvh_builder *b, uint32_t n, lc_tri_block *block);
/* Makes the wide nodes of bvh from the planned binary nodes, and unless it was a fast build its blocks.
 * LC_ERR_MEMORY. */
lc_status lc_bvh_collapse(lc_bvh_builder *b, lc_bvh *bvh);

#endif
