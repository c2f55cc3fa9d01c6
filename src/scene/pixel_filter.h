/* pixel_filter.h - pbrt's pixel filters, importance sampled ([Ernst06], as in pbrt-v4).
 *
 * Samples are drawn with a density proportional to |f|, so that all have the weight 1 or -1 and no sample
 * contributes to a second pixel. Every filter is a product of a function of x and a function of y.
 */
#ifndef LC_PIXEL_FILTER_H
#define LC_PIXEL_FILTER_H

#include "base/base.h"

typedef enum lc_pixel_filter_kind {
    LC_PIXEL_BOX,
    LC_PIXEL_TRIANGLE,
    LC_PIXEL_GAUSSIAN,
    LC_PIXEL_MITCHELL,
    LC_PIXEL_SINC
} lc_pixel_filter_kind;

typedef struct lc_pixel_filter_desc {
    lc_pixel_filter_kind kind;
    double radius[2]; /* pixels along x and y, LC_MIN_RADIUS..LC_MAX_RADIUS */
    double shape[2];  /* gaussian: alpha of f = e^(-alpha x^2) - e^(-alpha r^2); mitchell: B, C; sinc: tau of
                       * the Lanczos window; otherwise 0 */
} lc_pixel_filter_desc;

#define LC_PIXEL_FILTER_BOX { .kind = LC_PIXEL_BOX, .radius = { 0.5, 0.5 } }
#define LC_MIN_RADIUS 1e-3        /* pixels */
#define LC_MAX_RADIUS 64.0        /* pixels */
#define LC_PIXEL_FILTER_CELLS 128 /* of the table along an axis; f is taken as constant within a cell */

typedef struct lc_pixel_filter_axis {
    double radius;                         /* pixels */
    double cdf[LC_PIXEL_FILTER_CELLS + 1]; /* of |f|, from 0 to 1 over -radius .. radius */
    bool negative[LC_PIXEL_FILTER_CELLS];  /* f < 0 in the cell */
} lc_pixel_filter_axis;

typedef struct lc_pixel_filter {
    lc_pixel_filter_axis axis[2];
} lc_pixel_filter;

/* False if a number is out of range or the filter is 0 everywhere. */
bool lc_pixel_filter_init(lc_pixel_filter *f, const lc_pixel_filter_desc *desc);
/* Maps a pair of numbers 0 <= u < 1 to an offset from the pixel's centre, in pixels, and returns the sample's
 * weight, 1 or -1. */
double lc_pixel_filter_sample(const lc_pixel_filter *f, const double u[2], double offset[2]);

#endif
