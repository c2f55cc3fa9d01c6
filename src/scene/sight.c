/* sight.c - follows a camera ray through mirrors and glass, the ray of largest weight first. */
#include "scene/sight.h"

#include "base/sample.h"
#include "scene/media.h"
#include "scene/ray_light.h"
#include "scene/sun.h"
#include "shade/draw_lobe.h"
#include "shade/fresnel.h"
#include "shade/point_init.h"

/* Of a sample's footprint: a point of a medium gets no more of a lamp than from so far away, else points
 * closer by would be sparks. */
#define LAMP_SIZE 0.125f
#define MIN_WEIGHT 1e-12f /* a chain of mirrors ends when no channel's weight exceeds this */

/* A ray that is still to be traced. */
typedef struct ray {
    lc_f3 org, dir, weight;
    float length;   /* of the path from the camera to org */
    uint32_t depth; /* mirrors and glass surfaces on that path */
    bool narrow;    /* it leaves a narrow lobe, in which lights stand for the lamp that it may meet */
    lc_sky_part sky; /* what it shows of the sky, */
    float of_sky;    /* times this, */
    bool only_sky;   /* and nothing else */
} ray;

typedef struct trace {
    const lc_scene *scene;
    lc_sight *out;
    const lc_sight_desc *how;
    uint32_t max_depth, n_splits, n_rough, n_rays, n_in_media;
    ray rays[LC_MAX_SPLITS + (LC_SKY_RAYS + 1) * LC_MAX_ROUGH + 1];
} trace;

static lc_f3 reflect(lc_f3 dir, lc_f3 n) { return lc_f3_sub(dir, lc_f3_scale(n, 2 * lc_f3_dot(n, dir))); }

lc_f3 lc_mirror_leave(const lc_surface *s, lc_f3 dir)
{
    lc_f3 r = reflect(dir, s->n);
    if (lc_f3_dot(r, s->ng) < 0) r = reflect(r, s->ng);
    return lc_f3_normalize(r);
}

static lc_f3 refract(const lc_surface *s, lc_f3 dir, float cos_i, float eta)
{
    float cos_t = sqrtf(fmaxf(1 - (1 - cos_i * cos_i) / (eta * eta), 0));
    lc_f3 t = lc_f3_add(lc_f3_scale(dir, 1 / eta), lc_f3_scale(s->n, cos_i / eta - cos_t));
    if (lc_f3_dot(t, s->ng) > 0) t = reflect(t, s->ng);
    return lc_f3_normalize(t);
}

void lc_glass_split(const lc_surface *s, lc_f3 dir, lc_split *split)
{
    const lc_material *m = &s->material;
    float cos_i = fminf(fmaxf(-lc_f3_dot(dir, s->n), 0), 1), eta = s->front ? m->eta.x : 1 / m->eta.x;
    float f = lc_fresnel_dielectric(cos_i, m->thin ? m->eta.x : eta);
    if (m->thin) f = lc_sheet_reflectance(f);
    split->reflected = lc_f3_scale(m->ks, f);
    split->through = lc_f3_scale(m->kt, 1 - f);
    split->out = m->thin ? dir : refract(s, dir, cos_i, eta);
    split->radiance = m->thin ? 1 : 1 / (eta * eta);
}

static void send(trace *t, const ray *from, lc_f3 org, lc_f3 dir, lc_f3 weight, float length)
{
    t->rays[t->n_rays] = *from;
    ray *r = &t->rays[t->n_rays++];
    r->org = org;
    r->dir = dir;
    r->weight = weight;
    r->length = length;
    r->depth++;
    r->narrow = false;
}

static void meet_mirror(trace *t, const ray *r, const lc_surface *s, float min_weight)
{
    float cos_i = -lc_f3_dot(r->dir, s->n);
    bool inside = s->material.mirror && !s->front; /* a coat covers both sides */
    lc_f3 weight = lc_f3_mul(r->weight, lc_reflectance(&s->material, cos_i, inside));
    if (r->depth < t->max_depth && lc_f3_max(weight) > min_weight)
        send(t, r, lc_f3_load(s->ray_org), lc_mirror_leave(s, r->dir), weight, s->t);
}

