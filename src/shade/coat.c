/* coat.c - see coat.h; the formula is in material.h. */
#include "shade/coat.h"

#include "base/fmath.h"
#include "shade/fresnel.h"

/* Least index for which the terms of the closed form do not cancel. */
#define MIN_INDEX 1.001

/* Fraction of diffuse light from outside that a smooth surface transmits: the integral in closed form, or
 * linear in the index where the terms would cancel. */
static double mean_transmitted(double m)
{
    const double least = MIN_INDEX;
    if (m < least) return 1 - (1 - mean_transmitted(least)) * (m - 1) / (least - 1);
    double a = m * m, b = a - 1, d = a + 1, e = a * a;
    double f = 0.5 + (m - 1) * (3 * m + 1) / (6 * (m + 1) * (m + 1)) +
               a * b * b / (d * d * d) * (lc_ln(m - 1) - lc_ln(m + 1)) -
               2 * m * a * (a + 2 * m - 1) / (d * (e - 1)) +
               8 * e * (e + 1) / (d * (e - 1) * (e - 1)) * lc_ln(m);
    return 1 - f;
}

/* kd / (1 - kd Fi): the sum over any number of reflections back and forth below the coat. */
static float many_times(float kd, float inside) { return kd / (1 - (kd < 1 ? kd : 1) * inside); }

/* Factors of Fi and A for a coat of roughness a, as material.h gives them. */
static float rough_inside(double eta, float a)
{
    float more = (float)(1.1 + 1.125 / (eta > MIN_INDEX ? eta - 1 : 0.001)), root = sqrtf(a);
    return 1 / (1 + more * (a * root * sqrtf(root)));
}

static float rough_through(float a) { return 1 - 0.42f * a * a * a / (a + 0.5f); }

lc_f3 lc_coat_below(const lc_material *m)
{
    double eta = (double)m->eta.x;
    float a = sqrtf(m->roughness[0] * m->roughness[1]),
          smooth = fmaxf((float)(1 - mean_transmitted(eta) / (eta * eta)), 0);
    float inside = smooth * rough_inside(eta, a), out = rough_through(a) / (m->eta.x * m->eta.x);
    return lc_f3_scale(lc_f3_make(many_times(m->kd.x, inside), many_times(m->kd.y, inside),
                                  many_times(m->kd.z, inside)),
                       out);
}

lc_f3 lc_coat_albedo(const lc_material *m, float cos_i)
{
    /* cos_i may be negative where a shading normal is bent away. */
    float in = 1 - lc_fresnel_dielectric(fminf(fmaxf(cos_i, 0), 1), m->eta.x);
    return lc_f3_scale(lc_coat_below(m), in * (float)mean_transmitted((double)m->eta.x));
}
