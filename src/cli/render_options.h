/* render_options.h - what `lightcuts render` was asked for, and what of it is checked before the work. */
#ifndef LC_CLI_RENDER_OPTIONS_H
#define LC_CLI_RENDER_OPTIONS_H

#include "cli/cli.h"
#include "cli/display.h"
#include "cli/farm.h"
#include "cli/frames.h"
#include "cli/light_groups.h"
#include "cli/tone.h"
#include "cli/watch.h"

#define CLI_MAX_OUTPUTS 16

typedef struct cli_render_options {
    const char *scene, *outputs[CLI_MAX_OUTPUTS], *stats_file;
    struct {
        const char *scene, *outputs[CLI_MAX_OUTPUTS], *stats_file;
    } patterns; /* of frames: what the names above are made of */
    char names[CLI_MAX_OUTPUTS + 2][CLI_MAX_NAME];
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
    cli_frames frames;
    cli_tone tone;
    cli_server server;    /* n 0: none */
    cli_display *display; /* NULL: none */
    bool preview;
    double preview_interval; /* seconds; 0: not given */
    bool watch;
    cli_watch *files; /* NULL: they are not watched */
    cli_groups groups;
} cli_render_options;

/* Sets the names of the frame at work; those of --frames must have its number. Nonzero after a usage
 * error. */
int cli_render_name_frame(cli_render_options *o);
/* Whether the options of frames fit with the others, and the names of the first. Nonzero after a usage
 * error. */
int cli_render_check_frames(cli_render_options *o);
/* Whether --watch fits with the others. Nonzero after a usage error. */
int cli_render_check_watch(const cli_render_options *o);
/* Whether --time fits with the others, and what goes to standard output. Nonzero after a usage error. */
int cli_render_check_time(const cli_render_options *o);
int cli_render_check_streams(const cli_render_options *o);
/* Adds the default output, where none was given. */
void cli_render_choose_output(cli_render_options *o, const lc_scene_info *info);
/* The file of the statistics, if they go to one. */
const char *cli_render_stats_path(const cli_render_options *o);
/* Refuses files that would be written over each other, or over what the scene is read from. 0, or the exit
 * status. */
int cli_render_check_distinct(const cli_render_options *o, const lc_scene *scene);
/* Whether all files can be written. 0, or the exit status. */
int cli_render_check_outputs(const cli_render_options *o);
/* Says that channels or groups were asked for and no file has them. */
void cli_render_warn_channels(const cli_render_options *o);
#endif
