/* ply.c - reads the header into a list of elements with their properties, then each element's rows value by
 * value. Counts are checked against the remaining bytes before anything is allocated for them. */
#include "pbrt/ply.h"

#include "base/decimal.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define MAX_ELEMENTS 64 /* common files have at most 3 elements with 20 properties */
#define MAX_PROPERTIES 1024
#define MAX_VERTS 0x3fffffffu /* MAX_COUNT of scene.c */

typedef enum scalar { I8, U8, I16, U16, I32, U32, F32, F64, N_SCALARS } scalar;
static const uint8_t scalar_size[N_SCALARS] = { 1, 1, 2, 2, 4, 4, 4, 8 };

enum { ROLE_U = 6, ROLE_INDEX = 8, ROLE_NONE = 9 }; /* 0..7: x y z nx ny nz u v */

typedef struct property {
    scalar type, count_type;
    bool is_list;
    uint8_t role;
} property;

typedef enum element_kind { VERTEX, FACE, OTHER } element_kind;

typedef struct element {
    element_kind kind;
    uint64_t count;
    uint32_t first, n; /* its properties */
} element;

typedef enum format { NO_FORMAT, ASCII, LITTLE, BIG } format;

typedef struct reader {
    const lc_context *ctx;
    const char *name, *data;
    size_t size, off;
    format format;
    bool in_body;
    element elements[MAX_ELEMENTS];
    property properties[MAX_PROPERTIES];
    uint32_t n_elements, n_properties;
    const element *vertex, *face;
    bool has_normals, has_uv;
    lc_ply_mesh *mesh;
} reader;

/* ---- messages ---- */

/* Reports an error at byte `off`: by line and column in text, by the byte in binary data. */
static lc_status fail(const reader *r, size_t off, const char *what)
{
    if (r->in_body && r->format != ASCII)
        return lc_fail_at(r->ctx, LC_ERR_PARSE, (lc_pos){ r->name, 0, 0 }, "%s at byte %zu", what, off);
    uint32_t line = 1;
    size_t start = 0;
    for (size_t i = 0; i < off; i++) {
        bool end = r->data[i] == '\n' || (r->data[i] == '\r' && r->data[i + 1] != '\n');
        if (end) {
            line++;
            start = i + 1;
        }
    }
    return lc_fail_at(r->ctx, LC_ERR_PARSE, (lc_pos){ r->name, line, (uint32_t)(off - start + 1) }, "%s",
                      what);
}

/* ---- header ---- */

typedef struct words {
    const char *at[6];
    size_t len[6];
    uint32_t n; /* words of the line; only the first 6 are kept */
} words;

static bool is(const words *w, uint32_t i, const char *text)
{
    return i < w->n && w->len[i] == strlen(text) && !memcmp(w->at[i], text, w->len[i]);
}

/* Splits the line at r->off into words and advances r->off past it. False at the end of the file. */
static bool next_line(reader *r, words *w)
{
    const char *d = r->data;
    size_t i = r->off;
    w->n = 0;
    while (i < r->size && d[i] != '\n' && d[i] != '\r') {
        size_t first = i;
        while (i < r->size && d[i] != '\n' && d[i] != '\r' && d[i] != ' ' && d[i] != '\t') i++;
        if (i > first) {
            if (w->n < 6) {
                w->at[w->n] = d + first;
                w->len[w->n] = i - first;
            }
            w->n++;
        } else
            i++;
    }
    if (i >= r->size) return false;
    if (d[i] == '\r' && i + 1 < r->size && d[i + 1] == '\n') i++;
    r->off = i + 1;
    return true;
}

static scalar scalar_of(const words *w, uint32_t i)
{
    static const char *const names[2][N_SCALARS] = {
        { "char", "uchar", "short", "ushort", "int", "uint", "float", "double" },
        { "int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64" },
    };
    for (int k = 0; k < N_SCALARS; k++)
        if (is(w, i, names[0][k]) || is(w, i, names[1][k])) return (scalar)k;
    return N_SCALARS;
}

static lc_status read_format(reader *r, const words *w, size_t line)
{
    if (w->n != 3 || r->format) return fail(r, line, "expected one 'format' line of three words");
    if (is(w, 1, "ascii")) r->format = ASCII;
    if (is(w, 1, "binary_little_endian")) r->format = LITTLE;
    if (is(w, 1, "binary_big_endian")) r->format = BIG;
    return r->format ? LC_OK : fail(r, (size_t)(w->at[1] - r->data), "unknown PLY format");
}

