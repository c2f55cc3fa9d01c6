/* render.c - lc_render: tiles over threads. */
#include "render/render_job.h"

#include "base/desc.h"
#include "base/memory.h"
#include "base/pool.h"
#include "base/sample.h"
#include "image/image.h"
#include "render/checkpoint.h"
#include "render/edges.h"
#include "render/group_sums.h"
#include "render/guide.h"
#include "render/interpolate.h"
#include "render/interval.h"
#include "render/reconstruct.h"
#include "render/render_tile.h"
#include "render/samples.h"
#include "render/share.h"
#include "scene/near_bounce.h"
#include "tree/light_tree.h"

/* Nanoseconds between calls of progress: what a user sees, and how soon a signal is heard. */
#define CALL_STEP 20000000u

/* False once the render is cancelled. Calls progress when it is time and no other thread does. */
bool lc_job_go_on(void *user)
{
    lc_render_job *j = user;
    if (atomic_load_explicit(&j->cancelled, memory_order_relaxed)) return false;
    if (!j->desc->progress || !j->mutex) return true;
    uint64_t now = (uint64_t)(lc_now() * 1e9);
    if (now < atomic_load_explicit(&j->next_call, memory_order_relaxed) || !lc_mutex_try(j->mutex))
        return true;
    if (now >= atomic_load_explicit(&j->next_call, memory_order_relaxed)) {
        uint64_t done = atomic_load_explicit(&j->done, memory_order_relaxed);
        /* done == total only once, by the end of render_all */
        if (done < j->total && j->desc->progress(j->desc->progress_user, done, j->total))
            atomic_store(&j->cancelled, true);
        atomic_store_explicit(&j->next_call, (uint64_t)(lc_now() * 1e9) + CALL_STEP, memory_order_relaxed);
    }
    lc_mutex_unlock(j->mutex);
    return !atomic_load_explicit(&j->cancelled, memory_order_relaxed);
}

static uint32_t min_u(uint32_t a, uint32_t b) { return a < b ? a : b; }

lc_tile lc_tile_at(const lc_render_job *j, const lc_render_worker *w, uint32_t index)
{
    const uint32_t *c = j->film.crop;
    const uint32_t x0 = c[0] + index % j->tiles_x * LC_TILE, y0 = c[2] + index / j->tiles_x * LC_TILE;
    return (lc_tile){ .index = index,
                      .x0 = x0,
                      .x1 = min_u(x0 + LC_TILE, c[1]),
                      .y0 = y0,
                      .y1 = min_u(y0 + LC_TILE, c[3]),
                      .n_planes = j->n_planes,
                      .pixels = w->tile };
}

/* Whether a host's tile may go to the picture and the statistics. */
static bool is_usable(const lc_render_job *j, const lc_tile *t)
{
    const size_t n = (size_t)(t->x1 - t->x0) * (t->y1 - t->y0) * j->n_planes;
    for (size_t i = 0; i < n; i++)
        if (!isfinite(t->pixels[i])) return false;
    return t->counts.cut_max <= UINT32_MAX;
}

bool lc_tile_take(lc_render_job *j, lc_render_worker *w, lc_tile *t)
{
    lc_tile given = *t; /* the host fills in pixels and counts; nothing else that it does counts */
    if (!j->desc->tile_load || !j->desc->tile_load(j->desc->tile_user, &given)) return false;
    t->counts = given.counts;
    if (!is_usable(j, t)) return false;
    lc_film_set_tile(&j->film, t);
    lc_tile_add_counts(&w->stats, &t->counts);
    const uint64_t pixels = (uint64_t)(t->x1 - t->x0) * (t->y1 - t->y0);
    atomic_fetch_add(&j->loaded, pixels);
    atomic_fetch_add(&j->done, pixels);
    uint64_t old = atomic_load(&j->loaded_max);
    while (t->counts.cut_max > old &&
           !atomic_compare_exchange_weak(&j->loaded_max, &old, t->counts.cut_max)) {}
    return true;
}

/* What is in the tile of the block that begins at, or the tile has from, a pixel on; first the one that makes
 * the block's guide. */
