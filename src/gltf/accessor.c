/* accessor.c - accessors: the elements of a buffer view as floats or indices, with those that are given
 * sparsely. All sizes are checked against the buffer before the caller allocates. */
#include "gltf/state.h"

#include <string.h>

#define MAX_COUNT 0x3fffffffu         /* elements: as many vertices as a scene may have */
#define MAX_READ  ((uint64_t)1 << 31) /* elements of all accessors, each as often as it is used */

static uint32_t part_size(uint32_t type)
{
    return type == 5120 || type == 5121   ? 1
           : type == 5122 || type == 5123 ? 2
           : type == 5125 || type == 5126 ? 4
                                          : 0;
}

static lc_status read_type(const lc_gltf *g, uint32_t object, lc_gltf_accessor *a)
{
    const char *type;
    uint64_t component = 0;
    lc_status st = lc_gltf_text(g, object, "type", &type);
    if (!st) st = lc_gltf_size(g, object, "componentType", &component, NULL);
    if (st) return st;
    a->type = component >= 5120 && component <= 5126 ? (uint32_t)component : 0;
    if (!part_size(a->type)) return lc_gltf_fail(g, object, "an accessor of no known componentType");
    a->n_parts = !type                     ? 0
                 : !strcmp(type, "SCALAR") ? 1
                 : !strcmp(type, "VEC2")   ? 2
                 : !strcmp(type, "VEC3")   ? 3
                 : !strcmp(type, "VEC4")   ? 4
                                           : 0;
    if (!a->n_parts) return lc_gltf_fail(g, object, "an accessor of no type SCALAR, VEC2, VEC3 or VEC4");
    return LC_OK;
}

/* The bytes from the first element to the end of the last. */
static uint64_t extent(const lc_gltf_accessor *a)
{
    return (a->count - 1) * a->stride + part_size(a->type) * (uint64_t)a->n_parts;
}

lc_status lc_gltf_open_accessor(lc_gltf *g, uint32_t idx, lc_gltf_accessor *a)
{
    uint32_t object = lc_gltf_item(g, LC_GLTF_ACCESSORS, idx);
    uint64_t size = 0, element;
    const uint8_t *data;
    bool there;
    *a = (lc_gltf_accessor){ .value = object };
    lc_status st = read_type(g, object, a);
    if (!st) st = lc_gltf_index(g, object, "bufferView", LC_GLTF_VIEWS, &a->view);
    if (!st) st = lc_gltf_size(g, object, "byteOffset", &a->first, NULL);
    if (!st) st = lc_gltf_size(g, object, "count", &a->count, &there);
    if (!st) st = lc_gltf_bool(g, object, "normalized", &a->normalized);
    if (st) return st;
    if (!there || !a->count || a->count > MAX_COUNT)
        return lc_gltf_fail(g, object, "an accessor's count is out of range");
    if ((g->n_read += a->count) > MAX_READ)
        return lc_gltf_fail(g, object, "more than %llu elements are read of accessors",
                            (unsigned long long)MAX_READ);
    element = part_size(a->type) * (uint64_t)a->n_parts;
    if (a->view == LC_NONE) /* zeros; the limit is one of sense */
        return a->count > g->file_size ? lc_gltf_fail(g, object, "more zeros than the file has bytes")
                                       : LC_OK;
    if ((st = lc_gltf_view_size(g, a->view, &size, &a->stride))) return st;
    if (!a->stride) a->stride = element;
    if (a->stride < element || a->stride > 252 + element)
        return lc_gltf_fail(g, object, "elements of %llu bytes, %llu bytes apart",
                            (unsigned long long)element, (unsigned long long)a->stride);
    return lc_gltf_view(g, object, a->view, a->first, extent(a), &data);
}

static uint32_t get_bits(const uint8_t *p, uint32_t size)
{
    uint32_t v = 0;
    for (uint32_t i = size; i-- > 0;) v = v << 8 | p[i];
    return v;
}

/* [glTF, 3.11]: normalized integers. */
static float get_float(const uint8_t *p, uint32_t type, bool normalized)
{
    uint32_t bits = get_bits(p, part_size(type));
    float f;
    switch (type) {
    case 5120: f = (float)(int8_t)bits; return normalized ? fmaxf(f / 127, -1) : f;
    case 5121: return normalized ? (float)bits / 255 : (float)bits;
    case 5122: f = (float)(int16_t)bits; return normalized ? fmaxf(f / 32767, -1) : f;
    case 5123: return normalized ? (float)bits / 65535 : (float)bits;
    case 5125: return (float)bits;
    default: memcpy(&f, &bits, sizeof f); return f;
    }
}

/* ---- sparse ---- */

