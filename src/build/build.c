/* build.c - public calls that make a scene: check every argument, then call the scene builder.
 *
 * What each call was given goes into the scene's digest, as the bytes of files do: equal ids of pictures mean
 * equal scenes. What can be set again goes into it by lc_given_id. */
#include "build/build.h"

#include "base/desc.h"
#include "base/memory.h"
#include "base/motion.h"
#include "base/text.h"
#include "build/reader.h"
#include "scene/instance.h"
#include "scene/motion.h"
#include "scene/named.h"
#include "scene/usual_view.h"

#include <stdio.h>

#define MAX_KINDS 500  /* limits the kinds of notes and of features, which hostile files could multiply */
#define MAX_KIND  96   /* bytes of their names */
#define MAX_WHITE 1e6f /* of a white balance */
#define MAX_NOTE  500  /* bytes of a note */

lc_status lc_build_take(const lc_scene *s, const char *name, void *to, size_t size, const void *desc)
{
    if (!s) return LC_ERR_ARG;
    if (s->committed)
        return lc_fail(s->ctx, LC_ERR_ARG, "%s: the scene takes no more: it was loaded or committed", name);
    if (!to) return LC_OK;
    if (!desc) return lc_fail(s->ctx, LC_ERR_ARG, "%s is NULL", name);
    return lc_desc_take(s->ctx, name, to, size, desc);
}

static void add_floats(lc_scene *s, const float *v, size_t n)
{
    lc_digest_add(&s->inputs.digest, v, n * sizeof *v);
}

/* Keeps the scene's number of what a call has given. */
static lc_status number_of(lc_scene *s, uint32_t **list, size_t *n, size_t *cap)
{
    const lc_status st = lc_grow(s->ctx, (void **)list, cap, *n + 1, sizeof **list);
    if (!st) (*list)[(*n)++] = LC_NONE;
    return st;
}

bool lc_build_mark(lc_scene *s, int call)
{
    if (!s->by_calls) return false;
    lc_digest_mark(&s->inputs.digest);
    lc_digest_u64(&s->inputs.digest, (uint64_t)call);
    return true;
}

lc_status lc_build_wrong(const lc_scene *s, const char *call, const char *what)
{
    if (s->at.file) return lc_fail_at(s->ctx, LC_ERR_PARSE, s->at, "%s", what);
    return lc_fail(s->ctx, LC_ERR_ARG, "%s: %s", call, what);
}

lc_context *lc_build_context(const lc_scene *s) { return s->ctx; }

const lc_load_desc *lc_build_asked(const lc_scene *s) { return &s->load; }

lc_status lc_build_begin(lc_context *ctx, lc_scene **out)
{
    if (out) *out = NULL;
    if (!ctx) return LC_ERR_ARG;
    if (!out) return lc_fail(ctx, LC_ERR_ARG, "lc_build_begin: out is NULL");
    lc_scene *s;
    lc_status st = lc_scene_create(ctx, &s);
    if (st) return st;
    s->by_calls = true;
    *out = s;
    return LC_OK;
}

/* ---- places and notes ---- */

lc_status lc_build_at(lc_scene *s, const char *file, uint32_t line, uint32_t column)
{
    lc_status st = lc_build_take(s, "lc_build_at", NULL, 0, NULL);
    if (st) return st;
    if (file && (!s->at.file || strcmp(file, s->at.file))) {
        const size_t n = strlen(file) + 1;
        s->at.file = NULL;
        if ((st = lc_grow(s->ctx, (void **)&s->at_file, &s->cap_at_file, n, 1))) return st;
        memmove(s->at_file, file, n);
    }
    s->at = (lc_pos){ file ? s->at_file : NULL, file ? line : 0, file ? column : 0 };
    return LC_OK;
}

lc_status lc_build_note(lc_scene *s, const char *kind, const char *text)
{
    char name[MAX_KIND], line[MAX_NOTE];
    lc_status st = lc_build_take(s, "lc_build_note", NULL, 0, NULL);
    if (st) return st;
    if (!kind || !text) return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_note: kind or text is NULL");
    snprintf(name, sizeof name, "%s", s->n_notes < MAX_KINDS ? kind : "other");
    snprintf(line, sizeof line, "%s", text);
    lc_text_clean(name);
    lc_text_clean(line);
    return lc_scene_note_at(s, s->at, name, "%s", line);
}

