/* bvh_build.c - builds the binary tree by the binned surface area heuristic (SAH).
 *
 *     refs -> upper tree: large ranges, split level by level, all threads binning and moving chunks of them
 *          -> subtrees of at most task_max refs, each by one thread
 *
 * There is no recursion. The depth is bounded, as beyond MAX_SAH_DEPTH ranges are halved.
 */
#include "trace/bvh_build.h"

#include "base/pool.h"

#define CHUNK 4096    /* refs that one thread bins or moves at a time */
#define TASKS 64      /* subtrees: one has at most n_tris / TASKS refs, kept within the next two */
#define TASK_MIN 4096
#define TASK_MAX 65536
/* From so many triangles on every loop is worth threads, and every array a block of its own; for fuzzers
 * always, so that what goes beyond one is found. Measured with two threads on 16,000 to 1,000,000. */
#define MANY LC_SIZE(131072, 1)
#define MAX_SAH_DEPTH 60 /* from there on ranges are halved: 30 more levels hold 2^30 triangles */
#define SPLIT_COST 0.25f /* fraction of the area that splitting eight or fewer triangles must save; chosen */
_Static_assert(MAX_SAH_DEPTH + 31 < LC_BVH_MAX_DEPTH, "traversal stack");

static void set_node(lc_bin_node *node, f4_box box, uint32_t count)
{
    f4_store(node->lo, box.lo);
    f4_store(node->hi, box.hi);
    node->left = 0;
    node->info = count <= 8 ? count << LC_BIN_COUNT_SHIFT : 0;
}

static float area_of(const lc_bin_node *n)
{
    float x = n->hi[0] - n->lo[0], y = n->hi[1] - n->lo[1], z = n->hi[2] - n->lo[2];
    return x * y + y * z + z * x;
}

/* ---- subtrees ---- */

/* Splits r into half[2] and sets the boxes of nodes left and left + 1; false if it is cheaper as a leaf. */
static bool split_range(const lc_bvh_builder *b, const lc_bvh_range *r, uint32_t left, lc_bvh_range half[2])
{
    lc_bvh_ref *refs = b->refs[r->side] + r->first;
    lc_bvh_split s = { .cost = FLT_MAX };
    if (r->count > 1 && r->depth < MAX_SAH_DEPTH) {
        lc_bvh_bins bins;
        lc_bvh_binning by = lc_bvh_binning_of(r);
        lc_bvh_clear_bins(&bins, by.n);
        lc_bvh_add_to_bins(&bins, &by, refs, r->count);
        s = lc_bvh_best_split(&bins, &by);
        if (r->count <= 8 && !(s.cost < area_of(&b->nodes[r->node]) * (1 - SPLIT_COST))) return false;
        if (s.cost < FLT_MAX) {
            lc_bvh_ref *to_left = b->refs[!r->side] + r->first, *to_right = to_left + s.n_left;
            lc_bvh_partition(&by, &s, refs, r->count, &to_left, &to_right);
        }
    }
    if (r->count <= 8 && s.cost == FLT_MAX) return false;
    bool halve = s.cost == FLT_MAX;
    uint32_t n = halve ? r->count / 2 : s.n_left, side = halve ? r->side : !r->side;
    half[0] = (lc_bvh_range){ .node = left, .first = r->first, .count = n };
    half[1] = (lc_bvh_range){ .node = left + 1, .first = r->first + n, .count = r->count - n };
    for (int k = 0; k < 2; k++) {
        const lc_bvh_ref *part = b->refs[side] + half[k].first;
        half[k].depth = r->depth + 1;
        half[k].side = side;
        half[k].centroids = lc_bvh_centroids_of(part, half[k].count);
        set_node(&b->nodes[left + (uint32_t)k],
                 halve ? lc_bvh_box_of(part, half[k].count)
                 : k   ? s.right
                       : s.left,
                 half[k].count);
    }
    return true;
}

