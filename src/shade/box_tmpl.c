/* box_tmpl.c - the boxes of VF_LANES clusters relative to a point, and bounds of their cosines and distances;
 * included by isa_tmpl.c.
 *
 * For a cluster in the box center +- half and a point x, members are p = y - x in c +- h. Three cosines are
 * bounded the same way: about the axes n (receiver), mirror (Phong lobe) and, with p reversed, the emission
 * cone's axis.
 *
 *     z1   greatest z = axis.p        r  least distance of the box from the axis       D  least |p|
 *     z1 <= 0: cos <= 0, else  cos = z / |p| <= z1 / sqrt(max(r^2 + z1^2, D^2))          [Miksik07] eq. 5
 *
 * in the frame whose second axis, t, points from the axis to the box centre: r |t| = t.t - sum |t_k| h_k.
 *
 * The receiver's cosine and 1/d^2 are bounded together. With z in [z0, z1],
 *
 *     cos / d^2 = z / |p|^3 <= z / max(z^2 + r^2, D^2)^(3/2)
 *
 * which grows in z up to sqrt(D^2 - r^2), then up to r / sqrt 2, and falls beyond: its maximum is at z*, the
 * greater of those two, clamped to [z0, z1]. That is never above the product of the separate bounds. With q =
 * max(z*^2 + r^2, D^2) it is sqrt(z*^2 / q) / q, so z* itself is not needed. z*^2 and q are taken as no less
 * than the distance floor: the cosine is 1 below it, and too great by at most 1e-5 of the scene's size over
 * |p|.
 *
 * For a gather cluster, points in a box x +- g, half is the sum of both boxes' half extents: members' p are
 * in c +- h all the same. Its normals lie within an angle C of n. For a normal at the angle C from n, a p
 * with the height z along n and the distance l from n has its height in z cos C +- l sin C, or up to |p|
 * where p may lie inside the cone, l cos C <= z sin C; and where that height is positive, its distance is no
 * less than l cos C - max(z, 0) sin C. With T the greatest l, at most sqrt(M'^2 - min z^2),
 * M' the greatest |p|,
 *
 *     z0' = z0 cos C - T sin C      z1' = min(z1 cos C + T sin C, M'), inside min(sqrt(z1^2 + T^2), M')
 *     r'  = max(r cos C - max(z1, 0) sin C, 0)
 *
 * take the place of z0, z1, r. These are six operations on terms of at most M, so 16uM is added to each.
 *
 * Rounding, u = 2^-24, m_k = |c_k| + half_k, M = sum m_k.
 * - Subtraction: the estimate's p and our c are each within u of the exact difference, so h_k = half_k + 4u
 *   m_k. From there on p means the float vector that the estimate uses.
 * - D^2: the widening takes at most 2 * 4u m_k d_k off a square d_k^2, d_k = max(|c_k| - half_k, 0) <= m_k,
 *   and our own rounding 6u m_k^2: we subtract 18u M^2. The difference may be negative, which is as good as
 *   0.
 * - Dot products of three terms are within 3u of the sum of |terms|, at most S = sum |axis_k| m_k <= (1 + 2u)
 *   M; the estimate's and our two make at most 9u S, the widening of h 4u S: we add 14u M.
 * - r: t = c - (axis.c) axis is within 8u M of the exact one (an axis of length 1 +- 2u included), and its
 *   direction within 8u M / |t|, which matters by at most that times the half extent along the axis: together
 *   at most 8u M (|t| + extent) <= 8u M^2 of r |t|. The widening is 4u sum |t_k| m_k <= 4u M^2, our own
 *   rounding 6u M^2 (t.t <= M^2, sum |t_k| h_k <= M^2 / 4): 18u M^2.
 * - Boxes within NEAR of the point have squares near underflow: their cosines are taken as 1, and NEAR is
 *   added to z1.
 * - The rest is products, quotients and roots of positive terms, each within u. The estimate of a diffuse
 *   surface: |p|^2 is within 3u, so cos / d^2 within 4.5u and the 5 operations that make it, f one product,
 *   the luminance 4: 14.5u. Its bound: r^2 and the length of n 5u, so cos / d^2 7.5u and 6u for what follows,
 *   the weights' dot product 5u, two more products: 20.5u. Together 35u; 39u with Phong's lobe, 42u with
 *   Ward's; powers, exponentials and GGX's quotients have slacks of their own. Attenuation adds 3u, or the
 *   profile of a spot, which has none, 18u (light_spot.h): at most 60u, which the factor SLACK = 1 + 2^-18 =
 *   1 + 64u covers. The limits of light.h and point.h keep operands from being denormal wherever the estimate
 *   is not 0.
 * - Cosines enter angles (emission) and powers (Phong), where relative errors grow. For angles COS_SLACK =
 *   32u is added to them first: the estimate's own cosine is within 12u. For powers the square is multiplied
 *   by 1 + 32u: the errors of dot products are in z1 already, so the rest is relative: 4.5u of the estimate's
 *   quotient, twice; 8u of ours (r^2 5u, q and the quotient 1u an operation); 4u of a direction of length 1
 *   +- 2u that no estimate divides by.
 * - The power is fmath_tmpl.c's pow01_ub: above the exact one, and so above the estimate's times 1 - 2e-10.
 */
