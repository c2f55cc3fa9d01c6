/* calibrate.c - the factor z with which cuts keep the error that is asked of the finished pixel.
 *
 * A cut stops when z times the root of the sum of its squared bounds is within the asked error (cut.h). How
 * much of that root is real error differs from scene to scene, so z is found on pilots: some pixels of the
 * whole film, spread evenly, with all their samples. They are of those that show a lit surface, of which the
 * share is asked.
 *
 *     truth    every light at every point; of many lights, or samples, a much finer cut
 *     values   the pixel by cuts of a z, which begin with the roots, by several slots of representatives
 *     z        where the asked share of the values, and a margin, is within the error
 *     way      a cut for each sample, or shared by a pixel's; with evidence of the block, or without; with
 *              wider limits for pixels nearly dark, or the same
 *     between  whether pixels are interpolated: how many can be, and how near they are
 *
 * A value's miss is its error over what is asked. The misses' quantile of that share falls with z about as
 * 1/z, so z is found by a few steps of the secant method on their logarithms. The pilots are the same
 * whatever is rendered of the film.
 */
#include "render/interpolate.h"

#include "base/pool.h"
#include "render/near_grain.h"
#include "render/pixel_sights.h"
#include "tree/light_tree.h"

#include <math.h>
#include <stdlib.h>

#define N_PILOTS LC_SIZE(512, 64)
#define LEAST_PILOTS LC_SIZE(256, 64) /* if there are as many pixels */
#define PIXELS_OF_PILOT 36 /* of a film that has fewer than N_PILOTS, but no fewer than LEAST_PILOTS */
#define LOOKS 4           /* samples of a pixel that may be a pilot */
#define MOST_TRIED 16     /* pixels for each pilot */
#define N_SLOTS 4         /* values of a pilot, once z is known roughly */
#define N_GRAIN LC_SIZE(256, 16) /* whose grain is looked at */
#define N_BETWEEN 2       /* the same where pixels are interpolated, whose pilots need knots */
#define ROUGH_STEPS 2     /* by one value of each pilot */
#define MOST_STEPS 6
#define AIM 0.98          /* of the error: where the quantile is to be, and the least that is good enough */
#define GOOD_ENOUGH 0.95
#define LEAST_Z (1 / 256.0)
#define MOST_Z 8.0
#define MAX_EXACT 40000.0 /* lights times samples of a pilot, all of which are evaluated */
#define TRUE_Z 2.0        /* of the finer cuts, for one sample */
#define ERRORS_TIMED 6    /* where there is a time to keep: for a z */
#define Z_FOR_TIME 3      /* z that are found then */
#define ROUGH_PILOTS 128  /* that try a way which is seldom the best */
#define TRIED_STEPS 3     /* by one value of each of these */
#define Z_OF_EVIDENCE 0.7 /* of the z without, as a guess */
/* What work takes more time than with cuts of samples' own, without evidence: rays of shared cuts have many
 * origins, and rows of evidence are read again and again. Measured: tests/results/pixels.md. */
#define SHARED_COSTS 1.25
#define EVIDENCE_COSTS 1.22
#define SHARED_EVIDENCE_COSTS 1.19
/* Interpolated pixels; measured: tests/results/interpolation.md. */
#define MOST_SAVED 0.8    /* of the work of those pixels: the rest is that of knots */
#define BETWEEN_STEPS 4   /* in place of MOST_STEPS */
#define KNOTS_COST 5      /* work of a step with knots, in steps without */
#define MOST_MISSED 1.5   /* times the share that may miss the error: so many of them, at a guessed z */
/* Pixels nearly dark; measured: tests/results/asked-error.md. */
#define WIDER 4           /* times their limit */
#define LEAST_DARK 16     /* one in so many of the pilots is worth a try */
#define USED 0.92         /* of the time that is left; its estimate is off by some per cent */
#define NEAR_TIME 0.05    /* of the logarithm of the error: no further error is tried */
#define MOST_CHANGE 16.0  /* of the error, from one that is timed to the next */
#define TIMED_BLOCKS 96   /* blocks of pixels all over the film, whose time is taken */
#define LEAST_ERROR 1e-4
#define MOST_ERROR 1.0

