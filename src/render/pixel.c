/* pixel.c - samples of a pixel: camera rays, the points they light, their cuts. */
#include "render/render_job.h"

#include "cut/exact.h"
#include "render/edges.h"
#include "render/group_sums.h"
#include "render/guide.h"
#include "render/interpolate.h"
#include "render/interval.h"
#include "render/pixel_sights.h"
#include "render/reconstruct.h"
#include "render/sample_keys.h"
#include "render/samples.h"
#include "scene/lit_point.h"
#include "scene/sun.h"

#include <math.h>
#include <string.h>

#define ASK_STEP 1000 /* rays and lights between looks at the clock: 10 us and more */

/* Adds the light of surfaces nearby. */
static void add_near(lc_render_worker *w, lc_f3 near_light, const lc_f3 *of_group, lc_cut_result *out)
{
    out->radiance = lc_f3_add(out->radiance, near_light);
    for (uint32_t k = 0; w->groups && k < w->groups->n; k++) {
        w->groups->cut[k][0] += (double)of_group[k].x;
        w->groups->cut[k][1] += (double)of_group[k].y;
        w->groups->cut[k][2] += (double)of_group[k].z;
    }
}

void lc_shade_lit(const lc_render_job *j, lc_render_worker *w, const lc_lit *lit, uint32_t k, lc_guide *g,
                  const lc_sample_keys *keys, lc_cut_result *out)
{
    const lc_surface *s = &lit->surface;
    lc_point point[2], *p = point;
    lc_f3 of_group[LC_MAX_GROUPS];
    lc_lit_point(j->scene, lit, keys->point + k, point);
    for (uint32_t m = 0; w->groups && m < w->groups->n; m++) of_group[m] = lc_f3_make(0, 0, 0);
    const lc_f3 near_light =
        lc_near_bounce_light(lc_moments_scene(&j->moments, j->scene, s->moment), w->near, lit, p,
                             lc_near_sample_of(j, keys, k), lc_f3_make(1, 1, 1), w->groups ? of_group : NULL);
    w->cut.part.rest = (double)lc_luminance(near_light);
    w->stats.glossy += p->lobe != LC_LOBE_NONE;
    if (j->exact) {
        lc_exact_shade_groups(j->scene->tree, &j->visibility, p, s->ray_org,
                              w->groups ? w->groups->cut : NULL, &w->stats, out);
    } else {
        w->cut.alike = w->is_first ? 0 : lc_first_alike(&w->first, s, k);
        lc_guided_cut(&w->cut, g, p, s, keys->slot + k, &w->stats, out);
        w->cut.alike = 0;
        if (w->is_first) lc_first_add(&w->first, s, out->radiance);
        w->cut_hist[out->size]++;
    }
    if (out->size > w->cut_max) w->cut_max = out->size;
    w->cut.part.rest = 0;
    add_near(w, near_light, of_group, out);
}

/* Fills what the statistics and planes want. */
void lc_shade_sight(const lc_render_job *j, lc_render_worker *w, const lc_sight *sight, lc_guide *g,
                    const lc_sample_keys *keys, lc_cut_result *sum)
{
    *sum = (lc_cut_result){ .size = 0 };
    for (uint32_t i = 0; i < sight->n_lit; i++) {
        lc_cut_result r;
        lc_shade_lit(j, w, &sight->lit[i], i, g, keys, &r);
        w->cut.row = LC_NONE;
        if (g) g->made = true;
        sum->radiance = lc_f3_add(sum->radiance, lc_f3_mul(r.radiance, sight->lit[i].weight));
        lc_groups_add_cut(w->groups, sight->lit[i].weight);
        sum->size += r.size;
        sum->rays += r.rays;
        sum->max_error = r.max_error > sum->max_error ? r.max_error : sum->max_error;
    }
}

void lc_add_to_planes(const lc_render_job *j, lc_pixel *px, const lc_sight *sight, lc_f3 dir)
{
    const lc_surface *s = &sight->first;
    if (!sight->is_hit) return;
    const double *axis = j->scene->camera.axis;
    float cos_axis = (float)(axis[0] * (double)dir.x + axis[1] * (double)dir.y + axis[2] * (double)dir.z);
    px->n = lc_f3_add(px->n, s->n);
    px->p = lc_f3_add(px->p, s->pos);
    px->albedo = lc_f3_add(px->albedo, lc_f3_add(s->material.kd, s->material.ks));
    px->z += s->t * cos_axis;
    px->hits++;
    px->cover += 1;
}

