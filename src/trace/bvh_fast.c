/* bvh_fast.c - a linear BVH (Lauterbach et al. 2009, "Fast BVH construction on GPUs"): triangles in the order
 * of Morton codes of their centroids, ranges split where the highest bit in which their codes differ changes.
 * Nothing is moved after the sort; the boxes are joined from the leaves up.
 */
#include "trace/bvh_build.h"

#include "base/morton.h"
#include "base/pool.h"

#define CHUNK 4096
#define MAX_CODE_DEPTH 60 /* from there on ranges are halved */
_Static_assert(MAX_CODE_DEPTH + 31 < LC_BVH_MAX_DEPTH, "traversal stack");

static lc_f3 centroid_of(const void *user, uint32_t i)
{
    const lc_bvh_ref *r = (const lc_bvh_ref *)user + i;
    return lc_f3_make(r->lo[0] + r->hi[0], r->lo[1] + r->hi[1], r->lo[2] + r->hi[2]);
}

/* Copies the refs of a chunk in their order. */
static void gather_item(void *user, uint32_t thread, uint64_t item)
{
    const lc_bvh_builder *b = user;
    size_t first = (size_t)item * CHUNK, end = first + CHUNK < b->n_tris ? first + CHUNK : b->n_tris;
    (void)thread;
    for (size_t i = first; i < end; i++) b->refs[1][i] = b->refs[0][b->order[i]];
}

static lc_status sort_refs(lc_bvh_builder *b)
{
    lc_bvh_range *root = &b->heads[0].range;
    _Alignas(16) float lo[4], hi[4];
    f4_store(lo, root->centroids.lo);
    f4_store(hi, root->centroids.hi);
    const lc_box box = { lc_f3_load(lo), lc_f3_load(hi) };
    lc_status st = lc_morton_coarse(b->ctx, (uint32_t)b->n_tris, &box, centroid_of, b->refs[0], b->order,
                                    b->codes);
    if (st) return st;
    root->side = 1;
    lc_parallel(b->ctx, (b->n_tris + CHUNK - 1) / CHUNK, gather_item, b);
    return LC_OK;
}

/* The number of refs of a range of at least two that go left. */
static uint32_t count_left(const lc_bvh_builder *b, const lc_bvh_range *r)
{
    const uint64_t *code = b->codes + r->first;
    const uint64_t differ = (code[0] ^ code[r->count - 1]) >> LC_MORTON_FINE << LC_MORTON_FINE;
    if (!differ || r->depth >= MAX_CODE_DEPTH) return r->count / 2;
    const uint64_t bit = (uint64_t)1 << (63 - __builtin_clzll(differ));
    uint32_t clear = 0, set = r->count - 1; /* refs of which the bit is known */
    while (set - clear > 1) {
        uint32_t mid = clear + (set - clear) / 2;
        if (code[mid] & bit) set = mid;
        else clear = mid;
    }
    return set;
}

static void halves_of(const lc_bvh_builder *b, const lc_bvh_range *r, lc_bvh_range half[2])
{
    uint32_t n = count_left(b, r);
    for (uint32_t k = 0; k < 2; k++)
        half[k] = (lc_bvh_range){ .first = k ? r->first + n : r->first,
                                  .count = k ? r->count - n : n,
                                  .depth = r->depth + 1,
                                  .side = 1 };
}

lc_status lc_bvh_fast_top(lc_bvh_builder *b)
{
    lc_status st = sort_refs(b);
    for (size_t h = 0; h < b->n_heads && !st; h++) {
        lc_bvh_range r = b->heads[h].range, half[2];
        if (r.count <= b->task_max) continue;
        st = lc_grow(b->ctx, (void **)&b->heads, &b->cap_heads, b->n_heads + 2, sizeof *b->heads);
        if (st) break;
        halves_of(b, &r, half);
        b->heads[h].left = (uint32_t)b->n_heads;
        b->nodes[r.node].left = 2 * half[1].first;
        b->nodes[r.node].info = 0;
        for (uint32_t k = 0; k < 2; k++) {
            half[k].node = 2 * half[1].first + k;
            b->heads[b->n_heads++] = (lc_bvh_head){ .range = half[k] };
        }
    }
    return st;
}

static void set_box(lc_bin_node *node, f4_box box)
{
    f4_store(node->lo, box.lo);
    f4_store(node->hi, box.hi);
}

void lc_bvh_join_children(const lc_bvh_builder *b, lc_bin_node *node)
{
    uint32_t left = node->left, info = node->info;
    const lc_bin_node *c = b->nodes + left;
    set_box(node, f4_box_join((f4_box){ f4_load(c[0].lo), f4_load(c[0].hi) },
                              (f4_box){ f4_load(c[1].lo), f4_load(c[1].hi) }));
    node->left = left;
    node->info = info;
}

uint32_t lc_bvh_fast_subtree(const lc_bvh_builder *b, const lc_bvh_range *root)
{
    lc_bvh_range stack[LC_BVH_MAX_DEPTH + 1], half[2];
    const uint32_t first = 2 * root->first + 2;
    uint32_t n_stack = 0, next = first;
    stack[n_stack++] = *root;
    while (n_stack) {
        lc_bvh_range r = stack[--n_stack];
        lc_bin_node *node = &b->nodes[r.node];
        if (r.count <= 8) {
            set_box(node, lc_bvh_box_of(b->refs[1] + r.first, r.count));
            node->left = r.first;
            node->info = LC_BIN_LEAF | r.count << LC_BIN_COUNT_SHIFT;
            continue;
        }
        halves_of(b, &r, half);
        node->left = next;
        node->info = 0;
        half[0].node = next;
        half[1].node = next + 1;
        next += 2;
        stack[n_stack++] = half[1];
        stack[n_stack++] = half[0];
    }
    for (uint32_t i = next; i-- > first;)
        if (!(b->nodes[i].info & LC_BIN_LEAF)) lc_bvh_join_children(b, &b->nodes[i]);
    if (root->count > 8) lc_bvh_join_children(b, &b->nodes[root->node]);
    return next;
}
