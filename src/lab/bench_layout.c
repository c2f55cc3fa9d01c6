/* bench_layout.c - how light trees are laid out and cuts refined here, against the textbook's way.
 *
 *     generated scene -> its lights, as point lights -> light tree -> cuts of points on its surfaces
 *                                                           |              |
 *                                       bench_arrays.h <----'              '----> lists of bounded clusters
 *
 *     bounds       records: 64 bytes a cluster, gathered by index and transposed in registers (tree_data.h)
 *                  arrays: a cache line a field of 16 clusters (bench_arrays.h)
 *                  each for consecutive clusters, and for the pairs of siblings that those cuts bounded
 *     refinement   rounds: all clusters above the limit are split at once (cut.h)
 *                  heap, heap4: a max-heap gives the worst cluster, or the worst four (bench_heap.h)
 *
 * Receivers are grey and diffuse, and lights are points of inverse square: the cheapest bound, so that the
 * cost of reading the tree shows most. No ray is traced. The alternatives take turns, run by run.
 */
#include "lab/bench.h"

#include "base/stats.h"
#include "base/arena.h"
#include "cli/cli.h"
#include "cut/cut.h"
#include "lab/bench_arrays.h"
#include "lab/bench_heap.h"
#include "prepare/view_grid.h"

#include <math.h>
#include <string.h>

#define SCENE "room"
#define N_LIGHTS 10000u
#define N_REPS 16u       /* representatives of a cluster: the default of a render */
#define GRID_SIDE 16u    /* points: the first hits of 16 x 16 camera rays */
#define RUNS 15          /* by default */
#define BATCH 64u        /* consecutive clusters in a call */
#define MIN_BOUNDS 1000000u /* in a run, which repeats the list until it has as many */
#define MAX_ULP 4        /* greatest difference allowed between the bounds of the two layouts */
#define LINE 64u         /* bytes of a cache line */

typedef unsigned long long ull;

/* One call of the kernel. */
typedef struct call {
    size_t first; /* of its clusters in the list */
    uint32_t n, point;
} call;

/* The clusters that a kernel was asked for, call by call. */
typedef struct list {
    const lc_context *ctx;
    call *calls;
    uint32_t *index;
    size_t n_calls, cap_calls, n, cap_index;
    lc_status status;
} list;

enum { CONSECUTIVE, SIBLINGS, N_PATTERNS };
static const char *const pattern_names[N_PATTERNS] = { "consecutive", "siblings" };
enum { RECORDS, ARRAYS, N_LAYOUTS };
static const char *const layout_names[N_LAYOUTS] = { "records", "arrays" };
enum { ROUNDS, HEAP, HEAP4, N_METHODS };
static const char *const method_names[N_METHODS] = { "rounds", "heap", "heap4" };
static const uint32_t n_pops[N_METHODS] = { 0, 1, 4 };

typedef struct lines {
    double bound, split; /* cache lines a cluster: read for its bound; and for its children and its light */
} lines;

typedef struct method {
    bench_summary seconds; /* a cut */
    double size, bounds;   /* means over the cuts */
    double luminance;
} method;

typedef struct job {
    const bench_options *o;
    lc_context *ctx;
    lc_scene *scene;
    lc_light_tree *tree;
    lc_view_grid view; /* the points */
    bench_receiver *receivers;
    bench_arrays arrays;
    list lists[N_PATTERNS];
    lc_cut cut;
    bench_heap heaps[N_METHODS];
    uint32_t n_runs;
    uint32_t max_ulp; /* greatest difference found between the bounds of the two layouts */
    bench_summary bounds[N_PATTERNS][N_LAYOUTS]; /* seconds a cluster */
    lines lines[N_PATTERNS][N_LAYOUTS];
    method methods[N_METHODS];
} job;

/* ---- the points and the tree ---- */

static void nothing_hidden(const void *scene, const float org[3], uint32_t n, const float *const target[3],
                           bool far, uint8_t *hidden, uint32_t *blocker)
{
    (void)scene;
    (void)org;
    (void)target;
    (void)far;
    (void)blocker;
    memset(hidden, 0, n);
}