static bool render_block(lc_render_job *j, lc_render_worker *w, const lc_tile *t, uint32_t x0, uint32_t y0)
{
    const uint32_t x1 = min_u(x0 + LC_PIXEL_BLOCK - x0 % LC_PIXEL_BLOCK, t->x1),
                   y1 = min_u(y0 + LC_PIXEL_BLOCK - y0 % LC_PIXEL_BLOCK, t->y1);
    const uint32_t at_x = lc_guide_pixel(x0), at_y = lc_guide_pixel(y0);
    const bool makes = at_x >= x0 && at_x < x1 && at_y >= y0 && at_y < y1;
    if (makes && !lc_render_pixel(j, w, at_x, at_y)) return false;
    for (uint32_t y = y0; y < y1; y++)
        for (uint32_t x = x0; x < x1; x++)
            if (!(makes && x == at_x && y == at_y) && !lc_render_pixel(j, w, x, y)) return false;
    atomic_fetch_add_explicit(&j->done, (uint64_t)(x1 - x0) * (y1 - y0), memory_order_relaxed);
    return true;
}

void lc_tile_give(const lc_render_job *j, const lc_render_worker *w, const lc_stats *before, lc_tile *t)
{
    if (!j->desc->tile_done) return;
    lc_film_get_tile(&j->film, t);
    lc_tile_counts_between(before, &w->stats, w->cut_max, &t->counts);
    j->desc->tile_done(j->desc->tile_user, t);
}

/* Tiles are rendered all over the picture from the beginning, so that those that are done tell how long the
 * others take. */
static void render_tile(void *user, uint32_t thread, uint64_t item)
{
    lc_render_job *j = user;
    lc_render_worker *w = &j->workers[thread];
    if (!lc_job_go_on(j)) return;
    const double cpu = lc_thread_cpu();
    lc_tile t = lc_tile_at(j, w, (uint32_t)lc_spread(item, (uint64_t)j->tiles_x * j->tiles_y));
    if (lc_tile_take(j, w, &t)) return;
    lc_stats before = w->stats;
    w->cut_max = 0;
    for (uint32_t y = t.y0; y < t.y1; y += LC_PIXEL_BLOCK - y % LC_PIXEL_BLOCK)
        for (uint32_t x = t.x0; x < t.x1; x += LC_PIXEL_BLOCK - x % LC_PIXEL_BLOCK)
            if (!render_block(j, w, &t, x, y)) return;
    w->stats.cpu_seconds += lc_thread_cpu() - cpu;
    lc_tile_give(j, w, &before, &t);
}

static size_t n_shared(const lc_render_job *j)
{
    return (size_t)j->group * j->group * LC_TILE * LC_TILE;
}

/* Floats of all planes of a tile. */
static size_t n_tile(const lc_render_job *j)
{
    return ((size_t)LC_N_PLANES + 3 * j->scene->groups.n) * LC_TILE * LC_TILE;
}

void lc_job_free_workers(lc_render_job *j)
{
    for (uint32_t i = 0; i < j->ctx->n_threads && j->workers; i++) {
        if (!j->workers[i].cut.ctx) continue;
        lc_free(j->ctx, j->workers[i].shared, n_shared(j), sizeof *j->workers[i].shared);
        lc_free(j->ctx, j->workers[i].tile, n_tile(j), sizeof(float));
        lc_free(j->ctx, j->workers[i].guide.evidence, 1, sizeof *j->workers[i].guide.evidence);
        lc_pixel_points_free(j->ctx, j->workers[i].points);
        lc_interval_free_room(j->ctx, &j->workers[i]);
        lc_groups_free_room(j->ctx, &j->workers[i]);
        lc_block_light_free(j, &j->workers[i]);
        lc_free(j->ctx, j->workers[i].edges, 1, sizeof *j->workers[i].edges);
        lc_free(j->ctx, j->workers[i].cut_hist, (size_t)j->workers[i].cut.max_size + 2, sizeof(uint64_t));
        lc_near_cuts_free(j->ctx, j->workers[i].near);
        lc_cut_free(&j->workers[i].cut);
    }
    lc_free(j->ctx, j->workers, j->ctx->n_threads, sizeof *j->workers);
    j->workers = NULL;
}

void lc_job_free(lc_render_job *j)
{
    lc_job_free_workers(j);
    lc_coarse_free(j);
    lc_knots_free(j);
    lc_moments_free(&j->moments);
    lc_free(j->ctx, j->share, 1, sizeof *j->share);
    lc_free(j->ctx, j->parent, j->scene->tree->n_lights, sizeof *j->parent);
    j->share = NULL;
    j->parent = NULL;
}

