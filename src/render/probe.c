/* probe.c - one sample of a pixel on its own, with its cut kept: what explain.c asks for. */
#include "render/probe.h"

#include "cut/exact.h"
#include "render/guide.h"
#include "render/pixel_sights.h"
#include "render/sample_keys.h"
#include "scene/lit_point.h"
#include "scene/surface.h"

/* What cuts of the picture are made by; where it makes none, by those of LC_METHOD_CUTS. */
static lc_status probe_desc(lc_render_job *j, lc_probe *p, lc_cut_desc *cut)
{
    const lc_render_desc *desc = j->desc;
    lc_render_desc cuts = *desc;
    lc_render_stats stats = LC_RENDER_STATS_INIT;
    lc_status st = lc_choose_method(j, &stats);
    p->all_lights = j->exact;
    if (!st && j->exact) {
        cuts.method = LC_METHOD_CUTS;
        j->desc = &cuts;
        st = lc_choose_method(j, &stats);
        j->desc = desc;
    }
    *cut = lc_job_cut_desc(j);
    p->mean_luminance = stats.mean_luminance;
    return st;
}

/* A pixel whose sample is explained, and what its cuts begin with and go by. */
typedef struct {
    const lc_render_job *j;
    lc_probe *p;
    lc_guide *guide;
    lc_first_cuts first; /* of a sample before */
    double guide_rest;   /* the part's rest of the cut that made the guide */
    uint32_t x, y;
} probed_pixel;

/* Radiance of what is near a lit point, which counts for the limit of its cut. */
static lc_f3 near_light(const probed_pixel *px, const lc_lit *lit, uint32_t k, const lc_point *point,
                        const lc_sample_keys *keys)
{
    const lc_f3 light = lc_near_bounce_light(px->j->scene, px->p->near, lit, point,
                                             lc_near_sample_of(px->j, keys, k), lc_f3_make(1, 1, 1), NULL);
    px->p->cut.part.rest = (double)lc_luminance(light);
    return light;
}

/* The cuts of one sample, which make the guide if nobody has. False: it has none. */
static bool add_first(probed_pixel *px, uint32_t sample)
{
    const lc_render_job *j = px->j;
    const lc_sample_keys keys = lc_sample_keys_of(j, NULL, px->x, px->y, sample);
    lc_cut *cut = &px->p->cut;
    lc_stats stats = { 0 };
    lc_f3 dir;
    lc_sight sight;
    if (!lc_sample_sight(j, px->x, px->y, sample, NULL, NULL, &dir, &sight)) return false;
    lc_guide_of(j, cut, px->guide, px->x, px->y, sample, NULL);
    cut->row = sample ? LC_NONE : lc_guide_row(px->guide, px->x, px->y);
    for (uint32_t k = 0; k < sight.n_lit; k++) {
        const lc_lit *lit = &sight.lit[k];
        lc_point point[2];
        lc_cut_result r;
        lc_lit_point(j->scene, lit, keys.point + k, point);
        near_light(px, lit, k, point, &keys);
        if (!px->guide->made) px->guide_rest = cut->part.rest;
        lc_guided_cut(cut, px->guide, point, &lit->surface, keys.slot + k, &stats, &r);
        cut->row = LC_NONE;
        px->guide->made = true;
        lc_first_add(&px->first, &lit->surface, r.radiance);
    }
    return sight.n_lit > 0;
}

/* All that is lit but the first; the cut is scratch. */
static void shade_others(probed_pixel *px, const lc_sample_keys *keys)
{
    const lc_render_job *j = px->j;
    lc_probe *p = px->p;
    lc_stats stats = { 0 };
    for (uint32_t i = 1; i < p->sight.n_lit; i++) {
        const lc_lit *lit = &p->sight.lit[i];
        lc_point point[2];
        lc_cut_result r;
        lc_lit_point(j->scene, lit, keys->point + i, point);
        const lc_f3 light = near_light(px, lit, i, point, keys);
        p->cut.alike = lc_first_alike(&px->first, &lit->surface, i);
        if (p->all_lights)
            lc_exact_shade(j->scene->tree, &j->visibility, point, lit->surface.ray_org, &stats, &r);
        else
            lc_guided_cut(&p->cut, px->guide, point, &lit->surface, keys->slot + i, &stats, &r);
        p->others = lc_f3_add(p->others, lc_f3_mul(lc_f3_add(r.radiance, light), lit->weight));
    }
}

