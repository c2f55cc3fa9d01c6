/* calibrate.c - the factor z with which cuts keep the error that is asked of the finished pixel.
 *
 * A cut stops when z times the root of the sum of its squared bounds is within the asked error (cut.h). How
 * much of that root is real error differs from scene to scene, so z is found on pilots (pilots.h): pixels of
 * those that show a lit surface, of which the share is asked.
 *
 *     truth    every light at every point; of many lights, or samples, a finer cut: of some pilots first,
 *              which say how fine it must be
 *     values   the pixel by cuts of a z, which begin with the roots, by several slots of representatives
 *     z        where the asked share of the values, and a margin, is within the error
 *     way      a cut for each sample, or shared by a pixel's; with evidence of the block, or without; with
 *              wider limits for pixels nearly dark, or the same
 *     between  whether pixels are interpolated: how many can be, and how near they are
 *
 * A value's miss is its error over what is asked. The misses' quantile of that share falls with z about as
 * 1/z, so z is found by a few steps of the secant method on their logarithms.
 */
#include "render/pilots.h"

#include "base/pool.h"
#include "render/interpolate.h"
#include "render/near_grain.h"
#include "tree/light_tree.h"

#include <math.h>
#include <stdlib.h>

#define N_GRAIN LC_SIZE(256, 16) /* whose grain is looked at */
#define N_BETWEEN 2       /* values of a pilot where pixels are interpolated, as each needs knots */
#define ROUGH_STEPS 2     /* by one value of each pilot */
#define MOST_STEPS 6
#define AIM 0.98          /* of the error: where the quantile is to be */
#define CLOSE 1.1         /* from there: how many times off needs no other look */
#define FLATTEST (-0.75)   /* slope of misses: of few values it may seem flatter */
#define LEAST_Z (1 / 256.0)
#define MOST_Z 8.0
#define MAX_EXACT 40000.0 /* lights times samples of a pilot, all of which are evaluated */
/* Truth by finer cuts: ROUGH_PILOTS find the z of cuts that keep the error, then all pilots have NEARER
 * times that. Measured: tests/results/asked-error.md. */
#define FIRST_TRUE_Z 0.5  /* of the rough pilots' truth, for one sample; twice that and so on, until it is */
#define COARSEST 1.5      /* times the z that they find by it */
#define NEARER 4.0
#define ERRORS_TIMED 6    /* where there is a time to keep: for a z */
#define Z_FOR_TIME 3      /* z that are found then */
#define ROUGH_PILOTS 128
#define TRIED_STEPS 3     /* of their search, by one value of each */
#define Z_OF_EVIDENCE 0.7 /* of the z without, as a guess */
/* What work takes more time than with cuts of samples' own, without evidence: rays of shared cuts have many
 * origins, and rows of evidence are read again and again. Measured: tests/results/pixels.md. */
#define SHARED_COSTS 1.25
#define EVIDENCE_COSTS 1.22
#define SHARED_EVIDENCE_COSTS 1.19
/* Interpolated pixels; measured: tests/results/interpolation.md. */
#define KNOTS_OF_PIXEL (1 / 32.0) /* of a pilot's work: it shades some 5 knots, 16 pixels of a film 2.5 */
#define BETWEEN_STEPS 4   /* in place of MOST_STEPS */
#define MEAN_STEPS 2      /* of these, as a rule */
#define KNOTS_COST 5      /* work of a step with knots, in steps without */
#define MOST_MISSED 1.5   /* times the share that may miss the error: so many of them, at a guessed z */
/* Pixels nearly dark; measured: tests/results/asked-error.md. */
#define WIDER 4           /* times their limit */
#define LEAST_DARK 16     /* one in so many of the pilots is worth a try */
#define USED 0.92         /* of the time that is left; its estimate is off by some per cent */
#define SAME_TRUTH 0.7    /* times the error that a truth was made for: so small an error it serves, too */
#define NEAR_TIME 0.05    /* of the logarithm of the error: no further error is tried */
#define MOST_CHANGE 16.0  /* of the error, from one that is timed to the next */
#define LEAST_ERROR 1e-4
#define MOST_ERROR 1.0

