/* bench_array_loop.h - the bounds of bench_arrays.h as plain loops, which the compiler vectorizes. They are
 * inlined into one function for each instruction set, in bench_arrays.c and isa_avx_arrays.c. For the
 * mathematics see shade/bounds_tmpl.c. */
#ifndef LC_BENCH_ARRAY_LOOP_H
#define LC_BENCH_ARRAY_LOOP_H

#include "base/vec.h"
#include "lab/bench_arrays.h"

#define ARRAYS_INLINE static inline __attribute__((always_inline))

/* The rounding slack of shade/bounds_tmpl.c, where each is derived. */
#define U 0x1p-24f
#define SLACK (1 + 0x1p-18f)
#define Z_SLACK (14 * U)
#define R_SLACK (18 * U)
#define NEAR 1e-12f

/* Of a NaN in a and a number b they give b. */
ARRAYS_INLINE float greater(float a, float b) { return a > b ? a : b; }
ARRAYS_INLINE float less(float a, float b) { return a < b ? a : b; }

/* The bound of one lane: c is the box's centre, h its half extent, p its power. */
ARRAYS_INLINE float lane_bound(const bench_receiver *r, float cx, float cy, float cz, float hx, float hy,
                               float hz, float pr, float pg, float pb)
{
    const float nx = r->n[0], ny = r->n[1], nz = r->n[2];
    cx -= r->pos[0];
    cy -= r->pos[1];
    cz -= r->pos[2];
    float ax = fabsf(cx), ay = fabsf(cy), az = fabsf(cz);
    float dx = greater(ax - hx, 0), dy = greater(ay - hy, 0), dz = greater(az - hz, 0);
    float m_sum = (ax + hx) + (ay + hy) + (az + hz);
    float z_slack = m_sum * Z_SLACK + NEAR, r_slack = m_sum * (m_sum * R_SLACK);
    float d2 = dx * dx + dy * dy + dz * dz - r_slack;

    float z = nx * cx + ny * cy + nz * cz;
    float z_half = r->abs_n[0] * hx + r->abs_n[1] * hy + r->abs_n[2] * hz + z_slack;
    float tx = cx - nx * z, ty = cy - ny * z, tz = cz - nz * z;
    float tt = tx * tx + ty * ty + tz * tz;
    float rt = greater(tt - (fabsf(tx) * hx + fabsf(ty) * hy + fabsf(tz) * hz + r_slack), 0);
    float r2 = greater(rt * (rt / tt), 0);
    float z0 = z - z_half, z1 = z + z_half;

    float zz = greater(0.5f * r2, d2 - r2);
    zz = less(greater(zz, z0 * greater(z0, 0)), z1 * z1);
    float inv_q = 1 / greater(greater(zz + r2, d2), r->min_d2);
    float g = sqrtf(greater(zz, r->min_d2) * inv_q) * inv_q;
    float u = r->weight[0] * pr + r->weight[1] * pg + r->weight[2] * pb;
    return z1 > 0 ? u * g : 0;
}

/* The lane whose first word is at b. */
#define LANE_BOUND(r, b)                                                                                     \
    lane_bound(r, (b)[(ROW_CENTER + 0) * LC_LANES], (b)[(ROW_CENTER + 1) * LC_LANES],                        \
               (b)[(ROW_CENTER + 2) * LC_LANES], (b)[(ROW_HALF + 0) * LC_LANES],                             \
               (b)[(ROW_HALF + 1) * LC_LANES], (b)[(ROW_HALF + 2) * LC_LANES],                               \
               (b)[(ROW_POWER + 0) * LC_LANES], (b)[(ROW_POWER + 1) * LC_LANES],                             \
               (b)[(ROW_POWER + 2) * LC_LANES])

/* Bounds of the first `lanes`, a constant, of the clusters index[0 .. n); the last one stands in for those
 * that are missing. */
ARRAYS_INLINE void listed_bounds(const float *word, const uint32_t *index, uint32_t n, uint32_t lanes,
                                 const bench_receiver *r, float *restrict ub)
{
    const int n_lanes = (int)lanes; /* with signed counters GCC 12 vectorizes the loops */
    int32_t at[LC_LANES];
    for (int k = 0; k < n_lanes; k++) {
        uint32_t id = index[(uint32_t)k < n ? (uint32_t)k : n - 1];
        at[k] = (int32_t)(id / LC_LANES * BLOCK_WORDS + id % LC_LANES);
    }
#if defined(__clang__) /* vectorizes only what lies in a row in memory */
    float block[N_BOUND_ROWS * LC_LANES];
    for (int k = 0; k < n_lanes; k++)
        for (int row = 0; row < N_BOUND_ROWS; row++)
            block[row * LC_LANES + k] = word[at[k] + row * LC_LANES];
    for (int k = 0; k < n_lanes; k++) ub[k] = LANE_BOUND(r, block + k);
#else
    for (int k = 0; k < n_lanes; k++) ub[k] = LANE_BOUND(r, word + at[k]);
#endif
}

/* For the arguments see bench_array_bounds_fn. lanes: how many clusters of a list are bounded together, a
 * constant. */
ARRAYS_INLINE void array_bounds(const float *word, const uint32_t *index, uint32_t n, uint32_t lanes,
                                const bench_receiver *receiver, float *restrict ub)
{
    const bench_receiver r = *receiver;
    for (uint32_t i = 0; i < n && !index; i += LC_LANES) {
        const float *block = word + (size_t)i * N_ROWS;
        float *out = ub + i;
        for (int k = 0; k < LC_LANES; k++) out[k] = LANE_BOUND(&r, block + k);
    }
    for (uint32_t i = 0; i < n && index; i += lanes)
        listed_bounds(word, index + i, n - i, lanes, &r, ub + i);
}

#endif
