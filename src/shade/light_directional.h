/* light_directional.h - lights at infinity: G = 1, intensity is the irradiance across the direction, W/m^2.
 */
#ifndef LC_LIGHT_DIRECTIONAL_H
#define LC_LIGHT_DIRECTIONAL_H

#include "shade/light_kind.h"

#endif

#ifdef LC_TABLE_PARTS

static double directional_flux(const lc_light *light, double radius)
{
    (void)light;
    return LC_PI * radius * radius;
}

/* From a disc across the direction, as wide as the ball around the scene and just before it. */
static void directional_emit(const lc_light *light, const lc_emit_from *from, lc_emitted *out)
{
    double x, y;
    lc_sample_disc(from->u, &x, &y);
    lc_f3 across = lc_sample_frame(light->dir, x, y, -1); /* of length sqrt(1 + u[0]) */
    double scale = from->radius * sqrt(1 + from->u[0]);
    out->dir = light->dir;
    out->weight = 1;
    out->colour = lc_f3_make(1, 1, 1);
    out->org = lc_f3_make((float)(from->centre[0] + scale * (double)across.x),
                          (float)(from->centre[1] + scale * (double)across.y),
                          (float)(from->centre[2] + scale * (double)across.z));
}

#define LC_LIGHT_INFO_directional .name = "directional", .flux = directional_flux, .emit = directional_emit

#endif
