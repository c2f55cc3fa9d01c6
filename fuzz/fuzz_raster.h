/* fuzz_raster.h - what the fuzzers of image formats share: any bytes through one decoder. */
#ifndef FUZZ_RASTER_H
#define FUZZ_RASTER_H

#include "fuzz.h"
#include "image/pixels.h"

#include <string.h>

/* A raster that was accepted has a size and all its samples; a refused one has none. */
static inline int fuzz_raster(lc_raster_decoder *decode, const uint8_t *data, size_t size)
{
    lc_context *ctx = fuzz_context();
    lc_raster r;
    lc_bytes file = { ctx, malloc(size ? size : 1), size, size };
    if (!file.data) abort();
    if (size) memcpy(file.data, data, size);
    lc_status st = decode(ctx, "fuzz", &file, &r);
    if (st) require(!r.data, "a refused raster has samples");
    else require(r.width && r.height && r.n_channels >= 1 && r.n_channels <= 4, "a raster without size");
    size_t n = (size_t)r.width * r.height * r.n_channels * (size_t)r.kind;
    uint32_t sum = 0;
    for (size_t i = 0; i < n && !st; i++) sum += ((const uint8_t *)r.data)[i];
    if (sum == 1) file.len = 0; /* so that the compiler keeps the reads */
    lc_raster_free(ctx, &r);
    free(file.data);
    return 0;
}

#endif
