/* cut.c - refinement in rounds.
 *
 * The key is the bound U. max(U - estimate, estimate) is rigorous too and lost: on stairs, room and cornell its cuts were
 * 3 to 6 % smaller at 2 %, their rmse 18 to 62 % larger.
 *
 * A split replaces a cluster by its two children. One of them has the parent's representative (slots, light_tree.h):
 * its transfer M G V is taken over, only its power is new. The other costs one estimate and, unless that is 0, one
 * shadow ray. Children whose bound is 0 contribute exactly 0 and are done; so are leaves, which are exact.
 */
#include "cut.h"

#include "shade.h"

#include <string.h>

#define BATCH 64 /* parents whose children are bounded, and lights estimated and traced, at a time */

lc_status lc_cut_init(lc_cut *cut, const lc_context *ctx, const lc_light_tree *tree, const lc_bvh *bvh,
                      const lc_cut_desc *desc, bool keep_done)
{
    memset(cut, 0, sizeof *cut);
    cut->ctx = ctx, cut->tree = tree, cut->bvh = bvh, cut->desc = *desc, cut->keep_done = keep_done;
    cut->limit = desc->max_cut && desc->max_cut < tree->n_lights ? desc->max_cut : tree->n_lights;
    size_t n = (size_t)cut->limit + 1;
    cut->open = lc_alloc(ctx, n, sizeof *cut->open);
    cut->split = lc_alloc(ctx, n, sizeof *cut->split);
    cut->left = lc_alloc(ctx, n, sizeof *cut->left);
    cut->leaf = lc_alloc(ctx, n, sizeof *cut->leaf);
    cut->key = lc_alloc(ctx, n, sizeof *cut->key);
    cut->done = keep_done ? lc_alloc(ctx, n, sizeof *cut->done) : NULL;
    if (cut->open && cut->split && cut->left && cut->leaf && cut->key && (cut->done || !keep_done)) return LC_OK;
    lc_cut_free(cut);
    return LC_ERR_MEMORY;
}

void lc_cut_free(lc_cut *cut)
{
    size_t n = (size_t)cut->limit + 1;
    lc_free(cut->ctx, cut->open, n, sizeof *cut->open);
    lc_free(cut->ctx, cut->split, n, sizeof *cut->split);
    lc_free(cut->ctx, cut->left, n, sizeof *cut->left);
    lc_free(cut->ctx, cut->leaf, n, sizeof *cut->leaf);
    lc_free(cut->ctx, cut->key, n, sizeof *cut->key);
    lc_free(cut->ctx, cut->done, n, sizeof *cut->done);
    cut->open = cut->split = cut->left = cut->leaf = NULL, cut->key = NULL, cut->done = NULL;
}

static uint32_t cut_size(const lc_cut *c) { return c->n_open + c->n_split + c->n_left + c->n_done; }

/* The limit has fallen: opens what is above it now. */
static void open_left(lc_cut *c, float limit)
{
    uint32_t n = c->n_left;
    c->n_left = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (c->left[i].bound > limit) c->open[c->n_open++] = c->left[i];
        else if (c->n_left++ != i) c->left[c->n_left - 1] = c->left[i];
    }
}

static float worst_of(const lc_cut_node *node, uint32_t n)
{
    float worst = 0;
    for (uint32_t i = 0; i < n; i++) worst = node[i].bound > worst ? node[i].bound : worst;
    return worst;
}

/* The n-th largest of key[0 .. count), n >= 1; reorders them. */
static float nth_largest(float *key, uint32_t count, uint32_t n)
{
    uint32_t lo = 0, hi = count - 1, want = n - 1;
    while (lo < hi) {
        float pivot = key[lo + (hi - lo) / 2];
        uint32_t i = lo, j = hi;
        for (;;) {
            while (key[i] > pivot) i++;
            while (key[j] < pivot) j--;
            if (i >= j) break;
            float t = key[i];
            key[i++] = key[j], key[j--] = t;
        }
        if (want <= j) hi = j;
        else lo = j + 1;
    }
    return key[want];
}

/* Moves the clusters that the next round splits from open to split, at most `room` of them, and those within the limit
 * to left. */
