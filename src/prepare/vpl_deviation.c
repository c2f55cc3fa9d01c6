/* vpl_deviation.c - see vpl_deviation.h. */
#include "prepare/vpl_deviation.h"

#include "base/arena.h"
#include "base/pool.h"
#include "base/rng.h"
#include "cut/cut.h"
#include "scene/lit_point.h"
#include "shade/point_init.h"
#include "tree/light_tree.h"

#include <string.h>

#define SIDE LC_SIZE(16, 4)           /* blocks a side of the picture; see lc_view_side */
#define MOST_USED LC_SIZE(32768, 64) /* virtual lights looked at */
#define BATCH 64                      /* lights at a time */
#define DRAWN LC_SIZE(64, 4)          /* paths drawn for shadow rays, for each of the three sums */
#define MIN_HARD 0.0625f              /* an unclamped light's d^2 is at least r^2 / 16, so d >= r / 4 */
#define DARK 0.02                     /* of the mean: the least luminance that a deviation is taken of */
#define DIRECT_ERROR 0.05f            /* of clusters */
#define DIRECT_CUT 400

/* ---- points ---- */

typedef struct finder {
    lc_vpl_deviation *d;
    lc_cut *cuts; /* of threads */
    lc_stats *stats;
} finder;

static void find_direct(void *user, uint32_t thread, uint64_t item)
{
    finder *f = user;
    lc_vpl_deviation *d = f->d;
    for (size_t i = item * LC_BLOCK_POINTS; i < (item + 1) * LC_BLOCK_POINTS; i++) {
        lc_point p[2];
        lc_cut_result r;
        if (!(d->blocks.weight[i] > 0)) continue;
        const lc_lit *lit = &d->blocks.lit[i];
        const uint64_t hash = lc_hash2(d->blocks.seed, i);
        lc_lit_point(d->blocks.scene, lit, hash, p);
        lc_cut_shade(&f->cuts[thread], p, lit->surface.ray_org, hash, &f->stats[thread], &r);
        d->direct[item] += (double)(d->blocks.weight[i] * lc_luminance(r.radiance));
    }
}

static lc_status find_by_tree(finder *f, const lc_light_tree *tree)
{
    const lc_scene *s = f->d->blocks.scene;
    const uint32_t n_threads = s->ctx->n_threads;
    const lc_cut_desc desc = { .error_ratio = DIRECT_ERROR, .max_cut = DIRECT_CUT };
    lc_status st = LC_OK;
    f->cuts = lc_alloc(s->ctx, n_threads, sizeof *f->cuts);
    f->stats = lc_alloc(s->ctx, n_threads, sizeof *f->stats);
    if (!f->cuts || !f->stats) st = LC_ERR_MEMORY;
    for (uint32_t t = 0; t < n_threads && !st; t++)
        st = lc_cut_init(&f->cuts[t], s->ctx, tree, &s->visibility, &desc, false);
    if (!st) lc_parallel(s->ctx, f->d->blocks.n, find_direct, f);
    for (uint32_t t = 0; t < n_threads && f->cuts; t++) lc_cut_free(&f->cuts[t]);
    lc_free(s->ctx, f->cuts, n_threads, sizeof *f->cuts);
    lc_free(s->ctx, f->stats, n_threads, sizeof *f->stats);
    return st;
}

lc_status lc_vpl_deviation_init(lc_vpl_deviation *d, const lc_scene *scene, uint32_t max_depth,
                                uint64_t seed)
{
    const lc_context *ctx = scene->ctx;
    finder f = { .d = d };
    lc_light_tree *tree = NULL;
    *d = (lc_vpl_deviation){ .points = NULL };
    lc_status st = lc_view_blocks_init(&d->blocks, scene, SIDE, max_depth, seed);
    if (st) return st;
    d->points = lc_alloc_raw(ctx, (size_t)d->blocks.n * LC_BLOCK_POINTS, sizeof *d->points);
    d->direct = lc_alloc(ctx, d->blocks.n, sizeof *d->direct);
    if (!d->points || !d->direct) return LC_ERR_MEMORY;
    const lc_light_tree_desc desc = { .lights = scene->lights,
                                      .n_lights = scene->n_lights,
                                      .spot_maps = scene->spot_maps,
                                      .profiles = &scene->profiles,
                                      .diag2 = scene->diag2,
                                      .seed = seed,
                                      .n_reps = 1,
                                      .builder = LC_BUILDER_PLOC };
    st = lc_light_tree_build(ctx, &desc, &tree);
    if (!st) st = find_by_tree(&f, tree);
    lc_light_tree_destroy(tree);
    return st;
}

