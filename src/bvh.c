/* bvh.c - build: binary tree by binned surface area heuristic (Wald 2007), then collapsed to eight-wide nodes by
 * opening the child of largest area. No recursion; depth is bounded by halving once MAX_SAH_DEPTH is passed.
 *
 *     triangles -> refs (box, centroid) -> binary nodes -> lc_bvh_node[8] and lc_tri_block[8]
 *
 * Serial, so the same for any number of threads.
 */
#include "bvh.h"

#include <string.h>

#define N_BINS 16
#define LEAF_MAX 8
#define MAX_SAH_DEPTH 60      /* then halving: 30 more levels hold 2^30 triangles */
#define SPLIT_COST 0.25f /* of a binary node against one block of eight triangles; 0.5 and 1 were no faster */
_Static_assert(MAX_SAH_DEPTH + 31 < LC_BVH_MAX_DEPTH, "traversal stack");

typedef struct {
    lc_box box;
    uint32_t tri;
} tri_ref;

typedef struct {
    lc_box box;
    uint32_t left;         /* children left, left + 1; 0 = leaf */
    uint32_t first, count; /* refs */
} bin_node;

typedef struct {
    uint32_t node, depth;
} task;

typedef struct {
    const lc_context *ctx;
    tri_ref *refs;
    size_t n_refs;
    bin_node *nodes;
    size_t n_nodes, cap_nodes;
    task *tasks;
    size_t n_tasks, cap_tasks;
} builder;

static float area(const lc_box *b)
{
    float x = b->hi.x - b->lo.x, y = b->hi.y - b->lo.y, z = b->hi.z - b->lo.z;
    return x >= 0 ? x * y + y * z + z * x : 0;
}

static float axis_of(lc_f3 a, int k) { return k == 0 ? a.x : k == 1 ? a.y : a.z; }

/* Twice the centroid. */
static float center2(const lc_box *b, int k) { return axis_of(b->lo, k) + axis_of(b->hi, k); }

static float blocks_of(uint32_t n) { return (float)((n + LEAF_MAX - 1) / LEAF_MAX); }

typedef struct {
    int axis, bin; /* axis -1: none */
    float cost;
} split;

static uint32_t bin_of(float c, float lo, float scale)
{
    float b = (c - lo) * scale;
    return b >= N_BINS - 1 ? N_BINS - 1 : b > 0 ? (uint32_t)b : 0;
}

static void best_on_axis(const builder *b, const bin_node *node, int axis, float lo, float scale, split *best)
{
    lc_box box[N_BINS], right[N_BINS], acc = lc_box_empty();
    uint32_t count[N_BINS] = { 0 }, n_right[N_BINS], n = 0;
    for (int i = 0; i < N_BINS; i++) box[i] = lc_box_empty();
    for (uint32_t i = node->first; i < node->first + node->count; i++) {
        uint32_t k = bin_of(center2(&b->refs[i].box, axis), lo, scale);
        lc_box_join(&box[k], &b->refs[i].box);
        count[k]++;
    }
    for (int i = N_BINS - 1; i > 0; i--) {
        if (count[i]) lc_box_join(&acc, &box[i]);
        right[i] = acc;
        n_right[i] = n += count[i];
    }
    acc = lc_box_empty();
    n = 0;
    for (int i = 1; i < N_BINS; i++) {
        if (count[i - 1]) lc_box_join(&acc, &box[i - 1]);
        n += count[i - 1];
        if (!n || !n_right[i]) continue;
        float cost = area(&acc) * blocks_of(n) + area(&right[i]) * blocks_of(n_right[i]);
        /* Nearly full blocks being equal, prefer even halves: the count breaks the steps of blocks_of. */
        cost += 0.02f * (area(&acc) * (float)n + area(&right[i]) * (float)n_right[i]) / LEAF_MAX;
        if (best->axis < 0 || cost < best->cost) *best = (split){ axis, i, cost };
    }
}

/* Moves the refs left of the split to the front; returns how many. */
static uint32_t partition(builder *b, const bin_node *node, const split *s, float lo, float scale)
{
    uint32_t i = node->first, j = node->first + node->count;
    while (i < j) {
        if (bin_of(center2(&b->refs[i].box, s->axis), lo, scale) < (uint32_t)s->bin) {
            i++;
        } else {
            tri_ref t = b->refs[--j];
            b->refs[j] = b->refs[i];
            b->refs[i] = t;
        }
    }
    return i - node->first;
}