static void meet_glass(trace *t, const ray *r, const lc_surface *s)
{
    lc_split split;
    lc_glass_split(s, r->dir, &split);
    lc_f3 back = lc_f3_mul(r->weight, split.reflected);
    lc_f3 on = lc_f3_scale(lc_f3_mul(r->weight, split.through), split.radiance);
    if (r->depth == t->max_depth) return;
    bool is_back = lc_f3_max(back) > LC_MIN_PATH_WEIGHT, is_on = lc_f3_max(on) > LC_MIN_PATH_WEIGHT;
    if (is_back && is_on && t->n_splits == LC_MAX_SPLITS) {
        is_on = lc_luminance(on) > lc_luminance(back);
        is_back = !is_on;
    }
    t->n_splits += is_back && is_on;
    if (is_back) send(t, r, lc_f3_load(s->ray_org), lc_mirror_leave(s, r->dir), back, s->t);
    if (!is_on) return;
    send(t, r, lc_surface_behind(s), split.out, on, s->t);
    t->rays[t->n_rays - 1].narrow = r->narrow; /* lamps shine through glass */
}

/* Turns an entry into the one for the other side of a surface with diffuse transmission. */
static void turn_over(lc_lit *lit)
{
    lc_surface *s = &lit->surface;
    lc_f3_store(s->ray_org, lc_surface_behind(s));
    s->n = lc_f3_neg(s->n);
    s->ng = lc_f3_neg(s->ng);
    s->front = !s->front;
    s->material = (lc_material){ .kd = s->material.kt };
    lit->followed = false;
}

/* True if the lobe is so narrow that it is followed by a ray. */
static bool is_narrow(const lc_scene *scene, const lc_material *m)
{
    return scene->follows_smooth && fmaxf(m->roughness[0], m->roughness[1]) < LC_SMOOTH_ROUGHNESS;
}

/* A direction in which a narrow lobe is followed, the i-th, and what that leaves of the radiance. Below the
 * surface, which a bent normal may lead to, it is the mirror's. Lobes behind others have another place in the
 * same even pattern. */
static lc_f3 draw(const trace *t, const ray *r, const lc_surface *s, const lc_point *p, uint32_t i,
                  lc_f3 *left)
{
    const lc_f3 view = lc_f3_neg(r->dir);
    double u[2];
    float unmasked = 1;
    lc_sample_pair(t->how->lobe_key, t->how->lobe_index + i * t->how->lobe_step, u);
    for (int k = 0; k < 2; k++) u[k] += r->depth * (k ? 0.5698402909980532 : 0.7548776662466927);
    for (int k = 0; k < 2; k++) u[k] -= floor(u[k]);
    lc_f3 dir = lc_lobe_draw(p, u);
    if (!(lc_f3_dot(dir, s->ng) > 0 && lc_f3_dot(dir, s->n) > 0)) dir = lc_mirror_leave(s, r->dir);
    else unmasked = lc_lobe_unmasked(p, dir);
    const float cosine = lc_f3_dot(lc_f3_normalize(lc_f3_add(view, dir)), view);
    *left = lc_f3_scale(lc_reflectance(&s->material, cosine, false), unmasked);
    return dir;
}

static void send_narrow(trace *t, const ray *from, const lc_surface *s, lc_f3 dir, lc_f3 left)
{
    const lc_f3 weight = lc_f3_mul(from->weight, left);
    if (!(lc_f3_max(weight) > LC_MIN_PATH_WEIGHT)) return;
    send(t, from, lc_f3_load(s->ray_org), dir, weight, s->t);
    t->rays[t->n_rays - 1].narrow = true;
}

static void meet_narrow(trace *t, const ray *r, const lc_surface *s)
{
    const lc_f3 mirror = lc_mirror_leave(s, r->dir),
                by_mirror = lc_reflectance(&s->material, -lc_f3_dot(r->dir, s->n), false);
    const uint32_t n = t->scene->n_envs && !r->only_sky ? LC_SKY_RAYS : 1;
    ray from = *r;
    lc_point p;
    lc_f3 left;
    if (r->depth >= t->max_depth) return;
    if (!t->how->lobe_key) {
        send_narrow(t, r, s, mirror, by_mirror);
        return;
    }
    lc_point_init(&p, s->pos, s->n, lc_f3_neg(r->dir), &s->material, LC_MIN_D2);
    from.sky = LC_SKY_EVEN;
    from.of_sky = r->of_sky / (float)n;
    for (uint32_t i = 0; i < n && r->sky != LC_SKY_PEAKS; i++) {
        const lc_f3 dir = draw(t, r, s, &p, i, &left);
        from.only_sky = r->only_sky || i > 0;
        send_narrow(t, &from, s, dir, left);
    }
    if (r->sky == LC_SKY_EVEN || !(lc_f3_max(lc_background(t->scene, LC_SKY_PEAKS, mirror)) > 0)) return;
    from = *r;
    from.sky = LC_SKY_PEAKS;
    from.only_sky = true;
    send_narrow(t, &from, s, mirror, by_mirror);
}

