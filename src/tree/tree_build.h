/* tree_build.h - what the builders of light trees share: lights of one kind in, the pairs to join out.
 *
 * A builder only decides the shape of the tree. Boxes, cones, sums and representatives are computed from the
 * lights afterwards (tree_fill.c), so a builder may use any precision; its result must not depend on the
 * number of threads or the instruction set.
 */
#ifndef LC_TREE_BUILD_H
#define LC_TREE_BUILD_H

#include "base/arena.h"
#include "shade/light.h"

typedef struct lc_build_input {
    const lc_light *lights;
    const uint32_t *index; /* n scene indices of lights of one kind, rising; NULL: 0 .. n - 1 */
    uint32_t n;
    lc_light_kind kind;
    double c2; /* squared weight of directions in the metric, scene units^2; oriented lights and spots only */
} lc_build_input;

/* Cluster n + i is the union of child[0] < child[1] < n + i; clusters 0 .. n - 1 are the lights. */
typedef struct lc_build_pair {
    uint32_t child[2];
} lc_build_pair;

/* Fill n - 1 pairs, the root last. */
lc_status lc_agglomerate(const lc_context *ctx, const lc_build_input *in, lc_build_pair *pairs);
lc_status lc_ploc(const lc_context *ctx, const lc_build_input *in, lc_build_pair *pairs);

#endif
