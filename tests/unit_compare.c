/* unit_compare.c - the metrics of `lightcuts compare`, against values worked out by hand for small pictures;
 * FLIP for pairs of colours that its definition tells, and its symmetry and order. */
#include "support/logged.h"
#include "support/near.h"

/* Tests link with the library only, and these are parts of the program. */
#include "cli/flip.c"
#include "cli/metrics.c"

#include <math.h>
#include <stdbool.h>

#define SIDE 32

static lc_context *ctx;

/* Metrics of at most 1 are compared by near_abs, larger ones by near_rel. */
#define EPS 1e-6

TEST(by_hand)
{
    float ar[4] = { 1.0f, 2.0f, 0.0f, 0.5f }, ag[4] = { 1.0f, 2.0f, 0.0f, 0.5f },
          ab[4] = { 1.0f, 2.0f, 0.0f, 0.5f };
    float rr[4] = { 1.0f, 1.0f, 0.0f, 0.5f }, rg[4] = { 1.0f, 2.0f, 0.0f, 0.5f },
          rb[4] = { 1.0f, 2.0f, 0.25f, 0.5f };
    float *const a[3] = { ar, ag, ab }, *const ref[3] = { rr, rg, rb };
    metrics m;
    CHECK(metrics_of(ctx, 2, 2, a, ref, 0.02, &m) == LC_OK);
    CHECK(near_abs(m.value[METRIC_MAE], 1.25 / 12, EPS));
    CHECK(near_abs(m.value[METRIC_MSE], 1.0625 / 12, EPS));
    CHECK(near_abs(m.value[METRIC_RMSE], sqrt(1.0625 / 12), EPS));
    CHECK(near_abs(m.value[METRIC_MRSE], (1 / (1.01 * 1.01) + 0.0625 / (0.26 * 0.26)) / 12, EPS));
    CHECK(near_abs(m.value[METRIC_MAPE], (1 / 1.01 + 0.25 / 0.26) / 12, EPS));
    CHECK(near_rel(m.value[METRIC_PSNR], -10 * log10(1.0625 / 12), EPS));
    CHECK(m.value[METRIC_MAX] == 1.0 && m.max_x == 1 && m.max_y == 0 && m.max_channel == 0);
    CHECK(m.max_a == 2.0 && m.max_ref == 1.0);
    CHECK(near_rel(m.value[METRIC_MEAN_RATIO], 10.5 / 9.75, EPS));
    /* Luminances: 1 and 1, 2 and 1.7874, 0 and 0.01805, 0.5 and 0.5. */
    CHECK(m.value[METRIC_REL_P50] == 0.0 && near_abs(m.value[METRIC_REL_P99], 1.0, EPS) &&
          near_abs(m.value[METRIC_REL_MAX], 1.0, EPS));
    CHECK(near_abs(m.value[METRIC_OVER], 0.5, EPS) && m.value[METRIC_NONFINITE] == 0.0);
}

TEST(equal_pictures)
{
    float v[4] = { 0.0f, 1.0f, 1e6f, -1.0f };
    float *const a[3] = { v, v, v };
    metrics m;
    CHECK(metrics_of(ctx, 4, 1, a, a, 0.02, &m) == LC_OK);
    for (int k = 0; k < N_METRICS; k++) {
        double want = k == METRIC_PSNR ? HUGE_VAL : k == METRIC_MEAN_RATIO ? 1.0 : 0.0;
        CHECKF(m.value[k] == want, "%s %g", metric_names[k], m.value[k]);
    }
}

TEST(nonfinite_pixels_are_counted_and_left_out)
{
    float x[4] = { NAN, 1.0f, INFINITY, 2.0f }, y[4] = { 1.0f, 1.0f, 1.0f, 1.0f };
    float *const a[3] = { y, x, y }, *const ref[3] = { y, y, y };
    metrics m;
    CHECK(metrics_of(ctx, 4, 1, a, ref, 0.02, &m) == LC_OK);
    CHECK(m.value[METRIC_NONFINITE] == 2.0 && near_abs(m.value[METRIC_MAE], 1.0 / 6, EPS) &&
          isfinite(m.value[METRIC_FLIP]));
}

