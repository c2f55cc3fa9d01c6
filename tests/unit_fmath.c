/* unit_fmath.c - the powers against the C library's in long double. */
#include "base/fmath.h"
#include "base/rng.h"
#include "shade/tree_data.h"
#include "support/test.h"

#include <math.h>

/* The kernels' own powers, one lane at a time; check_kernels.c compares the instruction sets. */
#include "simd/vec_scalar.h"

#include "simd/fmath_tmpl.c"

/* Two roundings side by side, as of a vector's coordinates: what gcc 12 leaves out with
 * -ftree-slp-vectorize, and nothing but the last digits of a few lights tells. */
static void round_two(const double *a, double s, double *restrict o)
{
    float x = (float)(a[0] * s), y = (float)(a[1] * s);
    o[0] = (double)x * s;
    o[1] = (double)y * s;
}

TEST(the_compiler_rounds_to_float)
{
    volatile double in[3] = { 1.0 / 3, 2.0 / 7, 0.7 };
    const double a[2] = { in[0], in[1] };
    double o[2];
    round_two(a, in[2], o);
    for (int k = 0; k < 2; k++) {
        volatile float rounded = (float)(in[k] * in[2]);
        CHECKF(o[k] == (double)rounded * in[2], "%a", o[k]);
    }
}

TEST(pow_agrees)
{
    double worst = 0;
    for (uint64_t i = 0; i < 2000000; i++) {
        double u = lc_unit(lc_hash4(3, i, 0, 0)), v = lc_unit(lc_hash4(3, i, 1, 0));
        float n = (float)pow(10, 5 * v), x = (float)(i & 1 ? u : 1 - u * 10 / ((double)n + 10));
        double want = (double)powl((long double)x, (long double)n), got = (double)lc_pow01(x, n);
        if (want < 1.1e-13) continue;
        double error = fabs(got / want - 1);
        if (error > worst) worst = error;
        /* the result is rounded to float, 2^-24, on top of 1e-10 */
        CHECKF(error < 0x1p-24 + 1e-10, "%a ^ %a: %.9g for %.9g", (double)x, (double)n, got, want);
    }
    printf("  worst relative error %.3g\n", worst);
}

TEST(logarithm_and_angle_agree)
{
    double worst = 0;
    for (uint64_t i = 0; i < 200000; i++) {
        double x = exp(600 * (lc_unit(lc_hash4(4, i, 0, 0)) - 0.5)),
               y = exp(600 * (lc_unit(lc_hash4(4, i, 1, 0)) - 0.5));
        CHECKF(fabs(lc_ln(x) - log(x)) <= 1e-15 * fabs(log(x)) + 1e-16, "ln %a", x);
        if (i & 2) {
            x = 2 * lc_unit(lc_hash4(4, i, 2, 0)) - 1;
            y = 2 * lc_unit(lc_hash4(4, i, 3, 0)) - 1;
        }
        if (i & 1) x = -x;
        if (i & 4) y = -y;
        double error = fabs(lc_atan2(y, x) - atan2(y, x));
        if (error > worst) worst = error;
        CHECKF(error < 1e-15, "atan2(%a, %a)", y, x);
    }
    CHECK(lc_atan2(0, 0) == 0 && lc_atan2(0, 1) == 0 && lc_atan2(0, -1) == LC_PI &&
          lc_atan2(1, 0) == LC_PI / 2);
    CHECK(lc_atan2(-1, 0) == -LC_PI / 2 && lc_atan2(1, 1) == LC_PI / 4);
    printf("  worst error of the angle %.3g\n", worst);
}

TEST(pow_ends)
{
    CHECK(lc_pow01(0, 0) == 0 && lc_pow01(0, 5) == 0);
    CHECK(lc_pow01(1, 0) == 1 && lc_pow01(1, 1e5f) == 1 && lc_pow01(0.3f, 0) == 1);
    CHECK(lc_pow01(0.5f, 1) == 0.5f && lc_pow01(0.5f, 10) == 0x1p-10f);
    CHECK(lc_pow01(0.1f, 40) == 0);
    CHECK(lc_pow01(0x1p-126f, 1e-3f) > 0.9f);
}

/* Not below the exact power, and above it by 2^-15 and the error that fmath_tmpl.c derives at most. */
TEST(upper_bound_holds)
{
    double least = 1, most = 0;
    for (uint64_t i = 0; i < 4000000; i++) {
        double u = lc_unit(lc_hash4(5, i, 0, 0)), v = lc_unit(lc_hash4(5, i, 1, 0));
        float n = (float)pow(10, 6 * v - 1), x = (float)(i & 1 ? u : 1 - u * 28 / ((double)n + 28));
        if (!(x > 0)) continue;
        double exact = (double)powl((long double)x, (long double)n), ub = (double)pow01_ub(x, n);
        if (ub == 0) {
            CHECKF(exact < (double)LC_MIN_LOBE, "%a ^ %a: %.9g, no bound", (double)x, (double)n, exact);
            continue;
        }
        double excess = ub / exact - 1;
        CHECKF(excess > 0x1p-15 - 2.7e-5 && excess < 0x1p-15 + 2.7e-5, "%a ^ %a: %.9g, bound %.9g", (double)x,
               (double)n, exact, ub);
        if (excess < least) least = excess;
        if (excess > most) most = excess;
    }
    CHECK(pow01_ub(1, 0) >= 1 && pow01_ub(0.5f, 0) >= 1 && pow01_ub(1, 1e5f) >= 1);
    printf("  above the exact power by %.3g to %.3g\n", least, most);
}

TEST(exp_agrees)
{
    for (uint64_t i = 0; i < 200000; i++) {
        double y = -690 * lc_unit(lc_hash4(4, i, 0, 0)) * lc_unit(lc_hash4(4, i, 1, 0));
        double want = (double)expl((long double)y);
        CHECKF(fabs(lc_exp_neg(y) / want - 1) < 2e-13, "%a", y); /* k ln 2 rounds: |y| 2^-53 */
    }
    CHECK(lc_exp_neg(0) == 1 && lc_exp_neg(-800) == 0);
}

/* lc_decay and its bound, by the same margins as powers. */
TEST(decay_agrees)
{
    for (uint64_t i = 0; i < 1000000; i++) {
        double u = lc_unit(lc_hash4(6, i, 0, 0)), v = lc_unit(lc_hash4(6, i, 1, 0));
        float y = (float)(i & 1 ? 31 * u : pow(10, -40 * v) * u);
        double want = (double)expl(-(long double)y), got = (double)lc_decay(y),
               ub = (double)decay_ub(y);
        CHECKF(y > 29.93f ? got < 1.1e-13 : fabs(got / want - 1) < 0x1p-24 + 1e-12, "%a: %.9g for %.9g",
               (double)y, got, want);
        CHECKF(ub > 0 ? ub > want * (1 + 0x1p-15 - 2.7e-5) && ub < want * (1 + 0x1p-15 + 2.7e-5)
                      : want < (double)LC_MIN_LOBE,
               "%a: %.9g, bound %.9g", (double)y, want, ub);
    }
    CHECK(lc_decay(0) == 1 && lc_decay(1e30f) == 0 && decay_ub(0) >= 1 &&
          decay_ub(FLT_MAX) == 0);
    CHECK(decay_ub(INFINITY) == 0);
}

int main(void)
{
    RUN(the_compiler_rounds_to_float);
    RUN(pow_agrees);
    RUN(logarithm_and_angle_agree);
    RUN(pow_ends);
    RUN(upper_bound_holds);
    RUN(exp_agrees);
    RUN(decay_agrees);
    return test_done();
}
