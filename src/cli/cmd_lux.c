/* cmd_lux.c - lightcuts lux: illuminance at sensors, or the luminance that the camera sees. */
#include "cli/lux.h"
#include "cli/place.h"
#include "cli/progress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_OUTPUTS 16
#define MAX_COORD   1e12
#define ROW         1024   /* points a row, where they have no order */
#define BLOCK       4      /* cells of a grid whose sensors are computed together */
#define LUX_ERROR   0.005f /* --error, where it is not given: luminaires are known to a few per cent */
#define LAMPS_WITHIN 95    /* of lc_scene_info.lamps_high, per cent */
#define ROUNDING    1e-5   /* relative, of sums of floats: what is stated where nothing else is off */

typedef struct options {
    const char *scene, *points, *grid_text, *outputs[MAX_OUTPUTS];
    int n_outputs;
    double grid[9]; /* corner, edges */
    uint32_t nx, ny, n_threads;
    double efficacy;
    bool camera, json, quiet, cylindrical, scalar, to_stdout;
    lc_isa isa;
    lc_load_desc load;
    lc_render_desc render;
    lc_quantity quantity;
    cli_error_options given;
} options;

enum {
    OPT_GRID = CLI_LONG_ONLY,
    OPT_POINTS,
    OPT_CAMERA,
    OPT_CYLINDRICAL,
    OPT_SCALAR,
    OPT_EFFICACY,
    OPT_METHOD,
    OPT_AREA,
    OPT_ENV,
    OPT_INDIRECT,
    OPT_INDIRECT_ERROR,
    OPT_MAXDEPTH,
    OPT_SEED,
    OPT_ISA,
    OPT_MEMORY,
    OPT_JSON
};

static const struct option long_options[] = {
    { "outfile", 1, 0, 'o' },
    { "grid", 1, 0, OPT_GRID },
    { "points", 1, 0, OPT_POINTS },
    { "camera", 0, 0, OPT_CAMERA },
    { "cylindrical", 0, 0, OPT_CYLINDRICAL },
    { "scalar", 0, 0, OPT_SCALAR },
    { "efficacy", 1, 0, OPT_EFFICACY },
    { "error", 1, 0, CLI_OPT_ERROR },
    { "within", 1, 0, CLI_OPT_WITHIN },
    { "dark-floor", 1, 0, CLI_OPT_FLOOR },
    { "method", 1, 0, OPT_METHOD },
    { "area-lights", 1, 0, OPT_AREA },
    { "env-lights", 1, 0, OPT_ENV },
    { "indirect-lights", 1, 0, OPT_INDIRECT },
    { "indirect-error", 1, 0, OPT_INDIRECT_ERROR },
    { "maxdepth", 1, 0, OPT_MAXDEPTH },
    { "seed", 1, 0, OPT_SEED },
    { "nthreads", 1, 0, 't' },
    { "isa", 1, 0, OPT_ISA },
    { "max-memory", 1, 0, OPT_MEMORY },
    { "json", 0, 0, OPT_JSON },
    { "quiet", 0, 0, 'q' },
    { "help", 0, 0, 'h' },
    { 0, 0, 0, 0 },
};

