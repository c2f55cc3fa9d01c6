/* calibrate.c - the factor z with which cuts keep the error that is asked of the finished pixel.
 *
 * A cut stops when z times the root of the sum of its squared bounds is within the asked error (cut.h). How
 * much of that root is real error differs from scene to scene, so z is found on pilots: some pixels of the
 * whole film, spread evenly, with all their samples.
 *
 *     truth    every light at every point; of many lights, or samples, a much finer cut
 *     value    the pixel by cuts of a z, which begin with the roots
 *     z        the least for which the asked share of pilots, and a margin, is within the error
 *
 * The pilots are the same whatever is rendered of the film.
 */
#include "render/render_job.h"

#include "base/pool.h"
#include "tree/light_tree.h"

#include <math.h>

#define N_PILOTS LC_SIZE(512, 64)
#define MARGIN 0.8        /* of the share that may be off, so much is used: pilots are a sample */
#define LEAST_Z (1 / 256.0)
#define MOST_Z 4.0
#define Z_STEP 1.5        /* from one z that is tried to the next, while the share is too small */
#define Z_HALVINGS 4      /* of the last step */
#define MAX_EXACT 40000.0 /* lights times samples of a pilot, all of which are evaluated */
#define TRUE_Z 2.0        /* of the finer cuts, for one sample */

typedef struct {
    lc_render_job *j;
    uint32_t *pixel;       /* x + y * width */
    double *truth, *value; /* luminance */
    double *to;            /* one of these */
    uint32_t n, n_finite;  /* n_finite: whose truth is finite */
} pilots;

static void place_pilots(pilots *p)
{
    const uint64_t width = p->j->scene->film.width, height = p->j->scene->film.height;
    const double step_x = 0.7548776662466927, step_y = 0.5698402909980532; /* the R2 sequence */
    for (uint32_t i = 0; i < p->n; i++) {
        const double u = 0.5 + i * step_x, v = 0.5 + i * step_y;
        const uint64_t x = (uint64_t)((u - floor(u)) * (double)width),
                       y = (uint64_t)((v - floor(v)) * (double)height);
        p->pixel[i] = (uint32_t)(p->n < width * height ? y * width + x : i);
    }
}

static void shade_pilot(void *user, uint32_t thread, uint64_t item)
{
    pilots *p = user;
    lc_render_job *j = p->j;
    const uint32_t width = j->scene->film.width, x = p->pixel[item] % width, y = p->pixel[item] / width;
    lc_pixel px = { .hits = 0 };
    lc_f3 rgb;
    for (uint32_t i = 0; i < j->spp; i++) {
        if (!lc_render_sample(j, &j->workers[thread], x, y, i, &px, &rgb)) return;
        px.rgb = lc_f3_add(px.rgb, rgb);
    }
    p->to[item] = (double)lc_luminance(px.rgb) / j->spp;
}

/* Shades all pilots by cuts of a z, or, with 0, by every light. */
static void shade_all(pilots *p, double z, double *to)
{
    lc_render_job *j = p->j;
    p->to = to;
    j->exact = !(z > 0);
    for (uint32_t i = 0; i < j->ctx->n_threads; i++) {
        j->workers[i].cut.desc.z = (float)z;
        j->workers[i].alone = true; /* a guide for each pilot would double the work */
    }
    lc_parallel(j->ctx, p->n, shade_pilot, p);
    j->exact = false;
}

static uint32_t n_within(const pilots *p, double error, double floor_lum)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < p->n; i++)
        n += isfinite(p->truth[i]) && fabs(p->value[i] - p->truth[i]) <= error * fmax(p->truth[i], floor_lum)
                 ? 1
                 : 0;
    return n;
}

/* The number of pilots within the error by cuts of a z. */
static uint32_t try_z(pilots *p, const lc_cut_desc *cut, double z)
{
    shade_all(p, z, p->value);
    return n_within(p, (double)cut->error_ratio, (double)cut->floor);
}

static void find_z(pilots *p, const lc_cut_desc *cut, lc_calibration *c)
{
    const double off = MARGIN * (1 - (double)c->within / 100);
    const uint32_t want = (uint32_t)ceil((1 - off) * p->n_finite);
    double hi = (double)cut->z, lo = hi;
    uint32_t n = try_z(p, cut, hi);
    while (n < want && hi < MOST_Z) {
        lo = hi;
        hi *= Z_STEP;
        n = try_z(p, cut, hi);
    }
    while (lo >= hi && hi > LEAST_Z) {
        const uint32_t m = try_z(p, cut, lo = hi / Z_STEP);
        if (m < want) break;
        hi = lo;
        n = m;
    }
    for (int i = 0; i < Z_HALVINGS && n >= want; i++) {
        const double z = sqrt(lo * hi);
        const uint32_t m = try_z(p, cut, z);
        if (m < want) lo = z;
        else {
            hi = z;
            n = m;
        }
    }
    c->z = (float)hi;
    c->n_within = n;
}

static lc_status shade_truth(pilots *p, const lc_cut_desc *cut)
{
    lc_render_job *j = p->j;
    const bool all = (double)j->scene->tree->n_lights * j->spp <= MAX_EXACT;
    lc_cut_desc fine = *cut;
    fine.max_cut = 0;
    lc_status st = lc_job_make_workers(j, &fine);
    if (!st) shade_all(p, all ? 0 : TRUE_Z / sqrt((double)j->spp), p->truth);
    for (uint32_t i = 0; i < p->n; i++) p->n_finite += isfinite(p->truth[i]) ? 1 : 0;
    return st;
}

static uint64_t count_rays(const lc_render_job *j)
{
    uint64_t n = 0;
    for (uint32_t i = 0; i < j->ctx->n_threads && j->workers; i++) n += j->workers[i].stats.shadow_rays;
    return n;
}

static lc_status calibrate(pilots *p, lc_calibration *c)
{
    lc_render_job *j = p->j;
    const lc_cut_desc cut = { j->desc->error, j->desc->max_cut, j->floor, j->z };
    if (!p->pixel || !p->truth || !p->value) return LC_ERR_MEMORY;
    place_pilots(p);
    lc_status st = shade_truth(p, &cut);
    c->rays = count_rays(j);
    lc_job_free_workers(j);
    if (!st && p->n_finite) st = lc_job_make_workers(j, &cut);
    if (!st && p->n_finite) find_z(p, &cut, c);
    c->rays += count_rays(j);
    c->n_pilots = p->n_finite;
    lc_job_free_workers(j);
    return !st && atomic_load(&j->cancelled) ? LC_ERR_CANCELLED : st;
}

lc_status lc_calibrate(lc_render_job *j, lc_calibration *out)
{
    const uint64_t pixels = (uint64_t)j->scene->film.width * j->scene->film.height;
    pilots p = { .j = j, .n = pixels < N_PILOTS ? (uint32_t)pixels : N_PILOTS };
    p.pixel = lc_alloc(j->ctx, p.n, sizeof *p.pixel);
    p.truth = lc_alloc(j->ctx, p.n, sizeof *p.truth);
    p.value = lc_alloc(j->ctx, p.n, sizeof *p.value);
    lc_status st = calibrate(&p, out);
    lc_free(j->ctx, p.pixel, p.n, sizeof *p.pixel);
    lc_free(j->ctx, p.truth, p.n, sizeof *p.truth);
    lc_free(j->ctx, p.value, p.n, sizeof *p.value);
    return st;
}
