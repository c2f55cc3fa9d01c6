/* render_checks.c - the names of a render's files, and what is said of a scene before it. */
#include "cli/place.h"
#include "cli/render_options.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

int cli_render_name_frame(cli_render_options *o)
{
    const cli_frames *f = &o->frames;
    char(*name)[CLI_MAX_NAME] = o->names;
    int bad = 0;
    for (int i = 0; i < o->n_outputs && !bad; i++) {
        bad = cli_frames_name(f, "output", o->patterns.outputs[i], f->many, *name);
        o->outputs[i] = *name++;
    }
    if (o->patterns.stats_file && strcmp(o->patterns.stats_file, "-") && !bad) {
        bad = cli_frames_name(f, "statistics", o->patterns.stats_file, f->many, *name);
        o->stats_file = *name++;
    }
    if (cli_frames_has_scenes(f, o->patterns.scene) && !bad) {
        bad = cli_frames_name(f, "scene", o->patterns.scene, true, *name);
        o->scene = *name;
    }
    if (f->seed_per_frame) o->render.seed = f->frame;
    return bad;
}

/* Parts of a picture would choose errors of their own. */
int cli_render_check_time(const cli_render_options *o)
{
    const char *other = o->given.ratio                        ? "--error-ratio"
                        : o->render.error > 0                 ? "--error"
                        : o->calibration                      ? "--calibration"
                        : o->farm.chunk                       ? "--chunk"
                        : o->farm.print                       ? "--print-chunks"
                        : o->farm.checkpoint                  ? "--checkpoint"
                        : o->render.method == LC_METHOD_EXACT ? "--method exact"
                                                              : NULL;
    if (!(o->render.seconds > 0) || !other || o->preview) return 0;
    cli_usage_error("render", "--time chooses the error of the whole picture: not with %s", other);
    return -1;
}

/* What goes to standard output, and what of a part of a picture may be written. */
int cli_render_check_streams(const cli_render_options *o)
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
int cli_render_check_watch(const cli_render_options *o)
{
    const char *other = o->farm.chunk             ? "--chunk"
                        : o->farm.print           ? "--print-chunks"
                        : o->farm.checkpoint      ? "--checkpoint"
                        : o->calibration          ? "--calibration"
                        : o->frames.many          ? "--frames"
                        : o->frames.path          ? "--track"
                        : !strcmp(o->scene, "-")  ? "a scene from standard input"
                                                  : NULL;
    for (int i = 0; i < o->n_outputs && !other; i++)
        if (cli_is_stdout(o->outputs[i])) other = "a picture to standard output";
    if (!o->watch || !other) return 0;
    cli_usage_error("render", "--watch renders a scene each time that it changes: not with %s", other);
    return -1;
}

/* Frames are whole pictures, and their scene is set again after it was read. */
int cli_render_check_frames(cli_render_options *o)
{
    const char *other = o->farm.chunk            ? "--chunk"
                        : o->farm.print          ? "--print-chunks"
                        : o->farm.checkpoint     ? "--checkpoint"
                        : o->calibration         ? "--calibration"
                        : o->farm.time_limit > 0 ? "--time-limit"
                        : o->render.seconds > 0  ? "--time"
                                                 : NULL;
    if (!o->frames.given) {
        if (!o->frames.path && !o->frames.seed_per_frame) return 0;
        cli_usage_error("render", "%s needs --frames or --frame",
                        o->frames.path ? "--track" : "--seed-per-frame");
        return -1;
    }
    if (other && (o->frames.many || o->frames.path))
        cli_usage_error("render", "--frames and --track: not with %s", other);
    else if (o->frames.many && !o->n_outputs)
        cli_usage_error("render", "--frames needs -o, with a place for the number: -o frame.%%04d.exr");
    else {
        memcpy(o->patterns.outputs, o->outputs, sizeof o->outputs);
        o->patterns.scene = o->scene;
        o->patterns.stats_file = o->stats_file;
        o->frames.frame = o->frames.first;
        return cli_render_name_frame(o);
    }
    return -1;
}

/* The default output, in the current folder: the film's filename without its folder, so that a scene does not
 * choose what is overwritten elsewhere, with .exr in place of an extension that is neither .exr nor .png;
 * without a filename SCENE.exr, also of SCENE.pbrt.gz. */
void cli_render_choose_output(cli_render_options *o, const lc_scene_info *info)
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
const char *cli_render_stats_path(const cli_render_options *o)
{
    return o->stats_file && strcmp(o->stats_file, "-") ? o->stats_file : NULL;
}

/* Refuses files that would be written over each other, or over what the scene is read from. */
int cli_render_check_distinct(const cli_render_options *o, const lc_scene *scene)
{
    struct {
        const char *what, *path;
    } files[CLI_MAX_OUTPUTS + 3];
    int n = 0;
    for (; n < o->n_outputs; n++) files[n].what = "output", files[n].path = o->outputs[n];
    if (cli_render_stats_path(o)) files[n].what = "statistics", files[n++].path = o->stats_file;
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

int cli_render_check_outputs(const cli_render_options *o)
{
    for (int i = 0; i < o->n_outputs; i++)
        if (cli_check_writable(o->outputs[i])) return CLI_FAILED;
    return cli_render_stats_path(o) ? cli_check_writable(o->stats_file) : 0;
}

void cli_render_warn_channels(const cli_render_options *o)
{
    const char *what = o->load.n_groups ? "the light groups of --group"
                       : o->render.aovs ? "the channels of --aov"
                                        : NULL;
    for (int i = 0; i < o->n_outputs; i++)
        if (!cli_has_extension(o->outputs[i], ".png")) return;
    if (what)
        fprintf(stderr, "lightcuts: warning: %s are in no PNG: write -o FILE.exr as well\n", what);
}
