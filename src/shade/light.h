/* light.h - a light, of any of the kinds of light_kinds.h ([Miksik07] table in 2.2.2).
 *
 * The room shade/ knows one light and one surface point: what the light contributes there (estimate_tmpl.c),
 * and what a cluster of lights contributes at most (bounds_tmpl.c). In go materials and lights; lc_point and
 * the arrays of lc_tree_data are what its kernels read.
 *
 * A light y contributes M(x, o, y) G(x, y) V(x, y) I(y) to the radiance that leaves a point x towards the
 * viewer o ([Walter05] eq. 1), in that order:
 *
 *     material     reflectance towards o of light from y, times the cosine at the receiver
 *     geometry     the kind's emission in the direction of x, over f(d) = A + B d + C d^2 for a distance of d
 *     visibility   1, or 0 where y is occluded
 *     intensity    of the light; a cluster has the sum of its lights' intensities
 *
 * phi is the angle between lc_light.dir and the direction from the light to the point.
 */
#ifndef LC_LIGHT_H
#define LC_LIGHT_H

#include "base/vec.h"

enum {
    LC_LIGHT_FAR = 1,
    LC_LIGHT_AIMED = 2,
    LC_LIGHT_ATTENUATED = 4,
    LC_LIGHT_OWN = 8,
    LC_LIGHT_SIZED = 16,
    LC_LIGHT_BANDED = 32
}; /* traits: see light_kinds.h */

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
static inline bool lc_is_banded(lc_light_kind kind) { return lc_light_traits(kind) & LC_LIGHT_BANDED; }
static inline bool lc_is_sized(lc_light_kind kind) { return lc_light_traits(kind) & LC_LIGHT_SIZED; }
static inline bool lc_is_attenuated(lc_light_kind kind)
{
    return lc_light_traits(kind) & LC_LIGHT_ATTENUATED;
}

/* The range of accepted input. Within it no product of an estimate leaves the range of normal floats, nor
 * does a product of three differences of coordinates in a shadow ray's test: their sums stay below 48
 * LC_MAX_COORD^3. */
#define LC_MAX_COORD 1e12f      /* scene units, of vertices and lights */
#define LC_MAX_INTENSITY 1e15f
#define LC_MIN_INTENSITY 1e-18f /* a channel below this is set to 0 */
#define LC_MIN_ATTEN 1e-10f     /* of a coefficient that is not 0 */
#define LC_MAX_ATTEN 1e4f
/* Greatest A beside a C of 1, the least being LC_MIN_D2: the range of d^2. */
#define LC_MAX_SOFTENING 1e24f
#define LC_MIN_D2 1e-24f        /* least distance floor, scene units^2 */
#define LC_MAX_GROUPS 64        /* of lights, those of no group included: scene/groups.h */

/* The profile of a spot: emission is 0 where cos phi <= cos_total, 1 where cos phi >= cos_start. With cosines
 * below -1 it emits in all directions. */
typedef struct lc_spot {
    float cos_total, cos_start; /* -2..1, cos_total <= cos_start */
    uint32_t map;               /* 1 + index; 0: none */
} lc_spot;

/* A photometric table and how it is turned about the light's direction; see light_luminaire.h. */
typedef struct lc_luminaire {
    uint32_t zero[2]; /* the direction of azimuth 0, packed (dir_pack.h) */
    uint32_t profile; /* index, and LC_PROFILE_MIRRORED */
} lc_luminaire;

#define LC_NEXT_TURN 13u /* points of light_target.h from one lc_light.turn to the next */
#define LC_BALL_DEPTH 5  /* times that a ball may be divided by four */

/* How a virtual light shines that stands for what a lobe reflects: light_virtual.h. */
typedef struct lc_shine {
    uint32_t from[2]; /* direction to where the light that it reflects comes from, packed (dir_pack.h) */
    float roughness;  /* of the lobe; 0: there is none, and it shines by the cosine alone */
    float scale;      /* such that the lobe is at most 1 */
} lc_shine;

#define LC_SHINE_COS 0x1p-7f /* least cosine between `from` and the light's direction */

typedef struct lc_light {
    lc_f3 pos;       /* world space; unused where the kind is far */
    lc_f3 dir;       /* unit, the direction in which light travels; unused by point lights */
    lc_f3 intensity; /* >= 0 */
    union {
        struct {
            float atten[3]; /* kinds with LC_LIGHT_ATTENUATED: A, B, C, all >= 0, one > 0; 0, 0, 1 is 1/d^2 */
            lc_shine shine; /* virtual lights */
        };
        lc_spot spot;   /* spots */
        lc_luminaire luminaire;
        struct {
            float radius;   /* kinds with LC_LIGHT_SIZED, > 0: scene units; sky: a tangent */
            uint32_t turn;  /* of the sky: light_sky.h */
            uint32_t depth; /* of a ball: it is one of 4^depth lights in one place; at most LC_BALL_DEPTH */
            uint32_t part;  /* which; a digit to the base of 4 each division, the first one lowest */
        };
    };
    lc_light_kind kind;
    uint32_t group; /* below LC_MAX_GROUPS; 0: of none */
} lc_light;

static inline bool lc_has_shine(const lc_light *light)
{
    return light->kind == LC_LIGHT_VIRTUAL && light->shine.roughness > 0;
}

#endif
