/* bounds_tmpl.c - upper bounds of VF_LANES clusters at once; included by isa_*.c.
 *
 * For a cluster in the box center +- half and a point x: members are p = y - x in c +- h. Three cosines are
 * bounded the same way, about the axes n (receiver), mirror (Phong lobe) and, with p reversed, the emission
 * cone's axis a:
 *
 *     z1   greatest z = axis.p        r  least distance of the box from the axis       D  least |p|
 *     z1 <= 0: cos <= 0, else  cos = z / |p| <= z1 / sqrt(max(r^2 + z1^2, D^2))          [Miksik07] eq. 5
 *
 * in the frame whose second axis, t, points from the axis to the box centre: r |t| = t.t - sum |t_k| h_k.
 * Receiver cosine and 1/d^2 are bounded together (design.md): with z in [z0, z1], cos / d^2 = z / |p|^3 <= z
 * / max(z^2 + r^2, D^2)^(3/2), which grows in z up to sqrt(D^2 - r^2) and then up to r / sqrt 2, and falls
 * beyond: its maximum is at z* = those two's greater one, clamped to [z0, z1]. That is never above the
 * product of the separate bounds. With q = max(z*^2 + r^2, D^2) it is sqrt(z*^2 / q) / q: z* itself is not
 * needed. z*^2 and q are taken as no less than the distance floor: the cosine is 1 below it, and too great by
 * 1e-5 at most of the scene's size over |p|.
 *
 * Rounding, u = 2^-24, m_k = |c_k| + half_k, M = sum m_k.
 * - Subtraction: the estimate's p and our c are each within u of the exact difference, so h_k = half_k + 4u
 * m_k. From there on p means the float vector that the estimate uses.
 * - D^2: the widening takes at most 2 * 4u m_k d_k of a square d_k^2, d_k = max(|c_k| - half_k, 0) <= m_k,
 * and our own rounding 6u m_k^2: we subtract 18u M^2. What is left may be negative, which is as good as 0.
 * - Dot products of three terms are within 3u of the sum of |terms|, at most S = sum |axis_k| m_k <= (1 + 2u)
 * M; the estimate's and our two make at most 9u S, the widening of h 4u S: we add 14u M.
 * - r: t = c - (axis.c) axis is within 8u M of the exact one (an axis of length 1 +- 2u included), and its
 * direction within 8u M / |t|, which matters by at most that times the half extent along the axis: together
 * at most 8u M (|t| + extent) <= 8u M^2 of r |t|. The widening is 4u sum |t_k| m_k <= 4u M^2, our own
 * rounding 6u M^2 (t.t <= M^2, sum |t_k| h_k <= M^2 / 4): 18u M^2.
 * - Boxes within NEAR of the point have squares near underflow: their cosines are taken as 1, and NEAR is
 * added to z1.
 * - What follows is products, quotients and roots of positive terms: below 40 operations with those of the
 *   estimate, each within u; the factor SLACK = 1 + 2^-18 = 1 + 64u covers them. The limits of
 *   light.h and layout.h keep what they multiply away from denormals wherever the estimate is not 0.
 * - Cosines enter angles (emission) and powers (Phong), where relative errors grow. For angles COS_SLACK =
 * 32u is added to them first: the estimate's own cosine is within 12u. For powers the square is multiplied by
 * 1 + 32u: the errors of dot products are in z1 already, so what is left is relative: 4.5u of the estimate's
 * quotient, twice; 8u of ours (r^2 5u, q and the quotient 1u an operation); 4u of a direction of length 1 +-
 * 2u that no estimate divides by.
 * - The power is fmath_tmpl.c's pow01_ub: above the exact one, and so above the estimate's times 1 - 2e-10.
 *
 * Ward: with X, Y = tangents over roughness and N = n, each dotted with h = p / |p| + o, the estimate is
 * e^-(X^2 + Y^2) / N^2. Let e be the unit direction to the box centre: 0 <= |p| - e.p = |p x e|^2 / (|p| +
 * e.p) <= half.half / (2 min e.p) =: bend, so that |p| h, too, is linear in p but for a term of second order.
 * With (a, b) the unit vector along (X, Y) of the centre, q = a tx + b ty and l = q.o:
 *
 *     |p| sqrt(X^2 + Y^2) >= q.p + |p| l >= (q + l e).p + min(l, 0) bend =: L     |p| N <= (n + (n.o) e).p +
 * (n.o) bend =: Z
 *
 * and t = L / Z bounds the root of the exponent. So does t + L' / Z, where q - t n takes the place of q: a
 * step that may be repeated, towards the best t for this q. In front there is sqrt(cos) / d^2 = sqrt(cos /
 * d^2) sqrt(1 / d^2), whose first factor has its bound already, or where the cosine is below LC_WARD_MIN_COS,
 * cos / d^2 over that constant's root: the lesser holds for all.
 * - T = sharp is the length of the longer tangent, so |q|, |l| <= T; they share an exact l with the estimate.
 * In uTM: the estimate's X and Y 9.5 each, so 13.5; q and l 2 * 2.9; q + l e 6, its two dot products 12, the
 * widening of half 8, sums 4; a direction of length 1 +- 2u that is taken as 1: 3. Together 53, and as many
 * uM for Z: 64uM (T + t) is taken off L, and 64uM added to Z.
 * - e is shortened by 8u, so that its length is at most 1, and at least 1 - 16u: 16uM is added to bend.
 * half.half and its rounding are those of D^2, min e.p that of a z. Boxes that are nearer than NEAR, or about
 * the point, have no bound but 1.
 * - (a, b) is off by 4u in length, shorter where X^2 + Y^2 is below TINY; the rest is relative: less than 32u
 * of the exponent.
 *
 * GGX (material.h): f cos = F r^2 cos / (s(o) cos + s(i) o.n) times a constant, r = |h|^2 / (X^2 + Y^2 +
 * N^2), |h|^2 = (ax X)^2 + (ay Y)^2 + N^2. With Ward's t <= sqrt(X^2 + Y^2) / N, and a <= 1 the larger
 * roughness,
 *
 *     r = (1 + ((ax X)^2 + (ay Y)^2) / N^2) / (1 + (X^2 + Y^2) / N^2) <= min(1 + a^2 t^2, max |h|^2 / min
 * N^2) / (1 + t^2)
 *
 * since (1 + a^2 x) / (1 + x) falls. The first is exact where ax = ay; the second brings a lobe down that is
 * long one way. |h|^2 = 2 + 2 i.o, two cosines about o. s(i)^2 >= cos^2 + b^2 (1 - cos^2), b the smaller
 * roughness: s(i) grows with the cosine, s(i) / cos falls; and |p| s(i) >= w.p, w = S u, S the symmetric
 * matrix of s, u any unit vector: that along S e. So
 *
 *     cos / (s(o) cos + s(i) o.n) / f(d) <= g / (s(o) c0 + s0 o.n) and <= 1 / (least f(d) (s(o) + q o.n)), g:
 * greatest cos / f(d)
 *
 * with c0 the least cosine, s0 the greater of s there and min w.p / max |p|, q that of s / cos at the
 * greatest cosine and min w.p / z1. F falls with the cosine c = |h| / 2: Schlick's plainly, a dielectric's up
 * to an index of 2 + sqrt 3 (unit_ggx.c goes through them). A conductor's is no more than that of light
 * across the plane, 1 - 4 / ((w + x) / (c Re N) + 2), x = c^2, N^2 = x + p + i q, p = eta^2 - k^2 - 1, q = 2
 * eta k, w = |N|^2, which falls too: the derivative of ln((w + x)^2 / (x (w + x + p))) by x is -(p^2 + q^2) /
 * (w x (w + x)). A coat lets in more of light that is steeper: T at the greatest cosine.
 * - t holds for the estimate's X, Y, N, as above, and its squares of roughness are used. |h|^2 as the
 * estimate adds it up: frames are perpendicular to 4u, tangents off by 5u in length and components by 10u:
 * 40u of |h|^2 and 70u; i.o as for COS_SLACK: 64u. We take 256u of both. s(i): the same frame, 40u of it;
 * 256u.
 * - w.p: u and w within 8u, three dot products 9u each, the widening 4u, all times |S| <= 1: 64uM.
 * - T: g 2.5u, squares of sums 9u, quotients and products: below 20u of T <= 1 in estimate and bound: F is
 * raised by 64u.
 * - Conductors: x + p is off by 2u x where it cancels, N by the root of that at most, 3.5e-4 c; the quotient
 * of amplitudes by 2 c / |c + N|^2 times that, its square by twice as much: 1.4e-3, here and in the estimate.
 * CONDUCTOR_SLACK is 3.9e-3.
 * - r^2 has 18u in the estimate and 20u here, the rest 12u: a SLACK of its own.
 */