static lc_status read_element(reader *r, const words *w, size_t line)
{
    if (w->n != 3) return fail(r, line, "expected 'element NAME COUNT'");
    if (r->n_elements == MAX_ELEMENTS) return fail(r, line, "more than 64 elements");
    element *e = &r->elements[r->n_elements++];
    *e = (element){ OTHER, 0, r->n_properties, 0 };
    for (size_t i = 0; i < w->len[2]; i++) {
        char c = w->at[2][i];
        if (c < '0' || c > '9' || e->count > UINT64_MAX / 20)
            return fail(r, (size_t)(w->at[2] - r->data), "element count is not a number in range");
        e->count = e->count * 10 + (uint64_t)(c - '0');
    }
    if (is(w, 1, "vertex")) e->kind = VERTEX;
    if (is(w, 1, "face")) e->kind = FACE;
    const element **known = e->kind == VERTEX ? &r->vertex : &r->face;
    if (e->kind != OTHER && *known) return fail(r, line, "element stated twice");
    if (e->kind != OTHER) *known = e;
    return LC_OK;
}

static uint8_t role_of(element_kind kind, const words *w, uint32_t i)
{
    static const char *const names[] = { "x", "y", "z", "nx", "ny", "nz", "u", "v", "s", "t",
                                         "texture_u", "texture_v", "texture_s", "texture_t" };
    for (uint8_t k = 0; kind == VERTEX && k < 14; k++)
        if (is(w, i, names[k])) return k < ROLE_U ? k : ROLE_U + k % 2;
    if (kind == FACE && (is(w, i, "vertex_indices") || is(w, i, "vertex_index"))) return ROLE_INDEX;
    return ROLE_NONE;
}

