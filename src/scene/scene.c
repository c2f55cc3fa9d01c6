/* scene.c - the scene builder: checks what it is given and copies it. */
#include "scene/scene.h"

#include "shade/light_kind.h"
#include "shade/lobe.h"

#include <stdio.h>
#include <string.h>

#define MAX_COUNT 0x3fffffffu /* limits triangles, vertices, lights: ids of 30 bits leave two for flags */
#define UNIT_TOLERANCE 1e-4f  /* of the length of a unit direction; rounding gives about 1e-7 */

#define GROW(scene, field, cap, need)                                                                        \
    lc_grow((scene)->ctx, (void **)&(scene)->field, &(scene)->cap, need, sizeof *(scene)->field)

lc_status lc_scene_create(lc_context *ctx, lc_scene **out)
{
    lc_scene *s = lc_alloc(ctx, 1, sizeof *s);
    *out = s;
    if (!s) return LC_ERR_MEMORY;
    s->ctx = ctx;
    lc_arena_init(&s->arena, ctx);
    s->textures.ctx = ctx;
    s->bounds = lc_box_empty();
    s->media.around = s->media.beyond = LC_NONE;
    s->max_depth = LC_PBRT_DEPTH;
    s->film =
        (lc_film_desc){ .width = 1280, .height = 720, .crop = { 0, 1280, 0, 720 }, .scale = 1, .spp = 1 };
    s->film.filter = (lc_pixel_filter_desc)LC_PIXEL_FILTER_BOX;
    return LC_OK;
}

static bool in_range(lc_f3 a, float max) { return lc_f3_finite(a) && lc_f3_max_abs(a) <= max; }

static bool is_colour(lc_f3 a, float max) { return in_range(a, max) && a.x >= 0 && a.y >= 0 && a.z >= 0; }

lc_status lc_scene_add_material(lc_scene *s, const lc_material *m, uint32_t *id)
{
    if (!lc_material_in_range(m)) return LC_ERR_ARG;
    lc_status st = GROW(s, materials, cap_materials, s->n_materials + 1);
    if (!st) st = GROW(s, maps, cap_maps, s->n_materials + 1);
    if (st) return st;
    *id = (uint32_t)s->n_materials;
    s->materials[s->n_materials++] = *m;
    lc_scene_map_material(s, *id, &(lc_material_maps)LC_NO_MAPS);
    return LC_OK;
}

/* Sets the fields of *maps that follow from its other fields and from the materials it mixes. */
static void set_derived(const lc_scene *s, uint32_t id, lc_material_maps *maps)
{
    const lc_material *m = &s->materials[id];
    const float *rough = m->roughness;
    maps->textured = maps->mix[0] != LC_NONE || maps->kd != LC_NONE || maps->ks != LC_NONE ||
                     maps->kt != LC_NONE || maps->exponent != LC_NONE || maps->roughness[0] != LC_NONE ||
                     maps->roughness[1] != LC_NONE || maps->bump != LC_NONE || maps->normal != LC_NONE;
    maps->brushed = rough[0] < rough[1] || rough[0] > rough[1] || maps->roughness[0] != maps->roughness[1];
    maps->depth = 0;
    maps->clear = maps->mix[0] == LC_NONE && m->glass && (lc_f3_max(m->kt) > 0 || maps->kt != LC_NONE);
    maps->refracts = maps->clear && !m->thin && m->eta.x > 1;
    for (int i = 0; i < 2 && maps->mix[0] != LC_NONE; i++) {
        const lc_material_maps *part = &s->maps[maps->mix[i]];
        LC_ASSERT(maps->mix[i] < s->n_materials && maps->mix[i] != id && part->depth < LC_MAX_MIX);
        maps->brushed |= part->brushed;
        maps->clear |= part->clear;
        maps->refracts |= part->refracts;
        if (part->depth >= maps->depth) maps->depth = (uint8_t)(part->depth + 1);
    }
}

void lc_scene_map_material(lc_scene *s, uint32_t id, const lc_material_maps *maps)
{
    LC_ASSERT(id < s->n_materials);
    s->maps[id] = *maps;
    set_derived(s, id, &s->maps[id]);
}

