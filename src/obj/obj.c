/* obj.c - statements of OBJ files. Faces gather until the material changes; corners that have the same
 * vertex, texture coordinates and normal share a vertex of the mesh. */
#include "obj/obj.h"

#include "base/rng.h"
#include "base/text.h"
#include "io/readfile.h"
#include "obj/state.h"
#include "scene/group_names.h"
#include "scene/usual_view.h"

#include <stdio.h>
#include <string.h>

#define MAX_NOTES   500   /* limits the kinds of notes */
#define MAX_CORNERS 1000u /* of a face */
#define MAX_UNKNOWN 100   /* unknown statements after which the file is taken not to be OBJ */

lc_status lc_obj_note(lc_obj *o, lc_pos where, const char *kind, const char *fmt, ...)
{
    char text[400];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    lc_text_clean(text);
    return lc_scene_note_at(o->scene, where, o->scene->n_notes < MAX_NOTES ? kind : "other", "%s", text);
}

const char *lc_obj_join(lc_obj *o, const char *folder, const lc_obj_word *name)
{
    size_t n = name->len && *name->text == '/' ? 0 : strlen(folder);
    char *path = lc_arena_alloc(&o->arena, n + name->len + 1, 1);
    if (!path) return NULL;
    memcpy(path, folder, n);
    for (size_t i = 0; i < name->len; i++) path[n + i] = name->text[i] == '\\' ? '/' : name->text[i];
    return path;
}

/* ---- meshes ---- */

/* The arrays of a mesh, and a table of its vertices by their corners: 1 + number, 0 is free. */
typedef struct build {
    float *pos, *uv, *normal;
    uint32_t *index, *table;
    uint32_t (*vertices)[3];
    size_t n, size; /* corners; entries of the table, a power of two */
    uint32_t n_verts;
} build;

static lc_status make_build(lc_obj *o, build *b)
{
    b->n = o->n_corners;
    for (b->size = 16; b->size < 2 * b->n;) b->size *= 2;
    b->pos = lc_alloc_raw(o->ctx, b->n * 3, sizeof *b->pos);
    b->uv = lc_alloc_raw(o->ctx, b->n * 2, sizeof *b->uv);
    b->normal = lc_alloc_raw(o->ctx, b->n * 3, sizeof *b->normal);
    b->index = lc_alloc_raw(o->ctx, b->n, sizeof *b->index);
    b->vertices = lc_alloc_raw(o->ctx, b->n, sizeof *b->vertices);
    b->table = lc_alloc(o->ctx, b->size, sizeof *b->table);
    return b->pos && b->uv && b->normal && b->index && b->vertices && b->table ? LC_OK : LC_ERR_MEMORY;
}

static void free_build(const lc_obj *o, build *b)
{
    lc_free(o->ctx, b->pos, b->n * 3, sizeof *b->pos);
    lc_free(o->ctx, b->uv, b->n * 2, sizeof *b->uv);
    lc_free(o->ctx, b->normal, b->n * 3, sizeof *b->normal);
    lc_free(o->ctx, b->index, b->n, sizeof *b->index);
    lc_free(o->ctx, b->vertices, b->n, sizeof *b->vertices);
    lc_free(o->ctx, b->table, b->size, sizeof *b->table);
}

/* The vertex of a corner, a new one if no corner before was the same. */
static uint32_t vertex_of(const lc_obj *o, build *b, const uint32_t corner[3])
{
    static const float zero[3] = { 0, 0, 0 };
    size_t at = (size_t)lc_hash4(corner[0], corner[1], corner[2], 0) & (b->size - 1);
    for (; b->table[at]; at = (at + 1) & (b->size - 1))
        if (!memcmp(b->vertices[b->table[at] - 1], corner, 3 * sizeof *corner)) return b->table[at] - 1;
    uint32_t v = b->n_verts++;
    b->table[at] = v + 1;
    memcpy(b->vertices[v], corner, 3 * sizeof *corner);
    memcpy(b->pos + 3 * (size_t)v, o->pos + 3 * (size_t)corner[0], 3 * sizeof(float));
    memcpy(b->uv + 2 * (size_t)v, corner[1] ? o->uv + 2 * ((size_t)corner[1] - 1) : zero, 2 * sizeof(float));
    memcpy(b->normal + 3 * (size_t)v, corner[2] ? o->normal + 3 * ((size_t)corner[2] - 1) : zero,
           3 * sizeof(float));
    return v;
}

