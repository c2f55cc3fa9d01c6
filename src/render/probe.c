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

/* All that is lit but the first; the cut is scratch. */
static void shade_others(const lc_render_job *j, lc_probe *p, lc_guide *g, const lc_sample_keys *keys)
{
    const uint64_t hash = keys->slot;
    lc_stats stats = { 0 };
    for (uint32_t i = 1; i < p->sight.n_lit; i++) {
        const lc_lit *lit = &p->sight.lit[i];
        lc_point point[2];
        lc_cut_result r;
        lc_lit_point(j->scene, lit, hash + i, point);
        if (p->all_lights)
            lc_exact_shade(j->scene->tree, &j->visibility, point, lit->surface.ray_org, &stats, &r);
        else lc_guided_cut(&p->cut, g, point, &lit->surface, hash + i, &stats, &r);
        const lc_f3 light = lc_near_bounce_light(j->scene, p->near, lit, point, lc_near_sample_of(j, keys, i),
                                                 lit->weight, NULL);
        p->others = lc_f3_add(p->others, lc_f3_mul(lc_f3_add(r.radiance, light), lit->weight));
    }
}

/* Makes the cut again, with all before it that it begins with. */
static lc_status probe_lit(lc_render_job *j, uint32_t x, uint32_t y, uint32_t sample, lc_probe *p)
{
    const lc_lit *lit = &p->sight.lit[0];
    lc_stats stats = { 0 };
    lc_guide *g = lc_alloc(j->ctx, 1, sizeof *g);
    if (!g) return LC_ERR_MEMORY;
    if (j->evidence && !(g->evidence = lc_alloc_raw(j->ctx, 1, sizeof *g->evidence))) {
        lc_free(j->ctx, g, 1, sizeof *g);
        return LC_ERR_MEMORY;
    }
    const lc_sample_keys keys = lc_sample_keys_of(j, NULL, x, y, sample);
    lc_guide_of(j, &p->cut, g, x, y, sample, NULL);
    bool is_guide = !g->made;
    if (is_guide) lc_guide_make(j, &p->cut, g, NULL);
    shade_others(j, p, g, &keys);
    g->made = false;
    /* again: its splits are kept for the cut that begins with it. */
    if (!is_guide) lc_guide_make(j, &p->cut, g, NULL);
    lc_lit_point(j->scene, lit, keys.slot, p->point);
    const lc_f3 light = lc_near_bounce_light(j->scene, p->near, lit, p->point, lc_near_sample_of(j, &keys, 0),
                                             lit->weight, NULL);
    p->others = lc_f3_add(p->others, lc_f3_mul(light, lit->weight));
    p->cut.row = sample ? LC_NONE : lc_guide_row(g, x, y);
    lc_guided_cut(&p->cut, g, p->point, &lit->surface, keys.slot, &stats, &p->by_cut);
    lc_free(j->ctx, g->evidence, 1, sizeof *g->evidence);
    lc_free(j->ctx, g, 1, sizeof *g);
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
    p->hit = lc_sample_sight(j, x, y, sample, NULL, &dir, &p->sight);
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
