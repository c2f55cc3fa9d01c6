/* fmath.h - powers and angles whose bits depend on nothing but + - * / : the C library may choose a pow per
 * CPU. */
#ifndef LC_FMATH_H
#define LC_FMATH_H

#define LC_LN2 0.693147180559945309417232
#define LC_INV_LN2 1.44269504088896340735992
#define LC_LEAST_LN (-29.94) /* ln 1e-13 */

/* x^n for 0 <= x <= 1 and 0 <= n <= 1e5; x = 0 gives 0, also for n = 0, and so does a result below 1e-13.
 * Relative error below 1e-10, so that x <= y implies lc_pow01(x, n) <= lc_pow01(y, n) (1 + 2e-10) where it is
 * above 1e-13. */
float lc_pow01(float x, float n);

/* e^-y for y >= 0; a result below 1e-13 is 0. Relative error below 2e-13 but for the rounding to float. */
float lc_decay(float y);

/* ln x for normal x > 0; relative error below 1e-15 but near 1. */
double lc_ln(double x);

/* The angle of (x, y), -pi .. pi, within 4e-16; 0 for (0, 0). Finite arguments. */
double lc_atan2(double y, double x);

/* e^y for y <= 0, 0 below -700; relative error below 2e-13. */
double lc_exp_neg(double y);

#endif
