/* unit_ward.c - Ward's lobe as one_transfer gives it: its albedo against the reflectance and against an
 * integral of the formula of [Walter05b] in doubles; reciprocity; any tangent. */
#include "support/lobe.h"
#include "support/test.h"

#define N_U 256 /* steps of the integral over half vectors, by each of two numbers */
#define N_V 128

static const double ks = 0.75;

static void init(lc_point *p, const look *l)
{
    lc_material m = { .ks = { (float)ks, (float)ks, (float)ks },
                      .lobe = LC_LOBE_WARD,
                      .roughness = { (float)l->ax, (float)l->ay },
                      .tangent = { 1, 0, 0 } };
    lobe_point(p, l, &m);
}

/* f cos by [Walter05b], with cosines of at least 0.02 under the root. */
static double formula(const look *l, const double i[3])
{
    double o[3];
    direction_d(l->cos_o, l->phi_o, o);
    double x = (i[0] + o[0]) / l->ax, y = (i[1] + o[1]) / l->ay, z = i[2] + o[2];
    return i[2] * ks / (4 * LC_PI * l->ax * l->ay * sqrt(fmax(i[2], 0.02) * fmax(o[2], 0.02))) *
           exp(-(x * x + y * y) / (z * z));
}

/* Integral of f cos over the hemisphere of light directions i = 2 (o.h) h - o, by a midpoint rule over the
 * two numbers that give half vectors h the density of the lobe. */
static double reflected(const look *l)
{
    lc_point p;
    double o[3], sum = 0;
    init(&p, l);
    direction_d(l->cos_o, l->phi_o, o);
    for (int a = 0; a < N_U; a++)
        for (int b = 0; b < N_V; b++) {
            double u = (a + 0.5) / N_U, v = 2 * LC_PI * (b + 0.5) / N_V, h[3], i[3];
            double phi = atan2(l->ay * sin(v), l->ax * cos(v)), c = cos(phi) / l->ax, s = sin(phi) / l->ay;
            double t2 = -log(u) / (c * c + s * s);
            direction_d(1 / sqrt(1 + t2), phi, h);
            double oh = o[0] * h[0] + o[1] * h[1] + o[2] * h[2];
            for (int k = 0; k < 3; k++) i[k] = 2 * oh * h[k] - o[k];
            if (oh > 0 && i[2] > 0)
                sum += lobe_value(&p, i) * 4 * LC_PI * l->ax * l->ay * oh * pow(h[2], 3) / u;
        }
    return sum / N_U / N_V;
}

/* Integral of the formula, by a midpoint rule over cosine and azimuth. */
static double integral(const look *l)
{
    const int n = 800;
    double sum = 0, i[3];
    for (int a = 0; a < n; a++)
        for (int b = 0; b < n; b++) {
            direction_d((a + 0.5) / n, 2 * LC_PI * (b + 0.5) / n, i);
            sum += formula(l, i);
        }
    return sum * 2 * LC_PI / n / n;
}

/* A smooth surface has an albedo of ks times the viewer's cosine. */
TEST(smooth_reflects_its_albedo)
{
    static const double rough[] = { 0.01, 0.015, 0.02 }, cosines[] = { 1, 0.9, 0.7, 0.5 };
    for (int x = 0; x < 3; x++)
        for (int y = 0; y < 3; y++)
            for (int k = 0; k < 4; k++) {
                look l = { rough[x], rough[y], cosines[k], 0.3 };
                double r = reflected(&l) / (ks * l.cos_o);
                CHECKF(fabs(r - 1) <= 0.005, "roughness %g %g, cosine %g: %.6f", l.ax, l.ay, l.cos_o, r);
            }
}

/* A rough surface has the albedo of the formula, which is less. */
TEST(rough_reflects_what_the_formula_says)
{
    static const double rough[] = { 0.1, 0.2, 0.4, 1 }, cosines[] = { 1, 0.7, 0.3, 0.05 };
    double least = 1;
    for (int x = 0; x < 4; x++)
        for (int y = 0; y < 4; y++)
            for (int k = 0; k < 4; k++) {
                look l = { rough[x], rough[y], cosines[k], 0.3 };
                double r = reflected(&l), want = integral(&l);
                CHECKF(fabs(r / want - 1) <= 0.005, "roughness %g %g, cosine %g: %.6f, not %.6f", l.ax, l.ay,
                       l.cos_o, r, want);
                if (k == 0 && want / ks < least) least = want / ks;
            }
    printf("  along the normal, of the roughest: %.4f of ks\n", least);
}