static void print_help(void)
{
    printf(
        "usage: lightcuts lux [options] SCENE --grid O:U:V:NX,NY | --points P.csv | --camera\n"
        "\n"
        "Illuminance at sensors, in lux where lights are in cd, lm and cd/m^2, with its stated error.\n"
        "\n"
        "      --grid O:U:V:NX,NY   corner x,y,z, two edges as vectors x,y,z, numbers of sensors along "
        "them,\n"
        "                           which are at the centres of the cells; normal U x V\n"
        "      --points P.csv       sensors by columns x,y,z,nx,ny,nz; further columns are kept; -: from\n"
        "                           standard input\n"
        "      --camera             in place of sensors the luminance of the scene's picture, cd/m^2\n"
        "      --cylindrical        of the side of a small cylinder along the normal\n"
        "      --scalar             of a small sphere, over its cross-section: from all directions\n"
        "                           alike; its surface's mean is a quarter of that\n"
        "  -o, --outfile FILE       .csv: a line for each sensor, in their order: lux, error and within;\n"
        "                           .png: false colours, isolines and a legend; repeatable; default: the\n"
        "                           table to standard output, as by -\n"
        "      --json               least, mean and greatest value, uniformity and error as JSON to\n"
        "                           standard output, in place of the table\n"
        "      --efficacy K         multiply all values by K, lm/W, for scenes in W, default 1: 'power' is\n"
        "                           in lumens\n"
        "      --error E            relative error of the illuminance, default %g\n"
        "      --within P           per cent of the sensors to be within it, 1 to 99.9, default 95\n"
        "      --dark-floor F       errors are relative to at least F times the mean, default %g\n"
        "      --method M           lightcuts (default), exact: every light at every sensor, or cuts\n"
        "      --indirect-lights N  virtual lights of bounced light, default 0: direct light only; auto: as\n"
        "                           many as the next takes\n"
        "      --indirect-error E   of bounced light at half of the sensors, default 0.01\n"
        "      --maxdepth N         bounces, default the scene's\n"
        "      --area-lights N      lights made from emissive surfaces, default: as many as the sensors "
        "need\n"
        "      --env-lights N       lights made from environment maps, default 5000\n"
        "      --seed N             default 0\n"
        "      --max-memory BYTES   end when it needs more (500M, 2G), default: what the machine leaves\n"
        "  -t, --nthreads N         default: all processors this process may use\n"
        "      --isa I              use at most %s\n"
        "  -q, --quiet              errors only\n"
        "  -h, --help               this text\n"
        "\n"
        "Columns: error is the stated half-width over lux (1 where lux is 0), within the per cent of the\n"
        "sensors whose converged value is to be in that interval. Exit status: 0 done, 1 failed, 2 wrong "
        "command line,\n"
        "3 wrong scene or table.\n",
        (double)LUX_ERROR, (double)LC_ASKED_DARK_FLOOR, cli_isa_names());
}

/* ---- command line ---- */

/* "x,y,z:x,y,z:x,y,z:nx,ny" */
static int parse_grid(options *o, const char *text)
{
    char part[256];
    double n[2];
    o->grid_text = text;
    for (int i = 0; i < 4; i++) {
        const size_t len = strcspn(text, ":");
        if (len >= sizeof part || (text[len] == ':') != (i < 3)) return -1;
        memcpy(part, text, len);
        part[len] = 0;
        if (i < 3 && cli_parse_list(part, 3, -MAX_COORD, MAX_COORD, &o->grid[3 * i])) return -1;
        if (i == 3 && cli_parse_list(part, 2, 1, CLI_MAX_SIDE, n)) return -1;
        text += len + 1;
    }
    o->nx = (uint32_t)n[0];
    o->ny = (uint32_t)n[1];
    return n[0] > o->nx || n[1] > o->ny || (uint64_t)o->nx * o->ny > 1u << 24;
}

static int parse_indirect(options *o, const char *text)
{
    if (strcmp(text, "auto")) return cli_parse_indirect(text, &o->load.indirect_lights);
    o->load.indirect_lights = 0;
    return 0;
}

