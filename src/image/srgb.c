/* srgb.c - x^2.4 by a fifth root. */
#include "image/srgb.h"

/* x^(1/5) for x in (0, 1], by Newton's method from above, where iterates decrease until rounding stops
 * them. */
static double fifth_root(double x)
{
    double y = 1.0;
    for (;;) {
        double y4 = y * y * (y * y), next = y - (y - x / y4) / 5.0;
        if (!(next < y)) return y;
        y = next;
    }
}

double lc_srgb_to_linear(double v)
{
    if (v <= 0.04045) return v / 12.92;
    double x = (v + 0.055) / 1.055, r = fifth_root(x * x);
    return x * x * r; /* x^2.4 = x^2 (x^2)^(1/5) */
}
