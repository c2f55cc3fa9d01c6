/* float_bits.h - a float as its bits, and back. */
#ifndef LC_FLOAT_BITS_H
#define LC_FLOAT_BITS_H

#include <stdint.h>
#include <string.h>

static inline uint32_t lc_bits_of_float(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline float lc_float_of_bits(uint32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

#endif
