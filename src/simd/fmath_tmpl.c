/* fmath_tmpl.c - powers of many floats; included by isa_tmpl.c.
 *
 * pow01 is lc_pow01 and decay is lc_decay: the operations of fmath.c in the same order, so the same bits; the
 * derivation is there.
 *
 * pow01_ub is an upper bound of x^n, 0 < x <= 1, in float; or 0 where x^n < LC_MIN_LOBE. It takes the same
 * series, with u = 2^-24:
 * - s is within 2u (m - 1 is exact), ln m within 6u; omitting the terms after z^3 adds 1.4u.
 * - ln x = e ln 2 + ln m is at least half of its larger term, so within 13u, and y = n ln x, no less than -28
 *   where it matters, within 28 * 14u = 2.4e-5.
 * - r is within u of y - k ln 2 (k LN2_HIGH is exact), e^r without the terms after r^5 within 2.4e-6 + 5u.
 *
 * All together is below POW_SLACK = 1 + 2^-15. Neighbouring terms are added in pairs, for a shorter chain of
 * operations. decay_ub bounds e^-y by the same exponential, y >= 0 exact.
 */
#include "base/fmath.h"

#define LN2_HIGH 0.693359375f /* the first ten bits of ln 2 */
#define LN2_LOW (-2.12194440e-4f)
#define POW_SLACK (1 + 0x1p-15f)
#define LN_MIN_LOBE (-27.7f) /* ln LC_MIN_LOBE = -27.63 */
#define WHOLE 0x1.8p23f      /* added and subtracted: rounds to a whole number */

/* e^y for y <= 0, from above; 0 where that is below LC_MIN_LOBE. */
LC_INLINE vf exp_ub(vf y)
{
    vf yc = vf_max(y, vf_set(LN_MIN_LOBE));
    vf k = yc * (float)LC_INV_LN2 + WHOLE - WHOLE;
    vf r = yc - k * LN2_HIGH - k * LN2_LOW;
    vf r2 = r * r, exp = 0.5f + r * (1.0f / 6) + r2 * (1.0f / 24 + r * (1.0f / 120));
    exp = 1 + r + r2 * exp;
    return vf_sel_gt(y, vf_set(LN_MIN_LOBE), exp * vf_pow2(k) * POW_SLACK, vf_set(0));
}

LC_INLINE vf decay_ub(vf y) { return exp_ub(0 - y); }

/* The angle of (x, y), degrees, -180..180; 0 for (0, 0). The quotient of the lesser by the greater is brought
 * below tan(pi/8) by atan a = pi/4 + atan((a - 1) / (a + 1)); series to a^15: the remainder is below 5e-8 of
 * it. Quotients, sums and series: within 8u of pi/4, so 3e-5 degrees. */
LC_INLINE vf atan2_degrees(vf y, vf x)
{
    const vf zero = vf_set(0), one = vf_set(1), part = vf_set(0.41421356f);
    vf ax = vf_abs(x), ay = vf_abs(y), most = vf_max(ax, ay), a = vf_min(ax, ay);
    a = a / vf_sel_gt(most, zero, most, one);
    vf b = vf_sel_gt(a, part, (a - one) / (a + one), a), z = b * b;
    vf series = z * (1.0f / 9 - z * (1.0f / 11 - z * (1.0f / 13 - z * (1.0f / 15))));
    series = b - b * (z * (1.0f / 3 - z * (1.0f / 5 - z * (1.0f / 7 - series))));
    vf angle = series * 57.2957795f + vf_sel_gt(a, part, vf_set(45), zero);
    angle = vf_sel_gt(ay, ax, 90 - angle, angle);
    angle = vf_sel_gt(zero, x, 180 - angle, angle);
    return vf_sel_gt(zero, y, 0 - angle, angle);
}

LC_INLINE vf pow01_ub(vf x, float n)
{
    const vf root2 = vf_set(1.41421356f), one = vf_set(1);
    vf e = vf_exponent(x), m = vf_mantissa(x);
    e = vf_sel_gt(m, root2, e + one, e);
    m = vf_sel_gt(m, root2, m * 0.5f, m);
    vf s = (m - one) / (m + one), z = s * s;
    vf series = 1 + z * (1.0f / 3) + z * z * (1.0f / 5 + z * (1.0f / 7));
    vf ln = (s + s) * series + e * (float)LC_LN2;
    return exp_ub(n * ln);
}

#if VF_LANES == 1

LC_INLINE vf pow01(vf x, float n) { return lc_pow01(x, n); }
LC_INLINE vf decay(vf y) { return lc_decay(y); }

#else

LC_INLINE vd ln(vd x)
{
    vd e = vd_exponent(x), m = vd_mantissa(x), half = vd_set(1.41421356237309505);
    e = vd_sel_gt(m, half, e + 1, e);
    m = vd_sel_gt(m, half, m * 0.5, m);
    vd s = (m - 1) / (m + 1), z = s * s, z2 = z * z;
    vd even = 1 + z2 * (1.0 / 5 + z2 * (1.0 / 9 + z2 * (1.0 / 13 + z2 * (1.0 / 17))));
    vd odd = 1.0 / 3 + z2 * (1.0 / 7 + z2 * (1.0 / 11 + z2 * (1.0 / 15)));
    return 2 * s * (even + z * odd) + e * LC_LN2;
}

/* y in -700 .. 0 */
LC_INLINE vd exp_neg(vd y)
{
    vd k = vd_trunc(y * LC_INV_LN2 - 0.5);
    vd r = y - k * LC_LN2, r2 = r * r;
    vd even = 1.0 / 40320 + r2 * (1.0 / 3628800 + r2 * (1.0 / 479001600));
    even = 1 + r2 * (1.0 / 2 + r2 * (1.0 / 24 + r2 * (1.0 / 720 + r2 * even)));
    vd odd = 1.0 / 362880 + r2 * (1.0 / 39916800 + r2 * (1.0 / 6227020800.0));
    odd = 1 + r2 * (1.0 / 6 + r2 * (1.0 / 120 + r2 * (1.0 / 5040 + r2 * odd)));
    return (even + r * odd) * vd_pow2(k);
}

/* e^y for y <= 0, or 0 */
LC_INLINE vd exp_or_0(vd y)
{
    vd least = vd_set(LC_LEAST_LN), e = exp_neg(vd_sel_gt(least, y, least, y));
    return vd_sel_gt(least, y, vd_set(0), e);
}

/* 0 < x < 1, n > 0 */
LC_INLINE vd pow_inside(vd x, vd n) { return exp_or_0(n * ln(x)); }

LC_INLINE vf decay(vf y)
{
    return vf_of(exp_or_0(0 - vd_low(y)), exp_or_0(0 - vd_high(y)));
}

LC_INLINE vf pow01(vf x, float n)
{
    const vf one = vf_set(1), zero = vf_set(0);
    if (!(n > 0)) return vf_sel_gt(x, zero, one, zero);
    vf in = vf_sel_gt(x, zero, vf_sel_gt(one, x, x, one), one); /* what is outside is replaced below */
    vd low = pow_inside(vd_low(in), vd_set((double)n)), high = pow_inside(vd_high(in), vd_set((double)n));
    return vf_sel_gt(x, zero, vf_sel_gt(one, x, vf_of(low, high), one), zero);
}

#endif

#undef LN2_HIGH
#undef LN2_LOW
#undef POW_SLACK
#undef LN_MIN_LOBE
#undef WHOLE
