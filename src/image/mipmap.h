/* mipmap.h - an image as a pyramid of ever smaller ones, for textures.
 *
 *     level 0   width x height, rows from the top, 1 (grey) or 3 (RGB) channels; alpha is dropped
 *     level k   half of level k - 1, rounded up, each texel the mean of the area it covers, in linear light
 *
 * 8-bit images stay codes on every level, read through a table of 256 linear values; others are floats.
 * Lookups are of
 * + - * / and tables, so they give the same bits everywhere.
 */
#ifndef LC_MIPMAP_H
#define LC_MIPMAP_H

#include "image/pixels.h"

#define LC_MIP_LEVELS 30

/* How integer codes c / most become linear values. */
typedef struct lc_encoding {
    enum { LC_ENCODING_SRGB, LC_ENCODING_LINEAR, LC_ENCODING_GAMMA } kind;
    float gamma; /* > 0: c^gamma */
} lc_encoding;

typedef enum lc_wrap { LC_WRAP_REPEAT, LC_WRAP_CLAMP, LC_WRAP_BLACK } lc_wrap;
typedef enum lc_filter { LC_FILTER_POINT, LC_FILTER_BILINEAR, LC_FILTER_TRILINEAR } lc_filter;

typedef struct lc_mip_level {
    uint32_t width, height;
    size_t first; /* texel */
} lc_mip_level;

typedef struct lc_mipmap {
    lc_mip_level levels[LC_MIP_LEVELS];
    uint32_t n_levels, n_channels;
    bool is_codes;
    void *texels; /* uint8_t or float, n_texels * n_channels */
    size_t n_texels;
    float table[256]; /* of codes; rises */
} lc_mipmap;

/* Floats that are not finite count as 0. LC_ERR_MEMORY. */
lc_status lc_mipmap_build(const lc_context *ctx, const lc_raster *raster, lc_encoding encoding,
                          lc_mipmap *out);
void lc_mipmap_free(const lc_context *ctx, lc_mipmap *m);
size_t lc_mipmap_bytes(const lc_mipmap *m);

/* The value at (s, t), each finite, (0, 0) the upper left corner and (1, 1) the lower right one. width: of
 * the area that is seen, in texels of level 0. Point and bilinear look at one level, the one whose texels are
 * no wider than that. */
void lc_mipmap_lookup(const lc_mipmap *m, double s, double t, double width, lc_wrap wrap, lc_filter filter,
                      double out[3]);
/* A texel of level 0. */
void lc_mipmap_texel(const lc_mipmap *m, uint32_t x, uint32_t y, double out[3]);
/* The only texel of the last level. */
void lc_mipmap_mean(const lc_mipmap *m, double out[3]);

#endif
