/* bvh_reinsert.c - optimizes the upper binary tree (Bittner, Hapala, Havran 2013, "Fast insertion-based
 * optimization of bounding volume hierarchies"): nodes of large area are removed and inserted again where
 * they add the least area. Serial. Measured: tests/results/bvh-build.md.
 *
 *     remove n:    p(n, s) -> s in p's place          insert at x:    x -> q(x, n) in x's place
 *
 * x and n take the pair of places that n and s leave. Nodes of at most eight triangles are not opened, so
 * that the triangles of a block stay together. The depth stays below MAX_DEPTH.
 */
#include "trace/bvh_build.h"

#include <math.h>
#include <string.h>

/* Limits on the time spent; chosen. */
#define PASSES 2
#define TRIS_A_MOVE 28 /* triangles for each node that a pass moves */
#define MAX_MOVES 8192 /* nodes that a pass moves */
#define MAX_VISITS 128 /* nodes whose children the search for one place visits */
#define MAX_DEPTH (LC_BVH_MAX_DEPTH - 2)

typedef struct {
    float cost; /* what inserting below the node adds to it and all above it */
    uint32_t node, depth;
} entry;

/* A binary heap with the least cost at the top. */
typedef struct {
    entry *at;
    uint32_t n;
} heap;

typedef struct {
    lc_bvh_builder *b;
    uint32_t n_moves;
    uint32_t *moves;
    heap queue; /* room for 2 n_moves + 2 MAX_VISITS */
} mover;

static void push(heap *h, entry e)
{
    uint32_t i = h->n++;
    for (; i && e.cost < h->at[(i - 1) / 2].cost; i = (i - 1) / 2) h->at[i] = h->at[(i - 1) / 2];
    h->at[i] = e;
}

static entry pop(heap *h)
{
    entry top = h->at[0], e = h->at[--h->n];
    uint32_t i = 0;
    for (uint32_t k; (k = 2 * i + 1) < h->n; i = k) {
        if (k + 1 < h->n && h->at[k + 1].cost < h->at[k].cost) k++;
        if (!(h->at[k].cost < e.cost)) break;
        h->at[i] = h->at[k];
    }
    h->at[i] = e;
    return top;
}

static f4_box box_of(const lc_bin_node *n) { return (f4_box){ f4_load(n->lo), f4_load(n->hi) }; }

static float area_of(f4_box box)
{
    _Alignas(16) float d[4];
    f4_store(d, f4_sub(box.hi, box.lo));
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
}

/* True if a node may be inserted below this one. */
static bool is_open(const lc_bin_node *n)
{
    return !(n->info & LC_BIN_LEAF) && !(n->info >> LC_BIN_COUNT_SHIFT & 15);
}

/* Stores a node and its costs at a place. */
static void put(const lc_bvh_builder *b, uint32_t place, const lc_bin_node *node, const lc_bvh_costs *costs)
{
    b->nodes[place] = *node;
    *lc_bvh_costs_of(b, place) = *costs;
    if (!(node->info & LC_BIN_LEAF)) b->parents[node->left / 2] = place;
}

/* Updates boxes, heights and flags from a node whose children changed up to where nothing does. */
static void update_above(const lc_bvh_builder *b, uint32_t place)
{
    for (;; place = b->parents[place / 2]) {
        lc_bin_node *n = &b->nodes[place], *child = &b->nodes[n->left], was = *n;
        f4_box box = f4_box_join(box_of(&child[0]), box_of(&child[1]));
        uint32_t h0 = lc_bvh_costs_of(b, n->left)->height, h1 = lc_bvh_costs_of(b, n->left + 1)->height;
        f4_store(n->lo, box.lo);
        f4_store(n->hi, box.hi);
        n->left = was.left;
        n->info = was.info | LC_BIN_DIRTY | ((child[0].info | child[1].info) & LC_BIN_TOP);
        if (!place) return;
        uint32_t *height = &lc_bvh_costs_of(b, place)->height, h = 1 + (h0 > h1 ? h0 : h1);
        if (!memcmp(n, &was, sizeof was) && *height == h) return; /* what is dirty has dirty nodes above */
        *height = h;
    }
}

/* Whether the tree keeps its depth if a node of some height is put beside that at a place. */
static bool fits(const lc_bvh_builder *b, uint32_t place, uint32_t depth, uint32_t height)
{
    const uint32_t other = lc_bvh_costs_of(b, place)->height;
    return depth + 1 + (height > other ? height : other) < MAX_DEPTH;
}

/* The place where inserting the node adds the least area, to all nodes above and by the new parent; 0 if
 * there is none. Branch and bound, as in the paper. */
