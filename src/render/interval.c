/* interval.c - the intervals of a pixel's samples.
 *
 *     sample -> what it shows -> a cut for each lit point -> interval in luminance of the picture
 *
 * Their cuts are made beside those of the picture, which does not change, and count in none of its
 * statistics. Each sample has cuts of its own, that begin with the roots, by the slots of the picture's.
 */
#include "render/interval.h"

#include "cut/exact.h"
#include "render/edges.h"
#include "render/pixel_sights.h"
#include "render/sample_keys.h"
#include "scene/lit_point.h"
#include "scene/sun.h"
#include "trace/bvh.h"

struct lc_interval_room {
    lc_cut cut;
    lc_stats stats;
};

lc_status lc_interval_make_rooms(lc_render_job *j, const lc_cut_desc *desc)
{
    lc_cut_desc own = *desc;
    own.max_points = 0;
    for (uint32_t i = 0; i < j->ctx->n_threads; i++) {
        lc_render_worker *w = &j->workers[i];
        w->interval = lc_alloc(j->ctx, 1, sizeof *w->interval);
        if (!w->interval) return LC_ERR_MEMORY;
        w->interval->stats.go_on = lc_job_go_on;
        w->interval->stats.go_on_user = j;
        lc_status st =
            lc_cut_init(&w->interval->cut, j->ctx, j->scene->tree, &j->visibility, &own, false);
        if (st) return st;
        /* The error that is asked for is the pixel's: a sample's cut may be the rougher. */
        if (j->shared) w->interval->cut.part.share = 1 / (float)j->spp;
    }
    return LC_OK;
}

void lc_interval_free_room(const lc_context *ctx, lc_render_worker *w)
{
    if (w->interval && w->interval->cut.ctx) lc_cut_free(&w->interval->cut);
    lc_free(ctx, w->interval, 1, sizeof *w->interval);
    w->interval = NULL;
}

/* Adds what a surface shows. */
static void add_lit(const lc_render_job *j, struct lc_interval_room *room, lc_near_cuts *near,
                    const lc_lit *lit, uint32_t k, const lc_sample_keys *keys, uint64_t key, lc_interval *sum)
{
    lc_point point[2];
    lc_cut_result r;
    lc_interval part;
    double weight[3];
    const uint64_t hash = keys->slot + k;
    lc_film_weights(&j->scene->film, lit->weight, weight);
    lc_lit_point(j->scene, lit, hash, point);
    lc_cut_shade(&room->cut, point, lit->surface.ray_org, hash, &room->stats, &r);
    lc_cut_interval(&room->cut, point, lit->surface.ray_org, weight, key, &room->stats, &part);
    lc_interval_add(sum, &part, 1);
    const lc_scene *scene = lc_moments_scene(&j->moments, j->scene, lit->surface.moment);
    part = lc_interval_of(lc_near_bounce_light(scene, near, lit, point, lc_near_sample_of(j, keys, k),
                                               lit->weight, NULL), weight);
    lc_interval_add(sum, &part, 1);
}

bool lc_sample_interval(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, uint32_t i, lc_f3 rgb,
                        lc_interval *out)
{
    const lc_sample_keys keys = lc_sample_keys_of(j, NULL, x, y, i);
    double weight[3];
    lc_f3 dir;
    lc_sight s;
    lc_film_weights(&j->scene->film, lc_f3_make(1, 1, 1), weight);
    if (j->exact) {
        *out = lc_interval_of(rgb, weight);
    } else if (!lc_sample_sight(j, x, y, i, &w->light, NULL, &dir, &s)) {
        const lc_f3 emitted = lc_background(j->scene, LC_SKY_ALL, dir);
        *out = lc_interval_of(lc_edges_emitted(w, emitted), weight);
    } else {
        if (!lc_job_go_on(j)) return false;
        *out = lc_interval_of(lc_edges_emitted(w, s.emission), weight);
        for (uint32_t k = 0; k < s.n_lit; k++) {
            s.lit[k].weight = lc_f3_scale(s.lit[k].weight, lc_edges_weight(w, i, k));
            add_lit(j, w->interval, w->near, &s.lit[k], k, &keys,
                    lc_job_key(j, lc_pixel_number(j, x, y), i, LC_DIM_INTERVAL + k), out);
        }
    }
    lc_interval_round(out, j->spp);
    return true;
}

bool lc_add_interval(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, uint32_t i, lc_f3 rgb,
                     lc_pixel *px)
{
    lc_interval part;
    if (!w->interval) return true;
    if (!lc_sample_interval(j, w, x, y, i, rgb, &part)) return false;
    lc_interval_add(&px->interval, &part, 1);
    return true;
}
