/* jpeg.c - JPEG files: sequential and progressive frames of 8 bits with Huffman codes, grey or three
 * components, any sampling factors that divide the largest, restarts, tables that change between scans.
 *
 * Markers and tables are read here. Profiles and orientations in application segments are not applied. What
 * [T.81] allows beside this, lossless, hierarchical and arithmetic coding, 12 bits and CMYK, is refused by
 * name.
 */
#include "image/jpeg.h"

#include "base/arena.h"

#include <stdio.h>
#include <string.h>

#define MAX_SCANS 1000 /* a progressive file can ask for a pass over all blocks by a few bytes */
/* A block has at least one bit, that of DC, and at most 64 x 4 x 4 pixels. */
#define MAX_RATIO (8 * 64 * 16)

const uint8_t lc_jpeg_zigzag[LC_JPEG_BLOCK] = {
    0,  1,  8,  16, 9,  2,  3,  10, 17, 24, 32, 25, 18, 11, 4,  5,  12, 19, 26, 33, 40, 48,
    41, 34, 27, 20, 13, 6,  7,  14, 21, 28, 35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23,
    30, 37, 44, 51, 58, 59, 52, 45, 38, 31, 39, 46, 53, 60, 61, 54, 47, 55, 62, 63,
};

bool lc_jpeg_is(const uint8_t *head, size_t len)
{
    return len >= 3 && head[0] == 0xff && head[1] == 0xd8 && head[2] == 0xff;
}

lc_status lc_jpeg_damaged(const lc_jpeg *j, const char *what)
{
    return lc_raster_damaged(j->ctx, j->path, "JPEG", j->at, what);
}

static lc_status unsupported(const lc_jpeg *j, const char *what)
{
    return lc_fail_at(j->ctx, LC_ERR_UNSUPPORTED, (lc_pos){ j->path, 0, 0 },
                      "JPEG with %s is not read; convert it to PNG", what);
}

static uint32_t get_u16(const uint8_t *p) { return (uint32_t)p[0] << 8 | p[1]; }

/* ---- tables ---- */

static lc_status read_quant(lc_jpeg *j, const uint8_t *d, size_t n)
{
    while (n) {
        uint32_t wide = d[0] >> 4, table = d[0] & 15;
        size_t size = 1 + LC_JPEG_BLOCK * (size_t)(1 + wide);
        if (wide > 1 || table > 3) return lc_jpeg_damaged(j, "no such quantization table");
        if (n < size) return lc_jpeg_damaged(j, "a quantization table is cut off");
        for (size_t i = 0; i < LC_JPEG_BLOCK; i++)
            j->quant[table][lc_jpeg_zigzag[i]] = (uint16_t)(wide ? get_u16(d + 1 + 2 * i) : d[1 + i]);
        j->has_quant[table] = true;
        d += size;
        n -= size;
    }
    return LC_OK;
}

/* The codes of [T.81, C.2]; false: more codes than there are of a length. */
static bool make_codes(lc_jpeg_huffman *h, const uint8_t counts[16], const uint8_t *values, size_t n)
{
    *h = (lc_jpeg_huffman){ .defined = true };
    memcpy(h->values, values, n);
    int32_t code = 0, index = 0;
    for (int len = 1; len <= 16; len++, code <<= 1) {
        int32_t count = counts[len - 1];
        h->first[len] = index - code;
        h->max_code[len] = count ? code + count - 1 : -1;
        if (code + count > 1 << len) return false;
        for (int32_t i = 0; i < count && len <= 8; i++)
            for (int32_t k = 0; k < 1 << (8 - len); k++) {
                h->fast_len[(code + i) << (8 - len) | k] = (uint8_t)len;
                h->fast_value[(code + i) << (8 - len) | k] = values[index + i];
            }
        code += count;
        index += count;
    }
    return true;
}

