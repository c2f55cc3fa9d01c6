/* agglomerate.c - nearest-neighbour chain over a kd-tree of clusters.
 *
 * Chain: A, NN(A), NN(NN(A)), ... until the last two are each other's nearest; they are merged, and what is left of the
 * chain stays valid because merging never brings two clusters closer (reducibility). Distances along the chain fall
 * strictly - a neighbour has to beat the previous element, not only equal it - so it can't cycle on ties.
 *
 * kd-tree: perfectly balanced, over the lights' positions, static. A slot holds a cluster; a merged cluster takes its
 * left child's slot, the right one's goes empty. Every cell knows, over the clusters in its slots,
 *
 *     min_hi, max_lo per axis     the union of query Q and any of them is at least max(Q.hi, min_hi) - min(Q.lo, max_lo)
 *     min_power, max_cos          wide, at least Q + min_power bright, and has a cone of at most min(Q.cos, max_cos)
 *
 * which gives a lower bound of the metric for the whole cell ([Walter08]'s builder prunes likewise).
 */
#include "agglomerate.h"

#include "rng.h"
#include "tree_build.h"

#define BUCKET 4
#define PRUNE_SLACK 0.9999 /* of the lower bound, for its rounding; sums of floats above it are below 1e-6 */

typedef struct {
    float min_hi[3], max_lo[3];
    float min_power, max_cos;
} cell;

typedef struct {
    const lc_context *ctx;
    lc_build_node *nodes;
    double c2;
    uint32_t n;
    uint32_t n_leaves; /* power of two; cell 1 is the root, leaves are n_leaves .. 2 n_leaves - 1 */
    cell *cells;
    uint32_t *slot;    /* n: cluster or LC_NONE */
    uint32_t *slot_of; /* 2n - 1: slot of a live cluster */
    uint8_t *dead;     /* 2n - 1 */
} search;

typedef struct {
    uint32_t id;
    double d;
} neighbour;

double lc_cluster_metric(const lc_build_node *a, const lc_build_node *b, double c2)
{
    double alpha2 = 0, s2 = 0, r2 = 0, turn = 0;
    for (int k = 0; k < 3; k++) {
        double lo = a->c.lo[k] < b->c.lo[k] ? a->c.lo[k] : b->c.lo[k];
        double hi = a->c.hi[k] > b->c.hi[k] ? a->c.hi[k] : b->c.hi[k];
        alpha2 += (hi - lo) * (hi - lo);
    }
    if (c2 > 0) {
        for (int k = 0; k < 3; k++) {
            double lo = a->c.dlo[k] < b->c.dlo[k] ? a->c.dlo[k] : b->c.dlo[k];
            double hi = a->c.dhi[k] > b->c.dhi[k] ? a->c.dhi[k] : b->c.dhi[k];
            s2 += (lo + hi) * (lo + hi);
            r2 += (hi - lo) * (hi - lo);
        }
        double s = sqrt(s2), cos_beta = s < 0.1 ? -1 : (s2 + 4 - r2) / (4 * s);
        double least = a->cos_cone < b->cos_cone ? a->cos_cone : b->cos_cone;
        if (cos_beta > least) cos_beta = least;
        if (cos_beta < -1) cos_beta = -1;
        turn = c2 * (1 - cos_beta) * (1 - cos_beta);
    }
    return (lc_cluster_scalar(&a->c) + lc_cluster_scalar(&b->c)) * (alpha2 + turn);
}

lc_build_node lc_build_node_merge(const lc_build_node *nodes, uint32_t a, uint32_t b)
{
    const lc_build_node *x = &nodes[a], *y = &nodes[b];
    lc_build_node out = { .child = { a, b }, .light = LC_NONE };
    double axis[3];
    lc_cluster_join(&out.c, &x->c, &y->c);
    out.cos_cone = lc_cluster_cone(&out.c, axis);
    if (out.cos_cone > x->cos_cone) out.cos_cone = x->cos_cone;
    if (out.cos_cone > y->cos_cone) out.cos_cone = y->cos_cone;
    out.hash = x->hash < y->hash ? lc_hash2(x->hash, y->hash) : lc_hash2(y->hash, x->hash);
    return out;
}

