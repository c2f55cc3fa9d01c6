/* vpl.c - see vpl.h.
 *
 *     a light, by power -> direction -> surface -> virtual light, goes on -> surface -> virtual light, ...
 *
 * Path i draws its first numbers from point i of a Kronecker sequence (powers of the root of x^6 = x + 1,
 * [Roberts18]), which fills light, direction and first bounce evenly, and the others from its own hash. Each
 * virtual light emits as a diffuse surface does: flux * albedo / pi along the shading normal. Lobes count as
 * diffuse with all that they reflect; a surface with diffuse transmission has a light on its other side, too.
 * At mirrors and glass a path goes on, by chance where they both reflect and transmit. From the second rough
 * surface on a path ends with probability 1 - albedo. Intensities are divided by the number of paths.
 *
 * Lights that contribute little to what the camera sees, such as those outside a room, are kept with a
 * probability below 1 only, and scaled by its inverse ([Georgiev10]). A light is certain to be kept from
 * SURE_IMPORTANCE times the median importance of the first batch's lights on.
 */
#include "prepare/vpl.h"

#include "base/pool.h"
#include "base/rng.h"
#include "base/sample_dir.h"
#include "prepare/view_grid.h"
#include "prepare/vpl_radius.h"
#include "scene/sight.h"
#include "shade/fresnel.h"
#include "shade/light_kind.h"
#include "shade/lobe.h"
#include "shade/point_init.h"

#include <stdlib.h>

#define BATCH LC_SIZE(4096, 128)     /* paths traced at a time, after which lights are kept or dropped */
#define ITEM 64                      /* paths that a thread traces at a time */
#define PATH_LIGHTS 32               /* greatest number of lights of a path */
#define PATHS_A_LIGHT LC_SIZE(64, 8) /* greatest number of paths for each light requested */
#define PATHS_FOR_NONE (16 * BATCH)  /* paths without any light after which none is expected */
#define PATH_SURFACES 64             /* greatest number of surfaces of a path, for those among mirrors */
#define DIMS 5                       /* dimensions of the Kronecker sequence */
#define SURE_IMPORTANCE 0.5          /* of the median: importance from which a light is kept for certain */
#define MIN_CHANCE 0.0625            /* least probability of keeping a light */

typedef struct maker {
    const lc_scene *scene;
    uint64_t seed, first_path;
    uint32_t max_depth;
    double *sums; /* n_lights + 1: power of the lights before */
    double centre[3], radius; /* of a ball around all triangles */
    const lc_view_grid *view;
    double enough; /* importance from which a light is kept for certain; 0: not known yet, or all have none */
    double *importance, *sorted; /* of slots; scratch */
    lc_light *slots; /* PATH_LIGHTS a path of the batch */
    uint8_t n_stored[BATCH];
    lc_light *made;
    size_t n_made, n_wanted;
    uint64_t n_paths;
} maker;

typedef struct path {
    const maker *m;
    uint64_t index;
    uint32_t n_drawn, n_rough;
    lc_f3 org, dir, flux; /* W, of all paths */
    lc_light *lights;
    uint8_t *n_lights;
} path;

/* ---- numbers ---- */

