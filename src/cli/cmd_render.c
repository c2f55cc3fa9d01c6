/* cmd_render.c - options -> scene -> picture -> files and statistics. */
#include "cli/calibration.h"
#include "cli/cli.h"
#include "cli/display.h"
#include "cli/farm.h"
#include "cli/light_groups.h"
#include "cli/place.h"
#include "cli/progress.h"
#include "cli/sandbox.h"
#include "cli/stats_file.h"
#include "cli/tone.h"
#include "cli/warn.h"
#include "cli/watch.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define MAX_OUTPUTS 16

typedef struct {
    const char *scene, *outputs[MAX_OUTPUTS], *stats_file;
    char default_output[4096];
    int n_outputs;
    uint32_t n_threads;
    lc_isa isa;
    lc_load_desc load;
    lc_render_desc render;
    int32_t pixel_crop[4];
    double unit_crop[4];
    cli_error_options given;
    const char *calibration;
    lc_calibration known; /* of that file */
    bool has_pixel_crop, has_unit_crop, quiet, print_stats, write_time;
    int verbosity;
    cli_farm farm;
    cli_tone tone;
    cli_server server;    /* n 0: none */
    cli_display *display; /* NULL: none */
    bool watch;
    cli_watch *files;     /* NULL: they are not watched */
    cli_groups groups;
} options;

enum {
    OPT_METHOD = CLI_LONG_ONLY,
    OPT_CALIBRATION,
    OPT_SECONDS,
    OPT_REPS,
    OPT_MAXDEPTH,
    OPT_AREA,
    OPT_SEED,
    OPT_SPP,
    OPT_ISA,
    OPT_BVH,
    OPT_PIXELS,
    OPT_CROP,
    OPT_AOV,
    OPT_STATS_FILE,
    OPT_STATS,
    OPT_TIME,
    OPT_BUILDER,
    OPT_ENV,
    OPT_INDIRECT,
    OPT_INDIRECT_ERROR,
    OPT_INDIRECT_FROM,
    OPT_CHUNK,
    OPT_PRINT_CHUNKS,
    OPT_CHECKPOINT,
    OPT_INTERVAL,
    OPT_RESUME,
    OPT_KEEP,
    OPT_LIMIT,
    OPT_SANDBOX,
    OPT_MEMORY,
    OPT_RESOLUTION,
    OPT_PARTIAL,
    OPT_WATCH,
    OPT_SERVER
};

static const struct option long_options[] = {
    { "outfile", 1, 0, 'o' },
    { "method", 1, 0, OPT_METHOD },
    { "resolution", 1, 0, OPT_RESOLUTION },
    { "write-partial", 0, 0, OPT_PARTIAL },
    { "watch", 0, 0, OPT_WATCH },
    { "display-server", 1, 0, OPT_SERVER },
    CLI_TONE_OPTIONS,
    CLI_GROUP_OPTION,
    CLI_ERROR_OPTIONS,
    { "calibration", 1, 0, OPT_CALIBRATION },
    { "time", 1, 0, OPT_SECONDS },
    { "representatives", 1, 0, OPT_REPS },
    { "maxdepth", 1, 0, OPT_MAXDEPTH },
    { "area-lights", 1, 0, OPT_AREA },
    { "env-lights", 1, 0, OPT_ENV },
    { "indirect-lights", 1, 0, OPT_INDIRECT },
    { "indirect-error", 1, 0, OPT_INDIRECT_ERROR },
    { "indirect-from", 1, 0, OPT_INDIRECT_FROM },
    { "nthreads", 1, 0, 't' },
    { "seed", 1, 0, OPT_SEED },
    { "spp", 1, 0, OPT_SPP },
    { "bvh", 1, 0, OPT_BVH },
    { "isa", 1, 0, OPT_ISA },
    { "pixelbounds", 1, 0, OPT_PIXELS },
    { "cropwindow", 1, 0, OPT_CROP },
    { "aov", 1, 0, OPT_AOV },
    { "chunk", 1, 0, OPT_CHUNK },
    { "print-chunks", 1, 0, OPT_PRINT_CHUNKS },
    { "checkpoint", 1, 0, OPT_CHECKPOINT },
    { "checkpoint-interval", 1, 0, OPT_INTERVAL },
    { "keep-checkpoint", 0, 0, OPT_KEEP },
    { "resume", 0, 0, OPT_RESUME },
    { "time-limit", 1, 0, OPT_LIMIT },
    { "sandbox", 1, 0, OPT_SANDBOX },
    { "max-memory", 1, 0, OPT_MEMORY },
    { "stats-file", 1, 0, OPT_STATS_FILE },
    { "stats", 0, 0, OPT_STATS },
    { "write-time", 0, 0, OPT_TIME },
    { "builder", 1, 0, OPT_BUILDER },
    { "quiet", 0, 0, 'q' },
    { "verbose", 0, 0, 'v' },
    { "help", 0, 0, 'h' },
    { 0, 0, 0, 0 },
};

