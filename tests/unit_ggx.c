/* unit_ggx.c - GGX's lobe as one_transfer gives it: against the formulas of [Walter07] and [Heitz14] in
 * doubles, by the integral of its distribution, its albedo and its reciprocity; reflectances against known
 * values and Fresnel's equations; coats against their formula and a random walk between the two surfaces. */
#include "shade/coat.h"
#include "support/lobe.h"
#include "support/ref_bounds.h"
#include "support/rnd.h"
#include "support/test.h"

#define N_U 256 /* steps of the integral over half vectors, by each of two numbers */
#define N_V 128

/* Reflects all light: Schlick's reflectance is 1. */
static lc_material white(const look *l)
{
    return (lc_material){ .ks = { 1, 1, 1 },
                          .lobe = LC_LOBE_GGX,
                          .roughness = { (float)l->ax, (float)l->ay },
                          .tangent = { 1, 0, 0 } };
}

/* D of [Walter07]. */
static double distribution(const look *l, const double h[3])
{
    double e = pow(h[0] / l->ax, 2) + pow(h[1] / l->ay, 2) + h[2] * h[2];
    return 1 / (LC_PI * l->ax * l->ay * e * e);
}

/* Lambda of [Heitz14], by which G = 1 / (1 + Lambda(i) + Lambda(o)). */
static double lambda(const look *l, const double w[3])
{
    double tan2 = (pow(l->ax * w[0], 2) + pow(l->ay * w[1], 2)) / (w[2] * w[2]);
    return (sqrt(1 + tan2) - 1) / 2;
}

/* A half vector of density D cos, for step a, b of a midpoint rule over two numbers. */
static void half_vector(const look *l, int a, int b, double h[3])
{
    double u = (a + 0.5) / N_U, v = 2 * LC_PI * (b + 0.5) / N_V;
    double phi = atan2(l->ay * sin(v), l->ax * cos(v)), c = cos(phi) / l->ax, s = sin(phi) / l->ay;
    direction_d(1 / sqrt(1 + u / (1 - u) / (c * c + s * s)), phi, h);
}

/* Integral of f cos over the hemisphere of light directions i = 2 (o.h) h - o. */
static double reflected(const look *l, const lc_material *m)
{
    lc_point p;
    double o[3], sum = 0;
    lobe_point(&p, l, m);
    direction_d(l->cos_o, l->phi_o, o);
    for (int a = 0; a < N_U; a++)
        for (int b = 0; b < N_V; b++) {
            double h[3], i[3];
            half_vector(l, a, b, h);
            double oh = dot_d(o, h);
            for (int k = 0; k < 3; k++) i[k] = 2 * oh * h[k] - o[k];
            if (oh > 0 && i[2] > 0) sum += lobe_value(&p, i) * 4 * oh / (distribution(l, h) * h[2]);
        }
    return sum / N_U / N_V;
}

/* The library's D, from f = F D G / (4 ci co) with light and viewer both in direction h. */
static double library_distribution(const look *l, const double h[3])
{
    look at = { l->ax, l->ay, h[2], atan2(h[1], h[0]) }; /* i = o = h */
    lc_material m = white(l);
    lc_point p;
    lobe_point(&p, &at, &m);
    return lobe_value(&p, h) * 4 * h[2] * (1 + 2 * lambda(l, h));
}

/* The integral of D cos over the hemisphere is 1. */
TEST(distribution_is_one)
{
    static const double rough[] = { 0.01, 0.05, 0.2, 0.5, 1 };
    double worst = 0;
    for (int x = 0; x < 5; x++)
        for (int y = 0; y < 5; y++) {
            look l = { rough[x], rough[y], 1, 0 };
            double sum = 0;
            for (int a = 0; a < N_U; a++)
                for (int b = 0; b < N_V; b++) {
                    double h[3];
                    half_vector(&l, a, b, h);
                    sum += library_distribution(&l, h) / distribution(&l, h);
                }
            double off = fabs(sum / N_U / N_V - 1);
            CHECKF(off <= 0.005, "roughness %g %g: %g", l.ax, l.ay, off);
            worst = fmax(worst, off);
        }
    printf("  off by at most %.2g\n", worst);
}

