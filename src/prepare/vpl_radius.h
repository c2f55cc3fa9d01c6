/* vpl_radius.h - clamps virtual lights: the radius of the surface that each stands for. */
#ifndef LC_VPL_RADIUS_H
#define LC_VPL_RADIUS_H

#include "scene/light_places.h"

/* A virtual light stands for the surface around it, which is not a point for receivers nearby. A disc of
 * radius r seen along its axis contributes in proportion to 1 / (d^2 + r^2); so this sets the attenuation to
 * A = r^2, B = 0, C = 1. The light's share of the surface: a ball around it that contains lights of
 * LC_VPL_NEIGHBOURS other paths, of radius d, cuts an area of pi d^2 from the surface, so that is pi d^2 /
 * LC_VPL_NEIGHBOURS. One path leaves several lights in a narrow gap, which say nothing about each other.
 *
 * The disc has LC_VPL_DISC of the share: lights within a reach shed nothing (scene/near_bounce.h), so none is
 * seen as a dot, and larger discs would make corners darker. Measured: tests/results/virtual-lights.md.
 *
 * Lights whose surfaces face another way are on others and do not count. Where there are fewer others, all of
 * them count; without any A is 0. path: of each light, in rising order. places: what finds the lights, to be
 * freed. LC_ERR_MEMORY. */
#define LC_VPL_NEIGHBOURS LC_MAX_NEAREST
lc_status lc_vpl_radii(const lc_context *ctx, lc_light *lights, const uint32_t *path, size_t n,
                       lc_light_places *places);

#endif
