/* estimate_tmpl.c - transfers of VF_LANES lights at once; included by isa_*.c. The operations of
 * lc_shade_light in the same order, so the same bits, but for those that can't matter: lanes that it leaves
 * early are computed and set to 0, the root of B d is not taken where B is 0 in every lane, and a lobe that
 * is not added is added as 0.
 */
#include "shade/tree_data.h"

LC_INLINE vf dot_rows(const vf a[3], const vf b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

LC_INLINE void set_row(vf out[3], const float a[3])
{
    for (int k = 0; k < 3; k++) out[k] = vf_set(a[k]);
}

LC_INLINE uint32_t index_of(const lc_tree_data *t, const float *light)
{
    return (uint32_t)((const lc_light_rec *)(const void *)light - t->lights);
}

/* 1 / f, times g; d2: squared distances. */
LC_INLINE vf attenuated(const lc_tree_data *t, const float *const *light, lc_light_kind kind,
                        const lc_point *p, vf d2, vf g)
{
    vf min_d2 = vf_set(p->min_d2), d2c = vf_sel_gt(d2, min_d2, d2, min_d2), k[4], f;
    const float *atten[VF_LANES];
    if (!t->light_atten || kind == LC_LIGHT_SPOT) return g / d2c;
    for (uint32_t i = 0; i < VF_LANES; i++) atten[i] = t->light_atten[index_of(t, light[i])];
    vf_rows(atten, 0, k);
    f = k[0];
    if (vf_any_gt(k[1], vf_set(0))) f = f + k[1] * vf_sqrt(d2c);
    return g / (f + k[2] * d2c);
}

/* lc_spot_emission; tint: colours of maps, or 1. d: from the point to the light. */
LC_INLINE vf spot(const lc_tree_data *t, const float *const *light, vf cos_phi, const vf d[3], vf tint[3])
{
    const vf zero = vf_set(0), one = vf_set(1);
    const lc_spot_rec *spot[VF_LANES];
    const float *row[VF_LANES];
    float to[3][VF_LANES], rgb[3][VF_LANES];
    vf k[4];
    for (uint32_t i = 0; i < VF_LANES; i++) {
        spot[i] = &t->light_spot[index_of(t, light[i]) - t->first_spot_light];
        row[i] = &spot[i]->cos_total;
    }
    vf_rows(row, 0, k);
    vf x = (vf_sel_gt(one, cos_phi, cos_phi, one) - k[0]) * k[1];
    x = vf_sel_gt(x, zero, x, zero);
    x = vf_sel_gt(one, x, x, one);
    if (t->spot_maps) {
        for (int a = 0; a < 3; a++) vf_store(to[a], -d[a]);
        for (uint32_t i = 0; i < VF_LANES; i++) {
            const float w[3] = { to[0][i], to[1][i], to[2][i] };
            float c[3] = { 1, 1, 1 };
            if (spot[i]->map) lc_spot_colour(&t->spot_maps[spot[i]->map - 1], w, c);
            for (int a = 0; a < 3; a++) rgb[a][i] = c[a];
        }
        for (int a = 0; a < 3; a++) tint[a] = vf_load(rgb[a]);
    }
    return x * x * (3 - (x + x));
}

/* lc_dir_unpack. */
LC_INLINE void unpack(vf a, vf b, vf out[3])
{
    const vf zero = vf_set(0), flag = vf_word(LC_DIR_FLAG);
    vf is_x = vf_and(a, flag), is_y = vf_and(b, flag); /* 2 or 0 as floats */
    vf sign = vf_shl(vf_and(a, vf_word(LC_DIR_SIGN)), 31);
    a = vf_and(a, vf_word(~(LC_DIR_FLAG | LC_DIR_SIGN)));
    b = vf_and(b, vf_word(~LC_DIR_FLAG));
    vf rest = 1 - a * a - b * b, w = vf_xor(vf_sqrt(vf_max(rest, zero)), sign);
    out[0] = vf_sel_gt(is_x, zero, w, a);
    out[1] = vf_sel_gt(is_x, zero, a, vf_sel_gt(is_y, zero, w, b));
    out[2] = vf_sel_gt(is_x, zero, b, vf_sel_gt(is_y, zero, b, w));
}

/* Factor of the specular reflectance for directions d. */
LC_INLINE vf phong(const lc_point *p, const vf d[3], vf inv_len, vf lit)
{
    const vf zero = vf_set(0), one = vf_set(1);
    vf mirror[3];
    set_row(mirror, p->mirror);
    vf cos_m = dot_rows(mirror, d) * inv_len;
    cos_m = vf_sel_gt(lit, zero, cos_m, zero);
    cos_m = vf_sel_gt(cos_m, vf_set(LC_MIN_COS), vf_sel_gt(one, cos_m, cos_m, one), zero);
    if (!vf_any_gt(cos_m, zero)) return zero;
    vf lobe = pow01(cos_m, p->exponent);
    return vf_sel_gt(vf_set(LC_MIN_LOBE), lobe, zero, lobe);
}

/* The same of Ward's lobe, also for lanes that are not lit. */
LC_INLINE vf ward(const lc_point *p, const vf d[3], vf cos_r, vf inv_len, vf lit)
{
    const vf zero = vf_set(0), min_cos = vf_set(LC_WARD_MIN_COS), many = vf_set(100);
    vf tx[3], ty[3];
    set_row(tx, p->tangent[0]);
    set_row(ty, p->tangent[1]);
    vf x = dot_rows(tx, d) * inv_len + p->view[0];
    vf y = dot_rows(ty, d) * inv_len + p->view[1], z = cos_r + p->view[2];
    vf e = (x * x + y * y) / (z * z);
    e = vf_sel_gt(lit, zero, e, many);
    e = vf_sel_gt(many, e, e, many);
    if (!vf_any_gt(vf_set(-(float)LC_LEAST_LN), e)) return zero;
    vf lobe = decay(e);
    lobe = vf_sel_gt(vf_set(LC_MIN_LOBE), lobe, zero, lobe);
    return lobe / vf_sqrt(vf_sel_gt(cos_r, min_cos, cos_r, min_cos));
}

LC_INLINE vf stretched(const lc_point *p, vf x, vf y, vf z)
{
    x = x * p->square[0];
    y = y * p->square[1];
    return vf_sqrt(x * x + y * y + z * z);
}

/* out: R G B of GGX's lobe. */
LC_INLINE void fresnel(const lc_point *p, vf c, vf lobe, vf out[3])
{
    const vf one = vf_set(1);
    if (p->fresnel == LC_FRESNEL_SCHLICK) {
        vf m = one - c, m2 = m * m, w = m2 * m2 * m;
        w = vf_sel_gt(vf_set(LC_MIN_LOBE), w, vf_set(0), w);
        for (int k = 0; k < 3; k++) out[k] = (p->specular[k] + p->rise[k] * w) * lobe;
    } else if (p->fresnel == LC_FRESNEL_DIELECTRIC) {
        vf f = vf_max(one - transmitted(p, c), vf_set(0));
        for (int k = 0; k < 3; k++) out[k] = p->specular[k] * f * lobe;
    } else {
        for (int k = 0; k < 3; k++) out[k] = p->specular[k] * conductor(p->rise[k], p->turn[k], c) * lobe;
    }
}

LC_INLINE void ggx(const lc_point *p, const vf d[3], vf cos_r, vf inv_len, vf out[3])
{
    const vf o_n = vf_set(p->view[2]);
    vf tx[3], ty[3];
    set_row(tx, p->tangent[0]);
    set_row(ty, p->tangent[1]);
    vf x = dot_rows(tx, d) * inv_len, y = dot_rows(ty, d) * inv_len;
    vf shadowing = stretched(p, x, y, cos_r), z = cos_r + o_n;
    x = x + p->view[0];
    y = y + p->view[1];
    x = x * x;
    y = y * y;
    z = z * z;
    vf h2 = x * p->square[0] + y * p->square[1] + z, r = h2 / (x + y + z);
    vf lobe = r * r / (p->masking * cos_r + shadowing * o_n);
    fresnel(p, vf_min(0.5f * vf_sqrt(h2), vf_set(1)), lobe, out);
}

/* One channel of the transfer, times the cosine and g; 0 where `lit` is not above 0. */
LC_INLINE vf channel(vf f, vf cos_g, vf lit)
{
    const vf zero = vf_set(0), most = vf_set(LC_MAX_TRANSFER);
    f = f * cos_g;
    f = vf_sel_gt(vf_set(LC_MIN_TRANSFER), f, zero, vf_sel_gt(most, f, f, most));
    return vf_sel_gt(lit, zero, f, zero);
}

/* light: VF_LANES records. kind, lobe: constants. */
LC_INLINE void shade(const lc_tree_data *t, const float *const *light, lc_light_kind kind, lc_lobe lobe,
                     const lc_point *p, float *const out[6], uint32_t at)
{
    const vf zero = vf_set(0), one = vf_set(1), min_cos = vf_set(LC_MIN_COS), tiny = vf_set(LC_TINY_D2);
    vf n[3], d[3], y[4], tint[3] = { one, one, one }, inv_len = one, g = one, cos_r, lit;
    set_row(n, p->n);
    vf_rows(light, 0, y);
    if (kind == LC_LIGHT_DIRECTIONAL) {
        for (int k = 0; k < 3; k++) d[k] = y[k];
        cos_r = dot_rows(n, d);
        lit = vf_sel_gt(cos_r, min_cos, one, zero);
    } else {
        for (int k = 0; k < 3; k++) d[k] = y[k] - p->pos[k];
        vf nd = dot_rows(n, d), d2 = dot_rows(d, d);
        inv_len = one / vf_sqrt(vf_sel_gt(d2, tiny, d2, tiny));
        cos_r = nd * inv_len;
        lit = vf_sel_gt(cos_r, min_cos, one, zero); /* then nd > 0 */
        if (lc_is_aimed(kind)) {
            vf dir[3], row[4];
            vf_rows(light, offsetof(lc_light_rec, intensity) / sizeof(float), row);
            unpack(y[3], row[3], dir);
            g = -dot_rows(dir, d) * inv_len;
            if (kind == LC_LIGHT_SPOT) g = spot(t, light, g, d, tint);
            lit = vf_sel_gt(g, min_cos, lit, zero);
        }
        g = attenuated(t, light, kind, p, d2, g);
    }
    vf cos_g = cos_r * g, glossy = zero, lobes[3] = { zero, zero, zero }, coat = one;
    if (lobe == LC_LOBE_PHONG) glossy = phong(p, d, inv_len, lit);
    if (lobe == LC_LOBE_WARD) glossy = ward(p, d, cos_r, inv_len, lit);
    if (lobe == LC_LOBE_GGX) ggx(p, d, cos_r, inv_len, lobes);
    if (lobe == LC_LOBE_GGX && p->coat) coat = transmitted(p, cos_r);
    for (int k = 0; k < 3; k++) {
        vf f = vf_set(p->diffuse[k]);
        if (lobe == LC_LOBE_GGX) f = f * coat + lobes[k];
        else if (lobe != LC_LOBE_NONE) f = f + p->specular[k] * glossy;
        if (kind == LC_LIGHT_SPOT) f = f * tint[k];
        vf_store(out[k] + at, channel(f, cos_g, lit));
        vf_store(out[3 + k] + at, y[k]);
    }
}

LC_INLINE void estimate_of(const lc_tree_data *t, uint32_t first, const uint32_t *index, uint32_t n,
                           lc_light_kind kind, lc_lobe lobe, const lc_point *p, float *const out[6])
{
    for (uint32_t i = 0; i < n; i += VF_LANES) {
        const float *rec[VF_LANES]; /* the last one fills up */
        for (uint32_t k = 0; k < VF_LANES; k++) {
            uint32_t at = i + k < n ? i + k : n - 1;
            rec[k] = t->lights[index ? index[at] : first + at].pos;
        }
        shade(t, rec, kind, lobe, p, out, i);
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
#define ESTIMATE(kind, lobe) estimate_of(t, first, index, n, kind, lobe, p, out)
#define BY_LOBE(kind)                                                 \
    if (p->lobe == LC_LOBE_NONE) ESTIMATE(kind, LC_LOBE_NONE);        \
    else if (p->lobe == LC_LOBE_PHONG) ESTIMATE(kind, LC_LOBE_PHONG); \
    else if (p->lobe == LC_LOBE_WARD) ESTIMATE(kind, LC_LOBE_WARD);   \
    else ESTIMATE(kind, LC_LOBE_GGX)
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
#undef ESTIMATE
}
