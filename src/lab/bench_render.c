/* bench_render.c - what a frame costs over its own rays: the CPU time of a render divided by that of the same
 * shadow and camera rays alone. The shadow rays of a point are traced together, and filling the kernel's
 * arrays counts, as in `bench rays`.
 *
 *     render 1 -> record its rays (one thread) -> rays 1 -> render 2 -> rays 2 -> render 3 -> rays 3
 *
 * Renders and rays take turns, so that whatever slows the processor slows both. Where all rays would not fit
 * in memory, one block of camera rays out of several is recorded with its shadow rays, and their time is
 * scaled to the whole frame.
 */
#include "lab/bench.h"

#include "base/pool.h"
#include "base/stats.h"
#include "cli/cli.h"
#include "lab/bench_record.h"
#include "scene/scene.h"

#include <string.h>

#define RUNS 3 /* by default */
#define MAX_TARGETS ((size_t)80 << 20) /* limit of the recorded shadow rays, 12 bytes each: below 1 GiB */
#define GROUPS 64  /* shading points that a thread takes at a time */
#define CAMERAS 1024 /* camera rays that a thread takes at a time */
#define PIECE 1024 /* limit of rays in a kernel call; a multiple of LC_LANES */

typedef unsigned long long ull;

/* What is timed, and by which clock. */
enum { RENDER, SHADOW, CAMERA, RAYS, N_PARTS }; /* RAYS: shadow and camera rays of a run together */
enum { WALL, CPU, N_CLOCKS };

typedef struct job {
    lc_context *ctx;
    lc_scene *scene;
    bench_record rec;
    lc_render_stats stats;
    uint64_t *n_hidden;   /* by thread, 8 apart: a cache line each */
    double (*times)[N_PARTS][BENCH_MAX_RUNS]; /* N_CLOCKS; seconds of each run, rays scaled to the frame */
    bool differs;         /* rays that are traced again are not occluded as in the render */
} job;

typedef struct seconds {
    double of[N_CLOCKS];
} seconds;

static seconds now(void) { return (seconds){ { lc_now(), lc_process_cpu() } }; }

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

