/* sample.h - well spread points of the unit square: the (0,2)-sequence of van der Corput and Sobol', each
 * with a random digit shift of its own ([Kollig02]). Any 2^k points from a multiple of 2^k on have one in
 * each of 2^k strips and cells. */
#ifndef LC_SAMPLE_H
#define LC_SAMPLE_H

#include "base/rng.h"

/* Point i of the sequence that `key` names, 0 <= u < 1. */
static inline void lc_sample_pair(uint64_t key, uint32_t i, double u[2])
{
    uint32_t x = (uint32_t)key, y = (uint32_t)(key >> 32);
    for (uint32_t bit = 1u << 31, column = 1u << 31; i; i >>= 1, bit >>= 1, column ^= column >> 1)
        if (i & 1) {
            x ^= bit;
            y ^= column;
        }
    u[0] = x * 0x1p-32;
    u[1] = y * 0x1p-32;
}

#endif
