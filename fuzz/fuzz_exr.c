/* fuzz_exr.c - any bytes as an OpenEXR picture: no crash, and what was accepted is complete. */
#include "fuzz_raster.h"

#include "image/image.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return lc_exr_is(data, size) ? fuzz_raster(lc_raster_decode, data, size) : 0;
}
