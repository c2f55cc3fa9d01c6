/* image.c - see image.h. Reading goes by what a file starts with, writing by the name's extension. */
#include "image.h"

#include "raster.h"
#include "srgb.h"

#include <string.h>
#include <strings.h>

/* ---- making and looking ---- */

static lc_status check_desc(const lc_context *ctx, lc_image_desc *d)
{
    if (d->width == 0 || d->height == 0 || (uint64_t)d->width * d->height > LC_IMAGE_MAX_PIXELS) {
        return lc_fail(ctx, LC_ERR_ARG, "image of %u x %u pixels: not between 1 and 2^28 pixels", d->width,
                       d->height);
    }
    if (d->display_width == 0) d->display_width = d->width;
    if (d->display_height == 0) d->display_height = d->height;
    if (d->x0 < -LC_IMAGE_MAX_COORD || d->x0 > LC_IMAGE_MAX_COORD || d->y0 < -LC_IMAGE_MAX_COORD ||
        d->y0 > LC_IMAGE_MAX_COORD || d->display_width > LC_IMAGE_MAX_COORD ||
        d->display_height > LC_IMAGE_MAX_COORD) {
        return lc_fail(ctx, LC_ERR_ARG, "image window at %d, %d in %u x %u: out of range", d->x0, d->y0,
                       d->display_width, d->display_height);
    }
    return LC_OK;
}

lc_status lc_image_create(lc_context *ctx, const lc_image_desc *desc, lc_image **out)
{
    if (!out) return LC_ERR_ARG;
    *out = NULL;
    if (!ctx || !desc || desc->size != sizeof *desc) return LC_ERR_ARG;
    lc_image_desc d = *desc;
    lc_status status = check_desc(ctx, &d);
    if (status != LC_OK) return status;

    lc_image *image = lc_alloc(ctx, 1, sizeof *image);
    if (!image) return LC_ERR_MEMORY;
    image->ctx = ctx;
    image->desc = d;
    lc_arena_init(&image->arena, ctx);
    *out = image;
    return LC_OK;
}

void lc_image_destroy(lc_image *image)
{
    if (!image) return;
    lc_free(image->ctx, image->channels, image->cap_channels, sizeof *image->channels);
    lc_free(image->ctx, image->attrs, image->cap_attrs, sizeof *image->attrs);
    lc_arena_free(&image->arena);
    lc_free(image->ctx, image, 1, sizeof *image);
}

void lc_image_get_desc(const lc_image *image, lc_image_desc *desc) { *desc = image->desc; }

uint32_t lc_image_n_channels(const lc_image *image) { return (uint32_t)image->n_channels; }

const char *lc_image_channel_name(const lc_image *image, uint32_t idx)
{
    return idx < image->n_channels ? image->channels[idx].name : NULL;
}

float *lc_image_channel(const lc_image *image, const char *name)
{
    for (size_t i = 0; i < image->n_channels; i++) {
        if (strcmp(image->channels[i].name, name) == 0) return image->channels[i].plane;
    }
    return NULL;
}

lc_status lc_image_add_channel(lc_image *image, const char *name, float **plane)
{
    if (plane) *plane = NULL;
    if (!image || !name) return LC_ERR_ARG;
    size_t len = strlen(name);
    if (len == 0 || len > LC_IMAGE_MAX_NAME) {
        return lc_fail(image->ctx, LC_ERR_ARG, "image channel name of %zu bytes: not between 1 and %d", len,
                       LC_IMAGE_MAX_NAME);
    }
    if (lc_image_channel(image, name)) {
        return lc_fail(image->ctx, LC_ERR_ARG, "image channel %s is there already", name);
    }
    uint64_t n_pixels = (uint64_t)image->desc.width * image->desc.height;
    if (n_pixels * (image->n_channels + 1) > LC_IMAGE_MAX_SAMPLES) {
        return lc_fail(image->ctx, LC_ERR_ARG, "image of %zu channels of %u x %u pixels is too large",
                       image->n_channels + 1, image->desc.width, image->desc.height);
    }
    void *channels = image->channels;
    lc_status status =
        lc_grow(image->ctx, &channels, &image->cap_channels, image->n_channels + 1, sizeof *image->channels);
    image->channels = channels;
    if (status != LC_OK) return status;
    lc_channel channel = { lc_arena_text(&image->arena, name, len), NULL };
    if (!channel.name) return LC_ERR_MEMORY;
    channel.plane = lc_arena_alloc(&image->arena, (size_t)n_pixels, sizeof(float));
    if (!channel.plane) return LC_ERR_MEMORY;
    image->channels[image->n_channels++] = channel;
    if (plane) *plane = channel.plane;
    return LC_OK;
}

