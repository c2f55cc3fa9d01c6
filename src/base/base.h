/* base.h - attributes, the block width of every kernel array, assertions. */
#ifndef LC_BASE_H
#define LC_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define LC_NONE UINT32_MAX

#define LC_PI 3.14159265358979323846

#define LC_PRINTF(fmt_idx, arg_idx) __attribute__((format(printf, fmt_idx, arg_idx)))

/* A size that makes small scenes slow; fuzzers, which want many, have a smaller one. */
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
#define LC_SIZE(usual, fuzzing) (fuzzing)
#else
#define LC_SIZE(usual, fuzzing) (usual)
#endif

/* States what the caller has already ensured. Never used on input. */
#ifdef LC_DEBUG
#include <assert.h>
#define LC_ASSERT(cond) assert(cond)
#else
#define LC_ASSERT(cond) ((void)0)
#endif

/* Arrays that kernels write have room for their count rounded up to this; what they put past the count means
 * nothing. */
#define LC_LANES 16

#endif
