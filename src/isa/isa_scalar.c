/* isa_scalar.c - the kernels, compiled for this instruction set. */
#include "simd/vec_scalar.h"

#include "isa/isa_tmpl.c"

const lc_kernels lc_kernels_scalar = LC_KERNELS;
