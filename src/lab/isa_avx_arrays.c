/* isa_avx_arrays.c - the loops of bench_array_loop.h for AVX2 and AVX-512. Lint lets only files of such names
 * hold AVX instructions; bench_array_bounds returns these functions only where the processor has them. */
#include "lab/bench_arrays.h"

#if defined(__x86_64__)

#include "lab/bench_array_loop.h"

/* Registers of 16 lanes; by default compilers use half of them. */
#if defined(__clang__)
#define WIDE __attribute__((target("avx2,avx512f,avx512vl,avx512dq"), min_vector_width(512)))
#else
#define WIDE __attribute__((target("avx2,avx512f,avx512vl,avx512dq,prefer-vector-width=512")))
#endif

__attribute__((target("avx2"))) void bench_array_bounds_avx2(const float *word, const uint32_t *index,
                                                             uint32_t n, const bench_receiver *r, float *ub)
{
    array_bounds(word, index, n, 8, r, ub);
}

WIDE void bench_array_bounds_avx512(const float *word, const uint32_t *index, uint32_t n,
                                    const bench_receiver *r, float *ub)
{
    array_bounds(word, index, n, 8, r, ub);
}

#endif
