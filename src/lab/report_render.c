/* report_render.c - surveys the scenes, then renders what no earlier run has left: one scene at a time, and
 * the renders with the same number of representatives together, as they share a light tree. */
#include "lab/report.h"

#include "cli/cli.h"
#include "cli/progress.h"

#include <math.h>
#include <string.h>

#define QUICK_PIXELS 19200 /* limit of a film with --quick: 160 x 120 */

/* Work of a pixel, in lights that a cut evaluates; only the estimate of the time left depends on it.
 * Measured: tests/results/report.md. */
#define PIXEL_WORK 20        /* of any method */
#define EXACT_LIGHT_WORK 0.3 /* a light of the exact method */
#define CUT_SIZE 12          /* a cut has about CUT_SIZE error_ratio^(-3/4) lights */
#define LEAST_RATIO 1e-4     /* for that estimate */

/* Renders of less than SHORT seconds are repeated, as disturbances are a large part of their time. */
#define RUNS 3    /* renders, at most */
#define SHORT 2.0 /* seconds */

typedef struct progress {
    cli_progress line;
    double done, total, now; /* work: of finished renders, of all that are to be made, of the present one */
} progress;

static double work_of(const report_render *v, double lights, double pixels)
{
    if (v->method == LC_METHOD_EXACT) return pixels * (PIXEL_WORK + EXACT_LIGHT_WORK * lights);
    return pixels * (PIXEL_WORK + fmin(lights, CUT_SIZE * pow(fmax(v->ratio, LEAST_RATIO), -0.75)));
}

/* The callback of lc_render: progress over all renders, in billionths. */
static int step(void *user, uint64_t done, uint64_t total)
{
    progress *p = user;
    double all = p->done + p->now * (double)done / (double)(total ? total : 1);
    return cli_progress_step(&p->line, (uint64_t)(all / p->total * 1e9), 1000000000);
}

/* ---- what there is to do ---- */

static void set_up_renders(report *r, report_scene *s)
{
    const report_options *o = r->o;
    uint64_t shared[3] = { o->quick ? QUICK_PIXELS : 0, r->n_threads, 0 };
    uint64_t key = report_hash(report_hash(s->key, shared, sizeof shared), r->isa, strlen(r->isa));
    s->renders[0] = (report_render){ .method = LC_METHOD_EXACT, .n_reps = 1, .key = key };
    for (uint32_t i = 0; i < 2 * o->n_ratios; i++) {
        report_render *v = &s->renders[1 + i];
        *v = (report_render){ .n_reps = i < o->n_ratios ? 1 : o->n_reps,
                              .ratio = o->ratios[i % o->n_ratios] };
        v->key = report_hash(key, &v->ratio, sizeof v->ratio);
        v->key = report_hash(v->key, &v->n_reps, sizeof v->n_reps);
        v->key = report_hash(v->key, &o->max_cut, sizeof o->max_cut);
    }
}

static lc_status load(report *r, lc_context *ctx, const report_scene *s, uint32_t n_reps, lc_scene **scene)
{
    lc_load_desc d = LC_LOAD_DESC_INIT;
    d.n_reps = n_reps;
    d.max_pixels = r->o->quick ? QUICK_PIXELS : 0;
    cli_leave_signals(); /* a load looks for none, and what is rendered is kept */
    lc_status st = lc_scene_load(ctx, s->path, &d, scene);
    cli_catch_signals();
    return st;
}

static int input_status(lc_status st) { return st == LC_ERR_IO ? CLI_INPUT : cli_exit_status(st); }

/* Loads every scene of which a render is missing, so that errors in it are reported before hours of other
 * renders, and adds up the work. */
static int survey(report *r, lc_context *ctx, report_scene *s, double *work, uint32_t *n_missing)
{
    lc_scene *scene;
    lc_scene_info info = LC_SCENE_INFO_INIT;
    uint32_t missing = 0;
    set_up_renders(r, s);
    for (uint32_t i = 0; i < r->n_renders; i++) {
        s->renders[i].kept = report_read_kept(ctx, r, s, &s->renders[i]);
        missing += !s->renders[i].kept;
    }
    *n_missing += missing;
    if (!missing) return CLI_OK;
    lc_status st = load(r, ctx, s, 1, &scene);
    if (st) return input_status(st);
    lc_scene_get_info(scene, &info);
    lc_scene_destroy(scene);
    double pixels = (double)(info.crop[1] - info.crop[0]) * (info.crop[3] - info.crop[2]);
    for (uint32_t i = 0; i < r->n_renders; i++)
        if (!s->renders[i].kept) *work += work_of(&s->renders[i], (double)info.n_lights, pixels);
    return CLI_OK;
}

/* ---- doing it ---- */

/* Renders once more and keeps the shorter time. Without progress, as printing takes time too. */
static lc_status again(lc_context *ctx, const lc_scene *scene, const lc_render_desc *d,
                       lc_render_stats *stats)
{
    lc_render_desc silent = *d;
    lc_render_stats more = LC_RENDER_STATS_INIT;
    lc_image *image;
    silent.progress = NULL;
    lc_status st = lc_render(ctx, scene, &silent, &image, &more);
    if (st) return st;
    lc_image_destroy(image);
    if (more.seconds < stats->seconds) stats->seconds = more.seconds;
    return LC_OK;
}

