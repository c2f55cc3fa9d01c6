/* rnd.h - a stream of random numbers for a test. RND_KEY, if defined before the include, is its seed; a test
 * that sets rng_ctr back draws the same numbers again. */
#ifndef RND_H
#define RND_H

#include "base/rng.h"
#include "base/vec.h"

#ifndef RND_KEY
#define RND_KEY 1
#endif

static uint64_t rng_key = RND_KEY, rng_ctr;

static inline double rnd(void) { return lc_unit(lc_hash2(rng_key, rng_ctr++)); }
static inline double rnd_in(double lo, double hi) { return lo + (hi - lo) * rnd(); }
static inline uint32_t rnd_n(uint32_t n) { return (uint32_t)(rnd() * n); }

/* A point in the cube of half side h about 0. */
static inline lc_f3 rnd_in_box(double h)
{
    float x = (float)rnd_in(-h, h), y = (float)rnd_in(-h, h), z = (float)rnd_in(-h, h);
    return lc_f3_make(x, y, z);
}

/* A point of the unit sphere. */
static inline lc_f3 rnd_unit(void)
{
    for (;;) {
        double x = rnd_in(-1, 1), y = rnd_in(-1, 1), z = rnd_in(-1, 1), l2 = x * x + y * y + z * z;
        if (l2 < 1 && l2 > 1e-3) return lc_f3_normalize(lc_f3_make((float)x, (float)y, (float)z));
    }
}

#endif
