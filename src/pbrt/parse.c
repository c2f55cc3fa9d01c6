/* parse.c - the table of statements, reading them, scopes and notes. */
#include "pbrt/parse.h"

#include "pbrt/attribute.h"
#include "pbrt/light_group.h"
#include "pbrt/light_source.h"
#include "pbrt/make_texture.h"
#include "pbrt/medium.h"
#include "pbrt/shape_handler.h"

#include <stdio.h>
#include <string.h>

#define MAX_UNKNOWN 100    /* unknown statements after which the file is taken not to be a pbrt file */

/* ---- notes ---- */

void lc_pbrt_printable(char *text)
{
    for (; *text; text++)
        if ((unsigned char)*text < 32 || *text == 127) *text = '?';
}

lc_status lc_pbrt_note(lc_pbrt *p, lc_pos where, const char *kind, const char *fmt, ...)
{
    char text[256], name[96];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    snprintf(name, sizeof name, "%s", kind);
    lc_pbrt_printable(text);
    lc_pbrt_printable(name);
    lc_status st = lc_pbrt_at(p, where);
    return st ? st : lc_build_note(p->scene, name, text);
}

lc_status lc_pbrt_note_name(lc_pbrt *p, lc_pos where, const char *what, const char *name, const char *text)
{
    char kind[96];
    snprintf(kind, sizeof kind, "%s %.60s", what, name);
    return lc_pbrt_note(p, where, kind, "%s '%.60s': %s", what, name, text);
}

static lc_status note_unused(lc_pbrt *p)
{
    for (size_t i = 0; i < p->params.n; i++) {
        const lc_pbrt_param *par = &p->params.items[i];
        char kind[96];
        if (par->used) continue;
        snprintf(kind, sizeof kind, "parameter %.40s.%.40s", p->owner, par->name);
        lc_status st =
            lc_pbrt_note(p, par->pos, kind, "parameter '%.60s' of '%.60s' is ignored", par->name, p->owner);
        if (st) return st;
    }
    return LC_OK;
}

/* ---- scopes ---- */

static const char *const scope_names[] = { "AttributeBegin", "TransformBegin", "ObjectBegin" };

lc_status lc_pbrt_open_scope(lc_pbrt *p, lc_pos where, lc_pbrt_scope_kind kind)
{
    void *scopes = p->scopes;
    lc_status st = lc_grow(p->ctx, &scopes, &p->cap_scopes, p->n_scopes + 1, sizeof *p->scopes);
    p->scopes = scopes;
    if (!st) p->scopes[p->n_scopes++] = (lc_pbrt_scope){ p->attrs, where, kind, false };
    return st;
}

lc_status lc_pbrt_close_scope(lc_pbrt *p, lc_pos where, lc_pbrt_scope_kind kind)
{
    static const char *const ends[] = { "AttributeEnd", "TransformEnd", "ObjectEnd" };
    const lc_pbrt_scope *top = p->n_scopes ? &p->scopes[p->n_scopes - 1] : NULL;
    if (!top) return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "%s without %s", ends[kind], scope_names[kind]);
    if (top->kind != kind)
        return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "%s, but the %s of line %u is still open", ends[kind],
                          scope_names[top->kind], top->opened.line);
    if (top->saved_ctm) {
        const lc_pbrt_ctm *saved = &p->saved[--p->n_saved];
        p->ctm = saved->start;
        p->ctm_end = saved->end;
    }
    const uint32_t inactive = top->attrs.inactive;
    if (kind != LC_PBRT_IN_TRANSFORM) p->attrs = top->attrs;
    p->attrs.inactive = inactive;
    p->n_scopes--;
    return LC_OK;
}

bool lc_pbrt_mirrored(const lc_pbrt *p) { return lc_xform_det3(&p->ctm) < 0; }

static lc_status attribute_begin(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    return lc_pbrt_open_scope(p, s->pos, LC_PBRT_IN_ATTRIBUTE);
}

static lc_status attribute_end(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    return lc_pbrt_close_scope(p, s->pos, LC_PBRT_IN_ATTRIBUTE);
}

static lc_status transform_begin(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    return lc_pbrt_open_scope(p, s->pos, LC_PBRT_IN_TRANSFORM);
}

static lc_status transform_end(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    return lc_pbrt_close_scope(p, s->pos, LC_PBRT_IN_TRANSFORM);
}

