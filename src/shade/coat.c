/* coat.c - see coat.h; the formula is in material.h. */
#include "shade/coat.h"

#include "base/fmath.h"
#include "shade/fresnel.h"

/* Least index for which the terms of the closed form do not cancel. */
#define MIN_INDEX 1.001

/* Least eta - 1 in the fits. */
#define LEAST_MORE 0.001

/* Light that does not count any more. */
#define TINY 1e-30

/* As many terms of a geometric series as count for all: 0.9^64 is 0.001. */
#define MANY_TERMS 64

/* Fraction of diffuse light from outside that a smooth surface transmits: the integral in closed form, or
 * linear in the index where the terms would cancel. */
static double mean_smooth(double m)
{
    const double least = MIN_INDEX;
    if (m < least) return 1 - (1 - mean_smooth(least)) * (m - 1) / (least - 1);
    double a = m * m, b = a - 1, d = a + 1, e = a * a;
    double f = 0.5 + (m - 1) * (3 * m + 1) / (6 * (m + 1) * (m + 1)) +
               a * b * b / (d * d * d) * (lc_ln(m - 1) - lc_ln(m + 1)) -
               2 * m * a * (a + 2 * m - 1) / (d * (e - 1)) +
               8 * e * (e + 1) / (d * (e - 1) * (e - 1)) * lc_ln(m);
    return 1 - f;
}

/* kd (1 + x + x^2 + ...), x = kd inside, of so many terms, 0: of all: reflections back and forth below the
 * coat. */
static float many_times(float kd, float inside, uint32_t terms)
{
    const float x = (kd < 1 ? kd : 1) * inside;
    float sum = 1;
    if (!terms || terms > MANY_TERMS) return kd / (1 - x);
    for (uint32_t i = 1; i < terms; i++) sum = sum * x + 1;
    return kd * sum;
}

/* Factors of Fi and A for a coat of roughness a, as material.h gives them. */
static float rough_inside(double eta, float a)
{
    float more = (float)(1.1 + 1.125 / fmax(eta - 1, LEAST_MORE)), root = sqrtf(a);
    return 1 / (1 + more * (a * root * sqrtf(root)));
}

static float rough_through(float a) { return 1 - 0.1f * a - 0.2f * (a * a); }

static float mean_roughness(const lc_material *m) { return sqrtf(m->roughness[0] * m->roughness[1]); }

float lc_coat_lean(const lc_material *m)
{
    const float a = mean_roughness(m), more = 0.72f / fmaxf(m->eta.x - 1, (float)LEAST_MORE);
    const float b = a / (0.48f + 1.95f * a + (0.5f + more) * (a * a));
    return b * b;
}

/* Of diffuse light from outside what enters a coat whose squared lean is b2. By c' the integral of 2 c T(c')
 * is that of 2 c' T(c') / (1 - b^2) from b to 1: the smooth surface's less a part that three points find. */
static double mean_transmitted(const lc_material *m, float b2)
{
    static const double at[3] = { 0.112701665379258, 0.5, 0.887298334620742 }, weight[3] = { 5, 8, 5 };
    const double b = sqrt((double)b2);
    double steep = 0;
    for (int i = 0; i < 3; i++) {
        const double c = b * at[i];
        steep += b * weight[i] / 18 * 2 * c * (double)(1 - lc_fresnel_dielectric((float)c, m->eta.x));
    }
    return (mean_smooth((double)m->eta.x) - steep) / (1 - (double)b2);
}

lc_f3 lc_coat_below(const lc_material *m)
{
    double eta = (double)m->eta.x;
    float a = mean_roughness(m), smooth = fmaxf((float)(1 - mean_smooth(eta) / (eta * eta)), 0);
    float inside = smooth * rough_inside(eta, a), out = rough_through(a) / (m->eta.x * m->eta.x);
    if (m->coat_depth[0] > 0) {
        const float longer = 1 + 0.7f * a;
        out *= lc_decay(2 * longer * m->coat_depth[0]);
        inside *= lc_decay(longer * m->coat_depth[1]);
    }
    return lc_f3_scale(lc_f3_make(many_times(m->kd.x, inside, m->coat_terms),
                                  many_times(m->kd.y, inside, m->coat_terms),
                                  many_times(m->kd.z, inside, m->coat_terms)),
                       out);
}

lc_f3 lc_coat_albedo(const lc_material *m, float cos_i)
{
    /* cos_i may be negative where a shading normal is bent away. */
    const float c = fminf(fmaxf(cos_i, 0), 1), b2 = lc_coat_lean(m);
    const float in = c > 0 ? 1 - lc_fresnel_dielectric(sqrtf(b2 + (1 - b2) * (c * c)), m->eta.x) : 0;
    return lc_f3_scale(lc_coat_below(m), in * (float)mean_transmitted(m, b2));
}

/* Means over diffuse light, by the midpoint rule over its cosine. Light that has come in at a cosine c goes
 * on at one of sqrt(1 - (1 - c^2) / eta^2); from below none leaves where that would be less than 0. */
void lc_coat_absorb(lc_material *m, double depth)
{
    enum { STEPS = 1024 };
    const double eta = (double)m->eta.x;
    double in = 0, in_left = 0, inside = 0, inside_left = 0;
    for (int i = 0; i < STEPS; i++) {
        const double c = (i + 0.5) / STEPS, below = sqrt(1 - (1 - c * c) / (eta * eta)),
                     out2 = 1 - (1 - c * c) * (eta * eta);
        const double let_in = c * (double)(1 - lc_fresnel_dielectric((float)c, m->eta.x));
        const double cos_out = sqrt(fmax(out2, 0)),
                     kept = out2 > 0 ? (double)lc_fresnel_dielectric((float)cos_out, m->eta.x) : 1;
        in += let_in;
        in_left += let_in * lc_exp_neg(-depth / below);
        inside += c * kept;
        inside_left += c * kept * lc_exp_neg(-2 * depth / c);
    }
    m->coat_depth[0] = (float)fmax(-lc_ln(in_left / in + TINY), 0);
    m->coat_depth[1] = inside > 0 ? (float)fmax(-lc_ln(inside_left / inside + TINY), 0) : 0;
}
