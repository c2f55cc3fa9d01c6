/* shade.h - the transfer M G of one light at one shading point: the one function that estimates use and that the
 * bounds of bounds.h dominate. Radiance towards the viewer = transfer * intensity * visibility, per channel. */
#ifndef LC_SHADE_H
#define LC_SHADE_H

#include "layout.h"
#include "material.h"

/* n and view: unit; n is flipped to the viewer's side by the caller. */
void lc_point_init(lc_point *p, lc_f3 pos, lc_f3 n, lc_f3 view, const lc_material *m, float min_d2);

/* M_i G_i, R G B, >= 0 and finite. 0 when light or receiver face away. */
lc_f3 lc_shade_light(const lc_point *p, const lc_light_rec *light);

void lc_light_rec_init(lc_light_rec *rec, const lc_light *light);

#endif
