/* one_bound.c - one node and one light at a time, by the scalar kernels. */
#include "support/one_bound.h"

#include "isa/isa.h"
#include "shade/point_init.h"

#include <string.h>

float one_bound(const lc_node *node, const lc_atten *atten, lc_light_kind kind, const lc_point *point)
{
    const uint32_t index = 0;
    float ub[LC_LANES];
    lc_node n = *node;
    lc_atten a = { 0, 0, 1, 0 };
    if (atten) memcpy(a, *atten, sizeof a);
    const lc_tree_data tree = { .nodes = &n, .node_atten = atten ? &a : NULL };
    lc_kernels_scalar.shade.bounds(&tree, &index, 1, kind, point, ub);
    return ub[0];
}

float one_spot_bound(const lc_node *node, const lc_spot_rec *spot, const lc_point *point)
{
    const uint32_t index = 0;
    float ub[LC_LANES];
    lc_node n = *node;
    lc_spot_rec s = *spot;
    const lc_tree_data tree = { .nodes = &n, .own[LC_LIGHT_SPOT].node = &s };
    lc_kernels_scalar.shade.bounds(&tree, &index, 1, LC_LIGHT_SPOT, point, ub);
    return ub[0];
}

lc_f3 one_transfer(const lc_point *p, lc_light_kind kind, const lc_light_rec *light, const float *atten)
{
    return lc_estimate_one(&lc_kernels_scalar.shade, p, kind, light, atten);
}

lc_f3 one_virtual_transfer(const lc_point *p, const lc_light_rec *light, const float atten[3],
                           const lc_shine *shine)
{
    float to[6][LC_LANES];
    float *const out[6] = { to[0], to[1], to[2], to[3], to[4], to[5] };
    lc_light_rec rec = *light;
    lc_shine s = *shine;
    lc_atten a = { atten[0], atten[1], atten[2], 0 };
    const lc_tree_data tree = { .lights = &rec, .light_atten = &a, .light_shine = &s };
    lc_kernels_scalar.shade.estimate(&tree, 0, NULL, 1, LC_LIGHT_VIRTUAL, p, out);
    return lc_f3_make(to[0][0], to[1][0], to[2][0]);
}

lc_f3 one_spot_transfer(const lc_point *p, const lc_light_rec *light, const lc_spot_rec *spot,
                        const lc_spot_map *spot_maps)
{
    float to[6][LC_LANES];
    float *const out[6] = { to[0], to[1], to[2], to[3], to[4], to[5] };
    lc_light_rec rec = *light;
    lc_spot_rec s = *spot;
    const lc_tree_data tree = { .lights = &rec, .own[LC_LIGHT_SPOT].light = &s, .spot_maps = spot_maps };
    lc_kernels_scalar.shade.estimate(&tree, 0, NULL, 1, LC_LIGHT_SPOT, p, out);
    return lc_f3_make(to[0][0], to[1][0], to[2][0]);
}

float one_luminaire_bound(const lc_node *node, const lc_luminaire_rec *own, const lc_profiles *profiles,
                          const lc_point *point)
{
    const uint32_t index = 0;
    float ub[LC_LANES];
    lc_node n = *node;
    lc_luminaire_rec r = *own;
    const lc_tree_data tree = { .nodes = &n, .own[LC_LIGHT_LUMINAIRE].node = &r, .profiles = profiles };
    lc_kernels_scalar.shade.bounds(&tree, &index, 1, LC_LIGHT_LUMINAIRE, point, ub);
    return ub[0];
}

lc_f3 one_luminaire_transfer(const lc_point *p, const lc_light_rec *light, const lc_luminaire_rec *own,
                             const lc_profiles *profiles)
{
    float to[6][LC_LANES];
    float *const out[6] = { to[0], to[1], to[2], to[3], to[4], to[5] };
    lc_light_rec rec = *light;
    lc_luminaire_rec r = *own;
    const lc_tree_data tree = { .lights = &rec, .own[LC_LIGHT_LUMINAIRE].light = &r, .profiles = profiles };
    lc_kernels_scalar.shade.estimate(&tree, 0, NULL, 1, LC_LIGHT_LUMINAIRE, p, out);
    return lc_f3_make(to[0][0], to[1][0], to[2][0]);
}
