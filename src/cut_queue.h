/* cut_queue.h - the clusters of a cut that are above the error limit, worst first.
 *
 * A fixed-size priority queue by buckets: the leading 11 bits of a positive float (8 of exponent, 3 of mantissa) number
 * 2048 stacks, linked through the nodes; two levels of bit masks find the highest. Push and pop are a few instructions,
 * against the hard-to-predict comparisons of a binary heap: refinement without bounds, estimates and rays took 17 % of a
 * frame of stairs with one and takes 12.6 % (Zen 4, 2026-11). Order within 12.5 % of each other is last in, first out:
 * every one of them has to be split anyway, the order only matters at max_cut.
 */
#ifndef LC_CUT_QUEUE_H
#define LC_CUT_QUEUE_H

#include "base.h"

#include <string.h>

#define LC_CUT_BUCKETS 2048

/* A cluster in the cut: 32 bytes, so that two share a cache line. */
typedef struct lc_cut_node {
    float bound;       /* luminance, > 0 */
    uint32_t id;       /* light tree node */
    uint32_t rep;      /* light index */
    float transfer[3]; /* M G V of the representative */
    float lum;         /* luminance of the estimate */
    uint32_t next;     /* in its bucket */
} lc_cut_node;

typedef struct lc_cut_queue {
    uint32_t summary; /* bit w: mask[w] is not 0 */
    uint64_t mask[LC_CUT_BUCKETS / 64];
    uint32_t head[LC_CUT_BUCKETS]; /* meant only where the mask's bit is set */
} lc_cut_queue;

static inline void lc_cut_push(lc_cut_queue *q, lc_cut_node *nodes, uint32_t at)
{
    uint32_t bits, b;
    memcpy(&bits, &nodes[at].bound, sizeof bits);
    b = bits >> 20;
    LC_ASSERT(b < LC_CUT_BUCKETS);
    uint64_t bit = (uint64_t)1 << (b & 63);
    nodes[at].next = q->mask[b >> 6] & bit ? q->head[b] : LC_NONE;
    q->head[b] = at;
    q->mask[b >> 6] |= bit;
    q->summary |= 1u << (b >> 6);
}

/* The queue must not be empty: summary != 0. */
static inline uint32_t lc_cut_pop(lc_cut_queue *q, const lc_cut_node *nodes)
{
    uint32_t w = 31 - (uint32_t)__builtin_clz(q->summary);
    uint32_t b = w * 64 + 63 - (uint32_t)__builtin_clzll(q->mask[w]), at = q->head[b];
    q->head[b] = nodes[at].next;
    if (nodes[at].next == LC_NONE) {
        q->mask[w] &= ~((uint64_t)1 << (b & 63));
        if (!q->mask[w]) q->summary &= ~(1u << w);
    }
    return at;
}

#endif
