/* ploc.c - parallel locally-ordered clustering ([Meister18]) with the metric of light trees.
 *
 * The lights are put in the order of a space-filling curve (morton.h). In a round every cluster searches for
 * its nearest neighbour among those close to it in the list; two that are each other's nearest become one,
 * which takes the place of the first. Rounds go on until one cluster remains.
 *
 *     radius   how many positions to either side a cluster searches. It grows as the list gets shorter, so
 *              that no round measures fewer than MIN_ROUND pairs.
 *     ties     pairs are totally ordered (ploc_tmpl.c), so the nearest pair of any part of the list is
 *              joined.
 *     rounds   after one that joined fewer than 1 / SLOW of a list of more than SHORT, clusters search for
 *              one round within groups of eight positions only, each of which then joins two. So n lights
 *              take at most SLOW ln(n / SHORT) + SHORT rounds, and the tree is no deeper.
 *
 * Memory: a list has 13 floats (7 without emission directions) and an id a cluster; that of the lights 7 (4),
 * as the boxes of single lights are points. The lists of the first two rounds are allocated when their
 * lengths are known. At most 116 bytes a light (68), where almost nothing is joined; usually 75 (45). Before
 * that 28 for the order.
 */
#include "tree/tree_build.h"

#include "base/morton.h"
#include "base/pool.h"
#include "tree/ploc_list.h"

#include <string.h>

#define RADIUS 16             /* least search radius */
#define MIN_ROUND (1u << 18)  /* least number of pairs that a round measures */
#define SLOW 32
#define SHORT 128
#define CHUNK 2048            /* positions moved at a time */
#define MAX_SEARCH_ITEM 4096  /* positions searched at a time */
#define ITEMS_A_THREAD 8      /* least number of searches that each thread gets, for balance */
#define SERIAL_SEARCH 400000  /* pairs measured in the time that starting a thread takes */
#define SERIAL_MOVE 20000     /* clusters moved in that time */

typedef struct {
    uint32_t kept, joined;
} tally;

typedef struct {
    lc_box box;
    double intensity;
} extent;

/* A list and its memory. */
typedef struct {
    lc_ploc_list view;
    uint32_t *id;      /* of clusters */
    float *block;
    size_t n_floats, n_ids;
} list;

typedef struct {
    const lc_context *ctx;
    const lc_build_input *in;
    const lc_tree_kernels *kernels;
    list now, next;
    float *offset;
    tally *tallies;           /* of each chunk; then of all chunks before it */
    extent *extents;          /* of each chunk of lights */
    uint32_t *order;
    lc_build_pair *pairs;
    uint32_t n_pairs, n_lists; /* lists made so far */
    double scale, intensity_scale;
    float c2;                 /* scaled */
    uint32_t radius, search_item;
    bool grouped;
} builder;

static uint32_t n_chunks(uint32_t n, uint32_t size) { return n / size + (n % size != 0); }

static uint32_t chunk_size(uint32_t n, uint64_t chunk)
{
    uint32_t rest = n - (uint32_t)chunk * CHUNK;
    return rest < CHUNK ? rest : CHUNK;
}

static void run(builder *b, uint64_t n_items, bool serial,
                void (*fn)(void *user, uint32_t thread, uint64_t item))
{
    if (!serial) lc_parallel(b->ctx, n_items, fn, b);
    for (uint64_t i = 0; i < n_items && serial; i++) fn(b, 0, i);
}

/* ---- lights in order ---- */

static const lc_light *light_of(const builder *b, uint32_t i)
{
    return &b->in->lights[b->in->index ? b->in->index[i] : i];
}

static lc_f3 place_of(const lc_light *l)
{
    return lc_is_far(l->kind) ? lc_f3_neg(l->dir) : l->pos;
}

static double intensity_of(const lc_light *l)
{
    return ((double)l->intensity.x + (double)l->intensity.y + (double)l->intensity.z) / 3;
}