static lc_status build_tree(job *j)
{
    const lc_scene *s = j->scene;
    lc_light *lights = lc_alloc(j->ctx, s->n_lights, sizeof *lights);
    if (!lights) return LC_ERR_MEMORY;
    for (size_t i = 0; i < s->n_lights; i++) {
        lights[i] = (lc_light){ .kind = LC_LIGHT_POINT, .pos = s->lights[i].pos, .atten = { 0, 0, 1 } };
        lights[i].intensity = s->lights[i].intensity;
    }
    const lc_light_tree_desc desc = {
        .lights = lights, .n_lights = s->n_lights, .n_reps = N_REPS, .builder = LC_BUILDER_AUTO
    };
    lc_status st = lc_light_tree_build(j->ctx, &desc, &j->tree);
    lc_free(j->ctx, lights, s->n_lights, sizeof *lights);
    return st;
}

static lc_status init_points(job *j)
{
    lc_status st = lc_view_grid_init(&j->view, j->scene, GRID_SIDE, 1);
    if (st) return st;
    if (!j->view.n) return lc_fail(j->ctx, LC_ERR_ARG, "the camera sees nothing");
    j->receivers = lc_alloc(j->ctx, j->view.n, sizeof *j->receivers);
    if (!j->receivers) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < j->view.n; i++) {
        j->view.points[i].min_d2 = j->scene->min_d2;
        j->receivers[i] = bench_receiver_of(&j->view.points[i]);
    }
    return LC_OK;
}

static lc_status init_methods(job *j)
{
    const lc_visibility visibility = { .hidden = nothing_hidden };
    const lc_render_desc *r = &j->o->render;
    const lc_cut_desc desc = { .error_ratio = r->error_ratio, .max_cut = r->max_cut };
    lc_status st = lc_cut_init(&j->cut, j->ctx, j->tree, &visibility, &desc, false);
    for (int m = HEAP; m < N_METHODS && !st; m++)
        st = bench_heap_init(&j->heaps[m], j->ctx, j->tree, &visibility, r->error_ratio, r->max_cut,
                             n_pops[m]);
    return st;
}

/* ---- the lists ---- */

static void add_call(list *l, const uint32_t *index, uint32_t n, uint32_t point)
{
    if (!l->status)
        l->status = lc_grow(l->ctx, (void **)&l->calls, &l->cap_calls, l->n_calls + 1, sizeof *l->calls);
    if (!l->status)
        l->status = lc_grow(l->ctx, (void **)&l->index, &l->cap_index, l->n + n, sizeof *l->index);
    if (l->status) return;
    l->calls[l->n_calls++] = (call){ l->n, n, point };
    memcpy(l->index + l->n, index, n * sizeof *index);
    l->n += n;
}

static void free_list(list *l)
{
    lc_free(l->ctx, l->calls, l->cap_calls, sizeof *l->calls);
    lc_free(l->ctx, l->index, l->cap_index, sizeof *l->index);
}

/* What record_bounds needs beside its arguments, which are a kernel's. */
static struct {
    list *to;
    const lc_shade_kernels *real;
    uint32_t point;
} recorder;

static void record_bounds(const lc_tree_data *tree, const uint32_t *index, uint32_t n, lc_light_kind kind,
                          const lc_point *point, float *ub)
{
    add_call(recorder.to, index, n, recorder.point);
    recorder.real->bounds(tree, index, n, kind, point, ub);
}

static lc_status record_lists(job *j)
{
    list *l = &j->lists[SIBLINGS];
    const lc_shade_kernels *real = j->ctx->shade_kernels;
    lc_shade_kernels table = *real;
    lc_stats stats = { 0 };
    table.bounds = record_bounds;
    recorder.to = l;
    recorder.real = real;
    j->ctx->shade_kernels = &table;
    for (uint32_t i = 0; i < j->view.n; i++) {
        lc_cut_result r;
        recorder.point = i;
        lc_cut_shade(&j->cut, &j->view.points[i], j->view.org[i], i, &stats, &r);
    }
    j->ctx->shade_kernels = real;

    list *c = &j->lists[CONSECUTIVE];
    uint32_t all[BATCH], n_points = 0;
    for (uint32_t first = 0, n; first < j->tree->n_nodes; first += n) {
        n = j->tree->n_nodes - first < BATCH ? j->tree->n_nodes - first : BATCH;
        for (uint32_t i = 0; i < n; i++) all[i] = first + i;
        add_call(c, all, n, n_points++ % j->view.n);
    }
    return l->status ? l->status : c->status;
}