/* The lobe against the product of the formulas, in all directions. */
TEST(textbook)
{
    static const double rough[] = { 0.05, 0.3, 1 }, cosines[] = { 0.02, 0.2, 0.5, 0.8, 1 };
    double worst = 0;
    for (int x = 0; x < 9; x++)
        for (int y = 0; y < 25; y++)
            for (double phi = 0; phi < 6; phi += 0.7) {
                look l = { rough[x % 3], rough[x / 3], cosines[y % 5], 0.4 };
                double o[3], i[3], h[3], len;
                lc_material m = white(&l);
                lc_point p;
                lobe_point(&p, &l, &m);
                direction_d(l.cos_o, l.phi_o, o);
                direction_d(cosines[y / 5], phi, i);
                for (int k = 0; k < 3; k++) h[k] = o[k] + i[k];
                len = sqrt(dot_d(h, h));
                for (int k = 0; k < 3; k++) h[k] /= len;
                double want = distribution(&l, h) / (1 + lambda(&l, i) + lambda(&l, o)) / (4 * o[2]),
                       got = lobe_value(&p, i);
                worst = fmax(worst, fabs(got / want - 1));
                CHECKF(fabs(got / want - 1) <= 2e-4, "roughness %g %g: %g, not %g", l.ax, l.ay, got, want);
            }
    printf("  off by at most %.2g\n", worst);
}

/* A surface of reflectance 1 reflects at most the incoming light, and all of it where it is smooth. */
TEST(furnace)
{
    static const double rough[] = { 0.01, 0.05, 0.3, 0.6, 1 },
                        cosines[] = { 1, 0.7, 0.3, 0.1, 0.03, 0.01, 1e-3 };
    double most = 0, least = 1;
    for (int x = 0; x < 5; x++)
        for (int y = 0; y < 5; y++)
            for (int k = 0; k < 7; k++) {
                look l = { rough[x], rough[y], cosines[k], 0.8 };
                lc_material m = white(&l);
                double r = reflected(&l, &m);
                most = fmax(most, r);
                least = fmin(least, r);
                if (x == 0 && y == 0 && k < 3) CHECKF(fabs(r - 1) <= 0.005, "cosine %g: %.6f", l.cos_o, r);
            }
    printf("  %.4f to %.4f\n", least, most);
    CHECKF(most <= 1.002, "%.6f", most);
    look l = { 1, 1, 1, 0 };
    lc_material m = white(&l);
    /* Here D is 1 / pi and G is 2 c / (1 + c). */
    CHECKF(fabs(reflected(&l, &m) - (1 - log(2))) <= 1e-3, "%g", reflected(&l, &m));
}

static lc_material any_material(int fresnel, bool coat)
{
    lc_material m = {
        .kd = { 0.7f, 0.7f, 0.7f }, .ks = { 0.4f, 0.4f, 0.4f }, .lobe = LC_LOBE_GGX, .tangent = { 1, 0, 0 }
    };
    m.roughness[0] = 0.3f;
    m.roughness[1] = 0.6f;
    m.fresnel = (lc_fresnel)fresnel;
    m.coat = coat;
    m.eta = fresnel == LC_FRESNEL_CONDUCTOR ? lc_f3_make(1.5f, 0.4f, 1) : lc_f3_make(1.5f, 0, 0);
    m.k = lc_f3_make(0, 2.4f, 2);
    return m;
}