/* Adds what was gathered as a mesh of the material in force. */
static lc_status flush(lc_obj *o, lc_pos where)
{
    build b = { 0 };
    bool normals = false, uv = false;
    if (!o->n_corners) return LC_OK;
    if (o->n_corners >= LC_NONE) return lc_fail_at(o->ctx, LC_ERR_UNSUPPORTED, where, "too many faces");
    lc_status st = make_build(o, &b);
    for (size_t i = 0; i < b.n && !st; i++) {
        b.index[i] = vertex_of(o, &b, o->corners[i]);
        uv |= o->corners[i][1] > 0;
        normals |= o->corners[i][2] > 0;
    }
    const lc_obj_material *m = &o->materials[o->material];
    lc_mesh_desc mesh = {
        .n_verts = b.n_verts, .n_tris = (uint32_t)(b.n / 3), .pos = b.pos, .index = b.index
    };
    mesh.uv = uv ? b.uv : NULL;
    mesh.normal = normals ? b.normal : NULL;
    mesh.material_id = m->id;
    mesh.emission = m->emission;
    mesh.emission_map = lc_f3_max(m->emission) > 0 ? m->emission_map : 0;
    mesh.alpha = m->has_alpha ? &m->alpha : NULL;
    const char *const names[2] = { m->name, "area" };
    if (!st && lc_f3_max(m->emission) > 0) st = lc_group_choose(o->scene, 0, names, 2);
    if (!st) st = lc_scene_add_mesh(o->scene, where, &mesh);
    if (!st) st = lc_scene_count_feature(o->scene, "shape", "faces", LC_SUPPORT_YES, NULL);
    free_build(o, &b);
    o->n_corners = 0;
    return st;
}

/* ---- statements ---- */

static lc_status add_floats(lc_obj *o, lc_obj_lines *l, uint32_t n, uint32_t most, float **to, size_t *len,
                            size_t *cap)
{
    float v[8] = { 0 };
    uint32_t got;
    void *data = *to;
    lc_status st = lc_obj_numbers(l, n == 2 ? 1 : n, most, v, &got);
    if (!st) st = lc_grow(o->ctx, &data, cap, *len + n, sizeof **to);
    *to = data;
    if (st) return st;
    memcpy(*to + *len, v, n * sizeof *v);
    *len += n;
    return LC_OK;
}

/* One index of a corner, from 1 or back from the end; 0 in `out` if it is empty. */
static lc_status read_index(const lc_obj_lines *l, const lc_obj_word *w, const char **at, size_t n,
                            uint32_t *out)
{
    const char *stop = w->text + w->len, *start = *at;
    bool back = *at < stop && **at == '-';
    uint64_t v = 0;
    if (back) ++*at;
    for (; *at < stop && **at >= '0' && **at <= '9'; ++*at)
        v = v < LC_NONE ? v * 10 + (uint64_t)(**at - '0') : v;
    *out = 0;
    if (*at == start) return LC_OK;
    if (v < 1 || v > n || n >= LC_NONE)
        return lc_fail_at(l->ctx, LC_ERR_PARSE, w->pos, "'%.*s' names one of %zu that are there",
                          w->len < 40 ? (int)w->len : 40, w->text, n);
    *out = back ? (uint32_t)(n - v + 1) : (uint32_t)v;
    return LC_OK;
}

