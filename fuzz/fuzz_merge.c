/* fuzz_merge.c - any bytes as parts of a picture: no crash, and what is put together has every pixel of every
 * channel. The input is cut into parts at the bytes of OpenEXR's magic number. */
#include "fuzz.h"

#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static const uint8_t magic[4] = { 0x76, 0x2f, 0x31, 0x01 };
static int file = -1;
static char path[64];

static lc_status add(lc_merge *m, const uint8_t *data, size_t size)
{
    if (pwrite(file, data, size, 0) != (ssize_t)size || ftruncate(file, (off_t)size)) abort();
    return lc_merge_add(m, path);
}

static void finish(lc_merge *m)
{
    char text[32];
    lc_image *image;
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    double sum = 0;
    uint32_t missing = lc_merge_missing(m, text, sizeof text);
    if (strlen(text) >= sizeof text) abort();
    lc_status st = lc_merge_finish(m, &image);
    if (missing && !st) abort();
    if (st) return;
    lc_image_get_desc(image, &d);
    for (uint32_t c = 0; c < lc_image_n_channels(image); c++) {
        const float *plane = lc_image_channel(image, lc_image_channel_name(image, c));
        for (size_t i = 0; i < (size_t)d.width * d.height; i++) sum += (double)plane[i];
    }
    lc_image_destroy(sum > 0 ? image : image); /* uses sum, so that the compiler keeps the reads */
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    lc_merge *m;
    if (file < 0) file = memfd_create("part", 0);
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    if (lc_merge_create(fuzz_context(), &m)) abort();
    while (size >= sizeof magic && !memcmp(data, magic, sizeof magic)) {
        const uint8_t *next = memmem(data + 4, size - 4, magic, sizeof magic);
        size_t n = next ? (size_t)(next - data) : size;
        (void)add(m, data, n);
        data += n;
        size -= n;
    }
    finish(m);
    lc_merge_destroy(m);
    return 0;
}
