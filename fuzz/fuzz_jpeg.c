/* fuzz_jpeg.c - any bytes as a JPEG picture: no crash, and what was accepted is complete. */
#include "fuzz_raster.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_raster(lc_jpeg_decode, data, size);
}
