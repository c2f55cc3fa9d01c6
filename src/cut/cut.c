/* cut.c - memory of a cut, the loop that refines it, and its result. */
#include "cut/cut.h"

#include "base/rng.h"
#include "cut/cut_parts.h"

#include <math.h>
#include <string.h>

/* Below this fraction of the dark floor a point is nearly dark: its errors cannot be seen, so cuts with many
 * occluded representatives keep the error ratio, and with z the pilots say how much wider limits may be.
 * Measured: tests/results/refinement.md, asked-error.md. */
#define NEARLY_DARK 0.25
/* With z a start is saved while the root of the sum of its squared bounds is still this multiple of its own
 * point's limit, so that cuts that begin with it are not finer than their own points need. Measured:
 * tests/results/asked-error.md. */
#define START_COARSER 1.4

/* With z: how far the luminance that limits go by is from the cut's own at most. Measured:
 * tests/results/asked-error.md. */
#define MOST_UNLIKE 4.0

#define MAX_GATHER_SIZE 65536 /* pairs of a gather cluster's cut, of fewer lights than that */

/* ---- memory ---- */

/* Elements of a list: max_size, one more, what kernels write past the end, and all points' pairs with lights
 * that are roots, each of which max_size counts as one; in cache lines of 16. Their number is one above a
 * multiple of eight, so that the arrays do not compete for the same sets of the cache. */
static size_t list_capacity(const lc_cut *c)
{
    const uint32_t n_roots = c->tree ? c->tree->n_roots : 0; /* freed, it may never have been made */
    const size_t roots = n_roots > LC_LIGHT_KINDS ? n_roots : LC_LIGHT_KINDS;
    const size_t n = (size_t)c->max_size + 1 + LC_CUT_SPARE + roots * c->desc.max_points;
    return (((n + 15) / 16 | 7) + 2) * 16;
}

/* All links of a cut: those that max_size limits, as many of bound 0, and the hidden ones. */
static size_t link_capacity(const lc_cut *c) { return list_capacity(c) + c->max_size + LC_MAX_HIDDEN; }

static void lay_out(lc_cut_list *list, float *memory, size_t n)
{
    list->bound = memory;
    list->link = (uint32_t *)(void *)(memory + n);
    list->rep = (uint32_t *)(void *)(memory + 2 * n);
    for (size_t k = 0; k < 3; k++) {
        list->transfer[k] = memory + (3 + k) * n;
        list->e[k] = memory + (6 + k) * n;
    }
    list->weight = memory + 9 * n;
}

static void set_sizes(lc_cut *c)
{
    const lc_light_tree *tree = c->tree;
    const uint32_t max_cut = c->desc.max_cut;
    const uint32_t n_roots = tree->n_roots;
    uint64_t pairs = (uint64_t)tree->n_lights * c->desc.max_points;
    if (pairs > MAX_GATHER_SIZE) pairs = MAX_GATHER_SIZE;
    const uint32_t all = pairs > tree->n_lights ? (uint32_t)pairs : tree->n_lights;
    c->max_size = max_cut && max_cut < all ? max_cut : all;
    if (c->max_size < n_roots) c->max_size = n_roots;
    /* Cuts that begin with this one may see all of its hidden clusters, which count towards max_size then. */
    uint32_t most = c->max_size < tree->n_lights ? c->max_size / 2 : LC_MAX_HIDDEN;
    c->max_hidden = most < LC_MAX_HIDDEN ? most : LC_MAX_HIDDEN;
}

