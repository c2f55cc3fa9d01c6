/* bvh_tmpl.c - closest hits on the eight-wide BVH, and the tests of boxes and triangles; included by
 * isa_tmpl.c.
 *
 * Triangles: Woop, Benthin, Wald 2013, "Watertight ray/triangle intersection". The ray is sheared onto its
 * largest axis; a vertex is sheared by the same operations wherever it is used, and the sign of each edge
 * function is exact (two rounded products compare as the exact ones do or tie; ties are settled in double,
 * where they are exact), so a ray through a shared edge or vertex cannot pass between its triangles.
 *
 * Boxes: Ize 2013, "Robust BVH ray traversal". The far distance is widened by 1 + 2 gamma(3), here 1 + 2^-20;
 * the builder pads the boxes by the rounding of the shear.
 *
 * A node has eight children, a block eight triangles: LC_BLOCK_LANES. They are tested VB_LANES at a time,
 * from lane k on.
 */
#include "base/vec.h"

/* Least size of a direction's component as a divisor: smaller ones count as this, with their sign. */
static const float MIN_DIR = 1e-30f;

typedef struct {
    int kx, ky, kz;
    float sx, sy, sz;         /* shear */
    vb vo[3], vi[3];          /* origin, inverse direction, per axis */
    vb vf[3];                 /* inverse direction for far planes: times LC_FAR_SLACK */
    uint32_t near[3], far[3]; /* offsets in a node, in floats, of an axis' near and far planes */
    vb vsx, vsy;
} ray;

static inline void ray_init(ray *r, const float org[3], const float dir[3])
{
    for (int k = 0; k < 3; k++) {
        float d = fabsf(dir[k]) < MIN_DIR ? copysignf(MIN_DIR, dir[k]) : dir[k], inv = 1 / d;
        uint32_t lo = 8 * (uint32_t)k, hi = 24 + lo;
        r->vo[k] = vb_set(org[k]);
        r->vi[k] = vb_set(inv);
        r->vf[k] = vb_set(inv * LC_FAR_SLACK);
        r->near[k] = inv >= 0 ? lo : hi;
        r->far[k] = inv >= 0 ? hi : lo;
    }
    float ax = fabsf(dir[0]), ay = fabsf(dir[1]), az = fabsf(dir[2]);
    r->kz = az >= ax && az >= ay ? 2 : ay >= ax ? 1 : 0;
    r->kx = r->kz == 2 ? 0 : r->kz + 1;
    r->ky = r->kx == 2 ? 0 : r->kx + 1;
    float dz = dir[r->kz];
    if (dz == 0) dz = MIN_DIR; /* a null direction has no meaningful hits, but must not divide by 0 */
    r->sx = dir[r->kx] / dz;
    r->sy = dir[r->ky] / dz;
    r->sz = 1 / dz;
    r->vsx = vb_set(r->sx);
    r->vsy = vb_set(r->sy);
}

/* Bits of the boxes that the ray meets in [t_min, t_max]; near distances to tn. f: lo[3][8], then hi[3][8].
 */
static inline uint32_t test_boxes(const float *f, const ray *r, float t_min, float t_max, float tn[8])
{
    uint32_t met = 0;
    for (uint32_t k = 0; k < LC_BLOCK_LANES; k += VB_LANES) {
        vb near = vb_max((vb_load(f + k + r->near[0]) - r->vo[0]) * r->vi[0], vb_set(t_min));
        vb far = vb_min((vb_load(f + k + r->far[0]) - r->vo[0]) * r->vf[0], vb_set(t_max));
        near = vb_max((vb_load(f + k + r->near[1]) - r->vo[1]) * r->vi[1], near);
        far = vb_min((vb_load(f + k + r->far[1]) - r->vo[1]) * r->vf[1], far);
        near = vb_max((vb_load(f + k + r->near[2]) - r->vo[2]) * r->vi[2], near);
        far = vb_min((vb_load(f + k + r->far[2]) - r->vo[2]) * r->vf[2], far);
        vb_store(tn + k, near);
        met |= vb_le(near, far) << k;
    }
    return met;
}

