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

/* A round splits clusters with at least this share of the worst bound. */
#define SHARE (1.0f / 16)
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
    cut->key = lc_alloc(ctx, n, sizeof *cut->key);
    cut->done = keep_done ? lc_alloc(ctx, n, sizeof *cut->done) : NULL;
    if (cut->open && cut->split && cut->left && cut->key && (cut->done || !keep_done)) return LC_OK;
    lc_cut_free(cut);
    return LC_ERR_MEMORY;
}

void lc_cut_free(lc_cut *cut)
{
    size_t n = (size_t)cut->limit + 1;
    lc_free(cut->ctx, cut->open, n, sizeof *cut->open);
    lc_free(cut->ctx, cut->split, n, sizeof *cut->split);
    lc_free(cut->ctx, cut->left, n, sizeof *cut->left);
    lc_free(cut->ctx, cut->key, n, sizeof *cut->key);
    lc_free(cut->ctx, cut->done, n, sizeof *cut->done);
    cut->open = cut->split = cut->left = NULL, cut->key = NULL, cut->done = NULL;
}

static uint32_t cut_size(const lc_cut *c) { return c->n_open + c->n_split + c->n_left + c->n_done; }

/* Adds a cluster with a bound above 0 to those above the limit or to those left. */
static void keep(lc_cut *c, const lc_cut_node *node, double limit)
{
    bool above = (double)node->bound > limit;
    *(above ? &c->open[c->n_open] : &c->left[c->n_left]) = *node;
    c->n_open += above, c->n_left += !above;
    if (!above && node->bound > c->worst_left) c->worst_left = node->bound;
}

/* The limit has fallen: opens what is above it now. */
static void open_left(lc_cut *c, double limit)
{
    uint32_t n = c->n_left;
    c->n_left = 0;
    c->worst_left = 0;
    for (uint32_t i = 0; i < n; i++) keep(c, &c->left[i], limit); /* n_left <= i: writes behind the reading */
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
static void choose(lc_cut *c, double limit, uint32_t room)
{
    float worst = 0, least;
    uint32_t n = c->n_open, n_key = 0, n_take;
    for (uint32_t i = 0; i < n; i++) worst = c->open[i].bound > worst ? c->open[i].bound : worst;
    least = worst < FLT_MAX ? worst * SHARE : FLT_MAX;
    for (uint32_t i = 0; i < n; i++) {
        float b = c->open[i].bound;
        c->key[n_key] = b;
        n_key += (double)b > limit && b >= least;
    }
    n_take = n_key;
    if (n_take > room) { /* near max_cut: half of the room at a time, so that the worst can be split again */
        n_take = (room + 1) / 2;
        if (n_take) least = nth_largest(c->key, n_key, n_take);
    }
    c->n_open = 0;
    for (uint32_t i = 0; i < n; i++) {
        const lc_cut_node *node = &c->open[i];
        if ((double)node->bound > limit && node->bound >= least && n_take) c->split[c->n_split++] = *node, n_take--;
        else keep(c, node, limit);
    }
}

/* What one step works on: parents of one kind and their children, pair by pair. */
typedef struct {
    const lc_cut_node *parent;
    uint32_t n;
    const lc_point *point;
    const float *org;
    uint32_t *rays;
    double limit;
    uint32_t fresh[BATCH];                  /* which child of a pair has a new representative */
    uint32_t light[BATCH];                  /* that representative */
    _Alignas(64) float ub[2 * BATCH];
    _Alignas(64) float f[3][BATCH];         /* M G V of new representatives */
    _Alignas(64) float target[3][BATCH];    /* of their shadow rays */
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
        s->light[i] = s->fresh[i] ? right : left;
        __builtin_prefetch(&t->lights[s->light[i]]);
    }
}

static void bound_children(const lc_cut *c, step *s, uint32_t kind)
{
    uint32_t pair[BATCH];
    for (uint32_t i = 0; i < s->n; i++) pair[i] = s->parent[i].link / LC_BLOCK;
    if (kind != LC_PAIR_MIXED) c->bvh->kernels->bounds(c->tree->blocks, pair, s->n, (lc_light_kind)kind, s->point, s->ub);
    for (uint32_t i = 0; i < s->n && kind == LC_PAIR_MIXED; i++) bounds_of_mixed(c, pair[i], s->point, &s->ub[2 * i]);
}

