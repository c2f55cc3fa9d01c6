/* cut_start.c - how a cut begins: with the roots of the light trees, or with a start, the cut that was saved
 * at a point near it. Any cut will do: what is above the limit in it is split.
 *
 * A start's nodes are bounded, estimated and traced at once and go to `kept`, where those above the limit are
 * found afterwards; its lights are done. A cut that defers its rays leaves them pending. Clusters that were
 * proved to be occluded at the other point are tested here first.
 */
#include "cut/cut.h"
#include "cut/cut_gather.h"
#include "cut/evidence.h"

#include "shade/point_init.h"

#include <math.h>
#include <string.h>

/* ---- the roots ---- */

/* Puts a root into its list. Returns its luminance. */
static double place_root(lc_cut *c, lc_cut_step *s, uint32_t link)
{
    const lc_light_tree *t = c->tree;
    const lc_light_kind kind = lc_kind_of_link(t, link);
    bool inner = !(link & LC_LEAF), lit;
    if (c->gather && !inner) return lc_cut_gather_root(c, s, link, kind);
    s->rep[0] = lc_cut_rep_of(c, link);
    s->bound[0] = 1;
    if (inner) lc_cut_bounds(c, s, &link, 1, kind, s->bound);
    s->stats->bounds += inner;
    if (c->gather) {
        lc_cut_deal(c, s, 0, 1);
        lc_cut_gather_estimates(c, s, 0, 1, kind);
    } else {
        lc_cut_estimate(c, s, 0, 1, kind);
    }
    lit = s->f[0][0] > 0 || s->f[1][0] > 0 || s->f[2][0] > 0;
    c->n_zero_bound += inner && !(s->bound[0] > 0);
    inner &= s->bound[0] > 0;
    if (!inner) c->done[c->n_done] = link;
    c->n_done += !inner;
    if (!(s->bound[0] > 0)) return 0;
    return lc_cut_append(inner ? &c->open : &c->leaf, s->bound[0], link,
                         s->rep[0] | (lit ? LC_PENDING : 0),
                         (const float[3]){ s->f[0][0], s->f[1][0], s->f[2][0] },
                         lc_cut_intensity_of(&t->data, link));
}

double lc_cut_place_roots(lc_cut *c, lc_cut_step *s)
{
    double total = 0;
    for (uint32_t i = 0; i < c->tree->n_roots; i++) total += place_root(c, s, c->tree->roots[i]);
    return total;
}

/* ---- saving a start ---- */

/* Radix sort, in as many bytes as the greatest link has; scratch: room for n more. */
static void sort_links(uint32_t *link, uint32_t *scratch, uint32_t n)
{
    uint32_t all = 0, *from = link, *to = scratch;
    for (uint32_t i = 0; i < n; i++) all |= link[i];
    for (uint32_t shift = 0; shift < 32 && all >> shift; shift += 8) {
        uint32_t at[257] = { 0 }, *was = from;
        for (uint32_t i = 0; i < n; i++) at[(from[i] >> shift & 255) + 1]++;
        for (uint32_t d = 0; d < 256; d++) at[d + 1] += at[d];
        for (uint32_t i = 0; i < n; i++) to[at[from[i] >> shift & 255]++] = from[i];
        from = to;
        to = was;
    }
    if (from != link) memcpy(link, from, n * sizeof *link);
}

/* Whether a cluster is proved to be occluded from all points of the start, by what occludes one of its lights
 * from this one; it is noted then. */
static bool hide_from_block(const lc_cut *c, lc_cut_start *out, uint32_t link, uint32_t occluder,
                            lc_stats *stats)
{
    if (!out->has_points || occluder == LC_NONE || out->n_block + c->n_hidden >= c->max_hidden ||
        !lc_occlusion_proves_from(c->occlusion, &out->points, &c->tree->data.nodes[link], occluder, true,
                                  lc_is_far(lc_kind_of_node(c->tree, link)), LC_MAX_PATCH,
                                  &stats->proof_tests))
        return false;
    out->hidden[out->n_block++] = (lc_hidden_cluster){ link, occluder };
    return true;
}

