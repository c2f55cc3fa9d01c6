/* update.c - public calls that set something again in a committed scene. */
#include "prepare/update.h"

#include "base/desc.h"
#include "base/rng.h"
#include "build/build.h"
#include "scene/group_names.h"
#include "scene/sequence.h"
#include "scene/view.h"

#define MAX_TURN 1e6 /* degrees */

static lc_xform place_of(const lc_instance *i)
{
    lc_xform x = lc_xform_identity();
    memcpy(x.m, i->to_world, sizeof i->to_world);
    return x;
}

/* A scene that can be changed. */
static lc_status check(const lc_scene *s, const char *call)
{
    if (!s) return LC_ERR_ARG;
    if (s->tree) return LC_OK;
    return lc_fail(s->ctx, LC_ERR_ARG, "%s: the scene was not committed", call);
}

/* The scene's number of what a host calls number `at` of n; LC_NONE: it is left out. */
static lc_status find(const lc_scene *s, const char *call, const char *what, const uint32_t *numbers,
                      size_t n, uint32_t *at)
{
    if (*at >= n) return lc_fail(s->ctx, LC_ERR_ARG, "%s: %s %u of %zu", call, what, *at, n);
    if (numbers) *at = numbers[*at];
    return LC_OK;
}

/* Lights of files are kept apart from the first time that one is set. */
static lc_status find_light(lc_scene *s, const char *call, uint32_t at)
{
    lc_given *g = &s->given;
    const size_t n = s->by_calls || g->n_lights ? g->n_lights : s->n_given;
    if (at >= n) return lc_fail(s->ctx, LC_ERR_ARG, "%s: light %u of %zu", call, at, n);
    if (g->n_lights) return LC_OK;
    const lc_status st = lc_grow(s->ctx, (void **)&g->lights, &g->cap_lights, n, sizeof *g->lights);
    if (st) return st;
    memcpy(g->lights, s->lights, n * sizeof *g->lights);
    g->n_lights = n;
    return LC_OK;
}

/* The same, before a light is dimmed or moved: what it was until then is kept. */
static lc_status find_own(lc_scene *s, const char *call, uint32_t at)
{
    lc_given *g = &s->given;
    lc_status st = find_light(s, call, at);
    if (st || g->n_own) return st;
    st = lc_grow(s->ctx, (void **)&g->own, &g->cap_own, g->n_lights, sizeof *g->own);
    if (st) return st;
    memcpy(g->own, g->lights, g->n_lights * sizeof *g->own);
    g->n_own = g->n_lights;
    return LC_OK;
}

static lc_status check_factor(const lc_scene *s, const char *call, const float factor[3])
{
    for (int k = 0; k < 3; k++)
        if (!factor || !(factor[k] >= 0 && isfinite(factor[k])))
            return lc_fail(s->ctx, LC_ERR_ARG, "%s: factor is NULL, negative or not finite", call);
    return LC_OK;
}

lc_status lc_scene_move_camera(lc_scene *s, const lc_camera_place *place)
{
    static const char call[] = "lc_scene_move_camera";
    lc_change c = { .kind = LC_CHANGE_CAMERA };
    lc_camera_place p = LC_CAMERA_PLACE_INIT;
    lc_status st = check(s, call);
    if (!st && s->sensors)
        st = lc_fail(s->ctx, LC_ERR_ARG, "%s: the scene has sensors in place of a camera", call);
    if (!st && !place) st = lc_fail(s->ctx, LC_ERR_ARG, "%s: place is NULL", call);
    if (!st) st = lc_desc_take(s->ctx, "lc_camera_place", &p, sizeof p, place);
    if (st) return st;
    st = lc_scene_place_camera(s, call, &s->own_camera, &p, &c.camera);
    return st ? st : lc_scene_change(s, &c);
}

lc_status lc_scene_get_camera(const lc_scene *s, lc_camera_place *place)
{
    lc_camera_place p = LC_CAMERA_PLACE_INIT;
    if (!s) return LC_ERR_ARG;
    if (!place) return lc_fail(s->ctx, LC_ERR_ARG, "lc_scene_get_camera: place is NULL");
    if (s->sensors || !s->has_camera || !lc_camera_get_place(&s->camera_desc, &p))
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_scene_get_camera: the scene has no camera");
    return lc_desc_give(s->ctx, "lc_camera_place", place, &p, sizeof p);
}

