/* pixels.h - rasters: the pixels of an image file as integer codes or floats, colours not converted.
 *
 *     file -> lc_raster_decode, by its first bytes -> lc_raster -> texture, or planes of an lc_image
 *
 * Rows run from the top; the samples of a pixel are adjacent. Files are not trusted: the size in pixels is
 * checked against the bytes of the file before anything is allocated, and damage is an error with file and
 * byte.
 */
#ifndef LC_PIXELS_H
#define LC_PIXELS_H

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

/* True if a file with these first bytes, 8 suffice, looks like an image in a supported format. */
bool lc_raster_is(const uint8_t *head, size_t len);
/* `path` is for messages. LC_ERR_PARSE, _UNSUPPORTED, _MEMORY; on failure *out is empty. */
lc_raster_decoder lc_raster_decode;
void lc_raster_free(const lc_context *ctx, lc_raster *raster);

/* The decoders: png_read.c, jpeg.c, pfm.c, hdr.c, tga.c. */
bool lc_jpeg_is(const uint8_t *head, size_t len);
bool lc_pfm_is(const uint8_t *head, size_t len);
bool lc_hdr_is(const uint8_t *head, size_t len);
bool lc_tga_is(const uint8_t *head, size_t len); /* a guess, as the format has no signature */
lc_raster_decoder lc_png_decode, lc_jpeg_decode, lc_pfm_decode, lc_hdr_decode, lc_tga_decode;

/* For decoders: allocates a raster after checking its size, also against the file's: one byte of the file
 * gives at most max_pixels_per_byte pixels. */
lc_status lc_raster_init(lc_context *ctx, const char *path, const lc_raster *size, size_t file_len,
                         uint32_t max_pixels_per_byte, lc_raster *out);
/* Logs "PATH: error: damaged FORMAT file: WHAT at byte AT" and returns LC_ERR_PARSE. */
lc_status lc_raster_damaged(const lc_context *ctx, const char *path, const char *format, size_t at,
                            const char *what);

#endif
