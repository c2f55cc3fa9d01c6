/* pixels.c - rasters: their memory, the choice of the decoder, and rasters from OpenEXR's planes. */
#include "image/pixels.h"

#include "image/image.h"

#include <string.h>

bool lc_raster_is(const uint8_t *head, size_t len)
{
    return lc_exr_is(head, len) || lc_png_is(head, len) || lc_pfm_is(head, len) || lc_hdr_is(head, len) ||
           lc_jpeg_is(head, len) || lc_tga_is(head, len);
}

lc_status lc_raster_damaged(const lc_context *ctx, const char *path, const char *format, size_t at,
                            const char *what)
{
    return lc_fail_at(ctx, LC_ERR_PARSE, (lc_pos){ path, 0, 0 }, "damaged %s file: %s at byte %zu", format,
                      what, at);
}

lc_status lc_raster_init(lc_context *ctx, const char *path, const lc_raster *size, size_t file_len,
                         uint32_t max_pixels_per_byte, lc_raster *out)
{
    uint64_t n_pixels = (uint64_t)size->width * size->height;
    *out = (lc_raster){ 0 };
    if (!n_pixels)
        return lc_fail_at(ctx, LC_ERR_PARSE, (lc_pos){ path, 0, 0 }, "an image of %u x %u pixels",
                          size->width, size->height);
    if (n_pixels > LC_IMAGE_MAX_PIXELS)
        return lc_fail_at(ctx, LC_ERR_UNSUPPORTED, (lc_pos){ path, 0, 0 }, "too large: %u x %u pixels",
                          size->width, size->height);
    if (n_pixels / max_pixels_per_byte > file_len)
        return lc_fail_at(ctx, LC_ERR_PARSE, (lc_pos){ path, 0, 0 },
                          "%zu bytes are too short for %u x %u pixels", file_len, size->width, size->height);
    void *data = lc_alloc(ctx, (size_t)n_pixels, size->n_channels * (size_t)size->kind);
    if (!data) return LC_ERR_MEMORY;
    *out = *size;
    out->data = data;
    return LC_OK;
}

void lc_raster_free(const lc_context *ctx, lc_raster *r)
{
    lc_free(ctx, r->data, (size_t)r->width * r->height, r->n_channels * (size_t)r->kind);
    *r = (lc_raster){ 0 };
}

/* Selects planes R G B A, or as grey Y or the only plane. False if there are neither. */
static bool pick_planes(const lc_image *image, const float *plane[4], uint32_t *n)
{
    static const char *const names[4] = { "R", "G", "B", "A" };
    for (int i = 0; i < 4; i++) plane[i] = lc_image_channel(image, names[i]);
    *n = plane[3] ? 4 : 3;
    if (plane[0] && plane[1] && plane[2]) return true;
    *n = 1;
    plane[0] = lc_image_channel(image, "Y");
    if (!plane[0] && image->n_channels == 1) plane[0] = image->channels[0].plane;
    return plane[0] != NULL;
}

static lc_status exr_decode(lc_context *ctx, const char *path, const lc_bytes *file, lc_raster *out)
{
    lc_image *image;
    const float *plane[4];
    lc_raster size = { .kind = LC_RASTER_F32 };
    lc_status st = lc_exr_decode(ctx, path, file, &image);
    if (st) return st;
    size.width = image->desc.width;
    size.height = image->desc.height;
    if (!pick_planes(image, plane, &size.n_channels))
        st = lc_fail_at(ctx, LC_ERR_UNSUPPORTED, (lc_pos){ path, 0, 0 },
                        "no channels R, G and B, nor Y, nor just one");
    if (!st) st = lc_raster_init(ctx, path, &size, file->len, UINT32_MAX, out);
    size_t n = st ? 0 : (size_t)size.width * size.height;
    for (uint32_t c = 0; !st && c < size.n_channels; c++)
        for (size_t i = 0; i < n; i++) ((float *)out->data)[i * size.n_channels + c] = plane[c][i];
    lc_image_destroy(image);
    return st;
}

lc_status lc_raster_decode(lc_context *ctx, const char *path, const lc_bytes *file, lc_raster *out)
{
    static const struct {
        bool (*is)(const uint8_t *head, size_t len);
        lc_raster_decoder *decode;
    } formats[] = { { lc_exr_is, exr_decode },      { lc_png_is, lc_png_decode },
                    { lc_pfm_is, lc_pfm_decode },   { lc_hdr_is, lc_hdr_decode },
                    { lc_jpeg_is, lc_jpeg_decode }, { lc_tga_is, lc_tga_decode } };
    *out = (lc_raster){ 0 };
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (formats[i].is(file->data, file->len)) return formats[i].decode(ctx, path, file, out);
    return lc_fail_at(ctx, LC_ERR_PARSE, (lc_pos){ path, 0, 0 }, "%s",
                      file->len
                          ? "not an image of a known format: OpenEXR, PNG, JPEG, PFM, Radiance HDR or TGA"
                          : "the file is empty");
}