/* In place of each value what it misses the truth by, in units of the asked error. */
static void find_misses(lc_pilots *p, double error, double floor_lum)
{
    for (uint32_t i = 0; i < p->n * p->n_slots; i++) {
        const double truth = p->truth[i / p->n_slots], off = fabs(p->value[i] - truth),
                     allowed = error * fmax(truth, floor_lum);
        p->value[i] = allowed > 0 ? off / allowed : off > 0 ? INFINITY : 0;
    }
}

/* The share of values within the error, and half the width of its interval of 95 %: Wilson's, of as many
 * values as would be independent, since those of one pilot are not. Per cent. */
static void state_share(const lc_pilots *p, lc_calibration *c)
{
    const double n = p->n_finite, q = 1.96;
    double sum = 0, sum2 = 0;
    for (uint32_t i = 0; i < p->n; i++) {
        double within = 0;
        for (uint32_t k = 0; k < p->n_slots; k++) within += p->value[i * p->n_slots + k] <= 1 ? 1 : 0;
        within *= isfinite(p->truth[i]) ? 1.0 / p->n_slots : 0;
        sum += within;
        sum2 += within * within;
    }
    const double share = sum / n, variance = (sum2 / n - share * share) / n;
    double m = variance > 0 ? share * (1 - share) / variance : n;
    m = fmin(fmax(m, n), n * p->n_slots);
    c->achieved = (float)(100 * share);
    c->margin = (float)(100 * q * sqrt(share * (1 - share) / m + q * q / (4 * m * m)) / (1 + q * q / m));
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The miss that the asked share of the values does not exceed. The margin is one standard error of as many
 * independent pilots, as the values of one have much in common. */
static double quantile(const lc_pilots *p, double within)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < p->n * p->n_slots; i++)
        if (isfinite(p->truth[i / p->n_slots])) p->sorted[n++] = p->value[i];
    qsort(p->sorted, n, sizeof *p->sorted, by_size);
    const double off = 1 - within / 100, margin = sqrt(off * (1 - off) * p->n_slots / n),
                 aim = 1 - fmax(off - margin, off / 8);
    const double at = ceil(aim * n) - 1;
    return p->sorted[at < n - 1 ? (uint32_t)fmax(at, 0) : n - 1];
}

/* Where the quantile will be AIM, by the line through the last two steps, in logarithms. */
static double next_z(double z, double miss, double last_z, double last_miss, double flattest)
{
    double slope = -1;
    if (last_miss > 0 && miss > 0 && isfinite(last_miss) && fabs(log(z / last_z)) > 0.05)
        slope = fmin(fmax(log(miss / last_miss) / log(z / last_z), -2), flattest);
    const double change = isfinite(miss) ? pow(AIM / fmax(miss, 1e-3), -1 / slope) : 1 / MOST_Z;
    return fmin(fmax(z / fmin(fmax(change, 1 / 8.0), 8), LEAST_Z), MOST_Z);
}

/* Cuts of a z: sets their misses, and returns the one that the asked share does not exceed. */
static double try_z(lc_pilots *p, const lc_cut_desc *cut, double z, uint32_t n_slots)
{
    lc_pilots_shade(p, (double)cut->error_ratio, z, n_slots, p->value);
    find_misses(p, (double)cut->error_ratio, (double)cut->floor);
    return quantile(p, (double)p->j->desc->within);
}

/* The search for z: what is tried next, what was tried last, and the best that several values of each pilot
 * have shown. */
typedef struct {
    double z, last_z, last_miss, least;
    lc_calibration found; /* its z 0: nothing yet */
    bool done;
} search;

static search search_from(double z) { return (search){ .z = z, .last_z = z, .least = INFINITY }; }

/* Whether a smaller z would save the film less than one more step takes. */
static bool is_near(const lc_pilots *p, double miss)
{
    const lc_film_desc *film = &p->j->scene->film;
    const double pixels = p->lit * film->width * film->height;
    const double step = (double)p->n * p->most_slots * (p->j->interpolated ? KNOTS_COST : 1);
    return (AIM - miss) * pixels < step;
}

/* Takes a z at which the misses are those at hand times a factor. */
static void found_z(lc_pilots *p, const lc_cut_desc *cut, double z, double factor, search *s)
{
    const uint32_t n = p->n * p->n_slots;
    for (uint32_t i = 0; i < n; i++) p->value[i] *= factor;
    s->found.z = (float)fmin(fmax(z, LEAST_Z), MOST_Z);
    state_share(p, &s->found);
    s->found.median = (float)((double)cut->error_ratio * factor * p->sorted[p->n_finite * p->n_slots / 2]);
}

