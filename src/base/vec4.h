/* vec4.h - vectors of four floats for code that is compiled once for all CPUs: SSE2, which every x86-64 has,
 * else plain C, with the same bits. A box is two vectors, whose fourth lanes are ignored. */
#ifndef LC_VEC4_H
#define LC_VEC4_H

#include "base/base.h"

#include <float.h>
#include <string.h>

#if defined(__SSE2__)
#include <emmintrin.h>

typedef __m128 f4;
typedef __m128i i4;

static inline f4 f4_load(const void *p) { return _mm_load_ps((const float *)p); } /* 16-byte aligned */
static inline void f4_store(void *p, f4 a) { _mm_store_ps((float *)p, a); }
/* Lanes 0 to 2 from three floats, aligned as floats are; lane 3 is 0. */
static inline f4 f4_load3(const float *p)
{
    return _mm_movelh_ps(_mm_castsi128_ps(_mm_loadl_epi64((const i4 *)(const void *)p)), _mm_load_ss(p + 2));
}
static inline f4 f4_set(float a) { return _mm_set1_ps(a); }
static inline f4 f4_add(f4 a, f4 b) { return _mm_add_ps(a, b); }
static inline f4 f4_sub(f4 a, f4 b) { return _mm_sub_ps(a, b); }
static inline f4 f4_mul(f4 a, f4 b) { return _mm_mul_ps(a, b); }
/* Minimum and maximum; b if either is NaN. */
static inline f4 f4_min(f4 a, f4 b) { return _mm_min_ps(a, b); }
static inline f4 f4_max(f4 a, f4 b) { return _mm_max_ps(a, b); }
/* Bit k is set if lane k of a is less than that of b. */
static inline uint32_t f4_lt(f4 a, f4 b) { return (uint32_t)_mm_movemask_ps(_mm_cmplt_ps(a, b)); }
/* Truncates lanes 0 to 2, each in 0 .. 65535, to integers. */
static inline void f4_to_u3(f4 a, uint32_t out[3])
{
    i4 k = _mm_cvttps_epi32(a);
    out[0] = (uint32_t)_mm_cvtsi128_si32(k);
    out[1] = (uint32_t)_mm_extract_epi16(k, 2);
    out[2] = (uint32_t)_mm_extract_epi16(k, 4);
}
/* In lanes where less < *best, sets *best to less and *best_at to at. */
static inline void f4_keep_less(f4 *best, f4 *best_at, f4 less, f4 at)
{
    f4 m = _mm_cmplt_ps(less, *best);
    *best = _mm_min_ps(less, *best);
    *best_at = _mm_or_ps(_mm_and_ps(m, at), _mm_andnot_ps(m, *best_at));
}
static inline float f4_first(f4 a) { return _mm_cvtss_f32(a); }
static inline float f4_last(f4 a) { return _mm_cvtss_f32(_mm_shuffle_ps(a, a, _MM_SHUFFLE(3, 3, 3, 3))); }
/* Lanes 1 2 0 3. */
static inline f4 f4_turn3(f4 a) { return _mm_shuffle_ps(a, a, _MM_SHUFFLE(3, 0, 2, 1)); }
/* Lanes 0 to 2 of a, the last of b. */
static inline f4 f4_with_last(f4 a, f4 b)
{
    return _mm_shuffle_ps(a, _mm_shuffle_ps(a, b, _MM_SHUFFLE(3, 3, 2, 2)), _MM_SHUFFLE(2, 0, 1, 0));
}
static inline i4 i4_load(const void *p) { return _mm_load_si128((const i4 *)p); }
static inline void i4_store(void *p, i4 a) { _mm_store_si128((i4 *)p, a); }
static inline i4 i4_set(int32_t a) { return _mm_set1_epi32(a); }
static inline i4 i4_add(i4 a, i4 b) { return _mm_add_epi32(a, b); }
/* a / 8, a >= 0 */
static inline i4 i4_div8(i4 a) { return _mm_srli_epi32(a, 3); }
static inline f4 f4_from_i4(i4 a) { return _mm_cvtepi32_ps(a); }
/* Sets out[k] to lane k of a, b, c; its fourth lane is undefined. */
static inline void f4_transpose3(f4 a, f4 b, f4 c, f4 out[3])
{
    f4 ab_lo = _mm_unpacklo_ps(a, b), ab_hi = _mm_unpackhi_ps(a, b); /* ax bx ay by, az bz */
    out[0] = _mm_shuffle_ps(ab_lo, c, _MM_SHUFFLE(3, 0, 1, 0));
    out[1] = _mm_shuffle_ps(ab_lo, c, _MM_SHUFFLE(3, 1, 3, 2));
    out[2] = _mm_shuffle_ps(ab_hi, c, _MM_SHUFFLE(3, 2, 1, 0));
}
/* Sets out[k] to lane k of a, b, c, d. */
static inline void f4_transpose4(f4 a, f4 b, f4 c, f4 d, f4 out[3])
{
    f4 ab_lo = _mm_unpacklo_ps(a, b), cd_lo = _mm_unpacklo_ps(c, d);
    out[0] = _mm_movelh_ps(ab_lo, cd_lo);
    out[1] = _mm_movehl_ps(cd_lo, ab_lo);
    out[2] = _mm_movelh_ps(_mm_unpackhi_ps(a, b), _mm_unpackhi_ps(c, d));
}