/* Nonzero: the value of option c is out of range. */
static int set_option(void *user, int c)
{
    options *o = user;
    switch (c) {
    case 'o':
        o->outputs[o->n_outputs % MAX_OUTPUTS] = cli_output_name(optarg);
        return ++o->n_outputs > MAX_OUTPUTS || !*optarg;
    case OPT_METHOD: return cli_parse_method(optarg, &o->render.method);
    case OPT_CALIBRATION: o->calibration = optarg; return !*optarg;
    case OPT_SECONDS: return cli_parse_time(optarg, &o->render.seconds);
    case OPT_BUILDER: return cli_parse_builder(optarg, &o->load.builder);
    case OPT_REPS: return cli_parse_u32(optarg, 1, CLI_MAX_REPS, &o->load.n_reps);
    case OPT_MAXDEPTH: return cli_parse_u32(optarg, 1, CLI_MAX_DEPTH, &o->load.max_depth);
    case OPT_AREA: return cli_parse_u32(optarg, 1, CLI_MAX_LIGHTS, &o->load.area_lights);
    case OPT_ENV: return cli_parse_u32(optarg, 1, CLI_MAX_LIGHTS, &o->load.env_lights);
    case OPT_INDIRECT: return cli_parse_indirect(optarg, &o->load.indirect_lights);
    case OPT_INDIRECT_ERROR: return cli_parse_float(optarg, CLI_MIN_INDIRECT, 1, &o->load.indirect_error);
    case OPT_INDIRECT_FROM: return cli_parse_indirect_from(optarg, &o->load.indirect_from);
    case 't': return cli_parse_u32(optarg, 1, CLI_MAX_THREADS, &o->n_threads);
    case OPT_SEED: return cli_parse_u64(optarg, 0, UINT64_MAX, &o->load.seed);
    case OPT_SPP: return cli_parse_u32(optarg, 1, CLI_MAX_SPP, &o->load.spp);
    case OPT_BVH: return cli_parse_bvh(optarg);
    case OPT_ISA: return cli_parse_isa(optarg, &o->isa);
    case OPT_PIXELS: o->has_pixel_crop = true; return cli_parse_pixels(optarg, o->pixel_crop);
    case OPT_CROP: o->has_unit_crop = true; return cli_parse_list(optarg, 4, 0, 1, o->unit_crop);
    case OPT_CHUNK: o->farm.chunk = optarg; return 0;
    case OPT_PRINT_CHUNKS: return cli_parse_u32(optarg, 1, UINT32_MAX, &o->farm.print);
    case OPT_CHECKPOINT: o->farm.checkpoint = optarg; return !*optarg;
    case OPT_INTERVAL: return cli_parse_time(optarg, &o->farm.interval);
    case OPT_RESUME: o->farm.resume = true; return 0;
    case OPT_PARTIAL: o->render.partial = 1; return 0;
    case OPT_WATCH: o->watch = true; return 0;
    case OPT_SERVER: return cli_parse_server(optarg, &o->server);
    case OPT_KEEP: o->farm.keep = true; return 0;
    case OPT_LIMIT: return cli_parse_time(optarg, &o->farm.time_limit);
    case OPT_SANDBOX: o->load.sandbox = optarg; return !*optarg;
    case OPT_MEMORY: return cli_parse_memory(optarg);
    case OPT_AOV: return cli_parse_aovs(optarg, &o->render.aovs);
    case OPT_STATS_FILE: o->stats_file = optarg; return !*optarg;
    case OPT_STATS: o->print_stats = true; return 0;
    case OPT_TIME: o->write_time = true; return 0;
    case 'q':
        o->quiet = true;
        o->verbosity = -1;
        return 0;
    case 'v': o->verbosity = 1; return 0;
    case CLI_OPT_GROUP: return cli_add_group(&o->groups, optarg, &o->load);
    case OPT_RESOLUTION: return cli_parse_resolution(optarg, o->load.resolution);
    case CLI_OPT_EXPOSURE:
    case CLI_OPT_TONE: return cli_set_tone(c, optarg, &o->tone);
    default: return cli_set_error_option(c, optarg, &o->given, &o->render);
    }
}

