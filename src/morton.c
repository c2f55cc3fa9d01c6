/* morton.c - codes of 63 bits and a radix sort, least digit first. A pass counts the digits of every chunk, then moves chunks to
 * where they go: stable, so neither chunks nor threads matter. Passes in which all digits are equal are left out. */
#include "morton.h"

#include "pool.h"

#include <string.h>

#define DIGIT_BITS 11
#define DIGITS (1u << DIGIT_BITS)
#define CHUNK 32768

typedef struct {
    const lc_context *ctx;
    void (*cell)(const void *user, uint32_t i, uint32_t c[3]);
    const void *user;
    uint32_t n, n_chunks, shift;
    uint64_t *code[2];
    uint32_t *index[2];
    uint32_t (*count)[DIGITS]; /* of each chunk; then where its first of a digit goes */
} sorter;

/* 21 bits to every third of 63. */
static uint64_t spread(uint64_t x)
{
    x = (x | x << 32) & 0x001f00000000ffff;
    x = (x | x << 16) & 0x001f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    return (x | x << 2) & 0x1249249249249249;
}

static uint32_t chunk_end(const sorter *s, uint64_t chunk)
{
    uint64_t end = (chunk + 1) * CHUNK;
    return end < s->n ? (uint32_t)end : s->n;
}

static void make_codes(void *user, uint32_t thread, uint64_t chunk)
{
    const sorter *s = user;
    (void)thread;
    for (uint32_t i = (uint32_t)chunk * CHUNK; i < chunk_end(s, chunk); i++) {
        uint32_t c[3];
        s->cell(s->user, i, c);
        s->code[0][i] = spread(c[0]) << 2 | spread(c[1]) << 1 | spread(c[2]);
        s->index[0][i] = i;
    }
}

static void count_digits(void *user, uint32_t thread, uint64_t chunk)
{
    const sorter *s = user;
    uint32_t *count = s->count[chunk];
    (void)thread;
    memset(count, 0, sizeof *s->count);
    for (uint32_t i = (uint32_t)chunk * CHUNK; i < chunk_end(s, chunk); i++) count[s->code[0][i] >> s->shift & (DIGITS - 1)]++;
}

static void move(void *user, uint32_t thread, uint64_t chunk)
{
    const sorter *s = user;
    uint32_t *to = s->count[chunk];
    (void)thread;
    for (uint32_t i = (uint32_t)chunk * CHUNK; i < chunk_end(s, chunk); i++) {
        uint32_t at = to[s->code[0][i] >> s->shift & (DIGITS - 1)]++;
        s->code[1][at] = s->code[0][i];
        s->index[1][at] = s->index[0][i];
    }
}

/* Counts to positions; false when one digit has all. */
static bool place_digits(const sorter *s)
{
    uint32_t at = 0;
    for (uint32_t d = 0; d < DIGITS; d++) {
        uint32_t before = at;
        for (uint32_t c = 0; c < s->n_chunks; c++) {
            uint32_t n = s->count[c][d];
            s->count[c][d] = at;
            at += n;
        }
        if (at - before == s->n) return false;
    }
    return true;
}

static void swap_buffers(sorter *s)
{
    uint64_t *code = s->code[0];
    uint32_t *index = s->index[0];
    s->code[0] = s->code[1], s->index[0] = s->index[1];
    s->code[1] = code, s->index[1] = index;
}

static void sort(sorter *s)
{
    lc_parallel(s->ctx, s->n_chunks, make_codes, s);
    for (s->shift = 0; s->shift < 63; s->shift += DIGIT_BITS) {
        lc_parallel(s->ctx, s->n_chunks, count_digits, s);
        if (!place_digits(s)) continue;
        lc_parallel(s->ctx, s->n_chunks, move, s);
        swap_buffers(s);
    }
}

lc_status lc_morton_order(const lc_context *ctx, uint32_t n, void (*cell)(const void *user, uint32_t i, uint32_t c[3]),
                          const void *user, uint32_t *order)
{
    sorter s = { .ctx = ctx, .cell = cell, .user = user, .n = n, .n_chunks = (n + CHUNK - 1) / CHUNK };
    for (int k = 0; k < 2; k++) s.code[k] = lc_alloc_raw(ctx, n, sizeof *s.code[k]);
    s.index[0] = order;
    s.index[1] = lc_alloc_raw(ctx, n, sizeof *order);
    s.count = lc_alloc_raw(ctx, s.n_chunks, sizeof *s.count);
    bool ok = s.code[0] && s.code[1] && s.index[1] && s.count;
    if (ok) sort(&s);
    if (ok && s.index[0] != order) {
        memcpy(order, s.index[0], n * sizeof *order);
        swap_buffers(&s);
    }
    for (int k = 0; k < 2; k++) lc_free(ctx, s.code[k], n, sizeof *s.code[k]);
    lc_free(ctx, s.index[1], n, sizeof *order);
    lc_free(ctx, s.count, s.n_chunks, sizeof *s.count);
    return ok ? LC_OK : LC_ERR_MEMORY;
}
