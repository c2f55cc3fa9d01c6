/* bounds_tmpl.c - upper bounds of VF_LANES clusters at once; included by isa_*.c.
 *
 * For a cluster in the box center +- half and a point x: members are p = y - x in c +- h. Three cosines are bounded
 * the same way, about the axes n (receiver), mirror (Phong lobe) and, with p reversed, the emission cone's axis a:
 *
 *     z1   greatest z = axis.p        r  least distance of the box from the axis       D  least |p|
 *     z1 <= 0: cos <= 0, else  cos = z / |p| <= z1 / sqrt(max(r^2 + z1^2, D^2))          [Miksik07] eq. 5
 *
 * in the frame whose second axis, t, points from the axis to the box centre: r |t| = t.t - sum |t_k| h_k. Receiver
 * cosine and 1/d^2 are bounded together (design.md): with z in [z0, z1], cos / d^2 = z / |p|^3 <=
 * z / max(z^2 + r^2, D^2)^(3/2), which grows in z up to sqrt(D^2 - r^2) and then up to r / sqrt 2, and falls beyond:
 * its maximum is at z* = those two's greater one, clamped to [z0, z1]. That is never above the product of the separate
 * bounds. With q = max(z*^2 + r^2, D^2) it is sqrt(z*^2 / q) / q: z* itself is not needed. z*^2 and q are taken as no
 * less than the distance floor: the cosine is 1 below it, and too great by 1e-5 at most of the scene's size over |p|.
 *
 * Rounding, u = 2^-24, m_k = |c_k| + half_k, M = sum m_k.
 * - Subtraction: the estimate's p and our c are each within u of the exact difference, so h_k = half_k + 4u m_k.
 *   From there on p means the float vector that the estimate uses.
 * - D^2: the widening takes at most 2 * 4u m_k d_k of a square d_k^2, d_k = max(|c_k| - half_k, 0) <= m_k, and our own
 *   rounding 6u m_k^2: we subtract 18u M^2. What is left may be negative, which is as good as 0.
 * - Dot products of three terms are within 3u of the sum of |terms|, at most S = sum |axis_k| m_k <= (1 + 2u) M; the
 *   estimate's and our two make at most 9u S, the widening of h 4u S: we add 14u M.
 * - r: t = c - (axis.c) axis is within 8u M of the exact one (an axis of length 1 +- 2u included), and its direction
 *   within 8u M / |t|, which matters by at most that times the half extent along the axis: together at most
 *   8u M (|t| + extent) <= 8u M^2 of r |t|. The widening is 4u sum |t_k| m_k <= 4u M^2, our own rounding 6u M^2
 *   (t.t <= M^2, sum |t_k| h_k <= M^2 / 4): 18u M^2.
 * - Boxes within NEAR of the point have squares near underflow: their cosines are taken as 1, and NEAR is added to z1.
 * - What follows is products, quotients and roots of positive terms: below 40 operations with those of the
 *   estimate, each within u; the factor SLACK = 1 + 2^-18 = 1 + 64u covers them. The limits of
 *   light.h and layout.h keep what they multiply away from denormals wherever the estimate is not 0.
 * - Cosines enter angles (emission) and powers (Phong), where relative errors grow. For angles COS_SLACK = 32u is added
 *   to them first: the estimate's own cosine is within 12u. For powers the square is multiplied by 1 + 32u: the errors
 *   of dot products are in z1 already, so what is left is relative: 4.5u of the estimate's quotient, twice; 8u of ours
 *   (r^2 5u, q and the quotient 1u an operation); 4u of a direction of length 1 +- 2u that no estimate divides by.
 * - The power is fmath_tmpl.c's pow01_ub: above the exact one, and so above the estimate's times 1 - 2e-10.
 */
#include "vec.h"

#define U 0x1p-24f
#define SLACK (1 + 0x1p-18f)
#define COS_SLACK (32 * U)
#define COS2_SLACK (1 + 32 * U)
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
    v3 c, half, m; /* centre; half extent without the widening; |c| + half */
    vf m_sum;
    vf z_slack;    /* of z */
    vf r_slack;    /* of r |t| and d2 */
    vf d2;         /* least |p|^2, or less than 0 */
} LC_FN(rel_box);

#define rel_box LC_FN(rel_box)