static lc_status reverse_orientation(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    (void)s;
    p->attrs.reverse = !p->attrs.reverse;
    return LC_OK;
}

/* ---- world ---- */

static lc_status world_begin(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    if (p->in_world) return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "second WorldBegin");
    p->in_world = true;
    lc_status st = lc_pbrt_apply_options(p, s->pos);
    if (st) return st;
    p->attrs.inactive = 0;
    const lc_pbrt_ctm x = { lc_xform_identity(), lc_xform_identity() };
    st = lc_pbrt_set_ctm(p, s->pos, &x);
    return st ? st : lc_pbrt_name_coords(p, "world", &x);
}

static lc_status note_open_scopes(lc_pbrt *p)
{
    if (!p->n_scopes) return LC_OK;
    const lc_pbrt_scope *top = &p->scopes[p->n_scopes - 1];
    return lc_pbrt_note(p, top->opened, "scope without end", "%s has no end", scope_names[top->kind]);
}

static lc_status world_end(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    (void)s;
    p->world_over = true;
    return LC_OK;
}

static lc_status include(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    const char *lost;
    lc_status st = lc_pbrt_lex_include(&p->lex, s->text_pos[0], s->text[0], &lost);
    if (st || !lost) return st;
    if (!p->in_world)
        return lc_fail_at(p->ctx, LC_ERR_IO, s->text_pos[0], "cannot open '%s': No such file or directory",
                          lost);
    return lc_pbrt_note(p, s->text_pos[0], "missing file",
                        "'%.150s': no such file; what it holds is left out", lost);
}

/* ---- statements without effect ---- */

static lc_status ignore(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    (void)s;
    p->ignored = true;
    lc_pbrt_mark_all(&p->params);
    return LC_OK;
}

static lc_status ignore_v2(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    p->v2 = true;
    return ignore(p, s);
}

typedef enum place { ANYWHERE, BEFORE_WORLD, IN_WORLD } place;

/* The table of statements. After the name come n_num numbers, n_text strings, of which the last n_optional
 * may be absent, and parameters. word: a bare word in place of the string. */
