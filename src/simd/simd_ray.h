/* simd_ray.h - the words that only ray streams need: masks of rays in eight lanes, and fused products.
 *
 * vf8_fma and vf8_fms round once on some levels and twice on others: only for what decides nothing, such as conservative
 * filters. vu8 is eight lanes of 32 bits.
 */
#ifndef LC_SIMD_RAY_H
#define LC_SIMD_RAY_H

#include "simd/simd.h"

#if LC_ISA_LEVEL == 0

typedef struct vu8 {
    uint32_t v[8];
} vu8;

static inline vu8 vu8_zero(void) { return (vu8){ { 0 } }; }
/* a <= b ? acc | bits : acc */
static inline vu8 vu8_mark_le(vu8 acc, vf8 a, vf8 b, const uint32_t *bits)
{
    for (int i = 0; i < 8; i++) acc.v[i] |= a.v[i] <= b.v[i] ? *bits : 0;
    return acc;
}
static inline uint32_t vu8_nonzero(vu8 a) { VF8_BITS(a.v[i]); }
static inline void vu8_store(uint32_t *p, vu8 a)
{
    for (int i = 0; i < 8; i++) p[i] = a.v[i];
}
static inline vf8 vf8_fma(vf8 a, vf8 b, vf8 c) { return vf8_add(vf8_mul(a, b), c); }
static inline vf8 vf8_fms(vf8 a, vf8 b, vf8 c) { return vf8_sub(vf8_mul(a, b), c); }

#elif LC_ISA_LEVEL == 1

typedef struct vu8 {
    __m128i a, b;
} vu8;

static inline vu8 vu8_zero(void) { return (vu8){ _mm_setzero_si128(), _mm_setzero_si128() }; }
static inline vu8 vu8_mark_le(vu8 acc, vf8 x, vf8 y, const uint32_t *bits)
{
    const __m128i m = _mm_set1_epi32((int)*bits);
    return (vu8){ _mm_or_si128(acc.a, _mm_and_si128(_mm_castps_si128(_mm_cmple_ps(x.a, y.a)), m)),
                  _mm_or_si128(acc.b, _mm_and_si128(_mm_castps_si128(_mm_cmple_ps(x.b, y.b)), m)) };
}
static inline uint32_t vu8_nonzero(vu8 x)
{
    const __m128i z = _mm_setzero_si128();
    int zero = _mm_movemask_ps(_mm_castsi128_ps(_mm_cmpeq_epi32(x.a, z)))
               | _mm_movemask_ps(_mm_castsi128_ps(_mm_cmpeq_epi32(x.b, z))) << 4;
    return (uint32_t)~zero & 255;
}
static inline void vu8_store(uint32_t *p, vu8 x)
{
    _mm_store_si128((__m128i *)(void *)p, x.a);
    _mm_store_si128((__m128i *)(void *)(p + 4), x.b);
}
static inline vf8 vf8_fma(vf8 a, vf8 b, vf8 c) { return vf8_add(vf8_mul(a, b), c); }
static inline vf8 vf8_fms(vf8 a, vf8 b, vf8 c) { return vf8_sub(vf8_mul(a, b), c); }

#else

typedef __m256i vu8;

static inline vu8 vu8_zero(void) { return _mm256_setzero_si256(); }
static inline vu8 vu8_mark_le(vu8 acc, vf8 x, vf8 y, const uint32_t *bits)
{
    const __m256i m = _mm256_castps_si256(_mm256_cmp_ps(x, y, _CMP_LE_OQ));
    return _mm256_or_si256(acc, _mm256_and_si256(m, _mm256_set1_epi32((int)*bits)));
}
static inline uint32_t vu8_nonzero(vu8 x)
{
    const __m256i z = _mm256_cmpeq_epi32(x, _mm256_setzero_si256());
    return (uint32_t)~_mm256_movemask_ps(_mm256_castsi256_ps(z)) & 255;
}
static inline void vu8_store(uint32_t *p, vu8 x) { _mm256_store_si256((__m256i *)(void *)p, x); }
static inline vf8 vf8_fma(vf8 a, vf8 b, vf8 c) { return _mm256_fmadd_ps(a, b, c); }
static inline vf8 vf8_fms(vf8 a, vf8 b, vf8 c) { return _mm256_fmsub_ps(a, b, c); }

#endif

#endif