typedef struct {
    lc_render_job *j;
    uint32_t *pixel; /* x + y * width */
    double *truth;   /* luminance; a pilot whose truth is not finite counts for nothing */
    double *value;   /* the same by cuts, n_slots of each pilot; then its misses */
    double *to;      /* one of these */
    uint32_t n, n_slots, n_finite;
    double lit;     /* share of the film's pixels that could be pilots */
    uint64_t rays;  /* of workers that are no more */
    bool tried;     /* the ways: z is known roughly */
    bool guided;    /* cuts begin as those of a picture, though they take no evidence */
    bool by_itself; /* no guides: the truth */
    uint32_t most_slots;
    bool *between;  /* of each pilot: it may be interpolated */
    bool looks;     /* that is found out: all of them may */
    bool only_these; /* no others are shaded */
} pilots;

/* The i-th place of a sequence that is spread evenly over the film: the R2 sequence, or all pixels. */
static uint32_t place_of_pilot(const pilots *p, uint32_t i)
{
    const uint64_t width = p->j->scene->film.width, height = p->j->scene->film.height;
    const double u = 0.5 + i * 0.7548776662466927, v = 0.5 + i * 0.5698402909980532;
    const uint64_t x = (uint64_t)((u - floor(u)) * (double)width),
                   y = (uint64_t)((v - floor(v)) * (double)height);
    return (uint32_t)(p->n < width * height ? y * width + x : i);
}

/* Whether one of a few samples of a pixel shows a lit point. */
static bool shows_lit(const lc_render_job *j, uint32_t pixel)
{
    const uint32_t width = j->scene->film.width, n = j->spp < LOOKS ? j->spp : LOOKS;
    lc_sight sight;
    lc_f3 dir;
    for (uint32_t k = 0; k < n; k++)
        if (lc_sample_sight(j, pixel % width, pixel / width, k * j->spp / n, NULL, &dir, &sight) &&
            sight.n_lit)
            return true;
    return false;
}

static bool is_pilot(const pilots *p, uint32_t n, uint32_t pixel)
{
    for (uint32_t i = 0; i < n; i++)
        if (p->pixel[i] == pixel) return true;
    return false;
}

/* Pixels of the background are right whatever cuts do: they are no pilots, unless nothing else is there. */
static void place_pilots(pilots *p)
{
    const uint64_t pixels = (uint64_t)p->j->scene->film.width * p->j->scene->film.height;
    const uint32_t most = p->n < pixels ? MOST_TRIED * p->n : p->n;
    uint32_t n = 0, tried = 0;
    for (; tried < most && n < p->n && lc_job_go_on(p->j); tried++) {
        const uint32_t at = place_of_pilot(p, tried);
        if (shows_lit(p->j, at) && !is_pilot(p, n, at)) p->pixel[n++] = at;
    }
    for (uint32_t i = 0; i < p->n && !n; i++) p->pixel[i] = place_of_pilot(p, i);
    p->lit = n ? (double)n / tried : 1;
    if (n) p->n = n;
}

/* A pilot's slots one after the other, as they have one guide. */
static void shade_pilot(void *user, uint32_t thread, uint64_t item)
{
    pilots *p = user;
    lc_render_job *j = p->j;
    lc_render_worker *w = &j->workers[thread];
    const uint32_t width = j->scene->film.width, at = p->pixel[item];
    if (p->only_these && !p->between[item]) return;
    for (uint32_t k = 0; k < p->n_slots; k++) {
        lc_pixel px = { .hits = 0 };
        w->slot_shift = k * (j->spp < 16 ? j->spp : 1);
        bool between;
        lc_block_light_forget(w);
        if (!(p->between[item] ? lc_add_pixel(j, w, at % width, at / width, &px, &between)
                               : lc_add_samples(j, w, at % width, at / width, &px)))
            return;
        p->to[item * p->n_slots + k] = (double)lc_luminance(px.rgb) / j->spp;
        if (p->looks) p->between[item] = between;
    }
}

static void set_workers(const lc_render_job *j, double error, double z, bool alone, bool pilot)
{
    for (uint32_t i = 0; i < j->ctx->n_threads; i++) {
        lc_render_worker *w = &j->workers[i];
        w->cut.desc.error_ratio = (float)error;
        w->cut.desc.z = (float)z;
        w->cut.desc.dark = j->dark;
        w->alone = alone;
        w->pilot = pilot;
        w->guide.made = false;
        w->slot_shift = 0;
    }
}

