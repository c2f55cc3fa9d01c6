/* view_grid.c - makes the grid, scores single lights by it, and estimates what clamping removes. */
#include "prepare/view_grid.h"

#include "base/pool.h"
#include "base/rng.h"
#include "scene/sight.h"
#include "shade/point_init.h"
#include "trace/bvh.h"

#include <string.h>

#define FAR_SAMPLES 1024 /* far lights sampled at each point, for the loss by clamping */
#define NEAR_D2 64.0f    /* lights with d^2 < 64 r^2 are near; the loss of farther ones falls as 1 / d^4 */
#define MIN_HARD 16      /* an unclamped light's d^2 is at least r^2 / 16, so d >= r / 4 */
#define BATCH 64         /* shadow rays traced together */

static const lc_material grey = { .kd = { 0.5f, 0.5f, 0.5f } };

lc_status lc_view_grid_init(lc_view_grid *view, const lc_scene *scene, uint32_t side, uint32_t max_depth)
{
    const double lens[2] = { 0.5, 0.5 };
    const double width = scene->film.width, height = scene->film.height;
    *view = (lc_view_grid){ .scene = scene, .side = side };
    view->points = lc_alloc_raw(scene->ctx, (size_t)side * side, sizeof *view->points);
    view->org = lc_alloc_raw(scene->ctx, (size_t)side * side, sizeof *view->org);
    view->lobe = lc_alloc_raw(scene->ctx, (size_t)side * side, sizeof *view->lobe);
    if (!view->points || !view->org || !view->lobe) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < side * side; i++) {
        lc_f3 org, dir;
        lc_sight sight;
        lc_camera_ray(&scene->camera, (i % side + 0.5) / side * width, (i / side + 0.5) / side * height, lens,
                      &org, &dir);
        if (!lc_sight_trace(scene, org, dir, scene->camera.pixel, max_depth, &sight) || !sight.n_lit)
            continue;
        const lc_lit *lit = &sight.lit[0];
        lc_point_init(&view->points[view->n], lit->surface.pos, lit->surface.n, lit->view, &grey, LC_MIN_D2);
        view->lobe[view->n] = lc_lobe_angle(&lit->surface.material);
        memcpy(view->org[view->n++], lit->surface.ray_org, sizeof view->org[0]);
    }
    return LC_OK;
}

float lc_lobe_angle(const lc_material *m)
{
    if (!(lc_f3_max(m->ks) > 0) || m->mirror || m->glass || m->lobe == LC_LOBE_OREN_NAYAR) return 4;
    return m->lobe == LC_LOBE_PHONG ? 1 / sqrtf(m->exponent + 2) : fminf(m->roughness[0], m->roughness[1]);
}

void lc_view_grid_free(lc_view_grid *view)
{
    size_t n = (size_t)view->side * view->side;
    if (!n) return;
    lc_free(view->scene->ctx, view->points, n, sizeof *view->points);
    lc_free(view->scene->ctx, view->org, n, sizeof *view->org);
    lc_free(view->scene->ctx, view->lobe, n, sizeof *view->lobe);
    *view = (lc_view_grid){ 0 };
}

/* The light's unoccluded luminance at a point, with this attenuation (NULL: inverse square) and distance
 * floor. */
static float luminance(const lc_shade_kernels *kernels, const lc_point *p, const lc_light *light,
                       const lc_light_rec *rec, const float *atten, float min_d2)
{
    lc_point near = *p;
    near.min_d2 = min_d2;
    return lc_luminance(
        lc_f3_mul(lc_estimate_one(kernels, &near, light->kind, rec, atten), light->intensity));
}

float lc_unoccluded_luminance(const lc_shade_kernels *kernels, const lc_point *p, const lc_light *light,
                              const lc_light_rec *rec)
{
    return luminance(kernels, p, light, rec, NULL, LC_MIN_D2);
}

/* Shadow rays are traced from the light to the points, so that all have the same origin. */
double lc_view_grid_importance(const lc_view_grid *view, const lc_light *light, uint64_t hash)
{
    const lc_bvh *bvh = view->scene->bvh;
    const lc_shade_kernels *kernels = view->scene->ctx->shade_kernels;
    const float org[3] = { light->pos.x, light->pos.y, light->pos.z };
    float to[3][LC_IMPORTANCE_POINTS], f[LC_IMPORTANCE_POINTS];
    const float *const target[3] = { to[0], to[1], to[2] };
    uint8_t hidden[LC_IMPORTANCE_POINTS];
    uint32_t n = 0;
    double sum = 0;
    lc_light_rec rec;
    lc_light_rec_init(&rec, light);
    for (uint32_t k = 0; k < LC_IMPORTANCE_POINTS && view->n; k++) {
        /* Stratify over the picture. */
        uint32_t from = view->n * k / LC_IMPORTANCE_POINTS, end = view->n * (k + 1) / LC_IMPORTANCE_POINTS;
        uint32_t i = from + (uint32_t)(lc_hash2(hash, k) % (end > from ? end - from : 1));
        f[n] = luminance(kernels, &view->points[i], light, &rec, NULL, LC_MIN_D2);
        if (!(f[n] > 0)) continue;
        for (int c = 0; c < 3; c++) to[c][n] = view->org[i][c];
        n++;
    }
    if (n) bvh->kernels->hidden(&bvh->data, org, n, target, false, hidden, NULL);
    for (uint32_t k = 0; k < n; k++) sum += hidden[k] ? 0 : (double)f[k];
    return sum / LC_IMPORTANCE_POINTS;
}