#include "base/vec.h"
#include "shade/tree_data.h"

static const float U = 0x1p-24f;                   /* unit roundoff */
static const float SLACK = 1 + 0x1p-18f;           /* factor of positive products, quotients, roots */
static const float COS_SLACK = 32 * 0x1p-24f;      /* added to cosines that enter angles */
static const float COS2_SLACK = 1 + 32 * 0x1p-24f; /* factor of squared cosines that are raised to powers */
static const float TINY = 1e-30f;                  /* squares below this may have lost bits */
static const float NEAR = 1e-12f;                  /* scene units: the root of LC_MIN_D2 */

typedef struct {
    vf x, y, z;
} v3;

LC_INLINE v3 set3(const float a[3]) { return (v3){ vf_set(a[0]), vf_set(a[1]), vf_set(a[2]) }; }

LC_INLINE vf dot(v3 a, v3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

LC_INLINE v3 abs3(v3 a) { return (v3){ vf_abs(a.x), vf_abs(a.y), vf_abs(a.z) }; }

/* a + b s */
LC_INLINE v3 along(v3 a, v3 b, vf s) { return (v3){ a.x + b.x * s, a.y + b.y * s, a.z + b.z * s }; }

LC_INLINE v3 scale3(v3 a, vf s) { return (v3){ a.x * s, a.y * s, a.z * s }; }

/* The boxes relative to x, and what the bounds about every axis share. */
typedef struct {
    v3 c, half, m; /* centre; half extent without the widening; |c| + half */
    vf m_sum;
    vf z_slack;    /* rounding of z */
    vf r_slack;    /* rounding of r |t| and d2 */
    vf d2;         /* no more than the least |p|^2; may be negative */
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

/* The rows of lc_node. */
enum { ROW_CENTER, ROW_HALF, ROW_INTENSITY, ROW_AXIS };

#ifdef VF_LOADS_AHEAD
/* Loads all rows that are needed, of four nodes at a time, so that the addresses stay in registers. */
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

/* The clusters index[0 .. n), of which there are at least one; the last one fills the lanes up. room: what
 * may have to hold their indices. */
LC_INLINE cluster_lanes lanes_make(const lc_tree_data *t, lc_light_kind kind, const uint32_t *index,
                                   uint32_t n, uint32_t room[VF_LANES])
{
    cluster_lanes l;
    l.tree = t;
    l.atten = lc_is_attenuated(kind) ? t->node_atten : NULL;
    l.index = index;
    if (n < VF_LANES) {
        for (uint32_t k = 0; k < VF_LANES; k++) room[k] = index[k < n ? k : n - 1];
        l.index = room;
    }
    load(&l, lc_is_aimed(kind) ? 4 : 3);
    return l;
}

/* m = |c| + half; returns the least |p_k|, not widened. */
LC_INLINE vf least(vf c, vf half, vf *m)
{
    vf a = vf_abs(c);
    *m = a + half;
    return vf_max(a - half, vf_set(0));
}

/* half: of the box of points about x; NULL: x alone. */
LC_INLINE rel_box rel_box_make(cluster_lanes *l, const float x[3], const float *half)
{
    rel_box r;
    v3 center = row(l, ROW_CENTER), d;
    r.half = row(l, ROW_HALF);
    if (half) r.half = (v3){ r.half.x + half[0], r.half.y + half[1], r.half.z + half[2] };
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
    vf rt = vf_max(tt - support, zero);
    vf r2 = vf_max(rt * (rt / tt), zero); /* vf_max drops the NaN where tt is 0 */
    return (range){ (reversed ? -zc : zc) - zh, reversed ? zh - zc : zc + zh, r2 };
}

/* The range about every axis of a cone at once: those of the cone's own axis are `a`. See the head. */
LC_INLINE range range_of_cone(const range *a, const rel_box *b, const float cone[2])
{
    const vf zero = vf_set(0), slack = b->m_sum * (16 * U);
    const float cosine = cone[0], sine = cone[1];
    vf m2 = dot(b->m, b->m) * (1 + 8 * U), m = vf_sqrt(m2) + slack;
    vf near = vf_max(vf_max(a->z0, 0 - a->z1), zero), t = vf_sqrt(vf_max(m2 - near * near, zero)) + slack;
    vf r = vf_sqrt(a->r2), lean = t * sine + slack, ahead = vf_max(a->z1, zero);
    vf z1 = a->z1 * cosine + lean, inside = vf_sqrt(ahead * ahead + t * t) + slack;
    z1 = vf_sel_gt(r * cosine, ahead * sine + slack, z1, vf_max(z1, inside));
    r = vf_max(r * cosine - (ahead * sine + slack), zero);
    return (range){ a->z0 * cosine - lean, vf_min(z1, m), r * r };
}

/* Least |p|^2 at the greatest cosine, where z1 > 0. */
LC_INLINE vf least_q(const range *a, vf d2) { return vf_max(a->r2 + a->z1 * a->z1, d2); }

/* Greatest cosine about the axis, for q of least_q. */
LC_INLINE vf max_cos(const range *a, vf q)
{
    const vf one = vf_set(1);
    return vf_sel_gt(q, vf_set(NEAR * NEAR), vf_min(a->z1 / vf_sqrt(q), one), one);
}

/* Greatest cos phi over boxes and cones; <= 0 where all lights face away. Row ROW_CENTER has been read. back:
 * the greatest of -cos phi, about the reversed axis. */
LC_INLINE vf max_cos_phi(cluster_lanes *l, const rel_box *box, bool back)
{
    const vf one = vf_set(1), zero = vf_set(0), slack = vf_set(COS_SLACK);
    vf cc = l->row[ROW_CENTER][3];
    range a = range_make(box, row(l, ROW_AXIS), !back);
    /* Where all members are behind, the greatest cosine is at the greatest distance. */
    vf q = vf_sel_gt(zero, a.z1, dot(box->m, box->m), least_q(&a, box->d2));
    vf ct = max_cos(&a, q) + slack;
    vf sines = (one - ct) * (one + ct) * ((one - cc) * (one + cc)); /* squared */
    vf e = vf_min(ct * cc + vf_sqrt(vf_max(sines, zero)) + slack, one);
    e = vf_sel_gt(cc, ct, e, one);
    e = vf_sel_gt(cc, vf_set(-1), e, one);
    return vf_sel_gt(vf_set(NEAR), box->m_sum, one, e);
}

/* Least f(d), from the least A, B, C of the members, which are written to k. */
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
    g = vf_min(g / k[2], vf_set(FLT_MAX)); /* infinite where the least A, B, C are all 0 */
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

/* Weights of R G B in the luminance of light that a reflectance f scales, with the slack. */
LC_INLINE v3 weights(const float f[3])
{
    return (v3){ vf_set(0.2126f * SLACK * f[0]), vf_set(0.7152f * SLACK * f[1]),
                 vf_set(0.0722f * SLACK * f[2]) };
}
