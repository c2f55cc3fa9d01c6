/* slope_tmpl.c - the least slope of the half vector over a box, as Ward's and GGX's lobes need it; included
 * by isa_tmpl.c.
 *
 * With X, Y = tangents over roughness and N = n, each dotted with h = p / |p| + o, Ward's estimate is
 * e^-(X^2 + Y^2) / N^2. Let e be the unit direction to the box centre. Then
 *
 *     0 <= |p| - e.p = |p x e|^2 / (|p| + e.p) <= half.half / (2 min e.p) =: bend
 *
 * so that |p| h, too, is linear in p but for a term of second order. With (a, b) the unit vector along (X, Y)
 * of the centre, q = a tx + b ty and l = q.o:
 *
 *     |p| sqrt(X^2 + Y^2) >= q.p + |p| l >= (q + l e).p + min(l, 0) bend =: L
 *     |p| N <= (n + (n.o) e).p + (n.o) bend =: Z
 *
 * and t = L / Z bounds the root of the exponent. So does t + L' / Z, where q - t n takes the place of q: a
 * step that may be repeated, towards the best t for this q. The lobe's other factor is
 *
 *     sqrt(cos) / d^2 = sqrt(cos / d^2) sqrt(1 / d^2)
 *
 * whose first factor is bounded already, or where the cosine is below LC_WARD_MIN_COS, cos / d^2 over the
 * root of that constant: the lesser of the two bounds every case.
 * - T = max_tangent_length is the length of the longer tangent, so |q|, |l| <= T; they share an exact l with
 *   the estimate. In uTM: the estimate's X and Y 9.5 each, so 13.5; q and l 2 * 2.9; q + l e 6, its two dot
 *   products 12, the widening of half 8, sums 4; a direction of length 1 +- 2u that is taken as 1: 3.
 *   Together 53, and as many uM for Z: 64uM (T + t) is subtracted from L, and 64uM added to Z.
 * - e is shortened by 8u, so that its length is at most 1, and at least 1 - 16u: 16uM is added to bend.
 *   half.half and its rounding are those of D^2, min e.p that of a z. Boxes nearer than NEAR, or around the
 *   point, have no bound but 1.
 * - (a, b) is off by 4u in length, shorter where X^2 + Y^2 is below TINY; the rest is relative: less than 32u
 *   of the exponent.
 */
#include "shade/point.h"

/* Steps towards the best t; measured: tests/results/bounds.md. */
#define SLOPE_STEPS 2

/* Returns t, no more than the root of Ward's exponent; valid only where *clear, the least e.p, is above NEAR.
 */
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
    for (int step = 0; step < SLOPE_STEPS; step++) {
        v3 r = along(q, n, -slope);
        vf low = dot(r, box->c) - dot(abs3(r), box->half);
        low = low + vf_min(o_q - slope * o_n, zero) * bend;
        low = low - rounding * (p->max_tangent_length + slope);
        slope = slope + vf_max(low, zero) / high;
    }
    *clear = least;
    return slope;
}

#undef SLOPE_STEPS
