/* pixel_filter.h - pbrt's pixel filters, by sampling: a pixel's samples lie where the filter is large, so
 * that all count alike and pixels stay independent of each other ([Ernst06]; what pbrt-v4 does). All are
 * products of a function of x and one of y.
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
    double radius[2];    /* pixels, of x and y, LC_MIN_RADIUS..LC_MAX_RADIUS */
    double shape[2]; /* gaussian: exponent's factor alpha, f = e^(-alpha x^2) - e^(-alpha r^2); mitchell: B,
                      * C; sinc: tau, the radius's part of the window; else 0 */
} lc_pixel_filter_desc;

#define LC_PIXEL_FILTER_BOX { .kind = LC_PIXEL_BOX, .radius = { 0.5, 0.5 } }
#define LC_MIN_RADIUS 1e-3
#define LC_MAX_RADIUS 64.0
#define LC_PIXEL_FILTER_CELLS 128

typedef struct lc_pixel_filter_axis {
    double radius;
    double cdf[LC_PIXEL_FILTER_CELLS + 1];   /* of |f|, from 0 to 1 over -radius .. radius */
    bool negative[LC_PIXEL_FILTER_CELLS];
} lc_pixel_filter_axis;

typedef struct lc_pixel_filter {
    lc_pixel_filter_axis axis[2];
} lc_pixel_filter;

/* False where numbers are out of range or the filter is 0 everywhere. */
bool lc_pixel_filter_init(lc_pixel_filter *f, const lc_pixel_filter_desc *desc);
/* Offset from the pixel's centre, pixels, of a pair of numbers 0 <= u < 1; returns the sample's weight, 1 or
 * -1. */
double lc_pixel_filter_sample(const lc_pixel_filter *f, const double u[2], double offset[2]);

#endif
