/* morton.c - sorts points by Morton codes of 63 bits, level by level.
 *
 *     run of points -> cube around it -> codes -> stable sort -> runs of equal codes: the next level's
 *
 * A run of at most CHUNK points is merge sorted by one thread. A longer one is radix sorted by all threads,
 * least digit first: each pass counts the digits in every chunk, then moves every chunk's points to their
 * final positions, so the result depends neither on chunks nor on threads.
 *
 * A run's cube has at most 2^-21 the side of the one before, and no float is below 2^-149, so levels are few.
 */
#include "base/morton.h"

#include "base/pool.h"

#include <string.h>

#define DIGIT_BITS 11
#define DIGITS (1u << DIGIT_BITS)
#define CHUNK 32768  /* points that a thread takes at a time; longer runs are sorted by all threads */
#define CELLS 0x1p21 /* of a cube along each axis */

typedef struct {
    uint32_t first, n;
} run;

typedef struct {
    const lc_context *ctx;
    lc_f3 (*place)(const void *user, uint32_t i);
    const void *user;
    uint64_t *code[2];
    uint32_t *index[2]; /* NULL: codes alone are sorted */
    run *runs, *next;          /* of this level, of the next level */
    size_t n_runs, n_next, cap_runs, cap_next;
    /* For the long run that is being sorted: */
    run part;
    lc_box box;
    lc_box *boxes;             /* of its chunks */
    uint32_t shift, from;      /* the current digit; which of code[] and index[] holds the points */
    uint32_t (*count)[DIGITS]; /* per chunk: the number of each digit, then the position of the next */
} sorter;

/* Moves the 21 low bits to every third of 63 bits. */
static uint64_t spread(uint64_t x)
{
    x = (x | x << 32) & 0x001f00000000ffff;
    x = (x | x << 16) & 0x001f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    return (x | x << 2) & 0x1249249249249249;
}

static lc_box box_of(const sorter *s, run r)
{
    lc_box box = lc_box_empty();
    for (uint32_t i = r.first; i < r.first + r.n; i++) lc_box_add(&box, s->place(s->user, s->index[0][i]));
    return box;
}

static double side_of(const lc_box *b)
{
    double x = (double)b->hi.x - (double)b->lo.x, y = (double)b->hi.y - (double)b->lo.y,
           z = (double)b->hi.z - (double)b->lo.z;
    return fmax(x, fmax(y, z));
}

static uint64_t cell(double x, double lo, double scale)
{
    double at = (x - lo) * scale;
    return at < CELLS - 1 ? (uint64_t)at : (uint64_t)CELLS - 1;
}

static uint64_t code_of(const lc_box *box, double scale, lc_f3 p)
{
    return spread(cell((double)p.x, (double)box->lo.x, scale)) << 2 |
           spread(cell((double)p.y, (double)box->lo.y, scale)) << 1 |
           spread(cell((double)p.z, (double)box->lo.z, scale));
}

/* Computes the codes of a run. The box must have a side > 0. */
static void make_codes(const sorter *s, run r, const lc_box *box)
{
    const double scale = CELLS / side_of(box);
    for (uint32_t i = r.first; i < r.first + r.n; i++)
        s->code[0][i] = code_of(box, scale, s->place(s->user, s->index[0][i]));
}

/* ---- a run for one thread ---- */

static void merge(const sorter *s, uint32_t from, uint32_t first, uint32_t mid, uint32_t end)
{
    const uint64_t *code = s->code[from];
    uint32_t i = first, j = mid;
    for (uint32_t to = first; to < end; to++) {
        uint32_t k = j == end || (i < mid && code[i] <= code[j]) ? i++ : j++;
        s->code[!from][to] = code[k];
        s->index[!from][to] = s->index[from][k];
    }
}

static void copy_back(const sorter *s, run r)
{
    memcpy(s->code[0] + r.first, s->code[1] + r.first, r.n * sizeof **s->code);
    memcpy(s->index[0] + r.first, s->index[1] + r.first, r.n * sizeof **s->index);
}

