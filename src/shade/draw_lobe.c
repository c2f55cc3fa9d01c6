/* draw_lobe.c - see draw_lobe.h. */
#include "shade/draw_lobe.h"

#include "base/fmath.h"
#include "base/sample_dir.h"

#define TINY 1e-6 /* cosine */

static double power_of(const lc_point *p)
{
    if (p->lobe == LC_LOBE_PHONG) return (double)p->exponent;
    const lc_f3 x = lc_f3_load(p->tangent[0]), y = lc_f3_load(p->tangent[1]);
    /* of half vectors, which turn half as far as directions do */
    return fmax(0.5 * (double)fminf(lc_f3_dot(x, x), lc_f3_dot(y, y)), 1);
}

/* Local vectors are along the tangents, and these are over roughness: hence its squares. */
static lc_f3 draw_facet(const lc_point *p, const double u[2])
{
    const double ax2 = (double)p->square[0], ay2 = (double)p->square[1];
    const lc_f3 o = lc_f3_normalize_d(ax2 * (double)p->view[0], ay2 * (double)p->view[1], (double)p->view[2]),
                across = fabsf(o.x) + fabsf(o.y) > 0 ? lc_f3_normalize_d(-(double)o.y, (double)o.x, 0)
                                                     : lc_f3_make(1, 0, 0),
                up = lc_f3_cross(o, across);
    double x, y;
    lc_sample_disc(u, &x, &y);
    const double half = 0.5 * (1 + (double)o.z);
    y = (1 - half) * sqrt(fmax(1 - x * x, 0)) + half * y;
    const float z = (float)sqrt(fmax(1 - x * x - y * y, 0));
    const lc_f3 h =
        lc_f3_add(lc_f3_add(lc_f3_scale(across, (float)x), lc_f3_scale(up, (float)y)), lc_f3_scale(o, z));
    const lc_f3 on = lc_f3_add(lc_f3_scale(lc_f3_load(p->tangent[0]), p->square[0] * h.x),
                               lc_f3_scale(lc_f3_load(p->tangent[1]), p->square[1] * h.y));
    return lc_f3_normalize(lc_f3_add(on, lc_f3_scale(lc_f3_load(p->n), fmaxf(h.z, 0))));
}

lc_f3 lc_lobe_draw(const lc_point *p, const double u[2])
{
    double x, y;
    if (p->lobe == LC_LOBE_GGX) {
        const lc_f3 o = lc_f3_load(p->to_view), h = draw_facet(p, u);
        return lc_f3_normalize(lc_f3_sub(lc_f3_scale(h, 2 * lc_f3_dot(h, o)), o));
    }
    const double z = lc_exp_neg(lc_ln(1 - u[0]) / (power_of(p) + 1)), r = sqrt(fmax(1 - z * z, 0));
    lc_sincos_deg(360 * u[1], &y, &x);
    return lc_sample_frame(lc_f3_load(p->mirror), r * x, r * y, z);
}

static double ggx_density(const lc_point *p, lc_f3 dir)
{
    const lc_f3 h = lc_f3_normalize(lc_f3_add(dir, lc_f3_load(p->to_view)));
    const double x = (double)lc_f3_dot(h, lc_f3_load(p->tangent[0])),
                 y = (double)lc_f3_dot(h, lc_f3_load(p->tangent[1])),
                 z = (double)lc_f3_dot(h, lc_f3_load(p->n)), bracket = x * x + y * y + z * z;
    if (!(z > 0)) return 0;
    const double facets = 1 / (LC_PI * sqrt((double)p->square[0] * (double)p->square[1]) * bracket * bracket);
    return facets / (2 * ((double)p->view[2] + (double)p->masking));
}

double lc_lobe_density(const lc_point *p, lc_f3 dir)
{
    if (p->lobe == LC_LOBE_GGX) return ggx_density(p, dir);
    const double along = (double)lc_f3_dot(dir, lc_f3_load(p->mirror)), n = power_of(p);
    if (!(along > TINY)) return 0;
    return (n + 1) / (2 * LC_PI) * lc_exp_neg(n * lc_ln(fmin(along, 1)));
}

/* With 1 + 2 Lambda(w) = s(w) / wz: (1 + Lambda(o)) / (1 + Lambda(i) + Lambda(o)). */
float lc_lobe_unmasked(const lc_point *p, lc_f3 dir)
{
    const float x = lc_f3_dot(dir, lc_f3_load(p->tangent[0])) * p->square[0],
                y = lc_f3_dot(dir, lc_f3_load(p->tangent[1])) * p->square[1],
                z = lc_f3_dot(dir, lc_f3_load(p->n));
    const float in = sqrtf(x * x + y * y + z * z) / fmaxf(z, LC_MIN_COS),
                out = p->masking / fmaxf(p->view[2], LC_MIN_COS);
    return (1 + out) / (in + out);
}