/* f(i, o) = f(o, i), coat included. */
TEST(reciprocal)
{
    static const double cosines[] = { 1, 0.6, 0.2, 0.05, 0.01 };
    for (int x = 0; x < 5; x++)
        for (int y = 0; y < 5; y++)
            for (int kind = 0; kind < 8; kind++) {
                look l = { 0.3, 0.6, cosines[x], kind }, back = { 0.3, 0.6, cosines[y], 1 };
                lc_material m = any_material(kind % 4, kind > 3);
                lc_point p, q;
                double i[3], o[3];
                lobe_point(&p, &l, &m);
                lobe_point(&q, &back, &m);
                direction_d(l.cos_o, l.phi_o, o);
                direction_d(back.cos_o, back.phi_o, i);
                double a = lobe_value(&p, i) / i[2], b = lobe_value(&q, o) / o[2];
                CHECKF(fabs(a - b) <= 1e-4 * (a + b), "%d: %g %g", kind, a, b);
            }
}

/* Reflectance at cosine c between light and normal: the lobe in the mirror direction, divided by that of a
 * surface of reflectance 1. */
static double reflectance(lc_material m, double c)
{
    look l = { 0.3, 0.3, c, 0 };
    const double i[3] = { -sqrt(1 - c * c), 0, c };
    lc_material all = white(&l);
    lc_point p, q;
    m.kd = lc_f3_make(0, 0, 0);
    m.roughness[0] = m.roughness[1] = 0.3f;
    lobe_point(&p, &l, &m);
    lobe_point(&q, &l, &all);
    return lobe_value(&p, i) / lobe_value(&q, i);
}

/* Glass of index 1.5 reflects 4 % along the normal, 8.9 % at 60 degrees and 38.8 % at 80, and at Brewster's
 * angle half of the reflectance of s-polarized light. Gold at three wavelengths. */
TEST(known_reflectances)
{
    lc_material m = { .ks = { 1, 1, 1 },
                      .lobe = LC_LOBE_GGX,
                      .fresnel = LC_FRESNEL_DIELECTRIC,
                      .eta = { 1.5f, 1.5f, 1.5f } };
    const double brewster = 1 / sqrt(1 + 1.5 * 1.5);
    CHECKF(fabs(reflectance(m, 1) - 0.04) <= 1e-6, "%g", reflectance(m, 1));
    CHECKF(fabs(reflectance(m, 0.5) - 0.0892) <= 1e-4, "%g", reflectance(m, 0.5));
    CHECKF(fabs(reflectance(m, cos(80 * LC_PI / 180)) - 0.3877) <= 1e-4, "%g",
           reflectance(m, cos(80 * LC_PI / 180)));
    CHECKF(fabs(reflectance(m, brewster) - pow(1.25 / 3.25, 2) / 2) <= 1e-6, "%g", reflectance(m, brewster));
    /* Each: eta, k, reflectance along the normal. */
    static const double gold[3][3] = { { 0.143, 3.98, 0.967 }, { 0.375, 2.39, 0.802 }, { 1.44, 1.6, 0.323 } };
    m.fresnel = LC_FRESNEL_CONDUCTOR;
    for (int k = 0; k < 3; k++) {
        m.eta.y = (float)gold[k][0];
        m.k.y = (float)gold[k][1];
        CHECKF(fabs(reflectance(m, 1) - gold[k][2]) <= 5e-3, "%g", reflectance(m, 1));
    }
    m.fresnel = LC_FRESNEL_SCHLICK;
    m.ks = lc_f3_make(0.04f, 0.04f, 0.04f);
    CHECKF(fabs(reflectance(m, 0.5) - 0.07) <= 1e-6, "%g", reflectance(m, 0.5));
    m.fresnel = LC_FRESNEL_NONE;
    CHECKF(fabs(reflectance(m, 0.1) - 0.04) <= 1e-6, "%g", reflectance(m, 0.1));
}

