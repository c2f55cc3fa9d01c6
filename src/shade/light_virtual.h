/* light_virtual.h - virtual lights, which stand for what surfaces reflect: oriented lights, to which a point
 * may have another material (lc_point.soft), so that a narrow lobe does not show each of them as a dot.
 *
 * What a lobe or a mirror reflects shines as the lobe does. With n the surface's normal, i and o the
 * directions to where its light came from and to the point, a the roughness, h = i + o, z = h.n, the
 * emission is cos o min(scale q, 1), of GGX ([Walter07]; lobe_ggx.h) all but what does not depend on o:
 *
 *     q = r^2 / (s(i) cos o + s(o) cos i)
 *     r = |h|^2 / ((|h|^2 - z^2) / a^2 + z^2),   |h|^2 = 2 + 2 i.o,   s(w)^2 = cos^2 w + a^2 (1 - cos^2 w)
 *
 * shade/shine.h makes it. A cluster's bound does not know of q, and need not: cos o times what is at most 1
 * is at most cos o, rounded or not. From below it may be 0.
 */
#ifndef LC_LIGHT_VIRTUAL_H
#define LC_LIGHT_VIRTUAL_H

#include "shade/light_kind.h"

#endif

#ifdef LC_TABLE_PARTS

#define LC_LIGHT_INFO_virtual .name = "virtual", .flux = oriented_flux, .emit = oriented_emit

#endif

#ifdef LC_KERNEL_PARTS

LC_INLINE vf virtual_emission(const lc_tree_data *t, const float *const *light, vf cos_phi, const vf d[3],
                              vf tint[3])
{
    return oriented_emission(t, light, cos_phi, d, tint);
}

LC_INLINE vf virtual_emission_bound(const lc_tree_data *t, const uint32_t *node, const rel_box *box, vf e,
                                    vf least)
{
    return oriented_emission_bound(t, node, box, e, least);
}

LC_INLINE vf virtual_emission_least(const lc_tree_data *t, vf e)
{
    return t->light_shine ? vf_set(0) : e;
}

LC_INLINE vf smith_length(vf cosine, vf a2)
{
    const vf c2 = cosine * cosine;
    return vf_sqrt(c2 + a2 * vf_max(1 - c2, vf_set(0)));
}

/* min(scale q, 1), or 1 without a lobe. normal: of the lights' surfaces; d: from the point to the lights. */
LC_INLINE vf virtual_shine(const lc_tree_data *t, const float *const *light, const vf normal[3], vf cos_o,
                           const vf d[3], vf inv_len)
{
    const vf zero = vf_set(0), one = vf_set(1), least = vf_set(LC_SHINE_COS);
    const float *row[VF_LANES];
    vf k[4], i[3];
    for (uint32_t l = 0; l < VF_LANES; l++)
        row[l] = (const float *)(const void *)&t->light_shine[light_index(t, light[l])];
    vf_rows(row, 0, k);
    if (!vf_any_gt(k[2], zero)) return one;
    unpack(k[0], k[1], i);
    const vf cos_i = vf_max(dot_rows(i, normal), least), a2 = vf_max(k[2] * k[2], vf_set(LC_TINY_D2));
    cos_o = vf_max(cos_o, zero);
    const vf h2 = vf_max(2 - 2 * (dot_rows(i, d) * inv_len), zero), z = cos_i + cos_o, z2 = z * z;
    const vf r = h2 / (vf_max(h2 - z2, zero) / a2 + z2);
    const vf q = r * r / (smith_length(cos_i, a2) * cos_o + smith_length(cos_o, a2) * cos_i);
    return vf_sel_gt(k[2], zero, vf_min(q * k[3], one), one);
}

#endif
