/* pixel_filter.c - the filters' values and integrals; cumulative distributions, sampled by inversion. */
#include "scene/pixel_filter.h"

#include "base/fmath.h"
#include "base/xform.h"

#include <math.h>

#define MAX_SHAPE 1e3 /* limits |shape|; pbrt's defaults are at most 3 */
#define MAX_SUM   1e6 /* limits the sum of |f| over the cells of an axis */
#define MIN_INTEGRAL                                                                                         \
    1e-3 /* limits the integral of f over that of |f|: pixels would be a small difference of large numbers   \
          */
#define MAX_OWN_DEVIATION                                                                                    \
    0.5 /* pixels: the standard deviation of pbrt-v4's default, up to which a pixel has its samples alone */
#define FEATURE_STEPS 64 /* of the midpoint rule within the smallest feature of a filter */
#define MIN_STEPS     4  /* of the midpoint rule */

/* [Mitchell88] eq. 8, nonzero for -2 < x < 2. */
static double mitchell(double x, double b, double c)
{
    x = fabs(x);
    if (x >= 2) return 0;
    if (x >= 1)
        return (((-b - 6 * c) * x + (6 * b + 30 * c)) * x + (-12 * b - 48 * c)) * x / 6 +
               (8 * b + 24 * c) / 6;
    return ((12 - 9 * b - 6 * c) * x + (-18 + 12 * b + 6 * c)) * x * x / 6 + (6 - 2 * b) / 6;
}

/* sin(pi x) / (pi x) */
static double sinc(double x)
{
    double s, c;
    lc_sincos_deg(180 * x, &s, &c);
    return fabs(x) < 1e-5 ? 1 : s / (LC_PI * x);
}

/* f(x) along one axis, not normalized. */
static double value(const lc_pixel_filter_desc *d, double radius, double x)
{
    switch (d->kind) {
    case LC_PIXEL_TRIANGLE: return radius - fabs(x);
    case LC_PIXEL_GAUSSIAN:
        return lc_exp_neg(-d->shape[0] * x * x) - lc_exp_neg(-d->shape[0] * radius * radius);
    case LC_PIXEL_MITCHELL: return mitchell(2 * x / radius, d->shape[0], d->shape[1]);
    case LC_PIXEL_SINC: return sinc(x) * sinc(x / d->shape[0]);
    case LC_PIXEL_BOX: break;
    }
    return 1;
}

/* Length in pixels within which f changes by its own size. */
static double feature(const lc_pixel_filter_desc *d, double radius)
{
    if (d->kind == LC_PIXEL_GAUSSIAN) return fmin(radius, 1 / sqrt(d->shape[0]));
    if (d->kind == LC_PIXEL_SINC) return fmin(radius, fmin(1, d->shape[0]));
    return radius;
}

double lc_pixel_filter_integral(const lc_pixel_filter_desc *d, int axis, double lo, double hi)
{
    double radius = d->radius[axis], sum = 0;
    lo = fmax(lo, -radius);
    hi = fmin(hi, radius);
    if (!(lo < hi)) return 0;
    int n = MIN_STEPS + (int)((hi - lo) * FEATURE_STEPS / feature(d, radius));
    for (int i = 0; i < n; i++) sum += value(d, radius, lo + (hi - lo) * (i + 0.5) / n);
    return sum * (hi - lo) / n;
}

static bool init_axis(lc_pixel_filter *f, const lc_pixel_filter_desc *d, int axis)
{
    lc_pixel_filter_axis *a = &f->axis[axis];
    double sum = 0, x2 = 0, radius = a->radius = d->radius[axis];
    for (int i = 0; i < LC_PIXEL_FILTER_CELLS; i++) {
        double x = ((i + 0.5) * 2 / LC_PIXEL_FILTER_CELLS - 1) * radius, v = value(d, radius, x);
        a->cdf[i] = sum;
        sum += fabs(v);
        x2 += fabs(v) * x * x;
        f->shared |= v < 0;
    }
    if (!(sum > 0 && sum < MAX_SUM)) return false;
    for (int i = 0; i < LC_PIXEL_FILTER_CELLS; i++) a->cdf[i] /= sum;
    a->cdf[LC_PIXEL_FILTER_CELLS] = 1;
    for (int i = 0, cell = 0; i < LC_PIXEL_FILTER_STARTS; i++) {
        while (a->cdf[cell + 1] * LC_PIXEL_FILTER_STARTS <= i) cell++;
        a->start[i] = (uint8_t)cell;
    }
    f->shared |= x2 > sum * MAX_OWN_DEVIATION * MAX_OWN_DEVIATION;
    double cell = 2 * radius / LC_PIXEL_FILTER_CELLS;
    return lc_pixel_filter_integral(d, axis, -radius, radius) > MIN_INTEGRAL * sum * cell;
}

bool lc_pixel_filter_init(lc_pixel_filter *f, const lc_pixel_filter_desc *d)
{
    f->shared = false;
    for (int k = 0; k < 2; k++) {
        if (!(d->radius[k] >= LC_MIN_RADIUS && d->radius[k] <= LC_MAX_RADIUS)) return false;
        if (!(fabs(d->shape[k]) <= MAX_SHAPE)) return false;
    }
    if (d->kind == LC_PIXEL_GAUSSIAN && !(d->shape[0] > 0)) return false;
    if (d->kind == LC_PIXEL_SINC && !(d->shape[0] >= LC_MIN_RADIUS)) return false;
    return init_axis(f, d, 0) && init_axis(f, d, 1);
}

static double sample_axis(const lc_pixel_filter_axis *a, double u)
{
    int cell = a->start[(int)(u * LC_PIXEL_FILTER_STARTS)];
    while (a->cdf[cell + 1] <= u) cell++;
    double within = (u - a->cdf[cell]) / (a->cdf[cell + 1] - a->cdf[cell]);
    return ((cell + within) * 2 / LC_PIXEL_FILTER_CELLS - 1) * a->radius;
}

void lc_pixel_filter_sample(const lc_pixel_filter *f, const double u[2], double offset[2])
{
    for (int k = 0; k < 2; k++) offset[k] = sample_axis(&f->axis[k], u[k]);
}
