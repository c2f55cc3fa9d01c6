/* bench_quality.c - what trees of each builder are worth: error and cost of their cuts against the exact
 * method, on generated scenes.
 *
 *     scene, lights: exact method -> reference
 *         builder, seed of the representatives: load -> render at each error ratio -> error, shadow rays
 *
 * Cost at equal error: the builder's shadow rays a point, interpolated in logarithms at the errors that the
 * first builder has at each ratio, over the first builder's rays; the geometric mean over the ratios. It is
 * given for rmse, which a few bright pixels dominate, and for mrse, which they do not.
 *
 * Clusters have REPS representatives, so that the errors of neighbouring pixels are independent: the expected
 * error is that of one representative, but fewer seeds are needed to measure it. Pictures show the whole view
 * with so few pixels that the exact method can evaluate every light.
 */
#include "lab/bench.h"

#include "cli/cli.h"
#include "cli/metrics.h"

#include <math.h>

#define SEEDS 5 /* by default */
#define REPS 16 /* representatives of a cluster */
#define MAX_VISITS 1000000000u /* limit of pixels times lights of a reference: some 20 s */
#define MIN_PIXELS 300u /* limits of a picture */
#define MAX_PIXELS 25000u
#define N_RATIOS 4
static const float ratios[N_RATIOS] = { 0.01f, 0.02f, 0.05f, 0.1f };
enum { AT_2 = 1, AT_10 = 3 };

/* At one error ratio: rmse and mrse are root mean squares over the seeds, the others means. */
typedef struct point {
    double rmse;    /* over the mean of the reference */
    double mrse;    /* root of compare's mrse */
    double rel_p50; /* median of the pixels' relative errors */
    double cut;     /* lights evaluated a shading point */
    double rays;    /* shadow rays a shading point */
} point;

typedef struct outcome {
    const bench_builder *builder;
    double build_seconds; /* by the wall clock, the least over seeds */
    double bytes;         /* a light */
    point at[N_RATIOS];
    /* Shadow rays at equal error, over those of the first builder. NaN: the curves do not give it. */
    double cost_rmse, cost_mrse;
} outcome;

typedef struct job {
    const bench_options *o;
    lc_context *ctx;
    const gen_scene *scene;
    uint32_t n_lights;
    lc_image *reference;
    double mean; /* of the reference */
    bool first;  /* no result has been printed */
} job;

static void planes_of(const lc_image *image, float *planes[3])
{
    static const char *const names[3] = { "R", "G", "B" };
    for (int k = 0; k < 3; k++) planes[k] = lc_image_channel(image, names[k]);
}

static lc_status load(const job *j, const bench_builder *builder, uint64_t seed, uint32_t n_reps,
                      lc_scene **scene)
{
    uint64_t pixels = MAX_VISITS / j->n_lights;
    pixels = pixels < MIN_PIXELS ? MIN_PIXELS : pixels > MAX_PIXELS ? MAX_PIXELS : pixels;
    lc_load_desc d = j->o->load;
    d.seed = seed;
    d.n_reps = n_reps;
    return bench_load(j->ctx, j->scene, j->n_lights, pixels, builder, &d, scene);
}

static lc_status make_reference(job *j)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image_desc size = LC_IMAGE_DESC_INIT;
    lc_scene *scene;
    float *planes[3];
    d.method = LC_METHOD_EXACT;
    lc_status st = load(j, &bench_builders[0], 0, 1, &scene);
    if (!st) st = lc_render(j->ctx, scene, &d, &j->reference, NULL);
    lc_scene_destroy(scene);
    if (st) return st;
    lc_image_get_desc(j->reference, &size);
    planes_of(j->reference, planes);
    size_t n = (size_t)size.width * size.height;
    double sum = 0;
    for (size_t i = 0; i < n; i++) sum += (double)planes[0][i] + (double)planes[1][i] + (double)planes[2][i];
    j->mean = sum / (3 * (double)n);
    return LC_OK;
}

