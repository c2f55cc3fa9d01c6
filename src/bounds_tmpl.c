/* bounds_tmpl.c - upper bounds of VF_LANES clusters at once; included by isa_*.c.
 *
 * For a cluster in the box center +- half and a point x: members are p = y - x in cb +- h. Three cosines are bounded
 * the same way, about the axes n (receiver), mirror (Phong lobe) and, with p reversed, the emission cone's axis a:
 *
 *     z1   greatest z = axis.p        r  least distance of the box from the axis       D  least |p|
 *     z1 <= 0: cos <= 0, else  cos = z / |p| <= z1 / sqrt(max(r^2 + z1^2, D^2))          [Miksik07] eq. 5
 *
 * in the frame whose second axis points from the axis to the box centre. Receiver cosine and 1/d^2 are bounded
 * together (design.md): with z in [z0, z1], cos / d^2 = z / |p|^3 <= z / max(z^2 + r^2, D^2)^(3/2), which grows in z
 * up to sqrt(D^2 - r^2) and then up to r / sqrt 2, and falls beyond: its maximum is at z* = those two's greater one,
 * clamped to [z0, z1]. That is never above the product of the separate bounds.
 *
 * Rounding, u = 2^-24.
 * - Subtraction: the estimate's p and our cb are each within u of the exact difference, so h is widened by
 *   4u (|cb| + half) per axis. From there on p means the float vector that the estimate uses.
 * - Dot products of three terms are within 3u of the sum of |terms|; the estimate's and our two make at most 9u, we
 *   add 16u S, S = sum |axis_k| (|cb_k| + h_k).
 * - r: the lateral vector t = cb - (axis.cb) axis is within 8u M of the exact one (M = sum |cb_k| + h_k; an axis of
 *   length 1 +- 2u included), and its direction within 8u M / |t|, which matters by at most that times the half
 *   extent along the axis. Both are subtracted.
 * - Boxes within NEAR of the point have squares near underflow: their cosines are taken as 1.
 * - What follows is products, quotients and roots of positive terms: below 40 operations with those of the
 *   estimate, each within u; the factor SLACK = 1 + 2^-18 = 1 + 64u covers them. The limits of
 *   light.h and layout.h keep what they multiply away from denormals wherever the estimate is not 0.
 * - Cosines enter angles (emission) and powers (Phong), where relative errors grow: COS_SLACK = 32u is added to
 *   them first: the estimate's own cosine is within 12u.
 */
#include "vec.h"

#define U 0x1p-24f
#define SLACK (1 + 0x1p-18f)
#define COS_SLACK (32 * U)
#define NEAR 1e-12f /* scene units: the square root of LC_MIN_D2, below which 1/d^2 is flat anyway */

#define ADD vf_add
#define SUB vf_sub
#define MUL vf_mul
#define DIV vf_div
#define MIN vf_min
#define MAX vf_max
#define SET vf_set

typedef struct {
    vf x, y, z;
} LC_FN(v3);

#define v3 LC_FN(v3)

LC_INLINE v3 LC_FN(set3)(const float a[3]) { return (v3){ SET(a[0]), SET(a[1]), SET(a[2]) }; }

LC_INLINE vf LC_FN(dot)(v3 a, v3 b) { return ADD(ADD(MUL(a.x, b.x), MUL(a.y, b.y)), MUL(a.z, b.z)); }

LC_INLINE v3 LC_FN(abs3)(v3 a) { return (v3){ vf_abs(a.x), vf_abs(a.y), vf_abs(a.z) }; }

/* The boxes about x, and what every axis needs of them. */
typedef struct {
    v3 c, h, m;   /* centre, half extent, |c| + h of p */
    vf m_sum;
    vf d2;       /* least |p|^2 */
} LC_FN(rel_box);

#define rel_box LC_FN(rel_box)

/* The boxes seen along an axis. */
typedef struct {
    vf z0, z1; /* range of axis.p; z0 not clamped */
    vf r2;     /* least squared distance from the axis */
    vf l;      /* distance of the centre from the axis */
} LC_FN(range);

#define range LC_FN(range)

/* Field `at` (a constant) of the lanes; neighbours come in pairs, of which the compiler loads each once. */
LC_INLINE vf LC_FN(field)(const float *const *b, size_t at)
{
    vf two[2];
    vf_pairs(b, LC_BLOCK * (at & ~(size_t)1), two);
    return two[at & 1];
}

#define FIELD(b, name, k) LC_FN(field)(b, offsetof(lc_node_block, name) / (LC_BLOCK * sizeof(float)) + (k))
#define FIELD3(b, name) ((v3){ FIELD(b, name, 0), FIELD(b, name, 1), FIELD(b, name, 2) })

LC_INLINE void LC_FN(widen)(vf c, vf half, vf *h, vf *m, vf *d)
{
    vf a = vf_abs(c);
    *h = ADD(half, MUL(ADD(a, half), SET(4 * U)));
    *m = ADD(a, *h);
    *d = MAX(SUB(a, *h), SET(0));
}