/* Counts the cache lines that each call reads, every line once: mark has the number, from 1, of the last call
 * that read a line. */
static lc_status count_lines(job *j, int pattern)
{
    const list *l = &j->lists[pattern];
    size_t n_marks = j->tree->n_nodes, distinct[N_LAYOUTS] = { 0, 0 };
    size_t *mark[N_LAYOUTS];
    for (int k = 0; k < N_LAYOUTS; k++) mark[k] = lc_alloc(j->ctx, n_marks, sizeof **mark);
    for (size_t c = 0; c < l->n_calls && mark[RECORDS] && mark[ARRAYS]; c++)
        for (uint32_t i = 0; i < l->calls[c].n; i++) {
            uint32_t id = l->index[l->calls[c].first + i], at[N_LAYOUTS] = { id, id / LC_LANES };
            for (int k = 0; k < N_LAYOUTS; k++) {
                distinct[k] += mark[k][at[k]] != c + 1;
                mark[k][at[k]] = c + 1;
            }
        }
    bool failed = !mark[RECORDS] || !mark[ARRAYS];
    for (int k = 0; k < N_LAYOUTS; k++) lc_free(j->ctx, mark[k], n_marks, sizeof **mark);
    if (failed) return LC_ERR_MEMORY;
    double records = (double)distinct[RECORDS] / (double)l->n,
           blocks = (double)distinct[ARRAYS] / (double)l->n;
    j->lines[pattern][RECORDS] =
        (lines){ records * (double)(sizeof(lc_node) / LINE), records * (double)(sizeof(lc_node) / LINE) };
    j->lines[pattern][ARRAYS] = (lines){ blocks * N_BOUND_ROWS, blocks * (N_BOUND_ROWS + N_LINK_ROWS) };
    return LC_OK;
}

/* ---- bounds ---- */

#define MAX_CALL 256u /* clusters in one: a cut asks for 128 at most */

static void run_call(const job *j, int pattern, int layout, bench_array_bounds_fn *by_arrays, const call *c,
                     float *ub)
{
    const uint32_t *index = j->lists[pattern].index + c->first;
    if (layout == RECORDS)
        j->ctx->shade_kernels->bounds(&j->tree->data, index, c->n, LC_LIGHT_POINT, &j->view.points[c->point],
                                      ub);
    else if (pattern == CONSECUTIVE)
        by_arrays(j->arrays.word + (size_t)*index * N_ROWS, NULL, c->n, &j->receivers[c->point], ub);
    else
        by_arrays(j->arrays.word, index, c->n, &j->receivers[c->point], ub);
}

static double run_bounds(const job *j, int pattern, int layout)
{
    _Alignas(64) float ub[MAX_CALL];
    bench_array_bounds_fn *by_arrays = bench_array_bounds(j->ctx->isa);
    const list *l = &j->lists[pattern];
    size_t n = 0;
    double t0 = lc_thread_cpu();
    for (; n < MIN_BOUNDS; n += l->n)
        for (size_t c = 0; c < l->n_calls; c++) run_call(j, pattern, layout, by_arrays, &l->calls[c], ub);
    return (lc_thread_cpu() - t0) / (double)n;
}

/* Floats >= 0 lie in the order of their bits. */
static uint32_t ulp_between(float a, float b)
{
    uint32_t x, y;
    memcpy(&x, &a, sizeof x);
    memcpy(&y, &b, sizeof y);
    return x > y ? x - y : y - x;
}

static lc_status compare_bounds(job *j, int pattern)
{
    _Alignas(64) float ub[N_LAYOUTS][MAX_CALL];
    const list *l = &j->lists[pattern];
    for (size_t c = 0; c < l->n_calls; c++) {
        const call *one = &l->calls[c];
        if (one->n > MAX_CALL) return lc_fail(j->ctx, LC_ERR_ARG, "a call for %u bounds", one->n);
        for (int k = 0; k < N_LAYOUTS; k++)
            run_call(j, pattern, k, bench_array_bounds(j->ctx->isa), one, ub[k]);
        for (uint32_t i = 0; i < one->n; i++) {
            uint32_t ulp = ulp_between(ub[RECORDS][i], ub[ARRAYS][i]);
            if (ulp > j->max_ulp) j->max_ulp = ulp;
            if (ulp > MAX_ULP)
                return lc_fail(j->ctx, LC_ERR_ARG, "cluster %u has the bound %.9g by records, %.9g by arrays",
                               l->index[one->first + i], (double)ub[RECORDS][i], (double)ub[ARRAYS][i]);
        }
    }
    return LC_OK;
}

