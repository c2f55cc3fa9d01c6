/* value.c - members of glTF's JSON objects: of the right kind and in range, or an error with their place. */
#include "gltf/state.h"

#include "base/text.h"

#include <stdio.h>
#include <string.h>

lc_status lc_gltf_fail(const lc_gltf *g, uint32_t value, const char *fmt, ...)
{
    char text[400];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    lc_text_clean(text);
    return lc_fail_at(g->ctx, LC_ERR_PARSE, lc_json_pos(&g->json, value), "%s", text);
}

lc_status lc_gltf_note(lc_gltf *g, uint32_t value, const char *kind, const char *fmt, ...)
{
    char text[400];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    lc_status st = lc_gltf_at(g, value);
    return st ? st : lc_build_note(g->scene, kind, text);
}

lc_status lc_gltf_at(const lc_gltf *g, uint32_t value)
{
    return lc_build_at_pos(g->scene, lc_json_pos(&g->json, value));
}

static lc_status expected(const lc_gltf *g, uint32_t value, const char *what)
{
    const lc_json_value *v = &g->json.values[value];
    return lc_gltf_fail(g, value, "%s%.60s%sexpected %s", v->key == LC_NONE ? "" : "'",
                        v->key == LC_NONE ? "" : lc_json_name(&g->json, value),
                        v->key == LC_NONE ? "" : "': ", what);
}

static lc_status make_list(lc_gltf *g, uint32_t object, const char *name, lc_gltf_list *out)
{
    uint32_t array, n = 0;
    lc_status st = lc_gltf_member(g, object, name, LC_JSON_ARRAY, &array);
    if (st || array == LC_NONE) return st;
    const lc_json_value *v = g->json.values;
    out->items = lc_arena_alloc(&g->arena, v[array].n, sizeof *out->items);
    if (!out->items) return LC_ERR_MEMORY;
    for (uint32_t at = array + 1; at < v[array].next; at = v[at].next) {
        if (v[at].kind != LC_JSON_OBJECT) return expected(g, at, "an object");
        out->items[n++] = at;
    }
    out->n = n;
    return LC_OK;
}

lc_status lc_gltf_make_lists(lc_gltf *g)
{
    static const char *const names[] = { "buffers",  "bufferViews", "accessors", "images",
                                         "samplers", "textures",    "materials", "meshes",
                                         "cameras",  "nodes",       "scenes" };
    lc_status st = LC_OK;
    for (uint32_t i = 0; i < LC_GLTF_LIGHTS && !st; i++) st = make_list(g, 0, names[i], &g->lists[i]);
    uint32_t lights = lc_gltf_extension(g, 0, "KHR_lights_punctual");
    return st ? st : make_list(g, lights, "lights", &g->lists[LC_GLTF_LIGHTS]);
}

/* ---- members ---- */

lc_status lc_gltf_member(const lc_gltf *g, uint32_t object, const char *name, lc_json_kind kind,
                         uint32_t *out)
{
    *out = lc_json_find(&g->json, object, name);
    if (*out == LC_NONE || g->json.values[*out].kind == kind) return LC_OK;
    return expected(g, *out, kind == LC_JSON_ARRAY ? "an array" : "an object");
}

uint32_t lc_gltf_extension(const lc_gltf *g, uint32_t object, const char *name)
{
    return lc_json_find(&g->json, lc_json_find(&g->json, object, "extensions"), name);
}

static lc_status check_number(const lc_gltf *g, uint32_t value, double least, double most, double *out)
{
    const lc_json_value *v = &g->json.values[value];
    if (v->kind != LC_JSON_NUMBER) return expected(g, value, "a number");
    if (!(v->number >= least && v->number <= most))
        return lc_gltf_fail(g, value, "%g is not in %g .. %g", v->number, least, most);
    *out = v->number;
    return LC_OK;
}

lc_status lc_gltf_number(const lc_gltf *g, uint32_t object, const char *name, double least, double most,
                         double *out)
{
    uint32_t at = lc_json_find(&g->json, object, name);
    return at == LC_NONE ? LC_OK : check_number(g, at, least, most, out);
}

lc_status lc_gltf_numbers(const lc_gltf *g, uint32_t object, const char *name, uint32_t n, double *out,
                          bool *there)
{
    uint32_t array, i = 0;
    const lc_json_value *v = g->json.values;
    lc_status st = lc_gltf_member(g, object, name, LC_JSON_ARRAY, &array);
    if (there) *there = array != LC_NONE;
    if (st || array == LC_NONE) return st;
    if (v[array].n != n) return lc_gltf_fail(g, array, "'%s': %u numbers, not %u", name, v[array].n, n);
    for (uint32_t at = array + 1; at < v[array].next && !st; at = v[at].next)
        st = check_number(g, at, -1e30, 1e30, &out[i++]);
    return st;
}

lc_status lc_gltf_size(const lc_gltf *g, uint32_t object, const char *name, uint64_t *out, bool *there)
{
    uint32_t at = lc_json_find(&g->json, object, name);
    double v = 0;
    if (there) *there = at != LC_NONE;
    if (at == LC_NONE) return LC_OK;
    lc_status st = check_number(g, at, 0, 9007199254740991.0, &v);
    if (!st && floor(v) < v) st = expected(g, at, "an integer");
    if (!st) *out = (uint64_t)v;
    return st;
}

lc_status lc_gltf_bool(const lc_gltf *g, uint32_t object, const char *name, bool *out)
{
    uint32_t at = lc_json_find(&g->json, object, name);
    if (at == LC_NONE) return LC_OK;
    uint32_t kind = g->json.values[at].kind;
    if (kind != LC_JSON_TRUE && kind != LC_JSON_FALSE) return expected(g, at, "true or false");
    *out = kind == LC_JSON_TRUE;
    return LC_OK;
}

lc_status lc_gltf_text(const lc_gltf *g, uint32_t object, const char *name, const char **out)
{
    uint32_t at = lc_json_find(&g->json, object, name);
    *out = NULL;
    if (at == LC_NONE) return LC_OK;
    if (g->json.values[at].kind != LC_JSON_TEXT) return expected(g, at, "a text");
    *out = lc_json_text(&g->json, at);
    return LC_OK;
}

lc_status lc_gltf_check_index(const lc_gltf *g, uint32_t value, lc_gltf_kind kind, uint32_t *out)
{
    static const char *const names[] = { "buffers",  "buffer views", "accessors", "images",
                                         "samplers", "textures",     "materials", "meshes",
                                         "cameras",  "nodes",        "scenes",    "lights" };
    double v = 0;
    lc_status st = check_number(g, value, -1e30, 1e30, &v);
    if (st) return st;
    if (!(v >= 0 && v < g->lists[kind].n) || floor(v) < v)
        return lc_gltf_fail(g, value, "%g is none of %u %s", v, g->lists[kind].n, names[kind]);
    *out = (uint32_t)v;
    return LC_OK;
}

lc_status lc_gltf_index(const lc_gltf *g, uint32_t object, const char *name, lc_gltf_kind kind, uint32_t *out)
{
    uint32_t at = lc_json_find(&g->json, object, name);
    *out = LC_NONE;
    return at == LC_NONE ? LC_OK : lc_gltf_check_index(g, at, kind, out);
}

const char *lc_gltf_name(const lc_gltf *g, uint32_t object)
{
    const uint32_t value = object == LC_NONE ? LC_NONE : lc_json_find(&g->json, object, "name");
    if (value == LC_NONE || g->json.values[value].kind != LC_JSON_TEXT) return NULL;
    return lc_json_text(&g->json, value);
}