/* ---- attributes ---- */

/* Copies `attr` in, over one of the same name. */
static lc_status set_attr(lc_image *image, lc_attr attr)
{
    size_t len = strlen(attr.name);
    if (len == 0 || len > LC_IMAGE_MAX_NAME) {
        return lc_fail(image->ctx, LC_ERR_ARG, "image attribute name of %zu bytes: not between 1 and %d", len,
                       LC_IMAGE_MAX_NAME);
    }
    if (attr.text) {
        attr.text = lc_arena_text(&image->arena, attr.text, strlen(attr.text));
        if (!attr.text) return LC_ERR_MEMORY;
    }
    size_t i = 0;
    while (i < image->n_attrs && strcmp(image->attrs[i].name, attr.name) != 0) i++;
    if (i < image->n_attrs) {
        attr.name = image->attrs[i].name;
        image->attrs[i] = attr;
        return LC_OK;
    }
    attr.name = lc_arena_text(&image->arena, attr.name, len);
    if (!attr.name) return LC_ERR_MEMORY;
    void *attrs = image->attrs;
    lc_status status = lc_grow(image->ctx, &attrs, &image->cap_attrs, image->n_attrs + 1, sizeof attr);
    image->attrs = attrs;
    if (status != LC_OK) return status;
    image->attrs[image->n_attrs++] = attr;
    return LC_OK;
}

const char *lc_image_get_text(const lc_image *image, const char *name)
{
    for (size_t i = 0; i < image->n_attrs; i++)
        if (image->attrs[i].kind == LC_ATTR_TEXT && strcmp(image->attrs[i].name, name) == 0) return image->attrs[i].text;
    return NULL;
}

lc_status lc_image_set_text(lc_image *image, const char *name, const char *value)
{
    if (!image || !name || !value) return LC_ERR_ARG;
    return set_attr(image, (lc_attr){ .name = name, .kind = LC_ATTR_TEXT, .text = value });
}

lc_status lc_image_set_number(lc_image *image, const char *name, double value)
{
    if (!image || !name) return LC_ERR_ARG;
    return set_attr(image, (lc_attr){ .name = name, .kind = LC_ATTR_NUMBER, .number = value });
}

lc_status lc_image_set_matrix(lc_image *image, const char *name, const float m[16])
{
    if (!image || !name || !m) return LC_ERR_ARG;
    lc_attr attr = { .name = name, .kind = LC_ATTR_MATRIX };
    memcpy(attr.matrix, m, sizeof attr.matrix);
    return set_attr(image, attr);
}

/* ---- files ---- */

/* Integer codes are taken as sRGB, alpha as it is; a grey plane stands for R, G and B. */
static lc_status image_of_raster(lc_context *ctx, const lc_raster *r, lc_image **out)
{
    static const char *const names[4] = { "R", "G", "B", "A" };
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    desc.width = r->width, desc.height = r->height;
    size_t n = (size_t)r->width * r->height, n_codes = r->kind == LC_RASTER_U8 ? 256 : r->kind == LC_RASTER_U16 ? 65536 : 0;
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
            size_t code = n_codes == 256 ? ((const uint8_t *)r->data)[from] : ((const uint16_t *)r->data)[from];
            plane[i] = c == 3 ? (float)((double)code / (double)(n_codes - 1)) : linear[code];
        }
    }
    lc_free(ctx, linear, n_codes, sizeof *linear);
    return status;
}

lc_status lc_image_read(lc_context *ctx, const char *path, lc_image **out)
{
    if (!out) return LC_ERR_ARG;
    *out = NULL;
    if (!ctx || !path) return LC_ERR_ARG;
    lc_bytes file;
    lc_raster raster = { 0 };
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
    // A device or pipe has no extension to go by and gets EXR.
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
