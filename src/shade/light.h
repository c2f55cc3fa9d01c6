/* light.h - a light, of any of the kinds of light_kinds.h ([Miksik07] table in 2.2.2).
 *
 * Its contribution at a point is M G V I ([Walter05] 3): material, geometry, visibility, intensity. G is the
 * kind's emission in the point's direction over f(d) = A + B d + C d^2; phi is the angle between dir and the
 * direction from the light to the point.
 */
#ifndef LC_LIGHT_H
#define LC_LIGHT_H

#include "base/vec.h"

enum {
    LC_LIGHT_FAR = 1,
    LC_LIGHT_AIMED = 2,
    LC_LIGHT_ATTENUATED = 4,
    LC_LIGHT_OWN = 8
}; /* see light_kinds.h */

typedef enum lc_light_kind {
#define KIND(ID, name, traits) LC_LIGHT_##ID,
#include "shade/light_kinds.h"
#undef KIND
    LC_LIGHT_KINDS
} lc_light_kind;

static inline int lc_light_traits(lc_light_kind kind)
{
    switch (kind) {
#define KIND(ID, name, traits) \
    case LC_LIGHT_##ID: return traits;
#include "shade/light_kinds.h"
#undef KIND
    default: return 0;
    }
}

static inline bool lc_is_far(lc_light_kind kind) { return lc_light_traits(kind) & LC_LIGHT_FAR; }
static inline bool lc_is_aimed(lc_light_kind kind) { return lc_light_traits(kind) & LC_LIGHT_AIMED; }
static inline bool lc_is_attenuated(lc_light_kind kind)
{
    return lc_light_traits(kind) & LC_LIGHT_ATTENUATED;
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

/* How a spot shines. Anything below -1 shines everywhere. */
typedef struct lc_spot {
    float cos_total,
        cos_start; /* -2..1, rising: emission is 0 at and below the first, 1 from the second on */
    uint32_t map;               /* 1 + index; 0: none */
} lc_spot;

typedef struct lc_light {
    lc_f3 pos;       /* world space; unused where the kind is far */
    lc_f3 dir;       /* unit, the way light travels; unused by point lights */
    lc_f3 intensity; /* >= 0 */
    union {
        float atten[3]; /* A, B, C of kinds that are attenuated, all >= 0, one of them > 0; (0, 0, 1) =
                           inverse square */
        lc_spot spot;   /* of spots */
    };
    lc_light_kind kind;
} lc_light;

#endif