static float down(double x)
{
    float f = (float)x;
    return (double)f > x ? nextafterf(f, -INFINITY) : f;
}

static cell cell_empty(void)
{
    const float inf = INFINITY;
    return (cell){ { inf, inf, inf }, { -inf, -inf, -inf }, inf, -1 };
}

static cell cell_join(const cell *a, const cell *b)
{
    cell c = *a;
    for (int k = 0; k < 3; k++) {
        if (b->min_hi[k] < c.min_hi[k]) c.min_hi[k] = b->min_hi[k];
        if (b->max_lo[k] > c.max_lo[k]) c.max_lo[k] = b->max_lo[k];
    }
    if (b->min_power < c.min_power) c.min_power = b->min_power;
    if (b->max_cos > c.max_cos) c.max_cos = b->max_cos;
    return c;
}

static uint32_t leaf_first(const search *s, uint32_t leaf) { return (uint32_t)((uint64_t)leaf * s->n / s->n_leaves); }

static cell leaf_cell(const search *s, uint32_t leaf)
{
    cell c = cell_empty();
    for (uint32_t i = leaf_first(s, leaf); i < leaf_first(s, leaf + 1); i++) {
        if (s->slot[i] == LC_NONE) continue;
        const lc_build_node *n = &s->nodes[s->slot[i]];
        cell one = { { n->c.hi[0], n->c.hi[1], n->c.hi[2] }, { n->c.lo[0], n->c.lo[1], n->c.lo[2] },
                     down(lc_cluster_scalar(&n->c)), -down(-n->cos_cone) };
        c = cell_join(&c, &one);
    }
    return c;
}

static bool cell_equal(const cell *a, const cell *b)
{
    bool eq = a->min_power == b->min_power && a->max_cos == b->max_cos;
    for (int k = 0; k < 3; k++) eq = eq && a->min_hi[k] == b->min_hi[k] && a->max_lo[k] == b->max_lo[k];
    return eq;
}

static void refresh(search *s, uint32_t slot)
{
    uint32_t leaf = (uint32_t)(((uint64_t)slot * s->n_leaves) / s->n);
    while (leaf_first(s, leaf) > slot) leaf--;
    while (leaf_first(s, leaf + 1) <= slot) leaf++;
    s->cells[s->n_leaves + leaf] = leaf_cell(s, leaf);
    for (uint32_t i = (s->n_leaves + leaf) / 2; i >= 1; i /= 2) {
        cell c = cell_join(&s->cells[2 * i], &s->cells[2 * i + 1]);
        if (cell_equal(&c, &s->cells[i])) return;
        s->cells[i] = c;
    }
}

/* Coordinate, then id: a total order, so the kd-tree is the same whatever the selection algorithm does. */
static bool before(const search *s, uint32_t a, uint32_t b, int axis)
{
    float x = s->nodes[a].c.lo[axis], y = s->nodes[b].c.lo[axis];
    return x < y || (x == y && a < b);
}

/* Puts the k-th of slot[first, last) in its place, smaller ones before it (Hoare's selection). */
static void select_nth(search *s, uint32_t first, uint32_t last, uint32_t k, int axis)
{
    uint32_t *v = s->slot;
    while (last - first > 1) {
        uint32_t pivot = v[first + (last - first - 1) / 2], i = first, j = last - 1; /* never the last: both parts shrink */
        for (;;) {
            while (before(s, v[i], pivot, axis)) i++;
            while (before(s, pivot, v[j], axis)) j--;
            if (i >= j) break;
            uint32_t t = v[i];
            v[i++] = v[j];
            v[j--] = t;
        }
        if (k <= j) last = j + 1;
        else first = j + 1;
    }
}