static lc_status measure_bounds(job *j)
{
    static double times[N_PATTERNS][N_LAYOUTS][BENCH_MAX_RUNS];
    for (int p = 0; p < N_PATTERNS; p++) {
        lc_status st = compare_bounds(j, p);
        if (!st) st = count_lines(j, p);
        if (st) return st;
    }
    for (uint32_t run = 0; run < j->n_runs; run++)
        for (int p = 0; p < N_PATTERNS; p++)
            for (int k = 0; k < N_LAYOUTS; k++) times[p][k][run] = run_bounds(j, p, k);
    for (int p = 0; p < N_PATTERNS; p++)
        for (int k = 0; k < N_LAYOUTS; k++) j->bounds[p][k] = bench_summarize(times[p][k], j->n_runs);
    return LC_OK;
}

/* ---- refinement ---- */

/* All points once. Returns seconds a cut. */
static double run_method(job *j, int m)
{
    const double n = j->view.n;
    bench_heap *h = &j->heaps[m];
    method *out = &j->methods[m];
    lc_stats stats = { 0 };
    double size = 0, luminance = 0;
    h->n_bounds = 0;
    double t0 = lc_thread_cpu();
    for (uint32_t i = 0; i < j->view.n; i++) {
        if (m == ROUNDS) {
            lc_cut_result r;
            lc_cut_shade(&j->cut, &j->view.points[i], j->view.org[i], i, &stats, &r);
            luminance += (double)lc_luminance(r.radiance);
            size += r.size;
        } else {
            size += bench_heap_shade(h, &j->view.points[i], j->view.org[i], i);
            luminance += bench_heap_luminance(h);
        }
    }
    double seconds = (lc_thread_cpu() - t0) / n;
    out->size = size / n;
    out->luminance = luminance / n;
    out->bounds = (double)(m == ROUNDS ? stats.bounds : h->n_bounds) / n;
    return seconds;
}

/* All methods bound the error of a cluster by the same ratio; a greater difference of the means is a bug. */
static lc_status compare_methods(const job *j)
{
    double want = j->methods[ROUNDS].luminance, ratio = (double)j->o->render.error_ratio;
    for (int m = HEAP; m < N_METHODS; m++)
        if (!(fabs(j->methods[m].luminance - want) <= ratio * want))
            return lc_fail(j->ctx, LC_ERR_ARG, "the mean luminance is %.6g by %s, %.6g by %s",
                           j->methods[m].luminance, method_names[m], want, method_names[ROUNDS]);
    return LC_OK;
}

static lc_status measure_methods(job *j)
{
    static double times[N_METHODS][BENCH_MAX_RUNS];
    for (uint32_t run = 0; run < j->n_runs; run++)
        for (int m = 0; m < N_METHODS; m++) times[m][run] = run_method(j, m);
    for (int m = 0; m < N_METHODS; m++) j->methods[m].seconds = bench_summarize(times[m], j->n_runs);
    return compare_methods(j);
}

/* ---- output ---- */

static void print_text(const job *j)
{
    printf("light tree of %u point lights (%s), %u points; %s, one thread; ns of its CPU time: least of %u "
           "runs (median)\n\n",
           j->tree->n_lights, SCENE, j->view.n, lc_isa_name(j->ctx->isa), j->n_runs);
    printf(
        "bounds       layout    ns a bound            cache lines a cluster: for its bound, and its split\n");
    for (int p = 0; p < N_PATTERNS; p++)
        for (int k = 0; k < N_LAYOUTS; k++) {
            const bench_summary *s = &j->bounds[p][k];
            printf("%-12s %-8s %6.2f (%.2f) %22.2f %6.2f\n", pattern_names[p], layout_names[k], s->best * 1e9,
                   s->median * 1e9, j->lines[p][k].bound, j->lines[p][k].split);
        }
    printf("The bounds of both layouts are at most %u ulp apart.\n\n", j->max_ulp);
    printf("refinement   ns a cut           clusters   bounds   mean luminance\n");
    for (int m = 0; m < N_METHODS; m++) {
        const method *r = &j->methods[m];
        printf("%-10s %8.0f (%.0f) %14.1f %8.1f %12.5g\n", method_names[m], r->seconds.best * 1e9,
               r->seconds.median * 1e9, r->size, r->bounds, r->luminance);
    }
}

