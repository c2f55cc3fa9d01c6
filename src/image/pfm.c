/* pfm.c - PFM files: "PF" (RGB) or "Pf" (grey), width, height, scale and one white space; then floats by rows
 * from the bottom, little endian if the scale is negative. The magnitude of the scale is ignored, as in
 * pbrt. */
#include "image/pixels.h"

#include "base/decimal.h"

#include <math.h>
#include <string.h>

bool lc_pfm_is(const uint8_t *head, size_t len)
{
    return len >= 3 && head[0] == 'P' && (head[1] == 'F' || head[1] == 'f') &&
           (head[2] == ' ' || head[2] == '\n' || head[2] == '\r' || head[2] == '\t');
}

static bool is_space(uint8_t c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

/* Reads the next word as a number and moves *at behind it. False if it is no number or the file ends with
 * it. */
static bool next_number(const uint8_t *data, size_t len, size_t *at, double *out)
{
    char word[64] = "";
    size_t n = 0;
    while (*at < len && is_space(data[*at])) ++*at;
    while (*at < len && !is_space(data[*at]) && n + 1 < sizeof word) word[n++] = (char)data[(*at)++];
    return n && *at < len && lc_decimal_parse(word, n, out);
}

static float get_float(const uint8_t *p, bool little)
{
    uint32_t bits = little ? p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24
                           : p[3] | (uint32_t)p[2] << 8 | (uint32_t)p[1] << 16 | (uint32_t)p[0] << 24;
    float v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

lc_status lc_pfm_decode(lc_context *ctx, const char *path, const lc_bytes *file, lc_raster *out)
{
    const uint8_t *data = file->data;
    size_t at = 2;
    double v[3];
    *out = (lc_raster){ 0 };
    for (int i = 0; i < 3; i++) {
        size_t start = at;
        if (!next_number(data, file->len, &at, &v[i]))
            return lc_raster_damaged(ctx, path, "PFM", start, "no number");
        bool ok = i == 2 ? v[2] < 0 || v[2] > 0 : v[i] >= 1 && v[i] <= INT32_MAX && floor(v[i]) >= v[i];
        if (!ok) return lc_raster_damaged(ctx, path, "PFM", start, i == 2 ? "scale 0" : "size out of range");
    }
    if (!is_space(data[at])) return lc_raster_damaged(ctx, path, "PFM", at, "no white space after the scale");
    at++;
    lc_raster size = { (uint32_t)v[0], (uint32_t)v[1], data[1] == 'F' ? 3 : 1, LC_RASTER_F32, NULL };
    lc_status st = lc_raster_init(ctx, path, &size, file->len, 1, out);
    if (st) return st;
    size_t row = (size_t)size.width * size.n_channels, n = row * size.height;
    if ((file->len - at) / 4 < n) {
        lc_raster_free(ctx, out);
        return lc_raster_damaged(ctx, path, "PFM", file->len, "pixels are missing");
    }
    for (size_t y = 0; y < size.height; y++) {
        float *to = (float *)out->data + (size.height - 1 - y) * row;
        for (size_t i = 0; i < row; i++, at += 4) to[i] = get_float(data + at, v[2] < 0);
    }
    return LC_OK;
}