static void choose(lc_cut *c, float limit, uint32_t room)
{
    lc_cut_node *node = c->open;
    uint32_t n = c->n_open, n_above = 0;
    float least = 0;
    c->open = c->split, c->split = node;
    c->n_open = 0, c->n_split = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (!(node[i].bound > limit)) c->left[c->n_left++] = node[i];
        else if (n_above++ != i) node[n_above - 1] = node[i];
    }
    uint32_t n_take = n_above <= room ? n_above : (room + 1) / 2; /* half at a time: the worst may have to go on */
    if (n_take < n_above) {
        for (uint32_t i = 0; i < n_above; i++) c->key[i] = node[i].bound;
        least = n_take ? nth_largest(c->key, n_above, n_take) : INFINITY;
    }
    for (uint32_t i = 0; i < n_above; i++) {
        bool take = n_take == n_above || (c->n_split < n_take && node[i].bound >= least);
        if (!take) c->open[c->n_open++] = node[i];
        else if (c->n_split++ != i) node[c->n_split - 1] = node[i];
    }
}

/* What one step works on: some parents and their children, pair by pair, runs of one kind after each other. */
typedef struct {
    const lc_cut_node *parent;
    uint32_t n;
    const lc_point *point;
    float limit;
    uint32_t fresh[BATCH];   /* which child of a pair has a new representative */
    lc_cut_node new[BATCH];  /* of that child: rep, kind, transfer and pending */
    _Alignas(64) float ub[2 * BATCH + LC_LANES];
} step;

/* Bounds of both nodes of the pair below a virtual node, where each has its own kind. */
static void bounds_of_mixed(const lc_cut *c, uint32_t pair, const lc_point *p, float ub[2])
{
    const lc_light_tree *t = c->tree;
    _Alignas(64) float both[LC_LANES];
    for (uint32_t i = 0; i < 2; i++) {
        uint32_t id = 2 * pair + i, rep = t->rep[(size_t)id * t->n_reps];
        if (!lc_node_is_virtual(t, id))
            c->bvh->kernels->bounds(t->blocks, &pair, 1, (lc_light_kind)t->lights[rep].kind, p, both);
        ub[i] = lc_node_is_virtual(t, id) ? INFINITY : both[i];
    }
}

/* Finds the children and their new representatives, and asks the memory for what the next steps read. */
static void find_children(const lc_cut *c, step *s)
{
    const lc_light_tree *t = c->tree;
    for (uint32_t i = 0; i < s->n; i++) {
        uint32_t first = s->parent[i].link;
        __builtin_prefetch(&t->blocks[first / LC_BLOCK]);
        __builtin_prefetch(&t->blocks[first / LC_BLOCK].axis);
        __builtin_prefetch(&t->rep[(size_t)first * t->n_reps + c->slot]);
        __builtin_prefetch(&t->link[first]);
    }
    for (uint32_t i = 0; i < s->n; i++) {
        size_t first = s->parent[i].link;
        uint32_t left = t->rep[first * t->n_reps + c->slot], right = t->rep[(first + 1) * t->n_reps + c->slot];
        s->fresh[i] = left == s->parent[i].rep;
        s->new[i].rep = s->fresh[i] ? right : left;
        s->new[i].kind = s->parent[i].kind;
        __builtin_prefetch(&t->lights[s->new[i].rep]);
    }
}

/* Bounds of the children of parents [first, first + n), all of one kind. */
static void bound_children(const lc_cut *c, step *s, uint32_t first, uint32_t n, uint32_t kind)
{
    uint32_t pair[BATCH];
    _Alignas(64) float ub[2 * BATCH];
    for (uint32_t i = 0; i < n; i++) pair[i] = s->parent[first + i].link / LC_BLOCK;
    if (kind != LC_PAIR_MIXED) c->bvh->kernels->bounds(c->tree->blocks, pair, n, (lc_light_kind)kind, s->point, ub);
    else for (uint32_t i = 0; i < n; i++) bounds_of_mixed(c, pair[i], s->point, &ub[2 * i]);
    memcpy(s->ub + 2 * first, ub, 2 * n * sizeof *ub);
}

/* M G of the new representatives of pairs which[0 .. n), all of one kind. */
static void estimate(const lc_cut *c, step *s, const uint32_t *which, uint32_t n, lc_light_kind kind)
{
    _Alignas(64) float f[6][BATCH];
    float *const out[6] = { f[0], f[1], f[2], f[3], f[4], f[5] };
    uint32_t light[BATCH];
    for (uint32_t i = 0; i < n; i++) light[i] = s->new[which[i]].rep;
    if (n) c->bvh->kernels->estimate(c->tree->lights, light, n, kind, s->point, out);
    for (uint32_t i = 0; i < n; i++) {
        bool lit = f[0][i] > 0 || f[1][i] > 0 || f[2][i] > 0;
        for (int k = 0; k < 3; k++) s->new[which[i]].transfer[k] = f[k][i];
        s->new[which[i]].pending = lit ? 1 + (kind == LC_LIGHT_DIRECTIONAL) : 0;
    }
}