lc_status lc_scene_set_camera(lc_scene *s, const lc_build_camera_desc *desc)
{
    lc_change c = { .kind = LC_CHANGE_CAMERA };
    lc_status st = check(s, "lc_scene_set_camera");
    if (!st && s->sensors)
        st = lc_fail(s->ctx, LC_ERR_ARG, "lc_scene_set_camera: the scene has sensors in place of a camera");
    if (!st) st = lc_arg_camera(s, "lc_scene_set_camera", desc, &c.camera);
    if (!st) st = lc_scene_change(s, &c);
    if (!st) s->own_camera = c.camera;
    return st;
}

/* The group of a light that is set; had: that of the light before. */
static lc_status find_group(const lc_scene *s, const lc_build_light_desc *desc, uint32_t had, uint32_t *group)
{
    lc_build_light_desc d = LC_BUILD_LIGHT_DESC_INIT;
    const lc_status st = lc_desc_take(s->ctx, "lc_build_light_desc", &d, sizeof d, desc);
    *group = had;
    if (st || !d.group) return st;
    *group = lc_group_find(s, d.group);
    if (*group != LC_NONE) return LC_OK;
    return lc_fail(s->ctx, LC_ERR_ARG, "lc_scene_set_light: group is none of the scene's");
}

lc_status lc_scene_set_light(lc_scene *s, uint32_t light, const lc_build_light_desc *desc)
{
    lc_light set;
    lc_status st = check(s, "lc_scene_set_light");
    if (!st) st = lc_arg_light(s, "lc_scene_set_light", desc, &set);
    if (!st) st = find_light(s, "lc_scene_set_light", light);
    if (!st) st = find_group(s, desc, s->given.lights[light].group, &set.group);
    if (st) return st;
    s->given.lights[light] = set;
    if (s->given.n_own) s->given.own[light] = set;
    s->changes.lights = true;
    return LC_OK;
}

lc_status lc_scene_dim_light(lc_scene *s, uint32_t light, const float factor[3])
{
    static const char call[] = "lc_scene_dim_light";
    lc_status st = check(s, call);
    if (!st) st = find_own(s, call, light);
    if (!st) st = check_factor(s, call, factor);
    if (st) return st;
    lc_light *l = &s->given.lights[light], dim = *l;
    dim.intensity = lc_f3_mul(s->given.own[light].intensity, lc_f3_load(factor));
    if ((st = lc_as_arg(lc_scene_check_light(s, LC_BY_CALL, &dim, l)))) return st;
    s->changes.lights = true;
    return LC_OK;
}

lc_status lc_scene_move_light(lc_scene *s, uint32_t light, const float position[3])
{
    static const char call[] = "lc_scene_move_light";
    lc_status st = check(s, call);
    if (!st) st = find_own(s, call, light);
    if (!st && !position) st = lc_fail(s->ctx, LC_ERR_ARG, "%s: position is NULL", call);
    if (st) return st;
    lc_light *l = &s->given.lights[light], moved = *l;
    if (lc_is_far(l->kind)) return lc_fail(s->ctx, LC_ERR_ARG, "%s: light %u is far away", call, light);
    moved.pos = lc_f3_load(position);
    if ((st = lc_as_arg(lc_scene_check_light(s, LC_BY_CALL, &moved, l)))) return st;
    s->changes.lights = true;
    return LC_OK;
}

lc_status lc_scene_shift_light(lc_scene *s, uint32_t light, const float offset[3])
{
    static const char call[] = "lc_scene_shift_light";
    float to[3];
    lc_status st = check(s, call);
    if (!st) st = find_own(s, call, light);
    if (!st && !offset) st = lc_fail(s->ctx, LC_ERR_ARG, "%s: offset is NULL", call);
    if (st) return st;
    lc_f3_store(to, lc_f3_add(s->given.own[light].pos, lc_f3_load(offset)));
    return lc_scene_move_light(s, light, to);
}

