/* png_read.c - reads PNG files, with zlib: all colour types, 1 to 16 bits, interlaced or not.
 *
 * Samples of fewer than 8 bits are extended to 8, palettes become RGB, tRNS becomes an alpha channel. gAMA
 * and colour profiles are not applied. Sizes and checksums are checked.
 */
#include "image/pixels.h"

#include "base/arena.h"
#include "image/image.h"
#include "io/zlib_alloc.h"

#include <string.h>

#define MAX_INFLATE 1032 /* bytes that one byte of deflate data gives at most [zlib technical details] */

typedef struct png {
    lc_context *ctx;
    const char *path;
    const uint8_t *start, *data, *end; /* the file; data: the next byte to read */
    uint32_t width, height;
    unsigned depth, colour; /* bits per sample; 0 grey, 2 RGB, 3 palette, 4 grey + alpha, 6 RGBA */
    unsigned n_samples;     /* per pixel of the file */
    bool interlaced;
    uint8_t palette[256][4];
    unsigned n_palette;
    bool has_clear; /* there is a tRNS chunk: alpha of the palette, or the colour that is transparent */
    unsigned clear[3];
    uint8_t *raw; /* all rows of all passes, each with its filter byte before it */
    size_t raw_len, raw_got;
    lc_raster *to;
} png;

/* The passes of Adam7: first pixel and step in x and y [PNG, 8.2]; the last entry is for images without
 * interlacing. */
typedef struct pass {
    uint32_t x0, y0, dx, dy;
} pass;
static const pass passes[8] = { { 0, 0, 8, 8 }, { 4, 0, 8, 8 }, { 0, 4, 4, 8 }, { 2, 0, 4, 4 },
                                { 0, 2, 2, 4 }, { 1, 0, 2, 2 }, { 0, 1, 1, 2 }, { 0, 0, 1, 1 } };

