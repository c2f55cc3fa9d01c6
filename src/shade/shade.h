/* shade.h - the transfer M G of one light at one shading point: the one function that estimates use and that
 * the bounds of one_bound.h dominate. Radiance towards the viewer = transfer * intensity * visibility, per
 * channel. */
#ifndef LC_SHADE_H
#define LC_SHADE_H

#include "shade/material.h"
#include "shade/tree_data.h"

/* n and view: unit; n is flipped to the viewer's side by the caller. */
void lc_point_init(lc_point *p, lc_f3 pos, lc_f3 n, lc_f3 view, const lc_material *m, float min_d2);

/* M_i G_i, R G B, >= 0 and finite. 0 when light or receiver face away. atten: A, B, C, or NULL for 0, 0, 1.
 */
/* Of all kinds but spots. */
lc_f3 lc_shade_light(const lc_point *p, lc_light_kind kind, const lc_light_rec *light, const float *atten);

/* The same of a spot; spot_maps: those of the scene. */
lc_f3 lc_shade_spot(const lc_point *p, const lc_light_rec *light, const lc_spot_rec *spot,
                    const lc_spot_map *spot_maps);

/* Rounds the direction of an oriented light as lc_dir_round does. */
void lc_light_rec_init(lc_light_rec *rec, const lc_light *light);

static inline bool lc_inverse_square(const float atten[3])
{
    return atten[0] + atten[1] <= 0 && !(atten[2] < 1) && !(atten[2] > 1);
}

#endif
