/* vec.h - vectors of three floats, axis-aligned boxes, triangle vertices; scalar and inline. */
#ifndef LC_VEC_H
#define LC_VEC_H

#include "base/base.h"

#include <float.h>
#include <math.h>

typedef struct lc_f3 {
    float x, y, z;
} lc_f3;

typedef struct lc_box {
    lc_f3 lo, hi; /* empty: lo > hi */
} lc_box;

static inline lc_f3 lc_f3_make(float x, float y, float z) { return (lc_f3){ x, y, z }; }
static inline lc_f3 lc_f3_load(const float *p) { return (lc_f3){ p[0], p[1], p[2] }; }
static inline void lc_f3_store(float *p, lc_f3 a)
{
    p[0] = a.x;
    p[1] = a.y;
    p[2] = a.z;
}
static inline lc_f3 lc_f3_add(lc_f3 a, lc_f3 b) { return (lc_f3){ a.x + b.x, a.y + b.y, a.z + b.z }; }
static inline lc_f3 lc_f3_sub(lc_f3 a, lc_f3 b) { return (lc_f3){ a.x - b.x, a.y - b.y, a.z - b.z }; }
static inline lc_f3 lc_f3_mul(lc_f3 a, lc_f3 b) { return (lc_f3){ a.x * b.x, a.y * b.y, a.z * b.z }; }
static inline lc_f3 lc_f3_scale(lc_f3 a, float s) { return (lc_f3){ a.x * s, a.y * s, a.z * s }; }
static inline lc_f3 lc_f3_neg(lc_f3 a) { return (lc_f3){ -a.x, -a.y, -a.z }; }
static inline float lc_f3_dot(lc_f3 a, lc_f3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline float lc_f3_len(lc_f3 a) { return sqrtf(lc_f3_dot(a, a)); }
static inline float lc_f3_max(lc_f3 a) { return fmaxf(a.x, fmaxf(a.y, a.z)); }
static inline float lc_f3_max_abs(lc_f3 a) { return fmaxf(fabsf(a.x), fmaxf(fabsf(a.y), fabsf(a.z))); }
/* A point on a surface with unit normal n moved off it by 10 ulp of size, the largest coordinate of the
 * surface's corners: an interpolated point is within 4 ulp of the plane; twice that, and 2 for the sum. */
static inline lc_f3 lc_f3_off(lc_f3 p, lc_f3 n, float size)
{
    return lc_f3_add(p, lc_f3_scale(n, 10 * 0x1p-23f * size));
}
static inline bool lc_f3_finite(lc_f3 a) { return isfinite(a.x) && isfinite(a.y) && isfinite(a.z); }

static inline lc_f3 lc_f3_cross(lc_f3 a, lc_f3 b)
{
    return (lc_f3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

/* The unit vector along (x, y, z), computed in double and rounded to float once; the zero vector for zero.
 * Squares of the arguments must neither overflow nor underflow. */
static inline lc_f3 lc_f3_normalize_d(double x, double y, double z)
{
    double l = sqrt(x * x + y * y + z * z);
    if (!(l > 0)) return (lc_f3){ 0, 0, 0 };
    return (lc_f3){ (float)(x / l), (float)(y / l), (float)(z / l) };
}

static inline lc_f3 lc_f3_normalize(lc_f3 a)
{
    return lc_f3_normalize_d((double)a.x, (double)a.y, (double)a.z);
}

/* Vertex v (0..2) of a triangle. pos: vertices * 3; index: triangles * 3. */
static inline const float *lc_tri_vertex(const float *pos, const uint32_t *index, size_t tri, size_t v)
{
    return pos + 3 * (size_t)index[3 * tri + v];
}

/* Rec.709 luminance of linear RGB. */
static inline float lc_luminance(lc_f3 c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

static inline lc_box lc_box_empty(void)
{
    return (lc_box){ { FLT_MAX, FLT_MAX, FLT_MAX }, { -FLT_MAX, -FLT_MAX, -FLT_MAX } };
}

static inline void lc_box_add(lc_box *b, lc_f3 p)
{
    b->lo = lc_f3_make(p.x < b->lo.x ? p.x : b->lo.x, p.y < b->lo.y ? p.y : b->lo.y,
                       p.z < b->lo.z ? p.z : b->lo.z);
    b->hi = lc_f3_make(p.x > b->hi.x ? p.x : b->hi.x, p.y > b->hi.y ? p.y : b->hi.y,
                       p.z > b->hi.z ? p.z : b->hi.z);
}

static inline void lc_box_join(lc_box *b, const lc_box *o)
{
    lc_box_add(b, o->lo);
    lc_box_add(b, o->hi);
}

#endif
