/* vpl_deviation.h - how far blocks of the picture are from what endlessly many virtual lights would make. */
#ifndef LC_VPL_DEVIATION_H
#define LC_VPL_DEVIATION_H

#include "prepare/view_blocks.h"
#include "shade/tree_data.h"

typedef struct lc_vpl_deviation {
    lc_view_blocks blocks;
    lc_point *points; /* of these, as the latest virtual lights see them */
    double *direct;   /* of blocks: luminance by the lights that the scene has already */
} lc_vpl_deviation;

/* Finds the points of blocks, and their light by all lights of the scene. LC_ERR_MEMORY, after which it must
 * be freed, too. */
lc_status lc_vpl_deviation_init(lc_vpl_deviation *d, const lc_scene *scene, uint32_t max_depth,
                                uint64_t seed);
void lc_vpl_deviation_free(lc_vpl_deviation *d);

/* Sets out->median and out->high for virtual lights made along n_paths independent paths, and out->loss if
 * these are at most `enough`, of which out->high is allowed LC_INDIRECT_HIGH times. path: of each light,
 * rising. Intensities are not divided by the number of paths.
 *
 * Path i contributes X_i to a block, so the variance of their sum is sum X_i^2 - (sum X_i)^2 / n_paths.
 * What rays gather within the reach of a point, which hardly depends on the lights, does not count, neither
 * in what a block is off by nor in its light. Shadow rays are traced to paths drawn by X_i and by X_i^2
 * without shadows. What a block is off by is taken as normally distributed, and the percentiles are those of
 * all blocks' together. LC_ERR_MEMORY. */
lc_status lc_vpl_deviation_find(lc_vpl_deviation *d, const lc_light *lights, const uint32_t *path,
                                size_t n, uint64_t n_paths, double enough, lc_indirect *out);

#endif
