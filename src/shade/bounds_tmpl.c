/* bounds_tmpl.c - upper bounds of VF_LANES clusters at once; included by isa_tmpl.c. box_tmpl.c derives them
 * and their rounding. */
#include "shade/tree_data.h"

/* kind, lobe: constants. */
LC_INLINE vf emission_bound(cluster_lanes *l, lc_light_kind kind, const rel_box *box)
{
    vf cos_phi = max_cos_phi(l, box, false), least = vf_set(-1);
    if (lc_is_banded(kind)) least = 0 - max_cos_phi(l, box, true);
    switch (kind) {
#define KIND(ID, name, traits)
#define AIMED_KIND(ID, name, traits) \
    case LC_LIGHT_##ID: return name##_emission_bound(l->tree, l->index, box, cos_phi, least);
#include "shade/light_kinds.h"
#undef KIND
    default: return cos_phi;
    }
}

LC_INLINE vf lobe_bound(cluster_lanes *l, lc_lobe lobe, const lc_point *p, const rel_box *box, const range *n,
                        bool far, vf g, vf diffuse, v3 intensity)
{
    switch (lobe) {
#define LOBE(ID, name) \
    case LC_LOBE_##ID: return name##_bound(l, p, box, n, far, g, diffuse, intensity);
#include "shade/lobes.h"
#undef LOBE
    default: return diffuse * g;
    }
}

LC_INLINE vf bound(cluster_lanes *l, lc_light_kind kind, lc_lobe lobe, const lc_point *p)
{
    static const float origin[3] = { 0, 0, 0 };
    const vf zero = vf_set(0);
    const bool far = lc_is_far(kind);
    const bool wide = lobe == LC_LOBE_NONE;    /* it may be a box of points */
    const bool volume = lobe == LC_LOBE_PHASE; /* which has no horizon */
    rel_box box = rel_box_make(l, far ? origin : p->pos, wide && !far ? p->half : NULL);
    if (kind == LC_LIGHT_VIRTUAL) box.d2 = vf_max(box.d2, vf_set(p->near_d2)); /* nearer ones shed nothing */
    range n = range_make(&box, set3(p->n), false);
    if (wide && p->cone[1] > 0) n = range_of_cone(&n, &box, p->cone);
    if (!volume && !vf_any_gt(n.z1, zero)) return zero; /* behind the horizon */
    v3 intensity = row(l, ROW_INTENSITY);
    vf diffuse = dot(weights(p->diffuse), intensity), g = zero;
    if (far) g = max_cos(&n, least_q(&n, box.d2));
    else if (!volume) g = max_geometry(l, p, &box, &n);
    vf u = lobe_bound(l, lobe, p, &box, &n, far, g, diffuse, intensity);
    if (lc_is_aimed(kind)) {
        vf e = emission_bound(l, kind, &box);
        u = vf_max(u * e, zero); /* also NaN: infinite times 0 */
    }
    return volume ? u : vf_sel_gt(n.z1, zero, u, zero);
}

LC_INLINE void bounds_of(const lc_tree_data *t, const uint32_t *index, uint32_t n, lc_light_kind kind,
                         lc_lobe lobe, const lc_point *point, float *ub)
{
    const lc_point p = *point; /* a copy, which ub cannot alias */
    for (uint32_t i = 0; i < n; i += VF_LANES) {
        uint32_t room[VF_LANES];
        cluster_lanes l = lanes_make(t, kind, index + i, n - i, room);
        vf_store(ub + i, bound(&l, kind, lobe, &p));
    }
}

LC_INLINE void bounds_by_lobe(const lc_tree_data *t, const uint32_t *index, uint32_t n, lc_light_kind kind,
                              const lc_point *p, float *ub)
{
    switch (p->lobe) {
#define LOBE(ID, name) \
    case LC_LOBE_##ID: bounds_of(t, index, n, kind, LC_LOBE_##ID, p, ub); return;
#include "shade/lobes.h"
#undef LOBE
    default: bounds_of(t, index, n, kind, LC_LOBE_NONE, p, ub);
    }
}

static void bounds(const lc_tree_data *t, const uint32_t *index, uint32_t n, lc_light_kind kind,
                   const lc_point *p, float *ub)
{
#ifdef LC_HALF_AS_WIDE
    uint32_t rest = n % VF_LANES;
    if (rest && rest <= VF_LANES / 2) { /* half the cost, the same bits */
        n -= rest;
        LC_HALF_AS_WIDE.shade.bounds(t, index + n, rest, kind, p, ub + n);
    }
#endif
    p = lc_point_for(p, kind);
    switch (kind) {
#define KIND(ID, name, traits) \
    case LC_LIGHT_##ID: bounds_by_lobe(t, index, n, LC_LIGHT_##ID, p, ub); return;
#include "shade/light_kinds.h"
#undef KIND
    default: return;
    }
}
