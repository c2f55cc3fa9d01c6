/* mipmap.h - an image as a pyramid of levels, each half as large as the one before, for textures.
 *
 *     level 0   width x height, rows from the top, 1 (grey) or 3 (RGB) channels; alpha is dropped
 *     level k   half of level k - 1, rounded up; each texel is the linear mean of the area it covers
 *
 * 8-bit images remain codes on every level and are decoded by a table of 256 linear values; others are
 * floats. Lookups use + - * / and tables only, so they give the same bits on every machine.
 */
#ifndef LC_MIPMAP_H
#define LC_MIPMAP_H

#include "image/pixels.h"

#define LC_MIP_LEVELS 30

/* How integer codes, divided by the largest to c in 0..1, are decoded to linear values. */
typedef struct lc_encoding {
    enum { LC_ENCODING_SRGB, LC_ENCODING_LINEAR, LC_ENCODING_GAMMA } kind;
    float gamma; /* LC_ENCODING_GAMMA: c^gamma; > 0 */
} lc_encoding;

typedef enum lc_wrap { LC_WRAP_REPEAT, LC_WRAP_CLAMP, LC_WRAP_BLACK } lc_wrap;
typedef enum lc_filter { LC_FILTER_POINT, LC_FILTER_BILINEAR, LC_FILTER_TRILINEAR } lc_filter;

typedef struct lc_mip_level {
    uint32_t width, height;
    size_t first; /* index of its first texel */
} lc_mip_level;

typedef struct lc_mipmap {
    lc_mip_level levels[LC_MIP_LEVELS];
    uint32_t n_levels, n_channels;
    bool is_codes;
    void *texels; /* n_texels * n_channels, uint8_t if is_codes, else float */
    size_t n_texels;
    float table[256]; /* the linear values of codes, which increase */
} lc_mipmap;

/* Copies the raster. Floats that are not finite become 0. LC_ERR_MEMORY. */
lc_status lc_mipmap_build(const lc_context *ctx, const lc_raster *raster, lc_encoding encoding,
                          lc_mipmap *out);
lc_status lc_mipmap_copy(const lc_context *ctx, const lc_mipmap *m, lc_mipmap *out); /* LC_ERR_MEMORY */
void lc_mipmap_free(const lc_context *ctx, lc_mipmap *m);
size_t lc_mipmap_bytes(const lc_mipmap *m);

/* The linear value at (s, t), both finite; (0, 0) is the upper left corner, (1, 1) the lower right one.
 * width: of the pixel's footprint, in texels of level 0. Point and bilinear filtering use one level, the
 * coarsest whose texels are no wider than that; trilinear filtering interpolates between it and the next. */
void lc_mipmap_lookup(const lc_mipmap *m, double s, double t, double width, lc_wrap wrap, lc_filter filter,
                      double out[3]);
/* The linear value of texel (x, y) of level 0. */
void lc_mipmap_texel(const lc_mipmap *m, uint32_t x, uint32_t y, double out[3]);
/* The mean of the image: the single texel of the last level. */
void lc_mipmap_mean(const lc_mipmap *m, double out[3]);

#endif
