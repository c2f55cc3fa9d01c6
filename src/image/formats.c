/* formats.c - reads images, in the format that a file's first bytes show, and writes them, in the one its
 * name shows. */
#include "image/image.h"

#include "base/memory.h"
#include "image/pixels.h"
#include "image/srgb.h"

#include <string.h>
#include <strings.h>

/* Integer codes are decoded as sRGB, alpha is linear; grey is copied to R, G and B. */
static lc_status image_of_raster(lc_context *ctx, const lc_raster *r, lc_image **out)
{
    static const char *const names[4] = { "R", "G", "B", "A" };
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    desc.width = r->width;
    desc.height = r->height;
    size_t n = (size_t)r->width * r->height, n_codes = r->kind == LC_RASTER_U8    ? 256
                                                       : r->kind == LC_RASTER_U16 ? 65536
                                                                                  : 0;
    bool grey = r->n_channels < 3, alpha = r->n_channels % 2 == 0;
    float *linear = lc_alloc(ctx, n_codes, sizeof *linear), *plane = NULL;
    lc_status status = linear ? lc_image_create(ctx, &desc, out) : LC_ERR_MEMORY;
    for (size_t i = 0; linear && i < n_codes; i++)
        linear[i] = (float)lc_srgb_to_linear((double)i / (double)(n_codes - 1));
    for (uint32_t c = 0; status == LC_OK && c < (alpha ? 4 : 3); c++) {
        size_t step = r->n_channels, from = c == 3 ? step - 1 : grey ? 0 : c;
        status = lc_image_add_channel(*out, names[c], &plane);
        for (size_t i = 0; status == LC_OK && i < n; i++, from += step) {
            if (r->kind == LC_RASTER_F32) {
                plane[i] = ((const float *)r->data)[from];
                continue;
            }
            size_t code = n_codes == 256 ? ((const uint8_t *)r->data)[from]
                                         : ((const uint16_t *)r->data)[from];
            plane[i] = c == 3 ? (float)((double)code / (double)(n_codes - 1)) : linear[code];
        }
    }
    lc_free(ctx, linear, n_codes, sizeof *linear);
    return status;
}

lc_status lc_image_read(lc_context *ctx, const char *path, lc_image **out)
{
    if (!out) return ctx ? lc_fail(ctx, LC_ERR_ARG, "lc_image_read: out is NULL") : LC_ERR_ARG;
    *out = NULL;
    if (!ctx) return LC_ERR_ARG;
    if (!path) return lc_fail(ctx, LC_ERR_ARG, "lc_image_read: path is NULL");
    lc_bytes file;
    lc_raster raster = { 0 };
    lc_memory_step(ctx, "reading a picture");
    lc_status status = lc_bytes_load(ctx, path, LC_IMAGE_MAX_FILE, lc_raster_is, &file);
    if (status != LC_OK) return status;
    if (lc_exr_is(file.data, file.len)) {
        status = lc_exr_decode(ctx, path, &file, out);
    } else {
        status = lc_raster_decode(ctx, path, &file, &raster);
        if (status == LC_OK) status = image_of_raster(ctx, &raster, out);
    }
    lc_raster_free(ctx, &raster);
    lc_bytes_free(&file);
    if (status == LC_OK) return status;
    lc_image_destroy(*out);
    *out = NULL;
    return status;
}

static bool has_extension(const char *path, const char *extension)
{
    size_t len = strlen(path), n = strlen(extension);
    return len > n && strcasecmp(path + len - n, extension) == 0;
}

lc_status lc_image_write(const lc_image *image, const char *path)
{
    if (!image || !path) return LC_ERR_ARG;
    lc_bytes file = { image->ctx, NULL, 0, 0 };
    lc_status status;
    lc_memory_step(image->ctx, "writing a picture");
    /* A device or pipe has no extension; it is written as EXR. */
    if (has_extension(path, ".png")) {
        status = lc_png_encode(image, path, &file);
    } else if (has_extension(path, ".exr") || lc_file_is_special(path)) {
        status = lc_exr_encode(image, path, &file);
    } else {
        return lc_fail_at(image->ctx, LC_ERR_ARG, (lc_pos){ path, 0, 0 },
                          "unknown image format: the name must end in .exr or .png");
    }
    if (status == LC_OK) status = lc_file_replace(image->ctx, path, file.data, file.len);
    lc_bytes_free(&file);
    return status;
}
