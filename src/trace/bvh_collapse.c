/* bvh_collapse.c - turns the binary tree into eight-wide nodes and blocks of eight triangles.
 *
 * Dynamic programming from the leaves up (Ylitie, Karras, Laine 2017, "Efficient incoherent ray traversal on
 * GPUs through compressed wide BVHs", 3.2) chooses which descendants of a binary node become the children of
 * a wide one. Let C(n, i) be the least cost of the subtree of n as at most i children of a wide node, and l,
 * r the children of n:
 *
 *     C(n, 1) = min(area NODE_COST + min over k of C(l, k) + C(r, 8 - k),
 *                   area BLOCK_COST if n has at most 8 triangles)
 *     C(n, i) = min(C(n, i - 1), min over k of C(l, k) + C(r, i - k))
 *
 * The plan in a node's info has three bits at 3 (i - 2) for i = 2 .. 8: the best k, or 0 if C(n, i) = C(n, i
 * - 1).
 */
#include "trace/bvh_build.h"

#include "base/pool.h"
#include "base/vec.h"

#include <string.h>

#define NODE_COST 1.0f  /* relative costs of a visit */
#define BLOCK_COST 1.0f /* insensitive; measured: tests/results/bvh-build.md */

static float area_of(const lc_bin_node *n)
{
    float x = n->hi[0] - n->lo[0], y = n->hi[1] - n->lo[1], z = n->hi[2] - n->lo[2];
    return x * y + y * z + z * x;
}

lc_bvh_costs lc_bvh_plan(lc_bin_node *node, const lc_bvh_costs *left, const lc_bvh_costs *right)
{
    const float area = area_of(node);
    lc_bvh_costs c;
    if (!left) {
        for (int i = 0; i < 7; i++) c.at_most[i] = area * BLOCK_COST;
        c.height = 0;
        return c;
    }
    float l[8], r[8]; /* l[k] = C(l, k) */
    for (int i = 0; i < 7; i++) {
        l[i + 1] = left->at_most[i];
        r[i + 1] = right->at_most[i];
    }
    float opened[9];
    uint32_t plan[9];
    for (uint32_t i = 2; i <= 8; i++) {
        /* A leaf costs the same as any number of children, so the other child gets all that are left. */
        if (left->height && right->height) {
            opened[i] = l[1] + r[i - 1];
            plan[i] = 1;
            for (uint32_t k = 2; k < i; k++)
                if (l[k] + r[i - k] < opened[i]) {
                    opened[i] = l[k] + r[i - k];
                    plan[i] = k;
                }
        } else if (left->height && i > 2 && !(l[i - 1] + r[1] < opened[i - 1])) {
            opened[i] = opened[i - 1];
            plan[i] = plan[i - 1];
        } else {
            opened[i] = left->height ? l[i - 1] + r[1] : l[1] + r[i - 1];
            plan[i] = left->height ? i - 1 : 1;
        }
    }
    float best = area * NODE_COST + opened[8];
    uint32_t info = node->info | plan[8] << 18;
    if (info >> LC_BIN_COUNT_SHIFT & 15 && !(area * BLOCK_COST > best)) {
        best = area * BLOCK_COST;
        info |= LC_BIN_BLOCK;
    }
    c.at_most[0] = best;
    for (uint32_t i = 2; i <= 7; i++) {
        if (opened[i] < best) {
            best = opened[i];
            info |= plan[i] << 3 * (i - 2);
        }
        c.at_most[i - 1] = best;
    }
    node->info = info;
    c.height = 1 + (left->height > right->height ? left->height : right->height);
    return c;
}

static bool is_block(const lc_bin_node *n) { return n->info & (LC_BIN_LEAF | LC_BIN_BLOCK); }

/* What children are sorted by. The bits of floats that are not negative rise with them. */
static uint32_t rank_of(const lc_bin_node *n)
{
    const float area = area_of(n);
    uint32_t bits;
    memcpy(&bits, &area, sizeof bits);
    bits &= 0x7fffffff; /* NaN, of boxes too large, has either sign */
    return is_block(n) ? bits : UINT32_MAX - bits;
}

/* Sorts children for shadow rays: blocks first, by rising area, then nodes by falling area. The kernels test
 * blocks in order and visit the last node first. Measured: tests/results/bvh-build.md. */
static void sort_children(const lc_bin_node *nodes, uint32_t *child, uint32_t n)
{
    uint32_t rank[8];
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t x = child[i], by = rank_of(&nodes[x]);
        uint32_t k = i;
        for (; k > 0 && by < rank[k - 1]; k--) {
            child[k] = child[k - 1];
            rank[k] = rank[k - 1];
        }
        child[k] = x;
        rank[k] = by;
    }
}

/* Follows the plan: out[] gets the binary nodes that become the children of the wide node made from
 * `root`. */