/* Computes edge functions that are 0 in float again in double, lane by lane. */
static void settle_zeros(const vb x[3], const vb y[3], uint32_t lanes, vb edge[3])
{
    _Alignas(32) float X[3][VB_LANES], Y[3][VB_LANES], e[3][VB_LANES];
    for (int k = 0; k < 3; k++) {
        vb_store(X[k], x[k]);
        vb_store(Y[k], y[k]);
        vb_store(e[k], edge[k]);
    }
    for (int i = 0; i < VB_LANES; i++) {
        if (!(lanes >> i & 1)) continue;
        for (int k = 0; k < 3; k++) { /* edge k is opposite vertex k: from vertex k + 1 to k + 2 */
            int a = (k + 1) % 3, b = (k + 2) % 3;
            double d = (double)X[b][i] * (double)Y[a][i] - (double)Y[b][i] * (double)X[a][i];
            e[k][i] = (float)d;
            if (e[k][i] == 0 && d != 0) e[k][i] = d > 0 ? FLT_MIN : -FLT_MIN;
        }
    }
    for (int k = 0; k < 3; k++) edge[k] = vb_load(e[k]);
}

/* Bits of the triangles from lane `at` on that the ray passes inside of; sheared vertices to x, y, edge
 * functions to e. */
static inline uint32_t edges(const lc_tri_block *b, uint32_t at, const ray *r, vb x[3], vb y[3], vb e[3])
{
    const vb zero = vb_set(0);
    for (int k = 0; k < 3; k++) {
        const vb z = vb_load(b->v[k][r->kz] + at) - r->vo[r->kz];
        x[k] = vb_load(b->v[k][r->kx] + at) - r->vo[r->kx] - r->vsx * z;
        y[k] = vb_load(b->v[k][r->ky] + at) - r->vo[r->ky] - r->vsy * z;
    }
    for (int k = 0; k < 3; k++) { /* edge k is opposite vertex k */
        int i = (k + 1) % 3, j = (k + 2) % 3;
        e[k] = x[j] * y[i] - y[j] * x[i];
    }
    uint32_t pos = vb_le(zero, e[0]) & vb_le(zero, e[1]) & vb_le(zero, e[2]);
    uint32_t neg = vb_le(e[0], zero) & vb_le(e[1], zero) & vb_le(e[2], zero);
    if (!(pos | neg)) return 0;
    uint32_t zeros = (pos | neg) & (vb_eq(e[0], zero) | vb_eq(e[1], zero) | vb_eq(e[2], zero));
    if (zeros) {
        settle_zeros(x, y, zeros, e);
        pos = vb_le(zero, e[0]) & vb_le(zero, e[1]) & vb_le(zero, e[2]);
        neg = vb_le(e[0], zero) & vb_le(e[1], zero) & vb_le(e[2], zero);
    }
    return (pos | neg) & ~vb_eq(e[0] + e[1] + e[2], zero);
}

/* Whether a hit counts where the ray meets a triangle's edge or vertex exactly, so that it crosses adjoining
 * triangles once: by the rule of rasterizers, an edge belongs to the triangle on one side of it. Vertices as
 * sheared by edges(), which the triangles at an edge have in common. */
static __attribute__((noinline)) bool owns_edges(const vb x[3], const vb y[3], const vb e[3], uint32_t lane)
{
    _Alignas(32) float X[3][VB_LANES], Y[3][VB_LANES], E[3][VB_LANES];
    for (int k = 0; k < 3; k++) {
        vb_store(X[k], x[k]);
        vb_store(Y[k], y[k]);
        vb_store(E[k], e[k]);
    }
    const bool turned = E[0][lane] + E[1][lane] + E[2][lane] < 0;
    for (int k = 0; k < 3; k++) { /* edge k is from vertex k + 1 to k + 2 */
        int from = turned ? (k + 2) % 3 : (k + 1) % 3, to = turned ? (k + 1) % 3 : (k + 2) % 3;
        if (E[k][lane] < 0 || E[k][lane] > 0) continue;
        bool level = !(Y[to][lane] < Y[from][lane] || Y[to][lane] > Y[from][lane]);
        if (!(level ? X[to][lane] < X[from][lane] : Y[to][lane] > Y[from][lane])) return false;
    }
    return true;
}