bool lc_scene_is_textured(const lc_scene *s, uint32_t material_id) { return s->maps[material_id].textured; }

bool lc_scene_wants_uv(const lc_scene *s, uint32_t material_id)
{
    return s->maps[material_id].textured || s->maps[material_id].brushed;
}

static lc_status check_mesh(const lc_scene *s, lc_pos where, const lc_mesh_desc *m)
{
    for (size_t i = 0; i < (size_t)m->n_verts * 3; i++)
        if (!(fabsf(m->pos[i]) <= LC_MAX_COORD))
            return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "vertex %zu is not finite or beyond %g units",
                              i / 3, (double)LC_MAX_COORD);
    for (size_t i = 0; m->normal && i < (size_t)m->n_verts * 3; i++)
        if (!isfinite(m->normal[i]))
            return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "normal %zu is not finite", i / 3);
    for (size_t i = 0; i < (size_t)m->n_tris * 3; i++)
        if (m->index[i] >= m->n_verts)
            return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "triangle %zu uses vertex %u of %u", i / 3,
                              m->index[i], m->n_verts);
    if (!is_colour(m->emission, LC_MAX_INTENSITY))
        return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "emission is negative, not finite or above %g",
                          (double)LC_MAX_INTENSITY);
    return LC_OK;
}

static lc_status grow_mesh(lc_scene *s, const lc_mesh_desc *m)
{
    size_t nv = s->n_verts + m->n_verts, nt = s->n_tris + m->n_tris;
    lc_status st = GROW(s, pos, cap_pos, nv * 3);
    if (!st && (m->normal || s->normal)) st = GROW(s, normal, cap_normal, nv * 3);
    if (!st && (m->uv || s->uv)) st = GROW(s, uv, cap_uv, nv * 2);
    if (!st) st = GROW(s, index, cap_index, nt * 3);
    if (!st) st = GROW(s, tri_mesh, cap_tri_mesh, nt);
    if (!st) st = GROW(s, meshes, cap_meshes, s->n_meshes + 1);
    if (!st && m->alpha) st = GROW(s, alphas, cap_alphas, s->n_alphas + 1);
    return st;
}

/* Copies texture coordinates; those that are not finite become 0. */
static void copy_uv(lc_scene *s, const lc_mesh_desc *m)
{
    float *to = s->uv + s->n_verts * 2;
    for (size_t i = 0; i < (size_t)m->n_verts * 2; i++) to[i] = m->uv && isfinite(m->uv[i]) ? m->uv[i] : 0;
}