/* The same of a cluster of a list whose representative is occluded. */
static bool list_hides_from_block(const lc_cut *c, lc_cut_start *out, const lc_cut_list *list, uint32_t i,
                                  lc_stats *stats)
{
    const uint32_t link = list->link[i], rep = list->rep[i];
    if (rep & LC_PENDING || list->e[0][i] + list->e[1][i] + list->e[2][i] > 0) return false;
    return hide_from_block(c, out, link,
                           lc_occlusion_by(c->occlusion, rep, lc_is_far(lc_kind_of_node(c->tree, link))),
                           stats);
}

/* Saves the hidden clusters: first those that the whole block shares, last the others, of which there are
 * *n_rest. */
static void save_hidden(const lc_cut *c, lc_cut_start *out, uint32_t *n_rest, lc_stats *stats)
{
    /* With evidence the others are nodes: where all points find them hidden they are not split. */
    uint32_t room = c->start_only ? LC_MAX_START - lc_cut_n_clusters(c) : 0;
    out->n_block = *n_rest = 0;
    for (uint32_t i = 0; i < c->n_hidden; i++) {
        if (hide_from_block(c, out, c->hidden[i].link, c->hidden[i].occluder, stats)) continue;
        if (room) out->link[out->n_nodes++] = c->hidden[i].link;
        else out->hidden[LC_MAX_HIDDEN - ++*n_rest] = c->hidden[i];
        room -= room > 0;
    }
}

/* Nodes are saved in the order of the tree, so that rays to neighbours are traced in one group. Measured:
 * tests/results/shadow-rays.md. */
void lc_cut_save_start(lc_cut *c, lc_stats *stats)
{
    const lc_cut_list *const lists[] = { &c->open, &c->split, &c->kept };
    uint32_t *lights = (uint32_t *)(void *)c->scratch, n_rest;
    lc_cut_start *out = c->start_out;
    const bool for_block = out->has_points && c->occlusion;
    out->evidence = NULL;
    out->n_nodes = out->n_lights = 0;
    save_hidden(c, out, &n_rest, stats); /* may add nodes */
    for (int k = 0; k < 3; k++)
        for (uint32_t i = 0; i < lists[k]->n; i++)
            if (!for_block || !list_hides_from_block(c, out, lists[k], i, stats))
                out->link[out->n_nodes++] = lists[k]->link[i];
    for (uint32_t i = 0; i < c->n_done; i++) {
        uint32_t is_light = c->done[i] >> 31; /* written to both, counted in one: no branch */
        out->link[out->n_nodes] = lights[out->n_lights] = c->done[i];
        out->n_nodes += 1 - is_light;
        out->n_lights += is_light;
    }
    memcpy(out->link + out->n_nodes, lights, out->n_lights * sizeof *lights);
    memmove(out->hidden + out->n_block, out->hidden + LC_MAX_HIDDEN - n_rest, n_rest * sizeof *out->hidden);
    out->n_hidden = out->n_block + n_rest;
    sort_links(out->link, lights, out->n_nodes);
    c->start_saved = true;
    c->n_start_history = c->n_history;
    c->n_start_rounds = c->n_rounds;
}

/* ---- beginning with a start ---- */