/* Distances to the triangles' planes, a.N / d.N with N from the edges. Woop's test interpolates e.z / det
 * instead, which may be off by 1e-4 of the farthest vertex's distance where a triangle is long and the ray
 * starts far away. */
static inline vb plane_distances(const lc_tri_block *b, uint32_t at, const ray *r)
{
    const int axis[3] = { r->kx, r->ky, r->kz };
    vb v[3], e[3], f[3], n[3];
    for (int k = 0; k < 3; k++) {
        v[k] = vb_load(b->v[0][axis[k]] + at);
        e[k] = vb_load(b->v[1][axis[k]] + at) - v[k];
        f[k] = vb_load(b->v[2][axis[k]] + at) - v[k];
        v[k] = v[k] - r->vo[axis[k]];
    }
    for (int k = 0, x = 1, y = 2; k < 3; x = y, y = k++) n[k] = e[x] * f[y] - e[y] * f[x];
    vb h = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
    vb along = r->vsx * n[0] + r->vsy * n[1] + n[2];
    return h / along * r->sz;
}

/* For each of a block's triangles: edge functions 1 and 2, distance, sum of the edge functions. */
typedef struct {
    _Alignas(32) float v[8], w[8], t[8], det[8];
} tri_hits;

/* Bits of the triangles that the ray meets at t in (t_min, t_max); only their entries of *hits are valid. */
static inline uint32_t test_tris(const lc_tri_block *b, const ray *r, float t_min, float t_max,
                                 tri_hits *hits)
{
    uint32_t met = 0;
    for (uint32_t k = 0; k < LC_BLOCK_LANES; k += VB_LANES) {
        vb x[3], y[3], e[3];
        uint32_t in = edges(b, k, r, x, y, e);
        if (!in) continue;
        vb t = plane_distances(b, k, r);
        vb_store(hits->v + k, e[1]);
        vb_store(hits->w + k, e[2]);
        vb_store(hits->t + k, t);
        vb_store(hits->det + k, e[0] + e[1] + e[2]);
        met |= (in & vb_lt(vb_set(t_min), t) & vb_lt(t, vb_set(t_max))) << k;
    }
    return met;
}

/* Whether no ray passes the triangle anywhere. */
static inline bool is_solid(const lc_alpha *alpha, uint32_t tri)
{
    return !(alpha->bits[tri / 32] >> tri % 32 & 1);
}

/* Keeps the nearest of the lanes in `bits`. */
static inline void keep_nearest(const lc_bvh_data *bvh, const lc_tri_block *b, const tri_hits *h,
                                uint32_t bits, lc_hit *hit)
{
    for (; bits; bits &= bits - 1) {
        int i = __builtin_ctz(bits);
        uint32_t tri = bvh->first_tri + b->tri[i];
        if (!(h->t[i] < hit->t || (h->t[i] == hit->t && tri < hit->tri))) continue;
        const lc_hit got = { h->t[i], h->v[i] / h->det[i], h->w[i] / h->det[i], tri, LC_NONE };
        const lc_alpha *alpha = bvh->alpha;
        if (!alpha || is_solid(alpha, tri) || alpha->opaque(alpha->user, tri, got.u, got.v)) *hit = got;
    }
}

typedef struct {
    float t;
    uint32_t ref;
} entry;

/* Pushes the children in `bits`, farthest first, so that the nearest is popped next. */
static inline uint32_t push_sorted(const uint32_t child[8], uint32_t flags, uint32_t bits,
                                   const float near[8], entry *stack, uint32_t n)
{
    uint32_t first = n;
    for (; bits; bits &= bits - 1) {
        int i = __builtin_ctz(bits);
        entry e = { near[i], child[i] | flags };
        uint32_t k = n++;
        for (; k > first && stack[k - 1].t < e.t; k--) stack[k] = stack[k - 1];
        stack[k] = e;
    }
    return n;
}

