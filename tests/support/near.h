/* near.h - two numbers that count as equal. near_abs limits their difference, near_rel the ratio of that
 * difference to the second number, which is the right one. Neither holds for a NaN. */
#ifndef NEAR_H
#define NEAR_H

#include "base/vec.h"

static inline bool near_abs(double got, double want, double eps) { return fabs(got - want) <= eps; }

static inline bool near_rel(double got, double want, double eps)
{
    return fabs(got - want) <= eps * fabs(want);
}

/* near_abs of each component. */
static inline bool near3_abs(lc_f3 got, double x, double y, double z, double eps)
{
    return near_abs((double)got.x, x, eps) && near_abs((double)got.y, y, eps) &&
           near_abs((double)got.z, z, eps);
}

static inline bool near_f3_abs(lc_f3 got, lc_f3 want, double eps)
{
    return near3_abs(got, (double)want.x, (double)want.y, (double)want.z, eps);
}

#endif
