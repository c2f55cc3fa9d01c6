/* sky_deviation.c - see sky_deviation.h.
 *
 * Of a block, disc i is off by d_i: the mean over the block's points and the disc's directions of what
 * arrives, less the same over directions of its part of the map. Edges of what hides the sky cross few of the
 * parts, each in its own way, so the block is off by the root of f sum d_i^2, where f is 1 if the d_i are
 * independent, and more along an edge of the world that is one of the map: 1 + sum d_i d_j / sum d_i^2,
 * i != j, by all blocks together. In the same way the grain of a pixel follows from the variance of each disc
 * over its directions. Measured with all discs at once: tests/results/virtual-lights.md.
 *
 * Of the discs some are drawn by what they shed without shadows. A ray from each point tells which are hidden
 * in part; these are compared, and stand for those that looked whole though they are not: a disc of which a
 * share v is seen looks so with v^4 + (1 - v)^4. What the directions that are tried of a part are off by
 * counts, too.
 */
#include "prepare/sky_deviation.h"

#include "base/arena.h"
#include "base/pool.h"
#include "base/rng.h"
#include "cut/cut.h"
#include "scene/lit_point.h"
#include "shade/light_target.h"
#include "shade/point_init.h"

#include <math.h>
#include <string.h>

#define SIDE        LC_SIZE(8, 4)          /* blocks a side of the picture */
#define DRAWN       LC_SIZE(1024, 16)      /* discs of a block */
#define LEAST_FOUND 0.1                    /* chance of a disc to look hidden in part; chosen */
#define MOST        (2 * LC_TARGET_POINTS) /* rays of a point together */
#define BATCH       64                     /* lights at a time */
#define DARK        0.02 /* of the mean: the least luminance that a deviation is taken of */

lc_status lc_sky_deviation_init(lc_sky_deviation *d, const lc_scene *scene, uint32_t max_depth, uint64_t seed)
{
    *d = (lc_sky_deviation){ .light = NULL };
    const lc_status st = lc_view_blocks_init(&d->blocks, scene, SIDE, max_depth, seed);
    if (st) return st;
    d->light = lc_alloc(scene->ctx, d->blocks.n, sizeof *d->light);
    d->variance = lc_alloc(scene->ctx, d->blocks.n, sizeof *d->variance);
    d->grain = lc_alloc(scene->ctx, d->blocks.n, sizeof *d->grain);
    d->cross = lc_alloc(scene->ctx, d->blocks.n, sizeof *d->cross);
    return d->light && d->variance && d->grain && d->cross ? LC_OK : LC_ERR_MEMORY;
}

void lc_sky_deviation_free(lc_sky_deviation *d)
{
    if (!d->blocks.scene) return;
    lc_free(d->blocks.scene->ctx, d->light, d->blocks.n, sizeof *d->light);
    lc_free(d->blocks.scene->ctx, d->variance, d->blocks.n, sizeof *d->variance);
    lc_free(d->blocks.scene->ctx, d->grain, d->blocks.n, sizeof *d->grain);
    lc_free(d->blocks.scene->ctx, d->cross, d->blocks.n, sizeof *d->cross);
    lc_view_blocks_free(&d->blocks);
}

typedef struct job {
    lc_sky_deviation *d;
    const lc_sky_parts *parts;
    lc_tree_data data; /* the lights alone, as if of one tree */
    float **shed; /* of threads: of each disc, luminance at a block without shadows */
} job;

/* ---- rays ---- */

/* One direction of a disc or of its part. */
typedef struct {
    lc_light_kind kind;
    lc_light_rec rec;
    uint32_t turn;
} beam;

/* i: 0 .. LC_TARGET_POINTS - 1, each of another direction. */
static beam beam_of_disc(const job *j, uint64_t block, uint32_t light, uint32_t i)
{
    const uint32_t turn = (uint32_t)(lc_hash4(j->d->blocks.seed, block, light, 9) >> 59);
    return (beam){ .kind = LC_LIGHT_SKY, .rec = j->data.lights[light], .turn = turn + i * LC_TARGET_STEP };
}

static double frac(double x) { return x - floor(x); }

/* Directions i = 0, 1 ... are spread evenly together. */
static beam beam_of_part(const job *j, uint64_t block, uint32_t light, uint32_t i)
{
    const uint64_t hash = lc_hash4(j->d->blocks.seed, block, light, 10);
    const double u[2] = { frac(lc_unit(hash) + i * 0.7548776662466927), /* the R2 sequence */
                          frac(lc_unit(lc_mix(hash)) + i * 0.5698402909980532) };
    float to[3];
    beam b = { .kind = LC_LIGHT_DIRECTIONAL };
    j->parts->direction(j->parts->map, light, u, to);
    const lc_light ray = { .kind = b.kind, .dir = lc_f3_neg(lc_f3_load(to)),
                           .intensity = j->parts->lights[light].intensity };
    lc_light_rec_init(&b.rec, &ray);
    return b;
}

