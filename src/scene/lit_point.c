/* lit_point.c - see lit_point.h. */
#include "scene/lit_point.h"

#include "scene/light_places.h"
#include "scene/sun.h"
#include "shade/light_target.h"
#include "shade/lobe.h"
#include "shade/point_init.h"

#include <string.h>

#define LIGHTS_APART 4.0f /* roughness over the angle of lights' spacing: some 60 lights are in the lobe */
#define LIGHTS_IN_REACH 24.0f /* of their shares over pi: a disc of that squared radius holds as many */
#define BEGINS 0.5f       /* of the squared reach */
#define NEAR_ROUGHNESS 0.15f /* least of a lobe in which rays gather */
#define MOST_BY_RAYS 0.5f   /* roughness */
#define TINY 1e-30f

static void widen_lobe(lc_material *m, float roughness)
{
    const float exponent = LC_VIRTUAL_EXPONENT * LC_VIRTUAL_ROUGHNESS * LC_VIRTUAL_ROUGHNESS;
    m->exponent = fminf(m->exponent, exponent / (roughness * roughness));
    for (int k = 0; k < 2; k++) m->roughness[k] = fmaxf(m->roughness[k], roughness);
}

/* The direction about which the lobe lies. */
static lc_f3 mirror_of(const lc_lit *lit)
{
    const lc_f3 n = lit->surface.n;
    return lc_f3_sub(lc_f3_scale(n, 2 * lc_f3_dot(n, lit->view)), lit->view);
}

static void init_point(const lc_scene *scene, const lc_lit *lit, const lc_material *m, lc_point *p)
{
    const lc_surface *s = &lit->surface;
    lc_point_init(p, s->pos, s->n, lit->view, m, fmaxf(scene->min_d2, lit->floor * lit->floor));
    p->moment = s->moment;
    /* what is behind n sheds nothing anyhow */
    if (memcmp(&s->n, &s->ng, sizeof s->n)) lc_f3_store(p->ng, s->ng);
}

/* Widens a narrow lobe to what the lights of the lamps in its direction resolve. */
static void merge_lamps(const lc_scene *scene, const lc_lit *lit, lc_material *m)
{
    const lc_surface *s = &lit->surface;
    if (m->lobe != LC_LOBE_GGX || !scene->lamps.n) return;
    if (!(fminf(m->roughness[0], m->roughness[1]) < LC_SMOOTH_ROUGHNESS) || !(lc_f3_max(m->ks) > 0)) return;
    const lc_f3 mirror = mirror_of(lit);
    float least = fminf(lc_lamps_roughness(&scene->lamps, s->pos, mirror), LC_SMOOTH_ROUGHNESS);
    for (int k = 0; k < 2; k++) m->roughness[k] = fmaxf(m->roughness[k], least);
}

/* How far apart the virtual lights around a point are: the root of a share over pi; 0 without any. */
static float spacing_at(const lc_scene *scene, const lc_surface *at)
{
    lc_nearest_lights q = { .pos = at->pos, .n = at->n, .self = LC_NONE, .n_wanted = 1 };
    if (!lc_light_places_find(&scene->virtuals, &q)) return 0;
    return sqrtf(scene->virtuals.lights[q.place[0]->light].atten[0] / LC_VPL_DISC);
}

/* Least roughness of a lobe about the mirror direction in which there are enough virtual lights that single
 * ones do not show, of the surface that the mirror direction meets. */
static float virtual_roughness(const lc_scene *scene, const lc_lit *lit)
{
    const lc_surface *s = &lit->surface;
    const lc_f3 mirror = mirror_of(lit);
    lc_surface seen;
    if (!(lc_f3_max(s->material.ks) > 0) || !lc_lobe_is_narrow(s->material.lobe) || lit->followed) return 0;
    if (!scene->virtuals.n || !(lc_f3_dot(mirror, s->ng) > 0)) return 0;
    if (!lc_surface_hit(scene, lc_f3_load(s->ray_org), mirror, 0, &seen)) return 0;
    if (seen.material.mirror || seen.material.glass) return 0;
    return LIGHTS_APART * spacing_at(scene, &seen) / fmaxf(seen.t, TINY);
}

