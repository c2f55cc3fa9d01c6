/* vec_sse4.h - vector words in SSE4.1. See vec_words.h. */
#ifndef LC_VEC_SSE4_H
#define LC_VEC_SSE4_H

#include "base/base.h"

#include <immintrin.h>
#include <string.h>

#define LC_INLINE static inline __attribute__((always_inline))

/* ---- vf, vd ---- */

#define VF_LANES 4
typedef __m128 vf;
typedef __m128d vd;

LC_INLINE vf vf_set(float a) { return _mm_set1_ps(a); }
LC_INLINE vf vf_min(vf a, vf b) { return _mm_min_ps(a, b); }
LC_INLINE vf vf_max(vf a, vf b) { return _mm_max_ps(a, b); }
LC_INLINE vf vf_sqrt(vf a) { return _mm_sqrt_ps(a); }
LC_INLINE vf vf_abs(vf a) { return _mm_andnot_ps(_mm_set1_ps(-0.0f), a); }
LC_INLINE vf vf_sel_gt(vf a, vf b, vf x, vf y) { return _mm_blendv_ps(y, x, _mm_cmpgt_ps(a, b)); }
LC_INLINE bool vf_any_gt(vf a, vf b) { return _mm_movemask_ps(_mm_cmpgt_ps(a, b)) != 0; }
LC_INLINE vf vf_load(const float *p) { return _mm_loadu_ps(p); }
LC_INLINE void vf_store(float *p, vf a) { _mm_storeu_ps(p, a); }
LC_INLINE void vf_rows(const float *const *p, size_t at, vf out[4])
{
    for (int k = 0; k < 4; k++) out[k] = _mm_loadu_ps(p[k] + at);
    _MM_TRANSPOSE4_PS(out[0], out[1], out[2], out[3]);
}

LC_INLINE vd vd_set(double a) { return _mm_set1_pd(a); }
LC_INLINE vd vd_sel_gt(vd a, vd b, vd x, vd y) { return _mm_blendv_pd(y, x, _mm_cmpgt_pd(a, b)); }
LC_INLINE vd vd_trunc(vd a) { return _mm_round_pd(a, _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC); }
LC_INLINE vd vd_low(vf a) { return _mm_cvtps_pd(a); }
LC_INLINE vd vd_high(vf a) { return _mm_cvtps_pd(_mm_movehl_ps(a, a)); }
LC_INLINE vf vf_of(vd low, vd high) { return _mm_movelh_ps(_mm_cvtpd_ps(low), _mm_cvtpd_ps(high)); }

/* ---- vb ---- */

typedef __m128 vb;
typedef __m128i vbu;

LC_INLINE vb vb_load(const float *p) { return _mm_load_ps(p); }
LC_INLINE void vb_store(float *p, vb a) { _mm_store_ps(p, a); }
LC_INLINE uint32_t vb_le(vb a, vb b) { return (uint32_t)_mm_movemask_ps(_mm_cmple_ps(a, b)); }
LC_INLINE uint32_t vb_lt(vb a, vb b) { return (uint32_t)_mm_movemask_ps(_mm_cmplt_ps(a, b)); }
LC_INLINE uint32_t vb_eq(vb a, vb b) { return (uint32_t)_mm_movemask_ps(_mm_cmpeq_ps(a, b)); }
LC_INLINE vb vb_fma(vb a, vb b, vb c) { return a * b + c; }
LC_INLINE vb vb_fms(vb a, vb b, vb c) { return a * b - c; }
LC_INLINE vb vb_twice(const void *p)
{
    double two; /* p need not be aligned */
    memcpy(&two, p, sizeof two);
    __m128 a = _mm_castpd_ps(_mm_set_sd(two));
    return _mm_unpacklo_ps(a, a);
}
LC_INLINE vb vb_or(vb a, vb b) { return _mm_or_ps(a, b); }
LC_INLINE uint32_t vb_signs(vb a) { return (uint32_t)_mm_movemask_ps(a); }

#include "simd/vec_pack.h"

LC_INLINE void vb_keep(void *p, vb a, uint32_t mask)
{
    const __m128i *table = (const __m128i *)(const void *)vec_pack;
    _mm_storeu_ps(p, _mm_castsi128_ps(_mm_shuffle_epi8(_mm_castps_si128(a), _mm_loadu_si128(table + mask))));
}

LC_INLINE vbu vbu_zero(void) { return _mm_setzero_si128(); }
LC_INLINE vbu vbu_mark_le(vbu m, vb a, vb b, const uint32_t *word)
{
    const __m128i le = _mm_castps_si128(_mm_cmple_ps(a, b));
    return _mm_or_si128(m, _mm_and_si128(le, _mm_set1_epi32((int)*word)));
}
LC_INLINE uint32_t vbu_nonzero(vbu a)
{
    const __m128i z = _mm_cmpeq_epi32(a, _mm_setzero_si128());
    return (uint32_t)~_mm_movemask_ps(_mm_castsi128_ps(z)) & 15;
}
LC_INLINE void vbu_store(uint32_t *p, vbu a) { _mm_store_si128((__m128i *)(void *)p, a); }

#include "simd/vec_words.h"

#endif