/* Parts of a picture would choose errors of their own. */
static int check_time(const options *o)
{
    const char *other = o->given.ratio                        ? "--error-ratio"
                        : o->render.error > 0                 ? "--error"
                        : o->calibration                      ? "--calibration"
                        : o->farm.chunk                       ? "--chunk"
                        : o->farm.print                       ? "--print-chunks"
                        : o->farm.checkpoint                  ? "--checkpoint"
                        : o->render.method == LC_METHOD_EXACT ? "--method exact"
                                                              : NULL;
    if (!(o->render.seconds > 0) || !other) return 0;
    cli_usage_error("render", "--time chooses the error of the whole picture: not with %s", other);
    return -1;
}

/* What goes to standard output, and what of a part of a picture may be written. */
static int check_streams(const options *o)
{
    const int texts = (o->stats_file && !strcmp(o->stats_file, "-")) + o->print_stats;
    int pictures = 0;
    for (int i = 0; i < o->n_outputs; i++) pictures += cli_is_stdout(o->outputs[i]);
    if (pictures && pictures + texts > 1)
        cli_usage_error("render", "only one thing can go to standard output");
    else if (pictures && isatty(STDOUT_FILENO))
        cli_usage_error("render", "-o -: standard output is a terminal");
    else if (o->render.partial && o->farm.chunk)
        cli_usage_error("render", "--write-partial: a part of --chunk is whole or not there");
    else return 0;
    return -1;
}

/* What is kept of a picture is of the scene as it was. */
static int check_watch(const options *o)
{
    const char *other = o->farm.chunk             ? "--chunk"
                        : o->farm.print           ? "--print-chunks"
                        : o->farm.checkpoint      ? "--checkpoint"
                        : o->calibration          ? "--calibration"
                        : !strcmp(o->scene, "-")  ? "a scene from standard input"
                                                  : NULL;
    for (int i = 0; i < o->n_outputs && !other; i++)
        if (cli_is_stdout(o->outputs[i])) other = "a picture to standard output";
    if (!o->watch || !other) return 0;
    cli_usage_error("render", "--watch renders a scene each time that it changes: not with %s", other);
    return -1;
}

/* 0: go on; otherwise *status is the exit status. */
static int parse_options(int argc, char **argv, options *o, int *status)
{
    static const cli_option_set set = { "render", ":o:t:qvh", long_options, set_option, cli_render_help };
    *status = CLI_USAGE;
    if (cli_env_isa("render", &o->isa) || cli_read_options(&set, argc, argv, o, status)) return -1;
    *status = CLI_USAGE;
    if (argc - optind != 1) {
        cli_usage_error("render", argc == optind ? "no scene given" : "more than one scene given");
        return -1;
    }
    if (check_time(o) || check_streams(o)) return -1;
    if (cli_ask_error("render", &o->given, &o->render)) return -1;
    o->scene = argv[optind];
    if (cli_farm_check(&o->farm) || check_watch(o)) return -1;
    for (int i = 0; i < o->n_outputs; i++)
        if (cli_check_picture_name("render", o->outputs[i])) return -1;
    return 0;
}