static void make_leaf(const lc_bvh_builder *b, const lc_bvh_range *r)
{
    lc_bin_node *node = &b->nodes[r->node];
    for (uint32_t i = r->first; i < r->first + r->count; i++) b->order[i] = b->refs[r->side][i].tri;
    node->left = r->first;
    node->info = LC_BIN_LEAF | r->count << LC_BIN_COUNT_SHIFT;
}

/* Plans a node whose children have their plans. */
static lc_bvh_costs plan_node(const lc_bvh_builder *b, lc_bin_node *n)
{
    if (n->info & LC_BIN_LEAF) return lc_bvh_plan(n, NULL, NULL);
    return lc_bvh_plan(n, lc_bvh_costs_of(b, n->left), lc_bvh_costs_of(b, n->left + 1));
}

/* Builds the subtree of a range and returns the costs of its root. Its other nodes are stored from 2 first +
 * 2 on, parents before their children. */
static lc_bvh_costs make_subtree(const lc_bvh_builder *b, const lc_bvh_range *root)
{
    lc_bvh_range stack[LC_BVH_MAX_DEPTH + 1], half[2];
    const uint32_t first = 2 * root->first + 2;
    uint32_t n_stack = 0, next = first;
    stack[n_stack++] = *root;
    while (n_stack) {
        lc_bvh_range r = stack[--n_stack];
        if (split_range(b, &r, next, half)) {
            b->nodes[r.node].left = next;
            b->parents[next / 2] = r.node;
            next += 2;
            stack[n_stack++] = half[1];
            stack[n_stack++] = half[0];
        } else {
            make_leaf(b, &r);
        }
    }
    for (uint32_t i = next; i-- > first;) *lc_bvh_costs_of(b, i) = plan_node(b, &b->nodes[i]);
    return plan_node(b, &b->nodes[root->node]);
}

typedef struct {
    lc_bvh_builder *b;
    uint32_t *heads; /* the heads that are subtrees */
} subtree_loop;

static void subtree_item(void *user, uint32_t thread, uint64_t item)
{
    const subtree_loop *l = user;
    lc_bvh_head *head = &l->b->heads[l->heads[item]];
    (void)thread;
    head->costs = make_subtree(l->b, &head->range);
}

/* Builds all subtrees in parallel, then plans the upper tree from the bottom. */
static lc_status make_subtrees(lc_bvh_builder *b)
{
    subtree_loop l = { b, lc_alloc(b->ctx, b->n_heads, sizeof *l.heads) };
    uint64_t n = 0;
    if (!l.heads) return LC_ERR_MEMORY;
    for (uint32_t h = 0; h < b->n_heads; h++)
        if (!b->heads[h].left) l.heads[n++] = h;
    lc_parallel(b->ctx, n, subtree_item, &l);
    lc_free(b->ctx, l.heads, b->n_heads, sizeof *l.heads);
    for (size_t h = b->n_heads; h-- > 0;) {
        lc_bvh_head *head = &b->heads[h];
        lc_bin_node *node = &b->nodes[head->range.node];
        if (head->left) {
            head->costs = plan_node(b, node);
            node->info |= LC_BIN_TOP;
        }
        if (h) *lc_bvh_costs_of(b, head->range.node) = head->costs;
    }
    return LC_OK;
}

/* ---- ranges too large for one thread ---- */

/* A part of a range that one thread works on. */
typedef struct {
    uint32_t work, first, count; /* index of its range in level.works; its refs */
    lc_bvh_ref *left, *right;    /* destinations of its refs */
    f4_box centroids[2];         /* of its refs that go left and right */
    lc_bvh_bins bins;
} chunk;

/* A range of the current level that is split. */
typedef struct {
    uint32_t head, first_chunk, n_chunks;
    lc_bvh_binning by;
    lc_bvh_split split;
} work;

typedef struct {
    lc_bvh_builder *b;
    chunk *chunks;
    work *works;
    size_t n_chunks, n_works, cap_chunks, cap_works;
} level;

