/* point_init.h - fills in what the kernels read of a shading point and of a light.
 *
 * In the terms of light.h, M G V I, a light contributes transfer M G times visibility V times intensity I,
 * per channel. The estimate kernel gives M G: material and geometry, which do not depend on how strong the
 * light is.
 */
#ifndef LC_POINT_INIT_H
#define LC_POINT_INIT_H

#include "shade/material.h"
#include "shade/tree_data.h"

/* n and view: unit; n is flipped to the viewer's side by the caller. */
void lc_point_init(lc_point *p, lc_f3 pos, lc_f3 n, lc_f3 view, const lc_material *m, float min_d2);

/* Makes the surface reflect so much of what it does. */
void lc_point_scale(lc_point *p, lc_f3 by);

/* Transfer M G of one light by the kernels, R G B, >= 0 and finite; 0 where light or receiver face away. Only
 * for kinds without records of their own. atten: lc_light.atten, all four, or NULL for 0, 0, 1, 0. */
lc_f3 lc_estimate_one(const lc_shade_kernels *kernels, const lc_point *p, lc_light_kind kind,
                      const lc_light_rec *light, const float *atten);

/* Rounds the direction of an oriented light as lc_dir_round does. */
void lc_light_rec_init(lc_light_rec *rec, const lc_light *light);

static inline bool lc_inverse_square(const float atten[3])
{
    return atten[0] + atten[1] <= 0 && !(atten[2] < 1) && !(atten[2] > 1);
}

#endif
