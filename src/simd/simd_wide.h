/* simd_wide.h - as many floats at a time as the instruction set has (VF_LANES: 1, 4, 8, 16), and half as many doubles.
 *
 * The same operations as in simd.h, and the same care: only + - * / sqrt min max and comparisons, each the same IEEE
 * operation on every level, so that a lane's bits do not depend on the level. vf_min(a, b) is b where a is not less,
 * vf_max(a, b) is b where a is not greater: a NaN in a is dropped. Loads and stores need no alignment.
 *
 *     vf_sel_gt(a, b, x, y)   x in the lanes where a > b, else y
 *     vf_any_gt(a, b)         a > b in some lane
 *     vf_rows(p, at, out)     records: p[i] + at has four floats of lane i: transposed to out[0 .. 3]
 *     vf_word(w)              the bits of w in every lane; vf_and, vf_xor, vf_shl work on bits
 *     vd_low, vd_high, vf_of  halves of a vf to double and back, rounded to nearest
 *     vf_exponent, vf_mantissa, vd_..  x = mantissa 2^exponent with mantissa in [1, 2), x > 0 and normal
 *     vf_pow2(k), vd_pow2(k)  2^k, k whole, 2^k normal
 */
#ifndef LC_SIMD_WIDE_H
#define LC_SIMD_WIDE_H

#include "base/base.h"

#include <math.h>
#include <string.h>

#define LC_INLINE static inline __attribute__((always_inline))

#if LC_ISA_LEVEL == 0

#define VF_LANES 1
typedef float vf;

LC_INLINE vf vf_set(float a) { return a; }
LC_INLINE vf vf_add(vf a, vf b) { return a + b; }
LC_INLINE vf vf_sub(vf a, vf b) { return a - b; }
LC_INLINE vf vf_mul(vf a, vf b) { return a * b; }
LC_INLINE vf vf_div(vf a, vf b) { return a / b; }
LC_INLINE vf vf_min(vf a, vf b) { return a < b ? a : b; }
LC_INLINE vf vf_max(vf a, vf b) { return a > b ? a : b; }
LC_INLINE vf vf_sqrt(vf a) { return sqrtf(a); }
LC_INLINE vf vf_abs(vf a) { return fabsf(a); }
LC_INLINE vf vf_neg(vf a) { return -a; }
LC_INLINE vf vf_sel_gt(vf a, vf b, vf x, vf y) { return a > b ? x : y; }
LC_INLINE bool vf_any_gt(vf a, vf b) { return a > b; }
LC_INLINE vf vf_load(const float *p) { return *p; }
LC_INLINE void vf_store(float *p, vf a) { *p = a; }
LC_INLINE void vf_rows(const float *const *p, size_t at, vf out[4])
{
    for (size_t k = 0; k < 4; k++) out[k] = p[0][at + k];
}
LC_INLINE uint32_t vf_bits(float a)
{
    uint32_t bits;
    memcpy(&bits, &a, sizeof bits);
    return bits;
}
LC_INLINE vf vf_of_bits(uint32_t bits)
{
    float a;
    memcpy(&a, &bits, sizeof a);
    return a;
}
LC_INLINE vf vf_word(uint32_t word) { return vf_of_bits(word); }
LC_INLINE vf vf_and(vf a, vf b) { return vf_of_bits(vf_bits(a) & vf_bits(b)); }
LC_INLINE vf vf_xor(vf a, vf b) { return vf_of_bits(vf_bits(a) ^ vf_bits(b)); }
LC_INLINE vf vf_shl(vf a, int n) { return vf_of_bits(vf_bits(a) << n); }
LC_INLINE vf vf_exponent(vf x) { return (float)((int)(vf_bits(x) >> 23) - 127); }
LC_INLINE vf vf_mantissa(vf x) { return vf_of_bits((vf_bits(x) & 0x7fffff) | vf_bits(1)); }
LC_INLINE vf vf_pow2(vf k) { return vf_of_bits((uint32_t)((int)k + 127) << 23); }

#else

#include <immintrin.h>