/* Traces the rays to the new representatives of pairs which[0 .. n) and clears the transfers that are hidden. */
static void trace(const lc_cut *c, step *s, const uint32_t *which, uint32_t n, bool far)
{
    uint8_t hidden[BATCH];
    const float *const target[3] = { s->target[0], s->target[1], s->target[2] };
    if (!n) return;
    c->bvh->kernels->hidden(&c->bvh->data, s->org, n, target, far, hidden);
    *s->rays += n;
    for (uint32_t i = 0; i < n; i++)
        for (int k = 0; k < 3 && hidden[i]; k++) s->f[k][which[i]] = 0;
}

/* M G V of the new representatives of the pairs which[0 .. n), all of one kind: an estimate each and, unless that is 0,
 * a shadow ray. */
static void shade_pairs(const lc_cut *c, step *s, const uint32_t *which, uint32_t n, lc_light_kind kind)
{
    _Alignas(64) float f[6][BATCH];
    float *const out[6] = { f[0], f[1], f[2], f[3], f[4], f[5] };
    uint32_t light[BATCH], lit[BATCH], n_lit = 0;
    for (uint32_t i = 0; i < n; i++) light[i] = s->light[which[i]];
    if (n) c->bvh->kernels->estimate(c->tree->lights, light, n, kind, s->point, out);
    for (uint32_t i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) s->f[k][which[i]] = f[k][i], s->target[k][n_lit] = f[3 + k][i];
        lit[n_lit] = which[i];
        n_lit += f[0][i] > 0 || f[1][i] > 0 || f[2][i] > 0;
    }
    trace(c, s, lit, n_lit, kind == LC_LIGHT_DIRECTIONAL);
}

static void shade_children(const lc_cut *c, step *s, uint32_t kind)
{
    uint32_t which[BATCH], n = 0;
    if (kind != LC_PAIR_MIXED) {
        for (uint32_t i = 0; i < s->n; i++) {
            which[n] = i;
            n += s->ub[2 * i + s->fresh[i]] > 0;
        }
        shade_pairs(c, s, which, n, (lc_light_kind)kind);
        return;
    }
    for (uint32_t i = 0; i < s->n; i++)
        if (s->ub[2 * i + s->fresh[i]] > 0) shade_pairs(c, s, &i, 1, (lc_light_kind)c->tree->lights[s->light[i]].kind);
}

/* Puts a cluster into the cut: to the done ones when nothing about it is left to refine. Returns its luminance. */
static double place(lc_cut *c, lc_cut_node *node, uint32_t parent_kind, double limit)
{
    const lc_light_tree *t = c->tree;
    const lc_node_block *b = &t->blocks[node->id / LC_BLOCK];
    uint32_t lane = node->id % LC_BLOCK;
    for (uint32_t k = 0; k < 3; k++) node->e[k] = node->transfer[k] * b->power[k][lane];
    node->lum = lc_luminance(lc_f3_load(node->e));
    node->link = t->link[node->id];
    if (node->bound > 0 && !(node->link & LC_LEAF)) {
        node->kind = parent_kind == LC_PAIR_MIXED ? t->pair_kind[node->link / 2] : parent_kind;
        keep(c, node, limit);
    } else {
        if (c->keep_done) c->done[c->n_done] = node->id;
        c->n_done++;
        for (int k = 0; k < 3; k++) c->done_sum[k] += (double)node->e[k];
    }
    return (double)node->lum;
}

/* Puts the children into the cut. Returns the change of the total's luminance. */
static double place_children(lc_cut *c, const step *s, uint32_t kind)
{
    double change = 0;
    for (uint32_t i = 0; i < s->n; i++) {
        const lc_cut_node *parent = &s->parent[i];
        change -= (double)parent->lum;
        for (uint32_t k = 0; k < 2; k++) {
            bool fresh = k == s->fresh[i];
            lc_cut_node node = { .bound = s->ub[2 * i + k], .id = parent->link + k };
            node.rep = fresh ? s->light[i] : parent->rep;
            for (int j = 0; j < 3; j++) node.transfer[j] = fresh ? s->f[j][i] : parent->transfer[j];
            if (!(node.bound > 0)) node.transfer[0] = node.transfer[1] = node.transfer[2] = 0;
            change += place(c, &node, kind, s->limit);
        }
    }
    return change;
}