lc_status lc_scene_add_mesh(lc_scene *s, lc_pos where, const lc_mesh_desc *desc)
{
    LC_ASSERT(desc->material_id < s->n_materials);
    lc_mesh_desc with = *desc;
    const lc_mesh_desc *m = &with;
    bool textured = lc_scene_is_textured(s, m->material_id);
    if (!lc_scene_wants_uv(s, m->material_id) && !m->alpha && !m->emission_map) with.uv = NULL;
    lc_status st = check_mesh(s, where, m);
    if (st) return st;
    if (!m->n_tris) return LC_OK;
    if (m->n_verts > MAX_COUNT - s->n_verts || m->n_tris > MAX_COUNT - s->n_tris)
        return lc_fail_at(s->ctx, LC_ERR_UNSUPPORTED, where, "more than %u triangles or vertices", MAX_COUNT);
    st = grow_mesh(s, m);
    if (!st && s->maps[m->material_id].refracts)
        st = lc_scene_note_at(s, where, "glass",
                              "light passes straight through glass: what it bends (caustics) is left out");
    if (st) return st;
    memcpy(s->pos + s->n_verts * 3, m->pos, (size_t)m->n_verts * 3 * sizeof(float));
    if (m->normal)
        memcpy(s->normal + s->n_verts * 3, m->normal, (size_t)m->n_verts * 3 * sizeof(float));
    else if (s->normal)
        memset(s->normal + s->n_verts * 3, 0, (size_t)m->n_verts * 3 * sizeof(float));
    if (s->uv) copy_uv(s, m);
    for (size_t i = 0; i < (size_t)m->n_tris * 3; i++)
        s->index[s->n_tris * 3 + i] = (uint32_t)s->n_verts + m->index[i];
    for (size_t i = 0; i < m->n_tris; i++) s->tri_mesh[s->n_tris + i] = (uint32_t)s->n_meshes;
    lc_object *object = s->n_objects ? &s->objects[s->n_objects - 1] : NULL;
    LC_ASSERT(!object || object->unseen || m->n_places || !(lc_f3_max(m->emission) > 0));
    for (size_t i = 0; i < (size_t)m->n_tris * 3; i++)
        lc_box_add(object ? &object->box : &s->bounds, lc_f3_load(m->pos + 3 * (size_t)m->index[i]));
    if (object && object->unseen) {
        lc_box_join(&s->bounds, &object->box);
        s->n_unseen_tris += m->n_tris;
    }
    if (object) object->n_tris += m->n_tris;
    s->meshes[s->n_meshes++] = (lc_mesh){
        .first_tri = (uint32_t)s->n_tris,
        .n_tris = m->n_tris,
        .first_vert = (uint32_t)s->n_verts,
        .material_id = m->material_id,
        .has_normals = m->normal != NULL,
        .has_uv = m->uv != NULL,
        .textured = textured,
        .brushed = s->maps[m->material_id].brushed,
        .clear = s->maps[m->material_id].clear,
        .flip = m->flip,
        .two_sided = m->two_sided,
        .is_place = m->is_place,
        .n_places = m->n_places,
        .emission = m->emission,
        .own_emission = m->emission,
        .emission_map = m->emission_map,
        .alpha = m->alpha ? (uint32_t)s->n_alphas : LC_NONE,
        .group = s->groups.now,
    };
    if (m->alpha) s->alphas[s->n_alphas++] = *m->alpha;
    s->has_glass |= s->maps[m->material_id].clear;
    s->n_verts += m->n_verts;
    s->n_tris += m->n_tris;
    return LC_OK;
}

lc_status lc_scene_begin_object(lc_scene *s)
{
    lc_status st = GROW(s, objects, cap_objects, s->n_objects + 1);
    if (!st)
        s->objects[s->n_objects++] = (lc_object){ .first_tri = (uint32_t)s->n_tris, .box = lc_box_empty() };
    return st;
}

lc_status lc_scene_make_instance(const lc_scene *s, lc_pos where, uint32_t object, const lc_xform *to_world,
                                 lc_instance *at)
{
    lc_xform inverse;
    const lc_object *o = &s->objects[object];
    *at = (lc_instance){ .object = object, .mirrored = lc_xform_det3(to_world) < 0 };
    if (!lc_xform_invert(to_world, &inverse)) return LC_ERR_ARG;
    memcpy(at->to_world, to_world->m, sizeof at->to_world);
    memcpy(at->to_object, inverse.m, sizeof at->to_object);
    for (int i = 0; i < 8; i++) {
        const float p[3] = { i & 1 ? o->box.hi.x : o->box.lo.x, i & 2 ? o->box.hi.y : o->box.lo.y,
                             i & 4 ? o->box.hi.z : o->box.lo.z };
        float q[3];
        lc_instance_point(at, p, q);
        if (!in_range(lc_f3_load(q), LC_MAX_COORD))
            return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "an instance is beyond %g units",
                              (double)LC_MAX_COORD);
    }
    return LC_OK;
}

lc_status lc_scene_add_instance(lc_scene *s, lc_pos where, uint32_t object, const lc_xform *to_world)
{
    if (!s->objects[object].n_tris) return LC_OK;
    if (s->n_instances >= MAX_COUNT)
        return lc_fail_at(s->ctx, LC_ERR_UNSUPPORTED, where, "more than %u instances", MAX_COUNT);
    lc_status st = GROW(s, instances, cap_instances, s->n_instances + 1);
    if (!st) st = lc_scene_make_instance(s, where, object, to_world, &s->instances[s->n_instances]);
    if (!st) s->n_instances++;
    return st;
}