static uint32_t children_of(const lc_bin_node *nodes, uint32_t root, uint32_t out[8])
{
    struct {
        uint32_t node, n;
    } stack[9];
    uint32_t n_stack = 0, n_out = 0;
    stack[n_stack].node = root;
    stack[n_stack++].n = 8;
    if (nodes[root].info & (LC_BIN_LEAF | LC_BIN_BLOCK)) stack[0].n = 1;
    while (n_stack) {
        uint32_t node = stack[--n_stack].node, n = stack[n_stack].n, k = 0, info = nodes[node].info;
        if (info & LC_BIN_LEAF) n = 1;
        while (n > 1 && !(k = info >> 3 * (n - 2) & 7)) n--;
        if (n == 1) {
            out[n_out++] = node;
            continue;
        }
        stack[n_stack].node = nodes[node].left + 1;
        stack[n_stack++].n = n - k;
        stack[n_stack].node = nodes[node].left;
        stack[n_stack++].n = k;
    }
    return n_out;
}

static uint32_t sorted_children_of(const lc_bin_node *nodes, uint32_t root, uint32_t out[8])
{
    const uint32_t n = children_of(nodes, root, out);
    sort_children(nodes, out, n);
    return n;
}

/* ---- nodes and blocks ---- */

/* A subtree of wide nodes that one thread makes. */
typedef struct {
    uint32_t root;        /* binary node */
    uint32_t node, block; /* first the number of its nodes and blocks, then the index of the first of each */
} job;

typedef struct {
    const lc_bvh_builder *b;
    lc_bvh *bvh;
    float pad[3];  /* by which boxes are widened along each axis */
    uint32_t *top; /* the binary nodes of the wide nodes above all jobs */
    job *jobs;
    size_t n_top, n_jobs, n_top_blocks, cap_top, cap_jobs;
} collapse;

f4_box lc_bvh_fill_block(const lc_bvh_builder *b, uint32_t n, lc_tri_block *block)
{
    f4_box box = f4_box_empty();
    for (uint32_t i = n; i < 8; i++) block->tri[i] = LC_NONE;
    for (size_t v = 0; v < 3; v++)
        for (uint32_t i = 0; i < 8; i += 4) {
            f4 at[4], axis[3];
            for (uint32_t k = 0; k < 4; k++) {
                at[k] = f4_set(NAN); /* fails every comparison, so empty lanes are never hit */
                if (i + k >= n) continue;
                at[k] = f4_load3(lc_tri_vertex(b->pos, b->index, block->tri[i + k], v));
                box = f4_box_join(box, (f4_box){ at[k], at[k] });
            }
            f4_transpose4(at[0], at[1], at[2], at[3], axis);
            for (int k = 0; k < 3; k++) f4_store(&block->v[v][k][i], axis[k]);
        }
    return box;
}

/* Numbers the block of a leaf, or of a node that is as cheap as one, and fills it if need be. */
static uint32_t block_of(const collapse *c, const lc_bin_node *leaf, uint32_t *next)
{
    const lc_bvh_builder *b = c->b;
    const lc_bin_node *first = leaf;
    const uint32_t n = leaf->info >> LC_BIN_COUNT_SHIFT & 15;
    if (b->fast) return leaf->left;
    while (!(first->info & LC_BIN_LEAF)) first = &b->nodes[first->left];
    lc_tri_block *block = &c->bvh->blocks[*next];
    memcpy(block->tri, b->order + first->left, n * sizeof *block->tri);
    lc_bvh_fill_block(b, n, block);
    return (*next)++;
}

/* Fills a wide node's boxes and those of its children that are blocks, numbered from *block on. Returns the
 * number of other children: their binary nodes in inner[], their lanes in lane[]. */
static uint32_t fill_node(const collapse *c, lc_bvh_node *node, uint32_t root, uint32_t *block,
                          uint32_t inner[8], uint32_t lane[8])
{
    uint32_t child[8], n = sorted_children_of(c->b->nodes, root, child), n_inner = 0;
    memset(node->pad, 0, sizeof node->pad);
    for (uint32_t i = 0; i < 8; i++) {
        const lc_bin_node *from = i < n ? &c->b->nodes[child[i]] : NULL;
        for (int k = 0; k < 3; k++) {
            node->lo[k][i] = from ? from->lo[k] - c->pad[k] : FLT_MAX;
            node->hi[k][i] = from ? from->hi[k] + c->pad[k] : -FLT_MAX;
        }
        node->child[i] = LC_NONE;
        if (from && is_block(from)) {
            node->child[i] = LC_BVH_LEAF | block_of(c, from, block);
        } else if (from) {
            inner[n_inner] = child[i];
            lane[n_inner++] = i;
        }
    }
    return n_inner;
}

static void count_job(void *user, uint32_t thread, uint64_t item)
{
    const collapse *c = user;
    job *j = &c->jobs[item];
    uint32_t stack[LC_BVH_STACK], n_stack = 0, child[8];
    (void)thread;
    stack[n_stack++] = j->root;
    while (n_stack) {
        uint32_t n = children_of(c->b->nodes, stack[--n_stack], child);
        j->node++;
        for (uint32_t i = 0; i < n; i++) {
            if (is_block(&c->b->nodes[child[i]])) j->block++;
            else stack[n_stack++] = child[i];
        }
    }
}

