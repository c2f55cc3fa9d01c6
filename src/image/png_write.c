/* png_write.c - writes PNG files to memory, with zlib: 8-bit RGB from the planes R, G and B, without alpha.
 *
 * Values below 0.8 are unchanged. Above, a shoulder compresses highlights so that they remain
 * distinguishable: f(v) = 0.8 + 0.2 t / (1 + t), t = (v - 0.8) / 0.2, with slope 1 at 0.8 and limit 1 at
 * infinity (1.0 becomes 0.9). Then the sRGB curve [IEC 61966-2-1] is applied. NaN and negative values become
 * black.
 */
#include "image/image.h"

#include "image/srgb.h"
#include "io/zlib_alloc.h"

#include <string.h>

#define PIECE ((size_t)1 << 16) /* bytes packed at once; between them it looks whether to stop */
#define USUAL_LEVEL 6 /* of zlib */
#define SHOULDER 0.8 /* linear value from which on highlights are compressed; chosen */

static const uint8_t signature[8] = { 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n' };

/* ---- codes ---- */

/* Sets threshold[k] to the linear value above which the nearest of the 256 codes is more than k. */
static void make_thresholds(double threshold[255])
{
    for (int k = 0; k < 255; k++) threshold[k] = lc_srgb_to_linear((k + 0.5) / 255.0);
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
    if (len) crc = crc32_z(crc, data, len); /* NULL would restart the checksum */
    put_u32(tail, (uint32_t)crc);
    lc_status status = lc_bytes_put(file, file->len, head, sizeof head);
    if (status == LC_OK) status = lc_bytes_put(file, file->len, data, len);
    if (status == LC_OK) status = lc_bytes_put(file, file->len, tail, sizeof tail);
    return status;
}

/* Fills `raw` with `height` rows of a filter byte (Paeth) and width * 3 filtered bytes. rows: scratch of two
 * unfiltered rows. */
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
            *raw++ = (uint8_t)(row[i] - lc_png_paeth(left, above[i], corner));
        }
        uint8_t *t = above;
        above = row;
        row = t;
    }
}

static lc_status deflate_all(const lc_context *ctx, uint8_t *raw, size_t raw_len, int level, lc_bytes *out)
{
    z_stream z = lc_zlib_stream(ctx);
    if (deflateInit(&z, level) != Z_OK) return LC_ERR_MEMORY;
    size_t bound = deflateBound(&z, raw_len);
    lc_status status = lc_grow(ctx, &out->data, &out->cap, bound, 1);
    z.next_in = raw;
    z.avail_in = (uInt)raw_len;
    z.next_out = out->data;
    for (int rv = Z_OK; rv != Z_STREAM_END && status == LC_OK;) {
        size_t left = bound - out->len;
        z.avail_out = (uInt)(left < PIECE ? left : PIECE);
        const uInt room = z.avail_out;
        rv = deflate(&z, Z_FINISH);
        out->len += room - z.avail_out;
        if (rv != Z_STREAM_END && rv != Z_OK) status = LC_ERR_MEMORY;
        else if (lc_stopped(ctx)) status = LC_ERR_CANCELLED;
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
        status = deflate_all(ctx, raw, raw_len, image->draft ? LC_DRAFT_LEVEL : USUAL_LEVEL, &packed);
    }
    lc_free(ctx, raw, raw_len, 1);
    lc_free(ctx, rows, row_len, 2);

    uint8_t header[13] = { [8] = 8, [9] = 2 }; /* 8 bits, RGB, deflate, adaptive filters, not interlaced */
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
