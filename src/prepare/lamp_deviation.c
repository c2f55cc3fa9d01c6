/* lamp_deviation.c - how far points of the picture are off because lights stand for parts of lamps.
 *
 * At some of the points that the camera sees, the sum over all lights is compared with that over four times
 * as many, of the four parts of each patch, all with shadows; spheres, whose shadow rays end at one of their
 * points, with the mean of several. The difference is about the error of the coarser sum: that of the finer
 * one is half to a quarter of it.
 *
 * Of very many patches one in `step` is looked at. With s the sum of their differences d at a point, and s2
 * that of d^2, all together are off by about sqrt(f) s over their sum, where f is between 1, if all d are
 * alike, and 1 / step, if they are independent: s^2 = s2 on average tells that,
 *
 *     f = 1 - (1 - 1 / step) s2 / s^2, both summed over all points
 */
#include "prepare/lamp_patches.h"

#include "base/pool.h"
#include "base/rng.h"
#include "shade/light_target.h"
#include "shade/point_init.h"

#include <math.h>
#include <stdlib.h>

#define WORK       ((double)LC_SIZE(1 << 22, 1 << 12)) /* rays over all points, about */
#define MIN_POINTS ((double)LC_SIZE(24, 2))
#define MAX_POINTS 256.0
#define PARTS      4    /* of a patch; points of a sphere */
#define FLOOR      0.02 /* of the mean: what errors are relative to at least */
#define BATCH      64   /* rays */
#define MOST_ALL   LC_SIZE(1 << 18, 1 << 8) /* patches of which all are looked at; beyond them, about a ... */
#define FEWER      4                        /* ... of as many, to have set up a million in seconds */

typedef struct {
    const lc_patches *m;
    lc_light (*lights)[1 + PARTS]; /* of each patch; of a triangle's also those of its parts */
    /* Of each point: over the lights, over those of the parts, and of the squared differences of patches. */
    double (*sum)[3];
    uint32_t n;
    size_t step, n_used; /* one of each `step` patches */
} deviation;

/* The rays of a point that are still to be traced. */
typedef struct {
    const lc_patches *m;
    const lc_point *p;
    const float *org;
    double *sum;
    uint32_t n;
    float to[3][BATCH];
    double weight[BATCH][2]; /* what is added to the sums where the ray meets nothing */
    size_t patch, of[BATCH]; /* the one that is being added; those of the rays, in rising order */
    double difference;       /* of the one that was traced last, so far */
    size_t last;
} rays;

static void end_patch(rays *r)
{
    r->sum[2] += r->difference * r->difference;
    r->difference = 0;
}

static void trace(rays *r)
{
    const lc_visibility *v = &r->m->scene->visibility;
    const float *const target[3] = { r->to[0], r->to[1], r->to[2] };
    uint8_t hidden[BATCH];
    if (!r->n) return;
    v->hidden(v->scene, r->org, r->n, target, false, hidden, NULL);
    for (uint32_t i = 0; i < r->n; i++) {
        if (r->of[i] != r->last) end_patch(r);
        r->last = r->of[i];
        for (int k = 0; k < 2 && !hidden[i]; k++) r->sum[k] += r->weight[i][k];
        if (!hidden[i]) r->difference += r->weight[i][0] - r->weight[i][1];
    }
    r->n = 0;
}

static void add(rays *r, lc_f3 to, double coarse, double fine)
{
    if (!(coarse > 0 || fine > 0)) return;
    r->to[0][r->n] = to.x;
    r->to[1][r->n] = to.y;
    r->to[2][r->n] = to.z;
    r->weight[r->n][0] = coarse;
    r->weight[r->n][1] = fine;
    r->of[r->n] = r->patch;
    if (++r->n == BATCH) trace(r);
}

/* Luminance that a light gives to a white point times pi, shadows ignored; balls emit all round. */
static double given(const lc_light *light, const lc_point *p)
{
    const lc_f3 d = lc_f3_sub(light->pos, lc_f3_load(p->pos));
    const double d2 = fmax((double)lc_f3_dot(d, d), (double)p->min_d2),
                 in = fmax((double)lc_f3_dot(d, lc_f3_load(p->n)), 0),
                 out = light->kind == LC_LIGHT_ORIENTED ? fmax(-(double)lc_f3_dot(d, light->dir), 0)
                                                        : sqrt(d2);
    return (double)lc_luminance(light->intensity) * in * out / (d2 * d2);
}

static void add_ball(rays *r, const lc_light *ball, uint32_t turn)
{
    const double f = given(ball, r->p);
    lc_light_rec rec;
    lc_light_rec_init(&rec, ball);
    for (uint32_t i = 0; i < PARTS; i++) {
        lc_point p = *r->p;
        float to[3];
        p.turn = lc_turn(i, turn);
        lc_ball_target(&rec, &p, to);
        add(r, lc_f3_load(to), i ? 0 : f, f / PARTS);
    }
}

