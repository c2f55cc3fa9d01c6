/* fmath.c - logarithm by atanh series, exponential and arc tangent by Taylor series, in double after range
 * reduction. */
#include "base/fmath.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* ln x for normal x > 0: x = m 2^e, m in [sqrt(1/2), sqrt(2)), ln m = 2 atanh(s), s = (m - 1) / (m + 1), |s|
 * < 0.1716, series to s^17: remainder below 2 * 0.1716^19 / 19 / (1 - 0.03) < 4e-16 of s. */
double lc_ln(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    int e = (int)(bits >> 52) - 1023;
    bits = (bits & 0xfffffffffffffu) | 0x3ff0000000000000u;
    double m;
    memcpy(&m, &bits, sizeof m);
    if (m > 1.41421356237309505) {
        m *= 0.5;
        e++;
    }
    double s = (m - 1) / (m + 1), z = s * s, z2 = z * z;
    double even = 1 + z2 * (1.0 / 5 + z2 * (1.0 / 9 + z2 * (1.0 / 13 + z2 * (1.0 / 17))));
    double odd = 1.0 / 3 + z2 * (1.0 / 7 + z2 * (1.0 / 11 + z2 * (1.0 / 15)));
    return 2 * s * (even + z * odd) + e * LC_LN2;
}

/* y = k ln 2 + r, |r| <= 0.3466, Taylor to r^13: remainder below 1e-17. */
double lc_exp_neg(double y)
{
    if (!(y > -700)) return 0;
    int64_t k = (int64_t)(y * LC_INV_LN2 - 0.5); /* truncation of a negative number: rounds to nearest */
    double r = y - (double)k * LC_LN2, r2 = r * r;
    double even = 1 + r2 * (1.0 / 2 + r2 * (1.0 / 24 + r2 * (1.0 / 720 + r2 * (1.0 / 40320
                  + r2 * (1.0 / 3628800 + r2 * (1.0 / 479001600))))));
    double odd = 1 + r2 * (1.0 / 6 + r2 * (1.0 / 120 + r2 * (1.0 / 5040 + r2 * (1.0 / 362880
                 + r2 * (1.0 / 39916800 + r2 * (1.0 / 6227020800.0))))));
    uint64_t bits = (uint64_t)(k + 1023) << 52;
    double scale;
    memcpy(&scale, &bits, sizeof scale);
    return (even + r * odd) * scale;
}

float lc_pow01(float x, float n)
{
    if (!(x > 0)) return 0;
    if (x >= 1 || n == 0) return 1;
    double y = (double)n * lc_ln((double)x);
    return y < LC_LEAST_LN ? 0 : (float)lc_exp_neg(y);
}

float lc_decay(float y)
{
    double x = 0 - (double)y;
    return x < LC_LEAST_LN ? 0 : (float)lc_exp_neg(x);
}

/* atan a = pi/4 + atan((a - 1) / (a + 1)) brings a below tan(pi/8) = 0.4142; series to a^41: remainder below
 * 1e-17. */
double lc_atan2(double y, double x)
{
    const double quarter = 0.785398163397448309615661;
    double ax = fabs(x), ay = fabs(y), most = ax > ay ? ax : ay;
    if (!(most > 0)) return 0;
    double a = (ax > ay ? ay : ax) / most, base = 0, sum = 0;
    if (a > 0.41421356237309505) {
        a = (a - 1) / (a + 1);
        base = quarter;
    }
    for (int k = 41; k >= 3; k -= 2) sum = (k & 2 ? -1.0 / k : 1.0 / k) + a * a * sum;
    double angle = base + (a + a * (a * a * sum));
    if (ay > ax) angle = 2 * quarter - angle;
    if (x < 0) angle = 4 * quarter - angle;
    return y < 0 ? -angle : angle;
}
