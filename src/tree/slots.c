/* slots.c - see slots.h. Lights of a node in the order of its leaves, by intensity, are n_reps equal parts,
 * and each slot has one of them: its representative is there.
 *
 *     parts           0   1   2   3   4   5   6   7
 *     node            c   f   a   h   d   g   b   e     the slots that have them
 *                     |-- left -|------ right ------|   whose each is
 *     left child      c   h   f   d   g   a   b   e     c f a, which chose it, evenly; the others between
 *
 * So of any cluster below, the slots that come to it from above are spread evenly over its lights, and with
 * all slots, as a pixel's samples have them, the errors of a cut's clusters make up for each other.
 */
#include "tree/slots.h"

#include "base/memory.h"
#include "base/rng.h"

#include <string.h>

#define FREE 0xff

enum { KEY_OF_LEFT = LC_MAX_REPS, KEY_OF_RIGHT };

typedef struct {
    lc_light_tree *tree;
    uint32_t first, n, n_reps; /* of nodes */
    uint64_t seed;
    uint8_t *slot;   /* n n_reps: the slots of a node's parts */
    uint8_t *n_left; /* n: parts of a node whose representatives are the left child's */
} dealing;

static double intensity_of(const lc_light_tree *t, uint32_t link)
{
    const float *i =
        link & LC_LEAF ? t->data.lights[link & ~LC_LEAF].intensity : t->data.nodes[link].intensity;
    return (double)i[0] + (double)i[1] + (double)i[2];
}

static void shuffle(uint8_t *slot, uint32_t n, uint64_t h)
{
    for (uint32_t i = 0; i < n; i++) slot[i] = (uint8_t)i;
    for (uint32_t i = n; i-- > 1;) {
        h = lc_mix(h);
        const uint32_t other = (uint32_t)(h % (i + 1));
        const uint8_t was = slot[i];
        slot[i] = slot[other];
        slot[other] = was;
    }
}

/* Deals a child's parts: evenly to the slots that chose it, the rest to the others. Every slot has every part
 * with the same probability, as the first one is drawn. */
static void deal(const dealing *d, uint32_t child, const uint8_t *own, uint32_t n_own, const uint8_t *others,
                 uint64_t h)
{
    const uint32_t n = d->n_reps, first = (uint32_t)(h % n);
    if (child & LC_LEAF) return;
    uint8_t *to = d->slot + (size_t)(child - d->first) * n;
    memset(to, FREE, n);
    for (uint32_t i = 0; i < n_own; i++) to[(i * n / n_own + first) % n] = own[i];
    for (uint32_t i = 0, at = first; i < n - n_own; i++) {
        while (to[at % n] != FREE) at++;
        to[at % n] = others[i];
    }
}

/* A place in each part is drawn: those below the left child's share are its. */
static void deal_children(const dealing *d, uint32_t id)
{
    const lc_node *node = &d->tree->data.nodes[id];
    const double left = intensity_of(d->tree, node->left), all = left + intensity_of(d->tree, node->right);
    const uint8_t *slot = d->slot + (size_t)(id - d->first) * d->n_reps;
    const uint64_t key = lc_hash2(d->seed, id);
    uint32_t k = 0;
    while (k < d->n_reps && (k + lc_unit(lc_hash2(key, k))) * all < left * d->n_reps) k++;
    d->n_left[id - d->first] = (uint8_t)k;
    deal(d, node->left, slot, k, slot + k, lc_hash2(key, KEY_OF_LEFT));
    deal(d, node->right, slot + k, d->n_reps - k, slot, lc_hash2(key, KEY_OF_RIGHT));
}

/* The children's are chosen. */
static void take_reps(const dealing *d, uint32_t id)
{
    lc_light_tree *t = d->tree;
    lc_node *node = &t->data.nodes[id];
    const uint8_t *slot = d->slot + (size_t)(id - d->first) * d->n_reps;
    for (uint32_t k = 0; k < d->n_reps; k++) {
        const uint32_t link = k < d->n_left[id - d->first] ? node->left : node->right,
                       rep = link & LC_LEAF ? link & ~LC_LEAF : lc_rep_of(t, link, slot[k]);
        if (t->reps) t->reps[(size_t)id * d->n_reps + slot[k]] = rep;
        if (!slot[k]) node->rep = rep;
    }
}

lc_status lc_tree_choose_reps(lc_light_tree *t, lc_light_kind kind, uint64_t seed)
{
    dealing d = { .tree = t,
                  .first = t->first_node[kind],
                  .n = t->first_node[kind + 1] - t->first_node[kind],
                  .n_reps = t->n_reps,
                  .seed = lc_hash2(seed, kind) };
    if (!d.n) return LC_OK;
    d.slot = lc_alloc_raw(t->ctx, d.n, d.n_reps);
    d.n_left = lc_alloc_raw(t->ctx, d.n, 1);
    const lc_status st = d.slot && d.n_left ? LC_OK : LC_ERR_MEMORY;
    if (!st) {
        shuffle(d.slot, d.n_reps, d.seed);
        for (uint32_t i = 0; i < d.n; i++) deal_children(&d, d.first + i); /* children come after parents */
        for (uint32_t i = d.n; i-- > 0;) take_reps(&d, d.first + i);
    }
    lc_free(t->ctx, d.slot, d.n, d.n_reps);
    lc_free(t->ctx, d.n_left, d.n, 1);
    return st;
}
