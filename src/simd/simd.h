/* simd.h - eight floats at a time on every instruction set, for the templates that isa_*.c compile.
 *
 * vf8_sel_gt(a, b, x, y) is x in the lanes where a > b, else y. vf8_rows takes four floats
 * from each of eight places, transposed: the first of all to out[0].
 * LC_ISA_LEVEL: 0 plain C, 1 SSE4.1 (two registers), 2 AVX2, 3 AVX-512 (one). Only + - * / sqrt min max and comparisons: each is the
 * same IEEE operation on every level, so the bits agree. vf8_min(a, b) is b where a is not less (as minps), so a NaN
 * in a is dropped. Masks are one bit a lane.
 */
#ifndef LC_SIMD_H
#define LC_SIMD_H

#include "base/base.h"

#include <math.h>

#if LC_ISA_LEVEL == 0

typedef struct vf8 {
    float v[8];
} vf8;

#define VF8_LANES(expr)                                                                                               \
    vf8 r;                                                                                                            \
    for (int i = 0; i < 8; i++) r.v[i] = (expr);                                                                      \
    return r
#define VF8_BITS(expr)                                                                                                \
    uint32_t r = 0;                                                                                                   \
    for (int i = 0; i < 8; i++) r |= (uint32_t)((expr) != 0) << i;                                                    \
    return r

static inline vf8 vf8_load(const float *p) { VF8_LANES(p[i]); }
static inline vf8 vf8_set(float a) { VF8_LANES(a); }
static inline vf8 vf8_add(vf8 a, vf8 b) { VF8_LANES(a.v[i] + b.v[i]); }
static inline vf8 vf8_sub(vf8 a, vf8 b) { VF8_LANES(a.v[i] - b.v[i]); }
static inline vf8 vf8_mul(vf8 a, vf8 b) { VF8_LANES(a.v[i] * b.v[i]); }
static inline vf8 vf8_div(vf8 a, vf8 b) { VF8_LANES(a.v[i] / b.v[i]); }
static inline vf8 vf8_min(vf8 a, vf8 b) { VF8_LANES(a.v[i] < b.v[i] ? a.v[i] : b.v[i]); }
static inline vf8 vf8_max(vf8 a, vf8 b) { VF8_LANES(a.v[i] > b.v[i] ? a.v[i] : b.v[i]); }
static inline uint32_t vf8_le(vf8 a, vf8 b) { VF8_BITS(a.v[i] <= b.v[i]); }
static inline uint32_t vf8_lt(vf8 a, vf8 b) { VF8_BITS(a.v[i] < b.v[i]); }
static inline uint32_t vf8_eq(vf8 a, vf8 b) { VF8_BITS(a.v[i] == b.v[i]); }
static inline vf8 vf8_sqrt(vf8 a) { VF8_LANES(sqrtf(a.v[i])); }
static inline vf8 vf8_abs(vf8 a) { VF8_LANES(fabsf(a.v[i])); }
static inline vf8 vf8_sel_gt(vf8 a, vf8 b, vf8 x, vf8 y) { VF8_LANES(a.v[i] > b.v[i] ? x.v[i] : y.v[i]); }
static inline void vf8_rows(const float *const p[8], vf8 out[4])
{
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 4; k++) out[k].v[i] = p[i][k];
}
static inline void vf8_store(float *p, vf8 a)
{
    for (int i = 0; i < 8; i++) p[i] = a.v[i];
}

#elif LC_ISA_LEVEL == 1

#include <immintrin.h>

typedef struct vf8 {
    __m128 a, b;
} vf8;

#define VF8_BOTH(f) return (vf8){ f(x.a, y.a), f(x.b, y.b) }
#define VF8_MASK(f) return (uint32_t)_mm_movemask_ps(f(x.a, y.a)) | (uint32_t)_mm_movemask_ps(f(x.b, y.b)) << 4

