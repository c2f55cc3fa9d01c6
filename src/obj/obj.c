/* obj.c - statements of OBJ files. Faces gather until the material changes; corners that have the same
 * vertex, texture coordinates and normal share a vertex of the mesh. */
#include "obj/obj.h"

#include "base/rng.h"
#include "base/text.h"
#include "io/readfile.h"
#include "obj/state.h"

#include <stdio.h>
#include <string.h>

#define MAX_CORNERS 1000u /* of a face */
/* Triangles that are looked at to find a corner that sees the whole of a polygon: so many of a file, and for
 * each corner of its faces. A hostile face would need half the square of its corners. */
#define FIRST_TESTS 1000000u
#define TESTS_PER_CORNER 64u
#define MAX_UNKNOWN 100   /* unknown statements after which the file is taken not to be OBJ */

lc_status lc_obj_note(lc_obj *o, lc_pos where, const char *kind, const char *fmt, ...)
{
    char text[400];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    lc_status st = lc_build_at_pos(o->scene, where);
    return st ? st : lc_build_note(o->scene, kind, text);
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
    lc_build_mesh_desc mesh = LC_BUILD_MESH_DESC_INIT;
    mesh.n_vertices = b.n_verts;
    mesh.n_triangles = (uint32_t)(b.n / 3);
    mesh.positions = b.pos;
    mesh.indices = b.index;
    mesh.uv = uv ? b.uv : NULL;
    mesh.normals = normals ? b.normal : NULL;
    mesh.material = m->id;
    memcpy(mesh.emission, m->emission, sizeof mesh.emission);
    const bool emits = lc_f3_max(lc_f3_load(m->emission)) > 0;
    if (emits) mesh.emission_picture = m->emission_picture;
    mesh.alpha = m->alpha;
    const char *const names[2] = { m->name, "area" };
    if (!st) st = lc_build_at_pos(o->scene, where);
    if (!st && emits) st = lc_build_group(o->scene, NULL, names, 2);
    if (!st) st = lc_build_mesh(o->scene, &mesh);
    if (!st) st = lc_build_feature(o->scene, "shape", "faces", LC_SUPPORT_YES, NULL);
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
    o->fan_left += TESTS_PER_CORNER * n;
    from = n == 3 ? 0 : lc_obj_fan_from(o->pos, corners, n, &o->fan_left);
    if (from == n) {
        from = 0;
        st = lc_obj_note(o, where, "polygon",
                         "a polygon that is not star-shaped about a corner, or with many corners was not "
                         "found to be, is not filled rightly");
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

/* Puts the materials that have come into the table; the last of a name counts. */
static lc_status name_materials(lc_obj *o)
{
    size_t size = o->n_by_name ? o->n_by_name : 64;
    while (size < 2 * o->n_materials) size *= 2;
    if (size > o->n_by_name) {
        uint32_t *table = lc_alloc(o->ctx, size, sizeof *table);
        if (!table) return LC_ERR_MEMORY;
        lc_free(o->ctx, o->by_name, o->n_by_name, sizeof *o->by_name);
        o->by_name = table;
        o->n_by_name = size;
        o->n_named = 1; /* the default one has no name */
    }
    for (; o->n_named < o->n_materials; o->n_named++) {
        const char *name = o->materials[o->n_named].name;
        o->by_name[name_at(o, name, strlen(name))] = (uint32_t)o->n_named;
    }
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
    lc_obj o = {
        .ctx = lc_build_context(scene), .scene = scene, .no_files = no_files, .fan_left = FIRST_TESTS
    };
    const lc_build_film_desc film = lc_build_usual_film();
    lc_obj_lines l;
    lc_pos where = { path, 0, 0 };
    lc_arena_init(&o.arena, o.ctx);
    o.path = path;
    o.folder = lc_arena_text(&o.arena, path, slash ? (size_t)(slash - path) + 1 : 0);
    lc_obj_open_lines(o.ctx, path, data, size, &l);
    lc_status st = o.folder ? lc_build_at_pos(scene, where) : LC_ERR_MEMORY;
    if (!st) st = lc_build_film(scene, &film);
    if (!st) st = lc_build_paths(scene, 1, LC_USUAL_DEPTH);
    if (!st) st = lc_obj_default_material(&o);
    if (!st) st = parse_lines(&o, &l);
    if (!st) st = lc_build_at_pos(scene, where);
    if (!st) st = lc_build_usual_camera(scene);
    if (!st && !lc_build_is_lit(scene)) st = lc_build_note(scene, "no lights", LC_UNLIT);
    lc_free(o.ctx, o.pos, o.cap_pos, sizeof *o.pos);
    lc_free(o.ctx, o.uv, o.cap_uv, sizeof *o.uv);
    lc_free(o.ctx, o.normal, o.cap_normal, sizeof *o.normal);
    lc_free(o.ctx, o.corners, o.cap_corners, sizeof *o.corners);
    lc_free(o.ctx, o.by_name, o.n_by_name, sizeof *o.by_name);
    lc_free(o.ctx, o.materials, o.cap_materials, sizeof *o.materials);
    lc_free(o.ctx, o.images, o.cap_images, sizeof *o.images);
    lc_free(o.ctx, o.libraries, o.cap_libraries, sizeof *o.libraries);
    lc_arena_free(&o.arena);
    return st;
}

lc_status lc_obj_parse(lc_scene *scene, const char *path)
{
    lc_file file;
    lc_status st = lc_file_read(lc_build_context(scene), (lc_pos){ path, 0, 0 }, path, NULL, &file);
    if (st) return st;
    st = run(scene, path, false, file.data, file.size);
    lc_file_free(lc_build_context(scene), &file);
    return st;
}

lc_status lc_obj_parse_memory(lc_scene *scene, const char *name, const void *data, size_t size)
{
    lc_file file;
    lc_status st = lc_file_of_memory(lc_build_context(scene), data, size, &file);
    if (st) return st;
    st = run(scene, name, true, file.data, file.size);
    lc_file_free(lc_build_context(scene), &file);
    return st;
}