static const struct directive {
    const char *name;
    lc_pbrt_handler *handler;
    place where;
    uint8_t n_num, n_text, n_optional;
    bool params, word;
} directives[] = {
    { "Identity", lc_pbrt_identity, ANYWHERE, 0, 0, 0, false, false },
    { "Translate", lc_pbrt_translate, ANYWHERE, 3, 0, 0, false, false },
    { "Scale", lc_pbrt_scale, ANYWHERE, 3, 0, 0, false, false },
    { "Rotate", lc_pbrt_rotate, ANYWHERE, 4, 0, 0, false, false },
    { "LookAt", lc_pbrt_look_at, ANYWHERE, 9, 0, 0, false, false },
    { "Transform", lc_pbrt_transform, ANYWHERE, 16, 0, 0, false, false },
    { "ConcatTransform", lc_pbrt_concat, ANYWHERE, 16, 0, 0, false, false },
    { "CoordinateSystem", lc_pbrt_coord_system, ANYWHERE, 0, 1, 0, false, false },
    { "CoordSysTransform", lc_pbrt_coord_sys_transform, ANYWHERE, 0, 1, 0, false, false },
    { "TransformTimes", lc_pbrt_transform_times, ANYWHERE, 2, 0, 0, false, false },
    { "ActiveTransform", lc_pbrt_active_transform, ANYWHERE, 0, 1, 0, false, true },
    { "ReverseOrientation", reverse_orientation, ANYWHERE, 0, 0, 0, false, false },
    { "AttributeBegin", attribute_begin, ANYWHERE, 0, 0, 0, false, false },
    { "AttributeEnd", attribute_end, ANYWHERE, 0, 0, 0, false, false },
    { "TransformBegin", transform_begin, ANYWHERE, 0, 0, 0, false, false },
    { "TransformEnd", transform_end, ANYWHERE, 0, 0, 0, false, false },
    { "WorldBegin", world_begin, ANYWHERE, 0, 0, 0, false, false },
    { "WorldEnd", world_end, IN_WORLD, 0, 0, 0, false, false },
    { "Include", include, ANYWHERE, 0, 1, 0, false, false },
    { "Import", include, ANYWHERE, 0, 1, 0, false, false },
    { "Film", lc_pbrt_film, BEFORE_WORLD, 0, 1, 0, true, false },
    { "Camera", lc_pbrt_camera, BEFORE_WORLD, 0, 1, 0, true, false },
    { "Sampler", lc_pbrt_sampler, BEFORE_WORLD, 0, 1, 0, true, false },
    { "Integrator", lc_pbrt_integrator, ANYWHERE, 0, 1, 0, true, false },
    { "SurfaceIntegrator", lc_pbrt_integrator, ANYWHERE, 0, 1, 0, true, false },
    { "VolumeIntegrator", ignore_v2, ANYWHERE, 0, 1, 0, true, false },
    { "Renderer", ignore_v2, ANYWHERE, 0, 1, 0, true, false },
    { "PixelFilter", lc_pbrt_pixel_filter, ANYWHERE, 0, 1, 0, true, false },
    { "Accelerator", ignore, ANYWHERE, 0, 1, 0, true, false },
    { "Option", ignore, ANYWHERE, 0, 0, 0, true, false },
    { "ColorSpace", lc_pbrt_colour_space, ANYWHERE, 0, 1, 0, false, false },
    { "Attribute", lc_pbrt_attribute, ANYWHERE, 0, 1, 0, true, false },
    { "MediumInterface", lc_pbrt_medium_interface, ANYWHERE, 0, 2, 1, true, false },
    { "MakeNamedMedium", lc_pbrt_make_named_medium, ANYWHERE, 0, 1, 0, true, false },
    { "Volume", lc_pbrt_volume, ANYWHERE, 0, 1, 0, true, false },
    { "Material", lc_pbrt_do_material, IN_WORLD, 0, 1, 0, true, false },
    { "MakeNamedMaterial", lc_pbrt_make_named_material, IN_WORLD, 0, 1, 0, true, false },
    { "NamedMaterial", lc_pbrt_named_material, IN_WORLD, 0, 1, 0, true, false },
    { "Texture", lc_pbrt_texture, IN_WORLD, 0, 3, 0, true, false },
    { "Shape", lc_pbrt_shape, IN_WORLD, 0, 1, 0, true, false },
    { "LightSource", lc_pbrt_light, IN_WORLD, 0, 1, 0, true, false },
    { "AreaLightSource", lc_pbrt_area_light, IN_WORLD, 0, 1, 0, true, false },
    { "LightGroup", lc_pbrt_light_group, IN_WORLD, 0, 1, 0, false, false },
    { "ObjectBegin", lc_pbrt_object_begin, IN_WORLD, 0, 1, 0, false, false },
    { "ObjectEnd", lc_pbrt_object_end, IN_WORLD, 0, 0, 0, false, false },
    { "ObjectInstance", lc_pbrt_object_instance, IN_WORLD, 0, 1, 0, false, false },
};

/* ---- reading statements ---- */

static lc_status expected(lc_pbrt *p, const lc_pbrt_token *t, const char *name, const char *what)
{
    if (t->kind == LC_PBRT_END)
        return lc_fail_at(p->ctx, LC_ERR_PARSE, t->pos, "%s: expected %s, found the end of the file", name,
                          what);
    return lc_fail_at(p->ctx, LC_ERR_PARSE, t->pos, "%s: expected %s, found '%.*s'", name, what,
                      t->len < 40 ? (int)t->len : 40, t->text);
}

/* Reads n numbers, with or without brackets around them. */
static lc_status read_numbers(lc_pbrt *p, lc_pbrt_stmt *s, uint32_t n)
{
    const lc_pbrt_token *ahead;
    lc_pbrt_token t;
    lc_status st = lc_pbrt_lex_peek(&p->lex, &ahead);
    if (st) return st;
    bool open = ahead->kind == LC_PBRT_OPEN;
    if (open && (st = lc_pbrt_lex_next(&p->lex, &t))) return st;
    for (uint32_t i = 0; i < n; i++) {
        if ((st = lc_pbrt_lex_next(&p->lex, &t))) return st;
        if (t.kind != LC_PBRT_NUMBER) return expected(p, &t, s->name, "a number");
        s->num[i] = t.number;
    }
    if (!open) return LC_OK;
    if ((st = lc_pbrt_lex_next(&p->lex, &t))) return st;
    return t.kind == LC_PBRT_CLOSE ? LC_OK : expected(p, &t, s->name, "]");
}