static lc_status read_huffman(lc_jpeg *j, const uint8_t *d, size_t n)
{
    while (n) {
        uint32_t kind = d[0] >> 4, table = d[0] & 15;
        size_t n_codes = 0;
        if (kind > 1 || table > 3) return lc_jpeg_damaged(j, "no such Huffman table");
        for (size_t i = 0; i < 16 && n > 16; i++) n_codes += d[1 + i];
        if (n < 17 + n_codes) return lc_jpeg_damaged(j, "a Huffman table is cut off");
        if (n_codes > 256 || !make_codes(kind ? &j->ac[table] : &j->dc[table], d + 1, d + 17, n_codes))
            return lc_jpeg_damaged(j, "a Huffman table has too many codes");
        d += 17 + n_codes;
        n -= 17 + n_codes;
    }
    return LC_OK;
}

static void read_application(lc_jpeg *j, uint32_t marker, const uint8_t *d, size_t n)
{
    if (marker == 0xe0 && n >= 5 && !memcmp(d, "JFIF", 5)) j->jfif = true;
    if (marker != 0xee || n < 12 || memcmp(d, "Adobe", 5)) return;
    j->adobe = true;
    j->adobe_transform = d[11];
}

/* ---- the frame ---- */

static lc_status read_parts(lc_jpeg *j, const uint8_t *d)
{
    j->h_max = j->v_max = 1;
    for (uint32_t i = 0; i < j->n_parts; i++) {
        lc_jpeg_part *p = &j->parts[i];
        p->id = d[3 * i];
        p->h = d[3 * i + 1] >> 4;
        p->v = d[3 * i + 1] & 15;
        p->table = d[3 * i + 2];
        if (!p->h || p->h > 4 || !p->v || p->v > 4 || p->table > 3)
            return lc_jpeg_damaged(j, "sampling factors or tables out of range");
        for (uint32_t k = 0; k < i; k++)
            if (j->parts[k].id == p->id) return lc_jpeg_damaged(j, "two components of one name");
        if (j->n_parts == 1) p->h = p->v = 1;
        if (p->h > j->h_max) j->h_max = p->h;
        if (p->v > j->v_max) j->v_max = p->v;
    }
    for (uint32_t i = 0; i < j->n_parts; i++)
        if (j->h_max % j->parts[i].h || j->v_max % j->parts[i].v)
            return unsupported(j, "sampling factors that do not divide the largest");
    return LC_OK;
}

static lc_status make_parts(lc_jpeg *j)
{
    uint32_t units_x = (j->width + 8 * j->h_max - 1) / (8 * j->h_max);
    uint32_t units_y = (j->height + 8 * j->v_max - 1) / (8 * j->v_max);
    for (uint32_t i = 0; i < j->n_parts; i++) {
        lc_jpeg_part *p = &j->parts[i];
        p->width = (j->width * p->h + j->h_max - 1) / j->h_max;
        p->height = (j->height * p->v + j->v_max - 1) / j->v_max;
        p->cols = (p->width + 7) / 8;
        p->rows = (p->height + 7) / 8;
        p->wide = units_x * p->h;
        p->high = units_y * p->v;
        memset(p->bit, -1, sizeof p->bit);
        size_t n = (size_t)p->wide * p->high;
        p->coefs = lc_alloc(j->ctx, n, LC_JPEG_BLOCK * sizeof *p->coefs);
        p->samples = lc_alloc(j->ctx, n, LC_JPEG_BLOCK);
        if (!p->coefs || !p->samples) return LC_ERR_MEMORY;
    }
    return LC_OK;
}

static void free_parts(lc_jpeg *j)
{
    for (uint32_t i = 0; i < 3; i++) {
        lc_jpeg_part *p = &j->parts[i];
        lc_free(j->ctx, p->coefs, (size_t)p->wide * p->high, LC_JPEG_BLOCK * sizeof *p->coefs);
        lc_free(j->ctx, p->samples, (size_t)p->wide * p->high, LC_JPEG_BLOCK);
    }
}

