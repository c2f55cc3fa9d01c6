/* method.c - cuts or every light, and the pre-pass for the dark floor. */
#include "render/interpolate.h"

#include "base/desc.h"
#include "base/pool.h"
#include "render/sample_keys.h"
#include "scene/instance.h"

#include <math.h>

#define PREPASS_SIDE LC_SIZE(32, 8) /* grid of the pre-pass */
#define PREPASS_RATIO 0.1f   /* its error ratio and cut limit: its mean is wanted to a few percent */
#define PREPASS_MAX_CUT 128

/* Few lights: every one of them is evaluated where that takes less work than cuts. Work is counted, over a
 * grid of points that are shaded both ways, in estimates of one light; these are the only weights, and no
 * clock is asked, so that the choice, and with it the picture, is the same everywhere. A shadow ray visits a
 * few dozen boxes and triangles with what it shares with its group: those of a cut's groups are few. A bound
 * is two estimates' arithmetic, and its cluster is placed in a list. How they were chosen:
 * tests/results/few-lights.md. */
#define ALWAYS_FEW 8        /* lights: all are evaluated, neither way is tried */
#define NEVER_FEW 4096      /* lights: more are never all evaluated */
#define CHOICE_SIDE LC_SIZE(16, 6) /* grid of the points that are tried */
#define WORK_OF_RAY 10 /* of every light's rays, in groups of 64 */
#define WORK_OF_CUT_RAY 15
#define WORK_OF_BOUND 3     /* with its share of a split: half an estimate, a cluster placed */
#define WORK_OF_PROOF 15    /* a triangle tested in a proof */
#define WORK_OF_CUT 48      /* a cut, whatever its size */
#define USUAL_Z 0.25        /* of one sample, until it is known what keeps the asked error */
#define EVIDENCE_FROM 65536 /* pixels of the film: with fewer, to survey the blocks of the pilots takes more
                               than it saves; tests/results/asked-error.md */
#define TRIED_SIDE LC_SIZE(8, 2) /* grid of the pixels by which samples that share cuts are tried */
#define TRIED_FROM 4096          /* pixels of the film */
#define WORK_OF_PILOTS 32768     /* of as many pixels' every light, about */
#define WORK_FOR_NO_ERROR 1.1 /* factor of work that every light is allowed, as it has no error */

/* Radiance seen at a cell of a grid of side * side over the whole film; false: nothing there that is lit. */
static bool shade_cell(lc_render_job *j, uint32_t thread, uint64_t item, uint32_t side, lc_cut_result *r)
{
    lc_f3 dir;
    lc_sight s;
    double u = ((double)(item % side) + 0.5) / side, v = ((double)(item / side) + 0.5) / side;
    const double lens[2] = { 0.5, 0.5 };
    u *= j->scene->film.width;
    v *= j->scene->film.height;
    if (!lc_job_go_on(j) || !lc_view_sight(j->scene, u, v, lens, &j->how, &dir, &s) ||
        !s.n_lit)
        return false;
    const uint64_t hash = lc_job_key(j, item, 0, LC_DIM_SLOT);
    const lc_sample_keys keys = { hash, hash, hash, 0 };
    lc_shade_sight(j, &j->workers[thread], &s, NULL, &keys, r);
    return true;
}

static void prepass_cell(void *user, uint32_t thread, uint64_t item)
{
    lc_render_job *j = user;
    lc_cut_result r;
    if (shade_cell(j, thread, item, PREPASS_SIDE, &r)) j->prepass[item] = (double)lc_luminance(r.radiance);
}

/* Mean luminance over the grid, cells added in order. */
static lc_status prepass(lc_render_job *j, double *mean)
{
    const size_t n = PREPASS_SIDE * PREPASS_SIDE;
    lc_cut_desc desc = { .error_ratio = PREPASS_RATIO, .max_cut = PREPASS_MAX_CUT };
    j->prepass = lc_alloc(j->ctx, n, sizeof *j->prepass);
    lc_status st = j->prepass ? lc_job_make_workers(j, &desc) : LC_ERR_MEMORY;
    *mean = 0;
    if (!st) {
        lc_parallel(j->ctx, n, prepass_cell, j);
        for (size_t i = 0; i < n; i++) *mean += isfinite(j->prepass[i]) ? j->prepass[i] / (double)n : 0;
    }
    lc_free(j->ctx, j->prepass, n, sizeof *j->prepass);
    lc_job_free_workers(j);
    return st;
}

