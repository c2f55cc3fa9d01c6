/* cluster_kdtree.h - the live clusters of an agglomeration, in a tree that finds the nearest one by the
 * cluster metric.
 *
 *     level 0     clusters in slots, four to a node, in kd order of their centres (directions of oriented
 * lights too) level l     node i's lane k sums up node 4 i + k of level l - 1 top level   one node
 *
 * A lane knows, over its clusters, what makes the union of a query Q with any of them large ([Walter08]'s
 * builder prunes likewise):
 *
 *     min_hi, max_lo     the union reaches over at least max(Q.hi, min_hi) - min(Q.lo, max_lo); a cluster's
 * own hi and lo min_dhi, max_dlo   the same of the box of directions power, max_cos     it is at least as
 * bright as Q + power, and has a cone of at most min(Q.cos, max_cos)
 *
 * A merged cluster takes its left child's slot, the right one's goes empty. The caller renews the tree when
 * half are gone, which sorts again by the centres of what is left.
 *
 * Bytes a light: 64 + 21 for nodes, 8 for cones, 12 for slots and ids, 105 in all; 32 more for sorting at
 * first, and 65 while the tree is renewed with half the clusters left.
 */
#ifndef LC_NEAR_TREE_H
#define LC_NEAR_TREE_H

#include "tree/tree_build.h"

#define LC_NEAR_LEVELS 16 /* 4^16 slots */

typedef struct lc_near_node {
    _Alignas(64) float min_hi[3][4];
    float max_lo[3][4];
    double power[4]; /* least R + G + B; +inf: nothing here */
    float min_dhi[3][4], max_dlo[3][4];
    float max_cos[4];
    float lights[4]; /* 1: single lights only, else 0 */
} lc_near_node;

typedef struct lc_near_tree {
    const lc_context *ctx;
    bool oriented;
    double c2;
    uint32_t n, top;    /* slots; highest level */
    uint32_t n_ids;     /* clusters that there can be: 2 lights - 1 */
    size_t n_nodes;
    lc_near_node *nodes;
    size_t first[LC_NEAR_LEVELS]; /* node 0 of a level */
    uint32_t *id;       /* n: cluster in a slot or LC_NONE */
    double *cos_cone;   /* n: of oriented clusters, never above that of either child */
    uint32_t *slot;     /* n_ids: where a cluster lies, LC_NONE once it is merged */
} lc_near_tree;

typedef struct lc_neighbour {
    uint32_t id;
    double d;
} lc_neighbour;

lc_status lc_near_create(const lc_context *ctx, const lc_build_input *in, lc_near_tree *t);
void lc_near_destroy(lc_near_tree *t);
/* Makes a smaller tree of the n_live clusters that are left. */
lc_status lc_near_renew(lc_near_tree *t, uint32_t n_live);

/* Nearest live cluster of q that is nearer than `best`, which comes in as a candidate or as LC_NONE at +inf.
 * Ties: the candidate, then the lowest id; at distance 0, whichever is found first. No cluster is known to be
 * nearer than `floor`: a long search may end there. */
lc_neighbour lc_near_find(const lc_near_tree *t, uint32_t q, lc_neighbour best, double floor);
/* Metric of the union of two live clusters: [Miksik07] eq. 3, I (alpha^2 + c2 (1 - cos beta)^2). */
double lc_near_distance(const lc_near_tree *t, uint32_t a, uint32_t b);
/* a and b become cluster id. */
void lc_near_merge(lc_near_tree *t, uint32_t a, uint32_t b, uint32_t id);

#endif
