/* bvh_tmpl.c - closest and any hit on the eight-wide BVH; included by isa_*.c.
 *
 * Triangles: Woop, Benthin, Wald 2013, "Watertight ray/triangle intersection". The ray is sheared onto its largest
 * axis; a vertex is sheared by the same operations wherever it is used, and the sign of each edge function is exact
 * (two rounded products compare as the exact ones do or tie; ties are settled in double, where they are exact), so a
 * ray through a shared edge or vertex can't pass between its triangles.
 *
 * Boxes: Ize 2013, "Robust BVH ray traversal": the far distance is widened by 1 + 2 gamma(3), here 1 + 2^-20; the
 * builder pads the boxes by what the shear may round off.
 */
#include "base/vec.h"

#define FAR_SLACK (1 + 0x1p-20f)

typedef struct {
    int kx, ky, kz;
    float sx, sy, sz; /* shear */
    vf8 vo[3], vi[3]; /* origin, inverse direction, per axis */
    vf8 vf[3];        /* inverse direction for far planes: times FAR_SLACK */
    uint32_t near[3], far[3]; /* where in a node, in floats, the near and far planes of an axis stand */
    vf8 vsx, vsy;
} LC_FN(ray);

#define ray LC_FN(ray)

static inline void LC_FN(ray_init)(ray *r, const float org[3], const float dir[3])
{
    for (int k = 0; k < 3; k++) {
        float d = fabsf(dir[k]) < 1e-30f ? copysignf(1e-30f, dir[k]) : dir[k], inv = 1 / d;
        uint32_t lo = 8 * (uint32_t)k, hi = 24 + lo;
        r->vo[k] = vf8_set(org[k]);
        r->vi[k] = vf8_set(inv);
        r->vf[k] = vf8_set(inv * FAR_SLACK);
        r->near[k] = inv >= 0 ? lo : hi;
        r->far[k] = inv >= 0 ? hi : lo;
    }
    float ax = fabsf(dir[0]), ay = fabsf(dir[1]), az = fabsf(dir[2]);
    r->kz = az >= ax && az >= ay ? 2 : ay >= ax ? 1 : 0;
    r->kx = r->kz == 2 ? 0 : r->kz + 1;
    r->ky = r->kx == 2 ? 0 : r->kx + 1;
    float dz = dir[r->kz];
    if (dz == 0) dz = 1e-30f; /* a null direction hits nothing sensible, but must not divide by 0 */
    r->sx = dir[r->kx] / dz;
    r->sy = dir[r->ky] / dz;
    r->sz = 1 / dz;
    r->vsx = vf8_set(r->sx);
    r->vsy = vf8_set(r->sy);
}

/* Bits of the boxes that the ray meets in [t_min, t_max]; near distances to tn. f: lo[3][8], then hi[3][8]. */
static inline uint32_t LC_FN(test_boxes)(const float *f, const ray *r, float t_min, float t_max, vf8 *tn)
{
    vf8 near = vf8_mul(vf8_sub(vf8_load(f + r->near[0]), r->vo[0]), r->vi[0]);
    vf8 far = vf8_mul(vf8_sub(vf8_load(f + r->far[0]), r->vo[0]), r->vf[0]);
    near = vf8_max(near, vf8_set(t_min));
    far = vf8_min(far, vf8_set(t_max));
    near = vf8_max(vf8_mul(vf8_sub(vf8_load(f + r->near[1]), r->vo[1]), r->vi[1]), near);
    far = vf8_min(vf8_mul(vf8_sub(vf8_load(f + r->far[1]), r->vo[1]), r->vf[1]), far);
    near = vf8_max(vf8_mul(vf8_sub(vf8_load(f + r->near[2]), r->vo[2]), r->vi[2]), near);
    far = vf8_min(vf8_mul(vf8_sub(vf8_load(f + r->far[2]), r->vo[2]), r->vf[2]), far);
    *tn = near;
    return vf8_le(near, far);
}

typedef struct {
    vf8 v, w, t, det; /* edge functions 1 and 2, distance, sum of the edge functions */
} LC_FN(tri_hits);