void lc_vpl_deviation_free(lc_vpl_deviation *d)
{
    const lc_context *ctx = d->blocks.scene->ctx;
    lc_free(ctx, d->points, (size_t)d->blocks.n * LC_BLOCK_POINTS, sizeof *d->points);
    lc_free(ctx, d->direct, d->blocks.n, sizeof *d->direct);
    lc_view_blocks_free(&d->blocks);
}

/* ---- contributions ---- */

typedef struct job {
    const lc_vpl_deviation *d;
    lc_tree_data data; /* the lights alone, in the order of their paths, as if of one tree */
    float *in[3], *radius2;   /* n_lights: intensity, r^2 of clamping */
    size_t n_lights, n_paths; /* n_paths: those that have lights */
    uint32_t *path;           /* n_lights: which of these */
    uint32_t *first;          /* n_paths + 1: their lights */
    bool unclamped;           /* what clamping removes, in place of what it leaves */
    float **scratch; /* of threads, n_paths: contributions to a block, shadows ignored */
    double *mean, *square, *lost; /* n_blocks: sum X, sum X^2, and what clamping removes; with shadows */
} job;

/* Turns contributions into what clamping removes of them. */
static void to_lost(const job *j, const lc_point *p, uint32_t first, uint32_t n, float to[3][BATCH],
                    float f[BATCH])
{
    const float *a = j->radius2 + first, at[3] = { p->pos[0], p->pos[1], p->pos[2] };
    for (uint32_t i = 0; i < n; i++) {
        const float x = to[0][i] - at[0], y = to[1][i] - at[1], z = to[2][i] - at[2];
        const float d2 = x * x + y * y + z * z, far2 = d2 > LC_MIN_D2 ? d2 : LC_MIN_D2;
        const float least = far2 > a[i] * MIN_HARD ? far2 : a[i] * MIN_HARD;
        f[i] *= (far2 + a[i]) / least - 1;
    }
}

/* Lights first .. first + n - 1 at a point, n <= BATCH: luminance of each, and where shadow rays go. */
static void at_point(const job *j, size_t point, uint32_t first, uint32_t n, float value[BATCH],
                     float to[3][BATCH])
{
    _Alignas(64) float f[3][BATCH];
    float *const out[6] = { f[0], f[1], f[2], to[0], to[1], to[2] };
    const lc_point *p = &j->d->points[point];
    const float *r = j->in[0] + first, *g = j->in[1] + first, *b = j->in[2] + first;
    const float weight = j->d->blocks.weight[point];
    j->d->blocks.scene->ctx->shade_kernels->estimate(&j->data, first, NULL, n, LC_LIGHT_VIRTUAL, p, out);
    for (uint32_t i = 0; i < n; i++)
        f[0][i] = weight * lc_luminance(lc_f3_make(f[0][i] * r[i], f[1][i] * g[i], f[2][i] * b[i]));
    memcpy(value, f[0], n * sizeof *value);
    if (j->unclamped) to_lost(j, p, first, n, to, value);
}

static void add_point(const job *j, size_t point, float *sums)
{
    float value[BATCH], to[3][BATCH];
    if (!(j->d->blocks.weight[point] > 0)) return;
    for (uint32_t first = 0, n; first < j->n_lights; first += n) {
        n = (uint32_t)(j->n_lights - first < BATCH ? j->n_lights - first : BATCH);
        at_point(j, point, first, n, value, to);
        for (uint32_t i = 0; i < n; i++) sums[j->path[first + i]] += value[i];
    }
}

/* What a path contributes to a block, shadows included. */
static double with_shadows(const job *j, uint64_t block, uint32_t path)
{
    float value[BATCH], to[3][BATCH], thr[3][BATCH];
    float *const through[3] = { thr[0], thr[1], thr[2] };
    const float *const target[3] = { to[0], to[1], to[2] };
    uint8_t hidden[BATCH];
    const uint32_t first = j->first[path], n = j->first[path + 1] - first;
    double sum = 0;
    for (size_t p = block * LC_BLOCK_POINTS; p < (block + 1) * LC_BLOCK_POINTS; p++) {
        if (!(j->d->blocks.weight[p] > 0)) continue;
        at_point(j, p, first, n, value, to);
        const bool dims = lc_cut_hidden(&j->d->blocks.scene->visibility, &j->d->points[p],
                                        j->d->blocks.lit[p].surface.ray_org, n, target, false, hidden, NULL,
                                        through);
        for (uint32_t i = 0; i < n; i++) {
            if (hidden[i]) continue;
            const float t = dims ? lc_luminance(lc_f3_make(thr[0][i], thr[1][i], thr[2][i])) : 1;
            sum += (double)(t * value[i]);
        }
    }
    return sum;
}

