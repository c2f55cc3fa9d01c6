/* fmath.h - powers, logarithms and angles by + - * / alone, so that their bits are the same on every machine:
 * a C library may choose its pow by the CPU. */
#ifndef LC_FMATH_H
#define LC_FMATH_H

#define LC_LN2 0.693147180559945309417232
#define LC_INV_LN2 1.44269504088896340735992
#define LC_LEAST_LN (-29.94) /* ln 1e-13: lc_pow01 and lc_decay give 0 below that result */

/* x^n for 0 <= x <= 1 and 0 <= n <= 1e5. 0 if the result is below 1e-13, and for x = 0 even if n = 0.
 * Relative error below 1e-10; so x <= y implies lc_pow01(x, n) <= lc_pow01(y, n) (1 + 2e-10) for results
 * above 1e-13. */
float lc_pow01(float x, float n);

/* e^-y for y >= 0; 0 if the result is below 1e-13. Relative error below 2e-13 before rounding to float. */
float lc_decay(float y);

/* ln x for normal x > 0; relative error below 1e-15 except near x = 1. */
double lc_ln(double x);

/* The angle of (x, y), -pi .. pi, within 4e-16; 0 for (0, 0). The arguments must be finite. */
double lc_atan2(double y, double x);

/* e^y for y <= 0; 0 for y < -700. Relative error below 2e-13. */
double lc_exp_neg(double y);

#endif
