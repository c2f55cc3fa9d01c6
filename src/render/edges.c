/* edges.c - see edges.h. */
#include "render/edges.h"

#include "render/group_sums.h"
#include "render/pixel_sights.h"
#include "scene/sun.h"
#include "shade/lobe.h"

#include <math.h>
#include <string.h>

#define LEAST_SAMPLES 4 /* of a pixel */
#define LEAST_STEP 0.3f /* between the most and the least that is emitted, of its mean */
#define LEAST_COS 0.9f  /* between normals of surfaces alike */
#define REACH 0.1f      /* of the distance to the camera: how far they are apart at most */

/* What camera rays show. */
typedef struct {
    lc_edges *e;
    bool is_sample; /* of the pixel; surfaces become parts, and points entries */
    lc_f3 emitted;
    float least, most; /* luminance of that */
    double unknown;    /* of an even light, of surfaces that no sample shows */
    uint64_t surfaces; /* of the first sample */
    bool differ, fits;
} view;

bool lc_render_has_edges(const lc_scene *scene, const lc_render_desc *d)
{
    const uint32_t spp = lc_render_spp(scene, d);
    return !d->spp && !scene->load.spp && !d->n_passes && !(d->coarse > 1) && !scene->filter.shared &&
           spp >= LEAST_SAMPLES && spp <= LC_EDGE_SAMPLES;
}

/* What of an even light reaches the camera from a lit surface; narrow lobes show other surfaces. */
static double even_light(const lc_lit *lit)
{
    lc_material m = lit->surface.material;
    if (lit->followed) m.ks = lc_f3_make(0, 0, 0);
    const lc_f3 albedo = lc_lobes[m.lobe].albedo(&m, fabsf(lc_f3_dot(lit->surface.n, lit->view)));
    return (double)lc_luminance(lc_f3_mul(albedo, lit->weight));
}

/* The part of a surface; LC_EDGE_PARTS: there is none, and no more room for it where it is a sample's. */
static uint32_t part_of(view *v, const lc_surface *s)
{
    lc_edges *e = v->e;
    for (uint32_t i = 0; i < e->n_parts; i++) {
        const lc_edge_part *p = &e->parts[i];
        const lc_f3 way = lc_f3_sub(p->pos, s->pos);
        if (p->material == s->material_id && lc_f3_dot(way, way) <= p->reach2 &&
            lc_f3_dot(p->n, s->n) > LEAST_COS)
            return i;
    }
    if (!v->is_sample || e->n_parts == LC_EDGE_PARTS) return LC_EDGE_PARTS;
    e->parts[e->n_parts] = (lc_edge_part){
        .pos = s->pos, .n = s->n, .reach2 = REACH * REACH * s->t * s->t, .material = s->material_id
    };
    return e->n_parts++;
}

static void add_lit(view *v, const lc_lit *lit, uint32_t entry)
{
    lc_edges *e = v->e;
    const bool in_medium = lit->surface.material.lobe == LC_LOBE_PHASE;
    const uint32_t part = in_medium ? LC_EDGE_PARTS : part_of(v, &lit->surface);
    if (v->is_sample) e->part[entry] = (uint8_t)part;
    if (in_medium) return;
    const double even = even_light(lit);
    if (part == LC_EDGE_PARTS) {
        v->unknown += even;
        v->fits &= !v->is_sample;
        return;
    }
    e->parts[part].of_all += even;
    if (v->is_sample) e->parts[part].of_samples += even;
}

/* A number for the surfaces that a sample shows, but for those in narrow lobes: each sample has others. */
static uint64_t surfaces_of(const lc_sight *s, const uint8_t *part, uint32_t n)
{
    uint64_t all = n > 0;
    const bool by_glass = n && lc_is_specular(&s->first.material);
    for (uint32_t k = 0; k < n; k++)
        if (by_glass || !s->lit[k].n_mirrors) all = all * (LC_EDGE_PARTS + 1) + part[k];
    return all;
}

