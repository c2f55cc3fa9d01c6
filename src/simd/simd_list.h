/* simd_list.h - the words that only lists of clusters need: bits of any type in eight lanes, and their packing.
 *
 * vf8_keep writes the lanes in `mask` next to each other, and anything to the rest of p[0 .. 8).
 */
#ifndef LC_SIMD_LIST_H
#define LC_SIMD_LIST_H

#include "simd/simd.h"

#include <string.h>

#if LC_ISA_LEVEL == 0

static inline vf8 vf8_loadu(const void *p)
{
    vf8 r;
    memcpy(&r, p, sizeof r);
    return r;
}
/* Each of p[0 .. 4) twice. */
static inline vf8 vf8_twice(const void *p)
{
    vf8 r;
    for (size_t i = 0; i < 8; i++) memcpy(&r.v[i], (const char *)p + 4 * (i / 2), 4);
    return r;
}
static inline vf8 vf8_or(vf8 a, vf8 b)
{
    for (int i = 0; i < 8; i++) {
        uint32_t x, y;
        memcpy(&x, &a.v[i], 4);
        memcpy(&y, &b.v[i], 4);
        x |= y;
        memcpy(&a.v[i], &x, 4);
    }
    return a;
}
static inline uint32_t vf8_signs(vf8 a)
{
    uint32_t bits = 0, x;
    for (uint32_t i = 0; i < 8; i++) {
        memcpy(&x, &a.v[i], 4);
        bits |= x >> 31 << i;
    }
    return bits;
}
static inline void vf8_keep(void *p, vf8 a, uint32_t mask)
{
    for (char *to = p; mask; mask &= mask - 1, to += 4) memcpy(to, &a.v[__builtin_ctz(mask)], 4);
}

#else

#if LC_ISA_LEVEL < 3
#define LANE(k) 4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3
#define NONE -1, -1, -1, -1
static const int8_t LC_FN(pack)[16][16] = {
    { NONE, NONE, NONE, NONE },          { LANE(0), NONE, NONE, NONE },       { LANE(1), NONE, NONE, NONE },
    { LANE(0), LANE(1), NONE, NONE },    { LANE(2), NONE, NONE, NONE },       { LANE(0), LANE(2), NONE, NONE },
    { LANE(1), LANE(2), NONE, NONE },    { LANE(0), LANE(1), LANE(2), NONE }, { LANE(3), NONE, NONE, NONE },
    { LANE(0), LANE(3), NONE, NONE },    { LANE(1), LANE(3), NONE, NONE },    { LANE(0), LANE(1), LANE(3), NONE },
    { LANE(2), LANE(3), NONE, NONE },    { LANE(0), LANE(2), LANE(3), NONE }, { LANE(1), LANE(2), LANE(3), NONE },
    { LANE(0), LANE(1), LANE(2), LANE(3) },
};
#undef LANE
#undef NONE
static inline void LC_FN(keep_halves)(float *p, __m128 a, __m128 b, uint32_t mask)
{
    const __m128i *pack = (const __m128i *)(const void *)LC_FN(pack);
    __m128i lo = _mm_shuffle_epi8(_mm_castps_si128(a), _mm_loadu_si128(pack + (mask & 15)));
    __m128i hi = _mm_shuffle_epi8(_mm_castps_si128(b), _mm_loadu_si128(pack + (mask >> 4)));
    _mm_storeu_ps(p, _mm_castsi128_ps(lo));
    _mm_storeu_ps(p + __builtin_popcount(mask & 15), _mm_castsi128_ps(hi));
}
#endif

#if LC_ISA_LEVEL == 1

static inline vf8 vf8_loadu(const void *p) { return (vf8){ _mm_loadu_ps(p), _mm_loadu_ps((const float *)p + 4) }; }
static inline vf8 vf8_twice(const void *p)
{
    __m128 a = _mm_loadu_ps(p);
    return (vf8){ _mm_unpacklo_ps(a, a), _mm_unpackhi_ps(a, a) };
}
static inline vf8 vf8_or(vf8 x, vf8 y) { VF8_BOTH(_mm_or_ps); }
static inline uint32_t vf8_signs(vf8 x) { return (uint32_t)_mm_movemask_ps(x.a) | (uint32_t)_mm_movemask_ps(x.b) << 4; }
static inline void vf8_keep(void *p, vf8 x, uint32_t mask) { LC_FN(keep_halves)(p, x.a, x.b, mask); }

#else

static inline vf8 vf8_loadu(const void *p) { return _mm256_loadu_ps(p); }
static inline vf8 vf8_twice(const void *p)
{
    __m128 a = _mm_loadu_ps(p);
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_unpacklo_ps(a, a)), _mm_unpackhi_ps(a, a), 1);
}
static inline vf8 vf8_or(vf8 a, vf8 b) { return _mm256_or_ps(a, b); }
static inline uint32_t vf8_signs(vf8 a) { return (uint32_t)_mm256_movemask_ps(a); }
#if LC_ISA_LEVEL == 2
static inline void vf8_keep(void *p, vf8 a, uint32_t mask)
{
    LC_FN(keep_halves)(p, _mm256_castps256_ps128(a), _mm256_extractf128_ps(a, 1), mask);
}
#else
static inline void vf8_keep(void *p, vf8 a, uint32_t mask)
{
    _mm256_storeu_ps(p, _mm256_maskz_compress_ps((__mmask8)mask, a));
}
#endif

#endif
#endif

#endif