static void choice_cell(void *user, uint32_t thread, uint64_t item)
{
    lc_cut_result r;
    shade_cell(user, thread, item, CHOICE_SIDE, &r);
}

static void add_counts(const lc_stats *of, lc_stats *sum)
{
    sum->points += of->points;
    sum->shadow_rays += of->shadow_rays;
    sum->bounds += of->bounds;
    sum->proof_tests += of->proof_tests;
}

static double work_of(const lc_stats *cuts)
{
    return (double)(WORK_OF_CUT * cuts->points + WORK_OF_BOUND * cuts->bounds +
                    WORK_OF_CUT_RAY * cuts->shadow_rays + WORK_OF_PROOF * cuts->proof_tests);
}

static double work_of_all(const lc_stats *all, uint32_t n_lights)
{
    return (double)(all->points * n_lights + WORK_OF_RAY * all->shadow_rays);
}

double lc_job_work(const lc_render_job *j)
{
    lc_stats pixels = { 0 }, guides = { 0 };
    for (uint32_t i = 0; i < j->ctx->n_threads && j->workers; i++) {
        add_counts(&j->workers[i].stats, &pixels);
        add_counts(&j->workers[i].apart, &guides);
    }
    return work_of(&pixels) + (j->evidence ? work_of(&guides) / (LC_PIXEL_BLOCK * LC_PIXEL_BLOCK) : 0);
}

/* All samples of a pixel. */
static void choice_pixel(void *user, uint32_t thread, uint64_t item)
{
    lc_render_job *j = user;
    const lc_film_desc *film = &j->scene->film;
    lc_pixel px = { .hits = 0 };
    const double u = ((double)(item % TRIED_SIDE) + 0.5) / TRIED_SIDE,
                 v = ((double)(item / TRIED_SIDE) + 0.5) / TRIED_SIDE;
    lc_add_samples(j, &j->workers[thread], (uint32_t)(u * film->width), (uint32_t)(v * film->height), &px);
}

/* Counts of both methods over n points or pixels: shading points, shadow rays, bounds. */
static lc_status try_method(lc_render_job *j, const lc_cut_desc *cut, bool exact, uint32_t n,
                            void (*shade)(void *user, uint32_t thread, uint64_t item), lc_stats *sum)
{
    bool was = j->exact;
    lc_status st = lc_job_make_workers(j, cut);
    j->exact = exact;
    if (!st) lc_parallel(j->ctx, n, shade, j);
    for (uint32_t i = 0; i < j->ctx->n_threads && !st; i++) add_counts(&j->workers[i].stats, sum);
    j->exact = was;
    lc_job_free_workers(j);
    return st;
}

/* Whether every light takes no more work than these cuts. Never where there are more lights than max_cut. */
static lc_status exact_pays(lc_render_job *j, const lc_cut_desc *cut, bool *pays)
{
    lc_stats cuts = { 0 }, all = { 0 };
    const uint32_t n = j->scene->tree->n_lights;
    *pays = false;
    if ((cut->max_cut && cut->max_cut < n) || n > NEVER_FEW) return LC_OK;
    *pays = n <= ALWAYS_FEW;
    if (*pays) return LC_OK;
    lc_status st = try_method(j, cut, false, CHOICE_SIDE * CHOICE_SIDE, choice_cell, &cuts);
    if (!st) st = try_method(j, cut, true, CHOICE_SIDE * CHOICE_SIDE, choice_cell, &all);
    if (st) return st;
    const double exact = work_of_all(&all, n);
    double by_cuts = work_of(&cuts);
    if (j->shared) by_cuts = j->pixel_work / j->spp * CHOICE_SIDE * CHOICE_SIDE;
    *pays = exact <= WORK_FOR_NO_ERROR * by_cuts;
    return LC_OK;
}

/* Whether cuts that a pixel's samples share may save so much beside every light that pilots pay, which find
 * out what they take. */