/* At all angles, against the formulas in doubles; a conductor without absorption is a dielectric. */
TEST(reflectances)
{
    for (double eta = 0.05; eta < 4; eta += 0.1)
        for (double c = 0.01; c <= 1; c += 0.03) {
            lc_material m = { .ks = { 1, 1, 1 }, .lobe = LC_LOBE_GGX, .fresnel = LC_FRESNEL_DIELECTRIC };
            m.eta = lc_f3_make((float)eta, (float)eta, (float)eta);
            double want = ref_dielectric((double)m.eta.x, c), got = reflectance(m, c);
            if (eta >= 1 && eta <= 3.5)
                CHECKF(fabs(got - want) <= 1e-5, "%g %g: %g, not %g", eta, c, got, want);
            if (eta >= 1) CHECKF(fabs(ref_conductor((double)m.eta.x, 0, c) - want) <= 1e-12, "%g %g", eta, c);
            m.fresnel = LC_FRESNEL_CONDUCTOR;
            for (double k = 0.1; k < 8; k *= 2) {
                m.k.y = (float)k;
                want = ref_conductor((double)m.eta.y, (double)m.k.y, c);
                CHECKF(fabs(reflectance(m, c) - want) <= 1e-5, "%g + %g i, %g: %g, not %g", eta, k, c,
                       reflectance(m, c), want);
            }
        }
}

/* Bounds of clusters rely on this: the reflectance of a dielectric falls with the cosine, for every index
 * that is accepted. */
TEST(reflectance_falls)
{
    for (double eta = 1; eta <= (double)LC_MAX_ETA; eta += 0.002)
        for (double c = 0; c < 1; c += 0.002)
            CHECKF(ref_dielectric(eta, c + 0.002) <= ref_dielectric(eta, c) + 1e-15, "%g %g", eta, c);
}

/* A of material.h for a roughness of 0.5. */
#define ROUGH_THROUGH (1 - 0.05 - 0.05)

/* A coat's diffuse part against its formula: transmitted twice, and reflected any number of times between
 * coat and base. */
TEST(coats)
{
    for (double eta = 1; eta <= 3.5; eta += 0.05) {
        look l = { 0.5, 0.5, 1, 0 };
        lc_material m = {
            .kd = { 0.2f, 0.6f, 1 }, .lobe = LC_LOBE_GGX, .roughness = { 0.5f, 0.5f }, .coat = true
        };
        m.eta.x = (float)eta;
        lc_point p;
        const double i[3] = { 0, 0, 1 };
        lobe_point(&p, &l, &m);
        double e = (double)m.eta.x, t = 1 - ref_dielectric(e, 1),
               inside = 1 - (1 - ref_mean_dielectric(e)) / (e * e);
        inside /= 1 + (1.1 + 1.125 / fmax(e - 1, 0.001)) * pow(0.5, 1.75);
        double want = (double)m.kd.y / LC_PI * t * t / (e * e * (1 - (double)m.kd.y * inside)) *
                      ROUGH_THROUGH,
               got = lobe_value(&p, i);
        CHECKF(fabs(got / want - 1) <= 1e-5, "%g: %g, not %g", eta, got, want);
        if (eta < 1.001) CHECKF(fabs(got / ROUGH_THROUGH - (double)m.kd.y / LC_PI) <= 1e-6, "%g", got);
    }
    /* The albedo is within 0..1 for any cosine, as a shading normal may face away. */
    for (double c = -1; c <= 1.01; c += 0.001) {
        lc_material m = {
            .kd = { 1, 0.5f, 0 }, .roughness = { 0.5f, 0.5f }, .coat = true, .eta = { 1.5f, 0, 0 }
        };
        lc_f3 share = lc_coat_albedo(&m, (float)c);
        CHECKF(share.x >= 0 && share.x <= 1 && share.y >= 0 && share.y <= 1, "at %g: %g", c, (double)share.x);
    }
    /* Over a white base all light that enters the coat leaves it again. */
    look l = { 0.01, 0.01, 0.7, 0 };
    lc_material m = { .kd = { 1, 1, 1 },
                      .lobe = LC_LOBE_GGX,
                      .roughness = { 1e-5f, 1e-5f },
                      .coat = true,
                      .eta = { 1.5f, 0, 0 } };
    double sum = 0, i[3], o[3];
    lc_point p;
    lobe_point(&p, &l, &m);
    direction_d(0.7, 0, o);
    for (int a = 0; a < 4000; a++) {
        direction_d((a + 0.5) / 4000, 1, i);
        sum += lobe_value(&p, i) * 2 * LC_PI / 4000;
    }
    double left = 1 - ref_dielectric(1.5, 0.7);
    printf("  white below 1.5: %.5f of what the surface lets in\n", sum / left);
    CHECKF(fabs(sum / left - 1) <= 1e-3, "%g", sum / left);
}

