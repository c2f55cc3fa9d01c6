/* estimate_tmpl.c - transfers M G of VF_LANES lights at once; included by isa_tmpl.c.
 *
 * Lanes whose light contributes nothing are computed all the same, and set to 0. The square root that B d
 * needs is skipped where B is 0 in every lane.
 */
#include "shade/light_target.h"

/* g / f(d); d2: squared distances. */
LC_INLINE vf attenuated(const lc_tree_data *t, const float *const *light, lc_light_kind kind,
                        const lc_point *p, vf d2, vf g)
{
    vf min_d2 = vf_set(p->min_d2), d2c = vf_sel_gt(d2, min_d2, d2, min_d2), k[4], f;
    const float *atten[VF_LANES];
    if (!t->light_atten || !lc_is_attenuated(kind)) return g / d2c;
    for (uint32_t i = 0; i < VF_LANES; i++) atten[i] = t->light_atten[light_index(t, light[i])];
    vf_rows(atten, 0, k);
    f = k[0];
    if (vf_any_gt(k[1], vf_set(0))) f = f + k[1] * vf_sqrt(d2c);
    return g / (f + k[2] * d2c);
}

/* One channel of the transfer, times the cosine and g; 0 where `lit` is not above 0. */
LC_INLINE vf channel(vf f, vf cos_g, vf lit)
{
    const vf zero = vf_set(0), most = vf_set(LC_MAX_TRANSFER);
    f = f * cos_g;
    f = vf_sel_gt(vf_set(LC_MIN_TRANSFER), f, zero, vf_sel_gt(most, f, f, most));
    return vf_sel_gt(lit, zero, f, zero);
}

/* Emission in the direction of the point; kind: a constant. */
LC_INLINE vf emission(const lc_tree_data *t, const float *const *light, lc_light_kind kind, vf cos_phi,
                      const vf d[3], vf tint[3])
{
    switch (kind) {
#define KIND(ID, name, traits)
#define AIMED_KIND(ID, name, traits) \
    case LC_LIGHT_##ID: return name##_emission(t, light, cos_phi, d, tint);
#include "shade/light_kinds.h"
#undef KIND
    default: return cos_phi;
    }
}

LC_INLINE void add_lobe(const lc_point *p, lc_lobe lobe, const vf d[3], vf cos_r, vf inv_len, vf lit, vf f[3])
{
    switch (lobe) {
#define LOBE(ID, name) \
    case LC_LOBE_##ID: name##_value(p, d, cos_r, inv_len, lit, f); return;
#include "shade/lobes.h"
#undef LOBE
    default: return;
    }
}

/* The part of a virtual light that a point gets from it. */
LC_INLINE vf faded_in(const lc_point *p, vf d2)
{
    vf part = (d2 - vf_set(p->near_d2)) * vf_set(p->near_scale);
    return vf_min(vf_max(part, vf_set(0)), vf_set(1));
}

/* In place of the middles y of discs of the sky, and their radii, the directions from which p is lit: as
 * lc_sky_target. */
LC_INLINE void turn_in_sky(const float *const *light, const lc_point *p, vf y[4])
{
    const vf tiny = vf_set(LC_TINY_D2), one = vf_set(1);
    const float *row[VF_LANES];
    vf u[4], s[3];
    for (uint32_t i = 0; i < VF_LANES; i++)
        row[i] = lc_target_row((const lc_light_rec *)(const void *)light[i], p);
    vf_rows(row, 0, u);
    for (int k = 0; k < 3; k++) u[k] = u[k] + y[k];
    const vf len2 = dot_rows(u, u), inv = one / vf_sqrt(vf_sel_gt(len2, tiny, len2, tiny));
    for (int k = 0; k < 3; k++) u[k] = u[k] * inv;
    const vf cosine = dot_rows(u, y);
    for (int k = 0; k < 3; k++) s[k] = y[k] + (u[k] - y[k] * cosine) * y[3];
    const vf scale = one / vf_sqrt(dot_rows(s, s));
    for (int k = 0; k < 3; k++) y[k] = s[k] * scale;
}

