/* vpl_loss.c - see vpl_loss.h. */
#include "vpl_loss.h"

#include "bvh.h"
#include "mirror.h"
#include "pool.h"
#include "rng.h"
#include "shade.h"

#define SIDE 16     /* of the grid of points */
#define SAMPLE 2048 /* lights at each */
#define BATCH 64

typedef struct job {
    const lc_scene *scene;
    size_t first, n;
    uint32_t max_depth;
    uint64_t seed;
    double soft[SIDE * SIDE], hard[SIDE * SIDE];
} job;

/* Light k of n_sample, one of each of as many equal ranges. */
static const lc_light *pick(const job *j, uint64_t item, size_t k, size_t n_sample)
{
    size_t from = j->n * k / n_sample, to = j->n * (k + 1) / n_sample;
    return &j->scene->lights[j->first + from + lc_hash4(j->seed, item, k, 3) % (to - from)];
}

static void add_visible(job *j, uint64_t item, const float org[3], uint32_t n, float target[3][BATCH], const float *soft, const float *hard)
{
    uint8_t hidden[BATCH];
    const float *const t[3] = { target[0], target[1], target[2] };
    const lc_bvh *bvh = j->scene->bvh;
    bvh->kernels->hidden(&bvh->data, org, n, t, false, hidden);
    for (uint32_t i = 0; i < n; i++)
        if (!hidden[i]) j->soft[item] += (double)soft[i], j->hard[item] += (double)hard[i];
}

static void shade_point(job *j, uint64_t item, const lc_point *p, const float org[3])
{
    float target[3][BATCH], soft[BATCH], hard[BATCH];
    size_t n_sample = j->n < SAMPLE ? j->n : SAMPLE;
    uint32_t n = 0;
    for (size_t k = 0; k < n_sample; k++) {
        const lc_light *light = pick(j, item, k, n_sample);
        lc_light_rec rec;
        lc_point near = *p;
        lc_light_rec_init(&rec, light);
        near.min_d2 = fmaxf(near.min_d2, light->atten[0] / 16);
        lc_f3 f = lc_shade_light(&near, light->kind, &rec, NULL);
        if (!(lc_f3_max(f) > 0)) continue;
        hard[n] = lc_luminance(lc_f3_mul(f, light->intensity));
        soft[n] = lc_luminance(lc_f3_mul(lc_shade_light(p, light->kind, &rec, light->atten), light->intensity));
        target[0][n] = light->pos.x, target[1][n] = light->pos.y, target[2][n] = light->pos.z;
        if (++n == BATCH) add_visible(j, item, org, n, target, soft, hard), n = 0;
    }
    if (n) add_visible(j, item, org, n, target, soft, hard);
}

static void try_cell(void *user, uint32_t thread, uint64_t item)
{
    job *j = user;
    const lc_scene *s = j->scene;
    lc_f3 org, dir;
    lc_sight sight;
    lc_point p;
    (void)thread;
    lc_camera_ray(&s->camera, ((double)(item % SIDE) + 0.5) / SIDE * s->film.width, ((double)(item / SIDE) + 0.5) / SIDE * s->film.height,
                  &org, &dir);
    if (!lc_sight_trace(s, org, dir, s->camera.pixel, j->max_depth, &sight) || !sight.n_lit) return;
    const lc_lit *lit = &sight.lit[0];
    lc_material diffuse = { .kd = lit->surface.material.kd };
    lc_point_init(&p, lit->surface.pos, lit->surface.n, lit->view, &diffuse, (float)LC_MIN_D2);
    shade_point(j, item, &p, lit->surface.ray_org);
}

double lc_vpl_loss(const lc_scene *scene, size_t first, uint32_t max_depth, uint64_t seed)
{
    job j = { .scene = scene, .first = first, .n = scene->n_lights - first, .max_depth = max_depth, .seed = seed };
    double soft = 0, hard = 0;
    if (!j.n) return 0;
    lc_parallel(scene->ctx, SIDE * SIDE, try_cell, &j);
    for (int i = 0; i < SIDE * SIDE; i++) soft += j.soft[i], hard += j.hard[i];
    return hard > 0 ? 1 - soft / hard : 0;
}
