/* frames.h - frames in a row: --frames, --frame, --track, --seed-per-frame.
 *
 *     names with the frame's number; a track of key frames (track.h); the scene stays between frames, unless
 *     its name has a number, too
 *
 * What a frame shows depends on its number, the scene and the whole track: not on which frames are rendered.
 */
#ifndef LC_CLI_FRAMES_H
#define LC_CLI_FRAMES_H

#include "cli/track.h"

#define CLI_MAX_NAME 4096 /* bytes of a frame's names, with the zero */

typedef struct cli_frames {
    bool given, many; /* --frame or --frames; --frames */
    uint32_t first, last, step;
    const char *path; /* of the track; NULL: none */
    bool seed_per_frame;
    cli_track track;
    lc_camera_place places[CLI_TRACK_VIEWS];
    lc_views_desc views;    /* of the load: what of the track lights are made for */
    uint32_t frame, n_done; /* the frame at work; those written, or there already */
    double start;
} cli_frames;

/* "7", "1-100", "1-100x5", "1-100:5"; 0 = ok. Frames are 1 or more. */
int cli_frames_parse(const char *text, cli_frames *f);
/* The name of a file in frame f->frame: that of a pattern, or as it is where it has no '%'. must: it has to
 * have a place for the number. 0, or after a usage error that begins with `what` -1. */
int cli_frames_name(const cli_frames *f, const char *what, const char *name, bool must,
                    char out[CLI_MAX_NAME]);
/* Whether the scene has a file for each frame. */
bool cli_frames_has_scenes(const cli_frames *f, const char *scene);
/* Reads the track. 0, or the exit status. */
int cli_frames_begin(cli_frames *f);
void cli_frames_end(cli_frames *f);
/* For lc_load_desc.parsed: what lights are made for. 0, or the exit status. */
int cli_frames_views(cli_frames *f, const lc_scene *scene);
/* Puts the scene into the state of the frame. 0, or the exit status. */
int cli_frames_set(const cli_frames *f, lc_scene *scene);
/* After the last: how many, and what was built for them. */
void cli_frames_print(FILE *out, const cli_frames *f, const lc_scene *scene);

#endif