/* Sums the luminance of n estimates; four partial sums, as additions to one would wait for each other. */
static double luminance_of(float *const e[3], uint32_t n)
{
    double sum[4] = { 0, 0, 0, 0 };
    uint32_t i = 0;
    for (; i + 4 <= n; i += 4)
        for (uint32_t k = 0; k < 4; k++)
            sum[k] += (double)lc_luminance(lc_f3_make(e[0][i + k], e[1][i + k], e[2][i + k]));
    for (; i < n; i++) sum[i & 3] += (double)lc_luminance(lc_f3_make(e[0][i], e[1][i], e[2][i]));
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* The bounds of n nodes of a start have just been written past the end of `kept`. Writes links and
 * representatives of those above 0 beside them and moves the others to `done`. Returns the number of the
 * former; the caller adds it to the list. */
static uint32_t drop_zero(lc_cut *c, lc_cut_step *s, const uint32_t *link, uint32_t n)
{
    uint32_t at = c->kept.n, m = 0;
    float *bound = c->kept.bound + at, least = INFINITY;
    for (uint32_t i = 0; i < n; i++) least = bound[i] < least ? bound[i] : least;
    if (least > 0) { /* as in most starts */
        memcpy(c->kept.link + at, link, n * sizeof *link);
        memcpy(c->kept.rep + at, s->rep, n * sizeof *s->rep);
        return n;
    }
    for (uint32_t i = 0; i < n; i++) {
        c->done[c->n_done] = c->kept.link[at + m] = link[i]; /* written to both, counted in one */
        c->kept.rep[at + m] = s->rep[m] = s->rep[i];
        s->intensity[m] = s->intensity[i];
        bound[m] = bound[i];
        c->kept.weight[at + m] = c->kept.weight[at + i];
        bool zero = !(bound[i] > 0);
        c->n_done += zero;
        c->n_zero_bound += zero;
        m += !zero;
    }
    return m;
}

/* Traces the rays to the representatives of the last n clusters of `kept`, targets in f[3 .. 5]; occluded
 * ones get transfer and estimate 0, others what glass leaves. lit: which of them have a transfer above 0. */
static void trace_nodes(lc_cut *c, lc_cut_step *s, const uint32_t *lit, uint32_t n_lit,
                        float *const transfer[3], float *const e[3], lc_light_kind kind)
{
    uint32_t blocker[LC_CUT_BATCH];
    uint8_t hidden[LC_CUT_BATCH];
    float v[3][LC_CUT_BATCH], *const through[3] = { v[0], v[1], v[2] };
    bool dims = false;
    const float *const target[3] = { s->f[3], s->f[4], s->f[5] };
    if (n_lit)
        dims = lc_cut_hidden(&c->visibility, s->point, s->org, n_lit, target, lc_is_far(kind), hidden,
                             c->occlusion ? blocker : NULL, through);
    s->stats->shadow_rays += n_lit;
    lc_phase_end(s->stats, LC_PHASE_SHADOW);
    for (uint32_t i = 0; i < n_lit; i++) {
        for (int k = 0; k < 3 && dims && !hidden[i]; k++) {
            transfer[k][lit[i]] *= v[k][i];
            e[k][lit[i]] *= v[k][i];
        }
        if (!hidden[i]) continue;
        if (c->occlusion) lc_occlusion_note(c->occlusion, s->rep[lit[i]], blocker[i]);
        for (int k = 0; k < 3; k++) transfer[k][lit[i]] = e[k][lit[i]] = 0;
    }
}

/* Multiplies the bounds that have just been written past the end of `kept`; weight: NULL, by 1. */
static void weigh_bounds(const lc_cut_list *kept, const float *weight, uint32_t n)
{
    float *bound = kept->bound + kept->n, *to = kept->weight + kept->n;
    for (uint32_t i = 0; i < n; i++) to[i] = weight ? weight[i] : 1;
    for (uint32_t i = 0; i < n && weight; i++) bound[i] *= weight[i];
}

/* Takes over up to LC_CUT_BATCH nodes of one kind and traces their rays. Returns their luminance. */
static double start_nodes(lc_cut *c, lc_cut_step *s, const uint32_t *link, const float *weight, uint32_t n,
                          lc_light_kind kind)
{
    lc_cut_list *kept = &c->kept;
    uint32_t at = kept->n, lit[LC_CUT_BATCH], n_lit = 0;
    float *const out[6] = {
        kept->transfer[0] + at, kept->transfer[1] + at, kept->transfer[2] + at, s->f[3], s->f[4], s->f[5]
    };
    float *const e[3] = { kept->e[0] + at, kept->e[1] + at, kept->e[2] + at };
    for (uint32_t i = 0; i < n; i++) {
        s->rep[i] = lc_cut_rep_of(c, link[i]);
        s->intensity[i] = lc_cut_intensity_of(&c->tree->data, link[i]);
        __builtin_prefetch(&c->tree->data.lights[s->rep[i]]);
    }
    lc_phase_end(s->stats, LC_PHASE_REFINE);
    lc_cut_bounds(c, s, link, n, kind, kept->bound + at);
    s->stats->bounds += n;
    weigh_bounds(kept, weight, n);
    lc_phase_end(s->stats, LC_PHASE_BOUNDS);
    n = drop_zero(c, s, link, n);
    if (c->gather) {
        lc_cut_deal(c, s, 0, n);
        lc_cut_gather_estimates(c, s, 0, n, kind);
        for (int k = 0; k < 3; k++) memcpy(out[k], s->f[k], n * sizeof(float));
        memcpy(kept->rep + at, s->rep, n * sizeof *s->rep);
    } else {
        c->ctx->shade_kernels->estimate(&c->tree->data, 0, s->rep, n, kind, s->point, out);
    }
    if (!c->defers) lc_shadow_targets(c->tree, kind, s->point, s->rep, 0, n, out + 3);
    lc_phase_end(s->stats, LC_PHASE_ESTIMATES);
    for (uint32_t i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) e[k][i] = out[k][i] * s->intensity[i][k];
        lit[n_lit] = i;
        n_lit += out[0][i] + out[1][i] + out[2][i] > 0;
    }
    for (uint32_t i = 0; i < n_lit && n_lit < n; i++) /* in place, since lit[i] >= i */
        for (int k = 3; k < 6; k++) s->f[k][i] = s->f[k][lit[i]];
    lc_phase_end(s->stats, LC_PHASE_REFINE);
    if (c->defers)
        for (uint32_t i = 0; i < n_lit; i++) kept->rep[at + lit[i]] |= LC_PENDING;
    else trace_nodes(c, s, lit, n_lit, out, e, kind);
    kept->n = at + n;
    return luminance_of(e, n);
}

