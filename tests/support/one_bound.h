/* one_bound.h - upper bounds of clusters ([Walter05] 4.1, [Miksik07] 2.2; derivations in bounds_tmpl.c).
 *
 * Let L_i(c) = lc_shade_light(point, light i)[c] * intensity_i[c]. For every cluster C stored by
 * lc_cluster_store, bound >= sum over i in C of luminance(L_i), and so >= each of them, in float and in exact
 * arithmetic. It may be +inf, never NaN, never negative.
 */
#ifndef ONE_BOUND_H
#define ONE_BOUND_H

#include "shade/tree_data.h"

/* Bound of one node. atten: least A, B, C of its members, or NULL where all are 0, 0, 1. */
float lc_bound(const lc_node *node, const lc_atten *atten, lc_light_kind kind, const lc_point *point);
/* The same for spots. */
float lc_bound_spots(const lc_node *node, const lc_spot_rec *spot, const lc_point *point);

#endif