static void take_stats(report_render *v, const lc_scene_info *info, const lc_render_stats *st,
                       const lc_image *image)
{
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    lc_image_get_desc(image, &d);
    v->stats = (report_stats){ .width = d.width,
                               .height = d.height,
                               .triangles = (double)info->n_triangles,
                               .lights = (double)info->n_lights,
                               .seconds = st->seconds,
                               .tree_seconds = info->seconds_tree,
                               .cut_mean = st->cut_mean,
                               .cut_median = st->cut_median,
                               .cut_p99 = st->cut_p99,
                               .cut_max = st->cut_max,
                               .at_limit = (double)st->cut_at_limit,
                               .points = (double)st->points,
                               .shadow_rays = (double)st->shadow_rays,
                               .every_light = st->exact };
}

static int render_one(report *r, lc_context *ctx, const report_scene *s, report_render *v,
                      const lc_scene *scene, progress *p)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_scene_info info = LC_SCENE_INFO_INIT;
    lc_render_stats stats = LC_RENDER_STATS_INIT;
    lc_image *image = NULL;
    char what[96];
    lc_scene_get_info(scene, &info);
    if (v->method == LC_METHOD_EXACT) snprintf(what, sizeof what, "%.14s exact", s->name);
    else snprintf(what, sizeof what, "%.14s %g r%-2u", s->name, v->ratio, v->n_reps);
    char padded[40]; /* of fixed width, so that a shorter line covers a longer one */
    snprintf(padded, sizeof padded, "%-20.32s", what);
    p->line.what = padded;
    p->now = work_of(v, (double)info.n_lights,
                     (double)(info.crop[1] - info.crop[0]) * (info.crop[3] - info.crop[2]));
    d.method = v->method;
    if (v->method != LC_METHOD_EXACT) d.error_ratio = (float)v->ratio;
    d.max_cut = r->o->max_cut;
    d.aovs = LC_AOV_CUT; /* the sizes of the cuts; with them the file holds whole floats */
    d.progress = step;
    d.progress_user = p;
    lc_status st = lc_render(ctx, scene, &d, &image, &stats);
    for (int i = 1; i < RUNS && !st && stats.seconds < SHORT && !r->o->quick; i++)
        st = again(ctx, scene, &d, &stats);
    int status = cli_exit_status(st);
    if (!st) {
        take_stats(v, &info, &stats, image);
        status = report_write_kept(r, s, v, image);
    }
    v->kept = status == CLI_OK;
    lc_image_destroy(image);
    p->done += p->now;
    p->now = 0;
    p->line.what = "";
    return status;
}

/* Renders [from, to), which share a light tree. */
static int render_group(report *r, lc_context *ctx, report_scene *s, uint32_t from, uint32_t to, progress *p)
{
    lc_scene *scene = NULL;
    int status = CLI_OK;
    for (uint32_t i = from; i < to && status == CLI_OK; i++) {
        report_render *v = &s->renders[i];
        if (v->kept) continue;
        if (!scene) {
            lc_status st = load(r, ctx, s, v->n_reps, &scene);
            if (st) return input_status(st);
        }
        status = render_one(r, ctx, s, v, scene, p);
    }
    lc_scene_destroy(scene);
    return status;
}

static int survey_all(report *r, progress *p, uint32_t *n_missing)
{
    lc_context *ctx = cli_context(r->o->n_threads, r->o->isa, r->o->quiet ? -1 : 0);
    int status = ctx ? CLI_OK : CLI_FAILED;
    if (!status) {
        r->n_threads = lc_context_threads(ctx);
        r->isa = lc_isa_name(lc_context_isa(ctx));
    }
    for (uint32_t k = 0; k < r->o->n_scenes && !status; k++)
        status = survey(r, ctx, &r->scenes[k], &p->total, n_missing);
    lc_context_destroy(ctx);
    return status;
}

int report_render_all(report *r)
{
    progress p = { .total = 0 };
    uint32_t n_missing = 0, n_all = r->n_renders * r->o->n_scenes;
    int status = survey_all(r, &p, &n_missing);
    if (status || !n_missing) return status;
    if (n_missing < n_all && !r->o->quiet)
        fprintf(stderr, "lightcuts: %u of %u renders are there from before\n", n_all - n_missing, n_all);
    lc_context *ctx = cli_context(r->o->n_threads, r->o->isa, -1); /* the survey has printed the warnings */
    if (!ctx) return CLI_FAILED;
    cli_catch_signals();
    cli_progress_start(&p.line, "", r->o->quiet);
    for (uint32_t k = 0; k < r->o->n_scenes && !status; k++) {
        status = render_group(r, ctx, &r->scenes[k], 0, 1 + r->o->n_ratios, &p);
        if (!status) status = render_group(r, ctx, &r->scenes[k], 1 + r->o->n_ratios, r->n_renders, &p);
    }
    cli_progress_end(&p.line);
    lc_context_destroy(ctx);
    return status;
}
