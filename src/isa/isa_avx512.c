/* isa_avx512.c - the kernels, compiled for this instruction set. The BVH stays at eight lanes, as its nodes
 * have eight children. */
#define LC_HALF_AS_WIDE lc_kernels_avx2 /* computes the rest of a list at half the cost */
#include "simd/vec_avx512.h"

#include "isa/isa_tmpl.c"

const lc_kernels lc_kernels_avx512 = LC_KERNELS;