/* The albedo is at most ks in every direction, thanks to LC_WARD_MIN_COS. */
TEST(never_more_than_comes_in)
{
    static const double rough[] = { 0.01, 0.05, 0.3, 0.6, 1 },
                        cosines[] = { 1, 0.5, 0.2, 0.1, 0.05, 0.03, 0.02, 0.01, 1e-3, 1e-5 };
    double most = 0;
    for (int x = 0; x < 5; x++)
        for (int y = 0; y < 5; y++)
            for (int k = 0; k < 10; k++) {
                look l = { rough[x], rough[y], cosines[k], 0.8 };
                most = fmax(most, reflected(&l) / ks);
            }
    CHECKF(most <= 1.0005, "%.6f", most);
    printf("  at most %.4f of ks\n", most);
}

/* f(i, o) = f(o, i), also where cosines are raised to 0.02. */
TEST(reciprocal)
{
    static const double cosines[] = { 1, 0.6, 0.2, 0.05, 0.01 };
    for (int x = 0; x < 5; x++)
        for (int y = 0; y < 5; y++)
            for (double phi = 0; phi < 6; phi += 0.7) {
                look l = { 0.3, 0.6, cosines[x], phi }, back = { 0.3, 0.6, cosines[y], 1 };
                lc_point p, q;
                double i[3], o[3];
                init(&p, &l);
                init(&q, &back);
                direction_d(l.cos_o, l.phi_o, o);
                direction_d(back.cos_o, back.phi_o, i);
                double a = lobe_value(&p, i) / i[2], b = lobe_value(&q, o) / o[2];
                CHECKF(fabs(a - b) <= 1e-4 * (a + b), "%g %g", a, b);
            }
}

/* A tangent's sign and its part along the normal do not matter; without a tangent any direction will do; with
 * equal roughness the tangent does not matter. */
TEST(tangents)
{
    static const lc_f3 tangents[] = { { 0, 1, 0 }, { 0, -1, 0 }, { 0, 0.6f, 0.8f },
                                      { 0, 0, 1 }, { 0, 0, 0 },  { 0, 0, -1 } };
    const double i[3] = { 0.48, -0.6, 0.64 };
    double first = 0, want[2];
    for (int swap = 0; swap < 2; swap++) {
        look l = { swap ? 0.2 : 0.5, swap ? 0.5 : 0.2, 0.8, 2 };
        want[swap] = formula(&l, i);
    }
    for (int k = 0; k < 6; k++) {
        lc_material m = { .ks = { (float)ks, (float)ks, (float)ks },
                      .lobe = LC_LOBE_WARD, .roughness = { 0.2f, 0.5f }, .tangent = tangents[k] };
        double o[3];
        lc_point p;
        direction_d(0.8, 2, o);
        lc_f3 view = lc_f3_normalize_d(o[0], o[1], o[2]), n = lc_f3_make(0, 0, 1);
        lc_point_init(&p, lc_f3_make(0, 0, 0), n, view, &m, 1e-10f);
        double f = lobe_value(&p, i);
        if (k < 3) CHECKF(fabs(f / want[0] - 1) < 1e-4, "%g, not %g", f, want[0]);
        else CHECKF(fabs(f / want[1] - 1) < 1e-4 || fabs(f / want[0] - 1) < 1e-4, "%g", f); /* along x or y */
        m.roughness[1] = 0.2f;
        lc_point_init(&p, lc_f3_make(0, 0, 0), n, view, &m, 1e-10f);
        f = lobe_value(&p, i);
        if (k == 0) first = f;
        CHECKF(fabs(f / first - 1) < 1e-4, "%g, not %g", f, first);
    }
}

int main(void)
{
    RUN(smooth_reflects_its_albedo);
    RUN(rough_reflects_what_the_formula_says);
    RUN(never_more_than_comes_in);
    RUN(reciprocal);
    RUN(tangents);
    return test_done();
}