lc_status lc_job_make_workers(lc_render_job *j, const lc_cut_desc *desc)
{
    j->workers = lc_alloc(j->ctx, j->ctx->n_threads, sizeof *j->workers);
    if (!j->workers) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < j->ctx->n_threads; i++) {
        lc_render_worker *w = &j->workers[i];
        lc_status st = lc_cut_init(&w->cut, j->ctx, j->scene->tree, &j->visibility, desc, false);
        if (st) return st;
        if ((st = lc_near_cuts_create(j->scene, &w->near))) return st;
        w->cut_hist = lc_alloc(j->ctx, (size_t)w->cut.max_size + 2, sizeof *w->cut_hist);
        if (!w->cut_hist) return LC_ERR_MEMORY;
        const uint32_t in_media = j->scene->media.present ? j->spp * j->how.n_points : 0,
                       most = 2 * desc->max_points + in_media;
        if (desc->max_points && !(w->points = lc_pixel_points_create(j->ctx, most))) return LC_ERR_MEMORY;
        if (j->evidence && !(w->guide.evidence = lc_alloc_raw(j->ctx, 1, sizeof *w->guide.evidence)))
            return LC_ERR_MEMORY;
        if (lc_render_has_edges(j->scene, j->desc) && !(w->edges = lc_alloc(j->ctx, 1, sizeof *w->edges)))
            return LC_ERR_MEMORY;
        if (lc_may_interpolate(j) && (st = lc_block_light_init(j, w))) return st;
        w->stats.go_on = lc_job_go_on;
        w->stats.go_on_user = j;
        bool tiles = j->desc->tile_load || j->desc->tile_done;
        if (tiles && !(w->tile = lc_alloc(j->ctx, n_tile(j), sizeof(float))))
            return LC_ERR_MEMORY;
        if (j->share && !(w->shared = lc_alloc(j->ctx, n_shared(j), sizeof *w->shared))) return LC_ERR_MEMORY;
    }
    return LC_OK;
}

lc_status lc_render_take(const lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc,
                         lc_render_desc *out, uint32_t crop[4])
{
    *out = (lc_render_desc)LC_RENDER_DESC_INIT;
    lc_status st = lc_desc_take(ctx, "lc_render_desc", out, sizeof *out, desc);
    return st ? st : lc_render_check(ctx, scene, out, crop);
}

lc_status lc_render_check(const lc_context *ctx, const lc_scene *scene, const lc_render_desc *d,
                            uint32_t crop[4])
{
    const lc_film_desc *f = &scene->film;
    if (d->method < LC_METHOD_LIGHTCUTS || d->method > LC_METHOD_CUTS)
        return lc_fail(ctx, LC_ERR_ARG, "method is none of lc_method");
    if (!(d->error_ratio >= 0) || !isfinite(d->error_ratio) || !(d->dark_floor >= 0) ||
        !isfinite(d->dark_floor))
        return lc_fail(ctx, LC_ERR_ARG, "error ratio and dark floor must be finite and at least 0");
    if (!(d->error >= 0) || !isfinite(d->error) || (d->error > 0 && !(d->within > 0 && d->within < 100)))
        return lc_fail(ctx, LC_ERR_ARG,
                       "the error must be finite and at least 0, the share within it above 0 and below 100");
    lc_calibration c = LC_CALIBRATION_INIT;
    const lc_status st = d->calibration ? lc_desc_take(ctx, "lc_calibration", &c, sizeof c, d->calibration)
                                        : LC_OK;
    if (st) return st;
    if (d->calibration && d->calibration->size < sizeof c)
        return lc_fail(ctx, LC_ERR_ARG, "a calibration must say whether it was found with evidence");
    if (d->calibration && !(c.z > 0 && isfinite(c.z)))
        return lc_fail(ctx, LC_ERR_ARG, "a calibration's z must be finite and above 0");
    if (d->calibration && !(c.dark >= 0 && c.dark <= 64))
        return lc_fail(ctx, LC_ERR_ARG, "a calibration's dark must be at most 64");
    if (!(d->seconds >= 0) || !isfinite(d->seconds))
        return lc_fail(ctx, LC_ERR_ARG, "seconds must be finite and at least 0");
    if (d->seconds > 0 && (!(d->error > 0) || d->calibration))
        return lc_fail(ctx, LC_ERR_ARG, "seconds need an error above 0 and no calibration");
    if (d->spp > LC_MAX_SPP || d->n_passes > LC_MAX_SPP)
        return lc_fail(ctx, LC_ERR_ARG, "more than %u samples per pixel", LC_MAX_SPP);
    if (d->pass && d->pass >= d->n_passes)
        return lc_fail(ctx, LC_ERR_ARG, "pass %u of %u: passes count from 0", d->pass, d->n_passes);
    if ((d->n_passes || d->coarse > 1) && d->error > 0)
        return lc_fail(ctx, LC_ERR_ARG, "of passes and coarse pictures no error of pixels can be asked");
    const lc_status coarse = lc_coarse_check(ctx, scene, d);
    if (coarse) return coarse;
    bool scene_crop = !d->crop[0] && !d->crop[1] && !d->crop[2] && !d->crop[3];
    for (int i = 0; i < 4; i++) {
        if (d->crop[i] < 0)
            return lc_fail(ctx, LC_ERR_ARG, "crop is outside the film of %u x %u", f->width, f->height);
        crop[i] = scene_crop ? f->crop[i] : (uint32_t)d->crop[i];
    }
    if (crop[0] >= crop[1] || crop[2] >= crop[3] || crop[1] > f->width || crop[3] > f->height)
        return lc_fail(ctx, LC_ERR_ARG, "crop is empty or outside the film of %u x %u", f->width, f->height);
    return LC_OK;
}