static void estimate_children(const lc_cut *c, step *s, uint32_t first, uint32_t n, uint32_t kind)
{
    uint32_t which[BATCH], m = 0;
    for (uint32_t i = first; i < first + n; i++) {
        which[m] = i;
        m += s->ub[2 * i + s->fresh[i]] > 0;
    }
    if (kind != LC_PAIR_MIXED) estimate(c, s, which, m, (lc_light_kind)kind);
    else for (uint32_t i = 0; i < m; i++) estimate(c, s, &which[i], 1, (lc_light_kind)c->tree->lights[s->new[which[i]].rep].kind);
}

/* Where the next cluster of each sort goes. */
typedef struct {
    lc_cut_node *open, *left, *leaf;
} ends;

static inline ends ends_of(const lc_cut *c)
{
    return (ends){ c->open + c->n_open, c->left + c->n_left, c->leaf + c->n_leaf };
}

/* Puts a cluster into the cut: in place, as copies of half-written nodes stall, and without a branch on which list it goes
 * to, as nobody could predict that. Returns its luminance. */
static inline double place(lc_cut *c, ends *end, const lc_cut_node *from, uint32_t id, float bound, float limit)
{
    static const float zero[3] = { 0, 0, 0 };
    const lc_light_tree *t = c->tree;
    const lc_node_block *b = &t->blocks[id / LC_BLOCK];
    uint32_t lane = id % LC_BLOCK, link = t->link[id];
    bool some = bound > 0, inner = some & !(link >> 31), above = inner & (bound > limit);
    const float *f = some ? from->transfer : zero;
    lc_cut_node *node = above ? end->open : inner ? end->left : some ? end->leaf : &c->none;
    end->open += above, end->left += inner & !above, end->leaf += some & !inner;
    if (!inner) {
        if (c->keep_done) c->done[c->n_done] = id;
        c->n_done++;
    }
    node->bound = bound, node->id = id, node->link = link;
    node->rep = from->rep, node->kind = from->kind, node->pending = from->pending;
    for (uint32_t k = 0; k < 3; k++) {
        node->transfer[k] = f[k];
        node->e[k] = f[k] * b->power[k][lane];
    }
    node->lum = lc_luminance(lc_f3_load(node->e));
    if (from->kind == LC_PAIR_MIXED && inner) node->kind = t->pair_kind[link / 2];
    return (double)node->lum;
}

static void set_ends(lc_cut *c, const ends *end)
{
    c->n_open = (uint32_t)(end->open - c->open);
    c->n_left = (uint32_t)(end->left - c->left);
    c->n_leaf = (uint32_t)(end->leaf - c->leaf);
}

static double place_children(lc_cut *c, const step *s)
{
    double change = 0;
    ends end = ends_of(c);
    for (uint32_t i = 0; i < s->n; i++) {
        const lc_cut_node *parent = &s->parent[i], *new = &s->new[i];
        double left = place(c, &end, s->fresh[i] ? parent : new, parent->link, s->ub[2 * i], s->limit);
        double right = place(c, &end, s->fresh[i] ? new : parent, parent->link + 1, s->ub[2 * i + 1], s->limit);
        change += left + right - (double)parent->lum;
    }
    set_ends(c, &end);
    return change;
}

/* Replaces the chosen clusters by their children. Returns the change of the total's luminance. */
static double split_chosen(lc_cut *c, step *s, lc_stats *stats)
{
    double change = 0;
    uint32_t n = c->n_split;
    c->n_split = 0;
    stats->bounds += 2 * n;
    for (uint32_t at = 0; at < n; at += s->n) {
        s->parent = &c->split[at];
        s->n = n - at < BATCH ? n - at : BATCH;
        find_children(c, s);
        for (uint32_t i = 0, run; i < s->n; i += run) {
            uint32_t kind = s->parent[i].kind;
            for (run = 1; i + run < s->n && s->parent[i + run].kind == kind; run++) {}
            bound_children(c, s, i, run, kind);
            estimate_children(c, s, i, run, kind);
        }
        change += place_children(c, s);
    }
    return change;
}

static double place_root(lc_cut *c, step *s, lc_stats *stats)
{
    const lc_light_tree *t = c->tree;
    const uint32_t pair = 0, first = 0;
    bool is_virtual = lc_node_is_virtual(t, 0);
    s->new[0] = (lc_cut_node){ .rep = t->rep[c->slot], .kind = is_virtual ? LC_PAIR_MIXED : t->pair_kind[0] };
    s->ub[0] = INFINITY;
    if (!is_virtual) {
        c->bvh->kernels->bounds(t->blocks, &pair, 1, (lc_light_kind)t->pair_kind[0], s->point, s->ub);
        stats->bounds++;
    }
    if (s->ub[0] > 0) estimate(c, s, &first, 1, (lc_light_kind)t->lights[s->new[0].rep].kind);
    ends end = ends_of(c);
    double lum = place(c, &end, &s->new[0], 0, s->ub[0], 0);
    set_ends(c, &end);
    return lum;
}