/* 16 bytes. */
LC_INLINE __m128d vd_two(const float *p) { return _mm_loadu_pd((const double *)(const void *)p); }

#endif

#if LC_ISA_LEVEL == 1

#define VF_LANES 4
typedef __m128 vf;
typedef __m128d vd;

LC_INLINE vf vf_set(float a) { return _mm_set1_ps(a); }
LC_INLINE vf vf_add(vf a, vf b) { return _mm_add_ps(a, b); }
LC_INLINE vf vf_sub(vf a, vf b) { return _mm_sub_ps(a, b); }
LC_INLINE vf vf_mul(vf a, vf b) { return _mm_mul_ps(a, b); }
LC_INLINE vf vf_div(vf a, vf b) { return _mm_div_ps(a, b); }
LC_INLINE vf vf_min(vf a, vf b) { return _mm_min_ps(a, b); }
LC_INLINE vf vf_max(vf a, vf b) { return _mm_max_ps(a, b); }
LC_INLINE vf vf_sqrt(vf a) { return _mm_sqrt_ps(a); }
LC_INLINE vf vf_abs(vf a) { return _mm_andnot_ps(_mm_set1_ps(-0.0f), a); }
LC_INLINE vf vf_neg(vf a) { return _mm_xor_ps(_mm_set1_ps(-0.0f), a); }
LC_INLINE vf vf_sel_gt(vf a, vf b, vf x, vf y) { return _mm_blendv_ps(y, x, _mm_cmpgt_ps(a, b)); }
LC_INLINE bool vf_any_gt(vf a, vf b) { return _mm_movemask_ps(_mm_cmpgt_ps(a, b)) != 0; }
LC_INLINE vf vf_load(const float *p) { return _mm_loadu_ps(p); }
LC_INLINE void vf_store(float *p, vf a) { _mm_storeu_ps(p, a); }
LC_INLINE vd vd_row(const float *const *p, size_t at) { return vd_two(p[0] + at); }
LC_INLINE void vf_transpose(const vd r[4], vf out[4])
{
    for (int k = 0; k < 4; k++) out[k] = _mm_castpd_ps(r[k]);
    _MM_TRANSPOSE4_PS(out[0], out[1], out[2], out[3]);
}

LC_INLINE vd vd_set(double a) { return _mm_set1_pd(a); }
LC_INLINE vd vd_add(vd a, vd b) { return _mm_add_pd(a, b); }
LC_INLINE vd vd_sub(vd a, vd b) { return _mm_sub_pd(a, b); }
LC_INLINE vd vd_mul(vd a, vd b) { return _mm_mul_pd(a, b); }
LC_INLINE vd vd_div(vd a, vd b) { return _mm_div_pd(a, b); }
LC_INLINE vd vd_sel_gt(vd a, vd b, vd x, vd y) { return _mm_blendv_pd(y, x, _mm_cmpgt_pd(a, b)); }
LC_INLINE vd vd_trunc(vd a) { return _mm_round_pd(a, _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC); }
LC_INLINE vd vd_low(vf a) { return _mm_cvtps_pd(a); }
LC_INLINE vd vd_high(vf a) { return _mm_cvtps_pd(_mm_movehl_ps(a, a)); }
LC_INLINE vf vf_of(vd low, vd high) { return _mm_movelh_ps(_mm_cvtpd_ps(low), _mm_cvtpd_ps(high)); }

#define VD_BITS(name) _mm_##name
#define VD_AND(a, b) _mm_and_si128(a, b)
#define VD_OR(a, b) _mm_or_si128(a, b)
#define VD_XOR(a, b) _mm_xor_si128(a, b)
#define VD_SET_BITS(a) _mm_set1_epi64x(a)
#define VD_CAST(a) _mm_castpd_si128(a)
#define VD_OF_BITS(a) _mm_castsi128_pd(a)
#define VF_CAST(a) _mm_castps_si128(a)
#define VF_OF_BITS(a) _mm_castsi128_ps(a)

#elif LC_ISA_LEVEL == 2

