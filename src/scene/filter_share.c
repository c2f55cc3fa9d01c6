/* filter_share.c - strips, their integrals, and the order of samples. */
#include "scene/filter_share.h"

#include <math.h>

#define GOLDEN           0.6180339887498949
#define MAX_UNEVEN       0.05 /* limits how far a strip's weights may be from 1 / n, as a fraction */
#define NEGLIGIBLE_SHARE 1e-9 /* a pixel's part of the integral of |f| that is left out */

/* Integrals over the strips, seen from pixels within the radius; returns their sum. */
static double integrate(lc_share_axis *a, const lc_pixel_filter_desc *d, int axis, uint32_t n)
{
    double sum = 0;
    a->n_strips = n;
    a->half = fmin(0.5, d->radius[axis]);
    a->reach = (uint32_t)ceil(d->radius[axis] + 0.5) - 1;
    for (uint32_t s = 0; s < n; s++)
        for (uint32_t k = 0; k <= 2 * a->reach; k++) {
            double at = (double)a->reach - k; /* of the sample's pixel, from the other's centre */
            a->weight[s][k] = lc_pixel_filter_integral(d, axis, at + (2.0 * s / n - 1) * a->half,
                                                       at + (2.0 * (s + 1) / n - 1) * a->half);
            sum += a->weight[s][k];
        }
    return sum;
}

static double largest(const lc_share_axis *a, uint32_t k)
{
    double most = 0;
    for (uint32_t s = 0; s < a->n_strips; s++) most = fmax(most, fabs(a->weight[s][k]));
    return most;
}

/* Leaves out pixels in which every strip's weight is negligible, as of a narrow gaussian with a large radius.
 */
static void trim(lc_share_axis *a, double sum)
{
    const double least = NEGLIGIBLE_SHARE * fabs(sum) / a->n_strips;
    while (a->reach && largest(a, 0) <= least && largest(a, 2 * a->reach) <= least) {
        a->reach--;
        for (uint32_t s = 0; s < a->n_strips; s++)
            for (uint32_t k = 0; k <= 2 * a->reach; k++) a->weight[s][k] = a->weight[s][k + 1];
    }
}

static double strip_sum(const lc_share_axis *a, uint32_t strip)
{
    double sum = 0;
    for (uint32_t k = 0; k <= 2 * a->reach; k++) sum += a->weight[strip][k];
    return sum;
}

static double axis_sum(const lc_share_axis *a)
{
    double sum = 0;
    for (uint32_t s = 0; s < a->n_strips; s++) sum += strip_sum(a, s);
    return sum;
}

static bool is_even(const lc_share_axis *a)
{
    const double sum = axis_sum(a);
    for (uint32_t s = 0; s < a->n_strips; s++)
        if (!(fabs(strip_sum(a, s) * a->n_strips / sum - 1) <= MAX_UNEVEN)) return false;
    return true;
}

static void scale_strip(lc_share_axis *a, uint32_t strip, double by)
{
    for (uint32_t k = 0; k <= 2 * a->reach; k++) a->weight[strip][k] *= by;
}

static void make_axis(lc_share_axis *a, const lc_pixel_filter_desc *d, int axis, uint32_t n)
{
    trim(a, integrate(a, d, axis, n));
}

/* Makes the weights of each strip across add up to 1 and of each strip down to 1 / n; false: a strip's
 * weights differ too much from the others'. */
static bool make_lattice(lc_filter_share *s, const lc_pixel_filter_desc *d, uint32_t n)
{
    for (int k = 0; k < 2; k++) {
        make_axis(&s->axis[k], d, k, n);
        if (!is_even(&s->axis[k])) return false;
    }
    for (uint32_t i = 0; i < n; i++) {
        scale_strip(&s->axis[0], i, 1 / strip_sum(&s->axis[0], i));
        scale_strip(&s->axis[1], i, 1 / (strip_sum(&s->axis[1], i) * n));
        s->row[i] = 0;
        for (uint32_t k = 0; k < n; k++)
            s->row[i] = (uint8_t)(s->row[i] + (fmod(k * GOLDEN, 1) < fmod(i * GOLDEN, 1)));
    }
    s->n = n;
    return true;
}

static void make_grid(lc_filter_share *s, const lc_pixel_filter_desc *d, uint32_t n)
{
    const uint32_t across = (uint32_t)sqrt((double)n), down = n / across;
    make_axis(&s->axis[0], d, 0, across);
    make_axis(&s->axis[1], d, 1, down < LC_MAX_STRIPS ? down : LC_MAX_STRIPS);
    s->n = s->axis[0].n_strips * s->axis[1].n_strips;
    for (int k = 0; k < 2; k++) {
        const double sum = axis_sum(&s->axis[k]);
        for (uint32_t i = 0; i < s->axis[k].n_strips; i++) scale_strip(&s->axis[k], i, 1 / sum);
    }
}

void lc_filter_share_init(lc_filter_share *s, const lc_pixel_filter_desc *d, uint32_t n)
{
    if (n > LC_MAX_STRIPS * LC_MAX_STRIPS) n = LC_MAX_STRIPS * LC_MAX_STRIPS;
    s->lattice = n <= LC_MAX_LATTICE && make_lattice(s, d, n);
    if (!s->lattice) make_grid(s, d, n);
}

void lc_filter_share_strips(const lc_filter_share *s, uint32_t i, uint32_t strip[2])
{
    strip[0] = s->lattice ? i : i % s->axis[0].n_strips;
    strip[1] = s->lattice ? s->row[i] : i / s->axis[0].n_strips;
}

void lc_filter_share_offset(const lc_filter_share *s, uint32_t i, double offset[2])
{
    uint32_t strip[2];
    lc_filter_share_strips(s, i, strip);
    for (int k = 0; k < 2; k++)
        offset[k] = ((2.0 * strip[k] + 1) / s->axis[k].n_strips - 1) * s->axis[k].half;
}