uint64_t lc_build_noted(const lc_scene *s, const char **text)
{
    if (text) *text = s && s->noted ? s->noted : "";
    return s ? s->n_noted : 0;
}

/* A short name of ASCII, as almost all are: files may have many statements. */
static bool is_plain(const char *name)
{
    size_t n = 0;
    while (n < MAX_KIND && name[n] >= ' ' && name[n] < 127) n++;
    return n < MAX_KIND && !name[n];
}

lc_status lc_build_feature(lc_scene *s, const char *kind, const char *name, lc_support support,
                           const char *text)
{
    char clean[MAX_KIND];
    lc_status st = lc_build_take(s, "lc_build_feature", NULL, 0, NULL);
    if (st) return st;
    if (!kind || !name) return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_feature: kind or name is NULL");
    if ((unsigned)support > LC_SUPPORT_IGNORED)
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_feature: support is none of lc_support");
    if (s->n_features >= MAX_KINDS) name = "other";
    if (is_plain(name)) return lc_scene_count_feature(s, kind, name, support, text);
    snprintf(clean, sizeof clean, "%s", name);
    lc_text_clean(clean);
    return lc_scene_count_feature(s, kind, clean, support, text);
}

lc_status lc_build_paths(lc_scene *s, int traced, uint32_t max_depth)
{
    lc_status st = lc_build_take(s, "lc_build_paths", NULL, 0, NULL);
    if (st) return st;
    if (!max_depth || max_depth > LC_MAX_DEPTH)
        return lc_build_wrong(s, "lc_build_paths", "max_depth must be 1 to 1000");
    s->traces_paths = traced != 0;
    s->max_depth = max_depth;
    if (!lc_build_mark(s, LC_CALL_PATHS)) return LC_OK;
    lc_digest_u64(&s->inputs.digest, (uint64_t)max_depth << 1 | s->traces_paths);
    return LC_OK;
}

/* ---- meshes ---- */

static lc_status check_mesh(const lc_scene *s, const char *call, const lc_build_mesh_desc *d)
{
    const char *wrong = NULL;
    if (d->n_vertices && !d->positions) wrong = "positions are NULL";
    if (d->n_triangles && !d->indices) wrong = "indices are NULL";
    if (d->material >= s->n_materials) wrong = "material is not one of the scene's";
    if (!(d->alpha >= 0 && d->alpha <= 1)) wrong = "alpha must be 0 to 1";
    if (lc_build_check_texture(s, d->alpha_texture, true)) wrong = "alpha_texture is not one of one channel";
    for (size_t i = 0; d->uv && i < (size_t)d->n_vertices * 2; i++)
        if (!isfinite(d->uv[i])) wrong = "uv is not finite";
    if (lc_build_check_texture(s, d->emission_texture, false))
        wrong = "emission_texture is not one of the scene's";
    if (lc_build_check_texture(s, d->shadow_texture, true))
        wrong = "shadow_texture is not one of one channel";
    if (!(d->shadow_alpha >= 0 && d->shadow_alpha <= 1)) wrong = "shadow_alpha must be 0 to 1";
    if (d->emission_picture != LC_NO_PICTURE && d->emission_picture >= s->given.n_pictures)
        wrong = "emission_picture is not one of the scene's";
    return wrong ? lc_build_wrong(s, call, wrong) : LC_OK;
}

static lc_status check_object(const lc_scene *s, const lc_build_mesh_desc *d)
{
    static const char call[] = "lc_build_mesh";
    if (s->given.placed) return lc_build_wrong(s, call, "the meshes of an object come before its instances");
    for (int k = 0; k < 3; k++)
        if (s->n_objects && (d->emission[k] < 0 || d->emission[k] > 0))
            return lc_build_wrong(s, call, "emission: a mesh of an object must not emit");
    return LC_OK;
}

