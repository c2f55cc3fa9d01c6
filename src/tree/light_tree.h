/* light_tree.h - the finished light tree: one binary tree for each kind of light, flattened.
 *
 * The room tree/ builds it. In go the lights of a scene; a builder decides which clusters are joined
 * (tree_build.h: agglomerate.c exactly, ploc.c fast), and tree_fill.c lays the result out as arrays.
 *
 *     link        the name of a cluster: a node's id, or LC_LEAF | light
 *     nodes       those of one kind in a row, kinds in rising order, in treelets of three levels, depth
 *                 first, so that a descent stays on the same cache lines; parents before children
 *     lights      in the order in which the treelets meet them, kinds in rising order
 *     rep         representatives: slot s of a cluster is slot s of one child, chosen with probability
 *                 I_child / I_cluster from a hash of the cluster, so P(light) = I_light / I_cluster at every
 *                 cluster. A light represents itself
 *     groups      of lights: clusters hold lights of several, each with its share of the intensity
 *
 * Memory: 96 bytes a light; 32 more with attenuation other than 1/d^2; 32 more for a spot; 4 more for each
 * slot where there are several; with groups five more, and 16 for each group of a cluster of several.
 */
#ifndef LC_LIGHT_TREE_H
#define LC_LIGHT_TREE_H

#include "base/arena.h"
#include "shade/light_kind.h"
#include "shade/light_target.h"
#include "shade/tree_data.h"

#define LC_MAX_REPS 32

#define LC_LAST_SHARE 0x80000000u

/* A group of a cluster of several, which are in a row by rising number. */
typedef struct lc_group_share {
    uint32_t group; /* with LC_LAST_SHARE: the cluster's last */
    float part[3];  /* of the cluster's intensity, R G B; those of all groups add up to 1 */
} lc_group_share;

typedef struct lc_light_tree lc_light_tree;
struct lc_light_tree {
    const lc_context *ctx;
    lc_tree_data data;
    /* Slots 0 .. n_reps - 1 of each node, so that neighbouring pixels read the same cache line; NULL where
     * n_reps is 1. */
    uint32_t *reps;
    /* Of each node: 1 where its lights are equal but for their intensities, so that any of them represents
     * all exactly; NULL: there is no such node. */
    uint8_t *alike;
    uint32_t *order; /* of each light its place in what the tree was built from; NULL: not kept */
    uint32_t n_nodes, n_lights, n_reps;
    uint32_t n_of_kind[LC_LIGHT_KINDS];
    uint32_t first_node[LC_LIGHT_KINDS + 1], first_light[LC_LIGHT_KINDS + 1]; /* of each kind */
    uint32_t root[LC_LIGHT_KINDS];           /* link; LC_NONE: no light of that kind */
    uint32_t roots[LC_LIGHT_KINDS], n_roots; /* links with which cuts begin: of each kind that has lights */
    uint8_t *group; /* of each light; NULL: there are no groups. These are read where a cut is summed alone */
    uint32_t *node_group; /* of each node its only group, or LC_MAX_GROUPS + where in `shares` they begin */
    lc_group_share *shares;
    size_t n_shares, cap_shares;
    uint32_t n_groups;
};

typedef struct lc_light_tree_desc {
    const lc_light *lights;
    size_t n_lights;
    const lc_spot_map *spot_maps; /* of spots, or NULL; owned by the caller, and must outlive the tree */
    const lc_profiles *profiles;  /* of luminaires, finished, likewise */
    double diag2;    /* squared diagonal of the scene: c^2 of the metric for lights with a direction */
    uint64_t seed;   /* of representatives */
    uint32_t n_reps; /* 1..LC_MAX_REPS */
    lc_builder builder;
    bool keep_order;   /* the tree has `order` */
    uint32_t n_groups; /* 0: lc_light.group does not matter */
} lc_light_tree_desc;

lc_status lc_light_tree_build(const lc_context *ctx, const lc_light_tree_desc *desc, lc_light_tree **out);
void lc_light_tree_destroy(lc_light_tree *tree);
size_t lc_light_tree_bytes(const lc_light_tree *tree); /* of the arrays */

/* The light that represents a cluster. */
static inline uint32_t lc_rep_of(const lc_light_tree *t, uint32_t link, uint32_t slot)
{
    if (link & LC_LEAF) return link & ~LC_LEAF;
    return t->reps ? t->reps[(size_t)link * t->n_reps + slot] : t->data.nodes[link].rep;
}

/* Bounds of lights that are alike become the least above 0, as their estimate is exact: only a limit of 0
 * splits them. */
static inline void lc_lower_bounds_of_alike(const lc_light_tree *t, const uint32_t *node, uint32_t n,
                                            float *bound)
{
    for (uint32_t i = 0; i < n && t->alike; i++)
        if (t->alike[node[i]] && bound[i] > FLT_MIN) bound[i] = FLT_MIN;
}

/* The kind of the node or light at an index: as many kinds after the first begin at or before it. */
static inline lc_light_kind lc_kind_at(const uint32_t first[LC_LIGHT_KINDS + 1], uint32_t at)
{
    uint32_t kind = 0;
    for (int k = 1; k < LC_LIGHT_KINDS; k++) kind += at >= first[k];
    return (lc_light_kind)kind;
}

static inline lc_light_kind lc_kind_of_node(const lc_light_tree *t, uint32_t id)
{
    return lc_kind_at(t->first_node, id);
}

static inline lc_light_kind lc_kind_of_light(const lc_light_tree *t, uint32_t light)
{
    return lc_kind_at(t->first_light, light);
}

static inline lc_light_kind lc_kind_of_link(const lc_light_tree *t, uint32_t link)
{
    return link & LC_LEAF ? lc_kind_of_light(t, link & ~LC_LEAF) : lc_kind_of_node(t, link);
}

/* A, B, C of a light, or NULL where all are 0, 0, 1. */
static inline const float *lc_light_atten(const lc_tree_data *t, uint32_t light)
{
    return t->light_atten ? t->light_atten[light] : NULL;
}

/* The record of a light or node that only its kind has. */
static inline void *lc_light_own(const lc_tree_data *t, lc_light_kind kind, uint32_t light)
{
    return (char *)t->own[kind].light + (light - t->own[kind].first_light) * lc_light_kinds[kind].own_size;
}
static inline void *lc_node_own(const lc_tree_data *t, lc_light_kind kind, uint32_t node)
{
    return (char *)t->own[kind].node + (node - t->own[kind].first_node) * lc_light_kinds[kind].own_size;
}

/* Checks partition, boxes, cones, sums, links, representatives; NULL when all hold, else what does not. */
const char *lc_light_tree_validate(const lc_light_tree *tree);

/* Where shadow rays from p go, in place of the targets x, y, z that the estimate kernel gave for n lights of
 * one kind: light[0 .. n), or first .. first + n - 1 where that is NULL. Those of far lights stay. */
static inline void lc_shadow_targets(const lc_light_tree *t, lc_light_kind kind, const lc_point *p,
                                     const uint32_t *light, uint32_t first, uint32_t n, float *const to[3])
{
    for (uint32_t i = 0; i < n && lc_is_sized(kind) && !lc_is_far(kind); i++) {
        float target[3];
        lc_ball_target(&t->data.lights[light ? light[i] : first + i], p, target);
        for (int k = 0; k < 3; k++) to[k][i] = target[k];
    }
}

#endif