static void bin_chunk(void *user, uint32_t thread, uint64_t item)
{
    const level *l = user;
    chunk *c = &l->chunks[item];
    const work *w = &l->works[c->work];
    (void)thread;
    lc_bvh_clear_bins(&c->bins, w->by.n);
    lc_bvh_add_to_bins(&c->bins, &w->by, l->b->refs[l->b->heads[w->head].range.side] + c->first, c->count);
}

/* Chooses the split of a range and the destinations of its chunks' refs. */
static void choose_split(void *user, uint32_t thread, uint64_t item)
{
    const level *l = user;
    work *w = &l->works[item];
    chunk *first = &l->chunks[w->first_chunk], *end = first + w->n_chunks;
    const lc_bvh_range *r = &l->b->heads[w->head].range;
    (void)thread;
    w->split.cost = FLT_MAX;
    if (r->depth >= MAX_SAH_DEPTH) return;
    lc_bvh_bins all;
    lc_bvh_clear_bins(&all, w->by.n);
    for (const chunk *c = first; c < end; c++) lc_bvh_join_bins(&all, &c->bins, w->by.n);
    w->split = lc_bvh_best_split(&all, &w->by);
    lc_bvh_ref *left = l->b->refs[!r->side] + r->first, *right = left + w->split.n_left;
    for (chunk *c = first; c < end; c++) {
        uint32_t n = lc_bvh_count_left(&c->bins, &w->split);
        c->left = left;
        c->right = right;
        left += n;
        right += c->count - n;
    }
}

static void move_chunk(void *user, uint32_t thread, uint64_t item)
{
    const level *l = user;
    chunk *c = &l->chunks[item];
    const work *w = &l->works[c->work];
    (void)thread;
    if (w->split.cost == FLT_MAX) return;
    lc_bvh_ref *left = c->left, *right = c->right;
    const lc_bvh_ref *from = l->b->refs[l->b->heads[w->head].range.side] + c->first;
    lc_bvh_partition(&w->by, &w->split, from, c->count, &left, &right);
    c->centroids[0] = lc_bvh_centroids_of(c->left, (uint32_t)(left - c->left));
    c->centroids[1] = lc_bvh_centroids_of(c->right, (uint32_t)(right - c->right));
}

/* Lists the chunks of those heads first .. end - 1 that are too large for one thread. */
static void list_chunks(level *l, size_t first, size_t end)
{
    l->n_chunks = l->n_works = 0;
    for (size_t h = first; h < end; h++) {
        const lc_bvh_range *r = &l->b->heads[h].range;
        if (r->count <= l->b->task_max) continue;
        work *w = &l->works[l->n_works];
        *w = (work){ .head = (uint32_t)h, .first_chunk = (uint32_t)l->n_chunks, .by = lc_bvh_binning_of(r) };
        for (uint32_t i = 0; i < r->count; i += CHUNK) {
            chunk *c = &l->chunks[l->n_chunks++];
            c->work = (uint32_t)l->n_works;
            c->first = r->first + i;
            c->count = r->count - i < CHUNK ? r->count - i : CHUNK;
        }
        w->n_chunks = (uint32_t)l->n_chunks - w->first_chunk;
        l->n_works++;
    }
}

/* Appends the heads of the two halves of a range. */
static void add_heads(level *l, const work *w)
{
    lc_bvh_builder *b = l->b;
    const lc_bvh_range *r = &b->heads[w->head].range;
    const lc_bvh_split *s = &w->split;
    bool halve = s->cost == FLT_MAX;
    uint32_t n = halve ? r->count / 2 : s->n_left, node = 2 * (r->first + n);
    b->heads[w->head].left = (uint32_t)b->n_heads;
    b->nodes[r->node].left = node;
    b->parents[node / 2] = r->node;
    for (uint32_t k = 0; k < 2; k++) {
        lc_bvh_range h = { .node = node + k,
                           .first = k ? r->first + n : r->first,
                           .count = k ? r->count - n : n,
                           .depth = r->depth + 1,
                           .side = halve ? r->side : !r->side,
                           .centroids = f4_box_empty() };
        const lc_bvh_ref *refs = b->refs[h.side] + h.first;
        if (halve) h.centroids = lc_bvh_centroids_of(refs, h.count);
        for (uint32_t i = 0; i < w->n_chunks && !halve; i++)
            h.centroids = f4_box_join(h.centroids, l->chunks[w->first_chunk + i].centroids[k]);
        set_node(&b->nodes[h.node], halve ? lc_bvh_box_of(refs, h.count) : k ? s->right : s->left, h.count);
        b->heads[b->n_heads++] = (lc_bvh_head){ .range = h };
    }
}