static lc_status read_frame(lc_jpeg *j, uint32_t marker, const uint8_t *d, size_t n, lc_raster *out)
{
    if (j->n_parts) return lc_jpeg_damaged(j, "a second frame");
    if (marker >= 0xc9) return unsupported(j, "arithmetic coding");
    if (marker > 0xc2) return unsupported(j, marker == 0xc3 ? "lossless coding" : "a hierarchy of frames");
    if (n < 6 || n != 6 + 3 * (size_t)d[5]) return lc_jpeg_damaged(j, "the frame has a wrong length");
    if (d[0] != 8) return unsupported(j, "other than 8 bits");
    if (d[5] != 1 && d[5] != 3)
        return unsupported(j, d[5] == 4 ? "CMYK colours" : "other than 1 or 3 components");
    j->progressive = marker == 0xc2;
    j->height = get_u16(d + 1);
    j->width = get_u16(d + 3);
    if (!j->height && j->width) return unsupported(j, "its height behind the pixels");
    j->n_parts = d[5];
    const lc_raster size = { j->width, j->height, j->n_parts, LC_RASTER_U8, NULL };
    lc_status st = read_parts(j, d + 6);
    if (!st) st = lc_raster_init(j->ctx, j->path, &size, j->len, MAX_RATIO, out);
    return st ? st : make_parts(j);
}

/* ---- scans ---- */

/* Whether the scan's bits follow those known of its coefficients [T.81, G.1.1.1]; then they are known. */
static bool in_order(lc_jpeg *j)
{
    if (j->from > j->to || j->to > 63 || j->low_bit > 13 || (j->from && j->n_in_scan > 1)) return false;
    if (j->progressive ? !j->from && j->to : j->from || j->to != 63 || j->high_bit || j->low_bit)
        return false;
    for (uint32_t i = 0; i < j->n_in_scan; i++) {
        int8_t *bit = j->in_scan[i]->bit;
        if (j->from && bit[0] < 0) return false;
        for (uint32_t k = j->from; k <= j->to; k++) {
            if (j->high_bit ? bit[k] != j->high_bit || j->low_bit + 1 != j->high_bit : bit[k] >= 0)
                return false;
            bit[k] = (int8_t)j->low_bit;
        }
    }
    return true;
}

static lc_status pick_part(lc_jpeg *j, uint32_t i, const uint8_t *d)
{
    lc_jpeg_part *p = NULL;
    uint32_t dc = d[1] >> 4, ac = d[1] & 15;
    for (uint32_t k = 0; k < j->n_parts; k++)
        if (j->parts[k].id == d[0]) p = &j->parts[k];
    for (uint32_t k = 0; k < i; k++)
        if (j->in_scan[k] == p) p = NULL;
    if (!p || dc > 3 || ac > 3) return lc_jpeg_damaged(j, "a scan of no such component or table");
    if (!j->has_quant[p->table]) return lc_jpeg_damaged(j, "a quantization table is missing");
    if (p->bit[0] < 0) memcpy(p->quant, j->quant[p->table], sizeof p->quant);
    j->in_scan[i] = p;
    p->dc = &j->dc[dc];
    p->ac = &j->ac[ac];
    return LC_OK;
}

static lc_status read_scan(lc_jpeg *j, const uint8_t *d, size_t n)
{
    uint32_t blocks = 0;
    if (!j->n_parts) return lc_jpeg_damaged(j, "a scan before the frame");
    if (n < 1 || !d[0] || d[0] > j->n_parts || n != 4 + 2 * (size_t)d[0])
        return lc_jpeg_damaged(j, "the scan's header has a wrong length");
    if (++j->n_scans > MAX_SCANS) return lc_jpeg_damaged(j, "too many scans");
    j->n_in_scan = d[0];
    for (uint32_t i = 0; i < j->n_in_scan; i++) {
        lc_status st = pick_part(j, i, d + 1 + 2 * i);
        if (st) return st;
        blocks += (uint32_t)(j->in_scan[i]->h * j->in_scan[i]->v);
    }
    const uint8_t *band = d + 1 + 2 * (size_t)j->n_in_scan;
    j->from = band[0];
    j->to = band[1];
    j->high_bit = band[2] >> 4;
    j->low_bit = band[2] & 15;
    if (j->n_in_scan > 1 && blocks > 10) return lc_jpeg_damaged(j, "too many blocks in a unit");
    if (!in_order(j)) return lc_jpeg_damaged(j, "a scan that does not follow from those before");
    for (uint32_t i = 0; i < j->n_in_scan; i++)
        if ((!j->from && !j->high_bit && !j->in_scan[i]->dc->defined) ||
            (j->to && !j->in_scan[i]->ac->defined))
            return lc_jpeg_damaged(j, "a Huffman table is missing");
    return lc_jpeg_scan(j);
}