/* A step and a chessboard with the same error at each pixel: means of blocks show the step only. */
TEST(roberts_sees_bands_not_noise)
{
    static float flat[SIDE * SIDE], step[SIDE * SIDE], chess[SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; i++) {
        int x = i % SIDE, y = i / SIDE;
        flat[i] = 0.99f;
        step[i] = flat[i] + (x < 16 ? 0.1f : -0.1f);
        chess[i] = flat[i] + ((x + y) % 2 ? 0.1f : -0.1f);
    }
    float *const ref[3] = { flat, flat, flat }, *const a[3] = { step, step, step },
                 *const b[3] = { chess, chess, chess };
    metrics m;
    CHECK(metrics_of(ctx, SIDE, SIDE, a, ref, 0.02, &m) == LC_OK);
    /* In one of the seven columns of blocks both differences of Roberts's operator are 0.2. */
    CHECKF(near_abs(m.value[METRIC_ROBERTS], 2 * 0.2 * 0.2 / 7, EPS), "%g", m.value[METRIC_ROBERTS]);
    CHECK(metrics_of(ctx, SIDE, SIDE, b, ref, 0.02, &m) == LC_OK);
    CHECKF(m.value[METRIC_ROBERTS] < 1e-9, "%g", m.value[METRIC_ROBERTS]);
    /* A picture of one block in width has no differences. */
    CHECK(metrics_of(ctx, 7, SIDE, a, ref, 0.02, &m) == LC_OK && m.value[METRIC_ROBERTS] < 1e-30);
}

/* ---- FLIP ---- */

static double flip_of(const float from[3], const float to[3])
{
    static float one[3][SIDE * SIDE], two[3][SIDE * SIDE];
    float *a[3], *b[3];
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < SIDE * SIDE; i++) {
            one[c][i] = from[c];
            two[c][i] = to[c];
        }
        a[c] = one[c];
        b[c] = two[c];
    }
    double mean = -1;
    CHECK(flip_mean(ctx, SIDE, SIDE, a, b, &mean) == LC_OK);
    return mean;
}

TEST(flip_of_flat_colours)
{
    static const float black[3] = { 0, 0, 0 }, white[3] = { 1, 1, 1 }, green[3] = { 0, 1, 0 },
                       blue[3] = { 0, 0, 1 };
    static const float grey[3] = { 0.2f, 0.2f, 0.2f }, greyer[3] = { 0.21f, 0.21f, 0.21f },
                       over[3] = { 9, 9, 9 };
    CHECK(flip_of(grey, grey) == 0.0 && flip_of(white, over) == 0.0);
    /* Green and blue have the largest distance of colours in FLIP. Without edges only the colour error
     * counts. */
    CHECKF(fabs(flip_of(green, blue) - 1.0) < 1e-4, "%.9g", flip_of(green, blue));
    CHECKF(fabs(flip_of(green, blue) - flip_of(blue, green)) < 1e-6, "symmetric");
    /* By hand: HyAB of black and white is 100, and 100^0.7 = 25.12 is above 0.4 of 308.2^0.7, where errors
     * are mapped to more than 0.95. */
    double black_white = flip_of(black, white), small = flip_of(grey, greyer);
    CHECKF(black_white > 0.95 && black_white < 1.0, "%g", black_white);
    CHECKF(small > 0.0 && small < 0.15, "%g", small);
}

TEST(flip_sees_edges)
{
    static float flat[SIDE * SIDE], line[SIDE * SIDE], faint[SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; i++) {
        flat[i] = 0.5f;
        line[i] = i % SIDE == SIDE / 2 ? 1.0f : 0.5f;
        faint[i] = i % SIDE == SIDE / 2 ? 0.6f : 0.5f;
    }
    float *const a[3] = { flat, flat, flat }, *const b[3] = { line, line, line },
                 *const c[3] = { faint, faint, faint };
    double strong = 0, weak = 0, back = 0;
    CHECK(flip_mean(ctx, SIDE, SIDE, a, b, &strong) == LC_OK &&
          flip_mean(ctx, SIDE, SIDE, a, c, &weak) == LC_OK);
    CHECK(flip_mean(ctx, SIDE, SIDE, b, a, &back) == LC_OK && strong == back);
    CHECKF(0.0 < weak && weak < strong && strong < 1.0, "%g %g", weak, strong);
}

int main(void)
{
    ctx = quiet_context(0);
    RUN(by_hand);
    RUN(equal_pictures);
    RUN(nonfinite_pixels_are_counted_and_left_out);
    RUN(roberts_sees_bands_not_noise);
    RUN(flip_of_flat_colours);
    RUN(flip_sees_edges);
    lc_context_destroy(ctx);
    return test_done();
}
