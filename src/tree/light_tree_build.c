/* light_tree_build.c - the arrays of a light tree: made, filled by the builders, counted, freed. */
#include "tree/light_tree.h"

#include "shade/point_init.h"
#include "tree/slots.h"
#include "tree/tree_build.h"
#include "tree/tree_fill.h"

#include <string.h>

/* Greatest number of lights of one kind for which the exact builder is the default; measured:
 * tests/results/light-trees.md. */
#define AUTO_EXACT 10000

/* Scene indices of the lights of one kind; NULL where that is all lights as they are. */
static lc_status index_of_kind(const lc_context *ctx, const lc_light_tree_desc *desc, lc_light_kind kind,
                               uint32_t n, uint32_t **index)
{
    uint32_t at = 0;
    *index = NULL;
    if (n == desc->n_lights) return LC_OK;
    if (!(*index = lc_alloc_raw(ctx, n, sizeof **index))) return LC_ERR_MEMORY;
    for (size_t i = 0; i < desc->n_lights; i++)
        if (desc->lights[i].kind == kind) (*index)[at++] = (uint32_t)i;
    return LC_OK;
}

static lc_status build_kind(lc_light_tree *t, const lc_light_tree_desc *desc, lc_light_kind kind)
{
    const uint32_t n = t->n_of_kind[kind];
    uint32_t *index;
    lc_status st = index_of_kind(t->ctx, desc, kind, n, &index);
    if (st) return st;
    const lc_build_input in = { desc->lights, index, n, kind, lc_is_aimed(kind) ? desc->diag2 : 0 };
    const bool exact = desc->builder == LC_BUILDER_EXACT ||
                       (desc->builder == LC_BUILDER_AUTO && n <= AUTO_EXACT);
    lc_build_pair *pairs = lc_alloc_raw(t->ctx, n, sizeof *pairs);
    st = pairs ? LC_OK : LC_ERR_MEMORY;
    if (!st && n > 1) st = (exact ? lc_agglomerate : lc_ploc)(t->ctx, &in, pairs);
    if (!st) st = lc_tree_fill(t, &in, pairs);
    if (!st) t->roots[t->n_roots++] = t->root[kind];
    lc_free(t->ctx, pairs, n, sizeof *pairs);
    if (index) lc_free(t->ctx, index, n, sizeof *index);
    return st;
}

static size_t n_all_reps(const lc_light_tree *t)
{
    return t->n_reps > 1 ? (size_t)t->n_nodes * t->n_reps : 0;
}

static uint32_t n_nodes_of(const lc_light_tree *t, int kind)
{
    return t->first_node[kind + 1] - t->first_node[kind];
}

/* Allocates the records that only some kinds have. */
static bool alloc_own(lc_light_tree *t)
{
    for (int kind = 0; kind < LC_LIGHT_KINDS; kind++) {
        lc_own *own = &t->data.own[kind];
        const size_t size = lc_light_kinds[kind].own_size;
        own->first_node = t->first_node[kind];
        own->first_light = t->first_light[kind];
        if (!size || !t->n_of_kind[kind]) continue;
        own->node = lc_alloc(t->ctx, n_nodes_of(t, kind), size);
        own->light = lc_alloc(t->ctx, t->n_of_kind[kind], size);
        if (!own->node || !own->light) return false;
    }
    return true;
}

/* Counts the lights and allocates the arrays. */
static lc_status alloc_tree(lc_light_tree *t, const lc_light_tree_desc *desc)
{
    bool other = false; /* some attenuation is not 1/d^2 */
    bool by_lobe = false;
    for (size_t i = 0; i < desc->n_lights; i++) {
        const lc_light *l = &desc->lights[i];
        t->n_of_kind[l->kind]++;
        other |= lc_is_attenuated(l->kind) && !lc_inverse_square(l->atten);
        by_lobe |= lc_has_shine(l);
    }
    for (int k = 0; k < LC_LIGHT_KINDS; k++) {
        uint32_t n = t->n_of_kind[k];
        t->first_light[k + 1] = t->first_light[k] + n;
        t->first_node[k + 1] = t->first_node[k] + (n > 1 ? n - 1 : 0);
        t->root[k] = LC_NONE;
    }
    t->n_lights = t->first_light[LC_LIGHT_KINDS];
    t->n_nodes = t->first_node[LC_LIGHT_KINDS];
    t->data.nodes = lc_alloc_raw(t->ctx, t->n_nodes, sizeof *t->data.nodes);
    t->data.lights = lc_alloc_raw(t->ctx, t->n_lights, sizeof *t->data.lights);
    if (!t->data.nodes || !t->data.lights) return LC_ERR_MEMORY;
    if (t->n_groups && !(t->group = lc_alloc(t->ctx, t->n_lights, 1))) return LC_ERR_MEMORY;
    if (t->n_reps > 1 && !(t->reps = lc_alloc_raw(t->ctx, n_all_reps(t), sizeof *t->reps)))
        return LC_ERR_MEMORY;
    if (desc->keep_order && !(t->order = lc_alloc_raw(t->ctx, t->n_lights, sizeof *t->order)))
        return LC_ERR_MEMORY;
    t->data.spot_maps = desc->spot_maps;
    t->data.profiles = desc->profiles;
    if (!alloc_own(t)) return LC_ERR_MEMORY;
    if (by_lobe && !(t->data.light_shine = lc_alloc(t->ctx, t->n_lights, sizeof *t->data.light_shine)))
        return LC_ERR_MEMORY;
    if (!other) return LC_OK;
    t->data.node_atten = lc_alloc(t->ctx, t->n_nodes, sizeof *t->data.node_atten);
    t->data.light_atten = lc_alloc(t->ctx, t->n_lights, sizeof *t->data.light_atten);
    return t->data.node_atten && t->data.light_atten ? LC_OK : LC_ERR_MEMORY;
}

