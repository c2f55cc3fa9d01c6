/* bench_scaling.c - render time against the number of lights: the scene `cube` with 10^3, 10^4 ... lights of
 * the same total flux, so that the pictures are equally bright; printed, and plotted on demand. Render times
 * are CPU times of all threads. */
#include "lab/bench.h"

#include "base/stats.h"
#include "cli/cli.h"
#include "lab/svg.h"

#include <string.h>
#include <sys/resource.h>

#define RUNS 3               /* by default */
#define MAX_LIGHTS 10000000u /* by default */
#define MAX_SIZES 16

typedef struct sizes {
    double n[MAX_SIZES]; /* lights */
    double seconds[MAX_SIZES]; /* CPU time of a render, the least of the runs */
    double wall[MAX_SIZES];    /* of the same by the wall clock, the median */
    double cut[MAX_SIZES];
    uint32_t count;
} sizes;

/* Peak memory of the process, MB. */
static double peak_mb(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) ? 0 : (double)usage.ru_maxrss / 1024;
}

static lc_status render(const bench_options *o, lc_context *ctx, const lc_scene *scene,
                        lc_render_stats *stats, double *seconds, double *wall)
{
    double times[BENCH_MAX_RUNS], cpu[BENCH_MAX_RUNS];
    static const int32_t middle[4] = { 192, 448, 112, 368 }; /* 256 x 256 of 640 x 480 */
    lc_render_desc d = o->render;
    uint32_t n_runs = o->n_runs ? o->n_runs : RUNS;
    memcpy(d.crop, middle, sizeof d.crop);
    for (uint32_t r = 0; r < n_runs; r++) {
        lc_image *image;
        double t0 = lc_process_cpu();
        lc_status st = lc_render(ctx, scene, &d, &image, stats);
        if (st) return st;
        cpu[r] = lc_process_cpu() - t0;
        times[r] = stats->seconds;
        lc_image_destroy(image);
    }
    *seconds = bench_summarize(cpu, n_runs).best;
    *wall = bench_summarize(times, n_runs).median;
    return LC_OK;
}

static void print_row(const bench_options *o, const sizes *z, const lc_scene_info *info,
                      const lc_render_stats *stats)
{
    uint32_t k = z->count - 1;
    double ratio = k && z->seconds[k - 1] > 0 ? z->seconds[k] / z->seconds[k - 1] : 0;
    if (o->json) {
        bench_json_next(!k);
        printf("{\"scene\": \"cube\", \"lights\": %.0f, \"clock\": \"wall\", \"parse_seconds\": %.6g, "
               "\"tree_seconds\": %.6g, \"render_seconds\": %.6g, \"render_cpu_seconds_best\": %.6g, "
               "\"cut_mean\": %.6g, \"mean_luminance\": %.6g, \"bytes_per_light\": %.6g, \"peak_mb\": %.6g}",
               z->n[k], info->seconds_parse, info->seconds_tree, z->wall[k], z->seconds[k], z->cut[k],
               stats->mean_luminance, (double)info->tree_bytes / (double)info->n_lights, peak_mb());
        return;
    }
    printf("%9.0f %9.3f %9.3f %10.3f ", z->n[k], info->seconds_parse, info->seconds_tree, z->seconds[k]);
    if (k) printf("%7.2f", ratio);
    else printf("%7s", "");
    printf(" %8.1f %10.4g %9.0f\n", z->cut[k], stats->mean_luminance, peak_mb());
    fflush(stdout);
}

static lc_status one_size(const bench_options *o, lc_context *ctx, uint32_t n, sizes *z)
{
    const gen_scene *cube = gen_scenes;
    lc_scene *scene;
    lc_scene_info info = LC_SCENE_INFO_INIT;
    lc_render_stats stats = LC_RENDER_STATS_INIT;
    while (strcmp(cube->name, "cube")) cube++;
    lc_status st = bench_load(ctx, cube, n, 0, NULL, &o->load, &scene);
    if (st) return st;
    lc_scene_get_info(scene, &info);
    st = render(o, ctx, scene, &stats, &z->seconds[z->count], &z->wall[z->count]);
    z->n[z->count] = n;
    z->cut[z->count] = stats.cut_mean;
    if (!st) {
        z->count++;
        print_row(o, z, &info, &stats);
    }
    lc_scene_destroy(scene);
    return st;
}

static void write_plots(FILE *f, void *user)
{
    const sizes *z = user;
    const svg_plot plots[2] = {
        { .title = "Render time against number of lights",
          .x_label = "lights, total flux the same",
          .y_label = "CPU seconds",
          .log_x = 1,
          .log_y = 1,
          .values = 1,
          .series = { { "seconds", z->n, z->seconds, z->count } },
          .n_series = 1 },
        { .title = "Lights evaluated at a point",
          .x_label = "lights",
          .y_label = "mean cut",
          .log_x = 1,
          .values = 1,
          .series = { { "mean cut", z->n, z->cut, z->count } },
          .n_series = 1 },
    };
    svg_write(f, plots, 2, 640, 340);
}

int bench_scaling(const bench_options *o)
{
    lc_context *ctx = cli_context(o->n_threads, o->isa, 0);
    sizes z = { .count = 0 };
    lc_status st = LC_OK;
    if (!ctx) return CLI_FAILED;
    uint32_t threads = lc_context_threads(ctx), most = o->n_lights ? o->n_lights : MAX_LIGHTS;
    if (o->json) bench_json_begin("tree", threads);
    else
        printf(
            "cube, error ratio %g; render: CPU time of all threads, the least of %u renders; x: over that of "
            "the line above;\nparse, tree: by the wall clock; %u thread%s\n\n"
            "   lights   parse s    tree s   render s       x      cut  luminance   peak MB\n",
            (double)o->render.error_ratio, o->n_runs ? o->n_runs : RUNS, threads, threads == 1 ? "" : "s");
    for (uint64_t n = most < 1000 ? most : 1000; n <= most && !st; n *= 10)
        st = one_size(o, ctx, (uint32_t)n, &z);
    if (o->json) bench_json_end();
    lc_context_destroy(ctx);
    if (!st && o->outfile && cli_write_file(o->outfile, write_plots, &z)) return CLI_FAILED;
    return cli_exit_status(st);
}
