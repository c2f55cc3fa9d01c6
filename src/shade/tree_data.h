/* tree_data.h - a light tree as the kernels read it, and the table of the kernels over it; sizes asserted.
 *
 * A cluster is a cache line, a light half of one, each in rows of four words, so that kernels load a row of
 * as many clusters or lights as they have lanes and transpose it. Lights are the leaves: there is no node for
 * them. 96 bytes a light, if it falls off as 1/d^2; other attenuation lies in arrays of its own. (Blocks of
 * 16 lanes, a cache line a field, lost: a split touched 14 lines for two nodes. Pairs of siblings with nodes
 * for the leaves too were as fast, at 209 bytes a light.)
 */
#ifndef LC_TREE_DATA_H
#define LC_TREE_DATA_H

#include "shade/light_spot.h"
#include "shade/point.h"

/* A cluster of at least two lights. Its box is of positions (directional: of unit directions towards the
 * light) as centre and half extent: every member p has |p_k - center_k| <= half_k in exact arithmetic. A
 * child is a node, or LC_LEAF | light. */
typedef struct lc_node {
    float center[3];   /* world space */
    float cos_cone; /* oriented, spot: cosine of the cone's half angle, rounded down; -1 = all directions */
    float half[3];     /* >= 0, rounded up */
    uint32_t left;     /* child */
    float power[3];    /* summed intensity R G B, rounded up; also what the estimate uses */
    uint32_t right;    /* child */
    float axis[3];     /* oriented, spot: unit axis of the cone that holds every emission direction */
    uint32_t rep; /* of slot 0: the light that represents it, which represents one of its children, too */
} lc_node;
_Static_assert(sizeof(lc_node) == 64, "a cache line");

#define LC_LEAF 0x80000000u

/* One light as the estimate reads it. Where the kind's place in the tree is needed it follows from the index.
 */
typedef struct lc_light_rec {
    float pos[3];       /* directional: unit direction towards the light */
    uint32_t dir_a;     /* oriented, spot: the way light travels, see dir_pack.h */
    float intensity[3];
    uint32_t dir_b;
} lc_light_rec;
_Static_assert(sizeof(lc_light_rec) == 32, "half a cache line");

#define LC_DIR_FLAG 0x40000000u
#define LC_DIR_SIGN 1u

/* A, B, C of f(d), and a word unused: of a light, or the least ones of a cluster. */
typedef float lc_atten[4];

/* Records that a kind of light has of its own (LC_LIGHT_OWN), one for each of its nodes and lights; NULL:
 * none. */
typedef struct lc_own {
    void *node, *light;
    uint32_t first_node, first_light; /* of the kind */
} lc_own;

/* What the kernels read of a light tree. Attenuation arrays are NULL where all are 0, 0, 1: inverse square.
 */
typedef struct lc_tree_data {
    lc_node *nodes;
    lc_light_rec *lights;
    lc_atten *node_atten, *light_atten;
    lc_own own[LC_LIGHT_KINDS];
    const lc_spot_map *spot_maps;
} lc_tree_data;

/* Kernels over lights and clusters, of one instruction set. */
typedef struct lc_shade_kernels {
    /* Bounds of nodes index[0 .. n), all of one kind, to ub: no less than the luminance of what their lights
     * contribute together. */
    void (*bounds)(const lc_tree_data *tree, const uint32_t *index, uint32_t n, lc_light_kind kind,
                   const lc_point *point, float *ub);
    /* Transfers of lights index[0 .. n), or first .. first + n - 1 where index is NULL, all of one kind, as
     * lc_shade_light gives them: R G B to out[0 .. 2], the target of the shadow ray (position, or direction
     * towards the light) to out[3 .. 5]. */
    void (*estimate)(const lc_tree_data *tree, uint32_t first, const uint32_t *index, uint32_t n,
                     lc_light_kind kind, const lc_point *point, float *const out[6]);
} lc_shade_kernels;

#endif