/* Times the recorded rays, which must be occluded as they were in the render. */
static lc_status replay(job *j, uint32_t run)
{
    const bench_record *r = &j->rec;
    uint64_t n_hidden = 0;
    memset(j->n_hidden, 0, j->ctx->n_threads * 8 * sizeof *j->n_hidden);
    seconds t0 = now();
    lc_parallel(j->ctx, (r->n_groups + GROUPS - 1) / GROUPS, replay_groups, j);
    seconds t1 = now();
    lc_parallel(j->ctx, (r->n_cameras + CAMERAS - 1) / CAMERAS, replay_cameras, j);
    seconds t2 = now();
    for (int c = 0; c < N_CLOCKS; c++) {
        double(*t)[BENCH_MAX_RUNS] = j->times[c];
        t[SHADOW][run] = (t1.of[c] - t0.of[c]) * ratio_of((double)r->n_shadow_seen, (double)r->n_targets);
        t[CAMERA][run] = (t2.of[c] - t1.of[c]) * ratio_of((double)r->n_camera_seen, (double)r->n_cameras);
        t[RAYS][run] = t[SHADOW][run] + t[CAMERA][run];
    }
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

/* Renders once more with one thread and records the rays. */
static lc_status record(job *j, const bench_options *o)
{
    lc_context *single = cli_context(1, o->isa, -1);
    if (!single) return LC_ERR_MEMORY;
    uint64_t every = 1 + j->stats.shadow_rays / (MAX_TARGETS / 16 * 15);
    uint64_t want = j->stats.shadow_rays / 8 * 9 + (1 << 20); /* rays of the pre-pass are not counted */
    lc_status st = bench_record_start(&j->rec, j->ctx, j->scene->bvh, every,
                                      want < MAX_TARGETS ? (size_t)want : MAX_TARGETS);
    if (!st) {
        st = render(single, o, j->scene, NULL);
        lc_status stopped = bench_record_stop(&j->rec);
        if (!st) st = stopped;
    }
    lc_context_destroy(single);
    if (st) return st;
    if (j->rec.n_shadow_seen < j->stats.shadow_rays) /* then the ratio is of different rays */
        lc_log(j->ctx, LC_LOG_WARNING, "warning: the render counts %llu shadow rays, the kernels saw %llu",
               (ull)j->stats.shadow_rays, (ull)j->rec.n_shadow_seen);
    j->n_hidden = lc_alloc(j->ctx, j->ctx->n_threads, 8 * sizeof *j->n_hidden);
    return j->n_hidden ? LC_OK : LC_ERR_MEMORY;
}

static lc_status measure(job *j, const bench_options *o, uint32_t n_runs)
{
    lc_status st = LC_OK;
    for (uint32_t k = 0; k < n_runs && !st; k++) {
        double t0 = lc_process_cpu();
        st = render(j->ctx, o, j->scene, &j->stats);
        j->times[CPU][RENDER][k] = lc_process_cpu() - t0;
        j->times[WALL][RENDER][k] = j->stats.seconds;
        if (!k && !st) st = record(j, o);
        if (!st) st = replay(j, k);
    }
    return st;
}

typedef struct figures {
    bench_summary of[N_CLOCKS][N_PARTS]; /* seconds */
    double share;                        /* of the shadow rays that were recorded */
    double per_point;                    /* shadow rays a shading point */
} figures;

static figures figures_of(job *j, uint32_t n_runs)
{
    figures f = { .share = ratio_of((double)j->rec.n_targets, (double)j->rec.n_shadow_seen) };
    for (int c = 0; c < N_CLOCKS; c++)
        for (int p = 0; p < N_PARTS; p++) f.of[c][p] = bench_summarize(j->times[c][p], n_runs);
    f.per_point = ratio_of((double)j->stats.shadow_rays, (double)j->stats.points);
    return f;
}

/* Million rays a second; for a render its shadow rays count. */
static double rate(const job *j, int part, double seconds_of_part)
{
    uint64_t n = part == CAMERA ? j->rec.n_camera_seen : j->rec.n_shadow_seen;
    return ratio_of((double)n * 1e-6, seconds_of_part);
}

static void print_scene(const job *j, const bench_options *o)
{
    printf("scene     %s: %zu triangles, %zu lights; %s", cli_shown(o->scene), j->scene->n_tris,
           j->scene->n_lights,
           cli_method_name(o->render.method));
    if (o->render.method != LC_METHOD_EXACT)
        printf(", error ratio %g, at most %u clusters", (double)o->render.error_ratio, o->render.max_cut);
    printf("; %s, %u thread%s; CPU time is of all threads\n", lc_isa_name(j->ctx->isa), j->ctx->n_threads,
           j->ctx->n_threads == 1 ? "" : "s");
}

static void print_text(const job *j, const bench_options *o, const figures *f)
{
    const bench_summary *cpu = f->of[CPU], *wall = f->of[WALL];
    print_scene(j, o);
    printf(
        "render    CPU best %.3f s, median %.3f s, %.2f Mrays per CPU second; wall clock best %.3f s, %.2f "
        "Mrays/s\n",
        cpu[RENDER].best, cpu[RENDER].median, rate(j, RENDER, cpu[RENDER].best), wall[RENDER].best,
        rate(j, RENDER, wall[RENDER].best));
    printf("points    %llu, %.1f shadow rays a point\n", (ull)j->stats.points, f->per_point);
    printf("rays      CPU best %.3f s, median %.3f s: shadow rays %.3f s, %.2f Mrays per CPU second; camera "
           "rays "
           "%.3f s, %.2f\n",
           cpu[RAYS].best, cpu[RAYS].median, cpu[SHADOW].best, rate(j, SHADOW, cpu[SHADOW].best),
           cpu[CAMERA].best, rate(j, CAMERA, cpu[CAMERA].best));
    printf("          wall clock best %.3f s: shadow rays %.2f Mrays/s, camera rays %.2f Mrays/s\n",
           wall[RAYS].best, rate(j, SHADOW, wall[SHADOW].best), rate(j, CAMERA, wall[CAMERA].best));
    printf("recorded  %.1f %% of %llu shadow rays in %zu groups%s\n", 100 * f->share,
           (ull)j->rec.n_shadow_seen, j->rec.n_groups,
           f->share < 1 ? "; the time of the rays is scaled to all" : "");
    printf("speed     %.3f of the rays' alone (shadow rays per CPU second of the render and of the rays)\n",
           ratio_of(cpu[SHADOW].best, cpu[RENDER].best));
    printf("ratio     %.3f (of the best CPU times; %.3f of the medians, %.3f of the best wall clock times)\n",
           ratio_of(cpu[RENDER].best, cpu[RAYS].best), ratio_of(cpu[RENDER].median, cpu[RAYS].median),
           ratio_of(wall[RENDER].best, wall[RAYS].best));
}

static void print_times(const figures *f)
{
    static const char *const names[N_PARTS] = { "render", "shadow", "camera", "ray" };
    for (int p = 0; p < N_PARTS; p++)
        printf(
            "     \"%s_seconds_median\": %.9g, \"%s_seconds_best\": %.9g, \"%s_cpu_seconds_median\": %.9g, "
            "\"%s_cpu_seconds_best\": %.9g,\n",
            names[p], f->of[WALL][p].median, names[p], f->of[WALL][p].best, names[p], f->of[CPU][p].median,
            names[p], f->of[CPU][p].best);
}

static void print_rates(const job *j, const figures *f)
{
    static const char *const names[] = { "render", "shadow", "camera" };
    for (int p = RENDER; p <= CAMERA; p++)
        printf("     \"%s_mrays_per_second\": %.6g, \"%s_mrays_per_cpu_second\": %.6g,\n", names[p],
               rate(j, p, f->of[WALL][p].median), names[p], rate(j, p, f->of[CPU][p].best));
}

static void print_json(const job *j, const bench_options *o, const figures *f, uint32_t n_runs)
{
    const bench_summary *cpu = f->of[CPU], *wall = f->of[WALL];
    bench_json_begin("render", j->ctx->n_threads);
    bench_json_next(true);
    printf("{\"scene\": ");
    cli_json_text(stdout, o->scene);
    printf(", \"triangles\": %zu, \"lights\": %zu, \"method\": \"%s\", \"error_ratio\": %.6g, \"max_cut\": "
           "%u, \"isa\": \"%s\", \"runs\": %u, \"clock\": \"wall\",\n",
           j->scene->n_tris, j->scene->n_lights, cli_method_name(o->render.method),
           (double)o->render.error_ratio, o->render.max_cut, lc_isa_name(j->ctx->isa), n_runs);
    printf("     \"points\": %llu, \"shadow_rays\": %llu, \"camera_rays\": %llu, \"shadow_rays_per_point\": "
           "%.6g, \"recorded_share\": %.6g,\n",
           (ull)j->stats.points, (ull)j->rec.n_shadow_seen, (ull)j->rec.n_camera_seen, f->per_point,
           f->share);
    print_times(f);
    print_rates(j, f);
    printf("     \"ratio\": %.6g, \"ratio_best\": %.6g, \"cpu_ratio\": %.6g, \"cpu_ratio_best\": %.6g}",
           ratio_of(wall[RENDER].median, wall[RAYS].median), ratio_of(wall[RENDER].best, wall[RAYS].best),
           ratio_of(cpu[RENDER].median, cpu[RAYS].median), ratio_of(cpu[RENDER].best, cpu[RAYS].best));
    bench_json_end();
}

static lc_status run(job *j, const bench_options *o)
{
    static double times[N_CLOCKS][N_PARTS][BENCH_MAX_RUNS];
    uint32_t n_runs = o->n_runs ? o->n_runs : RUNS;
    j->times = times;
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
    job j = { .ctx = cli_context(o->n_threads, o->isa, 0), .stats = LC_RENDER_STATS_INIT };
    if (!j.ctx) return CLI_FAILED;
    lc_status st = run(&j, o);
    if (j.rec.ctx) bench_record_free(&j.rec);
    lc_free(j.ctx, j.n_hidden, j.ctx->n_threads, 8 * sizeof *j.n_hidden);
    lc_scene_destroy(j.scene);
    lc_context_destroy(j.ctx);
    if (j.differs) return CLI_FAILED;
    return st == LC_ERR_IO ? CLI_INPUT : cli_exit_status(st);
}
