/* sample.h - well distributed points of the unit square: the (0,2)-sequence of van der Corput and Sobol',
 * each coordinate with its own random digit shift ([Kollig02]). Of any 2^k successive points that start at a
 * multiple of 2^k, exactly one lies in each elementary interval of area 2^-k. */
#ifndef LC_SAMPLE_H
#define LC_SAMPLE_H

#include "base/rng.h"

static inline uint32_t lc_reverse_bits(uint32_t x)
{
    static const uint32_t mask[4] = { 0x00ff00ffu, 0x0f0f0f0fu, 0x33333333u, 0x55555555u };
    x = x >> 16 | x << 16;
    for (int i = 0, by = 8; i < 4; i++, by /= 2) x = (x & mask[i]) << by | (x >> by & mask[i]);
    return x;
}

/* Point i of the sequence with this key, 0 <= u < 1. In reversed order the second coordinate's digits are the
 * product of Pascal's triangle modulo 2 and i's, a Kronecker power of {1 1; 0 1}: one factor a step. */
static inline void lc_sample_pair(uint64_t key, uint32_t i, double u[2])
{
    static const uint32_t upper[5] = { 0xffff0000u, 0xff00ff00u, 0xf0f0f0f0u, 0xccccccccu, 0xaaaaaaaau };
    uint32_t y = i;
    for (int k = 0, by = 16; k < 5; k++, by /= 2) y ^= (y & upper[k]) >> by;
    u[0] = ((uint32_t)key ^ lc_reverse_bits(i)) * 0x1p-32;
    u[1] = ((uint32_t)(key >> 32) ^ lc_reverse_bits(y)) * 0x1p-32;
}

/* A permutation of all 32-bit numbers for each key that keeps each 2^k successive ones that start at a
 * multiple of 2^k together: several pairs of coordinates, each of lc_sample_pair in an order of its own, are
 * as even as one, and independent of each other. In reversed order each bit is made from itself and lower
 * ones, as sums, products and exclusive ors of products do. */
static inline uint32_t lc_shuffle(uint32_t i, uint64_t key)
{
    uint32_t x = lc_reverse_bits(i);
    for (uint64_t round = 0; round < 4; round++) {
        const uint64_t r = lc_hash2(key, round);
        x = (x + (uint32_t)r) * ((uint32_t)(r >> 32) | 1);
        x ^= x * ((uint32_t)(r >> 16) & ~1u);
    }
    return lc_reverse_bits(x);
}

/* A permutation of 0 .. 15 for each key: rounds of what can be undone, addition, an odd factor, a shifted
 * xor. */
static inline uint32_t lc_permute16(uint32_t k, uint64_t key)
{
    for (int round = 0; round < 4; round++, key >>= 8) {
        k = (k + (uint32_t)key) * ((uint32_t)(key >> 3) | 1) & 15;
        k ^= k >> 2;
    }
    return k;
}

/* A permutation of 0 .. n - 1, n up to 2^32, whose first values lie evenly among all: multiples of the number
 * next to the golden ratio of n that has no divisor with n in common. */
static inline uint64_t lc_spread(uint64_t i, uint64_t n)
{
    uint64_t step = (uint64_t)((double)n * 0.6180339887498949);
    for (;; step++) {
        uint64_t a = n, b = step;
        while (b) {
            const uint64_t rest = a % b;
            a = b;
            b = rest;
        }
        if (a == 1) return i * step % n;
    }
}

#endif