/* Nonzero: the value of option c is out of range. */
static int set_option(void *user, int c)
{
    options *o = user;
    switch (c) {
    case 'o':
        o->outputs[o->n_outputs % MAX_OUTPUTS] = cli_output_name(optarg);
        return ++o->n_outputs > MAX_OUTPUTS || !*optarg;
    case OPT_GRID: return parse_grid(o, optarg);
    case OPT_POINTS: o->points = optarg; return !*optarg;
    case OPT_CAMERA: o->camera = true; return 0;
    case OPT_CYLINDRICAL: o->cylindrical = true; return 0;
    case OPT_SCALAR: o->scalar = true; return 0;
    case OPT_EFFICACY: return cli_parse_float(optarg, 1e-6, 1e6, &o->efficacy);
    case OPT_METHOD: return cli_parse_method(optarg, &o->render.method);
    case OPT_AREA: return cli_parse_u32(optarg, 1, CLI_MAX_LIGHTS, &o->load.area_lights);
    case OPT_ENV: return cli_parse_u32(optarg, 1, CLI_MAX_LIGHTS, &o->load.env_lights);
    case OPT_INDIRECT: return parse_indirect(o, optarg);
    case OPT_INDIRECT_ERROR: return cli_parse_float(optarg, CLI_MIN_INDIRECT, 1, &o->load.indirect_error);
    case OPT_MAXDEPTH: return cli_parse_u32(optarg, 1, CLI_MAX_DEPTH, &o->load.max_depth);
    case OPT_SEED: return cli_parse_u64(optarg, 0, UINT64_MAX, &o->load.seed);
    case OPT_ISA: return cli_parse_isa(optarg, &o->isa);
    case OPT_MEMORY: return cli_parse_memory(optarg);
    case OPT_JSON: o->json = true; return 0;
    case 't': return cli_parse_u32(optarg, 1, CLI_MAX_THREADS, &o->n_threads);
    case 'q': o->quiet = true; return 0;
    default: return cli_set_error_option(c, optarg, &o->given, &o->render);
    }
}

/* What does not go together; nonzero after a message. */
static int check_options(options *o)
{
    const int sources = (o->grid_text != NULL) + (o->points != NULL) + o->camera;
    const char *wrong = NULL;
    if (sources != 1) wrong = "want one of --grid, --points and --camera";
    else if (o->camera + o->cylindrical + o->scalar > 1)
        wrong = "want one of --camera, --cylindrical and --scalar at most";
    else if (o->points && !strcmp(o->points, "-") && !strcmp(o->scene, "-"))
        wrong = "scene and points cannot both come from standard input";
    if (wrong) {
        cli_usage_error("lux", "%s", wrong);
        return -1;
    }
    if (o->cylindrical) o->quantity = LC_ILLUMINANCE_CYLINDRICAL;
    if (o->scalar) o->quantity = LC_ILLUMINANCE_SCALAR;
    for (int i = 0; i < o->n_outputs; i++) {
        if (cli_is_stdout(o->outputs[i])) {
            if (!o->json && !o->to_stdout) {
                o->to_stdout = true;
                continue;
            }
            cli_usage_error("lux", "only one thing can go to standard output");
            return -1;
        }
        if (!cli_has_extension(o->outputs[i], ".csv") && !cli_has_extension(o->outputs[i], ".png")) {
            cli_usage_error("lux", "output '%s' is neither .csv nor .png", o->outputs[i]);
            return -1;
        }
        for (int k = 0; k < i; k++)
            if (cli_one_file(o->outputs[k], o->outputs[i])) {
                cli_usage_error("lux", "'%s' and '%s' are one file", o->outputs[k], o->outputs[i]);
                return -1;
            }
        if (o->points && cli_one_file(o->points, o->outputs[i])) {
            cli_usage_error("lux", "output '%s' is the table of points", o->outputs[i]);
            return -1;
        }
    }
    return cli_ask_error("lux", &o->given, &o->render);
}

/* 0: go on; otherwise *status is the exit status. */
static int parse_options(int argc, char **argv, options *o, int *status)
{
    static const cli_option_set set = { "lux", ":o:t:qh", long_options, set_option, print_help };
    *status = CLI_USAGE;
    if (cli_env_isa("lux", &o->isa) || cli_read_options(&set, argc, argv, o, status)) return -1;
    *status = CLI_USAGE;
    if (argc - optind != 1) {
        cli_usage_error("lux", argc == optind ? "no scene given" : "more than one scene given");
        return -1;
    }
    o->scene = argv[optind];
    return check_options(o);
}

/* ---- sensors ---- */