/* ---- loss by clamping ---- */

/* soft, hard: each point's luminance with and without clamping. */
typedef struct job {
    const lc_view_grid *view;
    size_t first, n; /* virtual lights of the scene */
    uint64_t seed;
    double soft[LC_VIEW_GRID_SIDE * LC_VIEW_GRID_SIDE], hard[LC_VIEW_GRID_SIDE * LC_VIEW_GRID_SIDE];
} job;

/* A batch of lights at one point whose shadow rays are traced together. */
typedef struct group {
    job *j;
    uint64_t item; /* the point */
    float each;    /* number of lights that each of these stands for */
    uint32_t n;
    float target[3][BATCH], soft[BATCH], hard[BATCH];
} group;

static void trace(group *g)
{
    uint8_t hidden[BATCH];
    const float *const t[3] = { g->target[0], g->target[1], g->target[2] };
    const lc_view_grid *view = g->j->view;
    if (g->n)
        view->scene->bvh->kernels->hidden(&view->scene->bvh->data, view->org[g->item], g->n, t, false, hidden,
                                          NULL);
    for (uint32_t i = 0; i < g->n; i++) {
        if (hidden[i]) continue;
        g->j->soft[g->item] += (double)(g->soft[i] * g->each);
        g->j->hard[g->item] += (double)(g->hard[i] * g->each);
    }
    g->n = 0;
}

static void add(group *g, const lc_light *light)
{
    const lc_point *p = &g->j->view->points[g->item];
    const lc_shade_kernels *kernels = g->j->view->scene->ctx->shade_kernels;
    lc_light_rec rec;
    lc_light_rec_init(&rec, light);
    float hard = luminance(kernels, p, light, &rec, NULL, fmaxf(LC_MIN_D2, light->atten[0] / MIN_HARD));
    if (!(hard > 0)) return;
    g->hard[g->n] = hard;
    g->soft[g->n] = luminance(kernels, p, light, &rec, light->atten, LC_MIN_D2);
    g->target[0][g->n] = light->pos.x;
    g->target[1][g->n] = light->pos.y;
    g->target[2][g->n] = light->pos.z;
    if (++g->n == BATCH) trace(g);
}

static bool is_near(const lc_point *p, const lc_light *light)
{
    lc_f3 d = lc_f3_sub(light->pos, lc_f3_load(p->pos));
    return lc_f3_dot(d, d) < NEAR_D2 * light->atten[0];
}

/* Adds all near lights, and one of each of FAR_SAMPLES equal ranges of the lights if it is not near. */
static void try_point(void *user, uint32_t thread, uint64_t item)
{
    job *j = user;
    const lc_point *p = &j->view->points[item];
    const lc_light *lights = j->view->scene->lights + j->first;
    size_t n_sample = j->n < FAR_SAMPLES ? j->n : FAR_SAMPLES;
    group g = { .j = j, .item = item, .each = 1 };
    (void)thread;
    for (size_t i = 0; i < j->n; i++)
        if (is_near(p, &lights[i])) add(&g, &lights[i]);
    trace(&g);
    g.each = (float)j->n / (float)n_sample;
    for (size_t k = 0; k < n_sample; k++) {
        size_t from = j->n * k / n_sample, to = j->n * (k + 1) / n_sample;
        const lc_light *light = &lights[from + lc_hash4(j->seed, item, k, 3) % (to - from)];
        if (!is_near(p, light)) add(&g, light);
    }
    trace(&g);
}

double lc_view_grid_clamping_loss(const lc_view_grid *view, size_t first, uint64_t seed)
{
    job j = { .view = view, .first = first, .n = view->scene->n_lights - first, .seed = seed };
    double soft = 0, hard = 0;
    if (!j.n) return 0;
    lc_parallel(view->scene->ctx, view->n, try_point, &j);
    for (uint32_t i = 0; i < view->n; i++) {
        soft += j.soft[i];
        hard += j.hard[i];
    }
    return hard > 0 ? 1 - soft / hard : 0;
}