/* The closest hit among the BVH's own triangles. */
LC_INLINE void closest_tri(const lc_bvh_data *bvh, const float org[3], const float dir[3], float t_max,
                           lc_hit *hit)
{
    entry stack[LC_BVH_STACK];
    uint32_t n = 0;
    ray r;
    ray_init(&r, org, dir);
    *hit = (lc_hit){ t_max, 0, 0, LC_NONE, LC_NONE };
    if (bvh->n_nodes) stack[n++] = (entry){ 0, 0 };
    while (n) {
        entry e = stack[--n];
        if (e.t > hit->t) continue;
        if (e.ref & LC_BVH_LEAF) {
            tri_hits h;
            const lc_tri_block *b = &bvh->blocks[e.ref & ~LC_BVH_LEAF];
            uint32_t bits = test_tris(b, &r, 0, nextafterf(hit->t, INFINITY), &h);
            if (bits) keep_nearest(bvh, b, &h, bits, hit);
        } else {
            _Alignas(32) float near[8];
            const lc_bvh_node *node = &bvh->nodes[e.ref];
            uint32_t bits = test_boxes(&node->lo[0][0], &r, 0, hit->t, near);
            n = push_sorted(node->child, 0, bits, near, stack, n);
        }
    }
}

/* ---- instances: rays continue in the object's space, with the same t ---- */

/* A point (w = 1) or a vector (w = 0) in the object's space, rounded once. */
static inline void to_object(const lc_instance *at, const float v[3], double w, float out[3])
{
    const double *m = at->to_object, x = (double)v[0], y = (double)v[1], z = (double)v[2];
    for (int k = 0; k < 3; k++, m += 4) out[k] = (float)(m[0] * x + m[1] * y + m[2] * z + m[3] * w);
}

/* Sets *hit to the nearer of itself and the ray's closest hit on an instance. */
static __attribute__((noinline)) void closest_in(const lc_placed *p, uint32_t i, const float org[3],
                                                 const float dir[3], lc_hit *hit)
{
    const lc_instance *at = &p->instances[i];
    float o[3], d[3];
    lc_hit got;
    to_object(at, org, 1, o);
    to_object(at, dir, 0, d);
    closest_tri(&p->objects[at->object], o, d, hit->t, &got);
    if (got.tri == LC_NONE) return;
    got.instance = i;
    if (got.t < hit->t || hit->tri == LC_NONE || (hit->instance != LC_NONE && i < hit->instance)) *hit = got;
}

#define INSTANCE 0x40000000u /* with LC_BVH_LEAF */

/* Lanes of a block of instances' boxes that hold one. */
static inline uint32_t lanes_used(const lc_tri_block *b)
{
    uint32_t bits = 0;
    for (uint32_t i = 0; i < 8; i++) bits |= (uint32_t)(b->tri[i] != LC_NONE) << i;
    return bits;
}

static __attribute__((noinline)) void closest_placed(const lc_placed *p, const float org[3],
                                                     const float dir[3], lc_hit *hit)
{
    entry stack[LC_BVH_STACK];
    uint32_t n = 0;
    ray r;
    ray_init(&r, org, dir);
    if (p->boxes.n_nodes) stack[n++] = (entry){ 0, 0 };
    while (n) {
        entry e = stack[--n];
        _Alignas(32) float near[8];
        if (e.t > hit->t) continue;
        if (!(e.ref & LC_BVH_LEAF)) {
            const lc_bvh_node *node = &p->boxes.nodes[e.ref];
            uint32_t bits = test_boxes(&node->lo[0][0], &r, 0, hit->t, near);
            n = push_sorted(node->child, 0, bits, near, stack, n);
        } else if (e.ref & INSTANCE) {
            closest_in(p, e.ref & ~(LC_BVH_LEAF | INSTANCE), org, dir, hit);
        } else {
            const lc_tri_block *b = &p->boxes.blocks[e.ref & ~LC_BVH_LEAF];
            uint32_t bits = test_boxes(&b->v[0][0][0], &r, 0, hit->t, near) & lanes_used(b);
            n = push_sorted(b->tri, LC_BVH_LEAF | INSTANCE, bits, near, stack, n);
        }
    }
}

static void closest(const lc_bvh_data *bvh, const float org[3], const float dir[3], float t_max, lc_hit *hit)
{
    closest_tri(bvh, org, dir, t_max, hit);
    if (bvh->placed) closest_placed(bvh->placed, org, dir, hit);
}

#undef INSTANCE