/* The default output, in the current folder: the film's filename without its folder, so that a scene does not
 * choose what is overwritten elsewhere, with .exr in place of an extension that is neither .exr nor .png;
 * without a filename SCENE.exr, also of SCENE.pbrt.gz. */
static void choose_output(options *o, const lc_scene_info *info)
{
    if (o->n_outputs) return;
    const char *name = info->film_filename, *slash = strrchr(name, '/');
    if (slash) name = slash + 1;
    bool from_scene = !*name || !strcmp(name, ".") || !strcmp(name, "..");
    if (from_scene) {
        slash = strrchr(o->scene, '/');
        name = !strcmp(o->scene, "-") ? "stdin" : slash ? slash + 1 : o->scene;
    }
    snprintf(o->default_output, sizeof o->default_output - 40, "%s", name);
    size_t len = strlen(o->default_output);
    if (from_scene && cli_has_extension(name, ".gz") && len > 3) o->default_output[len - 3] = 0;
    char *dot = strrchr(o->default_output, '.');
    if (from_scene || (!cli_has_extension(name, ".exr") && !cli_has_extension(name, ".png"))) {
        if (dot && dot != o->default_output && !strchr(dot, '/')) *dot = 0;
        strcat(o->default_output, ".exr");
    }
    if (o->farm.chunk) { /* every chunk has a file of its own */
        char *end = o->default_output + strlen(o->default_output) - 4, extension[8];
        snprintf(extension, sizeof extension, "%s", end);
        snprintf(end, sizeof o->default_output - (size_t)(end - o->default_output), "-%u-of-%u%s", o->farm.k,
                 o->farm.n, extension);
    }
    o->outputs[o->n_outputs++] = o->default_output;
}

/* The file of the statistics, if they go to one. */
static const char *stats_path(const options *o)
{
    return o->stats_file && strcmp(o->stats_file, "-") ? o->stats_file : NULL;
}

/* Refuses files that would be written over each other, or over what the scene is read from. */
static int check_distinct(const options *o, const lc_scene *scene)
{
    struct {
        const char *what, *path;
    } files[MAX_OUTPUTS + 3];
    int n = 0;
    for (; n < o->n_outputs; n++) files[n].what = "output", files[n].path = o->outputs[n];
    if (stats_path(o)) files[n].what = "statistics", files[n++].path = o->stats_file;
    if (o->farm.checkpoint) files[n].what = "checkpoint", files[n++].path = o->farm.checkpoint;
    if (o->calibration) files[n].what = "calibration", files[n++].path = o->calibration;
    for (int i = 0; i < n; i++) {
        if (lc_scene_reads_file(scene, files[i].path)) {
            cli_usage_error("render", "%s '%s' is a file of the scene", files[i].what, files[i].path);
            return CLI_USAGE;
        }
        for (int k = 0; k < i; k++)
            if (cli_one_file(files[k].path, files[i].path)) {
                cli_usage_error("render", "%s '%s' and %s '%s' are one file", files[k].what, files[k].path,
                                files[i].what, files[i].path);
                return CLI_USAGE;
            }
    }
    return 0;
}

static int check_outputs(const options *o)
{
    for (int i = 0; i < o->n_outputs; i++)
        if (cli_check_writable(o->outputs[i])) return CLI_FAILED;
    return stats_path(o) ? cli_check_writable(o->stats_file) : 0;
}

static int set_crop(options *o, const lc_scene_info *info)
{
    for (int i = 0; i < 4; i++) {
        double size = i < 2 ? info->width : info->height;
        if (o->has_pixel_crop) o->render.crop[i] = o->pixel_crop[i];
        else if (o->has_unit_crop) o->render.crop[i] = (int32_t)(o->unit_crop[i] * size + 0.5);
    }
    bool asked = o->has_pixel_crop || o->has_unit_crop;
    if (asked && (o->render.crop[0] >= o->render.crop[1] || o->render.crop[2] >= o->render.crop[3] ||
                  (uint32_t)o->render.crop[1] > info->width || (uint32_t)o->render.crop[3] > info->height)) {
        cli_usage_error("render", "the crop is empty or outside the film of %u x %u pixels", info->width,
                        info->height);
        return CLI_USAGE;
    }
    return 0;
}

