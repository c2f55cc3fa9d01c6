/* rng.h - counter-based random numbers: a number depends only on its key, not on numbers drawn before. */
#ifndef LC_RNG_H
#define LC_RNG_H

#include "base/base.h"

/* One round of mixing: the finalizer of splitmix64 (Steele et al. 2014, Stafford's variant 13). */
static inline uint64_t lc_mix(uint64_t z)
{
    z += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static inline uint64_t lc_hash2(uint64_t a, uint64_t b) { return lc_mix(lc_mix(a) ^ b); }

static inline uint64_t lc_hash4(uint64_t seed, uint64_t pixel, uint64_t sample, uint64_t dimension)
{
    return lc_mix(lc_mix(lc_mix(lc_mix(seed) ^ pixel) ^ sample) ^ dimension);
}

/* A hash as a number 0 <= u < 1, with 53 bits. */
static inline double lc_unit(uint64_t h) { return (double)(h >> 11) * 0x1p-53; }

#endif