/* ---- markers ---- */

/* The next marker; what is before it, but for fill bytes only damage, is skipped. 0: none. */
static uint32_t next_marker(lc_jpeg *j)
{
    while (j->at + 1 < j->len) {
        uint32_t marker = j->data[j->at + 1];
        if (j->data[j->at] == 0xff && marker != 0 && marker != 0xff) {
            j->at += 2;
            return marker;
        }
        j->at++;
    }
    return 0;
}

static lc_status read_segment(lc_jpeg *j, uint32_t marker, lc_raster *out)
{
    size_t left = j->len - j->at, n = left >= 2 ? get_u16(j->data + j->at) : 0;
    if (n < 2 || n > left) return lc_jpeg_damaged(j, "a segment is cut off");
    const uint8_t *d = j->data + j->at + 2;
    n -= 2;
    lc_status st = LC_OK;
    if (marker == 0xda) j->at += n + 2; /* the scan's data follow */
    if (marker == 0xda) return read_scan(j, d, n);
    if (marker == 0xdb) st = read_quant(j, d, n);
    else if (marker == 0xc4) st = read_huffman(j, d, n);
    else if (marker >= 0xc0 && marker <= 0xcf && marker != 0xc8 && marker != 0xcc)
        st = read_frame(j, marker, d, n, out);
    else if (marker == 0xdd && n != 2) st = lc_jpeg_damaged(j, "the restart interval has a wrong length");
    else if (marker == 0xdd) j->restart = get_u16(d);
    else if (marker == 0xcc) st = unsupported(j, "arithmetic coding");
    else if (marker == 0xde) st = unsupported(j, "a hierarchy of frames");
    else if (marker == 0xdc) st = unsupported(j, "its height behind the pixels");
    else read_application(j, marker, d, n);
    j->at += n + 2;
    return st;
}

static lc_status read_all(lc_jpeg *j, lc_raster *out)
{
    uint32_t marker;
    while ((marker = next_marker(j)) != 0 && marker != 0xd9) {
        bool alone = marker == 0x01 || (marker >= 0xd0 && marker <= 0xd8);
        lc_status st = alone ? LC_OK : read_segment(j, marker, out);
        if (st) return st;
    }
    if (!marker) return lc_jpeg_damaged(j, "the end is missing");
    for (uint32_t i = 0; i < j->n_parts; i++)
        if (j->parts[i].bit[0] < 0) return lc_jpeg_damaged(j, "a component is missing");
    return j->n_parts ? LC_OK : lc_jpeg_damaged(j, "there is no frame");
}

lc_status lc_jpeg_decode(lc_context *ctx, const char *path, const lc_bytes *file, lc_raster *out)
{
    *out = (lc_raster){ 0 };
    lc_jpeg *j = lc_alloc(ctx, 1, sizeof *j);
    if (!j) return LC_ERR_MEMORY;
    j->ctx = ctx;
    j->path = path;
    j->data = file->data;
    j->len = file->len;
    lc_status st = LC_OK;
    if (!lc_jpeg_is(j->data, j->len)) st = lc_jpeg_damaged(j, "no signature");
    j->at = 2;
    if (!st) st = read_all(j, out);
    if (!st) st = lc_jpeg_pixels(j, out);
    free_parts(j);
    lc_free(ctx, j, 1, sizeof *j);
    if (st) lc_raster_free(ctx, out);
    return st;
}