static lc_status pilots_pay(lc_render_job *j, bool *pay)
{
    const uint64_t film = (uint64_t)j->scene->film.width * j->scene->film.height;
    lc_stats cuts = { 0 }, all = { 0 };
    *pay = false;
    if (!(j->error > 0) || !j->max_points || j->spp < 2 || film < TRIED_FROM) return LC_OK;
    j->shared = true;
    const lc_cut_desc cut = lc_job_cut_desc(j);
    lc_status st = try_method(j, &cut, false, TRIED_SIDE * TRIED_SIDE, choice_pixel, &cuts);
    j->shared = false;
    if (!st) st = try_method(j, &cut, true, TRIED_SIDE * TRIED_SIDE, choice_pixel, &all);
    const double exact = work_of_all(&all, j->scene->tree->n_lights);
    *pay = exact > 0 && (1 - work_of(&cuts) / exact) * (double)film > WORK_OF_PILOTS;
    return st;
}

double lc_job_root_slots(const lc_render_job *j) { return sqrt(fmin(j->spp, j->scene->tree->n_reps)); }

lc_cut_desc lc_job_cut_desc(const lc_render_job *j)
{
    const lc_render_desc *d = j->desc;
    return (lc_cut_desc){ j->error > 0 ? j->error : d->error_ratio, d->max_cut, j->floor, j->z,
                          j->shared ? j->max_points : 0, j->parent, j->dark, false };
}

/* Finds z, or takes it from who has it, unless every light turns out to be evaluated. */
static lc_status choose_z(lc_render_job *j, lc_calibration *c)
{
    lc_status st;
    *c = (lc_calibration){ .size = sizeof *c, .error = j->error, .within = j->desc->within, .z = j->z };
    if (j->desc->calibration)
        st = lc_desc_take(j->ctx, "lc_calibration", c, sizeof *c, j->desc->calibration);
    else st = lc_calibrate(j, c);
    j->z = c->z;
    j->dark = c->dark;
    j->error = c->error;
    j->shared = c->shared && j->max_points;
    j->evidence = c->evidence;
    j->interpolated = c->interpolated && lc_may_interpolate(j);
    if (!st && j->desc->method == LC_METHOD_LIGHTCUTS) {
        const lc_cut_desc cut = lc_job_cut_desc(j);
        st = exact_pays(j, &cut, &j->exact);
    }
    if (j->exact)
        *c = (lc_calibration){ .size = sizeof *c, .near_median = c->near_median, .near_high = c->near_high,
                               .medium_median = c->medium_median, .medium_high = c->medium_high,
                               .rays = c->rays };
    return st;
}

/* Whether cuts are made at all, the mean luminance for their dark floor, and their z. */
lc_status lc_choose_method(lc_render_job *j, lc_render_stats *stats)
{
    const lc_render_desc *d = j->desc;
    const uint32_t n = j->scene->tree->n_lights;
    lc_status st = LC_OK;
    stats->exact = j->exact = d->method == LC_METHOD_EXACT;
    if (j->exact) return LC_OK;
    j->error = d->error;
    const uint64_t film = (uint64_t)j->scene->film.width * j->scene->film.height;
    j->evidence = d->error > 0 && j->scene->tree->n_reps > 1 && film >= EVIDENCE_FROM;
    j->z = d->error > 0 ? (float)(USUAL_Z / lc_job_root_slots(j)) : 0;
    bool few = d->method == LC_METHOD_LIGHTCUTS && n <= ALWAYS_FEW && !(d->max_cut && d->max_cut < n);
    if (!few && d->dark_floor > 0 && (d->error > 0 || d->error_ratio > 0))
        st = prepass(j, &stats->mean_luminance);
    j->floor = d->dark_floor * (float)stats->mean_luminance;
    const lc_cut_desc cut = lc_job_cut_desc(j);
    if (!st && d->method == LC_METHOD_LIGHTCUTS) st = exact_pays(j, &cut, &j->exact);
    if (!st && j->exact && !few) {
        bool pilots = false;
        j->exact = false;
        st = pilots_pay(j, &pilots);
        j->exact = !pilots;
    }
    if (!st && !j->exact && n && d->error > 0) st = choose_z(j, &stats->calibration);
    else if (!st && n && d->error > 0 && (j->scene->media.present || j->scene->near_places)) {
        st = lc_find_grain(j, &stats->calibration);
        j->exact = true;
    }
    stats->exact = j->exact;
    return st;
}
