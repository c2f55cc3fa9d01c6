/* ploc.c - parallel locally-ordered clustering ([Meister18]) with the metric of light trees.
 *
 * The lights are put in the order of a space-filling curve. In a round every cluster looks for its nearest neighbour among those
 * close by in the list; two that are each other's nearest become one, which takes the place of the first. Rounds go on until
 * one is left.
 *
 *     radius   how far a cluster looks. It grows as the list gets shorter, such that no round costs less than SEARCH_LEAST pairs.
 *     ties     pairs are totally ordered (ploc_tmpl.c), so the least of any stretch is always joined.
 *     rounds   after one that joined fewer than a SLOW-th of a list of more than SHORT, clusters look for one round within groups
 *              of eight positions only, each of which then joins two. So n lights take at most SLOW ln(n / SHORT) + SHORT rounds,
 *              and the tree is no deeper.
 *
 * Memory while at it: 116 bytes a light (two lists of 13 floats and an id, an offset), without emission directions 68; before
 * that 28 for the order.
 */
#include "tree_build.h"

#include "kernels.h"
#include "morton.h"
#include "pool.h"

#include <string.h>

#define RADIUS 16
#define SEARCH_LEAST (1u << 20)
#define SLOW 32
#define SHORT 128
#define CHUNK 4096           /* positions moved at a time */
#define SERIAL_SEARCH 200000 /* pairs that are measured in the time it takes to start a thread */
#define SERIAL_MOVE 20000    /* clusters moved */

typedef struct {
    uint32_t kept, joined;
} tally;

typedef struct {
    lc_box box;
    double power;
} extent;

typedef struct {
    const lc_context *ctx;
    const lc_build_input *in;
    const lc_kernels *kernels;
    lc_ploc_list list, next;
    uint32_t *id, *next_id;
    float *offset;
    tally *tallies;           /* of each chunk; then how many come before it */
    extent *extents;          /* of each chunk of lights */
    uint32_t *order;
    lc_build_pair *pairs;
    uint32_t n_pairs;
    double origin[3], cells;  /* cells of the curve a unit */
    double scale, power_scale;
    float c2;                 /* scaled */
    uint32_t radius, search_item;
    bool grouped;
} builder;

static uint32_t n_chunks(uint32_t n, uint32_t size) { return n / size + (n % size != 0); }

static uint32_t chunk_size(uint32_t n, uint64_t chunk) { return n - (uint32_t)chunk * CHUNK < CHUNK ? n - (uint32_t)chunk * CHUNK : CHUNK; }

static void run(builder *b, uint64_t n_items, bool serial, void (*fn)(void *user, uint32_t thread, uint64_t item))
{
    if (!serial) lc_parallel(b->ctx, n_items, fn, b);
    for (uint64_t i = 0; i < n_items && serial; i++) fn(b, 0, i);
}

/* ---- lights in order ---- */

static const lc_light *light_of(const builder *b, uint32_t i) { return &b->in->lights[b->in->index ? b->in->index[i] : i]; }

static lc_f3 place_of(const lc_light *l) { return l->kind == LC_LIGHT_DIRECTIONAL ? lc_f3_neg(l->dir) : l->pos; }

static double power_of(const lc_light *l) { return ((double)l->intensity.x + (double)l->intensity.y + (double)l->intensity.z) / 3; }

static void measure_chunk(void *user, uint32_t thread, uint64_t chunk)
{
    builder *b = user;
    extent e = { lc_box_empty(), 0 };
    uint32_t first = (uint32_t)chunk * CHUNK;
    (void)thread;
    for (uint32_t i = first; i < first + chunk_size(b->in->n, chunk); i++) {
        const lc_light *l = light_of(b, i);
        double power = power_of(l);
        lc_box_add(&e.box, place_of(l));
        if (power > e.power) e.power = power;
    }
    b->extents[chunk] = e;
}

/* 2^-k such that x times it is in 1/2 .. 1; 1 for 0. */
static double inverse_size(double x)
{
    int k = 0;
    frexp(x, &k);
    return ldexp(1, -k);
}

static void set_scales(builder *b)
{
    extent e = b->extents[0];
    for (uint32_t c = 1; c < n_chunks(b->in->n, CHUNK); c++) {
        lc_box_join(&e.box, &b->extents[c].box);
        if (b->extents[c].power > e.power) e.power = b->extents[c].power;
    }
    const float lo[3] = { e.box.lo.x, e.box.lo.y, e.box.lo.z }, hi[3] = { e.box.hi.x, e.box.hi.y, e.box.hi.z };
    double size = 0, turn = b->in->kind == LC_LIGHT_ORIENTED ? sqrt(b->in->c2) : 0;
    for (int k = 0; k < 3; k++) {
        b->origin[k] = (double)lo[k];
        if ((double)hi[k] - (double)lo[k] > size) size = (double)hi[k] - (double)lo[k];
    }
    b->cells = size > 0 ? 0x1p21 / size : 0;
    b->scale = inverse_size(size > turn ? size : turn);
    b->power_scale = 0x1p100 * inverse_size(e.power * b->in->n);
    b->c2 = (float)(turn * b->scale * (turn * b->scale));
}