/* The same for lights, which are done. */
static double start_lights(lc_cut *c, lc_cut_step *s, const uint32_t *link, uint32_t n, lc_light_kind kind)
{
    double total = 0;
    if (c->gather) return lc_cut_gather_lights(c, s, link, n, kind);
    for (uint32_t i = 0; i < n; i++) s->rep[i] = link[i] & ~LC_LEAF;
    lc_cut_estimate(c, s, 0, n, kind);
    for (uint32_t i = 0; i < n; i++) {
        const float f[3] = { s->f[0][i], s->f[1][i], s->f[2][i] };
        uint32_t rep = s->rep[i] | (f[0] + f[1] + f[2] > 0 ? LC_PENDING : 0);
        c->done[c->n_done++] = link[i];
        total += lc_cut_append(&c->leaf, 1, link[i], rep, f, lc_cut_intensity_of(&c->tree->data, link[i]));
    }
    return c->defers ? total : total + lc_cut_trace_leaves(c, s);
}

/* How many of the n links are of the kind of the first, at most LC_CUT_BATCH. */
static uint32_t run_of_kind(const lc_light_tree *t, const uint32_t *link, uint32_t n, lc_light_kind *kind)
{
    uint32_t run = 0;
    *kind = lc_kind_of_link(t, *link);
    if (t->n_of_kind[*kind] == t->n_lights) return n < LC_CUT_BATCH ? n : LC_CUT_BATCH;
    while (run < n && run < LC_CUT_BATCH && lc_kind_of_link(t, link[run]) == *kind) run++;
    return run;
}

double lc_cut_start_nodes(lc_cut *c, lc_cut_step *s, const uint32_t *link, const float *weight, uint32_t n)
{
    lc_light_kind kind;
    double total = 0;
    for (uint32_t at = 0, run; at < n; at += run) {
        run = run_of_kind(c->tree, link + at, n - at, &kind);
        total += start_nodes(c, s, link + at, weight ? weight + at : NULL, run, kind);
    }
    return total;
}

