/* vpl.c - see vpl.h.
 *
 *     a source, by power -> place, direction -> surface -> virtual light, goes on -> surface -> ...
 *
 * Path i draws its source, and the pairs of numbers for its place on that, its direction and its first
 * bounce, from (0,2)-sequences, each in an order of its own, so that none makes a pattern with another
 * ([Kollig02]), and all other numbers from its own hash. Each virtual light emits as a diffuse surface does:
 * flux * albedo / pi along the shading normal.
 * What a metal's lobe reflects goes on in a direction drawn by it; its light shines as the lobe does, but
 * for Fresnel's changes within it (shade/light_virtual.h), and as one no narrower than LEAST_ROUGHNESS, so
 * that single lights do not show; so does a mirror's, and what glass reflects, of every path that meets it:
 * many weak lights rather than few bright ones. What the far face of glass reflects shines as it would
 * without the glass being thick, as shadow rays go straight through; what is reflected in it more often, or
 * totally, is left out. Of a surface with a lobe and a lesser diffuse part a light stands for one of these,
 * by chance; a lesser lobe counts as diffuse. A surface with diffuse transmission has a light on its other
 * side, too. At mirrors and glass a path goes on, by chance where they both reflect and transmit. From the
 * second rough surface on a path ends with probability 1 - albedo. Intensities are divided by the number of
 * paths.
 *
 * The first FIRST_LIGHTS show how far the picture's blocks are from the converged one (vpl_deviation.h); as
 * deviations fall with the root of the number of lights, they tell how many are needed. The next lot shows
 * whether that holds.
 *
 * With from_view, lights that contribute little to what the camera sees, such as those outside a room, are
 * kept with a probability below 1 only, and scaled by its inverse ([Georgiev10]). A light is certain to be
 * kept from SURE_IMPORTANCE times the median importance of the first batch's lights on.
 */
#include "prepare/vpl.h"

#include "base/pool.h"
#include "base/rng.h"
#include "base/sample.h"
#include "base/sample_dir.h"
#include "prepare/path_start.h"
#include "prepare/view_grid.h"
#include "prepare/vpl_deviation.h"
#include "prepare/vpl_radius.h"
#include "scene/media.h"
#include "scene/near_bounce.h"
#include "scene/sight.h"
#include "shade/draw_lobe.h"
#include "shade/fresnel.h"
#include "shade/light_kind.h"
#include "shade/lobe.h"
#include "shade/point_init.h"
#include "shade/reflected.h"
#include "shade/shine.h"
#include "trace/bvh_data.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BATCH LC_SIZE(4096, 128)     /* paths traced at a time, after which lights are kept or dropped */
#define ITEM 64                      /* paths that a thread traces at a time */
#define PATH_LIGHTS 32               /* greatest number of lights of a path */
#define PATHS_A_LIGHT LC_SIZE(64, 8) /* greatest number of paths for each light requested */
#define PATHS_FOR_NONE (16 * BATCH)  /* paths without any light after which none is expected */
#define PAIRS 4                      /* of numbers from sequences: one is left out, then follow */
#define DRAWN 5                      /* the source, the direction and the first bounce, drawn in turn, and */
#define PLACE 6                      /* the place on the source */
#define FIRST_LIGHTS LC_SIZE(16384, 64)
#define MOST_LIGHTS LC_SIZE(1048576, 256)
#define MOST_GROWTH 8.0              /* of the number of lights, after which deviations are looked at again */
#define SURE_IMPORTANCE 0.5          /* of the median: importance from which a light is kept for certain */
#define MIN_CHANCE 0.0625            /* least probability of keeping a light */
#define LEAST_SHARE 0.5f             /* of a lobe in what a surface reflects of light along its normal */
#define LEAST_ROUGHNESS 0.2f         /* of lobes that lights stand for; mirrors, too, shine like that */
#define OF_EXPONENT 0.82f            /* over n: square of a roughness whose facets fall to a half where the
                                        n-th power of the cosine to the mirror direction does */

typedef struct maker {
    lc_scene *scene;
    uint64_t seed, first_path;
    uint32_t max_depth;
    lc_path_starts starts;
    lc_view_grid view; /* without points: all lights are kept */
    double enough; /* importance from which a light is kept for certain; 0: not known yet, or all have none */
    double *importance, *sorted; /* of slots; scratch */
    lc_light *slots; /* PATH_LIGHTS a path of the batch; atten[0]: intensity of a flux of 1; [1]: depth */
    uint8_t n_stored[BATCH];
    lc_light *made; /* of all paths so far, not divided by their number */
    uint32_t *path;    /* of each light */
    size_t n_made, cap_made, cap_path;
    uint64_t n_paths;
    lc_f3 of_bounce[LC_MAX_BOUNCES]; /* of the lights of each, the first at 0: the sum of their fluxes */
} maker;

