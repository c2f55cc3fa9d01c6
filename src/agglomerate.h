/* agglomerate.h - exact agglomerative clustering of the lights of one kind ([Miksik07] 3, [Walter08]). */
#ifndef LC_AGGLOMERATE_H
#define LC_AGGLOMERATE_H

#include "arena.h"
#include "cluster.h"

/* A cluster while a tree is being built. Clusters 0 .. n - 1 are the lights, n .. 2n - 2 the merges in order. */
typedef struct lc_build_node {
    lc_cluster c;
    double cos_cone;         /* never above that of either child */
    uint32_t child[2];       /* LC_NONE for a light */
    uint32_t light;          /* scene index, of a light */
    uint64_t hash;           /* of the set of lights and how it was merged, for representatives */
} lc_build_node;

/* The size that merging a and b would give: [Miksik07] eq. 3, I (alpha^2 + c2 (1 - cos beta)^2).
 * c2: squared weight of directions, scene units^2. */
double lc_cluster_metric(const lc_build_node *a, const lc_build_node *b, double c2);

/* The parent of a and b, hash and cone included. */
lc_build_node lc_build_node_merge(const lc_build_node *nodes, uint32_t a, uint32_t b);

/* nodes holds n lights and room for 2n - 1; fills the rest. Ties: the previous element of the chain wins, then the
 * first that the search's fixed order meets, so that lights on a grid end too and coincident ones end soon. */
lc_status lc_agglomerate_nodes(const lc_context *ctx, lc_build_node *nodes, uint32_t n, double c2);

#endif
