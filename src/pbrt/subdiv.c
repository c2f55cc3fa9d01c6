/* subdiv.c - the step and the limit of Loop subdivision. Weights from [Loop87], those of normals from Hoppe
 * et al. 1994 ("Piecewise smooth surface reconstruction"), as in pbrt's loopsubdiv. */
#include "pbrt/subdiv.h"

#include "base/xform.h"
#include "trace/half_edge.h"

#include <string.h>

static uint32_t start_of(const lc_subdiv *m, uint32_t h) { return m->corner[h]; }
static uint32_t end_of(const lc_subdiv *m, uint32_t h) { return m->corner[lc_half_edge_next(h)]; }

typedef struct ring {
    double sum[3]; /* of the neighbours; at a boundary only of those along it */
    uint32_t n;
    bool boundary;
} ring;

static void add(ring *to, const double *p)
{
    for (int k = 0; k < 3; k++) to->sum[k] += p[k];
    to->n++;
}

static void gather(const lc_subdiv *m, const uint32_t *twin, ring *rings)
{
    for (uint32_t h = 0; h < 3 * m->n_faces; h++)
        if (twin[h] == LC_NONE) rings[start_of(m, h)].boundary = rings[end_of(m, h)].boundary = true;
    for (uint32_t h = 0; h < 3 * m->n_faces; h++) {
        uint32_t a = start_of(m, h), b = end_of(m, h);
        if (!rings[a].boundary) add(&rings[a], m->pos + 3 * (size_t)b);
        if (twin[h] == LC_NONE) {
            add(&rings[a], m->pos + 3 * (size_t)b);
            add(&rings[b], m->pos + 3 * (size_t)a);
        }
    }
}

static double beta(uint32_t valence) { return valence == 3 ? 3.0 / 16 : 3 / (8.0 * valence); }

/* Moves a vertex to a weighted mean: `inside` is the weight of each neighbour, `boundary` at a boundary that
 * of each of the two neighbours along it. */
static void move(const ring *r, double inside, double boundary, const double *from, double *to)
{
    double each = r->boundary ? 2 * boundary / (r->n ? r->n : 1) : inside;
    for (int k = 0; k < 3; k++) to[k] = (1 - each * r->n) * from[k] + each * r->sum[k];
}

/* ---- a step ---- */

static void odd_vertex(const lc_subdiv *m, uint32_t h, uint32_t twin, double *to)
{
    const double *a = m->pos + 3 * (size_t)start_of(m, h), *b = m->pos + 3 * (size_t)end_of(m, h);
    const double *c = m->pos + 3 * (size_t)m->corner[lc_half_edge_prev(h)];
    const double *d = twin == LC_NONE ? c : m->pos + 3 * (size_t)m->corner[lc_half_edge_prev(twin)];
    for (int k = 0; k < 3; k++)
        to[k] = twin == LC_NONE ? 0.5 * (a[k] + b[k]) : 0.375 * (a[k] + b[k]) + 0.125 * (c[k] + d[k]);
}

/* Makes the odd vertices: odd[h] is the one on half-edge h and on its twin. */
static void split_edges(const lc_subdiv *in, const uint32_t *twin, uint32_t *odd, lc_subdiv *out)
{
    for (uint32_t h = 0; h < 3 * in->n_faces; h++) {
        if (twin[h] != LC_NONE && twin[h] < h) {
            odd[h] = odd[twin[h]];
            continue;
        }
        odd[h] = out->n_verts++;
        odd_vertex(in, h, twin[h], out->pos + 3 * (size_t)odd[h]);
    }
}

lc_status lc_subdiv_refine(lc_arena *arena, const lc_subdiv *in, lc_subdiv *out)
{
    uint32_t n_half = 3 * in->n_faces;
    uint32_t *twin = lc_arena_alloc(arena, n_half, sizeof *twin),
             *odd = lc_arena_alloc(arena, n_half, sizeof *odd);
    ring *rings = lc_arena_alloc(arena, in->n_verts, sizeof *rings);
    *out = (lc_subdiv){ in->n_verts, 4 * in->n_faces, NULL, NULL };
    out->corner = lc_arena_alloc(arena, 4 * (size_t)n_half, sizeof *out->corner);
    lc_status st = twin && odd && rings && out->corner
                       ? lc_find_twins(arena->ctx, in->corner, in->n_faces, twin)
                       : LC_ERR_MEMORY;
    if (st) return st;
    size_t n_edges = 0;
    for (uint32_t h = 0; h < n_half; h++) n_edges += twin[h] == LC_NONE || h < twin[h];
    out->pos = lc_arena_alloc(arena, 3 * (in->n_verts + n_edges), sizeof *out->pos);
    if (!out->pos) return LC_ERR_MEMORY;
    gather(in, twin, rings);
    for (size_t v = 0; v < in->n_verts; v++) {
        double b = rings[v].n && !rings[v].boundary ? beta(rings[v].n) : 0;
        move(&rings[v], b, 1.0 / 8, in->pos + 3 * v, out->pos + 3 * v);
    }
    split_edges(in, twin, odd, out);
    for (uint32_t f = 0; f < in->n_faces; f++) {
        const uint32_t *v = in->corner + 3 * (size_t)f, *e = odd + 3 * (size_t)f;
        const uint32_t made[12] = { v[0], e[0], e[2], e[0], v[1], e[1], e[2], e[1], v[2], e[0], e[1], e[2] };
        memcpy(out->corner + 12 * (size_t)f, made, sizeof made);
    }
    return LC_OK;
}