static void cell_of(const void *user, uint32_t i, uint32_t c[3])
{
    const builder *b = user;
    lc_f3 p = place_of(light_of(b, i));
    const float x[3] = { p.x, p.y, p.z };
    for (int k = 0; k < 3; k++) {
        double at = ((double)x[k] - b->origin[k]) * b->cells;
        c[k] = at < 0x1p21 - 1 ? (uint32_t)at : (1u << 21) - 1;
    }
}

static void load_chunk(void *user, uint32_t thread, uint64_t chunk)
{
    builder *b = user;
    float *const *row = b->list.row;
    uint32_t first = (uint32_t)chunk * CHUNK;
    (void)thread;
    for (uint32_t i = first; i < first + chunk_size(b->in->n, chunk); i++) {
        const lc_light *l = light_of(b, b->order[i]);
        lc_f3 at = place_of(l);
        const float x[3] = { at.x, at.y, at.z }, d[3] = { l->dir.x, l->dir.y, l->dir.z };
        for (int k = 0; k < 3; k++) {
            row[LC_PLOC_LO + k][i] = row[LC_PLOC_HI + k][i] = (float)(((double)x[k] - b->origin[k]) * b->scale);
            if (b->list.oriented) row[LC_PLOC_DLO + k][i] = row[LC_PLOC_DHI + k][i] = d[k];
        }
        row[LC_PLOC_POWER][i] = (float)(power_of(l) * b->power_scale);
        b->id[i] = b->order[i];
    }
}

/* ---- a round ---- */

static void search_some(void *user, uint32_t thread, uint64_t item)
{
    builder *b = user;
    uint32_t first = (uint32_t)item * b->search_item, n = b->list.n - first;
    (void)thread;
    b->kernels->nearest(&b->list, first, n < b->search_item ? n : b->search_item, b->radius, b->grouped, b->offset + first);
}

/* Offset to the other of a pair that is each other's nearest, else 0. */
static int32_t partner(const builder *b, uint32_t i)
{
    int32_t to = (int32_t)b->offset[i];
    return to && b->offset[i + (uint32_t)to] == -b->offset[i] ? to : 0;
}

static void count_chunk(void *user, uint32_t thread, uint64_t chunk)
{
    builder *b = user;
    tally t = { 0, 0 };
    uint32_t first = (uint32_t)chunk * CHUNK;
    (void)thread;
    for (uint32_t i = first; i < first + chunk_size(b->list.n, chunk); i++) {
        int32_t to = partner(b, i);
        t.kept += to >= 0;
        t.joined += to > 0;
    }
    b->tallies[chunk] = t;
}

/* Sums before each chunk; returns those of all. */
static tally sum_tallies(builder *b)
{
    tally sum = { 0, 0 };
    for (uint32_t c = 0; c < n_chunks(b->list.n, CHUNK); c++) {
        tally t = b->tallies[c];
        b->tallies[c] = sum;
        sum.kept += t.kept, sum.joined += t.joined;
    }
    return sum;
}

/* to[i] of the clusters that left[i] and right[i], which may be the same, become. */
static void move_rows(const builder *b, const uint32_t *left, const uint32_t *right, uint32_t n, uint32_t to)
{
    for (int k = 0; k < (b->list.oriented ? LC_PLOC_ROWS : LC_PLOC_DLO); k++) {
        const float *from = b->list.row[k];
        float *out = b->next.row[k] + to;
        bool high = (k >= LC_PLOC_HI && k < LC_PLOC_POWER) || k >= LC_PLOC_DHI;
        if (k == LC_PLOC_POWER)
            for (uint32_t i = 0; i < n; i++) out[i] = left[i] == right[i] ? from[left[i]] : from[left[i]] + from[right[i]];
        else if (high)
            for (uint32_t i = 0; i < n; i++) out[i] = from[left[i]] > from[right[i]] ? from[left[i]] : from[right[i]];
        else
            for (uint32_t i = 0; i < n; i++) out[i] = from[left[i]] < from[right[i]] ? from[left[i]] : from[right[i]];
    }
}

static void join_chunk(void *user, uint32_t thread, uint64_t chunk)
{
    builder *b = user;
    uint32_t left[CHUNK], right[CHUNK], first = (uint32_t)chunk * CHUNK, n = 0;
    uint32_t to = b->tallies[chunk].kept, pair = b->n_pairs + b->tallies[chunk].joined;
    (void)thread;
    for (uint32_t i = first; i < first + chunk_size(b->list.n, chunk); i++) {
        int32_t with = partner(b, i);
        if (with < 0) continue;
        uint32_t other = i + (uint32_t)with, x = b->id[i], y = b->id[other];
        b->next_id[to + n] = with ? b->in->n + pair : x;
        if (with) b->pairs[pair++] = (lc_build_pair){ { x < y ? x : y, x < y ? y : x } };
        left[n] = i, right[n] = other;
        n++;
    }
    move_rows(b, left, right, n, to);
}