static lc_status read_texts(lc_pbrt *p, const struct directive *d, lc_pbrt_stmt *s)
{
    const lc_pbrt_token *t;
    lc_status st = LC_OK;
    for (uint32_t i = 0; i < d->n_text && !st; i++) {
        if ((st = lc_pbrt_lex_peek(&p->lex, &t))) return st;
        bool fits = t->kind == LC_PBRT_STRING || (d->word && t->kind == LC_PBRT_WORD);
        if (!fits && i + d->n_optional >= d->n_text) return LC_OK;
        lc_pbrt_lex_take(&p->lex);
        if (!fits) return expected(p, t, s->name, d->word ? "a name" : "a quoted name");
        s->text[i] = t->text;
        s->text_pos[i] = t->pos;
        s->n_text = i + 1;
        if (t->kind == LC_PBRT_WORD && !(s->text[i] = lc_arena_text(&p->arena, t->text, t->len)))
            return LC_ERR_MEMORY;
    }
    return st;
}

static lc_status run(lc_pbrt *p, const struct directive *d, lc_pos pos)
{
    lc_pbrt_stmt s = { .pos = pos, .name = d->name };
    if (d->where == BEFORE_WORLD && p->in_world)
        return lc_fail_at(p->ctx, LC_ERR_PARSE, pos, "%s after WorldBegin", d->name);
    if (d->where == IN_WORLD && !p->in_world)
        return lc_fail_at(p->ctx, LC_ERR_PARSE, pos, "%s before WorldBegin", d->name);
    uint64_t n_noted = lc_build_noted(p->scene, NULL);
    p->params.n = 0;
    p->ignored = false;
    lc_status st = d->n_num ? read_numbers(p, &s, d->n_num) : LC_OK;
    if (!st) st = read_texts(p, d, &s);
    if (!st && d->params) st = lc_pbrt_params_read(&p->params, &p->lex);
    if (!st && d->params) st = lc_pbrt_take_defaults(p, d->name);
    p->owner = s.n_text ? s.text[0] : d->name;
    if (!st) st = d->handler(p, &s);
    if (!st) st = note_unused(p);
    return st ? st : lc_pbrt_count_feature(p, d->name, n_noted);
}

/* Notes an unknown statement and skips to the next word, which may begin another. */
static lc_status unknown(lc_pbrt *p, const lc_pbrt_token *word)
{
    char name[64];
    snprintf(name, sizeof name, "%.*s", word->len < 60 ? (int)word->len : 60, word->text);
    if (++p->n_unknown > MAX_UNKNOWN)
        return lc_fail_at(p->ctx, LC_ERR_PARSE, word->pos, "more than %d unknown statements", MAX_UNKNOWN);
    lc_status st =
        lc_pbrt_note_name(p, word->pos, "unknown directive", name, "it and its parameters are skipped");
    bool inside = false;
    while (!st) {
        const lc_pbrt_token *t;
        lc_pbrt_token skipped;
        if ((st = lc_pbrt_lex_peek(&p->lex, &t)) || t->kind == LC_PBRT_END) break;
        if (t->kind == LC_PBRT_WORD && !inside && !lc_pbrt_is_word(t, "true") && !lc_pbrt_is_word(t, "false"))
            break;
        inside = t->kind == LC_PBRT_OPEN || (inside && t->kind != LC_PBRT_CLOSE);
        st = lc_pbrt_lex_next(&p->lex, &skipped);
    }
    return st;
}

static lc_status statement(lc_pbrt *p, const lc_pbrt_token *t)
{
    if (t->kind != LC_PBRT_WORD) return expected(p, t, "statement", "a directive");
    const size_t n = sizeof directives / sizeof *directives;
    /* Start at the directive found last: scenes with many lights repeat it. */
    for (size_t k = 0, i = p->last_directive; k < n; k++, i = i + 1 < n ? i + 1 : 0)
        if (*directives[i].name == *t->text && lc_pbrt_is_word(t, directives[i].name)) {
            p->last_directive = i;
            return run(p, &directives[i], t->pos);
        }
    return unknown(p, t);
}