/* Of a scene by calls: the numbers by which a host knows the mesh, and what it is known by. */
static lc_status number_mesh(lc_scene *s, const lc_mesh_desc *m)
{
    lc_given *g = &s->given;
    const size_t before = s->n_meshes;
    lc_status st = number_of(s, &g->meshes, &g->n_meshes, &g->cap_meshes);
    if (st) return st;
    if ((st = lc_build_status(s, lc_scene_add_mesh(s, s->at, m)))) {
        g->n_meshes--;
        return st;
    }
    if (s->n_meshes > before) g->meshes[g->n_meshes - 1] = (uint32_t)before;
    return LC_OK;
}

/* Adds a mesh with the names that were chosen. */
static lc_status add_numbered(lc_scene *s, const lc_mesh_desc *m)
{
    const size_t at = s->by_calls ? s->given.n_meshes : s->n_meshes;
    const lc_status st = lc_names_begin(s, LC_NAMED_MESH, at);
    if (st) return st;
    return s->by_calls ? number_mesh(s, m) : lc_scene_add_mesh(s, s->at, m);
}

static void digest_mesh(lc_scene *s, const lc_build_mesh_desc *d)
{
    if (!lc_build_mark(s, LC_CALL_MESH)) return;
    lc_digest_u64(&s->inputs.digest, d->n_vertices);
    lc_digest_u64(&s->inputs.digest, d->n_triangles);
    lc_digest_u64(&s->inputs.digest, d->material);
    lc_digest_u64(&s->inputs.digest,
                  (d->uv ? 8u : 0) + (d->normals ? 4u : 0) + (d->flip ? 2u : 0) + (d->two_sided ? 1u : 0));
    lc_digest_u64(&s->inputs.digest, (uint64_t)d->alpha_texture << 32 | d->emission_texture);
    lc_digest_u64(&s->inputs.digest, (uint64_t)d->shadow_texture << 32 | d->emission_picture);
    add_floats(s, &d->alpha, 1);
    add_floats(s, &d->shadow_alpha, 1);
    if (d->uv) add_floats(s, d->uv, (size_t)d->n_vertices * 2);
    add_floats(s, d->positions, (size_t)d->n_vertices * 3);
    if (d->normals) add_floats(s, d->normals, (size_t)d->n_vertices * 3);
    lc_digest_add(&s->inputs.digest, d->indices, (size_t)d->n_triangles * 3 * sizeof *d->indices);
    lc_build_mark_group(s);
}

/* The mesh as the scene takes it, *hole for its alpha. */
static lc_status describe_mesh(lc_scene *s, const lc_build_mesh_desc *d, lc_mesh_alpha *hole, lc_mesh_desc *m)
{
    const bool holes = d->alpha_texture != LC_NO_TEXTURE || d->alpha < 1 ||
                       d->shadow_texture != LC_NO_TEXTURE || d->shadow_alpha < 1;
    const double alpha = (double)d->alpha, shadow = (double)d->shadow_alpha;
    *hole = (lc_mesh_alpha){ { d->alpha_texture, { alpha, alpha, alpha } },
                             { d->shadow_texture, { shadow, shadow, shadow } } };
    *m = (lc_mesh_desc){ .n_verts = d->n_vertices,
                         .n_tris = d->n_triangles,
                         .pos = d->positions,
                         .normal = d->normals,
                         .uv = d->uv,
                         .alpha = holes ? hole : NULL,
                         .index = d->indices,
                         .material_id = d->material,
                         .flip = d->flip,
                         .emission = lc_f3_load(d->emission),
                         .two_sided = d->two_sided };
    if (d->emission_picture != LC_NO_PICTURE)
        return lc_picture_as_emission(s, d->emission_picture, &m->emission_map);
    if (d->emission_texture != LC_NO_TEXTURE)
        return lc_build_emission_map(s, d->emission_texture, &m->emission_map);
    return LC_OK;
}

