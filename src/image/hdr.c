/* hdr.c - Radiance HDR files: a text header, the line "-Y 480 +X 640", then scanlines of RGBE pixels.
 *
 * Scanlines are flat, or run-length encoded in the old way (1 1 1 n repeats the previous pixel) or in the new
 * way (2 2 length, then the four bytes of all pixels one after the other). All eight orientations are
 * supported. EXPOSURE is not applied, as in pbrt; XYZE is rejected.
 */
#include "image/pixels.h"

#include "base/arena.h"

#include <string.h>

#define MAX_RATIO 1024    /* limits pixels per byte; the new encoding reaches 16 */
#define MAX_NEW_RLE 32767 /* pixels of a scanline in the new encoding, by its format */

typedef struct hdr {
    lc_context *ctx;
    const char *path;
    const uint8_t *data;
    size_t len, at;
    bool by_columns;     /* X is the first axis of the size line */
    bool down, right;    /* "-Y", "+X": in the direction of the raster's rows and columns */
    uint32_t width, height;
} hdr;

bool lc_hdr_is(const uint8_t *head, size_t len)
{
    return len >= 6 && (!memcmp(head, "#?RADI", 6) || !memcmp(head, "#?RGBE", 6));
}

static lc_status damaged(const hdr *h, size_t at, const char *what)
{
    return lc_raster_damaged(h->ctx, h->path, "Radiance", at, what);
}

/* Reads the line at h->at without its newline, truncated to size - 1 bytes. False at the end of the file. */
static bool next_line(hdr *h, char *line, size_t size)
{
    size_t n = 0;
    while (h->at < h->len && h->data[h->at] != '\n') {
        if (n + 1 < size) line[n++] = (char)h->data[h->at];
        h->at++;
    }
    line[n] = 0;
    return h->at++ < h->len;
}

/* Parses text like "-Y 12 " at *p: the axis, whether its sign is minus, the length. False if it is something
 * else. */
static bool read_axis(const char **p, char *axis, bool *minus, uint32_t *n)
{
    const char *c = *p;
    uint64_t v = 0;
    *minus = *c == '-';
    if (*c != '-' && *c != '+') return false;
    *axis = *++c;
    if (*c++ != 'X' && *axis != 'Y') return false;
    if (*c++ != ' ' || *c < '0' || *c > '9') return false;
    while (*c >= '0' && *c <= '9' && v <= INT32_MAX) v = v * 10 + (uint64_t)(*c++ - '0');
    while (*c == ' ' || *c == '\r') c++;
    *n = (uint32_t)v;
    *p = c;
    return v > 0 && v <= INT32_MAX;
}

static lc_status read_header(hdr *h)
{
    char line[128];
    char axis[2];
    bool minus[2];
    uint32_t n[2];
    do {
        size_t start = h->at;
        if (!next_line(h, line, sizeof line)) return damaged(h, h->len, "the header has no end");
        if (!strncmp(line, "FORMAT=", 7) && strncmp(line + 7, "32-bit_rle_rgbe", 15))
            return lc_fail_at(h->ctx, LC_ERR_UNSUPPORTED, (lc_pos){ h->path, 0, 0 },
                              "Radiance picture at byte %zu: only 32-bit_rle_rgbe is read", start);
    } while (line[0] && line[0] != '\r');
    size_t start = h->at;
    const char *p = line;
    if (!next_line(h, line, sizeof line) || !read_axis(&p, &axis[0], &minus[0], &n[0]) ||
        !read_axis(&p, &axis[1], &minus[1], &n[1]) || *p || axis[0] == axis[1])
        return damaged(h, start, "no line such as '-Y 480 +X 640'");
    int x = axis[0] == 'X' ? 0 : 1;
    h->by_columns = x == 0;
    h->width = n[x];
    h->height = n[1 - x];
    h->right = !minus[x];
    h->down = minus[1 - x];
    return LC_OK;
}