lc_status lc_cut_init(lc_cut *cut, const lc_context *ctx, const lc_light_tree *tree,
                      const lc_visibility *visibility, const lc_cut_desc *desc, bool record)
{
    memset(cut, 0, sizeof *cut);
    cut->ctx = ctx;
    cut->tree = tree;
    cut->visibility = *visibility;
    cut->desc = *desc;
    cut->record = record;
    cut->part = (lc_cut_part){ 1, 1, 0 };
    cut->light_bits = 31;
    cut->light_mask = ~LC_PENDING;
    set_sizes(cut);
    lc_cut_list *const lists[] = { &cut->open, &cut->split, &cut->kept, &cut->leaf };
    size_t n = list_capacity(cut);
    /* Not set to 0: without max_cut the lists have room for every light, and few pages are ever touched. */
    cut->memory = lc_alloc_raw(ctx, n, 4 * LC_CUT_WORDS * sizeof *cut->memory);
    cut->scratch = lc_alloc_raw(ctx, n, sizeof *cut->scratch);
    cut->weight = lc_alloc_raw(ctx, LC_MAX_START, sizeof *cut->weight);
    cut->row = LC_NONE;
    cut->done = lc_alloc_raw(ctx, link_capacity(cut), sizeof *cut->done);
    cut->hidden = lc_alloc_raw(ctx, LC_MAX_HIDDEN, sizeof *cut->hidden);
    cut->occlusion = visibility->occluders ? lc_alloc_raw(ctx, 1, sizeof *cut->occlusion) : NULL;
    cut->history = record ? lc_alloc_raw(ctx, link_capacity(cut), sizeof *cut->history) : NULL;
    cut->rounds = record ? lc_alloc_raw(ctx, link_capacity(cut), sizeof *cut->rounds) : NULL;
    if (!cut->memory || !cut->scratch || !cut->weight || !cut->done || !cut->hidden ||
        (record && (!cut->history || !cut->rounds)) || (visibility->occluders && !cut->occlusion)) {
        lc_cut_free(cut);
        return LC_ERR_MEMORY;
    }
    if (cut->occlusion) lc_occlusion_init(cut->occlusion, visibility, &tree->data);
    for (size_t i = 0; i < 4; i++) lay_out(lists[i], cut->memory + i * LC_CUT_WORDS * n, n);
    return LC_OK;
}

void lc_cut_free(lc_cut *cut)
{
    size_t n = list_capacity(cut);
    lc_free(cut->ctx, cut->memory, n, 4 * LC_CUT_WORDS * sizeof *cut->memory);
    lc_free(cut->ctx, cut->scratch, n, sizeof *cut->scratch);
    lc_free(cut->ctx, cut->weight, LC_MAX_START, sizeof *cut->weight);
    lc_free(cut->ctx, cut->done, link_capacity(cut), sizeof *cut->done);
    lc_free(cut->ctx, cut->hidden, LC_MAX_HIDDEN, sizeof *cut->hidden);
    lc_free(cut->ctx, cut->occlusion, 1, sizeof *cut->occlusion);
    lc_free(cut->ctx, cut->history, link_capacity(cut), sizeof *cut->history);
    lc_free(cut->ctx, cut->rounds, link_capacity(cut), sizeof *cut->rounds);
    cut->memory = NULL;
    cut->scratch = NULL;
    cut->weight = NULL;
    cut->done = NULL;
    cut->hidden = NULL;
    cut->occlusion = NULL;
    cut->history = NULL;
    cut->rounds = NULL;
}

/* ---- the result ---- */

/* Sum of n floats; eight partial sums, as additions to one would wait for each other. */
static double sum_of(const float *a, uint32_t n)
{
    double sum[8] = { 0 };
    uint32_t i = 0;
    for (; i + 8 <= n; i += 8)
        for (uint32_t k = 0; k < 8; k++) sum[k] += (double)a[i + k];
    for (; i < n; i++) sum[i & 7] += (double)a[i];
    return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
}

/* Largest bound of a list; four partial maxima, for the same reason. */
static float worst_of(const lc_cut_list *list)
{
    const float *a = list->bound;
    float worst[4] = { 0, 0, 0, 0 };
    uint32_t i = 0;
    for (; i + 4 <= list->n; i += 4)
        for (int k = 0; k < 4; k++) worst[k] = a[i + (uint32_t)k] > worst[k] ? a[i + (uint32_t)k] : worst[k];
    for (; i < list->n; i++) worst[0] = a[i] > worst[0] ? a[i] : worst[0];
    return fmaxf(fmaxf(worst[0], worst[1]), fmaxf(worst[2], worst[3]));
}

/* The luminance that the error of a cut is relative to. Where that is its own, a cut that is too bright by
 * its representatives ends early and stays so, and one that is too dark is refined: together they are too
 * bright. The cut of a point alike, by other representatives, has errors of its own. */
static double of_alike(const lc_cut *c, double total)
{
    if (!(c->alike > 0)) return total;
    return fmin(fmax(c->alike, total / MOST_UNLIKE), total * MOST_UNLIKE);
}

/* The luminance of the pixel, as far as it is known. */
static double pixel_of(const lc_cut *c, double total)
{
    return (double)c->part.own * of_alike(c, total) + c->part.rest;
}