typedef struct path {
    const maker *m;
    uint64_t index;
    double numbers[2 * PAIRS]; /* of sequences */
    uint32_t n_drawn, n_rough;
    uint32_t group; /* of the light that it starts from */
    int depth;      /* of what it meets next, from 1 on */
    lc_f3 org, dir, flux; /* W, of all paths */
    lc_f3 entered; /* its direction before the glass that it has entered last; 0: it has met more since */
    lc_light *lights;
    uint8_t *n_lights;
} path;

/* ---- numbers ---- */

static void start_numbers(path *p)
{
    for (uint32_t k = 0; k < PAIRS; k++) {
        const uint32_t at = lc_shuffle((uint32_t)p->index, lc_hash4(p->m->seed, k, 0, 7));
        lc_sample_pair(lc_hash4(p->m->seed, k, 0, 0), at, p->numbers + 2 * k);
    }
}

static double draw(path *p)
{
    uint32_t d = p->n_drawn++;
    return d < DRAWN ? p->numbers[1 + d] : lc_unit(lc_hash4(p->m->seed, p->index, d, 1));
}

/* For choices between reflection and transmission, so that mirrors do not use up the numbers of the first
 * bounce. */
static double toss(const path *p, uint32_t depth)
{
    return lc_unit(lc_hash4(p->m->seed, p->index, depth, 2));
}

static lc_f3 draw_cosine(path *p, lc_f3 n)
{
    double u[2], x, y;
    u[0] = draw(p);
    u[1] = draw(p);
    lc_sample_disc(u, &x, &y);
    return lc_sample_frame(n, x, y, sqrt(1 - u[0]));
}

/* ---- emission ---- */

/* Sets the light that the path starts from. */
static void emit(path *p, lc_light *from)
{
    const lc_path_starts *starts = &p->m->starts;
    const double at = draw(p);
    const double chance = lc_path_start_draw(starts, at, p->numbers + PLACE, from);
    lc_emit_from in = { .centre = { starts->centre[0], starts->centre[1], starts->centre[2] },
                        .radius = starts->radius,
                        .spot_maps = p->m->scene->spot_maps,
                        .profiles = &p->m->scene->profiles };
    lc_emitted ray;
    for (int k = 0; k < 2; k++) in.u[k] = draw(p);
    lc_light_kinds[from->kind].emit(from, &in, &ray);
    const double factor = lc_light_kinds[from->kind].flux(from, starts->radius) / chance;
    p->org = ray.org;
    p->dir = ray.dir;
    p->flux = lc_f3_mul(lc_f3_scale(lc_f3_scale(from->intensity, (float)factor), ray.weight), ray.colour);
}

/* The factor by which a light is stronger at a surface than with attenuation of 1 / d^2. */
static float unlike_square(const lc_light *light, const lc_surface *s)
{
    const float *a = light->atten;
    if (!lc_is_attenuated(light->kind) || lc_inverse_square(a)) return 1;
    lc_f3 v = lc_f3_sub(s->pos, light->pos);
    float d2 = lc_f3_dot(v, v);
    d2 = d2 > LC_MIN_D2 ? d2 : LC_MIN_D2;
    return d2 / (a[0] + a[1] * sqrtf(d2) + a[2] * d2);
}

/* ---- surfaces ---- */

static lc_f3 at_most_1(lc_f3 a) { return lc_f3_make(fminf(a.x, 1), fminf(a.y, 1), fminf(a.z, 1)); }

/* The fraction of light that a rough surface reflects, and that its lobe does. */
static lc_f3 albedo(const lc_material *m, float cos_i)
{
    return at_most_1(lc_lobes[m->lobe].albedo(m, cos_i));
}

static lc_f3 lobe_albedo(const lc_material *m, float cos_i)
{
    if (!lc_lobe_is_narrow(m->lobe) || !(lc_f3_max(m->ks) > 0)) return lc_f3_make(0, 0, 0);
    return at_most_1(lc_lobe_reflected(m, cos_i));
}

/* Otherwise the lobe counts as diffuse. */
static bool is_mostly_lobe(const lc_material *m)
{
    return lc_luminance(lobe_albedo(m, 1)) > LEAST_SHARE * lc_luminance(albedo(m, 1));
}