#else

typedef struct {
    _Alignas(16) float v[4];
} f4;
typedef struct {
    _Alignas(16) int32_t v[4];
} i4;

static inline f4 f4_load(const void *p)
{
    f4 a;
    memcpy(&a, p, sizeof a);
    return a;
}
static inline void f4_store(void *p, f4 a) { memcpy(p, &a, sizeof a); }
static inline f4 f4_load3(const float *p) { return (f4){ { p[0], p[1], p[2], 0 } }; }
static inline f4 f4_set(float a) { return (f4){ { a, a, a, a } }; }
#define F4_EACH(expr) \
    f4 r; \
    for (int k = 0; k < 4; k++) r.v[k] = (expr); \
    return r
static inline f4 f4_add(f4 a, f4 b) { F4_EACH(a.v[k] + b.v[k]); }
static inline f4 f4_sub(f4 a, f4 b) { F4_EACH(a.v[k] - b.v[k]); }
static inline f4 f4_mul(f4 a, f4 b) { F4_EACH(a.v[k] * b.v[k]); }
static inline f4 f4_min(f4 a, f4 b) { F4_EACH(a.v[k] < b.v[k] ? a.v[k] : b.v[k]); }
static inline f4 f4_max(f4 a, f4 b) { F4_EACH(a.v[k] > b.v[k] ? a.v[k] : b.v[k]); }
static inline uint32_t f4_lt(f4 a, f4 b)
{
    uint32_t bits = 0;
    for (int k = 0; k < 4; k++) bits |= (uint32_t)(a.v[k] < b.v[k]) << k;
    return bits;
}
static inline void f4_to_u3(f4 a, uint32_t out[3])
{
    for (int k = 0; k < 3; k++) out[k] = (uint32_t)a.v[k];
}
static inline void f4_keep_less(f4 *best, f4 *best_at, f4 less, f4 at)
{
    for (int k = 0; k < 4; k++)
        if (less.v[k] < best->v[k]) {
            best->v[k] = less.v[k];
            best_at->v[k] = at.v[k];
        }
}
static inline float f4_first(f4 a) { return a.v[0]; }
static inline float f4_last(f4 a) { return a.v[3]; }
static inline f4 f4_turn3(f4 a) { return (f4){ { a.v[1], a.v[2], a.v[0], a.v[3] } }; }
static inline f4 f4_with_last(f4 a, f4 b) { return (f4){ { a.v[0], a.v[1], a.v[2], b.v[3] } }; }
static inline i4 i4_load(const void *p)
{
    i4 a;
    memcpy(&a, p, sizeof a);
    return a;
}
static inline void i4_store(void *p, i4 a) { memcpy(p, &a, sizeof a); }
static inline i4 i4_set(int32_t a) { return (i4){ { a, a, a, a } }; }
static inline i4 i4_add(i4 a, i4 b)
{
    for (int k = 0; k < 4; k++) a.v[k] += b.v[k];
    return a;
}
static inline i4 i4_div8(i4 a)
{
    for (int k = 0; k < 4; k++) a.v[k] /= 8;
    return a;
}
static inline f4 f4_from_i4(i4 a) { F4_EACH((float)a.v[k]); }
static inline void f4_transpose3(f4 a, f4 b, f4 c, f4 out[3])
{
    for (int k = 0; k < 3; k++) out[k] = (f4){ { a.v[k], b.v[k], c.v[k], 0 } };
}
static inline void f4_transpose4(f4 a, f4 b, f4 c, f4 d, f4 out[3])
{
    for (int k = 0; k < 3; k++) out[k] = (f4){ { a.v[k], b.v[k], c.v[k], d.v[k] } };
}
#undef F4_EACH

#endif

typedef struct f4_box {
    f4 lo, hi; /* empty: lo > hi */
} f4_box;

static inline f4_box f4_box_empty(void) { return (f4_box){ f4_set(FLT_MAX), f4_set(-FLT_MAX) }; }

static inline f4_box f4_box_join(f4_box a, f4_box b)
{
    return (f4_box){ f4_min(a.lo, b.lo), f4_max(a.hi, b.hi) };
}

/* Half the surface area of each of three boxes, in lanes 0 to 2. */
static inline f4 f4_areas(const f4_box box[3])
{
    f4 d[3];
    f4_transpose3(f4_sub(box[0].hi, box[0].lo), f4_sub(box[1].hi, box[1].lo), f4_sub(box[2].hi, box[2].lo),
                  d);
    return f4_add(f4_add(f4_mul(d[0], d[1]), f4_mul(d[1], d[2])), f4_mul(d[2], d[0]));
}

#endif
