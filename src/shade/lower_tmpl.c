/* lower_tmpl.c - lower bounds of VF_LANES clusters at once: what all their lights together contribute at
 * least where nothing is in the way; included by isa_tmpl.c. In the words of box_tmpl.c:
 *
 * Lobes are never below 0 and count as 0: the diffuse part alone is bounded. With R the greatest distance of
 * a member from the axis n, and d2 the distance floor,
 *
 *     cos / d^2 = z / |p|^3 >= z / max(z^2 + R^2, d2)^(3/2)
 *
 * which grows in z, then falls, so that its least value over [z0, z1] is at one of the two ends; and it is no
 * less than z0 / max(max |p|^2, d2)^(3/2). The greater of the two counts. A cosine, z / sqrt(z^2 + R^2),
 * grows in z: it is least at z0. For the emission cosine, the greatest angle about the cone's axis and the
 * cone's half angle are added up. R is bounded by
 *
 *     |t + e'|^2 <= t.t + 2 sum |t_k| h_k + h.h
 *
 * e' being the part across n of an offset e from the centre, |e_k| <= h_k: t.e' = t.e. Attenuation is no more
 * than that by the least A, B, C over what the cluster has kept of the greatest ones (cluster.h).
 *
 * Rounding, beside z and |p| of box_tmpl.c:
 * - R^2: t is within 8u M of the exact one, which moves |t + e'| <= M by as much, its square by 16u M^2; t.n
 *   <= 8u M takes at most 16u M^2 of 2 t.e; the widening of h is 8u M^2 of 2 sum |t_k| h_k, 8u M^2 of h.h;
 *   our own rounding 8u of a sum that is at most (|t| + |h|)^2 <= M^2. Together 56u M^2: r_slack is added
 *   four times (72u M^2).
 * - max |p|^2: the widening and the sum m_k are 6u of m_k, the dot product 3u: 15u, for which 32u are added.
 * - The rest is relative, as for upper bounds: at most 64u there; the intensity, which is rounded up, 2u, the
 *   attenuation's ratio and root 6u, what a coat lets in 24u in estimate and bound, and 10u for its cosine:
 *   T / c falls with the cosine c, and c' of a coat grows no faster. LESS takes 128u off, from the greatest
 *   transfer, too.
 * - Estimates are 0 below LC_MIN_COS and LC_MIN_TRANSFER, and at most LC_MAX_TRANSFER; so are the bounds, at
 *   twice the former. Points within NEAR of a light's plane have a bound of 0, and so have sums near
 *   underflow, where the weights of luminance make products denormal.
 */
#include "shade/tree_data.h"

static const float LESS = 1 - 0x1p-17f;
static const float LEAST_SUM = 1e-30f; /* luminance; less counts as 0 */
static const float ALL_LIT = 1 + 0x1p-20f; /* of faded_in, with the rounding of its product */

/* Greatest squared distance of the boxes from an axis. */
LC_INLINE vf greatest_r2(const rel_box *b, v3 axis)
{
    v3 t = along(b->c, axis, 0 - dot(axis, b->c));
    vf support = dot(abs3(t), b->half);
    return dot(t, t) + (support + support) + dot(b->half, b->half) + 4 * b->r_slack;
}

/* Least cosine where the least z is above NEAR, else 0; p2: greatest |p|^2. */
LC_INLINE vf least_cos(vf z0, vf r2, vf p2)
{
    vf c = z0 / vf_sqrt(vf_min(z0 * z0 + r2, p2));
    return vf_sel_gt(z0, vf_set(NEAR), vf_min(c, vf_set(1)), vf_set(0));
}

/* z / max(q, floor)^(3/2) */
LC_INLINE vf cubed(vf z, vf q, vf floor_d2)
{
    vf inv_q = 1 / vf_max(q, floor_d2);
    return z * vf_sqrt(inv_q) * inv_q;
}

/* Least receiver cosine times 1 / f(d). cos_r: the least cosine. */
LC_INLINE vf least_geometry(cluster_lanes *l, const lc_point *p, const range *n, vf r2, vf p2, vf cos_r)
{
    const vf zero = vf_set(0), min_d2 = vf_set(p->min_d2);
    vf low = cubed(n->z0, n->z0 * n->z0 + r2, min_d2), high = cubed(n->z1, n->z1 * n->z1 + r2, min_d2);
    vf g = vf_max(vf_min(low, high), cubed(n->z0, p2, min_d2));
    if (!l->atten) return g;
    const float *atten[VF_LANES];
    for (uint32_t i = 0; i < VF_LANES; i++) atten[i] = l->atten[l->index[i]];
    vf k[4], d2 = vf_max(p2, min_d2);
    vf_rows(atten, 0, k);
    vf separate = cos_r / (k[0] + k[1] * vf_sqrt(d2) + k[2] * d2);
    g = vf_sel_gt(k[0] + k[1], zero, separate, g / vf_max(k[2], vf_set(LC_MIN_ATTEN)));
    return g * k[3];
}

