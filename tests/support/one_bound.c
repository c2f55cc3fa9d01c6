/* one_bound.c - one node at a time, for tests. */
#include "support/one_bound.h"

#include "isa/isa.h"

#include <string.h>

float lc_bound(const lc_node *node, const lc_atten *atten, lc_light_kind kind, const lc_point *point)
{
    const uint32_t index = 0;
    float ub[LC_LANES];
    lc_node n = *node;
    lc_atten a = { 0, 0, 1, 0 };
    if (atten) memcpy(a, *atten, sizeof a);
    const lc_tree_data tree = { .nodes = &n, .node_atten = atten ? &a : NULL };
    lc_kernels_scalar.shade.bounds(&tree, &index, 1, kind, point, ub);
    return ub[0];
}

float lc_bound_spots(const lc_node *node, const lc_spot_rec *spot, const lc_point *point)
{
    const uint32_t index = 0;
    float ub[LC_LANES];
    lc_node n = *node;
    lc_spot_rec s = *spot;
    const lc_tree_data tree = { .nodes = &n, .node_spot = &s };
    lc_kernels_scalar.shade.bounds(&tree, &index, 1, LC_LIGHT_SPOT, point, ub);
    return ub[0];
}