/* Sets arrives[] to the luminance of a block that arrives by each of n beams at its point k; returns how many
 * are hidden. */
static uint32_t trace(const job *j, uint64_t block, uint32_t light, uint32_t k, const lc_point *p,
                      const beam *b, uint32_t n, double *arrives)
{
    const lc_view_blocks *blocks = &j->d->blocks;
    const lc_scene *scene = blocks->scene;
    const size_t at = block * LC_BLOCK_POINTS + k;
    const double weight = (double)blocks->weight[at];
    lc_point q = *lc_point_for(p, LC_LIGHT_SKY);
    float to[3][MOST], thr[3][MOST], way[3];
    float *const through[3] = { thr[0], thr[1], thr[2] };
    const float *const target[3] = { to[0], to[1], to[2] };
    uint8_t hidden[MOST];
    uint32_t n_hidden = 0;
    for (uint32_t i = 0; i < n; i++) {
        q.turn = b[i].turn;
        lc_light_target(b[i].kind, &b[i].rec, &q, way);
        for (int c = 0; c < 3; c++) to[c][i] = way[c];
    }
    const bool dims = lc_cut_hidden(&scene->visibility, p, blocks->lit[at].surface.ray_org, n, target, true,
                                    hidden, NULL, through);
    for (uint32_t i = 0; i < n; i++) {
        arrives[i] = 0;
        n_hidden += hidden[i];
        if (hidden[i]) continue;
        q.turn = b[i].turn;
        const lc_f3 f = lc_estimate_one(scene->ctx->shade_kernels, &q, b[i].kind, &b[i].rec, NULL);
        arrives[i] = weight * (double)lc_luminance(lc_f3_mul(f, j->parts->lights[light].intensity));
        if (dims) arrives[i] *= (double)lc_luminance(lc_f3_make(thr[0][i], thr[1][i], thr[2][i]));
    }
    return n_hidden;
}

/* Of a disc at a block: its luminance, d_i, and the variance of a pixel's luminance by its directions; the
 * chance that these are found. */
typedef struct {
    double light, off, grain, found;
} effect;

/* Sets its light by a ray from each point. True: it looks hidden in part. */
static bool looks_partial(const job *j, uint64_t block, uint32_t light, lc_point p[][2], effect *out)
{
    uint32_t n_hidden = 0, n = 0;
    double arrives;
    *out = (effect){ .found = 1 };
    for (uint32_t k = 0; k < LC_BLOCK_POINTS; k++) {
        if (!(j->d->blocks.weight[block * LC_BLOCK_POINTS + k] > 0)) continue;
        const beam b = beam_of_disc(j, block, light, k);
        n_hidden += trace(j, block, light, k, p[k], &b, 1, &arrives);
        n++;
        out->light += arrives;
    }
    return n_hidden && n_hidden < n;
}

/* Sets the rest by all directions of the disc at each point, and as many of its part. */
static void compare(const job *j, uint64_t block, uint32_t light, lc_point p[][2], effect *out)
{
    const uint32_t n = LC_TARGET_POINTS;
    beam b[MOST];
    double arrives[MOST], n_points = 0, seen = 0;
    for (uint32_t k = 0; k < LC_BLOCK_POINTS; k++) {
        double mean = 0, squares = 0;
        if (!(j->d->blocks.weight[block * LC_BLOCK_POINTS + k] > 0)) continue;
        for (uint32_t i = 0; i < n; i++) {
            b[i] = beam_of_disc(j, block, light, i);
            b[n + i] = beam_of_part(j, block, light, k * n + i);
        }
        trace(j, block, light, k, p[k], b, 2 * n, arrives);
        for (uint32_t i = 0; i < n; i++) {
            mean += arrives[i] / n;
            squares += arrives[i] * arrives[i] / n;
            out->off -= arrives[n + i] / n;
            seen += arrives[i] > 0 ? 1.0 / n : 0;
        }
        n_points++;
        out->off += mean;
        out->grain += (squares - mean * mean) * LC_BLOCK_POINTS; /* a point is so much of a block's light */
    }
    const double v = seen / n_points;
    out->found = fmax(1 - pow(v, n_points) - pow(1 - v, n_points), LEAST_FOUND);
}

/* ---- blocks ---- */

/* What all lights shed on a point without shadows, from one direction each. */
static void add_shed(const job *j, const lc_point *p, uint32_t turn, float weight, float *shed)
{
    lc_point q = *lc_point_for(p, LC_LIGHT_SKY);
    _Alignas(64) float f[6][BATCH];
    float *const out[6] = { f[0], f[1], f[2], f[3], f[4], f[5] };
    q.turn = turn;
    for (uint32_t first = 0, n; first < j->parts->n; first += n) {
        n = j->parts->n - first < BATCH ? j->parts->n - first : BATCH;
        j->d->blocks.scene->ctx->shade_kernels->estimate(&j->data, first, NULL, n, LC_LIGHT_SKY, &q, out);
        for (uint32_t i = 0; i < n; i++) {
            const lc_f3 to = lc_f3_mul(lc_f3_make(f[0][i], f[1][i], f[2][i]),
                                       j->parts->lights[first + i].intensity);
            shed[first + i] += weight * lc_luminance(to);
        }
    }
}