lc_status lc_build_mesh(lc_scene *s, const lc_build_mesh_desc *desc)
{
    lc_build_mesh_desc d = LC_BUILD_MESH_DESC_INIT;
    lc_mesh_alpha hole;
    lc_mesh_desc m;
    lc_status st = lc_build_take(s, "lc_build_mesh_desc", &d, sizeof d, desc);
    if (!st) st = check_mesh(s, "lc_build_mesh", &d);
    if (!st) st = check_object(s, &d);
    if (!st) st = describe_mesh(s, &d, &hole, &m);
    if (st) return st;
    const uint32_t had = s->groups.n;
    if (!st) st = lc_build_begin_group(s, "lc_build_mesh", d.group);
    if (!st) st = add_numbered(s, &m);
    if (!st) digest_mesh(s, &d);
    return lc_build_end_group(s, had, st);
}

lc_status lc_build_object(lc_scene *s, uint32_t *id)
{
    lc_status st = lc_build_take(s, "lc_build_object", NULL, 0, NULL);
    if (st) return st;
    if (!id) return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_object: id is NULL");
    if ((st = lc_scene_begin_object(s))) return st;
    *id = (uint32_t)s->n_objects - 1;
    s->given.placed = false;
    lc_build_mark(s, LC_CALL_OBJECT);
    return LC_OK;
}

/* to: NULL where it does not move. */
static lc_status place(lc_scene *s, const char *call, uint32_t object, const double *from, const double *to)
{
    lc_xform x, end;
    lc_status st = lc_build_take(s, call, NULL, 0, NULL);
    if (st) return st;
    if (object >= s->n_objects)
        return lc_fail(s->ctx, LC_ERR_ARG, "%s: object %u of %zu", call, object, s->n_objects);
    if ((st = lc_arg_to_world(s, call, from, &x))) return st;
    if (to && (st = lc_arg_to_world(s, call, to, &end))) return st;
    lc_given *g = &s->given;
    const size_t before = s->n_instances;
    if ((st = lc_names_begin(s, LC_NAMED_INSTANCE, s->by_calls ? g->n_instances : before))) return st;
    if (s->by_calls && (st = number_of(s, &g->instances, &g->n_instances, &g->cap_instances))) return st;
    st = lc_scene_add_instance(s, s->at, object, &x);
    if (!st && to && s->n_instances > before && (st = lc_scene_add_motion(s, s->at, &x, &end)))
        s->n_instances = before;
    if ((st = lc_build_status(s, st))) {
        g->n_instances -= s->by_calls;
        return st;
    }
    if (s->n_instances > before && s->by_calls) g->instances[g->n_instances - 1] = (uint32_t)before;
    if (object + 1 == s->n_objects) g->placed = true;
    return LC_OK;
}

lc_status lc_build_instance(lc_scene *s, uint32_t object, const double to_world[16])
{
    return place(s, "lc_build_instance", object, to_world, NULL);
}

lc_status lc_build_moving_instance(lc_scene *s, uint32_t object, const double from[16], const double to[16])
{
    if (s && !to) return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_moving_instance: to is NULL");
    return place(s, "lc_build_moving_instance", object, from, to);
}

/* ---- lamps that move ---- */

/* A lamp has so many places that these have no more than LAMP_TRIS triangles, but LEAST_PLACES; fewer as all
 * lamps' places have more triangles. */
#define LAMP_TRIS    (1u << 17)
#define LEAST_PLACES 8u

static uint32_t places_of(const lc_scene *s, const lc_mesh_desc *m, const lc_xform *from, const lc_xform *to)
{
    static const struct {
        size_t up_to; /* triangles of all places, this lamp's included */
        uint32_t most;
    } levels[] = { { (size_t)1 << 20, 64 }, { (size_t)1 << 21, 16 }, { (size_t)1 << 22, 4 } };
    const uint32_t fit = LAMP_TRIS / m->n_tris, wanted = fit < LEAST_PLACES ? LEAST_PLACES : fit;
    if (!memcmp(from, to, sizeof *from)) return 1;
    for (size_t i = 0; i < sizeof levels / sizeof *levels; i++) {
        const uint32_t n = wanted < levels[i].most ? wanted : levels[i].most;
        if (s->n_unseen_tris + (size_t)n * m->n_tris <= levels[i].up_to) return n;
    }
    return 1;
}

