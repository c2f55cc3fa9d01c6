/* fuzz_look.h - what fuzzers of scenes share: a scene that was parsed is committed and 8 x 8 pixels of it are
 * rendered, of which every number is finite. Scenes that would take long are left out. */
#ifndef FUZZ_LOOK_H
#define FUZZ_LOOK_H

#include "fuzz.h"
#include "pbrt/parse.h"
#include "prepare/commit.h"

#define LOOK_SIDE     8
#define LOOK_MAX_FILM 4096u /* pixels a side */

typedef struct {
    uint32_t max_tris, max_lights, n_reps, made_lights, indirect, spp; /* spp: 0 for the scene's, up to 2 */
    lc_method method;
    uint32_t aovs;
} look_options;

/* The middle of a large picture. */
static inline void look_crop(const lc_scene *scene, lc_render_desc *desc)
{
    const int32_t w = (int32_t)scene->film.width, h = (int32_t)scene->film.height;
    if (w <= LOOK_SIDE && h <= LOOK_SIDE) return;
    desc->crop[0] = w > LOOK_SIDE ? (w - LOOK_SIDE) / 2 : 0;
    desc->crop[1] = w > LOOK_SIDE ? desc->crop[0] + LOOK_SIDE : w;
    desc->crop[2] = h > LOOK_SIDE ? (h - LOOK_SIDE) / 2 : 0;
    desc->crop[3] = h > LOOK_SIDE ? desc->crop[2] + LOOK_SIDE : h;
}

/* A filter with negative parts may make pixels negative. */
static inline void look_at_picture(const lc_scene *scene, const lc_image *image)
{
    const bool may_be_negative = scene->film.filter.kind == LC_PIXEL_MITCHELL ||
                                 scene->film.filter.kind == LC_PIXEL_SINC;
    lc_image_desc size = LC_IMAGE_DESC_INIT;
    lc_image_get_desc(image, &size);
    for (uint32_t c = 0; c < lc_image_n_channels(image); c++) {
        const char *name = lc_image_channel_name(image, c);
        const float *p = lc_image_channel(image, name);
        bool colour = !name[1] && name[0] != 'Z'; /* distances may be infinite */
        for (uint32_t i = 0; i < size.width * size.height; i++)
            require(colour ? isfinite(p[i]) && (p[i] >= 0 || may_be_negative) : !isnan(p[i]), name);
    }
}

/* False if it was not rendered. */
static inline bool look(lc_context *ctx, lc_scene *scene, const look_options *o)
{
    lc_load_desc load = LC_LOAD_DESC_INIT;
    lc_render_desc desc = LC_RENDER_DESC_INIT;
    lc_image *image;
    load.area_lights = o->made_lights;
    load.env_lights = o->made_lights;
    load.n_reps = o->n_reps;
    load.indirect_lights = o->indirect;
    if (scene->n_tris > o->max_tris || scene->n_lights > o->max_lights || (!o->spp && scene->film.spp > 2) ||
        scene->film.width > LOOK_MAX_FILM || scene->film.height > LOOK_MAX_FILM)
        return false;
    if (scene->max_depth > 4) scene->max_depth = 4;
    if (lc_scene_commit(scene, &load)) return false;
    desc.method = o->method;
    desc.aovs = o->aovs;
    desc.spp = load.spp = o->spp;
    look_crop(scene, &desc);
    if (lc_render(ctx, scene, &desc, &image, NULL)) return false;
    look_at_picture(scene, image);
    lc_image_destroy(image);
    return true;
}

#endif