LC_INLINE rel_box LC_FN(rel_box_make)(const float *const *b, const float x[3])
{
    rel_box r;
    v3 center = FIELD3(b, center), half = FIELD3(b, half), d;
    r.c = (v3){ SUB(center.x, SET(x[0])), SUB(center.y, SET(x[1])), SUB(center.z, SET(x[2])) };
    LC_FN(widen)(r.c.x, half.x, &r.h.x, &r.m.x, &d.x);
    LC_FN(widen)(r.c.y, half.y, &r.h.y, &r.m.y, &d.y);
    LC_FN(widen)(r.c.z, half.z, &r.h.z, &r.m.z, &d.z);
    r.m_sum = ADD(ADD(r.m.x, r.m.y), r.m.z);
    r.d2 = LC_FN(dot)(d, d);
    return r;
}

/* sign: 1, or -1 for the reversed box. */
LC_INLINE range LC_FN(range_make)(const rel_box *b, v3 axis, float sign)
{
    v3 a = LC_FN(abs3)(axis), t;
    vf zc = LC_FN(dot)(axis, b->c), zh = LC_FN(dot)(a, b->h), slack = MUL(SET(16 * U), LC_FN(dot)(a, b->m));
    t = (v3){ SUB(b->c.x, MUL(axis.x, zc)), SUB(b->c.y, MUL(axis.y, zc)), SUB(b->c.z, MUL(axis.z, zc)) };
    vf l = vf_sqrt(LC_FN(dot)(t, t)), e = MUL(SET(8 * U), b->m_sum);
    vf support = DIV(ADD(LC_FN(dot)(LC_FN(abs3)(t), b->h), MUL(e, zh)), l);
    vf r = SUB(SUB(l, e), support); /* NaN where l is 0: MAX drops it */
    r = MAX(r, SET(0));
    vf z = MUL(zc, SET(sign));
    return (range){ SUB(SUB(z, zh), slack), ADD(ADD(z, zh), slack), MUL(r, r), l };
}

/* Greatest cosine about the axis where z1 > 0. d2: least |p|^2. */
LC_INLINE vf LC_FN(max_cos)(const range *a, vf d2)
{
    vf q = MAX(ADD(a->r2, MUL(a->z1, a->z1)), d2), one = SET(1);
    return vf_sel_gt(q, SET(NEAR * NEAR), MIN(DIV(a->z1, vf_sqrt(q)), one), one);
}

/* Greatest cos phi over boxes and cones; <= 0 where all face away. */
LC_INLINE vf LC_FN(max_emission)(const float *const *b, const rel_box *box)
{
    const vf one = SET(1), zero = SET(0), slack = SET(COS_SLACK);
    vf cc = FIELD(b, cos_cone, 0);
    range a = LC_FN(range_make)(box, FIELD3(b, axis), -1);
    /* all behind: the largest cosine is at the largest distance from the axis */
    vf far = ADD(ADD(a.l, vf_sqrt(LC_FN(dot)(box->h, box->h))), MUL(SET(8 * U), box->m_sum));
    vf behind = DIV(a.z1, vf_sqrt(ADD(MUL(far, far), MUL(a.z1, a.z1))));
    vf ct = ADD(vf_sel_gt(zero, a.z1, behind, LC_FN(max_cos)(&a, box->d2)), slack);
    vf st = vf_sqrt(MAX(MUL(SUB(one, ct), ADD(one, ct)), zero));
    vf sc = vf_sqrt(MAX(MUL(SUB(one, cc), ADD(one, cc)), zero));
    vf e = MIN(ADD(ADD(MUL(ct, cc), MUL(st, sc)), slack), one);
    e = vf_sel_gt(cc, ct, e, one);
    e = vf_sel_gt(cc, SET(-1), e, one);
    return vf_sel_gt(SET(NEAR), box->m_sum, one, e);
}

/* Greatest receiver cosine times 1 / f(d). */
LC_INLINE vf LC_FN(max_geometry)(const float *const *b, const lc_point *p, const rel_box *box, const range *n)
{
    const vf inf = SET(INFINITY), zero = SET(0), min_d2 = SET(p->min_d2);
    v3 k = FIELD3(b, atten);
    vf d2c = MAX(box->d2, min_d2);
    vf f = ADD(ADD(k.x, MUL(k.y, vf_sqrt(d2c))), MUL(k.z, d2c));
    vf separate = vf_sel_gt(f, zero, DIV(LC_FN(max_cos)(n, box->d2), f), inf); /* members whose least A, B, C are all 0 */
    vf z = MAX(vf_sqrt(MUL(SET(0.5f), n->r2)), vf_sqrt(MAX(SUB(box->d2, n->r2), zero)));
    z = MIN(MAX(z, n->z0), n->z1);
    vf q = MAX(ADD(MUL(z, z), n->r2), box->d2);
    vf joint = MIN(DIV(DIV(z, vf_sqrt(q)), MUL(q, k.z)), separate);
    joint = vf_sel_gt(q, min_d2, joint, separate);
    return vf_sel_gt(k.z, zero, joint, separate);
}

