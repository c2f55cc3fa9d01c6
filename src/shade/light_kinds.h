/* light_kinds.h - the kinds of light, a line each. No guard: it is included wherever something is wanted of
 * all.
 *
 *     KIND(ID, name, traits)    shade/light_NAME.h is its home: all that the kind is stands there
 *
 *     LC_LIGHT_FAR         at infinity: what counts as its position is the unit direction towards it
 *     LC_LIGHT_AIMED       shines in directions about lc_light.dir; clusters of them have a cone
 *     LC_LIGHT_ATTENUATED  falls off by lc_light.atten; others that are not far by 1/d^2
 *     LC_LIGHT_OWN         has records of its own, a light and a node, in lc_tree_data.own
 */
#ifdef KIND
KIND(POINT, point, LC_LIGHT_ATTENUATED)
KIND(ORIENTED, oriented, LC_LIGHT_AIMED | LC_LIGHT_ATTENUATED)
KIND(DIRECTIONAL, directional, LC_LIGHT_FAR)
KIND(SPOT, spot, LC_LIGHT_AIMED | LC_LIGHT_OWN)
#else
#include "shade/light_directional.h"
#include "shade/light_oriented.h"
#include "shade/light_point.h"
#include "shade/light_spot.h"
#endif