static uint32_t find_place(mover *m, const lc_bin_node *node, uint32_t height)
{
    const lc_bvh_builder *b = m->b;
    const f4_box box = box_of(node);
    const float own = area_of(box);
    float least = INFINITY;
    uint32_t place = 0;
    m->queue.n = 0;
    const f4_box all = box_of(&b->nodes[0]);
    push(&m->queue, (entry){ area_of(f4_box_join(box, all)) - area_of(all), 0, 0 });
    for (int visits = 0; m->queue.n && visits < MAX_VISITS; visits++) {
        const entry e = pop(&m->queue);
        if (e.cost + own >= least) break;
        for (uint32_t k = b->nodes[e.node].left, end = k + 2; k < end; k++) {
            const lc_bin_node *x = &b->nodes[k];
            const float joined = area_of(f4_box_join(box, box_of(x))),
                        above = e.cost + joined - area_of(box_of(x));
            if (e.cost + joined < least && fits(b, k, e.depth + 1, height)) {
                least = e.cost + joined;
                place = k;
            }
            if (!is_open(x) || !(above + own < least)) continue;
            __builtin_prefetch(&b->nodes[x->left]);
            push(&m->queue, (entry){ above, k, e.depth + 1 });
        }
    }
    return place;
}

static void move_node(mover *m, uint32_t place)
{
    const lc_bvh_builder *b = m->b;
    const uint32_t pair = place & ~1u, parent = b->parents[place / 2];
    if (!parent || !is_open(&b->nodes[parent])) return;
    const lc_bin_node node = b->nodes[place], sibling = b->nodes[place ^ 1];
    const lc_bvh_costs costs = *lc_bvh_costs_of(b, place), sibling_costs = *lc_bvh_costs_of(b, place ^ 1);
    put(b, parent, &sibling, &sibling_costs);
    update_above(b, b->parents[parent / 2]);
    uint32_t to = find_place(m, &node, costs.height);
    if (!to) to = parent;
    const lc_bin_node x = b->nodes[to];
    const lc_bvh_costs x_costs = *lc_bvh_costs_of(b, to);
    put(b, pair, &x, &x_costs);
    put(b, pair + 1, &node, &costs);
    b->nodes[to].left = pair;
    b->nodes[to].info = 0;
    b->parents[pair / 2] = to;
    update_above(b, to);
}

/* Lists the nodes of largest area below the root, in falling order: a child is never larger than its
 * parent. */
static uint32_t list_largest(mover *m)
{
    const lc_bin_node *nodes = m->b->nodes;
    uint32_t n = 0;
    m->queue.n = 0;
    push(&m->queue, (entry){ -INFINITY, 0, 0 });
    while (m->queue.n && n < m->n_moves) {
        uint32_t node = pop(&m->queue).node;
        if (node) m->moves[n++] = node;
        if (!is_open(&nodes[node])) continue;
        for (uint32_t k = nodes[node].left; k < nodes[node].left + 2; k++)
            push(&m->queue, (entry){ -area_of(box_of(&nodes[k])), k, 0 });
    }
    return n;
}

/* Plans again all nodes that changed, which form a tree below the root. list: room for all inner nodes. */
static void plan_changed(const lc_bvh_builder *b, uint32_t *list)
{
    uint32_t n = 0;
    list[n++] = 0;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = b->nodes[list[i]].left, end = k + 2; k < end; k++)
            if (b->nodes[k].info & LC_BIN_DIRTY) list[n++] = k;
    while (n) {
        uint32_t place = list[--n];
        lc_bin_node *node = &b->nodes[place];
        node->info &= LC_BIN_TOP;
        lc_bvh_costs c = lc_bvh_plan(node, lc_bvh_costs_of(b, node->left),
                                     lc_bvh_costs_of(b, node->left + 1));
        if (place) *lc_bvh_costs_of(b, place) = c;
    }
}

lc_status lc_bvh_reinsert(lc_bvh_builder *b)
{
    const size_t moves = b->n_tris / TRIS_A_MOVE;
    mover m = { .b = b, .n_moves = moves < MAX_MOVES ? (uint32_t)moves : MAX_MOVES };
    const size_t room = 2 * (size_t)m.n_moves + 2 * MAX_VISITS;
    if (!m.n_moves || !is_open(&b->nodes[0])) return LC_OK;
    m.moves = lc_alloc_raw(b->ctx, m.n_moves, sizeof *m.moves);
    m.queue.at = lc_alloc_raw(b->ctx, room, sizeof *m.queue.at);
    lc_status st = m.moves && m.queue.at ? LC_OK : LC_ERR_MEMORY;
    if (!st) {
        b->nodes[0].info |= LC_BIN_DIRTY;
        for (int pass = 0; pass < PASSES; pass++)
            for (uint32_t i = 0, n = list_largest(&m); i < n; i++) move_node(&m, m.moves[i]);
        plan_changed(b, b->parents);
    }
    lc_free(b->ctx, m.moves, m.n_moves, sizeof *m.moves);
    lc_free(b->ctx, m.queue.at, room, sizeof *m.queue.at);
    return st;
}
