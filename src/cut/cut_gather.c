/* cut_gather.c - what is different in a cut whose receiver is a gather cluster (gather.h).
 *
 * Clusters of lights are paired with all points. Where a cluster's child is a light, it is paired with all
 * points still: its link is LC_PAIR with level 0, and it stays among the clusters with a bound. Splitting it
 * halves its range of points. With one point left the pair is exact, a light like any other in a cut.
 *
 *     representative   LC_PENDING | point << light_bits | light
 *     bound            of a cluster: by the kernel for the box of all points; of points with a lobe, the mean
 *                      of the points' own bounds, of some where there are many
 *                      of a child that is a light: the parent's times the share of the intensity; without
 *                      lobes times OF_PAIR, as points this near mostly see a light, or none does; no bound,
 *                      but z is found with it
 *                      of a range: the whole range's times the share of the points' weight
 *
 * New representatives are dealt out to points, PER_POINT to each, neighbours to different ones, since what is
 * near in the tree is hidden from a point together. So rays and estimates still come in groups of one origin.
 */
#include "cut/cut_gather.h"

#include "base/rng.h"
#include "shade/light_target.h"

#include <string.h>

#define UP (1 + 0x1p-20f) /* above the rounding of a few products */
#define OF_PAIR 0.35f     /* chosen; see above */
#define PER_POINT 8      /* new representatives of a batch for each of its points */
#define BOUND_POINTS 16  /* of a gather cluster with lobes, spread over the order of its points */
#define OF_TARGET 0x1p-20f /* of a light's coordinates: what rounding may move its targets by */
#define GOLDEN 0x9e3779b9u
#define END_OF_CHAIN 255 /* no place in a batch */

void lc_cut_use_point(const lc_cut *c, lc_cut_step *s, uint32_t at)
{
    const lc_gather_point *point = lc_gather_at(c->gather, at);
    s->point = point->p;
    s->org = point->org;
}

static uint32_t next_point(lc_cut *c)
{
    const uint32_t u = (uint32_t)(c->hash >> 32) + GOLDEN * c->turn++;
    return lc_gather_draw(c->gather, 0, c->gather->n, u);
}

void lc_cut_deal(lc_cut *c, lc_cut_step *s, uint32_t first, uint32_t n)
{
    const uint32_t n_points = (n + PER_POINT - 1) / PER_POINT;
    for (uint32_t i = first; i < first + n; i++)
        s->at[i] = i < first + n_points ? next_point(c) : s->at[i - n_points];
}

/* A light's intensity times a range's share of the points' weight. */
static const float *part_of(const lc_cut *c, lc_cut_step *s, uint32_t child, const float *intensity,
                            uint32_t lo, uint32_t hi)
{
    const lc_gather *g = c->gather;
    const float share = (float)(g->below[hi] - g->below[lo]) / (float)g->below[g->n];
    for (int k = 0; k < 3; k++) s->part[child][k] = intensity[k] * share;
    return s->part[child];
}

/* A light and a range of the points, as a child: exact where the range is one point. */
static uint32_t pair_link(const lc_cut *c, uint32_t light, uint32_t level, uint32_t points)
{
    return points > 1 ? LC_PAIR | level << c->light_bits | light : LC_LEAF | light;
}

/* Halves the range of points of a batch's i-th parent. */
static void halve(const lc_cut *c, lc_cut_step *s, uint32_t i, uint32_t link, uint32_t own)
{
    const uint32_t n = c->gather->n, light = link & c->light_mask,
                   level = ((link & ~LC_PAIR) >> c->light_bits) + 1, point = lc_cut_point_of(c, own);
    uint32_t lo, hi, half_lo, half_hi;
    lc_gather_range(n, level - 1, point, &lo, &hi);
    lc_gather_range(n, level, point, &half_lo, &half_hi);
    const uint32_t points = half_hi - half_lo, rest = hi - lo - points,
                   from = half_lo == lo ? half_hi : lo, to = from + rest;
    const float *intensity = lc_cut_intensity_of(&c->tree->data, LC_LEAF | light);
    s->link[2 * i] = pair_link(c, light, level, points);
    s->link[2 * i + 1] = pair_link(c, light, level, rest);
    s->intensity[2 * i] = part_of(c, s, 2 * i, intensity, half_lo, half_hi);
    s->intensity[2 * i + 1] = part_of(c, s, 2 * i + 1, intensity, from, to);
    s->fresh[2 * i] = 0;
    s->fresh[2 * i + 1] = 1;
    s->rep[i] = light;
    s->at[i] = lc_gather_draw(c->gather, from, to, (uint32_t)(lc_hash4(c->hash, light, level, point) >> 32));
}