/* Keeps where all instances are before the first is moved, those that wait included. */
static lc_status keep_places(lc_scene *s)
{
    lc_given *g = &s->given;
    if (g->n_places == s->n_instances) return LC_OK;
    const lc_status st = lc_grow(s->ctx, (void **)&g->places, &g->cap_places, s->n_instances,
                                 sizeof *g->places);
    if (st) return st;
    for (size_t i = 0; i < s->n_instances; i++) g->places[i] = place_of(&s->instances[i]);
    for (size_t i = 0; i < s->changes.n; i++) {
        const lc_change *c = &s->changes.list[i];
        if (c->kind == LC_CHANGE_INSTANCE) g->places[c->at] = place_of(&c->instance);
    }
    g->n_places = s->n_instances;
    return LC_OK;
}

/* The scene's number of an instance; LC_NONE: it was empty and left out. */
static lc_status find_instance(const lc_scene *s, const char *call, uint32_t *at)
{
    const lc_given *g = &s->given;
    return find(s, call, "instance", g->instances, s->by_calls ? g->n_instances : s->n_instances, at);
}

static lc_status change_instance(lc_scene *s, uint32_t at, const lc_xform *x)
{
    lc_change c = { .kind = LC_CHANGE_INSTANCE, .at = at };
    const lc_status st = lc_as_arg(
        lc_scene_make_instance(s, LC_BY_CALL, s->instances[at].object, x, &c.instance));
    return st ? st : lc_scene_change(s, &c);
}