static double power(double x, int exponent) { return exponent == 2 ? x * x : x; }

/* The sum over all paths of their contributions or the squares of these, with shadows: the sum without, times
 * the mean share that is left of DRAWN paths drawn by what they add to it. */
static double sum_with_shadows(const job *j, uint64_t block, const float *values, int exponent)
{
    double sum = 0, before = 0, left = 0;
    for (uint32_t i = 0; i < j->n_paths; i++) sum += power((double)values[i], exponent);
    if (!(sum > 0)) return 0;
    const double jitter = lc_unit(lc_hash4(j->d->blocks.seed, block, (uint64_t)exponent, 6 + j->unclamped));
    for (uint32_t i = 0, k = 0; i < j->n_paths && k < DRAWN; i++) {
        const double weight = power((double)values[i], exponent);
        uint32_t times = 0;
        before += weight;
        for (; k < DRAWN && (k + jitter) / DRAWN * sum < before; k++) times++;
        if (times && weight > 0)
            left += times * power(with_shadows(j, block, i), exponent) / weight;
    }
    return sum * left / DRAWN;
}

static void find_sums(void *user, uint32_t thread, uint64_t item)
{
    job *j = user;
    float *values = j->scratch[thread];
    const size_t first = item * LC_BLOCK_POINTS;
    memset(values, 0, j->n_paths * sizeof *values);
    for (size_t p = first; p < first + LC_BLOCK_POINTS; p++) add_point(j, p, values);
    if (j->unclamped) {
        j->lost[item] = sum_with_shadows(j, item, values, 1);
        return;
    }
    j->mean[item] = sum_with_shadows(j, item, values, 1);
    j->square[item] = sum_with_shadows(j, item, values, 2);
}

/* ---- percentiles ---- */

static void find_percentiles(job *j, double used, double n_paths, lc_indirect *out)
{
    const uint32_t n = j->d->blocks.n;
    double *off = j->square, total = 0;
    uint32_t n_seen = 0;
    for (uint32_t i = 0; i < n; i++) total += j->mean[i] + j->d->direct[i];
    for (uint32_t i = 0; i < n; i++) {
        const double variance = fmax(j->square[i] - j->mean[i] * j->mean[i] / used, 0) * used / n_paths;
        const double light = fmax(j->mean[i] + j->d->direct[i], DARK * total / n);
        if (!(j->mean[i] + j->d->direct[i] > 0)) continue;
        off[n_seen++] = sqrt(variance) / light;
    }
    out->median = n_seen ? lc_normal_percentile(off, n_seen, 0.5) : 0;
    out->high = n_seen ? lc_normal_percentile(off, n_seen, 0.95) : 0;
}

static void find_loss(job *j, lc_indirect *out)
{
    double mean = 0, lost = 0;
    j->unclamped = true;
    lc_parallel(j->d->blocks.scene->ctx, j->d->blocks.n, find_sums, j);
    for (uint32_t i = 0; i < j->d->blocks.n; i++) {
        mean += j->mean[i];
        lost += j->lost[i];
    }
    out->loss = mean + lost > 0 ? lost / (mean + lost) : 0;
}

/* ---- the whole ---- */

/* A point as the scene's virtual lights see it. */
static void see_virtuals(void *user, uint32_t thread, uint64_t item)
{
    lc_vpl_deviation *d = user;
    const lc_view_blocks *b = &d->blocks;
    (void)thread;
    if (b->weight[item] > 0) lc_lit_point_of_virtual(b->scene, &b->lit[item], &d->points[item]);
}

