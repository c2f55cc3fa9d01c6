/* isa_avx2.c - the kernels, compiled for this instruction set. */
#include "simd/vec_avx2.h"

#include "isa/isa_tmpl.c"

const lc_kernels lc_kernels_avx2 = LC_KERNELS;