/* ---- a random walk between a rough interface and the diffuse surface below it ---- */

#define WITHOUT_END 1000

/* Lambda for isotropic roughness a. */
static double smith(double a, const double w[3])
{
    return (sqrt(1 + a * a * (w[0] * w[0] + w[1] * w[1]) / (w[2] * w[2])) - 1) / 2;
}

/* A normal out of the distribution of those visible from w ([Heitz18]). */
static void visible_normal(double a, const double w[3], double h[3])
{
    double v[3] = { a * w[0], a * w[1], w[2] }, len = sqrt(dot_d(v, v)), r = sqrt(rnd()),
           phi = 2 * LC_PI * rnd();
    for (int k = 0; k < 3; k++) v[k] /= len;
    double flat = sqrt(v[0] * v[0] + v[1] * v[1]), p = r * cos(phi), q = r * sin(phi), s = 0.5 * (1 + v[2]);
    double t[3] = { flat > 0 ? -v[1] / flat : 1, flat > 0 ? v[0] / flat : 0, 0 };
    double b[3] = { v[1] * t[2] - v[2] * t[1], v[2] * t[0] - v[0] * t[2], v[0] * t[1] - v[1] * t[0] };
    q = (1 - s) * sqrt(1 - p * p) + s * q;
    double u = sqrt(fmax(0, 1 - p * p - q * q));
    for (int k = 0; k < 3; k++) h[k] = p * t[k] + q * b[k] + u * v[k];
    h[0] *= a;
    h[1] *= a;
    h[2] = fmax(h[2], 1e-9);
    len = sqrt(dot_d(h, h));
    for (int k = 0; k < 3; k++) h[k] /= len;
}

/* Light from w meets an interface to relative index eta: -1 lost, 0 reflected, 1 transmitted, to o, on the
 * side that it then is. */
static int meet(double a, double eta, const double w[3], double o[3], double *weight)
{
    double h[3];
    visible_normal(a, w, h);
    double c = dot_d(w, h), in2 = 1 - (1 - c * c) / (eta * eta);
    if (c <= 0) return -1;
    int through = rnd() >= (in2 > 0 ? ref_dielectric(eta, c) : 1);
    for (int k = 0; k < 3; k++)
        o[k] = through ? -w[k] / eta + (c / eta - sqrt(in2)) * h[k] : 2 * c * h[k] - w[k];
    if (through ? o[2] >= 0 : o[2] <= 0) return -1;
    o[2] = fabs(o[2]);
    *weight *= (1 + smith(a, w)) / (1 + smith(a, w) + smith(a, o));
    return through;
}

/* A coat of optical depth `depth`, and how often at most its base reflects. */
typedef struct layers {
    double a, eta, kd, depth;
    int times;
} layers;

/* Share of the light from a cosine of c that leaves the coat after it was at the base. */
static double walk(const layers *l, double c, int n)
{
    double sum = 0;
    for (int i = 0; i < n; i++) {
        double w[3] = { sqrt(1 - c * c), 0, c }, o[3], weight = 1;
        int what = meet(l->a, l->eta, w, o, &weight) == 1 ? 0 : -1;
        for (int k = 0; k < l->times && what == 0; k++) {
            const double u = rnd();
            weight *= l->kd * exp(-l->depth / o[2]);
            w[0] = sqrt(u);
            w[1] = 0;
            w[2] = sqrt(1 - u);
            weight *= exp(-l->depth / w[2]);
            what = meet(l->a, 1 / l->eta, w, o, &weight);
        }
        if (what == 1) sum += weight;
    }
    return sum / n;
}