/* Orders the slots level by level: each cell's range is cut at its middle leaf, along its longest side. */
static void kd_build(search *s)
{
    for (uint32_t width = s->n_leaves; width > 1; width /= 2)
        for (uint32_t leaf = 0; leaf < s->n_leaves; leaf += width) {
            uint32_t first = leaf_first(s, leaf), mid = leaf_first(s, leaf + width / 2), last = leaf_first(s, leaf + width);
            lc_box box = lc_box_empty();
            for (uint32_t i = first; i < last; i++) lc_box_add(&box, lc_f3_load(s->nodes[s->slot[i]].c.lo));
            float x = box.hi.x - box.lo.x, y = box.hi.y - box.lo.y, z = box.hi.z - box.lo.z;
            if (mid > first && mid < last) select_nth(s, first, last, mid, x >= y && x >= z ? 0 : y >= z ? 1 : 2);
        }
    for (uint32_t i = 0; i < s->n; i++) s->slot_of[s->slot[i]] = i;
    for (uint32_t l = 0; l < s->n_leaves; l++) s->cells[s->n_leaves + l] = leaf_cell(s, l);
    for (uint32_t i = s->n_leaves - 1; i >= 1; i--) s->cells[i] = cell_join(&s->cells[2 * i], &s->cells[2 * i + 1]);
}

/* Least metric that any cluster of the cell can reach with q; +inf for an empty cell. */
static double lower_bound(const search *s, const cell *c, const lc_build_node *q, double q_power)
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        float hi = q->c.hi[k] > c->min_hi[k] ? q->c.hi[k] : c->min_hi[k];
        float lo = q->c.lo[k] < c->max_lo[k] ? q->c.lo[k] : c->max_lo[k];
        sum += ((double)hi - lo) * ((double)hi - lo);
    }
    if (s->c2 > 0) {
        double cos_beta = q->cos_cone < (double)c->max_cos ? q->cos_cone : (double)c->max_cos;
        sum += s->c2 * (1 - cos_beta) * (1 - cos_beta);
    }
    return c->min_power == INFINITY ? INFINITY : (q_power + (double)c->min_power) * sum * PRUNE_SLACK;
}

static void search_leaf(const search *s, uint32_t leaf, uint32_t q, uint32_t prev, neighbour *best)
{
    for (uint32_t i = leaf_first(s, leaf); i < leaf_first(s, leaf + 1); i++) {
        uint32_t id = s->slot[i];
        if (id == LC_NONE || id == q) continue;
        double d = lc_cluster_metric(&s->nodes[q], &s->nodes[id], s->c2);
        if (d < best->d || best->id == LC_NONE || (d == best->d && best->id != prev && id < best->id))
            *best = (neighbour){ id, d };
    }
}

/* Nearest live cluster of q; `best` comes in as the previous chain element, or LC_NONE at +inf. */
static neighbour nearest(const search *s, uint32_t q, neighbour best)
{
    struct {
        uint32_t cell;
        double lb;
    } stack[64];
    uint32_t n = 0, prev = best.id;
    double q_power = lc_cluster_scalar(&s->nodes[q].c);
    stack[n].cell = 1, stack[n++].lb = 0;
    while (n) {
        uint32_t c = stack[--n].cell;
        if (stack[n].lb >= best.d) continue; /* equal: coincident lights must not all be looked at */
        if (c >= s->n_leaves) {
            search_leaf(s, c - s->n_leaves, q, prev, &best);
            continue;
        }
        double a = lower_bound(s, &s->cells[2 * c], &s->nodes[q], q_power);
        double b = lower_bound(s, &s->cells[2 * c + 1], &s->nodes[q], q_power);
        uint32_t near = b < a; /* pushed last, so visited first */
        double lb[2] = { a, b };
        for (uint32_t i = 0; i < 2; i++) {
            uint32_t side = i ? near : !near;
            if (lb[side] >= best.d) continue; /* +inf too */
            stack[n].cell = 2 * c + side, stack[n++].lb = lb[side];
        }
    }
    return best;
}