/* Whether a render with --resume finds all its outputs in place. An EXR names its chunk and options; a PNG
 * cannot, so it only has to exist, and beside an EXR. */
static bool already_done(const options *o, lc_context *ctx)
{
    bool told = false;
    if (!o->farm.chunk || !o->farm.resume) return false;
    for (int i = 0; i < o->n_outputs; i++) {
        bool png = cli_has_extension(o->outputs[i], ".png");
        if (png ? access(o->outputs[i], R_OK) != 0 : !cli_farm_has(&o->farm, ctx, o->outputs[i]))
            return false;
        told = told || !png;
    }
    return told;
}

/* Decides what is rendered and where it is written as soon as the scene file is read, so that errors are
 * reported before the long work. */
typedef struct {
    options *o;
    lc_context *ctx;
    int status; /* exit status of the process where make_plan ends the load */
} plan;

static int make_plan(void *user, const lc_scene *scene)
{
    plan *p = user;
    options *o = p->o;
    lc_scene_info info = LC_SCENE_INFO_INIT;
    lc_scene_get_info(scene, &info);
    choose_output(o, &info);
    p->status = o->farm.print ? 0 : check_distinct(o, scene);
    if (!p->status) p->status = set_crop(o, &info);
    if (!p->status && o->calibration)
        p->status = cli_calibration_read(p->ctx, scene, o->calibration, &o->render, &o->known);
    if (!p->status) p->status = cli_farm_crop(&o->farm, p->ctx, scene, &o->render);
    if (p->status) return 1;
    if (o->farm.print) {
        p->status = cli_farm_print(&o->farm);
        return 1;
    }
    if (already_done(o, p->ctx)) {
        if (!o->quiet) fprintf(stderr, "lightcuts: chunk %u of %u: already done\n", o->farm.k, o->farm.n);
        return 1;
    }
    p->status = check_outputs(o);
    if (!p->status) p->status = cli_farm_open(&o->farm, p->ctx, scene, &o->render, o->quiet);
    return p->status;
}

static int write_outputs(options *o, lc_context *ctx, lc_image *image, double seconds)
{
    if (o->write_time && !getenv("SOURCE_DATE_EPOCH") &&
        lc_image_set_number(image, "renderTimeSeconds", seconds))
        return CLI_FAILED;
    if (o->farm.chunk && lc_chunk_mark(image, &o->farm.id, o->farm.crop, o->farm.k, o->farm.n))
        return CLI_FAILED;
    for (int i = 0; i < o->n_outputs; i++) {
        const bool png = cli_has_extension(o->outputs[i], ".png");
        lc_status st = png ? cli_write_png(ctx, image, o->outputs[i], &o->tone, !o->quiet)
                           : lc_image_write(image, o->outputs[i]);
        if (st == LC_ERR_CANCELLED) return cli_farm_stopped(&o->farm);
        if (st) return CLI_FAILED;
    }
    return CLI_OK;
}

static int report(const options *o, cli_render_report *r)
{
    if (!o->quiet && o->n_outputs) {
        fprintf(stderr, "lightcuts: wrote");
        for (int i = 0; i < o->n_outputs; i++) fprintf(stderr, " %s", cli_shown(o->outputs[i]));
        fprintf(stderr, " in %.2f s, %.1f of %llu lights a point\n", r->seconds_total, r->stats.cut_mean,
                (unsigned long long)r->info.n_lights);
    }
    if (o->print_stats) cli_print_stats(stdout, r);
    if (!o->stats_file) return CLI_OK;
    if (strcmp(o->stats_file, "-")) return cli_write_file(o->stats_file, cli_write_stats_json, r);
    cli_write_stats_json(stdout, r);
    return CLI_OK;
}

