/* host_shade.c - shaders: the cuts of several points, made side by side. */
#include "api/host.h"

#include "base/arena.h"
#include "base/desc.h"
#include "base/sample.h"
#include "cut/cut.h"
#include "scene/scene.h"
#include "shade/light_target.h"
#include "shade/point_init.h"

#include <math.h>
#include <string.h>

#define LANE_CLUSTERS (1u << 22) /* that the cuts side by side may have: bounds their memory */
#define GUIDE_COS     0.8f       /* as render/guide.c */

/* ---- memory ---- */

static lc_status check(const lc_tree *t, const lc_shader_desc *d)
{
    const lc_scene *traced = d->visible == lc_scene_visible ? d->visible_user : NULL;
    if (!d->visible) return lc_fail(t->ctx, LC_ERR_ARG, "desc.visible is NULL");
    if (d->visible == lc_scene_visible && !(traced && traced->tree))
        return lc_fail(t->ctx, LC_ERR_ARG, "desc.visible_user is no committed scene");
    if (d->occluders && !d->occluders->tree)
        return lc_fail(t->ctx, LC_ERR_ARG, "desc.occluders was not committed");
    if (!(d->error_ratio >= 0 && d->error_ratio <= FLT_MAX))
        return lc_fail(t->ctx, LC_ERR_ARG, "desc.error_ratio must be finite and not negative");
    if (!(d->z >= 0 && d->z <= FLT_MAX))
        return lc_fail(t->ctx, LC_ERR_ARG, "desc.z must be finite and not negative");
    if (!(d->floor >= 0 && d->floor <= FLT_MAX))
        return lc_fail(t->ctx, LC_ERR_ARG, "desc.floor must be finite and not negative");
    return LC_OK;
}

static lc_status init_lane(lc_shader *sh, lc_host_lane *lane)
{
    const lc_shader_desc *d = &sh->desc;
    const lc_cut_desc cut = { d->error_ratio, d->max_cut, d->floor, d->z, 0, NULL, 1, false };
    const lc_visibility none = { 0 };
    lc_status st = lc_cut_init(&lane->cut, sh->tree->ctx, sh->tree->tree,
                               d->occluders ? &d->occluders->visibility : &none, &cut, false);
    if (st) {
        lane->cut.ctx = NULL;
        return st;
    }
    lane->cut.defers = true;
    if (!d->cut) return LC_OK;
    lane->lights = lc_alloc_raw(sh->tree->ctx, sh->n_entries, sizeof *lane->lights);
    return lane->lights ? LC_OK : LC_ERR_MEMORY;
}

/* The most clusters of a cut, lights included. */
static size_t most_clusters(const lc_tree *t, uint32_t max_cut)
{
    const uint32_t n = t->tree->n_lights;
    return max_cut && max_cut < n ? (max_cut > LC_LIGHT_KINDS ? max_cut : LC_LIGHT_KINDS) : n;
}

lc_status lc_shader_create(const lc_tree *t, const lc_shader_desc *desc, lc_shader **out)
{
    if (out) *out = NULL;
    if (!t) return LC_ERR_ARG;
    if (!out) return lc_fail(t->ctx, LC_ERR_ARG, "out is NULL");
    if (!desc) return lc_fail(t->ctx, LC_ERR_ARG, "desc is NULL");
    lc_shader_desc d = LC_SHADER_DESC_INIT;
    lc_status st = lc_desc_take(t->ctx, "desc", &d, sizeof d, desc);
    if (!st) st = check(t, &d);
    if (st) return st;
    lc_shader *sh = lc_alloc(t->ctx, 1, sizeof *sh);
    if (!sh) return LC_ERR_MEMORY;
    sh->tree = t;
    sh->desc = d;
    sh->n_entries = most_clusters(t, d.max_cut) + 1;
    size_t n = LANE_CLUSTERS / sh->n_entries;
    sh->n_lanes = n < 1 ? 1 : n < LC_HOST_LANES ? (uint32_t)n : LC_HOST_LANES;
    sh->lanes = lc_alloc(t->ctx, sh->n_lanes, sizeof *sh->lanes);
    sh->rays = lc_alloc_raw(t->ctx, 1, sizeof *sh->rays);
    if (!d.apart) sh->starts = lc_alloc_raw(t->ctx, LC_HOST_BLOCKS, sizeof *sh->starts);
    if (d.cut) sh->entries = lc_alloc_raw(t->ctx, sh->n_entries, sizeof *sh->entries);
    if (!sh->lanes || !sh->rays || (!d.apart && !sh->starts) || (d.cut && !sh->entries))
        st = LC_ERR_MEMORY;
    for (uint32_t i = 0; i < sh->n_lanes && !st; i++) st = init_lane(sh, &sh->lanes[i]);
    if (st) {
        lc_shader_destroy(sh);
        return st;
    }
    sh->rays->n = sh->rays->n_runs = 0;
    *out = sh;
    return LC_OK;
}