/* A surface with a diffuse part or a lobe. A smooth coat is a mirror; a narrow lobe is illuminated by lights,
 * and followed to whatever else there is. */
static void meet_rough(trace *t, const ray *r, const lc_surface *s)
{
    lc_sight *out = t->out;
    const lc_material *m = &s->material;
    bool gloss = m->lobe == LC_LOBE_GGX && lc_f3_max(m->ks) > 0, smooth = gloss && m->smooth;
    bool narrow = gloss && !smooth && is_narrow(t->scene, m);
    if (smooth) meet_mirror(t, r, s, LC_MIN_PATH_WEIGHT);
    if (narrow) meet_narrow(t, r, s);
    if (r->only_sky || (smooth && !(lc_f3_max(m->kd) > 0))) return;
    t->n_rough++;
    out->lit[out->n_lit++] = (lc_lit){ .surface = *s,
                                       .view = lc_f3_neg(r->dir),
                                       .weight = r->weight,
                                       .part = lc_luminance(r->weight),
                                       .n_mirrors = r->depth,
                                       .followed = narrow };
    if (smooth) out->lit[out->n_lit - 1].surface.material.ks = lc_f3_make(0, 0, 0);
    if (!(lc_f3_max(m->kt) > 0)) return;
    out->lit[out->n_lit] = out->lit[out->n_lit - 1];
    turn_over(&out->lit[out->n_lit++]);
}

static void meet(trace *t, const ray *r, const lc_surface *s)
{
    lc_sight *out = t->out;
    const bool shines = !r->narrow && !r->only_sky;
    if (shines) out->emission = lc_f3_add(out->emission, lc_f3_mul(r->weight, s->emission));
    if (shines && t->how->of_group) {
        lc_f3 *sum = &t->how->of_group[s->group];
        *sum = lc_f3_add(*sum, lc_f3_mul(r->weight, s->emission));
    }
    if (s->material.glass) {
        meet_glass(t, r, s);
    } else if (s->material.mirror) {
        meet_mirror(t, r, s, MIN_WEIGHT);
    } else if (r->depth < t->max_depth) {
        meet_rough(t, r, s);
    }
}

/* Removes and returns the ray of largest weight; among equals the oldest. */
static ray take_strongest(trace *t)
{
    uint32_t best = 0;
    for (uint32_t i = 1; i < t->n_rays; i++)
        if (lc_luminance(t->rays[i].weight) > lc_luminance(t->rays[best].weight)) best = i;
    ray r = t->rays[best];
    t->n_rays--;
    for (uint32_t i = best; i < t->n_rays; i++) t->rays[i] = t->rays[i + 1];
    return r;
}

/* A point of a medium: its n is the direction to the viewer. */
static void light_medium(trace *t, const ray *r, const lc_medium_point *p)
{
    const lc_f3 to_viewer = lc_f3_neg(r->dir), pos = lc_f3_add(r->org, lc_f3_scale(r->dir, p->t));
    lc_lit *lit = &t->out->lit[t->out->n_lit++];
    *lit = (lc_lit){ .view = to_viewer, .weight = lc_f3_mul(r->weight, p->weight),
                     .part = lc_luminance(r->weight) * p->part,
                     .floor = LAMP_SIZE * (float)t->how->pixel * (r->length + p->t), .n_mirrors = r->depth };
    lit->surface = (lc_surface){ .pos = pos, .n = to_viewer, .ng = to_viewer, .t = r->length + p->t,
                                 .front = true, .material_id = LC_NONE,
                                 .moment = t->scene->moment };
    lit->surface.material = (lc_material){ .ks = { 1, 1, 1 }, .exponent = p->g, .lobe = LC_LOBE_PHASE };
    lc_f3_store(lit->surface.ray_org, pos);
    t->n_in_media++;
}

