/* bench_render.c - what a frame costs over its own rays: seconds of a render divided by the seconds that the
 * same shadow and camera rays take when nothing else is done: the shadow rays of a point together, and, as in
 * `bench rays`, with the making of the kernel's arrays.
 *
 *     render 1 -> record its rays (one thread) -> rays 1 -> render 2 -> rays 2 -> render 3 -> rays 3
 *
 * in turn, so that a busy machine slows both. Where all rays would not fit in memory, one block of tiles out
 * of so many is recorded and the time of its rays scaled by their share.
 */
#include "lab/bench.h"

#include "base/pool.h"
#include "base/stats.h"
#include "cli/cli.h"
#include "lab/bench_record.h"
#include "scene/scene.h"

#include <string.h>

#define RUNS 3
#define MAX_TARGETS ((size_t)80 << 20) /* shadow rays kept at most, 12 bytes each: below 1 GiB */
#define GROUPS 64  /* shading points handed to a thread at a time */
#define CAMERAS 1024
#define PIECE 1024 /* rays in one kernel call at most; a multiple of LC_LANES */

typedef unsigned long long ull;

typedef struct job {
    lc_context *ctx;
    lc_scene *scene;
    bench_record rec;
    lc_render_stats stats;
    uint64_t *n_hidden;   /* by thread, 8 apart: a cache line each */
    double
        *times[3]; /* render, shadow rays, camera rays; seconds of each run, rays scaled to the whole frame */
    bool differs;         /* rays traced again were not occluded as they were in the render */
} job;

static double ratio_of(double a, double b) { return b > 0 ? a / b : 0; }

static uint32_t replay_group(const bench_record *r, const record_group *g)
{
    _Alignas(64) float x[3][PIECE];
    _Alignas(64) uint8_t hidden[PIECE];
    const float *const target[3] = { x[0], x[1], x[2] };
    const float *from = r->target + 3 * g->first;
    uint32_t count = 0;
    for (uint32_t done = 0, n; done < g->n; done += n) {
        n = g->n - done < PIECE ? g->n - done : PIECE;
        for (uint32_t i = 0; i < n; i++, from += 3) {
            x[0][i] = from[0];
            x[1][i] = from[1];
            x[2][i] = from[2];
        }
        r->real->hidden(&r->bvh->data, g->org, n, target, g->far, hidden, NULL);
        for (uint32_t i = 0; i < n; i++) count += hidden[i];
    }
    return count;
}

static void replay_groups(void *user, uint32_t thread, uint64_t item)
{
    const job *j = user;
    const bench_record *r = &j->rec;
    uint64_t end = (item + 1) * GROUPS < r->n_groups ? (item + 1) * GROUPS : r->n_groups, count = 0;
    for (uint64_t i = item * GROUPS; i < end; i++) count += replay_group(r, &r->groups[i]);
    j->n_hidden[8 * thread] += count;
}

static void replay_cameras(void *user, uint32_t thread, uint64_t item)
{
    const job *j = user;
    const bench_record *r = &j->rec;
    uint64_t end = (item + 1) * CAMERAS < r->n_cameras ? (item + 1) * CAMERAS : r->n_cameras;
    (void)thread;
    for (uint64_t i = item * CAMERAS; i < end; i++) {
        const record_camera *c = &r->cameras[i];
        lc_hit hit;
        r->real->closest(&r->bvh->data, c->org, c->dir, c->t_max, &hit);
    }
}

/* Times the recorded rays; the render has found the same ones occluded, or something is wrong. */
static lc_status replay(job *j, uint32_t run)
{
    const bench_record *r = &j->rec;
    uint64_t n_hidden = 0;
    memset(j->n_hidden, 0, j->ctx->n_threads * 8 * sizeof *j->n_hidden);
    double t0 = lc_now();
    lc_parallel(j->ctx, (r->n_groups + GROUPS - 1) / GROUPS, replay_groups, j);
    double t1 = lc_now();
    lc_parallel(j->ctx, (r->n_cameras + CAMERAS - 1) / CAMERAS, replay_cameras, j);
    double t2 = lc_now();
    j->times[1][run] = (t1 - t0) * ratio_of((double)r->n_shadow_seen, (double)r->n_targets);
    j->times[2][run] = (t2 - t1) * ratio_of((double)r->n_camera_seen, (double)r->n_cameras);
    for (uint32_t t = 0; t < j->ctx->n_threads; t++) n_hidden += j->n_hidden[8 * t];
    j->differs = n_hidden != r->n_hidden;
    if (!j->differs) return LC_OK;
    return lc_fail(j->ctx, LC_ERR_CANCELLED,
                   "%llu of the recorded rays were occluded, %llu of the same rays traced again",
                   (ull)r->n_hidden, (ull)n_hidden);
}