static void add_block(void *user, uint32_t thread, uint64_t item)
{
    const job *j = user;
    const lc_view_blocks *blocks = &j->d->blocks;
    const size_t first = item * LC_BLOCK_POINTS;
    lc_point p[LC_BLOCK_POINTS][2];
    float *shed = j->shed[thread];
    double all = 0, before = 0, sum = 0;
    memset(shed, 0, j->parts->n * sizeof *shed);
    for (size_t k = 0; k < LC_BLOCK_POINTS; k++) {
        if (!(blocks->weight[first + k] > 0)) continue;
        lc_lit_point(blocks->scene, &blocks->lit[first + k], 0, p[k]);
        add_shed(j, p[k], (uint32_t)k * LC_TARGET_STEP, blocks->weight[first + k], shed);
    }
    for (uint32_t i = 0; i < j->parts->n; i++) all += (double)shed[i];
    if (!(all > 0)) return;
    const double jitter = lc_unit(lc_hash4(blocks->seed, item, j->parts->n, 12));
    for (uint32_t i = 0, drawn = 0; i < j->parts->n && drawn < DRAWN; i++) {
        effect e;
        uint32_t times = 0;
        before += (double)shed[i];
        for (; drawn < DRAWN && (drawn + jitter) / DRAWN * all < before; drawn++) times++;
        if (!times) continue;
        if (looks_partial(j, item, i, p, &e)) compare(j, item, i, p, &e);
        const double stands_for = times * all / ((double)shed[i] * DRAWN), of_off = stands_for / e.found;
        j->d->light[item] += stands_for * e.light;
        j->d->variance[item] += of_off * e.off * e.off;
        j->d->grain[item] += of_off * e.grain;
        j->d->cross[item] -= of_off * e.off * of_off * e.off;
        sum += of_off * e.off;
    }
    j->d->cross[item] += sum * sum;
}

lc_status lc_sky_deviation_add(lc_sky_deviation *d, const lc_sky_parts *parts)
{
    const lc_context *ctx = d->blocks.scene->ctx;
    job j = { .d = d, .parts = parts };
    lc_status st = LC_OK;
    j.data.lights = lc_alloc_raw(ctx, parts->n, sizeof *j.data.lights);
    j.shed = lc_alloc(ctx, ctx->n_threads, sizeof *j.shed);
    if (!j.data.lights || !j.shed) st = LC_ERR_MEMORY;
    for (uint32_t t = 0; t < ctx->n_threads && !st; t++)
        if (!(j.shed[t] = lc_alloc_raw(ctx, parts->n, sizeof **j.shed))) st = LC_ERR_MEMORY;
    for (uint32_t i = 0; i < parts->n && !st; i++) lc_light_rec_init(&j.data.lights[i], &parts->lights[i]);
    if (!st) lc_parallel(ctx, d->blocks.n, add_block, &j);
    for (uint32_t t = 0; t < ctx->n_threads && j.shed; t++)
        lc_free(ctx, j.shed[t], parts->n, sizeof **j.shed);
    lc_free(ctx, j.shed, ctx->n_threads, sizeof *j.shed);
    lc_free(ctx, j.data.lights, parts->n, sizeof *j.data.lights);
    return st;
}

/* Sets a median and 95th percentile of deviations relative to the light of blocks, by their variances. */
static void find_percentiles(const lc_sky_deviation *d, double *variance, double *median, double *high)
{
    double total = 0;
    uint32_t n = 0;
    for (uint32_t i = 0; i < d->blocks.n; i++) total += d->light[i];
    for (uint32_t i = 0; i < d->blocks.n; i++)
        if (d->light[i] > 0)
            variance[n++] = sqrt(fmax(variance[i], 0)) / fmax(d->light[i], DARK * total / d->blocks.n);
    *median = n ? lc_normal_percentile(variance, n, 0.5) : 0;
    *high = n ? lc_normal_percentile(variance, n, 0.95) : 0;
}

/* The f of the head. */
static double factor(const lc_sky_deviation *d)
{
    double sum = 0;
    uint32_t n = 0;
    for (uint32_t i = 0; i < d->blocks.n; i++) {
        if (!(d->variance[i] > 0)) continue;
        sum += d->cross[i] / d->variance[i];
        n++;
    }
    return n ? fmax(1 + sum / n, 1) : 1;
}

void lc_sky_deviation_find(lc_sky_deviation *d, lc_sky_error *out)
{
    const double off = sqrt(factor(d));
    *out = (lc_sky_error){ .n_blocks = 0 };
    for (uint32_t i = 0; i < d->blocks.n; i++) out->n_blocks += d->light[i] > 0;
    find_percentiles(d, d->variance, &out->median, &out->high);
    find_percentiles(d, d->grain, &out->grain_median, &out->grain_high);
    out->median *= off;
    out->high *= off;
}
