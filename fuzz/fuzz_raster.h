/* fuzz_raster.h - what the fuzzers of image formats share: any bytes through one decoder. */
#ifndef FUZZ_RASTER_H
#define FUZZ_RASTER_H

#include "image/pixels.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Aborts unless a raster that was accepted has a size and all its samples, or a refused one is empty. */
static inline int fuzz_raster(lc_raster_decoder *decode, const uint8_t *data, size_t size)
{
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    lc_context *ctx;
    lc_raster r;
    desc.n_threads = 1;
    if (lc_context_create(&desc, &ctx)) return 0;
    lc_bytes file = { ctx, malloc(size ? size : 1), size, size };
    if (!file.data) abort();
    if (size) memcpy(file.data, data, size);
    lc_status st = decode(ctx, "fuzz", &file, &r);
    if (st ? r.data != NULL : !r.width || !r.height || r.n_channels < 1 || r.n_channels > 4) abort();
    size_t n = (size_t)r.width * r.height * r.n_channels * (size_t)r.kind;
    uint32_t sum = 0;
    for (size_t i = 0; i < n && !st; i++) sum += ((const uint8_t *)r.data)[i];
    if (sum == 1) file.len = 0; /* so that the reads stay */
    lc_raster_free(ctx, &r);
    free(file.data);
    lc_context_destroy(ctx);
    return 0;
}

#endif
