/* unit_oren_nayar.c - Oren and Nayar's rough diffuse surface: what one_transfer gives against the paper's
 * formula by angles, in doubles; the albedo against an integral of it; Lambert's law for a smooth one. */
#include "shade/lobe.h"
#include "support/lobe.h"
#include "support/test.h"

static const double rho = 0.75;

static lc_material material(double sigma)
{
    float k = (float)rho, s = (float)sigma;
    return (lc_material){
        .kd = { k, k, k }, .ks = { k, k, k }, .lobe = LC_LOBE_OREN_NAYAR, .roughness = { s, s }
    };
}

/* f cos, [Oren94] eq. 30. */
static double formula(double sigma, double angle_i, double angle_o, double azimuth)
{
    double s2 = sigma * sigma, a = 1 - s2 / (2 * (s2 + 0.33)), b = 0.45 * s2 / (s2 + 0.09);
    double alpha = fmax(angle_i, angle_o), beta = fmin(angle_i, angle_o);
    return rho / LC_PI * cos(angle_i) * (a + b * fmax(cos(azimuth), 0) * sin(alpha) * tan(beta));
}

static const double sigmas[] = { 0.05, 0.2, 0.35, 0.7, 1 };
static const double angles[] = { 0, 0.1, 0.5, 1, 1.3, 1.5, 1.565 };

TEST(agrees_with_the_formula)
{
    for (int s = 0; s < 5; s++)
        for (int a = 0; a < 7; a++)
            for (int b = 0; b < 7; b++)
                for (double azimuth = 0; azimuth < 6.3; azimuth += 0.3) {
                    lc_material m = material(sigmas[s]);
                    look l = { .cos_o = cos(angles[b]), .phi_o = 0.4 };
                    lc_point p;
                    double i[3];
                    lobe_point(&p, &l, &m);
                    direction_d(cos(angles[a]), 0.4 + azimuth, i);
                    double got = lobe_value(&p, i), want = formula(sigmas[s], angles[a], angles[b], azimuth);
                    /* rounded directions: 1e-7 of cosines as small as 0.006 */
                    CHECKF(fabs(got - want) <= 1e-4 * want + 1e-8, "%g, %g %g, %g: %g, not %g",
                           sigmas[s], angles[a], angles[b], azimuth, got, want);
                }
}

TEST(albedo_is_the_integral)
{
    const int n = 1000;
    for (int s = 0; s < 5; s++)
        for (int a = 0; a < 7; a++) {
            lc_material m = material(sigmas[s]);
            double sum = 0, got = (double)lc_lobes[m.lobe].albedo(&m, (float)cos(angles[a])).y;
            /* Midpoints of the angle. The integral of the azimuth's cosine, where positive, is 2. */
            for (int x = 0; x < n; x++)
                for (int k = 0; k < 2; k++) {
                    double angle = (x + 0.5) / n * LC_PI / 2;
                    double f0 = formula(sigmas[s], angle, angles[a], LC_PI),
                           f1 = formula(sigmas[s], angle, angles[a], 0);
                    sum += sin(angle) * (k ? 2 * (f1 - f0) : 2 * LC_PI * f0) * LC_PI / 2 / n;
                }
            CHECKF(fabs(got / sum - 1) < 1e-4, "%g, %g: %g, not %g", sigmas[s], angles[a], got, sum);
        }
}

TEST(smooth_is_lambert)
{
    lc_material m = material((double)LC_MIN_ROUGHNESS);
    look l = { .cos_o = 0.6, .phi_o = 1 };
    lc_point p;
    double i[3];
    lobe_point(&p, &l, &m);
    direction_d(0.8, 1.5, i);
    CHECK(fabs(lobe_value(&p, i) / (rho / LC_PI * 0.8) - 1) < 1e-3);
}

int main(void)
{
    RUN(agrees_with_the_formula);
    RUN(albedo_is_the_integral);
    RUN(smooth_is_lambert);
    return test_done();
}
