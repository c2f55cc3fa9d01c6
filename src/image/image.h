/* image.h - an image in memory: named float planes, a data window, attributes.
 *
 * The room image/ reads and writes pictures:
 *
 *     file -> raster of codes or floats (pixels.h) -> planes of an lc_image
 *                                                  -> mipmap of a texture (mipmap.h)
 *     lc_image -> EXR (exr_write.c), PNG (png_write.c) -> file
 *
 * An image:
 *
 *     display window  (0,0) .. (display_width, display_height)
 *       data window   (x0,y0) .. (x0+width, y0+height), the pixels held; may lie outside the display window
 *     plane           width * height floats by rows from the top, first pixel (x0,y0)
 *
 * Planes, names and attributes are in the image's arena. Names of channels and of attributes are unique.
 */
#ifndef LC_IMAGE_H
#define LC_IMAGE_H

#include "base/arena.h"
#include "io/file.h"

#define LC_IMAGE_MAX_PIXELS ((uint64_t)1 << 28)  /* of the data window */
#define LC_IMAGE_MAX_SAMPLES ((uint64_t)1 << 30) /* pixels * channels: 4 GiB of floats */
#define LC_IMAGE_MAX_COORD (1 << 28)             /* limits |x0|, |y0| and the display size */
#define LC_IMAGE_MAX_NAME 255                    /* bytes; EXR's limit */
#define LC_IMAGE_MAX_FILE ((size_t)1 << 33)      /* bytes of a file that is read */

typedef struct lc_channel {
    const char *name;
    float *plane;
} lc_channel;

typedef enum lc_attr_kind { LC_ATTR_TEXT, LC_ATTR_NUMBER, LC_ATTR_MATRIX } lc_attr_kind;

typedef struct lc_attr {
    const char *name;
    lc_attr_kind kind;
    const char *text;
    double number;
    float matrix[16]; /* row-major, acts on column vectors */
} lc_attr;

struct lc_image {
    const lc_context *ctx;
    lc_arena arena;
    lc_image_desc desc;
    lc_channel *channels;
    size_t n_channels, cap_channels;
    lc_attr *attrs;
    size_t n_attrs, cap_attrs;
    bool draft; /* its EXR and PNG files are compressed fast rather than well */
};

#define LC_DRAFT_LEVEL 1 /* of zlib, for drafts: a third of the time, a tenth more bytes */

/* Codecs between images and the bytes of files: exr.c, png_write.c. `path` is for messages. _is tells by the
 * first bytes whether a file has the format. LC_ERR_PARSE, _UNSUPPORTED, _MEMORY, and LC_ERR_ARG from
 * encoders. */
bool lc_exr_is(const uint8_t *head, size_t len);
lc_status lc_exr_decode(lc_context *ctx, const char *path, const lc_bytes *file, lc_image **out);
lc_status lc_exr_encode(const lc_image *image, const char *path, lc_bytes *file);
bool lc_png_is(const uint8_t *head, size_t len);
uint8_t lc_png_paeth(uint8_t left, uint8_t up, uint8_t corner); /* the predictor of filter 4 [PNG, 9.4] */
lc_status lc_png_encode(const lc_image *image, const char *path, lc_bytes *file);

/* How an EXR file is written: these numbers as float, all others as int or double; pixels as half if there
 * are only R, G and B, clamped to LC_HALF_MAX, else as float. */
bool lc_image_writes_float(const char *name);
bool lc_image_writes_half(const lc_image *image);
#define LC_HALF_MAX 65504.0f /* larger values would become infinity */

/* Whether OpenEXR's layout needs the attribute, or would drop it: it cannot be set. as_number: of some a
 * number can. */
bool lc_image_is_layout(const char *name, bool as_number);

#endif