/* The boxes seen along an axis. */
typedef struct {
    vf z0, z1; /* range of axis.p; z0 not clamped */
    vf r2;     /* least squared distance from the axis */
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

/* m = |c| + half; returns the least |p_k|, not widened. */
LC_INLINE vf LC_FN(least)(vf c, vf half, vf *m)
{
    vf a = vf_abs(c);
    *m = ADD(a, half);
    return MAX(SUB(a, half), SET(0));
}

LC_INLINE rel_box LC_FN(rel_box_make)(const float *const *b, const float x[3])
{
    rel_box r;
    v3 center = FIELD3(b, center), d;
    r.half = FIELD3(b, half);
    r.c = (v3){ SUB(center.x, SET(x[0])), SUB(center.y, SET(x[1])), SUB(center.z, SET(x[2])) };
    d.x = LC_FN(least)(r.c.x, r.half.x, &r.m.x);
    d.y = LC_FN(least)(r.c.y, r.half.y, &r.m.y);
    d.z = LC_FN(least)(r.c.z, r.half.z, &r.m.z);
    r.m_sum = ADD(ADD(r.m.x, r.m.y), r.m.z);
    r.z_slack = ADD(MUL(r.m_sum, SET(14 * U)), SET(NEAR));
    r.r_slack = MUL(r.m_sum, MUL(r.m_sum, SET(18 * U)));
    r.d2 = SUB(LC_FN(dot)(d, d), r.r_slack);
    return r;
}

/* reversed: of the box of -p. */
LC_INLINE range LC_FN(range_make)(const rel_box *b, v3 axis, bool reversed)
{
    const vf zero = SET(0);
    vf zc = LC_FN(dot)(axis, b->c), zh = ADD(LC_FN(dot)(LC_FN(abs3)(axis), b->half), b->z_slack);
    v3 t = { SUB(b->c.x, MUL(axis.x, zc)), SUB(b->c.y, MUL(axis.y, zc)), SUB(b->c.z, MUL(axis.z, zc)) };
    vf tt = LC_FN(dot)(t, t), support = ADD(LC_FN(dot)(LC_FN(abs3)(t), b->half), b->r_slack);
    vf rt = MAX(SUB(tt, support), zero), r2 = MAX(MUL(rt, DIV(rt, tt)), zero); /* NaN where tt is 0: MAX drops it */
    return (range){ SUB(reversed ? vf_neg(zc) : zc, zh), reversed ? SUB(zh, zc) : ADD(zc, zh), r2 };
}

/* Least |p|^2 at the greatest cosine, where z1 > 0. */
LC_INLINE vf LC_FN(least_q)(const range *a, vf d2) { return MAX(ADD(a->r2, MUL(a->z1, a->z1)), d2); }

/* Greatest cosine about the axis for that q. */
LC_INLINE vf LC_FN(max_cos)(const range *a, vf q)
{
    const vf one = SET(1);
    return vf_sel_gt(q, SET(NEAR * NEAR), MIN(DIV(a->z1, vf_sqrt(q)), one), one);
}

/* Greatest cos phi over boxes and cones; <= 0 where all face away. */
LC_INLINE vf LC_FN(max_emission)(const float *const *b, const rel_box *box)
{
    const vf one = SET(1), zero = SET(0), slack = SET(COS_SLACK);
    vf cc = FIELD(b, cos_cone, 0);
    range a = LC_FN(range_make)(box, FIELD3(b, axis), true);
    /* all behind: the largest cosine is at the largest distance */
    vf q = vf_sel_gt(zero, a.z1, LC_FN(dot)(box->m, box->m), LC_FN(least_q)(&a, box->d2));
    vf ct = ADD(LC_FN(max_cos)(&a, q), slack);
    vf sines = MUL(MUL(SUB(one, ct), ADD(one, ct)), MUL(SUB(one, cc), ADD(one, cc))); /* squared */
    vf e = MIN(ADD(ADD(MUL(ct, cc), vf_sqrt(MAX(sines, zero))), slack), one);
    e = vf_sel_gt(cc, ct, e, one);
    e = vf_sel_gt(cc, SET(-1), e, one);
    return vf_sel_gt(SET(NEAR), box->m_sum, one, e);
}

/* Greatest receiver cosine times 1 / f(d). */
LC_INLINE vf LC_FN(max_geometry)(const float *const *b, const lc_point *p, const rel_box *box, const range *n)
{
    const vf zero = SET(0), min_d2 = SET(p->min_d2);
    v3 k = FIELD3(b, atten);
    vf zz = MAX(MUL(SET(0.5f), n->r2), SUB(box->d2, n->r2)); /* z*^2 */
    zz = MIN(MAX(zz, MUL(n->z0, MAX(n->z0, zero))), MUL(n->z1, n->z1));
    vf inv_q = DIV(SET(1), MAX(MAX(ADD(zz, n->r2), box->d2), min_d2));
    vf g = MUL(vf_sqrt(MUL(MAX(zz, min_d2), inv_q)), inv_q);
    vf ab = ADD(k.x, k.y), unlike = ADD(ab, vf_abs(SUB(k.z, SET(1)))); /* other than 1 / d^2 */
    if (!vf_any_gt(unlike, zero)) return g;                            /* where g / C is g */
    vf d2c = MAX(box->d2, min_d2), f = ADD(ADD(k.x, MUL(k.y, vf_sqrt(d2c))), MUL(k.z, d2c));
    vf separate = DIV(LC_FN(max_cos)(n, LC_FN(least_q)(n, box->d2)), f);
    g = MIN(DIV(g, k.z), SET(FLT_MAX)); /* where the members' least A, B, C are all 0 */
    return vf_sel_gt(ab, zero, MIN(g, separate), g);
}

/* Greatest power of the Phong lobe's cosine. */
LC_INLINE vf LC_FN(max_lobe)(const lc_point *p, const rel_box *box)
{
    const vf one = SET(1), zero = SET(0);
    range m = LC_FN(range_make)(box, LC_FN(set3)(p->mirror), false);
    vf q = LC_FN(least_q)(&m, box->d2);
    vf cos2 = MIN(MUL(DIV(MUL(m.z1, m.z1), q), SET(COS2_SLACK)), one);
    cos2 = vf_sel_gt(q, SET(NEAR * NEAR), cos2, one);
    vf lobe = LC_FN(pow01_ub)(cos2, 0.5f * p->exponent);
    return vf_sel_gt(m.z1, zero, lobe, zero);
}

LC_INLINE v3 LC_FN(weights)(const float f[3])
{
    return (v3){ SET(0.2126f * SLACK * f[0]), SET(0.7152f * SLACK * f[1]), SET(0.0722f * SLACK * f[2]) };
}

/* b: as vf_pairs takes them. kind, glossy: constants. */
LC_INLINE vf LC_FN(bound)(const float *const *b, lc_light_kind kind, bool glossy, const lc_point *p)
{
    static const float origin[3] = { 0, 0, 0 };
    const vf zero = SET(0);
    const bool directional = kind == LC_LIGHT_DIRECTIONAL;
    rel_box box = LC_FN(rel_box_make)(b, directional ? origin : p->pos);
    range n = LC_FN(range_make)(&box, LC_FN(set3)(p->n), false);
    if (!vf_any_gt(n.z1, zero)) return zero; /* behind the horizon */
    v3 power = FIELD3(b, power);
    vf u = LC_FN(dot)(LC_FN(weights)(p->diffuse), power);
    if (glossy) u = ADD(u, MUL(LC_FN(dot)(LC_FN(weights)(p->specular), power), LC_FN(max_lobe)(p, &box)));
    if (directional) u = MUL(u, LC_FN(max_cos)(&n, LC_FN(least_q)(&n, box.d2)));
    else u = MUL(u, LC_FN(max_geometry)(b, p, &box, &n));
    if (kind == LC_LIGHT_ORIENTED) u = MAX(MUL(u, LC_FN(max_emission)(b, &box)), zero); /* also NaN: infinite times 0 */
    return vf_sel_gt(n.z1, zero, u, zero);
}

enum { LC_FN(blocks_at_once) = VF_LANES > LC_BLOCK ? VF_LANES / LC_BLOCK : 1 };

LC_INLINE void LC_FN(bounds_of)(const lc_node_block *blocks, const uint32_t *pair, uint32_t n, lc_light_kind kind, bool glossy,
                                const lc_point *point, float *ub)
{
    enum { AT_ONCE = LC_FN(blocks_at_once) };
    const lc_point p = *point; /* that ub can't alias */
    uint32_t rest[AT_ONCE];
    for (uint32_t i = 0; i < n; i += AT_ONCE) {
        const uint32_t *list = pair + i;
        const float *b[AT_ONCE];
        if (n - i < AT_ONCE) { /* the last one fills up */
            for (uint32_t k = 0; k < AT_ONCE; k++) rest[k] = list[k < n - i ? k : n - i - 1];
            list = rest;
        }
        for (uint32_t k = 0; k < AT_ONCE; k++) b[k] = &blocks[list[k]].center[0][0];
        vf_store(ub + LC_BLOCK * i, LC_FN(bound)(b, kind, glossy, &p));
        if (VF_LANES > 1) continue;
        b[0]++;
        vf_store(ub + LC_BLOCK * i + 1, LC_FN(bound)(b, kind, glossy, &p));
    }
}

static void LC_FN(bounds)(const lc_node_block *blocks, const uint32_t *pair, uint32_t n, lc_light_kind kind, const lc_point *p,
                          float *ub)
{
#ifdef LC_HALF_AS_WIDE
    uint32_t rest = n % LC_FN(blocks_at_once);
    if (rest && rest <= LC_FN(blocks_at_once) / 2) { /* at half the price, and the same bits */
        n -= rest;
        LC_HALF_AS_WIDE.bounds(blocks, pair + n, rest, kind, p, ub + LC_BLOCK * n);
    }
#endif
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
