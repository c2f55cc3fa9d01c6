/* light_places.h - finds the lights nearest to a point, among those on surfaces that face the same way. */
#ifndef LC_LIGHT_PLACES_H
#define LC_LIGHT_PLACES_H

#include "base/context.h"
#include "shade/light.h"

#include <math.h>

#define LC_SAME_WAY 0.5f /* cosine between directions */
#define LC_MAX_NEAREST 8

typedef struct lc_light_place {
    float pos[3], n[3];            /* n: the normal of its surface, where it may shine another way */
    uint32_t light : 30, axis : 2; /* axis: on which the range is divided here */
} lc_light_place;

typedef struct lc_light_places {
    const lc_light *lights;
    lc_light_place *places; /* n */
    size_t n;
} lc_light_places;

/* A virtual light shines as a disc, whose area is this part of its share, the surface that it stands for
 * (prepare/vpl_radius.h). */
#define LC_VPL_DISC 0.04f

/* The lights must outlive the places; at most 2^30. They shine along the normals of their surfaces.
 * LC_ERR_MEMORY. */
lc_status lc_light_places_init(lc_light_places *places, const lc_context *ctx, const lc_light *lights,
                               size_t n);
void lc_light_places_free(lc_light_places *places, const lc_context *ctx);

typedef struct lc_nearest_lights {
    lc_f3 pos, n;      /* n: unit */
    bool any_way;      /* lights on all surfaces count */
    uint32_t self;     /* a light that does not count, or LC_NONE */
    uint32_t n_wanted; /* 1..LC_MAX_NEAREST */
    const uint32_t *path; /* of each light: of each path the nearest counts, and none of that of `self` */
    /* Found: squared distances and places, the farthest first; from n_wanted - n on where there are n. */
    float d2[LC_MAX_NEAREST];
    const lc_light_place *place[LC_MAX_NEAREST];
} lc_nearest_lights;

/* Returns the number of lights found. */
uint32_t lc_light_places_find(const lc_light_places *places, lc_nearest_lights *query);

#endif