static inline vf8 vf8_load(const float *p) { return (vf8){ _mm_load_ps(p), _mm_load_ps(p + 4) }; }
static inline vf8 vf8_set(float a) { return (vf8){ _mm_set1_ps(a), _mm_set1_ps(a) }; }
static inline vf8 vf8_add(vf8 x, vf8 y) { VF8_BOTH(_mm_add_ps); }
static inline vf8 vf8_sub(vf8 x, vf8 y) { VF8_BOTH(_mm_sub_ps); }
static inline vf8 vf8_mul(vf8 x, vf8 y) { VF8_BOTH(_mm_mul_ps); }
static inline vf8 vf8_div(vf8 x, vf8 y) { VF8_BOTH(_mm_div_ps); }
static inline vf8 vf8_min(vf8 x, vf8 y) { VF8_BOTH(_mm_min_ps); }
static inline vf8 vf8_max(vf8 x, vf8 y) { VF8_BOTH(_mm_max_ps); }
static inline uint32_t vf8_le(vf8 x, vf8 y) { VF8_MASK(_mm_cmple_ps); }
static inline uint32_t vf8_lt(vf8 x, vf8 y) { VF8_MASK(_mm_cmplt_ps); }
static inline uint32_t vf8_eq(vf8 x, vf8 y) { VF8_MASK(_mm_cmpeq_ps); }
static inline vf8 vf8_sqrt(vf8 x) { return (vf8){ _mm_sqrt_ps(x.a), _mm_sqrt_ps(x.b) }; }
static inline vf8 vf8_abs(vf8 x)
{
    const __m128 sign = _mm_set1_ps(-0.0f);
    return (vf8){ _mm_andnot_ps(sign, x.a), _mm_andnot_ps(sign, x.b) };
}
static inline vf8 vf8_sel_gt(vf8 a, vf8 b, vf8 x, vf8 y)
{
    return (vf8){ _mm_blendv_ps(y.a, x.a, _mm_cmpgt_ps(a.a, b.a)), _mm_blendv_ps(y.b, x.b, _mm_cmpgt_ps(a.b, b.b)) };
}
static inline void vf8_rows(const float *const p[8], vf8 out[4])
{
    __m128 a[4], b[4];
    for (int k = 0; k < 4; k++) {
        a[k] = _mm_loadu_ps(p[k]);
        b[k] = _mm_loadu_ps(p[k + 4]);
    }
    _MM_TRANSPOSE4_PS(a[0], a[1], a[2], a[3]);
    _MM_TRANSPOSE4_PS(b[0], b[1], b[2], b[3]);
    for (int k = 0; k < 4; k++) out[k] = (vf8){ a[k], b[k] };
}
static inline void vf8_store(float *p, vf8 x)
{
    _mm_store_ps(p, x.a);
    _mm_store_ps(p + 4, x.b);
}

#else

#include <immintrin.h>

typedef __m256 vf8;

static inline vf8 vf8_load(const float *p) { return _mm256_load_ps(p); }
static inline vf8 vf8_set(float a) { return _mm256_set1_ps(a); }
static inline vf8 vf8_add(vf8 a, vf8 b) { return _mm256_add_ps(a, b); }
static inline vf8 vf8_sub(vf8 a, vf8 b) { return _mm256_sub_ps(a, b); }
static inline vf8 vf8_mul(vf8 a, vf8 b) { return _mm256_mul_ps(a, b); }
static inline vf8 vf8_div(vf8 a, vf8 b) { return _mm256_div_ps(a, b); }
static inline vf8 vf8_min(vf8 a, vf8 b) { return _mm256_min_ps(a, b); }
static inline vf8 vf8_max(vf8 a, vf8 b) { return _mm256_max_ps(a, b); }
static inline uint32_t vf8_le(vf8 a, vf8 b) { return (uint32_t)_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ)); }
static inline uint32_t vf8_lt(vf8 a, vf8 b) { return (uint32_t)_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LT_OQ)); }
static inline uint32_t vf8_eq(vf8 a, vf8 b) { return (uint32_t)_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_EQ_OQ)); }
static inline vf8 vf8_sqrt(vf8 a) { return _mm256_sqrt_ps(a); }
static inline vf8 vf8_abs(vf8 a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a); }
static inline vf8 vf8_sel_gt(vf8 a, vf8 b, vf8 x, vf8 y)
{
    return _mm256_blendv_ps(y, x, _mm256_cmp_ps(a, b, _CMP_GT_OQ));
}
static inline void vf8_rows(const float *const p[8], vf8 out[4])
{
    __m256 r[4];
    for (int k = 0; k < 4; k++) r[k] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(p[k])), _mm_loadu_ps(p[k + 4]), 1);
    __m256d ab = _mm256_castps_pd(_mm256_unpacklo_ps(r[0], r[1])), cd = _mm256_castps_pd(_mm256_unpacklo_ps(r[2], r[3]));
    __m256d ef = _mm256_castps_pd(_mm256_unpackhi_ps(r[0], r[1])), gh = _mm256_castps_pd(_mm256_unpackhi_ps(r[2], r[3]));
    out[0] = _mm256_castpd_ps(_mm256_unpacklo_pd(ab, cd));
    out[1] = _mm256_castpd_ps(_mm256_unpackhi_pd(ab, cd));
    out[2] = _mm256_castpd_ps(_mm256_unpacklo_pd(ef, gh));
    out[3] = _mm256_castpd_ps(_mm256_unpackhi_pd(ef, gh));
}
static inline void vf8_store(float *p, vf8 a) { _mm256_store_ps(p, a); }

#endif

#endif
