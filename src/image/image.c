/* image.c - creates images and their channels and attributes. */
#include "image/image.h"

#include "base/desc.h"

#include <string.h>
#include <strings.h>

/* ---- images and channels ---- */

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
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    if (!ctx || !desc || lc_desc_take(ctx, "lc_image_desc", &d, sizeof d, desc)) return LC_ERR_ARG;
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

lc_status lc_image_get_desc(const lc_image *image, lc_image_desc *desc)
{
    return lc_desc_give(image->ctx, "lc_image_desc", desc, &image->desc, sizeof *desc);
}

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

bool lc_image_writes_float(const char *name)
{
    static const char *const names[] = { "renderTimeSeconds", "pixelAspectRatio", "screenWindowWidth",
                                         "xDensity",          "exposure",         "aperture",
                                         "expTime",           "isoSpeed",         "focus",
                                         "MSE" };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(names[i], name) == 0) return true;
    return false;
}

bool lc_image_writes_half(const lc_image *image)
{
    return image->n_channels == 3 && lc_image_channel(image, "R") && lc_image_channel(image, "G") &&
           lc_image_channel(image, "B");
}

bool lc_image_is_layout(const char *name, bool as_number)
{
    static const char *const names[] = { "channels",   "compression",        "dataWindow",
                                         "lineOrder",  "displayWindow",      "name",
                                         "type",       "screenWindowCenter", "version",
                                         "chunkCount", "tiles",              "pixelAspectRatio",
                                         "screenWindowWidth" };
    const size_t n = sizeof names / sizeof *names - (as_number ? 2 : 0);
    for (size_t i = 0; i < n; i++)
        if (strcmp(names[i], name) == 0) return true;
    return false;
}

/* Adds a copy of `attr`, or replaces the attribute of the same name. */
static lc_status set_attr(lc_image *image, lc_attr attr)
{
    size_t len = strlen(attr.name);
    if (len == 0 || len > LC_IMAGE_MAX_NAME) {
        return lc_fail(image->ctx, LC_ERR_ARG, "image attribute name of %zu bytes: not between 1 and %d", len,
                       LC_IMAGE_MAX_NAME);
    }
    if (lc_image_is_layout(attr.name, attr.kind == LC_ATTR_NUMBER))
        return lc_fail(image->ctx, LC_ERR_ARG, "image attribute %s is part of the layout of OpenEXR",
                       attr.name);
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
        if (image->attrs[i].kind == LC_ATTR_TEXT && strcmp(image->attrs[i].name, name) == 0)
            return image->attrs[i].text;
    return NULL;
}

double lc_image_get_number(const lc_image *image, const char *name, double otherwise)
{
    for (size_t i = 0; i < image->n_attrs; i++)
        if (image->attrs[i].kind == LC_ATTR_NUMBER && strcmp(image->attrs[i].name, name) == 0)
            return image->attrs[i].number;
    return otherwise;
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
