/* interval.h - between what the light that a point gets by every light must lie, by what is proved of the
 * clusters of a cut.
 *
 *     worst case     a cluster contributes at most its bound, nothing if it is proved to be hidden, and at
 *                    least its lower bound if it is proved to be visible as a whole, else at least 0; lights
 *                    are exact. The sums are `lower` and `upper`
 *     statistical    in each cluster a light is drawn anew, which no cut has looked at; what it stands for
 *                    is an unbiased estimate of the cluster, in the same range. Hoeffding's inequality for
 *                    sums of independent numbers, each in a range of width r_i, range2 = sum of r_i^2:
 *
 *                        P(|estimate - truth| >= h) <= 2 exp(-2 h^2 / range2)
 *
 * Truth is what the exact method sums, float by float. It is measured by weights of R G B: those of
 * luminance, times whatever the radiance is multiplied by on its way to the picture.
 *
 * Rounding. Bounds hold for the float estimates (shade/box_tmpl.c, lower_tmpl.c), so what is left are sums
 * and products of what is not negative: at most 64 roundings, and one for each further sample of a pixel.
 */
#ifndef LC_INTERVAL_H
#define LC_INTERVAL_H

#include "cut/cut.h"

typedef struct lc_interval {
    double lower, upper; /* proved */
    double estimate, range2;
} lc_interval;

/* Of one point, whose cut lc_cut_shade has just made, and weights of R G B. key: of the random lights. */
void lc_cut_interval(lc_cut *cut, const lc_point *point, const float ray_org[3], const double weight[3],
                     uint64_t key, lc_stats *stats, lc_interval *out);

/* That of a known radiance. */
lc_interval lc_interval_of(lc_f3 radiance, const double weight[3]);
/* Adds a part of a sum, or a share of it: weight may be negative. */
void lc_interval_add(lc_interval *sum, const lc_interval *part, double weight);
/* Widens lower and upper by what n samples may be off by rounding. */
void lc_interval_round(lc_interval *x, uint32_t n);
/* h above for 1 - P = 95 %, plus rounding; no more than what is proved. */
double lc_interval_half_width(const lc_interval *x);

#endif