/* Shadow rays of one point on their way to the tracer: near targets and far ones apart. */
typedef struct {
    lc_cut_node *node[2][BATCH];
    float target[2][3][BATCH];
    uint32_t n[2];
    const float *org;
    double change; /* of the total's luminance */
} ray_group;

static void trace(const lc_cut *c, ray_group *g, uint32_t far)
{
    uint8_t hidden[BATCH];
    const float *const target[3] = { g->target[far][0], g->target[far][1], g->target[far][2] };
    if (!g->n[far]) return;
    c->bvh->kernels->hidden(&c->bvh->data, g->org, g->n[far], target, far, hidden);
    for (uint32_t i = 0; i < g->n[far]; i++) {
        lc_cut_node *node = g->node[far][i];
        node->pending = 0;
        if (!hidden[i]) continue;
        g->change -= (double)node->lum;
        node->lum = 0;
        for (int k = 0; k < 3; k++) node->transfer[k] = node->e[k] = 0;
    }
    g->n[far] = 0;
}

/* Traces what is pending among some clusters. Returns the number of rays. */
static uint32_t trace_nodes(const lc_cut *c, ray_group *g, lc_cut_node *node, uint32_t n)
{
    uint32_t n_rays = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (!node[i].pending) continue;
        uint32_t far = node[i].pending - 1u, m = g->n[far]++;
        const lc_light_rec *light = &c->tree->lights[node[i].rep];
        for (int k = 0; k < 3; k++) g->target[far][k][m] = far ? -light->dir[k] : light->pos[k];
        g->node[far][m] = &node[i];
        n_rays++;
        if (m + 1 == BATCH) trace(c, g, far);
    }
    return n_rays;
}

/* Traces all rays that are pending; leaves then are done. Returns the change of the total's luminance. */
static double trace_pending(lc_cut *c, const float org[3], uint32_t *n_rays)
{
    ray_group g;
    g.n[0] = g.n[1] = 0, g.org = org, g.change = 0;
    *n_rays += trace_nodes(c, &g, c->open, c->n_open);
    *n_rays += trace_nodes(c, &g, c->left, c->n_left);
    *n_rays += trace_nodes(c, &g, c->leaf, c->n_leaf);
    trace(c, &g, 0);
    trace(c, &g, 1);
    for (uint32_t i = 0; i < c->n_leaf; i++)
        for (int k = 0; k < 3; k++) c->done_sum[k] += (double)c->leaf[i].e[k];
    c->n_leaf = 0;
    return g.change;
}

/* Fills in the result of a finished cut. */
static void finish(lc_cut *c, lc_stats *stats, lc_cut_result *out)
{
    double sum[3] = { c->done_sum[0], c->done_sum[1], c->done_sum[2] };
    for (uint32_t i = 0; i < c->n_open; i++) c->left[c->n_left++] = c->open[i]; /* at max_cut */
    c->n_open = 0;
    for (uint32_t i = 0; i < c->n_left; i++)
        for (int k = 0; k < 3; k++) sum[k] += (double)c->left[i].e[k];
    out->radiance = lc_f3_make((float)sum[0], (float)sum[1], (float)sum[2]);
    out->size = cut_size(c);
    float lum = lc_luminance(out->radiance), worst = worst_of(c->left, c->n_left);
    if (worst > 0) out->max_error = lum > 0 ? worst / lum : INFINITY;
    stats->shadow_rays += out->rays;
    stats->cut_sum += out->size;
    stats->at_limit += out->at_limit;
    stats->dark += out->dark;
}

/* Largest float that is at most x. */
static float round_down(double x)
{
    float f = (float)x;
    return (double)f > x ? nextafterf(f, 0) : f;
}

/* Splits until no bound is above the limit, all shadow rays that are pending taken as not hidden: the total then is no
 * less than it will be and the limit no lower. So nothing is split that need not be, and the rays go out in large
 * groups. Then those rays lower the total, and what is above the new limit is split in turn. */