static void move_mesh(const lc_mesh_desc *m, const lc_xform *x, float *pos, float *normal)
{
    double rows[9];
    lc_xform_normal_rows(x, rows);
    for (size_t i = 0; i < (size_t)m->n_verts * 3; i += 3) {
        const double v[3] = { (double)m->pos[i], (double)m->pos[i + 1], (double)m->pos[i + 2] };
        lc_xform_point(x, v, pos + i);
        if (m->normal) lc_xform_normal(rows, m->normal + i, normal + i);
    }
}

/* Adds an object of what gives the lamp's light: the mesh at n places evenly along its way, each with its
 * share of the emission. */
static lc_status add_places(lc_scene *s, const lc_mesh_desc *mesh, uint32_t n, const lc_xform *from,
                            const lc_xform *to)
{
    const size_t n_floats = (size_t)mesh->n_verts * 3;
    lc_xform x;
    lc_status st = lc_scene_begin_object(s);
    if (st) return st;
    s->objects[s->n_objects - 1].unseen = true;
    float *room = lc_alloc_raw(s->ctx, 2 * n_floats, sizeof *room);
    if (!room) return LC_ERR_MEMORY;
    lc_mesh_desc m = *mesh;
    m.emission = lc_f3_scale(m.emission, 1 / (float)n);
    m.is_place = true;
    m.pos = room;
    if (m.normal) m.normal = room + n_floats;
    for (uint32_t i = 0; i < n && !st; i++) {
        if (!lc_xform_between(from, to, (i + 0.5) / n, &x)) st = LC_ERR_ARG;
        if (st) break;
        move_mesh(mesh, &x, room, room + n_floats);
        m.flip = mesh->flip != (lc_xform_det3(&x) < 0);
        st = lc_scene_add_mesh(s, s->at, &m);
    }
    lc_free(s->ctx, room, 2 * n_floats, sizeof *room);
    return st;
}

/* Adds an object of the mesh as it is seen, through which shadow rays pass, and its instance. */
static lc_status add_seen(lc_scene *s, const lc_mesh_desc *mesh, uint32_t n_places, const lc_xform *from,
                          const lc_xform *to)
{
    lc_mesh_desc m = *mesh;
    lc_mesh_alpha hole = { { LC_NO_TEXTURE, { 1, 1, 1 } }, { LC_NO_TEXTURE, { 0, 0, 0 } } };
    if (m.alpha) hole.alpha = m.alpha->alpha;
    m.alpha = &hole;
    m.n_places = n_places;
    lc_status st = lc_scene_begin_object(s);
    if (!st) st = add_numbered(s, &m);
    if (!st) st = lc_scene_add_instance(s, s->at, (uint32_t)s->n_objects - 1, from);
    return st ? st : lc_scene_add_motion(s, s->at, from, to);
}

lc_status lc_build_moving_lamp(lc_scene *s, const lc_build_mesh_desc *desc, const double from[16],
                               const double to[16])
{
    static const char call[] = "lc_build_moving_lamp";
    lc_build_mesh_desc d = LC_BUILD_MESH_DESC_INIT;
    lc_mesh_alpha hole;
    lc_mesh_desc m;
    lc_xform x, end;
    lc_status st = lc_build_take(s, "lc_build_mesh_desc", &d, sizeof d, desc);
    if (!st) st = check_mesh(s, call, &d);
    if (!st && !(lc_f3_max(lc_f3_load(d.emission)) > 0))
        st = lc_build_wrong(s, call, "emission must be above 0");
    if (!st && !d.n_triangles) st = lc_build_wrong(s, call, "there are no triangles");
    if (!st) st = lc_arg_to_world(s, call, from, &x);
    if (!st) st = lc_arg_to_world(s, call, to, &end);
    if (!st) st = describe_mesh(s, &d, &hole, &m);
    if (st) return st;
    const uint32_t had = s->groups.n;
    st = lc_build_begin_group(s, call, d.group);
    const uint32_t n = places_of(s, &m, &x, &end);
    if (!st) st = lc_build_status(s, add_seen(s, &m, n, &x, &end));
    if (!st) st = lc_build_status(s, add_places(s, &m, n, &x, &end));
    s->given.placed = true; /* no further meshes belong to these objects */
    if (!st) digest_mesh(s, &d);
    if (!st && lc_build_mark(s, LC_CALL_MOVING_LAMP)) {
        lc_digest_add(&s->inputs.digest, x.m, sizeof x.m);
        lc_digest_add(&s->inputs.digest, end.m, sizeof end.m);
    }
    return lc_build_end_group(s, had, st);
}

