/* cut.c - refinement with a fixed-size heap.
 *
 * A split replaces a cluster by its two children. One of them has the parent's representative (slots, light_tree.h):
 * its transfer M G V is taken over, only its power is new. The other costs one estimate and, unless that is 0, one
 * shadow ray. Children whose bound is 0 contribute exactly 0 and leave the heap; so do leaves, which are exact.
 */
#include "cut.h"

#include "bounds.h"
#include "shade.h"

#include <string.h>

lc_status lc_cut_init(lc_cut *cut, const lc_context *ctx, const lc_light_tree *tree, const lc_bvh *bvh,
                      const lc_cut_desc *desc, bool keep_done)
{
    *cut = (lc_cut){ .ctx = ctx, .tree = tree, .bvh = bvh, .desc = *desc, .keep_done = keep_done };
    cut->limit = desc->max_cut && desc->max_cut < tree->n_lights ? desc->max_cut : tree->n_lights;
    cut->heap = lc_alloc(ctx, (size_t)cut->limit + 1, sizeof *cut->heap);
    cut->done = keep_done ? lc_alloc(ctx, (size_t)cut->limit + 1, sizeof *cut->done) : NULL;
    if (cut->heap && (cut->done || !keep_done)) return LC_OK;
    lc_cut_free(cut);
    return LC_ERR_MEMORY;
}

void lc_cut_free(lc_cut *cut)
{
    lc_free(cut->ctx, cut->heap, (size_t)cut->limit + 1, sizeof *cut->heap);
    lc_free(cut->ctx, cut->done, (size_t)cut->limit + 1, sizeof *cut->done);
    cut->heap = NULL;
    cut->done = NULL;
}

/* Heap order: larger bound first, then lower id. */
static bool above(const lc_cut_node *a, const lc_cut_node *b)
{
    return a->bound > b->bound || (a->bound == b->bound && a->id < b->id);
}

static void sift_up(lc_cut_node *heap, uint32_t i, lc_cut_node node)
{
    while (i) {
        uint32_t parent = (i - 1) / 2;
        if (!above(&node, &heap[parent])) break;
        heap[i] = heap[parent];
        i = parent;
    }
    heap[i] = node;
}

static void sift_down(lc_cut_node *heap, uint32_t n, lc_cut_node node)
{
    uint32_t i = 0;
    for (;;) {
        uint32_t c = 2 * i + 1;
        if (c >= n) break;
        if (c + 1 < n && above(&heap[c + 1], &heap[c])) c++;
        if (!above(&heap[c], &node)) break;
        heap[i] = heap[c];
        i = c;
    }
    heap[i] = node;
}

static lc_f3 power_of(const lc_light_tree *t, uint32_t id)
{
    const lc_node_block *b = &t->blocks[id / LC_BLOCK];
    uint32_t k = id % LC_BLOCK;
    return lc_f3_make(b->power[0][k], b->power[1][k], b->power[2][k]);
}

/* Point the shadow ray goes to; far when only its direction counts. */
static bool ray_target(const lc_light_rec *light, const float org[3], float target[3])
{
    bool far = light->kind == LC_LIGHT_DIRECTIONAL;
    for (int k = 0; k < 3; k++) target[k] = far ? org[k] - light->dir[k] : light->pos[k];
    return far;
}

/* M G V of a light; traces a ray only if M G > 0. */
static lc_f3 transfer_of(const lc_light_tree *t, const lc_bvh *bvh, uint32_t light, const lc_point *p,
                         const float org[3], uint32_t *rays)
{
    const lc_light_rec *rec = &t->lights[light];
    lc_f3 f = lc_shade_light(p, rec);
    if (f.x <= 0 && f.y <= 0 && f.z <= 0) return f;
    float target[1][3];
    uint8_t hidden;
    bool far = ray_target(rec, org, target[0]);
    ++*rays;
    bvh->kernels->hidden(&bvh->data, org, 1, (const float(*)[3])target, far, &hidden);
    return hidden ? lc_f3_make(0, 0, 0) : f;
}

static void bounds_of_pair(const lc_cut *c, uint32_t first, const lc_point *p, float ub[2])
{
    const lc_light_tree *t = c->tree;
    float out[LC_BLOCK];
    uint32_t k = first % LC_BLOCK, kind = t->pair_kind[first / 2];
    const lc_node_block *b = &t->blocks[first / LC_BLOCK];
    if (kind != LC_PAIR_MIXED) {
        lc_bounds_block(b, k, 2, (lc_light_kind)kind, p, out);
    } else {
        for (uint32_t i = 0; i < 2; i++) {
            uint32_t rep = t->rep[(size_t)(first + i) * t->n_reps];
            if (lc_node_is_virtual(t, first + i)) out[k + i] = INFINITY;
            else lc_bounds_block(b, k + i, 1, (lc_light_kind)t->lights[rep].kind, p, out);
        }
    }
    ub[0] = out[k], ub[1] = out[k + 1];
}

/* Sends a cluster to the heap, or to the done ones when nothing about it is left to refine. */
static double place(lc_cut *c, lc_cut_node node)
{
    lc_f3 e = lc_f3_mul(lc_f3_load(node.transfer), power_of(c->tree, node.id));
    node.lum = lc_luminance(e);
    if (node.bound > 0) {
        sift_up(c->heap, c->n_heap++, node);
    } else {
        if (c->keep_done) c->done[c->n_done] = node.id;
        c->n_done++;
        c->done_sum[0] += (double)e.x, c->done_sum[1] += (double)e.y, c->done_sum[2] += (double)e.z;
    }
    return (double)node.lum;
}

