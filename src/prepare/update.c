/* update.c - see update.h. */
#include "prepare/update.h"

#include "base/memory.h"
#include "base/stats.h"
#include "prepare/lighting.h"
#include "scene/instance.h"
#include "scene/sequence.h"
#include "tree/light_tree.h"

lc_status lc_scene_change(lc_scene *s, const lc_change *change)
{
    lc_changes *c = &s->changes;
    const lc_status st = lc_grow(s->ctx, (void **)&c->list, &c->cap, c->n + 1, sizeof *c->list);
    if (!st) c->list[c->n++] = *change;
    return st;
}

static void emit(lc_mesh *m, lc_f3 emission)
{
    m->emission = emission;
    for (uint32_t i = 1; i <= m->n_places; i++) m[i].emission = lc_f3_scale(emission, 1 / (float)m->n_places);
}

/* Exchanges the value of a change with the scene's, so that a second time undoes the first. */
static void exchange(lc_scene *s, lc_change *c)
{
    lc_change had = *c;
    switch (c->kind) {
    case LC_CHANGE_CAMERA:
        had.camera = s->camera_desc;
        s->camera_desc = c->camera;
        break;
    case LC_CHANGE_INSTANCE:
        had.instance = s->instances[c->at];
        s->instances[c->at] = c->instance;
        break;
    case LC_CHANGE_EMISSION:
        had.emission = s->meshes[c->at].emission;
        emit(&s->meshes[c->at], c->emission);
        break;
    case LC_CHANGE_ENVIRONMENT:
        had.scale = s->envs[c->at].scale;
        s->envs[c->at].scale = c->scale;
        break;
    }
    *c = had;
}

static bool has(const lc_scene *s, lc_change_kind kind)
{
    for (size_t i = 0; i < s->changes.n; i++)
        if (s->changes.list[i].kind == kind) return true;
    return false;
}

/* The lights of a scene from files, which has kept none apart, are those that its lighting began with. */
static lc_status add_given(lc_scene *s, const lc_lighting *old)
{
    lc_status st = LC_OK;
    if (s->given.n_lights) return lc_scene_add_given_lights(s);
    for (size_t i = 0; i < old->n_given && !st; i++)
        st = lc_scene_add_light(s, (lc_pos){ 0, 0, 0 }, &old->lights[i]);
    return st;
}

static bool has_aimed(const lc_scene *s)
{
    for (int k = 0; k < LC_LIGHT_KINDS; k++)
        if (s->tree->n_of_kind[k] && lc_is_aimed((lc_light_kind)k)) return true;
    return false;
}

/* Where all lights stay. */
static lc_status keep_lights(lc_scene *s, lc_lighting *old)
{
    const double diag2 = lc_lighting_diag2(s);
    const bool other = diag2 < s->diag2 || diag2 > s->diag2;
    lc_lighting_set_diag2(s, diag2);
    if (!other || !has_aimed(s)) return LC_OK;
    lc_light_tree *tree = NULL;
    const lc_status st = lc_lighting_build_tree(s, &tree);
    if (st) return st;
    old->tree = s->tree;
    s->tree = tree;
    return LC_OK;
}

typedef struct plan {
    bool moved, lights, made; /* instances have moved; there are other lights; those of lamps and environments
                               * are to be made */
    lc_stale stale;           /* what is stale afterwards */
} plan;

static plan plan_of(const lc_scene *s, bool keep)
{
    const bool camera = has(s, LC_CHANGE_CAMERA) && !s->n_views, moved = has(s, LC_CHANGE_INSTANCE);
    const bool sees = lc_lighting_sees(s), indirect = lc_lighting_is_indirect(s);
    const bool of_view = sees && (camera || moved || s->stale.made);
    const bool of_paths = indirect && (camera || s->stale.made || s->stale.indirect);
    plan p = { .moved = moved };
    p.made = has(s, LC_CHANGE_EMISSION) || has(s, LC_CHANGE_ENVIRONMENT) || s->changes.pictures ||
             (of_view && !keep);
    p.lights = p.made || s->changes.lights || (moved && indirect) || (of_paths && !keep);
    p.stale.made = of_view && !p.made;
    p.stale.indirect = of_paths && !p.lights;
    return p;
}

/* Makes again what follows from the changes, which the scene has. What is replaced goes to *old and *top; on
 * failure the scene is left with some of both. */
static lc_status remake(lc_scene *s, const plan *p, lc_lighting *old, lc_top *top)
{
    lc_status st = LC_OK;
    if (!s->sensors && !lc_camera_init(&s->camera, &s->camera_desc, s->film.width, s->film.height))
        return lc_fail(s->ctx, LC_ERR_PARSE, "camera out of range");
    if (p->lights) {
        lc_lighting_exchange(s, old);
        st = add_given(s, old);
        if (!st) st = lc_scene_join_lights(s);
    }
    const double t0 = lc_now();
    lc_memory_step(s->ctx, "the BVH");
    if (!st) st = lc_top_build(s, p->moved, top);
    s->seconds_bvh += lc_now() - t0;
    if (st) return st;
    lc_top_exchange(s, top);
    return p->lights ? lc_lighting_make(s, p->made ? NULL : old) : keep_lights(s, old);
}

/* Puts back what was there, whether or not it had been replaced yet. */
static void undo(lc_scene *s, const plan *p, lc_lighting *old, lc_top *top)
{
    lc_scene_drop_light_chunks(s);
    if (p->lights) lc_lighting_exchange(s, old);
    lc_top_exchange(s, top);
}

lc_status lc_scene_apply(lc_scene *s, bool keep)
{
    lc_changes *c = &s->changes;
    lc_lighting old = { .lights = NULL };
    lc_top top = { .boxes = NULL };
    const lc_camera camera = s->camera;
    const double diag2 = s->diag2;
    for (size_t i = 0; i < c->n; i++) exchange(s, &c->list[i]);
    lc_sequences_exchange(s);
    const plan p = plan_of(s, keep);
    const lc_status st = remake(s, &p, &old, &top);
    if (st) {
        undo(s, &p, &old, &top);
        for (size_t i = c->n; i-- > 0;) exchange(s, &c->list[i]);
        lc_sequences_exchange(s);
        lc_lighting_set_diag2(s, diag2);
        s->camera = camera;
    } else {
        c->n = 0;
        c->lights = false;
        lc_sequences_drop(s);
        s->stale = p.stale;
    }
    lc_lighting_free(s->ctx, &old);
    lc_bvh_destroy(top.boxes);
    return st;
}
