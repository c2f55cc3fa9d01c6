/* metrics.c - see metrics.h. */
#include "cli/metrics.h"

#include "cli/flip.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define EPSILON 0.01 /* in denominators: dark reference pixels must not dominate mrse and mape; as in pbrt */
#define BLOCK 4      /* pixels a side: the slots of representatives are shared out over such blocks */

const char *const metric_names[N_METRICS] = { "mae",     "mse",      "rmse",    "mrse",       "mape",
                                              "psnr",    "flip",     "roberts", "max",        "mean_ratio",
                                              "rel_p50", "rel_p95",  "rel_p99",  "rel_p999",   "rel_max",
                                              "over",    "nonfinite" };

static bool finite_pixel(float *const a[3], float *const ref[3], size_t i)
{
    for (int c = 0; c < 3; c++) {
        if (!isfinite(a[c][i]) || !isfinite(ref[c][i])) return false;
    }
    return true;
}

/* The metrics that are sums and maxima over pixels. */
static void add_up(uint32_t width, size_t n, float *const a[3], float *const ref[3], metrics *m)
{
    double abs_sum = 0, sq_sum = 0, rel_sq_sum = 0, rel_sum = 0, a_sum = 0, ref_sum = 0;
    size_t n_values = 0, n_bad = 0;
    for (size_t i = 0; i < n; i++) {
        if (!finite_pixel(a, ref, i)) {
            n_bad++;
            continue;
        }
        for (int c = 0; c < 3; c++) {
            double va = (double)a[c][i], vr = (double)ref[c][i], d = fabs(va - vr);
            abs_sum += d;
            sq_sum += d * d;
            rel_sum += d / (fabs(vr) + EPSILON);
            rel_sq_sum += d * d / ((vr + EPSILON) * (vr + EPSILON));
            a_sum += va;
            ref_sum += vr;
            if (d > m->value[METRIC_MAX] || n_values == 0) {
                m->value[METRIC_MAX] = d;
                m->max_x = (uint32_t)(i % width);
                m->max_y = (uint32_t)(i / width);
                m->max_channel = c;
                m->max_a = va;
                m->max_ref = vr;
            }
            n_values++;
        }
    }
    double inv_n = n_values ? 1.0 / (double)n_values : 0.0;
    m->value[METRIC_MAE] = abs_sum * inv_n;
    m->value[METRIC_MSE] = sq_sum * inv_n;
    m->value[METRIC_RMSE] = sqrt(sq_sum * inv_n);
    m->value[METRIC_MRSE] = rel_sq_sum * inv_n;
    m->value[METRIC_MAPE] = rel_sum * inv_n;
    m->value[METRIC_PSNR] = sq_sum > 0 ? -10.0 * log10(sq_sum * inv_n) : HUGE_VAL;
    m->value[METRIC_MEAN_RATIO] = a_sum == ref_sum ? 1.0 : a_sum / ref_sum;
    m->value[METRIC_NONFINITE] = (double)n_bad;
}

static int by_value(const void *a, const void *b)
{
    float x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

/* The least of the sorted values that is no less than a fraction p of them. */
static double percentile(const float *sorted, size_t n, double p)
{
    if (n == 0) return 0;
    size_t k = (size_t)ceil(p * (double)n);
    return (double)sorted[k < 1 ? 0 : k - 1];
}

static double luminance(float *const p[3], size_t i)
{
    return 0.2126 * (double)p[0][i] + 0.7152 * (double)p[1][i] + 0.0722 * (double)p[2][i];
}

/* rel: scratch for n values. */
static void relative_errors(size_t n, float *const a[3], float *const ref[3], double over, float *rel,
                            metrics *m)
{
    size_t n_rel = 0, n_over = 0;
    for (size_t i = 0; i < n; i++) {
        double vr = luminance(ref, i);
        if (!finite_pixel(a, ref, i) || !(vr > 0)) continue;
        double e = fabs(luminance(a, i) - vr) / vr;
        n_over += e > over;
        rel[n_rel++] = (float)e;
    }
    qsort(rel, n_rel, sizeof *rel, by_value);
    m->value[METRIC_REL_P50] = percentile(rel, n_rel, 0.5);
    m->value[METRIC_REL_P95] = percentile(rel, n_rel, 0.95);
    m->value[METRIC_REL_P99] = percentile(rel, n_rel, 0.99);
    m->value[METRIC_REL_P999] = percentile(rel, n_rel, 0.999);
    m->value[METRIC_REL_MAX] = percentile(rel, n_rel, 1.0);
    m->value[METRIC_OVER] = n_rel ? (double)n_over / (double)n_rel : 0.0;
}

/* Means of the relative error of luminance over blocks of BLOCK x BLOCK pixels. Incomplete blocks at the
 * edges are left out. */
static void block_errors(uint32_t width, uint32_t height, float *const a[3], float *const ref[3],
                         float *block)
{
    for (size_t y = 0; y < height / BLOCK; y++)
        for (size_t x = 0; x < width / BLOCK; x++) {
            double sum = 0;
            for (size_t k = 0; k < BLOCK * BLOCK; k++) {
                size_t i = (y * BLOCK + k / BLOCK) * width + x * BLOCK + k % BLOCK;
                double vr = luminance(ref, i);
                if (finite_pixel(a, ref, i)) sum += (luminance(a, i) - vr) / (fabs(vr) + EPSILON);
            }
            block[y * (width / BLOCK) + x] = (float)(sum / (BLOCK * BLOCK));
        }
}

/* Energy of Roberts' operator on the block means of the error. It shows bands: averaging removes most of the
 * noise, but not edges longer than a block. block: scratch for the means. */
static double roberts(uint32_t width, uint32_t height, float *const a[3], float *const ref[3], float *block)
{
    size_t w = width / BLOCK, h = height / BLOCK;
    double sum = 0;
    if (w < 2 || h < 2) return 0;
    block_errors(width, height, a, ref, block);
    for (size_t i = 0; i + w + 1 < w * h; i++) {
        if (i % w == w - 1) continue;
        double p = (double)block[i] - (double)block[i + w + 1],
               q = (double)block[i + 1] - (double)block[i + w];
        sum += p * p + q * q;
    }
    return sum / (double)((w - 1) * (h - 1));
}

lc_status metrics_of(lc_context *ctx, uint32_t width, uint32_t height, float *const a[3], float *const ref[3],
                     double over, metrics *out)
{
    memset(out, 0, sizeof *out);
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    desc.width = width;
    desc.height = height;
    lc_image *scratch = NULL;
    float *rel = NULL;
    lc_status status = lc_image_create(ctx, &desc, &scratch);
    if (status == LC_OK) status = lc_image_add_channel(scratch, "rel", &rel);
    if (status == LC_OK) {
        size_t n = (size_t)width * height;
        add_up(width, n, a, ref, out);
        out->value[METRIC_ROBERTS] = roberts(width, height, a, ref, rel);
        relative_errors(n, a, ref, over, rel, out);
        status = flip_mean(ctx, width, height, a, ref, &out->value[METRIC_FLIP]);
    }
    lc_image_destroy(scratch);
    return status;
}
