/* agglomerate.c - exact agglomeration by a nearest-neighbour chain ([Miksik07] 3, [Walter08]).
 *
 * Chain: A, NN(A), NN(NN(A)), ... until the last two are each other's nearest; they are merged, and what is left of the
 * chain stays valid because merging never brings two clusters closer (reducibility). Distances along the chain fall
 * strictly - a neighbour has to beat the previous element, not only equal it - so it can't cycle on ties.
 */
#include "near_tree.h"

#define RENEW_MIN 32 /* clusters: fewer are in the cache anyway */

typedef struct {
    lc_near_tree near;
    lc_neighbour *chain; /* chain[i].d is the distance between elements i and i - 1 */
    size_t cap_chain;
    uint32_t n_chain;
    uint32_t oldest; /* no cluster below it is live */
} builder;

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

static lc_status run_chain(builder *b, const lc_context *ctx, uint32_t n, lc_build_pair *pairs)
{
    lc_status st = LC_OK;
    uint32_t next = n, fresh = LC_NONE; /* cluster that the end of the chain has just lost its nearest to */
    double floor = 0;
    while (next < 2 * n - 1 && !st) {
        uint32_t n_live = 2 * n - next;
        if (n_live <= b->near.n / 2 && n_live >= RENEW_MIN && (st = lc_near_renew(&b->near, n_live))) break;
        if (!b->n_chain) {
            while (b->near.slot[b->oldest] == LC_NONE) b->oldest++;
            if ((st = push(b, ctx, (lc_neighbour){ b->oldest, INFINITY }))) break;
            fresh = LC_NONE, floor = 0;
        }
        lc_neighbour top = b->chain[b->n_chain - 1], best = { LC_NONE, INFINITY };
        if (b->n_chain > 1) best = (lc_neighbour){ b->chain[b->n_chain - 2].id, top.d };
        (void)fresh;
        lc_neighbour nearest = lc_near_find(&b->near, top.id, best, floor);
        floor = 0;
        if (b->n_chain > 1 && nearest.id == best.id) {
            floor = b->chain[b->n_chain - 2].d;
            merge_last(b, fresh = next, &pairs[next - n]);
            next++;
        } else {
            st = push(b, ctx, nearest);
            fresh = LC_NONE;
        }
    }
    return st;
}

lc_status lc_agglomerate(const lc_context *ctx, const lc_build_input *in, lc_build_pair *pairs)
{
    if (in->n < 2) return LC_OK;
    builder b = { .n_chain = 0 };
    lc_status st = lc_near_create(ctx, in, &b.near);
    if (st) return st;
    st = run_chain(&b, ctx, in->n, pairs);
    lc_free(ctx, b.chain, b.cap_chain, sizeof *b.chain);
    lc_near_destroy(&b.near);
    return st;
}
