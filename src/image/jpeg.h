/* jpeg.h - what the parts of the JPEG decoder share: the frame with its coefficients, tables and the bits of
 * a scan.
 *
 *     jpeg.c: markers, tables, frame -> jpeg_scan.c: entropy-coded bits -> coefficients of all blocks
 *             -> jpeg_pixels.c: inverse DCT, chroma to full size, colours -> raster
 *
 * [T.81] is ITU-T T.81, the JPEG standard. All arithmetic is of integers.
 */
#ifndef LC_JPEG_H
#define LC_JPEG_H

#include "image/pixels.h"

#define LC_JPEG_BLOCK 64 /* coefficients of a block */

/* A Huffman table in the canonical form of [T.81, F.2.2.3]. */
typedef struct lc_jpeg_huffman {
    bool defined;
    uint8_t values[256];
    uint8_t fast_len[256], fast_value[256]; /* by the next 8 bits; length 0: the code is longer, or none */
    int32_t max_code[17];                   /* by length: the largest code; -1: none */
    int32_t first[17];                      /* by length: index of the first value minus its code */
} lc_jpeg_huffman;

typedef struct lc_jpeg_part {
    uint8_t id, h, v, table;       /* sampling factors, quantization table */
    uint16_t quant[LC_JPEG_BLOCK]; /* that table when its first scan began, by rows */
    uint32_t width, height;        /* samples */
    uint32_t cols, rows;           /* blocks that have samples */
    uint32_t wide, high;           /* blocks stored: whole minimum coded units */
    int16_t *coefs;                /* wide * high * 64, each block by rows */
    uint8_t *samples;              /* wide * 8 by high * 8 */
    int8_t bit[LC_JPEG_BLOCK]; /* the lowest bit known of each coefficient, in zigzag order; -1: nothing */
    const lc_jpeg_huffman *dc, *ac; /* of the scan */
    int32_t predicted;              /* DC of the block before */
} lc_jpeg_part;

typedef struct lc_jpeg {
    lc_context *ctx;
    const char *path;
    const uint8_t *data;
    size_t len, at;
    uint32_t width, height, n_parts;
    uint8_t h_max, v_max;
    bool progressive, jfif, adobe;
    uint8_t adobe_transform;
    uint32_t restart, n_scans; /* restart: units between restart markers; 0: none */
    bool has_quant[4];
    uint16_t quant[4][LC_JPEG_BLOCK]; /* by rows */
    lc_jpeg_huffman dc[4], ac[4];
    lc_jpeg_part parts[3];
    /* the scan being read */
    lc_jpeg_part *in_scan[3];
    uint32_t n_in_scan;
    uint8_t from, to, high_bit, low_bit; /* [T.81, B.2.3]: Ss, Se, Ah, Al */
    uint64_t bits;                       /* the lowest n_bits are the next ones */
    uint32_t n_bits, n_missing;          /* of them, zeros that stand for what is missing of the data */
    uint32_t end_run;                    /* blocks that still end with the band [T.81, G.1.2.2] */
} lc_jpeg;

extern const uint8_t lc_jpeg_zigzag[LC_JPEG_BLOCK]; /* place by rows of a coefficient of the zigzag order */

lc_status lc_jpeg_damaged(const lc_jpeg *j, const char *what);
/* Reads the entropy-coded data of a scan whose header was read and checked. LC_ERR_PARSE. */
lc_status lc_jpeg_scan(lc_jpeg *j);
/* The pixels of all coefficients. LC_ERR_MEMORY. */
lc_status lc_jpeg_pixels(lc_jpeg *j, lc_raster *out);
/* Of one block: dequantizes, transforms and writes 8 rows of 8 samples that are `stride` bytes apart. */
void lc_jpeg_inverse_dct(const int16_t *coefs, const uint16_t *quant, uint8_t *out, size_t stride);

#endif