static void measure_chunk(void *user, uint32_t thread, uint64_t chunk)
{
    builder *b = user;
    extent e = { lc_box_empty(), 0 };
    uint32_t first = (uint32_t)chunk * CHUNK;
    (void)thread;
    for (uint32_t i = first; i < first + chunk_size(b->in->n, chunk); i++) {
        const lc_light *l = light_of(b, i);
        double intensity = intensity_of(l);
        lc_box_add(&e.box, place_of(l));
        if (intensity > e.intensity) e.intensity = intensity;
    }
    b->extents[chunk] = e;
}

/* The 2^-k for which x 2^-k is in [1/2, 1); 1 for 0. */
static double inverse_size(double x)
{
    int k = 0;
    frexp(x, &k);
    return ldexp(1, -k);
}

/* Scales are powers of two, so that coordinates stay exact. No metric is above 2^100 (3 + 4): edges of boxes
 * and the weight of directions are at most 1, and sums of intensities at most 2^100. The least size, 2^-60 of
 * the coordinates, keeps them finite where all are equal. */
static void set_scales(builder *b)
{
    extent e = b->extents[0];
    for (uint32_t c = 1; c < n_chunks(b->in->n, CHUNK); c++) {
        lc_box_join(&e.box, &b->extents[c].box);
        if (b->extents[c].intensity > e.intensity) e.intensity = b->extents[c].intensity;
    }
    const float lo[3] = { e.box.lo.x, e.box.lo.y, e.box.lo.z },
                hi[3] = { e.box.hi.x, e.box.hi.y, e.box.hi.z };
    double turn = lc_is_aimed(b->in->kind) ? sqrt(b->in->c2) : 0, size = turn;
    for (int k = 0; k < 3; k++) {
        size = fmax(size, (double)hi[k] - (double)lo[k]);
        size = fmax(size, 0x1p-60 * fmax(fabs((double)lo[k]), fabs((double)hi[k])));
    }
    b->scale = inverse_size(size);
    b->intensity_scale = 0x1p100 * inverse_size(e.intensity * b->in->n);
    b->c2 = (float)(turn * b->scale * (turn * b->scale));
}

static lc_f3 place_in_order(const void *user, uint32_t i) { return place_of(light_of(user, i)); }

static void load_chunk(void *user, uint32_t thread, uint64_t chunk)
{
    builder *b = user;
    float *const *row = b->now.view.row;
    uint32_t first = (uint32_t)chunk * CHUNK;
    (void)thread;
    for (uint32_t i = first; i < first + chunk_size(b->in->n, chunk); i++) {
        const lc_light *l = light_of(b, b->order[i]);
        lc_f3 at = place_of(l);
        const float x[3] = { at.x, at.y, at.z }, d[3] = { l->dir.x, l->dir.y, l->dir.z };
        for (int k = 0; k < 3; k++) {
            row[LC_PLOC_LO + k][i] = row[LC_PLOC_HI + k][i] = (float)((double)x[k] * b->scale);
            if (b->now.view.oriented) row[LC_PLOC_DLO + k][i] = row[LC_PLOC_DHI + k][i] = d[k];
        }
        row[LC_PLOC_INTENSITY][i] = (float)(intensity_of(l) * b->intensity_scale);
        b->now.id[i] = b->order[i];
    }
}

/* ---- a round ---- */

static void search_some(void *user, uint32_t thread, uint64_t item)
{
    builder *b = user;
    uint32_t first = (uint32_t)item * b->search_item, n = b->now.view.n - first;
    (void)thread;
    b->kernels->nearest(&b->now.view, first, n < b->search_item ? n : b->search_item, b->radius, b->grouped,
                        b->offset + first);
}

/* Whether cluster i is the nearest of its nearest. */
static bool is_mutual(const builder *b, uint32_t i)
{
    return b->offset[i + (uint32_t)(int32_t)b->offset[i]] == -b->offset[i];
}