const lc_alpha *lc_scene_alpha_of(const lc_scene *s, size_t first, size_t n)
{
    for (size_t t = first; t < first + n && s->alpha_bits; t++)
        if (s->alpha_bits[t / 32] >> t % 32 & 1) return &s->alpha;
    return NULL;
}

/* Makes room for one more light and sets *out to its place. */
static lc_status next_light(lc_scene *s, lc_light **out)
{
    if (s->n_lights >= s->cap_lights && s->cap_lights < LC_LIGHT_CHUNK) {
        lc_status st = GROW(s, lights, cap_lights, s->n_lights + 1);
        if (st) return st;
    }
    *out = s->lights + s->n_lights;
    if (s->n_lights < s->cap_lights) return LC_OK;
    size_t chunk = (s->n_lights - s->cap_lights) / LC_LIGHT_CHUNK;
    if (chunk == s->n_light_chunks) {
        lc_status st = GROW(s, light_chunks, cap_light_chunks, chunk + 1);
        if (st) return st;
        s->light_chunks[chunk] = lc_alloc_raw(s->ctx, LC_LIGHT_CHUNK, sizeof *s->lights);
        if (!s->light_chunks[chunk]) return LC_ERR_MEMORY;
        s->n_light_chunks++;
    }
    *out = s->light_chunks[chunk] + (s->n_lights - s->cap_lights) % LC_LIGHT_CHUNK;
    return LC_OK;
}

void lc_scene_drop_light_chunks(lc_scene *s)
{
    for (size_t i = 0; i < s->n_light_chunks; i++)
        lc_free(s->ctx, s->light_chunks[i], LC_LIGHT_CHUNK, sizeof *s->lights);
    s->n_light_chunks = 0;
}

lc_status lc_scene_join_lights(lc_scene *s)
{
    if (!s->n_light_chunks) return LC_OK;
    /* Untouched pages take no memory until the copies below write them. */
    lc_light *all = lc_alloc_raw(s->ctx, s->n_lights, sizeof *all);
    if (!all) return LC_ERR_MEMORY;
    memcpy(all, s->lights, s->cap_lights * sizeof *all);
    lc_free(s->ctx, s->lights, s->cap_lights, sizeof *all);
    for (size_t i = 0, at = s->cap_lights; i < s->n_light_chunks; i++, at += LC_LIGHT_CHUNK) {
        size_t n = s->n_lights - at < LC_LIGHT_CHUNK ? s->n_lights - at : LC_LIGHT_CHUNK;
        memcpy(all + at, s->light_chunks[i], n * sizeof *all);
        lc_free(s->ctx, s->light_chunks[i], LC_LIGHT_CHUNK, sizeof *all);
    }
    s->lights = all;
    s->cap_lights = s->n_lights;
    s->n_light_chunks = 0;
    return LC_OK;
}

lc_status lc_scene_check_light(const lc_scene *s, lc_pos where, const lc_light *light, lc_light *out)
{
    if (!is_colour(light->intensity, LC_MAX_INTENSITY))
        return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "light intensity is negative, not finite or above %g",
                          (double)LC_MAX_INTENSITY);
    if (!lc_is_far(light->kind) && !in_range(light->pos, LC_MAX_COORD))
        return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "light position is not finite or beyond %g units",
                          (double)LC_MAX_COORD);
    float len = lc_f3_len(light->dir), sum = 0;
    if ((lc_is_far(light->kind) || lc_is_aimed(light->kind)) && !(fabsf(len - 1) < UNIT_TOLERANCE))
        return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "light direction is zero or not finite");
    const lc_light_kind_info *kind = &lc_light_kinds[light->kind];
    size_t n_maps = light->kind == LC_LIGHT_LUMINAIRE ? s->profiles.n : s->n_spot_maps;
    const char *wrong = kind->check ? kind->check(light, n_maps) : NULL;
    if (wrong) return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "%s", wrong);
    for (int k = 0; k < 3 && lc_is_attenuated(light->kind); k++) {
        float a = light->atten[k];
        bool soft = k == 0 && light->atten[2] == 1;
        if (!(a == 0 ||
              (a >= (soft ? LC_MIN_D2 : LC_MIN_ATTEN) && a <= (soft ? LC_MAX_SOFTENING : LC_MAX_ATTEN))))
            return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "attenuation coefficients must be 0 or %g to %g",
                              (double)LC_MIN_ATTEN, (double)LC_MAX_ATTEN);
        sum += a;
    }
    if (lc_is_attenuated(light->kind) && !(sum > 0))
        return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "attenuation coefficients are all 0");
    const lc_f3 i = light->intensity;
    *out = *light;
    if (lc_is_far(light->kind) && lc_is_sized(light->kind)) out->dir = lc_f3_normalize(light->dir);
    out->intensity = lc_f3_make(i.x < LC_MIN_INTENSITY ? 0 : i.x, i.y < LC_MIN_INTENSITY ? 0 : i.y,
                                i.z < LC_MIN_INTENSITY ? 0 : i.z);
    return LC_OK;
}