void lc_cut_gather_children(lc_cut *c, lc_cut_step *s)
{
    const lc_tree_data *t = &c->tree->data;
    const uint32_t *parent = c->split.link + s->pairs.first, *own = c->split.rep + s->pairs.first;
    lc_cut_deal(c, s, 0, s->pairs.n);
    for (uint32_t i = 0; i < s->pairs.n; i++) {
        if (!lc_cut_is_node(parent[i])) {
            halve(c, s, i, parent[i], own[i]);
            continue;
        }
        const lc_node *node = &t->nodes[parent[i]];
        const uint32_t rep = lc_cut_rep_of(c, node->left), right_is_new = rep == (own[i] & c->light_mask),
                       child[2] = { node->left, node->right };
        for (uint32_t k = 0; k < 2; k++) {
            const uint32_t light = child[k] & ~LC_LEAF;
            s->link[2 * i + k] = child[k] & LC_LEAF ? pair_link(c, light, 0, c->gather->n) : child[k];
            s->intensity[2 * i + k] = lc_cut_intensity_of(t, child[k]);
        }
        s->rep[i] = right_is_new ? lc_cut_rep_of(c, node->right) : rep;
        s->fresh[2 * i] = (float)(1 - right_is_new);
        s->fresh[2 * i + 1] = (float)right_is_new;
        __builtin_prefetch(&t->lights[s->rep[i]]);
    }
}

/* What the bound of a child that is a light is multiplied by: a lobe may be met by few of the points. */
static float of_pair(const lc_cut *c) { return c->gather->lobed ? 1 : OF_PAIR; }

/* The greatest share of a channel that a light has in its cluster. */
static float share_of(const float *light, const float *cluster)
{
    float most = 0;
    for (int k = 0; k < 3; k++)
        if (light[k] > 0 && light[k] / cluster[k] > most) most = light[k] / cluster[k];
    return most;
}

void lc_cut_gather_bounds(const lc_cut *c, lc_cut_step *s, uint32_t first, uint32_t n, lc_light_kind kind)
{
    const uint32_t *link = s->link + 2 * first, at = s->pairs.first;
    uint32_t m = 0;
    for (uint32_t i = 0; i < 2 * n; i++) {
        s->node[m] = link[i];
        m += lc_cut_is_node(link[i]);
        s->n_bounded += !(link[i] & LC_LEAF);
    }
    s->stats->bounds += m;
    lc_cut_bounds(c, s, s->node, m, kind, s->node_bound);
    for (uint32_t i = 2 * first, k = 0; i < 2 * (first + n); i++) {
        const uint32_t own = s->link[i], parent = c->split.link[at + i / 2];
        const float above = c->split.bound[at + i / 2] / c->split.weight[at + i / 2];
        if (own & LC_LEAF) {
            s->bound[i] = 1;
        } else if (!(own & LC_PAIR)) {
            s->bound[i] = s->node_bound[k++];
        } else if (lc_cut_is_node(parent)) {
            s->bound[i] = above * of_pair(c) *
                          share_of(s->intensity[i], c->tree->data.nodes[parent].intensity) * UP;
        } else {
            const float *other = s->intensity[i ^ 1];
            const float both = s->intensity[i][0] + s->intensity[i][1] + s->intensity[i][2];
            s->bound[i] = above * (both / (both + other[0] + other[1] + other[2])) * UP;
        }
    }
}

/* Adds the bounds of one of the points, times a factor. */
static void add_bounds(const lc_cut *c, uint32_t at, const uint32_t *node, uint32_t n, lc_light_kind kind,
                       float factor, float *sum)
{
    float bound[2 * LC_CUT_BATCH + LC_LANES];
    c->ctx->shade_kernels->bounds(&c->tree->data, node, n, kind, lc_gather_at(c->gather, at)->p, bound);
    for (uint32_t i = 0; i < n; i++) sum[i] += bound[i] * factor;
}

/* The mean over the points; of more than BOUND_POINTS, over some, or over all where these have 0. */
void lc_cut_lobed_bounds(const lc_cut *c, const uint32_t *node, uint32_t n, lc_light_kind kind, float *bound)
{
    const uint32_t all = c->gather->n, some = all < BOUND_POINTS ? all : BOUND_POINTS;
    uint32_t dark[2 * LC_CUT_BATCH], at[2 * LC_CUT_BATCH], n_dark = 0;
    float sum[2 * LC_CUT_BATCH] = { 0 };
    for (uint32_t i = 0; i < n; i++) bound[i] = 0;
    for (uint32_t k = 0; k < some; k++)
        add_bounds(c, (2 * k + 1) * all / (2 * some), node, n, kind, 1 / (float)some, bound);
    for (uint32_t i = 0; i < n && some < all; i++) {
        dark[n_dark] = node[i];
        at[n_dark] = i;
        n_dark += bound[i] > 0 ? 0 : 1;
    }
    for (uint32_t k = 0; k < all && n_dark; k++) add_bounds(c, k, dark, n_dark, kind, 1 / (float)all, sum);
    for (uint32_t i = 0; i < n_dark; i++) bound[at[i]] = sum[i];
}