static lc_status render(lc_context *ctx, const bench_options *o, const lc_scene *scene,
                        lc_render_stats *stats)
{
    lc_image *image;
    lc_status st = lc_render(ctx, scene, &o->render, &image, stats);
    lc_image_destroy(image);
    return st;
}

/* Renders once more, by one thread, and keeps what rays it traces. */
static lc_status record(job *j, const bench_options *o)
{
    lc_context *single = cli_context(1, o->isa, -1);
    if (!single) return LC_ERR_MEMORY;
    uint64_t every = 1 + j->stats.shadow_rays / (MAX_TARGETS / 16 * 15);
    uint64_t want = j->stats.shadow_rays / 8 * 9 + (1 << 20); /* the pre-pass is not counted */
    lc_status st = bench_record_start(&j->rec, j->ctx, j->scene->bvh, every,
                                      want < MAX_TARGETS ? (size_t)want : MAX_TARGETS);
    if (!st) {
        st = render(single, o, j->scene, NULL);
        lc_status stopped = bench_record_stop(&j->rec);
        if (!st) st = stopped;
    }
    lc_context_destroy(single);
    if (st) return st;
    if (j->rec.n_shadow_seen < j->stats.shadow_rays) /* then the ratio is of other rays than it says */
        lc_log(j->ctx, LC_LOG_WARNING, "warning: the render counts %llu shadow rays, the kernels saw %llu",
               (ull)j->stats.shadow_rays, (ull)j->rec.n_shadow_seen);
    j->n_hidden = lc_alloc(j->ctx, j->ctx->n_threads, 8 * sizeof *j->n_hidden);
    return j->n_hidden ? LC_OK : LC_ERR_MEMORY;
}

static lc_status measure(job *j, const bench_options *o, uint32_t n_runs)
{
    lc_status st = LC_OK;
    for (uint32_t k = 0; k < n_runs && !st; k++) {
        st = render(j->ctx, o, j->scene, &j->stats);
        j->times[0][k] = j->stats.seconds;
        if (!k && !st) st = record(j, o);
        if (!st) st = replay(j, k);
    }
    return st;
}

typedef struct figures {
    bench_summary render, shadow, camera, rays; /* seconds; rays: shadow and camera of a run together */
    double share;                               /* of the shadow rays that were recorded */
    double ratio, ratio_best;
    double render_rate, shadow_rate,
        camera_rate; /* million rays a second, medians; the render's: shadow rays */
    double per_point;
} figures;

static figures figures_of(job *j, uint32_t n_runs)
{
    figures f = { .share = ratio_of((double)j->rec.n_targets, (double)j->rec.n_shadow_seen) };
    double rays[BENCH_MAX_RUNS];
    for (uint32_t k = 0; k < n_runs; k++) rays[k] = j->times[1][k] + j->times[2][k];
    f.render = bench_summarize(j->times[0], n_runs);
    f.shadow = bench_summarize(j->times[1], n_runs);
    f.camera = bench_summarize(j->times[2], n_runs);
    f.rays = bench_summarize(rays, n_runs);
    f.ratio = ratio_of(f.render.median, f.rays.median);
    f.ratio_best = ratio_of(f.render.best, f.rays.best);
    f.render_rate = ratio_of((double)j->rec.n_shadow_seen * 1e-6, f.render.median);
    f.shadow_rate = ratio_of((double)j->rec.n_shadow_seen * 1e-6, f.shadow.median);
    f.camera_rate = ratio_of((double)j->rec.n_camera_seen * 1e-6, f.camera.median);
    f.per_point = ratio_of((double)j->stats.shadow_rays, (double)j->stats.points);
    return f;
}

