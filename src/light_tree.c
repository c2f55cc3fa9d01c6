/* light_tree.c - lights by kind -> agglomerative trees -> virtual root -> flat treelets -> representatives. */
#include "light_tree.h"

#include "cluster.h"
#include "rng.h"
#include "shade.h"
#include "tree_build.h"

#include <string.h>

#define TREELET_PAIRS 7 /* 2 + 4 + 8 nodes */

/* Of one kind: 0 .. n - 1 are the lights, n .. 2n - 2 the merges in order. */
typedef struct {
    lc_cluster c;
    uint32_t child[2];       /* LC_NONE for a light */
    uint32_t light;          /* scene index, of a light */
    uint64_t hash;           /* of the set of lights and how it was merged, for representatives */
} build_node;

typedef struct {
    const lc_context *ctx;
    const lc_light_tree_desc *desc;
    build_node *nodes; /* each kind's 2n - 1 in turn, then the virtual ones */
    size_t n_nodes, cap_nodes;
    uint32_t root;
    uint32_t *id; /* flat id of a build node */
    lc_light_tree *tree;
} builder;

static build_node merge_nodes(const build_node *nodes, uint32_t a, uint32_t b)
{
    const build_node *x = &nodes[a], *y = &nodes[b];
    build_node out = { .child = { a, b }, .light = LC_NONE };
    lc_cluster_join(&out.c, &x->c, &y->c);
    out.hash = x->hash < y->hash ? lc_hash2(x->hash, y->hash) : lc_hash2(y->hash, x->hash);
    return out;
}

static void add_leaf(builder *b, build_node *node, size_t light)
{
    *node = (build_node){ .child = { LC_NONE, LC_NONE }, .light = (uint32_t)light };
    lc_cluster_from_light(&node->c, &b->desc->lights[light]);
    node->hash = lc_mix(light);
}

static lc_status merge_kind(builder *b, lc_light_kind kind, uint32_t n, uint32_t *index, lc_build_pair *pairs)
{
    build_node *nodes = b->nodes + b->n_nodes;
    uint32_t base = (uint32_t)b->n_nodes;
    for (uint32_t i = 0; i < n; i++) index[i] = nodes[i].light;
    lc_build_input in = { b->desc->lights, index, n, kind, kind == LC_LIGHT_ORIENTED ? b->desc->diag2 : 0 };
    lc_status st = lc_agglomerate(b->ctx, &in, pairs);
    for (uint32_t i = 0; i + 1 < n && !st; i++)
        nodes[n + i] = merge_nodes(b->nodes, base + pairs[i].child[0], base + pairs[i].child[1]);
    return st;
}

/* Builds the tree of one kind at b->nodes + b->n_nodes; *root gets its root or LC_NONE. */
static lc_status build_kind(builder *b, lc_light_kind kind, uint32_t *root)
{
    build_node *nodes = b->nodes + b->n_nodes;
    uint32_t n = 0;
    for (size_t i = 0; i < b->desc->n_lights; i++)
        if (b->desc->lights[i].kind == kind) add_leaf(b, &nodes[n++], i);
    *root = LC_NONE;
    if (!n) return LC_OK;
    uint32_t *index = lc_alloc_raw(b->ctx, n, sizeof *index);
    lc_build_pair *pairs = lc_alloc_raw(b->ctx, n, sizeof *pairs);
    lc_status st = index && pairs ? merge_kind(b, kind, n, index, pairs) : LC_ERR_MEMORY;
    lc_free(b->ctx, index, n, sizeof *index);
    lc_free(b->ctx, pairs, n, sizeof *pairs);
    if (st) return st;
    b->n_nodes += 2 * (size_t)n - 1;
    b->tree->n_of_kind[kind] = n;
    *root = (uint32_t)(b->n_nodes - 1);
    return LC_OK;
}

static lc_status build_all(builder *b)
{
    uint32_t root = LC_NONE, r;
    for (int kind = 0; kind < LC_LIGHT_KINDS; kind++) {
        lc_status st = build_kind(b, (lc_light_kind)kind, &r);
        if (st) return st;
        if (r == LC_NONE) continue;
        if (root == LC_NONE) {
            root = r;
        } else { /* a virtual node; only sums and hash of it mean anything */
            b->nodes[b->n_nodes] = merge_nodes(b->nodes, root, r);
            root = (uint32_t)b->n_nodes++;
        }
    }
    b->root = root;
    return LC_OK;
}

/* Children of different kinds: a virtual node takes its first child's kind, and kinds are joined in rising order. */
static bool is_virtual(const builder *b, const build_node *n)
{
    return b->nodes[n->child[0]].c.kind != b->nodes[n->child[1]].c.kind;
}

static void place_pair(builder *b, const build_node *parent, uint32_t pair)
{
    lc_light_tree *t = b->tree;
    t->pair_kind[pair] = is_virtual(b, parent) ? LC_PAIR_MIXED : (uint8_t)b->nodes[parent->child[0]].c.kind;
    for (uint32_t i = 0; i < 2; i++) {
        uint32_t id = 2 * pair + i;
        b->id[parent->child[i]] = id;
        lc_cluster_store(&b->nodes[parent->child[i]].c, &t->blocks[id / LC_BLOCK], id % LC_BLOCK);
    }
}

/* Gives every build node its flat id: treelets depth first, pairs of a treelet level by level. The lights are stored in
 * the order of the leaves, so that clusters near each other find theirs near each other. */