/* Shades all pilots by cuts of an error and a z, or, where that is 0, by every light; by n_slots slots of
 * representatives. */
static void shade_all(pilots *p, double error, double z, uint32_t n_slots, double *to)
{
    lc_render_job *j = p->j;
    p->to = to;
    p->n_slots = n_slots;
    j->exact = !(z > 0);
    /* Where cuts take no evidence of their block, a guide for each pilot would double the work. */
    set_workers(j, error, z, p->by_itself || !(j->evidence || p->guided), true);
    lc_parallel(j->ctx, p->n, shade_pilot, p);
    j->exact = false;
}

/* In place of each value what it misses the truth by, in units of the asked error. */
static void find_misses(pilots *p, double error, double floor_lum)
{
    for (uint32_t i = 0; i < p->n * p->n_slots; i++) {
        const double truth = p->truth[i / p->n_slots], off = fabs(p->value[i] - truth),
                     allowed = error * fmax(truth, floor_lum);
        p->value[i] = allowed > 0 ? off / allowed : off > 0 ? INFINITY : 0;
    }
}

/* The share of values within the error, and half the width of its interval of 95 %: Wilson's, of as many
 * values as would be independent, since those of one pilot are not. Per cent. */
static void state_share(const pilots *p, lc_calibration *c)
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
 * independent values. */
