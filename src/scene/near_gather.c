/* near_gather.c - see near_gather.h. */
#include "scene/near_gather.h"

#include "base/rng.h"
#include "base/sample.h"
#include "base/sample_dir.h"
#include "scene/alpha.h"
#include "scene/lit_point.h"
#include "scene/media.h"
#include "scene/surface.h"
#include "shade/draw_lobe.h"
#include "shade/fresnel.h"
#include "shade/point_init.h"

#include <float.h>
#include <string.h>

#define OF_RAYS 4             /* some of so many in a row are drawn by a narrow lobe */
#define WEAK 0.25f            /* a lobe's part of what is reflected by the rest */
#define TINY 1e-6             /* cosine */
#define BATCH 32              /* rays */
#define MOST_ON_WAY 8         /* surfaces of glass, others that stop no light, and mirrors on a ray's way */

/* Rays that meet surfaces in reach. */
typedef struct {
    uint32_t n;
    lc_light_rec rec[BATCH]; /* from where: as lights at infinity */
    lc_f3 factor[BATCH];     /* (1 - part) times what glass lets through, over their density and number */
    lc_f3 dir[BATCH];        /* at their ends */
    lc_hit hit[BATCH];
} gathered;

/* A ray on its way: where it starts, what is left of a radiance, the length so far. */
typedef struct {
    float org[3], gone;
    lc_f3 dir, through;
} way;

/* Goes on at a hit of a surface without light of its own: straight through, or as a mirror reflects. */
static void go_on(const lc_scene *s, const lc_hit *hit, way *w)
{
    const lc_mesh *mesh = &s->meshes[s->tri_mesh[hit->tri]];
    const float d[3] = { w->dir.x, w->dir.y, w->dir.z };
    lc_surface at;
    lc_surface_of(s, hit, w->dir, 0, &at);
    w->gone = hit->t;
    if (mesh->n_places || mesh->clear) {
        if (!mesh->n_places) w->through = lc_f3_mul(w->through, lc_alpha_through(s, hit, d));
        lc_f3_store(w->org, lc_surface_behind(&at));
        return;
    }
    w->through = lc_f3_mul(w->through, lc_reflectance(&at.material, -lc_f3_dot(w->dir, at.n), !at.front));
    memcpy(w->org, at.ray_org, sizeof w->org);
    w->dir = lc_mirror_leave(&at, w->dir);
}

/* The surface that a ray meets within a length, beyond glass and, if these are followed, mirrors. */
static bool meet(const lc_scene *s, way *w, float length, bool follow, lc_hit *hit)
{
    for (int i = 0; i < MOST_ON_WAY && w->gone < length; i++) {
        const float d[3] = { w->dir.x, w->dir.y, w->dir.z };
        s->bvh->kernels->closest(&s->bvh->data, w->org, d, length - w->gone, hit);
        if (hit->tri == LC_NONE) return false;
        const lc_mesh *mesh = &s->meshes[s->tri_mesh[hit->tri]];
        const lc_material *m = &s->materials[mesh->material_id];
        hit->t += w->gone;
        if (!mesh->n_places && (!lc_is_specular(m) || (!m->glass && !follow))) return true;
        if (!mesh->n_places && !mesh->clear && m->glass) return false;
        go_on(s, hit, w);
    }
    return false;
}

/* How rays are drawn, and what they are for: all that the point reflects within reach, by the cosine to the
 * normal, with some by the lobe, each of which counts by the density of both together ([Veach95] balance
 * heuristic); or its diffuse part by the cosine and its lobe by the lobe, at any distance. */
typedef struct {
    const lc_scene *scene;
    const lc_lit *lit;
    const lc_point *soft, *own; /* own: with the lobe, alone where it is for rays by it */
    lc_near_rays rays;
    uint32_t by_lobe; /* of 4 rays in a row, the last ones */
    uint32_t every;   /* one of so many of these is traced */
    bool apart;
} gatherer;

static bool is_by_lobe(const gatherer *g, uint32_t i) { return i % OF_RAYS >= OF_RAYS - g->by_lobe; }

/* Of a ray by the lobe among all of these. */
static uint32_t number_of(const gatherer *g, uint32_t i)
{
    return i / OF_RAYS * g->by_lobe + i % OF_RAYS + g->by_lobe - OF_RAYS;
}

static bool is_traced(const gatherer *g, uint32_t i, bool by_lobe)
{
    return is_by_lobe(g, i) == by_lobe && (!by_lobe || number_of(g, i) % g->every == 0);
}

static lc_f3 draw(const gatherer *g, uint32_t i)
{
    double u[2], x, y;
    const uint32_t rest = OF_RAYS - g->by_lobe;
    if (is_by_lobe(g, i)) {
        lc_sample_pair(lc_hash2(g->rays.key, 1), number_of(g, i) / g->every, u);
        return lc_lobe_draw(g->own, u);
    }
    lc_sample_pair(g->rays.key, i / OF_RAYS * rest + i % OF_RAYS, u);
    lc_sample_disc(u, &x, &y);
    return lc_sample_frame(lc_f3_load(g->soft->n), x, y, sqrt(1 - u[0]));
}

