/* cpu.c - asks CPU (cpuid, xgetbv through the compiler's builtin) and scheduler. */
#include "cpu.h"

#include <sched.h>

lc_isa lc_cpu_isa(void)
{
#if defined(__x86_64__)
    __builtin_cpu_init();
    bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
    if (avx2) return avx512 ? LC_ISA_AVX512 : LC_ISA_AVX2;
    if (__builtin_cpu_supports("sse4.1")) return LC_ISA_SSE4;
#endif
    return LC_ISA_SCALAR;
}

uint32_t lc_cpu_threads(void)
{
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set)) return 1;
    int n = CPU_COUNT(&set), quota = (int)lc_cpu_quota("");
    if (quota && quota < n) n = quota;
    return n < 1 ? 1 : n > LC_MAX_THREADS ? LC_MAX_THREADS : (uint32_t)n;
}