/* Number of refs that go left; 0 = make a leaf. */
static uint32_t choose_split(builder *b, const bin_node *node, uint32_t depth)
{
    if (depth < MAX_SAH_DEPTH && node->count > 1) {
        float lo[3], scale[3];
        split best = { -1, 0, 0 };
        for (int k = 0; k < 3; k++) {
            float hi = -FLT_MAX;
            lo[k] = FLT_MAX;
            for (uint32_t i = node->first; i < node->first + node->count; i++) {
                float c = center2(&b->refs[i].box, k);
                lo[k] = c < lo[k] ? c : lo[k];
                hi = c > hi ? c : hi;
            }
            scale[k] = N_BINS / (hi - lo[k]);
            if (hi > lo[k] && isfinite(scale[k])) best_on_axis(b, node, k, lo[k], scale[k], &best);
        }
        float leaf_cost = area(&node->box) * (1 - SPLIT_COST);
        if (best.axis >= 0 && (node->count > LEAF_MAX || best.cost < leaf_cost))
            return partition(b, node, &best, lo[best.axis], scale[best.axis]);
    }
    return node->count > LEAF_MAX ? node->count / 2 : 0;
}

static lc_box box_of_refs(const builder *b, uint32_t first, uint32_t count)
{
    lc_box box = lc_box_empty();
    for (uint32_t i = first; i < first + count; i++) lc_box_join(&box, &b->refs[i].box);
    return box;
}

static lc_status build_binary(builder *b)
{
    lc_status st = lc_grow(b->ctx, (void **)&b->nodes, &b->cap_nodes, 1, sizeof *b->nodes);
    if (!st) st = lc_grow(b->ctx, (void **)&b->tasks, &b->cap_tasks, 1, sizeof *b->tasks);
    if (st) return st;
    b->nodes[b->n_nodes++] = (bin_node){ box_of_refs(b, 0, (uint32_t)b->n_refs), 0, 0, (uint32_t)b->n_refs };
    b->tasks[b->n_tasks++] = (task){ 0, 0 };
    while (b->n_tasks) {
        task t = b->tasks[--b->n_tasks];
        uint32_t n_left = choose_split(b, &b->nodes[t.node], t.depth);
        if (!n_left) continue;
        st = lc_grow(b->ctx, (void **)&b->nodes, &b->cap_nodes, b->n_nodes + 2, sizeof *b->nodes);
        if (!st) st = lc_grow(b->ctx, (void **)&b->tasks, &b->cap_tasks, b->n_tasks + 2, sizeof *b->tasks);
        if (st) return st;
        uint32_t left = (uint32_t)b->n_nodes, first = b->nodes[t.node].first, count = b->nodes[t.node].count;
        b->nodes[t.node].left = left;
        b->nodes[left] = (bin_node){ box_of_refs(b, first, n_left), 0, first, n_left };
        b->nodes[left + 1] = (bin_node){ box_of_refs(b, first + n_left, count - n_left), 0, first + n_left,
                                         count - n_left };
        b->n_nodes += 2;
        b->tasks[b->n_tasks++] = (task){ left, t.depth + 1 };
        b->tasks[b->n_tasks++] = (task){ left + 1, t.depth + 1 };
    }
    return LC_OK;
}

/* Up to eight descendants of a binary node, opening the largest first. */
static uint32_t gather_children(const builder *b, uint32_t node, uint32_t out[8])
{
    uint32_t n = 0;
    if (!b->nodes[node].left) {
        out[n++] = node;
        return n;
    }
    out[n++] = b->nodes[node].left;
    out[n++] = b->nodes[node].left + 1;
    while (n < 8) {
        uint32_t best = LC_NONE;
        for (uint32_t i = 0; i < n; i++)
            if (b->nodes[out[i]].left
                && (best == LC_NONE || area(&b->nodes[out[i]].box) > area(&b->nodes[out[best]].box)))
                best = i;
        if (best == LC_NONE) break;
        uint32_t left = b->nodes[out[best]].left;
        out[best] = left;
        out[n++] = left + 1;
    }
    return n;
}

