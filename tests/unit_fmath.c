/* unit_fmath.c - the powers against the C library's in long double. */
#include "fmath.h"
#include "rng.h"
#include "test.h"

#include <math.h>

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

TEST(pow_ends)
{
    CHECK(lc_pow01(0, 0) == 0 && lc_pow01(0, 5) == 0);
    CHECK(lc_pow01(1, 0) == 1 && lc_pow01(1, 1e5f) == 1 && lc_pow01(0.3f, 0) == 1);
    CHECK(lc_pow01(0.5f, 1) == 0.5f && lc_pow01(0.5f, 10) == 0x1p-10f);
    CHECK(lc_pow01(0.1f, 40) == 0);
    CHECK(lc_pow01(0x1p-126f, 1e-3f) > 0.9f);
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

int main(void)
{
    RUN(pow_agrees);
    RUN(pow_ends);
    RUN(exp_agrees);
    return test_done();
}