static double z_of(const lc_cut *c, double total)
{
    const bool dark = c->desc.dark > 1 && pixel_of(c, total) < NEARLY_DARK * (double)c->desc.floor;
    return (double)c->desc.z / (dark ? (double)c->desc.dark : 1);
}

static void set_max_error(const lc_cut *c, lc_cut_result *out)
{
    float lum = lc_luminance(out->radiance), worst = worst_of(&c->kept);
    if (c->desc.z > 0) {
        worst = (float)(z_of(c, (double)lum) * sqrt(lc_cut_sum2(c)));
        lum = fmaxf((float)of_alike(c, (double)lum), c->desc.floor);
    }
    if (worst > 0) out->max_error = lum > 0 ? worst / lum : INFINITY;
}

/* Fills in the result of a finished cut. Clusters that are in `open` still, for want of room, are kept. */
static void finish(lc_cut *c, uint64_t rays_before, lc_stats *stats, lc_cut_result *out)
{
    double sum[3] = { c->done_sum[0], c->done_sum[1], c->done_sum[2] };
    for (uint32_t i = 0; i < c->open.n; i++) lc_cut_copy(&c->kept, c->kept.n++, &c->open, i);
    c->open.n = 0;
    for (int k = 0; k < 3; k++) sum[k] += sum_of(c->kept.e[k], c->kept.n);
    if (c->of_group) lc_cut_add_to_groups(c, &c->kept);
    out->radiance = lc_f3_make((float)sum[0], (float)sum[1], (float)sum[2]);
    out->size = lc_cut_size(c);
    for (uint32_t i = 0; i < c->n_hidden && c->record; i++) c->done[c->n_done++] = c->hidden[i].link;
    set_max_error(c, out);
    out->rays = (uint32_t)(stats->shadow_rays - rays_before) + c->rays_given;
    stats->cut_sum += out->size;
    stats->proved += c->n_hidden;
    stats->at_limit += out->at_limit;
    stats->dark += out->dark;
    lc_phase_end(stats, LC_PHASE_REFINE);
}

/* ---- refinement ---- */

/* Largest float that is at most x. */
static float round_down(double x)
{
    float f = (float)x;
    return (double)f > x ? nextafterf(f, 0) : f;
}

static void set_slot(lc_cut *c, uint32_t slot)
{
    const lc_light_tree *t = c->tree;
    c->slot = slot;
    c->reps = t->reps ? t->reps + slot : &t->data.nodes->rep;
    c->reps_stride = t->reps ? t->n_reps : sizeof(lc_node) / sizeof(uint32_t);
}

static void reset(lc_cut *c)
{
    c->open.n = 0;
    c->split.n = 0;
    c->kept.n = 0;
    c->leaf.n = 0;
    c->n_done = 0;
    c->n_zero_bound = 0;
    c->n_hidden = 0;
    c->n_traced = 0;
    c->last_room_tested = c->worst_first = c->short_of_room = false;
    c->factor = 1;
    c->rays_given = 0;
    c->n_history = c->start ? c->n_start_history : 0;
    c->n_rounds = c->start ? c->n_start_rounds : 0;
    for (int k = 0; k < 3; k++) c->done_sum[k] = 0;
    if (c->of_group) memset(c->of_group, 0, c->tree->n_groups * sizeof *c->of_group);
    c->start_saved = !c->start_out;
}

/* A cut of n clusters, hidden ones included, takes n - 1 splits at most, so there is room. */
static void record_round(lc_cut *c, float limit, double total, uint64_t rays)
{
    c->rounds[c->n_rounds++] = (lc_cut_round){ c->split.n, (uint32_t)rays, limit, total };
    memcpy(c->history + c->n_history, c->split.link, c->split.n * sizeof *c->history);
    c->n_history += c->split.n;
}

/* Whether splitting the selected clusters makes the cut too large for a start, so that it is saved before:
 * with max_cut, half of the room is for the splits of the points that begin with it. */
static bool outgrows_start(const lc_cut *c)
{
    uint32_t most = c->max_size < c->tree->n_lights ? c->max_size / 2 : c->max_size;
    return lc_cut_n_clusters(c) + c->split.n > (most < LC_MAX_START ? most : LC_MAX_START);
}