lc_status lc_scene_add_light(lc_scene *s, lc_pos where, const lc_light *light)
{
    lc_light kept;
    lc_status st = lc_scene_check_light(s, where, light, &kept);
    return st ? st : lc_scene_put_light(s, where, &kept);
}

lc_status lc_scene_put_light(lc_scene *s, lc_pos where, const lc_light *checked)
{
    lc_light *to;
    if (s->n_lights >= MAX_COUNT)
        return lc_fail_at(s->ctx, LC_ERR_UNSUPPORTED, where, "more than %u lights", MAX_COUNT);
    if (!(lc_f3_max(checked->intensity) > 0)) return LC_OK; /* contributes nothing */
    lc_status st = next_light(s, &to);
    if (st) return st;
    *to = *checked;
    if (!to->group) to->group = s->groups.now;
    s->n_lights++;
    return LC_OK;
}

lc_status lc_scene_add_given_lights(lc_scene *s)
{
    lc_status st = LC_OK;
    for (size_t i = 0; i < s->given.n_lights && !st; i++)
        st = lc_scene_add_light(s, (lc_pos){ 0, 0, 0 }, &s->given.lights[i]);
    return st;
}

lc_status lc_scene_add_env(lc_scene *s, lc_pos where, const lc_env *env)
{
    if (!is_colour(env->scale, LC_MAX_INTENSITY) || !lc_xform_finite(&env->to_world) ||
        !lc_xform_finite(&env->to_light))
        return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "the light's radiance or transform is out of range");
    lc_status st = GROW(s, envs, cap_envs, s->n_envs + 1);
    if (st) return st;
    s->envs[s->n_envs] = *env;
    s->envs[s->n_envs].own_scale = env->scale;
    s->envs[s->n_envs++].group = s->groups.now;
    return LC_OK;
}

lc_status lc_scene_add_emission_map(lc_scene *s, const lc_mipmap *map, uint32_t *id)
{
    lc_status st = GROW(s, emission_maps, cap_emission_maps, s->n_emission_maps + 1);
    if (st) return st;
    s->emission_maps[s->n_emission_maps++] = *map;
    *id = (uint32_t)s->n_emission_maps;
    return LC_OK;
}

void lc_spot_map_free(const lc_context *ctx, lc_spot_map *map)
{
    lc_free(ctx, map->texels, (size_t)map->width * map->height * 3, sizeof *map->texels);
    map->texels = NULL;
}

lc_status lc_scene_add_spot_map(lc_scene *s, const lc_spot_map *map, uint32_t *id)
{
    lc_status st = GROW(s, spot_maps, cap_spot_maps, s->n_spot_maps + 1);
    if (st) return st;
    s->spot_maps[s->n_spot_maps++] = *map;
    *id = (uint32_t)s->n_spot_maps;
    return LC_OK;
}

lc_status lc_scene_add_camera(lc_scene *s, lc_pos where, const lc_camera_desc *camera)
{
    lc_camera test;
    if (!lc_camera_init(&test, camera, 1, 1))
        return lc_fail_at(s->ctx, LC_ERR_PARSE, where,
                          "camera: singular transform, or fov or screen window out of range");
    s->camera_desc = *camera;
    s->has_camera = true;
    return LC_OK;
}