static void fill_block(const builder *b, const bin_node *leaf, const float *pos, const uint32_t *index, lc_tri_block *blk)
{
    for (float *f = &blk->v[0][0][0]; f < &blk->v[0][0][0] + 72; f++) *f = NAN; /* empty lanes fail every comparison */
    for (uint32_t i = 0; i < 8; i++) blk->tri[i] = LC_NONE;
    for (uint32_t i = 0; i < leaf->count; i++) {
        uint32_t tri = b->refs[leaf->first + i].tri;
        blk->tri[i] = tri;
        for (size_t v = 0; v < 3; v++)
            for (size_t k = 0; k < 3; k++) blk->v[v][k][i] = lc_tri_vertex(pos, index, tri, v)[k];
    }
}

static void set_child_box(lc_bvh_node *node, uint32_t i, const lc_box *box, const float pad[3])
{
    node->lo[0][i] = box->lo.x - pad[0], node->lo[1][i] = box->lo.y - pad[1], node->lo[2][i] = box->lo.z - pad[2];
    node->hi[0][i] = box->hi.x + pad[0], node->hi[1][i] = box->hi.y + pad[1], node->hi[2][i] = box->hi.z + pad[2];
}

/* b->tasks[i].node is the binary node that wide node i stands for. */
static lc_status collapse(builder *b, lc_bvh *bvh, const float *pos, const uint32_t *index)
{
    size_t n_blocks = 0, n_wide = 1;
    lc_box all = b->nodes[0].box;
    /* 2^-20 of the largest coordinate: the shear of the triangle test rounds a vertex by at most 3 ulp of its distance
     * from the origin, 6 * 2^-24 of twice that coordinate while the ray starts inside the scene. */
    float pad[3];
    for (int k = 0; k < 3; k++) pad[k] = 0x1p-20f * fmaxf(lc_f3_max_abs(all.lo), lc_f3_max_abs(all.hi));
    b->tasks[0] = (task){ 0, 0 };
    for (size_t w = 0; w < n_wide; w++) {
        uint32_t child[8], n = gather_children(b, b->tasks[w].node, child);
        lc_status st = lc_grow(b->ctx, (void **)&bvh->nodes, &bvh->cap_nodes, w + 1, sizeof *bvh->nodes);
        if (!st) st = lc_grow(b->ctx, (void **)&bvh->blocks, &bvh->cap_blocks, n_blocks + 8, sizeof *bvh->blocks);
        if (!st) st = lc_grow(b->ctx, (void **)&b->tasks, &b->cap_tasks, n_wide + 8, sizeof *b->tasks);
        if (st) return st;
        lc_bvh_node *node = &bvh->nodes[w];
        lc_box none = lc_box_empty();
        const float no_pad[3] = { 0, 0, 0 };
        for (uint32_t i = 0; i < 8; i++) {
            if (i >= n) {
                set_child_box(node, i, &none, no_pad);
                node->child[i] = LC_NONE;
                continue;
            }
            const bin_node *c = &b->nodes[child[i]];
            set_child_box(node, i, &c->box, pad);
            if (c->left) {
                node->child[i] = (uint32_t)n_wide;
                b->tasks[n_wide++] = (task){ child[i], 0 };
            } else {
                node->child[i] = LC_BVH_LEAF | (uint32_t)n_blocks;
                fill_block(b, c, pos, index, &bvh->blocks[n_blocks++]);
            }
        }
    }
    bvh->data = (lc_bvh_data){ bvh->nodes, bvh->blocks, (uint32_t)n_wide, (uint32_t)n_blocks };
    return LC_OK;
}

static lc_status make_refs(builder *b, const float *pos, const uint32_t *index, size_t n_tris)
{
    b->refs = lc_alloc(b->ctx, n_tris, sizeof *b->refs);
    if (!b->refs) return LC_ERR_MEMORY;
    b->n_refs = n_tris;
    for (size_t t = 0; t < n_tris; t++) {
        lc_box box = lc_box_empty();
        for (size_t v = 0; v < 3; v++) lc_box_add(&box, lc_f3_load(lc_tri_vertex(pos, index, t, v)));
        b->refs[t] = (tri_ref){ box, (uint32_t)t };
    }
    return LC_OK;
}

