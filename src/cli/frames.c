/* frames.c - see frames.h. */
#include "cli/frames.h"

#include "cli/progress.h"

#include <string.h>
#include <unistd.h>

#define MAX_FRAME 99999999

int cli_frames_parse(const char *text, cli_frames *f)
{
    char number[12];
    uint32_t *const to[3] = { &f->first, &f->last, &f->step };
    f->step = 1;
    for (int i = 0; i < 3; i++) {
        const size_t len = strspn(text, "0123456789");
        if (!len || len >= sizeof number) return -1;
        memcpy(number, text, len);
        number[len] = 0;
        if (cli_parse_u32(number, 1, MAX_FRAME, to[i])) return -1;
        if (!i) f->last = f->first;
        text += len;
        if (!*text) return f->first <= f->last ? 0 : -1;
        if (i == 0 ? *text != '-' : *text != 'x' && *text != ':') return -1;
        text++;
    }
    return -1;
}

int cli_frames_name(const cli_frames *f, const char *what, const char *name, bool must,
                    char out[CLI_MAX_NAME])
{
    const size_t n = lc_frame_name(name, f->frame, out, CLI_MAX_NAME);
    if (n && n < CLI_MAX_NAME) return 0;
    if (!n && !must && !strchr(name, '%')) {
        if (strlen(name) < CLI_MAX_NAME) {
            memcpy(out, name, strlen(name) + 1);
            return 0;
        }
    }
    cli_usage_error("render", "%s '%s': a frame's name needs one place for its number, such as %%04d", what,
                    name);
    return -1;
}

bool cli_frames_has_scenes(const cli_frames *f, const char *scene)
{
    char name[CLI_MAX_NAME];
    const size_t n = lc_frame_name(scene, f->frame, name, sizeof name);
    return f->given && n && n < sizeof name && access(scene, F_OK);
}

int cli_frames_begin(cli_frames *f)
{
    f->start = cli_now();
    return f->path ? cli_track_read(f->path, &f->track) : 0;
}

void cli_frames_end(cli_frames *f) { cli_track_free(&f->track); }

int cli_frames_views(cli_frames *f, const lc_scene *scene)
{
    double frames[CLI_TRACK_VIEWS];
    f->views = (lc_views_desc)LC_VIEWS_DESC_INIT;
    if (!f->path || !cli_track_has_camera(&f->track)) return 0;
    f->track.own = (lc_camera_place)LC_CAMERA_PLACE_INIT;
    if (lc_scene_get_camera(scene, &f->track.own)) return CLI_INPUT;
    const uint32_t n = cli_track_moments(&f->track, frames);
    for (uint32_t i = 0; i < n; i++)
        if (!cli_track_place(&f->track, frames[i], &f->places[i])) return CLI_INPUT;
    f->views.places = f->places;
    f->views.n = n;
    return 0;
}

int cli_frames_set(const cli_frames *f, lc_scene *scene)
{
    int status = f->path ? cli_track_set(&f->track, scene, f->frame) : 0;
    lc_status st = status ? LC_OK : lc_scene_set_frame(scene, f->frame);
    if (!st && !status) st = lc_scene_update(scene, NULL);
    if (status) return status;
    return st == LC_ERR_IO || st == LC_ERR_ARG ? CLI_INPUT : st ? cli_exit_status(st) : 0;
}

void cli_frames_print(FILE *out, const cli_frames *f, const lc_scene *scene)
{
    lc_scene_info i = LC_SCENE_INFO_INIT;
    lc_scene_get_info(scene, &i);
    fprintf(out,
            "frames           %u in %.2f s; built of the last scene: %u BVHs, %u over instances, lights %u "
            "times,\n                 virtual lights %u, light trees %u; %u pictures read\n",
            f->n_done, cli_now() - f->start, i.built_bvhs, i.built_tops, i.built_lights, i.built_indirect,
            i.built_trees, i.built_images);
}
