/* fmath_tmpl.c - powers of many floats; included by isa_*.c.
 *
 * pow01 is lc_pow01, decay is lc_decay: the operations of fmath.c in the same order, so the same bits; there is the derivation.
 *
 * pow01_ub is an upper bound of x^n, 0 < x <= 1, in float; or 0 where x^n < LC_MIN_LOBE. By the same series, u = 2^-24:
 * s within 2u (m - 1 is exact), ln m within 6u, cut after z^3 another 1.4u; ln x = e ln 2 + ln m is at least half of its
 * larger term, so within 13u, and y = n ln x, no less than -28 where it matters, within 28 * 14u = 2.4e-5. r is within
 * u of y - k ln 2 (k LN2_HIGH is exact), e^r cut after r^5 within 2.4e-6 + 5u. All below POW_SLACK = 1 + 2^-15. Neighbouring
 * terms are added in pairs: a shorter chain of operations. decay_ub bounds e^-y by the same exponential, y >= 0 exact.
 */
#include "base/fmath.h"

#define LN2_HIGH 0.693359375f /* ten bits */
#define LN2_LOW (-2.12194440e-4f)
#define POW_SLACK (1 + 0x1p-15f)
#define LN_MIN_LOBE (-27.7f) /* ln LC_MIN_LOBE = -27.63 */
#define WHOLE 0x1.8p23f      /* added and taken away again: rounds to a whole number */
#define PAIR(a, b, x) vf_add(vf_set(a), vf_mul(x, vf_set(b)))

/* e^y for y <= 0, from above; 0 where that is below LC_MIN_LOBE. */
LC_INLINE vf LC_FN(exp_ub)(vf y)
{
    vf yc = vf_max(y, vf_set(LN_MIN_LOBE));
    vf k = vf_sub(vf_add(vf_mul(yc, vf_set((float)LC_INV_LN2)), vf_set(WHOLE)), vf_set(WHOLE));
    vf r = vf_sub(vf_sub(yc, vf_mul(k, vf_set(LN2_HIGH))), vf_mul(k, vf_set(LN2_LOW)));
    vf r2 = vf_mul(r, r), exp = vf_add(PAIR(0.5f, 1.0f / 6, r), vf_mul(r2, PAIR(1.0f / 24, 1.0f / 120, r)));
    exp = vf_add(vf_add(vf_set(1), r), vf_mul(r2, exp));
    return vf_sel_gt(y, vf_set(LN_MIN_LOBE), vf_mul(vf_mul(exp, vf_pow2(k)), vf_set(POW_SLACK)), vf_set(0));
}

LC_INLINE vf LC_FN(decay_ub)(vf y) { return LC_FN(exp_ub)(vf_sub(vf_set(0), y)); }

LC_INLINE vf LC_FN(pow01_ub)(vf x, float n)
{
    const vf root2 = vf_set(1.41421356f), one = vf_set(1);
    vf e = vf_exponent(x), m = vf_mantissa(x);
    e = vf_sel_gt(m, root2, vf_add(e, one), e);
    m = vf_sel_gt(m, root2, vf_mul(m, vf_set(0.5f)), m);
    vf s = vf_div(vf_sub(m, one), vf_add(m, one)), z = vf_mul(s, s);
    vf series = vf_add(PAIR(1, 1.0f / 3, z), vf_mul(vf_mul(z, z), PAIR(1.0f / 5, 1.0f / 7, z)));
    vf ln = vf_add(vf_mul(vf_add(s, s), series), vf_mul(e, vf_set((float)LC_LN2)));
    return LC_FN(exp_ub)(vf_mul(vf_set(n), ln));
}

#undef PAIR
#undef WHOLE

#if LC_ISA_LEVEL == 0

LC_INLINE vf LC_FN(pow01)(vf x, float n) { return lc_pow01(x, n); }
LC_INLINE vf LC_FN(decay)(vf y) { return lc_decay(y); }

#else

#define D vd_set
/* c + x * rest */
#define THEN(c, x, rest) vd_add(D(c), vd_mul(x, rest))

LC_INLINE vd LC_FN(ln)(vd x)
{
    vd e = vd_exponent(x), m = vd_mantissa(x), half = D(1.41421356237309505);
    e = vd_sel_gt(m, half, vd_add(e, D(1)), e);
    m = vd_sel_gt(m, half, vd_mul(m, D(0.5)), m);
    vd s = vd_div(vd_sub(m, D(1)), vd_add(m, D(1))), z = vd_mul(s, s), z2 = vd_mul(z, z);
    vd even = THEN(1, z2, THEN(1.0 / 5, z2, THEN(1.0 / 9, z2, THEN(1.0 / 13, z2, D(1.0 / 17)))));
    vd odd = THEN(1.0 / 3, z2, THEN(1.0 / 7, z2, THEN(1.0 / 11, z2, D(1.0 / 15))));
    return vd_add(vd_mul(vd_mul(D(2), s), vd_add(even, vd_mul(z, odd))), vd_mul(e, D(LC_LN2)));
}

/* y in -700 .. 0 */
LC_INLINE vd LC_FN(exp_neg)(vd y)
{
    vd k = vd_trunc(vd_sub(vd_mul(y, D(LC_INV_LN2)), D(0.5)));
    vd r = vd_sub(y, vd_mul(k, D(LC_LN2))), r2 = vd_mul(r, r);
    vd even = THEN(1.0 / 40320, r2, THEN(1.0 / 3628800, r2, D(1.0 / 479001600)));
    even = THEN(1, r2, THEN(1.0 / 2, r2, THEN(1.0 / 24, r2, THEN(1.0 / 720, r2, even))));
    vd odd = THEN(1.0 / 362880, r2, THEN(1.0 / 39916800, r2, D(1.0 / 6227020800.0)));
    odd = THEN(1, r2, THEN(1.0 / 6, r2, THEN(1.0 / 120, r2, THEN(1.0 / 5040, r2, odd))));
    return vd_mul(vd_add(even, vd_mul(r, odd)), vd_pow2(k));
}

/* e^y for y <= 0, or 0 */
LC_INLINE vd LC_FN(exp_or_0)(vd y)
{
    vd least = D(LC_LEAST_LN), e = LC_FN(exp_neg)(vd_sel_gt(least, y, least, y));
    return vd_sel_gt(least, y, D(0), e);
}

/* 0 < x < 1, n > 0 */
LC_INLINE vd LC_FN(pow_inside)(vd x, vd n) { return LC_FN(exp_or_0)(vd_mul(n, LC_FN(ln)(x))); }

LC_INLINE vf LC_FN(decay)(vf y)
{
    return vf_of(LC_FN(exp_or_0)(vd_sub(D(0), vd_low(y))), LC_FN(exp_or_0)(vd_sub(D(0), vd_high(y))));
}

LC_INLINE vf LC_FN(pow01)(vf x, float n)
{
    const vf one = vf_set(1), zero = vf_set(0);
    if (!(n > 0)) return vf_sel_gt(x, zero, one, zero);
    vf in = vf_sel_gt(x, zero, vf_sel_gt(one, x, x, one), one); /* what is outside is replaced below */
    vd low = LC_FN(pow_inside)(vd_low(in), D((double)n)), high = LC_FN(pow_inside)(vd_high(in), D((double)n));
    return vf_sel_gt(x, zero, vf_sel_gt(one, x, vf_of(low, high), one), zero);
}

#undef D
#undef THEN

#endif
