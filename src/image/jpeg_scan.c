/* jpeg_scan.c - the entropy-coded data of JPEG scans: Huffman codes, blocks of sequential and of progressive
 * frames, restarts. */
#include "image/jpeg.h"

#include <string.h>

/* ---- bits ---- */

/* Makes at least 32 bits ready. Behind the data, which end at a marker, come zeros. */
static void fill(lc_jpeg *j)
{
    while (j->n_bits <= 56) {
        uint32_t byte = 0;
        bool there = j->at < j->len;
        if (there) {
            byte = j->data[j->at];
            if (byte == 0xff) there = j->at + 1 < j->len && j->data[j->at + 1] == 0;
        }
        if (there) j->at += byte == 0xff ? 2 : 1;
        else byte = 0, j->n_missing += 8;
        j->bits = j->bits << 8 | byte;
        j->n_bits += 8;
    }
}

static uint32_t look(const lc_jpeg *j, uint32_t n)
{
    return (uint32_t)(j->bits >> (j->n_bits - n)) & ((1u << n) - 1);
}

/* n: 0..16 */
static uint32_t take(lc_jpeg *j, uint32_t n)
{
    if (j->n_bits < n) fill(j);
    uint32_t v = look(j, n);
    j->n_bits -= n;
    return v;
}

/* Whether more bits were taken than there are. */
static bool beyond(const lc_jpeg *j) { return j->n_bits < j->n_missing; }

/* A number of `size` bits, 0..15, in the form of [T.81, F.1.2.1]. */
static int32_t take_signed(lc_jpeg *j, uint32_t size)
{
    if (!size) return 0;
    int32_t v = (int32_t)take(j, size);
    return v < 1 << (size - 1) ? v - (1 << size) + 1 : v;
}

/* The next symbol; -1: no such code. */
static int32_t take_symbol(lc_jpeg *j, const lc_jpeg_huffman *h)
{
    if (j->n_bits < 16) fill(j);
    uint32_t head = look(j, 8);
    if (h->fast_len[head]) {
        j->n_bits -= h->fast_len[head];
        return h->fast_value[head];
    }
    for (uint32_t n = 9; n <= 16; n++) {
        int32_t code = (int32_t)look(j, n);
        if (code > h->max_code[n]) continue;
        j->n_bits -= n;
        return h->values[(h->first[n] + code) & 255];
    }
    return -1;
}

static lc_status no_code(const lc_jpeg *j) { return lc_jpeg_damaged(j, "no such Huffman code"); }

/* ---- blocks ---- */

static lc_status read_dc(lc_jpeg *j, lc_jpeg_part *p, int16_t *block)
{
    int32_t size = take_symbol(j, p->dc);
    if (size < 0) return no_code(j);
    if (size > 15) return lc_jpeg_damaged(j, "a coefficient out of range");
    p->predicted += take_signed(j, (uint32_t)size);
    int32_t v = p->predicted * (1 << j->low_bit);
    if (p->predicted < INT16_MIN || p->predicted > INT16_MAX || v < INT16_MIN || v > INT16_MAX)
        return lc_jpeg_damaged(j, "a coefficient out of range");
    block[0] = (int16_t)v;
    return LC_OK;
}

/* The coefficients from `from` on, [T.81, F.2.2.2] and, with runs of blocks that end, [T.81, G.1.2.2]. */
static lc_status read_ac(lc_jpeg *j, const lc_jpeg_part *p, uint32_t from, int16_t *block)
{
    if (j->end_run) {
        j->end_run--;
        return LC_OK;
    }
    for (uint32_t k = from; k <= j->to; k++) {
        int32_t symbol = take_symbol(j, p->ac);
        if (symbol < 0) return no_code(j);
        uint32_t zeros = (uint32_t)symbol >> 4, size = symbol & 15;
        if (!size && zeros < 15) {
            if (zeros && !j->progressive) return no_code(j);
            j->end_run = (1u << zeros) - 1 + take(j, zeros);
            break;
        }
        k += zeros;
        if (k > j->to) return lc_jpeg_damaged(j, "too many coefficients in a block");
        int32_t v = take_signed(j, size) * (1 << j->low_bit);
        if (v < INT16_MIN || v > INT16_MAX) return lc_jpeg_damaged(j, "a coefficient out of range");
        block[lc_jpeg_zigzag[k]] = (int16_t)v;
    }
    return LC_OK;
}

/* One more bit of a coefficient that is not 0. */
static void refine(lc_jpeg *j, int16_t *v)
{
    int32_t bit = 1 << j->low_bit;
    if (!take(j, 1) || (*v & bit)) return;
    int32_t more = *v < 0 ? *v - bit : *v + bit;
    if (more >= INT16_MIN && more <= INT16_MAX) *v = (int16_t)more;
}

