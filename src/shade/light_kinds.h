/* light_kinds.h - the kinds of light, a line each. No guard: it is included wherever something is needed for
 * each of them.
 *
 *     KIND(ID, name, traits)         shade/light_NAME.h is its home: all that is particular to the kind
 *     AIMED_KIND(ID, name, traits)   the same of lights that emit in directions about lc_light.dir, which
 *                                    adds LC_LIGHT_AIMED; where it is not defined, KIND stands for both
 *
 *     LC_LIGHT_FAR         at infinity: the unit direction towards it takes the place of its position
 *     LC_LIGHT_AIMED       a cluster of them has a cone, and the kernels ask the home for emissions
 *     LC_LIGHT_ATTENUATED  falls off by lc_light.atten; other lights that are not far fall off by 1/d^2
 *     LC_LIGHT_SIZED       has lc_light.radius; shadow rays go to points of it, by light_target.h
 *     LC_LIGHT_BANDED      the bound of its emission asks for the least cosine of directions, too
 *     LC_LIGHT_OWN         each light and each node has a record of the kind's own in lc_tree_data.own
 */
#ifdef KIND
#ifndef AIMED_KIND
#define AIMED_KIND(ID, name, traits) KIND(ID, name, LC_LIGHT_AIMED | (traits))
#endif
KIND(POINT, point, LC_LIGHT_ATTENUATED)
AIMED_KIND(ORIENTED, oriented, LC_LIGHT_ATTENUATED)
KIND(DIRECTIONAL, directional, LC_LIGHT_FAR)
AIMED_KIND(SPOT, spot, LC_LIGHT_OWN)
AIMED_KIND(VIRTUAL, virtual, LC_LIGHT_ATTENUATED)
KIND(BALL, ball, LC_LIGHT_SIZED)
KIND(SKY, sky, LC_LIGHT_FAR | LC_LIGHT_SIZED)
AIMED_KIND(LUMINAIRE, luminaire, LC_LIGHT_OWN | LC_LIGHT_BANDED)
#undef AIMED_KIND
#else
#include "shade/light_directional.h"
#include "shade/light_luminaire.h"
#include "shade/light_oriented.h"
#include "shade/light_point.h"
#include "shade/light_spot.h"
#include "shade/light_virtual.h"

#include "shade/light_ball.h" /* after light_point.h, which it uses */
#include "shade/light_sky.h"  /* after light_directional.h */
#endif
