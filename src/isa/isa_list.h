/* isa_list.h - the instruction sets that have kernels, a line each. No guard: it is included wherever
 * something is wanted of all.
 *
 *     ISA(name, rank, test, flags)
 *
 *     name    as --isa takes it; isa_NAME.c is its translation unit, vec_NAME.h its vector words
 *     rank    the supported one of the highest rank is used; a cap admits no higher rank than its own
 *     test    of CPU and operating system: whether its kernels may be called
 *     flags   that the compiler gets for isa_NAME.c; the Makefile reads them from here
 *
 * Their numbers, lc_isa, count from 1 in this order and mean nothing else. The plain C comes first: it is
 * there everywhere.
 */
ISA(scalar, 0, true, "-fno-tree-vectorize -fno-tree-slp-vectorize") /* what the others are measured against:
                                                                       one lane at a time */
#if defined(__x86_64__)
ISA(sse4, 10, __builtin_cpu_supports("sse4.1"), "-msse4.1")
ISA(avx2, 20, __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"), "-mavx2 -mfma")
ISA(avx512, 30,
    __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("avx512f") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq"),
    "-mavx2 -mfma -mavx512f -mavx512vl -mavx512dq")
#endif
#if defined(__aarch64__)
ISA(neon, 10, true, "")
#endif