static void count_chunk(void *user, uint32_t thread, uint64_t chunk)
{
    builder *b = user;
    uint32_t first = (uint32_t)chunk * CHUNK, n = chunk_size(b->now.view.n, chunk), before = 0, behind = 0;
    (void)thread;
    for (uint32_t i = first; i < first + n; i++) {
        bool mutual = is_mutual(b, i);
        before += mutual & (b->offset[i] < 0);
        behind += mutual & (b->offset[i] > 0);
    }
    b->tallies[chunk] = (tally){ n - before, behind };
}

/* Replaces each tally by the sum of those before it; returns the sum of all. */
static tally sum_tallies(builder *b)
{
    tally sum = { 0, 0 };
    for (uint32_t c = 0; c < n_chunks(b->now.view.n, CHUNK); c++) {
        tally t = b->tallies[c];
        b->tallies[c] = sum;
        sum.kept += t.kept;
        sum.joined += t.joined;
    }
    return sum;
}

/* Writes clusters to + [0, n) of the next list: the union of left[i] and right[i], which may be the same. */
static void join_rows(const builder *b, const uint32_t *left, const uint32_t *right, uint32_t n, uint32_t to)
{
    for (int k = 0; k < (b->now.view.oriented ? LC_PLOC_ROWS : LC_PLOC_DLO); k++) {
        const float *from = b->now.view.row[k];
        float *out = b->next.view.row[k] + to;
        bool high = (k >= LC_PLOC_HI && k < LC_PLOC_INTENSITY) || k >= LC_PLOC_DHI;
        if (k == LC_PLOC_INTENSITY)
            for (uint32_t i = 0; i < n; i++)
                out[i] = from[left[i]] + (left[i] == right[i] ? 0 : from[right[i]]);
        else if (high)
            for (uint32_t i = 0; i < n; i++)
                out[i] = from[left[i]] > from[right[i]] ? from[left[i]] : from[right[i]];
        else
            for (uint32_t i = 0; i < n; i++)
                out[i] = from[left[i]] < from[right[i]] ? from[left[i]] : from[right[i]];
    }
}

/* Without branches, as they would be mispredicted: which clusters have a partner is close to random. */
static void join_chunk(void *user, uint32_t thread, uint64_t chunk)
{
    builder *b = user;
    uint32_t left[CHUNK], right[CHUNK], first = (uint32_t)chunk * CHUNK, n = 0, joined = 0;
    lc_build_pair pairs[CHUNK + 1];
    const uint32_t to = b->tallies[chunk].kept, pair = b->n_pairs + b->tallies[chunk].joined;
    (void)thread;
    for (uint32_t i = first; i < first + chunk_size(b->now.view.n, chunk); i++) {
        float offset = is_mutual(b, i) ? b->offset[i] : 0;
        left[n] = i;
        right[n] = i + (uint32_t)(int32_t)offset;
        n += offset >= 0;
    }
    for (uint32_t i = 0; i < n; i++) {
        uint32_t x = b->now.id[left[i]], y = b->now.id[right[i]];
        bool two = x != y;
        pairs[joined] = (lc_build_pair){ { x < y ? x : y, x < y ? y : x } };
        b->next.id[to + i] = two ? b->in->n + pair + joined : x;
        joined += two;
    }
    memcpy(b->pairs + pair, pairs, joined * sizeof *pairs);
    join_rows(b, left, right, n, to);
}

/* ---- memory ---- */

static void free_list(builder *b, list *l)
{
    lc_free(b->ctx, l->block, l->n_floats, sizeof *l->block);
    lc_free(b->ctx, l->id, l->n_ids, sizeof *l->id);
    *l = (list){ 0 };
}