/* Puts a child into the cut: `from` is the parent if it has the same representative. */
static double place_child(lc_cut *c, uint32_t id, float bound, const lc_cut_node *parent, const lc_point *p,
                          const float org[3], uint32_t *rays)
{
    const lc_light_tree *t = c->tree;
    lc_cut_node node = { .bound = bound, .id = id, .rep = t->rep[(size_t)id * t->n_reps + c->slot] };
    if (bound > 0) {
        if (parent && parent->rep == node.rep) memcpy(node.transfer, parent->transfer, sizeof node.transfer);
        else lc_f3_store(node.transfer, transfer_of(t, c->bvh, node.rep, p, org, rays));
        if (lc_node_is_leaf(t, id)) node.bound = 0;
    }
    return place(c, node);
}

static void place_root(lc_cut *c, const lc_point *p, const float org[3], lc_stats *stats, uint32_t *rays, double *total)
{
    const lc_light_tree *t = c->tree;
    float ub[LC_BLOCK] = { INFINITY };
    if (!lc_node_is_virtual(t, 0)) {
        lc_bounds_block(&t->blocks[0], 0, 1, (lc_light_kind)t->pair_kind[0], p, ub);
        stats->bounds++;
    }
    *total = place_child(c, 0, ub[0], NULL, p, org, rays);
}

static lc_f3 sum_up(const lc_cut *c)
{
    double sum[3] = { c->done_sum[0], c->done_sum[1], c->done_sum[2] };
    for (uint32_t i = 0; i < c->n_heap; i++) {
        lc_f3 e = lc_f3_mul(lc_f3_load(c->heap[i].transfer), power_of(c->tree, c->heap[i].id));
        sum[0] += (double)e.x, sum[1] += (double)e.y, sum[2] += (double)e.z;
    }
    return lc_f3_make((float)sum[0], (float)sum[1], (float)sum[2]);
}

void lc_cut_shade(lc_cut *c, const lc_point *p, const float org[3], uint64_t hash, lc_stats *stats, lc_cut_result *out)
{
    const lc_light_tree *t = c->tree;
    double total = 0, floor_lum = (double)c->desc.floor;
    *out = (lc_cut_result){ 0 };
    c->n_heap = c->n_done = 0;
    c->done_sum[0] = c->done_sum[1] = c->done_sum[2] = 0;
    stats->points++;
    if (!t->n_lights) return;
    c->slot = (uint32_t)(hash % t->n_reps);
    place_root(c, p, org, stats, &out->rays, &total);
    while (c->n_heap) {
        lc_cut_node top = c->heap[0];
        double limit = (double)c->desc.error_ratio * (total > floor_lum ? total : floor_lum);
        if ((double)top.bound <= limit) {
            out->dark = total < floor_lum && (double)top.bound > (double)c->desc.error_ratio * total;
            break;
        }
        if (c->n_heap + c->n_done >= c->limit) {
            out->at_limit = true;
            break;
        }
        sift_down(c->heap, c->n_heap - 1, c->heap[c->n_heap - 1]);
        c->n_heap--;
        uint32_t first = t->link[top.id];
        float ub[2];
        bounds_of_pair(c, first, p, ub);
        stats->bounds += 2;
        total -= (double)top.lum;
        for (uint32_t i = 0; i < 2; i++) total += place_child(c, first + i, ub[i], &top, p, org, &out->rays);
    }
    out->radiance = sum_up(c);
    out->size = c->n_heap + c->n_done;
    float lum = lc_luminance(out->radiance);
    if (c->n_heap) out->max_error = lum > 0 ? c->heap[0].bound / lum : INFINITY;
    stats->shadow_rays += out->rays;
    stats->cut_sum += out->size;
    stats->at_limit += out->at_limit;
    stats->dark += out->dark;
}

#define GROUP 64 /* shadow rays handed to the tracer at once */

/* Lights [first, last), all of one kind of ray. */
typedef struct {
    float target[GROUP][3];
    lc_f3 e[GROUP];
    uint32_t n;
    bool far;
} ray_group;

static void flush(ray_group *g, const lc_bvh *bvh, const float org[3], double sum[3])
{
    uint8_t hidden[GROUP];
    bvh->kernels->hidden(&bvh->data, org, g->n, (const float(*)[3])g->target, g->far, hidden);
    for (uint32_t i = 0; i < g->n; i++)
        if (!hidden[i]) sum[0] += (double)g->e[i].x, sum[1] += (double)g->e[i].y, sum[2] += (double)g->e[i].z;
    g->n = 0;
}

void lc_exact_shade(const lc_light_tree *t, const lc_bvh *bvh, const lc_point *p, const float org[3], lc_stats *stats,
                    lc_cut_result *out)
{
    double sum[3] = { 0, 0, 0 };
    ray_group g = { .n = 0 };
    *out = (lc_cut_result){ .size = t->n_lights };
    for (uint32_t i = 0; i < t->n_lights; i++) {
        const lc_light_rec *rec = &t->lights[i];
        lc_f3 f = lc_shade_light(p, rec);
        if (f.x <= 0 && f.y <= 0 && f.z <= 0) continue;
        bool far = rec->kind == LC_LIGHT_DIRECTIONAL;
        if (g.n == GROUP || (g.n && far != g.far)) flush(&g, bvh, org, sum);
        g.far = ray_target(rec, org, g.target[g.n]);
        g.e[g.n++] = lc_f3_mul(f, lc_f3_load(rec->intensity));
        out->rays++;
    }
    if (g.n) flush(&g, bvh, org, sum);
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
    for (uint32_t i = 0; i < c->n_heap && !wrong; i++) stack[n++] = c->heap[i].id;
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