/* Splits all ranges that are too large, level by level from the root. */
static lc_status split_levels(level *l)
{
    lc_bvh_builder *b = l->b;
    for (size_t first = 0, end; (end = b->n_heads) > first; first = end) {
        list_chunks(l, first, end);
        if (!l->n_works) continue;
        lc_parallel_if(b->many, b->ctx, l->n_chunks, bin_chunk, l);
        for (size_t i = 0; i < l->n_works; i++) choose_split(l, 0, i);
        lc_parallel_if(b->many, b->ctx, l->n_chunks, move_chunk, l);
        lc_status st = lc_grow(b->ctx, (void **)&b->heads, &b->cap_heads, b->n_heads + 2 * l->n_works,
                               sizeof *b->heads);
        if (st) return st;
        for (size_t i = 0; i < l->n_works; i++) add_heads(l, &l->works[i]);
    }
    return LC_OK;
}

static lc_status split_top(lc_bvh_builder *b)
{
    if (b->n_tris <= b->task_max) return LC_OK;
    /* The ranges of a level have more than task_max refs each, and at most one chunk that is not full. */
    level l = { .b = b, .cap_works = b->n_tris / b->task_max + 1 };
    l.cap_chunks = b->n_tris / CHUNK + l.cap_works;
    l.chunks = lc_alloc_raw(b->ctx, l.cap_chunks, sizeof *l.chunks);
    l.works = lc_alloc_raw(b->ctx, l.cap_works, sizeof *l.works);
    lc_status st = l.chunks && l.works ? split_levels(&l) : LC_ERR_MEMORY;
    lc_free(b->ctx, l.chunks, l.cap_chunks, sizeof *l.chunks);
    lc_free(b->ctx, l.works, l.cap_works, sizeof *l.works);
    return st;
}

/* ---- the whole build ---- */

#define BYTES_A_TRI (2 * sizeof(lc_bin_node) + 2 * sizeof(lc_bvh_ref) + 2 * sizeof(uint32_t))

void *lc_bvh_take(lc_bvh_builder *b, size_t n, size_t size)
{
    if (b->many) return lc_alloc_raw(b->ctx, n, size);
    void *ptr = b->memory + b->taken;
    b->taken += (n * size + 63) / 64 * 64;
    return ptr;
}

void lc_bvh_give(const lc_bvh_builder *b, void *ptr, size_t n, size_t size)
{
    if (b->many) lc_free(b->ctx, ptr, n, size);
}

static void refs_item(void *user, uint32_t thread, uint64_t item)
{
    struct { lc_bvh_builder *b; f4_box *boxes; } *l = user;
    (void)thread;
    uint32_t first = (uint32_t)item * CHUNK, left = (uint32_t)l->b->n_tris - first;
    lc_bvh_make_refs(l->b, first, left < CHUNK ? left : CHUNK, &l->boxes[2 * item], &l->boxes[2 * item + 1]);
}