void lc_shader_destroy(lc_shader *sh)
{
    if (!sh) return;
    const lc_context *ctx = sh->tree->ctx;
    for (uint32_t i = 0; i < sh->n_lanes && sh->lanes; i++) {
        if (sh->lanes[i].cut.ctx) lc_cut_free(&sh->lanes[i].cut);
        lc_free(ctx, sh->lanes[i].lights, sh->n_entries, sizeof *sh->entries);
    }
    lc_free(ctx, sh->lanes, sh->n_lanes, sizeof *sh->lanes);
    lc_free(ctx, sh->rays, 1, sizeof *sh->rays);
    lc_free(ctx, sh->starts, LC_HOST_BLOCKS, sizeof *sh->starts);
    lc_free(ctx, sh->entries, sh->n_entries, sizeof *sh->entries);
    lc_free(ctx, sh, 1, sizeof *sh);
}

/* ---- the cut, for the host ---- */

/* Entry of an element of a list of the cut. */
static lc_cut_entry entry_of(const lc_shader *sh, const lc_host_lane *lane, const lc_cut_list *list,
                             uint32_t i, bool light)
{
    const lc_light_tree *t = sh->tree->tree;
    const float *sum = lc_cut_intensity_of(&t->data, list->link[i]);
    const uint32_t rep = list->rep[i];
    lc_cut_entry e = { .light = sh->tree->given[rep], .bound = light ? 0 : list->bound[i] };
    float to[6][LC_LANES], *const out[6] = { to[0], to[1], to[2], to[3], to[4], to[5] };
    if (sh->desc.dims) /* what glass lets through is in the transfer alone */
        lane->cut.ctx->shade_kernels->estimate(&t->data, 0, &rep, 1, lc_kind_of_light(t, rep), &lane->point,
                                               out);
    for (int k = 0; k < 3; k++) {
        const float f = list->transfer[k][i];
        e.weight[k] = sum[k] * (sh->desc.dims && to[k][0] > 0 ? fminf(f / to[k][0], 1) : 1);
        e.radiance[k] = list->e[k][i];
        e.visible |= f > 0;
    }
    return e;
}

/* Keeps the lights that are done now and contribute. */
static void keep_lights(const lc_shader *sh, lc_host_lane *lane)
{
    const lc_cut_list *leaf = &lane->cut.leaf;
    if (lane->cut.worst_first && !lane->worst_first) lane->n_lights = 0; /* begun again */
    lane->worst_first = lane->cut.worst_first;
    for (uint32_t i = 0; i < leaf->n && sh->desc.cut; i++)
        if (leaf->e[0][i] + leaf->e[1][i] + leaf->e[2][i] > 0)
            lane->lights[lane->n_lights++] = entry_of(sh, lane, leaf, i, true);
}

static void give_cut(lc_shader *sh, const lc_host_lane *lane)
{
    const lc_cut_list *kept = &lane->cut.kept;
    uint32_t n = 0;
    for (uint32_t i = 0; i < kept->n; i++) sh->entries[n++] = entry_of(sh, lane, kept, i, false);
    memcpy(sh->entries + n, lane->lights, lane->n_lights * sizeof *lane->lights);
    sh->desc.cut(sh->desc.cut_user, lane->at, sh->entries, n + lane->n_lights);
}

/* ---- points ---- */

/* As lc_slot_hash of render/pixel.c: the points of a block have 16 numbers in an order of its own. */
static uint64_t slot_hash(const lc_shader *sh, const lc_shade_batch *b, uint32_t at)
{
    const uint64_t h = lc_hash4(sh->desc.seed, b->first / LC_HOST_BLOCK + at / LC_HOST_BLOCK, 0, 2);
    return (h & ~(uint64_t)15) | lc_permute16(at % LC_HOST_BLOCK, h);
}

static void begin(lc_shader *sh, const lc_shade_batch *b, lc_host_lane *lane, uint32_t at,
                  const lc_cut_start *start, lc_cut_start *save)
{
    const uint64_t hash = slot_hash(sh, b, at);
    lane->at = at;
    lane->n_lights = 0;
    lane->worst_first = false;
    lane->cut.start = start;
    lane->cut.start_out = save;
    if (save) save->has_points = false; /* of the host's points no box is known */
    lc_host_set_point(lane, sh->tree, b, lc_turn((uint32_t)hash, (uint32_t)(hash >> 48)));
    lc_cut_set_step(&sh->step, &lane->cut, &lane->point, lane->org, &lane->stats);
    lane->waits = lc_cut_begin(&lane->cut, &sh->step, hash);
}

