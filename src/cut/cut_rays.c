/* cut_rays.c - the shadow rays of a cut.
 *
 * A cluster's ray is pending while LC_PENDING is set in its `rep`; its V counts as 1 until then. Rays are
 * traced in groups of up to LC_CUT_BATCH, those of directional lights apart. An occluded representative sets
 * transfer and estimate to 0, and what blocked its ray is noted for proofs of occlusion. Where glass dims
 * rays, V is what it lets through, per channel.
 */
#include "cut/cut.h"
#include "cut/cut_gather.h"

#include "shade/point_init.h"

#include <string.h>

bool lc_cut_hidden(const lc_visibility *visibility, const lc_point *p, const float org[3], uint32_t n,
                   const float *const target[3], bool far, uint8_t *hidden, uint32_t *blocker,
                   float *const through[3])
{
    const lc_f3 ng = lc_f3_load(p->ng), from = far ? lc_f3_make(0, 0, 0) : lc_f3_load(p->pos);
    const bool dims = visibility->dimmed != NULL;
    const void *scene = visibility->moments ? visibility->moments[p->moment] : visibility->scene;
    if (dims) visibility->dimmed(scene, org, n, target, far, hidden, blocker, through);
    else visibility->hidden(scene, org, n, target, far, hidden, blocker);
    if (!(lc_f3_max_abs(ng) > 0)) return dims;
    for (uint32_t i = 0; i < n; i++)
        hidden[i] |= lc_f3_dot(ng, lc_f3_sub(lc_f3_make(target[0][i], target[1][i], target[2][i]), from)) < 0;
    return dims;
}

/* Rays of some clusters of a list. */
typedef struct {
    uint32_t at[LC_CUT_BATCH]; /* index in the list */
    lc_cut_list *list[LC_CUT_BATCH];
    uint32_t n;
    float target[3][LC_CUT_BATCH];
} ray_group;

static double luminance_at(const lc_cut_list *list, uint32_t at)
{
    return (double)lc_luminance(lc_f3_make(list->e[0][at], list->e[1][at], list->e[2][at]));
}

/* Takes the answer to an element's ray into account; through: what glass leaves of it, or NULL. */
static void settle(const lc_cut *c, lc_cut_list *list, uint32_t at, bool hidden, const float *through,
                   uint32_t blocker, double *change)
{
    *change -= luminance_at(list, at);
    if (!hidden) {
        for (int k = 0; k < 3; k++) {
            list->transfer[k][at] *= through[k];
            list->e[k][at] *= through[k];
        }
        *change += luminance_at(list, at);
        return;
    }
    if (c->occlusion) lc_occlusion_note(c->occlusion, list->rep[at] & c->light_mask, blocker);
    for (int k = 0; k < 3; k++) list->transfer[k][at] = list->e[k][at] = 0;
}

static double trace_group(const lc_cut *c, const lc_cut_step *s, const ray_group *g, bool far)
{
    uint8_t hidden[LC_CUT_BATCH];
    uint32_t blocker[LC_CUT_BATCH];
    float v[3][LC_CUT_BATCH], *const through[3] = { v[0], v[1], v[2] };
    const float *const target[3] = { g->target[0], g->target[1], g->target[2] };
    double change = 0;
    lc_phase_end(s->stats, LC_PHASE_REFINE);
    const bool dims = lc_cut_hidden(&c->visibility, s->point, s->org, g->n, target, far, hidden,
                                    c->occlusion ? blocker : NULL, through);
    lc_phase_end(s->stats, LC_PHASE_SHADOW);
    s->stats->shadow_rays += g->n;
    for (uint32_t i = 0; i < g->n; i++) {
        if (!hidden[i] && !dims) continue;
        const float *left = dims ? (const float[3]){ v[0][i], v[1][i], v[2][i] } : NULL;
        settle(c, g->list[i], g->at[i], hidden[i], left, c->occlusion ? blocker[i] : LC_NONE, &change);
    }
    return change;
}

/* Adds the pending ray of an element to a group. */
static void add_ray(const lc_cut *c, const lc_cut_step *s, lc_cut_list *list, uint32_t i, ray_group *g)
{
    const uint32_t rep = list->rep[i] & c->light_mask;
    const lc_light_rec *light = &c->tree->data.lights[rep];
    float to[3];
    lc_light_target(lc_kind_of_light(c->tree, rep), light, s->point, to);
    for (int k = 0; k < 3; k++) g->target[k][g->n] = to[k];
    g->list[g->n] = list;
    g->at[g->n++] = i;
    list->rep[i] &= ~LC_PENDING;
}

