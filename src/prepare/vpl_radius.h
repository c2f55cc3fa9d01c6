/* vpl_radius.h - how near virtual lights may shine. */
#ifndef LC_VPL_RADIUS_H
#define LC_VPL_RADIUS_H

#include "base/context.h"
#include "shade/light.h"

/* A virtual light stands for the surface around it, which near by is no point: a disc of radius r, seen along
 * its axis, gives 1 / (d^2 + r^2). Sets attenuation r^2, 0, 1 with the disc that is the light's share of the
 * surface: the ball that reaches its LC_VPL_NEIGHBOURS nearest others, of radius d, cuts a surface of pi d^2,
 * so r^2 = d^2 / LC_VPL_NEIGHBOURS. */
#define LC_VPL_NEIGHBOURS 8
lc_status lc_vpl_radii(const lc_context *ctx, lc_light *lights, size_t n);

#endif