/* Makes the refs, and the root as the first head. */
static lc_status make_root(lc_bvh_builder *b)
{
    const size_t n = (b->n_tris + CHUNK - 1) / CHUNK;
    struct { lc_bvh_builder *b; f4_box *boxes; } l = { b, lc_alloc(b->ctx, 2 * n, sizeof *l.boxes) };
    if (!l.boxes) return LC_ERR_MEMORY;
    lc_parallel_if(b->many, b->ctx, n, refs_item, &l);
    f4_box box = f4_box_empty(), centroids = box;
    for (size_t i = 0; i < n; i++) {
        box = f4_box_join(box, l.boxes[2 * i]);
        centroids = f4_box_join(centroids, l.boxes[2 * i + 1]);
    }
    lc_free(b->ctx, l.boxes, 2 * n, sizeof *l.boxes);
    set_node(&b->nodes[0], box, (uint32_t)b->n_tris);
    b->heads[b->n_heads++] = (lc_bvh_head){ .range = { .centroids = centroids,
                                                       .count = (uint32_t)b->n_tris } };
    return LC_OK;
}

static lc_status make_tree(lc_bvh_builder *b)
{
    const size_t n = b->n_tris;
    b->refs[0] = lc_bvh_take(b, n, sizeof **b->refs);
    b->refs[1] = lc_bvh_take(b, n, sizeof **b->refs);
    b->order = lc_bvh_take(b, n, sizeof *b->order);
    b->parents = lc_bvh_take(b, n, sizeof *b->parents);
    lc_status st = b->refs[0] && b->refs[1] && b->order && b->parents ? make_root(b) : LC_ERR_MEMORY;
    if (!st) st = split_top(b);
    if (!st) st = make_subtrees(b);
    if (!st) st = lc_bvh_reinsert(b);
    /* Freed before the wide nodes and blocks are allocated, which keeps the peak of memory low. */
    lc_bvh_give(b, b->refs[0], n, sizeof **b->refs);
    lc_bvh_give(b, b->refs[1], n, sizeof **b->refs);
    lc_bvh_give(b, b->parents, n, sizeof *b->parents);
    return st;
}

static lc_status make_bvh(lc_bvh_builder *b, lc_bvh *bvh)
{
    /* Each of up to eight arrays begins at a multiple of 64 bytes. */
    const size_t n = b->n_tris, bytes = b->many ? 0 : n * BYTES_A_TRI + 8 * 64;
    if (bytes) b->memory = lc_alloc_raw(b->ctx, bytes, 1);
    if (bytes && !b->memory) return LC_ERR_MEMORY;
    b->nodes = lc_bvh_take(b, 2 * n, sizeof *b->nodes);
    lc_status st = b->nodes ? LC_OK : LC_ERR_MEMORY;
    if (!st) st = lc_grow(b->ctx, (void **)&b->heads, &b->cap_heads, 1, sizeof *b->heads);
    if (!st) st = b->fast ? lc_bvh_fast_tree(b, bvh) : make_tree(b);
    if (!st) st = lc_bvh_collapse(b, bvh);
    lc_bvh_give(b, b->order, n, sizeof *b->order);
    lc_bvh_give(b, b->nodes, 2 * n, sizeof *b->nodes);
    lc_free(b->ctx, b->memory, bytes, 1);
    lc_free(b->ctx, b->heads, b->cap_heads, sizeof *b->heads);
    return st;
}

lc_status lc_bvh_build(const lc_context *ctx, const float *pos, const uint32_t *index, size_t n_tris,
                       lc_bvh **out)
{
    *out = NULL;
    lc_bvh *bvh = lc_alloc(ctx, 1, sizeof *bvh);
    if (!bvh) return LC_ERR_MEMORY;
    bvh->ctx = ctx;
    bvh->kernels = ctx->trace_kernels;
    size_t task_max = n_tris / TASKS;
    task_max = task_max < TASK_MIN ? TASK_MIN : task_max > TASK_MAX ? TASK_MAX : task_max;
    lc_bvh_builder b = {
        .ctx = ctx, .pos = pos, .index = index, .n_tris = n_tris, .task_max = (uint32_t)task_max,
        .many = n_tris >= MANY, .fast = ctx->bvh == LC_BVH_FAST
    };
    lc_status st = n_tris ? make_bvh(&b, bvh) : LC_OK;
    if (st) {
        lc_bvh_destroy(bvh);
        return st;
    }
    *out = bvh;
    return LC_OK;
}