#define tri_hits LC_FN(tri_hits)

/* Edge functions that came out 0 once more, in double, lane by lane. */
static void LC_FN(settle_zeros)(const vf8 x[3], const vf8 y[3], uint32_t lanes, vf8 edge[3])
{
    _Alignas(32) float X[3][8], Y[3][8], e[3][8];
    for (int k = 0; k < 3; k++) {
        vf8_store(X[k], x[k]);
        vf8_store(Y[k], y[k]);
        vf8_store(e[k], edge[k]);
    }
    for (int i = 0; i < 8; i++) {
        if (!(lanes >> i & 1)) continue;
        for (int k = 0; k < 3; k++) { /* edge k is opposite vertex k: from vertex k + 1 to k + 2 */
            int a = (k + 1) % 3, b = (k + 2) % 3;
            double d = (double)X[b][i] * Y[a][i] - (double)Y[b][i] * X[a][i];
            e[k][i] = (float)d;
            if (e[k][i] == 0 && d != 0) e[k][i] = d > 0 ? FLT_MIN : -FLT_MIN;
        }
    }
    for (int k = 0; k < 3; k++) edge[k] = vf8_load(e[k]);
}

/* Bits of the triangles that the ray passes inside of; sheared vertices and edge functions to x, y, z, e. */
static inline uint32_t LC_FN(edges)(const lc_tri_block *b, const ray *r, vf8 x[3], vf8 y[3], vf8 z[3], vf8 e[3])
{
    const vf8 zero = vf8_set(0);
    for (int k = 0; k < 3; k++) {
        z[k] = vf8_sub(vf8_load(b->v[k][r->kz]), r->vo[r->kz]);
        x[k] = vf8_sub(vf8_sub(vf8_load(b->v[k][r->kx]), r->vo[r->kx]), vf8_mul(r->vsx, z[k]));
        y[k] = vf8_sub(vf8_sub(vf8_load(b->v[k][r->ky]), r->vo[r->ky]), vf8_mul(r->vsy, z[k]));
    }
    for (int k = 0; k < 3; k++) { /* edge k is opposite vertex k */
        int i = (k + 1) % 3, j = (k + 2) % 3;
        e[k] = vf8_sub(vf8_mul(x[j], y[i]), vf8_mul(y[j], x[i]));
    }
    uint32_t pos = vf8_le(zero, e[0]) & vf8_le(zero, e[1]) & vf8_le(zero, e[2]);
    uint32_t neg = vf8_le(e[0], zero) & vf8_le(e[1], zero) & vf8_le(e[2], zero);
    if (!(pos | neg)) return 0;
    uint32_t zeros = (pos | neg) & (vf8_eq(e[0], zero) | vf8_eq(e[1], zero) | vf8_eq(e[2], zero));
    if (zeros) {
        LC_FN(settle_zeros)(x, y, zeros, e);
        pos = vf8_le(zero, e[0]) & vf8_le(zero, e[1]) & vf8_le(zero, e[2]);
        neg = vf8_le(e[0], zero) & vf8_le(e[1], zero) & vf8_le(e[2], zero);
    }
    return (pos | neg) & ~vf8_eq(vf8_add(vf8_add(e[0], e[1]), e[2]), zero);
}

/* Distances to the triangles' planes, a.N / d.N with N from the edges. What Woop's test interpolates instead, e.z / det, is off by
 * 1e-4 of the farthest vertex's distance where a triangle is long and the ray starts far away. */
static inline vf8 LC_FN(plane_distances)(const lc_tri_block *b, const ray *r)
{
    const int axis[3] = { r->kx, r->ky, r->kz };
    vf8 v[3], e[3], f[3], n[3];
    for (int k = 0; k < 3; k++) {
        v[k] = vf8_load(b->v[0][axis[k]]);
        e[k] = vf8_sub(vf8_load(b->v[1][axis[k]]), v[k]);
        f[k] = vf8_sub(vf8_load(b->v[2][axis[k]]), v[k]);
        v[k] = vf8_sub(v[k], r->vo[axis[k]]);
    }
    for (int k = 0, x = 1, y = 2; k < 3; x = y, y = k++) n[k] = vf8_sub(vf8_mul(e[x], f[y]), vf8_mul(e[y], f[x]));
    vf8 h = vf8_add(vf8_add(vf8_mul(v[0], n[0]), vf8_mul(v[1], n[1])), vf8_mul(v[2], n[2]));
    vf8 along = vf8_add(vf8_add(vf8_mul(r->vsx, n[0]), vf8_mul(r->vsy, n[1])), n[2]);
    return vf8_mul(vf8_div(h, along), vf8_set(r->sz));
}

