/* occluder.c - selects the largest triangles by a histogram, then finds neighbours by vertex position. */
#include "trace/occluder.h"

#include "base/rng.h"
#include "base/vec.h"
#include "trace/half_edge.h"

#include <string.h>

#define BIN_SHIFT LC_SIZE(16, 22) /* the histogram of sizes has a bin for what a float's upper bits may be */
#define BINS ((size_t)1 << (32 - BIN_SHIFT))

static bool may_be_one(const lc_occluders_desc *d, size_t tri)
{
    return !d->may_pass || !(d->may_pass[tri / 32] >> tri % 32 & 1);
}

/* Four times the squared area as the bits of a float, which have the same order as its values. */
static uint32_t size_of(const lc_occluders_desc *d, size_t tri)
{
    lc_f3 a = lc_f3_load(lc_tri_vertex(d->pos, d->index, tri, 0)),
          b = lc_f3_load(lc_tri_vertex(d->pos, d->index, tri, 1));
    lc_f3 n = lc_f3_cross(lc_f3_sub(b, a), lc_f3_sub(lc_f3_load(lc_tri_vertex(d->pos, d->index, tri, 2)), a));
    float size = lc_f3_dot(n, n);
    uint32_t bits;
    memcpy(&bits, &size, sizeof bits);
    return size > 0 ? bits : 0;
}

/* Marks the triangles of as many of the highest bins as stay below LC_MAX_OCCLUDERS together. */
static lc_status choose(const lc_context *ctx, const lc_occluders_desc *d, lc_occluders *o)
{
    uint32_t *count = lc_alloc(ctx, BINS, sizeof *count);
    if (!count) return LC_ERR_MEMORY;
    for (size_t t = 0; t < d->n_tris; t++)
        if (may_be_one(d, t)) count[size_of(d, t) >> BIN_SHIFT]++;
    size_t least = BINS;
    while (least > 1 && count[least - 1] <= LC_MAX_OCCLUDERS - o->n) o->n += count[--least];
    for (size_t t = 0; t < d->n_tris; t++)
        if (may_be_one(d, t) && size_of(d, t) >> BIN_SHIFT >= least) o->bits[t / 64] |= (uint64_t)1 << t % 64;
    for (size_t w = 1; w < o->n_words; w++)
        o->rank[w] = o->rank[w - 1] + (uint32_t)__builtin_popcountll(o->bits[w - 1]);
    lc_free(ctx, count, BINS, sizeof *count);
    return LC_OK;
}

static void set(lc_occluder *o, size_t k, lc_f3 v)
{
    o->v[0][k] = v.x;
    o->v[1][k] = v.y;
    o->v[2][k] = v.z;
}

static void copy_vertices(const lc_occluders_desc *d, lc_occluders *o)
{
    uint32_t n = 0;
    for (size_t t = 0; t < d->n_tris; t++) {
        if (!(o->bits[t / 64] >> t % 64 & 1)) continue;
        lc_f3 v[3];
        for (size_t k = 0; k < 3; k++) {
            v[k] = lc_f3_add(lc_f3_load(lc_tri_vertex(d->pos, d->index, t, k)), lc_f3_make(0, 0, 0));
            set(&o->all[n], k, v[k]);
        }
        lc_f3 normal = lc_f3_cross(lc_f3_sub(v[1], v[0]), lc_f3_sub(v[2], v[0]));
        set(&o->all[n], 3, normal);
        o->all[n++].n1 = fabsf(normal.x) + fabsf(normal.y) + fabsf(normal.z);
    }
}

static bool same_place(const lc_occluders *o, uint32_t a, uint32_t b)
{
    const lc_occluder *p = &o->all[a / 3], *q = &o->all[b / 3];
    bool same = true;
    for (int axis = 0; axis < 3; axis++)
        same &= !memcmp(&p->v[axis][a % 3], &q->v[axis][b % 3], sizeof(float));
    return same;
}

/* Sets corner[i] to the first corner at the position of corner i. Meshes often repeat a vertex to give it two
 * normals. */
static lc_status weld(const lc_context *ctx, const lc_occluders *o, uint32_t *corner)
{
    size_t cap = 16;
    while (cap < 6 * (size_t)o->n) cap *= 2;
    uint32_t *slots = lc_alloc_raw(ctx, cap, sizeof *slots);
    if (!slots) return LC_ERR_MEMORY;
    memset(slots, 0xff, cap * sizeof *slots);
    for (uint32_t i = 0; i < 3 * o->n; i++) {
        uint32_t key[3];
        for (int axis = 0; axis < 3; axis++)
            memcpy(&key[axis], &o->all[i / 3].v[axis][i % 3], sizeof key[axis]);
        size_t at = lc_hash2((uint64_t)key[0] << 32 | key[1], key[2]) & (cap - 1);
        while (slots[at] != LC_NONE && !same_place(o, slots[at], i)) at = (at + 1) & (cap - 1);
        if (slots[at] == LC_NONE) slots[at] = i;
        corner[i] = slots[at];
    }
    lc_free(ctx, slots, cap, sizeof *slots);
    return LC_OK;
}

/* Finds the neighbours across the edges. */
static lc_status join(const lc_context *ctx, lc_occluders *o)
{
    size_t n = 3 * (size_t)o->n;
    uint32_t *corner = lc_alloc_raw(ctx, n, sizeof *corner), *twin = lc_alloc_raw(ctx, n, sizeof *twin);
    lc_status st = corner && twin ? weld(ctx, o, corner) : LC_ERR_MEMORY;
    if (!st) st = lc_find_twins(ctx, corner, o->n, twin);
    for (size_t h = 0; h < n && !st; h++)
        o->all[h / 3].next[h % 3] = twin[h] == LC_NONE ? LC_NONE : twin[h] / 3;
    lc_free(ctx, corner, n, sizeof *corner);
    lc_free(ctx, twin, n, sizeof *twin);
    return st;
}

lc_status lc_occluders_build(const lc_context *ctx, const lc_occluders_desc *desc, lc_occluders **out)
{
    lc_occluders *o = lc_alloc(ctx, 1, sizeof *o);
    *out = o;
    if (!o) return LC_ERR_MEMORY;
    o->ctx = ctx;
    o->n_words = (uint32_t)(desc->n_tris / 64 + 1);
    o->bits = lc_alloc(ctx, o->n_words, sizeof *o->bits);
    o->rank = lc_alloc(ctx, o->n_words, sizeof *o->rank);
    lc_status st = o->bits && o->rank ? choose(ctx, desc, o) : LC_ERR_MEMORY;
    if (!st && !(o->all = lc_alloc_raw(ctx, o->n, sizeof *o->all))) st = LC_ERR_MEMORY;
    if (!st) copy_vertices(desc, o);
    if (!st) st = join(ctx, o);
    if (!st) return LC_OK;
    lc_occluders_destroy(o);
    *out = NULL;
    return st;
}

void lc_occluders_destroy(lc_occluders *o)
{
    if (!o) return;
    lc_free(o->ctx, o->bits, o->n_words, sizeof *o->bits);
    lc_free(o->ctx, o->rank, o->n_words, sizeof *o->rank);
    lc_free(o->ctx, o->all, o->n, sizeof *o->all);
    lc_free(o->ctx, o, 1, sizeof *o);
}
