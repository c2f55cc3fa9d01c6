/* fuzz.h - what fuzzers share: the entry that a fuzzing engine or driver.c calls, a context, and the check of
 * a property. */
#ifndef FUZZ_H
#define FUZZ_H

#include "lightcuts.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* One context of one thread for all inputs. */
static inline lc_context *fuzz_context(void)
{
    static lc_context *ctx;
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    desc.n_threads = 1;
    if (!ctx && lc_context_create(&desc, &ctx)) abort();
    return ctx;
}

/* A property that must hold: what is broken is printed, and the input kept by the engine. */
static inline void require(bool holds, const char *broken)
{
    if (holds) return;
    fprintf(stderr, "%s\n", broken);
    abort();
}

#endif
