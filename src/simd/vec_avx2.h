/* vec_avx2.h - vector words in AVX2. See vec_words.h. */
#ifndef LC_VEC_AVX2_H
#define LC_VEC_AVX2_H

#include "base/base.h"

#include <immintrin.h>

#define LC_INLINE static inline __attribute__((always_inline))

#define VF_LANES 8
typedef __m256 vf;
typedef __m256d vd;

LC_INLINE vf vf_set(float a) { return _mm256_set1_ps(a); }
LC_INLINE vf vf_min(vf a, vf b) { return _mm256_min_ps(a, b); }
LC_INLINE vf vf_max(vf a, vf b) { return _mm256_max_ps(a, b); }
LC_INLINE vf vf_sqrt(vf a) { return _mm256_sqrt_ps(a); }
LC_INLINE vf vf_abs(vf a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a); }
LC_INLINE vf vf_sel_gt(vf a, vf b, vf x, vf y)
{
    return _mm256_blendv_ps(y, x, _mm256_cmp_ps(a, b, _CMP_GT_OQ));
}
LC_INLINE bool vf_any_gt(vf a, vf b) { return _mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_GT_OQ)) != 0; }
LC_INLINE vf vf_load(const float *p) { return _mm256_loadu_ps(p); }
LC_INLINE void vf_store(float *p, vf a) { _mm256_storeu_ps(p, a); }

/* Four floats, as two doubles, of p[0] and of p[4]. */
LC_INLINE __m256d load_two(const float *const *p, size_t at)
{
    __m128d low = _mm_loadu_pd((const double *)(const void *)(p[0] + at));
    __m128d high = _mm_loadu_pd((const double *)(const void *)(p[4] + at));
    return _mm256_insertf128_pd(_mm256_castpd128_pd256(low), high, 1);
}
LC_INLINE void vf_rows(const float *const *p, size_t at, vf out[4])
{
    vd r[4], t[4];
    for (int k = 0; k < 4; k++) r[k] = load_two(p + k, at);
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
LC_INLINE vd vd_sel_gt(vd a, vd b, vd x, vd y)
{
    return _mm256_blendv_pd(y, x, _mm256_cmp_pd(a, b, _CMP_GT_OQ));
}
LC_INLINE vd vd_trunc(vd a) { return _mm256_round_pd(a, _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC); }
LC_INLINE vd vd_low(vf a) { return _mm256_cvtps_pd(_mm256_castps256_ps128(a)); }
LC_INLINE vd vd_high(vf a) { return _mm256_cvtps_pd(_mm256_extractf128_ps(a, 1)); }
LC_INLINE vf vf_of(vd low, vd high) { return _mm256_set_m128(_mm256_cvtpd_ps(high), _mm256_cvtpd_ps(low)); }

#include "simd/vec_block_avx.h"

#include "simd/vec_pack.h"

LC_INLINE __m128 vf_pack(__m128 a, uint32_t mask)
{
    const __m128i *table = (const __m128i *)(const void *)vec_pack;
    return _mm_castsi128_ps(_mm_shuffle_epi8(_mm_castps_si128(a), _mm_loadu_si128(table + mask)));
}
LC_INLINE void vb_keep(void *p, vb a, uint32_t mask)
{
    _mm_storeu_ps(p, vf_pack(_mm256_castps256_ps128(a), mask & 15));
    _mm_storeu_ps((float *)p + __builtin_popcount(mask & 15),
                  vf_pack(_mm256_extractf128_ps(a, 1), mask >> 4));
}

#include "simd/vec_words.h"

#endif