/* Finishes the cuts of the first n lanes. */
static void finish(lc_shader *sh, uint32_t n, float (*rgb)[3])
{
    for (bool waits = true; waits && !sh->cancelled;) {
        waits = false;
        lc_host_trace(sh, n);
        for (uint32_t l = 0; l < n && !sh->cancelled; l++) {
            lc_host_lane *lane = &sh->lanes[l];
            if (!lane->waits) continue;
            keep_lights(sh, lane);
            lc_cut_leaves_done(&lane->cut);
            lc_cut_set_step(&sh->step, &lane->cut, &lane->point, lane->org, &lane->stats);
            lane->waits = lc_cut_go_on(&lane->cut, &sh->step, lane->change);
            waits |= lane->waits;
        }
    }
    for (uint32_t l = 0; l < n && !sh->cancelled; l++) {
        lc_host_lane *lane = &sh->lanes[l];
        lc_cut_result r;
        lc_cut_set_step(&sh->step, &lane->cut, &lane->point, lane->org, &lane->stats);
        lc_cut_end(&lane->cut, &sh->step, &r);
        lc_f3_store(rgb[lane->at], r.radiance);
        if (sh->desc.cut) give_cut(sh, lane);
    }
}

/* Whether a point begins with the guide's cut. */
static bool guides(const lc_shade_point *guide, const lc_shade_point *p)
{
    const lc_f3 way = lc_f3_sub(lc_f3_load(p->position), lc_f3_load(guide->position));
    return lc_f3_dot(lc_f3_load(p->normal), lc_f3_load(guide->normal)) > GUIDE_COS &&
           (guide->reach <= 0 || lc_f3_dot(way, way) <= guide->reach * guide->reach);
}

static uint32_t guide_of(const lc_shade_batch *b, uint32_t first)
{
    return b->n - first > LC_HOST_GUIDE ? first + LC_HOST_GUIDE : first;
}

/* Points first .. end - 1, those of a group: the guides of its blocks, then the others. */
static void shade_group(lc_shader *sh, const lc_shade_batch *b, uint32_t first, uint32_t end, float (*rgb)[3])
{
    uint32_t n = 0;
    for (uint32_t at = first; at < end && sh->starts && !sh->cancelled; at += LC_HOST_BLOCK) {
        begin(sh, b, &sh->lanes[n++], guide_of(b, at), NULL, &sh->starts[(at - first) / LC_HOST_BLOCK]);
        if (n < sh->n_lanes && end - at > LC_HOST_BLOCK) continue;
        finish(sh, n, rgb);
        n = 0;
    }
    for (uint32_t at = first; at < end && !sh->cancelled; at++) {
        const uint32_t block = at - at % LC_HOST_BLOCK, guide = guide_of(b, block);
        const bool alike = sh->starts && guides(&b->points[guide], &b->points[at]);
        if (!sh->starts || at != guide)
            begin(sh, b, &sh->lanes[n++], at, alike ? &sh->starts[(block - first) / LC_HOST_BLOCK] : NULL,
                  NULL);
        if (n < sh->n_lanes && end - at > 1) continue;
        finish(sh, n, rgb);
        n = 0;
    }
}

static lc_status add_stats(lc_shader *sh, lc_shade_stats *given)
{
    lc_shade_stats sum = LC_SHADE_STATS_INIT, *out = &sum;
    memcpy(out, given, given->size < sizeof sum ? given->size : sizeof sum);
    for (uint32_t i = 0; i < sh->n_lanes; i++) {
        lc_stats *s = &sh->lanes[i].stats;
        out->points += s->points;
        out->rays += s->shadow_rays;
        out->cut_sum += s->cut_sum;
        out->bounds_evaluated += s->bounds;
        out->cut_at_limit += s->at_limit;
        out->points_dark += s->dark;
    }
    out->calls += sh->n_calls;
    return lc_desc_give(sh->tree->ctx, "lc_shade_stats", given, out, sizeof *out);
}

lc_status lc_shade(lc_shader *sh, const lc_shade_batch *given, float (*rgb)[3], lc_shade_stats *stats)
{
    if (!sh) return LC_ERR_ARG;
    if (!given) return lc_fail(sh->tree->ctx, LC_ERR_ARG, "batch is NULL");
    lc_shade_batch b = LC_SHADE_BATCH_INIT;
    const lc_shade_batch *batch = &b;
    lc_status st = lc_desc_take(sh->tree->ctx, "batch", &b, sizeof b, given);
    if (!st) st = lc_host_check_batch(sh->tree, batch);
    if (st) return st;
    if (batch->n && !rgb) return lc_fail(sh->tree->ctx, LC_ERR_ARG, "rgb is NULL");
    if (stats && !lc_desc_size_fits(stats->size))
        return lc_fail(sh->tree->ctx, LC_ERR_ARG, "lc_shade_stats: its size is wrong: its INIT sets it");
    const uint32_t group = LC_HOST_BLOCK * LC_HOST_BLOCKS;
    for (uint32_t i = 0; i < sh->n_lanes; i++) sh->lanes[i].stats = (lc_stats){ 0 };
    sh->n_calls = 0;
    sh->cancelled = false;
    for (uint32_t at = 0, n; at < batch->n && !sh->cancelled; at += n) {
        n = batch->n - at < group ? batch->n - at : group;
        shade_group(sh, batch, at, at + n, rgb);
    }
    if (stats) st = add_stats(sh, stats);
    return sh->cancelled ? LC_ERR_CANCELLED : st;
}