/* By one value of each pilot, or by all slots. Of a small film any z that keeps the error is taken as it is:
 * a search costs more than it saves, and what is left over makes up for pilots being few. */
static void take_step(lc_pilots *p, const lc_cut_desc *cut, uint32_t n_slots, search *s)
{
    const double z = s->z, miss = try_z(p, cut, z, n_slots);
    const double by_miss = z * miss / AIM; /* misses are about as 1/z */
    const bool is_close = miss > AIM / CLOSE && miss < AIM * CLOSE && by_miss <= MOST_Z;
    if (n_slots == p->most_slots && is_close && (miss > 1 || !is_near(p, miss))) {
        found_z(p, cut, by_miss, AIM / miss, s);
        s->done = true;
    } else if (n_slots == p->most_slots && (miss <= 1 || miss < s->least || !(s->found.z > 0))) {
        s->least = miss;
        found_z(p, cut, z, 1, s);
        s->done = miss <= 1 ? is_near(p, miss) || z <= LEAST_Z : z >= MOST_Z;
    }
    s->z = next_z(z, miss, s->last_z, s->last_miss, p->j->interpolated ? -1 : FLATTEST);
    s->last_z = z;
    s->last_miss = miss;
}

/* Goes on with a search, or begins one. */
static void find_z(lc_pilots *p, const lc_cut_desc *cut, search *s, lc_calibration *c)
{
    const int most = p->j->interpolated ? BETWEEN_STEPS : MOST_STEPS;
    for (int step = 0; step < most && !s->done && !atomic_load(&p->j->cancelled); step++)
        take_step(p, cut, p->most_slots, s);
    c->z = s->found.z;
    c->achieved = s->found.achieved;
    c->margin = s->found.margin;
    c->median = s->found.median;
}

/* What one way to make cuts costs: its search, and work of a pixel at the z that keeps the error. */
typedef struct {
    search s;
    double work;
    bool shared, evidence;
    float dark;
} way_cost;

/* Cuts with evidence or without, for each sample or shared: steps by one value of each pilot, and a last one
 * by several, if asked. Counts, no clock, so that what is chosen by them is the same everywhere. */
static way_cost try_way(lc_pilots *p, const lc_cut_desc *cut, double z, int n_steps, bool fine)
{
    const lc_render_job *j = p->j;
    way_cost c = { .s = search_from(z) };
    double work_z = z;
    for (int step = 0; step < n_steps && !atomic_load(&j->cancelled); step++) {
        const double before = lc_job_work(j);
        work_z = c.s.z;
        take_step(p, cut, 1, &c.s);
        c.work = lc_job_work(j) - before; /* of several values, only the first has its row of evidence */
    }
    if (fine && !lc_may_interpolate(j) && !atomic_load(&j->cancelled))
        take_step(p, cut, p->most_slots, &c.s);
    c.work *= c.s.z / work_z / p->n; /* about as the inverse of the error */
    return c;
}

/* The error whose cuts of a z use the time that is left: they take time about as its inverse. */
static double error_for_time(lc_pilots *p, double error, double z)
{
    const lc_render_job *j = p->j;
    for (int i = 0; i < ERRORS_TIMED && !atomic_load(&j->cancelled); i++) {
        const double need = lc_pilots_time(p, error, z) * (double)j->total,
                     left = fmax(USED * (j->desc->seconds - (lc_now() - j->began)), need / MOST_CHANGE),
                     was = error;
        error = fmin(fmax(error * fmax(need / left, 1 / MOST_CHANGE), LEAST_ERROR), MOST_ERROR);
        if (fabs(log(error / was)) < NEAR_TIME) break;
    }
    return error;
}

static uint64_t count_rays(const lc_render_job *j)
{
    uint64_t n = 0;
    for (uint32_t i = 0; i < j->ctx->n_threads && j->workers; i++)
        n += j->workers[i].stats.shadow_rays + j->workers[i].apart.shadow_rays;
    return n;
}

