/* sky_deviation.h - how far blocks of the picture are off because a disc stands for each part of an
 * environment map, relative to the light that they get from all maps.
 */
#ifndef LC_SKY_DEVIATION_H
#define LC_SKY_DEVIATION_H

#include "prepare/view_blocks.h"

typedef struct lc_sky_deviation {
    lc_view_blocks blocks;
    /* Of blocks, by the maps so far: luminance, the variance of its error if discs' errors are independent,
     * and what their products add; the variance of a pixel of one sample by the choice of directions. */
    double *light, *variance, *cross, *grain;
} lc_sky_deviation;

/* A map's lights, and the directions of the parts of the map that they stand for. */
typedef struct lc_sky_parts {
    const lc_light *lights; /* n of them, of kind LC_LIGHT_SKY */
    uint32_t n;
    /* Sets to[] to the unit vector, world space, to a place in part i that is chosen with a density in
     * proportion to power by u, both 0..1. Threads call it at the same time. */
    void (*direction)(const void *map, uint32_t i, const double u[2], float to[3]);
    const void *map;
} lc_sky_parts;

/* Finds points of the picture; LC_ERR_MEMORY, after which it must be freed, too. */
lc_status lc_sky_deviation_init(lc_sky_deviation *d, const lc_scene *scene, uint32_t max_depth,
                                uint64_t seed);
void lc_sky_deviation_free(lc_sky_deviation *d);
/* Adds a map. LC_ERR_MEMORY. */
lc_status lc_sky_deviation_add(lc_sky_deviation *d, const lc_sky_parts *parts);
/* Sets the figures, of the blocks that get light; variances are no more after it. */
void lc_sky_deviation_find(lc_sky_deviation *d, lc_sky_error *out);

#endif