static void show_sky(trace *t, const ray *r)
{
    const lc_f3 weight = lc_f3_scale(r->weight, r->of_sky), sky = lc_background(t->scene, r->sky, r->dir);
    t->out->emission = lc_f3_add(t->out->emission, lc_f3_mul(weight, sky));
    if (t->how->of_group) lc_background_of_groups(t->scene, r->sky, r->dir, weight, t->how->of_group);
}

/* Follows a ray to its end: a surface, NULL if it leaves the scene. */
static void follow(trace *t, ray *r, const lc_surface *s)
{
    const lc_scene *scene = t->scene;
    lc_medium_point points[LC_MEDIUM_POINTS];
    const ray before = *r;
    uint32_t n = 0;
    if (scene->media.present) {
        const uint32_t want = r->depth ? (t->how->n_points + 3) / 4 : t->how->n_points;
        const double length = s ? (double)(s->t - r->length) : LC_BEYOND;
        const bool lit = !r->only_sky && r->depth < t->max_depth && t->n_in_media + want <= LC_MAX_IN_MEDIA;
        lc_f3 through;
        lc_ray_light own;
        const bool another = r->depth || (t->how->light && t->how->light->varies);
        lc_media_draws draws = { lit ? want : 0, t->how->offset, another ? &own : t->how->light };
        if (draws.n && another)
            lc_ray_light_find(scene, r->org, r->dir, &(const lc_ray_spread){ 0, 0, 1 }, t->how->slot, &own);
        n = lc_media_draw(scene, r->org, r->dir, length, &draws, points, &through);
        r->weight = lc_f3_mul(r->weight, through);
    }
    if (s) meet(t, r, s);
    else show_sky(t, r);
    for (uint32_t i = 0; i < n; i++) light_medium(t, &before, &points[i]);
}

/* The triangle if the ray meets nothing else, and another place of it would look the same. */
static uint32_t find_flat(const trace *t, const lc_hit *hit)
{
    const lc_sight *s = t->out;
    if (!s->is_hit || t->scene->media.present || s->n_rays || s->n_lit != 1 || s->lit[0].followed ||
        s->first.material.smooth || lc_f3_max_abs(s->emission) > 0)
        return LC_NONE;
    return lc_is_flat(t->scene, hit) ? hit->tri : LC_NONE;
}

/* Whether the sight of the last ray is that of this one, too; if so, moves it. */
static bool is_same(const lc_scene *scene, const lc_hit *hit, lc_f3 dir, lc_sight *s)
{
    if (hit->tri == LC_NONE || s->flat_tri != hit->tri || s->scene != scene || hit->instance != LC_NONE ||
        !(lc_f3_dot(s->first.ng, dir) < 0))
        return false;
    lc_surface_move(scene, hit, &s->first);
    s->lit[0].surface.pos = s->first.pos;
    for (int k = 0; k < 3; k++) s->lit[0].surface.ray_org[k] = s->first.ray_org[k];
    s->lit[0].surface.t = s->first.t;
    s->lit[0].view = lc_f3_neg(dir);
    return true;
}

bool lc_sight_trace(const lc_scene *scene, lc_f3 org, lc_f3 dir, const lc_sight_desc *how, lc_sight *out)
{
    trace t;
    ray r = { org, dir, lc_f3_make(1, 1, 1), 0, 0, false, LC_SKY_ALL, 1, false };
    lc_hit hit;
    lc_closest_hit(scene, org, dir, &hit);
    out->is_same = how->again && is_same(scene, &hit, dir, out);
    if (out->is_same) return true;
    t.scene = scene;
    t.out = out;
    t.how = how;
    t.max_depth = how->max_depth;
    t.n_splits = t.n_rough = t.n_rays = t.n_in_media = 0;
    out->n_rays = out->n_lit = 0;
    out->flat_tri = LC_NONE;
    out->scene = scene;
    out->emission = lc_f3_make(0, 0, 0);
    out->is_hit = hit.tri != LC_NONE;
    if (out->is_hit) lc_surface_of(scene, &hit, dir, how->pixel, &out->first);
    if (!out->is_hit && !scene->media.present) return false;
    follow(&t, &r, out->is_hit ? &out->first : NULL);
    while (t.n_rays && t.n_rough < LC_MAX_ROUGH) {
        lc_surface s;
        r = take_strongest(&t);
        out->n_rays++;
        follow(&t, &r, lc_surface_hit_after(scene, r.org, r.dir, r.length, how->pixel, &s) ? &s : NULL);
    }
    out->flat_tri = find_flat(&t, &hit);
    return true;
}
