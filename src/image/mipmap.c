/* mipmap.c - builds the levels, encoding their means again for 8-bit images, and filters lookups. */
#include "image/mipmap.h"

#include "base/arena.h"
#include "base/fmath.h"
#include "image/srgb.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- building ---- */

static double decode(lc_encoding e, double v)
{
    if (e.kind == LC_ENCODING_SRGB) return lc_srgb_to_linear(v);
    return e.kind == LC_ENCODING_LINEAR ? v : (double)lc_pow01((float)v, e.gamma);
}

/* Finds the code whose linear value is nearest to a given one. */
#define GUESSES 1024
typedef struct encoder {
    double above[255];          /* values above above[c] have a larger code than c */
    uint8_t guess[GUESSES + 1]; /* code of i / GUESSES, where the search starts */
} encoder;

static uint8_t encode(const encoder *e, double v)
{
    uint32_t code = e->guess[(uint32_t)(fmin(fmax(v, 0), 1) * GUESSES)];
    while (code < 255 && v > e->above[code]) code++;
    return (uint8_t)code;
}

static void make_encoder(const float *table, encoder *e)
{
    uint32_t code = 0;
    for (int i = 0; i < 255; i++) e->above[i] = 0.5 * ((double)table[i] + (double)table[i + 1]);
    for (int i = 0; i <= GUESSES; i++) {
        while (code < 255 && (double)i / GUESSES > e->above[code]) code++;
        e->guess[i] = (uint8_t)code;
    }
}

static double get(const lc_mipmap *m, size_t sample)
{
    return m->is_codes ? (double)m->table[((const uint8_t *)m->texels)[sample]]
                       : (double)((const float *)m->texels)[sample];
}

static void lay_out(lc_mipmap *m, uint32_t width, uint32_t height)
{
    for (;;) {
        m->levels[m->n_levels++] = (lc_mip_level){ width, height, m->n_texels };
        m->n_texels += (size_t)width * height;
        if (width == 1 && height == 1) return;
        width = (width + 1) / 2;
        height = (height + 1) / 2;
    }
}

/* Fills level 0 from the raster: with codes as they are, or with linear floats. */
static lc_status fill_first(const lc_context *ctx, const lc_raster *r, lc_encoding encoding, lc_mipmap *m)
{
    size_t n = (size_t)r->width * r->height, n_codes = r->kind == LC_RASTER_U16 ? 65536 : 0;
    float *linear = lc_alloc(ctx, n_codes, sizeof *linear);
    if (!linear) return LC_ERR_MEMORY;
    for (size_t i = 0; i < n_codes; i++) linear[i] = (float)decode(encoding, (double)i / 65535);
    for (size_t i = 0; i < n; i++)
        for (uint32_t c = 0; c < m->n_channels; c++) {
            size_t from = i * r->n_channels + c, to = i * m->n_channels + c;
            if (r->kind == LC_RASTER_U8) {
                ((uint8_t *)m->texels)[to] = ((const uint8_t *)r->data)[from];
                continue;
            }
            float v = n_codes ? linear[((const uint16_t *)r->data)[from]] : ((const float *)r->data)[from];
            ((float *)m->texels)[to] = isfinite(v) ? v : 0;
        }
    lc_free(ctx, linear, n_codes, sizeof *linear);
    return LC_OK;
}

/* What a texel of the next level covers along one axis: up to three texels, with the weight of each. */
typedef struct span {
    uint32_t first, n;
    double share[3];
} span;

static span span_of(uint32_t i, uint32_t n, uint32_t n_next)
{
    double width = (double)n / n_next, lo = i * width, hi = (i + 1) * width;
    span s = { (uint32_t)lo, 0, { 0, 0, 0 } };
    for (uint32_t k = s.first; k < n && s.n < 3; k++) {
        double from = lo > k ? lo : k, to = hi < k + 1.0 ? hi : k + 1.0;
        if (!(to > from)) break;
        s.share[s.n++] = (to - from) / width;
    }
    return s;
}

/* Fills a level with means of the one before. columns: scratch of to->width. */
static void shrink(lc_mipmap *m, const lc_mip_level *from, const lc_mip_level *to, const encoder *e,
                   span *columns)
{
    for (uint32_t x = 0; x < to->width; x++) columns[x] = span_of(x, from->width, to->width);
    for (uint32_t y = 0; y < to->height; y++) {
        span sy = span_of(y, from->height, to->height);
        for (uint32_t x = 0; x < to->width; x++) {
            const span *sx = &columns[x];
            size_t at = (to->first + (size_t)y * to->width + x) * m->n_channels;
            for (uint32_t c = 0; c < m->n_channels; c++) {
                double sum = 0;
                for (uint32_t j = 0; j < sy.n; j++)
                    for (uint32_t i = 0; i < sx->n; i++) {
                        size_t texel = from->first + (size_t)(sy.first + j) * from->width + sx->first + i;
                        sum += sy.share[j] * sx->share[i] * get(m, texel * m->n_channels + c);
                    }
                if (m->is_codes) ((uint8_t *)m->texels)[at + c] = encode(e, sum);
                else ((float *)m->texels)[at + c] = (float)fmin(fmax(sum, -(double)FLT_MAX), (double)FLT_MAX);
            }
        }
    }
}