/* Allocates a list for n clusters, or for n lights: their boxes are points, so lo and hi share rows. */
static lc_status alloc_list(builder *b, list *l, uint32_t n, bool of_lights)
{
    const bool oriented = lc_is_aimed(b->in->kind);
    const size_t stride = ((size_t)n + 2 * LC_LANES - 1) / LC_LANES * LC_LANES;
    const uint32_t n_rows = oriented ? LC_PLOC_ROWS : LC_PLOC_DLO;
    *l = (list){ .view = { .n = n, .oriented = oriented, .c2 = b->c2 }, .n_ids = n };
    l->n_floats = stride * (n_rows - (of_lights ? (oriented ? 6 : 3) : 0));
    l->block = lc_alloc_raw(b->ctx, l->n_floats, sizeof *l->block);
    l->id = lc_alloc_raw(b->ctx, l->n_ids, sizeof *l->id);
    if (!l->block || !l->id) return LC_ERR_MEMORY;
    for (size_t k = 0, at = 0; k < n_rows; k++) {
        bool again = of_lights && ((k >= LC_PLOC_HI && k < LC_PLOC_INTENSITY) || k >= LC_PLOC_DHI);
        l->view.row[k] = again ? l->view.row[k - 3] : l->block + stride * at++;
        memset(l->view.row[k] + n, 0, LC_LANES * sizeof *l->block);
    }
    return LC_OK;
}

/* Room for n clusters in the next list. */
static lc_status make_room(builder *b, uint32_t n)
{
    b->next.view.n = n;
    if (b->n_lists > 2) return LC_OK; /* both lists have held more */
    free_list(b, &b->next);
    b->n_lists++;
    return alloc_list(b, &b->next, n, false);
}

/* ---- all of it ---- */

static lc_status join_all(builder *b)
{
    while (b->now.view.n > 1) {
        const uint32_t n = b->now.view.n, chunks = n_chunks(n, CHUNK);
        b->radius = MIN_ROUND / n > RADIUS ? MIN_ROUND / n : RADIUS;
        b->search_item = n / (ITEMS_A_THREAD * b->ctx->n_threads) / LC_PLOC_CHUNK * LC_PLOC_CHUNK;
        if (b->search_item < LC_PLOC_CHUNK) b->search_item = LC_PLOC_CHUNK;
        if (b->search_item > MAX_SEARCH_ITEM) b->search_item = MAX_SEARCH_ITEM;
        run(b, n_chunks(n, b->search_item), (uint64_t)n * (b->radius < n ? b->radius : n) < SERIAL_SEARCH,
            search_some);
        run(b, chunks, n < SERIAL_MOVE, count_chunk);
        tally t = sum_tallies(b);
        lc_status st = make_room(b, t.kept);
        if (st) return st;
        run(b, chunks, n < SERIAL_MOVE, join_chunk);
        b->n_pairs += t.joined;
        b->grouped = n > SHORT && (uint64_t)t.joined * SLOW < n;
        list was = b->now;
        b->now = b->next;
        b->next = was;
    }
    return LC_OK;
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
        st = lc_morton_order(b->ctx, n, place_in_order, b, b->order);
    }
    if (!st) st = alloc_list(b, &b->now, n, true);
    if (!st) run(b, chunks, n < SERIAL_MOVE, load_chunk);
    lc_free(b->ctx, b->extents, chunks, sizeof *b->extents);
    lc_free(b->ctx, b->order, n, sizeof *b->order);
    return st;
}

lc_status lc_ploc(const lc_context *ctx, const lc_build_input *in, lc_build_pair *pairs)
{
    if (in->n < 2) return LC_OK;
    builder b = { .ctx = ctx, .in = in, .kernels = ctx->tree_kernels, .pairs = pairs, .n_lists = 1 };
    const uint32_t chunks = n_chunks(in->n, CHUNK);
    lc_status st = load_lights(&b);
    if (!st) {
        b.offset = lc_alloc_raw(ctx, in->n, sizeof *b.offset);
        b.tallies = lc_alloc_raw(ctx, chunks, sizeof *b.tallies);
        st = b.offset && b.tallies ? LC_OK : LC_ERR_MEMORY;
    }
    if (!st) st = join_all(&b);
    free_list(&b, &b.now);
    free_list(&b, &b.next);
    lc_free(ctx, b.offset, in->n, sizeof *b.offset);
    lc_free(ctx, b.tallies, chunks, sizeof *b.tallies);
    return st;
}