/* What leaves a surface, of a flux of 1. */
typedef struct leaving {
    lc_f3 flux, normal;
    float roughness; /* of the lobe by which it leaves; 0: by the cosine */
    lc_f3 from, next; /* where it comes from and goes on by the lobe */
} leaving;

/* The roughness of GGX that is about as narrow as a lobe. */
static float roughness_of(const lc_material *m)
{
    const float a2 = m->lobe == LC_LOBE_PHONG ? OF_EXPONENT / m->exponent : m->roughness[0] * m->roughness[1];
    return fminf(fmaxf(sqrtf(a2), LEAST_ROUGHNESS), 1);
}

static void store(path *p, lc_f3 pos, const leaving *l)
{
    lc_light light = { .kind = LC_LIGHT_VIRTUAL,
                       .pos = pos,
                       .dir = l->normal,
                       .group = p->group };
    float factor = (float)(1 / LC_PI);
    if (l->roughness > 0) factor = lc_shine_make(&light.shine, l->roughness, l->from, l->normal);
    light.atten[0] = factor;
    light.atten[1] = (float)p->depth;
    light.intensity = lc_f3_scale(lc_f3_mul(p->flux, l->flux), factor);
    if (!(lc_f3_max(light.intensity) > 0) || *p->n_lights == PATH_LIGHTS) return;
    p->lights[(*p->n_lights)++] = light;
}

/* A direction by the lobe. flux: what leaves by it; 0: it is below the surface. */
static void draw_by_lobe(path *p, const lc_surface *s, leaving *out)
{
    lc_point at;
    double u[2];
    for (int k = 0; k < 2; k++) u[k] = draw(p);
    lc_point_init(&at, s->pos, s->n, lc_f3_neg(p->dir), &s->material, 0);
    memset(at.diffuse, 0, sizeof at.diffuse);
    out->next = lc_lobe_draw(&at, u);
    const double density = lc_lobe_density(&at, out->next);
    out->flux = lc_f3_make(0, 0, 0);
    if (!(lc_f3_dot(out->next, s->n) > 0) || !(lc_f3_dot(out->next, s->ng) > 0) || !(density > 0)) return;
    const lc_light_rec far = { .pos = { out->next.x, out->next.y, out->next.z } };
    const lc_f3 transfer =
        lc_estimate_one(p->m->scene->ctx->shade_kernels, &at, LC_LIGHT_DIRECTIONAL, &far, NULL);
    out->flux = lc_f3_scale(transfer, (float)(1 / density));
}

/* What a surface reflects: all: by its lobe and otherwise. */
static void reflect(path *p, const lc_surface *s, uint32_t depth, lc_f3 all, leaving *out)
{
    const float cos_i = -lc_f3_dot(p->dir, s->n);
    const lc_f3 lobe = lobe_albedo(&s->material, cos_i);
    const float share = lc_f3_max(lobe) > 0 ? fminf(lc_luminance(lobe) / lc_luminance(all), 1) : 0;
    *out = (leaving){ .flux = all, .normal = s->n };
    if (!(share > 0) || !is_mostly_lobe(&s->material)) return;
    if (!(lc_unit(lc_hash4(p->m->seed, p->index, depth, 3)) < (double)share)) {
        const lc_f3 rest = lc_f3_sub(all, lobe);
        out->flux = lc_f3_make(fmaxf(rest.x, 0), fmaxf(rest.y, 0), fmaxf(rest.z, 0));
        out->flux = lc_f3_scale(out->flux, 1 / (1 - share));
        return;
    }
    out->roughness = roughness_of(&s->material);
    out->from = lc_f3_neg(p->dir);
    draw_by_lobe(p, s, out);
    out->flux = lc_f3_scale(out->flux, 1 / share);
}

