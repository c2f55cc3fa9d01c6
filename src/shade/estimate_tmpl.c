/* estimate_tmpl.c - transfers of VF_LANES lights at once; included by isa_*.c. The operations of lc_shade_light in the same
 * order, so the same bits, but for those that can't matter: lanes that it leaves early are computed and set to 0, the
 * root of B d is not taken where B is 0 in every lane, and a lobe that is not added is added as 0.
 */
#include "shade/tree_data.h"

#define ADD vf_add
#define MUL vf_mul
#define SET vf_set

LC_INLINE vf LC_FN(dot_rows)(const vf a[3], const vf b[3])
{
    return ADD(ADD(MUL(a[0], b[0]), MUL(a[1], b[1])), MUL(a[2], b[2]));
}

LC_INLINE void LC_FN(set_row)(vf out[3], const float a[3])
{
    for (int k = 0; k < 3; k++) out[k] = SET(a[k]);
}

LC_INLINE uint32_t LC_FN(index_of)(const lc_tree_data *t, const float *light)
{
    return (uint32_t)((const lc_light_rec *)(const void *)light - t->lights);
}

/* 1 / f, times g; d2: squared distances. */
LC_INLINE vf LC_FN(attenuated)(const lc_tree_data *t, const float *const *light, lc_light_kind kind, const lc_point *p, vf d2, vf g)
{
    vf min_d2 = SET(p->min_d2), d2c = vf_sel_gt(d2, min_d2, d2, min_d2), k[4], f;
    const float *atten[VF_LANES];
    if (!t->light_atten || kind == LC_LIGHT_SPOT) return vf_div(g, d2c);
    for (uint32_t i = 0; i < VF_LANES; i++) atten[i] = t->light_atten[LC_FN(index_of)(t, light[i])];
    vf_rows(atten, 0, k);
    f = k[0];
    if (vf_any_gt(k[1], SET(0))) f = ADD(f, MUL(k[1], vf_sqrt(d2c)));
    return vf_div(g, ADD(f, MUL(k[2], d2c)));
}

/* lc_spot_emission; tint: colours of maps, or 1. d: from the point to the light. */
LC_INLINE vf LC_FN(spot)(const lc_tree_data *t, const float *const *light, vf cos_phi, const vf d[3], vf tint[3])
{
    const vf zero = SET(0), one = SET(1);
    const lc_spot_rec *spot[VF_LANES];
    const float *row[VF_LANES];
    float to[3][VF_LANES], rgb[3][VF_LANES];
    vf k[4];
    for (uint32_t i = 0; i < VF_LANES; i++) {
        spot[i] = &t->light_spot[LC_FN(index_of)(t, light[i]) - t->first_spot_light];
        row[i] = &spot[i]->cos_total;
    }
    vf_rows(row, 0, k);
    vf x = MUL(vf_sub(vf_sel_gt(one, cos_phi, cos_phi, one), k[0]), k[1]);
    x = vf_sel_gt(x, zero, x, zero);
    x = vf_sel_gt(one, x, x, one);
    if (t->spot_maps) {
        for (int a = 0; a < 3; a++) vf_store(to[a], vf_neg(d[a]));
        for (uint32_t i = 0; i < VF_LANES; i++) {
            const float w[3] = { to[0][i], to[1][i], to[2][i] };
            float c[3] = { 1, 1, 1 };
            if (spot[i]->map) lc_spot_colour(&t->spot_maps[spot[i]->map - 1], w, c);
            for (int a = 0; a < 3; a++) rgb[a][i] = c[a];
        }
        for (int a = 0; a < 3; a++) tint[a] = vf_load(rgb[a]);
    }
    return MUL(MUL(x, x), vf_sub(SET(3), ADD(x, x)));
}

/* lc_dir_unpack. */
LC_INLINE void LC_FN(unpack)(vf a, vf b, vf out[3])
{
    const vf zero = SET(0), flag = vf_word(LC_DIR_FLAG);
    vf is_x = vf_and(a, flag), is_y = vf_and(b, flag); /* 2 or 0 as floats */
    vf sign = vf_shl(vf_and(a, vf_word(LC_DIR_SIGN)), 31);
    a = vf_and(a, vf_word(~(LC_DIR_FLAG | LC_DIR_SIGN)));
    b = vf_and(b, vf_word(~LC_DIR_FLAG));
    vf rest = vf_sub(vf_sub(SET(1), MUL(a, a)), MUL(b, b)), w = vf_xor(vf_sqrt(vf_max(rest, zero)), sign);
    out[0] = vf_sel_gt(is_x, zero, w, a);
    out[1] = vf_sel_gt(is_x, zero, a, vf_sel_gt(is_y, zero, w, b));
    out[2] = vf_sel_gt(is_x, zero, b, vf_sel_gt(is_y, zero, b, w));
}