/* Makes the nodes of a job. The children of a node are consecutive; the subtree of the first comes before
 * that of the next. */
static void fill_job(void *user, uint32_t thread, uint64_t item)
{
    const collapse *c = user;
    const job *j = &c->jobs[item];
    struct {
        uint32_t root, wide;
    } stack[LC_BVH_STACK];
    uint32_t n_stack = 0, next = j->node, block = j->block, inner[8], lane[8];
    (void)thread;
    stack[n_stack].root = j->root;
    stack[n_stack++].wide = next++;
    while (n_stack) {
        uint32_t root = stack[--n_stack].root;
        lc_bvh_node *node = &c->bvh->nodes[stack[n_stack].wide];
        uint32_t n = fill_node(c, node, root, &block, inner, lane);
        for (uint32_t i = 0; i < n; i++) node->child[lane[i]] = next + i;
        for (uint32_t i = n; i-- > 0;) {
            stack[n_stack].root = inner[i];
            stack[n_stack++].wide = next + i;
        }
        next += n;
    }
}

/* Lists the wide nodes above all jobs, and the jobs, level by level: the nth child of its kind found here is
 * the nth found by fill_top. */
static lc_status list_jobs(collapse *c)
{
    const lc_bin_node *nodes = c->b->nodes;
    uint32_t child[8] = { 0 }, n = 1; /* starts with the root, node 0 */
    for (size_t t = 0;; t++) {
        lc_status st = lc_grow(c->b->ctx, (void **)&c->top, &c->cap_top, c->n_top + 8, sizeof *c->top);
        if (!st) st = lc_grow(c->b->ctx, (void **)&c->jobs, &c->cap_jobs, c->n_jobs + 8, sizeof *c->jobs);
        if (st) return st;
        for (uint32_t i = 0; i < n; i++) {
            if (nodes[child[i]].info & LC_BIN_TOP) c->top[c->n_top++] = child[i];
            else if (c->n_top && is_block(&nodes[child[i]])) c->n_top_blocks++;
            else c->jobs[c->n_jobs++].root = child[i];
        }
        if (t == c->n_top) return LC_OK;
        n = sorted_children_of(nodes, c->top[t], child);
    }
}

static void fill_top(const collapse *c)
{
    uint32_t block = 0, next_top = 1, next_job = 0, inner[8], lane[8];
    for (size_t t = 0; t < c->n_top; t++) {
        lc_bvh_node *node = &c->bvh->nodes[t];
        for (uint32_t i = 0, n = fill_node(c, node, c->top[t], &block, inner, lane); i < n; i++)
            node->child[lane[i]] = c->b->nodes[inner[i]].info & LC_BIN_TOP ? next_top++
                                                                           : c->jobs[next_job++].node;
    }
}

static lc_status fill(collapse *c)
{
    lc_bvh *bvh = c->bvh;
    const lc_context *ctx = c->b->ctx;
    size_t n_nodes, n_blocks;
    lc_status st = list_jobs(c);
    if (st) return st;
    lc_parallel_if(c->b->many, ctx, c->n_jobs, count_job, c);
    n_nodes = c->n_top;
    n_blocks = c->n_top_blocks;
    for (size_t i = 0; i < c->n_jobs; i++) {
        job *j = &c->jobs[i];
        uint32_t nodes = j->node, blocks = j->block;
        j->node = (uint32_t)n_nodes;
        j->block = (uint32_t)n_blocks;
        n_nodes += nodes;
        n_blocks += blocks;
    }
    bvh->data.n_nodes = (uint32_t)n_nodes;
    bvh->data.nodes = bvh->nodes = lc_alloc_raw(ctx, n_nodes, sizeof *bvh->nodes);
    if (!c->b->fast) {
        bvh->data.n_blocks = (uint32_t)n_blocks;
        bvh->data.blocks = bvh->blocks = lc_alloc_raw(ctx, n_blocks, sizeof *bvh->blocks);
    }
    if (!bvh->nodes || !bvh->blocks) return LC_ERR_MEMORY;
    fill_top(c);
    lc_parallel_if(c->b->many || !c->b->fast, ctx, c->n_jobs, fill_job, c);
    return LC_OK;
}

lc_status lc_bvh_collapse(lc_bvh_builder *b, lc_bvh *bvh)
{
    collapse c = { .b = b, .bvh = bvh };
    /* Boxes are padded by 2^-20 of the largest coordinate: the shear of the triangle test rounds a vertex by
     * at most 3 ulp of its distance from the ray's origin, or 6 * 2^-24 of twice the largest coordinate if
     * the ray starts inside the scene. */
    float most = 0;
    for (int k = 0; k < 3; k++) most = fmaxf(most, fmaxf(fabsf(b->nodes[0].lo[k]), fabsf(b->nodes[0].hi[k])));
    for (int k = 0; k < 3; k++) c.pad[k] = 0x1p-20f * most;
    lc_status st = fill(&c);
    lc_free(b->ctx, c.top, c.cap_top, sizeof *c.top);
    lc_free(b->ctx, c.jobs, c.cap_jobs, sizeof *c.jobs);
    return st;
}
