/* env_importance.c - traces shadow rays from visible points towards each direction, in parallel over blocks
 * of lights. */
#include "prepare/env_importance.h"

#include "base/pool.h"
#include "base/rng.h"
#include "scene/view.h"
#include "shade/point_init.h"
#include "trace/bvh.h"

#include <stdlib.h>

#define BLOCK 64                /* lights whose shadow rays are traced together from a point */
#define POINTS LC_SIZE(256, 16) /* points of a view that a block's lights are scored at */
#define GROUP 8                 /* neighbouring directions over which importance is smoothed */
#define FULL_WEIGHT 0.5         /* fraction of the median importance from which on the weight is 1 */

typedef struct job {
    const lc_view_grid *view;
    const lc_light *lights;
    uint32_t n, points; /* points: at which each is scored */
    uint64_t seed;
    double *importance; /* n */
} job;

/* Adds the contributions of lights first .. first + n - 1, with unit irradiance, to one point. */
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
        f[m] = lc_unoccluded_luminance(j->view->scene->ctx->shade_kernels, &j->view->points[point], &light,
                                       &rec);
        if (!(f[m] > 0)) continue;
        for (int c = 0; c < 3; c++) to[c][m] = rec.pos[c];
        at[m++] = i;
    }
    if (m) bvh->kernels->hidden(&bvh->data, j->view->org[point], m, target, true, hidden, NULL);
    for (uint32_t k = 0; k < m; k++)
        if (!hidden[k]) j->importance[at[k]] += (double)f[k];
}

static void try_block(void *user, uint32_t thread, uint64_t item)
{
    job *j = user;
    uint32_t first = (uint32_t)item * BLOCK, n = j->n - first < BLOCK ? j->n - first : BLOCK,
             all = j->view->n;
    (void)thread;
    for (uint32_t k = 0; k < j->points; k++) {
        uint32_t from = (uint32_t)((uint64_t)all * k / j->points),
                 to = (uint32_t)((uint64_t)all * (k + 1) / j->points);
        if (to > from) try_point(j, first, n, from + (uint32_t)(lc_hash4(j->seed, item, k, 6) % (to - from)));
    }
}

static int rising(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The median of the positive values, 0 if there is none. sorted: scratch of n. */
static double median_importance(const double *importance, double *sorted, uint32_t n)
{
    uint32_t m = 0;
    for (uint32_t i = 0; i < n; i++)
        if (importance[i] > 0) sorted[m++] = importance[i];
    qsort(sorted, m, sizeof *sorted, rising);
    return m ? sorted[m / 2] : 0;
}

/* Averages each value with the mean of its group: a direction occluded at all its sample points may be
 * visible from others, the more likely the more its neighbours are. */
static void smooth(double *importance, uint32_t n)
{
    for (uint32_t from = 0; from < n; from += GROUP) {
        uint32_t to = from + GROUP < n ? from + GROUP : n;
        double mean = 0;
        for (uint32_t i = from; i < to; i++) mean += importance[i] / (to - from);
        for (uint32_t i = from; i < to; i++) importance[i] = (importance[i] + mean) / 2;
    }
}

lc_status lc_env_importance(const lc_view_grid *view, const lc_light *lights, uint32_t n, uint64_t seed,
                         double *weights)
{
    const lc_context *ctx = view->scene->ctx;
    double *sorted = lc_alloc_raw(ctx, n, sizeof *sorted);
    job j = { .view = view, .lights = lights, .n = n, .seed = seed, .importance = weights };
    j.points = (uint32_t)(POINTS * sqrt(lc_view_count(view->scene)));
    if (!sorted) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < n; i++) weights[i] = 0;
    lc_parallel(ctx, (n + BLOCK - 1) / BLOCK, try_block, &j);
    smooth(weights, n);
    double enough = FULL_WEIGHT * median_importance(weights, sorted, n);
    for (uint32_t i = 0; i < n; i++)
        weights[i] = enough > 0 ? fmin(fmax(weights[i] / enough, LC_MIN_ENV_WEIGHT), 1) : 1;
    lc_free(ctx, sorted, n, sizeof *sorted);
    return LC_OK;
}
