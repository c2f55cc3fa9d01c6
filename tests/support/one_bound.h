/* one_bound.h - upper bounds of clusters ([Walter05] 4.1, [Miksik07] 2.2; derivations in bounds_tmpl.c).
 *
 * Let L_i(c) = one_transfer(point, light i)[c] * intensity_i[c]. For every cluster C stored by
 * lc_cluster_store, bound >= sum over i in C of luminance(L_i), and so >= each of them, in float and in exact
 * arithmetic. It may be +inf, never NaN, never negative.
 */
#ifndef ONE_BOUND_H
#define ONE_BOUND_H

#include "shade/light_spot.h"
#include "shade/tree_data.h"

/* Bound of one node. atten: least A, B, C of its members, or NULL where all are 0, 0, 1. */
float one_bound(const lc_node *node, const lc_atten *atten, lc_light_kind kind, const lc_point *point);
/* The same for spots. */
float one_spot_bound(const lc_node *node, const lc_spot_rec *spot, const lc_point *point);

/* The same for luminaires. */
float one_luminaire_bound(const lc_node *node, const lc_luminaire_rec *own, const lc_profiles *profiles,
                          const lc_point *point);

/* M G of one light, R G B, without visibility. atten: A, B, C, or NULL for 0, 0, 1. */
lc_f3 one_transfer(const lc_point *p, lc_light_kind kind, const lc_light_rec *light, const float *atten);
/* The same of a virtual light. */
lc_f3 one_virtual_transfer(const lc_point *p, const lc_light_rec *light, const float atten[3],
                           const lc_shine *shine);
/* The same of a spot; spot_maps: those of the scene, or NULL. */
lc_f3 one_spot_transfer(const lc_point *p, const lc_light_rec *light, const lc_spot_rec *spot,
                        const lc_spot_map *spot_maps);

/* The same of a luminaire. */
lc_f3 one_luminaire_transfer(const lc_point *p, const lc_light_rec *light, const lc_luminaire_rec *own,
                             const lc_profiles *profiles);

#endif