static void swap_lists(builder *b, uint32_t n)
{
    lc_ploc_list list = b->list;
    uint32_t *id = b->id;
    b->list = b->next, b->id = b->next_id;
    b->next = list, b->next_id = id;
    b->list.n = n;
}

static void join_all(builder *b)
{
    while (b->list.n > 1) {
        const uint32_t n = b->list.n, chunks = n_chunks(n, CHUNK);
        b->radius = SEARCH_LEAST / n > RADIUS ? SEARCH_LEAST / n : RADIUS;
        b->search_item = n / (8 * b->ctx->n_threads) / LC_PLOC_CHUNK * LC_PLOC_CHUNK;
        if (b->search_item < LC_PLOC_CHUNK) b->search_item = LC_PLOC_CHUNK;
        if (b->search_item > CHUNK) b->search_item = CHUNK;
        run(b, n_chunks(n, b->search_item), (uint64_t)n * (b->radius < n ? b->radius : n) < SERIAL_SEARCH, search_some);
        run(b, chunks, n < SERIAL_MOVE, count_chunk);
        tally t = sum_tallies(b);
        run(b, chunks, n < SERIAL_MOVE, join_chunk);
        b->n_pairs += t.joined;
        b->grouped = n > SHORT && (uint64_t)t.joined * SLOW < n;
        swap_lists(b, t.kept);
    }
}

/* ---- memory ---- */

static bool alloc_list(builder *b, lc_ploc_list *l, uint32_t **id)
{
    bool ok = true;
    size_t n = (size_t)b->in->n + LC_LANES;
    *l = (lc_ploc_list){ .n = b->in->n, .oriented = b->in->kind == LC_LIGHT_ORIENTED, .c2 = b->c2 };
    for (int k = 0; k < (l->oriented ? LC_PLOC_ROWS : LC_PLOC_DLO); k++) {
        l->row[k] = lc_alloc_raw(b->ctx, n, sizeof **l->row);
        ok = ok && l->row[k];
        if (l->row[k]) memset(l->row[k] + b->in->n, 0, LC_LANES * sizeof **l->row);
    }
    *id = lc_alloc_raw(b->ctx, b->in->n, sizeof **id);
    return ok && *id;
}

static void free_list(builder *b, lc_ploc_list *l, uint32_t *id)
{
    for (int k = 0; k < LC_PLOC_ROWS; k++) lc_free(b->ctx, l->row[k], (size_t)b->in->n + LC_LANES, sizeof **l->row);
    lc_free(b->ctx, id, b->in->n, sizeof *id);
}

static lc_status load_lights(builder *b)
{
    const uint32_t n = b->in->n, chunks = n_chunks(n, CHUNK);
    lc_status st;
    b->order = lc_alloc_raw(b->ctx, n, sizeof *b->order);
    b->extents = lc_alloc_raw(b->ctx, chunks, sizeof *b->extents);
    st = b->order && b->extents ? LC_OK : LC_ERR_MEMORY;
    if (!st) {
        run(b, chunks, n < SERIAL_MOVE, measure_chunk);
        set_scales(b);
        st = lc_morton_order(b->ctx, n, cell_of, b, b->order);
    }
    if (!st) st = alloc_list(b, &b->list, &b->id) ? LC_OK : LC_ERR_MEMORY;
    if (!st) run(b, chunks, n < SERIAL_MOVE, load_chunk);
    lc_free(b->ctx, b->extents, chunks, sizeof *b->extents);
    lc_free(b->ctx, b->order, n, sizeof *b->order);
    return st;
}

lc_status lc_ploc(const lc_context *ctx, const lc_build_input *in, lc_build_pair *pairs)
{
    if (in->n < 2) return LC_OK;
    builder b = { .ctx = ctx, .in = in, .kernels = lc_kernels_get(ctx->isa), .pairs = pairs };
    const uint32_t chunks = n_chunks(in->n, CHUNK);
    lc_status st = load_lights(&b);
    if (!st) {
        bool ok = alloc_list(&b, &b.next, &b.next_id);
        b.offset = lc_alloc_raw(ctx, in->n, sizeof *b.offset);
        b.tallies = lc_alloc_raw(ctx, chunks, sizeof *b.tallies);
        st = ok && b.offset && b.tallies ? LC_OK : LC_ERR_MEMORY;
    }
    if (!st) join_all(&b);
    free_list(&b, &b.list, b.id);
    free_list(&b, &b.next, b.next_id);
    lc_free(ctx, b.offset, in->n, sizeof *b.offset);
    lc_free(ctx, b.tallies, chunks, sizeof *b.tallies);
    return st;
}
