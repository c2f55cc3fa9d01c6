/* light.h - the four kinds of light and their geometric terms ([Miksik07] table in 2.2.2).
 *
 *     kind         G                              intensity is
 *     point        1 / f(d)                       W/sr
 *     oriented     max(cos phi, 0) / f(d)         W/sr along dir
 *     directional  1                              W/m^2 across the direction
 *     spot         emission (spot.h) / d^2        W/sr at most
 *
 * f(d) = A + B d + C d^2; phi between dir and the direction from the light to the point.
 */
#ifndef LC_LIGHT_H
#define LC_LIGHT_H

#include "shade/spot.h"

typedef enum lc_light_kind {
    LC_LIGHT_POINT = 0,
    LC_LIGHT_ORIENTED = 1,
    LC_LIGHT_DIRECTIONAL = 2,
    LC_LIGHT_SPOT = 3
} lc_light_kind;
#define LC_LIGHT_KINDS 4

/* Lights that have a position and shine in directions about one. */
static inline bool lc_is_aimed(lc_light_kind kind)
{
    return kind == LC_LIGHT_ORIENTED || kind == LC_LIGHT_SPOT;
}

/* What is accepted, so that no product of an estimate leaves the range of normal floats, nor one of three
 * differences of coordinates in a shadow ray's test: sums of these stay below 48 LC_MAX_COORD^3. */
#define LC_MAX_COORD 1e12f     /* scene units, of vertices and lights */
#define LC_MAX_INTENSITY 1e15f
#define LC_MIN_INTENSITY 1e-18f /* a channel below this is set to 0 */
#define LC_MIN_ATTEN 1e-10f    /* of a coefficient that is not 0 */
#define LC_MAX_ATTEN 1e4f
/* A beside a C of 1 may be anything from LC_MIN_D2 to this: no more than d^2 may be. */
#define LC_MAX_SOFTENING 1e24f
#define LC_MIN_D2 1e-24f       /* the distance floor's own floor */

typedef struct lc_light {
    lc_f3 pos;       /* world space; unused by directional lights */
    lc_f3 dir;       /* unit, the way light travels; unused by point lights */
    lc_f3 intensity; /* >= 0 */
    union {
        float atten[3]; /* all but spots: A, B, C, all >= 0, one of them > 0; (0, 0, 1) = inverse square */
        lc_spot spot;   /* spots, which always fall off with the inverse square */
    };
    lc_light_kind kind;
} lc_light;

#endif
