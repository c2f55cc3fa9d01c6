/* fuzz_hdr.c - any bytes as a Radiance picture: no crash, and what was accepted is complete. */
#include "fuzz_raster.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_raster(lc_hdr_decode, data, size);
}
