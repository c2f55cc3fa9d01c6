/* bounds.h - upper bounds of clusters ([Walter05] 4.1, [Miksik07] 2.2; derivations in bounds.c).
 *
 * Let L_i(c) = lc_shade_light(point, light i)[c] * intensity_i[c]. For every cluster C stored by lc_cluster_store,
 * bound >= sum over i in C of luminance(L_i), and so >= each of them, in float and in exact arithmetic. It may be
 * +inf, never NaN, never negative.
 */
#ifndef LC_BOUNDS_H
#define LC_BOUNDS_H

#include "layout.h"

/* Bounds of lanes first .. first + n - 1 of a block, all of one kind, to ub[first ..]. */
void lc_bounds_block(const lc_node_block *block, uint32_t first, uint32_t n, lc_light_kind kind, const lc_point *point,
                     float ub[LC_BLOCK]);

#endif
