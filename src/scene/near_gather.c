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
#define MOST_TURNS 2          /* of a ray by glass that are followed */
#define EVEN_WIDE 0.25f       /* rad: what rays by the cosine stand for beyond glass that reflects them */
#define MOST_ON_WAY 8         /* surfaces of glass, others that stop no light, and mirrors on a ray's way */

/* Rays that meet surfaces in reach, and those that glass reflects. */
typedef struct {
    uint32_t n;
    lc_light_rec rec[BATCH]; /* from where: as lights at infinity */
    lc_near_end end[BATCH];  /* to: yet without what the point reflects */
} gathered;

/* A ray on its way: where it starts, what is left of a radiance, the length so far. */
typedef struct {
    float org[3], gone;
    lc_f3 dir, through;
} way;

/* What glass on the way reflects: where the ray goes then, instead. */
typedef struct {
    uint64_t key; /* of the numbers that choose it */
    uint32_t n;
    way way[MOST_TURNS]; /* gone: the length to the glass */
} turns;

/* The ray is turned with a chance that is the root of what is reflected, so that what it carries then differs
 * less. */
static void turn(const lc_surface *at, const way *w, uint32_t number, turns *t)
{
    const lc_f3 part = lc_glass_reflectance(&at->material, -lc_f3_dot(w->dir, at->n));
    const float chance = sqrtf(fminf(lc_luminance(part), 1));
    if (!(lc_unit(lc_hash2(t->key, number)) < (double)chance) || t->n == MOST_TURNS) return;
    way *to = &t->way[t->n++];
    to->gone = w->gone;
    to->dir = lc_mirror_leave(at, w->dir);
    to->through = lc_f3_mul(w->through, lc_f3_scale(part, 1 / chance));
    memcpy(to->org, at->ray_org, sizeof to->org);
}

typedef enum { LOST, LEAVES, MEETS } course;

/* Follows a ray to a surface within a length, beyond glass and, if these are followed, mirrors. t: NULL, or
 * where what glass reflects is added. */
static course follow_ray(const lc_scene *s, way *w, float length, bool mirrors, turns *t, lc_hit *hit)
{
    for (uint32_t i = 0; i < MOST_ON_WAY && w->gone < length; i++) {
        const float d[3] = { w->dir.x, w->dir.y, w->dir.z };
        s->bvh->kernels->closest(&s->bvh->data, w->org, d, length - w->gone, hit);
        if (hit->tri == LC_NONE) return LEAVES;
        const lc_mesh *mesh = &s->meshes[s->tri_mesh[hit->tri]];
        const lc_material *m = &s->materials[mesh->material_id];
        hit->t += w->gone;
        if (!mesh->n_places && (!lc_is_specular(m) || (!m->glass && !mirrors))) return MEETS;
        if (!mesh->n_places && !mesh->clear && m->glass) return LOST;
        lc_surface at;
        lc_surface_of(s, hit, w->dir, 0, &at);
        w->gone = hit->t;
        if (mesh->n_places || mesh->clear) {
            if (t && !mesh->n_places && at.material.glass) turn(&at, w, i, t);
            if (!mesh->n_places) w->through = lc_f3_mul(w->through, lc_alpha_through(s, hit, d));
            lc_f3_store(w->org, lc_surface_behind(&at));
            continue;
        }
        const lc_f3 part = lc_reflectance(&at.material, -lc_f3_dot(w->dir, at.n), !at.front);
        w->through = lc_f3_mul(w->through, part);
        memcpy(w->org, at.ray_org, sizeof w->org);
        w->dir = lc_mirror_leave(&at, w->dir);
    }
    return LOST;
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
    float wide;       /* the lobe, rad */
} gatherer;

/* Width of a lobe, rad: of GGX its roughness, of Phong's about two of these. */
static float width_of(const lc_material *m)
{
    if (m->lobe == LC_LOBE_PHONG) return sqrtf(2 / (m->exponent + 2));
    return fmaxf(m->roughness[0], m->roughness[1]);
}

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

/* How much of what is so far from where rays start they gather. */
static float part_at(const gatherer *g, lc_f3 away)
{
    const lc_point *soft = g->soft;
    const lc_f3 org = lc_f3_load(g->lit->surface.ray_org),
                apart = lc_f3_sub(lc_f3_add(org, away), lc_f3_load(soft->pos));
    return 1 - fmaxf((lc_f3_dot(apart, apart) - soft->near_d2) * soft->near_scale, 0);
}

static void add_end(const gatherer *g, lc_f3 dir, lc_near_end end, gathered *to)
{
    to->rec[to->n] = (lc_light_rec){ .pos = { dir.x, dir.y, dir.z } };
    end.to = lc_f3_scale(end.to, 1 / (float)g->rays.n);
    to->end[to->n++] = end;
}

