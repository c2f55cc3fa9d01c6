/* vec_scalar.h - vector words in plain C: one float at a time. See vec_words.h. */
#ifndef LC_VEC_SCALAR_H
#define LC_VEC_SCALAR_H

#include "base/base.h"

#include <math.h>
#include <string.h>

#define LC_INLINE static inline __attribute__((always_inline))

/* ---- vf ---- */

#define VF_LANES 1
typedef float vf;

LC_INLINE vf vf_set(float a) { return a; }
LC_INLINE vf vf_min(vf a, vf b) { return a < b ? a : b; }
LC_INLINE vf vf_max(vf a, vf b) { return a > b ? a : b; }
LC_INLINE vf vf_sqrt(vf a) { return sqrtf(a); }
LC_INLINE vf vf_abs(vf a) { return fabsf(a); }
LC_INLINE vf vf_sel_gt(vf a, vf b, vf x, vf y) { return a > b ? x : y; }
LC_INLINE bool vf_any_gt(vf a, vf b) { return a > b; }
LC_INLINE vf vf_load(const float *p) { return *p; }
LC_INLINE void vf_store(float *p, vf a) { *p = a; }
LC_INLINE void vf_rows(const float *const *p, size_t at, vf out[4])
{
    for (size_t k = 0; k < 4; k++) out[k] = p[0][at + k];
}
LC_INLINE uint32_t vf_to_bits(float a)
{
    uint32_t bits;
    memcpy(&bits, &a, sizeof bits);
    return bits;
}
LC_INLINE vf vf_word(uint32_t bits)
{
    float a;
    memcpy(&a, &bits, sizeof a);
    return a;
}
LC_INLINE vf vf_and(vf a, vf b) { return vf_word(vf_to_bits(a) & vf_to_bits(b)); }
LC_INLINE vf vf_xor(vf a, vf b) { return vf_word(vf_to_bits(a) ^ vf_to_bits(b)); }
LC_INLINE vf vf_shl(vf a, int n) { return vf_word(vf_to_bits(a) << n); }
LC_INLINE vf vf_exponent(vf x) { return (float)((int)(vf_to_bits(x) >> 23) - 127); }
LC_INLINE vf vf_mantissa(vf x) { return vf_word((vf_to_bits(x) & 0x7fffff) | vf_to_bits(1)); }
LC_INLINE vf vf_pow2(vf k) { return vf_word((uint32_t)((int)k + 127) << 23); }

/* ---- vb: a block's lanes one after another ---- */

typedef float vb;
typedef uint32_t vbu;

LC_INLINE vb vb_load(const float *p) { return *p; }
LC_INLINE void vb_store(float *p, vb a) { *p = a; }
LC_INLINE uint32_t vb_le(vb a, vb b) { return a <= b; }
LC_INLINE uint32_t vb_lt(vb a, vb b) { return a < b; }
LC_INLINE uint32_t vb_eq(vb a, vb b) { return a <= b && a >= b; }
LC_INLINE vb vb_fma(vb a, vb b, vb c) { return a * b + c; }
LC_INLINE vb vb_fms(vb a, vb b, vb c) { return a * b - c; }
LC_INLINE vb vb_twice(const void *p) { return *(const float *)p; }
LC_INLINE vb vb_or(vb a, vb b) { return vf_word(vf_to_bits(a) | vf_to_bits(b)); }
LC_INLINE uint32_t vb_signs(vb a) { return vf_to_bits(a) >> 31; }
LC_INLINE void vb_keep(void *p, vb a, uint32_t mask)
{
    if (mask) memcpy(p, &a, sizeof a);
}
LC_INLINE vbu vbu_zero(void) { return 0; }
LC_INLINE vbu vbu_mark_le(vbu m, vb a, vb b, const uint32_t *word) { return a <= b ? m | *word : m; }
LC_INLINE uint32_t vbu_nonzero(vbu a) { return a != 0; }
LC_INLINE void vbu_store(uint32_t *p, vbu a) { *p = a; }

#include "simd/vec_words.h"

#endif
