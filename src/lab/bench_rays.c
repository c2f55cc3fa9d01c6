/* bench_rays.c - shadow rays a second, and the build of the BVH they are traced through.
 *
 * Rays of one origin go to the kernel together, as the renderer sends those of a shading point; making the
 * kernel's arrays out of the file's rays is part of the time. Chunks of 16384 rays are handed to the threads.
 * Rates are of the process's CPU time, and by the wall clock, which other programs on the machine slow down.
 * The most stable rate is `quiet`: each chunk counts with the least CPU time it ever took.
 */
#include "lab/bench.h"

#include "base/pool.h"
#include "base/stats.h"
#include "cli/cli.h"
#include "lab/bench_file.h"
#include "trace/bvh.h"

#include <string.h>

#define CHUNK 16384u    /* rays that a thread takes at a time */
#define MAX_GROUP 1024u /* rays in one kernel call; a multiple of LC_LANES */
#define UNKNOWN_GROUP 64u /* rays in one kernel call where the file does not say how many share an origin */
#define RUNS 5          /* by default */
#define POINTS 6400 /* points that generated rays start from */

typedef unsigned long long ull;

typedef struct job {
    lc_context *ctx;
    const char *mesh_name, *rays_name;
    bench_mesh mesh;
    bench_segments rays;
    uint32_t max_group, n_runs;
    lc_bvh *bvh;
    const lc_trace_kernels *kernels; /* of the instruction set that is timed */
    uint64_t n_chunks;
    double *quiet;             /* least CPU seconds of each chunk */
    uint32_t *hidden;          /* occluded rays of each chunk */
} job;

/* Seconds by the wall clock, and of CPU time of all threads. */
typedef struct timing {
    bench_summary wall, cpu;
} timing;

typedef struct result {
    lc_isa isa;
    timing seconds;
    double quiet;      /* seconds on all threads, every chunk at its least CPU time */
    uint64_t occluded;
} result;

static bool same_origin(const float *a, const float *b)
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static uint32_t trace(const job *j, const float *ray, uint64_t n)
{
    _Alignas(64) float x[3][MAX_GROUP];
    _Alignas(64) uint8_t hidden[MAX_GROUP];
    const float *const target[3] = { x[0], x[1], x[2] };
    uint32_t occluded = 0;
    for (const float *end = ray + 6 * n; ray < end;) {
        const float *org = ray;
        uint32_t m = 0;
        do {
            x[0][m] = ray[3];
            x[1][m] = ray[4];
            x[2][m] = ray[5];
            ray += 6;
        } while (++m < j->max_group && ray < end && same_origin(ray, org));
        j->kernels->hidden(&j->bvh->data, org, m, target, false, hidden, NULL);
        for (uint32_t i = 0; i < m; i++) occluded += hidden[i];
    }
    return occluded;
}

static void trace_chunk(void *user, uint32_t thread, uint64_t item)
{
    job *j = user;
    uint64_t first = item * CHUNK, n = j->rays.n - first < CHUNK ? j->rays.n - first : CHUNK;
    (void)thread;
    double t0 = lc_thread_cpu();
    j->hidden[item] = trace(j, j->rays.ray + 6 * first, n);
    double s = lc_thread_cpu() - t0;
    if (s < j->quiet[item]) j->quiet[item] = s;
}

/* Times the rays with one instruction set. */
static result run_rays(job *j, lc_isa isa)
{
    double wall[BENCH_MAX_RUNS], cpu[BENCH_MAX_RUNS];
    result r = { .isa = isa };
    j->kernels = &lc_isa_kernels(isa)->trace;
    for (uint64_t i = 0; i < j->n_chunks; i++) j->quiet[i] = 1e30;
    for (uint32_t k = 0; k < j->n_runs; k++) {
        double wall0 = lc_now(), cpu0 = lc_process_cpu();
        lc_parallel(j->ctx, j->n_chunks, trace_chunk, j);
        wall[k] = lc_now() - wall0;
        cpu[k] = lc_process_cpu() - cpu0;
    }
    r.seconds.wall = bench_summarize(wall, j->n_runs);
    r.seconds.cpu = bench_summarize(cpu, j->n_runs);
    for (uint64_t i = 0; i < j->n_chunks; i++) {
        r.quiet += j->quiet[i];
        r.occluded += j->hidden[i];
    }
    r.quiet /= j->ctx->n_threads < j->n_chunks ? (double)j->ctx->n_threads : (double)j->n_chunks;
    return r;
}