/* Whether two lights of a kind differ in their intensities at most. */
static bool are_alike(const lc_light_tree *t, lc_light_kind kind, uint32_t a, uint32_t b)
{
    const lc_light_rec *x = &t->data.lights[a], *y = &t->data.lights[b];
    const lc_atten *atten = t->data.light_atten;
    const lc_shine *shine = t->data.light_shine;
    const size_t own = lc_light_kinds[kind].own_size;
    return !memcmp(x->pos, y->pos, sizeof x->pos) && x->dir_a == y->dir_a && x->dir_b == y->dir_b &&
           (!atten || !memcmp(atten[a], atten[b], sizeof *atten)) &&
           (!shine || !memcmp(&shine[a], &shine[b], sizeof *shine)) &&
           (!own || !memcmp(lc_light_own(&t->data, kind, a), lc_light_own(&t->data, kind, b), own));
}

static bool is_alike(const lc_light_tree *t, uint32_t link)
{
    return link & LC_LEAF || (t->alike && t->alike[link]);
}

/* Finds the clusters of lights that are alike. Children come after their parents. Shadow rays to lights with
 * a size go to different points. */
static lc_status mark_alike(lc_light_tree *t, lc_light_kind kind)
{
    for (uint32_t id = t->first_node[kind + 1]; id-- > t->first_node[kind] && !lc_is_sized(kind);) {
        const lc_node *node = &t->data.nodes[id];
        if (node->half[0] + node->half[1] + node->half[2] > 0) continue;
        if (!is_alike(t, node->left) || !is_alike(t, node->right)) continue;
        if (!are_alike(t, kind, lc_rep_of(t, node->left, 0), lc_rep_of(t, node->right, 0))) continue;
        if (!t->alike && !(t->alike = lc_alloc(t->ctx, t->n_nodes, 1))) return LC_ERR_MEMORY;
        t->alike[id] = 1;
    }
    return LC_OK;
}

lc_status lc_light_tree_build(const lc_context *ctx, const lc_light_tree_desc *desc, lc_light_tree **out)
{
    *out = NULL;
    lc_light_tree *t = lc_alloc(ctx, 1, sizeof *t);
    if (!t) return LC_ERR_MEMORY;
    t->ctx = ctx;
    t->n_reps = desc->n_reps;
    t->n_groups = desc->n_groups;
    lc_status st = alloc_tree(t, desc);
    for (int kind = 0; kind < LC_LIGHT_KINDS && !st; kind++)
        if (t->n_of_kind[kind]) st = build_kind(t, desc, (lc_light_kind)kind);
    for (int kind = 0; kind < LC_LIGHT_KINDS && !st; kind++)
        st = lc_tree_choose_reps(t, (lc_light_kind)kind, desc->seed);
    for (int kind = 0; kind < LC_LIGHT_KINDS && !st; kind++) st = mark_alike(t, (lc_light_kind)kind);
    if (!st) st = lc_tree_share_groups(t);
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
    lc_free(t->ctx, t->data.nodes, t->n_nodes, sizeof *t->data.nodes);
    lc_free(t->ctx, t->data.lights, t->n_lights, sizeof *t->data.lights);
    lc_free(t->ctx, t->data.node_atten, t->n_nodes, sizeof *t->data.node_atten);
    lc_free(t->ctx, t->data.light_atten, t->n_lights, sizeof *t->data.light_atten);
    lc_free(t->ctx, t->data.light_shine, t->n_lights, sizeof *t->data.light_shine);
    for (int kind = 0; kind < LC_LIGHT_KINDS; kind++) {
        lc_free(t->ctx, t->data.own[kind].node, n_nodes_of(t, kind), lc_light_kinds[kind].own_size);
        lc_free(t->ctx, t->data.own[kind].light, t->n_of_kind[kind], lc_light_kinds[kind].own_size);
    }
    lc_free(t->ctx, t->reps, n_all_reps(t), sizeof *t->reps);
    lc_free(t->ctx, t->alike, t->n_nodes, 1);
    lc_free(t->ctx, t->group, t->n_lights, 1);
    lc_free(t->ctx, t->node_group, t->n_nodes, sizeof *t->node_group);
    lc_free(t->ctx, t->shares, t->cap_shares, sizeof *t->shares);
    lc_free(t->ctx, t->order, t->n_lights, sizeof *t->order);
    lc_free(t->ctx, t, 1, sizeof *t);
}

size_t lc_light_tree_bytes(const lc_light_tree *t)
{
    size_t node = sizeof *t->data.nodes + (t->data.node_atten ? sizeof(lc_atten) : 0);
    size_t light = sizeof *t->data.lights + (t->data.light_atten ? sizeof(lc_atten) : 0) +
                   (t->data.light_shine ? sizeof(lc_shine) : 0);
    size_t own = 0;
    for (int kind = 0; kind < LC_LIGHT_KINDS; kind++)
        own += ((size_t)n_nodes_of(t, kind) + t->n_of_kind[kind]) * lc_light_kinds[kind].own_size;
    return t->n_nodes * node + n_all_reps(t) * sizeof *t->reps + t->n_lights * light + own +
           (t->alike ? t->n_nodes : 0) + (t->order ? t->n_lights * sizeof *t->order : 0) +
           (t->group ? t->n_lights : 0) + (t->node_group ? t->n_nodes * sizeof *t->node_group : 0) +
           t->cap_shares * sizeof *t->shares;
}