/* Stores virtual lights at a rough surface and continues the path; false: it ends. */
static bool scatter(path *p, const lc_surface *s, uint32_t depth)
{
    const lc_f3 all = albedo(&s->material, -lc_f3_dot(p->dir, s->n));
    leaving back, on = { .flux = s->material.kt, .normal = lc_f3_neg(s->n) };
    const float sum = lc_luminance(all) + lc_luminance(on.flux),
                share = sum > 0 ? lc_luminance(all) / sum : 1;
    const lc_f3 before = lc_f3_load(s->ray_org), behind = lc_surface_behind(s);
    reflect(p, s, depth, all, &back);
    store(p, before, &back);
    store(p, behind, &on);
    if (!(sum > 0) || *p->n_lights == PATH_LIGHTS) return false;
    bool through = toss(p, depth) >= (double)share;
    const leaving *l = through ? &on : &back;
    lc_f3 flux = lc_f3_mul(p->flux, lc_f3_scale(l->flux, 1 / (through ? 1 - share : share)));
    if (!(lc_f3_max(flux) > 0)) return false;
    if (p->n_rough++) {
        float stay = fminf(lc_f3_max(flux) / lc_f3_max(p->flux), 1);
        if (!(draw(p) < (double)stay)) return false;
        flux = lc_f3_scale(flux, 1 / stay);
    }
    p->flux = flux;
    p->org = through ? behind : before;
    p->dir = l->roughness > 0 ? l->next : draw_cosine(p, l->normal);
    return true;
}

/* Continues the path at a mirror or glass; false: its flux is 0. */
static bool scatter_specular(path *p, const lc_surface *s, uint32_t depth)
{
    const float cos_i = -lc_f3_dot(p->dir, s->n);
    const lc_f3 before = lc_f3_load(s->ray_org);
    if (!s->material.glass) {
        const lc_f3 part = lc_reflectance(&s->material, cos_i, !s->front), dir = lc_mirror_leave(s, p->dir);
        store(p, before, &(leaving){ .flux = part, .normal = s->n, .from = lc_f3_neg(p->dir),
                                     .roughness = LEAST_ROUGHNESS });
        p->flux = lc_f3_mul(p->flux, part);
        p->org = before;
        p->dir = dir;
        return lc_f3_max(p->flux) > 0;
    }
    lc_split split;
    lc_glass_split(s, p->dir, &split);
    float back = lc_luminance(split.reflected), on = lc_luminance(split.through);
    if (!(back + on > 0)) return false;
    float share = back / (back + on);
    bool through = toss(p, depth) >= (double)share;
    const lc_f3 part = lc_f3_scale(through ? split.through : split.reflected,
                                   1 / (through ? 1 - share : share));
    const bool outside = s->front || s->material.thin;
    const leaving off = { .flux = split.reflected, .normal = s->n, .roughness = LEAST_ROUGHNESS,
                          .from = lc_f3_neg(outside ? p->dir : p->entered) };
    if (outside || (on > 0 && lc_f3_dot(off.from, s->n) > 0)) store(p, before, &off);
    p->entered = outside ? p->dir : lc_f3_make(0, 0, 0);
    p->flux = lc_f3_mul(p->flux, part);
    p->org = through ? lc_surface_behind(s) : before;
    p->dir = through ? split.out : lc_mirror_leave(s, p->dir);
    return lc_f3_max(p->flux) > 0;
}

/* The next surface; light passes what is only seen. */
static bool meet(path *p, lc_surface *s)
{
    for (uint32_t i = 0; i < LC_MAX_BOUNCES && lc_surface_hit(p->m->scene, p->org, p->dir, 0, s); i++) {
        if (!s->only_seen) return true;
        p->org = lc_surface_behind(s);
    }
    return false;
}

static void trace(path *p)
{
    lc_light from;
    lc_surface s;
    emit(p, &from);
    p->group = from.group;
    if (!(lc_f3_max(p->flux) > 0)) return;
    for (uint32_t depth = 1; depth < p->m->max_depth && depth <= LC_MAX_BOUNCES; depth++) {
        if (!meet(p, &s)) return;
        if (p->m->scene->media.present)
            p->flux = lc_f3_mul(p->flux, lc_media_through(p->m->scene, p->org, p->dir, (double)s.t));
        if (!(lc_f3_max(p->flux) > 0)) return;
        p->depth = (int)depth;
        if (!s.material.glass) p->entered = lc_f3_make(0, 0, 0);
        if (depth == 1) p->flux = lc_f3_scale(p->flux, unlike_square(&from, &s));
        if (!(lc_is_specular(&s.material) ? scatter_specular(p, &s, depth) : scatter(p, &s, depth))) return;
    }
}

static void trace_item(void *user, uint32_t thread, uint64_t item)
{
    maker *m = user;
    (void)thread;
    for (uint64_t i = item * ITEM; i < (item + 1) * ITEM; i++) {
        path p = { .m = m,
                   .index = m->first_path + i,
                   .lights = m->slots + i * PATH_LIGHTS,
                   .n_lights = &m->n_stored[i] };
        m->n_stored[i] = 0;
        start_numbers(&p);
        trace(&p);
        for (uint64_t k = i * PATH_LIGHTS; k < i * PATH_LIGHTS + m->n_stored[i] && m->view.n; k++)
            m->importance[k] = lc_view_grid_importance(&m->view, &m->slots[k],
                                                  lc_hash4(m->seed, p.index, k % PATH_LIGHTS, 4));
    }
}