static lc_status run_build(job *j, timing *out)
{
    double wall[BENCH_MAX_RUNS], cpu[BENCH_MAX_RUNS];
    for (uint32_t k = 0; k < j->n_runs; k++) {
        lc_bvh_destroy(j->bvh);
        double wall0 = lc_now(), cpu0 = lc_process_cpu();
        lc_status st = lc_bvh_build(j->ctx, j->mesh.pos, j->mesh.index, j->mesh.n_tris, &j->bvh);
        wall[k] = lc_now() - wall0;
        cpu[k] = lc_process_cpu() - cpu0;
        if (st) return st;
    }
    out->wall = bench_summarize(wall, j->n_runs);
    out->cpu = bench_summarize(cpu, j->n_runs);
    return LC_OK;
}

static void print_build(const job *j, const timing *b)
{
    printf("runs    %u on %u thread%s; CPU time is of all threads\n", j->n_runs, j->ctx->n_threads,
           j->ctx->n_threads == 1 ? "" : "s");
    printf("mesh    %s: %u triangles, %u vertices\n", cli_shown(j->mesh_name), j->mesh.n_tris,
           j->mesh.n_verts);
    printf("build   CPU best %.3f ms, median %.3f ms; wall clock best %.3f ms, median %.3f ms, %.2f "
           "Mtriangles/s at best; %.2f MB\n",
           b->cpu.best * 1e3, b->cpu.median * 1e3, b->wall.best * 1e3, b->wall.median * 1e3,
           j->mesh.n_tris / b->wall.best * 1e-6, (double)lc_bvh_bytes(j->bvh) * 1e-6);
    printf("rays    %s: %llu rays, at most %u of one origin at a time\n", cli_shown(j->rays_name),
           (ull)j->rays.n,
           j->max_group);
}

static void print_rays(const job *j, const result *r)
{
    double m = (double)j->rays.n * 1e-6;
    printf("%-7s best %.2f, median %.2f Mrays per CPU second; wall clock best %.2f, median %.2f, quiet %.2f "
           "Mrays/s; %llu occluded (%.2f %%)\n",
           lc_isa_name(r->isa), m / r->seconds.cpu.best, m / r->seconds.cpu.median, m / r->seconds.wall.best,
           m / r->seconds.wall.median, m / r->quiet, (ull)r->occluded, 1e-4 * (double)r->occluded / m);
}

static void print_json(const job *j, const timing *b, const result *r)
{
    double m = (double)j->rays.n * 1e-6;
    printf("{\"mesh\": ");
    cli_json_text(stdout, j->mesh_name);
    printf(", \"rays\": ");
    cli_json_text(stdout, j->rays_name);
    printf(", \"triangles\": %u, \"vertices\": %u, \"n_rays\": %llu,\n     \"isa\": \"%s\", \"runs\": %u, "
           "\"clock\": \"wall\", \"build_seconds_best\": %.9g, \"build_seconds_median\": %.9g,\n"
           "     \"build_cpu_seconds_best\": %.9g, \"build_cpu_seconds_median\": %.9g, \"bvh_bytes\": %zu,\n"
           "     \"mrays_per_second_best\": %.6g, \"mrays_per_second_median\": %.6g, "
           "\"mrays_per_second_quiet\": %.6g,\n"
           "     \"mrays_per_cpu_second_best\": %.6g, \"mrays_per_cpu_second_median\": %.6g, "
           "\"occluded\": %llu}",
           j->mesh.n_tris, j->mesh.n_verts, (ull)j->rays.n, lc_isa_name(r->isa), j->n_runs, b->wall.best,
           b->wall.median, b->cpu.best, b->cpu.median, lc_bvh_bytes(j->bvh), m / r->seconds.wall.best,
           m / r->seconds.wall.median, m / r->quiet, m / r->seconds.cpu.best, m / r->seconds.cpu.median,
           (ull)r->occluded);
}

