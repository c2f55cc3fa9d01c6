/* kernels.c - the table. */
#include "kernels.h"

const lc_kernels *lc_kernels_get(lc_isa isa)
{
#if defined(__x86_64__)
    if (isa >= LC_ISA_AVX512) return &lc_kernels_avx512;
    if (isa == LC_ISA_AVX2) return &lc_kernels_avx2;
    if (isa == LC_ISA_SSE4) return &lc_kernels_sse4;
#endif
    (void)isa;
    return &lc_kernels_scalar;
}
