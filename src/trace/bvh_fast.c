/* bvh_fast.c - a linear BVH (Lauterbach et al. 2009, "Fast BVH construction on GPUs"): triangles in the order
 * of Morton codes of their centroids, ranges split where the highest bit in which their codes differ changes.
 * Only the keys are moved. Once the leaves are counted, they become blocks, in which their boxes are found,
 * and boxes are joined and nodes planned from the leaves up.
 */
#include "trace/bvh_build.h"

#include "base/morton.h"
#include "base/pool.h"
#include "base/vec.h"

#define CHUNK 4096
#define MAX_CODE_DEPTH 60 /* from there on ranges are halved */
_Static_assert(MAX_CODE_DEPTH + 31 < LC_BVH_MAX_DEPTH, "traversal stack");

typedef struct {
    lc_bvh_builder *b;
    lc_bvh *bvh;
    uint64_t *keys;
    f4_box *boxes; /* of the chunks, around twice the centroids */
    f4 lo, scale;  /* of twice a centroid to its cell */
} fast;

/* ---- along the curve ---- */

static f4 twice_centroid(const lc_bvh_builder *b, size_t tri)
{
    const f4_box box = lc_bvh_tri_box(b, tri);
    return f4_add(box.lo, box.hi);
}

static uint32_t end_of_chunk(const lc_bvh_builder *b, uint64_t item)
{
    size_t end = ((size_t)item + 1) * CHUNK;
    return (uint32_t)(end < b->n_tris ? end : b->n_tris);
}

static void measure_chunk(void *user, uint32_t thread, uint64_t item)
{
    const fast *f = user;
    f4_box box = f4_box_empty();
    (void)thread;
    for (uint32_t i = (uint32_t)item * CHUNK, end = end_of_chunk(f->b, item); i < end; i++) {
        const f4 c = twice_centroid(f->b, i);
        box = f4_box_join(box, (f4_box){ c, c });
    }
    f->boxes[item] = box;
}

static void key_chunk(void *user, uint32_t thread, uint64_t item)
{
    const fast *f = user;
    const f4 last = f4_set(LC_MORTON_CELLS - 1);
    (void)thread;
    for (uint32_t i = (uint32_t)item * CHUNK, end = end_of_chunk(f->b, item); i < end; i++) {
        uint32_t cell[3];
        f4_to_u3(f4_min(f4_mul(f4_sub(twice_centroid(f->b, i), f->lo), f->scale), last), cell);
        f->keys[i] = lc_morton_key(cell, i);
    }
}

static lc_status make_keys(fast *f, uint64_t *keys, uint64_t *spare)
{
    const lc_bvh_builder *b = f->b;
    const size_t n = (b->n_tris + CHUNK - 1) / CHUNK;
    _Alignas(16) float size[4];
    f4_box box = f4_box_empty();
    f->boxes = lc_alloc_raw(b->ctx, n, sizeof *f->boxes);
    if (!f->boxes) return LC_ERR_MEMORY;
    lc_parallel_if(b->many, b->ctx, n, measure_chunk, f);
    for (size_t i = 0; i < n; i++) box = f4_box_join(box, f->boxes[i]);
    lc_free(b->ctx, f->boxes, n, sizeof *f->boxes);
    f4_store(size, f4_sub(box.hi, box.lo));
    const float scale = LC_MORTON_CELLS / fmaxf(size[0], fmaxf(size[1], size[2]));
    f->lo = box.lo;
    f->scale = f4_set(scale > 0 && scale <= FLT_MAX ? scale : 0);
    f->keys = keys;
    lc_parallel_if(b->many, b->ctx, n, key_chunk, f);
    f->keys = lc_morton_sort_keys(b->ctx, (uint32_t)b->n_tris, keys, spare);
    return f->keys ? LC_OK : LC_ERR_MEMORY;
}

/* ---- ranges ---- */

/* The number of keys of a range of at least two that go left. */
static uint32_t count_left(const uint64_t *key, uint32_t count, uint32_t depth)
{
    const uint64_t differ = (key[0] ^ key[count - 1]) >> 32 << 32;
    if (!differ || depth >= MAX_CODE_DEPTH) return count / 2;
    const uint64_t bit = (uint64_t)1 << (63 - __builtin_clzll(differ));
    uint32_t clear = 0, set = count - 1; /* keys of which the bit is known */
    while (set - clear > 1) {
        uint32_t mid = clear + (set - clear) / 2;
        if (key[mid] & bit) set = mid;
        else clear = mid;
    }
    return set;
}

/* Splits ranges down to task_max triangles. */
static lc_status split_top(fast *f)
{
    lc_bvh_builder *b = f->b;
    b->heads[b->n_heads++] = (lc_bvh_head){ .range = { .count = (uint32_t)b->n_tris } };
    for (size_t h = 0; h < b->n_heads; h++) {
        const lc_bvh_range r = b->heads[h].range;
        if (r.count <= b->task_max) continue;
        lc_status st = lc_grow(b->ctx, (void **)&b->heads, &b->cap_heads, b->n_heads + 2, sizeof *b->heads);
        if (st) return st;
        const uint32_t n = count_left(f->keys + r.first, r.count, r.depth), left = 2 * (r.first + n);
        b->heads[h].left = (uint32_t)b->n_heads;
        b->nodes[r.node].left = left;
        b->nodes[r.node].info = LC_BIN_TOP;
        for (uint32_t k = 0; k < 2; k++)
            b->heads[b->n_heads++] = (lc_bvh_head){ .range = { .node = left + k,
                                                               .first = k ? r.first + n : r.first,
                                                               .count = k ? r.count - n : n,
                                                               .depth = r.depth + 1 } };
    }
    return LC_OK;
}