LC_INLINE vf LC_FN(lum_dot)(const float f[3], v3 power)
{
    vf r = MUL(SET(0.2126f), MUL(SET(f[0]), power.x)), g = MUL(SET(0.7152f), MUL(SET(f[1]), power.y));
    return ADD(ADD(r, g), MUL(SET(0.0722f), MUL(SET(f[2]), power.z)));
}

/* Greatest power of the Phong lobe's cosine. */
LC_INLINE vf LC_FN(max_lobe)(const lc_point *p, const rel_box *box)
{
    range m = LC_FN(range_make)(box, LC_FN(set3)(p->mirror), 1);
    vf cos_m = MIN(ADD(LC_FN(max_cos)(&m, box->d2), SET(COS_SLACK)), SET(1));
    cos_m = vf_sel_gt(m.z1, SET(0), cos_m, SET(0));
    return LC_FN(pow01)(vf_sel_gt(SET(NEAR), box->m_sum, SET(1), cos_m), p->exponent);
}

/* b: as vf_pairs takes them. kind, glossy: constants. */
LC_INLINE vf LC_FN(bound)(const float *const *b, lc_light_kind kind, bool glossy, const lc_point *p)
{
    static const float origin[3] = { 0, 0, 0 };
    const vf zero = SET(0), near = SET(NEAR);
    rel_box box = LC_FN(rel_box_make)(b, kind == LC_LIGHT_DIRECTIONAL ? origin : p->pos);
    range n = LC_FN(range_make)(&box, LC_FN(set3)(p->n), 1);
    v3 power = FIELD3(b, power);
    vf u = LC_FN(lum_dot)(p->diffuse, power);
    if (glossy) u = ADD(u, MUL(LC_FN(lum_dot)(p->specular, power), LC_FN(max_lobe)(p, &box)));
    vf lit = u;
    u = MUL(u, kind == LC_LIGHT_DIRECTIONAL ? LC_FN(max_cos)(&n, box.d2) : LC_FN(max_geometry)(b, p, &box, &n));
    u = MUL(u, SET(SLACK));
    u = vf_sel_gt(n.z1, zero, u, vf_sel_gt(near, box.m_sum, u, zero)); /* behind the horizon */
    if (kind == LC_LIGHT_ORIENTED) {
        vf e = LC_FN(max_emission)(b, &box);
        u = vf_sel_gt(e, zero, MUL(u, e), zero);
    }
    return vf_sel_gt(lit, zero, u, zero); /* black: 0 times an infinite geometry */
}

LC_INLINE void LC_FN(bounds_of)(const lc_node_block *blocks, const uint32_t *pair, uint32_t n, lc_light_kind kind, bool glossy,
                                const lc_point *p, float *ub)
{
    enum { AT_ONCE = VF_LANES > 1 ? VF_LANES / 2 : 1 };
    for (uint32_t i = 0; i < 2 * n; i += VF_LANES) {
        const float *b[AT_ONCE]; /* the last one fills up */
        for (uint32_t k = 0; k < AT_ONCE; k++) b[k] = &blocks[pair[i / 2 + k < n ? i / 2 + k : n - 1]].center[0][0];
        if (VF_LANES == 1) b[0] += i & 1;
        vf_store(ub + i, LC_FN(bound)(b, kind, glossy, p));
    }
}

static void LC_FN(bounds)(const lc_node_block *blocks, const uint32_t *pair, uint32_t n, lc_light_kind kind, const lc_point *p,
                          float *ub)
{
    switch (kind) {
    case LC_LIGHT_POINT:
        if (p->glossy) LC_FN(bounds_of)(blocks, pair, n, LC_LIGHT_POINT, true, p, ub);
        else LC_FN(bounds_of)(blocks, pair, n, LC_LIGHT_POINT, false, p, ub);
        break;
    case LC_LIGHT_ORIENTED:
        if (p->glossy) LC_FN(bounds_of)(blocks, pair, n, LC_LIGHT_ORIENTED, true, p, ub);
        else LC_FN(bounds_of)(blocks, pair, n, LC_LIGHT_ORIENTED, false, p, ub);
        break;
    case LC_LIGHT_DIRECTIONAL:
        if (p->glossy) LC_FN(bounds_of)(blocks, pair, n, LC_LIGHT_DIRECTIONAL, true, p, ub);
        else LC_FN(bounds_of)(blocks, pair, n, LC_LIGHT_DIRECTIONAL, false, p, ub);
        break;
    }
}

#undef U
#undef ADD
#undef SUB
#undef MUL
#undef DIV
#undef MIN
#undef MAX
#undef SET
#undef v3
#undef rel_box
#undef range
#undef FIELD
#undef FIELD3
