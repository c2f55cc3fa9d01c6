/* light_virtual.h - virtual lights, which stand for what surfaces reflect: oriented lights, to which a point
 * may have another material (lc_point.soft), so that a narrow lobe does not show each of them as a dot. */
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

LC_INLINE vf virtual_emission_least(vf e) { return oriented_emission_least(e); }

#endif