int lc_build_instance_fits(const double to_world[16])
{
    lc_xform x;
    if (!to_world) return 0;
    memcpy(x.m, to_world, sizeof x.m);
    return lc_instance_fits(&x);
}

/* ---- camera and film ---- */

lc_status lc_build_camera(lc_scene *s, const lc_build_camera_desc *desc)
{
    lc_camera_desc camera;
    lc_build_camera_desc d = LC_BUILD_CAMERA_DESC_INIT;
    lc_status st = lc_build_take(s, "lc_build_camera", NULL, 0, NULL);
    if (!st) st = lc_arg_camera(s, "lc_build_camera", desc, &camera);
    if (!st) st = lc_build_status(s, lc_scene_add_camera(s, s->at, &camera));
    if (!st) st = lc_desc_take(s->ctx, "lc_build_camera_desc", &d, sizeof d, desc);
    if (st) return st;
    s->own_screen = !lc_arg_is_none(d.screen, 4);
    s->media.around = d.medium;
    return LC_OK;
}

lc_status lc_build_camera_motion(lc_scene *s, const double world_to_camera[16])
{
    lc_xform to;
    lc_status st = lc_build_take(s, "lc_build_camera_motion", NULL, 0, NULL);
    if (st) return st;
    if (!s->has_camera || !world_to_camera)
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_camera_motion: there is no camera, or no matrix");
    memcpy(to.m, world_to_camera, sizeof to.m);
    if (!lc_xform_finite(&to) || lc_scene_move_view(s, &to))
        return lc_build_wrong(s, "lc_build_camera_motion", "there is no way to this matrix");
    return LC_OK;
}

lc_status lc_build_usual_camera(lc_scene *s)
{
    lc_status st = lc_build_take(s, "lc_build_usual_camera", NULL, 0, NULL);
    if (!st) st = lc_build_status(s, lc_scene_usual_camera(s, s->at));
    if (!st) s->own_screen = false;
    return st;
}

lc_status lc_build_film(lc_scene *s, const lc_build_film_desc *desc)
{
    static const double radius[] = { 0.5, 2, 1.5, 2, 4 }, shape[] = { 0, 0, 2, 1.0 / 3, 3 };
    lc_build_film_desc d = LC_BUILD_FILM_DESC_INIT;
    lc_status st = lc_build_take(s, "lc_build_film_desc", &d, sizeof d, desc);
    if (st) return st;
    if ((unsigned)d.filter > LC_BUILD_SINC)
        return lc_build_wrong(s, "lc_build_film", "filter is none of lc_build_pixel_filter");
    lc_film_desc film = { .width = d.width,
                          .height = d.height,
                          .crop = { 0, d.width, 0, d.height },
                          .scale = d.scale,
                          .spp = d.spp,
                          .filename = d.filename,
                          .filter = { .kind = (lc_pixel_filter_kind)d.filter } };
    for (int i = 0; i < 4 && (d.crop[0] || d.crop[1] || d.crop[2] || d.crop[3]); i++)
        film.crop[i] = d.crop[i];
    const bool usual = !d.own_shape && lc_arg_is_none(d.shape, 2);
    memcpy(film.white, d.white, sizeof film.white);
    for (int i = 0; i < 9; i++)
        if (!(fabsf(d.white[i]) <= MAX_WHITE))
            return lc_build_wrong(s, "lc_build_film", "white is out of range");
    for (int i = 0; i < 2; i++) {
        film.filter.radius[i] = fabs(d.radius[i]) <= 0 ? radius[d.filter] : d.radius[i];
        film.filter.shape[i] = !usual                                    ? d.shape[i]
                               : i == 0 || d.filter == LC_BUILD_MITCHELL ? shape[d.filter]
                                                                         : 0;
    }
    return lc_build_status(s, lc_scene_set_film(s, s->at, &film));
}