#include "base/vec.h"

#define U 0x1p-24f
#define SLACK (1 + 0x1p-18f)
#define COS_SLACK (32 * U)
#define COS2_SLACK (1 + 32 * U)
#define TINY 1e-30f /* squares below this may have lost bits */
#define WARD_STEPS 2
#define WARD_GRAZING 7.0710683f /* 1 / sqrt(LC_WARD_MIN_COS), rounded up */
#define HALF_SLACK (256 * U)
#define CONDUCTOR_SLACK 0x1p-8f
#define NEAR 1e-12f /* scene units: the square root of LC_MIN_D2, below which 1/d^2 is flat anyway */

typedef struct {
    vf x, y, z;
} v3;

LC_INLINE v3 set3(const float a[3]) { return (v3){ vf_set(a[0]), vf_set(a[1]), vf_set(a[2]) }; }

LC_INLINE vf dot(v3 a, v3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

LC_INLINE v3 abs3(v3 a) { return (v3){ vf_abs(a.x), vf_abs(a.y), vf_abs(a.z) }; }

/* The boxes about x, and what every axis needs of them. */
typedef struct {
    v3 c, half, m; /* centre; half extent without the widening; |c| + half */
    vf m_sum;
    vf z_slack;    /* of z */
    vf r_slack;    /* of r |t| and d2 */
    vf d2;         /* least |p|^2, or less than 0 */
} rel_box;

/* The boxes seen along an axis. */
typedef struct {
    vf z0, z1; /* range of axis.p; z0 not clamped */
    vf r2;     /* least squared distance from the axis */
} range;

/* The clusters of the lanes. */
typedef struct {
    const lc_tree_data *tree;
    const lc_atten *atten; /* of nodes; NULL: inverse square */
    const uint32_t *index;
    const float *node[VF_LANES];
    vf row[4][4]; /* of lc_node */
} cluster_lanes;

#ifdef VF_LOADS_AHEAD
/* All rows that will be needed, of four nodes at a time, so that addresses stay in registers: there are
 * enough for both. */
LC_INLINE void load(cluster_lanes *l, int n_rows)
{
    vd r[4][4];
    for (int k = 0; k < 4; k++) {
        for (int i = k; i < VF_LANES; i += 4) l->node[i] = l->tree->nodes[l->index[i]].center;
        for (int row = 0; row < n_rows; row++) r[row][k] = vd_row(l->node + k, 4 * (size_t)row);
    }
    for (int row = 0; row < n_rows; row++) vf_transpose(r[row], l->row[row]);
}
LC_INLINE v3 row(cluster_lanes *l, int k) { return (v3){ l->row[k][0], l->row[k][1], l->row[k][2] }; }
#else
LC_INLINE void load(cluster_lanes *l, int n_rows)
{
    (void)n_rows;
    for (int i = 0; i < VF_LANES; i++) l->node[i] = l->tree->nodes[l->index[i]].center;
}
LC_INLINE v3 row(cluster_lanes *l, int k)
{
    vf_rows(l->node, 4 * (size_t)k, l->row[k]);
    return (v3){ l->row[k][0], l->row[k][1], l->row[k][2] };
}
#endif

#define CENTER(l) row(l, 0)
#define HALF(l) row(l, 1)
#define POWER(l) row(l, 2)
#define AXIS(l) row(l, 3)
#define COS_CONE(l) ((l)->row[0][3]) /* after CENTER */

/* m = |c| + half; returns the least |p_k|, not widened. */
LC_INLINE vf least(vf c, vf half, vf *m)
{
    vf a = vf_abs(c);
    *m = a + half;
    return vf_max(a - half, vf_set(0));
}

LC_INLINE rel_box rel_box_make(cluster_lanes *l, const float x[3])
{
    rel_box r;
    v3 center = CENTER(l), d;
    r.half = HALF(l);
    r.c = (v3){ center.x - x[0], center.y - x[1], center.z - x[2] };
    d.x = least(r.c.x, r.half.x, &r.m.x);
    d.y = least(r.c.y, r.half.y, &r.m.y);
    d.z = least(r.c.z, r.half.z, &r.m.z);
    r.m_sum = r.m.x + r.m.y + r.m.z;
    r.z_slack = r.m_sum * (14 * U) + NEAR;
    r.r_slack = r.m_sum * (r.m_sum * (18 * U));
    r.d2 = dot(d, d) - r.r_slack;
    return r;
}

/* reversed: of the box of -p. */
LC_INLINE range range_make(const rel_box *b, v3 axis, bool reversed)
{
    const vf zero = vf_set(0);
    vf zc = dot(axis, b->c), zh = dot(abs3(axis), b->half) + b->z_slack;
    v3 t = { b->c.x - axis.x * zc, b->c.y - axis.y * zc, b->c.z - axis.z * zc };
    vf tt = dot(t, t), support = dot(abs3(t), b->half) + b->r_slack;
    vf rt = vf_max(tt - support, zero),
       r2 = vf_max(rt * (rt / tt), zero); /* NaN where tt is 0: MAX drops it */
    return (range){ (reversed ? -zc : zc) - zh, reversed ? zh - zc : zc + zh, r2 };
}

/* Least |p|^2 at the greatest cosine, where z1 > 0. */
LC_INLINE vf least_q(const range *a, vf d2) { return vf_max(a->r2 + a->z1 * a->z1, d2); }

/* Greatest cosine about the axis for that q. */
LC_INLINE vf max_cos(const range *a, vf q)
{
    const vf one = vf_set(1);
    return vf_sel_gt(q, vf_set(NEAR * NEAR), vf_min(a->z1 / vf_sqrt(q), one), one);
}

/* Greatest cos phi over boxes and cones; <= 0 where all face away. */
LC_INLINE vf max_emission(cluster_lanes *l, const rel_box *box)
{
    const vf one = vf_set(1), zero = vf_set(0), slack = vf_set(COS_SLACK);
    vf cc = COS_CONE(l);
    range a = range_make(box, AXIS(l), true);
    /* all behind: the largest cosine is at the largest distance */
    vf q = vf_sel_gt(zero, a.z1, dot(box->m, box->m), least_q(&a, box->d2));
    vf ct = max_cos(&a, q) + slack;
    vf sines = (one - ct) * (one + ct) * ((one - cc) * (one + cc)); /* squared */
    vf e = vf_min(ct * cc + vf_sqrt(vf_max(sines, zero)) + slack, one);
    e = vf_sel_gt(cc, ct, e, one);
    e = vf_sel_gt(cc, vf_set(-1), e, one);
    return vf_sel_gt(vf_set(NEAR), box->m_sum, one, e);
}

/* Greatest emission of spots by the greatest cosine. The quotient t falls in both cos_total and cos_start, so
 * that of the members' least ones, cut off at 1, is no less than any member's; the members' cosines, cut off
 * at 1, are no more than e. Ours and a member's t are differences of what is exact, and their products:
 * within 3u each of exact, twice that in the emission, which grows no faster than t^2, and 3u more of its
 * own: 18u, for which the factor is taken once more. */
LC_INLINE vf max_profile(cluster_lanes *l, vf e)
{
    const float *spot[VF_LANES];
    vf k[4];
    for (uint32_t i = 0; i < VF_LANES; i++)
        spot[i] = &l->tree->node_spot[l->index[i] - l->tree->first_spot_node].cos_total;
    vf_rows(spot, 0, k);
    vf t = vf_min(vf_max((e - k[0]) * k[1], vf_set(0)), vf_set(1));
    return t * t * (3 - (t + t)) * SLACK;
}

/* Least f(d) by least A, B, C in k. */
LC_INLINE vf least_f(cluster_lanes *l, const lc_point *p, const rel_box *box, vf k[4])
{
    const float *atten[VF_LANES];
    for (uint32_t i = 0; i < VF_LANES; i++) atten[i] = l->atten[l->index[i]];
    vf_rows(atten, 0, k);
    vf d2c = vf_max(box->d2, vf_set(p->min_d2));
    return k[0] + k[1] * vf_sqrt(d2c) + k[2] * d2c;
}

/* g: greatest cosine over d^2. Returns the greatest receiver cosine times 1 / f(d). */
LC_INLINE vf attenuated_bound(cluster_lanes *l, const lc_point *p, const rel_box *box, const range *n, vf g)
{
    vf k[4], f = least_f(l, p, box, k), ab = k[0] + k[1];
    vf separate = max_cos(n, least_q(n, box->d2)) / f;
    g = vf_min(g / k[2], vf_set(FLT_MAX)); /* where the members' least A, B, C are all 0 */
    return vf_sel_gt(ab, vf_set(0), vf_min(g, separate), g);
}

/* Greatest receiver cosine times 1 / f(d). */
LC_INLINE vf max_geometry(cluster_lanes *l, const lc_point *p, const rel_box *box, const range *n)
{
    const vf zero = vf_set(0), min_d2 = vf_set(p->min_d2);
    vf zz = vf_max(0.5f * n->r2, box->d2 - n->r2); /* z*^2 */
    zz = vf_min(vf_max(zz, n->z0 * vf_max(n->z0, zero)), n->z1 * n->z1);
    vf inv_q = 1 / vf_max(vf_max(zz + n->r2, box->d2), min_d2);
    vf g = vf_sqrt(vf_max(zz, min_d2) * inv_q) * inv_q;
    return l->atten ? attenuated_bound(l, p, box, n, g) : g;
}

/* Greatest power of the Phong lobe's cosine. */
LC_INLINE vf max_phong(const lc_point *p, const rel_box *box)
{
    const vf one = vf_set(1), zero = vf_set(0);
    range m = range_make(box, set3(p->mirror), false);
    vf q = least_q(&m, box->d2);
    vf cos2 = vf_min(m.z1 * m.z1 / q * COS2_SLACK, one);
    cos2 = vf_sel_gt(q, vf_set(NEAR * NEAR), cos2, one);
    vf lobe = pow01_ub(cos2, 0.5f * p->exponent);
    return vf_sel_gt(m.z1, zero, lobe, zero);
}

/* a + b s */
LC_INLINE v3 along(v3 a, v3 b, vf s) { return (v3){ a.x + b.x * s, a.y + b.y * s, a.z + b.z * s }; }

LC_INLINE v3 scale3(v3 a, vf s) { return (v3){ a.x * s, a.y * s, a.z * s }; }

/* No more than the root of Ward's exponent: t; only where *clear is above NEAR. Steps: one makes Ward's
 * bounds 2 to 4 % looser, three are 0.5 % tighter than two. */
LC_INLINE vf least_slope(const lc_point *p, const rel_box *box, vf *clear)
{
    const vf one = vf_set(1), zero = vf_set(0), tiny = vf_set(TINY), o_n = vf_set(p->view[2]);
    v3 tx = set3(p->tangent[0]), ty = set3(p->tangent[1]);
    vf len = vf_sqrt(dot(box->c, box->c));
    v3 e = scale3(box->c, one / len * (1 - 8 * U)); /* NaN where len is 0, and `least`: no bound */
    vf least = dot(e, box->c) - (dot(abs3(e), box->half) + box->z_slack);
    vf rounding = box->m_sum * (64 * U);
    vf bend = (dot(box->half, box->half) + box->r_slack) / (least + least) + box->m_sum * (16 * U);
    bend = bend * (1 + 8 * U);
    vf x = dot(tx, box->c) + len * p->view[0], y = dot(ty, box->c) + len * p->view[1];
    vf inv_xy = one / vf_sqrt(vf_max(x * x + y * y, tiny)), a = x * inv_xy, b = y * inv_xy;
    vf o_q = a * p->view[0] + b * p->view[1];
    v3 q = along(along(scale3(tx, a), ty, b), e, o_q), n = along(set3(p->n), e, o_n);
    vf high = dot(n, box->c) + dot(abs3(n), box->half) + (o_n * bend + rounding);
    vf slope = zero;
    for (int step = 0; step < WARD_STEPS; step++) {
        v3 r = along(q, n, -slope);
        vf low = dot(r, box->c) - dot(abs3(r), box->half);
        low = low + vf_min(o_q - slope * o_n, zero) * bend;
        low = low - rounding * (p->sharp + slope);
        slope = slope + vf_max(low, zero) / high;
    }
    *clear = least;
    return slope;
}

/* Greatest exponential of Ward's lobe. */
LC_INLINE vf max_ward(const lc_point *p, const rel_box *box)
{
    vf clear, slope = least_slope(p, box, &clear);
    vf lobe = decay_ub(slope * slope * (1 - 32 * U));
    return vf_sel_gt(clear, vf_set(NEAR), lobe, vf_set(1));
}

/* From the greatest cosine over f(d): that of what stands before Ward's exponential; twice it is finite. */
LC_INLINE vf ward_geometry(cluster_lanes *l, const lc_point *p, const rel_box *box, bool directional, vf g)
{
    const vf most = g * WARD_GRAZING;
    vf k[4], f, root = vf_sqrt(g);
    if (!directional) {
        if (l->atten) f = least_f(l, p, box, k);
        else f = vf_max(box->d2, vf_set(p->min_d2));
        root = root / vf_sqrt(f);
    }
    return vf_min(vf_min(root, most), vf_set(FLT_MAX / 2));
}

LC_INLINE v3 weights(const float f[3])
{
    return (v3){ vf_set(0.2126f * SLACK * f[0]), vf_set(0.7152f * SLACK * f[1]),
                 vf_set(0.0722f * SLACK * f[2]) };
}

/* Greatest reflectance for a cosine of at least c, times the power. */
LC_INLINE vf max_fresnel(const lc_point *p, vf c, v3 power)
{
    const vf one = vf_set(1);
    v3 s = weights(p->specular);
    if (p->fresnel == LC_FRESNEL_SCHLICK) {
        vf m = one - c, m2 = m * m, w = m2 * m2 * m;
        return dot(s, power) + dot(weights(p->rise), power) * w;
    }
    if (p->fresnel == LC_FRESNEL_DIELECTRIC) {
        vf f = one - transmitted(p, vf_max(c, vf_set(LC_MIN_COS))) + 64 * U;
        return dot(s, power) * vf_min(f, one);
    }
    vf f[3], t2, w;
    for (int k = 0; k < 3; k++)
        f[k] = vf_min(conductor_across(p->rise[k], p->turn[k], c, &t2, &w) + CONDUCTOR_SLACK, one);
    s = (v3){ s.x * f[0], s.y * f[1], s.z * f[2] };
    return dot(s, power);
}

/* Least and greatest |h|^2. */
LC_INLINE void half_range(const lc_point *p, const rel_box *box, vf far2, vf *least, vf *most)
{
    const vf zero = vf_set(0), two = vf_set(2), slack = vf_set(256 * U);
    range away = range_make(box, set3(p->to_view), true), to = { zero, -away.z0, away.r2 };
    /* where all are behind the largest cosine is at the largest distance */
    vf c0 = max_cos(&away, vf_sel_gt(zero, away.z1, far2, least_q(&away, box->d2)));
    vf c1 = max_cos(&to, vf_sel_gt(zero, to.z1, far2, least_q(&to, box->d2)));
    *least = vf_max(two - slack - two * c0, zero) * (1 - HALF_SLACK);
    *most = (two + slack + two * c1) * (1 + HALF_SLACK);
}

/* Length of the least (ax w.x, ay w.y, w.z) for a cosine of c, which grows with c, from below. */
LC_INLINE vf least_stretched(const lc_point *p, vf c)
{
    vf cc = c * c, square = vf_set(p->square[0] < p->square[1] ? p->square[0] : p->square[1]);
    return vf_sqrt((cc + square * vf_max(1 - cc, vf_set(0))) * (1 - HALF_SLACK));
}

/* Least |p| times the length of (ax i.x, ay i.y, i.z), by its tangent at the box centre. */
LC_INLINE vf linear_stretched(const lc_point *p, const rel_box *box)
{
    const vf a = vf_set(p->square[0]), b = vf_set(p->square[1]);
    v3 tx = set3(p->tangent[0]), ty = set3(p->tangent[1]), n = set3(p->n);
    vf x = dot(tx, box->c) * a, y = dot(ty, box->c) * b, z = dot(n, box->c);
    vf inv = 1 / vf_sqrt(vf_max(x * x + y * y + z * z, vf_set(TINY)));
    v3 w = along(along(scale3(tx, x * inv * a), ty, y * inv * b), n, z * inv);
    vf low = dot(w, box->c) - dot(abs3(w), box->half);
    return vf_max(low - box->m_sum * (64 * U), vf_set(0));
}

/* Greatest receiver cosine times 1 / f(d) and what stands below the fraction of GGX's lobe; near: least
 * receiver cosine. */
LC_INLINE vf ggx_geometry(cluster_lanes *l, const lc_point *p, const rel_box *box, bool directional, vf g,
                          vf cos_r, vf near, vf z1, vf far)
{
    const vf one = vf_set(1), o_s = vf_set(p->masking), o_n = vf_set(p->view[2]);
    const bool isotropic = !(p->square[0] < p->square[1] || p->square[0] > p->square[1]);
    vf linear = isotropic ? vf_set(0) : linear_stretched(p, box);
    vf k[4], f = one, both = g / (o_s * near + o_n * vf_max(linear / far, least_stretched(p, near)));
    if (!directional) f = l->atten ? least_f(l, p, box, k) : vf_max(box->d2, vf_set(p->min_d2));
    vf apart = one / (f * (o_s + o_n * vf_max(linear / z1, least_stretched(p, cos_r) / cos_r)));
    return vf_min(vf_min(both, apart), vf_set(FLT_MAX / 2));
}

/* Bound of the lobe; diffuse: what bounds the rest without its coat and g. */
LC_INLINE vf bound_ggx(cluster_lanes *l, const lc_point *p, const rel_box *box, const range *n,
                       bool directional, vf g, vf diffuse, v3 power)
{
    const vf one = vf_set(1), zero = vf_set(0), o_n = vf_set(p->view[2]);
    vf far2 = dot(box->m, box->m), clear, h_least, h_most, slope = least_slope(p, box, &clear);
    vf near = vf_min(vf_max(n->z0 / vf_sqrt(far2) * (1 - 32 * U), zero), one);
    vf cos_r = vf_min(max_cos(n, least_q(n, box->d2)) + COS_SLACK, one);
    half_range(p, box, far2, &h_least, &h_most);
    vf t2 = vf_sel_gt(clear, vf_set(NEAR), slope * slope * (1 - 32 * U), zero);
    float square = p->square[0] > p->square[1] ? p->square[0] : p->square[1];
    vf z = o_n + near, r = vf_min(one + square * t2, h_most / (z * z)) / (one + t2);
    vf lobe = r * r * SLACK * ggx_geometry(l, p, box, directional, g, cos_r, near, n->z1, vf_sqrt(far2));
    if (p->coat) diffuse = diffuse * (transmitted(p, cos_r) * SLACK);
    return diffuse * g + max_fresnel(p, 0.5f * vf_sqrt(h_least), power) * lobe;
}

/* kind, lobe: constants. */
LC_INLINE vf bound(cluster_lanes *l, lc_light_kind kind, lc_lobe lobe, const lc_point *p)
{
    static const float origin[3] = { 0, 0, 0 };
    const vf zero = vf_set(0);
    const bool directional = kind == LC_LIGHT_DIRECTIONAL;
    rel_box box = rel_box_make(l, directional ? origin : p->pos);
    range n = range_make(&box, set3(p->n), false);
    if (!vf_any_gt(n.z1, zero)) return zero; /* behind the horizon */
    v3 power = POWER(l);
    vf u = dot(weights(p->diffuse), power), g, s = zero;
    if (lobe == LC_LOBE_PHONG || lobe == LC_LOBE_WARD) s = dot(weights(p->specular), power);
    if (lobe == LC_LOBE_PHONG) u = u + s * max_phong(p, &box);
    if (directional) g = max_cos(&n, least_q(&n, box.d2));
    else g = max_geometry(l, p, &box, &n);
    if (lobe == LC_LOBE_GGX) u = bound_ggx(l, p, &box, &n, directional, g, u, power);
    else u = u * g;
    if (lobe == LC_LOBE_WARD) {
        vf ward = max_ward(p, &box) * ward_geometry(l, p, &box, directional, g);
        u = u + s * ward;
    }
    if (lc_is_aimed(kind)) {
        vf e = max_emission(l, &box);
        if (kind == LC_LIGHT_SPOT) e = max_profile(l, e);
        u = vf_max(u * e, zero); /* also NaN: infinite times 0 */
    }
    return vf_sel_gt(n.z1, zero, u, zero);
}

LC_INLINE void bounds_of(const lc_tree_data *t, const uint32_t *index, uint32_t n, lc_light_kind kind,
                         lc_lobe lobe, const lc_point *point, float *ub)
{
    const lc_point p = *point; /* that ub can't alias */
    uint32_t rest[VF_LANES];
    cluster_lanes l;
    l.tree = t;
    l.atten = kind == LC_LIGHT_SPOT ? NULL : t->node_atten;
    for (uint32_t i = 0; i < n; i += VF_LANES) {
        l.index = index + i;
        if (n - i < VF_LANES) { /* the last one fills up */
            for (uint32_t k = 0; k < VF_LANES; k++) rest[k] = index[i + (k < n - i ? k : n - i - 1)];
            l.index = rest;
        }
        load(&l, lc_is_aimed(kind) ? 4 : 3);
        vf_store(ub + i, bound(&l, kind, lobe, &p));
    }
}

static void bounds(const lc_tree_data *t, const uint32_t *index, uint32_t n, lc_light_kind kind,
                   const lc_point *p, float *ub)
{
#ifdef LC_HALF_AS_WIDE
    uint32_t rest = n % VF_LANES;
    if (rest && rest <= VF_LANES / 2) { /* at half the price, and the same bits */
        n -= rest;
        LC_HALF_AS_WIDE.shade.bounds(t, index + n, rest, kind, p, ub + n);
    }
#endif
#define BOUNDS(kind, lobe) bounds_of(t, index, n, kind, lobe, p, ub)
#define BY_LOBE(kind)                                               \
    if (p->lobe == LC_LOBE_NONE) BOUNDS(kind, LC_LOBE_NONE);        \
    else if (p->lobe == LC_LOBE_PHONG) BOUNDS(kind, LC_LOBE_PHONG); \
    else if (p->lobe == LC_LOBE_WARD) BOUNDS(kind, LC_LOBE_WARD);   \
    else BOUNDS(kind, LC_LOBE_GGX)
    switch (kind) {
    case LC_LIGHT_POINT:
        BY_LOBE(LC_LIGHT_POINT);
        break;
    case LC_LIGHT_ORIENTED:
        BY_LOBE(LC_LIGHT_ORIENTED);
        break;
    case LC_LIGHT_DIRECTIONAL:
        BY_LOBE(LC_LIGHT_DIRECTIONAL);
        break;
    case LC_LIGHT_SPOT:
        BY_LOBE(LC_LIGHT_SPOT);
        break;
    }
#undef BY_LOBE
#undef BOUNDS
}

#undef U
#undef SLACK
#undef COS_SLACK
#undef COS2_SLACK
#undef TINY
#undef WARD_STEPS
#undef WARD_GRAZING
#undef HALF_SLACK
#undef CONDUCTOR_SLACK
#undef NEAR
#undef CENTER
#undef HALF
#undef POWER
#undef AXIS
#undef COS_CONE