typedef struct sparse {
    uint64_t count;
    const uint8_t *at, *values;
    uint32_t index_size;
} sparse;

static lc_status open_part(lc_gltf *g, uint32_t object, const char *name, uint64_t n, const uint8_t **out)
{
    uint32_t part, view;
    uint64_t first = 0;
    lc_status st = lc_gltf_member(g, object, name, LC_JSON_OBJECT, &part);
    if (!st && part == LC_NONE) st = lc_gltf_fail(g, object, "sparse without %s", name);
    if (!st) st = lc_gltf_index(g, part, "bufferView", LC_GLTF_VIEWS, &view);
    if (!st && view == LC_NONE) st = lc_gltf_fail(g, part, "sparse %s without bufferView", name);
    if (!st) st = lc_gltf_size(g, part, "byteOffset", &first, NULL);
    return st ? st : lc_gltf_view(g, part, view, first, n, out);
}

static lc_status open_sparse(lc_gltf *g, const lc_gltf_accessor *a, sparse *s)
{
    uint32_t object, indices;
    uint64_t type = 0;
    *s = (sparse){ .count = 0 };
    lc_status st = lc_gltf_member(g, a->value, "sparse", LC_JSON_OBJECT, &object);
    if (st || object == LC_NONE) return st;
    if ((st = lc_gltf_size(g, object, "count", &s->count, NULL))) return st;
    if (!s->count || s->count > a->count)
        return lc_gltf_fail(g, object, "%llu sparse elements of %llu", (unsigned long long)s->count,
                            (unsigned long long)a->count);
    st = lc_gltf_member(g, object, "indices", LC_JSON_OBJECT, &indices);
    if (!st) st = lc_gltf_size(g, indices, "componentType", &type, NULL);
    if (st) return st;
    if (type != 5121 && type != 5123 && type != 5125)
        return lc_gltf_fail(g, object, "sparse indices of no known componentType");
    s->index_size = part_size((uint32_t)type);
    st = open_part(g, object, "indices", s->count * s->index_size, &s->at);
    return st ? st : open_part(g, object, "values", s->count * part_size(a->type) * a->n_parts, &s->values);
}

lc_status lc_gltf_floats(lc_gltf *g, const lc_gltf_accessor *a, float *out)
{
    uint32_t size = part_size(a->type), n = a->n_parts;
    const uint8_t *data = NULL;
    sparse s;
    lc_status st = a->view == LC_NONE ? LC_OK
                                      : lc_gltf_view(g, a->value, a->view, a->first, extent(a), &data);
    if (!st) st = open_sparse(g, a, &s);
    if (st) return st;
    if (!data) memset(out, 0, (size_t)a->count * n * sizeof *out);
    for (size_t i = 0; i < a->count && data; i++)
        for (uint32_t k = 0; k < n; k++)
            out[i * n + k] = get_float(data + i * a->stride + k * size, a->type, a->normalized);
    for (size_t i = 0; i < s.count; i++) {
        size_t at = get_bits(s.at + i * s.index_size, s.index_size);
        if (at >= a->count)
            return lc_gltf_fail(g, a->value, "sparse element %zu of %llu", at, (unsigned long long)a->count);
        for (uint32_t k = 0; k < n; k++)
            out[at * n + k] = get_float(s.values + (i * n + k) * size, a->type, a->normalized);
    }
    return LC_OK;
}

lc_status lc_gltf_indices(lc_gltf *g, const lc_gltf_accessor *a, uint32_t limit, uint32_t *out)
{
    uint32_t size = part_size(a->type);
    const uint8_t *data = NULL;
    sparse s;
    if (a->n_parts != 1 || (a->type != 5121 && a->type != 5123 && a->type != 5125))
        return lc_gltf_fail(g, a->value, "indices are not unsigned integers");
    lc_status st = a->view == LC_NONE ? LC_OK
                                      : lc_gltf_view(g, a->value, a->view, a->first, extent(a), &data);
    if (!st) st = open_sparse(g, a, &s);
    if (st) return st;
    for (size_t i = 0; i < a->count; i++) out[i] = data ? get_bits(data + i * a->stride, size) : 0;
    for (size_t i = 0; i < s.count; i++) {
        size_t at = get_bits(s.at + i * s.index_size, s.index_size);
        if (at >= a->count)
            return lc_gltf_fail(g, a->value, "sparse element %zu of %llu", at, (unsigned long long)a->count);
        out[at] = get_bits(s.values + i * size, size);
    }
    for (size_t i = 0; i < a->count; i++)
        if (out[i] >= limit)
            return lc_gltf_fail(g, a->value, "index %zu is %u, not one of %u vertices", i, out[i], limit);
    return LC_OK;
}
