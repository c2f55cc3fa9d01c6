/* vec_neon.h - vector words in NEON of 64-bit ARM. See vec_words.h.
 *
 * vminq and vmaxq keep a NaN of either side, so minima and maxima are a comparison and a selection.
 */
#ifndef LC_VEC_NEON_H
#define LC_VEC_NEON_H

#include "base/base.h"

#include <arm_neon.h>

#define LC_INLINE static inline __attribute__((always_inline))

/* ---- vf, vd ---- */

#define VF_LANES 4
typedef float32x4_t vf;
typedef float64x2_t vd;

LC_INLINE vf vf_set(float a) { return vdupq_n_f32(a); }
LC_INLINE vf vf_min(vf a, vf b) { return vbslq_f32(vcltq_f32(a, b), a, b); }
LC_INLINE vf vf_max(vf a, vf b) { return vbslq_f32(vcgtq_f32(a, b), a, b); }
LC_INLINE vf vf_sqrt(vf a) { return vsqrtq_f32(a); }
LC_INLINE vf vf_abs(vf a) { return vabsq_f32(a); }
LC_INLINE vf vf_sel_gt(vf a, vf b, vf x, vf y) { return vbslq_f32(vcgtq_f32(a, b), x, y); }
LC_INLINE bool vf_any_gt(vf a, vf b) { return vmaxvq_u32(vcgtq_f32(a, b)) != 0; }
LC_INLINE vf vf_load(const float *p) { return vld1q_f32(p); }
LC_INLINE void vf_store(float *p, vf a) { vst1q_f32(p, a); }
LC_INLINE void vf_rows(const float *const *p, size_t at, vf out[4])
{
    const vf a = vld1q_f32(p[0] + at), b = vld1q_f32(p[1] + at), c = vld1q_f32(p[2] + at),
             d = vld1q_f32(p[3] + at);
    const vd ac_low = (vd)vzip1q_f32(a, c), ac_high = (vd)vzip2q_f32(a, c); /* a0 c0 a1 c1, a2 c2 a3 c3 */
    const vd bd_low = (vd)vzip1q_f32(b, d), bd_high = (vd)vzip2q_f32(b, d);
    out[0] = vzip1q_f32((vf)ac_low, (vf)bd_low);
    out[1] = vzip2q_f32((vf)ac_low, (vf)bd_low);
    out[2] = vzip1q_f32((vf)ac_high, (vf)bd_high);
    out[3] = vzip2q_f32((vf)ac_high, (vf)bd_high);
}

LC_INLINE vd vd_set(double a) { return vdupq_n_f64(a); }
LC_INLINE vd vd_sel_gt(vd a, vd b, vd x, vd y) { return vbslq_f64(vcgtq_f64(a, b), x, y); }
LC_INLINE vd vd_trunc(vd a) { return vrndq_f64(a); }
LC_INLINE vd vd_low(vf a) { return vcvt_f64_f32(vget_low_f32(a)); }
LC_INLINE vd vd_high(vf a) { return vcvt_high_f64_f32(a); }
LC_INLINE vf vf_of(vd low, vd high) { return vcvt_high_f32_f64(vcvt_f32_f64(low), high); }

/* ---- vb ---- */

typedef float32x4_t vb;
typedef uint32x4_t vbu;

/* A bit for each lane of a mask whose lanes have all bits set or none. */
LC_INLINE uint32_t vb_mask(uint32x4_t mask)
{
    const uint32x4_t bit = { 1, 2, 4, 8 };
    return vaddvq_u32(vandq_u32(mask, bit));
}

LC_INLINE vb vb_load(const float *p) { return vld1q_f32(p); }
LC_INLINE void vb_store(float *p, vb a) { vst1q_f32(p, a); }
LC_INLINE uint32_t vb_le(vb a, vb b) { return vb_mask(vcleq_f32(a, b)); }
LC_INLINE uint32_t vb_lt(vb a, vb b) { return vb_mask(vcltq_f32(a, b)); }
LC_INLINE uint32_t vb_eq(vb a, vb b) { return vb_mask(vceqq_f32(a, b)); }
LC_INLINE vb vb_fma(vb a, vb b, vb c) { return vfmaq_f32(c, a, b); }
LC_INLINE vb vb_fms(vb a, vb b, vb c) { return vfmaq_f32(-c, a, b); }
LC_INLINE vb vb_twice(const void *p)
{
    const vb a = vcombine_f32(vld1_f32(p), vdup_n_f32(0));
    return vzip1q_f32(a, a);
}
LC_INLINE vb vb_or(vb a, vb b) { return (vb)((vbu)a | (vbu)b); }
LC_INLINE uint32_t vb_signs(vb a) { return vb_mask(vcltzq_s32((int32x4_t)a)); }

#include "simd/vec_pack.h"

LC_INLINE void vb_keep(void *p, vb a, uint32_t mask)
{
    vst1q_f32(p, (vb)vqtbl1q_u8((uint8x16_t)a, (uint8x16_t)vld1q_s8(vec_pack[mask])));
}

LC_INLINE vbu vbu_zero(void) { return vdupq_n_u32(0); }
LC_INLINE vbu vbu_mark_le(vbu m, vb a, vb b, const uint32_t *word) { return m | (vcleq_f32(a, b) & *word); }
LC_INLINE uint32_t vbu_nonzero(vbu a) { return vb_mask(vtstq_u32(a, a)); }
LC_INLINE void vbu_store(uint32_t *p, vbu a) { vst1q_u32(p, a); }

#include "simd/vec_words.h"

#endif
