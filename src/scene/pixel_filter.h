/* pixel_filter.h - pbrt's pixel filters. Every filter is a product of a function of x and a function of y.
 *
 * A filter without negative values and no wider than pbrt-v4's default is importance sampled ([Ernst06], as
 * in pbrt-v4): samples are drawn with a density proportional to f, all have the same weight, and none
 * contributes to a second pixel. With any other filter neighbouring pixels share samples (filter_share.h).
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
#define LC_MAX_RADIUS 64          /* pixels */
#define LC_PIXEL_FILTER_CELLS 128 /* of the table along an axis; f is taken as constant within a cell */
#define LC_PIXEL_FILTER_STARTS 256 /* equal parts of 0 <= u < 1, of which the first cells are known */

typedef struct lc_pixel_filter_axis {
    double radius;                         /* pixels */
    double cdf[LC_PIXEL_FILTER_CELLS + 1]; /* of |f|, from 0 to 1 over -radius .. radius */
    uint8_t start[LC_PIXEL_FILTER_STARTS]; /* the cell of the least u of each part: cdf[cell] <= u */
} lc_pixel_filter_axis;

typedef struct lc_pixel_filter {
    bool shared; /* samples are shared; the tables are not used */
    lc_pixel_filter_axis axis[2];
} lc_pixel_filter;

/* False if a number is out of range or the filter's integral is not positive. */
bool lc_pixel_filter_init(lc_pixel_filter *f, const lc_pixel_filter_desc *desc);
/* Maps a pair of numbers 0 <= u < 1 to an offset from the pixel's centre, in pixels; not for shared samples.
 */
void lc_pixel_filter_sample(const lc_pixel_filter *f, const double u[2], double offset[2]);
/* The integral of f along axis 0 or 1 from lo to hi, distances from the pixel's centre in pixels. Relative
 * error below 1e-3 of the filter's features, of smooth parts far less. */
double lc_pixel_filter_integral(const lc_pixel_filter_desc *desc, int axis, double lo, double hi);

#endif