/* Factor of the specular reflectance for directions d. */
LC_INLINE vf LC_FN(phong)(const lc_point *p, const vf d[3], vf inv_len, vf lit)
{
    const vf zero = SET(0), one = SET(1);
    vf mirror[3];
    LC_FN(set_row)(mirror, p->mirror);
    vf cos_m = MUL(LC_FN(dot_rows)(mirror, d), inv_len);
    cos_m = vf_sel_gt(lit, zero, cos_m, zero);
    cos_m = vf_sel_gt(cos_m, SET(LC_MIN_COS), vf_sel_gt(one, cos_m, cos_m, one), zero);
    if (!vf_any_gt(cos_m, zero)) return zero;
    vf lobe = LC_FN(pow01)(cos_m, p->exponent);
    return vf_sel_gt(SET(LC_MIN_LOBE), lobe, zero, lobe);
}

/* The same of Ward's lobe, also for lanes that are not lit. */
LC_INLINE vf LC_FN(ward)(const lc_point *p, const vf d[3], vf cos_r, vf inv_len, vf lit)
{
    const vf zero = SET(0), min_cos = SET(LC_WARD_MIN_COS), many = SET(100);
    vf tx[3], ty[3];
    LC_FN(set_row)(tx, p->tangent[0]);
    LC_FN(set_row)(ty, p->tangent[1]);
    vf x = ADD(MUL(LC_FN(dot_rows)(tx, d), inv_len), SET(p->view[0]));
    vf y = ADD(MUL(LC_FN(dot_rows)(ty, d), inv_len), SET(p->view[1])), z = ADD(cos_r, SET(p->view[2]));
    vf e = vf_div(ADD(MUL(x, x), MUL(y, y)), MUL(z, z));
    e = vf_sel_gt(lit, zero, e, many);
    e = vf_sel_gt(many, e, e, many);
    if (!vf_any_gt(SET(-(float)LC_LEAST_LN), e)) return zero;
    vf lobe = LC_FN(decay)(e);
    lobe = vf_sel_gt(SET(LC_MIN_LOBE), lobe, zero, lobe);
    return vf_div(lobe, vf_sqrt(vf_sel_gt(cos_r, min_cos, cos_r, min_cos)));
}

LC_INLINE vf LC_FN(stretched)(const lc_point *p, vf x, vf y, vf z)
{
    x = MUL(x, SET(p->square[0]));
    y = MUL(y, SET(p->square[1]));
    return vf_sqrt(ADD(ADD(MUL(x, x), MUL(y, y)), MUL(z, z)));
}

/* out: R G B of GGX's lobe. */
LC_INLINE void LC_FN(fresnel)(const lc_point *p, vf c, vf lobe, vf out[3])
{
    const vf one = SET(1);
    if (p->fresnel == LC_FRESNEL_SCHLICK) {
        vf m = vf_sub(one, c), m2 = MUL(m, m), w = MUL(MUL(m2, m2), m);
        w = vf_sel_gt(SET(LC_MIN_LOBE), w, SET(0), w);
        for (int k = 0; k < 3; k++) out[k] = MUL(ADD(SET(p->specular[k]), MUL(SET(p->rise[k]), w)), lobe);
    } else if (p->fresnel == LC_FRESNEL_DIELECTRIC) {
        vf f = vf_max(vf_sub(one, LC_FN(transmitted)(p, c)), SET(0));
        for (int k = 0; k < 3; k++) out[k] = MUL(MUL(SET(p->specular[k]), f), lobe);
    } else {
        for (int k = 0; k < 3; k++) out[k] = MUL(MUL(SET(p->specular[k]), LC_FN(conductor)(p->rise[k], p->turn[k], c)), lobe);
    }
}

LC_INLINE void LC_FN(ggx)(const lc_point *p, const vf d[3], vf cos_r, vf inv_len, vf out[3])
{
    const vf o_n = SET(p->view[2]);
    vf tx[3], ty[3];
    LC_FN(set_row)(tx, p->tangent[0]);
    LC_FN(set_row)(ty, p->tangent[1]);
    vf x = MUL(LC_FN(dot_rows)(tx, d), inv_len), y = MUL(LC_FN(dot_rows)(ty, d), inv_len);
    vf shadowing = LC_FN(stretched)(p, x, y, cos_r), z = ADD(cos_r, o_n);
    x = ADD(x, SET(p->view[0]));
    y = ADD(y, SET(p->view[1]));
    x = MUL(x, x);
    y = MUL(y, y);
    z = MUL(z, z);
    vf h2 = ADD(ADD(MUL(x, SET(p->square[0])), MUL(y, SET(p->square[1]))), z), r = vf_div(h2, ADD(ADD(x, y), z));
    vf lobe = vf_div(MUL(r, r), ADD(MUL(SET(p->masking), cos_r), MUL(shadowing, o_n)));
    LC_FN(fresnel)(p, vf_min(MUL(SET(0.5f), vf_sqrt(h2)), SET(1)), lobe, out);
}

