/* light_ball.h - spheres that emit the same radiance L everywhere: G = 1 / d^2 from the centre, intensity
 * pi r^2 L in W/sr. That is what a sphere wholly above the horizon gives a diffuse surface exactly, at any
 * distance. Shadow rays go to points of its surface (light_target.h). A ball that gives much of the light
 * of a place is several of them in one spot.
 */
#ifndef LC_LIGHT_BALL_H
#define LC_LIGHT_BALL_H

#include "shade/light_kind.h"

#endif

#ifdef LC_TABLE_PARTS

static const char *ball_check(const lc_light *light, size_t n_maps)
{
    (void)n_maps;
    return light->radius > 0 && light->radius <= LC_MAX_COORD ? NULL : "the ball's radius is out of range";
}

static double ball_flux(const lc_light *light, double radius)
{
    (void)light;
    (void)radius;
    return 4 * LC_PI;
}

/* From where the ray's line through the centre leaves the ball. */
static void ball_emit(const lc_light *light, const lc_emit_from *from, lc_emitted *out)
{
    point_emit(light, from, out);
    out->org = lc_f3_add(out->org, lc_f3_scale(out->dir, light->radius));
}

#define LC_LIGHT_INFO_ball .name = "ball", .flux = ball_flux, .emit = ball_emit, .check = ball_check

#endif
