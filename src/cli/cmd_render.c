/* cmd_render.c - options -> scene -> picture -> files and statistics. */
#include "cli/calibration.h"
#include "cli/display.h"
#include "cli/preview_passes.h"
#include "cli/progress.h"
#include "cli/render_options.h"
#include "cli/sandbox.h"
#include "cli/stats_file.h"
#include "cli/warn.h"
#include "cli/watch.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef cli_render_options options;

#define NOTHING_TO_DO (-1) /* of load: the plan has done all */

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
    OPT_PARTIAL, OPT_EVERY_PIXEL,
    OPT_PREVIEW,
    OPT_PREVIEW_INTERVAL,
    OPT_WATCH,
    OPT_SERVER,
    OPT_FRAMES,
    OPT_FRAME,
    OPT_TRACK,
    OPT_FRAME_SEED
};

static const struct option long_options[] = {
    { "outfile", 1, 0, 'o' },
    { "method", 1, 0, OPT_METHOD },
    { "resolution", 1, 0, OPT_RESOLUTION },
    { "write-partial", 0, 0, OPT_PARTIAL },
    { "every-pixel", 0, 0, OPT_EVERY_PIXEL },
    { "preview", 0, 0, OPT_PREVIEW },
    { "preview-interval", 1, 0, OPT_PREVIEW_INTERVAL },
    { "watch", 0, 0, OPT_WATCH },
    { "display-server", 1, 0, OPT_SERVER },
    { "frames", 1, 0, OPT_FRAMES },
    { "frame", 1, 0, OPT_FRAME },
    { "track", 1, 0, OPT_TRACK },
    { "seed-per-frame", 0, 0, OPT_FRAME_SEED },
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
        o->outputs[o->n_outputs % CLI_MAX_OUTPUTS] = cli_output_name(optarg);
        return ++o->n_outputs > CLI_MAX_OUTPUTS || !*optarg;
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
    case OPT_EVERY_PIXEL: o->render.every_pixel = 1; return 0;
    case OPT_PREVIEW: o->preview = true; return 0;
    case OPT_PREVIEW_INTERVAL: return cli_parse_time(optarg, &o->preview_interval);
    case OPT_WATCH: o->watch = true; return 0;
    case OPT_SERVER: return cli_parse_server(optarg, &o->server);
    case OPT_KEEP: o->farm.keep = true; return 0;
    case OPT_FRAMES: o->frames.given = o->frames.many = true; return cli_frames_parse(optarg, &o->frames);
    case OPT_FRAME:
        o->frames.given = true;
        return cli_frames_parse(optarg, &o->frames) || o->frames.first != o->frames.last;
    case OPT_TRACK: o->frames.path = optarg; return !*optarg;
    case OPT_FRAME_SEED: o->frames.seed_per_frame = true; return 0;
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
    if (cli_render_check_time(o) || cli_render_check_streams(o) || cli_preview_check(o)) return -1;
    if (cli_ask_error("render", &o->given, &o->render)) return -1;
    o->scene = argv[optind];
    if (cli_render_check_frames(o) || (!o->frames.many && cli_farm_check(&o->farm)) ||
        cli_render_check_watch(o))
        return -1;
    for (int i = 0; i < o->n_outputs; i++)
        if (cli_check_picture_name("render", o->outputs[i])) return -1;
    return 0;
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
    if ((!o->farm.chunk && !o->frames.many) || !o->farm.resume) return false;
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
    cli_render_choose_output(o, &info);
    p->status = o->farm.print ? 0 : cli_render_check_distinct(o, scene);
    if (!p->status) p->status = set_crop(o, &info);
    if (!p->status && o->frames.given) p->status = cli_frames_views(&o->frames, scene);
    if (!p->status && o->calibration)
        p->status = cli_calibration_read(p->ctx, scene, o->calibration, &o->render, &o->known);
    if (!p->status) p->status = cli_farm_crop(&o->farm, p->ctx, scene, &o->render);
    if (p->status) return 1;
    if (o->farm.print) {
        p->status = cli_farm_print(&o->farm);
        return 1;
    }
    if (!o->frames.many && already_done(o, p->ctx)) {
        if (!o->quiet) fprintf(stderr, "lightcuts: chunk %u of %u: already done\n", o->farm.k, o->farm.n);
        return 1;
    }
    p->status = cli_render_check_outputs(o);
    if (!p->status) p->status = cli_farm_open(&o->farm, p->ctx, scene, &o->render, o->quiet);
    return p->status;
}