#define VF_LANES 8
typedef __m256 vf;
typedef __m256d vd;

LC_INLINE vf vf_set(float a) { return _mm256_set1_ps(a); }
LC_INLINE vf vf_add(vf a, vf b) { return _mm256_add_ps(a, b); }
LC_INLINE vf vf_sub(vf a, vf b) { return _mm256_sub_ps(a, b); }
LC_INLINE vf vf_mul(vf a, vf b) { return _mm256_mul_ps(a, b); }
LC_INLINE vf vf_div(vf a, vf b) { return _mm256_div_ps(a, b); }
LC_INLINE vf vf_min(vf a, vf b) { return _mm256_min_ps(a, b); }
LC_INLINE vf vf_max(vf a, vf b) { return _mm256_max_ps(a, b); }
LC_INLINE vf vf_sqrt(vf a) { return _mm256_sqrt_ps(a); }
LC_INLINE vf vf_abs(vf a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a); }
LC_INLINE vf vf_neg(vf a) { return _mm256_xor_ps(_mm256_set1_ps(-0.0f), a); }
LC_INLINE vf vf_sel_gt(vf a, vf b, vf x, vf y) { return _mm256_blendv_ps(y, x, _mm256_cmp_ps(a, b, _CMP_GT_OQ)); }
LC_INLINE bool vf_any_gt(vf a, vf b) { return _mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_GT_OQ)) != 0; }
LC_INLINE vf vf_load(const float *p) { return _mm256_loadu_ps(p); }
LC_INLINE void vf_store(float *p, vf a) { _mm256_storeu_ps(p, a); }
/* Four floats of places k, k + 4, ... */
LC_INLINE vd vd_row(const float *const *p, size_t at)
{
    return _mm256_insertf128_pd(_mm256_castpd128_pd256(vd_two(p[0] + at)), vd_two(p[4] + at), 1);
}
LC_INLINE void vf_transpose(const vd r[4], vf out[4])
{
    vd t[4];
    for (int k = 0; k < 4; k += 2) {
        __m256 a = _mm256_castpd_ps(r[k]), b = _mm256_castpd_ps(r[k + 1]);
        t[k] = _mm256_castps_pd(_mm256_unpacklo_ps(a, b));
        t[k + 1] = _mm256_castps_pd(_mm256_unpackhi_ps(a, b));
    }
    for (int k = 0; k < 2; k++) {
        out[2 * k] = _mm256_castpd_ps(_mm256_unpacklo_pd(t[k], t[k + 2]));
        out[2 * k + 1] = _mm256_castpd_ps(_mm256_unpackhi_pd(t[k], t[k + 2]));
    }
}

LC_INLINE vd vd_set(double a) { return _mm256_set1_pd(a); }
LC_INLINE vd vd_add(vd a, vd b) { return _mm256_add_pd(a, b); }
LC_INLINE vd vd_sub(vd a, vd b) { return _mm256_sub_pd(a, b); }
LC_INLINE vd vd_mul(vd a, vd b) { return _mm256_mul_pd(a, b); }
LC_INLINE vd vd_div(vd a, vd b) { return _mm256_div_pd(a, b); }
LC_INLINE vd vd_sel_gt(vd a, vd b, vd x, vd y) { return _mm256_blendv_pd(y, x, _mm256_cmp_pd(a, b, _CMP_GT_OQ)); }
LC_INLINE vd vd_trunc(vd a) { return _mm256_round_pd(a, _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC); }
LC_INLINE vd vd_low(vf a) { return _mm256_cvtps_pd(_mm256_castps256_ps128(a)); }
LC_INLINE vd vd_high(vf a) { return _mm256_cvtps_pd(_mm256_extractf128_ps(a, 1)); }
LC_INLINE vf vf_of(vd low, vd high) { return _mm256_set_m128(_mm256_cvtpd_ps(high), _mm256_cvtpd_ps(low)); }