typedef struct {
    cli_progress line;
    options *o;
} steps;

static void warn_of_display(const options *o, cli_progress *line)
{
    const char *text = cli_display_warning(o->display);
    if (!text || o->quiet) return;
    if (line) cli_progress_end(line);
    fprintf(stderr, "lightcuts: warning: %s\n", text);
}

static int step(void *user, uint64_t done, uint64_t total)
{
    steps *s = user;
    const options *o = s->o;
    if (o->display) {
        cli_display_step(o->display);
        warn_of_display(o, &s->line);
    }
    if (cli_progress_step(&s->line, done, total)) return 1;
    return done < total && ((o->files && cli_watch_changed(o->files)) || cli_farm_step(&s->o->farm));
}

/* After a signal, or when time is over. */
static int write_partial(options *o, lc_context *ctx, lc_image *image)
{
    const int sig = cli_forget_signal(), status = write_outputs(o, ctx, image, 0);
    if (!status)
        fprintf(stderr, "lightcuts: %s has %.1f %% of its pixels\n", cli_shown(o->outputs[0]),
                100 * lc_image_get_number(image, "lightcuts/finished", 0));
    cli_remember_signal(sig);
    const int stopped = o->farm.file ? cli_farm_stopped(&o->farm) : CLI_FAILED;
    return status ? status : stopped;
}

static void begin_display(options *o, lc_context *ctx, const lc_scene *scene)
{
    uint32_t crop[4];
    if (!o->display || lc_render_crop(ctx, scene, &o->render, crop)) return;
    cli_display_begin(o->display, o->outputs[0], crop, &o->render);
    warn_of_display(o, NULL);
}

static int render(options *o, lc_context *ctx, const lc_scene *scene, lc_image **image,
                  lc_render_stats *stats)
{
    steps s = { .o = o };
    /* not earlier: while loading nothing checks for signals, and there is nothing to save */
    cli_catch_signals();
    cli_progress_start(&s.line, "rendering", o->quiet);
    s.line.before = o->farm.share_before;
    o->render.progress = step;
    o->render.progress_user = &s;
    begin_display(o, ctx, scene);
    if (o->render.seconds > 0)
        o->render.seconds = fmax(o->render.seconds - (cli_now() - o->farm.start), 0.001);
    lc_status st = lc_render(ctx, scene, &o->render, image, stats);
    cli_progress_end(&s.line);
    if (o->display) cli_display_end(o->display, *image);
    warn_of_display(o, NULL);
    if (st == LC_ERR_CANCELLED && o->files && o->files->changed && !cli_caught_signal()) return CLI_STOPPED;
    if (st == LC_ERR_CANCELLED && *image) return write_partial(o, ctx, *image);
    if (st == LC_ERR_CANCELLED && !o->farm.file && (o->render.partial || o->watch)) {
        fprintf(stderr, "lightcuts: interrupted%s, nothing written\n",
                o->render.partial ? " before a pixel was finished" : "");
        return CLI_FAILED;
    }
    if (st == LC_ERR_CANCELLED) return cli_farm_stopped(&o->farm);
    return st ? cli_exit_status(st) : CLI_OK;
}

static int enter_sandbox(const options *o)
{
    cli_sandbox s = { .scene = o->scene,
                      .folder = o->load.sandbox,
                      .reads_outputs = o->farm.checkpoint || o->farm.resume };
    bool by_kernel;
    if (access(o->load.sandbox, R_OK | X_OK)) {
        cli_usage_error("render", "bad value '%s' for option --sandbox: %s", o->load.sandbox,
                        strerror(errno));
        return CLI_USAGE;
    }
    for (int i = 0; i < o->n_outputs; i++)
        if (!cli_is_stdout(o->outputs[i])) s.outputs[s.n_outputs++] = o->outputs[i];
    if (!o->n_outputs) s.outputs[s.n_outputs++] = "./";
    if (stats_path(o)) s.outputs[s.n_outputs++] = o->stats_file;
    if (o->farm.checkpoint) s.outputs[s.n_outputs++] = o->farm.checkpoint;
    int err = cli_sandbox_enter(&s, &by_kernel);
    if (err)
        fprintf(stderr, "lightcuts: error: cannot enter the sandbox '%s': %s\n", cli_shown(o->load.sandbox),
                strerror(err));
    if (!err && o->verbosity > 0)
        fprintf(stderr, "lightcuts: sandbox: names are checked%s\n",
                by_kernel ? ", and every access by Landlock" : "; this kernel has no Landlock");
    return err ? CLI_FAILED : 0;
}

