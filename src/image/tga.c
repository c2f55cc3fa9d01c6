/* tga.c - Targa files: palette, true colour and grey (types 1, 2, 3), also run-length encoded (9, 10, 11),
 * with any corner as origin. Colours of 15 and 16 bits are 5-5-5 with an ignored attribute bit; 16 bits of
 * grey are grey and alpha. The order of bytes is blue, green, red, alpha. */
#include "image/pixels.h"

#include <string.h>

#define HEADER 18
#define MAX_RATIO 128 /* limits pixels per byte: a packet has at most 128 pixels and at least 2 bytes */

typedef struct tga {
    lc_context *ctx;
    const char *path;
    const uint8_t *data;
    size_t len, at;
    uint32_t type;        /* 1, 2, 3 */
    bool coded;           /* run-length encoded */
    uint32_t bytes;       /* per pixel in the file */
    const uint8_t *palette;
    uint32_t first, n_palette, entry_bytes; /* index of the palette's first entry, entries, bytes of each */
    bool alpha;
} tga;

bool lc_tga_is(const uint8_t *head, size_t len)
{
    if (len < 8 || head[1] > 1) return false;
    uint32_t type = head[2] & ~8u, entry = head[7];
    if (type < 1 || type > 3 || head[2] > 11) return false;
    return type != 1 || (head[1] == 1 && (entry == 15 || entry == 16 || entry == 24 || entry == 32));
}

static lc_status damaged(const tga *t, size_t at, const char *what)
{
    return lc_raster_damaged(t->ctx, t->path, "TGA", at, what);
}

static uint32_t get_u16(const uint8_t *p) { return p[0] | (uint32_t)p[1] << 8; }

static lc_status read_header(tga *t, lc_raster *size)
{
    const uint8_t *d = t->data;
    if (t->len < HEADER) return damaged(t, t->len, "the header is cut off");
    if (!lc_tga_is(d, t->len)) return damaged(t, 1, "no such type");
    t->type = d[2] & 3;
    t->coded = d[2] & 8;
    uint32_t bits = d[16], alpha_bits = d[17] & 15;
    bool depth_ok = t->type == 2 ? bits == 15 || bits == 16 || bits == 24 || bits == 32
                                 : bits == 8 || bits == 16;
    if (!depth_ok) return damaged(t, 16, "no such depth for this type");
    if (d[17] & 0xc0)
        return lc_fail_at(t->ctx, LC_ERR_UNSUPPORTED, (lc_pos){ t->path, 0, 0 },
                          "interleaved TGA is not read");
    t->bytes = (bits + 7) / 8;
    t->at = HEADER + (size_t)d[0];
    t->first = get_u16(d + 3);
    t->n_palette = get_u16(d + 5);
    t->entry_bytes = (d[7] + 7u) / 8;
    size_t palette_len = d[1] ? (size_t)t->n_palette * t->entry_bytes : 0;
    if (t->at > t->len || palette_len > t->len - t->at) return damaged(t, t->len, "the palette is cut off");
    t->palette = d + t->at;
    t->at += palette_len;
    uint32_t colour_bits = t->type == 1 ? d[7] : bits;
    t->alpha = t->type == 3 ? bits == 16 : colour_bits == 32 && alpha_bits;
    *size = (lc_raster){ get_u16(d + 12), get_u16(d + 14), (t->type == 3 ? 1u : 3u) + t->alpha, LC_RASTER_U8,
                         NULL };
    return LC_OK;
}

static uint8_t five_bits(uint32_t v) { return (uint8_t)(((v & 31) * 255 + 15) / 31); }

static void put_colour(const tga *t, const uint8_t *p, uint32_t bytes, uint8_t *out)
{
    if (bytes == 2) {
        uint32_t v = get_u16(p);
        out[0] = five_bits(v >> 10);
        out[1] = five_bits(v >> 5);
        out[2] = five_bits(v);
        return;
    }
    out[0] = p[2];
    out[1] = p[1];
    out[2] = p[0];
    if (t->alpha) out[3] = p[3];
}

/* Decodes the pixel at byte `at`. */
static lc_status put_pixel(const tga *t, size_t at, uint8_t *out)
{
    const uint8_t *p = t->data + at;
    if (t->type == 2) {
        put_colour(t, p, t->bytes, out);
    } else if (t->type == 3) {
        memcpy(out, p, t->bytes);
    } else {
        uint32_t code = t->bytes == 1 ? p[0] : get_u16(p);
        if (code < t->first || code - t->first >= t->n_palette)
            return damaged(t, at, "a pixel is outside the palette");
        put_colour(t, t->palette + (size_t)(code - t->first) * t->entry_bytes, t->entry_bytes, out);
    }
    return LC_OK;
}

/* The place in the raster of a pixel by its number in the file. */
static uint8_t *place(const tga *t, const lc_raster *r, size_t number)
{
    size_t x = number % r->width, y = number / r->width;
    if (t->data[17] & 16) x = r->width - 1 - x;
    if (!(t->data[17] & 32)) y = r->height - 1 - y;
    return (uint8_t *)r->data + (y * r->width + x) * r->n_channels;
}

/* Reads all pixels. Packets may continue on the next row, as older writers make them. */
static lc_status read_pixels(tga *t, const lc_raster *r)
{
    size_t n = (size_t)r->width * r->height;
    for (size_t i = 0; i < n;) {
        size_t count = n, packet = t->at;
        bool run = false;
        if (t->coded) {
            if (t->at >= t->len) return damaged(t, t->len, "pixels are missing");
            run = t->data[t->at] & 128;
            count = (t->data[t->at++] & 127) + (size_t)1;
        }
        if (count > n - i) return damaged(t, packet, "more pixels than the size says");
        if ((t->len - t->at) / t->bytes < (run ? 1 : count)) return damaged(t, t->len, "pixels are missing");
        for (size_t k = 0; k < count; k++, i++) {
            lc_status st = put_pixel(t, t->at, place(t, r, i));
            if (st) return st;
            if (!run) t->at += t->bytes;
        }
        if (run) t->at += t->bytes;
    }
    return LC_OK;
}

lc_status lc_tga_decode(lc_context *ctx, const char *path, const lc_bytes *file, lc_raster *out)
{
    tga t = { .ctx = ctx, .path = path, .data = file->data, .len = file->len };
    lc_raster size = { 0 };
    *out = (lc_raster){ 0 };
    lc_status st = read_header(&t, &size);
    if (!st) st = lc_raster_init(ctx, path, &size, file->len, MAX_RATIO, out);
    if (!st) st = read_pixels(&t, out);
    if (st) lc_raster_free(ctx, out);
    return st;
}
