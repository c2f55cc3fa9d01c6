/* lobe.h - a glossy lobe as one_transfer gives it, at a point at the origin with the normal +z. */
#ifndef LOBE_H
#define LOBE_H

#include "shade/point_init.h"
#include "support/one_bound.h"
#include "support/vec_d.h"

/* Roughness along x and y, and the direction of the viewer. */
typedef struct look {
    double ax, ay, cos_o, phi_o;
} look;

static inline void lobe_point(lc_point *p, const look *l, const lc_material *m)
{
    double o[3];
    direction_d(l->cos_o, l->phi_o, o);
    lc_point_init(p, lc_f3_make(0, 0, 0), lc_f3_make(0, 0, 1), lc_f3_normalize_d(o[0], o[1], o[2]), m,
                  1e-10f);
}

/* The library's BRDF times cosine for light from direction i, of the green channel. */
static inline double lobe_value(const lc_point *p, const double i[3])
{
    lc_light_rec rec = { .pos = { (float)i[0], (float)i[1], (float)i[2] } };
    return (double)one_transfer(p, LC_LIGHT_DIRECTIONAL, &rec, NULL).y;
}

#endif