static void print_text(const job *j, const bench_options *o, const figures *f)
{
    printf("scene     %s: %zu triangles, %zu lights; %s", o->scene, j->scene->n_tris, j->scene->n_lights,
           cli_method_name(o->render.method));
    if (o->render.method != LC_METHOD_EXACT)
        printf(", error ratio %g, at most %u clusters", (double)o->render.error_ratio, o->render.max_cut);
    printf("; %s, %u thread%s\n", lc_isa_name(j->ctx->isa), j->ctx->n_threads,
           j->ctx->n_threads == 1 ? "" : "s");
    printf("render    median %.3f s, best %.3f s; %llu points, %.1f shadow rays a point, %.2f Mrays/s\n",
           f->render.median, f->render.best, (ull)j->stats.points, f->per_point, f->render_rate);
    printf("rays      median %.3f s, best %.3f s: shadow rays %.3f s, %.2f Mrays/s; camera rays %.3f s, %.2f "
           "Mrays/s\n",
           f->rays.median, f->rays.best, f->shadow.median, f->shadow_rate, f->camera.median, f->camera_rate);
    printf("recorded  %.1f %% of %llu shadow rays in %zu groups%s\n", 100 * f->share,
           (ull)j->rec.n_shadow_seen, j->rec.n_groups,
           f->share < 1 ? "; the time of the rays is scaled to all" : "");
    printf("speed     %.3f of the rays' alone (shadow rays a second of the render and of the rays)\n",
           ratio_of(f->render_rate, f->shadow_rate));
    printf("ratio     %.3f (of the medians; %.3f of the best)\n", f->ratio, f->ratio_best);
}

static void print_json(const job *j, const bench_options *o, const figures *f, uint32_t n_runs)
{
    bench_json_begin("render", j->ctx->n_threads);
    bench_json_next(true);
    printf("{\"scene\": ");
    cli_json_text(stdout, o->scene);
    printf(", \"triangles\": %zu, \"lights\": %zu, \"method\": \"%s\", \"error_ratio\": %.6g, \"max_cut\": "
           "%u, \"isa\": \"%s\", "
           "\"runs\": %u,\n",
           j->scene->n_tris, j->scene->n_lights, cli_method_name(o->render.method),
           (double)o->render.error_ratio, o->render.max_cut, lc_isa_name(j->ctx->isa), n_runs);
    printf("     \"points\": %llu, \"shadow_rays\": %llu, \"camera_rays\": %llu, \"shadow_rays_per_point\": "
           "%.6g, "
           "\"recorded_share\": %.6g,\n",
           (ull)j->stats.points, (ull)j->rec.n_shadow_seen, (ull)j->rec.n_camera_seen, f->per_point,
           f->share);
    printf(
        "     \"render_seconds_median\": %.9g, \"render_seconds_best\": %.9g, \"ray_seconds_median\": %.9g, "
        "\"ray_seconds_best\": %.9g,\n     \"shadow_seconds_median\": %.9g, \"camera_seconds_median\": "
        "%.9g,\n",
        f->render.median, f->render.best, f->rays.median, f->rays.best, f->shadow.median, f->camera.median);
    printf("     \"render_mrays_per_second\": %.6g, \"shadow_mrays_per_second\": %.6g, "
           "\"camera_mrays_per_second\": %.6g,\n"
           "     \"ratio\": %.6g, \"ratio_best\": %.6g}",
           f->render_rate, f->shadow_rate, f->camera_rate, f->ratio, f->ratio_best);
    bench_json_end();
}

static lc_status run(job *j, const bench_options *o)
{
    static double times[3][BENCH_MAX_RUNS];
    uint32_t n_runs = o->n_runs ? o->n_runs : RUNS;
    for (int i = 0; i < 3; i++) j->times[i] = times[i];
    lc_status st = lc_scene_load(j->ctx, o->scene, &o->load, &j->scene);
    if (!st) st = measure(j, o, n_runs);
    if (st) return st;
    figures f = figures_of(j, n_runs);
    if (o->json) print_json(j, o, &f, n_runs);
    else print_text(j, o, &f);
    return LC_OK;
}

int bench_render(const bench_options *o)
{
    job j = { .ctx = cli_context(o->n_threads, o->isa, 0) };
    if (!j.ctx) return CLI_FAILED;
    lc_status st = run(&j, o);
    if (j.rec.ctx) bench_record_free(&j.rec);
    lc_free(j.ctx, j.n_hidden, j.ctx->n_threads, 8 * sizeof *j.n_hidden);
    lc_scene_destroy(j.scene);
    lc_context_destroy(j.ctx);
    if (j.differs) return CLI_FAILED;
    return st == LC_ERR_IO ? CLI_INPUT : cli_exit_status(st);
}