lc_status lc_scene_move_instance(lc_scene *s, uint32_t instance, const double offset[3], const double turn[3])
{
    static const char call[] = "lc_scene_move_instance";
    static const double axes[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    lc_status st = check(s, call);
    if (!st) st = find_instance(s, call, &instance);
    if (!st && (!offset || !turn)) st = lc_fail(s->ctx, LC_ERR_ARG, "%s: offset or turn is NULL", call);
    for (int k = 0; k < 3 && !st; k++)
        if (!isfinite(offset[k]) || !(fabs(turn[k]) <= MAX_TURN))
            st = lc_fail(s->ctx, LC_ERR_ARG, "%s: offset or turn is out of range", call);
    if (st || instance == LC_NONE) return st;
    if ((st = keep_places(s))) return st;
    lc_xform x = s->given.places[instance];
    const double origin[3] = { x.m[3], x.m[7], x.m[11] };
    x.m[3] = x.m[7] = x.m[11] = 0;
    for (int k = 0; k < 3; k++) {
        lc_xform rotate;
        if (fabs(turn[k]) > 0 && lc_xform_rotate(turn[k], axes[k], &rotate)) x = lc_xform_mul(&rotate, &x);
    }
    for (int k = 0; k < 3; k++) x.m[4 * k + 3] = origin[k] + offset[k];
    return change_instance(s, instance, &x);
}

lc_status lc_scene_set_instance(lc_scene *s, uint32_t instance, const double to_world[16])
{
    static const char call[] = "lc_scene_set_instance";
    lc_xform x;
    lc_status st = check(s, call);
    if (!st) st = find_instance(s, call, &instance);
    if (!st) st = lc_arg_to_world(s, call, to_world, &x);
    if (st || instance == LC_NONE) return st;
    if (!(st = change_instance(s, instance, &x)) && s->given.n_places) s->given.places[instance] = x;
    return st;
}

/* The scene's number of a mesh. */
static lc_status find_mesh(const lc_scene *s, const char *call, uint32_t *at)
{
    const lc_given *g = &s->given;
    const lc_status st = check(s, call);
    return st ? st : find(s, call, "mesh", g->meshes, s->by_calls ? g->n_meshes : s->n_meshes, at);
}

/* Exchanges the emission of mesh c->at, once it is the scene's number. */
static lc_status change_emission(lc_scene *s, const char *call, const lc_change *c)
{
    const lc_mesh *m = &s->meshes[c->at];
    const bool of_object = s->n_objects && m->first_tri >= s->objects[0].first_tri && !m->n_places;
    if (of_object && lc_f3_max(c->emission) > 0)
        return lc_fail(s->ctx, LC_ERR_ARG, "%s: emission: a mesh of an object must not emit", call);
    return lc_scene_change(s, c);
}

lc_status lc_scene_set_emission(lc_scene *s, uint32_t mesh, const float emission[3])
{
    static const char call[] = "lc_scene_set_emission";
    lc_change c = { .kind = LC_CHANGE_EMISSION, .at = mesh };
    lc_status st = find_mesh(s, call, &c.at);
    if (st) return st;
    for (int k = 0; k < 3; k++)
        if (!emission || !(emission[k] >= 0 && emission[k] <= LC_MAX_INTENSITY))
            return lc_fail(s->ctx, LC_ERR_ARG, "%s: emission is NULL, negative, not finite or above %g", call,
                           (double)LC_MAX_INTENSITY);
    c.emission = lc_f3_load(emission);
    if (c.at == LC_NONE) return LC_OK;
    if (!(st = change_emission(s, call, &c))) s->meshes[c.at].own_emission = c.emission;
    return st;
}

lc_status lc_scene_dim_emission(lc_scene *s, uint32_t mesh, const float factor[3])
{
    static const char call[] = "lc_scene_dim_emission";
    lc_change c = { .kind = LC_CHANGE_EMISSION, .at = mesh };
    lc_status st = find_mesh(s, call, &c.at);
    if (!st) st = check_factor(s, call, factor);
    if (st || c.at == LC_NONE) return st;
    c.emission = lc_f3_mul(s->meshes[c.at].own_emission, lc_f3_load(factor));
    if (!(lc_f3_max(c.emission) <= LC_MAX_INTENSITY))
        return lc_fail(s->ctx, LC_ERR_ARG, "%s: the emission is above %g", call, (double)LC_MAX_INTENSITY);
    return change_emission(s, call, &c);
}

lc_status lc_scene_dim_environment(lc_scene *s, uint32_t environment, const float factor[3])
{
    static const char call[] = "lc_scene_dim_environment";
    lc_change c = { .kind = LC_CHANGE_ENVIRONMENT, .at = environment };
    lc_status st = check(s, call);
    if (!st) st = find(s, call, "environment", NULL, s->n_envs, &c.at);
    if (!st) st = check_factor(s, call, factor);
    if (st) return st;
    lc_env env = s->envs[c.at];
    env.scale = c.scale = lc_f3_mul(env.own_scale, lc_f3_load(factor));
    const bool brighter = lc_f3_max(lc_f3_load(factor)) > 1;
    if (!(lc_f3_max(c.scale) <= LC_MAX_INTENSITY) || (brighter && lc_env_peak(&env) > LC_MAX_ENV_RADIANCE))
        return lc_fail(s->ctx, LC_ERR_ARG, "%s: the radiance is above %g", call, LC_MAX_ENV_RADIANCE);
    return lc_scene_change(s, &c);
}

lc_status lc_scene_set_frame(lc_scene *s, uint32_t frame)
{
    lc_status st = check(s, "lc_scene_set_frame");
    if (!st && !frame) st = lc_fail(s->ctx, LC_ERR_ARG, "lc_scene_set_frame: frames are 1 or more");
    return st ? st : lc_scene_read_frame(s, frame);
}

static bool is_stale(const lc_scene *s) { return s->stale.made || s->stale.indirect; }

lc_status lc_scene_update(lc_scene *s, const lc_update_desc *desc)
{
    lc_update_desc d = LC_UPDATE_DESC_INIT;
    lc_status st = check(s, "lc_scene_update");
    if (!st && desc) st = lc_desc_take(s->ctx, "lc_update_desc", &d, sizeof d, desc);
    if (st) return st;
    const bool waits = s->changes.n || s->changes.lights || s->changes.pictures, was_stale = is_stale(s);
    if (!waits && (d.keep_lights || !was_stale)) return LC_OK;
    const uint64_t before = s->input_id;
    const uint32_t trees = s->built.trees;
    if ((st = lc_as_arg(lc_scene_apply(s, d.keep_lights)))) return st;
    if (is_stale(s) && !was_stale) s->made_id = before;
    else if (s->built.trees != trees) s->made_id = lc_hash2(s->made_id, before);
    s->input_id = lc_given_id(s);
    return LC_OK;
}
