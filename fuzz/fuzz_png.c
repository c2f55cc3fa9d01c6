/* fuzz_png.c - any bytes as a PNG picture, as they are and with the checksums of their chunks mended: no
 * crash, and what was accepted is complete. */
#include "fuzz_raster.h"

#include <zlib.h>

/* In place, as far as chunks follow each other. */
static void mend(uint8_t *data, size_t size)
{
    for (size_t at = 8; size >= 12 && at <= size - 12;) {
        size_t len = (size_t)data[at] << 24 | (size_t)data[at + 1] << 16 | (size_t)data[at + 2] << 8 |
                     data[at + 3];
        if (len > size - 12 - at) return;
        uint32_t crc = (uint32_t)crc32_z(0, data + at + 4, len + 4);
        for (size_t i = 0; i < 4; i++) data[at + 8 + len + i] = (uint8_t)(crc >> (24 - 8 * i));
        at += 12 + len;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_raster(lc_png_decode, data, size);
    uint8_t *copy = malloc(size ? size : 1);
    if (!copy) abort();
    if (size) memcpy(copy, data, size);
    mend(copy, size);
    fuzz_raster(lc_png_decode, copy, size);
    free(copy);
    return 0;
}
