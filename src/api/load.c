/* load.c - public calls of scenes: checks arguments, then delegates. */
#include "api/load.h"

#include "api/format.h"
#include "base/desc.h"
#include "base/memory.h"
#include "build/build.h"
#include "prepare/commit.h"
#include "scene/group_names.h"
#include "scene/view.h"
#include "tree/light_tree.h"

#define DEFAULT_REPS 16 /* bands are 6 to 9 times fainter than with 1: tests/results/representatives.md */
#define DEFAULT_ENV_LIGHTS 5000
#define DEFAULT_INDIRECT_ERROR 0.01
#define MIN_INDIRECT_ERROR 1e-4
#define MAX_MOVABLE 4096
#define MAX_MADE_LIGHTS (1u << 28) /* of each */

/* Reads all files and says so. */
static lc_status parse(lc_scene *scene, const char *path, const lc_load_desc *d)
{
    double t0 = lc_now();
    lc_memory_step(scene->ctx, "reading the scene");
    scene->load = *d;
    scene->inputs.reads = d->reads;
    scene->inputs.reads_user = d->reads_user;
    scene->frame = d->frame ? d->frame : 1;
    scene->ctx->inputs = &scene->inputs;
    lc_status st = lc_groups_ask(scene, d->groups, d->n_groups);
    if (!st && d->sandbox) st = lc_inputs_restrict(&scene->inputs, &scene->arena, path, d->sandbox);
    if (!st) st = lc_format_parse(scene, path);
    if (!st) lc_groups_warn(scene);
    lc_build_end(scene);
    scene->ctx->inputs = NULL;
    scene->inputs.reads = NULL;
    scene->input_id = lc_digest_result(&scene->inputs.digest);
    if (!st && d->sensors) st = lc_scene_set_sensors(scene, d->sensors);
    scene->load.sensors = NULL; /* the host's, which may go */
    scene->load.groups = NULL;
    scene->load.n_movable = 0;
    if (!st) lc_scene_size_film(scene, d);
    if (!st && scene->n_sequences) scene->input_id = lc_given_id(scene);
    scene->seconds_parse = lc_now() - t0;
    return st ? st : d->parsed && d->parsed(d->parsed_user, scene) ? LC_ERR_CANCELLED : LC_OK;
}

lc_status lc_load_take(const lc_context *ctx, const lc_load_desc *desc, lc_load_desc *out)
{
    lc_load_desc d = LC_LOAD_DESC_INIT;
    if (desc && lc_desc_take(ctx, "lc_load_desc", &d, sizeof d, desc)) return LC_ERR_ARG;
    if (!d.env_lights) d.env_lights = DEFAULT_ENV_LIGHTS;
    if (d.indirect_error >= 0 && d.indirect_error <= 0) d.indirect_error = DEFAULT_INDIRECT_ERROR;
    if (!d.n_reps) d.n_reps = DEFAULT_REPS;
    if (d.builder < LC_BUILDER_AUTO || d.builder > LC_BUILDER_PLOC)
        return lc_fail(ctx, LC_ERR_ARG, "builder is none of lc_builder");
    if (d.indirect_from != LC_INDIRECT_FROM_SCENE && d.indirect_from != LC_INDIRECT_FROM_VIEW)
        return lc_fail(ctx, LC_ERR_ARG, "indirect_from is none of lc_indirect_from");
    if (!(d.indirect_error >= MIN_INDIRECT_ERROR && d.indirect_error <= 1))
        return lc_fail(ctx, LC_ERR_ARG, "the indirect light's error must be %g to 1", MIN_INDIRECT_ERROR);
    if (d.indirect_lights != LC_NO_LIGHTS && d.indirect_lights > MAX_MADE_LIGHTS)
        return lc_fail(ctx, LC_ERR_ARG, "indirect lights must be at most %u", MAX_MADE_LIGHTS);
    if (d.n_reps > LC_MAX_REPS || d.area_lights > MAX_MADE_LIGHTS || d.env_lights > MAX_MADE_LIGHTS)
        return lc_fail(ctx, LC_ERR_ARG,
                       "representatives must be 1 to %d, area and environment lights at most %u", LC_MAX_REPS,
                       MAX_MADE_LIGHTS);
    for (uint32_t i = 0; i < d.n_movable; i++)
        if (d.n_movable > MAX_MOVABLE || !d.movable || !d.movable[i])
            return lc_fail(ctx, LC_ERR_ARG, "movable: patterns are NULL or more than %d", MAX_MOVABLE);
    const uint32_t *size = d.resolution;
    if (size[0] > LC_MAX_SIDE || size[1] > LC_MAX_SIDE || (uint64_t)size[0] * size[1] > LC_MAX_PIXELS ||
        !size[0] != !size[1])
        return lc_fail(ctx, LC_ERR_ARG, "resolution: no film has %u x %u pixels", size[0], size[1]);
    *out = d;
    return LC_OK;
}

lc_status lc_scene_load(lc_context *ctx, const char *path, const lc_load_desc *desc, lc_scene **out)
{
    if (out) *out = NULL;
    lc_load_desc d;
    lc_scene *scene;
    if (!ctx) return LC_ERR_ARG;
    if (!path || !out) return lc_fail(ctx, LC_ERR_ARG, "lc_scene_load: path or out is NULL");
    lc_status st = lc_load_take(ctx, desc, &d);
    if (st) return st;
    st = lc_scene_create(ctx, &scene);
    if (!st) st = parse(scene, path, &d);
    if (!st) st = lc_scene_commit(scene, &d);
    if (st) {
        lc_scene_destroy(scene);
        return st;
    }
    scene->committed = true;
    *out = scene;
    return LC_OK;
}
