/* vec_words.h - the vector words of the kernels, and those of them that are the same for every instruction
 * set.
 *
 * The room simd/ is the vocabulary of the kernels: a template is written once in these words, and isa_NAME.c
 * compiles it with the words of one instruction set.
 *
 * vec_NAME.h has the types and the words in its own instructions, then includes this file. Arithmetic is
 * written with + - * / on the types; a scalar operand stands for a vector of equal lanes. A lane's bits do
 * not depend on the instruction set: only + - * / sqrt min max and comparisons are used, each the same IEEE
 * operation everywhere, and nothing is fused (-ffp-contract=off).
 *
 *     vf    VF_LANES floats, as many as a register has: 1, 4, 8 or 16; loads and stores need no alignment
 *     vd    half as many doubles; only where VF_LANES > 1
 *     vb    as many lanes of a block of eight (a node's children, a block's triangles) as a register has:
 *           VB_LANES, 1, 4 or 8. Kernels over blocks go `for (k = 0; k < 8; k += VB_LANES)`
 *     vbu   as many words of 32 bits
 *
 *     vf_set(a)               a in every lane
 *     vf_min(a, b)            a < b ? a : b, and vf_max a > b ? a : b: a NaN in a is dropped
 *     vf_sel_gt(a, b, x, y)   x in the lanes where a > b, else y
 *     vf_any_gt(a, b)         whether a > b in some lane
 *     vf_rows(p, at, out)     records: p[i] + at has four floats of lane i; out[0 .. 3] gets them transposed
 *     vf_word(w)              the bits of w in every lane; vf_and, vf_xor, vf_shl work on bits
 *     vd_low, vd_high, vf_of  halves of a vf to double and back, rounded to nearest
 *     vf_exponent, vf_mantissa, vd_..
 *                             x = mantissa 2^exponent with mantissa in [1, 2), x > 0 and normal
 *     vf_pow2(k), vd_pow2(k)  2^k, k whole, 2^k normal
 *
 *     vb_le, _lt, _eq         a bit for each lane; so vb_signs, and vbu_nonzero
 *     vb_load, vb_store       aligned to VB_LANES floats; vb_loadu loads from any address
 *     vb_twice(p)             each of p[0 .. VB_LANES / 2) twice; with one lane: p[0]
 *     vb_keep(p, a, mask)     the lanes in `mask` next to each other, anything to the rest of p[0 ..
 *                             VB_LANES)
 *     vb_fma, vb_fms          a b + c, a b - c, rounded once on some sets and twice on others: only for
 *                             filters that are conservative, so that their rounding decides nothing
 *     vbu_mark_le(m, a, b, w) m | *w in the lanes where a <= b
 */
#ifndef LC_VEC_WORDS_H
#define LC_VEC_WORDS_H

#ifndef VB_LANES /* a register holds no more than a block */
#define VB_LANES VF_LANES
LC_INLINE vb vb_set(float a) { return vf_set(a); }
LC_INLINE vb vb_min(vb a, vb b) { return vf_min(a, b); }
LC_INLINE vb vb_max(vb a, vb b) { return vf_max(a, b); }
LC_INLINE vb vb_abs(vb a) { return vf_abs(a); }
LC_INLINE vb vb_sel_gt(vb a, vb b, vb x, vb y) { return vf_sel_gt(a, b, x, y); }
LC_INLINE vb vb_loadu(const void *p) { return vf_load(p); }
LC_INLINE void vb_rows(const float *const *p, vb out[4]) { vf_rows(p, 0, out); }
#endif

#if VF_LANES > 1

/* The bits of a vector's lanes as whole numbers. */
typedef uint32_t vf_bits __attribute__((vector_size(4 * VF_LANES)));
typedef uint64_t vd_bits __attribute__((vector_size(4 * VF_LANES)));

/* A whole number below one of these is in the low bits of the sum of the two. */
#define VF_2_23 0x1p23f
#define VD_2_52 0x1p52

LC_INLINE vf vf_word(uint32_t word) { return (vf)((vf_bits){ 0 } + word); }
LC_INLINE vf vf_and(vf a, vf b) { return (vf)((vf_bits)a & (vf_bits)b); }
LC_INLINE vf vf_xor(vf a, vf b) { return (vf)((vf_bits)a ^ (vf_bits)b); }
LC_INLINE vf vf_shl(vf a, int n) { return (vf)((vf_bits)a << n); }

LC_INLINE vf vf_exponent(vf x) { return (vf)((vf_bits)x >> 23 | (vf_bits)vf_set(VF_2_23)) - (VF_2_23 + 127); }
LC_INLINE vf vf_mantissa(vf x) { return (vf)(((vf_bits)x & 0x7fffff) | (vf_bits)vf_set(1)); }
LC_INLINE vf vf_pow2(vf k) { return (vf)((vf_bits)(k + (VF_2_23 + 127)) << 23); }

LC_INLINE vd vd_exponent(vd x)
{
    return (vd)((vd_bits)x >> 52 | (vd_bits)vd_set(VD_2_52)) - (VD_2_52 + 1023);
}
LC_INLINE vd vd_mantissa(vd x) { return (vd)(((vd_bits)x & 0xfffffffffffff) | (vd_bits)vd_set(1)); }
LC_INLINE vd vd_pow2(vd k) { return (vd)((vd_bits)(k + (VD_2_52 + 1023)) << 52); }

#endif

#endif