/* Replaces the chosen clusters by their children, runs of one kind at a time. */
static double split_chosen(lc_cut *c, step *s, lc_stats *stats)
{
    double change = 0;
    uint32_t n = c->n_split;
    c->n_split = 0;
    stats->bounds += 2 * n;
    for (uint32_t i = 0; i < n; i += s->n) {
        uint32_t kind = c->split[i].kind;
        for (s->n = 1; s->n < BATCH && i + s->n < n && c->split[i + s->n].kind == kind; s->n++) {}
        s->parent = &c->split[i];
        find_children(c, s);
        bound_children(c, s, kind);
        shade_children(c, s, kind);
        change += place_children(c, s, kind);
    }
    return change;
}

static double place_root(lc_cut *c, step *s, lc_stats *stats)
{
    const lc_light_tree *t = c->tree;
    const uint32_t pair = 0, first = 0;
    bool is_virtual = lc_node_is_virtual(t, 0);
    lc_cut_node root = { .bound = INFINITY, .id = 0, .rep = t->rep[c->slot] };
    if (!is_virtual) {
        c->bvh->kernels->bounds(t->blocks, &pair, 1, (lc_light_kind)t->pair_kind[0], s->point, s->ub);
        root.bound = s->ub[0];
        stats->bounds++;
    }
    if (root.bound > 0) {
        s->light[0] = root.rep;
        shade_pairs(c, s, &first, 1, (lc_light_kind)t->lights[root.rep].kind);
        for (int k = 0; k < 3; k++) root.transfer[k] = s->f[k][0];
    }
    return place(c, &root, is_virtual ? LC_PAIR_MIXED : t->pair_kind[0], 0);
}

/* Fills in the result of a finished cut. */
static void finish(lc_cut *c, lc_stats *stats, lc_cut_result *out)
{
    double sum[3] = { c->done_sum[0], c->done_sum[1], c->done_sum[2] };
    open_left(c, INFINITY); /* worst_left */
    for (uint32_t i = 0; i < c->n_open; i++) keep(c, &c->open[i], INFINITY); /* at max_cut */
    c->n_open = 0;
    for (uint32_t i = 0; i < c->n_left; i++)
        for (int k = 0; k < 3; k++) sum[k] += (double)c->left[i].e[k];
    out->radiance = lc_f3_make((float)sum[0], (float)sum[1], (float)sum[2]);
    out->size = cut_size(c);
    float lum = lc_luminance(out->radiance);
    if (c->worst_left > 0) out->max_error = lum > 0 ? c->worst_left / lum : INFINITY;
    stats->shadow_rays += out->rays;
    stats->cut_sum += out->size;
    stats->at_limit += out->at_limit;
    stats->dark += out->dark;
}

void lc_cut_shade(lc_cut *c, const lc_point *p, const float org[3], uint64_t hash, lc_stats *stats, lc_cut_result *out)
{
    double ratio = (double)c->desc.error_ratio, floor_lum = (double)c->desc.floor;
    step s;
    s.point = p, s.org = org, s.rays = &out->rays;
    *out = (lc_cut_result){ 0 };
    c->n_open = c->n_split = c->n_left = c->n_done = 0;
    c->worst_left = 0;
    c->done_sum[0] = c->done_sum[1] = c->done_sum[2] = 0;
    stats->points++;
    if (!c->tree->n_lights) return;
    c->slot = (uint32_t)(hash % c->tree->n_reps);
    double total = place_root(c, &s, stats);
    for (;;) {
        s.limit = ratio * (total > floor_lum ? total : floor_lum);
        if ((double)c->worst_left > s.limit) open_left(c, s.limit);
        uint32_t room = c->limit - cut_size(c);
        choose(c, s.limit, room);
        if (!c->n_split) break;
        total += split_chosen(c, &s, stats);
    }
    out->at_limit = c->n_open > 0;
    out->dark = !out->at_limit && total < floor_lum && (double)c->worst_left > ratio * total;
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
