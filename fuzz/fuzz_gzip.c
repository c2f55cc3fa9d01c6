/* fuzz_gzip.c - any bytes behind a gzip header through the reader of files: no crash, no more than it says,
 * the same bytes whatever the size of the pieces that are asked for. */
#include "fuzz.h"
#include "io/readfile.h"

#include <string.h>

#define MOST ((size_t)1 << 20) /* bytes unpacked */

static lc_status unpack(lc_context *ctx, const uint8_t *data, size_t size, size_t piece, uint8_t *to,
                        size_t *n)
{
    lc_reader r;
    size_t got = 1;
    lc_status st = LC_OK;
    lc_reader_memory(data, size, &r);
    for (*n = 0; !st && got && *n + piece <= MOST; *n += got)
        st = lc_reader_read(ctx, &r, (char *)to + *n, piece, &got);
    lc_reader_close(&r);
    return st;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static uint8_t out[2][MOST];
    lc_context *ctx = fuzz_context();
    uint8_t *copy = malloc(size + 10);
    if (!copy) abort();
    memcpy(copy, "\x1f\x8b\x08\0\0\0\0\0\0\x03", 10);
    if (size) memcpy(copy + 10, data, size);
    for (int with_header = 0; with_header < 2; with_header++) {
        const uint8_t *from = with_header ? copy : copy + 10;
        size_t len = with_header ? size + 10 : size, n[2];
        lc_status a = unpack(ctx, from, len, 4096, out[0], &n[0]),
                  b = unpack(ctx, from, len, 1 + size % 61, out[1], &n[1]);
        if (n[0] + 4096 > MOST || n[1] + 61 > MOST) continue;
        if (a != b || (!a && (n[0] != n[1] || memcmp(out[0], out[1], n[0])))) abort();
    }
    free(copy);
    return 0;
}
