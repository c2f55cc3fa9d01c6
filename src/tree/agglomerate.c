/* agglomerate.c - exact agglomeration by a nearest-neighbour chain ([Miksik07] 3, [Walter08]).
 *
 * The chain is A, NN(A), NN(NN(A)), ... until the last two are each other's nearest. These are merged, and
 * the rest of the chain stays valid because merging never brings two clusters closer (reducibility).
 * Distances along the chain decrease strictly - a neighbour must be nearer than the previous element, not
 * only as near - so that it cannot cycle on ties.
 *
 * The nearest neighbour of every light, about two searches in five, is found beforehand and in parallel; the
 * chain itself runs in one thread.
 *
 * Memory: at most 170 bytes a light for cluster_kdtree.h, 4 for the lights' nearest, 16 for each element of
 * the chain, which has some dozens except on sets made to be hard.
 */
#include "tree/cluster_kdtree.h"

#include "base/pool.h"

#define RENEW_MIN 32     /* live clusters; a tree of fewer fits in the cache */
#define FIRST_STEP 1024u /* slots that a thread takes at a time */

typedef struct {
    lc_near_tree near;
    /* Nearest neighbour of each light among the lights; right as long as that one is live. */
    uint32_t *first;
    lc_neighbour *chain; /* chain[i].d is the distance between elements i and i - 1 */
    size_t cap_chain;
    uint32_t n_chain;
    uint32_t oldest; /* no cluster below it is live */
    uint32_t n;      /* lights */
} builder;

static void find_first(void *user, uint32_t thread, uint64_t item)
{
    (void)thread;
    const builder *b = user;
    uint32_t begin = (uint32_t)item * FIRST_STEP, end = b->n - begin < FIRST_STEP ? b->n : begin + FIRST_STEP;
    for (uint32_t slot = begin; slot < end; slot++) {
        uint32_t id = b->near.id[slot];
        b->first[id] = lc_near_find(&b->near, id, (lc_neighbour){ LC_NONE, INFINITY }, 0).id;
    }
}

/* The cluster nearest to q; ties: prev, then the lowest id. A light's is b->first as long as that is live:
 * clusters merged since are no nearer and have higher ids. */
static lc_neighbour nearest(const builder *b, uint32_t q, lc_neighbour prev, double floor)
{
    uint32_t known = q < b->n ? b->first[q] : LC_NONE;
    if (known == LC_NONE || b->near.slot[known] == LC_NONE) return lc_near_find(&b->near, q, prev, floor);
    double d = lc_near_distance(&b->near, q, known);
    return d < prev.d || prev.id == LC_NONE ? (lc_neighbour){ known, d } : prev;
}

static lc_status push(builder *b, const lc_context *ctx, lc_neighbour element)
{
    lc_status st = lc_grow(ctx, (void **)&b->chain, &b->cap_chain, (size_t)b->n_chain + 1, sizeof *b->chain);
    if (!st) b->chain[b->n_chain++] = element;
    return st;
}

/* Merges the last two of the chain. */
static void merge_last(builder *b, uint32_t id, lc_build_pair *pair)
{
    uint32_t x = b->chain[b->n_chain - 1].id, y = b->chain[b->n_chain - 2].id;
    *pair = (lc_build_pair){ { x < y ? x : y, x < y ? y : x } };
    lc_near_merge(&b->near, x, y, id);
    b->n_chain -= 2;
}

static lc_status run_chain(builder *b, const lc_context *ctx, lc_build_pair *pairs)
{
    lc_status st = LC_OK;
    uint32_t n = b->n, next = n;
    /* After a merge, the distance from the chain's end to its merged neighbour: no cluster is nearer. */
    double floor = 0;
    while (next < 2 * n - 1 && !st) {
        uint32_t n_live = 2 * n - next;
        if (n_live <= b->near.n / 2 && n_live >= RENEW_MIN && (st = lc_near_renew(&b->near, n_live))) break;
        if (!b->n_chain) {
            while (b->near.slot[b->oldest] == LC_NONE) b->oldest++;
            if ((st = push(b, ctx, (lc_neighbour){ b->oldest, INFINITY }))) break;
            floor = 0;
        }
        lc_neighbour top = b->chain[b->n_chain - 1], prev = { LC_NONE, INFINITY };
        if (b->n_chain > 1) prev = (lc_neighbour){ b->chain[b->n_chain - 2].id, top.d };
        lc_neighbour found = nearest(b, top.id, prev, floor);
        if (b->n_chain > 1 && found.id == prev.id) {
            floor = b->chain[b->n_chain - 2].d;
            merge_last(b, next, &pairs[next - n]);
            next++;
        } else {
            st = push(b, ctx, found);
            floor = 0;
        }
    }
    return st;
}

lc_status lc_agglomerate(const lc_context *ctx, const lc_build_input *in, lc_build_pair *pairs)
{
    if (in->n < 2) return LC_OK;
    builder b = { .n = in->n };
    lc_status st = lc_near_create(ctx, in, &b.near);
    if (st) return st;
    b.first = lc_alloc_raw(ctx, b.n, sizeof *b.first);
    st = b.first ? LC_OK : LC_ERR_MEMORY;
    if (!st) {
        lc_parallel(ctx, ((uint64_t)b.n + FIRST_STEP - 1) / FIRST_STEP, find_first, &b);
        st = run_chain(&b, ctx, pairs);
    }
    lc_free(ctx, b.first, b.n, sizeof *b.first);
    lc_free(ctx, b.chain, b.cap_chain, sizeof *b.chain);
    lc_near_destroy(&b.near);
    return st;
}