static void sort_run(void *user, uint32_t thread, uint64_t item)
{
    sorter *s = user;
    run *r = &s->runs[item];
    uint32_t from = 0, end = r->first + r->n;
    (void)thread;
    if (r->n > CHUNK) return;
    lc_box box = box_of(s, *r);
    if (!(side_of(&box) > 0)) {
        r->n = 0; /* all points are the same */
        return;
    }
    make_codes(s, *r, &box);
    for (uint32_t width = 1; width < r->n; width *= 2, from = !from)
        for (uint32_t i = r->first; i < end; i += 2 * width) {
            uint32_t left = end - i;
            merge(s, from, i, left > width ? i + width : end, left > 2 * width ? i + 2 * width : end);
        }
    if (from) copy_back(s, *r);
}

/* ---- a run for all threads ---- */

static run chunk_of(const sorter *s, uint64_t chunk)
{
    uint32_t at = (uint32_t)chunk * CHUNK, left = s->part.n - at;
    return (run){ s->part.first + at, left < CHUNK ? left : CHUNK };
}

static void measure_chunk(void *user, uint32_t thread, uint64_t chunk)
{
    const sorter *s = user;
    (void)thread;
    s->boxes[chunk] = box_of(s, chunk_of(s, chunk));
}

static void code_chunk(void *user, uint32_t thread, uint64_t chunk)
{
    const sorter *s = user;
    (void)thread;
    make_codes(s, chunk_of(s, chunk), &s->box);
}

static void count_digits(void *user, uint32_t thread, uint64_t chunk)
{
    const sorter *s = user;
    const run r = chunk_of(s, chunk);
    uint32_t *count = s->count[chunk];
    (void)thread;
    memset(count, 0, sizeof *s->count);
    for (uint32_t i = r.first; i < r.first + r.n; i++)
        count[s->code[s->from][i] >> s->shift & (DIGITS - 1)]++;
}

static void move_chunk(void *user, uint32_t thread, uint64_t chunk)
{
    const sorter *s = user;
    const run r = chunk_of(s, chunk);
    uint32_t *to = s->count[chunk], from = s->from;
    (void)thread;
    for (uint32_t i = r.first; i < r.first + r.n; i++) {
        uint32_t at = to[s->code[from][i] >> s->shift & (DIGITS - 1)]++;
        s->code[!from][at] = s->code[from][i];
        if (s->index[0]) s->index[!from][at] = s->index[from][i];
    }
}

/* Turns counts into positions; false if all points have the same digit. */
static bool place_digits(const sorter *s, uint32_t n_chunks)
{
    uint32_t at = s->part.first;
    for (uint32_t d = 0; d < DIGITS; d++) {
        uint32_t before = at;
        for (uint32_t c = 0; c < n_chunks; c++) {
            uint32_t n = s->count[c][d];
            s->count[c][d] = at;
            at += n;
        }
        if (at - before == s->part.n) return false;
    }
    return true;
}

/* Sorts the points of part by all digits of their codes from bit `shift` on, into the arrays `from`. */
static void sort_digits(sorter *s, uint32_t n_chunks, uint32_t shift)
{
    for (s->from = 0, s->shift = shift; s->shift < 64; s->shift += DIGIT_BITS) {
        lc_parallel_if(n_chunks > 3, s->ctx, n_chunks, count_digits, s);
        if (!place_digits(s, n_chunks)) continue;
        lc_parallel_if(n_chunks > 3, s->ctx, n_chunks, move_chunk, s);
        s->from = !s->from;
    }
}

static void sort_long_run(sorter *s, run *r)
{
    const uint32_t n_chunks = (r->n + CHUNK - 1) / CHUNK;
    s->part = *r;
    s->box = lc_box_empty();
    lc_parallel(s->ctx, n_chunks, measure_chunk, s);
    for (uint32_t c = 0; c < n_chunks; c++) lc_box_join(&s->box, &s->boxes[c]);
    if (!(side_of(&s->box) > 0)) {
        r->n = 0;
        return;
    }
    lc_parallel(s->ctx, n_chunks, code_chunk, s);
    sort_digits(s, n_chunks, 0);
    if (s->from) copy_back(s, s->part);
}