/* One more bit of the coefficients that are known, and those that become other than 0 by it [T.81, G.1.2.3].
 */
static lc_status refine_ac(lc_jpeg *j, const lc_jpeg_part *p, int16_t *block)
{
    uint32_t k = j->from;
    while (k <= j->to && !j->end_run) {
        int32_t symbol = take_symbol(j, p->ac), value = 0;
        if (symbol < 0) return no_code(j);
        uint32_t zeros = (uint32_t)symbol >> 4, size = symbol & 15;
        if (size > 1) return lc_jpeg_damaged(j, "a coefficient out of range");
        if (size) {
            value = take(j, 1) ? 1 << j->low_bit : -(1 << j->low_bit);
        } else if (zeros < 15) {
            j->end_run = (1u << zeros) + take(j, zeros);
            break;
        }
        for (; k <= j->to; k++) {
            int16_t *v = block + lc_jpeg_zigzag[k];
            if (*v) refine(j, v);
            else if (!zeros--) break;
        }
        if (value && k > j->to) return lc_jpeg_damaged(j, "too many coefficients in a block");
        if (value) block[lc_jpeg_zigzag[k]] = (int16_t)value;
        k++;
        if (beyond(j)) break;
    }
    if (!j->end_run) return LC_OK;
    for (; k <= j->to; k++)
        if (block[lc_jpeg_zigzag[k]]) refine(j, block + lc_jpeg_zigzag[k]);
    j->end_run--;
    return LC_OK;
}

static lc_status read_block(lc_jpeg *j, lc_jpeg_part *p, int16_t *block)
{
    lc_status st = LC_OK;
    if (j->from == 0) {
        if (!j->high_bit) st = read_dc(j, p, block);
        else if (take(j, 1)) block[0] = (int16_t)(block[0] | 1 << j->low_bit);
        if (!st && j->to > 0) st = read_ac(j, p, 1, block);
    } else {
        st = j->high_bit ? refine_ac(j, p, block) : read_ac(j, p, j->from, block);
    }
    if (!st && beyond(j)) st = lc_jpeg_damaged(j, "pixels are missing");
    return st;
}

/* ---- scans ---- */

static void forget(lc_jpeg *j)
{
    j->bits = 0;
    j->n_bits = j->n_missing = j->end_run = 0;
    for (uint32_t i = 0; i < j->n_parts; i++) j->parts[i].predicted = 0;
}

/* The marker RSTn; bytes before it that no code needed are skipped. */
static lc_status restart(lc_jpeg *j, uint32_t number)
{
    while (j->at + 1 < j->len &&
           (j->data[j->at] != 0xff || j->data[j->at + 1] == 0 || j->data[j->at + 1] == 0xff))
        j->at++;
    if (j->at + 1 >= j->len || j->data[j->at + 1] != 0xd0 + (number & 7))
        return lc_jpeg_damaged(j, "a restart marker is missing");
    j->at += 2;
    forget(j);
    return LC_OK;
}

/* The unit (x, y): a block of the only component, or as many of each as its sampling factors say. */
static lc_status read_unit(lc_jpeg *j, uint32_t x, uint32_t y)
{
    bool alone = j->n_in_scan == 1;
    lc_status st = LC_OK;
    for (uint32_t i = 0; i < j->n_in_scan; i++) {
        lc_jpeg_part *p = j->in_scan[i];
        uint32_t h = alone ? 1 : p->h, v = alone ? 1 : p->v;
        for (uint32_t k = 0; k < h * v && !st; k++) {
            size_t at = (size_t)(y * v + k / h) * p->wide + x * h + k % h;
            st = read_block(j, p, p->coefs + at * LC_JPEG_BLOCK);
        }
    }
    return st;
}

lc_status lc_jpeg_scan(lc_jpeg *j)
{
    const lc_jpeg_part *p = j->in_scan[0];
    bool alone = j->n_in_scan == 1;
    uint32_t wide = alone ? p->cols : p->wide / p->h, high = alone ? p->rows : p->high / p->v;
    uint64_t n = 0;
    lc_status st = LC_OK;
    forget(j);
    for (uint32_t y = 0; y < high && !st; y++)
        for (uint32_t x = 0; x < wide && !st; x++, n++) {
            if (j->restart && n && n % j->restart == 0) st = restart(j, (uint32_t)(n / j->restart - 1));
            if (!st) st = read_unit(j, x, y);
        }
    return st;
}