/* Takes the next n rays. False: what samples show is more than there is room for. */
static bool look(view *v, lc_pixel_sights *all, lc_render_worker *w, uint32_t n)
{
    const lc_scene *scene = all->job->scene;
    const lc_sight *s = &all->sight;
    lc_edges *e = v->e;
    lc_f3 *of_group = w->groups ? e->of_group : NULL;
    for (uint32_t i = 0, entry = 0; i < n; i++) {
        const bool seen = lc_pixel_sights_next(all, of_group);
        const uint32_t n_lit = seen ? s->n_lit : 0;
        const lc_f3 emitted = seen ? s->emission : lc_background(scene, LC_SKY_ALL, all->dir);
        const float l = lc_luminance(emitted);
        if (!seen && of_group)
            lc_background_of_groups(scene, LC_SKY_ALL, all->dir, lc_f3_make(1, 1, 1), of_group);
        v->emitted = lc_f3_add(v->emitted, emitted);
        v->least = fminf(v->least, l);
        v->most = fmaxf(v->most, l);
        if (entry + n_lit > LC_EDGE_ENTRIES) return false;
        for (uint32_t k = 0; k < n_lit; k++) add_lit(v, &s->lit[k], entry + k);
        if (!v->fits) return false;
        if (!v->is_sample) {
            w->stats.camera_rays += 1 + (seen ? s->n_rays : 0);
            continue;
        }
        const uint64_t surfaces = surfaces_of(s, e->part + entry, n_lit);
        if (!i) v->surfaces = surfaces;
        v->differ |= surfaces != v->surfaces;
        e->sample[i] = (lc_edge_sample){ .seen = seen, .dir = all->dir, .emission = emitted, .entry = entry };
        if (!seen) continue;
        e->sample[i].is_hit = s->is_hit;
        e->sample[i].first = s->first;
        e->sample[i].n_rays = s->n_rays;
        e->sample[i].n_lit = n_lit;
        memcpy(e->lit + entry, s->lit, n_lit * sizeof *e->lit);
        entry += n_lit;
    }
    return true;
}

/* What no sample shows is shared out among what they do. */
static void find_weights(lc_edges *e, double unknown)
{
    double known = 0;
    for (uint32_t i = 0; i < e->n_parts; i++) known += e->parts[i].of_all;
    const double rest = known > 0 ? (known + unknown) / known : 1;
    for (uint32_t i = 0; i < e->n_parts; i++) {
        lc_edge_part *p = &e->parts[i];
        p->weight = p->of_samples > 0 ? (float)(rest * p->of_all / p->of_samples / LC_EDGE_RAYS) : 1;
    }
}

void lc_edges_find(const lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y)
{
    lc_edges *e = w->edges;
    lc_pixel_sights all;
    view v = { .e = e, .is_sample = true, .least = INFINITY, .fits = true };
    if (!e) return;
    e->n_parts = 0;
    memset(e->of_group, 0, sizeof e->of_group);
    lc_phase_start(&w->stats);
    lc_pixel_sights_begin(&all, j, x, y, 0, &w->light);
    e->kept = look(&v, &all, w, j->spp);
    v.is_sample = false;
    if (e->kept && (v.differ || (v.most - v.least) * (float)j->spp > LEAST_STEP * lc_luminance(v.emitted))) {
        const float a_sample = 1 / (float)(LC_EDGE_RAYS * j->spp);
        e->on = look(&v, &all, w, (LC_EDGE_RAYS - 1) * j->spp);
        find_weights(e, v.unknown);
        e->emitted = lc_f3_scale(v.emitted, a_sample);
        for (uint32_t g = 0; g < LC_MAX_GROUPS; g++) e->of_group[g] = lc_f3_scale(e->of_group[g], a_sample);
    }
    lc_phase_end(&w->stats, LC_PHASE_CAMERA);
    lc_phase_stop(&w->stats);
}

void lc_edges_end(lc_render_worker *w)
{
    if (w->edges) w->edges->on = w->edges->kept = false;
}

bool lc_edges_sight(const lc_render_worker *w, uint32_t i, bool *seen, lc_f3 *dir, lc_sight *s)
{
    const lc_edges *e = w->edges;
    if (!e || !e->kept || (w->groups && !e->on)) return false; /* of these, what is emitted is not kept */
    const lc_edge_sample *from = &e->sample[i];
    *seen = from->seen;
    *dir = from->dir;
    s->is_hit = from->is_hit;
    s->first = from->first;
    s->emission = lc_edges_emitted(w, from->emission);
    s->n_rays = from->n_rays;
    s->n_lit = from->n_lit;
    memcpy(s->lit, e->lit + from->entry, from->n_lit * sizeof *s->lit);
    for (uint32_t k = 0; k < s->n_lit; k++)
        s->lit[k].weight = lc_f3_scale(s->lit[k].weight, lc_edges_weight(w, i, k));
    if (w->groups) memcpy(w->groups->sample, e->of_group, w->groups->n * sizeof *e->of_group);
    return true;
}

float lc_edges_weight(const lc_render_worker *w, uint32_t i, uint32_t k)
{
    const lc_edges *e = w->edges;
    const uint32_t part = e && e->on ? e->part[e->sample[i].entry + k] : LC_EDGE_PARTS;
    return part < LC_EDGE_PARTS ? e->parts[part].weight : 1;
}

lc_f3 lc_edges_emitted(const lc_render_worker *w, lc_f3 emitted)
{
    return w->edges && w->edges->on ? w->edges->emitted : emitted;
}