/* Decodes a scanline in the new encoding: the four bytes separately; lengths above 128 are runs. */
static lc_status read_new(hdr *h, uint8_t *row, uint32_t n)
{
    h->at += 4;
    for (uint32_t c = 0; c < 4; c++)
        for (uint32_t i = 0; i < n;) {
            if (h->len - h->at < 2) return damaged(h, h->len, "the file ends inside a scanline");
            uint32_t count = h->data[h->at++];
            bool run = count > 128;
            if (run) count -= 128;
            if (!count || count > n - i)
                return damaged(h, h->at - 1, "a run is empty or leaves the scanline");
            if (!run && h->len - h->at < count) return damaged(h, h->len, "the file ends inside a scanline");
            for (uint32_t k = 0; k < count; k++, i++) row[4 * (size_t)i + c] = h->data[run ? h->at : h->at++];
            h->at += run;
        }
    return LC_OK;
}

static lc_status read_old(hdr *h, uint8_t *row, uint32_t n)
{
    uint32_t shift = 0;
    for (uint32_t i = 0; i < n;) {
        if (h->len - h->at < 4) return damaged(h, h->len, "the file ends inside a scanline");
        const uint8_t *p = h->data + h->at;
        if (p[0] != 1 || p[1] != 1 || p[2] != 1) {
            memcpy(row + 4 * (size_t)i++, p, 4);
            shift = 0;
        } else {
            uint64_t count = shift < 32 ? (uint64_t)p[3] << shift : UINT64_MAX;
            if (!i || count > n - i)
                return damaged(h, h->at, "a run has no pixel before it or leaves the scanline");
            for (uint64_t k = 0; k < count; k++, i++) memcpy(row + 4 * (size_t)i, row + 4 * (size_t)i - 4, 4);
            shift += 8;
        }
        h->at += 4;
    }
    return LC_OK;
}

static lc_status read_scanline(hdr *h, uint8_t *row, uint32_t n)
{
    const uint8_t *p = h->data + h->at;
    bool coded = h->len - h->at >= 4 && n >= 8 && n <= MAX_NEW_RLE && p[0] == 2 && p[1] == 2 && p[2] < 128;
    if (!coded) return read_old(h, row, n);
    if (((uint32_t)p[2] << 8 | p[3]) != n) return damaged(h, h->at, "a scanline has another length");
    return read_new(h, row, n);
}

/* Converts RGBE to floats: a mantissa m with exponent e is m 2^(e - 136). */
static void expand(const uint8_t *rgbe, float *out)
{
    uint64_t bits = (uint64_t)(rgbe[3] + 1023 - 136) << 52;
    double scale;
    memcpy(&scale, &bits, sizeof scale);
    for (int c = 0; c < 3; c++) out[c] = rgbe[3] ? (float)(rgbe[c] * scale) : 0;
}

static lc_status read_pixels(hdr *h, const lc_raster *to)
{
    uint32_t n_lines = h->by_columns ? h->width : h->height, n = h->by_columns ? h->height : h->width;
    uint8_t *row = lc_alloc(h->ctx, n, 4);
    lc_status st = row ? LC_OK : LC_ERR_MEMORY;
    for (uint32_t line = 0; line < n_lines && !st; line++) {
        st = read_scanline(h, row, n);
        for (uint32_t i = 0; i < n && !st; i++) {
            uint32_t x = h->by_columns ? line : i, y = h->by_columns ? i : line;
            if (!h->right) x = h->width - 1 - x;
            if (!h->down) y = h->height - 1 - y;
            expand(row + 4 * (size_t)i, (float *)to->data + 3 * ((size_t)y * h->width + x));
        }
    }
    lc_free(h->ctx, row, n, 4);
    return st;
}

lc_status lc_hdr_decode(lc_context *ctx, const char *path, const lc_bytes *file, lc_raster *out)
{
    hdr h = { .ctx = ctx, .path = path, .data = file->data, .len = file->len };
    *out = (lc_raster){ 0 };
    lc_status st = read_header(&h);
    lc_raster size = { h.width, h.height, 3, LC_RASTER_F32, NULL };
    if (!st) st = lc_raster_init(ctx, path, &size, file->len, MAX_RATIO, out);
    if (!st) st = read_pixels(&h, out);
    if (st) lc_raster_free(ctx, out);
    return st;
}
