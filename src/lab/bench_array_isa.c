/* bench_array_isa.c - the function that bounds clusters in arrays for each instruction set, but for those of
 * isa_avx_arrays.c. */
#include "lab/bench_array_loop.h"

bench_receiver bench_receiver_of(const lc_point *p)
{
    static const float luminance[3] = { 0.2126f, 0.7152f, 0.0722f };
    bench_receiver r = { .min_d2 = p->min_d2 };
    for (int k = 0; k < 3; k++) {
        r.pos[k] = p->pos[k];
        r.n[k] = p->n[k];
        r.abs_n[k] = fabsf(p->n[k]);
        r.weight[k] = luminance[k] * SLACK * p->diffuse[k];
    }
    return r;
}

/* A lane at a time: the statement keeps the compiler from making vectors of the loop. */
static void bounds_scalar(const float *word, const uint32_t *index, uint32_t n, const bench_receiver *r,
                          float *ub)
{
    for (uint32_t i = 0; i < n; i++) {
        uint32_t id = index ? index[i] : i;
        const float *lane = word + (size_t)(id / LC_LANES) * BLOCK_WORDS + id % LC_LANES;
        ub[i] = LANE_BOUND(r, lane);
        __asm__ volatile("");
    }
}

#if defined(__x86_64__)
__attribute__((target("sse4.1"))) static void bounds_sse4(const float *word, const uint32_t *index,
                                                          uint32_t n, const bench_receiver *r, float *ub)
{
    array_bounds(word, index, n, 4, r, ub);
}
#endif

bench_array_bounds_fn *bench_array_bounds(lc_isa isa)
{
    switch ((int)isa) {
#if defined(__x86_64__)
    case LC_ISA_ID_sse4: return bounds_sse4;
    case LC_ISA_ID_avx2: return bench_array_bounds_avx2;
    case LC_ISA_ID_avx512: return bench_array_bounds_avx512;
#endif
    default: return bounds_scalar;
    }
}