/* again: not the first picture of --watch. */
static int run(options *o, lc_context *ctx, bool again, lc_scene **scene, lc_image **image)
{
    cli_render_report r = { .scene = o->scene,
                            .method = o->render.method,
                            .seed = o->load.seed,
                            .info = LC_SCENE_INFO_INIT,
                            .stats = LC_RENDER_STATS_INIT };
    plan p = { .o = o, .ctx = ctx };
    double t0 = cli_now();
    int status = o->load.sandbox && !again ? enter_sandbox(o) : 0;
    if (status) return status;
    cli_catch_save_signals(o->farm.checkpoint != NULL);
    o->load.parsed = make_plan;
    o->load.parsed_user = &p;
    o->load.reads = o->files ? cli_watch_note : NULL;
    o->load.reads_user = o->files;
    lc_status st = lc_scene_load(ctx, o->scene, &o->load, scene);
    if (st == LC_ERR_CANCELLED) return p.status;
    if (st) return st == LC_ERR_IO ? CLI_INPUT : cli_exit_status(st);
    lc_scene_get_info(*scene, &r.info);
    r.loaded = *scene;
    if (!o->quiet) cli_warn_of_scene(&o->load, &r.info);
    status = render(o, ctx, *scene, image, &r.stats);
    if (!status && o->calibration)
        status = cli_calibration_write(ctx, *scene, o->calibration, &o->render, &r.stats.calibration);
    if (status) return status;
    if (r.stats.nonfinite)
        fprintf(stderr, "lightcuts: warning: %llu pixels were not finite and were set to 0\n",
                (unsigned long long)r.stats.nonfinite);
    double t1 = cli_now();
    status = write_outputs(o, ctx, *image, r.stats.seconds);
    if (status) return status;
    cli_farm_close(&o->farm, true);
    r.isa = lc_isa_name(lc_context_isa(ctx));
    r.threads = lc_context_threads(ctx);
    r.seconds_write = cli_now() - t1;
    r.seconds_total = cli_now() - t0;
    return report(o, &r);
}

typedef struct {
    const options *given;
    lc_context *ctx;
    cli_watch files;
} job;

/* One picture, from the options as they were given. */
static int once(void *user, bool again)
{
    job *j = user;
    options o = *j->given;
    lc_scene *scene = NULL;
    lc_image *image = NULL;
    if (again) o.farm.start = cli_now();
    if (o.watch) o.files = &j->files;
    const int status = run(&o, j->ctx, again, &scene, &image);
    cli_farm_close(&o.farm, false);
    lc_image_destroy(image);
    lc_scene_destroy(scene);
    return status;
}

int cmd_render(int argc, char **argv)
{
    options o = { .load = LC_LOAD_DESC_INIT, .render = LC_RENDER_DESC_INIT, .farm = CLI_FARM_INIT };
    int status;
    o.farm.start = cli_now();
    if (parse_options(argc, argv, &o, &status)) return status;
    job j = { .given = &o, .ctx = cli_context(o.n_threads, o.isa, o.verbosity) };
    if (o.server.n && j.ctx && !(o.display = cli_display_open(&o.server)))
        fprintf(stderr, "lightcuts: warning: out of memory: the picture is not shown\n");
    if (!j.ctx) status = CLI_FAILED;
    else status = o.watch ? cli_watch_loop(&j.files, once, &j, o.quiet) : once(&j, false);
    cli_display_close(o.display);
    lc_context_destroy(j.ctx);
    if (cli_caught_signal()) cli_die_by_signal(cli_caught_signal());
    return status;
}
