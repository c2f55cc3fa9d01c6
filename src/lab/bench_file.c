/* bench_file.c - see bench_file.h. The arrays are used where the file was read into memory. A file must have
 * exactly the size that its counts give. */
#include "lab/bench_file.h"

#include "lab/bench.h"

#include <math.h>
#include <string.h>

#define MESH_HEAD 16 /* bytes before the arrays */
#define RAYS_HEAD 24

typedef unsigned long long ull;

static uint64_t little(const char *p, int n_bytes)
{
    uint64_t v = 0;
    for (int i = n_bytes - 1; i >= 0; i--) v = v << 8 | (unsigned char)p[i];
    return v;
}

/* Puts little-endian words into the machine's order. */
static void to_host(char *p, uint64_t n_words)
{
#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
    for (uint64_t i = 0; i < n_words; i++) {
        uint32_t v = (uint32_t)little(p + 4 * i, 4);
        memcpy(p + 4 * i, &v, 4);
    }
#else
    (void)p;
    (void)n_words;
#endif
}

static lc_status fail_at_byte(const lc_context *ctx, const char *path, uint64_t off, const char *what)
{
    return lc_fail_at(ctx, LC_ERR_PARSE, (lc_pos){ path, 0, 0 }, "%s at byte %llu", what, (ull)off);
}

/* want: the size that the counts give. */
static lc_status check_size(const lc_context *ctx, const char *path, const lc_file *f, double want,
                            const char *what)
{
    if ((double)f->size == want) return LC_OK;
    return lc_fail_at(ctx, LC_ERR_PARSE, (lc_pos){ path, 0, 0 },
                      "%s at byte 8 make %.0f bytes, the file has %zu", what, want, f->size);
}

static lc_status check_magic(const lc_context *ctx, const char *path, const lc_file *f, const char *magic,
                             size_t head)
{
    if (f->size < 8 || memcmp(f->data, magic, 8)) {
        return lc_fail_at(ctx, LC_ERR_PARSE, (lc_pos){ path, 0, 0 }, "no '%s' at byte 0", magic);
    }
    return f->size < head ? fail_at_byte(ctx, path, f->size, "the header ends too early") : LC_OK;
}

/* Coordinates have the limit of scenes' vertices and lights. */
static lc_status check_floats(const lc_context *ctx, const char *path, const float *p, uint64_t n,
                              uint64_t off)
{
    for (uint64_t i = 0; i < n; i++)
        if (!(fabsf(p[i]) <= LC_MAX_COORD))
            return fail_at_byte(ctx, path, off + 4 * i, "a coordinate that is not finite or beyond 1e12");
    return LC_OK;
}

static lc_status parse_mesh(const lc_context *ctx, const char *path, bench_mesh *m)
{
    lc_status st = check_magic(ctx, path, &m->file, "LCMESH1", MESH_HEAD);
    if (st) return st;
    char *data = m->file.data;
    m->n_verts = (uint32_t)little(data + 8, 4);
    m->n_tris = (uint32_t)little(data + 12, 4);
    uint64_t n_pos = 3 * (uint64_t)m->n_verts, n_index = 3 * (uint64_t)m->n_tris,
             index_off = MESH_HEAD + 4 * n_pos;
    st = check_size(ctx, path, &m->file, (double)(index_off + 4 * n_index),
                    "numbers of vertices and triangles");
    if (st) return st;
    to_host(data + MESH_HEAD, n_pos + n_index);
    m->pos = (const float *)(void *)(data + MESH_HEAD);
    m->index = (const uint32_t *)(void *)(data + index_off);
    st = check_floats(ctx, path, m->pos, n_pos, MESH_HEAD);
    for (uint64_t i = 0; i < n_index && !st; i++)
        if (m->index[i] >= m->n_verts)
            st = fail_at_byte(ctx, path, index_off + 4 * i, "an index out of range");
    return st;
}

static lc_status parse_segments(const lc_context *ctx, const char *path, bench_segments *s)
{
    lc_status st = check_magic(ctx, path, &s->file, "LCRAYS1", RAYS_HEAD);
    if (st) return st;
    char *data = s->file.data;
    s->n = little(data + 8, 8);
    s->group = (uint32_t)little(data + 16, 4);
    st = check_size(ctx, path, &s->file, RAYS_HEAD + 24.0 * (double)s->n, "number of rays");
    if (!st && !s->n) st = fail_at_byte(ctx, path, 8, "no rays");
    if (st) return st;
    to_host(data + RAYS_HEAD, 6 * s->n);
    s->ray = (const float *)(void *)(data + RAYS_HEAD);
    return check_floats(ctx, path, s->ray, 6 * s->n, RAYS_HEAD);
}