/* Others, which have what the way at hand needs. */
static lc_status make_workers(lc_pilots *p, const lc_cut_desc *cut)
{
    p->rays += count_rays(p->j);
    lc_job_free_workers(p->j);
    return lc_job_make_workers(p->j, cut);
}

/* Most of what pixels nearly dark could be lit by is hidden: they keep the error by far. */
static bool many_are_dark(const lc_pilots *p, double floor_lum)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < p->n; i++) n += p->truth[i] < floor_lum;
    return n * LEAST_DARK > p->n;
}

/* A cut for each sample, or every light. */
static lc_status shade_truth(lc_pilots *p, const lc_cut_desc *cut, double z, float dark)
{
    lc_render_job *j = p->j;
    lc_cut_desc fine = *cut;
    fine.max_cut = 0;
    fine.max_points = 0;
    j->shared = j->evidence = false;
    j->dark = dark;
    lc_status st = make_workers(p, &fine);
    p->by_itself = true;
    if (!st) lc_pilots_shade(p, (double)cut->error_ratio, z, 1, p->truth);
    p->by_itself = false;
    p->true_z = z;
    p->true_error = (double)cut->error_ratio;
    p->n_finite = 0;
    for (uint32_t i = 0; i < p->n; i++) p->n_finite += isfinite(p->truth[i]) ? 1 : 0;
    return st;
}

static void find_grain(void *user, uint32_t thread, uint64_t item)
{
    const lc_pilots *p = user;
    const uint32_t width = p->j->scene->film.width, at = p->pixel[item];
    if (!lc_job_go_on(p->j)) return;
    p->value[item] = lc_near_grain(p->j, &p->j->workers[thread], at % width, at / width);
}

/* The grain of rays to near surfaces, and of where points of media are, truth and values have alike. Both are
 * found of some of the pilots, and stated relative to their truth. */
static void state_grain(lc_pilots *p, uint32_t n_all, double floor_lum, float *median, float *high)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < n_all; i++) {
        const double of = fmax(p->truth[i], floor_lum);
        if (isfinite(p->truth[i]) && isfinite(p->value[i]) && of > 0) p->sorted[n++] = p->value[i] / of;
    }
    if (!n) return;
    qsort(p->sorted, n, sizeof *p->sorted, by_size);
    *median = (float)p->sorted[n / 2];
    *high = (float)p->sorted[n * 19 / 20];
}

/* Pilots are shaded once more as their truth was, with other points. */
static void find_medium_grain(lc_pilots *p, uint32_t n)
{
    lc_render_job *j = p->j;
    const uint32_t n_all = p->n;
    for (uint32_t i = 0; i < n; i++) p->value[i] = NAN;
    p->n = n;
    p->by_itself = j->redraws = true;
    lc_pilots_shade(p, p->true_error, p->true_z, 1, p->value);
    p->by_itself = j->redraws = false;
    p->n = n_all;
    for (uint32_t i = 0; i < n; i++) p->value[i] = fabs(p->value[i] - p->truth[i]) / sqrt(2);
}

static void state_grains(lc_pilots *p, double floor_lum, lc_calibration *c)
{
    const uint32_t n = p->n < N_GRAIN ? p->n : N_GRAIN;
    if (p->j->scene->near_places) {
        lc_parallel(p->j->ctx, n, find_grain, p);
        state_grain(p, n, floor_lum, &c->near_median, &c->near_high);
    }
    if (p->j->scene->media.present) {
        find_medium_grain(p, n);
        state_grain(p, n, floor_lum, &c->medium_median, &c->medium_high);
    }
}

/* Tries a way and keeps it where it takes less time than the best so far, by its work. */
static lc_status keep_better(lc_pilots *p, const lc_cut_desc *cut, double z, bool shared, bool evidence,
                             float dark, way_cost *best)
{
    static const double costs[2][2] = { { 1, EVIDENCE_COSTS }, { SHARED_COSTS, SHARED_EVIDENCE_COSTS } };
    lc_render_job *j = p->j;
    const int n_steps = evidence || dark > 1 ? 1 : ROUGH_STEPS;
    j->shared = shared;
    j->evidence = evidence;
    j->dark = dark;
    lc_status st = make_workers(p, cut);
    if (st) return st;
    way_cost c = try_way(p, cut, z, n_steps, true);
    if (shared && !evidence && !(dark > 1)) j->pixel_work = c.work * p->lit;
    c.work *= costs[shared][evidence];
    c.shared = shared;
    c.evidence = evidence;
    c.dark = dark;
    if (c.work < best->work) *best = c;
    return st;
}

