/* pixels.h - the pixels of an image file as they stand there: integer codes or floats, colours not converted.
 *
 *     file -> lc_raster_decode, by what it starts with -> lc_raster -> texture, or planes of an lc_image
 *
 * Rows run from the top, the samples of a pixel lie side by side. A file is not trusted: its size in pixels
 * is held against its bytes before anything is allocated for it, and damage is an error that names file and
 * byte.
 */
#ifndef LC_RASTER_H
#define LC_RASTER_H

#include "io/file.h"

/* The value is the size of a sample in bytes. */
typedef enum lc_raster_kind { LC_RASTER_U8 = 1, LC_RASTER_U16 = 2, LC_RASTER_F32 = 4 } lc_raster_kind;

typedef struct lc_raster {
    uint32_t width, height;
    uint32_t n_channels; /* 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA */
    lc_raster_kind kind;
    void *data; /* width * height * n_channels samples, 64-byte aligned */
} lc_raster;

typedef lc_status lc_raster_decoder(lc_context *ctx, const char *path, const lc_bytes *file, lc_raster *out);

/* Does a file that starts so look like an image that is read? 8 bytes tell. */
bool lc_raster_is(const uint8_t *head, size_t len);
bool lc_jpeg_is(const uint8_t *head, size_t len);
/* `path` is for messages. LC_ERR_PARSE, _UNSUPPORTED, _MEMORY; *out is then empty. */
lc_raster_decoder lc_raster_decode;
void lc_raster_free(const lc_context *ctx, lc_raster *raster);

/* One for each format, raster_*.c. */
bool lc_pfm_is(const uint8_t *head, size_t len);
bool lc_hdr_is(const uint8_t *head, size_t len);
bool lc_tga_is(const uint8_t *head, size_t len); /* a guess: the format has no mark at its start */
lc_raster_decoder lc_png_decode, lc_pfm_decode, lc_hdr_decode, lc_tga_decode;

/* For the decoders. Checks the size, also against the file's: a byte of it makes at most max_pixels_per_byte.
 */
lc_status lc_raster_init(lc_context *ctx, const char *path, const lc_raster *size, size_t file_len,
                         uint32_t max_pixels_per_byte, lc_raster *out);
/* LC_ERR_PARSE: "PATH: error: damaged FORMAT file: WHAT at byte AT" */
lc_status lc_raster_damaged(const lc_context *ctx, const char *path, const char *format, size_t at,
                            const char *what);

#endif