static lc_status parse_all(lc_pbrt *p)
{
    lc_pos end = { 0 };
    while (p->lex.depth) {
        lc_pbrt_token t;
        lc_pbrt_lex_forget(&p->lex);
        lc_status st = lc_pbrt_lex_next(&p->lex, &t);
        if (st) return st;
        if (t.kind == LC_PBRT_END) {
            end = t.pos;
            lc_pbrt_lex_pop(&p->lex);
            continue;
        }
        if (p->world_over) {
            st = lc_pbrt_note(p, t.pos, "after WorldEnd", "what follows WorldEnd is ignored");
            return st ? st : note_open_scopes(p);
        }
        if ((st = statement(p, &t))) return st;
    }
    if (!p->in_world) return lc_fail_at(p->ctx, LC_ERR_PARSE, end, "no WorldBegin in this file");
    return note_open_scopes(p);
}

/* ---- entry points ---- */

static void init(lc_pbrt *p, lc_scene *scene)
{
    memset(p, 0, sizeof *p);
    p->ctx = lc_build_context(scene);
    p->scene = scene;
    lc_arena_init(&p->arena, p->ctx);
    lc_pbrt_lex_init(&p->lex, p->ctx, &p->arena);
    lc_pbrt_params_init(&p->params, p->ctx);
    lc_pbrt_options_init(&p->opt);
    p->attrs.material_id = p->default_material = p->black_material = LC_NONE;
    p->attrs.sides = (lc_boundary){ LC_NONE, LC_NONE };
    p->ctm = p->ctm_end = lc_xform_identity();
    p->light_share = 1;
}

static void destroy(lc_pbrt *p)
{
    const lc_context *ctx = p->ctx;
    lc_pbrt_map *maps[] = { &p->material_names, &p->colour_textures, &p->float_textures, &p->image_names,
                            &p->emission_names, &p->object_names,    &p->coord_names,    &p->table_names,
                            &p->medium_names };
    lc_pbrt_free_tables(p);
    for (size_t i = 0; i < sizeof maps / sizeof *maps; i++) lc_pbrt_map_free(maps[i], ctx);
    lc_pbrt_free_defaults(p);
    lc_free(ctx, p->scopes, p->cap_scopes, sizeof *p->scopes);
    lc_free(ctx, p->saved, p->cap_saved, sizeof *p->saved);
    lc_free(ctx, p->materials, p->cap_materials, sizeof *p->materials);
    lc_free(ctx, p->coords, p->cap_coords, sizeof *p->coords);
    lc_free(ctx, p->objects, p->cap_objects, sizeof *p->objects);
    lc_free(ctx, p->object_meshes, p->cap_object_meshes, sizeof *p->object_meshes);
    lc_free(ctx, p->places, p->cap_places, sizeof *p->places);
    lc_free(ctx, p->pos, p->cap_pos, sizeof *p->pos);
    lc_free(ctx, p->normal, p->cap_normal, sizeof *p->normal);
    lc_free(ctx, p->uv, p->cap_uv, sizeof *p->uv);
    lc_free(ctx, p->index, p->cap_index, sizeof *p->index);
    lc_pbrt_params_free(&p->params);
    lc_pbrt_lex_free(&p->lex);
    lc_arena_free(&p->arena);
}

static lc_status parse(lc_scene *scene, const char *path, const void *data, size_t size)
{
    lc_context *ctx = lc_build_context(scene);
    lc_pbrt *p = lc_alloc(ctx, 1, sizeof *p);
    if (!p) return LC_ERR_MEMORY;
    init(p, scene);
    lc_status st =
        data ? lc_pbrt_lex_open_memory(&p->lex, path, data, size) : lc_pbrt_lex_open(&p->lex, path);
    if (!st) st = parse_all(p);
    if (!st) st = lc_pbrt_place_objects(p);
    if (!st) st = lc_pbrt_usual_integrator(p);
    if (!st && p->lex.comma.file)
        st = lc_pbrt_note(p, p->lex.comma, "comma", "commas between the values of lists are read as spaces");
    destroy(p);
    lc_free(ctx, p, 1, sizeof *p);
    return st;
}

lc_status lc_pbrt_parse(lc_scene *scene, const char *path) { return parse(scene, path, NULL, 0); }

lc_status lc_pbrt_parse_memory(lc_scene *scene, const char *name, const void *data, size_t size)
{
    return parse(scene, name, data ? data : "", size);
}
