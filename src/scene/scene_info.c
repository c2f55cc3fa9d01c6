/* scene_info.c - the public queries about a scene: counts, timings, notes, features. */
#include "lightcuts.h"

#include "base/desc.h"
#include "scene/instance.h"
#include "scene/motion.h"
#include "scene/scene.h"
#include "trace/bvh.h"
#include "tree/light_tree.h"

uint32_t lc_light_kind_count(void) { return LC_LIGHT_KINDS; }

const char *lc_light_kind_name(uint32_t kind)
{
    return kind < LC_LIGHT_KINDS ? lc_light_kinds[kind].name : "unknown";
}

_Static_assert((int)LC_LIGHT_KINDS <= LC_MAX_LIGHT_KINDS, "lc_scene_info counts them");

/* What is not at hand. */
static void count(const lc_scene *s, lc_scene_info *info)
{
    for (size_t i = 0; i < s->textures.n_images; i++)
        info->image_bytes += lc_mipmap_bytes(&s->textures.images[i]);
    for (size_t i = 0; i < s->n_materials; i++)
        info->n_mirrors += s->materials[i].mirror || s->materials[i].glass;
}

static void set_environment(const lc_scene *s, lc_scene_info *info)
{
    const lc_sky_error *e = &s->sky_error;
    info->n_env_maps = s->n_envs;
    info->n_env_lights = s->n_env_lights;
    info->n_env_tried = s->n_env_tried;
    info->sky_median = e->n_blocks ? e->median : -1;
    info->sky_high = e->n_blocks ? e->high : -1;
    info->sky_grain_median = e->grain_median;
    info->sky_grain_high = e->grain_high;
}

lc_status lc_scene_get_info(const lc_scene *s, lc_scene_info *out)
{
    static const lc_light_tree none;
    if (!s || !out) return LC_ERR_ARG;
    const lc_light_tree *t = s->tree ? s->tree : &none; /* no tree while only parsed */
    lc_scene_info full = {
        .size = sizeof full,
        .n_triangles = s->n_tris - s->n_unseen_tris,
        .n_vertices = s->n_verts,
        .n_meshes = s->n_meshes,
        .n_materials = s->n_materials,
        .n_lights = t->n_lights,
        .n_emissive_triangles = s->n_emissive_tris,
        .n_indirect_lights = s->indirect.n_lights,
        .n_light_paths = s->indirect.n_paths,
        .indirect_loss = s->indirect.loss,
        .indirect_median = s->indirect.median,
        .indirect_high = s->indirect.high,
        .lamps_median = s->lamp_error.n_points ? s->lamp_error.median : -1,
        .lamps_high = s->lamp_error.n_points ? s->lamp_error.high : -1,
        .indirect_off = s->indirect.n_lights ? lc_indirect_deviation(&s->indirect) / s->load.indirect_error
                                             : 0,
        .n_instances = s->n_instances,
        .n_instanced_triangles = lc_instanced_tris(s),
        .n_alpha_meshes = s->n_alphas,
        .max_depth = s->max_depth,
        .n_textures = s->textures.n,
        .n_images = s->textures.n_images,
        .width = s->film.width,
        .height = s->film.height,
        .spp = s->film.spp,
        .film_filename = s->film.filename ? s->film.filename : "",
        .n_notes = (uint32_t)s->n_notes,
        .seconds_parse = s->seconds_parse,
        .seconds_bvh = s->seconds_bvh,
        .seconds_lights = s->seconds_lights,
        .seconds_tree = s->seconds_tree,
        .bvh_bytes = s->bvh ? lc_bvh_bytes(s->bvh) + lc_instances_bytes(s) : 0,
        .tree_bytes = s->tree ? lc_light_tree_bytes(t) : 0,
        .n_given_lights = s->by_calls || s->given.n_lights ? s->given.n_lights : s->n_given,
        .n_given_instances = s->by_calls ? s->given.n_instances : s->n_instances,
        .n_given_meshes = s->by_calls ? s->given.n_meshes : s->n_meshes,
        .built_bvhs = s->built.bvhs,
        .built_tops = s->built.tops,
        .built_lights = s->built.lights,
        .built_indirect = s->built.indirect,
        .built_trees = s->built.trees,
        .built_images = (uint32_t)(s->textures.n_images + s->n_emission_maps) + s->built.images,
        .n_sequences = (uint32_t)s->n_sequences,
        .n_moving = lc_scene_n_moving(s),
        .camera_moves = s->camera_desc.moves,
    }, *info = &full;
    count(s, info);
    set_environment(s, info);
    for (int k = 0; k < LC_LIGHT_KINDS; k++) info->n_of_kind[k] = t->n_of_kind[k];
    lc_f3_store(info->bounds_lo, s->bounds.lo);
    lc_f3_store(info->bounds_hi, s->bounds.hi);
    for (int i = 0; i < 4; i++) info->crop[i] = s->film.crop[i];
    return lc_desc_give(s->ctx, "lc_scene_info", out, info, sizeof *info);
}

lc_status lc_scene_get_texture_class(const lc_scene *s, uint32_t idx, const char **name, uint64_t *count)
{
    if (!s || !name || !count || idx >= LC_TEX_KINDS) return LC_ERR_ARG;
    *name = lc_tex_kind_name((lc_tex_kind)idx);
    *count = 0;
    for (size_t i = 0; i < s->textures.n; i++) *count += s->textures.items[i].kind == (lc_tex_kind)idx;
    return LC_OK;
}

int lc_scene_reads_file(const lc_scene *s, const char *path)
{
    return s && path && lc_inputs_have(&s->inputs, path);
}

lc_status lc_scene_get_note(const lc_scene *s, uint32_t idx, lc_note *note)
{
    if (!s || !note || idx >= s->n_notes) return LC_ERR_ARG;
    const lc_note n = { .kind = s->notes[idx].kind,
                        .text = s->notes[idx].text,
                        .count = s->notes[idx].count };
    return lc_desc_give(s->ctx, "lc_note", note, &n, sizeof n);
}

lc_status lc_scene_get_feature(const lc_scene *s, uint32_t idx, lc_feature *feature)
{
    if (!s || !feature || idx >= s->n_features) return LC_ERR_ARG;
    return lc_desc_give(s->ctx, "lc_feature", feature, &s->features[idx], sizeof *s->features);
}

lc_status lc_scene_get_group(const lc_scene *s, uint32_t idx, lc_light_group *group)
{
    if (!s || !group || idx >= s->groups.n) return LC_ERR_ARG;
    lc_light_group g = { .name = s->groups.name[idx] };
    for (size_t i = 0; i < s->n_lights && s->tree; i++) {
        const bool own = s->lights[i].group == idx;
        g.n_lights += own;
        g.n_indirect_lights += own && s->lights[i].kind == LC_LIGHT_VIRTUAL;
    }
    return lc_desc_give(s->ctx, "lc_light_group", group, &g, sizeof g);
}