static bool has_far(const lc_light_tree *t)
{
    bool far = false;
    for (int kind = 0; kind < LC_LIGHT_KINDS; kind++)
        far |= t->n_of_kind[kind] && lc_is_far((lc_light_kind)kind);
    return far;
}

#define IN_LIST_BITS 30 /* of a place: the element; above, its list */
#define IN_LIST ((1u << IN_LIST_BITS) - 1)

/* Appends the places of a list's pending rays to those of others, `in_list` added. Returns their number. */
static uint32_t find_pending(const lc_cut_list *list, uint32_t first, uint32_t in_list, uint32_t *place,
                             uint32_t n)
{
    for (uint32_t i = first; i < list->n; i++) {
        place[n] = i | in_list;
        n += list->rep[i] >> 31; /* LC_PENDING */
    }
    return n;
}

/* The places of all pending rays by their keys, point and whether they go far, which are counted in `end`:
 * key k's are order[end[k - 1]] to order[end[k]]. `split` is empty between rounds, so its memory is free. */
static const uint32_t *sort_rays(const lc_cut *c, uint32_t n_keys, uint32_t *end)
{
    const lc_cut_list *const lists[] = { &c->open, &c->kept, &c->leaf };
    uint32_t *place = c->split.link, *key = c->split.rep, *order = (uint32_t *)(void *)c->scratch, n = 0;
    const bool all_near = !has_far(c->tree);
    for (uint32_t k = 0; k < 3; k++)
        n = find_pending(lists[k], k == 1 ? c->n_traced : 0, k << IN_LIST_BITS, place, n);
    memset(end, 0, (n_keys + 1) * sizeof *end);
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t rep = lists[place[i] >> IN_LIST_BITS]->rep[place[i] & IN_LIST],
                       light = rep & c->light_mask;
        key[i] = 2 * lc_cut_point_of(c, rep) + (!all_near && lc_is_far(lc_kind_of_light(c->tree, light)));
        end[key[i] + 1]++;
        __builtin_prefetch(&c->tree->data.lights[light]);
    }
    for (uint32_t k = 0; k < n_keys; k++) end[k + 1] += end[k];
    for (uint32_t i = 0; i < n; i++) order[end[key[i]]++] = place[i];
    return order;
}

/* The rays of each point together, of all lists. */
double lc_cut_gather_trace(lc_cut *c, lc_cut_step *s)
{
    lc_cut_list *const lists[] = { &c->open, &c->kept, &c->leaf };
    uint32_t end[2 * LC_GATHER_MOST + 1];
    const uint32_t n_keys = 2 * c->gather->n, *order = sort_rays(c, n_keys, end);
    double change = 0;
    ray_group g;
    for (uint32_t key = 0, i = 0; key < n_keys; key++) {
        lc_cut_use_point(c, s, key / 2);
        while (i < end[key]) {
            for (g.n = 0; i < end[key] && g.n < LC_CUT_BATCH; i++)
                add_ray(c, s, lists[order[i] >> IN_LIST_BITS], order[i] & IN_LIST, &g);
            change += trace_group(c, s, &g, key & 1);
        }
    }
    lc_cut_leaves_done(c);
    return change;
}

/* Traces the pending rays of a list from element `first` on. */
static double trace_list(const lc_cut *c, lc_cut_step *s, lc_cut_list *list, uint32_t first)
{
    const lc_light_tree *t = c->tree;
    double change = 0;
    ray_group near, far;
    for (uint32_t i = first; i < list->n;) {
        near.n = far.n = 0;
        for (; i < list->n && near.n < LC_CUT_BATCH && far.n < LC_CUT_BATCH; i++) {
            const uint32_t rep = list->rep[i];
            if (!(rep & LC_PENDING)) continue;
            add_ray(c, s, list, i, lc_is_far(lc_kind_of_light(t, rep & ~LC_PENDING)) ? &far : &near);
        }
        if (near.n) change += trace_group(c, s, &near, false);
        if (far.n) change += trace_group(c, s, &far, true);
    }
    return change;
}

void lc_cut_leaves_done(lc_cut *c)
{
    for (uint32_t i = 0; i < c->leaf.n; i++)
        for (int k = 0; k < 3; k++) c->done_sum[k] += (double)c->leaf.e[k][i];
    if (c->of_group) lc_cut_add_to_groups(c, &c->leaf);
    c->leaf.n = 0;
}