bool lc_png_is(const uint8_t *head, size_t len)
{
    static const uint8_t signature[8] = { 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n' };
    return len >= sizeof signature && memcmp(head, signature, sizeof signature) == 0;
}

static lc_status damaged(const png *p, const char *what)
{
    return lc_raster_damaged(p->ctx, p->path, "PNG", (size_t)(p->data - p->start), what);
}

static uint32_t get_u32(const uint8_t *from)
{
    return (uint32_t)from[0] << 24 | (uint32_t)from[1] << 16 | (uint32_t)from[2] << 8 | from[3];
}

static uint32_t pass_width(const png *p, const pass *s)
{
    return p->width > s->x0 ? (p->width - s->x0 + s->dx - 1) / s->dx : 0;
}

static uint32_t pass_height(const png *p, const pass *s)
{
    return p->height > s->y0 ? (p->height - s->y0 + s->dy - 1) / s->dy : 0;
}

static size_t row_bytes(const png *p, uint32_t width)
{
    return ((size_t)width * p->n_samples * p->depth + 7) / 8;
}

static bool depth_allowed(unsigned colour, unsigned depth)
{
    switch (colour) {
    case 0: return depth == 1 || depth == 2 || depth == 4 || depth == 8 || depth == 16;
    case 3: return depth == 1 || depth == 2 || depth == 4 || depth == 8;
    case 2:
    case 4:
    case 6: return depth == 8 || depth == 16;
    default: return false;
    }
}

/* ---- chunks ---- */

static lc_status read_header(png *p, const uint8_t *data, size_t len)
{
    static const uint8_t samples[7] = { 1, 0, 3, 1, 2, 0, 4 };
    if (len != 13) return damaged(p, "IHDR is not 13 bytes");
    p->width = get_u32(data);
    p->height = get_u32(data + 4);
    p->depth = data[8];
    p->colour = data[9];
    if (!depth_allowed(p->colour, p->depth)) return damaged(p, "no such colour type and bit depth");
    if (data[10] != 0 || data[11] != 0 || data[12] > 1)
        return damaged(p, "no such compression, filter or interlace method");
    p->n_samples = samples[p->colour];
    p->interlaced = data[12] == 1;
    if (p->width == 0 || p->height == 0 || p->width > INT32_MAX || p->height > INT32_MAX)
        return damaged(p, "width or height out of range");
    if ((uint64_t)p->width * p->height > LC_IMAGE_MAX_PIXELS)
        return lc_fail_at(p->ctx, LC_ERR_UNSUPPORTED, (lc_pos){ p->path, 0, 0 }, "too large: %u x %u pixels",
                          p->width, p->height);
    const pass *first = p->interlaced ? passes : passes + 7, *last = p->interlaced ? passes + 7 : passes + 8;
    for (const pass *s = first; s < last; s++) {
        uint32_t w = pass_width(p, s), h = pass_height(p, s);
        if (w) p->raw_len += (row_bytes(p, w) + 1) * h;
    }
    /* Allocate nothing for more rows than the file can hold. */
    if (p->raw_len / MAX_INFLATE > (size_t)(p->end - p->start))
        return damaged(p, "too short for its size in pixels");
    p->raw = lc_alloc(p->ctx, p->raw_len, 1);
    return p->raw ? LC_OK : LC_ERR_MEMORY;
}

static lc_status read_palette(png *p, const uint8_t *data, size_t len)
{
    if (len == 0 || len % 3 != 0 || len > 768) return damaged(p, "PLTE has a wrong length");
    p->n_palette = (unsigned)(len / 3);
    for (size_t i = 0; i < p->n_palette; i++) {
        memcpy(p->palette[i], data + 3 * i, 3);
        p->palette[i][3] = 255;
    }
    return LC_OK;
}

static lc_status read_clear(png *p, const uint8_t *data, size_t len)
{
    if (p->colour & 4) return damaged(p, "tRNS beside an alpha channel");
    if (p->colour == 3 ? len > p->n_palette : len != 2 * (size_t)p->n_samples)
        return damaged(p, "tRNS has a wrong length");
    p->has_clear = true;
    for (size_t i = 0; p->colour == 3 && i < len; i++) p->palette[i][3] = data[i];
    for (size_t i = 0; p->colour != 3 && i < p->n_samples; i++)
        p->clear[i] = ((unsigned)data[2 * i] << 8 | data[2 * i + 1]) & ((1u << p->depth) - 1);
    return LC_OK;
}

/* Inflates one IDAT chunk. Data after the last row are ignored. */
static lc_status read_data(png *p, z_stream *z, const uint8_t *data, size_t len)
{
    memcpy(&z->next_in, &data, sizeof data); /* without ZLIB_CONST zlib's input pointer is not const */
    z->avail_in = (uInt)len;
    while (z->avail_in > 0 && p->raw_got < p->raw_len) {
        size_t room = p->raw_len - p->raw_got;
        uInt ask = room > (1u << 30) ? 1u << 30 : (uInt)room;
        z->next_out = p->raw + p->raw_got;
        z->avail_out = ask;
        int rv = inflate(z, Z_NO_FLUSH);
        p->raw_got += ask - z->avail_out;
        if (rv == Z_MEM_ERROR) return LC_ERR_MEMORY;
        if (rv == Z_STREAM_END || rv == Z_BUF_ERROR) break;
        if (rv != Z_OK) return damaged(p, "the compressed data are wrong");
    }
    return LC_OK;
}

static lc_status read_chunk(png *p, z_stream *z, const uint8_t *type, const uint8_t *data, size_t len)
{
    bool is_header = memcmp(type, "IHDR", 4) == 0;
    if (is_header != !p->raw) return damaged(p, is_header ? "a second IHDR" : "it does not start with IHDR");
    if (is_header) return read_header(p, data, len);
    if (memcmp(type, "PLTE", 4) == 0) return read_palette(p, data, len);
    if (memcmp(type, "tRNS", 4) == 0) return read_clear(p, data, len);
    if (memcmp(type, "IDAT", 4) == 0) return read_data(p, z, data, len);
    if (type[0] & 0x20) return LC_OK; /* ancillary */
    return lc_fail_at(p->ctx, LC_ERR_UNSUPPORTED, (lc_pos){ p->path, 0, 0 },
                      "critical PNG chunk of unknown type at byte %zu", (size_t)(p->data - p->start));
}

static lc_status read_chunks(png *p, z_stream *z)
{
    p->data += 8;
    for (;;) {
        size_t left = (size_t)(p->end - p->data);
        if (left < 12) return damaged(p, "it ends before IEND");
        size_t len = get_u32(p->data);
        const uint8_t *type = p->data + 4, *data = p->data + 8;
        if (len > left - 12) return damaged(p, "a chunk reaches beyond the end");
        if (get_u32(data + len) != (uint32_t)crc32_z(0, type, len + 4)) return damaged(p, "wrong checksum");
        if (p->raw && memcmp(type, "IEND", 4) == 0) return LC_OK;
        lc_status status = read_chunk(p, z, type, data, len);
        if (status != LC_OK) return status;
        p->data += len + 12;
    }
}

/* ---- pixels ---- */

uint8_t lc_png_paeth(uint8_t left, uint8_t up, uint8_t corner)
{
    int a = left, b = up, c = corner, pa = b - c, pb = a - c, pc = pa + pb;
    pa = pa < 0 ? -pa : pa;
    pb = pb < 0 ? -pb : pb;
    pc = pc < 0 ? -pc : pc;
    return pa <= pb && pa <= pc ? left : pb <= pc ? up : corner;
}

/* Reverses the filters of one pass in place [PNG, 9.2]. */
static lc_status unfilter(const png *p, uint8_t *rows, uint32_t height, size_t n)
{
    size_t step = ((size_t)p->n_samples * p->depth + 7) / 8;
    for (uint32_t y = 0; y < height; y++) {
        uint8_t *row = rows + y * (n + 1) + 1, filter = row[-1];
        const uint8_t *above = y ? row - (n + 1) : NULL;
        if (filter > 4) return damaged(p, "no such filter");
        for (size_t i = 0; i < n && filter; i++) {
            uint8_t left = i < step ? 0 : row[i - step], up = above ? above[i] : 0;
            uint8_t corner = above && i >= step ? above[i - step] : 0, guess = 0;
            if (filter == 1) guess = left;
            if (filter == 2) guess = up;
            if (filter == 3) guess = (uint8_t)((left + up) / 2);
            if (filter == 4) guess = lc_png_paeth(left, up, corner);
            row[i] = (uint8_t)(row[i] + guess);
        }
    }
    return LC_OK;
}

static unsigned get_sample(const png *p, const uint8_t *row, size_t idx)
{
    if (p->depth == 16) return (unsigned)row[2 * idx] << 8 | row[2 * idx + 1];
    size_t bit = idx * p->depth;
    return (unsigned)row[bit / 8] >> (8 - p->depth - bit % 8) & ((1u << p->depth) - 1);
}

/* Converts the `width` pixels of one row of a pass to the raster: to pixels at, at + step, ... */
static lc_status convert_row(const png *p, const uint8_t *row, uint32_t width, size_t at, size_t step)
{
    unsigned n = p->to->n_channels, most = p->depth == 16 ? 65535 : 255,
             scale = p->depth < 8 ? 255 / ((1u << p->depth) - 1) : 1;
    for (size_t x = 0; x < width; x++, at += step) {
        unsigned v[4], same = 0;
        for (unsigned s = 0; s < p->n_samples; s++) v[s] = get_sample(p, row, x * p->n_samples + s);
        if (p->colour == 3) {
            if (v[0] >= p->n_palette) return damaged(p, "a pixel is outside the palette");
            memcpy((uint8_t *)p->to->data + at * n, p->palette[v[0]], n);
            continue;
        }
        for (unsigned s = 0; s < p->n_samples; s++) {
            same += s < 3 && v[s] == p->clear[s];
            v[s] *= scale;
        }
        if (p->has_clear) v[p->n_samples] = same == p->n_samples ? 0 : most;
        for (unsigned c = 0; c < n; c++) {
            if (most > 255) ((uint16_t *)p->to->data)[at * n + c] = (uint16_t)v[c];
            else ((uint8_t *)p->to->data)[at * n + c] = (uint8_t)v[c];
        }
    }
    return LC_OK;
}

static lc_status convert(png *p)
{
    lc_raster size = { p->width, p->height, p->colour == 3 ? 3 : p->n_samples,
                       p->depth == 16 ? LC_RASTER_U16 : LC_RASTER_U8, NULL };
    size.n_channels += p->has_clear;
    lc_status status = lc_raster_init(p->ctx, p->path, &size, (size_t)(p->end - p->start), UINT32_MAX, p->to);
    if (status != LC_OK) return status;
    uint8_t *rows = p->raw;
    const pass *first = p->interlaced ? passes : passes + 7, *last = p->interlaced ? passes + 7 : passes + 8;
    for (const pass *s = first; s < last; s++) {
        uint32_t w = pass_width(p, s), h = pass_height(p, s);
        if (!w) continue;
        size_t n = row_bytes(p, w);
        status = unfilter(p, rows, h, n);
        for (uint32_t y = 0; status == LC_OK && y < h; y++) {
            size_t at = (size_t)(s->y0 + (size_t)y * s->dy) * p->width + s->x0;
            status = convert_row(p, rows + y * (n + 1) + 1, w, at, s->dx);
        }
        if (status != LC_OK) return status;
        rows += h * (n + 1);
    }
    return LC_OK;
}

lc_status lc_png_decode(lc_context *ctx, const char *path, const lc_bytes *file, lc_raster *out)
{
    *out = (lc_raster){ 0 };
    if (!lc_png_is(file->data, file->len)) return lc_raster_damaged(ctx, path, "PNG", 0, "no signature");
    png *p = lc_alloc(ctx, 1, sizeof *p);
    if (!p) return LC_ERR_MEMORY;
    p->ctx = ctx;
    p->path = path;
    p->start = p->data = file->data;
    p->end = p->data + file->len;
    p->to = out;
    z_stream z = lc_zlib_stream(ctx);
    lc_status status = inflateInit(&z) == Z_OK ? LC_OK : LC_ERR_MEMORY;
    if (status == LC_OK) {
        status = read_chunks(p, &z);
        inflateEnd(&z);
    }
    if (status == LC_OK && p->raw_got < p->raw_len) status = damaged(p, "pixels are missing");
    if (status == LC_OK && p->colour == 3 && !p->n_palette) status = damaged(p, "no palette");
    if (status == LC_OK) status = convert(p);
    if (status != LC_OK) lc_raster_free(ctx, out);
    lc_free(ctx, p->raw, p->raw_len, 1);
    lc_free(ctx, p, 1, sizeof *p);
    return status;
}
