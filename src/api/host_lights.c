/* host_lights.c - a host's lights, checked by the rules of a scene's, and the tree over them. */
#include "api/host.h"

#include "base/desc.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

_Static_assert(LC_TREE_POINT == (int)LC_LIGHT_POINT && LC_TREE_ORIENTED == (int)LC_LIGHT_ORIENTED &&
                   LC_TREE_DIRECTIONAL == (int)LC_LIGHT_DIRECTIONAL && LC_TREE_SPOT == (int)LC_LIGHT_SPOT &&
                   LC_TREE_VIRTUAL == (int)LC_LIGHT_VIRTUAL && LC_TREE_BALL == (int)LC_LIGHT_BALL &&
                   LC_TREE_SKY == (int)LC_LIGHT_SKY,
               "numbers of lightcuts.h");

#define MAX_DIAGONAL 1e13 /* scene units */

static lc_light light_of(const lc_tree_light *in, uint32_t i)
{
    lc_light l = { .kind = (lc_light_kind)in->kind,
                   .pos = lc_f3_load(in->position),
                   .dir = lc_f3_load(in->direction),
                   .intensity = lc_f3_load(in->intensity) };
    const float *a = in->attenuation;
    if (lc_is_attenuated(l.kind)) {
        const bool none = !(fabsf(a[0]) + fabsf(a[1]) + fabsf(a[2]) > 0) && !isnan(a[0] + a[1] + a[2]);
        memcpy(l.atten, none ? (const float[3]){ 0, 0, 1 } : a, 3 * sizeof *l.atten);
    }
    if (l.kind == LC_LIGHT_SPOT) l.spot = (lc_spot){ in->cos_total, in->cos_start, 0 };
    if (lc_is_sized(l.kind)) {
        l.radius = in->radius;
        l.turn = lc_is_far(l.kind) ? i : 0;
    }
    return l;
}

#define HOST_KINDS LC_LIGHT_LUMINAIRE /* the last kind: its table is a scene's, which a host has none of */

/* The scene checks and copies the lights; kept[i] becomes the place of its i-th in `lights`. */
static lc_status add_lights(lc_scene *s, const lc_tree_light *lights, size_t n, uint32_t *kept)
{
    for (size_t i = 0; i < n; i++) {
        char name[40];
        if (lights[i].kind >= HOST_KINDS)
            return lc_fail(s->ctx, LC_ERR_ARG, "lights[%zu].kind is %u: there are %d kinds", i,
                           lights[i].kind, (int)HOST_KINDS);
        const lc_light l = light_of(&lights[i], (uint32_t)i);
        const size_t before = s->n_lights;
        snprintf(name, sizeof name, "lights[%zu]", i);
        lc_status st = lc_scene_add_light(s, (lc_pos){ name, 0, 0 }, &l);
        if (st) return st == LC_ERR_MEMORY ? st : LC_ERR_ARG;
        if (s->n_lights > before) kept[before] = (uint32_t)i;
    }
    return lc_scene_join_lights(s);
}

static double diag2_of(const lc_scene *s, double diagonal)
{
    lc_box box = lc_box_empty();
    for (size_t i = 0; i < s->n_lights; i++)
        if (!lc_is_far(s->lights[i].kind)) lc_box_add(&box, s->lights[i].pos);
    double x = (double)box.hi.x - box.lo.x, y = (double)box.hi.y - box.lo.y, z = (double)box.hi.z - box.lo.z;
    return fmax(diagonal * diagonal, x >= 0 ? x * x + y * y + z * z : 0);
}

static lc_status build(lc_tree *t, const lc_scene *s, const lc_tree_desc *d, const uint32_t *kept)
{
    const double diag2 = diag2_of(s, d->diagonal);
    const lc_light_tree_desc desc = { .lights = s->lights,
                                      .n_lights = s->n_lights,
                                      .diag2 = diag2,
                                      .seed = d->seed,
                                      .n_reps = d->n_reps ? d->n_reps : 16,
                                      .builder = d->builder,
                                      .keep_order = true };
    t->min_d2 = (float)fmax(LC_FLOOR_OF_DIAG2 * diag2, LC_MIN_D2);
    lc_status st = lc_light_tree_build(t->ctx, &desc, &t->tree);
    if (st) return st;
    t->given = t->tree->order;
    for (size_t i = 0; i < s->n_lights; i++) t->given[i] = kept[t->given[i]];
    return LC_OK;
}

static lc_status check(const lc_context *ctx, const lc_tree_light *lights, size_t n, const lc_tree_desc *d)
{
    if (!lights && n) return lc_fail(ctx, LC_ERR_ARG, "lights is NULL");
    if (n >= LC_LEAF / 2) return lc_fail(ctx, LC_ERR_ARG, "n: %zu lights are more than %u", n, LC_LEAF / 2);
    if (d->n_reps > LC_MAX_REPS)
        return lc_fail(ctx, LC_ERR_ARG, "desc.n_reps is %u: 1 to %d, or 0", d->n_reps, LC_MAX_REPS);
    if ((int)d->builder < 0 || d->builder > LC_BUILDER_PLOC)
        return lc_fail(ctx, LC_ERR_ARG, "desc.builder is none of lc_builder");
    if (!(d->diagonal >= 0 && d->diagonal <= MAX_DIAGONAL))
        return lc_fail(ctx, LC_ERR_ARG, "desc.diagonal must be 0 to %g", MAX_DIAGONAL);
    return LC_OK;
}

lc_status lc_tree_create(lc_context *ctx, const lc_tree_light *lights, size_t n, const lc_tree_desc *desc,
                         lc_tree **out)
{
    if (out) *out = NULL;
    if (!ctx) return LC_ERR_ARG;
    if (!out) return lc_fail(ctx, LC_ERR_ARG, "out is NULL");
    lc_tree_desc d = LC_TREE_DESC_INIT;
    lc_status st = desc ? lc_desc_take(ctx, "desc", &d, sizeof d, desc) : LC_OK;
    if (!st) st = check(ctx, lights, n, &d);
    if (st) return st;
    lc_scene *scene = NULL;
    uint32_t *kept = lc_alloc_raw(ctx, n + 1, sizeof *kept);
    lc_tree *t = lc_alloc(ctx, 1, sizeof *t);
    st = kept && t ? lc_scene_create(ctx, &scene) : LC_ERR_MEMORY;
    if (!st) st = add_lights(scene, lights, n, kept);
    if (!st) {
        *t = (lc_tree){ .ctx = ctx, .n_given = n };
        st = build(t, scene, &d, kept);
    }
    lc_scene_destroy(scene);
    lc_free(ctx, kept, n + 1, sizeof *kept);
    if (st) {
        lc_free(ctx, t, 1, sizeof *t);
        return st;
    }
    *out = t;
    return LC_OK;
}

void lc_tree_destroy(lc_tree *t)
{
    if (!t) return;
    lc_light_tree_destroy(t->tree);
    lc_free(t->ctx, t, 1, sizeof *t);
}

lc_status lc_tree_get_info(const lc_tree *t, lc_tree_info *info)
{
    if (!t || !info) return LC_ERR_ARG;
    lc_tree_info i = { .n_given = (uint32_t)t->n_given,
                       .n_lights = t->tree->n_lights,
                       .bytes = lc_light_tree_bytes(t->tree) };
    memcpy(i.n_of_kind, t->tree->n_of_kind, sizeof t->tree->n_of_kind);
    return lc_desc_give(t->ctx, "lc_tree_info", info, &i, sizeof i);
}