/* A round: splits what lc_cut_select chose. False: there is nothing to split, or no room for a round. */
static bool split_round(lc_cut *c, lc_cut_step *s, float limit, uint64_t rays_before, double *total)
{
    lc_cut_select(c, limit, s->stats);
    if (!c->split.n) return false;
    if (!c->start_saved && outgrows_start(c)) lc_cut_save_start(c, s->stats);
    if (c->record) record_round(c, limit, *total, s->stats->shadow_rays - rays_before);
    *total += lc_cut_split(c, s, limit);
    return true;
}

/* What the error of the whole cut is relative to: the pixel's luminance, or the floor. The pixel's variance
 * is the sum over its cuts, each times its share squared; each may add as much as its share. */
static double of_pixel(const lc_cut *c, double total)
{
    return fmax(pixel_of(c, total), (double)c->desc.floor) / sqrt((double)c->part.share);
}

/* The limit on the bounds of clusters: that of each of them, or that of a round, with which clusters are
 * split worst first until the whole cut is within its limit, or the room is used up. */
static float limit_of(lc_cut *c, const lc_cut_step *s, bool traced, double total, double *ratio)
{
    const double floor_lum = (double)c->desc.floor, of = total > floor_lum ? total : floor_lum;
    *ratio = (double)c->desc.error_ratio;
    if (c->desc.z > 0) {
        const double rss = *ratio * of_pixel(c, total) / z_of(c, total);
        const double coarser = c->start_only ? 1 : START_COARSER;
        if (!c->start_saved && isinf(lc_cut_rss_limit(c, coarser * rss)))
            lc_cut_save_start(c, s->stats);
        return lc_cut_rss_limit(c, rss);
    }
    if (traced) c->factor = total > NEARLY_DARK * floor_lum ? lc_cut_ratio_factor(c) : 1;
    *ratio *= c->factor;
    float limit = round_down(*ratio * of);
    return c->worst_first ? lc_cut_worst_limit(c, limit) : limit;
}

/* Begins with the start, or the roots. */
static void place(lc_cut *c, lc_cut_step *s)
{
    c->rays_before = s->stats->shadow_rays;
    c->total = c->start ? lc_cut_place_start(c, s) : lc_cut_place_roots(c, s);
    c->traced = c->start && !c->defers;
}

/* Refines the cut as far as it can be without a ray; see cut.h. Pending rays count as V = 1: the total is no
 * less than it will be and the limit no lower, so nothing is split without need. With proofs of occlusion,
 * rays are traced after every round of a cut that is saved as a start, and of one that is short of room,
 * which large hidden clusters would fill. True: the pending rays have to be traced now; false: this is the
 * cut, or where c->short_of_room is set a round did not fit. */
static bool refine(lc_cut *c, lc_cut_step *s)
{
    const bool each_round = c->worst_first || c->desc.z > 0; /* a limit of its own */
    const bool trace_each_round = c->occlusion && (c->start_out || c->worst_first);
    for (;;) {
        const float limit = limit_of(c, s, c->traced, c->total, &c->ratio);
        if (c->start_only && c->start_saved) return false;
        if (c->traced || each_round) {
            c->ctx->cut_kernels->partition(&c->kept, limit, &c->open, &c->kept);
            c->n_traced = c->traced ? c->kept.n : 0;
        }
        const uint32_t hidden_before = c->n_hidden;
        const bool split = split_round(c, s, limit, c->rays_before, &c->total);
        if (c->short_of_room && !each_round) return false;
        if (c->start_only && c->start_saved) return false;
        if (split) c->traced = false;
        if (split && !trace_each_round) continue;
        if (!split && c->n_hidden > hidden_before) continue; /* all of the round are: there is a new limit */
        return !c->traced;
    }
}

/* Refines it in rounds; where these run out of room, again from the roots, worst first. */
static bool refine_within_room(lc_cut *c, lc_cut_step *s)
{
    if (refine(c, s)) return true;
    if (!c->short_of_room || c->desc.z > 0 || c->worst_first) return false;
    c->start = NULL;
    reset(c);
    c->worst_first = true;
    place(c, s);
    return refine(c, s);
}

/* Whether the error left is above this. */
static bool error_above(const lc_cut *c, double most)
{
    if (c->desc.z > 0) return z_of(c, c->total) * sqrt(lc_cut_sum2(c)) > most;
    return (double)worst_of(&c->kept) > most;
}

