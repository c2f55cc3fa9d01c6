/* isa_sse4.c - the kernels, compiled for this instruction set. */
#include "simd/vec_sse4.h"

#include "isa/isa_tmpl.c"

const lc_kernels lc_kernels_sse4 = LC_KERNELS;
