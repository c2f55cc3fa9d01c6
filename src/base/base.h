/* base.h - what every file may use: constants, attributes, assertions, the padding of kernel arrays.
 *
 * The room base/ is what the others stand on. It knows nothing of scenes or light:
 *
 *     base.h  context.h  log.c            assertions; allocator, log and thread count of a host; errors
 *     arena   memory   pool   cpu   stats memory and its limit, parallel loops, processors, clock, counters
 *     text    build                       what a terminal may get; which build this is
 *     vec  vec4  xform  fmath  decimal    arithmetic whose bits are the same on every machine
 *     float_bits                          a float as its bits
 *     rng  sample  digest  morton         random numbers, sample points, hashes, space-filling order
 */
#ifndef LC_BASE_H
#define LC_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define LC_NONE UINT32_MAX /* no index */

#define LC_PI 3.14159265358979323846

#define LC_PRINTF(fmt_idx, arg_idx) __attribute__((format(printf, fmt_idx, arg_idx)))

/* A size that even small scenes pay for: fuzzers, which load very many scenes, use the second. */
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
#define LC_SIZE(usual, fuzzing) (fuzzing)
#else
#define LC_SIZE(usual, fuzzing) (usual)
#endif

/* States what callers have ensured; never used to check input. */
#ifdef LC_DEBUG
#include <assert.h>
#define LC_ASSERT(cond) assert(cond)
#else
#define LC_ASSERT(cond) ((void)0)
#endif

/* Arrays that kernels write have room for their count rounded up to a multiple of this. What kernels write
 * beyond the count is undefined. */
#define LC_LANES 16

#endif