/* vertex, vertex/uv, vertex//normal or vertex/uv/normal */
static lc_status read_corner(const lc_obj *o, const lc_obj_lines *l, const lc_obj_word *w, uint32_t out[3])
{
    const char *at = w->text, *stop = w->text + w->len;
    const size_t n[3] = { o->n_pos / 3, o->n_uv / 2, o->n_normal / 3 };
    out[1] = out[2] = 0;
    for (int i = 0; i < 3; i++) {
        lc_status st = read_index(l, w, &at, n[i], &out[i]);
        if (st) return st;
        if (at == stop || i == 2 || *at != '/') break;
        at++;
    }
    if (at != stop || !out[0])
        return lc_fail_at(l->ctx, LC_ERR_PARSE, w->pos, "'%.*s' is no corner of a face",
                          w->len < 40 ? (int)w->len : 40, w->text);
    out[0]--;
    return LC_OK;
}

static lc_status add_triangle(lc_obj *o, const uint32_t a[3], const uint32_t b[3], const uint32_t c[3])
{
    void *corners = o->corners;
    lc_status st = lc_grow(o->ctx, &corners, &o->cap_corners, o->n_corners + 3, sizeof *o->corners);
    o->corners = corners;
    if (st) return st;
    memcpy(o->corners[o->n_corners++], a, sizeof *o->corners);
    memcpy(o->corners[o->n_corners++], b, sizeof *o->corners);
    memcpy(o->corners[o->n_corners++], c, sizeof *o->corners);
    return LC_OK;
}

