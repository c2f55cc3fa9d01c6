/* bench_heap.c - see bench_heap.h. */
#include "lab/bench_heap.h"

#include "base/arena.h"

lc_status bench_heap_init(bench_heap *h, const lc_context *ctx, const lc_light_tree *tree,
                          const lc_visibility *visibility, float error_ratio, uint32_t max_cut,
                          uint32_t n_pop)
{
    *h = (bench_heap){ .ctx = ctx, .tree = tree, .visibility = *visibility, .error_ratio = error_ratio,
                       .n_pop = n_pop };
    h->max_cut = max_cut && max_cut < tree->n_lights ? max_cut : tree->n_lights;
    h->item = lc_alloc_raw(ctx, h->max_cut, sizeof *h->item);
    h->cluster = lc_alloc_raw(ctx, h->max_cut, sizeof *h->cluster);
    h->free_slot = lc_alloc_raw(ctx, h->max_cut, sizeof *h->free_slot);
    return h->item && h->cluster && h->free_slot ? LC_OK : LC_ERR_MEMORY;
}

void bench_heap_free(bench_heap *h)
{
    lc_free(h->ctx, h->item, h->max_cut, sizeof *h->item);
    lc_free(h->ctx, h->cluster, h->max_cut, sizeof *h->cluster);
    lc_free(h->ctx, h->free_slot, h->max_cut, sizeof *h->free_slot);
    h->item = NULL;
    h->cluster = NULL;
    h->free_slot = NULL;
}

static void push(bench_heap *h, heap_item x)
{
    uint32_t i = h->n++;
    for (uint32_t parent; i && h->item[parent = (i - 1) / 2].bound < x.bound; i = parent)
        h->item[i] = h->item[parent];
    h->item[i] = x;
}

static heap_item pop(bench_heap *h)
{
    heap_item top = h->item[0], last = h->item[--h->n];
    uint32_t i = 0;
    for (uint32_t child; (child = 2 * i + 1) < h->n; i = child) {
        child += child + 1 < h->n && h->item[child + 1].bound > h->item[child].bound;
        if (!(h->item[child].bound > last.bound)) break;
        h->item[i] = h->item[child];
    }
    h->item[i] = last;
    return top;
}

/* What one step works on: up to HEAP_MAX_POP parents and their children. */
typedef struct step {
    uint32_t n;
    heap_cluster parent[HEAP_MAX_POP];
    uint32_t link[2 * HEAP_MAX_POP], node[2 * HEAP_MAX_POP]; /* children; those of them that are nodes */
    uint32_t rep[HEAP_MAX_POP];                              /* the new representative of each pair */
    bool right_is_new[HEAP_MAX_POP];                         /* it is the right child's */
    uint8_t hidden[HEAP_MAX_POP];
    _Alignas(64) float ub[2 * HEAP_MAX_POP + LC_LANES], f[6][HEAP_MAX_POP + LC_LANES];
} step;

static void find_children(const bench_heap *h, step *s)
{
    for (uint32_t i = 0; i < s->n; i++) {
        const lc_node *node = &h->tree->data.nodes[s->parent[i].link];
        uint32_t rep = lc_rep_of(h->tree, node->left, h->rep_slot);
        s->link[2 * i] = node->left;
        s->link[2 * i + 1] = node->right;
        s->right_is_new[i] = rep == s->parent[i].rep;
        s->rep[i] = s->right_is_new[i] ? lc_rep_of(h->tree, node->right, h->rep_slot) : rep;
    }
}

/* Bounds of the children that are nodes, in their order, and transfers of the new representatives. */
static void run_kernels(bench_heap *h, step *s, const lc_point *p, const float org[3])
{
    const lc_shade_kernels *k = h->ctx->shade_kernels;
    float *const out[6] = { s->f[0], s->f[1], s->f[2], s->f[3], s->f[4], s->f[5] };
    const float *const target[3] = { s->f[3], s->f[4], s->f[5] };
    uint32_t n_nodes = 0;
    for (uint32_t i = 0; i < 2 * s->n; i++)
        if (!(s->link[i] & LC_LEAF)) s->node[n_nodes++] = s->link[i];
    if (n_nodes) k->bounds(&h->tree->data, s->node, n_nodes, LC_LIGHT_POINT, p, s->ub);
    h->n_bounds += n_nodes;
    k->estimate(&h->tree->data, 0, s->rep, s->n, LC_LIGHT_POINT, p, out);
    h->visibility.hidden(h->visibility.scene, org, s->n, target, false, s->hidden, NULL);
    for (uint32_t i = 0; i < s->n; i++)
        if (s->hidden[i]) s->f[0][i] = s->f[1][i] = s->f[2][i] = 0;
}