void lc_cut_set_step(lc_cut_step *s, const lc_cut *c, const lc_point *p, const float org[3], lc_stats *stats)
{
    s->point = s->bounded = p;
    s->org = org;
    s->stats = stats;
    s->pairs = (lc_cut_pairs){ .parent = &c->split,
                               .bound = s->bound,
                               .link = s->link,
                               .intensity = s->intensity,
                               .fresh = s->fresh,
                               .rep = s->rep,
                               .transfer = { s->f[0], s->f[1], s->f[2] } };
}

bool lc_cut_begin(lc_cut *c, lc_cut_step *s, uint64_t hash)
{
    reset(c);
    c->worst_first = c->desc.worst_first;
    c->first_ray = s->stats->shadow_rays;
    s->stats->points++;
    c->total = c->ratio = 0;
    if (!c->tree->n_lights) return false;
    set_slot(c, (uint32_t)(hash % c->tree->n_reps));
    if (c->occlusion) lc_occlusion_start(c->occlusion, s->org);
    c->in_block = c->occlusion && c->start && c->start->has_points &&
                  (c->gather ? lc_point_box_has(&c->start->points, &c->gather->orgs)
                             : lc_point_box_holds(&c->start->points, s->org));
    place(c, s);
    return (c->start && c->defers) || refine_within_room(c, s);
}

bool lc_cut_go_on(lc_cut *c, lc_cut_step *s, double change)
{
    c->total += change;
    c->traced = true;
    return refine_within_room(c, s);
}

void lc_cut_end(lc_cut *c, lc_cut_step *s, lc_cut_result *out)
{
    *out = (lc_cut_result){ 0 };
    if (!c->tree->n_lights) return;
    if (!c->start_saved) lc_cut_save_start(c, s->stats);
    out->at_limit = c->open.n > 0;
    out->dark = !out->at_limit && c->total < (double)c->desc.floor && error_above(c, c->ratio * c->total);
    finish(c, c->first_ray, s->stats, out);
}

void lc_cut_shade(lc_cut *c, const lc_point *p, const float org[3], uint64_t hash, lc_stats *stats,
                  lc_cut_result *out)
{
    lc_cut_step s;
    lc_cut_set_step(&s, c, p, org, stats);
    for (bool wants_rays = lc_cut_begin(c, &s, hash); wants_rays;)
        wants_rays = lc_cut_go_on(c, &s, lc_cut_trace(c, &s));
    lc_cut_end(c, &s, out);
}

void lc_cut_survey(lc_cut *c, const lc_point *p, const float org[3], uint64_t hash, const lc_cut_start *start,
                   lc_evidence_row *row, lc_stats *stats)
{
    lc_cut_step s;
    const uint64_t before = stats->shadow_rays;
    lc_cut_set_step(&s, c, p, org, stats);
    c->start = NULL;
    c->start_out = NULL;
    reset(c);
    set_slot(c, (uint32_t)(hash % c->tree->n_reps));
    if (c->occlusion) lc_occlusion_start(c->occlusion, org);
    lc_cut_start_nodes(c, &s, start->link, NULL, start->n_nodes);
    row->slot = c->slot;
    row->n_rays = (uint32_t)(stats->shadow_rays - before);
    lc_evidence_keep(c, start, row);
    lc_phase_end(stats, LC_PHASE_REFINE);
}

void lc_cut_shade_gather(lc_cut *c, const lc_gather *g, uint64_t hash, lc_stats *stats, lc_cut_result *out)
{
    const bool defers = c->defers;
    const lc_gather_point *first = lc_gather_at(g, 0);
    lc_cut_step s;
    lc_cut_set_step(&s, c, first->p, first->org, stats);
    s.bounded = g->all;
    c->gather = g;
    c->defers = true; /* all rays of a point together */
    c->hash = lc_mix(hash);
    c->turn = 0;
    c->light_bits = 0;
    while ((uint32_t)1 << c->light_bits < c->tree->n_lights) c->light_bits++;
    c->light_mask = ((uint32_t)1 << c->light_bits) - 1;
    for (bool wants_rays = lc_cut_begin(c, &s, hash); wants_rays;)
        wants_rays = lc_cut_go_on(c, &s, lc_cut_trace(c, &s));
    lc_cut_end(c, &s, out);
    c->gather = NULL;
    c->defers = defers;
    c->light_bits = 31;
    c->light_mask = ~LC_PENDING;
}
