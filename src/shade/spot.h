/* spot.h - how a spot light's intensity varies with direction.
 *
 *     t = (cos phi - cos_total) / (cos_start - cos_total) in 0..1      emission = t^2 (3 - 2 t) colour
 *
 * phi is the angle about the light's axis; the colour is 1, or that of a map: a picture that is projected, or
 * intensities by direction on an octahedron (x, y of the direction over |x| + |y| + |z|, the lower half
 * folded outwards), each 0..1, so that a bound of the cosine alone holds. Estimates of all instruction sets
 * look colours up by lc_spot_colour, one light at a time.
 */
#ifndef LC_SPOT_H
#define LC_SPOT_H

#include "base/vec.h"

/* Of a light. Anything below -1 shines everywhere. */
typedef struct lc_spot {
    float cos_total,
        cos_start; /* -2..1, rising: emission is 0 at and below the first, 1 from the second on */
    uint32_t map;               /* 1 + index; 0: none */
} lc_spot;

/* As kernels read it: of a light, or what is no less than any member's: the least cosines. */
typedef struct lc_spot_rec {
    float cos_total, inv_width; /* 1 / (cos_start - cos_total), at most LC_SPOT_MAX_INV */
    float cos_start;
    uint32_t map;
} lc_spot_rec;

#define LC_SPOT_MAX_INV 1e30f /* a step: with this any cosine above cos_total by 1e-30 is within */

typedef struct lc_spot_map {
    float to_light[3][3];   /* rows; of any common length */
    float scale[2];         /* projected: x / z times this, from the middle, in texels */
    uint32_t width, height; /* octahedron: of knots, the outermost on the edge */
    bool projected;
    float *texels;          /* width * height * 3, 0..1 */
} lc_spot_map;

static inline void lc_spot_rec_init(lc_spot_rec *rec, float cos_total, float cos_start, uint32_t map)
{
    double width = (double)cos_start - (double)cos_total;
    *rec = (lc_spot_rec){ cos_total,
                          width * (double)LC_SPOT_MAX_INV > 1 ? (float)(1 / width) : LC_SPOT_MAX_INV,
                          cos_start, map };
}

static inline float lc_spot_emission(const lc_spot_rec *spot, float cos_phi)
{
    float t = ((cos_phi < 1 ? cos_phi : 1) - spot->cos_total) * spot->inv_width;
    t = t > 0 ? t : 0;
    t = t < 1 ? t : 1;
    return t * t * (3 - (t + t));
}

/* Column x of a row of three colours a texel, and x + 1 by f. */
static inline float lc_spot_mix(const float *texel, float f) { return (1 - f) * texel[0] + f * texel[3]; }

/* Octahedron: c channels between four knots. */
static inline void lc_spot_knots(const lc_spot_map *m, float x, float y, float rgb[3])
{
    uint32_t ix = (uint32_t)x, iy = (uint32_t)y;
    if (ix > m->width - 2) ix = m->width - 2;
    if (iy > m->height - 2) iy = m->height - 2;
    float fx = x - (float)ix, fy = y - (float)iy;
    const float *a = m->texels + ((size_t)iy * m->width + ix) * 3, *b = a + (size_t)m->width * 3;
    for (int c = 0; c < 3; c++) {
        float v = (1 - fy) * lc_spot_mix(a + c, fx) + fy * lc_spot_mix(b + c, fx);
        rgb[c] = v < 1 ? v : 1;
    }
}

/* Colour of a map in the direction `to` from the light, of any length; world space. */
static inline void lc_spot_colour(const lc_spot_map *m, const float to[3], float rgb[3])
{
    float w[3];
    for (int k = 0; k < 3; k++)
        w[k] = m->to_light[k][0] * to[0] + m->to_light[k][1] * to[1] + m->to_light[k][2] * to[2];
    rgb[0] = rgb[1] = rgb[2] = 0;
    if (m->projected) {
        float x = w[0] / w[2] * m->scale[0] + 0.5f * (float)m->width,
              y = w[1] / w[2] * m->scale[1] + 0.5f * (float)m->height;
        if (!(w[2] > 0 && x >= 0 && x < (float)m->width && y >= 0 && y < (float)m->height)) return;
        const float *texel = m->texels + ((size_t)(uint32_t)y * m->width + (uint32_t)x) * 3;
        rgb[0] = texel[0];
        rgb[1] = texel[1];
        rgb[2] = texel[2];
        return;
    }
    float sum = fabsf(w[0]) + fabsf(w[1]) + fabsf(w[2]);
    if (!(sum > 0)) return;
    float x = w[0] / sum, y = w[1] / sum;
    if (w[2] < 0) {
        float fold = 1 - fabsf(y);
        y = copysignf(1 - fabsf(x), y);
        x = copysignf(fold, x);
    }
    x = (0.5f * x + 0.5f) * (float)(m->width - 1);
    y = (0.5f * y + 0.5f) * (float)(m->height - 1);
    lc_spot_knots(m, x > 0 ? x : 0, y > 0 ? y : 0, rgb);
}

#endif
