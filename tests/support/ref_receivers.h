/* ref_receivers.h - references in double precision of receivers and lobes that are a formula of few cosines.
 */
#ifndef REF_RECEIVERS_H
#define REF_RECEIVERS_H

#include "shade/light.h"
#include "shade/light_target.h"
#include "shade/point_init.h"

#include <math.h>

static inline double ref_clamp(double a, double lo, double hi) { return fmin(fmax(a, lo), hi); }

/* [Oren94]: max(0, cos of the azimuth between) times the sine of the greater angle and the tangent of the
 * lesser one; i_t: component of i along the viewer's part across n. */
static inline double oren_nayar(const lc_point *p, double i_t, double cos_i)
{
    double angle_i = acos(ref_clamp(cos_i, 0, 1)), angle_o = asin(ref_clamp((double)p->view[0], 0, 1));
    double cos_phi = sin(angle_i) > 0 ? ref_clamp(i_t / sin(angle_i), 0, 1) : 0;
    return cos_phi * sin(fmax(angle_i, angle_o)) * tan(fmin(angle_i, angle_o));
}

/* A sphere, or a cylinder's side, over the cosine by which `combine` multiplies. */
static inline double round_lobe(const lc_point *p, double sin_r, double cos_r)
{
    return (p->exponent > 0 ? sin_r : 1) / fmax(cos_r, (double)LC_MIN_COS / 2);
}

/* Diffuse part, of which a coat lets in `coat`, and lobe, times the receiver cosine times G ([Miksik07] eq.
 * 6). cos^0 = 1. */
static inline double combine(const lc_point *p, int c, double cos_r, double coat, double lobe, double cos_e,
                             double inv_f)
{
    double rho = (double)p->diffuse[c] * coat + lobe;
    return rho * fmax(cos_r, 0) * fmax(cos_e, 0) * inv_f;
}

/* [Henyey41], beside (1 - g^2) / (4 pi): 1 + g^2 + 2 g c to the power -3/2. */
static inline double phase(const lc_point *p, double c)
{
    const double x = 1 + c * (p->view[2] < 0 ? -1 : 1);
    return pow((double)p->view[0] + (double)p->view[1] * fmax(x, 0), -1.5);
}

/* From the point to a light; far: the direction from which it is lit. */
static inline void ref_towards(const lc_point *p, const lc_light *l, double v[3])
{
    const float *dir = &l->dir.x, *pos = &l->pos.x;
    float to[3] = { -dir[0], -dir[1], -dir[2] };
    if (lc_is_far(l->kind) && lc_is_sized(l->kind)) {
        lc_light_rec rec;
        lc_light_rec_init(&rec, l);
        lc_sky_target(&rec, p, to);
    }
    for (int k = 0; k < 3; k++)
        v[k] = lc_is_far(l->kind) ? (double)to[k] : (double)pos[k] - (double)p->pos[k];
}

/* How far from the middle of a light of the sky its directions may be, rounding included. */
static inline double ref_sky_half(const lc_light *l)
{
    return lc_is_far(l->kind) && lc_is_sized(l->kind) ? (double)l->radius + 0x1p-20 : 0;
}

/* Whether a light is not at the point, where it has no direction and the estimate is 0. */
static inline bool ref_apart(const lc_point *p, const lc_light *l)
{
    const double x = (double)l->pos.x - (double)p->pos[0], y = (double)l->pos.y - (double)p->pos[1],
                 z = (double)l->pos.z - (double)p->pos[2];
    return lc_is_far(l->kind) || x * x + y * y + z * z > 1.001 * (double)LC_TINY_D2;
}

/* rest: emission over the squared distance. */
static inline void ref_phase_transfer(const lc_point *p, double c, double rest, double mg[3])
{
    for (int k = 0; k < 3; k++) mg[k] = (double)p->specular[k] * phase(p, c) * fmax(rest, 0);
}

/* Where the cosine is off by `er` and the emission in a range. The rest is relative: of D three roundings, of
 * which the power makes 5 U, and 10 U for distance and products. */
static inline void ref_phase_range(const lc_point *p, double c, double er, const double emission[2],
                                   double inv_f, double lo[3], double hi[3])
{
    const double u = 0x1p-24, way = p->view[2] < 0 ? -1 : 1;
    for (int k = 0; k < 3; k++) {
        const double spec = (double)p->specular[k], tiny = 0x1p-147 * (spec + inv_f + 1);
        lo[k] = spec * phase(p, c + way * (er + 2 * u)) * fmax(emission[0], 0) * inv_f * (1 - 20 * u) - tiny;
        hi[k] = spec * phase(p, c - way * (er + 2 * u)) * fmax(emission[1], 0) * inv_f * (1 + 20 * u) + tiny;
        if (emission[0] <= (double)LC_MIN_COS || inv_f < 0x1p-127) lo[k] = 0;
        if (lo[k] < (double)LC_MIN_TRANSFER * (1 + 1e-6)) lo[k] = 0;
        lo[k] = fmin(lo[k], (double)LC_MAX_TRANSFER * (1 - 1e-6));
    }
}

#endif