/* Bits of the triangles that the ray meets at t in (t_min, t_max). */
static inline uint32_t LC_FN(test_tris)(const lc_tri_block *b, const ray *r, float t_min, float t_max, tri_hits *h)
{
    vf8 x[3], y[3], z[3], e[3];
    uint32_t in = LC_FN(edges)(b, r, x, y, z, e);
    if (!in) return 0;
    vf8 det = vf8_add(vf8_add(e[0], e[1]), e[2]);
    vf8 t = LC_FN(plane_distances)(b, r);
    *h = (tri_hits){ e[1], e[2], t, det };
    return in & vf8_lt(vf8_set(t_min), t) & vf8_lt(t, vf8_set(t_max));
}

static inline bool LC_FN(is_opaque)(const lc_alpha *alpha, uint32_t tri, float u, float v, bool shadow)
{
    return !(alpha->bits[tri / 32] >> tri % 32 & 1) || alpha->opaque(alpha->user, tri, u, v, shadow);
}

/* Keeps the nearest of the lanes in `bits`. */
static inline void LC_FN(keep_nearest)(const lc_bvh_data *bvh, const lc_tri_block *b, const tri_hits *h, uint32_t bits,
                                       lc_hit *hit)
{
    _Alignas(32) float t[8], v[8], w[8], det[8];
    vf8_store(t, h->t);
    vf8_store(v, h->v);
    vf8_store(w, h->w);
    vf8_store(det, h->det);
    for (; bits; bits &= bits - 1) {
        int i = __builtin_ctz(bits);
        uint32_t tri = bvh->first_tri + b->tri[i];
        if (!(t[i] < hit->t || (t[i] == hit->t && tri < hit->tri))) continue;
        const lc_hit got = { t[i], v[i] / det[i], w[i] / det[i], tri, LC_NONE };
        if (!bvh->alpha || LC_FN(is_opaque)(bvh->alpha, tri, got.u, got.v, false)) *hit = got;
    }
}

typedef struct {
    float t;
    uint32_t ref;
} LC_FN(entry);

#define entry LC_FN(entry)

/* Pushes the children in `bits`, farthest first, so that the nearest is popped next. */
static inline uint32_t LC_FN(push_sorted)(const uint32_t child[8], uint32_t flags, uint32_t bits, vf8 near, entry *stack,
                                          uint32_t n)
{
    _Alignas(32) float tn[8];
    vf8_store(tn, near);
    uint32_t first = n;
    for (; bits; bits &= bits - 1) {
        int i = __builtin_ctz(bits);
        entry e = { tn[i], child[i] | flags };
        uint32_t k = n++;
        for (; k > first && stack[k - 1].t < e.t; k--) stack[k] = stack[k - 1];
        stack[k] = e;
    }
    return n;
}

/* Of the BVH's own triangles. */
LC_INLINE void LC_FN(closest_tri)(const lc_bvh_data *bvh, const float org[3], const float dir[3], float t_max, lc_hit *hit)
{
    entry stack[LC_BVH_STACK];
    uint32_t n = 0;
    ray r;
    LC_FN(ray_init)(&r, org, dir);
    *hit = (lc_hit){ t_max, 0, 0, LC_NONE, LC_NONE };
    if (bvh->n_nodes) stack[n++] = (entry){ 0, 0 };
    while (n) {
        entry e = stack[--n];
        if (e.t > hit->t) continue;
        if (e.ref & LC_BVH_LEAF) {
            tri_hits h;
            const lc_tri_block *b = &bvh->blocks[e.ref & ~LC_BVH_LEAF];
            uint32_t bits = LC_FN(test_tris)(b, &r, 0, nextafterf(hit->t, INFINITY), &h);
            if (bits) LC_FN(keep_nearest)(bvh, b, &h, bits, hit);
        } else {
            vf8 near;
            const lc_bvh_node *node = &bvh->nodes[e.ref];
            uint32_t bits = LC_FN(test_boxes)(&node->lo[0][0], &r, 0, hit->t, &near);
            n = LC_FN(push_sorted)(node->child, 0, bits, near, stack, n);
        }
    }
}