lc_status lc_bvh_build(const lc_context *ctx, const float *pos, const uint32_t *index, size_t n_tris, lc_bvh **out)
{
    *out = NULL;
    lc_bvh *bvh = lc_alloc(ctx, 1, sizeof *bvh);
    if (!bvh) return LC_ERR_MEMORY;
    bvh->ctx = ctx;
    bvh->kernels = lc_kernels_get(ctx->isa);
    builder b = { .ctx = ctx };
    lc_status st = LC_OK;
    if (n_tris) {
        st = make_refs(&b, pos, index, n_tris);
        if (!st) st = build_binary(&b);
        if (!st) st = collapse(&b, bvh, pos, index);
    }
    lc_free(ctx, b.refs, b.n_refs, sizeof *b.refs);
    lc_free(ctx, b.nodes, b.cap_nodes, sizeof *b.nodes);
    lc_free(ctx, b.tasks, b.cap_tasks, sizeof *b.tasks);
    if (st) {
        lc_bvh_destroy(bvh);
        return st;
    }
    *out = bvh;
    return LC_OK;
}

void lc_bvh_destroy(lc_bvh *bvh)
{
    if (!bvh) return;
    const lc_context *ctx = bvh->ctx;
    lc_free(ctx, bvh->nodes, bvh->cap_nodes, sizeof *bvh->nodes);
    lc_free(ctx, bvh->blocks, bvh->cap_blocks, sizeof *bvh->blocks);
    lc_free(ctx, bvh, 1, sizeof *bvh);
}

size_t lc_bvh_bytes(const lc_bvh *bvh)
{
    return sizeof *bvh + bvh->data.n_nodes * sizeof *bvh->nodes + bvh->data.n_blocks * sizeof *bvh->blocks;
}

/* Is the box of child i of a node around everything in its subtree's blocks? Checked level by level: a child's boxes
 * against the parent's, a block's vertices against its box. */
static const char *check_child(const lc_bvh *bvh, uint32_t w, uint32_t i, uint8_t *seen, size_t n_tris, const float *pos,
                               const uint32_t *index)
{
    const lc_bvh_node *node = &bvh->nodes[w];
    uint32_t ref = node->child[i];
    if (!(ref & LC_BVH_LEAF)) {
        if (ref <= w || ref >= bvh->data.n_nodes || seen[n_tris + ref]++) return "node out of order or with two parents";
        const lc_bvh_node *c = &bvh->nodes[ref];
        for (uint32_t j = 0; j < 8; j++)
            for (int k = 0; k < 3 && c->child[j] != LC_NONE; k++)
                if (c->lo[k][j] < node->lo[k][i] || c->hi[k][j] > node->hi[k][i]) return "child box outside its parent";
        return NULL;
    }
    if ((ref & ~LC_BVH_LEAF) >= bvh->data.n_blocks) return "block out of range";
    const lc_tri_block *b = &bvh->blocks[ref & ~LC_BVH_LEAF];
    for (uint32_t j = 0; j < 8; j++) {
        if (b->tri[j] == LC_NONE) continue;
        if (b->tri[j] >= n_tris || seen[b->tri[j]]) return "triangle out of range or in two blocks";
        seen[b->tri[j]] = 1;
        for (size_t v = 0; v < 3; v++)
            for (size_t k = 0; k < 3; k++) {
                float p = b->v[v][k][j];
                if (p != lc_tri_vertex(pos, index, b->tri[j], v)[k]) return "vertex differs";
                if (p < node->lo[k][i] || p > node->hi[k][i]) return "vertex outside its box";
            }
    }
    return NULL;
}

const char *lc_bvh_validate(const lc_bvh *bvh, const float *pos, const uint32_t *index, size_t n_tris)
{
    const size_t n_nodes = bvh->data.n_nodes;
    uint8_t *seen = lc_alloc(bvh->ctx, n_tris + n_nodes, 1); /* triangles, then nodes */
    if (!seen) return "out of memory";
    const char *wrong = NULL;
    for (uint32_t w = 0; w < bvh->data.n_nodes && !wrong; w++)
        for (uint32_t i = 0; i < 8 && !wrong; i++)
            if (bvh->nodes[w].child[i] != LC_NONE) wrong = check_child(bvh, w, i, seen, n_tris, pos, index);
    for (size_t t = 0; t < n_tris && !wrong; t++)
        if (!seen[t]) wrong = "triangle in no block";
    for (size_t w = 1; w < n_nodes && !wrong; w++)
        if (!seen[n_tris + w]) wrong = "node without parent";
    lc_free(bvh->ctx, seen, n_tris + n_nodes, 1);
    return wrong;
}