/* By the two letters with which both kinds begin. */
static bool is_bench_file(const uint8_t *head, size_t len)
{
    return len >= 2 && head[0] == 'L' && head[1] == 'C';
}

lc_status bench_read_mesh(const lc_context *ctx, const char *path, bench_mesh *out)
{
    *out = (bench_mesh){ .n_verts = 0 };
    lc_status st = lc_file_read(ctx, (lc_pos){ path, 0, 0 }, path, is_bench_file, &out->file);
    if (!st) st = parse_mesh(ctx, path, out);
    if (st) lc_file_free(ctx, &out->file);
    return st;
}

lc_status bench_read_segments(const lc_context *ctx, const char *path, bench_segments *out)
{
    *out = (bench_segments){ .n = 0 };
    lc_status st = lc_file_read(ctx, (lc_pos){ path, 0, 0 }, path, is_bench_file, &out->file);
    if (!st) st = parse_segments(ctx, path, out);
    if (st) lc_file_free(ctx, &out->file);
    return st;
}

static lc_status make_file(const lc_context *ctx, size_t bytes, lc_file *f)
{
    *f = (lc_file){ .size = bytes, .cap = bytes };
    f->data = lc_alloc(ctx, bytes, 1);
    return f->data ? LC_OK : LC_ERR_MEMORY;
}

lc_status bench_make_mesh(const lc_context *ctx, uint32_t n, bench_mesh *out)
{
    static const uint8_t faces[12][3] = { { 0, 1, 3 }, { 0, 3, 2 }, { 4, 6, 7 }, { 4, 7, 5 },
                                          { 0, 4, 5 }, { 0, 5, 1 }, { 2, 3, 7 }, { 2, 7, 6 },
                                          { 0, 2, 6 }, { 0, 6, 4 }, { 1, 5, 7 }, { 1, 7, 3 } };
    const size_t n_pos = (size_t)(n + 1) * 24, n_index = (size_t)(n + 1) * 36;
    *out = (bench_mesh){ .n_verts = 8 * (n + 1), .n_tris = 12 * (n + 1) };
    lc_status st = make_file(ctx, 4 * (n_pos + n_index), &out->file);
    if (st) return st;
    float *pos = (float *)(void *)out->file.data;
    uint32_t *index = (uint32_t *)(void *)(out->file.data + 4 * n_pos);
    out->pos = pos;
    out->index = index;
    for (uint32_t i = 0; i <= n; i++) {
        float c[3] = { bench_unit(i, 10) * 10, bench_unit(i, 11) * 4, bench_unit(i, 12) * 10 },
              h = 0.02f + 0.1f * bench_unit(i, 13);
        for (uint32_t v = 0; v < 8; v++)
            for (uint32_t k = 0; k < 3; k++) {
                float side = v >> k & 1 ? 1.0f : -1.0f;
                pos[(8 * i + v) * 3 + k] = i ? c[k] + side * h : 5 + 5.01f * side;
            }
        for (uint32_t f = 0; f < 12; f++)
            for (uint32_t v = 0; v < 3; v++) index[(12 * i + f) * 3 + v] = 8 * i + faces[f][v];
    }
    return LC_OK;
}

lc_status bench_make_segments(const lc_context *ctx, uint32_t n_points, bench_segments *out)
{
    *out = (bench_segments){ .n = 64 * (uint64_t)n_points, .group = 64 };
    lc_status st = make_file(ctx, 24 * out->n, &out->file);
    if (st) return st;
    float *r = (float *)(void *)out->file.data;
    out->ray = r;
    for (uint64_t i = 0; i < out->n; i++, r += 6) {
        uint64_t point = i / 64, light = i % 64;
        r[0] = bench_unit(point, 20) * 10;
        r[1] = bench_unit(point, 21) * 4;
        r[2] = bench_unit(point, 22) * 10;
        r[3] = bench_unit(light, 23) * 10;
        r[4] = 9;
        r[5] = bench_unit(light, 24) * 10;
    }
    return LC_OK;
}
