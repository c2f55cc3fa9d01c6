/* vec_avx512.h - vector words in AVX-512. See vec_words.h. */
#ifndef LC_VEC_AVX512_H
#define LC_VEC_AVX512_H

#include "base/base.h"

#include <immintrin.h>

#define LC_INLINE static inline __attribute__((always_inline))

#define VF_LANES 16
typedef __m512 vf;
typedef __m512d vd;

LC_INLINE vf vf_set(float a) { return _mm512_set1_ps(a); }
LC_INLINE vf vf_min(vf a, vf b) { return _mm512_min_ps(a, b); }
LC_INLINE vf vf_max(vf a, vf b) { return _mm512_max_ps(a, b); }
LC_INLINE vf vf_sqrt(vf a) { return _mm512_sqrt_ps(a); }
LC_INLINE vf vf_abs(vf a) { return _mm512_andnot_ps(_mm512_set1_ps(-0.0f), a); }
LC_INLINE vf vf_sel_gt(vf a, vf b, vf x, vf y)
{
    return _mm512_mask_blend_ps(_mm512_cmp_ps_mask(a, b, _CMP_GT_OQ), y, x);
}
LC_INLINE bool vf_any_gt(vf a, vf b) { return _mm512_cmp_ps_mask(a, b, _CMP_GT_OQ) != 0; }
LC_INLINE vf vf_load(const float *p) { return _mm512_loadu_ps(p); }
LC_INLINE void vf_store(float *p, vf a) { _mm512_storeu_ps(p, a); }

/* There are enough registers for the rows of all records and their addresses: kernels load first, then
 * transpose. */
#define VF_LOADS_AHEAD

/* Four floats, as two doubles, of p[0], p[4], p[8] and p[12]. */
LC_INLINE __m128d load_two(const float *p) { return _mm_loadu_pd((const double *)(const void *)p); }
LC_INLINE vd vd_row(const float *const *p, size_t at)
{
    __m256d low = _mm256_insertf128_pd(_mm256_castpd128_pd256(load_two(p[0] + at)), load_two(p[4] + at), 1);
    __m256d high = _mm256_insertf128_pd(_mm256_castpd128_pd256(load_two(p[8] + at)), load_two(p[12] + at), 1);
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
LC_INLINE void vf_rows(const float *const *p, size_t at, vf out[4])
{
    vd r[4];
    for (int k = 0; k < 4; k++) r[k] = vd_row(p + k, at);
    vf_transpose(r, out);
}

LC_INLINE vd vd_set(double a) { return _mm512_set1_pd(a); }
LC_INLINE vd vd_sel_gt(vd a, vd b, vd x, vd y)
{
    return _mm512_mask_blend_pd(_mm512_cmp_pd_mask(a, b, _CMP_GT_OQ), y, x);
}
#pragma GCC diagnostic push
/* GCC 12 at -O0: its macro _mm512_roundscale_pd passes a mask of 255 as a char. */
#pragma GCC diagnostic ignored "-Wsign-conversion"
LC_INLINE vd vd_trunc(vd a) { return _mm512_roundscale_pd(a, _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC); }
#pragma GCC diagnostic pop
LC_INLINE vd vd_low(vf a) { return _mm512_cvtps_pd(_mm512_castps512_ps256(a)); }
LC_INLINE vd vd_high(vf a) { return _mm512_cvtps_pd(_mm512_extractf32x8_ps(a, 1)); }
LC_INLINE vf vf_of(vd low, vd high)
{
    return _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(low)), _mm512_cvtpd_ps(high), 1);
}

#include "simd/vec_block_avx.h"

LC_INLINE void vb_keep(void *p, vb a, uint32_t mask)
{
    _mm256_storeu_ps(p, _mm256_maskz_compress_ps((__mmask8)mask, a));
}

#include "simd/vec_words.h"

#endif
