/* lightcuts.c - public calls of scenes: checks arguments, then delegates. */
#include "lightcuts.h"

#include "bvh.h"
#include "digest.h"
#include "instance.h"
#include "light_tree.h"
#include "pbrt_parse.h"
#include "scene.h"

#define DEFAULT_AREA_LIGHTS 1024
#define DEFAULT_REPS 16 /* README.md, Representatives: bands 6 to 9 times fainter for 0 to 8 % of time */
#define DEFAULT_ENV_LIGHTS 5000
#define MAX_MADE_LIGHTS (1u << 28) /* of each */

/* Reads all files and says so. */
static lc_status parse(lc_scene *scene, const char *path, const lc_load_desc *d)
{
    lc_digest inputs = { 0 };
    double t0 = lc_now();
    scene->load = *d;
    scene->ctx->inputs = &inputs;
    lc_status st = lc_pbrt_parse(scene, path);
    scene->ctx->inputs = NULL;
    scene->input_id = lc_digest_result(&inputs);
    scene->seconds_parse = lc_now() - t0;
    return st ? st : d->parsed && d->parsed(d->parsed_user, scene) ? LC_ERR_CANCELLED : LC_OK;
}

lc_status lc_scene_load(lc_context *ctx, const char *path, const lc_load_desc *desc, lc_scene **out)
{
    if (!out) return LC_ERR_ARG;
    *out = NULL;
    lc_load_desc d = LC_LOAD_DESC_INIT;
    if (!ctx || !path || (desc && desc->size != sizeof d)) return LC_ERR_ARG;
    if (desc) d = *desc;
    if (!d.area_lights) d.area_lights = DEFAULT_AREA_LIGHTS;
    if (!d.env_lights) d.env_lights = DEFAULT_ENV_LIGHTS;
    if (!d.n_reps) d.n_reps = DEFAULT_REPS;
    if (d.builder < LC_BUILDER_AUTO || d.builder > LC_BUILDER_PLOC) return LC_ERR_ARG;
    if (d.indirect_lights != LC_NO_LIGHTS && d.indirect_lights > MAX_MADE_LIGHTS)
        return lc_fail(ctx, LC_ERR_ARG, "indirect lights must be at most %u", MAX_MADE_LIGHTS);
    if (d.n_reps > LC_MAX_REPS || d.area_lights > MAX_MADE_LIGHTS || d.env_lights > MAX_MADE_LIGHTS)
        return lc_fail(ctx, LC_ERR_ARG, "representatives must be 1 to %d, area and environment lights at most %u", LC_MAX_REPS,
                       MAX_MADE_LIGHTS);
    lc_scene *scene;
    lc_status st = lc_scene_create(ctx, &scene);
    if (!st) st = parse(scene, path, &d);
    if (!st) st = lc_scene_commit(scene, &d);
    if (st) {
        lc_scene_destroy(scene);
        return st;
    }
    *out = scene;
    return LC_OK;
}

void lc_scene_get_info(const lc_scene *s, lc_scene_info *info)
{
    static const lc_light_tree none;
    const lc_light_tree *t = s->tree ? s->tree : &none; /* parsed only */
    *info = (lc_scene_info){
        .n_triangles = s->n_tris, .n_vertices = s->n_verts, .n_meshes = s->n_meshes, .n_materials = s->n_materials,
        .n_lights = t->n_lights, .n_point = t->n_of_kind[LC_LIGHT_POINT], .n_oriented = t->n_of_kind[LC_LIGHT_ORIENTED],
        .n_directional = t->n_of_kind[LC_LIGHT_DIRECTIONAL], .n_spot = t->n_of_kind[LC_LIGHT_SPOT],
        .n_emissive_triangles = s->n_emissive_tris,
        .n_indirect_lights = s->indirect.n_lights, .n_light_paths = s->indirect.n_paths, .indirect_loss = s->indirect.loss,
        .n_instances = s->n_instances, .n_instanced_triangles = lc_instanced_tris(s), .n_alpha_meshes = s->n_alphas,
        .n_env_maps = s->n_envs, .n_env_lights = s->n_env_lights, .n_env_tried = s->n_env_tried,
        .max_depth = s->max_depth, .n_textures = s->textures.n, .n_images = s->textures.n_images,
        .width = s->film.width, .height = s->film.height, .spp = s->film.spp,
        .film_filename = s->film.filename ? s->film.filename : "", .n_notes = (uint32_t)s->n_notes,
        .seconds_parse = s->seconds_parse, .seconds_bvh = s->seconds_bvh, .seconds_lights = s->seconds_lights,
        .seconds_tree = s->seconds_tree, .bvh_bytes = s->bvh ? lc_bvh_bytes(s->bvh) + lc_instances_bytes(s) : 0,
        .tree_bytes = s->tree ? lc_light_tree_bytes(t) : 0,
    };
    for (size_t i = 0; i < s->textures.n_images; i++) info->image_bytes += lc_mipmap_bytes(&s->textures.images[i]);
    for (size_t i = 0; i < s->n_materials; i++) info->n_mirrors += s->materials[i].mirror || s->materials[i].glass;
    lc_f3_store(info->bounds_lo, s->bounds.lo);
    lc_f3_store(info->bounds_hi, s->bounds.hi);
    for (int i = 0; i < 4; i++) info->crop[i] = s->film.crop[i];
}

lc_status lc_scene_get_texture_class(const lc_scene *s, uint32_t idx, const char **name, uint64_t *count)
{
    if (idx >= LC_TEX_KINDS) return LC_ERR_ARG;
    *name = lc_tex_kind_name((lc_tex_kind)idx);
    *count = 0;
    for (size_t i = 0; i < s->textures.n; i++) *count += s->textures.items[i].kind == (lc_tex_kind)idx;
    return LC_OK;
}

lc_status lc_scene_get_note(const lc_scene *s, uint32_t idx, lc_note *note)
{
    if (idx >= s->n_notes) return LC_ERR_ARG;
    *note = (lc_note){ s->notes[idx].kind, s->notes[idx].text, s->notes[idx].count };
    return LC_OK;
}

lc_status lc_scene_get_feature(const lc_scene *s, uint32_t idx, lc_feature *feature)
{
    if (idx >= s->n_features) return LC_ERR_ARG;
    *feature = s->features[idx];
    return LC_OK;
}