/* Times one mesh and its rays. first: no result has been printed. */
static lc_status run_all(const bench_options *o, job *j, const bench_isas *isas, bool first)
{
    timing build;
    j->max_group = !j->rays.group ? UNKNOWN_GROUP : j->rays.group < MAX_GROUP ? j->rays.group : MAX_GROUP;
    j->n_chunks = (j->rays.n + CHUNK - 1) / CHUNK;
    j->quiet = lc_alloc(j->ctx, j->n_chunks, sizeof *j->quiet);
    j->hidden = lc_alloc(j->ctx, j->n_chunks, sizeof *j->hidden);
    if (!j->quiet || !j->hidden) return LC_ERR_MEMORY;
    lc_status st = run_build(j, &build);
    if (st) return st;
    if (!o->json) print_build(j, &build);
    for (uint32_t i = 0; i < isas->n; i++) {
        result r = run_rays(j, isas->of[i]);
        if (o->json) {
            bench_json_next(first);
            print_json(j, &build, &r);
        } else print_rays(j, &r);
        first = false;
    }
    return LC_OK;
}

static void free_job(job *j)
{
    lc_bvh_destroy(j->bvh);
    lc_free(j->ctx, j->quiet, j->n_chunks, sizeof *j->quiet);
    lc_free(j->ctx, j->hidden, j->n_chunks, sizeof *j->hidden);
    lc_file_free(j->ctx, &j->mesh.file);
    lc_file_free(j->ctx, &j->rays.file);
}

static lc_status run_files(const bench_options *o, lc_context *ctx, uint32_t n_runs)
{
    job j = { .ctx = ctx, .mesh_name = o->mesh, .rays_name = o->rays, .n_runs = n_runs };
    lc_status st = bench_read_mesh(ctx, o->mesh, &j.mesh);
    if (!st) st = bench_read_segments(ctx, o->rays, &j.rays);
    if (!st && o->json) bench_json_begin("rays", ctx->n_threads);
    if (!st) st = run_all(o, &j, &(bench_isas){ .n = 1, .of = { ctx->isa } }, true);
    if (!st && o->json) bench_json_end();
    free_job(&j);
    return st;
}

static lc_status run_made_up(const bench_options *o, lc_context *ctx, uint32_t n_runs)
{
    const bench_isas isas = bench_isas_of(o, ctx->isa);
    lc_status st = LC_OK;
    if (o->json) bench_json_begin("rays", ctx->n_threads);
    for (uint32_t n = 2; n <= 20000 && !st; n *= 100) {
        char name[32];
        snprintf(name, sizeof name, "%u boxes in a room", n);
        job j = {
            .ctx = ctx, .mesh_name = name, .rays_name = "from random points to 64 lights", .n_runs = n_runs
        };
        st = bench_make_mesh(ctx, n, &j.mesh);
        if (!st) st = bench_make_segments(ctx, POINTS, &j.rays);
        if (!st) st = run_all(o, &j, &isas, n == 2);
        free_job(&j);
    }
    if (o->json) bench_json_end();
    return st;
}

int bench_rays(const bench_options *o)
{
    uint32_t n_runs = o->n_runs ? o->n_runs : RUNS;
    lc_context *ctx = cli_context(o->n_threads, o->isa, 0);
    if (!ctx) return CLI_FAILED;
    lc_status st = o->mesh ? run_files(o, ctx, n_runs) : run_made_up(o, ctx, n_runs);
    lc_context_destroy(ctx);
    return st == LC_ERR_IO ? CLI_INPUT : cli_exit_status(st);
}
