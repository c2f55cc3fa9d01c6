/* view_blocks.h - blocks of 8x8 pixels, spread over the whole film, at whose points lights that were made are
 * compared with what they stand for.
 */
#ifndef LC_VIEW_BLOCKS_H
#define LC_VIEW_BLOCKS_H

#include "scene/sight.h"

#define LC_BLOCK_POINTS 4 /* pixels of a block that are looked at */

typedef struct lc_view_blocks {
    const lc_scene *scene;
    uint64_t seed;
    uint32_t side, n, max_depth; /* side: blocks of a row or column of a view */
    lc_lit *lit;   /* n * LC_BLOCK_POINTS: what is seen first that is lit */
    float *weight; /* luminance of the picture for theirs, over LC_BLOCK_POINTS; 0: nothing to light */
} lc_view_blocks;

/* Finds the points of side * side blocks, or of lc_view_side(side)^2 for each of several views. max_depth: of
 * camera rays. LC_ERR_MEMORY, after which it must be freed, too. */
lc_status lc_view_blocks_init(lc_view_blocks *b, const lc_scene *scene, uint32_t side, uint32_t max_depth,
                              uint64_t seed);
void lc_view_blocks_free(lc_view_blocks *b);

/* The value below which this share of |x_i| lies, for normal x_i of the given deviations, i < n. */
double lc_normal_percentile(const double *deviation, uint32_t n, double share);

#endif
