/* light_tree.h - the finished tree: one per kind of light, joined by virtual nodes under one root, flattened.
 *
 *     node id = block * 2 + lane; siblings are ids 2k, 2k + 1 ("pair k"); pair 0 holds the root and an empty lane.
 *     link[id]    child pair's first id, or LC_LEAF | light index
 *     pair_kind   what the two nodes of a pair are; LC_PAIR_MIXED below a virtual node, where each lane has its own
 *     rep         n_reps light indices a node: slot s of a parent is slot s of one child, chosen with probability
 *                 I_child / I_parent from a hash of the node, so P(light) = I_light / I_node at every node
 *
 * Lights lie in the order of the leaves. Pairs lie in treelets of three levels, so a descent stays on the same cache lines.
 */
#ifndef LC_LIGHT_TREE_H
#define LC_LIGHT_TREE_H

#include "arena.h"
#include "layout.h"

#define LC_LEAF 0x80000000u
#define LC_PAIR_MIXED 3
#define LC_MAX_REPS 32

typedef struct lc_light_tree lc_light_tree;
struct lc_light_tree {
    const lc_context *ctx;
    lc_node_block *blocks;
    uint32_t *link;
    uint8_t *pair_kind;
    uint32_t *rep;
    lc_light_rec *lights;
    size_t n_blocks, n_pairs; /* link and rep have 2 n_pairs nodes */
    uint32_t n_lights, n_reps;
    uint32_t n_of_kind[LC_LIGHT_KINDS];
};

typedef struct lc_light_tree_desc {
    const lc_light *lights;
    size_t n_lights;
    double diag2;    /* squared diagonal of the scene: c^2 of the metric for oriented lights */
    uint64_t seed;   /* of representatives */
    uint32_t n_reps; /* 1..LC_MAX_REPS */
} lc_light_tree_desc;

lc_status lc_light_tree_build(const lc_context *ctx, const lc_light_tree_desc *desc, lc_light_tree **out);
void lc_light_tree_destroy(lc_light_tree *tree);
size_t lc_light_tree_bytes(const lc_light_tree *tree);

static inline bool lc_node_is_leaf(const lc_light_tree *t, uint32_t id) { return (t->link[id] & LC_LEAF) != 0; }

/* A node that joins trees of different kinds: nothing bounds it but the sum of its children. */
static inline bool lc_node_is_virtual(const lc_light_tree *t, uint32_t id)
{
    return !lc_node_is_leaf(t, id) && t->pair_kind[t->link[id] / 2] == LC_PAIR_MIXED;
}

/* Checks partition, boxes, cones, sums, links, representatives; NULL when all hold, else what does not. */
const char *lc_light_tree_validate(const lc_light_tree *tree);

#endif