void lc_cut_shade(lc_cut *c, const lc_point *p, const float org[3], uint64_t hash, lc_stats *stats, lc_cut_result *out)
{
    double ratio = (double)c->desc.error_ratio, floor_lum = (double)c->desc.floor;
    step s;
    s.point = p;
    *out = (lc_cut_result){ 0 };
    c->n_open = c->n_split = c->n_left = c->n_leaf = c->n_done = 0;
    c->done_sum[0] = c->done_sum[1] = c->done_sum[2] = 0;
    stats->points++;
    if (!c->tree->n_lights) return;
    c->slot = (uint32_t)(hash % c->tree->n_reps);
    double total = place_root(c, &s, stats);
    for (bool traced = false;;) {
        s.limit = round_down(ratio * (total > floor_lum ? total : floor_lum));
        if (traced) open_left(c, s.limit);
        choose(c, s.limit, c->limit - cut_size(c));
        if (c->n_split) {
            total += split_chosen(c, &s, stats);
            traced = false;
        } else {
            if (traced) break;
            total += trace_pending(c, org, &out->rays);
            traced = true;
        }
    }
    out->at_limit = c->n_open > 0;
    out->dark = !out->at_limit && total < floor_lum && (double)worst_of(c->left, c->n_left) > ratio * total;
    finish(c, stats, out);
}

/* Every light of tree->lights[first .. first + n), all of one kind, n <= BATCH. */
static uint32_t shade_exactly(const lc_light_tree *t, const lc_bvh *bvh, const lc_point *p, const float org[3], uint32_t first,
                              uint32_t n, double sum[3])
{
    const lc_light_kind kind = (lc_light_kind)t->lights[first].kind;
    _Alignas(64) float f[6][BATCH];
    float *const out[6] = { f[0], f[1], f[2], f[3], f[4], f[5] };
    const float *const target[3] = { f[3], f[4], f[5] };
    uint8_t hidden[BATCH];
    uint32_t lit[BATCH], m = 0;
    bvh->kernels->estimate(t->lights + first, NULL, n, kind, p, out);
    for (uint32_t i = 0; i < n; i++) { /* m <= i: writes behind the reading */
        for (int k = 0; k < 6; k++) f[k][m] = f[k][i];
        lit[m] = first + i;
        m += f[0][i] > 0 || f[1][i] > 0 || f[2][i] > 0;
    }
    if (m) bvh->kernels->hidden(&bvh->data, org, m, target, kind == LC_LIGHT_DIRECTIONAL, hidden);
    for (uint32_t i = 0; i < m; i++)
        for (int k = 0; k < 3 && !hidden[i]; k++) sum[k] += (double)(f[k][i] * t->lights[lit[i]].intensity[k]);
    return m;
}

void lc_exact_shade(const lc_light_tree *t, const lc_bvh *bvh, const lc_point *p, const float org[3], lc_stats *stats,
                    lc_cut_result *out)
{
    double sum[3] = { 0, 0, 0 };
    *out = (lc_cut_result){ .size = t->n_lights };
    for (uint32_t first = 0, n; first < t->n_lights; first += n) {
        for (n = 1; n < BATCH && first + n < t->n_lights && t->lights[first + n].kind == t->lights[first].kind; n++) {}
        out->rays += shade_exactly(t, bvh, p, org, first, n, sum);
    }
    out->radiance = lc_f3_make((float)sum[0], (float)sum[1], (float)sum[2]);
    stats->points++;
    stats->shadow_rays += out->rays;
    stats->cut_sum += out->size;
}

const char *lc_cut_validate(const lc_cut *c)
{
    const lc_light_tree *t = c->tree;
    const char *wrong = NULL;
    uint8_t *seen = lc_alloc(c->ctx, t->n_lights, 1);
    uint32_t *stack = lc_alloc(c->ctx, 2 * t->n_pairs, sizeof *stack), n = 0;
    if (!seen || !stack) wrong = "out of memory";
    for (uint32_t i = 0; i < c->n_left && !wrong; i++) stack[n++] = c->left[i].id;
    for (uint32_t i = 0; i < c->n_done && !wrong; i++) stack[n++] = c->done[i];
    while (n && !wrong) {
        uint32_t id = stack[--n];
        if (!lc_node_is_leaf(t, id)) {
            if (n + 2 > 2 * t->n_pairs) {
                wrong = "a node is in the cut twice";
            } else {
                stack[n++] = t->link[id];
                stack[n++] = t->link[id] + 1;
            }
        } else if (seen[t->link[id] & ~LC_LEAF]++) {
            wrong = "a light is under two nodes of the cut";
        }
    }
    for (uint32_t i = 0; i < t->n_lights && !wrong; i++)
        if (!seen[i]) wrong = "a light is under no node of the cut";
    lc_free(c->ctx, stack, 2 * t->n_pairs, sizeof *stack);
    lc_free(c->ctx, seen, t->n_lights, 1);
    return wrong;
}