/* Those of one point at a time, which are scattered over the batch: chains of what is of one point. */
void lc_cut_gather_estimates(const lc_cut *c, lc_cut_step *s, uint32_t first, uint32_t n, lc_light_kind kind)
{
    uint32_t rep[LC_CUT_BATCH + LC_LANES], from[LC_CUT_BATCH];
    float f[3][LC_CUT_BATCH + LC_LANES], to[3][LC_CUT_BATCH + LC_LANES];
    float *const out[6] = { f[0], f[1], f[2], to[0], to[1], to[2] };
    uint8_t next[LC_CUT_BATCH], begin[LC_GATHER_MOST];
    memset(begin, END_OF_CHAIN, c->gather->n);
    for (uint32_t i = n; i-- > 0;) {
        next[i] = begin[s->at[first + i]];
        begin[s->at[first + i]] = (uint8_t)i;
    }
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t at = s->at[first + i];
        uint32_t m = 0;
        if (begin[at] != i) continue;
        for (uint32_t k = i; k != END_OF_CHAIN; k = next[k]) {
            rep[m] = s->rep[first + k];
            from[m++] = first + k;
        }
        lc_cut_use_point(c, s, at);
        c->ctx->shade_kernels->estimate(&c->tree->data, 0, rep, m, kind, s->point, out);
        const float *scale = lc_gather_at(c->gather, at)->scale;
        for (uint32_t j = 0; j < m; j++)
            for (int k = 0; k < 3; k++) s->f[k][from[j]] = c->gather->uneven ? f[k][j] * scale[k] : f[k][j];
    }
    for (uint32_t i = first; i < first + n; i++) s->rep[i] |= s->at[i] << c->light_bits;
}

/* Appends one light, all points of whose range are represented by one. */
static double add_light(lc_cut_list *list, float bound, uint32_t link, uint32_t rep,
                        const float transfer[3], const float *intensity)
{
    const bool lit = transfer[0] + transfer[1] + transfer[2] > 0;
    return lc_cut_append(list, bound, link, rep | (lit ? LC_PENDING : 0), transfer, intensity);
}

double lc_cut_gather_root(lc_cut *c, lc_cut_step *s, uint32_t link, lc_light_kind kind)
{
    const uint32_t n = c->gather->n, light = link & ~LC_LEAF;
    double total = 0;
    c->done[c->n_done++] = link;
    for (uint32_t at = 0; at < n; at++) {
        s->rep[0] = light;
        s->at[0] = at;
        lc_cut_gather_estimates(c, s, 0, 1, kind);
        total += add_light(&c->leaf, 1, link, s->rep[0],
                           (const float[3]){ s->f[0][0], s->f[1][0], s->f[2][0] },
                           part_of(c, s, 0, lc_cut_intensity_of(&c->tree->data, link), at, at + 1));
    }
    return total;
}

double lc_cut_gather_lights(lc_cut *c, lc_cut_step *s, const uint32_t *link, uint32_t n, lc_light_kind kind)
{
    double total = 0;
    if (*link == c->tree->root[kind]) return lc_cut_gather_root(c, s, *link, kind); /* it has no parent */
    for (uint32_t i = 0; i < n; i++) s->node[i] = c->desc.parent[link[i] & ~LC_LEAF];
    lc_cut_bounds(c, s, s->node, n, kind, s->node_bound);
    s->stats->bounds += n;
    for (uint32_t i = 0; i < n; i++) s->rep[i] = link[i] & ~LC_LEAF;
    lc_cut_deal(c, s, 0, n);
    lc_cut_gather_estimates(c, s, 0, n, kind);
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t light = link[i] & ~LC_LEAF;
        const float *intensity = lc_cut_intensity_of(&c->tree->data, LC_LEAF | light),
                    share = share_of(intensity, c->tree->data.nodes[s->node[i]].intensity),
                    bound = s->node_bound[i] * share * UP * of_pair(c);
        if (bound > 0)
            total += add_light(&c->kept, bound, pair_link(c, light, 0, c->gather->n), s->rep[i],
                               (const float[3]){ s->f[0][i], s->f[1][i], s->f[2][i] }, intensity);
        else c->done[c->n_done++] = LC_LEAF | light;
        c->n_zero_bound += bound > 0 ? 0 : 1;
    }
    return total;
}

/* The box that all shadow rays to a light go into. */
static lc_node target_box(const lc_light_rec *light, lc_light_kind kind)
{
    const float *pos = light->pos, radius = lc_is_sized(kind) ? lc_target_radius(light) : 0;
    lc_node box = { .center = { pos[0], pos[1], pos[2] } };
    const float most = fmaxf(radius, fmaxf(fabsf(pos[0]), fmaxf(fabsf(pos[1]), fabsf(pos[2]))));
    for (int k = 0; k < 3 && lc_is_sized(kind); k++) box.half[k] = radius + OF_TARGET * most;
    return box;
}

bool lc_cut_gather_proves(const lc_cut *c, uint32_t link, uint32_t occluder, lc_stats *stats)
{
    const uint32_t light = link & c->light_mask;
    const lc_light_kind kind = lc_kind_of_light(c->tree, light);
    const lc_node box = target_box(&c->tree->data.lights[light], kind);
    return lc_occlusion_proves_from(c->occlusion, &c->gather->orgs, &box, occluder, true, lc_is_far(kind),
                                    LC_MAX_PATCH, &stats->proof_tests);
}