#define VD_BITS(name) _mm256_##name
#define VD_AND(a, b) _mm256_and_si256(a, b)
#define VD_OR(a, b) _mm256_or_si256(a, b)
#define VD_XOR(a, b) _mm256_xor_si256(a, b)
#define VD_SET_BITS(a) _mm256_set1_epi64x(a)
#define VD_CAST(a) _mm256_castpd_si256(a)
#define VD_OF_BITS(a) _mm256_castsi256_pd(a)
#define VF_CAST(a) _mm256_castps_si256(a)
#define VF_OF_BITS(a) _mm256_castsi256_ps(a)

#elif LC_ISA_LEVEL == 3

#define VF_LANES 16
typedef __m512 vf;
typedef __m512d vd;

LC_INLINE vf vf_set(float a) { return _mm512_set1_ps(a); }
LC_INLINE vf vf_add(vf a, vf b) { return _mm512_add_ps(a, b); }
LC_INLINE vf vf_sub(vf a, vf b) { return _mm512_sub_ps(a, b); }
LC_INLINE vf vf_mul(vf a, vf b) { return _mm512_mul_ps(a, b); }
LC_INLINE vf vf_div(vf a, vf b) { return _mm512_div_ps(a, b); }
LC_INLINE vf vf_min(vf a, vf b) { return _mm512_min_ps(a, b); }
LC_INLINE vf vf_max(vf a, vf b) { return _mm512_max_ps(a, b); }
LC_INLINE vf vf_sqrt(vf a) { return _mm512_sqrt_ps(a); }
LC_INLINE vf vf_abs(vf a) { return _mm512_andnot_ps(_mm512_set1_ps(-0.0f), a); }
LC_INLINE vf vf_neg(vf a) { return _mm512_xor_ps(_mm512_set1_ps(-0.0f), a); }
LC_INLINE vf vf_sel_gt(vf a, vf b, vf x, vf y) { return _mm512_mask_blend_ps(_mm512_cmp_ps_mask(a, b, _CMP_GT_OQ), y, x); }
LC_INLINE bool vf_any_gt(vf a, vf b) { return _mm512_cmp_ps_mask(a, b, _CMP_GT_OQ) != 0; }
LC_INLINE vf vf_load(const float *p) { return _mm512_loadu_ps(p); }
LC_INLINE void vf_store(float *p, vf a) { _mm512_storeu_ps(p, a); }
LC_INLINE vd vd_row(const float *const *p, size_t at)
{
    __m256d low = _mm256_insertf128_pd(_mm256_castpd128_pd256(vd_two(p[0] + at)), vd_two(p[4] + at), 1);
    __m256d high = _mm256_insertf128_pd(_mm256_castpd128_pd256(vd_two(p[8] + at)), vd_two(p[12] + at), 1);
    return _mm512_insertf64x4(_mm512_castpd256_pd512(low), high, 1);
}
LC_INLINE void vf_transpose(const vd r[4], vf out[4])
{
    vd t[4];
    for (int k = 0; k < 4; k += 2) {
        __m512 a = _mm512_castpd_ps(r[k]), b = _mm512_castpd_ps(r[k + 1]);
        t[k] = _mm512_castps_pd(_mm512_unpacklo_ps(a, b));
        t[k + 1] = _mm512_castps_pd(_mm512_unpackhi_ps(a, b));
    }
    for (int k = 0; k < 2; k++) {
        out[2 * k] = _mm512_castpd_ps(_mm512_unpacklo_pd(t[k], t[k + 2]));
        out[2 * k + 1] = _mm512_castpd_ps(_mm512_unpackhi_pd(t[k], t[k + 2]));
    }
}

