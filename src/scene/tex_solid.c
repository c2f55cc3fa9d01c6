/* tex_solid.c - solid patterns: sums of noise, marble, wood. */
#include "scene/texture.h"

#include "base/xform.h"
#include "scene/noise.h"

#include <math.h>

static double clamp01(double v) { return fmin(fmax(v, 0), 1); }

static double smooth(double t) { return t * t * (3 - 2 * t); }

static double windy(const double p[3], double width)
{
    double slow[3] = { 0.1 * p[0], 0.1 * p[1], 0.1 * p[2] };
    return fabs(lc_fbm(slow, 0.1 * width, 0.5, 3)) * lc_fbm(p, width, 0.5, 6);
}

/* pbrt's marble: nine colours as control points of six overlapping cubic Bezier segments, times 1.5. */
static void marble(const lc_texture *t, const double p[3], double width, double out[3])
{
    static const double colours[9][3] = { { .58, .58, .6 }, { .58, .58, .6 },  { .58, .58, .6 },
                                          { .5, .5, .5 },   { .6, .59, .58 },  { .58, .58, .6 },
                                          { .58, .58, .6 }, { .2, .2, .33 },   { .58, .58, .6 } };
    double q[3] = { t->scale * p[0], t->scale * p[1], t->scale * p[2] }, sine, cosine;
    double phase = q[1] + t->variation * lc_fbm(q, fabs(t->scale) * width, t->roughness, t->octaves);
    if (!(fabs(phase) < 1e15)) phase = 0; /* too large for its sine to mean anything */
    lc_sincos_deg(phase * (180 / LC_PI), &sine, &cosine);
    double at = clamp01(0.5 + 0.5 * sine) * 6, first = fmin(floor(at), 5);
    double f = at - first, g = 1 - f;
    const double(*c)[3] = colours + (size_t)first;
    for (int k = 0; k < 3; k++)
        out[k] = 1.5 * (g * g * g * c[0][k] + 3 * f * g * g * c[1][k] + 3 * f * f * g * c[2][k] +
                        f * f * f * c[3][k]);
}

/* The fraction of late wood: rings about the z axis, distorted by noise stretched tenfold along it. The
 * fraction rises over four fifths of a ring and falls over the last fifth. Rings narrower than a pixel blur
 * into their mean, 1/2. */
static double wood(const lc_texture *t, const double p[3], double width)
{
    double q[3] = { p[0], p[1], 0.1 * p[2] };
    double r = sqrt(p[0] * p[0] + p[1] * p[1]) + t->variation * lc_fbm(q, width, t->roughness, t->octaves);
    double ring = t->scale * r, f = ring - floor(ring), seen = clamp01(1.5 - fabs(t->scale) * width);
    double share = f < 0.8 ? smooth(f / 0.8) : smooth((1 - f) / 0.2);
    return 0.5 + (share - 0.5) * seen;
}

void lc_tex_solid(const lc_texture *t, const double p[3], double width, double *weight, double out[3])
{
    double v = 0;
    *weight = 0;
    switch (t->kind) {
    case LC_TEX_FBM: v = lc_fbm(p, width, t->roughness, t->octaves); break;
    case LC_TEX_WRINKLED: v = lc_turbulence(p, width, t->roughness, t->octaves); break;
    case LC_TEX_WINDY: v = windy(p, width); break;
    case LC_TEX_WOOD: *weight = wood(t, p, width); break;
    default: marble(t, p, width, out); return;
    }
    out[0] = out[1] = out[2] = v;
}
