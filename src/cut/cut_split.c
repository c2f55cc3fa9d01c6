/* cut_split.c - replaces clusters by their children, LC_CUT_BATCH at a time.
 *
 * One child has the parent's representative (slots, light_tree.h): it takes over the transfer M G V, and only
 * its summed intensity is new. The other child costs one estimate and, unless that is 0, one shadow ray. A
 * child whose bound is 0 contributes exactly 0 and is done; so is a light, which is exact.
 */
#include "cut/cut_gather.h"

/* Finds the children of the batch and their new representatives. */
static void find_children(const lc_cut *c, lc_cut_step *s)
{
    const lc_tree_data *t = &c->tree->data;
    const uint32_t *parent = c->split.link + s->pairs.first, *own = c->split.rep + s->pairs.first;
    for (uint32_t i = 0; i < s->pairs.n; i++) {
        const lc_node *node = &t->nodes[parent[i]];
        uint32_t rep = lc_cut_rep_of(c, node->left), right_is_new = rep == (own[i] & ~LC_PENDING);
        s->link[2 * i] = node->left;
        s->link[2 * i + 1] = node->right;
        s->intensity[2 * i] = lc_cut_intensity_of(t, node->left);
        s->intensity[2 * i + 1] = lc_cut_intensity_of(t, node->right);
        s->rep[i] = right_is_new ? lc_cut_rep_of(c, node->right) : rep;
        s->fresh[2 * i] = (float)(1 - right_is_new);
        s->fresh[2 * i + 1] = (float)right_is_new;
        __builtin_prefetch(&t->lights[s->rep[i]]);
    }
}

/* Bounds of the children of pairs first .. first + n - 1; 1 for lights, which need none. */
static void bound_children(const lc_cut *c, lc_cut_step *s, uint32_t first, uint32_t n, lc_light_kind kind)
{
    const uint32_t *link = s->link + 2 * first;
    uint32_t m = 0;
    for (uint32_t i = 0; i < 2 * n; i++) {
        s->node[m] = link[i];
        m += !(link[i] & LC_LEAF);
    }
    s->stats->bounds += m;
    s->n_bounded += m;
    if (m == 2 * n) {
        lc_cut_bounds(c, s, link, m, kind, s->bound + 2 * first);
        return;
    }
    lc_cut_bounds(c, s, s->node, m, kind, s->node_bound);
    for (uint32_t i = 0, k = 0; i < 2 * n; i++) {
        bool leaf = link[i] & LC_LEAF;
        s->bound[2 * first + i] = leaf ? 1 : s->node_bound[k];
        k += !leaf;
    }
}

/* How many of the batch's parents from the i-th on are of its kind. */
static uint32_t run_length(const lc_cut *c, const lc_cut_step *s, uint32_t i, lc_light_kind kind)
{
    const lc_light_tree *t = c->tree;
    const uint32_t *parent = c->split.link + s->pairs.first;
    uint32_t run = 1;
    if (t->n_of_kind[kind] == t->n_lights) return s->pairs.n - i;
    while (i + run < s->pairs.n && lc_cut_kind_of(c, parent[i + run]) == kind) run++;
    return run;
}

/* Counts the children that are done, which is all but n_placed, and writes their links where they are needed.
 */
static void count_done(lc_cut *c, const lc_cut_step *s, uint32_t n_placed)
{
    uint32_t at = c->n_done;
    c->n_done += 2 * s->pairs.n - n_placed;
    c->n_zero_bound += s->n_bounded - n_placed;
    for (uint32_t i = 0; i < 2 * s->pairs.n && (c->record || c->start_out); i++)
        if (!(s->bound[i] > 0) || s->link[i] & LC_LEAF) c->done[at++] = s->link[i];
}

double lc_cut_split(lc_cut *c, lc_cut_step *s, float limit)
{
    double change = 0;
    uint32_t n = c->split.n;
    c->split.n = 0;
    s->pairs.limit = limit;
    for (uint32_t at = 0; at < n; at += s->pairs.n) {
        uint32_t run, n_before = c->open.n + c->kept.n;
        s->pairs.first = at;
        s->pairs.n = n - at < LC_CUT_BATCH ? n - at : LC_CUT_BATCH;
        s->n_bounded = 0;
        if (c->gather) lc_cut_gather_children(c, s);
        else find_children(c, s);
        lc_phase_end(s->stats, LC_PHASE_REFINE);
        for (uint32_t i = 0; i < s->pairs.n; i += run) {
            lc_light_kind kind = lc_cut_kind_of(c, c->split.link[at + i]);
            run = run_length(c, s, i, kind);
            if (c->gather) lc_cut_gather_bounds(c, s, i, run, kind);
            else bound_children(c, s, i, run, kind);
            lc_phase_end(s->stats, LC_PHASE_BOUNDS);
            if (c->gather) lc_cut_gather_estimates(c, s, i, run, kind);
            else lc_cut_estimate(c, s, i, run, kind);
            lc_phase_end(s->stats, LC_PHASE_ESTIMATES);
        }
        change += c->ctx->cut_kernels->place(&s->pairs, &c->open, &c->kept, &c->leaf);
        count_done(c, s, c->open.n + c->kept.n - n_before);
        lc_phase_end(s->stats, LC_PHASE_REFINE);
    }
    return change;
}