static lc_status render_all(lc_render_job *j, const uint32_t crop[4], lc_render_stats *stats)
{
    const lc_film_desc *f = &j->scene->film;
    const double t0 = j->began = lc_now();
    lc_status st = lc_choose_method(j, stats);
    if (!st && atomic_load(&j->cancelled)) st = LC_ERR_CANCELLED;
    if (st) return st;
    lc_cut_desc cut = lc_job_cut_desc(j);
    if (j->exact) cut.max_cut = 1; /* no cuts are made */
    j->tiles_x = (crop[1] - crop[0] + LC_TILE - 1) / LC_TILE;
    j->tiles_y = (crop[3] - crop[2] + LC_TILE - 1) / LC_TILE;
    lc_choose_group(j);
    st = lc_job_make_workers(j, &cut);
    if (!st && j->desc->aovs & LC_AOV_INTERVAL) st = lc_interval_make_rooms(j, &cut);
    if (!st && j->desc->coarse > 1) st = lc_coarse_init(j, crop);
    if (!st && j->interpolated) st = lc_knots_init(j, crop);
    if (!st) st = lc_groups_make_rooms(j, n_shared(j));
    if (!st) st = lc_film_init(&j->film, j->ctx, crop, f, j->desc->aovs, &j->scene->groups);
    if (st) return st;
    j->n_planes = lc_image_n_channels(j->film.image);
    j->film.image->draft = j->coarse != NULL;
    if (j->coarse) {
        lc_parallel(j->ctx, lc_coarse_n_strips(j), lc_coarse_strip, j);
        lc_parallel(j->ctx, lc_coarse_n_rows(j), lc_coarse_smooth, j);
    }
    if (j->share) lc_parallel(j->ctx, lc_n_groups(j), lc_render_group, j);
    else lc_parallel(j->ctx, (uint64_t)j->tiles_x * j->tiles_y, render_tile, j);
    if (atomic_load(&j->cancelled)) return LC_ERR_CANCELLED;
    if (j->desc->progress && j->desc->progress(j->desc->progress_user, j->total, j->total))
        return LC_ERR_CANCELLED;
    stats->seconds = lc_now() - t0;
    stats->pixels = j->total;
    stats->pixels_loaded = atomic_load(&j->loaded);
    lc_job_join_stats(j, stats);
    return lc_job_set_attributes(j, stats);
}

#define GATHER_FROM 8 /* samples of a pixel: fewer are faster by cuts of their own; tests/results/pixels.md */

/* What a picture is that was not finished. */
static lc_status keep_partial(lc_render_job *j, lc_render_stats *stats)
{
    const uint64_t done = atomic_load(&j->done);
    stats->pixels = done;
    lc_job_join_stats(j, stats);
    const lc_status st = lc_job_set_attributes(j, stats);
    return st ? st
              : lc_image_set_number(j->film.image, "lightcuts/finished", (double)done / (double)j->total);
}