/* Rays a steradian about a direction whose cosine to the normal is above 0, of one ray. */
static double density_of(const gatherer *g, lc_f3 dir, double cosine, bool by_lobe)
{
    const double of_lobe = (double)g->by_lobe / OF_RAYS, even = (1 - of_lobe) * cosine / LC_PI;
    if (g->apart) return by_lobe ? of_lobe / g->every * lc_lobe_density(g->own, dir) : even;
    return g->by_lobe ? even + of_lobe * lc_lobe_density(g->own, dir) : even;
}

static void gather_ray(const gatherer *g, uint32_t i, bool by_lobe, gathered *to)
{
    const lc_point *soft = g->soft;
    const lc_surface *at = &g->lit->surface;
    const bool far = g->apart && by_lobe;
    lc_hit *hit = &to->hit[to->n];
    const lc_f3 dir = draw(g, i), org = lc_f3_load(at->ray_org);
    const double cosine = (double)lc_f3_dot(dir, lc_f3_load(soft->n));
    if (!(cosine > TINY) || !(lc_f3_dot(dir, at->ng) > 0)) return;
    const float length = far ? FLT_MAX : sqrtf(soft->near_d2 + 1 / soft->near_scale);
    way w = { .org = { org.x, org.y, org.z }, .dir = dir, .through = { 1, 1, 1 } };
    if (!meet(g->scene, &w, length, far, hit)) return;
    const lc_f3 apart = lc_f3_sub(lc_f3_add(org, lc_f3_scale(dir, hit->t)), lc_f3_load(soft->pos));
    const float part = far ? 0 : (lc_f3_dot(apart, apart) - soft->near_d2) * soft->near_scale;
    if (!(part < 1)) return;
    if (far && g->scene->media.present)
        w.through = lc_f3_mul(w.through, lc_media_through(g->scene, org, dir, (double)hit->t));
    const double density = density_of(g, dir, cosine, by_lobe);
    if (!(density > 0)) return;
    to->rec[to->n] = (lc_light_rec){ .pos = { dir.x, dir.y, dir.z } };
    to->dir[to->n] = w.dir;
    to->factor[to->n++] = lc_f3_scale(w.through, (1 - fmaxf(part, 0)) / (float)(density * g->rays.n));
}

/* Width of a lobe, rad: of GGX its roughness, of Phong's about two of these. */
static float width_of(const lc_material *m)
{
    if (m->lobe == LC_LOBE_PHONG) return sqrtf(2 / (m->exponent + 2));
    return fmaxf(m->roughness[0], m->roughness[1]);
}

static void give(const lc_near_ends *ends, const gatherer *g, bool by_lobe, const gathered *from)
{
    _Alignas(64) float f[6][BATCH];
    float *const out[6] = { f[0], f[1], f[2], f[3], f[4], f[5] };
    const lc_point *p = g->apart && !by_lobe ? g->soft : g->own;
    const float wide = width_of(&g->lit->surface.material);
    const lc_tree_data all = { .lights = (lc_light_rec *)from->rec };
    ends->scene->ctx->shade_kernels->estimate(&all, 0, NULL, from->n, LC_LIGHT_DIRECTIONAL, p, out);
    for (uint32_t i = 0; i < from->n; i++)
        ends->end(ends->user, &from->hit[i], from->dir[i],
                  lc_f3_mul(lc_f3_make(f[0][i], f[1][i], f[2][i]), from->factor[i]),
                  g->apart && by_lobe ? wide * from->hit[i].t : INFINITY);
}

static void gather(const lc_near_ends *ends, const gatherer *g, bool by_lobe)
{
    gathered to;
    to.n = 0;
    for (uint32_t i = 0; i < g->rays.n; i++) {
        if (is_traced(g, g->rays.first + i, by_lobe)) gather_ray(g, g->rays.first + i, by_lobe, &to);
        if (!to.n || (to.n < BATCH && i + 1 < g->rays.n)) continue;
        give(ends, g, by_lobe, &to);
        to.n = 0;
    }
}

/* How many rays are for a lobe that has rays of its own: the less it reflects, the fewer. */
static void share_rays(gatherer *g)
{
    const lc_surface *at = &g->lit->surface;
    const float lobe = lc_f3_max(lc_reflectance(&at->material, lc_f3_dot(g->lit->view, at->n), false)),
                rest = (float)LC_PI * lc_f3_max(lc_f3_load(g->soft->diffuse));
    g->by_lobe = !(rest > 0) ? OF_RAYS : lobe > rest ? 2 : 1;
    if (lobe < WEAK * rest) g->every = lobe < WEAK / 2 * rest ? 4 : 2;
}

void lc_near_gather(const lc_near_ends *ends, const lc_lit *lit, const lc_point *soft, lc_near_rays rays)
{
    lc_point own;
    gatherer g = { ends->scene, lit, soft, &own, rays, 0, 1, soft->lobe_by_rays };
    const bool narrow = lc_lit_point_of_near(ends->scene, lit, soft->lobe_by_rays, &own);
    if (narrow && g.apart) share_rays(&g);
    else if (narrow) g.by_lobe = 1;
    gather(ends, &g, false);
    if (g.by_lobe) gather(ends, &g, true);
}
