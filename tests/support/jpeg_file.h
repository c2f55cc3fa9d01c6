/* jpeg_file.h - writes JPEG files from the coefficients of their blocks, sequential or progressive, by ITU-T
 * T.81. Shares nothing with the library. */
#ifndef JPEG_FILE_H
#define JPEG_FILE_H

#include "support/jpeg_bits.h"

#define JPEG_MAX_BLOCKS 64

typedef struct jpeg_plan {
    int width, height, n_parts;        /* 1 or 3 components */
    int h[3], v[3];                    /* sampling factors */
    bool progressive, jfif, rgb;       /* rgb: Adobe's marker says so */
    int restart;                       /* units; 0: none */
    int quant[64];                     /* by rows */
    int coefs[3][JPEG_MAX_BLOCKS][64]; /* by blocks of whole units, each by rows; not yet dequantized */
} jpeg_plan;

static inline int jpeg_max(const int *v, int n)
{
    int most = 1;
    for (int i = 0; i < n; i++) most = v[i] > most ? v[i] : most;
    return most;
}

/* Blocks stored of a component along x. */
static inline int jpeg_wide(const jpeg_plan *p, int part)
{
    int most = jpeg_max(p->h, p->n_parts);
    return (p->width + 8 * most - 1) / (8 * most) * p->h[part];
}

static inline int jpeg_high(const jpeg_plan *p, int part)
{
    int most = jpeg_max(p->v, p->n_parts);
    return (p->height + 8 * most - 1) / (8 * most) * p->v[part];
}

/* Samples of a component along x, and along y. */
static inline int jpeg_part_width(const jpeg_plan *p, int part)
{
    int most = jpeg_max(p->h, p->n_parts);
    return (p->width * p->h[part] + most - 1) / most;
}

static inline int jpeg_part_height(const jpeg_plan *p, int part)
{
    int most = jpeg_max(p->v, p->n_parts);
    return (p->height * p->v[part] + most - 1) / most;
}

/* A scan of one component, or with part -1 of all; high: 0 or the bit known before. */
static inline void jpeg_scan(jpeg_file *f, const jpeg_plan *p, int part, int from, int to, int high, int low)
{
    int n = part < 0 ? p->n_parts : 1, first = part < 0 ? 0 : part, units = 0;
    jpeg_word(f, 0xffda);
    jpeg_word(f, 6 + 2 * n);
    jpeg_byte(f, n);
    for (int i = 0; i < n; i++) jpeg_byte(f, 'R' + first + i), jpeg_byte(f, 0);
    jpeg_byte(f, from), jpeg_byte(f, to), jpeg_byte(f, high << 4 | low);
    bool alone = n == 1;
    int wide = alone ? (jpeg_part_width(p, first) + 7) / 8 : jpeg_wide(p, 0) / p->h[0];
    int high_units = alone ? (jpeg_part_height(p, first) + 7) / 8 : jpeg_high(p, 0) / p->v[0];
    for (int y = 0; y < high_units; y++)
        for (int x = 0; x < wide; x++, units++) {
            if (p->restart && units && units % p->restart == 0) {
                jpeg_align(f);
                jpeg_word(f, 0xffd0 + (units / p->restart - 1) % 8);
            }
            for (int i = first; i < first + n; i++)
                for (int k = 0; k < (alone ? 1 : p->h[i] * p->v[i]); k++) {
                    int h = alone ? 1 : p->h[i], v = alone ? 1 : p->v[i];
                    const int *b = p->coefs[i][(y * v + k / h) * jpeg_wide(p, i) + x * h + k % h];
                    if (from == 0 && !high) jpeg_dc(f, i, b, low);
                    else if (from == 0) jpeg_put(f, (uint32_t)(b[0] >> low) & 1, 1);
                    if (to && !high) jpeg_ac(f, b, from ? from : 1, to, low, p->progressive);
                    else if (to) jpeg_refine(f, b, from, to, low);
                }
        }
    jpeg_align(f);
}

static inline void jpeg_head(jpeg_file *f, const jpeg_plan *p)
{
    jpeg_word(f, 0xffd8);
    if (p->jfif) {
        jpeg_word(f, 0xffe0), jpeg_word(f, 16);
        for (int i = 0; i < 14; i++) jpeg_byte(f, "JFIF\0\1\1\0\0\1\0\1\0\0"[i]);
    }
    if (p->rgb) {
        jpeg_word(f, 0xffee), jpeg_word(f, 14);
        for (int i = 0; i < 12; i++) jpeg_byte(f, "Adobe\0\144\0\0\0\0\0"[i]);
    }
    jpeg_word(f, 0xffdb), jpeg_word(f, 67), jpeg_byte(f, 0);
    for (int i = 0; i < 64; i++) jpeg_byte(f, p->quant[jpeg_order[i]]);
    jpeg_word(f, p->progressive ? 0xffc2 : 0xffc0), jpeg_word(f, 8 + 3 * p->n_parts), jpeg_byte(f, 8);
    jpeg_word(f, p->height), jpeg_word(f, p->width), jpeg_byte(f, p->n_parts);
    for (int i = 0; i < p->n_parts; i++)
        jpeg_byte(f, 'R' + i), jpeg_byte(f, p->h[i] << 4 | p->v[i]), jpeg_byte(f, 0);
    jpeg_word(f, 0xffc4), jpeg_word(f, 2 + 17 + 15 + 17 + 256);
    jpeg_byte(f, 0x00);
    for (int i = 1; i <= 16; i++) jpeg_byte(f, i == 4 ? 15 : 0);
    for (int i = 0; i < 15; i++) jpeg_byte(f, i);
    jpeg_byte(f, 0x10);
    for (int i = 1; i <= 16; i++) jpeg_byte(f, i == 2 || i == 3 ? 1 : i == 10 ? 254 : 0);
    for (int i = 0; i < 256; i++) jpeg_byte(f, i);
    if (p->restart) jpeg_word(f, 0xffdd), jpeg_word(f, 4), jpeg_word(f, p->restart);
}

static inline void jpeg_write(jpeg_file *f, const jpeg_plan *p)
{
    memset(f, 0, sizeof *f);
    jpeg_head(f, p);
    if (!p->progressive) jpeg_scan(f, p, -1, 0, 63, 0, 0);
    for (int part = -1; p->progressive && part < p->n_parts; part++)
        if (part < 0) {
            jpeg_scan(f, p, part, 0, 0, 0, 1);
        } else {
            jpeg_scan(f, p, part, 1, 5, 0, 2);
            jpeg_scan(f, p, part, 6, 63, 0, 2);
            jpeg_scan(f, p, part, 1, 63, 2, 1);
        }
    if (p->progressive) jpeg_scan(f, p, -1, 0, 0, 1, 0);
    for (int part = 0; p->progressive && part < p->n_parts; part++) jpeg_scan(f, p, part, 1, 63, 1, 0);
    jpeg_word(f, 0xffd9);
}

#endif
