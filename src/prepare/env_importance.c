/* env_importance.c - see env_importance.h. */
#include "prepare/env_importance.h"

#include "base/pool.h"
#include "base/rng.h"
#include "shade/point_init.h"
#include "trace/bvh.h"

#include <stdlib.h>

#define BLOCK 64   /* lights whose rays go out together, from the same points */
#define POINTS LC_SIZE(256, 16) /* of the view that a block is tried at */
#define FAMILY 8   /* neighbours in the sky that vouch for each other */
#define WORTH 0.5  /* of the median of those that give anything, for a weight of 1 */

typedef struct job {
    const lc_vpl_view *view;
    const lc_light *lights;
    uint32_t n;
    uint64_t seed;
    double *worth;
} job;

/* Adds what the block's lights give to one point. */
static void try_point(const job *j, uint32_t first, uint32_t n, uint32_t point)
{
    const lc_bvh *bvh = j->view->scene->bvh;
    float to[3][BLOCK], f[BLOCK];
    const float *const target[3] = { to[0], to[1], to[2] };
    uint8_t hidden[BLOCK];
    uint32_t at[BLOCK], m = 0;
    for (uint32_t i = first; i < first + n; i++) {
        lc_light light = j->lights[i];
        lc_light_rec rec;
        light.intensity = lc_f3_make(1, 1, 1);
        lc_light_rec_init(&rec, &light);
        f[m] = lc_view_luminance(j->view->scene->ctx->shade_kernels, &j->view->points[point], &light, &rec);
        if (!(f[m] > 0)) continue;
        for (int c = 0; c < 3; c++) to[c][m] = rec.pos[c];
        at[m++] = i;
    }
    if (m) bvh->kernels->hidden(&bvh->data, j->view->org[point], m, target, true, hidden, NULL);
    for (uint32_t k = 0; k < m; k++)
        if (!hidden[k]) j->worth[at[k]] += (double)f[k];
}

static void try_block(void *user, uint32_t thread, uint64_t item)
{
    job *j = user;
    uint32_t first = (uint32_t)item * BLOCK, n = j->n - first < BLOCK ? j->n - first : BLOCK,
             all = j->view->n;
    (void)thread;
    for (uint32_t k = 0; k < POINTS; k++) {
        uint32_t from = (uint32_t)((uint64_t)all * k / POINTS),
                 to = (uint32_t)((uint64_t)all * (k + 1) / POINTS);
        if (to > from) try_point(j, first, n, from + (uint32_t)(lc_hash4(j->seed, item, k, 6) % (to - from)));
    }
}

static int rising(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median_worth(const double *worth, double *sorted, uint32_t n)
{
    uint32_t m = 0;
    for (uint32_t i = 0; i < n; i++)
        if (worth[i] > 0) sorted[m++] = worth[i];
    qsort(sorted, m, sizeof *sorted, rising);
    return m ? sorted[m / 2] : 0;
}

/* What none of a light's points sees may be seen elsewhere, the sooner the more of its neighbours are. */
static void vouch(double *worth, uint32_t n)
{
    for (uint32_t from = 0; from < n; from += FAMILY) {
        uint32_t to = from + FAMILY < n ? from + FAMILY : n;
        double mean = 0;
        for (uint32_t i = from; i < to; i++) mean += worth[i] / (to - from);
        for (uint32_t i = from; i < to; i++) worth[i] = (worth[i] + mean) / 2;
    }
}

lc_status lc_env_weights(const lc_vpl_view *view, const lc_light *lights, uint32_t n, uint64_t seed,
                         double *weights)
{
    const lc_context *ctx = view->scene->ctx;
    double *sorted = lc_alloc_raw(ctx, n, sizeof *sorted);
    job j = { .view = view, .lights = lights, .n = n, .seed = seed, .worth = weights };
    if (!sorted) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < n; i++) weights[i] = 0;
    lc_parallel(ctx, (n + BLOCK - 1) / BLOCK, try_block, &j);
    vouch(weights, n);
    double enough = WORTH * median_worth(weights, sorted, n);
    for (uint32_t i = 0; i < n; i++)
        weights[i] = enough > 0 ? fmin(fmax(weights[i] / enough, LC_LEAST_WEIGHT), 1) : 1;
    lc_free(ctx, sorted, n, sizeof *sorted);
    return LC_OK;
}