/* Lets samples of a pixel share cuts, where there is room for the names of their pairs. */
static lc_status share_cuts(lc_render_job *j)
{
    const lc_light_tree *t = j->scene->tree;
    const uint32_t most = lc_gather_capacity(t->n_lights);
    if (most < 2 || !t->n_lights) return LC_OK;
    j->parent = lc_alloc(j->ctx, t->n_lights, sizeof *j->parent);
    if (!j->parent) return LC_ERR_MEMORY;
    j->max_points = j->spp < 2 ? 2 : j->spp < most ? j->spp : most;
    for (uint32_t i = 0; i < t->n_nodes; i++) {
        const uint32_t child[2] = { t->data.nodes[i].left, t->data.nodes[i].right };
        for (int k = 0; k < 2; k++)
            if (child[k] & LC_LEAF) j->parent[child[k] & ~LC_LEAF] = i;
    }
    return LC_OK;
}

lc_status lc_job_init(lc_render_job *j, lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc)
{
    *j = (lc_render_job){
        .ctx = ctx, .scene = scene, .desc = desc, .spp = lc_render_spp(scene, desc),
        .moments = { .ctx = ctx }, .visibility = scene->visibility
    };
    if (scene->filter.shared && !(desc->coarse > 1)) {
        j->share = lc_alloc(ctx, 1, sizeof *j->share);
        if (!j->share) return LC_ERR_MEMORY;
        lc_filter_share_init(j->share, &scene->film.filter, j->spp);
        if (desc->n_passes && (!j->share->lattice || j->share->n != desc->n_passes))
            return lc_fail(ctx, LC_ERR_ARG, "no %u passes with this pixel filter, whose samples make a grid",
                           desc->n_passes);
        j->spp = j->share->n;
    }
    j->first = desc->n_passes ? desc->pass : 0;
    j->end = desc->n_passes ? desc->pass + 1 : j->spp;
    if ((j->spp >= GATHER_FROM || scene->media.present) && !j->share && desc->error > 0) {
        lc_status st = share_cuts(j);
        if (st) return st;
    }
    /* samples share a pixel; as in pbrt, one sees no less than an eighth of it */
    while (j->lens_order * 2 + 1 < j->spp) j->lens_order = j->lens_order * 2 + 1;
    j->how = (lc_sight_desc){ .pixel = scene->camera.pixel * fmax(0.125, 1 / sqrt((double)j->spp)),
                              .max_depth = lc_render_depth(scene, desc),
                              .n_points = (LC_MEDIUM_POINTS + j->spp - 1) / j->spp,
                              .offset = 0.5 };
    return LC_OK;
}

lc_status lc_render(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc, lc_image **out,
                    lc_render_stats *stats)
{
    lc_render_desc d;
    lc_render_stats own = LC_RENDER_STATS_INIT;
    uint32_t crop[4];
    if (out) *out = NULL;
    if (!ctx) return LC_ERR_ARG;
    if (!scene || !desc || !out) return lc_fail(ctx, LC_ERR_ARG, "lc_render: scene, desc or out is NULL");
    lc_status st = lc_render_take(ctx, scene, desc, &d, crop);
    if (!st) st = lc_render_ready(ctx, scene);
    if (!st) st = lc_checkpoint_check(scene, &d);
    if (!st && stats) st = lc_desc_give(ctx, "lc_render_stats", stats, &own, sizeof own);
    if (st) return st;
    lc_memory_step(ctx, "rendering");
    lc_render_job j;
    st = lc_job_init(&j, ctx, scene, &d);
    if (!st) st = lc_moments_make(&j.moments, scene, j.spp);
    if (!st) j.visibility = lc_moments_visibility(&j.moments, scene);
    j.total = (uint64_t)(crop[1] - crop[0]) * (crop[3] - crop[2]);
    j.mutex = st ? NULL : lc_mutex_create(ctx);
    if (!st) st = j.mutex ? render_all(&j, crop, &own) : LC_ERR_MEMORY;
    lc_mutex_destroy(ctx, j.mutex);
    const bool kept = st == LC_ERR_CANCELLED && d.partial && j.film.image && atomic_load(&j.done) &&
                      !keep_partial(&j, &own);
    lc_job_free(&j);
    if (st && !kept) lc_image_destroy(j.film.image);
    else *out = j.film.image;
    if (stats) (void)lc_desc_give(ctx, "lc_render_stats", stats, &own, sizeof own);
    return st;
}

lc_status lc_render_crop(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc, uint32_t crop[4])
{
    lc_render_desc d;
    if (!ctx) return LC_ERR_ARG;
    if (!scene || !desc || !crop)
        return lc_fail(ctx, LC_ERR_ARG, "lc_render_crop: scene, desc or crop is NULL");
    return lc_render_take(ctx, scene, desc, &d, crop);
}