static int fill_grid(const options *o, lux_table *t, lux_values *v)
{
    const double *corner = o->grid, *u = o->grid + 3, *w = o->grid + 6;
    double n[3], length = 0;
    for (int k = 0; k < 3; k++) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        n[k] = u[a] * w[b] - u[b] * w[a];
        v->edge[0] = hypot(v->edge[0], u[k]);
        v->edge[1] = hypot(v->edge[1], w[k]);
    }
    for (int k = 0; k < 3; k++) length = hypot(length, n[k]);
    if (!(length > 1e-9 * v->edge[0] * v->edge[1])) {
        cli_usage_error("lux", "--grid %s: the edges are 0 or parallel", o->grid_text);
        return CLI_USAGE;
    }
    t->n = 0;
    if (!lux_table_reserve(t, (size_t)o->nx * o->ny)) return CLI_FAILED;
    const double reach = BLOCK * hypot(v->edge[0] / o->nx, v->edge[1] / o->ny);
    for (uint32_t j = 0; j < o->ny; j++)
        for (uint32_t i = 0; i < o->nx; i++) {
            lc_sensor *s = &t->sensors[t->n];
            for (int k = 0; k < 3; k++) {
                s->position[k] = (float)(corner[k] + (i + 0.5) / o->nx * u[k] + (j + 0.5) / o->ny * w[k]);
                s->normal[k] = (float)(n[k] / length);
            }
            s->reach = (float)reach;
            t->lines[t->n++] = NULL;
        }
    v->width = o->nx;
    v->height = o->ny;
    v->n = t->n;
    return 0;
}

/* Rows of points; the last is filled up with the last point. */
static int fill_points(const options *o, lux_table *t, lux_values *v, lc_sensors_desc *d)
{
    const int status = lux_table_read(o->points, t);
    if (status) return status;
    v->n = t->n;
    d->height = (uint32_t)((t->n + ROW - 1) / ROW);
    d->width = (uint32_t)((t->n + d->height - 1) / d->height);
    const size_t all = (size_t)d->width * d->height;
    if (!lux_table_reserve(t, all)) return CLI_FAILED;
    for (size_t i = t->n; i < all; i++) t->sensors[i] = t->sensors[t->n - 1];
    return 0;
}

static int make_sensors(const options *o, lux_table *t, lux_values *v, lc_sensors_desc *d)
{
    d->quantity = o->camera ? LC_LUMINANCE : o->quantity;
    if (o->camera) return 0;
    int status = o->points ? fill_points(o, t, v, d) : fill_grid(o, t, v);
    if (status) return status;
    if (!o->points) d->width = v->width, d->height = v->height;
    d->sensors = t->sensors;
    return 0;
}

/* ---- values ---- */

/* Whether nothing was left out anywhere: also where no light is. */
static bool is_exact(const lc_render_stats *stats) { return stats->exact || !stats->calibration.n_pilots; }

/* To what cuts leave out comes how far the lights of lamps are from their lamps, at 95 of 100 sensors. */
static int set_values(const options *o, const lc_image *image, const lc_render_stats *stats,
                      const lc_scene_info *info, lux_values *v)
{
    const float *rgb[3] = { lc_image_channel(image, "R"), lc_image_channel(image, "G"),
                            lc_image_channel(image, "B") },
                *error = lc_image_channel(image, "cut.error");
    const double floor_value = (double)o->render.dark_floor * stats->mean_luminance,
                 asked = (double)o->render.error;
    const double lamps = fmax(info->lamps_high, ROUNDING);
    double sum = 0; /* a cut's own half-width, which is less than is asked, would hold for fewer of them */
    if (o->camera) {
        lc_image_desc size = LC_IMAGE_DESC_INIT;
        lc_image_get_desc(image, &size);
        v->width = size.width;
        v->height = size.height;
        v->n = (size_t)size.width * size.height;
    }
    v->value = calloc(v->n, sizeof *v->value);
    v->error = calloc(v->n, sizeof *v->error);
    if (!v->value || !v->error) {
        fprintf(stderr, "lightcuts: error: out of memory\n");
        return CLI_FAILED;
    }
    v->within = is_exact(stats) ? 100 : (double)o->render.within;
    if (lamps > ROUNDING) v->within = fmin(v->within, LAMPS_WITHIN);
    v->min = HUGE_VAL;
    v->max = -HUGE_VAL;
    for (size_t i = 0; i < v->n; i++) {
        const double y = 0.2126 * (double)rgb[0][i] + 0.7152 * (double)rgb[1][i] + 0.0722 * (double)rgb[2][i],
                     half = !is_exact(stats) && error[i] > 0 ? asked * fmax(y, floor_value) : 0;
        v->error[i] = y > 0 ? half / y + lamps : 1;
        v->value[i] = y * o->efficacy;
        v->min = fmin(v->min, v->value[i]);
        v->max = fmax(v->max, v->value[i]);
        sum += v->value[i];
    }
    v->mean = sum / (double)v->n;
    return 0;
}