static double quantile(const pilots *p, double *sorted, double within)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < p->n * p->n_slots; i++)
        if (isfinite(p->truth[i / p->n_slots])) sorted[n++] = p->value[i];
    qsort(sorted, n, sizeof *sorted, by_size);
    const double off = 1 - within / 100, aim = 1 - fmax(off - sqrt(off * (1 - off) / n), off / 8);
    const double at = ceil(aim * n) - 1;
    return sorted[at < n - 1 ? (uint32_t)fmax(at, 0) : n - 1];
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
static double try_z(pilots *p, const lc_cut_desc *cut, double z, uint32_t n_slots, double *sorted)
{
    shade_all(p, (double)cut->error_ratio, z, n_slots, p->value);
    find_misses(p, (double)cut->error_ratio, (double)cut->floor);
    return quantile(p, sorted, (double)p->j->desc->within);
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
static bool is_near(const pilots *p, double miss)
{
    const lc_film_desc *film = &p->j->scene->film;
    const double pixels = p->lit * film->width * film->height;
    const double step = (double)p->n * p->most_slots * (p->j->interpolated ? KNOTS_COST : 1);
    return miss >= GOOD_ENOUGH || (AIM - miss) * pixels < step;
}

/* By one value of each pilot, or by all slots. */
static void take_step(pilots *p, const lc_cut_desc *cut, uint32_t n_slots, double *sorted, search *s)
{
    const double z = s->z, miss = try_z(p, cut, z, n_slots, sorted);
    if (n_slots == p->most_slots && (miss <= 1 || miss < s->least || !(s->found.z > 0))) {
        s->least = miss;
        s->found.z = (float)z;
        state_share(p, &s->found);
        s->found.median = (float)((double)cut->error_ratio * sorted[p->n_finite * n_slots / 2]);
        s->done = miss <= 1 ? is_near(p, miss) || z <= LEAST_Z : z >= MOST_Z;
    }
    s->z = next_z(z, miss, s->last_z, s->last_miss, p->j->interpolated ? -1 : -0.5);
    s->last_z = z;
    s->last_miss = miss;
}

/* Goes on with a search, or begins one. */
static void find_z(pilots *p, const lc_cut_desc *cut, double *sorted, search *s, lc_calibration *c)
{
    const int most = p->j->interpolated ? BETWEEN_STEPS : MOST_STEPS;
    for (int step = 0; step < most && !s->done && !atomic_load(&p->j->cancelled); step++)
        take_step(p, cut, step < ROUGH_STEPS && !p->tried ? 1 : p->most_slots, sorted, s);
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
static way_cost try_way(pilots *p, const lc_cut_desc *cut, double z, int n_steps, bool fine, double *sorted)
{
    const lc_render_job *j = p->j;
    way_cost c = { .s = search_from(z) };
    double work_z = z;
    for (int step = 0; step < n_steps && !atomic_load(&j->cancelled); step++) {
        const double before = lc_job_work(j);
        work_z = c.s.z;
        take_step(p, cut, 1, sorted, &c.s);
        c.work = lc_job_work(j) - before; /* of several values, only the first has its row of evidence */
    }
    if (fine && !lc_may_interpolate(j) && !atomic_load(&j->cancelled))
        take_step(p, cut, p->most_slots, sorted, &c.s);
    c.work *= c.s.z / work_z / p->n; /* about as the inverse of the error */
    return c;
}

static void shade_block(void *user, uint32_t thread, uint64_t item)
{
    const pilots *p = user;
    lc_render_job *j = p->j;
    const uint32_t width = j->scene->film.width, height = j->scene->film.height,
                   at = place_of_pilot(p, (uint32_t)item),
                   x0 = at % width - at % width % LC_PIXEL_BLOCK,
                   y0 = at / width - at / width % LC_PIXEL_BLOCK;
    lc_pixel px = { .hits = 0 };
    for (uint32_t y = y0; y < y0 + LC_PIXEL_BLOCK && y < height; y++)
        for (uint32_t x = x0; x < x0 + LC_PIXEL_BLOCK && x < width; x++)
            if (!lc_add_samples(j, &j->workers[thread], x, y, &px)) return;
}

/* Seconds that a pixel takes by cuts of an error and a z, when all threads render. */
static double time_pixel(pilots *p, double error, double z)
{
    lc_render_job *j = p->j;
    const uint32_t n = p->n < TIMED_BLOCKS ? p->n : TIMED_BLOCKS;
    set_workers(j, error, z, false, false);
    const double began = lc_now();
    lc_parallel(j->ctx, n, shade_block, p);
    return (lc_now() - began) / (n * LC_PIXEL_BLOCK * LC_PIXEL_BLOCK);
}

/* The error whose cuts of a z use the time that is left: they take time about as its inverse. */
static double error_for_time(pilots *p, double error, double z)
{
    const lc_render_job *j = p->j;
    for (int i = 0; i < ERRORS_TIMED && !atomic_load(&j->cancelled); i++) {
        const double need = time_pixel(p, error, z) * (double)j->total,
                     left = fmax(USED * (j->desc->seconds - (lc_now() - j->began)), need / MOST_CHANGE),
                     was = error;
        error = fmin(fmax(error * fmax(need / left, 1 / MOST_CHANGE), LEAST_ERROR), MOST_ERROR);
        if (fabs(log(error / was)) < NEAR_TIME) break;
    }
    return error;
}

/* Finds z for the asked error, or for the one that uses the time. */
static void find_error(pilots *p, lc_cut_desc cut, double *sorted, search *s, lc_calibration *c)
{
    for (int i = 0; i < Z_FOR_TIME && p->j->desc->seconds > 0; i++) {
        const double error = error_for_time(p, (double)c->error, (double)cut.z);
        if (i && fabs(log(error / (double)c->error)) < NEAR_TIME) return;
        c->error = cut.error_ratio = (float)error;
        *s = search_from((double)cut.z);
        find_z(p, &cut, sorted, s, c);
        cut.z = c->z;
    }
    if (!(p->j->desc->seconds > 0)) find_z(p, &cut, sorted, s, c);
}

static lc_status shade_truth(pilots *p, const lc_cut_desc *cut)
{
    lc_render_job *j = p->j;
    const bool all = (double)j->scene->tree->n_lights * j->spp <= MAX_EXACT;
    lc_cut_desc fine = *cut;
    fine.max_cut = 0;
    fine.max_points = 0; /* a cut for each sample */
    lc_status st = lc_job_make_workers(j, &fine);
    p->by_itself = true;
    if (!st) shade_all(p, (double)cut->error_ratio, all ? 0 : TRUE_Z / sqrt((double)j->spp), 1, p->truth);
    p->by_itself = false;
    for (uint32_t i = 0; i < p->n; i++) p->n_finite += isfinite(p->truth[i]) ? 1 : 0;
    return st;
}

static void find_grain(void *user, uint32_t thread, uint64_t item)
{
    const pilots *p = user;
    const uint32_t width = p->j->scene->film.width, at = p->pixel[item];
    if (!lc_job_go_on(p->j)) return;
    p->value[item] = lc_near_grain(p->j, &p->j->workers[thread], at % width, at / width);
}

/* The grain that rays to near surfaces leave, which truth and values have alike: of some of the pilots,
 * relative to their truth. */
static void state_grain(pilots *p, double floor_lum, double *sorted, lc_calibration *c)
{
    uint32_t n = 0;
    const uint32_t n_all = p->n < N_GRAIN ? p->n : N_GRAIN;
    if (!p->j->scene->near_places) return;
    lc_parallel(p->j->ctx, n_all, find_grain, p);
    for (uint32_t i = 0; i < n_all; i++) {
        const double of = fmax(p->truth[i], floor_lum);
        if (isfinite(p->truth[i]) && isfinite(p->value[i]) && of > 0) sorted[n++] = p->value[i] / of;
    }
    if (!n) return;
    qsort(sorted, n, sizeof *sorted, by_size);
    c->near_median = (float)sorted[n / 2];
    c->near_high = (float)sorted[n * 19 / 20];
}

static uint64_t count_rays(const lc_render_job *j)
{
    uint64_t n = 0;
    for (uint32_t i = 0; i < j->ctx->n_threads && j->workers; i++)
        n += j->workers[i].stats.shadow_rays + j->workers[i].apart.shadow_rays;
    return n;
}

/* Others, which have what the way at hand needs. */
static lc_status make_workers(pilots *p, const lc_cut_desc *cut)
{
    p->rays += count_rays(p->j);
    lc_job_free_workers(p->j);
    return lc_job_make_workers(p->j, cut);
}

/* Tries a way and keeps it where it takes less time than the best so far, by its work. */
static lc_status keep_better(pilots *p, const lc_cut_desc *cut, double z, bool shared, bool evidence,
                             float dark, double *sorted, way_cost *best)
{
    static const double costs[2][2] = { { 1, EVIDENCE_COSTS }, { SHARED_COSTS, SHARED_EVIDENCE_COSTS } };
    lc_render_job *j = p->j;
    const bool fine = shared || !j->max_points; /* else it is seldom the best, and dear: by few pilots */
    const int n_steps = evidence || dark > 1 ? 1 : fine ? ROUGH_STEPS : TRIED_STEPS;
    j->shared = shared;
    j->evidence = evidence;
    j->dark = dark;
    lc_status st = make_workers(p, cut);
    if (st) return st;
    const uint32_t n = p->n;
    if (!fine) p->n = n < ROUGH_PILOTS ? n : ROUGH_PILOTS;
    way_cost c = try_way(p, cut, z, n_steps, fine, sorted);
    p->n = n;
    if (shared && !evidence && !(dark > 1)) j->pixel_work = c.work * p->lit;
    c.work *= costs[shared][evidence];
    c.shared = shared;
    c.evidence = evidence;
    c.dark = dark;
    if (!(best->s.z > 0) || c.work < best->work) *best = c;
    return st;
}

/* Most of what pixels nearly dark could be lit by is hidden: they keep the error by far. */
static bool many_are_dark(const pilots *p, double floor_lum)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < p->n; i++) n += p->truth[i] < floor_lum;
    return n * LEAST_DARK > p->n;
}