/* Least cos phi over boxes and cones; not above 0 where some light may face away. */
LC_INLINE vf least_cos_phi(cluster_lanes *l, const rel_box *box, vf p2)
{
    const vf one = vf_set(1), zero = vf_set(0), slack = vf_set(COS_SLACK);
    vf cc = l->row[ROW_CENTER][3];
    v3 axis = row(l, ROW_AXIS);
    range a = range_make(box, axis, true);
    vf ct = least_cos(a.z0, greatest_r2(box, axis), p2) - slack;
    vf sines = (one - ct) * (one + ct) * ((one - cc) * (one + cc)); /* squared */
    vf e = ct * cc - vf_sqrt(vf_max(sines, zero)) - slack;
    return vf_sel_gt(ct, zero, vf_sel_gt(cc, zero, e, zero), zero);
}

/* e: least cosine; kind: a constant. */
LC_INLINE vf least_emission(cluster_lanes *l, lc_light_kind kind, vf e)
{
    switch (kind) {
#define KIND(ID, name, traits)
#define AIMED_KIND(ID, name, traits) \
    case LC_LIGHT_##ID: return name##_emission_least(l->tree, e);
#include "shade/light_kinds.h"
#undef KIND
    default: return e;
    }
}

/* One channel of the sum: of its transfer and intensity. */
LC_INLINE vf least_channel(float diffuse, vf g, vf intensity)
{
    vf f = vf_min(diffuse * g, vf_set(LC_MAX_TRANSFER)) * LESS;
    return vf_sel_gt(f, vf_set(2 * LC_MIN_TRANSFER), f * intensity, vf_set(0));
}

LC_INLINE vf lower_bound(cluster_lanes *l, lc_light_kind kind, const lc_point *p)
{
    static const float origin[3] = { 0, 0, 0 };
    const vf zero = vf_set(0), min_cos = vf_set(2 * LC_MIN_COS);
    const bool far = lc_is_far(kind);
    rel_box box = rel_box_make(l, far ? origin : p->pos, NULL);
    range n = range_make(&box, set3(p->n), false);
    if (!vf_any_gt(n.z0, vf_set(NEAR))) return zero; /* a light may be behind the horizon */
    v3 intensity = row(l, ROW_INTENSITY);
    vf p2 = dot(box.m, box.m) * (1 + 32 * U), r2 = greatest_r2(&box, set3(p->n));
    vf cos_r = far ? n.z0 : least_cos(n.z0, r2, p2), g = n.z0;
    if (!far) g = least_geometry(l, p, &n, r2, p2, cos_r);
    vf lit = vf_sel_gt(n.z0, vf_set(NEAR), cos_r, zero);
    if (lc_is_aimed(kind)) {
        vf e = least_cos_phi(l, &box, p2);
        lit = vf_min(lit, e);
        g = g * least_emission(l, kind, e);
    }
    if (p->coat) g = g * let_in(p, vf_max(cos_r * LESS, min_cos)) * LESS;
    vf sum = 0.2126f * least_channel(p->diffuse[0], g, intensity.x) +
             0.7152f * least_channel(p->diffuse[1], g, intensity.y) +
             0.0722f * least_channel(p->diffuse[2], g, intensity.z);
    sum = vf_min(vf_max(sum, zero), vf_set(FLT_MAX)); /* also NaN: infinite times 0 */
    sum = vf_sel_gt(sum, vf_set(LEAST_SUM), sum, zero);
    if (kind == LC_LIGHT_VIRTUAL && p->near_scale > 0) /* some may be near, and shed less */
        sum = vf_sel_gt((box.d2 - p->near_d2) * p->near_scale, vf_set(ALL_LIT), sum, zero);
    return vf_sel_gt(lit, min_cos, sum, zero);
}

LC_INLINE void lower_bounds_of(const lc_tree_data *t, const uint32_t *index, uint32_t n, lc_light_kind kind,
                               const lc_point *point, float *lb)
{
    const lc_point p = *point; /* a copy, which lb cannot alias */
    for (uint32_t i = 0; i < n; i += VF_LANES) {
        uint32_t room[VF_LANES];
        cluster_lanes l = lanes_make(t, kind, index + i, n - i, room);
        vf_store(lb + i, lower_bound(&l, kind, &p));
    }
}

static void lower_bounds(const lc_tree_data *t, const uint32_t *index, uint32_t n, lc_light_kind kind,
                         const lc_point *p, float *lb)
{
    p = lc_point_for(p, kind);
    switch (kind) {
#define KIND(ID, name, traits) \
    case LC_LIGHT_##ID: lower_bounds_of(t, index, n, LC_LIGHT_##ID, p, lb); return;
#include "shade/light_kinds.h"
#undef KIND
    default: return;
    }
}