/* What glass reflects of a ray along dir, beside what passes. */
static void gather_turned(const gatherer *g, lc_f3 dir, float density, bool far, turns *t, gathered *to)
{
    for (uint32_t i = 0; i < t->n; i++) {
        way *w = &t->way[i];
        const lc_f3 org = lc_f3_load(w->org), turned = w->dir;
        const float at = w->gone, part = far ? 1 : part_at(g, lc_f3_scale(dir, at));
        lc_near_end end = { .reflected = true };
        if (!(part > 0)) continue;
        const course c = follow_ray(g->scene, w, FLT_MAX, true, NULL, &end.hit);
        if (c == LOST) continue;
        if (c == MEETS && g->scene->media.present)
            w->through = lc_f3_mul(w->through, lc_media_through(g->scene, org, turned,
                                                                (double)(end.hit.t - at)));
        end.dir = w->dir;
        end.to = lc_f3_scale(w->through, part / density);
        end.width = (far ? g->wide : EVEN_WIDE) * end.hit.t;
        add_end(g, dir, end, to);
    }
}

static void gather_ray(const gatherer *g, uint32_t i, bool by_lobe, gathered *to)
{
    const lc_point *soft = g->soft;
    const lc_surface *at = &g->lit->surface;
    const bool far = g->apart && by_lobe;
    const lc_f3 dir = draw(g, i), org = lc_f3_load(at->ray_org);
    const double cosine = (double)lc_f3_dot(dir, lc_f3_load(soft->n));
    if (!(cosine > TINY) || !(lc_f3_dot(dir, at->ng) > 0)) return;
    const float density = (float)density_of(g, dir, cosine, by_lobe),
                length = far ? FLT_MAX : sqrtf(soft->near_d2 + 1 / soft->near_scale);
    if (!(density > 0)) return;
    way w = { .org = { org.x, org.y, org.z }, .dir = dir, .through = { 1, 1, 1 } };
    turns t = { .key = lc_hash2(g->rays.key, 2 * (uint64_t)(g->rays.first + i) + by_lobe) };
    lc_near_end end = { .reflected = false };
    if (follow_ray(g->scene, &w, length, far, g->scene->has_glass ? &t : NULL, &end.hit) == MEETS) {
        const float part = far ? 1 : part_at(g, lc_f3_scale(dir, end.hit.t));
        if (far && g->scene->media.present)
            w.through = lc_f3_mul(w.through, lc_media_through(g->scene, org, dir, (double)end.hit.t));
        end.dir = w.dir;
        end.to = lc_f3_scale(w.through, part / density);
        end.width = far ? g->wide * end.hit.t : INFINITY;
        if (part > 0) add_end(g, dir, end, to);
    }
    gather_turned(g, dir, density, far, &t, to);
}

static void give(const lc_near_ends *ends, const gatherer *g, bool by_lobe, gathered *from)
{
    _Alignas(64) float f[6][BATCH];
    float *const out[6] = { f[0], f[1], f[2], f[3], f[4], f[5] };
    const lc_point *p = g->apart && !by_lobe ? g->soft : g->own;
    const lc_tree_data all = { .lights = (lc_light_rec *)from->rec };
    ends->scene->ctx->shade_kernels->estimate(&all, 0, NULL, from->n, LC_LIGHT_DIRECTIONAL, p, out);
    for (uint32_t i = 0; i < from->n; i++) {
        lc_near_end *end = &from->end[i];
        end->to = lc_f3_mul(lc_f3_make(f[0][i], f[1][i], f[2][i]), end->to);
        ends->end(ends->user, end);
    }
    from->n = 0;
}

static void gather(const lc_near_ends *ends, const gatherer *g, bool by_lobe)
{
    gathered to;
    to.n = 0;
    for (uint32_t i = 0; i < g->rays.n; i++) {
        if (is_traced(g, g->rays.first + i, by_lobe)) gather_ray(g, g->rays.first + i, by_lobe, &to);
        if (to.n && (to.n + 1 + MOST_TURNS > BATCH || i + 1 == g->rays.n)) give(ends, g, by_lobe, &to);
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
    gatherer g = { ends->scene, lit, soft, &own, rays, 0, 1, soft->lobe_by_rays,
                   width_of(&lit->surface.material) };
    const bool narrow = lc_lit_point_of_near(ends->scene, lit, soft->lobe_by_rays, &own);
    if (narrow && g.apart) share_rays(&g);
    else if (narrow) g.by_lobe = 1;
    gather(ends, &g, false);
    if (g.by_lobe) gather(ends, &g, true);
}
