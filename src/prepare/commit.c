/* commit.c - the steps in order: BVH; all that follows from lights (lighting.c). */
#include "prepare/commit.h"

#include "base/memory.h"
#include "base/stats.h"
#include "prepare/lighting.h"
#include "scene/alpha.h"
#include "scene/instance.h"
#include "scene/media.h"
#include "scene/view.h"
#include "trace/bvh.h"

/* Makes the film one of this size. The crop is rounded outwards to whole pixels. */
static void resize_film(lc_film_desc *f, const uint32_t to[2])
{
    uint32_t *side[2] = { &f->width, &f->height };
    for (int i = 0; i < 2; i++) {
        const double scale = (double)to[i] / *side[i];
        f->crop[2 * i] = (uint32_t)floor(f->crop[2 * i] * scale);
        f->crop[2 * i + 1] = (uint32_t)fmin(ceil(f->crop[2 * i + 1] * scale), to[i]);
        *side[i] = to[i];
    }
}

/* Reduces the film to about max_pixels with the same view. */
static void shrink_film(lc_film_desc *f, uint64_t max_pixels)
{
    double all = (double)f->width * f->height, factor = sqrt((double)max_pixels / all);
    if (!max_pixels || factor >= 1) return;
    const uint32_t to[2] = { (uint32_t)fmax(floor(f->width * factor), 1),
                             (uint32_t)fmax(floor(f->height * factor), 1) };
    resize_film(f, to);
}

void lc_scene_size_film(lc_scene *s, const lc_load_desc *desc)
{
    if (s->sensors) return;
    if (desc->resolution[0]) resize_film(&s->film, desc->resolution);
    shrink_film(&s->film, desc->max_pixels);
}

/* The BVH of the world's own triangles, and what shadow rays and proofs read beside it. */
static lc_status build_world(lc_scene *s)
{
    const size_t n_world = s->n_objects ? s->objects[0].first_tri : s->n_tris;
    lc_status st = lc_alpha_init(s);
    if (!st) st = lc_bvh_build(s->ctx, s->pos, s->index, n_world, &s->bvh);
    if (st) return st;
    s->built.bvhs++;
    s->bvh->data.alpha = lc_scene_alpha_of(s, 0, n_world);
    s->bvh->has_glass = s->has_glass;
    const lc_occluders_desc occluders = { s->pos, s->index, n_world, s->alpha_bits };
    if ((st = lc_occluders_build(s->ctx, &occluders, &s->occluders))) return st;
    s->bvh->occluders = s->occluders;
    s->visibility = lc_bvh_visibility(s->bvh);
    return LC_OK;
}

lc_status lc_scene_commit(lc_scene *s, const lc_load_desc *desc)
{
    if (!s->has_camera && !s->sensors) return lc_fail(s->ctx, LC_ERR_PARSE, "the scene has no Camera");
    s->load = *desc;
    s->groups.now = 0;
    s->load.sensors = NULL; /* the host's, which may go */
    s->load.groups = NULL;
    s->load.views = NULL;
    s->own_camera = s->camera_desc;
    if (desc->views) {
        const lc_status st = lc_scene_set_views(s, desc->views);
        if (st) return st;
    }
    if (!s->sensors && !lc_camera_init(&s->camera, &s->camera_desc, s->film.width, s->film.height))
        return lc_fail(s->ctx, LC_ERR_PARSE, "camera out of range");
    const double t0 = lc_now();
    lc_memory_step(s->ctx, "the BVH");
    lc_status st = lc_scene_add_given_lights(s);
    if (!st && s->n_instances) st = lc_scene_join_lights(s); /* for the instances' boxes */
    if (!st) st = build_world(s);
    if (!st) st = lc_instances_build(s);
    if (!st) st = lc_media_commit(s);
    s->seconds_bvh = lc_now() - t0;
    if (!st) st = lc_profiles_finish(s->ctx, &s->profiles);
    return st ? st : lc_lighting_make(s, NULL);
}