/* Whether the samples of a pixel share cuts, whether blocks take evidence, and whether pixels nearly dark
 * have wider limits; *s: the search so far. */
static lc_status choose_way(pilots *p, lc_cut_desc *cut, double *sorted, search *s)
{
    lc_render_job *j = p->j;
    const bool evidence = j->evidence, may_share = j->max_points;
    way_cost best = { .work = 0 };
    p->guided = evidence;
    lc_status st = keep_better(p, cut, (double)cut->z, false, false, 1, sorted, &best);
    if (!st && may_share)
        st = keep_better(p, cut, best.s.z * sqrt((double)j->spp), true, false, 1, sorted, &best);
    if (!st && evidence) {
        const double from = may_share && !best.shared ? sqrt((double)j->spp) : 1;
        st = keep_better(p, cut, from * Z_OF_EVIDENCE * best.s.z, may_share, true, 1, sorted, &best);
    }
    if (!st && many_are_dark(p, (double)cut->floor))
        st = keep_better(p, cut, best.s.z, best.shared, best.evidence, WIDER, sorted, &best);
    p->guided = false;
    j->shared = best.shared;
    j->evidence = best.evidence;
    j->dark = best.dark;
    *s = best.s;
    return st ? st : make_workers(p, cut);
}

/* Pixels between others are interpolated where as many of these are within the error as is asked of all, more
 * or less, as the z is a guess, and where that saves more than its search takes. That goes on with them. */
