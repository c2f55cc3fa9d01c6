/* isa_neon.c - the kernels, compiled for this instruction set. */
#include "simd/vec_neon.h"

#include "isa/isa_tmpl.c"

const lc_kernels lc_kernels_neon = LC_KERNELS;