lc_status lc_scene_set_film(lc_scene *s, lc_pos where, const lc_film_desc *f)
{
    if (!f->width || !f->height || f->width > LC_MAX_SIDE || f->height > LC_MAX_SIDE ||
        (uint64_t)f->width * f->height > LC_MAX_PIXELS)
        return lc_fail_at(s->ctx, LC_ERR_PARSE, where,
                          "film of %u x %u pixels: each side must be 1 to 65535, the product at most %u",
                          f->width, f->height, LC_MAX_PIXELS);
    if (f->crop[0] >= f->crop[1] || f->crop[2] >= f->crop[3] || f->crop[1] > f->width ||
        f->crop[3] > f->height)
        return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "film: crop window is empty or outside the film");
    if (!(f->scale > 0 && f->scale <= LC_MAX_INTENSITY) || !f->spp || f->spp > LC_MAX_SPP)
        return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "film: scale or samples per pixel out of range");
    if (!lc_pixel_filter_init(&s->filter, &f->filter))
        return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "film: pixel filter out of range");
    char *name = NULL;
    if (f->filename && !(name = lc_arena_text(&s->arena, f->filename, strlen(f->filename))))
        return LC_ERR_MEMORY;
    s->film = *f;
    s->film.filename = name;
    return LC_OK;
}

lc_status lc_scene_note_at(lc_scene *s, lc_pos where, const char *kind, const char *fmt, ...)
{
    for (size_t i = 0; i < s->n_notes; i++)
        if (!strcmp(s->notes[i].kind, kind)) {
            s->n_noted++;
            s->notes[i].count++;
            s->noted = s->notes[i].text;
            return LC_OK;
        }
    char text[1024];
    va_list args;
    va_start(args, fmt);
    lc_warn_at(s->ctx, where, fmt, args);
    va_end(args);
    va_start(args, fmt);
    int n = snprintf(text, 512, "%s:%u:%u: ", where.file ? where.file : "", where.line, where.column);
    vsnprintf(text + (n < 512 ? n : 511), 512, fmt, args);
    va_end(args);
    lc_status st = GROW(s, notes, cap_notes, s->n_notes + 1);
    if (st) return st;
    lc_scene_note note = { lc_arena_text(&s->arena, kind, strlen(kind)),
                           lc_arena_text(&s->arena, text, strlen(text)), 1 };
    if (!note.kind || !note.text) return LC_ERR_MEMORY;
    s->n_noted++;
    s->notes[s->n_notes++] = note;
    s->noted = note.text;
    return LC_OK;
}

static lc_status find_feature(lc_scene *s, const char *kind, const char *name, lc_feature **out)
{
    for (size_t i = 0; i < s->n_features; i++) {
        lc_feature *f = &s->features[i];
        if (strcmp(f->name, name) || strcmp(f->kind, kind)) continue;
        *out = f;
        return LC_OK;
    }
    lc_status st = GROW(s, features, cap_features, s->n_features + 1);
    if (st) return st;
    lc_feature f = { .kind = lc_arena_text(&s->arena, kind, strlen(kind)),
                     .name = lc_arena_text(&s->arena, name, strlen(name)),
                     .text = "" };
    if (!f.kind || !f.name) return LC_ERR_MEMORY;
    *out = &s->features[s->n_features];
    s->features[s->n_features++] = f;
    return LC_OK;
}

lc_status lc_scene_count_feature(lc_scene *s, const char *kind, const char *name, lc_support support,
                                 const char *text)
{
    lc_feature *f;
    lc_status st = find_feature(s, kind, name, &f);
    if (st) return st;
    const char *copy = "";
    if (support > f->support && text && !(copy = lc_arena_text(&s->arena, text, strlen(text)))) {
        if (!f->count) s->n_features--;
        return LC_ERR_MEMORY;
    }
    f->count++;
    if (support <= f->support) return LC_OK;
    f->support = support;
    if (text) f->text = copy;
    return LC_OK;
}