static void name_values(const options *o, lux_values *v)
{
    v->is_picture = o->camera;
    v->unit = o->camera ? "cd/m2" : "lx";
    v->what = o->camera                                   ? "Luminance"
              : o->quantity == LC_ILLUMINANCE_CYLINDRICAL ? "Cylindrical illum."
              : o->quantity == LC_ILLUMINANCE_SCALAR      ? "Scalar illuminance"
                                                          : "Illuminance";
}

/* ---- output ---- */

typedef struct result {
    const options *o;
    const lux_table *table;
    const lux_values *values;
    const lc_scene_info *info;
    const lc_render_stats *stats;
} result;

static void write_csv(FILE *f, void *user)
{
    const result *r = user;
    lux_csv_write(f, r->table, r->values);
}

static double uniformity(const lux_values *v) { return v->mean > 0 ? v->min / v->mean : 0; }

static void print_json(FILE *f, const result *r)
{
    const lux_values *v = r->values;
    const lc_calibration *c = &r->stats->calibration;
    const lc_scene_info *i = r->info;
    const bool exact = is_exact(r->stats);
    fprintf(f, "{\n  \"quantity\": \"%s\",\n  \"unit\": \"%s\",\n  \"sensors\": %zu,\n", v->what, v->unit,
            v->n);
    fprintf(f, "  \"min\": %.9g,\n  \"mean\": %.9g,\n  \"max\": %.9g,\n  \"uniformity\": %.6g,\n", v->min,
            v->mean, v->max, uniformity(v));
    fprintf(f, "  \"lights\": %llu,\n  \"cut\": {\"mean\": %.6g, \"median\": %u, \"p99\": %u},\n",
            (unsigned long long)i->n_lights, r->stats->cut_mean, r->stats->cut_median, r->stats->cut_p99);
    cli_deviations_json(f, i);
    fprintf(f,
            "  \"error\": {\"asked\": %.6g, \"within\": %.6g, \"achieved\": %.6g, \"margin\": %.6g, "
            "\"pilots\": %u, "
            "\"floor\": %.6g, \"every_light\": %s}\n}\n",
            exact ? 0 : (double)r->o->render.error, v->within, c->n_pilots ? (double)c->achieved : 100,
            (double)c->margin, c->n_pilots,
            (double)r->o->render.dark_floor * r->stats->mean_luminance * r->o->efficacy,
            exact ? "true" : "false");
}

static void print_summary(const result *r)
{
    const lux_values *v = r->values;
    const lc_calibration *c = &r->stats->calibration;
    fprintf(stderr, "lightcuts: %zu %s: min %.6g, mean %.6g, max %.6g %s, min/mean %.4f\n", v->n,
            v->is_picture ? "pixels" : "sensors", v->min, v->mean, v->max, v->unit, uniformity(v));
    if (is_exact(r->stats)) fprintf(stderr, "lightcuts: every light at every sensor");
    else
        fprintf(stderr, "lightcuts: %.4g %% +- %.2g %% of them are within %.3g %%, by %u pilots",
                (double)c->achieved, (double)c->margin, 100 * (double)c->error, c->n_pilots);
    if (r->info->lamps_median >= 0)
        fprintf(stderr, "; lamps as points: %.2g %% in half of them", 100 * r->info->lamps_median);
    if (r->info->sky_median >= 0)
        fprintf(stderr, "; sky as discs: %.2g %%", 100 * r->info->sky_median);
    if (r->info->n_indirect_lights)
        fprintf(stderr, "; indirect light: %.2g %%", 100 * r->info->indirect_median);
    fprintf(stderr, "\n");
}