LC_INLINE vd vd_set(double a) { return _mm512_set1_pd(a); }
LC_INLINE vd vd_add(vd a, vd b) { return _mm512_add_pd(a, b); }
LC_INLINE vd vd_sub(vd a, vd b) { return _mm512_sub_pd(a, b); }
LC_INLINE vd vd_mul(vd a, vd b) { return _mm512_mul_pd(a, b); }
LC_INLINE vd vd_div(vd a, vd b) { return _mm512_div_pd(a, b); }
LC_INLINE vd vd_sel_gt(vd a, vd b, vd x, vd y) { return _mm512_mask_blend_pd(_mm512_cmp_pd_mask(a, b, _CMP_GT_OQ), y, x); }
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wsign-conversion" /* GCC 12 at -O0: its macro of this name passes a mask of 255 as a char */
LC_INLINE vd vd_trunc(vd a) { return _mm512_roundscale_pd(a, _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC); }
#pragma GCC diagnostic pop
LC_INLINE vd vd_low(vf a) { return _mm512_cvtps_pd(_mm512_castps512_ps256(a)); }
LC_INLINE vd vd_high(vf a) { return _mm512_cvtps_pd(_mm512_extractf32x8_ps(a, 1)); }
LC_INLINE vf vf_of(vd low, vd high)
{
    return _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(low)), _mm512_cvtpd_ps(high), 1);
}

#define VD_BITS(name) _mm512_##name
#define VD_AND(a, b) _mm512_and_si512(a, b)
#define VD_OR(a, b) _mm512_or_si512(a, b)
#define VD_XOR(a, b) _mm512_xor_si512(a, b)
#define VD_SET_BITS(a) _mm512_set1_epi64(a)
#define VD_CAST(a) _mm512_castpd_si512(a)
#define VD_OF_BITS(a) _mm512_castsi512_pd(a)
#define VF_CAST(a) _mm512_castps_si512(a)
#define VF_OF_BITS(a) _mm512_castsi512_ps(a)

#endif

#if LC_ISA_LEVEL > 0

LC_INLINE void vf_rows(const float *const *p, size_t at, vf out[4])
{
    vd r[4];
    for (int k = 0; k < 4; k++) r[k] = vd_row(p + k, at);
    vf_transpose(r, out);
}

/* Whole numbers below these stand in the low bits of their sum with them. */
#define VF_2_23 0x1p23f
#define VD_2_52 0x1p52

LC_INLINE vf vf_word(uint32_t word) { return VF_OF_BITS(VD_BITS(set1_epi32)((int)word)); }
LC_INLINE vf vf_and(vf a, vf b) { return VF_OF_BITS(VD_AND(VF_CAST(a), VF_CAST(b))); }
LC_INLINE vf vf_xor(vf a, vf b) { return VF_OF_BITS(VD_XOR(VF_CAST(a), VF_CAST(b))); }
#define vf_shl(a, n) VF_OF_BITS(VD_BITS(slli_epi32)(VF_CAST(a), n))

LC_INLINE vf vf_exponent(vf x)
{
    return vf_sub(VF_OF_BITS(VD_OR(VD_BITS(srli_epi32)(VF_CAST(x), 23), VF_CAST(vf_set(VF_2_23)))), vf_set(VF_2_23 + 127));
}
LC_INLINE vf vf_mantissa(vf x)
{
    return VF_OF_BITS(VD_OR(VD_AND(VF_CAST(x), VD_BITS(set1_epi32)(0x7fffff)), VF_CAST(vf_set(1))));
}
LC_INLINE vf vf_pow2(vf k) { return VF_OF_BITS(VD_BITS(slli_epi32)(VF_CAST(vf_add(k, vf_set(VF_2_23 + 127))), 23)); }

LC_INLINE vd vd_exponent(vd x)
{
    return vd_sub(VD_OF_BITS(VD_OR(VD_BITS(srli_epi64)(VD_CAST(x), 52), VD_CAST(vd_set(VD_2_52)))), vd_set(VD_2_52 + 1023));
}
LC_INLINE vd vd_mantissa(vd x)
{
    return VD_OF_BITS(VD_OR(VD_AND(VD_CAST(x), VD_SET_BITS(0xfffffffffffff)), VD_CAST(vd_set(1))));
}
LC_INLINE vd vd_pow2(vd k) { return VD_OF_BITS(VD_BITS(slli_epi64)(VD_CAST(vd_add(k, vd_set(VD_2_52 + 1023))), 52)); }

#endif

#endif
