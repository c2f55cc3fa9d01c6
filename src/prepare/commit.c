/* commit.c - the steps in order: BVH; lights from surfaces, environments and light paths; light tree. */
#include "prepare/commit.h"

#include "base/memory.h"
#include "base/stats.h"
#include "prepare/area_light.h"
#include "prepare/env_light.h"
#include "prepare/lamp_find.h"
#include "prepare/lamp_lights.h"
#include "prepare/vpl.h"
#include "scene/alpha.h"
#include "scene/instance.h"
#include "trace/bvh.h"
#include "tree/light_tree.h"

/* The squared diagonal of the box around triangles and lights. */
static double scene_diag2(const lc_scene *s)
{
    lc_box box = s->bounds;
    for (size_t i = 0; i < s->n_lights; i++)
        if (!lc_is_far(s->lights[i].kind)) lc_box_add(&box, s->lights[i].pos);
    double x = (double)box.hi.x - box.lo.x, y = (double)box.hi.y - box.lo.y, z = (double)box.hi.z - box.lo.z;
    return x >= 0 ? x * x + y * y + z * z : 0;
}

/* Reduces the film to about max_pixels with the same view. The crop is rounded outwards to whole pixels. */
static void shrink_film(lc_film_desc *f, uint64_t max_pixels)
{
    double all = (double)f->width * f->height, factor = sqrt((double)max_pixels / all);
    if (!max_pixels || factor >= 1) return;
    uint32_t *side[2] = { &f->width, &f->height };
    for (int i = 0; i < 2; i++) {
        double size = fmax(floor(*side[i] * factor), 1), scale = size / *side[i];
        f->crop[2 * i] = (uint32_t)floor(f->crop[2 * i] * scale);
        f->crop[2 * i + 1] = (uint32_t)fmin(ceil(f->crop[2 * i + 1] * scale), size);
        *side[i] = (uint32_t)size;
    }
}

static uint32_t depth_of(const lc_scene *s, const lc_load_desc *desc)
{
    return desc->max_depth ? desc->max_depth : s->max_depth;
}

/* Virtual lights, if there are any. */
static lc_status make_indirect(lc_scene *s, const lc_load_desc *desc, size_t n_given)
{
    const lc_vpl_desc vpl = { .n_lights = desc->indirect_lights,
                              .deviation = desc->indirect_error,
                              .max_depth = depth_of(s, desc),
                              .from_view = desc->indirect_from == LC_INDIRECT_FROM_VIEW,
                              .n_given = n_given,
                              .seed = desc->seed };
    if (desc->indirect_lights == LC_NO_LIGHTS || (!desc->indirect_lights && !s->traces_paths)) return LC_OK;
    return lc_vpl_make(s, &vpl);
}

lc_status lc_scene_commit(lc_scene *s, const lc_load_desc *desc)
{
    if (!s->has_camera && !s->sensors) return lc_fail(s->ctx, LC_ERR_PARSE, "the scene has no Camera");
    if (!s->sensors) shrink_film(&s->film, desc->max_pixels);
    if (!s->sensors && !lc_camera_init(&s->camera, &s->camera_desc, s->film.width, s->film.height))
        return lc_fail(s->ctx, LC_ERR_PARSE, "camera out of range");
    double t0 = lc_now();
    lc_memory_step(s->ctx, "the BVH");
    size_t n_world = s->n_objects ? s->objects[0].first_tri : s->n_tris;
    lc_status st = lc_alpha_init(s);
    if (!st) st = lc_bvh_build(s->ctx, s->pos, s->index, n_world, &s->bvh);
    if (st) return st;
    s->bvh->data.alpha = lc_scene_alpha_of(s, 0, n_world);
    s->bvh->has_glass = s->has_glass;
    const lc_occluders_desc occluders = { s->pos, s->index, n_world, s->alpha_bits };
    if ((st = lc_occluders_build(s->ctx, &occluders, &s->occluders))) return st;
    s->bvh->occluders = s->occluders;
    s->visibility = lc_bvh_visibility(s->bvh);
    if ((st = lc_instances_build(s))) return st;
    double t1 = lc_now();
    s->seconds_bvh = t1 - t0;
    lc_memory_step(s->ctx, "making lights");
    if ((st = lc_profiles_finish(s->ctx, &s->profiles))) return st;
    bool all_seen = !s->n_lights;
    const size_t n_given = s->n_lights;
    if (desc->area_lights) st = lc_area_lights_make(s, desc->area_lights, desc->seed);
    else st = lc_lamp_lights_make(s, depth_of(s, desc), desc->seed);
    const size_t n_before = s->n_lights;
    s->n_area_lights = n_before - n_given;
    if (!st) st = lc_env_lights_make(s, desc->env_lights, depth_of(s, desc), desc->seed);
    s->n_env_lights = s->n_lights - n_before;
    if (!st) st = lc_scene_join_lights(s);
    if (!st) lc_lamps_find(s, n_given, n_before);
    s->diag2 = scene_diag2(s);
    lc_camera_set_distance(&s->camera, sqrt(s->diag2));
    s->min_d2 = (float)fmax(LC_FLOOR_OF_DIAG2 * s->diag2, LC_MIN_D2);
    if (!st) st = make_indirect(s, desc, n_given);
    if (st) return st;
    s->follows_smooth = all_seen || s->indirect.n_lights;
    double t2 = lc_now();
    s->seconds_lights = t2 - t1;
    lc_memory_step(s->ctx, "the light tree");
    lc_light_tree_desc tree_desc = { .lights = s->lights,
                                     .n_lights = s->n_lights,
                                     .spot_maps = s->spot_maps,
                                     .profiles = &s->profiles,
                                     .diag2 = s->diag2,
                                     .seed = desc->seed,
                                     .n_reps = desc->n_reps,
                                     .builder = desc->builder };
    st = lc_light_tree_build(s->ctx, &tree_desc, &s->tree);
    s->seconds_tree = lc_now() - t2;
    return st;
}