static int rising(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Median importance of the batch's lights that have any, 0 without such lights. Not the mean: a few lights
 * next to a visible point would decide it. */
static double median_importance(maker *m)
{
    size_t n = 0;
    for (size_t i = 0; i < BATCH; i++)
        for (size_t k = i * PATH_LIGHTS; k < i * PATH_LIGHTS + m->n_stored[i]; k++)
            if (m->importance[k] > 0) m->sorted[n++] = m->importance[k];
    qsort(m->sorted, n, sizeof *m->sorted, rising);
    return n ? m->sorted[n / 2] : 0;
}

/* Keeps light k of path i of the batch, or not. */
static void keep(maker *m, size_t i, size_t k)
{
    static const float inverse_square[] = { 0, 0, 1 };
    const lc_light *light = &m->slots[i * PATH_LIGHTS + k];
    double chance = m->enough > 0
                        ? fmin(fmax(m->importance[i * PATH_LIGHTS + k] / m->enough, MIN_CHANCE), 1)
                        : 1;
    if (!(lc_unit(lc_hash4(m->seed, m->first_path + i, k, 5)) < chance)) return;
    lc_f3 *sum = &m->of_bounce[(int)light->atten[1] - 1];
    *sum = lc_f3_add(*sum, lc_f3_scale(light->intensity, (float)(1 / chance) / light->atten[0]));
    m->path[m->n_made] = (uint32_t)(m->first_path + i);
    m->made[m->n_made] = *light;
    memcpy(m->made[m->n_made].atten, inverse_square, sizeof inverse_square);
    m->made[m->n_made++].intensity = lc_f3_scale(light->intensity, (float)(1 / chance));
}

/* ---- the whole ---- */

/* Traces paths until there are n lights, or it is clear that there will not be. Every path is completed. */
static lc_status trace_until(maker *m, size_t n)
{
    const lc_context *ctx = m->scene->ctx;
    const size_t room = n + PATH_LIGHTS;
    lc_status st = lc_grow(ctx, (void **)&m->made, &m->cap_made, room, sizeof *m->made);
    if (!st) st = lc_grow(ctx, (void **)&m->path, &m->cap_path, room, sizeof *m->path);
    while (!st && m->n_made < n && m->n_paths < (uint64_t)PATHS_A_LIGHT * n) {
        if (!m->n_made && m->n_paths >= PATHS_FOR_NONE) break;
        m->first_path = m->n_paths;
        lc_parallel(ctx, BATCH / ITEM, trace_item, m);
        if (!m->first_path && m->view.n) m->enough = SURE_IMPORTANCE * median_importance(m);
        for (size_t i = 0; i < BATCH && m->n_made < n; i++, m->n_paths++)
            for (size_t k = 0; k < m->n_stored[i]; k++) keep(m, i, k);
    }
    return st;
}

/* How many lights to have in place of n for the deviations that are asked for: n times a power of 2, since a
 * number that changes whenever the camera moves a little would change all cuts. */
static size_t needed(const lc_indirect *have, double asked, size_t n)
{
    const double off = lc_indirect_deviation(have) / asked;
    double growth = 2;
    while (growth < off * off && growth < MOST_GROWTH) growth *= 2;
    return (size_t)fmin((double)n * growth, MOST_LIGHTS);
}

/* Makes as many lights as are asked for, by number or by deviation. */
static lc_status make_enough(maker *m, lc_vpl_deviation *deviation, const lc_vpl_desc *desc,
                             lc_indirect *out)
{
    size_t n = desc->n_lights ? desc->n_lights : FIRST_LIGHTS;
    for (;;) {
        lc_status st = trace_until(m, n);
        const bool last = desc->n_lights || n >= MOST_LIGHTS || m->n_made < n;
        lc_light_places_free(&m->scene->virtuals, m->scene->ctx);
        if (!st)
            st = lc_vpl_radii(m->scene->ctx, m->made, m->path, m->n_made, &m->scene->virtuals);
        if (!st)
            st = lc_vpl_deviation_find(deviation, m->made, m->path, m->n_made, m->n_paths,
                                       last ? INFINITY : desc->deviation, out);
        if (st || last || lc_indirect_deviation(out) <= desc->deviation) return st;
        n = needed(out, desc->deviation, n);
    }
}

static lc_status add_all(lc_scene *scene, const maker *m)
{
    double each = 1 / (double)m->n_paths;
    lc_status st = LC_OK;
    for (size_t i = 0; i < m->n_made && !st; i++) {
        lc_light l = m->made[i];
        l.intensity = lc_f3_make((float)((double)l.intensity.x * each), (float)((double)l.intensity.y * each),
                                 (float)((double)l.intensity.z * each));
        st = lc_scene_add_light(scene, (lc_pos){ 0, 0, 0 }, &l);
    }
    return st ? st : lc_scene_join_lights(scene);
}

static float part_of(float sum, float all) { return all > 0 ? sum / all : 0; }

static void set_bounces(const maker *m, lc_indirect *in)
{
    lc_f3 all = { 0, 0, 0 }, sum = all;
    in->n_bounces = m->max_depth - 1 < LC_MAX_BOUNCES ? m->max_depth - 1 : LC_MAX_BOUNCES;
    for (uint32_t j = 0; j < in->n_bounces; j++) all = lc_f3_add(all, m->of_bounce[j]);
    for (uint32_t j = 0; j < LC_MAX_BOUNCES; j++) in->again[j] = lc_f3_make(0, 0, 0);
    for (uint32_t j = 0; j < in->n_bounces; j++) {
        sum = lc_f3_add(sum, m->of_bounce[j]);
        in->again[in->n_bounces - 1 - j] =
            lc_f3_make(part_of(sum.x, all.x), part_of(sum.y, all.y), part_of(sum.z, all.z));
    }
}

static lc_status make(lc_scene *scene, maker *m, const lc_vpl_desc *desc)
{
    const lc_context *ctx = scene->ctx;
    lc_vpl_deviation deviation;
    lc_status st = LC_OK;
    m->slots = lc_alloc_raw(ctx, (size_t)BATCH * PATH_LIGHTS, sizeof *m->slots);
    m->importance = lc_alloc_raw(ctx, (size_t)BATCH * PATH_LIGHTS, sizeof *m->importance);
    m->sorted = lc_alloc_raw(ctx, (size_t)BATCH * PATH_LIGHTS, sizeof *m->sorted);
    if (!m->slots || !m->importance || !m->sorted) return LC_ERR_MEMORY;
    if (desc->from_view) st = lc_view_grid_init(&m->view, scene, LC_VIEW_GRID_SIDE, desc->max_depth);
    if (st) return st;
    st = lc_vpl_deviation_init(&deviation, scene, desc->max_depth, m->seed);
    if (!st) st = make_enough(m, &deviation, desc, &scene->indirect);
    lc_vpl_deviation_free(&deviation);
    if (st) return st;
    size_t before = scene->n_lights;
    st = add_all(scene, m);
    scene->virtuals.lights = scene->lights + before;
    scene->indirect.n_lights = scene->n_lights - before;
    scene->indirect.n_paths = m->n_paths;
    set_bounces(m, &scene->indirect);
    return st ? st : lc_near_places_make(scene);
}

lc_status lc_vpl_make(lc_scene *scene, const lc_vpl_desc *desc)
{
    maker m = { .scene = scene,
                .view = { .scene = scene },
                .seed = lc_hash2(desc->seed, 0x76706c),
                .max_depth = desc->max_depth };
    const lc_context *ctx = scene->ctx;
    if (desc->max_depth < 2 || !scene->n_lights || !scene->n_tris) return LC_OK;
    lc_status st = lc_path_starts_init(&m.starts, scene, desc->n_given, desc->seed);
    if (!st && m.starts.n && m.starts.sums[m.starts.n] > 0) st = make(scene, &m, desc);
    lc_path_starts_free(&m.starts);
    lc_view_grid_free(&m.view);
    if (m.slots) lc_free(ctx, m.slots, (size_t)BATCH * PATH_LIGHTS, sizeof *m.slots);
    if (m.importance) lc_free(ctx, m.importance, (size_t)BATCH * PATH_LIGHTS, sizeof *m.importance);
    if (m.sorted) lc_free(ctx, m.sorted, (size_t)BATCH * PATH_LIGHTS, sizeof *m.sorted);
    lc_free(ctx, m.made, m.cap_made, sizeof *m.made);
    lc_free(ctx, m.path, m.cap_path, sizeof *m.path);
    return st;
}