/* One channel of the transfer, times the cosine and g; 0 where `lit` is not above 0. */
LC_INLINE vf LC_FN(channel)(vf f, vf cos_g, vf lit)
{
    const vf zero = SET(0), most = SET(LC_MAX_TRANSFER);
    f = MUL(f, cos_g);
    f = vf_sel_gt(SET(LC_MIN_TRANSFER), f, zero, vf_sel_gt(most, f, f, most));
    return vf_sel_gt(lit, zero, f, zero);
}

/* light: VF_LANES records. kind, lobe: constants. */
LC_INLINE void LC_FN(shade)(const lc_tree_data *t, const float *const *light, lc_light_kind kind, lc_lobe lobe, const lc_point *p,
                            float *const out[6], uint32_t at)
{
    const vf zero = SET(0), one = SET(1), min_cos = SET(LC_MIN_COS), tiny = SET(LC_TINY_D2);
    vf n[3], d[3], y[4], tint[3] = { one, one, one }, inv_len = one, g = one, cos_r, lit;
    LC_FN(set_row)(n, p->n);
    vf_rows(light, 0, y);
    if (kind == LC_LIGHT_DIRECTIONAL) {
        for (int k = 0; k < 3; k++) d[k] = y[k];
        cos_r = LC_FN(dot_rows)(n, d);
        lit = vf_sel_gt(cos_r, min_cos, one, zero);
    } else {
        for (int k = 0; k < 3; k++) d[k] = vf_sub(y[k], SET(p->pos[k]));
        vf nd = LC_FN(dot_rows)(n, d), d2 = LC_FN(dot_rows)(d, d);
        inv_len = vf_div(one, vf_sqrt(vf_sel_gt(d2, tiny, d2, tiny)));
        cos_r = MUL(nd, inv_len);
        lit = vf_sel_gt(cos_r, min_cos, one, zero); /* then nd > 0 */
        if (lc_is_aimed(kind)) {
            vf dir[3], row[4];
            vf_rows(light, offsetof(lc_light_rec, intensity) / sizeof(float), row);
            LC_FN(unpack)(y[3], row[3], dir);
            g = MUL(vf_neg(LC_FN(dot_rows)(dir, d)), inv_len);
            if (kind == LC_LIGHT_SPOT) g = LC_FN(spot)(t, light, g, d, tint);
            lit = vf_sel_gt(g, min_cos, lit, zero);
        }
        g = LC_FN(attenuated)(t, light, kind, p, d2, g);
    }
    vf cos_g = MUL(cos_r, g), glossy = zero, lobes[3] = { zero, zero, zero }, coat = one;
    if (lobe == LC_LOBE_PHONG) glossy = LC_FN(phong)(p, d, inv_len, lit);
    if (lobe == LC_LOBE_WARD) glossy = LC_FN(ward)(p, d, cos_r, inv_len, lit);
    if (lobe == LC_LOBE_GGX) LC_FN(ggx)(p, d, cos_r, inv_len, lobes);
    if (lobe == LC_LOBE_GGX && p->coat) coat = LC_FN(transmitted)(p, cos_r);
    for (int k = 0; k < 3; k++) {
        vf f = SET(p->diffuse[k]);
        if (lobe == LC_LOBE_GGX) f = ADD(MUL(f, coat), lobes[k]);
        else if (lobe != LC_LOBE_NONE) f = ADD(f, MUL(SET(p->specular[k]), glossy));
        if (kind == LC_LIGHT_SPOT) f = MUL(f, tint[k]);
        vf_store(out[k] + at, LC_FN(channel)(f, cos_g, lit));
        vf_store(out[3 + k] + at, y[k]);
    }
}

LC_INLINE void LC_FN(estimate_of)(const lc_tree_data *t, uint32_t first, const uint32_t *index, uint32_t n, lc_light_kind kind,
                                  lc_lobe lobe, const lc_point *p, float *const out[6])
{
    for (uint32_t i = 0; i < n; i += VF_LANES) {
        const float *rec[VF_LANES]; /* the last one fills up */
        for (uint32_t k = 0; k < VF_LANES; k++) {
            uint32_t at = i + k < n ? i + k : n - 1;
            rec[k] = t->lights[index ? index[at] : first + at].pos;
        }
        LC_FN(shade)(t, rec, kind, lobe, p, out, i);
    }
}

static void LC_FN(estimate)(const lc_tree_data *t, uint32_t first, const uint32_t *index, uint32_t n, lc_light_kind kind,
                            const lc_point *p, float *const out[6])
{
#ifdef LC_HALF_AS_WIDE
    uint32_t rest = n % VF_LANES;
    if (rest && rest <= VF_LANES / 2) {
        n -= rest;
        float *const end[6] = { out[0] + n, out[1] + n, out[2] + n, out[3] + n, out[4] + n, out[5] + n };
        LC_HALF_AS_WIDE.shade.estimate(t, first + n, index ? index + n : NULL, rest, kind, p, end);
    }
#endif
#define ESTIMATE(kind, lobe) LC_FN(estimate_of)(t, first, index, n, kind, lobe, p, out)
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

#undef ADD
#undef MUL
#undef SET
