/* jpeg_pixels.c - from coefficients to pixels: the inverse DCT, chroma at full size, YCbCr to RGB. */
#include "image/jpeg.h"

#include "base/arena.h"

/* ---- inverse DCT ---- */

#define BITS   13 /* of the constants' fractions */
#define PASS   2  /* bits of fraction between the passes */
#define FIX(v) ((int64_t)((v) * (1 << BITS) + 0.5))

/* Eight values `step` apart, times sqrt 8 2^BITS, by the factorization of [Loeffler89], figure 1, read
 * backwards, with 12 multiplications; then shifted right by `shift`, rounded. */
static void transform(const int64_t *in, int64_t *out, size_t step, int shift)
{
    int64_t z = (in[2 * step] + in[6 * step]) * FIX(0.541196100);
    int64_t e2 = z - in[6 * step] * FIX(1.847759065), e3 = z + in[2 * step] * FIX(0.765366865);
    int64_t e0 = (in[0] + in[4 * step]) * (1 << BITS), e1 = (in[0] - in[4 * step]) * (1 << BITS);
    const int64_t even[4] = { e0 + e3, e1 + e2, e1 - e2, e0 - e3 };

    int64_t t0 = in[7 * step], t1 = in[5 * step], t2 = in[3 * step], t3 = in[step];
    int64_t z5 = (t0 + t2 + t1 + t3) * FIX(1.175875602);
    int64_t z1 = -(t0 + t3) * FIX(0.899976223), z2 = -(t1 + t2) * FIX(2.562915447);
    int64_t z3 = z5 - (t0 + t2) * FIX(1.961570560), z4 = z5 - (t1 + t3) * FIX(0.390180644);
    const int64_t odd[4] = { t3 * FIX(1.501321110) + z1 + z4, t2 * FIX(3.072711026) + z2 + z3,
                             t1 * FIX(2.053119869) + z2 + z4, t0 * FIX(0.298631336) + z1 + z3 };

    int64_t half = (int64_t)1 << (shift - 1);
    for (size_t i = 0; i < 4; i++) {
        out[i * step] = (even[i] + odd[i] + half) >> shift;
        out[(7 - i) * step] = (even[i] - odd[i] + half) >> shift;
    }
}

static uint8_t to_byte(int64_t v) { return (uint8_t)(v < 0 ? 0 : v > 255 ? 255 : v); }

void lc_jpeg_inverse_dct(const int16_t *coefs, const uint16_t *quant, uint8_t *out, size_t stride)
{
    int64_t v[LC_JPEG_BLOCK];
    for (size_t i = 0; i < LC_JPEG_BLOCK; i++) v[i] = (int64_t)coefs[i] * quant[i];
    for (size_t x = 0; x < 8; x++) transform(v + x, v + x, 8, BITS - PASS);
    for (size_t y = 0; y < 8; y++) {
        int64_t *row = v + y * 8;
        transform(row, row, 1, BITS + PASS + 3);
        for (size_t x = 0; x < 8; x++) out[y * stride + x] = to_byte(row[x] + 128);
    }
}

/* ---- full size ---- */

/* Where sample x of full size lies among samples `factor` times as far apart, whose centres are those of
 * their pixels: between *a and *b, with the weight *w / (2 factor) of *b. */
static void between(uint32_t x, uint32_t factor, uint32_t n, uint32_t *a, uint32_t *b, uint32_t *w)
{
    uint32_t at = 2 * x + 1 + factor; /* of the distance between samples / (2 factor), plus that distance */
    uint32_t i = at / (2 * factor);   /* 1 + the sample before */
    *w = at % (2 * factor);
    *a = i ? i - 1 : 0;
    *b = i < n ? i : n - 1;
    if (*a >= n) *a = n - 1;
}

/* One row of a component at full size, bilinear. */
static void full_row(const lc_jpeg *j, const lc_jpeg_part *p, uint32_t y, uint8_t *out)
{
    uint32_t fx = j->h_max / p->h, fy = j->v_max / p->v, a, b, w;
    between(y, fy, p->height, &a, &b, &w);
    const uint8_t *up = p->samples + (size_t)a * p->wide * 8, *down = p->samples + (size_t)b * p->wide * 8;
    uint32_t whole = 4 * fx * fy;
    for (uint32_t x = 0; x < j->width; x++) {
        uint32_t l, r, u;
        between(x, fx, p->width, &l, &r, &u);
        uint32_t left = up[l] * (2 * fy - w) + down[l] * w, right = up[r] * (2 * fy - w) + down[r] * w;
        out[x] = (uint8_t)((left * (2 * fx - u) + right * u + whole / 2) / whole);
    }
}

/* ---- colours ---- */

#define FIX16(v) ((int32_t)((v)*65536 + 0.5))

/* [JFIF 1.02]: YCbCr of ITU-R BT.601 with all 256 levels. */
static void to_rgb(uint8_t *pixel)
{
    int32_t y = pixel[0], cb = pixel[1] - 128, cr = pixel[2] - 128;
    pixel[0] = to_byte(y + ((FIX16(1.40200) * cr + 32768) >> 16));
    pixel[1] = to_byte(y + ((-FIX16(0.34414) * cb - FIX16(0.71414) * cr + 32768) >> 16));
    pixel[2] = to_byte(y + ((FIX16(1.77200) * cb + 32768) >> 16));
}

/* Whether three components are RGB: Adobe's marker says so, or nothing but their names does. */
static bool is_rgb(const lc_jpeg *j)
{
    if (j->adobe) return j->adobe_transform == 0;
    return !j->jfif && j->parts[0].id == 'R' && j->parts[1].id == 'G' && j->parts[2].id == 'B';
}

lc_status lc_jpeg_pixels(lc_jpeg *j, lc_raster *out)
{
    uint8_t *row = lc_alloc(j->ctx, j->width, 1), *data = out->data;
    size_t n = j->n_parts;
    if (!row) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < n; i++) {
        const lc_jpeg_part *p = &j->parts[i];
        size_t stride = (size_t)p->wide * 8;
        for (size_t y = 0; y < p->high; y++)
            for (size_t x = 0; x < p->wide; x++)
                lc_jpeg_inverse_dct(p->coefs + (y * p->wide + x) * LC_JPEG_BLOCK, p->quant,
                                    p->samples + y * 8 * stride + x * 8, stride);
    }
    bool rgb = n == 1 || is_rgb(j);
    for (uint32_t y = 0; y < j->height; y++) {
        uint8_t *to = data + (size_t)y * j->width * n;
        for (uint32_t i = 0; i < n; i++) {
            full_row(j, &j->parts[i], y, row);
            for (size_t x = 0; x < j->width; x++) to[x * n + i] = row[x];
        }
        for (size_t x = 0; x < j->width && !rgb; x++) to_rgb(to + x * n);
    }
    lc_free(j->ctx, row, j->width, 1);
    return LC_OK;
}