/* Twice the area vector of a triangle of vertices. */
static void area_of(const lc_obj *o, uint32_t a, uint32_t b, uint32_t c, double out[3])
{
    double e[3], f[3];
    for (size_t k = 0; k < 3; k++) {
        double from = (double)o->pos[3 * (size_t)a + k];
        e[k] = (double)o->pos[3 * (size_t)b + k] - from;
        f[k] = (double)o->pos[3 * (size_t)c + k] - from;
    }
    for (int k = 0; k < 3; k++) out[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
}

/* The corner from which a fan covers the polygon: one whose triangles all turn the same way; n if there is
 * none. */
static uint32_t fan_from(const lc_obj *o, uint32_t (*corners)[3], uint32_t n)
{
    double whole[3] = { 0, 0, 0 }, t[3];
    for (uint32_t i = 2; i < n; i++) {
        area_of(o, corners[0][0], corners[i - 1][0], corners[i][0], t);
        for (int k = 0; k < 3; k++) whole[k] += t[k];
    }
    for (uint32_t from = 0; from < n; from++) {
        bool good = true;
        for (uint32_t i = 1; i + 1 < n && good; i++) {
            area_of(o, corners[from][0], corners[(from + i) % n][0], corners[(from + i + 1) % n][0], t);
            good = t[0] * whole[0] + t[1] * whole[1] + t[2] * whole[2] >= 0;
        }
        if (good) return from;
    }
    return n;
}

static lc_status read_face(lc_obj *o, lc_obj_lines *l, lc_pos where)
{
    uint32_t corners[MAX_CORNERS][3], n = 0, from;
    lc_obj_word w;
    while (lc_obj_next_word(l, &w)) {
        if (n == MAX_CORNERS)
            return lc_fail_at(o->ctx, LC_ERR_PARSE, w.pos, "a face of more than %u corners", MAX_CORNERS);
        lc_status st = read_corner(o, l, &w, corners[n]);
        if (st) return st;
        n++;
    }
    if (n < 3) return lc_obj_note(o, where, "face", "a face of fewer than three corners is left out");
    lc_status st = LC_OK;
    from = n == 3 ? 0 : fan_from(o, corners, n);
    if (from == n) {
        from = 0;
        st = lc_obj_note(o, where, "polygon",
                         "a polygon that is not star-shaped about a corner is not filled rightly");
    }
    for (uint32_t i = 1; i + 1 < n && !st; i++)
        st = add_triangle(o, corners[from], corners[(from + i) % n], corners[(from + i + 1) % n]);
    return st;
}

static size_t name_at(const lc_obj *o, const char *text, size_t len)
{
    const lc_obj_word name = { .text = text, .len = len };
    size_t at = (size_t)lc_text_hash(text, len) & (o->n_by_name - 1);
    while (o->by_name[at] && !lc_obj_word_is(&name, o->materials[o->by_name[at]].name))
        at = (at + 1) & (o->n_by_name - 1);
    return at;
}

/* Makes the table again where materials have come; the last of a name counts. */
static lc_status name_materials(lc_obj *o)
{
    size_t size = 64;
    if (o->n_named == o->n_materials) return LC_OK;
    while (size < 2 * o->n_materials) size *= 2;
    uint32_t *table = lc_alloc(o->ctx, size, sizeof *table);
    if (!table) return LC_ERR_MEMORY;
    lc_free(o->ctx, o->by_name, o->n_by_name, sizeof *o->by_name);
    o->by_name = table;
    o->n_by_name = size;
    for (size_t i = 1; i < o->n_materials; i++) {
        const char *name = o->materials[i].name;
        table[name_at(o, name, strlen(name))] = (uint32_t)i;
    }
    o->n_named = o->n_materials;
    return LC_OK;
}

static lc_status use_material(lc_obj *o, lc_obj_lines *l, lc_pos where)
{
    lc_obj_word name;
    lc_status st = flush(o, where);
    if (st) return st;
    o->material = 0;
    if (!lc_obj_rest(l, &name)) return LC_OK;
    if ((st = name_materials(o))) return st;
    o->material = o->by_name[name_at(o, name.text, name.len)];
    if (o->material) return LC_OK;
    return lc_obj_note(o, name.pos, "unknown material", "'%.*s': no such material; grey diffuse is used",
                       name.len < 60 ? (int)name.len : 60, name.text);
}

static lc_status unknown(lc_obj *o, const lc_obj_word *w, uint32_t *n_unknown)
{
    static const char *const curves[] = { "vp",   "curv",  "curv2", "surf", "cstype", "deg",  "parm",
                                          "trim", "hole",  "scrv",  "sp",   "end",    "bmat", "step",
                                          "con",  "ctech", "stech", "p",    "l" };
    static const char *const silent[] = { "o",        "g",   "s",          "mg",        "bevel",  "c_interp",
                                          "d_interp", "lod", "shadow_obj", "trace_obj", "maplib", "usemap" };
    for (size_t i = 0; i < sizeof silent / sizeof *silent; i++)
        if (lc_obj_word_is(w, silent[i])) return LC_OK;
    for (size_t i = 0; i < sizeof curves / sizeof *curves; i++)
        if (lc_obj_word_is(w, curves[i]))
            return lc_obj_note(o, w->pos, "curves", "points, lines, curves and surfaces are left out");
    if (++*n_unknown > MAX_UNKNOWN)
        return lc_fail_at(o->ctx, LC_ERR_PARSE, w->pos, "more than %d unknown statements", MAX_UNKNOWN);
    return lc_obj_note(o, w->pos, "unknown statement", "'%.*s' is skipped", w->len < 40 ? (int)w->len : 40,
                       w->text);
}

static lc_status parse_lines(lc_obj *o, lc_obj_lines *l)
{
    uint32_t n_unknown = 0;
    lc_status st = LC_OK;
    lc_pos end = { o->path, 0, 0 };
    while (!st && lc_obj_next_line(l)) {
        lc_obj_word w, name;
        if (!lc_obj_next_word(l, &w)) continue;
        end = w.pos;
        if (lc_obj_word_is(&w, "v")) st = add_floats(o, l, 3, 7, &o->pos, &o->n_pos, &o->cap_pos);
        else if (lc_obj_word_is(&w, "vt")) st = add_floats(o, l, 2, 3, &o->uv, &o->n_uv, &o->cap_uv);
        else if (lc_obj_word_is(&w, "vn"))
            st = add_floats(o, l, 3, 3, &o->normal, &o->n_normal, &o->cap_normal);
        else if (lc_obj_word_is(&w, "f") || lc_obj_word_is(&w, "fo")) st = read_face(o, l, w.pos);
        else if (lc_obj_word_is(&w, "usemtl")) st = use_material(o, l, w.pos);
        else if (lc_obj_word_is(&w, "mtllib")) st = lc_obj_rest(l, &name) ? lc_obj_read_mtl(o, &name) : LC_OK;
        else st = unknown(o, &w, &n_unknown);
        if (!st && lc_stopped(o->ctx)) st = LC_ERR_CANCELLED;
    }
    return st ? st : flush(o, end);
}

/* ---- entry points ---- */

bool lc_obj_is(const uint8_t *head, size_t len)
{
    static const char *const words[] = { "v", "vn", "vt", "f", "o", "g", "s", "mtllib", "usemtl" };
    lc_context quiet = { .n_threads = 1 };
    lc_obj_lines l;
    lc_obj_word w;
    lc_obj_open_lines(&quiet, "", (const char *)head, len, &l);
    if (!lc_obj_next_line(&l) || !lc_obj_next_word(&l, &w) || l.at >= l.end) return false;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (lc_obj_word_is(&w, words[i])) return true;
    return false;
}

static lc_status run(lc_scene *scene, const char *path, bool no_files, const char *data, size_t size)
{
    const char *slash = strrchr(path, '/');
    lc_obj o = { .ctx = scene->ctx, .scene = scene, .no_files = no_files };
    lc_obj_lines l;
    lc_pos where = { path, 0, 0 };
    lc_arena_init(&o.arena, o.ctx);
    o.path = path;
    o.folder = lc_arena_text(&o.arena, path, slash ? (size_t)(slash - path) + 1 : 0);
    lc_obj_open_lines(o.ctx, path, data, size, &l);
    lc_status st = o.folder ? lc_scene_usual_film(scene, where) : LC_ERR_MEMORY;
    if (!st) st = lc_obj_default_material(&o);
    if (!st) st = parse_lines(&o, &l);
    if (!st) st = lc_scene_usual_camera(scene, where);
    if (!st) st = lc_scene_check_lit(scene, where);
    lc_free(o.ctx, o.pos, o.cap_pos, sizeof *o.pos);
    lc_free(o.ctx, o.uv, o.cap_uv, sizeof *o.uv);
    lc_free(o.ctx, o.normal, o.cap_normal, sizeof *o.normal);
    lc_free(o.ctx, o.corners, o.cap_corners, sizeof *o.corners);
    lc_free(o.ctx, o.by_name, o.n_by_name, sizeof *o.by_name);
    lc_free(o.ctx, o.materials, o.cap_materials, sizeof *o.materials);
    lc_free(o.ctx, o.images, o.cap_images, sizeof *o.images);
    lc_arena_free(&o.arena);
    return st;
}

lc_status lc_obj_parse(lc_scene *scene, const char *path)
{
    lc_file file;
    lc_status st = lc_file_read(scene->ctx, (lc_pos){ path, 0, 0 }, path, NULL, &file);
    if (st) return st;
    st = run(scene, path, false, file.data, file.size);
    lc_file_free(scene->ctx, &file);
    return st;
}

lc_status lc_obj_parse_memory(lc_scene *scene, const char *name, const void *data, size_t size)
{
    lc_file file;
    lc_status st = lc_file_of_memory(scene->ctx, data, size, &file);
    if (st) return st;
    st = run(scene, name, true, file.data, file.size);
    lc_file_free(scene->ctx, &file);
    return st;
}
