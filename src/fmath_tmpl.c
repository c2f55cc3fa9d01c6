/* fmath_tmpl.c - lc_pow01 of many floats; included by isa_*.c. The operations of fmath.c in the same order, so the same
 * bits: there is the derivation. */
#include "fmath.h"

#if LC_ISA_LEVEL == 0

LC_INLINE vf LC_FN(pow01)(vf x, float n) { return lc_pow01(x, n); }

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

/* 0 < x < 1, n > 0 */
LC_INLINE vd LC_FN(pow_inside)(vd x, vd n)
{
    vd y = vd_mul(n, LC_FN(ln)(x)), least = D(LC_LEAST_LN);
    vd e = LC_FN(exp_neg)(vd_sel_gt(least, y, least, y));
    return vd_sel_gt(least, y, D(0), e);
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
