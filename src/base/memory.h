/* memory.h - a limit on what a context allocates, and what the memory left on the machine is. */
#ifndef LC_MEMORY_H
#define LC_MEMORY_H

#include "base/context.h"

#include <stdatomic.h>

/* Counted by lc_alloc_raw and lc_free, which are called for whole arrays and chunks of arenas. */
typedef struct lc_memory {
    atomic_size_t used;
    size_t limit;                /* bytes */
    _Atomic(const char *) step;  /* what is being made, for the message */
} lc_memory;

/* Names what the allocations that follow are for: "the light tree". */
void lc_memory_step(const lc_context *ctx, const char *what);
/* False, after a message: the limit would be passed. */
bool lc_memory_take(const lc_context *ctx, size_t bytes);
void lc_memory_give(const lc_context *ctx, size_t bytes);
/* What lc_memory_left of lightcuts.h returns; root is prefixed to all paths: "", except in tests. */
uint64_t lc_memory_left_below(const char *root);

#endif
