/* vpl_radius.h - clamps virtual lights: the radius of the surface that each stands for. */
#ifndef LC_VPL_RADIUS_H
#define LC_VPL_RADIUS_H

#include "scene/light_places.h"

/* A virtual light stands for the surface around it, which is not a point for receivers nearby. A disc of
 * radius r seen along its axis contributes in proportion to 1 / (d^2 + r^2); so this sets the attenuation to
 * A = r^2, B = 0, C = 1. The light's part of the surface: a ball around it that contains LC_VPL_NEIGHBOURS
 * others, of radius d, cuts an area of pi d^2 from the surface, so that is pi d^2 / LC_VPL_NEIGHBOURS. The
 * disc has LC_VPL_DISC of it: with all of it corners would be darker, with less there would be dots in them
 * (tests/results/virtual-lights.md). Lights that face another way are on other surfaces and do not count.
 * Where there are fewer others, all of them count; without any A is 0. places: what finds the lights, to be
 * freed. LC_ERR_MEMORY. */
#define LC_VPL_NEIGHBOURS LC_MAX_NEAREST
#define LC_VPL_DISC 0.25f
lc_status lc_vpl_radii(const lc_context *ctx, lc_light *lights, size_t n, lc_light_places *places);

#endif
