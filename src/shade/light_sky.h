/* light_sky.h - discs of the sky: light from all directions that are within a radius of one. G = 1, intensity
 * is the irradiance across the direction, W/m^2, as of directional lights. A point is lit from one direction
 * of the disc, another for each light and each lc_point.turn (light_target.h): so a piece of the sky is seen
 * whole by the pixels of a block together, where a single direction would be seen or not by all of them.
 *
 * Neighbours have turns in a row: 32 of them use each point of the disc once, so that together they shed on
 * an open surface what they would from their middles, almost without grain. Light paths start from the
 * middles.
 */
#ifndef LC_LIGHT_SKY_H
#define LC_LIGHT_SKY_H

#include "shade/light_kind.h"

#define LC_MAX_SKY_RADIUS 1.0f /* tangent of half the angle that a disc is seen under */

#endif

#ifdef LC_TABLE_PARTS

static const char *sky_check(const lc_light *light, size_t n_maps)
{
    (void)n_maps;
    const bool right = light->radius > 0 && light->radius <= LC_MAX_SKY_RADIUS;
    return right ? NULL : "the radius of the disc of the sky is out of range";
}

#define LC_LIGHT_INFO_sky \
    .name = "sky", .flux = directional_flux, .emit = directional_emit, .check = sky_check

#endif