/* ---- the limit ---- */

static void add_scaled(double *to, double k, const double *p)
{
    for (int i = 0; i < 3; i++) to[i] += k * p[i];
}

/* The tangents of an inner vertex from its ring p[0 .. n - 1], in clockwise order. */
static void tangents_inside(const double *const *p, uint32_t n, double s[3], double t[3])
{
    for (uint32_t j = 0; j < n; j++) {
        double sine, cosine;
        lc_sincos_deg(360.0 * j / n, &sine, &cosine);
        add_scaled(s, cosine, p[j]);
        add_scaled(t, sine, p[j]);
    }
}

/* The tangents of a boundary vertex from its ring, counter-clockwise from one boundary edge to the other. */
static void tangents_boundary(const double *const *p, uint32_t n, const double *v, double s[3], double t[3])
{
    add_scaled(s, 1, p[n - 1]);
    add_scaled(s, -1, p[0]);
    if (n == 2) {
        add_scaled(t, 1, p[0]);
        add_scaled(t, 1, p[1]);
        add_scaled(t, -2, v);
    } else if (n == 3) {
        add_scaled(t, 1, p[1]);
        add_scaled(t, -1, v);
    } else if (n == 4) {
        const double w[4] = { -1, 2, 2, -1 };
        for (int j = 0; j < 4; j++) add_scaled(t, w[j], p[j]);
        add_scaled(t, -2, v);
    } else {
        double step = 180.0 / (n - 1), sine, cosine, cos_step;
        lc_sincos_deg(step, &sine, &cos_step);
        add_scaled(t, -sine, p[0]);
        add_scaled(t, -sine, p[n - 1]);
        for (uint32_t k = 1; k + 1 < n; k++) {
            lc_sincos_deg(k * step, &sine, &cosine);
            add_scaled(t, (2 - 2 * cos_step) * sine, p[k]);
        }
    }
}

/* Lists the ring of a vertex. first: a half-edge that leaves the vertex, for a boundary vertex the one along
 * the boundary. */
static uint32_t ring_inside(const lc_subdiv *m, const uint32_t *twin, uint32_t first, const double **p)
{
    uint32_t n = 0, h = first;
    do {
        p[n++] = m->pos + 3 * (size_t)end_of(m, h);
        h = twin[h] == LC_NONE ? LC_NONE : lc_half_edge_next(twin[h]);
    } while (h != LC_NONE && h != first);
    return n;
}

static uint32_t ring_boundary(const lc_subdiv *m, const uint32_t *twin, uint32_t first, const double **p)
{
    uint32_t n = 0, h = first;
    p[n++] = m->pos + 3 * (size_t)end_of(m, h);
    do {
        p[n++] = m->pos + 3 * (size_t)start_of(m, lc_half_edge_prev(h));
        h = twin[lc_half_edge_prev(h)];
    } while (h != LC_NONE && h != first);
    return n;
}

static void normals(const lc_subdiv *m, const uint32_t *twin, const ring *rings, uint32_t *first,
                    const double **p, double *normal)
{
    for (size_t v = 0; v < m->n_verts; v++) first[v] = LC_NONE;
    for (uint32_t h = 0; h < 3 * m->n_faces; h++)
        if (!rings[start_of(m, h)].boundary || twin[h] == LC_NONE) first[start_of(m, h)] = h;
    for (size_t v = 0; v < m->n_verts; v++) {
        double s[3] = { 0 }, t[3] = { 0 }, *n = normal + 3 * v;
        n[0] = n[1] = n[2] = 0;
        if (first[v] == LC_NONE) continue;
        if (rings[v].boundary)
            tangents_boundary(p, ring_boundary(m, twin, first[v], p), m->pos + 3 * v, s, t);
        else tangents_inside(p, ring_inside(m, twin, first[v], p), s, t);
        for (int k = 0; k < 3; k++) n[k] = s[(k + 1) % 3] * t[(k + 2) % 3] - s[(k + 2) % 3] * t[(k + 1) % 3];
    }
}

lc_status lc_subdiv_limit(lc_arena *arena, lc_subdiv *m, double *normal)
{
    size_t n_half = 3 * (size_t)m->n_faces, n_floats = 3 * (size_t)m->n_verts;
    uint32_t *twin = lc_arena_alloc(arena, n_half, sizeof *twin),
             *first = lc_arena_alloc(arena, m->n_verts, sizeof *first);
    ring *rings = lc_arena_alloc(arena, m->n_verts, sizeof *rings);
    double *moved = lc_arena_alloc(arena, n_floats, sizeof *moved);
    const double **p = lc_arena_alloc(arena, n_half + 1, sizeof *p); /* room for any ring */
    lc_status st = twin && first && rings && moved && p
                       ? lc_find_twins(arena->ctx, m->corner, m->n_faces, twin)
                       : LC_ERR_MEMORY;
    if (st) return st;
    gather(m, twin, rings);
    for (size_t v = 0; v < m->n_verts; v++) {
        uint32_t n = rings[v].n;
        double gamma = n && !rings[v].boundary ? 1 / (n + 3 / (8 * beta(n))) : 0;
        move(&rings[v], gamma, 1.0 / 5, m->pos + 3 * v, moved + 3 * v);
    }
    m->pos = moved;
    normals(m, twin, rings, first, p, normal);
    return LC_OK;
}
