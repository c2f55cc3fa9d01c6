/* samples.c - a pixel whose samples share cuts: points on surfaces alike are a gather cluster (cut/gather.h)
 * with one cut; others have cuts of their own.
 *
 *     camera rays -> lit points -> gather clusters, the largest first -> a cut each -> the pixel
 *
 * The error that is asked for is the pixel's, so the less of the pixel a cut is, the rougher it may be.
 */
#include "render/samples.h"

#include "render/edges.h"
#include "render/group_sums.h"
#include "render/guide.h"
#include "render/pixel_sights.h"
#include "render/sample_keys.h"
#include "scene/lit_point.h"
#include "scene/sun.h"

#include <math.h>
#include <string.h>

/* Of a point and the first one of its gather cluster; both chosen. */
#define LEAST_COS 0.9f  /* between their normals */
#define LEAST_COS_LOBED 0.98f /* where they have a lobe */
#define REACH     0.1f  /* of the distance to the camera: how far they are apart at most */
#define LEAST_MASS 1e-6f
#define START_FROM 0.25f /* of the pixel: a smaller part is done before it is as fine as its block's start */

/* What a lit point has beside what its gather cluster needs. */
typedef struct {
    lc_f3 weight; /* of its radiance; 1 where its reflectances have it */
    lc_f3 place, n;
    float reach2;
    uint64_t hash;
    uint32_t group, material;
    float mass;  /* of the pixel, whose samples have 1 each: in media its weight, else 1 */
    bool folded; /* its reflectances have its weight */
} lit_sample;

struct lc_pixel_points {
    uint32_t capacity, n, n_groups;
    lc_gather_point *point, *chosen; /* all of them; those of one group */
    lit_sample *lit;
    uint32_t *first, *size; /* of each group: its first point, how many it has; 0: shaded */
    lc_gather gather;
};

/* A pixel while its groups are shaded. */
typedef struct {
    lc_render_job *j;
    lc_render_worker *w;
    lc_guide *guide;
    uint32_t samples_left;      /* whose points are not known yet */
    double mass_left;           /* of points that are known and not shaded */
    double luminance, error2;   /* of what is done: times the number of samples, squared */
    lc_f3 sum;
    uint32_t clusters, rays;
} pixel_sum;

static void free_points(const lc_context *ctx, lc_pixel_points *p)
{
    lc_free(ctx, p->point, p->capacity, sizeof *p->point);
    lc_free(ctx, p->chosen, p->capacity, sizeof *p->chosen);
    lc_free(ctx, p->lit, p->capacity, sizeof *p->lit);
    lc_free(ctx, p->first, p->capacity, sizeof *p->first);
    lc_free(ctx, p->size, p->capacity, sizeof *p->size);
}

lc_pixel_points *lc_pixel_points_create(const lc_context *ctx, uint32_t most)
{
    lc_pixel_points *p = lc_alloc(ctx, 1, sizeof *p);
    if (!p) return NULL;
    p->capacity = most + LC_MAX_LIT;
    p->point = lc_alloc_raw(ctx, p->capacity, sizeof *p->point);
    p->chosen = lc_alloc_raw(ctx, p->capacity, sizeof *p->chosen);
    p->lit = lc_alloc_raw(ctx, p->capacity, sizeof *p->lit);
    p->first = lc_alloc_raw(ctx, p->capacity, sizeof *p->first);
    p->size = lc_alloc_raw(ctx, p->capacity, sizeof *p->size);
    if (p->point && p->chosen && p->lit && p->first && p->size) return p;
    lc_pixel_points_free(ctx, p);
    return NULL;
}

void lc_pixel_points_free(const lc_context *ctx, lc_pixel_points *p)
{
    if (p) free_points(ctx, p);
    lc_free(ctx, p, 1, sizeof *p);
}

/* ---- gather clusters ---- */

static bool have_lobes_alike(const lc_gather_point *a, const lc_gather_point *b)
{
    const lc_lobe soft_a = a->p[0].soft ? a->p[1].lobe : LC_LOBE_NONE,
                  soft_b = b->p[0].soft ? b->p[1].lobe : LC_LOBE_NONE;
    return a->p[0].lobe == b->p[0].lobe && soft_a == soft_b && a->p[0].soft_kinds == b->p[0].soft_kinds;
}

static bool are_alike(const lc_gather_point *a, const lit_sample *la, const lc_gather_point *b,
                      const lit_sample *lb)
{
    const lc_f3 way = lc_f3_sub(la->place, lb->place);
    const float least_cos = lc_has_lobe(&a->p[0]) ? LEAST_COS_LOBED : LEAST_COS;
    return lc_may_gather(&a->p[0]) && lc_may_gather(&b->p[0]) && la->material == lb->material &&
           have_lobes_alike(a, b) && !memcmp(&la->weight, &lb->weight, sizeof la->weight) &&
           lc_f3_dot(way, way) <= la->reach2 && lc_f3_dot(la->n, lb->n) > least_cos;
}