static int write_outputs(lc_context *ctx, result *r)
{
    bool table = false;
    int status = 0;
    for (int i = 0; i < r->o->n_outputs && !status; i++) {
        const char *path = r->o->outputs[i];
        if (cli_is_stdout(path)) continue;
        const bool png = cli_has_extension(path, ".png");
        table |= !png;
        status = png ? lux_map_write(ctx, path, r->table, r->values) : cli_write_file(path, write_csv, r);
    }
    if (status) return status;
    if (r->o->json) print_json(stdout, r);
    else if (!table || r->o->to_stdout) lux_csv_write(stdout, r->table, r->values);
    if (!r->o->quiet) print_summary(r);
    return CLI_OK;
}

static void state_error(const options *o, const lc_render_stats *stats, lux_values *v)
{
    if (is_exact(stats)) snprintf(v->error_text, sizeof v->error_text, "every light at every sensor");
    else
        snprintf(v->error_text, sizeof v->error_text, "%.4g %% within %.3g %% (pilots: %.4g %%)",
                 (double)o->render.within, 100 * (double)o->render.error,
                 (double)stats->calibration.achieved);
}

/* ---- the command ---- */

static int measure(options *o, lc_context *ctx, const lc_scene *scene, lux_table *t, lux_values *v)
{
    lc_scene_info info = LC_SCENE_INFO_INIT;
    lc_render_stats stats = LC_RENDER_STATS_INIT;
    lc_image *image = NULL;
    cli_progress line;
    lc_scene_get_info(scene, &info);
    if (!info.n_lights && !o->quiet)
        fprintf(stderr, "lightcuts: warning: the scene has no lights: all values are 0\n");
    for (int i = 0; i < o->n_outputs; i++)
        if (lc_scene_reads_file(scene, o->outputs[i])) {
            cli_usage_error("lux", "output '%s' is a file of the scene", o->outputs[i]);
            return CLI_USAGE;
        }
    o->render.aovs = LC_AOV_ERROR;
    o->render.progress = cli_progress_step;
    o->render.progress_user = &line;
    cli_progress_start(&line, o->scene, o->quiet);
    lc_status st = lc_render(ctx, scene, &o->render, &image, &stats);
    cli_progress_end(&line);
    int status = cli_exit_status(st);
    if (!status) status = set_values(o, image, &stats, &info, v);
    lc_image_destroy(image);
    if (status) return status;
    name_values(o, v);
    state_error(o, &stats, v);
    return write_outputs(ctx, &(result){ o, t, v, &info, &stats });
}

static int run(options *o, lc_context *ctx, lux_table *t, lux_values *v)
{
    lc_sensors_desc sensors = LC_SENSORS_DESC_INIT;
    lc_scene *scene = NULL;
    int status = make_sensors(o, t, v, &sensors);
    for (int i = 0; i < o->n_outputs && !status; i++) status = cli_check_writable(o->outputs[i]);
    if (status) return status;
    o->load.sensors = &sensors;
    lc_status st = lc_scene_load(ctx, o->scene, &o->load, &scene);
    status = st == LC_ERR_IO ? CLI_INPUT : cli_exit_status(st);
    if (!status) status = measure(o, ctx, scene, t, v);
    lc_scene_destroy(scene);
    return status;
}

int cmd_lux(int argc, char **argv)
{
    options o = { .load = LC_LOAD_DESC_INIT, .render = LC_RENDER_DESC_INIT, .efficacy = 1 };
    lux_table table = { 0 };
    lux_values values = { 0 };
    int status;
    o.load.indirect_lights = LC_NO_LIGHTS;
    o.render.error = LUX_ERROR;
    if (parse_options(argc, argv, &o, &status)) return status;
    cli_catch_signals();
    lc_context *ctx = cli_context(o.n_threads, o.isa, o.quiet ? -1 : 0);
    status = ctx ? run(&o, ctx, &table, &values) : CLI_FAILED;
    lux_table_free(&table);
    free(values.value);
    free(values.error);
    lc_context_destroy(ctx);
    if (cli_caught_signal()) cli_die_by_signal(cli_caught_signal());
    return status;
}
