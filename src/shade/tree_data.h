/* tree_data.h - a light tree as the kernels read it, and the table of the kernels over it.
 *
 *     lc_node        64 bytes, a cache line    center cos_cone | half left | intensity right | axis rep
 *     lc_light_rec   32 bytes, half of one     pos dir_a | intensity dir_b
 *
 * Both are rows of four words: kernels load one row of as many clusters or lights as they have lanes, and
 * transpose it. The lights are the leaves, so there is no node for a leaf. A light takes 96 bytes, its share
 * of the nodes included, if it falls off as 1/d^2; coefficients of other attenuation are in arrays of their
 * own. Measured: tests/results/layout.md.
 */
#ifndef LC_TREE_DATA_H
#define LC_TREE_DATA_H

#include "shade/light_luminaire.h"
#include "shade/light_spot.h"
#include "shade/point.h"

/* A cluster of at least two lights. Its box holds the lights' positions (directional lights, sky: the unit
 * directions towards them), as centre and half extent: every member p has |p_k - center_k| <= half_k in exact
 * arithmetic. */
typedef struct lc_node {
    float center[3];   /* world space */
    float cos_cone;    /* oriented, spot: cosine of the cone's half angle, rounded down; -1: all directions */
    float half[3];     /* >= 0, rounded up */
    uint32_t left;     /* child: a node, or LC_LEAF | light */
    float intensity[3]; /* sum over the lights, R G B, rounded up; the estimate is the transfer times this */
    uint32_t right;    /* child */
    float axis[3];     /* oriented, spot: unit axis of the cone that holds every emission direction */
    uint32_t rep;      /* representative of slot 0: a light, which also represents one of the children */
} lc_node;
_Static_assert(sizeof(lc_node) == 64, "a cache line");

#define LC_LEAF 0x80000000u

/* One light as the estimate reads it. */
typedef struct lc_light_rec {
    float pos[3];       /* directional, sky: unit direction towards the light */
    uint32_t dir_a;     /* oriented, spot: the way light travels, see dir_pack.h; ball, sky: radius, a float,
                           and in dir_b a random word, of the sky its turn */
    float intensity[3];
    uint32_t dir_b;
} lc_light_rec;
_Static_assert(sizeof(lc_light_rec) == 32, "half a cache line");

#define LC_DIR_FLAG 0x40000000u
#define LC_DIR_SIGN 1u

/* A, B, C of f(d): those of a light, and 0; or the least ones of a cluster's lights, and a factor such that
 * f(d) by the least ones is no less than it times f(d) by any light's. */
typedef float lc_atten[4];

/* Records that only one kind of light has (LC_LIGHT_OWN), one for each of its nodes and lights; NULL: none.
 */
typedef struct lc_own {
    void *node, *light;
    uint32_t first_node, first_light; /* of the kind */
} lc_own;

/* What the kernels read of a light tree. The attenuation arrays are NULL where every light has A, B, C of
 * 0, 0, 1, which is 1/d^2. */
typedef struct lc_tree_data {
    lc_node *nodes;
    lc_light_rec *lights;
    lc_atten *node_atten, *light_atten;
    lc_shine *light_shine; /* of all lights; NULL: no virtual light stands for a lobe */
    lc_own own[LC_LIGHT_KINDS];
    const lc_spot_map *spot_maps;
    const lc_profiles *profiles;
} lc_tree_data;

/* Kernels over lights and clusters, of one instruction set. */
typedef struct lc_shade_kernels {
    /* Writes a bound of each of the nodes index[0 .. n), all of one kind, to ub: no less than the luminance
     * of the estimates of all its lights together. */
    void (*bounds)(const lc_tree_data *tree, const uint32_t *index, uint32_t n, lc_light_kind kind,
                   const lc_point *point, float *ub);
    /* The same from below, to lb: no more than the luminance of the estimates of all its lights together. It
     * is finite; 0 for spots and luminaires. */
    void (*lower_bounds)(const lc_tree_data *tree, const uint32_t *index, uint32_t n, lc_light_kind kind,
                         const lc_point *point, float *lb);
    /* Writes the transfers M G (light.h) of lights index[0 .. n), or first .. first + n - 1 where index is
     * NULL, all of one kind: R G B to out[0 .. 2], the target of the shadow ray (position, or direction
     * towards the light) to out[3 .. 5]. */
    void (*estimate)(const lc_tree_data *tree, uint32_t first, const uint32_t *index, uint32_t n,
                     lc_light_kind kind, const lc_point *point, float *const out[6]);
} lc_shade_kernels;

#endif
