/* light_places.h - finds the lights nearest to a point, among those on surfaces that face the same way. */
#ifndef LC_LIGHT_PLACES_H
#define LC_LIGHT_PLACES_H

#include "base/context.h"
#include "shade/light.h"

#include <math.h>

#define LC_SAME_WAY 0.5f /* cosine between directions */
#define LC_MAX_NEAREST 8

typedef struct lc_light_place {
    float pos[3];
    uint32_t light : 30, axis : 2; /* axis: on which the range is divided here */
} lc_light_place;

typedef struct lc_light_places {
    const lc_light *lights;
    lc_light_place *places; /* n */
    size_t n;
    float sparse; /* share over pi, above which virtual lights are sparse */
} lc_light_places;

/* A virtual light shines as a disc, whose area is a part of its share, the surface that it stands for
 * (prepare/vpl_radius.h): usually LC_VPL_DISC of it; of sparse lights more, up to LC_VPL_MOST_DISC. */
#define LC_VPL_DISC 0.25f
#define LC_VPL_MOST_DISC 4.0f
/* That part, of a share over pi. */
static inline float lc_virtual_disc(const lc_light_places *places, float share)
{
    const float more = share > places->sparse ? share / places->sparse : 1;
    return more < LC_VPL_MOST_DISC / LC_VPL_DISC ? LC_VPL_DISC * more : LC_VPL_MOST_DISC;
}

/* The inverse: the share of a disc, both over pi. */
static inline float lc_virtual_share(const lc_light_places *places, float disc)
{
    if (!(disc > LC_VPL_DISC * places->sparse)) return disc / LC_VPL_DISC;
    const float grown = sqrtf(disc * (places->sparse / LC_VPL_DISC)), most = disc / LC_VPL_MOST_DISC;
    return grown > most ? grown : most;
}

/* The lights must outlive the places; at most 2^30. LC_ERR_MEMORY. */
lc_status lc_light_places_init(lc_light_places *places, const lc_context *ctx, const lc_light *lights,
                               size_t n);
void lc_light_places_free(lc_light_places *places, const lc_context *ctx);

typedef struct lc_nearest_lights {
    lc_f3 pos, n;      /* n: unit */
    bool any_way;      /* lights on all surfaces count */
    uint32_t self;     /* a light that does not count, or LC_NONE */
    uint32_t n_wanted; /* 1..LC_MAX_NEAREST */
    const uint32_t *path; /* of each light: of each path the nearest counts, and none of that of `self` */
    /* Found: squared distances and numbers, the farthest first; from n_wanted - n on where there are n. */
    float d2[LC_MAX_NEAREST];
    uint32_t light[LC_MAX_NEAREST];
    const lc_light *lights;
} lc_nearest_lights;

/* Returns the number of lights found. */
uint32_t lc_light_places_find(const lc_light_places *places, lc_nearest_lights *query);

/* Calls meet for each light within a squared distance of pos, on surfaces that face the way of n; the order
 * depends on the places alone. */
typedef struct lc_lights_within {
    lc_f3 pos, n; /* n: unit */
    float d2;
    void (*meet)(void *user, const lc_light *light);
    void *user;
} lc_lights_within;
void lc_light_places_within(const lc_light_places *places, const lc_lights_within *query);

#endif
