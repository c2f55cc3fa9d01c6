/* lighting.c - see lighting.h. */
#include "prepare/lighting.h"

#include "base/memory.h"
#include "base/stats.h"
#include "prepare/area_light.h"
#include "prepare/env_light.h"
#include "prepare/lamp_find.h"
#include "prepare/lamp_lights.h"
#include "prepare/vpl.h"
#include "scene/near_bounce.h"
#include "scene/view.h"
#include "tree/light_tree.h"

#define SWAP(type, field)                                                                                    \
    do {                                                                                                     \
        const type swapped = s->field;                                                                       \
        s->field = l->field;                                                                                 \
        l->field = swapped;                                                                                  \
    } while (0)

void lc_lighting_exchange(lc_scene *s, lc_lighting *l)
{
    lc_light *lights = s->lights;
    lc_light_tree *tree = s->tree;
    lc_near_places *near_places = s->near_places;
    s->lights = l->lights;
    s->tree = l->tree;
    s->near_places = l->near_places;
    l->lights = lights;
    l->tree = tree;
    l->near_places = near_places;
    SWAP(size_t, n_lights);
    SWAP(size_t, cap_lights);
    SWAP(size_t, n_given);
    SWAP(uint64_t, n_emissive_tris);
    SWAP(uint64_t, n_area_lights);
    SWAP(uint64_t, n_env_lights);
    SWAP(uint64_t, n_env_tried);
    SWAP(bool, follows_smooth);
    SWAP(lc_indirect, indirect);
    SWAP(lc_lamp_error, lamp_error);
    SWAP(lc_sky_error, sky_error);
    SWAP(lc_lamps, lamps);
    SWAP(lc_light_places, virtuals);
    SWAP(double, diag2);
    SWAP(float, min_d2);
}

void lc_lighting_free(const lc_context *ctx, lc_lighting *l)
{
    lc_light_tree_destroy(l->tree);
    lc_light_places_free(&l->virtuals, ctx);
    lc_near_places_free(ctx, l->near_places);
    lc_free(ctx, l->lights, l->cap_lights, sizeof *l->lights);
    *l = (lc_lighting){ .lights = NULL };
}

static uint32_t depth_of(const lc_scene *s) { return s->load.max_depth ? s->load.max_depth : s->max_depth; }

static bool has_lamps(const lc_scene *s)
{
    for (size_t i = 0; i < s->n_meshes; i++)
        if (lc_mesh_is_lamp(&s->meshes[i])) return true;
    return false;
}

bool lc_lighting_has_made(const lc_scene *s) { return s->n_envs || has_lamps(s); }

bool lc_lighting_sees(const lc_scene *s) { return s->n_envs || (!s->load.area_lights && has_lamps(s)); }

bool lc_lighting_is_indirect(const lc_scene *s)
{
    const uint32_t n = s->load.indirect_lights;
    return n != LC_NO_LIGHTS && (n || s->traces_paths);
}

double lc_lighting_diag2(const lc_scene *s)
{
    lc_box box = s->bounds;
    for (size_t i = 0; i < s->n_lights - s->indirect.n_lights; i++)
        if (!lc_is_far(s->lights[i].kind)) lc_box_add(&box, s->lights[i].pos);
    double x = (double)box.hi.x - box.lo.x, y = (double)box.hi.y - box.lo.y, z = (double)box.hi.z - box.lo.z;
    return x >= 0 ? x * x + y * y + z * z : 0;
}

void lc_lighting_set_diag2(lc_scene *s, double diag2)
{
    s->diag2 = diag2;
    s->min_d2 = (float)fmax(LC_FLOOR_OF_DIAG2 * diag2, LC_MIN_D2);
    lc_camera_set_distance(&s->camera, sqrt(diag2));
    for (uint32_t i = 0; i < s->n_views; i++) lc_camera_set_distance(&s->views[i], sqrt(diag2));
}

/* Lights of lamps and environments. */
static lc_status make_of_surfaces(lc_scene *s)
{
    const lc_load_desc *desc = &s->load;
    lc_status st;
    if (desc->area_lights) st = lc_area_lights_make(s, desc->area_lights, desc->seed);
    else st = lc_lamp_lights_make(s, depth_of(s), desc->seed);
    const size_t n_before = s->n_lights;
    s->n_area_lights = n_before - s->n_given;
    if (!st) st = lc_env_lights_make(s, desc->env_lights, depth_of(s), desc->seed);
    s->n_env_lights = s->n_lights - n_before;
    if (!st) st = lc_scene_join_lights(s);
    if (!st) lc_lamps_find(s, s->n_given, n_before);
    if (!st && lc_lighting_has_made(s)) s->built.lights++;
    return st;
}

/* The same, from another lighting. */
static lc_status keep_made(lc_scene *s, const lc_lighting *kept)
{
    const size_t end = kept->n_given + kept->n_area_lights + kept->n_env_lights;
    lc_status st = LC_OK;
    for (size_t i = kept->n_given; i < end && !st; i++)
        st = lc_scene_add_light(s, (lc_pos){ 0, 0, 0 }, &kept->lights[i]);
    s->n_area_lights = kept->n_area_lights;
    s->n_env_lights = kept->n_env_lights;
    s->n_env_tried = kept->n_env_tried;
    s->n_emissive_tris = kept->n_emissive_tris;
    s->lamp_error = kept->lamp_error;
    s->sky_error = kept->sky_error;
    s->lamps = kept->lamps;
    return st ? st : lc_scene_join_lights(s);
}

static lc_status make_indirect(lc_scene *s)
{
    const lc_load_desc *desc = &s->load;
    const lc_vpl_desc vpl = { .n_lights = desc->indirect_lights,
                              .deviation = desc->indirect_error,
                              .max_depth = depth_of(s),
                              .from_view = desc->indirect_from == LC_INDIRECT_FROM_VIEW,
                              .n_given = s->n_given,
                              .seed = desc->seed };
    if (!lc_lighting_is_indirect(s)) return LC_OK;
    const lc_status st = lc_vpl_make(s, &vpl);
    if (!st) s->built.indirect++;
    return st;
}

lc_status lc_lighting_build_tree(lc_scene *s, lc_light_tree **tree)
{
    const double t0 = lc_now();
    lc_memory_step(s->ctx, "the light tree");
    const lc_light_tree_desc desc = { .lights = s->lights,
                                      .n_lights = s->n_lights,
                                      .spot_maps = s->spot_maps,
                                      .profiles = &s->profiles,
                                      .diag2 = s->diag2,
                                      .seed = s->load.seed,
                                      .n_reps = s->load.n_reps,
                                      .builder = s->load.builder,
                                      .n_groups = s->groups.n };
    const lc_status st = lc_light_tree_build(s->ctx, &desc, tree);
    s->seconds_tree += lc_now() - t0;
    if (!st) s->built.trees++;
    return st;
}

lc_status lc_lighting_make(lc_scene *s, const lc_lighting *kept)
{
    const double t0 = lc_now();
    lc_memory_step(s->ctx, "making lights");
    s->n_given = s->n_lights;
    lc_views_init(s);
    lc_status st = kept ? keep_made(s, kept) : make_of_surfaces(s);
    lc_lighting_set_diag2(s, lc_lighting_diag2(s));
    if (!st) st = make_indirect(s);
    if (st) return st;
    s->follows_smooth = !s->n_given || s->indirect.n_lights;
    s->seconds_lights += lc_now() - t0;
    return lc_lighting_build_tree(s, &s->tree);
}
