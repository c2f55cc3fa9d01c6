/* fmath.h - powers whose bits depend on nothing but + - * / : the C library may choose a pow per CPU. */
#ifndef LC_FMATH_H
#define LC_FMATH_H

/* x^n for 0 <= x <= 1 and 0 <= n <= 1e5; x = 0 gives 0, also for n = 0. Relative error below 1e-10, so that
 * x <= y implies lc_pow01(x, n) <= lc_pow01(y, n) (1 + 2e-10). */
float lc_pow01(float x, float n);

#endif