/* Splits a head's range down to leaves, and counts those. Its nodes are stored from 2 first + 2 on, parents
 * before their children; a leaf's `left` is its first key. */
static void split_item(void *user, uint32_t thread, uint64_t item)
{
    const fast *f = user;
    lc_bvh_head *head = &f->b->heads[item];
    lc_bvh_range stack[LC_BVH_MAX_DEPTH + 1], r = head->range;
    uint32_t n_stack = 0, next = 2 * r.first + 2;
    (void)thread;
    if (head->left) return;
    for (;;) {
        lc_bin_node *node = &f->b->nodes[r.node];
        if (r.count > 8) {
            const uint32_t n = count_left(f->keys + r.first, r.count, r.depth);
            node->left = next;
            node->info = 0;
            r.depth++;
            stack[n_stack] = r;
            stack[n_stack].node = next + 1;
            stack[n_stack].first += n;
            stack[n_stack++].count -= n;
            r.node = next;
            r.count = n;
            next += 2;
        } else {
            node->left = r.first;
            node->info = LC_BIN_LEAF | r.count << LC_BIN_COUNT_SHIFT;
            head->block++;
            if (!n_stack) return;
            r = stack[--n_stack];
        }
    }
}

/* ---- blocks, and the plan ---- */

static void set_box(lc_bin_node *node, f4_box box)
{
    const uint32_t left = node->left, info = node->info;
    f4_store(node->lo, f4_add(box.lo, f4_set(0))); /* -0 becomes 0 */
    f4_store(node->hi, f4_add(box.hi, f4_set(0)));
    node->left = left;
    node->info = info;
}

static lc_bvh_costs plan_leaf(const fast *f, lc_bin_node *leaf, uint32_t at)
{
    const uint32_t n = leaf->info >> LC_BIN_COUNT_SHIFT & 15;
    lc_tri_block *block = &f->bvh->blocks[at];
    for (uint32_t i = 0; i < n; i++) block->tri[i] = (uint32_t)f->keys[leaf->left + i];
    set_box(leaf, lc_bvh_fill_block(f->b, n, block));
    leaf->left = at;
    return lc_bvh_plan(leaf, NULL, NULL);
}

/* Plans a node from the costs of its children. */
static lc_bvh_costs plan_inner(const fast *f, lc_bin_node *node, const lc_bvh_costs *left,
                               const lc_bvh_costs *right)
{
    const lc_bin_node *child = f->b->nodes + node->left;
    set_box(node, f4_box_join((f4_box){ f4_load(child[0].lo), f4_load(child[0].hi) },
                              (f4_box){ f4_load(child[1].lo), f4_load(child[1].hi) }));
    return lc_bvh_plan(node, left, right);
}

/* Depth first: a node is planned as soon as its children are, so that costs are only those on the way. */
static void plan_item(void *user, uint32_t thread, uint64_t item)
{
    const fast *f = user;
    lc_bvh_head *head = &f->b->heads[item];
    struct {
        lc_bin_node *node;
        bool left_done;
        lc_bvh_costs left;
    } above[LC_BVH_MAX_DEPTH + 1];
    lc_bin_node *nodes = f->b->nodes, *node = &nodes[head->range.node];
    uint32_t n = 0, block = head->block;
    (void)thread;
    if (head->left) return;
    for (;;) {
        for (; !(node->info & LC_BIN_LEAF); node = &nodes[node->left]) {
            above[n].node = node;
            above[n++].left_done = false;
        }
        lc_bvh_costs costs = plan_leaf(f, node, block++);
        for (; n && above[n - 1].left_done; n--)
            costs = plan_inner(f, above[n - 1].node, &above[n - 1].left, &costs);
        if (!n) {
            head->costs = costs;
            return;
        }
        above[n - 1].left = costs;
        above[n - 1].left_done = true;
        node = &nodes[above[n - 1].node->left + 1];
    }
}

static lc_status make_blocks(fast *f)
{
    lc_bvh_builder *b = f->b;
    uint32_t n = 0;
    for (size_t h = 0; h < b->n_heads; h++) {
        const uint32_t count = b->heads[h].block;
        b->heads[h].block = n;
        n += count;
    }
    f->bvh->data.n_blocks = n;
    f->bvh->data.blocks = f->bvh->blocks = lc_alloc_raw(b->ctx, n, sizeof *f->bvh->blocks);
    if (!f->bvh->blocks) return LC_ERR_MEMORY;
    lc_parallel(b->ctx, b->n_heads, plan_item, f);
    for (size_t h = b->n_heads; h-- > 0;) {
        lc_bvh_head *head = &b->heads[h], *child = &b->heads[head->left];
        if (!head->left) continue;
        head->costs = plan_inner(f, &b->nodes[head->range.node], &child[0].costs, &child[1].costs);
    }
    return LC_OK;
}

lc_status lc_bvh_fast_tree(lc_bvh_builder *b, lc_bvh *bvh)
{
    const size_t n = b->n_tris;
    fast f = { .b = b, .bvh = bvh };
    uint64_t *keys = lc_bvh_take(b, n, sizeof *keys), *spare = lc_bvh_take(b, n, sizeof *spare);
    lc_status st = keys && spare ? make_keys(&f, keys, spare) : LC_ERR_MEMORY;
    if (!st) st = split_top(&f);
    if (!st) lc_parallel_if(b->many, b->ctx, b->n_heads, split_item, &f);
    if (!st) st = make_blocks(&f);
    lc_bvh_give(b, keys, n, sizeof *keys);
    lc_bvh_give(b, spare, n, sizeof *spare);
    return st;
}
