/* vec_block_avx.h - the lanes of a block of eight in one register of AVX2, for every set that has it. See
 * vec_words.h; vb_keep is the sets' own. */
#ifndef LC_VEC_BLOCK_AVX_H
#define LC_VEC_BLOCK_AVX_H

#define VB_LANES 8
typedef __m256 vb;
typedef __m256i vbu;

LC_INLINE vb vb_set(float a) { return _mm256_set1_ps(a); }
LC_INLINE vb vb_min(vb a, vb b) { return _mm256_min_ps(a, b); }
LC_INLINE vb vb_max(vb a, vb b) { return _mm256_max_ps(a, b); }
LC_INLINE uint32_t vb_le(vb a, vb b) { return (uint32_t)_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LE_OQ)); }
LC_INLINE uint32_t vb_lt(vb a, vb b) { return (uint32_t)_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LT_OQ)); }
LC_INLINE uint32_t vb_eq(vb a, vb b) { return (uint32_t)_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_EQ_OQ)); }
LC_INLINE vb vb_abs(vb a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a); }
LC_INLINE vb vb_sel_gt(vb a, vb b, vb x, vb y)
{
    return _mm256_blendv_ps(y, x, _mm256_cmp_ps(a, b, _CMP_GT_OQ));
}
LC_INLINE vb vb_fma(vb a, vb b, vb c) { return _mm256_fmadd_ps(a, b, c); }
LC_INLINE vb vb_fms(vb a, vb b, vb c) { return _mm256_fmsub_ps(a, b, c); }
LC_INLINE void vb_rows(const float *const *p, vb out[4])
{
    __m256 r[4];
    for (int k = 0; k < 4; k++)
        r[k] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(p[k])), _mm_loadu_ps(p[k + 4]), 1);
    __m256d ab = _mm256_castps_pd(_mm256_unpacklo_ps(r[0], r[1]));
    __m256d cd = _mm256_castps_pd(_mm256_unpacklo_ps(r[2], r[3]));
    __m256d ef = _mm256_castps_pd(_mm256_unpackhi_ps(r[0], r[1]));
    __m256d gh = _mm256_castps_pd(_mm256_unpackhi_ps(r[2], r[3]));
    out[0] = _mm256_castpd_ps(_mm256_unpacklo_pd(ab, cd));
    out[1] = _mm256_castpd_ps(_mm256_unpackhi_pd(ab, cd));
    out[2] = _mm256_castpd_ps(_mm256_unpacklo_pd(ef, gh));
    out[3] = _mm256_castpd_ps(_mm256_unpackhi_pd(ef, gh));
}

/* ---- lists ---- */

LC_INLINE vb vb_load(const float *p) { return _mm256_load_ps(p); }
LC_INLINE void vb_store(float *p, vb a) { _mm256_store_ps(p, a); }
LC_INLINE vb vb_loadu(const void *p) { return _mm256_loadu_ps(p); }
LC_INLINE vb vb_twice(const void *p)
{
    __m128 a = _mm_loadu_ps(p);
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_unpacklo_ps(a, a)), _mm_unpackhi_ps(a, a), 1);
}
LC_INLINE vb vb_or(vb a, vb b) { return _mm256_or_ps(a, b); }
LC_INLINE uint32_t vb_signs(vb a) { return (uint32_t)_mm256_movemask_ps(a); }

/* ---- rays ---- */

LC_INLINE vbu vbu_zero(void) { return _mm256_setzero_si256(); }
LC_INLINE vbu vbu_mark_le(vbu m, vb a, vb b, const uint32_t *word)
{
    const __m256i le = _mm256_castps_si256(_mm256_cmp_ps(a, b, _CMP_LE_OQ));
    return _mm256_or_si256(m, _mm256_and_si256(le, _mm256_set1_epi32((int)*word)));
}
LC_INLINE uint32_t vbu_nonzero(vbu a)
{
    const __m256i z = _mm256_cmpeq_epi32(a, _mm256_setzero_si256());
    return (uint32_t)~_mm256_movemask_ps(_mm256_castsi256_ps(z)) & 255;
}
LC_INLINE void vbu_store(uint32_t *p, vbu a) { _mm256_store_si256((__m256i *)(void *)p, a); }

#endif