/* The same by the material, an integral over directions of light. */
static double formula(const layers *l, double c)
{
    enum { STEPS = 200 };
    const look from = { l->a, l->a, c, 0 };
    lc_material m = white(&from);
    lc_point p;
    double sum = 0, i[3];
    m.ks = lc_f3_make(0, 0, 0);
    m.kd = lc_f3_make((float)l->kd, (float)l->kd, (float)l->kd);
    m.coat = true;
    m.eta = lc_f3_make((float)l->eta, 0, 0);
    m.coat_terms = l->times < WITHOUT_END ? (uint32_t)l->times : 0;
    if (l->depth > 0) lc_coat_absorb(&m, l->depth);
    lobe_point(&p, &from, &m);
    for (int k = 0; k < STEPS; k++) {
        direction_d((k + 0.5) / STEPS, 1, i);
        sum += lobe_value(&p, i) * 2 * LC_PI / STEPS;
    }
    const double albedo = (double)lc_coat_albedo(&m, (float)c).x;
    CHECKF(fabs(sum - albedo) <= 2e-3 * albedo, "%g in all, not %g", sum, albedo);
    return sum;
}

TEST(coats_against_a_walk)
{
    static const double roughness[] = { 0.001, 0.05, 0.1, 0.2, 0.35, 0.6, 1 }, etas[] = { 1.3, 1.5, 2 },
                        kds[] = { 0.3, 0.9 }, cosines[] = { 0.1, 0.3, 0.6, 1 };
    static const struct {
        double depth;
        int times;
    } kinds[] = { { 0, WITHOUT_END }, { 0.01, 5 }, { 0.05, 2 } };
    for (int a = 0; a < 7; a++) {
        double worst = 0, sum[3] = { 0 };
        for (int x = 0; x < 3 * 2 * 4 * 3; x++) {
            const layers l = { roughness[a], (double)(float)etas[x / 24], kds[x / 12 % 2],
                               kinds[x % 3].depth, kinds[x % 3].times };
            const double c = cosines[x / 3 % 4], off = formula(&l, c) / walk(&l, c, 30000) - 1;
            const double limit = l.a > 0.6 ? 0.2 : l.a > 0.2 || c < 0.2 ? 0.12 : 0.06;
            worst = fmax(worst, fabs(off));
            sum[x % 3] += off / 24;
            CHECKF(fabs(off) < limit, "eta %g roughness %g kd %g depth %g, at %g: %+.3f", l.eta, l.a, l.kd,
                   l.depth, c, off);
        }
        printf("  roughness %g: off by %.3f at most; mean %+.3f, thin %+.3f, thick %+.3f\n", roughness[a],
               worst, sum[0], sum[1], sum[2]);
        for (int k = 0; k < 3; k++) CHECKF(fabs(sum[k]) < 0.02, "in the mean %+.3f", sum[k]);
    }
}

/* A viewer below the horizon counts as one on it; values at grazing angles are finite. */
TEST(grazing)
{
    for (int x = -3; x <= 3; x++) {
        look l = { 0.2, 0.4, 0.01 * x, 0.5 };
        lc_material m = white(&l);
        lc_point p;
        lobe_point(&p, &l, &m);
        for (int y = 0; y < 20; y++) {
            double i[3];
            direction_d(pow(0.5, y), 3.6, i);
            double f = lobe_value(&p, i);
            CHECKF(f >= 0 && f < 1e4, "%g", f);
        }
    }
}

int main(void)
{
    RUN(distribution_is_one);
    RUN(textbook);
    RUN(furnace);
    RUN(reciprocal);
    RUN(known_reflectances);
    RUN(reflectances);
    RUN(reflectance_falls);
    RUN(coats);
    RUN(coats_against_a_walk);
    RUN(grazing);
    return test_done();
}
