/* image_png.c - PNG files from and to memory, with zlib.
 *
 * Written: 8 bits RGB of the planes R G B, no alpha. Values below 0.8 keep their place; above, a shoulder
 * rolls off so that highlights stay apart: f(v) = 0.8 + 0.2 t / (1 + t), t = (v - 0.8) / 0.2, with slope 1 at
 * 0.8 and limit 1 at infinity (1.0 becomes 0.9). Then the sRGB curve [IEC 61966-2-1]. NaN, negative: black.
 *
 * Read: every colour type, 1 to 16 bits, interlaced too, as linear R G B, and A where the file has an alpha
 * channel. tRNS, gAMA and colour profiles are not applied: values are taken as sRGB. Sizes and checksums are
 * checked. The curve is made from + - * / alone, so it is the same on every machine.
 */
#include "image.h"

#include <string.h>
#include <zlib.h>

#define SHOULDER 0.8
#define MAX_INFLATE 1032 /* deflate makes at most 1032 bytes out of one [zlib technical details] */

static const uint8_t signature[8] = { 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n' };

bool lc_png_is(const uint8_t *head, size_t len)
{
    return len >= sizeof signature && memcmp(head, signature, sizeof signature) == 0;
}

/* ---- the sRGB curve ---- */

/* x^(1/5) for x in (0, 1], by Newton's method from above, where it falls until it meets rounding. */
static double fifth_root(double x)
{
    double y = 1.0;
    for (;;) {
        double y4 = y * y * (y * y), next = y - (y - x / y4) / 5.0;
        if (!(next < y)) return y;
        y = next;
    }
}

static double srgb_to_linear(double v)
{
    if (v <= 0.04045) return v / 12.92;
    double x = (v + 0.055) / 1.055, r = fifth_root(x * x);
    return x * x * r; /* x^2.4 = x^2 (x^2)^(1/5) */
}

/* Linear value above which the nearest of the 256 codes is more than k. */
static void make_thresholds(double threshold[255])
{
    for (int k = 0; k < 255; k++) threshold[k] = srgb_to_linear((k + 0.5) / 255.0);
}

static uint8_t quantize(float value, const double threshold[255])
{
    double v = (double)value;
    if (!(v > 0.0)) return 0;
    if (v > SHOULDER) {
        double t = (v - SHOULDER) / (1.0 - SHOULDER);
        v = 1.0 - (1.0 - SHOULDER) / (1.0 + t);
    }
    int lo = 0, hi = 255;
    while (lo < hi) {
        int mid = (lo + hi) / 2;
        if (v > threshold[mid]) {
            lo = mid + 1;
        } else {
            hi = mid;
        }
    }
    return (uint8_t)lo;
}

/* ---- zlib's memory: blocks that know their size ---- */

#define BLOCK_HEAD 64

static void *zlib_alloc(void *user, unsigned n, unsigned size)
{
    const lc_context *ctx = user;
    size_t bytes = (size_t)n * size + BLOCK_HEAD;
    uint8_t *block = lc_alloc(ctx, bytes, 1);
    if (!block) return NULL;
    memcpy(block, &bytes, sizeof bytes);
    return block + BLOCK_HEAD;
}

static void zlib_free(void *user, void *ptr)
{
    if (!ptr) return;
    uint8_t *block = (uint8_t *)ptr - BLOCK_HEAD;
    size_t bytes;
    memcpy(&bytes, block, sizeof bytes);
    lc_free(user, block, bytes, 1);
}

static z_stream zlib_stream(const lc_context *ctx)
{
    lc_context *user;
    memcpy(&user, &ctx, sizeof user); /* zlib wants a pointer without const */
    return (z_stream){ .zalloc = zlib_alloc, .zfree = zlib_free, .opaque = user };
}

/* ---- writing ---- */

static void put_u32(uint8_t *to, uint32_t v)
{
    for (int i = 0; i < 4; i++) to[i] = (uint8_t)(v >> (24 - 8 * i));
}

static lc_status put_chunk(lc_bytes *file, const char type[4], const uint8_t *data, size_t len)
{
    uint8_t head[8], tail[4];
    put_u32(head, (uint32_t)len);
    memcpy(head + 4, type, 4);
    uLong crc = crc32_z(0, head + 4, 4);
    if (len) crc = crc32_z(crc, data, len); /* NULL would start anew */
    put_u32(tail, (uint32_t)crc);
    lc_status status = lc_bytes_put(file, file->len, head, sizeof head);
    if (status == LC_OK) status = lc_bytes_put(file, file->len, data, len);
    if (status == LC_OK) status = lc_bytes_put(file, file->len, tail, sizeof tail);
    return status;
}

static uint8_t paeth(uint8_t left, uint8_t up, uint8_t corner)
{
    int a = left, b = up, c = corner, pa = b - c, pb = a - c, pc = pa + pb;
    pa = pa < 0 ? -pa : pa;
    pb = pb < 0 ? -pb : pb;
    pc = pc < 0 ? -pc : pc;
    return pa <= pb && pa <= pc ? left : pb <= pc ? up : corner;
}

/* `raw` gets height rows of a filter byte (Paeth) and width * 3 filtered bytes; `rows` is room for two plain
 * ones. */
static void filter_rows(const lc_image *image, uint8_t *raw, uint8_t *rows)
{
    static const char *const names[3] = { "R", "G", "B" };
    double threshold[255];
    make_thresholds(threshold);
    size_t width = image->desc.width, n = width * 3;
    const float *plane[3];
    for (int c = 0; c < 3; c++) plane[c] = lc_image_channel(image, names[c]);
    uint8_t *above = rows, *row = rows + n;
    for (size_t y = 0; y < image->desc.height; y++) {
        for (size_t i = 0; i < n; i++) row[i] = quantize(plane[i % 3][y * width + i / 3], threshold);
        *raw++ = 4;
        for (size_t i = 0; i < n; i++) {
            uint8_t left = i < 3 ? 0 : row[i - 3], corner = i < 3 ? 0 : above[i - 3];
            *raw++ = (uint8_t)(row[i] - paeth(left, above[i], corner));
        }
        uint8_t *t = above;
        above = row;
        row = t;
    }
}

static lc_status deflate_all(const lc_context *ctx, uint8_t *raw, size_t raw_len, lc_bytes *out)
{
    z_stream z = zlib_stream(ctx);
    if (deflateInit(&z, 6) != Z_OK) return LC_ERR_MEMORY;
    size_t bound = deflateBound(&z, raw_len);
    lc_status status = lc_grow(ctx, &out->data, &out->cap, bound, 1);
    if (status == LC_OK) {
        z.next_in = raw;
        z.avail_in = (uInt)raw_len;
        z.next_out = out->data;
        z.avail_out = (uInt)bound;
        if (deflate(&z, Z_FINISH) != Z_STREAM_END) status = LC_ERR_MEMORY;
        out->len = bound - z.avail_out;
    }
    deflateEnd(&z);
    return status;
}

lc_status lc_png_encode(const lc_image *image, const char *path, lc_bytes *file)
{
    const lc_context *ctx = image->ctx;
    const lc_image_desc *d = &image->desc;
    if (!lc_image_channel(image, "R") || !lc_image_channel(image, "G") || !lc_image_channel(image, "B")) {
        return lc_fail_at(ctx, LC_ERR_ARG, (lc_pos){ path, 0, 0 }, "a PNG needs the channels R, G and B");
    }
    size_t row_len = (size_t)d->width * 3, raw_len = (row_len + 1) * d->height;
    uint8_t *raw = lc_alloc(ctx, raw_len, 1), *rows = lc_alloc(ctx, row_len, 2);
    lc_bytes packed = { ctx, NULL, 0, 0 };
    lc_status status = raw && rows ? LC_OK : LC_ERR_MEMORY;
    if (status == LC_OK) {
        filter_rows(image, raw, rows);
        status = deflate_all(ctx, raw, raw_len, &packed);
    }
    lc_free(ctx, raw, raw_len, 1);
    lc_free(ctx, rows, row_len, 2);

    uint8_t header[13] = { [8] = 8, [9] = 2 }; /* 8 bits, RGB, deflate, the five filters, not interlaced */
    put_u32(header, d->width);
    put_u32(header + 4, d->height);
    const uint8_t intent = 0; /* perceptual */
    if (status == LC_OK) status = lc_bytes_put(file, 0, signature, sizeof signature);
    if (status == LC_OK) status = put_chunk(file, "IHDR", header, sizeof header);
    if (status == LC_OK) status = put_chunk(file, "sRGB", &intent, 1);
    if (status == LC_OK) status = put_chunk(file, "IDAT", packed.data, packed.len);
    if (status == LC_OK) status = put_chunk(file, "IEND", NULL, 0);
    lc_bytes_free(&packed);
    return status;
}

/* ---- reading ---- */

typedef struct png {
    lc_context *ctx;
    const char *path;
    const uint8_t *data, *end; /* rest of the file */
    uint32_t width, height;
    unsigned depth, colour; /* bits per sample; 0 grey, 2 RGB, 3 palette, 4 grey + alpha, 6 RGBA */
    unsigned n_samples;     /* per pixel */
    bool interlaced;
    uint8_t palette[256][3];
    unsigned n_palette;
    uint8_t *raw; /* all rows of all passes, each after its filter byte */
    size_t raw_len, raw_got;
    float *linear; /* curve, 2^depth values */
    lc_image *image;
} png;

/* Adam7's passes: first pixel and distance in x and y [PNG, 8.2]; the last row is a plain image. */
typedef struct pass {
    uint32_t x0, y0, dx, dy;
} pass;
static const pass passes[8] = { { 0, 0, 8, 8 }, { 4, 0, 8, 8 }, { 0, 4, 4, 8 }, { 2, 0, 4, 4 },
                                { 0, 2, 2, 4 }, { 1, 0, 2, 2 }, { 0, 1, 1, 2 }, { 0, 0, 1, 1 } };

static lc_status damaged(const png *p, const char *what)
{
    return lc_fail_at(p->ctx, LC_ERR_PARSE, (lc_pos){ p->path, 0, 0 }, "damaged PNG file: %s", what);
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

static lc_status read_header(png *p, const uint8_t *data, size_t len, size_t file_len)
{
    static const uint8_t samples[7] = { 1, 0, 3, 1, 2, 0, 4 };
    if (len != 13) return damaged(p, "IHDR is not 13 bytes");
    p->width = get_u32(data);
    p->height = get_u32(data + 4);
    p->depth = data[8];
    p->colour = data[9];
    if (!depth_allowed(p->colour, p->depth)) return damaged(p, "no such colour type and bit depth");
    if (data[10] != 0 || data[11] != 0 || data[12] > 1) {
        return damaged(p, "no such compression, filter or interlace method");
    }
    p->n_samples = samples[p->colour];
    p->interlaced = data[12] == 1;
    if (p->width == 0 || p->height == 0 || p->width > INT32_MAX || p->height > INT32_MAX) {
        return damaged(p, "width or height out of range");
    }
    if ((uint64_t)p->width * p->height > LC_IMAGE_MAX_PIXELS) {
        return lc_fail_at(p->ctx, LC_ERR_UNSUPPORTED, (lc_pos){ p->path, 0, 0 }, "too large: %u x %u pixels",
                          p->width, p->height);
    }
    const pass *first = p->interlaced ? passes : passes + 7, *last = p->interlaced ? passes + 7 : passes + 8;
    for (const pass *s = first; s < last; s++) {
        uint32_t w = pass_width(p, s), h = pass_height(p, s);
        if (w) p->raw_len += (row_bytes(p, w) + 1) * h;
    }
    // More than the file can hold is not worth asking memory for.
    if (p->raw_len / MAX_INFLATE > file_len) return damaged(p, "too short for its size in pixels");
    p->raw = lc_alloc(p->ctx, p->raw_len, 1);
    return p->raw ? LC_OK : LC_ERR_MEMORY;
}

static lc_status read_palette(png *p, const uint8_t *data, size_t len)
{
    if (len == 0 || len % 3 != 0 || len > sizeof p->palette) return damaged(p, "PLTE has a wrong length");
    memcpy(p->palette, data, len);
    p->n_palette = (unsigned)(len / 3);
    return LC_OK;
}

/* Feeds one IDAT chunk to the inflater. What comes after the last row is ignored. */
static lc_status read_data(png *p, z_stream *z, const uint8_t *data, size_t len)
{
    memcpy(&z->next_in, &data, sizeof data); /* zlib's input pointer lacks const without ZLIB_CONST */
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

static lc_status read_chunk(png *p, z_stream *z, const uint8_t *type, const uint8_t *data, size_t len,
                            size_t file_len)
{
    bool is_header = memcmp(type, "IHDR", 4) == 0;
    if (is_header != !p->raw) return damaged(p, is_header ? "a second IHDR" : "it does not start with IHDR");
    if (is_header) return read_header(p, data, len, file_len);
    if (memcmp(type, "PLTE", 4) == 0) return read_palette(p, data, len);
    if (memcmp(type, "IDAT", 4) == 0) return read_data(p, z, data, len);
    if (type[0] & 0x20) return LC_OK; /* ancillary */
    return lc_fail_at(p->ctx, LC_ERR_UNSUPPORTED, (lc_pos){ p->path, 0, 0 },
                      "critical PNG chunk of unknown type");
}

static lc_status read_chunks(png *p, z_stream *z)
{
    size_t file_len = (size_t)(p->end - p->data);
    p->data += sizeof signature;
    for (;;) {
        size_t left = (size_t)(p->end - p->data);
        if (left < 12) return damaged(p, "it ends before IEND");
        size_t len = get_u32(p->data);
        const uint8_t *type = p->data + 4, *data = p->data + 8;
        if (len > left - 12) return damaged(p, "a chunk reaches beyond the end");
        if (get_u32(data + len) != (uint32_t)crc32_z(0, type, len + 4)) return damaged(p, "wrong checksum");
        p->data += len + 12;
        if (p->raw && memcmp(type, "IEND", 4) == 0) return LC_OK;
        lc_status status = read_chunk(p, z, type, data, len, file_len);
        if (status != LC_OK) return status;
    }
}

/* Undoes the filters of one pass in place [PNG, 9.2]. */
static lc_status unfilter(const png *p, uint8_t *rows, uint32_t height, size_t n)
{
    size_t step = ((size_t)p->n_samples * p->depth + 7) / 8;
    for (uint32_t y = 0; y < height; y++) {
        uint8_t *row = rows + y * (n + 1) + 1, filter = row[-1];
        const uint8_t *above = y ? row - (n + 1) : NULL;
        if (filter > 4) return damaged(p, "no such filter");
        for (size_t i = 0; i < n; i++) {
            uint8_t left = i < step ? 0 : row[i - step], up = above ? above[i] : 0;
            uint8_t corner = above && i >= step ? above[i - step] : 0, guess = 0;
            if (filter == 1) guess = left;
            if (filter == 2) guess = up;
            if (filter == 3) guess = (uint8_t)((left + up) / 2);
            if (filter == 4) guess = paeth(left, up, corner);
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

static lc_status convert_row(const png *p, const uint8_t *row, uint32_t width, size_t at, size_t step,
                             float *const plane[4])
{
    float scale = 1.0f / (float)((1u << p->depth) - 1);
    for (size_t x = 0; x < width; x++, at += step) {
        unsigned v[4];
        for (unsigned s = 0; s < p->n_samples; s++) v[s] = get_sample(p, row, x * p->n_samples + s);
        if (p->colour == 3) {
            if (v[0] >= p->n_palette) return damaged(p, "a pixel is outside the palette");
            for (int c = 0; c < 3; c++) plane[c][at] = p->linear[p->palette[v[0]][c]];
            continue;
        }
        for (unsigned c = 0; c < 3; c++) plane[c][at] = p->linear[v[p->n_samples < 3 ? 0 : c]];
        if (plane[3]) plane[3][at] = (float)v[p->n_samples - 1] * scale;
    }
    return LC_OK;
}

static lc_status convert(png *p)
{
    static const char *const names[4] = { "R", "G", "B", "A" };
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    desc.width = p->width;
    desc.height = p->height;
    lc_status status = lc_image_create(p->ctx, &desc, &p->image);
    float *plane[4] = { NULL, NULL, NULL, NULL };
    for (int c = 0; status == LC_OK && c < (p->colour & 4 ? 4 : 3); c++) {
        status = lc_image_add_channel(p->image, names[c], &plane[c]);
    }
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
            status = convert_row(p, rows + y * (n + 1) + 1, w, at, s->dx, plane);
        }
        if (status != LC_OK) return status;
        rows += h * (n + 1);
    }
    return LC_OK;
}

lc_status lc_png_decode(lc_context *ctx, const char *path, const lc_bytes *file, lc_image **out)
{
    *out = NULL;
    png *p = lc_alloc(ctx, 1, sizeof *p);
    if (!p) return LC_ERR_MEMORY;
    p->ctx = ctx;
    p->path = path;
    p->data = file->data;
    p->end = p->data + file->len;
    z_stream z = zlib_stream(ctx);
    lc_status status = inflateInit(&z) == Z_OK ? LC_OK : LC_ERR_MEMORY;
    if (status == LC_OK) {
        status = read_chunks(p, &z);
        inflateEnd(&z);
    }
    if (status == LC_OK && p->raw_got < p->raw_len) status = damaged(p, "pixels are missing");
    if (status == LC_OK && p->colour == 3 && !p->n_palette) status = damaged(p, "no palette");
    size_t n_codes = 0;
    if (status == LC_OK) {
        n_codes = (size_t)1 << (p->colour == 3 ? 8 : p->depth);
        p->linear = lc_alloc(ctx, n_codes, sizeof *p->linear);
        if (!p->linear) status = LC_ERR_MEMORY;
    }
    if (status == LC_OK) {
        for (size_t i = 0; i < n_codes; i++)
            p->linear[i] = (float)srgb_to_linear((double)i / (double)(n_codes - 1));
        status = convert(p);
    }
    lc_free(ctx, p->linear, n_codes, sizeof *p->linear);
    lc_free(ctx, p->raw, p->raw_len, 1);
    if (status == LC_OK) {
        *out = p->image;
    } else {
        lc_image_destroy(p->image);
    }
    lc_free(ctx, p, 1, sizeof *p);
    return status;
}
