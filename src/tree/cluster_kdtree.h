/* cluster_kdtree.h - the live clusters of an agglomeration, in a tree that finds the nearest one by the
 * cluster metric.
 *
 *     level 0     clusters in slots, four to a node, in kd order of their centres (and of the directions of
 *                 oriented lights)
 *     level l     node i's lane k sums up node 4 i + k of level l - 1
 *     top level   one node
 *
 * A lane knows, over its clusters, lower limits on the union of a query Q with any of them ([Walter08]'s
 * builder prunes likewise):
 *
 *     min_hi, max_lo     the union extends over at least max(Q.hi, min_hi) - min(Q.lo, max_lo); in a slot:
 *                        the cluster's own hi and lo
 *     min_dhi, max_dlo   the same of the box of directions
 *     intensity          the union has at least the intensity of Q plus this
 *     max_cos            the union's cone has a cosine of at most min(Q.cos, max_cos)
 *
 * A merged cluster takes the slot of its left child, and that of the right one becomes empty. The caller
 * renews the tree when half the slots are empty: the live clusters are then sorted again by their centres.
 *
 * Memory: 64 + 21 bytes a light for nodes, 8 for cones, 12 for slots and ids, 105 in all; 32 more for sorting
 * at first, and 65 while the tree is renewed with half the clusters.
 */
#ifndef LC_CLUSTER_KDTREE_H
#define LC_CLUSTER_KDTREE_H

#include "tree/tree_build.h"

#define LC_NEAR_LEVELS 16 /* 4^16 slots */

typedef struct lc_near_node {
    _Alignas(64) float min_hi[3][4];
    float max_lo[3][4];
    double intensity[4]; /* least R + G + B; +inf: empty */
    float min_dhi[3][4], max_dlo[3][4];
    float max_cos[4];
    float lights[4]; /* 1: single lights only, else 0 */
} lc_near_node;

typedef struct lc_near_tree {
    const lc_context *ctx;
    bool oriented;
    double c2;
    uint32_t n, top;    /* slots; highest level */
    uint32_t n_ids;     /* greatest number of clusters: 2 lights - 1 */
    size_t n_nodes;
    lc_near_node *nodes;
    size_t first[LC_NEAR_LEVELS]; /* node 0 of a level */
    uint32_t *id;       /* n: cluster in a slot or LC_NONE */
    double *cos_cone;   /* n: of oriented clusters, never above that of either child */
    uint32_t *slot;     /* n_ids: the slot of a cluster, LC_NONE once it is merged */
} lc_near_tree;

typedef struct lc_neighbour {
    uint32_t id;
    double d;
} lc_neighbour;

lc_status lc_near_create(const lc_context *ctx, const lc_build_input *in, lc_near_tree *t);
void lc_near_destroy(lc_near_tree *t);
/* Makes a smaller tree of the n_live live clusters. */
lc_status lc_near_renew(lc_near_tree *t, uint32_t n_live);

/* The live cluster nearest to q, or `best` if none is nearer; best is a candidate, or LC_NONE at +inf. Ties:
 * the candidate, then the lowest id; at distance 0, the one found first. The caller knows that no cluster is
 * nearer than `floor`: a long search may end with one at that distance. */
lc_neighbour lc_near_find(const lc_near_tree *t, uint32_t q, lc_neighbour best, double floor);
/* Metric of the union of two live clusters: [Miksik07] eq. 3, I (alpha^2 + c2 (1 - cos beta)^2). */
double lc_near_distance(const lc_near_tree *t, uint32_t a, uint32_t b);
/* a and b become cluster id. */
void lc_near_merge(lc_near_tree *t, uint32_t a, uint32_t b, uint32_t id);

#endif