static lc_status flatten(builder *b)
{
    lc_light_tree *t = b->tree;
    uint32_t *stack = lc_alloc(b->ctx, b->n_nodes, sizeof *stack), n = 0, pair = 1, n_lights = 0;
    if (!stack) return LC_ERR_MEMORY;
    b->id[b->root] = 0;
    lc_cluster_store(&b->nodes[b->root].c, &t->blocks[0], 0);
    t->pair_kind[0] = (uint8_t)b->nodes[b->root].c.kind;
    stack[n++] = b->root;
    while (n) {
        uint32_t queue[2 * TREELET_PAIRS + 1], head = 0, tail = 0, placed = 0;
        queue[tail++] = stack[--n];
        for (; head < tail; head++) {
            build_node *node = &b->nodes[queue[head]];
            uint32_t id = b->id[queue[head]];
            if (node->child[0] == LC_NONE) {
                lc_light_rec_init(&t->lights[n_lights], &b->desc->lights[node->light]);
                node->light = n_lights++;
                t->link[id] = LC_LEAF | node->light;
            } else if (placed < TREELET_PAIRS) {
                t->link[id] = 2 * pair;
                place_pair(b, node, pair++);
                placed++;
                queue[tail++] = node->child[0];
                queue[tail++] = node->child[1];
            } else {
                stack[n++] = queue[head];
            }
        }
    }
    lc_free(b->ctx, stack, b->n_nodes, sizeof *stack);
    return LC_OK;
}

/* Children come before parents among the build nodes, so one pass bottom-up sets all slots. */
static void choose_reps(builder *b)
{
    lc_light_tree *t = b->tree;
    for (size_t i = 0; i < b->n_nodes; i++) {
        const build_node *n = &b->nodes[i];
        uint32_t *rep = t->rep + (size_t)b->id[i] * t->n_reps;
        if (n->child[0] == LC_NONE) {
            for (uint32_t s = 0; s < t->n_reps; s++) rep[s] = n->light;
            continue;
        }
        double left = lc_cluster_scalar(&b->nodes[n->child[0]].c), right = lc_cluster_scalar(&b->nodes[n->child[1]].c);
        for (uint32_t s = 0; s < t->n_reps; s++) {
            double u = lc_unit(lc_hash4(b->desc->seed, n->hash, s, 0));
            uint32_t child = n->child[u * (left + right) < left ? 0 : 1];
            rep[s] = t->rep[(size_t)b->id[child] * t->n_reps + s];
        }
    }
}

static lc_status alloc_tree(builder *b)
{
    lc_light_tree *t = b->tree;
    size_t n = b->desc->n_lights;
    t->n_lights = (uint32_t)n;
    t->n_pairs = n; /* 1 for the root, n - 1 for the inner nodes, virtual ones included */
    t->n_blocks = (2 * t->n_pairs + LC_BLOCK - 1) / LC_BLOCK;
    t->blocks = lc_alloc(b->ctx, t->n_blocks, sizeof *t->blocks);
    t->link = lc_alloc(b->ctx, 2 * t->n_pairs, sizeof *t->link);
    t->pair_kind = lc_alloc(b->ctx, t->n_pairs, 1);
    t->rep = lc_alloc(b->ctx, 2 * t->n_pairs * t->n_reps, sizeof *t->rep);
    t->lights = lc_alloc(b->ctx, n, sizeof *t->lights);
    b->cap_nodes = 2 * n;
    b->nodes = lc_alloc(b->ctx, b->cap_nodes, sizeof *b->nodes);
    b->id = lc_alloc(b->ctx, b->cap_nodes, sizeof *b->id);
    bool ok = t->blocks && t->link && t->pair_kind && t->rep && t->lights && b->nodes && b->id;
    return ok ? LC_OK : LC_ERR_MEMORY;
}

lc_status lc_light_tree_build(const lc_context *ctx, const lc_light_tree_desc *desc, lc_light_tree **out)
{
    *out = NULL;
    lc_light_tree *t = lc_alloc(ctx, 1, sizeof *t);
    if (!t) return LC_ERR_MEMORY;
    t->ctx = ctx;
    t->n_reps = desc->n_reps;
    builder b = { .ctx = ctx, .desc = desc, .tree = t };
    lc_status st = LC_OK;
    if (desc->n_lights) {
        st = alloc_tree(&b);
        if (!st) st = build_all(&b);
        if (!st) st = flatten(&b);
        if (!st) choose_reps(&b);
        lc_free(ctx, b.nodes, b.cap_nodes, sizeof *b.nodes);
        lc_free(ctx, b.id, b.cap_nodes, sizeof *b.id);
    }
    if (st) {
        lc_light_tree_destroy(t);
        return st;
    }
    *out = t;
    return LC_OK;
}

void lc_light_tree_destroy(lc_light_tree *t)
{
    if (!t) return;
    lc_free(t->ctx, t->blocks, t->n_blocks, sizeof *t->blocks);
    lc_free(t->ctx, t->link, 2 * t->n_pairs, sizeof *t->link);
    lc_free(t->ctx, t->pair_kind, t->n_pairs, 1);
    lc_free(t->ctx, t->rep, 2 * t->n_pairs * t->n_reps, sizeof *t->rep);
    lc_free(t->ctx, t->lights, t->n_lights, sizeof *t->lights);
    lc_free(t->ctx, t, 1, sizeof *t);
}

size_t lc_light_tree_bytes(const lc_light_tree *t)
{
    return sizeof *t + t->n_blocks * sizeof *t->blocks + 2 * t->n_pairs * (sizeof *t->link + t->n_reps * sizeof *t->rep)
           + t->n_pairs + t->n_lights * sizeof *t->lights;
}