/* Adds the light of surfaces nearby. */
static void add_near(pixel_sum *s, const lc_lit *lit, const lc_point *p, lc_near_sample sample)
{
    const lc_scene *scene = lc_moments_scene(&s->j->moments, s->j->scene, lit->surface.moment);
    lc_f3 *of_group = lc_groups_begin_sample(s->w->groups);
    const lc_f3 light = lc_f3_mul(
        lc_near_bounce_light(scene, s->w->near, lit, p, sample, lit->weight, of_group), lit->weight);
    lc_groups_end_sample(s->w->groups);
    s->sum = lc_f3_add(s->sum, light);
    s->luminance += (double)lc_luminance(light);
}

/* Adds lit point k of a sample to the group whose first point it is like, or makes one. */
static void add_point(pixel_sum *s, const lc_lit *lit, uint32_t k, const lc_sample_keys *keys, uint32_t most)
{
    lc_pixel_points *p = s->w->points;
    lc_gather_point *a = &p->point[p->n];
    lit_sample *l = &p->lit[p->n];
    lc_lit_point(s->j->scene, lit, keys->point + k, a->p);
    add_near(s, lit, a->p, lc_near_sample_of(s->j, keys, k));
    for (int c = 0; c < 3; c++) a->org[c] = lit->surface.ray_org[c];
    *l = (lit_sample){ .weight = lit->weight, .place = lit->surface.pos, .n = lit->surface.n,
                       .hash = keys->slot + k, .material = lit->surface.material_id, .mass = 1 };
    if (s->j->scene->media.present) l->mass = fmaxf(lit->part, LEAST_MASS);
    l->reach2 = REACH * REACH * lit->surface.t * lit->surface.t;
    if (!lc_has_lobe(&a->p[0])) {
        lc_f3_store(a->p[0].diffuse, lc_f3_mul(lc_f3_load(a->p[0].diffuse), lit->weight));
        lc_f3_store(a->p[1].diffuse, lc_f3_load(a->p[0].diffuse));
        l->folded = true;
    }
    if (a->p[0].lobe == LC_LOBE_PHASE) {
        for (int i = 0; i < (a->p[0].soft ? 2 : 1); i++)
            lc_f3_store(a->p[i].specular, lc_f3_mul(lc_f3_load(a->p[i].specular), lit->weight));
        l->folded = true;
    }
    if (l->folded) l->weight = lc_f3_make(1, 1, 1);
    s->mass_left += (double)l->mass;
    for (l->group = lc_may_gather(&a->p[0]) ? 0 : p->n_groups; l->group < p->n_groups; l->group++) {
        const uint32_t first = p->first[l->group];
        if (p->size[l->group] < most && are_alike(&p->point[first], &p->lit[first], a, l)) break;
    }
    if (l->group == p->n_groups) {
        p->first[p->n_groups] = p->n;
        p->size[p->n_groups++] = 0;
    }
    p->size[l->group]++;
    p->n++;
}

static double mass_of(const lc_pixel_points *p, uint32_t group)
{
    double sum = 0;
    for (uint32_t i = p->first[group], n = 0; n < p->size[group]; i++)
        if (p->lit[i].group == group) {
            sum += (double)p->lit[i].mass;
            n++;
        }
    return sum;
}

static void shade_group(pixel_sum *s, uint32_t group)
{
    const lc_render_job *j = s->j;
    lc_pixel_points *p = s->w->points;
    lc_cut *cut = &s->w->cut;
    const uint32_t first = p->first[group], n = p->size[group];
    const lit_sample *l = &p->lit[first];
    const double spp = (double)j->spp, mass = mass_of(p, group);
    lc_cut_result r;
    uint32_t m = 0;
    cut->part.share = (float)(l->folded ? n * (n / mass) / spp : mass / spp);
    cut->part.own = (float)((l->folded ? n / mass : 1) * (s->mass_left + s->samples_left) / spp);
    cut->part.rest = s->luminance / spp;
    s->mass_left -= mass;
    cut->start = mass > (double)START_FROM * spp ? lc_guide_start(s->guide, l->place, l->n) : NULL;
    cut->start_out = NULL;
    for (uint32_t i = first; m < n; i++) {
        if (p->lit[i].group != group) continue;
        p->chosen[m] = p->point[i];
        if (p->chosen[m].p[0].soft) p->chosen[m].p[0].soft = &p->chosen[m].p[1];
        m++;
    }
    if (n > 1) {
        lc_gather_make(&p->gather, p->chosen, n);
        lc_cut_shade_gather(cut, &p->gather, l->hash, &s->w->stats, &r);
    } else {
        lc_cut_shade(cut, p->chosen[0].p, p->chosen[0].org, l->hash, &s->w->stats, &r);
    }
    cut->part = (lc_cut_part){ 1, 1, 0 };
    s->w->stats.glossy += p->chosen[0].p[0].lobe != LC_LOBE_NONE;
    s->w->cut_hist[r.size]++;
    if (r.size > s->w->cut_max) s->w->cut_max = r.size;
    const double error = (double)r.max_error *
                         fmax((double)lc_luminance(r.radiance), (double)cut->desc.floor) * (double)n *
                         (double)lc_luminance(l->weight);
    if (r.max_error > 0) s->error2 += error * error;
    lc_groups_begin_sample(s->w->groups);
    lc_groups_add_cut(s->w->groups, lc_f3_scale(l->weight, (float)n));
    lc_groups_end_sample(s->w->groups);
    r.radiance = lc_f3_scale(lc_f3_mul(r.radiance, l->weight), (float)n);
    s->sum = lc_f3_add(s->sum, r.radiance);
    s->luminance += (double)lc_luminance(r.radiance);
    s->clusters += r.size;
    s->rays += r.rays;
}

