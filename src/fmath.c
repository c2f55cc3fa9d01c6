/* fmath.c - logarithm by atanh series, exponential by Taylor series, both in double after range reduction. */
#include "fmath.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#define LN2 0.693147180559945309417232

/* ln x for normal x > 0: x = m 2^e, m in [sqrt(1/2), sqrt(2)), ln m = 2 atanh(s), s = (m - 1) / (m + 1), |s| < 0.1716,
 * series to s^19: remainder below 2 * 0.1716^21 / 21 < 1e-17. */
static double ln(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    int e = (int)(bits >> 52) - 1023;
    bits = (bits & 0xfffffffffffffu) | 0x3ff0000000000000u;
    double m;
    memcpy(&m, &bits, sizeof m);
    if (m > 1.41421356237309505) m *= 0.5, e++;
    double s = (m - 1) / (m + 1), s2 = s * s, sum = 0;
    for (int k = 19; k >= 1; k -= 2) sum = sum * s2 + 1.0 / k;
    return 2 * s * sum + e * LN2;
}

/* e^y for -700 <= y <= 0: y = k ln 2 + r, |r| <= 0.3466, Taylor to r^13: remainder below 1e-17. */
static double expo(double y)
{
    double k = floor(y / LN2 + 0.5), r = y - k * LN2, sum = 1;
    for (int i = 13; i >= 1; i--) sum = 1 + sum * r / i;
    uint64_t bits = (uint64_t)(int64_t)(k + 1023) << 52;
    double scale;
    memcpy(&scale, &bits, sizeof scale);
    return sum * scale;
}

float lc_pow01(float x, float n)
{
    if (!(x > 0)) return 0;
    if (x >= 1 || n == 0) return 1;
    double y = (double)n * ln((double)x);
    return y < -100 ? 0 : (float)expo(y); /* e^-100 is below the least normal float */
}