/* Renders at one error ratio and adds the outcome to *p. */
static lc_status add_render(const job *j, const lc_scene *scene, float ratio, point *p)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_render_stats stats = LC_RENDER_STATS_INIT;
    lc_image *image;
    lc_image_desc size = LC_IMAGE_DESC_INIT;
    metrics m;
    float *a[3], *b[3];
    d.method = LC_METHOD_CUTS;
    d.error_ratio = ratio;
    d.max_cut = 0; /* no limit: the error ratio alone decides */
    lc_status st = lc_render(j->ctx, scene, &d, &image, &stats);
    if (st) return st;
    lc_image_get_desc(image, &size);
    planes_of(image, a);
    planes_of(j->reference, b);
    st = metrics_of(j->ctx, size.width, size.height, a, b, 0.1, &m);
    lc_image_destroy(image);
    if (st) return st;
    p->rmse += m.value[METRIC_RMSE] * m.value[METRIC_RMSE];
    p->mrse += m.value[METRIC_MRSE];
    p->rel_p50 += m.value[METRIC_REL_P50];
    p->cut += stats.cut_mean;
    p->rays += stats.points ? (double)stats.shadow_rays / (double)stats.points : 0;
    return LC_OK;
}

static lc_status measure(const job *j, outcome *r)
{
    double builds[BENCH_MAX_RUNS];
    uint32_t n_seeds = j->o->n_runs ? j->o->n_runs : SEEDS;
    lc_status st = LC_OK;
    for (uint32_t s = 0; s < n_seeds && !st; s++) {
        lc_scene *scene;
        lc_scene_info info = LC_SCENE_INFO_INIT;
        if ((st = load(j, r->builder, s, 1, &scene))) return st;
        lc_scene_get_info(scene, &info);
        builds[s] = info.seconds_tree;
        r->bytes = (double)info.tree_bytes / (double)info.n_lights;
        lc_scene_destroy(scene);
        if ((st = load(j, r->builder, s, REPS, &scene))) return st;
        for (int k = 0; k < N_RATIOS && !st; k++) st = add_render(j, scene, ratios[k], &r->at[k]);
        lc_scene_destroy(scene);
    }
    if (st) return st;
    r->build_seconds = bench_summarize(builds, n_seeds).best;
    for (int k = 0; k < N_RATIOS; k++) {
        point *p = &r->at[k];
        p->rmse = j->mean > 0 ? sqrt(p->rmse / n_seeds) / j->mean : 0;
        p->mrse = sqrt(p->mrse / n_seeds);
        p->rel_p50 /= n_seeds;
        p->cut /= n_seeds;
        p->rays /= n_seeds;
    }
    return LC_OK;
}

/* Shadow rays a point at an error: on the segment of the curve that holds the error, or on the continuation
 * of the nearest one. But for noise, errors rise with the ratio. */
static double cost_at(const double error[N_RATIOS], const point *at, double target)
{
    int k = 0;
    while (k + 2 < N_RATIOS && error[k + 1] < target) k++;
    if (!(error[k] > 0 && error[k + 1] > error[k] && target > 0 && at[k].rays > 0 && at[k + 1].rays > 0))
        return NAN;
    double t = log(target / error[k]) / log(error[k + 1] / error[k]);
    return at[k].rays * exp(t * log(at[k + 1].rays / at[k].rays));
}

static double cost(const double error[N_RATIOS], const outcome *r, const double first_error[N_RATIOS],
                   const outcome *first)
{
    double sum = 0;
    for (int k = 0; k < N_RATIOS; k++) sum += log(cost_at(error, r->at, first_error[k]) / first->at[k].rays);
    return exp(sum / N_RATIOS);
}

static void set_costs(outcome *r, const outcome *first)
{
    double rmse[2][N_RATIOS], mrse[2][N_RATIOS];
    for (int k = 0; k < N_RATIOS; k++) {
        rmse[0][k] = r->at[k].rmse;
        rmse[1][k] = first->at[k].rmse;
        mrse[0][k] = r->at[k].mrse;
        mrse[1][k] = first->at[k].mrse;
    }
    r->cost_rmse = cost(rmse[0], r, rmse[1], first);
    r->cost_mrse = cost(mrse[0], r, mrse[1], first);
}