static void make_lights(void *user, uint32_t thread, uint64_t item)
{
    const deviation *d = user;
    lc_patch part[PARTS];
    (void)thread;
    /* One of each `step` in a row: every fourth would be the same part of each patch that was divided. */
    const size_t first = item * d->step, left = d->m->n - first, n = left < d->step ? left : d->step;
    const lc_patch *patch = &d->m->patches[first + lc_hash2(d->m->seed, item) % n];
    d->lights[item][0] = lc_patch_light(d->m, patch);
    if (d->lights[item][0].kind != LC_LIGHT_ORIENTED) return;
    lc_patch_divide(patch, part);
    for (int i = 0; i < PARTS; i++) d->lights[item][1 + i] = lc_patch_light(d->m, &part[i]);
}

static void sum_point(void *user, uint32_t thread, uint64_t item)
{
    const deviation *d = user;
    const lc_patches *m = d->m;
    const double jitter = (double)item * 0.6180339887498949; /* or the points could be in few columns */
    const size_t at = (size_t)(((double)item + (jitter - floor(jitter))) * m->view.n / d->n);
    rays r = { .m = m, .p = &m->view.points[at], .org = m->view.org[at], .sum = d->sum[item] };
    (void)thread;
    for (size_t i = 0; i < d->n_used; i++) {
        const lc_light *light = d->lights[i];
        r.patch = i;
        if (light->kind != LC_LIGHT_ORIENTED) add_ball(&r, light, (uint32_t)item);
        else
            for (int k = 0; k <= PARTS; k++) {
                const double f = given(&light[k], r.p);
                add(&r, light[k].pos, k ? 0 : f, k ? f : 0);
            }
    }
    trace(&r);
    end_patch(&r);
}

/* The root of f: by this the relative differences of the patches looked at become those of all. */
static double of_all(const deviation *d)
{
    double s2 = 0, squares = 0;
    for (uint32_t i = 0; i < d->n && d->step > 1; i++) {
        const double of2 = d->sum[i][1] * d->sum[i][1], off = d->sum[i][0] - d->sum[i][1];
        s2 += of2 > 0 ? off * off / of2 : 0;
        squares += of2 > 0 ? d->sum[i][2] / of2 : 0;
    }
    const double f = s2 > 0 ? 1 - (1 - 1 / (double)d->step) * squares / s2 : 1;
    return sqrt(fmax(f, 1 / (double)d->step));
}

static int rising(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Of the points, rising. */
static void find_quantiles(const deviation *d, double *off, lc_lamp_error *out)
{
    const double all = of_all(d);
    double mean = 0;
    for (uint32_t i = 0; i < d->n; i++) mean += d->sum[i][1] / d->n;
    for (uint32_t i = 0; i < d->n; i++)
        off[i] = mean > 0 ? fabs(d->sum[i][0] - d->sum[i][1]) / fmax(d->sum[i][1], FLOOR * mean) : 0;
    for (uint32_t i = 0; i < d->n; i++) off[i] *= all;
    qsort(off, d->n, sizeof *off, rising);
    *out = (lc_lamp_error){ d->n, off[d->n / 2], off[(uint32_t)(0.95 * d->n)] };
}

lc_status lc_patches_deviation(const lc_patches *m, lc_lamp_error *out)
{
    const lc_context *ctx = m->scene->ctx;
    deviation d = { .m = m, .step = m->n > MOST_ALL ? m->n / (MOST_ALL / FEWER) : 1 };
    d.n_used = (m->n + d.step - 1) / d.step;
    d.n = (uint32_t)fmin(fmax(WORK / ((double)d.n_used * (1 + PARTS)), MIN_POINTS), MAX_POINTS);
    if (d.n > m->view.n) d.n = m->view.n;
    *out = (lc_lamp_error){ .n_points = 0 };
    if (!d.n || !m->n) return LC_OK;
    d.lights = lc_alloc_raw(ctx, d.n_used, sizeof *d.lights);
    d.sum = lc_alloc(ctx, d.n, sizeof *d.sum);
    double *off = lc_alloc(ctx, d.n, sizeof *off);
    const lc_status st = d.lights && d.sum && off ? LC_OK : LC_ERR_MEMORY;
    if (!st) {
        lc_parallel(ctx, d.n_used, make_lights, &d);
        lc_parallel(ctx, d.n, sum_point, &d);
        find_quantiles(&d, off, out);
    }
    lc_free(ctx, d.lights, d.n_used, sizeof *d.lights);
    lc_free(ctx, d.sum, d.n, sizeof *d.sum);
    lc_free(ctx, off, d.n, sizeof *off);
    return st;
}