/* ---- levels ---- */

/* Appends the runs of equal codes in a sorted run to the next level. */
static lc_status find_equal(sorter *s, run r)
{
    const uint64_t *code = s->code[0];
    for (uint32_t i = r.first, end = r.first + r.n, last; i < end; i = last) {
        for (last = i + 1; last < end && code[last] == code[i]; last++) {}
        if (last - i <= LC_MORTON_FEW) continue;
        lc_status st = lc_grow(s->ctx, (void **)&s->next, &s->cap_next, s->n_next + 1, sizeof *s->next);
        if (st) return st;
        s->next[s->n_next++] = (run){ i, last - i };
    }
    return LC_OK;
}

/* Sorts the runs of a level and makes those of the next the current ones. */
static lc_status sort_level(sorter *s)
{
    lc_status st = LC_OK;
    lc_parallel(s->ctx, s->n_runs, sort_run, s);
    for (size_t i = 0; i < s->n_runs; i++)
        if (s->runs[i].n > CHUNK) sort_long_run(s, &s->runs[i]);
    s->n_next = 0;
    for (size_t i = 0; i < s->n_runs && !st; i++) st = find_equal(s, s->runs[i]);
    run *runs = s->runs;
    size_t cap = s->cap_runs;
    s->runs = s->next;
    s->cap_runs = s->cap_next;
    s->n_runs = s->n_next;
    s->next = runs;
    s->cap_next = cap;
    return st;
}

lc_status lc_morton_order(const lc_context *ctx, uint32_t n, lc_f3 (*place)(const void *user, uint32_t i),
                          const void *user, uint32_t *order)
{
    const uint32_t n_chunks = n / CHUNK + 1;
    sorter s = { .ctx = ctx, .place = place, .user = user, .index = { order } };
    for (int k = 0; k < 2; k++) s.code[k] = lc_alloc_raw(ctx, n, sizeof *s.code[k]);
    s.index[1] = lc_alloc_raw(ctx, n, sizeof *order);
    s.count = lc_alloc_raw(ctx, n_chunks, sizeof *s.count);
    s.boxes = lc_alloc_raw(ctx, n_chunks, sizeof *s.boxes);
    lc_status st = s.code[0] && s.code[1] && s.index[1] && s.count && s.boxes ? LC_OK : LC_ERR_MEMORY;
    if (!st) st = lc_grow(ctx, (void **)&s.runs, &s.cap_runs, 1, sizeof *s.runs);
    if (!st) {
        for (uint32_t i = 0; i < n; i++) order[i] = i;
        s.runs[s.n_runs++] = (run){ 0, n };
    }
    while (!st && s.n_runs) st = sort_level(&s);
    for (int k = 0; k < 2; k++) lc_free(ctx, s.code[k], n, sizeof *s.code[k]);
    lc_free(ctx, s.index[1], n, sizeof *order);
    lc_free(ctx, s.count, n_chunks, sizeof *s.count);
    lc_free(ctx, s.boxes, n_chunks, sizeof *s.boxes);
    lc_free(ctx, s.runs, s.cap_runs, sizeof *s.runs);
    lc_free(ctx, s.next, s.cap_next, sizeof *s.next);
    return st;
}

uint64_t *lc_morton_sort_keys(const lc_context *ctx, uint32_t n, uint64_t *key, uint64_t *spare)
{
    const uint32_t n_chunks = (n + CHUNK - 1) / CHUNK;
    sorter s = { .ctx = ctx, .code = { key, spare }, .part = { 0, n } };
    s.count = lc_alloc_raw(ctx, n_chunks, sizeof *s.count);
    if (!s.count) return NULL;
    sort_digits(&s, n_chunks, 32);
    lc_free(ctx, s.count, n_chunks, sizeof *s.count);
    return s.code[s.from];
}