/* light: VF_LANES records. kind, lobe: constants. */
LC_INLINE void shade(const lc_tree_data *t, const float *const *light, lc_light_kind kind, lc_lobe lobe,
                     const lc_point *p, float *const out[6], uint32_t at)
{
    const vf zero = vf_set(0), one = vf_set(1), min_cos = vf_set(LC_MIN_COS), tiny = vf_set(LC_TINY_D2);
    vf n[3], d[3], y[4], tint[3] = { one, one, one }, inv_len = one, g = one, cos_r, lit;
    const bool volume = lobe == LC_LOBE_PHASE; /* all round are lit, and no cosine counts */
    set_row(n, p->n);
    vf_rows(light, 0, y);
    if (lc_is_far(kind)) {
        if (lc_is_sized(kind)) turn_in_sky(light, p, y);
        for (int k = 0; k < 3; k++) d[k] = y[k];
        cos_r = dot_rows(n, d);
        lit = vf_sel_gt(cos_r, min_cos, one, zero);
        if (volume) lit = one;
    } else {
        for (int k = 0; k < 3; k++) d[k] = y[k] - p->pos[k];
        vf nd = dot_rows(n, d), d2 = dot_rows(d, d);
        inv_len = one / vf_sqrt(vf_sel_gt(d2, tiny, d2, tiny));
        cos_r = nd * inv_len;
        lit = vf_sel_gt(cos_r, min_cos, one, zero); /* then nd > 0 */
        if (volume) lit = vf_sel_gt(d2, tiny, one, zero);
        if (lc_is_aimed(kind)) {
            vf dir[3], row[4];
            vf_rows(light, offsetof(lc_light_rec, intensity) / sizeof(float), row);
            unpack(y[3], row[3], dir);
            g = -dot_rows(dir, d) * inv_len;
            g = emission(t, light, kind, g, d, tint);
            lit = vf_sel_gt(g, min_cos, lit, zero);
            if (kind == LC_LIGHT_VIRTUAL && t->light_shine)
                g = g * virtual_shine(t, light, dir, g, d, inv_len);
        }
        g = attenuated(t, light, kind, p, d2, g);
        if (kind == LC_LIGHT_VIRTUAL && p->near_scale > 0) g = g * faded_in(p, d2);
    }
    vf cos_g = g, f[3];
    if (!volume) cos_g = cos_r * g;
    set_row(f, p->diffuse);
    add_lobe(p, lobe, d, cos_r, inv_len, lit, f);
    for (int k = 0; k < 3; k++) {
        vf_store(out[k] + at, channel(f[k] * tint[k], cos_g, lit));
        vf_store(out[3 + k] + at, y[k]);
    }
}

LC_INLINE void estimate_of(const lc_tree_data *t, uint32_t first, const uint32_t *index, uint32_t n,
                           lc_light_kind kind, lc_lobe lobe, const lc_point *p, float *const out[6])
{
    for (uint32_t i = 0; i < n; i += VF_LANES) {
        const float *rec[VF_LANES]; /* the last light fills the lanes up */
        for (uint32_t k = 0; k < VF_LANES; k++) {
            uint32_t at = i + k < n ? i + k : n - 1;
            rec[k] = t->lights[index ? index[at] : first + at].pos;
        }
        shade(t, rec, kind, lobe, p, out, i);
    }
}

LC_INLINE void estimate_by_lobe(const lc_tree_data *t, uint32_t first, const uint32_t *index, uint32_t n,
                                lc_light_kind kind, const lc_point *p, float *const out[6])
{
    switch (p->lobe) {
#define LOBE(ID, name) \
    case LC_LOBE_##ID: estimate_of(t, first, index, n, kind, LC_LOBE_##ID, p, out); return;
#include "shade/lobes.h"
#undef LOBE
    default: estimate_of(t, first, index, n, kind, LC_LOBE_NONE, p, out);
    }
}

static void estimate(const lc_tree_data *t, uint32_t first, const uint32_t *index, uint32_t n,
                     lc_light_kind kind, const lc_point *p, float *const out[6])
{
#ifdef LC_HALF_AS_WIDE
    uint32_t rest = n % VF_LANES;
    if (rest && rest <= VF_LANES / 2) {
        n -= rest;
        float *const end[6] = { out[0] + n, out[1] + n, out[2] + n, out[3] + n, out[4] + n, out[5] + n };
        LC_HALF_AS_WIDE.shade.estimate(t, first + n, index ? index + n : NULL, rest, kind, p, end);
    }
#endif
    p = lc_point_for(p, kind);
    switch (kind) {
#define KIND(ID, name, traits) \
    case LC_LIGHT_##ID: estimate_by_lobe(t, first, index, n, LC_LIGHT_##ID, p, out); return;
#include "shade/light_kinds.h"
#undef KIND
    default: return;
    }
}