/* Within what distance virtual lights shed nothing or less: scene/near_bounce.h. */
static void find_reach(const lc_scene *s, const lc_surface *at, lc_point *soft)
{
    lc_nearest_lights q = { .pos = at->pos, .any_way = true, .self = LC_NONE, .n_wanted = LC_MAX_NEAREST };
    /* where light counts without a cosine, rays by the cosine would be too few near the horizon */
    if (!s->virtuals.n || soft->lobe == LC_LOBE_PHASE || soft->lobe == LC_LOBE_ROUND) return;
    const uint32_t n = lc_light_places_find(&s->virtuals, &q);
    float sum = 0;
    for (uint32_t i = LC_MAX_NEAREST - n; i < LC_MAX_NEAREST; i++)
        sum += s->virtuals.lights[q.place[i]->light].atten[0] / LC_VPL_DISC;
    const float d2 = LIGHTS_IN_REACH * sum / (float)n;
    if (!(d2 > soft->min_d2)) return;
    soft->near_d2 = BEGINS * d2;
    soft->near_scale = 1 / (d2 - soft->near_d2);
}

bool lc_lit_point_of_near(const lc_scene *scene, const lc_lit *lit, bool lobe, lc_point *p)
{
    lc_material m = lit->surface.material;
    if (m.lobe != LC_LOBE_PHASE && !lobe) widen_lobe(&m, NEAR_ROUGHNESS);
    if (lit->followed) m.ks = lc_f3_make(0, 0, 0);
    init_point(scene, lit, &m, p);
    if (lobe) memset(p->diffuse, 0, sizeof p->diffuse);
    return lc_lobe_is_narrow(m.lobe) && lc_f3_max(lc_f3_load(p->specular)) > 0;
}

/* Whether a lobe is so narrow that rays find what surfaces reflect into it better than virtual lights do. */
static bool is_for_rays(const lc_material *m)
{
    lc_material rough = *m;
    if (!(lc_f3_max(m->ks) > 0)) return false;
    if (m->lobe == LC_LOBE_GGX) return fmaxf(m->roughness[0], m->roughness[1]) < MOST_BY_RAYS;
    widen_lobe(&rough, MOST_BY_RAYS);
    return m->lobe == LC_LOBE_PHONG && rough.exponent < m->exponent;
}

static void leave_out_lobe(lc_point *p)
{
    memset(p->specular, 0, sizeof p->specular);
    if (p->fresnel == LC_FRESNEL_SCHLICK) memset(p->schlick_delta, 0, sizeof p->schlick_delta);
    if (!p->coat) p->lobe = LC_LOBE_NONE;
    p->lobe_by_rays = true;
}

void lc_lit_point_of_virtual(const lc_scene *scene, const lc_lit *lit, lc_point *p)
{
    lc_material m = lit->surface.material;
    const bool by_rays = !lit->followed && !lit->no_rays && is_for_rays(&m);
    if (lit->followed) m.ks = lc_f3_make(0, 0, 0);
    else if (!by_rays && m.lobe != LC_LOBE_PHASE)
        widen_lobe(&m, fminf(fmaxf(virtual_roughness(scene, lit), LC_VIRTUAL_ROUGHNESS), LC_MAX_ROUGHNESS));
    init_point(scene, lit, &m, p);
    find_reach(scene, &lit->surface, p);
    if (by_rays && p->near_scale > 0) leave_out_lobe(p);
}

static bool is_met_by_sky(const lc_scene *scene, const lc_lit *lit)
{
    return lit->followed && (scene->n_envs || scene->suns);
}

lc_f3 lc_lit_share(const lc_scene *scene, const lc_lit *lit)
{
    if (!lit->n_mirrors || is_met_by_sky(scene, lit)) return lc_f3_make(1, 1, 1);
    return lit->n_mirrors < LC_MAX_BOUNCES ? scene->indirect.again[lit->n_mirrors] : lc_f3_make(0, 0, 0);
}

/* A point of its own is met by virtual lights, and with a followed lobe by the lights made from environments:
 * those are seen in it as in a mirror. */
static void soften(const lc_scene *scene, const lc_lit *lit, lc_point p[2])
{
    const bool sky = is_met_by_sky(scene, lit);
    if (!scene->indirect.n_lights && !sky) return;
    lc_lit_point_of_virtual(scene, lit, &p[1]);
    if (lit->n_mirrors && !sky) lc_point_scale(&p[1], lc_lit_share(scene, lit));
    p[1].turn = p->turn;
    p->soft = &p[1];
    p->soft_kinds = 1u << LC_LIGHT_VIRTUAL | (sky ? 1u << LC_LIGHT_DIRECTIONAL | 1u << LC_LIGHT_SKY : 0);
}

void lc_lit_point(const lc_scene *scene, const lc_lit *lit, uint64_t hash, lc_point p[2])
{
    lc_material m = lit->surface.material;
    merge_lamps(scene, lit, &m);
    init_point(scene, lit, &m, p);
    p->turn = lc_turn((uint32_t)hash, (uint32_t)(hash >> 48));
    soften(scene, lit, p);
}