/* After a render that was cancelled. */
static int stopped(options *o)
{
    if (!o->frames.many) return cli_farm_stopped(&o->farm);
    fprintf(stderr, "lightcuts: interrupted in frame %u; go on with --resume\n", o->frames.frame);
    return CLI_FAILED;
}

/* whole: all pixels are there; each frame is then marked as a picture in one part, which --resume knows. */
static int write_outputs(options *o, lc_context *ctx, lc_image *image, double seconds, bool whole)
{
    if (o->write_time && !getenv("SOURCE_DATE_EPOCH") &&
        lc_image_set_number(image, "renderTimeSeconds", seconds))
        return CLI_FAILED;
    if ((o->farm.chunk || (o->frames.many && whole)) &&
        lc_chunk_mark(image, &o->farm.id, o->farm.crop, o->farm.k, o->farm.n))
        return CLI_FAILED;
    for (int i = 0; i < o->n_outputs; i++) {
        const bool png = cli_has_extension(o->outputs[i], ".png");
        lc_status st = png ? cli_write_png(ctx, image, o->outputs[i], &o->tone, !o->quiet)
                           : lc_image_write(image, o->outputs[i]);
        if (st == LC_ERR_CANCELLED) return stopped(o);
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
    const int sig = cli_forget_signal(), status = write_outputs(o, ctx, image, 0, false);
    if (!status)
        fprintf(stderr, "lightcuts: %s has %.1f %% of its pixels\n", cli_shown(o->outputs[0]),
                100 * lc_image_get_number(image, "lightcuts/finished", 0));
    cli_remember_signal(sig);
    const int ended = o->farm.file ? cli_farm_stopped(&o->farm) : CLI_FAILED;
    return status ? status : ended;
}

static void begin_display(options *o, lc_context *ctx, const lc_scene *scene, lc_render_desc *desc)
{
    uint32_t crop[4];
    if (!o->display || lc_render_crop(ctx, scene, desc, crop)) return;
    cli_display_begin(o->display, o->outputs[0], crop, desc);
    warn_of_display(o, NULL);
}

static int render(options *o, lc_context *ctx, const lc_scene *scene, lc_image **image,
                  lc_render_stats *stats)
{
    steps s = { .o = o };
    char what[40] = "rendering";
    /* not earlier: while loading nothing checks for signals, and there is nothing to save */
    cli_catch_signals();
    if (o->frames.many) snprintf(what, sizeof what, "rendering frame %u", o->frames.frame);
    cli_progress_start(&s.line, what, o->quiet);
    s.line.before = o->farm.share_before;
    o->render.progress = step;
    o->render.progress_user = &s;
    if (o->render.seconds > 0)
        o->render.seconds = fmax(o->render.seconds - (cli_now() - o->farm.start), 0.001);
    lc_render_desc desc = o->render; /* what the display takes of it is of this picture */
    begin_display(o, ctx, scene, &desc);
    lc_status st = lc_render(ctx, scene, &desc, image, stats);
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
    if (st == LC_ERR_CANCELLED) return stopped(o);
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
    if (cli_render_stats_path(o)) s.outputs[s.n_outputs++] = o->stats_file;
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

/* Reads the scene and makes all that pictures have in common. */
static int load(options *o, lc_context *ctx, lc_scene **scene)
{
    lc_scene_info info = LC_SCENE_INFO_INIT;
    plan p = { .o = o, .ctx = ctx };
    o->load.parsed = make_plan;
    o->load.parsed_user = &p;
    o->load.frame = o->frames.frame;
    o->load.views = &o->frames.views;
    o->load.movable = o->frames.track.movable;
    o->load.n_movable = o->frames.track.n_movable;
    o->load.reads = o->files ? cli_watch_note : NULL;
    o->load.reads_user = o->files;
    lc_status st = lc_scene_load(ctx, o->scene, &o->load, scene);
    if (st == LC_ERR_CANCELLED) return p.status ? p.status : NOTHING_TO_DO;
    if (st == LC_ERR_ARG && o->frames.path) return CLI_INPUT; /* the track's cameras */
    if (st) return st == LC_ERR_IO ? CLI_INPUT : cli_exit_status(st);
    lc_scene_get_info(*scene, &info);
    if (!o->quiet) {
        cli_warn_of_scene(&o->load, &info);
        cli_render_warn_channels(o);
    }
    return 0;
}

/* A picture of a scene that is ready, and its files. */
static int make_picture(options *o, lc_context *ctx, const lc_scene *scene, lc_image **image, double t0)
{
    cli_render_report r = { .scene = o->scene,
                            .method = o->render.method,
                            .seed = o->load.seed,
                            .frame = o->frames.given ? o->frames.frame : 0,
                            .info = LC_SCENE_INFO_INIT,
                            .stats = LC_RENDER_STATS_INIT };
    lc_scene_get_info(scene, &r.info);
    r.loaded = scene;
    if (o->preview) return cli_preview_render(o, ctx, scene, write_outputs);
    int status = render(o, ctx, scene, image, &r.stats);
    if (!status && o->calibration)
        status = cli_calibration_write(ctx, scene, o->calibration, &o->render, &r.stats.calibration);
    if (status) return status;
    if (r.stats.nonfinite)
        fprintf(stderr, "lightcuts: warning: %llu pixels were not finite and were set to 0\n",
                (unsigned long long)r.stats.nonfinite);
    double t1 = cli_now();
    status = write_outputs(o, ctx, *image, r.stats.seconds, true);
    if (status) return status;
    cli_farm_close(&o->farm, true);
    r.isa = lc_isa_name(lc_context_isa(ctx));
    r.threads = lc_context_threads(ctx);
    r.seconds_write = cli_now() - t1;
    r.seconds_total = cli_now() - t0;
    return report(o, &r);
}

/* The frame at work; one that is there is left as it is, if asked. */
static int make_frame(options *o, lc_context *ctx, lc_scene *scene, lc_image **image, double t0)
{
    int status = cli_frames_set(&o->frames, scene);
    if (!status && o->frames.many) {
        o->farm.k = o->farm.n = 1;
        status = cli_render_check_distinct(o, scene);
        if (!status) status = cli_render_check_outputs(o);
        if (!status) status = cli_farm_crop(&o->farm, ctx, scene, &o->render);
        if (!status && already_done(o, ctx)) {
            if (!o->quiet) fprintf(stderr, "lightcuts: frame %u: already done\n", o->frames.frame);
            return 0;
        }
    }
    return status ? status : make_picture(o, ctx, scene, image, t0);
}

static int make_frames(options *o, lc_context *ctx, lc_scene **scene, lc_image **image)
{
    cli_frames *f = &o->frames;
    int status = 0;
    for (uint64_t i = f->first; i <= f->last && !status; i += f->step) {
        const double t0 = cli_now();
        f->frame = (uint32_t)i;
        if (cli_render_name_frame(o)) return CLI_USAGE;
        if (*scene && cli_frames_has_scenes(f, o->patterns.scene)) {
            lc_scene_destroy(*scene);
            *scene = NULL;
        }
        if (!*scene) status = load(o, ctx, scene);
        if (!status) status = make_frame(o, ctx, *scene, image, t0);
        lc_image_destroy(*image);
        *image = NULL;
        if (!status) f->n_done++;
        if (!status && cli_caught_signal() && i + f->step <= f->last) status = stopped(o);
    }
    if (status && f->n_done)
        fprintf(stderr, "lightcuts: frame %u is not written; those before it, %u, are\n", f->frame,
                f->n_done);
    if (!status && o->print_stats) cli_frames_print(stdout, f, *scene);
    return status;
}

/* again: not the first picture of --watch. */
static int run(options *o, lc_context *ctx, bool again, lc_scene **scene, lc_image **image)
{
    const double t0 = cli_now();
    int status = cli_frames_begin(&o->frames); /* the track may be outside of the sandbox */
    if (!status && o->load.sandbox && !again) status = enter_sandbox(o);
    if (status) return status;
    cli_catch_save_signals(o->farm.checkpoint != NULL);
    if (o->frames.many) return make_frames(o, ctx, scene, image);
    status = load(o, ctx, scene);
    if (status) return status == NOTHING_TO_DO ? 0 : status;
    return o->frames.given ? make_frame(o, ctx, *scene, image, t0) : make_picture(o, ctx, *scene, image, t0);
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
    static options o; /* not on the stack: it has many names */
    o = *j->given;
    lc_scene *scene = NULL;
    lc_image *image = NULL;
    if (again) o.farm.start = cli_now();
    if (o.watch) o.files = &j->files;
    const int status = run(&o, j->ctx, again, &scene, &image);
    cli_farm_close(&o.farm, false);
    cli_frames_end(&o.frames);
    lc_image_destroy(image);
    lc_scene_destroy(scene);
    return status;
}

int cmd_render(int argc, char **argv)
{
    static const options none = { .load = LC_LOAD_DESC_INIT,
                                  .render = LC_RENDER_DESC_INIT,
                                  .farm = CLI_FARM_INIT,
                                  .frames = { .views = LC_VIEWS_DESC_INIT } };
    static options o;
    o = none;
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
