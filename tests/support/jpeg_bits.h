/* jpeg_bits.h - the entropy-coded data of JPEG files for tests: bits, and the coefficients of blocks in
 * sequential and progressive scans, by ITU-T T.81. Shares nothing with the library. */
#ifndef JPEG_BITS_H
#define JPEG_BITS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef struct jpeg_file {
    uint8_t data[1 << 16];
    size_t n;
    uint32_t bits, n_bits;
    int predicted[3];
    int run, n_later; /* blocks that ended, and correction bits that follow their number */
    uint8_t later[4096];
} jpeg_file;

static const uint8_t jpeg_order[64] = { 0,  1,  8,  16, 9,  2,  3,  10, 17, 24, 32, 25, 18, 11, 4,  5,
                                        12, 19, 26, 33, 40, 48, 41, 34, 27, 20, 13, 6,  7,  14, 21, 28,
                                        35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23, 30, 37, 44, 51,
                                        58, 59, 52, 45, 38, 31, 39, 46, 53, 60, 61, 54, 47, 55, 62, 63 };

static inline void jpeg_byte(jpeg_file *f, int v)
{
    if (f->n < sizeof f->data) f->data[f->n++] = (uint8_t)v;
    else abort();
}

static inline void jpeg_word(jpeg_file *f, int v) { jpeg_byte(f, v >> 8), jpeg_byte(f, v & 255); }

static inline void jpeg_put(jpeg_file *f, uint32_t value, int n)
{
    for (int i = n - 1; i >= 0; i--) {
        f->bits = f->bits << 1 | (value >> i & 1);
        if (++f->n_bits < 8) continue;
        jpeg_byte(f, (int)(f->bits & 255));
        if ((f->bits & 255) == 255) jpeg_byte(f, 0);
        f->n_bits = 0;
    }
}

/* The codes: DC all 4 bits; AC the symbol 0 two, 1 three, all others ten bits. */
static inline void jpeg_symbol(jpeg_file *f, bool dc, int symbol)
{
    if (dc) jpeg_put(f, (uint32_t)symbol, 4);
    else if (symbol < 2) jpeg_put(f, symbol ? 2 : 0, symbol ? 3 : 2);
    else jpeg_put(f, 384 + (uint32_t)symbol - 2, 10);
}

static inline int jpeg_size(int v)
{
    int n = 0;
    for (v = abs(v); v; v >>= 1) n++;
    return n;
}

static inline void jpeg_value(jpeg_file *f, int v, int size)
{
    jpeg_put(f, (uint32_t)(v < 0 ? v + (1 << size) - 1 : v), size);
}

static inline void jpeg_end_run(jpeg_file *f)
{
    if (!f->run) return;
    int n = jpeg_size(f->run) - 1;
    jpeg_symbol(f, false, n << 4);
    jpeg_put(f, (uint32_t)(f->run - (1 << n)), n);
    for (int i = 0; i < f->n_later; i++) jpeg_put(f, f->later[i], 1);
    f->run = f->n_later = 0;
}

static inline void jpeg_dc(jpeg_file *f, int part, const int *block, int low)
{
    int v = block[0] >= 0 ? block[0] >> low : -((-block[0] + (1 << low) - 1) >> low);
    int size = jpeg_size(v - f->predicted[part]);
    jpeg_symbol(f, true, size);
    jpeg_value(f, v - f->predicted[part], size);
    f->predicted[part] = v;
}

static inline void jpeg_ac(jpeg_file *f, const int *block, int from, int to, int low, bool runs)
{
    int zeros = 0;
    for (int k = from; k <= to; k++) {
        int c = block[jpeg_order[k]], v = c < 0 ? -(-c >> low) : c >> low, size = jpeg_size(v);
        if (!v) {
            zeros++;
            continue;
        }
        jpeg_end_run(f);
        for (; zeros > 15; zeros -= 16) jpeg_symbol(f, false, 0xf0);
        jpeg_symbol(f, false, zeros << 4 | size);
        jpeg_value(f, v, size);
        zeros = 0;
    }
    if (!zeros) return;
    f->run++;
    if (!runs) jpeg_end_run(f);
}

static inline void jpeg_refine(jpeg_file *f, const int *block, int from, int to, int low)
{
    int last = 0, zeros = 0, n = 0;
    uint8_t bits[64];
    for (int k = from; k <= to; k++)
        if (abs(block[jpeg_order[k]]) >> low == 1) last = k;
    for (int k = from; k <= to; k++) {
        int c = block[jpeg_order[k]], v = abs(c) >> low;
        if (!v) {
            zeros++;
            continue;
        }
        while (zeros > 15 && k <= last) {
            jpeg_end_run(f);
            jpeg_symbol(f, false, 0xf0);
            for (int i = 0; i < n; i++) jpeg_put(f, bits[i], 1);
            n = 0;
            zeros -= 16;
        }
        if (v > 1) {
            bits[n++] = v & 1;
            continue;
        }
        jpeg_end_run(f);
        jpeg_symbol(f, false, zeros << 4 | 1);
        jpeg_put(f, c > 0, 1);
        for (int i = 0; i < n; i++) jpeg_put(f, bits[i], 1);
        n = zeros = 0;
    }
    if (!zeros && !n) return;
    f->run++;
    memcpy(f->later + f->n_later, bits, (size_t)n);
    f->n_later += n;
    if (f->n_later > 3000) jpeg_end_run(f);
}

static inline void jpeg_align(jpeg_file *f)
{
    jpeg_end_run(f);
    while (f->n_bits) jpeg_put(f, 1, 1);
    memset(f->predicted, 0, sizeof f->predicted);
}

#endif