/* Clusters that were occluded at the start's point may be occluded at this one too. */
static double start_hidden(lc_cut *c, lc_cut_step *s, const lc_hidden_cluster *hidden, uint32_t n)
{
    uint32_t *rest = (uint32_t *)(void *)c->scratch, n_rest = 0;
    if (c->in_block) { /* proved for all of its points */
        c->n_hidden = c->start->n_block;
        memcpy(c->hidden, hidden, c->n_hidden * sizeof *hidden);
        hidden += c->n_hidden;
        n -= c->n_hidden;
    }
    for (uint32_t i = 0; i < n; i++) __builtin_prefetch(&c->occlusion->occluders->all[hidden[i].occluder]);
    for (uint32_t i = 0; i < n; i++) {
        rest[n_rest] = hidden[i].link;
        n_rest += !lc_cut_prove(c, hidden[i].link, hidden[i].occluder, false, LC_MAX_PATCH, s->stats);
    }
    return lc_cut_start_nodes(c, s, rest, NULL, n_rest);
}

/* Takes over what the point itself found at the nodes of the start. */
static double take_row(lc_cut *c, const lc_evidence_row *row)
{
    lc_cut_list *kept = &c->kept;
    const uint32_t at = kept->n, n = row->n;
    for (uint32_t i = 0, k = 0; n < c->start->n_nodes && i < c->start->n_nodes; i++) {
        if (k < n && row->node[k] == i) {
            k++;
            continue;
        }
        c->done[c->n_done++] = c->start->link[i];
        c->n_zero_bound++;
    }
    for (uint32_t i = 0; i < n; i++) {
        const float weight = c->weight[row->node[i]];
        kept->weight[at + i] = weight;
        kept->bound[at + i] = row->bound[i] * weight;
        kept->link[at + i] = c->start->link[row->node[i]];
        if (row->blocker[i] != LC_NONE) lc_occlusion_note(c->occlusion, row->rep[i], row->blocker[i]);
    }
    memcpy(kept->rep + at, row->rep, n * sizeof *row->rep);
    for (int k = 0; k < 3; k++) {
        memcpy(kept->transfer[k] + at, row->transfer[k], n * sizeof(float));
        memcpy(kept->e[k] + at, row->e[k], n * sizeof(float));
    }
    float *const e[3] = { kept->e[0] + at, kept->e[1] + at, kept->e[2] + at };
    kept->n = at + n;
    c->rays_given = row->n_rays;
    return luminance_of(e, n);
}

/* The nodes of a start, with what its evidence says of them. */
static double place_nodes(lc_cut *c, lc_cut_step *s)
{
    const lc_cut_start *start = c->start;
    const lc_evidence *evidence = start->evidence;
    if (!evidence) return lc_cut_start_nodes(c, s, start->link, NULL, start->n_nodes);
    lc_evidence_weigh(evidence, start->n_nodes, c->slot, c->weight);
    if (c->row != LC_NONE && evidence->row[c->row].slot == c->slot && !c->gather)
        return take_row(c, &evidence->row[c->row]);
    return lc_cut_start_nodes(c, s, start->link, c->weight, start->n_nodes);
}

double lc_cut_place_start(lc_cut *c, lc_cut_step *s)
{
    const lc_cut_start *start = c->start;
    const uint32_t *lights = start->link + start->n_nodes;
    lc_light_kind kind;
    double total = start_hidden(c, s, start->hidden, start->n_hidden);
    total += place_nodes(c, s);
    for (uint32_t at = 0, run; at < start->n_lights; at += run) {
        run = run_of_kind(c->tree, lights + at, start->n_lights - at, &kind);
        total += start_lights(c, s, lights + at, run, kind);
    }
    lc_phase_end(s->stats, LC_PHASE_REFINE);
    return total;
}