static void print_times(const bench_summary *s)
{
    printf("\"clock\": \"cpu\", \"ns\": %.4f, \"ns_spread\": %.4f, \"ns_best\": %.4f", s->median * 1e9,
           s->spread * 1e9, s->best * 1e9);
}

static void print_json(const job *j)
{
    const char *isa = lc_isa_name(j->ctx->isa);
    bench_json_begin("layout", 1);
    for (int p = 0; p < N_PATTERNS; p++)
        for (int k = 0; k < N_LAYOUTS; k++) {
            bench_json_next(!p && !k);
            printf("{\"part\": \"bounds\", \"pattern\": \"%s\", \"layout\": \"%s\", \"isa\": \"%s\", "
                   "\"lights\": %u, ",
                   pattern_names[p], layout_names[k], isa, j->tree->n_lights);
            print_times(&j->bounds[p][k]);
            printf(", \"lines_per_bound\": %.4f, \"lines_per_split\": %.4f, \"max_ulp\": %u}",
                   j->lines[p][k].bound, j->lines[p][k].split, j->max_ulp);
        }
    for (int m = 0; m < N_METHODS; m++) {
        const method *r = &j->methods[m];
        bench_json_next(false);
        printf("{\"part\": \"refinement\", \"method\": \"%s\", \"isa\": \"%s\", \"lights\": %u, "
               "\"points\": %u, \"error_ratio\": %.6g, \"max_cut\": %u, ",
               method_names[m], isa, j->tree->n_lights, j->view.n, (double)j->o->render.error_ratio,
               j->o->render.max_cut);
        print_times(&r->seconds);
        printf(", \"cut_mean\": %.6g, \"bounds_per_cut\": %.6g, \"mean_luminance\": %.6g}", r->size,
               r->bounds, r->luminance);
    }
    bench_json_end();
}

static lc_status run(job *j)
{
    const gen_scene *scene = gen_scenes;
    while (strcmp(scene->name, SCENE)) scene++;
    uint32_t n_lights = j->o->n_lights ? j->o->n_lights : N_LIGHTS;
    lc_status st = bench_load(j->ctx, scene, n_lights, 0, NULL, &j->o->load, &j->scene);
    if (!st) st = build_tree(j);
    if (!st) st = init_points(j);
    if (!st) st = bench_arrays_init(j->ctx, &j->tree->data, j->tree->n_nodes, &j->arrays);
    if (!st) st = init_methods(j);
    if (!st) st = record_lists(j);
    if (!st) st = measure_bounds(j);
    if (!st) st = measure_methods(j);
    return st;
}

static void free_job(job *j)
{
    for (int p = 0; p < N_PATTERNS; p++) free_list(&j->lists[p]);
    for (int m = HEAP; m < N_METHODS; m++)
        if (j->heaps[m].ctx) bench_heap_free(&j->heaps[m]);
    if (j->cut.ctx) lc_cut_free(&j->cut);
    bench_arrays_free(j->ctx, &j->arrays);
    lc_free(j->ctx, j->receivers, j->view.n, sizeof *j->receivers);
    lc_view_grid_free(&j->view);
    lc_light_tree_destroy(j->tree);
    lc_scene_destroy(j->scene);
}

int bench_layout(const bench_options *o)
{
    job j = { .o = o, .ctx = cli_context(1, o->isa, 0), .n_runs = o->n_runs ? o->n_runs : RUNS };
    if (!j.ctx) return CLI_FAILED;
    for (int p = 0; p < N_PATTERNS; p++) j.lists[p].ctx = j.ctx;
    lc_status st = run(&j);
    if (!st && o->json) print_json(&j);
    else if (!st) print_text(&j);
    free_job(&j);
    lc_context_destroy(j.ctx);
    return cli_exit_status(st);
}