/* Two partial sums of each group, as additions to one would wait for each other. A cluster of several groups
 * gives each its share of the intensity. */
void lc_cut_add_to_groups(const lc_cut *c, const lc_cut_list *list)
{
    const lc_light_tree *t = c->tree;
    double odd[LC_MAX_GROUPS][3];
    memset(odd, 0, t->n_groups * sizeof *odd);
    for (uint32_t i = 0; i < list->n; i++) {
        double(*const sums)[3] = i & 1 ? odd : c->of_group;
        const uint32_t link = list->link[i];
        const uint32_t g = lc_cut_is_node(link) ? t->node_group[link]
                                                : t->group[list->rep[i] & c->light_mask];
        if (g < LC_MAX_GROUPS) {
            for (int k = 0; k < 3; k++) sums[g][k] += (double)list->e[k][i];
            continue;
        }
        const lc_group_share *share = &t->shares[g - LC_MAX_GROUPS];
        do
            for (int k = 0; k < 3; k++)
                sums[share->group & ~LC_LAST_SHARE][k] += (double)list->e[k][i] * (double)share->part[k];
        while (!(share++->group & LC_LAST_SHARE));
    }
    for (uint32_t g = 0; g < t->n_groups; g++)
        for (int k = 0; k < 3; k++) c->of_group[g][k] += odd[g][k];
}

double lc_cut_trace_leaves(lc_cut *c, lc_cut_step *s)
{
    double change = trace_list(c, s, &c->leaf, 0);
    lc_cut_leaves_done(c);
    return change;
}

double lc_cut_trace(lc_cut *c, lc_cut_step *s)
{
    if (c->gather) return lc_cut_gather_trace(c, s);
    double change = trace_list(c, s, &c->open, 0);
    change += trace_list(c, s, &c->kept, c->n_traced);
    return change + lc_cut_trace_leaves(c, s);
}

/* ---- rays that someone else traces ---- */

/* Whether a ray goes behind the geometric surface, so that it is occluded. */
static bool is_behind(const lc_point *p, const float to[3], bool far)
{
    const lc_f3 from = far ? lc_f3_make(0, 0, 0) : lc_f3_load(p->pos);
    return lc_f3_dot(lc_f3_load(p->ng), lc_f3_sub(lc_f3_load(to), from)) < 0;
}

uint32_t lc_cut_take_rays(lc_cut *c, const lc_point *p, lc_cut_cursor *next, uint32_t room,
                          const lc_cut_rays *out, double *change)
{
    lc_cut_list *const lists[LC_CUT_RAY_LISTS] = { &c->open, &c->kept, &c->leaf };
    const bool has_ng = lc_f3_max_abs(lc_f3_load(p->ng)) > 0;
    uint32_t n = 0;
    for (; next->list < LC_CUT_RAY_LISTS; next->list++, next->at = 0) {
        lc_cut_list *list = lists[next->list];
        uint32_t i = next->list == 1 && next->at < c->n_traced ? c->n_traced : next->at;
        for (; i < list->n && n < room; i++) {
            if (!(list->rep[i] & LC_PENDING)) continue;
            const uint32_t rep = list->rep[i] &= ~LC_PENDING;
            const lc_light_kind kind = lc_kind_of_light(c->tree, rep);
            const lc_light_rec *light = &c->tree->data.lights[rep];
            float to[3];
            lc_light_target(kind, light, p, to);
            if (has_ng && is_behind(p, to, lc_is_far(kind))) {
                settle(c, list, i, true, NULL, LC_NONE, change);
                continue;
            }
            for (int k = 0; k < 3; k++) out->to[k][n] = to[k];
            out->light[n] = rep;
            out->far[n] = lc_is_far(kind);
            out->list[n] = (uint8_t)next->list;
            out->at[n++] = i;
        }
        next->at = i;
        if (i < list->n) break;
    }
    return n;
}

void lc_cut_settle(lc_cut *c, const lc_cut_rays *rays, uint32_t n, const uint8_t *hidden,
                   float *const through[3], const uint32_t *blocker, double *change)
{
    lc_cut_list *const lists[LC_CUT_RAY_LISTS] = { &c->open, &c->kept, &c->leaf };
    for (uint32_t i = 0; i < n; i++) {
        if (!hidden[i] && !through) continue;
        const float *left = through ? (const float[3]){ through[0][i], through[1][i], through[2][i] } : NULL;
        settle(c, lists[rays->list[i]], rays->at[i], hidden[i], left, blocker ? blocker[i] : LC_NONE, change);
    }
}