/* Reading the clock for every sample would cost some percent where a pixel takes half a microsecond. */
bool lc_time_to_ask(lc_render_worker *w)
{
    uint64_t work = w->stats.camera_rays + w->stats.shadow_rays + w->stats.cut_sum;
    if (work - w->asked < ASK_STEP) return false;
    w->asked = work;
    return true;
}

bool lc_render_sample(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, uint32_t i, lc_pixel *px,
                      lc_f3 *rgb)
{
    lc_f3 dir;
    lc_sight s;
    lc_cut_result r;
    if (lc_time_to_ask(w) && !lc_job_go_on(j)) return false;
    lc_phase_start(&w->stats);
    if (i == j->first) w->first.n = 0;
    w->stats.camera_rays++;
    lc_f3 *of_group = lc_groups_begin_sample(w->groups);
    bool hit;
    const bool kept = lc_edges_sight(w, i, &hit, &dir, &s);
    if (!kept) hit = lc_sample_sight(j, x, y, i, &w->light, of_group, &dir, &s);
    lc_phase_end(&w->stats, LC_PHASE_CAMERA);
    if (!hit) {
        *rgb = kept ? s.emission : lc_background(j->scene, LC_SKY_ALL, dir);
        if (of_group && !kept)
            lc_background_of_groups(j->scene, LC_SKY_ALL, dir, lc_f3_make(1, 1, 1), of_group);
        lc_phase_stop(&w->stats);
        return true;
    }
    w->stats.camera_rays += s.n_rays;
    lc_guide *g = j->exact || w->alone ? NULL : lc_guide_of(j, &w->cut, &w->guide, x, y, i, lc_guide_work(w));
    w->cut.row = i + w->slot_shift ? LC_NONE : lc_guide_row(g, x, y);
    const lc_sample_keys keys = lc_sample_keys_of(j, w, x, y, i);
    w->is_first = !w->first.n;
    lc_shade_sight(j, w, &s, g, &keys, &r);
    w->is_first = false;
    *rgb = lc_f3_add(r.radiance, s.emission);
    lc_add_to_planes(j, px, &s, dir);
    px->cut += (float)r.size;
    px->rays += (float)r.rays;
    px->error += r.max_error;
    lc_phase_end(&w->stats, LC_PHASE_OTHER);
    lc_phase_stop(&w->stats);
    /* The exact method may have stopped halfway. */
    return !atomic_load_explicit(&j->cancelled, memory_order_relaxed);
}

static bool add_samples(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, lc_pixel *px)
{
    if (j->shared && !j->exact) {
        for (uint32_t i = j->first; i < j->end; i++)
            if (!lc_add_interval(j, w, x, y, i, px->rgb, px)) return false;
        return lc_add_shared_samples(j, w, x, y, px);
    }
    for (uint32_t i = j->first; i < j->end; i++) {
        lc_f3 rgb;
        if (!lc_render_sample(j, w, x, y, i, px, &rgb)) return false;
        px->rgb = lc_f3_add(px->rgb, rgb);
        lc_groups_end_sample(w->groups);
        if (!lc_add_interval(j, w, x, y, i, rgb, px)) return false;
    }
    return true;
}

bool lc_add_samples(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, lc_pixel *px)
{
    lc_edges_find(j, w, x, y);
    const bool done = add_samples(j, w, x, y, px);
    lc_edges_end(w);
    return done;
}

/* False: cancelled, nothing stored. */
bool lc_render_pixel(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y)
{
    if (j->coarse) return lc_coarse_pixel(j, w, x, y);
    if (j->interpolated) return lc_interpolated_pixel(j, w, x, y);
    lc_pixel px = { .weight = (float)(j->end - j->first), .of_group = lc_groups_begin_pixel(w->groups) };
    if (!lc_add_samples(j, w, x, y, &px)) return false;
    if (!lc_film_store(&j->film, x, y, &px)) w->stats.nonfinite++;
    return true;
}