static void print_head(const job *j)
{
    if (j->o->json) {
        bench_json_begin("tree", lc_context_threads(j->ctx));
        return;
    }
    printf("light trees: %u seeds; cuts without limit against every light; rmse over the mean, median "
           "relative error;\n"
           "rays: shadow rays a point at 2 %%; x: at equal rmse and at equal mrse, over those of '%s'; %u "
           "thread%s\n\n",
           j->o->n_runs ? j->o->n_runs : SEEDS, bench_builders[0].name, lc_context_threads(j->ctx),
           lc_context_threads(j->ctx) == 1 ? "" : "s");
    printf("                                            |---------- 2 %% ----------|  |---------- 10 %% "
           "---------|\n"
           "scene     lights builder   build s   B/light    cut    rmse  median rel     cut    rmse  median "
           "rel     rays x rmse x mrse\n");
}

static void print_ratio(double ratio)
{
    if (isfinite(ratio)) printf(" %6.3f", ratio);
    else printf("      -");
}

static void print_row(const job *j, const outcome *r)
{
    const point *a = &r->at[AT_2], *b = &r->at[AT_10];
    printf("%-8s %7u %-8s %9.4f %9.0f %6.1f %7.4f %11.5f %7.1f %7.4f %11.5f %8.1f", j->scene->name,
           j->n_lights, r->builder->name, r->build_seconds, r->bytes, a->cut, a->rmse, a->rel_p50, b->cut,
           b->rmse, b->rel_p50, a->rays);
    print_ratio(r->cost_rmse);
    print_ratio(r->cost_mrse);
    printf("\n");
    fflush(stdout);
}

static void json_number(const char *name, double v)
{
    if (isfinite(v)) printf(", \"%s\": %.6g", name, v);
    else printf(", \"%s\": null", name);
}

static void print_json(job *j, const outcome *r)
{
    bench_json_next(j->first);
    printf("{\"scene\": \"%s\", \"lights\": %u, \"builder\": \"%s\"", j->scene->name, j->n_lights,
           r->builder->name);
    json_number("build_seconds", r->build_seconds);
    json_number("bytes_per_light", r->bytes);
    json_number("cost_at_equal_rmse", r->cost_rmse);
    json_number("cost_at_equal_mrse", r->cost_mrse);
    printf(", \"ratios\": [");
    for (int k = 0; k < N_RATIOS; k++) {
        const point *p = &r->at[k];
        printf("%s{\"error_ratio\": %g", k ? ", " : "", (double)ratios[k]);
        json_number("rmse", p->rmse);
        json_number("root_mrse", p->mrse);
        json_number("rel_p50", p->rel_p50);
        json_number("cut_mean", p->cut);
        json_number("shadow_rays_per_point", p->rays);
        printf("}");
    }
    printf("]}");
    j->first = false;
}

static lc_status one_size(job *j)
{
    outcome r[BENCH_N_BUILDERS] = { 0 };
    lc_status st = make_reference(j);
    for (int i = 0; i < BENCH_N_BUILDERS && !st; i++) {
        r[i].builder = &bench_builders[i];
        if ((st = measure(j, &r[i]))) break;
        set_costs(&r[i], &r[0]);
        if (j->o->json) print_json(j, &r[i]);
        else print_row(j, &r[i]);
    }
    lc_image_destroy(j->reference);
    j->reference = NULL;
    return st;
}

int bench_quality(const bench_options *o)
{
    job j = { .o = o, .ctx = cli_context(o->n_threads, o->isa, 0), .first = true };
    lc_status st = LC_OK;
    if (!j.ctx) return CLI_FAILED;
    print_head(&j);
    uint32_t n_scenes = o->n_scenes ? o->n_scenes : GEN_N_MANY, from = o->n_lights ? o->n_lights : 10000;
    uint32_t to = o->n_lights ? o->n_lights : 100000;
    for (uint32_t i = 0; i < n_scenes; i++)
        for (uint64_t n = from; n <= to && !st; n *= 10) {
            j.scene = o->n_scenes ? o->scenes[i] : &gen_scenes[i];
            j.n_lights = (uint32_t)n;
            st = one_size(&j);
        }
    if (o->json) bench_json_end();
    lc_context_destroy(j.ctx);
    return cli_exit_status(st);
}