/* ---- instances: rays go on in the object's space, with the same t ---- */

/* A point (w = 1) or a vector (w = 0) in the object's space, rounded once. */
static inline void LC_FN(to_object)(const lc_instance *at, const float v[3], double w, float out[3])
{
    const double *m = at->to_object, x = (double)v[0], y = (double)v[1], z = (double)v[2];
    for (int k = 0; k < 3; k++, m += 4) out[k] = (float)(m[0] * x + m[1] * y + m[2] * z + m[3] * w);
}

/* The nearer of *hit and what the ray meets of an instance. */
static __attribute__((noinline)) void LC_FN(closest_in)(const lc_placed *p, uint32_t i, const float org[3], const float dir[3],
                                                        lc_hit *hit)
{
    const lc_instance *at = &p->instances[i];
    float o[3], d[3];
    lc_hit got;
    LC_FN(to_object)(at, org, 1, o);
    LC_FN(to_object)(at, dir, 0, d);
    LC_FN(closest_tri)(&p->objects[at->object], o, d, hit->t, &got);
    if (got.tri == LC_NONE) return;
    got.instance = i;
    if (got.t < hit->t || hit->tri == LC_NONE || (hit->instance != LC_NONE && i < hit->instance)) *hit = got;
}

#define INSTANCE 0x40000000u /* with LC_BVH_LEAF */

/* Lanes of a block of instances' boxes that hold one. */
static inline uint32_t LC_FN(lanes_used)(const lc_tri_block *b)
{
    uint32_t bits = 0;
    for (uint32_t i = 0; i < 8; i++) bits |= (uint32_t)(b->tri[i] != LC_NONE) << i;
    return bits;
}

static __attribute__((noinline)) void LC_FN(closest_placed)(const lc_placed *p, const float org[3], const float dir[3],
                                                            lc_hit *hit)
{
    entry stack[LC_BVH_STACK];
    uint32_t n = 0;
    ray r;
    LC_FN(ray_init)(&r, org, dir);
    if (p->boxes.n_nodes) stack[n++] = (entry){ 0, 0 };
    while (n) {
        entry e = stack[--n];
        vf8 near;
        if (e.t > hit->t) continue;
        if (!(e.ref & LC_BVH_LEAF)) {
            const lc_bvh_node *node = &p->boxes.nodes[e.ref];
            uint32_t bits = LC_FN(test_boxes)(&node->lo[0][0], &r, 0, hit->t, &near);
            n = LC_FN(push_sorted)(node->child, 0, bits, near, stack, n);
        } else if (e.ref & INSTANCE) {
            LC_FN(closest_in)(p, e.ref & ~(LC_BVH_LEAF | INSTANCE), org, dir, hit);
        } else {
            const lc_tri_block *b = &p->boxes.blocks[e.ref & ~LC_BVH_LEAF];
            uint32_t bits = LC_FN(test_boxes)(&b->v[0][0][0], &r, 0, hit->t, &near) & LC_FN(lanes_used)(b);
            n = LC_FN(push_sorted)(b->tri, LC_BVH_LEAF | INSTANCE, bits, near, stack, n);
        }
    }
}

static void LC_FN(closest)(const lc_bvh_data *bvh, const float org[3], const float dir[3], float t_max, lc_hit *hit)
{
    LC_FN(closest_tri)(bvh, org, dir, t_max, hit);
    if (bvh->placed) LC_FN(closest_placed)(bvh->placed, org, dir, hit);
}

#undef ray
#undef tri_hits
#undef entry
#undef INSTANCE