/* A cut for each sample of a pixel, by some pilots: where samples may share cuts it is seldom the best way,
 * and dear. It says how fine the truth of all pilots must be. */
static lc_status find_truth(lc_pilots *p, const lc_cut_desc *cut, way_cost *rough)
{
    lc_render_job *j = p->j;
    const uint32_t n = p->n, n_rough = n < ROUGH_PILOTS ? n : ROUGH_PILOTS;
    const bool all = (double)j->scene->tree->n_lights * j->spp <= MAX_EXACT;
    double z = all ? 0 : FIRST_TRUE_Z / lc_job_root_slots(j);
    float dark = 1;
    lc_status st;
    for (;; z *= 2) {
        *rough = (way_cost){ .s = search_from((double)cut->z) };
        p->n = all ? n : n_rough;
        st = shade_truth(p, cut, z, 1);
        p->n = n_rough;
        if (st || !p->n_finite || atomic_load(&j->cancelled)) break;
        if (many_are_dark(p, (double)cut->floor)) dark = WIDER;
        if ((st = make_workers(p, cut))) break;
        *rough = try_way(p, cut, (double)cut->z, TRIED_STEPS, false);
        if (all || z > COARSEST * rough->s.z || z >= MOST_Z) break;
    }
    p->n = n;
    return st || all ? st : shade_truth(p, cut, NEARER * rough->s.z, dark);
}

/* Whether the samples of a pixel share cuts, whether blocks take evidence, and whether pixels nearly dark
 * have wider limits; *s: the search so far. A cut for each sample is tried by all pilots if some find it to
 * be the best, or nothing else is possible. */
static lc_status choose_way(lc_pilots *p, lc_cut_desc *cut, search *s, lc_calibration *c)
{
    lc_render_job *j = p->j;
    const bool evidence = j->evidence, may_share = j->max_points;
    const double of_shared = lc_job_root_slots(j); /* its z over that of a cut for each sample, as a guess */
    way_cost rough, best = { .work = INFINITY };
    p->guided = evidence;
    lc_status st = find_truth(p, cut, &rough);
    if (st || !p->n_finite) return st;
    state_grains(p, (double)cut->floor, c);
    cut->max_points = j->max_points;
    if (may_share) st = keep_better(p, cut, of_shared * rough.s.z, true, false, 1, &best);
    if (!st && may_share && evidence) {
        const double from = best.work < rough.work ? best.s.z : of_shared * rough.s.z;
        st = keep_better(p, cut, Z_OF_EVIDENCE * from, true, true, 1, &best);
    }
    if (!st && rough.work < best.work)
        st = keep_better(p, cut, rough.s.z, false, false, 1, &best);
    if (!st && !may_share && evidence)
        st = keep_better(p, cut, Z_OF_EVIDENCE * best.s.z, false, true, 1, &best);
    if (!st && many_are_dark(p, (double)cut->floor))
        st = keep_better(p, cut, best.s.z, best.shared, best.evidence, WIDER, &best);
    p->guided = false;
    j->shared = best.shared;
    j->evidence = best.evidence;
    j->dark = best.dark;
    *s = best.s;
    return st ? st : make_workers(p, cut);
}

/* Pixels between others are interpolated where as many of these are within the error as is asked of all, more
 * or less, as the z is a guess, and where that saves more than its search takes. That goes on with them. */