/* Makes the cut again, with all before it that it begins with. */
static void probe_cut(probed_pixel *px, uint32_t sample)
{
    const lc_render_job *j = px->j;
    lc_probe *p = px->p;
    lc_guide *g = px->guide;
    const lc_lit *lit = &p->sight.lit[0];
    const lc_sample_keys keys = lc_sample_keys_of(j, NULL, px->x, px->y, sample);
    lc_stats stats = { 0 };
    for (uint32_t i = 0; i < sample && !j->shared; i++)
        if (add_first(px, i)) break;
    lc_guide_of(j, &p->cut, g, px->x, px->y, sample, NULL);
    bool is_guide = !g->made;
    if (is_guide) lc_guide_make(j, &p->cut, g, NULL);
    shade_others(px, &keys);
    p->cut.alike = 0;
    p->cut.part.rest = px->guide_rest;
    g->made = false;
    /* again: its splits are kept for the cut that begins with it. */
    if (!is_guide) lc_guide_make(j, &p->cut, g, NULL);
    lc_lit_point(j->scene, lit, keys.point, p->point);
    const lc_f3 light = near_light(px, lit, 0, p->point, &keys);
    p->others = lc_f3_add(p->others, lc_f3_mul(light, lit->weight));
    p->cut.alike = lc_first_alike(&px->first, &lit->surface, 0);
    p->cut.row = sample ? LC_NONE : lc_guide_row(g, px->x, px->y);
    lc_guided_cut(&p->cut, g, p->point, &lit->surface, keys.slot, &stats, &p->by_cut);
}

static lc_status probe_lit(const lc_render_job *j, uint32_t x, uint32_t y, uint32_t sample, lc_probe *p)
{
    probed_pixel px = { .j = j, .p = p, .x = x, .y = y };
    px.guide = lc_alloc(j->ctx, 1, sizeof *px.guide);
    if (!px.guide) return LC_ERR_MEMORY;
    if (j->evidence && !(px.guide->evidence = lc_alloc_raw(j->ctx, 1, sizeof *px.guide->evidence))) {
        lc_free(j->ctx, px.guide, 1, sizeof *px.guide);
        return LC_ERR_MEMORY;
    }
    probe_cut(&px, sample);
    lc_free(j->ctx, px.guide->evidence, 1, sizeof *px.guide->evidence);
    lc_free(j->ctx, px.guide, 1, sizeof *px.guide);
    return LC_OK;
}

static lc_status probe_sample(lc_render_job *j, uint32_t x, uint32_t y, uint32_t sample, lc_probe *p)
{
    const lc_scene *scene = j->scene;
    lc_cut_desc cut;
    lc_f3 dir;
    if (x >= scene->film.width || y >= scene->film.height)
        return lc_fail(j->ctx, LC_ERR_ARG, "pixel %u,%u is outside the film of %u x %u", x, y,
                       scene->film.width, scene->film.height);
    if (sample >= j->spp)
        return lc_fail(j->ctx, LC_ERR_ARG, "sample %u: a pixel has %u, counted from 0", sample, j->spp);
    lc_status st = probe_desc(j, p, &cut);
    if (!st) st = lc_cut_init(&p->cut, j->ctx, scene->tree, &scene->visibility, &cut, true);
    if (!st) st = lc_near_cuts_create(scene, &p->near);
    if (st) return st;
    p->hit = lc_sample_sight(j, x, y, sample, NULL, NULL, &dir, &p->sight);
    if (p->hit && p->sight.n_lit) return probe_lit(j, x, y, sample, p);
    p->hit &= p->sight.is_hit;
    if (!p->hit) return LC_OK;
    p->sight.lit[0] = (lc_lit){ .surface = p->sight.first, .view = lc_f3_neg(dir), .weight = { 1, 1, 1 } };
    return LC_OK;
}

lc_status lc_render_probe(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc, uint32_t x,
                          uint32_t y, uint32_t sample, lc_probe *p)
{
    lc_render_job j;
    lc_render_desc d;
    uint32_t crop[4];
    *p = (lc_probe){ .hit = false };
    lc_status st = lc_render_take(ctx, scene, desc, &d, crop);
    if (!st) st = lc_render_ready(ctx, scene);
    if (!st && (d.n_passes || d.coarse > 1))
        st = lc_fail(ctx, LC_ERR_ARG, "a sample is explained of a whole picture: no passes, not coarse");
    if (st) return st;
    st = lc_job_init(&j, ctx, scene, &d);
    if (!st) st = probe_sample(&j, x, y, sample, p);
    lc_near_cuts_free(ctx, p->near);
    p->near = NULL;
    lc_job_free(&j);
    return st;
}

void lc_probe_free(lc_probe *p)
{
    if (p->cut.ctx) lc_cut_free(&p->cut);
}