/* Shades all groups, the largest first, so that what the others are is best known where it matters. */
static void shade_groups(pixel_sum *s)
{
    lc_pixel_points *p = s->w->points;
    uint32_t left = p->n;
    while (left) { /* points */
        uint32_t best = 0;
        for (uint32_t g = 1; g < p->n_groups; g++)
            if (p->size[g] > p->size[best]) best = g;
        shade_group(s, best);
        left -= p->size[best];
        p->size[best] = 0;
    }
    p->n = p->n_groups = 0;
}

/* Traces the camera ray of the next sample. False: cancelled. */
static bool add_camera_ray(pixel_sum *s, lc_pixel_sights *all, lc_pixel *px)
{
    lc_render_job *j = s->j;
    lc_render_worker *w = s->w;
    const lc_sight *sight = &all->sight;
    const uint32_t x = all->x, y = all->y, i = all->next;
    if (lc_time_to_ask(w) && !lc_job_go_on(j)) return false;
    w->stats.camera_rays++;
    lc_f3 *of_group = lc_groups_begin_sample(w->groups);
    bool hit;
    const bool kept = lc_edges_sight(w, i, &hit, &all->dir, &all->sight);
    if (kept) all->next++;
    else hit = lc_pixel_sights_next(all, of_group);
    lc_phase_end(&w->stats, LC_PHASE_CAMERA);
    const lc_f3 emitted = hit || kept ? sight->emission : lc_background(j->scene, LC_SKY_ALL, all->dir);
    if (!hit && of_group && !kept)
        lc_background_of_groups(j->scene, LC_SKY_ALL, all->dir, lc_f3_make(1, 1, 1), of_group);
    lc_groups_end_sample(w->groups);
    s->sum = lc_f3_add(s->sum, emitted);
    s->luminance += (double)lc_luminance(emitted);
    s->samples_left--;
    if (!hit) return true;
    w->stats.camera_rays += sight->n_rays;
    lc_add_to_planes(j, px, sight, all->dir);
    const lc_sample_keys keys = lc_sample_keys_of(j, w, x, y, i);
    for (uint32_t k = 0; k < sight->n_lit; k++) add_point(s, &sight->lit[k], k, &keys, j->max_points);
    lc_phase_end(&w->stats, LC_PHASE_OTHER);
    return true;
}

bool lc_add_shared_samples(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, lc_pixel *px)
{
    pixel_sum s = { .j = j, .w = w, .samples_left = j->spp };
    lc_pixel_sights all;
    lc_pixel_sights_begin(&all, j, x, y, 0, &w->light);
    lc_phase_start(&w->stats);
    for (uint32_t i = 0; i < j->spp; i++) {
        if (!add_camera_ray(&s, &all, px)) return false;
        if (w->points->n + LC_MAX_LIT <= w->points->capacity && i + 1 < j->spp) continue;
        if (!w->points->n) continue;
        if (!s.guide && !w->alone)
            s.guide = lc_guide_of(j, &w->cut, &w->guide, x, y, 1, w->pilot ? &w->apart : &w->stats);
        shade_groups(&s);
    }
    const double luminance = fmax(s.luminance / j->spp, (double)w->cut.desc.floor);
    px->rgb = lc_f3_add(px->rgb, s.sum);
    px->cut += (float)s.clusters * (float)px->hits;
    px->rays += (float)s.rays * (float)px->hits;
    if (s.error2 > 0) px->error += (float)(sqrt(s.error2) / j->spp / luminance) * (float)px->hits;
    lc_phase_end(&w->stats, LC_PHASE_OTHER);
    lc_phase_stop(&w->stats);
    return true;
}
