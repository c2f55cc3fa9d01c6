/* filter_share.h - samples that neighbouring pixels share, with weights that add up to 1 in every pixel.
 *
 *     a pixel            All pixels have their samples at the same places. Across, a pixel is n strips of
 *     +---+---+---+      equal width, down also; a sample is in the middle of a strip each way. The weight
 *     | x |   |   |      that a sample has in a pixel d to its right is the integral of the filter over the
 *     +---+---+---+      sample's strip, seen from that pixel's centre, times that down. So sums of weights
 *     |   |   | x |      are integrals of the filter: a step edge along an axis overshoots no more than with
 *     +---+---+---+      the filter itself, whatever the number of samples.
 *     |   | x |   |
 *     +---+---+---+
 *
 * Up to LC_MAX_LATTICE samples, n strips each way hold one sample each, in the order of the golden ratio's
 * multiples. For that each sample's weights in all pixels must add up to about 1 / n; they are made to, but
 * for rounding. For filters so narrow that they do not, and for more samples, the samples make a grid.
 */
#ifndef LC_FILTER_SHARE_H
#define LC_FILTER_SHARE_H

#include "scene/pixel_filter.h"

#define LC_MAX_LATTICE 64  /* samples */
#define LC_MAX_STRIPS  256 /* of an axis */

typedef struct lc_share_axis {
    uint32_t n_strips;
    uint32_t reach;                                      /* pixels: the largest |d| of a weight */
    double half;                                         /* pixels: the strips are those of -half .. half */
    double weight[LC_MAX_STRIPS][2 * LC_MAX_RADIUS + 1]; /* [strip][d + reach] */
} lc_share_axis;

typedef struct lc_filter_share {
    uint32_t n;                  /* samples of a pixel, at most as many as were asked for */
    bool lattice;                /* not a grid */
    uint8_t row[LC_MAX_LATTICE]; /* strip down of the sample in strip i across */
    lc_share_axis axis[2];
} lc_filter_share;

/* desc: one that lc_pixel_filter_init takes; n > 0. */
void lc_filter_share_init(lc_filter_share *share, const lc_pixel_filter_desc *desc, uint32_t n);
/* Sample i's strips across and down. */
void lc_filter_share_strips(const lc_filter_share *share, uint32_t i, uint32_t strip[2]);
/* Where sample i is, from its pixel's centre, in pixels. */
void lc_filter_share_offset(const lc_filter_share *share, uint32_t i, double offset[2]);

/* The factor along an axis of the weight that a sample of this strip has in the pixel d further on. */
static inline double lc_share_weight(const lc_share_axis *a, uint32_t strip, int64_t d)
{
    const int64_t reach = a->reach;
    return d < -reach || d > reach ? 0 : a->weight[strip][d + reach];
}

#endif