static void try_interpolation(pilots *p, const lc_cut_desc *cut, double *sorted, search *s)
{
    lc_render_job *j = p->j;
    const double pixels = p->lit * j->scene->film.width * j->scene->film.height;
    search with = search_from(s->z);
    uint32_t n = 0, within = 0;
    const double before = lc_job_work(j);
    j->interpolated = p->looks = true;
    for (uint32_t i = 0; i < p->n; i++) p->between[i] = true;
    take_step(p, cut, 1, sorted, &with);
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
    shade_all(p, (double)cut->error_ratio, s->z, 1, p->value);
    p->only_these = false;
    const double shaded = lc_job_work(j) - before - looked;
    j->interpolated = MOST_SAVED * shaded / p->n * pixels > BETWEEN_STEPS * N_BETWEEN * looked;
    if (!j->interpolated) return;
    p->most_slots = N_BETWEEN;
    *s = with;
}

static lc_status calibrate(pilots *p, double *sorted, lc_calibration *c)
{
    lc_render_job *j = p->j;
    lc_cut_desc cut = lc_job_cut_desc(j);
    search s = search_from((double)cut.z);
    cut.error_ratio = c->error;
    if (!p->pixel || !p->truth || !p->value || !p->between || !sorted) return LC_ERR_MEMORY;
    place_pilots(p);
    lc_status st = shade_truth(p, &cut);
    if (!st) state_grain(p, (double)cut.floor, sorted, c);
    cut.max_points = j->max_points;
    p->tried = j->evidence || j->max_points || many_are_dark(p, (double)cut.floor);
    if (!st && p->n_finite) st = p->tried ? choose_way(p, &cut, sorted, &s) : make_workers(p, &cut);
    if (!st && p->n_finite) {
        if (lc_may_interpolate(j)) try_interpolation(p, &cut, sorted, &s);
        cut.z = (float)s.z;
        find_error(p, cut, sorted, &s, c);
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

/* Fewer for a small film, where pilots would be a large part of the work. */
static uint32_t n_pilots(uint64_t pixels)
{
    const uint64_t most = pixels < N_PILOTS * PIXELS_OF_PILOT ? pixels / PIXELS_OF_PILOT : N_PILOTS,
                   n = most > LEAST_PILOTS ? most : LEAST_PILOTS;
    return (uint32_t)(n < pixels ? n : pixels);
}

lc_status lc_calibrate(lc_render_job *j, lc_calibration *out)
{
    const uint64_t pixels = (uint64_t)j->scene->film.width * j->scene->film.height;
    const uint32_t n = n_pilots(pixels); /* what there is room for */
    pilots p = { .j = j, .n = n, .most_slots = N_SLOTS };
    p.pixel = lc_alloc(j->ctx, n, sizeof *p.pixel);
    p.truth = lc_alloc(j->ctx, n, sizeof *p.truth);
    p.value = lc_alloc(j->ctx, n, N_SLOTS * sizeof *p.value);
    p.between = lc_alloc(j->ctx, n, sizeof *p.between);
    double *sorted = lc_alloc(j->ctx, n, N_SLOTS * sizeof *sorted);
    lc_status st = calibrate(&p, sorted, out);
    lc_free(j->ctx, p.pixel, n, sizeof *p.pixel);
    lc_free(j->ctx, p.truth, n, sizeof *p.truth);
    lc_free(j->ctx, p.value, n, N_SLOTS * sizeof *p.value);
    lc_free(j->ctx, p.between, n, sizeof *p.between);
    lc_free(j->ctx, sorted, n, N_SLOTS * sizeof *sorted);
    return st;
}