static double draw(path *p)
{
    static const uint64_t step[DIMS] = { 0xe19b01aa9d42c633u, 0xc6d1d6c8ed0c9631u, 0xaf36d01ef7518dbbu,
                                         0x9a69443f36f710e7u, 0x881403b9339bd42du };
    uint32_t d = p->n_drawn++;
    if (d >= DIMS) return lc_unit(lc_hash4(p->m->seed, p->index, d, 1));
    return lc_unit(lc_hash4(p->m->seed, d, 0, 0) + (p->index + 1) * step[d]);
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

static double power_of(const maker *m, const lc_light *light)
{
    lc_f3 i = light->intensity;
    return ((double)i.x + (double)i.y + (double)i.z) / 3 * lc_light_kinds[light->kind].flux(light, m->radius);
}

static const lc_light *pick_light(const path *p, double at)
{
    const double *sums = p->m->sums;
    size_t lo = 0, hi = p->m->scene->n_lights - 1;
    at *= sums[hi + 1];
    while (lo < hi) {
        size_t mid = lo + (hi - lo) / 2;
        if (at < sums[mid + 1]) hi = mid;
        else lo = mid + 1;
    }
    return &p->m->scene->lights[lo];
}

static void emit(path *p, const lc_light **from)
{
    const maker *m = p->m;
    const lc_light *light = *from = pick_light(p, draw(p));
    double power = power_of(m, light);
    double factor = lc_light_kinds[light->kind].flux(light, m->radius) *
                    (m->sums[m->scene->n_lights] / power);
    lc_emit_from in = { .centre = { m->centre[0], m->centre[1], m->centre[2] },
                        .radius = m->radius,
                        .spot_maps = m->scene->spot_maps };
    lc_emitted ray;
    for (int k = 0; k < 2; k++) in.u[k] = draw(p);
    lc_light_kinds[light->kind].emit(light, &in, &ray);
    p->org = ray.org;
    p->dir = ray.dir;
    p->flux = lc_f3_mul(lc_f3_scale(lc_f3_scale(light->intensity, (float)factor), ray.weight), ray.colour);
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

/* The fraction of light that a rough surface reflects. */
static lc_f3 albedo(const lc_material *m, float cos_i)
{
    return at_most_1(lc_lobes[m->lobe].albedo(m, cos_i));
}

static void store(path *p, const lc_surface *s, float side, lc_f3 albedo_of_side)
{
    lc_f3 intensity = lc_f3_scale(lc_f3_mul(p->flux, albedo_of_side), (float)(1 / LC_PI));
    if (!(lc_f3_max(intensity) > 0) || *p->n_lights == PATH_LIGHTS) return;
    p->lights[(*p->n_lights)++] = (lc_light){ .kind = LC_LIGHT_VIRTUAL,
                                              .pos = s->pos,
                                              .dir = lc_f3_scale(s->n, side),
                                              .intensity = intensity,
                                              .atten = { 0, 0, 1 } };
}

/* Stores virtual lights at a rough surface and continues the path; false: it ends. */
static bool scatter(path *p, const lc_surface *s, uint32_t depth)
{
    lc_f3 back = albedo(&s->material, -lc_f3_dot(p->dir, s->n)), on = s->material.kt;
    float org[3], sum = lc_luminance(back) + lc_luminance(on), share = sum > 0 ? lc_luminance(back) / sum : 1;
    store(p, s, 1, back);
    store(p, s, -1, on);
    if (!(sum > 0) || *p->n_lights == PATH_LIGHTS) return false;
    bool through = toss(p, depth) >= (double)share;
    lc_f3 flux = lc_f3_mul(p->flux, lc_f3_scale(through ? on : back, 1 / (through ? 1 - share : share)));
    if (p->n_rough++) {
        float stay = fminf(lc_f3_max(flux) / lc_f3_max(p->flux), 1);
        if (!(draw(p) < (double)stay)) return false;
        flux = lc_f3_scale(flux, 1 / stay);
    }
    p->flux = flux;
    lc_f3_store(org, lc_f3_load(s->ray_org));
    if (through) lc_surface_behind(s, org);
    p->org = lc_f3_load(org);
    p->dir = draw_cosine(p, through ? lc_f3_neg(s->n) : s->n);
    return true;
}

/* Continues the path at a mirror or glass; false: its flux is 0. */
static bool scatter_specular(path *p, const lc_surface *s, uint32_t depth)
{
    float org[3], cos_i = -lc_f3_dot(p->dir, s->n);
    if (!s->material.glass) {
        p->flux = lc_f3_mul(p->flux, lc_reflectance(&s->material, cos_i, !s->front));
        p->org = lc_f3_load(s->ray_org);
        p->dir = lc_mirror_leave(s, p->dir);
        return lc_f3_max(p->flux) > 0;
    }
    lc_split split;
    lc_glass_split(s, p->dir, &split);
    float back = lc_luminance(split.reflected), on = lc_luminance(split.through);
    if (!(back + on > 0)) return false;
    float share = back / (back + on);
    bool through = toss(p, depth) >= (double)share;
    p->flux = lc_f3_mul(p->flux, lc_f3_scale(through ? split.through : split.reflected,
                                             1 / (through ? 1 - share : share)));
    lc_surface_behind(s, org);
    p->org = through ? lc_f3_load(org) : lc_f3_load(s->ray_org);
    p->dir = through ? split.out : lc_mirror_leave(s, p->dir);
    return lc_f3_max(p->flux) > 0;
}

static void trace(path *p)
{
    const lc_light *from;
    lc_surface s;
    emit(p, &from);
    if (!(lc_f3_max(p->flux) > 0)) return;
    for (uint32_t depth = 1; depth < p->m->max_depth && depth <= PATH_SURFACES; depth++) {
        if (!lc_surface_hit(p->m->scene, p->org, p->dir, 0, &s)) return;
        if (depth == 1) p->flux = lc_f3_scale(p->flux, unlike_square(from, &s));
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
        trace(&p);
        for (uint64_t k = i * PATH_LIGHTS; k < i * PATH_LIGHTS + m->n_stored[i]; k++)
            m->importance[k] = lc_view_grid_importance(m->view, &m->slots[k],
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
    const lc_light *light = &m->slots[i * PATH_LIGHTS + k];
    double chance = m->enough > 0
                        ? fmin(fmax(m->importance[i * PATH_LIGHTS + k] / m->enough, MIN_CHANCE), 1)
                        : 1;
    if (!(lc_unit(lc_hash4(m->seed, m->first_path + i, k, 5)) < chance)) return;
    m->made[m->n_made] = *light;
    m->made[m->n_made++].intensity = lc_f3_scale(light->intensity, (float)(1 / chance));
}

/* ---- the whole ---- */

static bool prepare(maker *m)
{
    const lc_scene *s = m->scene;
    const lc_box *b = &s->bounds;
    double lo[3] = { (double)b->lo.x, (double)b->lo.y, (double)b->lo.z },
           hi[3] = { (double)b->hi.x, (double)b->hi.y, (double)b->hi.z };
    double r2 = 0;
    for (int k = 0; k < 3; k++) {
        double half = (hi[k] - lo[k]) / 2;
        m->centre[k] = lo[k] + half;
        r2 += half * half;
    }
    m->radius = sqrt(r2);
    for (size_t i = 0; i < s->n_lights; i++) m->sums[i + 1] = m->sums[i] + power_of(m, &s->lights[i]);
    return m->sums[s->n_lights] > 0;
}

static void trace_all(maker *m)
{
    while (m->n_made < m->n_wanted && m->n_paths < (uint64_t)PATHS_A_LIGHT * m->n_wanted) {
        if (!m->n_made && m->n_paths >= PATHS_FOR_NONE) return;
        m->first_path = m->n_paths;
        lc_parallel(m->scene->ctx, BATCH / ITEM, trace_item, m);
        if (!m->first_path) m->enough = SURE_IMPORTANCE * median_importance(m);
        for (size_t i = 0; i < BATCH && m->n_made < m->n_wanted; i++, m->n_paths++)
            for (size_t k = 0; k < m->n_stored[i]; k++) keep(m, i, k);
    }
}

static lc_status add_all(lc_scene *scene, maker *m)
{
    double each = 1 / (double)m->n_paths;
    for (size_t i = 0; i < m->n_made; i++) {
        lc_light *l = &m->made[i];
        l->intensity = lc_f3_make((float)((double)l->intensity.x * each),
                                  (float)((double)l->intensity.y * each),
                                  (float)((double)l->intensity.z * each));
    }
    lc_status st = lc_vpl_radii(scene->ctx, m->made, m->n_made);
    size_t before = scene->n_lights;
    for (size_t i = 0; i < m->n_made && !st; i++)
        st = lc_scene_add_light(scene, (lc_pos){ 0, 0, 0 }, &m->made[i]);
    if (!st) st = lc_scene_join_lights(scene);
    if (st) return st;
    scene->indirect.n_lights = scene->n_lights - before;
    scene->indirect.n_paths = m->n_paths;
    scene->indirect.loss = lc_view_grid_clamping_loss(m->view, before, m->seed);
    return LC_OK;
}

lc_status lc_vpl_make(lc_scene *scene, uint32_t n_lights, uint32_t max_depth, uint64_t seed)
{
    lc_view_grid view = { 0 };
    maker m = { .scene = scene,
                .view = &view,
                .seed = lc_hash2(seed, 0x76706c),
                .max_depth = max_depth,
                .n_wanted = n_lights };
    const lc_context *ctx = scene->ctx;
    size_t n_sums = scene->n_lights + 1, n_room = (size_t)n_lights + PATH_LIGHTS;
    if (!n_lights || max_depth < 2 || !scene->n_lights || !scene->n_tris) return LC_OK;
    m.sums = lc_alloc(ctx, n_sums, sizeof *m.sums);
    m.slots = lc_alloc_raw(ctx, (size_t)BATCH * PATH_LIGHTS, sizeof *m.slots);
    m.importance = lc_alloc_raw(ctx, (size_t)BATCH * PATH_LIGHTS, sizeof *m.importance);
    m.sorted = lc_alloc_raw(ctx, (size_t)BATCH * PATH_LIGHTS, sizeof *m.sorted);
    m.made = lc_alloc_raw(ctx, n_room, sizeof *m.made);
    lc_status st = m.sums && m.slots && m.importance && m.sorted && m.made ? LC_OK : LC_ERR_MEMORY;
    if (!st && prepare(&m) && !(st = lc_view_grid_init(&view, scene, LC_VIEW_GRID_SIDE, max_depth))) {
        trace_all(&m);
        st = add_all(scene, &m);
    }
    lc_free(ctx, m.sums, n_sums, sizeof *m.sums);
    lc_free(ctx, m.slots, (size_t)BATCH * PATH_LIGHTS, sizeof *m.slots);
    lc_free(ctx, m.importance, (size_t)BATCH * PATH_LIGHTS, sizeof *m.importance);
    lc_free(ctx, m.sorted, (size_t)BATCH * PATH_LIGHTS, sizeof *m.sorted);
    lc_view_grid_free(&view);
    lc_free(ctx, m.made, n_room, sizeof *m.made);
    return st;
}
