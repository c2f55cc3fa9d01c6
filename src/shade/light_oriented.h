/* light_oriented.h - lights that emit from a point by the cosine about their direction, as a small piece of a
 * diffuse surface does: G = max(cos phi, 0) / f(d), intensity in W/sr along dir. */
#ifndef LC_LIGHT_ORIENTED_H
#define LC_LIGHT_ORIENTED_H

#include "shade/light_kind.h"

#endif

#ifdef LC_TABLE_PARTS

static double oriented_flux(const lc_light *light, double radius)
{
    (void)light;
    (void)radius;
    return LC_PI;
}

static void oriented_emit(const lc_light *light, const lc_emit_from *from, lc_emitted *out)
{
    double x, y;
    lc_sample_disc(from->u, &x, &y);
    out->dir = lc_sample_frame(light->dir, x, y, sqrt(1 - from->u[0]));
    out->weight = 1;
    out->colour = lc_f3_make(1, 1, 1);
    out->org = lc_emit_clear(light, light->dir);
}

#define LC_LIGHT_INFO_oriented .name = "oriented", .flux = oriented_flux, .emit = oriented_emit

#endif

#ifdef LC_KERNEL_PARTS

LC_INLINE vf oriented_emission(const lc_tree_data *t, const float *const *light, vf cos_phi, const vf d[3],
                               vf tint[3])
{
    (void)t;
    (void)light;
    (void)d;
    (void)tint;
    return cos_phi;
}

LC_INLINE vf oriented_emission_bound(const lc_tree_data *t, const uint32_t *node, const rel_box *box, vf e,
                                     vf least)
{
    (void)box;
    (void)t;
    (void)least;
    (void)node;
    return e;
}

LC_INLINE vf oriented_emission_least(const lc_tree_data *t, vf e)
{
    (void)t;
    return e;
}

#endif