static lc_status read_property(reader *r, const words *w, size_t line)
{
    bool list = is(w, 1, "list");
    uint32_t type = list ? 3 : 1;
    if (!r->n_elements) return fail(r, line, "property before any element");
    if (w->n != (list ? 5u : 3u))
        return fail(r, line, "expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
    if (r->n_properties == MAX_PROPERTIES) return fail(r, line, "more than 1024 properties");
    element *e = &r->elements[r->n_elements - 1];
    property p = { scalar_of(w, type), list ? scalar_of(w, 2) : U8, list, role_of(e->kind, w, w->n - 1) };
    if (p.type == N_SCALARS) return fail(r, (size_t)(w->at[type] - r->data), "unknown type");
    if (p.count_type >= F32)
        return fail(r, (size_t)(w->at[2] - r->data), "the count of a list needs an integer type");
    if (p.role < ROLE_INDEX && list) return fail(r, line, "coordinates can't be lists");
    if (p.role == ROLE_INDEX && (!list || p.type >= F32))
        return fail(r, line, "vertex indices must be lists of integers");
    r->properties[r->n_properties++] = p;
    e->n++;
    return LC_OK;
}

/* Checks that the header has what reading the rest requires. */
static lc_status check_header(reader *r)
{
    uint32_t roles = 0;
    bool index = false;
    if (!r->format) return fail(r, r->off - 1, "header without 'format'");
    if (!r->vertex || !r->face) return fail(r, r->off - 1, "a mesh needs the elements 'vertex' and 'face'");
    for (uint32_t i = 0; i < r->vertex->n; i++) roles |= 1u << r->properties[r->vertex->first + i].role;
    for (uint32_t i = 0; i < r->face->n; i++) index |= r->properties[r->face->first + i].role == ROLE_INDEX;
    if ((roles & 7) != 7) return fail(r, r->off - 1, "vertices without x, y and z");
    if (!index) return fail(r, r->off - 1, "faces without vertex_indices");
    r->has_normals = (roles & 56) == 56;
    r->has_uv = (roles & 192) == 192;
    if (r->vertex->count > MAX_VERTS) return fail(r, r->off - 1, "too many vertices");
    return LC_OK;
}

static lc_status read_header(reader *r)
{
    words w;
    if (!next_line(r, &w) || !is(&w, 0, "ply") || w.n != 1) {
        r->in_body = false;
        return fail(r, 0, r->size ? "not a PLY file: the first line is not 'ply'" : "the file is empty");
    }
    for (;;) {
        size_t line = r->off;
        lc_status st = LC_OK;
        if (!next_line(r, &w)) return fail(r, line, "the file ends inside the header");
        if (is(&w, 0, "end_header")) return check_header(r);
        if (is(&w, 0, "format"))
            st = read_format(r, &w, line);
        else if (is(&w, 0, "element"))
            st = read_element(r, &w, line);
        else if (is(&w, 0, "property"))
            st = read_property(r, &w, line);
        else if (w.n && !is(&w, 0, "comment") && !is(&w, 0, "obj_info"))
            st = fail(r, line, "unknown line in the header");
        if (st) return st;
    }
}

/* ---- values ---- */

static double load(const char *p, scalar type, bool big)
{
    unsigned char b[8] = { 0 };
    for (int i = 0, n = scalar_size[type]; i < n; i++) b[i] = (unsigned char)p[big ? n - 1 - i : i];
    uint32_t lo = (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
    uint32_t hi = (uint32_t)b[4] | (uint32_t)b[5] << 8 | (uint32_t)b[6] << 16 | (uint32_t)b[7] << 24;
    uint64_t both = (uint64_t)hi << 32 | lo;
    float f;
    double d;
    switch (type) {
    case I8: return (int8_t)lo;
    case I16: return (int16_t)lo;
    case I32: return (int32_t)lo;
    case F32: memcpy(&f, &lo, sizeof f); return (double)f;
    case F64: memcpy(&d, &both, sizeof d); return d;
    default: return lo;
    }
}

static bool is_space(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v';
}

static lc_status next_value(reader *r, scalar type, double *out)
{
    const char *d = r->data;
    if (r->format != ASCII) {
        if (r->size - r->off < scalar_size[type]) return fail(r, r->size, "the file ends too early");
        *out = load(d + r->off, type, r->format == BIG);
        r->off += scalar_size[type];
        return LC_OK;
    }
    while (r->off < r->size && is_space(d[r->off])) r->off++;
    size_t first = r->off;
    while (r->off < r->size && !is_space(d[r->off])) r->off++;
    if (r->off == first) return fail(r, first, "the file ends too early");
    if (!lc_decimal_parse(d + first, r->off - first, out)) return fail(r, first, "not a number");
    return LC_OK;
}

static lc_status skip_value(reader *r, const property *p)
{
    double n = 1, ignored;
    size_t start = r->off;
    lc_status st = p->is_list ? next_value(r, p->count_type, &n) : LC_OK;
    if (st) return st;
    if (!(n >= 0 && n <= (double)(r->size - r->off)) || floor(n) < n)
        return fail(r, start, "the length of a list is out of range");
    if (r->format != ASCII) {
        size_t bytes = (size_t)n * scalar_size[p->type];
        if (r->size - r->off < bytes) return fail(r, r->size, "the file ends too early");
        r->off += bytes;
        return LC_OK;
    }
    for (size_t i = 0; i < (size_t)n; i++)
        if ((st = next_value(r, p->type, &ignored))) return st;
    return LC_OK;
}

/* ---- rows ---- */

/* Checks that the rest of the file can hold the element's rows. */
static lc_status check_count(const reader *r, const element *e)
{
    uint64_t row = 0, left = r->size - r->off;
    for (uint32_t i = 0; i < e->n; i++) {
        const property *p = &r->properties[e->first + i];
        row += r->format == ASCII ? 2 : p->is_list ? scalar_size[p->count_type] : scalar_size[p->type];
    }
    /* In text the last value of the file needs no separator, hence left + 1. */
    if (row && e->count > (left + 1) / row)
        return fail(r, r->off, "the element count is more than the file can hold");
    return LC_OK;
}

static lc_status read_vertex(reader *r, size_t row)
{
    for (uint32_t i = 0; i < r->vertex->n; i++) {
        const property *p = &r->properties[r->vertex->first + i];
        size_t start = r->off;
        double v;
        bool is_uv = p->role >= ROLE_U && p->role < ROLE_INDEX && r->has_uv;
        bool wanted = p->role < 3 || (p->role < ROLE_U && r->has_normals) || is_uv;
        lc_status st = wanted ? next_value(r, p->type, &v) : skip_value(r, p);
        if (st) return st;
        if (is_uv)
            r->mesh->uv[2 * row + p->role - ROLE_U] = (float)fmin(fmax(v, -(double)FLT_MAX), (double)FLT_MAX);
        if (!wanted || is_uv) continue;
        while (r->format == ASCII && is_space(r->data[start])) start++;
        if (!(fabs(v) <= (double)FLT_MAX)) return fail(r, start, "a vertex is not finite");
        (p->role < 3 ? r->mesh->pos : r->mesh->normal)[3 * row + p->role % 3] = (float)v;
    }
    return LC_OK;
}

static lc_status add_triangle(reader *r, uint32_t a, uint32_t b, uint32_t c)
{
    lc_ply_mesh *m = r->mesh;
    if (m->n_tris == UINT32_MAX) return fail(r, r->off, "too many triangles");
    void *index = m->index;
    lc_status st = lc_grow(r->ctx, &index, &m->cap_index, ((size_t)m->n_tris + 1) * 3, sizeof *m->index);
    m->index = index;
    if (st) return st;
    uint32_t *out = m->index + (size_t)m->n_tris++ * 3;
    out[0] = a;
    out[1] = b;
    out[2] = c;
    return LC_OK;
}

static lc_status read_corners(reader *r, const property *p)
{
    uint32_t first = 0, last = 0;
    double n, v;
    size_t start = r->off;
    lc_status st = next_value(r, p->count_type, &n);
    if (st) return st;
    while (r->format == ASCII && is_space(r->data[start])) start++;
    if (!(n >= 0 && n <= (double)(r->size - r->off)) || floor(n) < n)
        return fail(r, start, "the number of corners is out of range");
    if (n < 3) r->mesh->n_small_faces++;
    for (size_t i = 0; i < (size_t)n; i++) {
        start = r->off;
        if ((st = next_value(r, p->type, &v))) return st;
        while (r->format == ASCII && is_space(r->data[start])) start++;
        if (!(v >= 0 && v < (double)r->vertex->count) || floor(v) < v)
            return fail(r, start, "a vertex index is out of range");
        uint32_t corner = (uint32_t)v;
        if (i >= 2 && (st = add_triangle(r, first, last, corner))) return st;
        if (i == 0) first = corner;
        last = corner;
    }
    return LC_OK;
}

static lc_status read_face(reader *r)
{
    for (uint32_t i = 0; i < r->face->n; i++) {
        const property *p = &r->properties[r->face->first + i];
        lc_status st = p->role == ROLE_INDEX ? read_corners(r, p) : skip_value(r, p);
        if (st) return st;
    }
    return LC_OK;
}

static lc_status read_rows(reader *r, const element *e)
{
    lc_ply_mesh *m = r->mesh;
    lc_status st = check_count(r, e);
    if (st || !e->n) return st;
    if (e->kind == VERTEX) {
        m->n_verts = (uint32_t)e->count;
        m->pos = lc_alloc(r->ctx, (size_t)m->n_verts * 3, sizeof *m->pos);
        if (r->has_normals) m->normal = lc_alloc(r->ctx, (size_t)m->n_verts * 3, sizeof *m->normal);
        if (r->has_uv) m->uv = lc_alloc(r->ctx, (size_t)m->n_verts * 2, sizeof *m->uv);
        if (!m->pos || (r->has_normals && !m->normal) || (r->has_uv && !m->uv)) return LC_ERR_MEMORY;
    }
    for (size_t row = 0; row < e->count && !st; row++) {
        if (e->kind == VERTEX)
            st = read_vertex(r, row);
        else if (e->kind == FACE)
            st = read_face(r);
        else
            for (uint32_t i = 0; i < e->n && !st; i++) st = skip_value(r, &r->properties[e->first + i]);
    }
    return st;
}

lc_status lc_ply_parse(const lc_context *ctx, const char *name, const char *data, size_t size,
                       lc_ply_mesh *out)
{
    *out = (lc_ply_mesh){ 0 };
    reader *r = lc_alloc(ctx, 1, sizeof *r);
    if (!r) return LC_ERR_MEMORY;
    r->ctx = ctx;
    r->name = name;
    r->data = data;
    r->size = size;
    r->mesh = out;
    lc_status st = read_header(r);
    r->in_body = true;
    bool vertex = false, face = false;
    for (uint32_t i = 0; i < r->n_elements && !st && !(vertex && face); i++) {
        st = read_rows(r, &r->elements[i]);
        vertex |= &r->elements[i] == r->vertex;
        face |= &r->elements[i] == r->face;
    }
    lc_free(ctx, r, 1, sizeof *r);
    if (st) lc_ply_free(ctx, out);
    return st;
}

static bool is_ply(const uint8_t *head, size_t len) { return len >= 3 && !memcmp(head, "ply", 3); }

lc_status lc_ply_load(const lc_context *ctx, lc_pos where, const char *path, lc_ply_mesh *out)
{
    lc_file file;
    *out = (lc_ply_mesh){ 0 };
    lc_status st = lc_file_read(ctx, where, path, is_ply, &file);
    if (st) return st;
    st = lc_ply_parse(ctx, path, file.data, file.size, out);
    lc_file_free(ctx, &file);
    return st;
}

void lc_ply_free(const lc_context *ctx, lc_ply_mesh *mesh)
{
    lc_free(ctx, mesh->pos, (size_t)mesh->n_verts * 3, sizeof *mesh->pos);
    lc_free(ctx, mesh->normal, (size_t)mesh->n_verts * 3, sizeof *mesh->normal);
    lc_free(ctx, mesh->uv, (size_t)mesh->n_verts * 2, sizeof *mesh->uv);
    lc_free(ctx, mesh->index, mesh->cap_index, sizeof *mesh->index);
    *mesh = (lc_ply_mesh){ 0 };
}