/* The lights as kernels read them, and where paths begin. */
static void load(job *j, const lc_light *lights, const uint32_t *path, double each)
{
    for (size_t i = 0; i < j->n_lights; i++) {
        lc_light light = lights[i];
        light.intensity = lc_f3_scale(light.intensity, (float)each);
        lc_light_rec_init(&j->data.lights[i], &light);
        memcpy(j->data.light_atten[i], light.atten, sizeof light.atten);
        j->data.light_shine[i] = light.shine;
        for (int k = 0; k < 3; k++) j->in[k][i] = j->data.lights[i].intensity[k];
        j->radius2[i] = light.atten[0];
        if (!i || path[i] != path[i - 1]) j->first[j->n_paths++] = (uint32_t)i;
        j->path[i] = (uint32_t)j->n_paths - 1;
    }
    j->first[j->n_paths] = (uint32_t)j->n_lights;
}

static lc_status make_scratch(job *j)
{
    const lc_context *ctx = j->d->blocks.scene->ctx;
    j->scratch = lc_alloc(ctx, ctx->n_threads, sizeof *j->scratch);
    for (uint32_t t = 0; t < ctx->n_threads && j->scratch; t++)
        if (!(j->scratch[t] = lc_alloc_raw(ctx, j->n_paths, sizeof **j->scratch))) return LC_ERR_MEMORY;
    return j->scratch ? LC_OK : LC_ERR_MEMORY;
}

static void free_job(job *j, size_t n)
{
    const lc_context *ctx = j->d->blocks.scene->ctx;
    for (uint32_t t = 0; t < ctx->n_threads && j->scratch; t++)
        lc_free(ctx, j->scratch[t], j->n_paths, sizeof **j->scratch);
    lc_free(ctx, j->scratch, ctx->n_threads, sizeof *j->scratch);
    lc_free(ctx, j->data.lights, n, sizeof *j->data.lights);
    lc_free(ctx, j->data.light_atten, n, sizeof *j->data.light_atten);
    lc_free(ctx, j->data.light_shine, n, sizeof *j->data.light_shine);
    lc_free(ctx, j->in[0], 4 * n, sizeof *j->in[0]);
    lc_free(ctx, j->path, n, sizeof *j->path);
    lc_free(ctx, j->first, n + 1, sizeof *j->first);
    lc_free(ctx, j->mean, 3 * (size_t)j->d->blocks.n, sizeof *j->mean);
}

lc_status lc_vpl_deviation_find(lc_vpl_deviation *d, const lc_light *lights, const uint32_t *path,
                                size_t n, uint64_t n_paths, double enough, lc_indirect *out)
{
    const lc_context *ctx = d->blocks.scene->ctx;
    job j = { .d = d, .n_lights = n };
    double used = (double)n_paths;
    if (!n) return LC_OK;
    if (n > MOST_USED) { /* whole paths; no path has as many lights as that */
        for (j.n_lights = MOST_USED; path[j.n_lights] == path[j.n_lights - 1];) j.n_lights--;
        used = path[j.n_lights];
    }
    const size_t n_used = j.n_lights;
    j.data.lights = lc_alloc_raw(ctx, n_used, sizeof *j.data.lights);
    j.data.light_atten = lc_alloc(ctx, n_used, sizeof *j.data.light_atten);
    j.data.light_shine = lc_alloc_raw(ctx, n_used, sizeof *j.data.light_shine);
    j.in[0] = lc_alloc_raw(ctx, 4 * n_used, sizeof *j.in[0]);
    j.path = lc_alloc_raw(ctx, n_used, sizeof *j.path);
    j.first = lc_alloc_raw(ctx, n_used + 1, sizeof *j.first);
    j.mean = lc_alloc(ctx, 3 * (size_t)d->blocks.n, sizeof *j.mean);
    const bool made = j.data.lights && j.data.light_atten && j.data.light_shine && j.in[0] && j.path &&
                      j.first && j.mean;
    lc_status st = made ? LC_OK : LC_ERR_MEMORY;
    if (made) {
        j.in[1] = j.in[0] + n_used;
        j.in[2] = j.in[1] + n_used;
        j.radius2 = j.in[2] + n_used;
        j.square = j.mean + d->blocks.n;
        j.lost = j.square + d->blocks.n;
        load(&j, lights, path, 1 / used);
        st = make_scratch(&j);
    }
    if (!st) {
        lc_parallel(ctx, (uint64_t)d->blocks.n * LC_BLOCK_POINTS, see_virtuals, d);
        lc_parallel(ctx, d->blocks.n, find_sums, &j);
        find_percentiles(&j, used, (double)n_paths, out);
        if (lc_indirect_deviation(out) <= enough) find_loss(&j, out);
    }
    free_job(&j, n_used);
    return st;
}