/* Adds a cluster with the bound, or a light, to the cut. */
static void add(bench_heap *h, uint32_t link, uint32_t rep, const float transfer[3], float bound)
{
    const bool leaf = link & LC_LEAF;
    const lc_tree_data *t = &h->tree->data;
    const float *intensity = leaf ? t->lights[link & ~LC_LEAF].intensity : t->nodes[link].intensity;
    heap_cluster c = { .link = link, .rep = rep };
    for (int k = 0; k < 3; k++) {
        c.transfer[k] = transfer[k];
        c.e[k] = transfer[k] * intensity[k];
        h->sum[k] += (double)c.e[k];
    }
    h->n_done += leaf;
    if (leaf) return;
    uint32_t slot = h->n_free ? h->free_slot[--h->n_free] : h->n_used++;
    h->cluster[slot] = c;
    push(h, (heap_item){ bound, slot });
}

static void place_children(bench_heap *h, const step *s)
{
    const float *ub = s->ub;
    for (uint32_t i = 0; i < s->n; i++) {
        const heap_cluster *parent = &s->parent[i];
        const float fresh[3] = { s->f[0][i], s->f[1][i], s->f[2][i] };
        for (int k = 0; k < 3; k++) h->sum[k] -= (double)parent->e[k];
        for (uint32_t side = 0; side < 2; side++) {
            bool own = side == s->right_is_new[i]; /* a representative of its own */
            uint32_t link = s->link[2 * i + side];
            float bound = link & LC_LEAF ? 0 : *ub++;
            if (!(bound > 0) && !(link & LC_LEAF)) continue;
            add(h, link, own ? s->rep[i] : parent->rep, own ? fresh : parent->transfer, bound);
        }
    }
}

double bench_heap_luminance(const bench_heap *h)
{
    return 0.2126 * h->sum[0] + 0.7152 * h->sum[1] + 0.0722 * h->sum[2];
}

/* Takes what is to be split next out of the heap; none: the cut is done. */
static void pop_worst(bench_heap *h, step *s)
{
    double limit = (double)h->error_ratio * bench_heap_luminance(h);
    s->n = 0;
    while (s->n < h->n_pop && h->n && (double)h->item[0].bound > limit &&
           h->n + h->n_done + 2 * s->n + 1 <= h->max_cut) {
        heap_item top = pop(h);
        s->parent[s->n++] = h->cluster[top.slot];
        h->free_slot[h->n_free++] = top.slot;
    }
}

uint32_t bench_heap_shade(bench_heap *h, const lc_point *p, const float org[3], uint64_t hash)
{
    const uint32_t root = h->tree->root[LC_LIGHT_POINT];
    step s;
    h->rep_slot = (uint32_t)(hash % h->tree->n_reps);
    h->n = h->n_done = h->n_free = h->n_used = 0;
    for (int k = 0; k < 3; k++) h->sum[k] = 0;
    s.n = 1;
    s.link[0] = root;
    s.link[1] = LC_LEAF; /* the root has no sibling */
    s.rep[0] = lc_rep_of(h->tree, root, h->rep_slot);
    run_kernels(h, &s, p, org);
    if (root & LC_LEAF || s.ub[0] > 0)
        add(h, root, s.rep[0], (const float[3]){ s.f[0][0], s.f[1][0], s.f[2][0] }, s.ub[0]);
    for (pop_worst(h, &s); s.n; pop_worst(h, &s)) {
        find_children(h, &s);
        run_kernels(h, &s, p, org);
        place_children(h, &s);
    }
    return h->n + h->n_done;
}