static void try_interpolation(lc_pilots *p, const lc_cut_desc *cut, search *s)
{
    lc_render_job *j = p->j;
    const double pixels = p->lit * j->scene->film.width * j->scene->film.height;
    search with = search_from(s->z);
    uint32_t n = 0, within = 0;
    const double before = lc_job_work(j);
    j->interpolated = p->looks = true;
    for (uint32_t i = 0; i < p->n; i++) p->between[i] = true;
    take_step(p, cut, 1, &with);
    p->looks = false;
    const double looked = lc_job_work(j) - before;
    for (uint32_t i = 0; i < p->n; i++) {
        if (!p->between[i] || !isfinite(p->truth[i])) continue;
        n++;
        within += p->value[i] <= 1;
    }
    j->interpolated = false;
    if (!n || 1 - (double)within / n > MOST_MISSED * (1 - (double)j->desc->within / 100)) return;
    p->only_these = true;
    lc_pilots_shade(p, (double)cut->error_ratio, s->z, 1, p->value);
    p->only_these = false;
    const double shaded = lc_job_work(j) - before - looked;
    const double saved = (shaded - KNOTS_OF_PIXEL * looked) / p->n * pixels;
    j->interpolated = saved > MEAN_STEPS * N_BETWEEN * looked;
    if (!j->interpolated) return;
    p->most_slots = N_BETWEEN;
    *s = with;
}

/* Makes the pilots' truth again where it was made for a larger error than that of the cut. */
static lc_status sharpen_truth(lc_pilots *p, const lc_cut_desc *cut)
{
    lc_render_job *j = p->j;
    const bool shared = j->shared, evidence = j->evidence;
    const float dark = j->dark;
    if (!(p->true_z > 0) || (double)cut->error_ratio > SAME_TRUTH * p->true_error) return LC_OK;
    lc_status st = shade_truth(p, cut, p->true_z, dark);
    j->shared = shared;
    j->evidence = evidence;
    j->dark = dark;
    return st ? st : make_workers(p, cut);
}

/* Finds z for the asked error, or for the one that uses the time. */
static lc_status find_error(lc_pilots *p, lc_cut_desc cut, search *s, lc_calibration *c)
{
    lc_status st = LC_OK;
    for (int i = 0; i < Z_FOR_TIME && p->j->desc->seconds > 0 && !st; i++) {
        const double error = error_for_time(p, (double)c->error, (double)cut.z);
        if (i && fabs(log(error / (double)c->error)) < NEAR_TIME) return st;
        c->error = cut.error_ratio = (float)error;
        if ((st = sharpen_truth(p, &cut))) break;
        *s = search_from((double)cut.z);
        find_z(p, &cut, s, c);
        cut.z = c->z;
    }
    if (!(p->j->desc->seconds > 0)) find_z(p, &cut, s, c);
    return st;
}

static lc_status calibrate(lc_pilots *p, lc_calibration *c)
{
    lc_render_job *j = p->j;
    lc_cut_desc cut = lc_job_cut_desc(j);
    search s = search_from((double)cut.z);
    cut.error_ratio = c->error;
    lc_status st = choose_way(p, &cut, &s, c);
    if (!st && p->n_finite) {
        if (lc_may_interpolate(j)) try_interpolation(p, &cut, &s);
        cut.z = (float)s.z;
        st = find_error(p, cut, &s, c);
    }
    c->shared = j->shared;
    c->evidence = j->evidence;
    c->dark = j->dark;
    c->interpolated = j->interpolated;
    c->rays = p->rays + count_rays(j);
    c->n_pilots = p->n_finite;
    lc_job_free_workers(j);
    return !st && atomic_load(&j->cancelled) ? LC_ERR_CANCELLED : st;
}

lc_status lc_calibrate(lc_render_job *j, lc_calibration *out)
{
    lc_pilots p;
    lc_status st = lc_pilots_init(&p, j);
    if (!st) st = calibrate(&p, out);
    lc_pilots_free(&p);
    return st;
}

lc_status lc_find_grain(lc_render_job *j, lc_calibration *out)
{
    const lc_cut_desc cut = lc_job_cut_desc(j);
    double mean = 0;
    lc_pilots p;
    lc_status st = lc_pilots_init(&p, j);
    p.n = p.n < N_GRAIN ? p.n : N_GRAIN;
    if (!st) st = shade_truth(&p, &cut, 0, 1);
    for (uint32_t i = 0; !st && i < p.n; i++) mean += isfinite(p.truth[i]) ? p.truth[i] / p.n : 0;
    if (!st && p.n_finite) state_grains(&p, (double)j->desc->dark_floor * mean, out);
    out->rays = p.rays + count_rays(j);
    lc_job_free_workers(j);
    lc_pilots_free(&p);
    return !st && atomic_load(&j->cancelled) ? LC_ERR_CANCELLED : st;
}
