/* light_point.h - lights that emit from a point equally in all directions: G = 1 / f(d), intensity in W/sr.
 */
#ifndef LC_LIGHT_POINT_H
#define LC_LIGHT_POINT_H

#include "shade/light_kind.h"

#endif

#ifdef LC_TABLE_PARTS

static double point_flux(const lc_light *light, double radius)
{
    (void)light;
    (void)radius;
    return 4 * LC_PI;
}

static void point_emit(const lc_light *light, const lc_emit_from *from, lc_emitted *out)
{
    double z = 1 - 2 * from->u[0], sine, cosine, r = sqrt(fmax(1 - z * z, 0));
    lc_sincos_deg(360 * from->u[1], &sine, &cosine);
    out->dir = lc_f3_normalize_d(r * cosine, r * sine, z);
    out->weight = 1;
    out->colour = lc_f3_make(1, 1, 1);
    out->org = lc_emit_clear(light, out->dir);
}

#define LC_LIGHT_INFO_point .name = "point", .flux = point_flux, .emit = point_emit

#endif
