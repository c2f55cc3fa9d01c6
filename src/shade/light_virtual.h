/* light_virtual.h - virtual lights, which stand for what surfaces reflect: oriented lights, to which a point
 * may have another material (lc_point.soft), so that a narrow lobe does not show each of them as a dot.
 *
 * What a lobe or a mirror reflects shines narrowly about lc_light.dir: by the n-th power of the cosine, n =
 * 1, 3, 7, 15 for lc_light.atten[3] = 0, 1, 2, 3. A cluster's bound does not know: a power of a cosine is at
 * most that. The cosine is first taken for at most 1, and its power is within 6u of an n-th power, which is
 * off from 1 by n times as much as the cosine: so the rounded power, too, is at most the rounded cosine, or
 * 6u above, of the 64u that bounds have. From below all of a tree are the narrowest, if one is narrow: 15
 * times what the cosine is off by, 8u, and the products, 6u, are less than the 2^-16 that is taken off.
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
    if (!t->narrow) return e;
    const vf e2 = e * e, e4 = e2 * e2, e8 = e4 * e4;
    return e8 * e4 * e2 * e * (1 - 0x1p-16f);
}

/* The power of a cosine. */
LC_INLINE vf virtual_narrowed(vf cosine, vf how)
{
    const vf g = vf_min(cosine, vf_set(1)), g2 = g * g, g3 = g2 * g, g4 = g2 * g2, g7 = g4 * g3,
             g15 = g4 * g4 * g7;
    cosine = vf_sel_gt(how, vf_set(0.5f), g3, cosine);
    cosine = vf_sel_gt(how, vf_set(1.5f), g7, cosine);
    return vf_sel_gt(how, vf_set(2.5f), g15, cosine);
}

#endif