lc_status lc_mipmap_build(const lc_context *ctx, const lc_raster *r, lc_encoding encoding, lc_mipmap *m)
{
    *m = (lc_mipmap){ .n_channels = r->n_channels < 3 ? 1 : 3, .is_codes = r->kind == LC_RASTER_U8 };
    for (int i = 0; i < 256; i++) m->table[i] = (float)decode(encoding, i / 255.0);
    lay_out(m, r->width, r->height);
    m->texels = lc_alloc_raw(ctx, m->n_texels,
                             m->n_channels * (m->is_codes ? sizeof(uint8_t) : sizeof(float)));
    size_t n_columns = ((size_t)r->width + 1) / 2;
    span *columns = lc_alloc(ctx, n_columns, sizeof *columns);
    lc_status st = m->texels && columns ? fill_first(ctx, r, encoding, m) : LC_ERR_MEMORY;
    encoder e;
    make_encoder(m->table, &e);
    for (uint32_t k = 0; k + 1 < m->n_levels && !st; k++)
        shrink(m, &m->levels[k], &m->levels[k + 1], &e, columns);
    lc_free(ctx, columns, n_columns, sizeof *columns);
    if (st) lc_mipmap_free(ctx, m);
    return st;
}

lc_status lc_mipmap_copy(const lc_context *ctx, const lc_mipmap *m, lc_mipmap *out)
{
    const size_t size = m->n_channels * (m->is_codes ? sizeof(uint8_t) : sizeof(float));
    *out = *m;
    out->texels = lc_alloc_raw(ctx, m->n_texels, size);
    if (!out->texels) return LC_ERR_MEMORY;
    memcpy(out->texels, m->texels, m->n_texels * size);
    return LC_OK;
}

void lc_mipmap_free(const lc_context *ctx, lc_mipmap *m)
{
    lc_free(ctx, m->texels, m->n_texels, m->n_channels * (m->is_codes ? sizeof(uint8_t) : sizeof(float)));
    *m = (lc_mipmap){ 0 };
}

size_t lc_mipmap_bytes(const lc_mipmap *m)
{
    return m->n_texels * m->n_channels * (m->is_codes ? sizeof(uint8_t) : sizeof(float));
}

/* ---- lookups ---- */

/* Adds share times the texel (x, y), which may be outside of the image. */
static void add_texel(const lc_mipmap *m, const lc_mip_level *l, int64_t x, int64_t y, lc_wrap wrap,
                      double share, double out[3])
{
    int64_t w = l->width, h = l->height;
    if (wrap == LC_WRAP_REPEAT) {
        x = x < 0 ? x + w : x >= w ? x - w : x;
        y = y < 0 ? y + h : y >= h ? y - h : y;
    } else if (x < 0 || x >= w || y < 0 || y >= h) {
        if (wrap == LC_WRAP_BLACK) return;
        x = x < 0 ? 0 : x >= w ? w - 1 : x;
        y = y < 0 ? 0 : y >= h ? h - 1 : y;
    }
    size_t at = (l->first + (size_t)(y * w + x)) * m->n_channels;
    for (size_t c = 0; c < 3; c++) out[c] += share * get(m, m->n_channels == 3 ? at + c : at);
}

/* Reduces a coordinate to 0..1 if the image repeats, else to a range in which texel indices stay small. */
static double bring_near(double v, lc_wrap wrap)
{
    return wrap == LC_WRAP_REPEAT ? v - floor(v) : fmin(fmax(v, -1), 2);
}

/* Adds share times the value of one level, by point or bilinear filtering. */
static void look(const lc_mipmap *m, uint32_t level, double s, double t, lc_wrap wrap, bool point,
                 double share, double out[3])
{
    const lc_mip_level *l = &m->levels[level];
    double x = s * l->width, y = t * l->height;
    if (point) {
        add_texel(m, l, (int64_t)floor(x), (int64_t)floor(y), wrap, share, out);
        return;
    }
    double x0 = floor(x - 0.5), y0 = floor(y - 0.5), fx = x - 0.5 - x0, fy = y - 0.5 - y0;
    add_texel(m, l, (int64_t)x0, (int64_t)y0, wrap, share * (1 - fx) * (1 - fy), out);
    add_texel(m, l, (int64_t)x0 + 1, (int64_t)y0, wrap, share * fx * (1 - fy), out);
    add_texel(m, l, (int64_t)x0, (int64_t)y0 + 1, wrap, share * (1 - fx) * fy, out);
    add_texel(m, l, (int64_t)x0 + 1, (int64_t)y0 + 1, wrap, share * fx * fy, out);
}

void lc_mipmap_lookup(const lc_mipmap *m, double s, double t, double width, lc_wrap wrap, lc_filter filter,
                      double out[3])
{
    double level = width > 1 ? fmin(lc_ln(fmin(width, 0x1p40)) * LC_INV_LN2, m->n_levels - 1.0) : 0;
    uint32_t whole = (uint32_t)level;
    double part = filter == LC_FILTER_TRILINEAR ? level - whole : 0;
    s = bring_near(s, wrap);
    t = bring_near(t, wrap);
    out[0] = out[1] = out[2] = 0;
    look(m, whole, s, t, wrap, filter == LC_FILTER_POINT, 1 - part, out);
    if (part > 0) look(m, whole + 1, s, t, wrap, false, part, out);
}

void lc_mipmap_texel(const lc_mipmap *m, uint32_t x, uint32_t y, double out[3])
{
    size_t at = ((size_t)y * m->levels[0].width + x) * m->n_channels;
    for (size_t c = 0; c < 3; c++) out[c] = get(m, m->n_channels == 3 ? at + c : at);
}

void lc_mipmap_mean(const lc_mipmap *m, double out[3])
{
    out[0] = out[1] = out[2] = 0;
    add_texel(m, &m->levels[m->n_levels - 1], 0, 0, LC_WRAP_CLAMP, 1, out);
}
