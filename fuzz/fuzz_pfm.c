/* fuzz_pfm.c - any bytes as a PFM picture: no crash, and what was accepted is complete. */
#include "fuzz_raster.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_raster(lc_pfm_decode, data, size);
}