static void merge(search *s, uint32_t a, uint32_t b, uint32_t id)
{
    uint32_t left = a < b ? a : b, right = a < b ? b : a;
    s->nodes[id] = lc_build_node_merge(s->nodes, left, right);
    s->dead[left] = s->dead[right] = 1;
    s->slot_of[id] = s->slot_of[left];
    s->slot[s->slot_of[left]] = id;
    s->slot[s->slot_of[right]] = LC_NONE;
    refresh(s, s->slot_of[right]);
    refresh(s, s->slot_of[left]);
}

static void run_chain(search *s, neighbour *chain)
{
    uint32_t n_chain = 0, next = s->n, oldest = 0;
    while (next < 2 * s->n - 1) {
        if (!n_chain) {
            while (s->dead[oldest]) oldest++;
            chain[n_chain++] = (neighbour){ oldest, INFINITY };
        }
        /* chain[i].d is the distance between elements i and i - 1 */
        neighbour top = chain[n_chain - 1];
        neighbour start = n_chain > 1 ? (neighbour){ chain[n_chain - 2].id, top.d } : (neighbour){ LC_NONE, INFINITY };
        neighbour nn = nearest(s, top.id, start);
        if (n_chain > 1 && nn.id == start.id) {
            merge(s, top.id, nn.id, next++);
            n_chain -= 2;
        } else {
            chain[n_chain++] = nn;
        }
    }
}

lc_status lc_agglomerate_nodes(const lc_context *ctx, lc_build_node *nodes, uint32_t n, double c2)
{
    if (n < 2) return LC_OK;
    search s = { .ctx = ctx, .nodes = nodes, .c2 = c2, .n = n, .n_leaves = 1 };
    while ((uint64_t)s.n_leaves * BUCKET < n) s.n_leaves *= 2;
    size_t total = 2 * (size_t)n - 1;
    s.cells = lc_alloc(ctx, 2 * (size_t)s.n_leaves, sizeof *s.cells);
    s.slot = lc_alloc(ctx, n, sizeof *s.slot);
    s.slot_of = lc_alloc(ctx, total, sizeof *s.slot_of);
    s.dead = lc_alloc(ctx, total, 1);
    neighbour *chain = lc_alloc(ctx, (size_t)n + 1, sizeof *chain);
    bool ok = s.cells && s.slot && s.slot_of && s.dead && chain;
    if (ok) {
        for (uint32_t i = 0; i < n; i++) s.slot[i] = i;
        kd_build(&s);
        run_chain(&s, chain);
    }
    lc_free(ctx, chain, (size_t)n + 1, sizeof *chain);
    lc_free(ctx, s.dead, total, 1);
    lc_free(ctx, s.slot_of, total, sizeof *s.slot_of);
    lc_free(ctx, s.slot, n, sizeof *s.slot);
    lc_free(ctx, s.cells, 2 * (size_t)s.n_leaves, sizeof *s.cells);
    return ok ? LC_OK : LC_ERR_MEMORY;
}

lc_status lc_agglomerate(const lc_context *ctx, const lc_build_input *in, lc_build_pair *pairs)
{
    size_t total = 2 * (size_t)in->n - 1;
    lc_build_node *nodes = lc_alloc(ctx, total, sizeof *nodes);
    if (!nodes) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < in->n; i++) {
        uint32_t light = in->index ? in->index[i] : i;
        nodes[i] = (lc_build_node){ .child = { LC_NONE, LC_NONE }, .light = light, .cos_cone = 1 };
        lc_cluster_from_light(&nodes[i].c, &in->lights[light]);
    }
    lc_status st = lc_agglomerate_nodes(ctx, nodes, in->n, in->c2);
    for (size_t i = in->n; i < total && !st; i++)
        pairs[i - in->n] = (lc_build_pair){ { nodes[i].child[0], nodes[i].child[1] } };
    lc_free(ctx, nodes, total, sizeof *nodes);
    return st;
}
