/* edges.c - see edges.h. */
#include "render/edges.h"

#include "render/pixel_sights.h"
#include "scene/sun.h"
#include "shade/lobe.h"

#include <math.h>
#include <string.h>

#define LEAST_SAMPLES 4 /* of a pixel */
#define LEAST_STEP 0.3f /* between the most and the least that is emitted, of the pixel's mean */

/* What camera rays show. */
typedef struct {
    lc_f3 emitted;
    double lit; /* what of light leaves towards the camera from what is lit */
    lc_f3 of_group[LC_MAX_GROUPS]; /* emitted */
} seen;

bool lc_render_has_edges(const lc_scene *scene, const lc_render_desc *d)
{
    return !d->spp && !scene->load.spp && !d->n_passes && !(d->coarse > 1) && !scene->filter.shared &&
           lc_render_spp(scene, d) >= LEAST_SAMPLES;
}

void lc_edges_note(lc_pixel *px, lc_f3 emitted)
{
    const float l = lc_luminance(emitted);
    if (!px->n_emitted || l < px->emitted_least) px->emitted_least = l;
    if (!px->n_emitted || l > px->emitted_most) px->emitted_most = l;
    px->n_emitted++;
}

/* What of an even light reaches the camera from a lit surface; narrow lobes show other surfaces. */
static double part_of(const lc_lit *lit)
{
    lc_material m = lit->surface.material;
    if (lit->followed) m.ks = lc_f3_make(0, 0, 0);
    const lc_f3 albedo = lc_lobes[m.lobe].albedo(&m, fabsf(lc_f3_dot(lit->surface.n, lit->view)));
    return (double)lc_luminance(lc_f3_mul(albedo, lit->weight));
}

/* Adds what the next n rays show. */
static void look(lc_pixel_sights *all, lc_render_worker *w, uint32_t n, seen *to)
{
    const lc_scene *scene = all->job->scene;
    const lc_sight *sight = &all->sight;
    lc_f3 *of_group = w->groups ? to->of_group : NULL;
    for (uint32_t i = 0; i < n; i++) {
        const bool hit = lc_pixel_sights_next(all, of_group);
        w->stats.camera_rays += 1 + (hit ? sight->n_rays : 0);
        to->emitted =
            lc_f3_add(to->emitted, hit ? sight->emission : lc_background(scene, LC_SKY_ALL, all->dir));
        if (!hit && of_group)
            lc_background_of_groups(scene, LC_SKY_ALL, all->dir, lc_f3_make(1, 1, 1), of_group);
        for (uint32_t k = 0; hit && k < sight->n_lit; k++) to->lit += part_of(&sight->lit[k]);
    }
}

/* A sum over samples with what all rays say in place of what the samples do. */
static lc_f3 replaced(lc_f3 sum, lc_f3 of_samples, lc_f3 of_all, float lit)
{
    return lc_f3_add(lc_f3_scale(lc_f3_sub(sum, of_samples), lit), lc_f3_scale(of_all, 1.0f / LC_EDGE_RAYS));
}

void lc_edges_smooth(const lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, lc_pixel *px)
{
    const float step = (px->emitted_most - px->emitted_least) * (float)px->n_emitted;
    lc_pixel_sights all;
    seen to;
    if (!lc_render_has_edges(j->scene, j->desc) || !(step > LEAST_STEP * lc_luminance(px->rgb))) return;
    lc_phase_start(&w->stats);
    memset(&to, 0, sizeof to);
    lc_pixel_sights_begin(&all, j, x, y, 0);
    look(&all, w, j->spp, &to);
    const seen first = to;
    look(&all, w, (LC_EDGE_RAYS - 1) * j->spp, &to);
    const double lit = first.lit > 0 ? to.lit / first.lit / LC_EDGE_RAYS : 0;
    px->rgb = replaced(px->rgb, first.emitted, to.emitted, (float)lit);
    for (uint32_t g = 0; px->of_group && w->groups && g < j->scene->groups.n; g++)
        px->of_group[g] = replaced(px->of_group[g], first.of_group[g], to.of_group[g], (float)lit);
    if (w->interval) {
        double weight[3];
        lc_film_weights(&j->scene->film, lc_f3_make(1, 1, 1), weight);
        lc_interval emitted = lc_interval_of(to.emitted, weight), sum = { 0 };
        const lc_interval of_samples = lc_interval_of(first.emitted, weight);
        lc_interval_add(&sum, &px->interval, lit);
        lc_interval_add(&sum, &of_samples, -lit);
        lc_interval_add(&sum, &emitted, 1.0 / LC_EDGE_RAYS);
        lc_interval_round(&sum, LC_EDGE_RAYS * j->spp);
        px->interval = sum;
    }
    lc_phase_end(&w->stats, LC_PHASE_CAMERA);
    lc_phase_stop(&w->stats);
}
