/* path_start.c - see path_start.h. */
#include "prepare/path_start.h"

#include "base/context.h"
#include "prepare/area_map.h"
#include "prepare/ball_find.h"
#include "prepare/emitter.h"
#include "prepare/env_light.h"
#include "prepare/triangle.h"
#include "shade/light_kind.h"

#define SKY_LIGHTS LC_SIZE(16384u, 96u) /* directions of an environment, of equal power */

static double power_of(const lc_path_starts *p, const lc_light *light)
{
    lc_f3 i = light->intensity;
    return ((double)i.x + (double)i.y + (double)i.z) / 3 * lc_light_kinds[light->kind].flux(light, p->radius);
}

static void bound_scene(lc_path_starts *p)
{
    const lc_box *b = &p->scene->bounds;
    const double lo[3] = { (double)b->lo.x, (double)b->lo.y, (double)b->lo.z };
    const double hi[3] = { (double)b->hi.x, (double)b->hi.y, (double)b->hi.z };
    double r2 = 0;
    for (int k = 0; k < 3; k++) {
        double half = (hi[k] - lo[k]) / 2;
        p->centre[k] = lo[k] + half;
        r2 += half * half;
    }
    p->radius = sqrt(r2);
}

static lc_status add(lc_path_starts *p, lc_path_source_kind what, size_t index)
{
    lc_status st = lc_grow(p->scene->ctx, (void **)&p->sources, &p->cap, p->n + 1, sizeof *p->sources);
    if (st) return st;
    p->sources[p->n].what = what;
    p->sources[p->n++].index = (uint32_t)index;
    return LC_OK;
}

static lc_status add_mesh(lc_path_starts *p, size_t i)
{
    const lc_scene *s = p->scene;
    const lc_mesh *mesh = &s->meshes[i];
    lc_light ball;
    lc_status st = LC_OK;
    if (!lc_mesh_is_lamp(mesh)) return LC_OK;
    if (lc_ball_find(s, (uint32_t)i, &ball)) {
        st = lc_grow(s->ctx, (void **)&p->balls, &p->cap_balls, p->n_balls + 1, sizeof *p->balls);
        if (st) return st;
        p->balls[p->n_balls++] = ball;
        return add(p, LC_PATH_BALL, p->n_balls - 1);
    }
    for (size_t t = mesh->first_tri; t < (size_t)mesh->first_tri + mesh->n_tris && !st; t++) {
        const lc_emitter e = lc_emitter_of(s, t);
        if (!(e.power > 0)) continue;
        st = add(p, LC_PATH_TRIANGLE, t);
        if (!st && e.n_sides == 2) st = add(p, LC_PATH_OTHER_SIDE, t);
    }
    return st;
}

static lc_status add_sky(lc_path_starts *p, uint64_t seed)
{
    const lc_scene *s = p->scene;
    if (!s->n_envs) return LC_OK;
    p->sky = lc_alloc_raw(s->ctx, s->n_envs * SKY_LIGHTS, sizeof *p->sky);
    if (!p->sky) return LC_ERR_MEMORY;
    lc_status st = LC_OK;
    for (size_t i = 0; i < s->n_envs && !st; i++) {
        uint32_t n = 0;
        st = lc_env_lights_by_power(s, i, SKY_LIGHTS, seed, p->sky + p->n_sky, &n);
        for (uint32_t k = 0; k < n && !st; k++) st = add(p, LC_PATH_SKY, p->n_sky++);
    }
    return st;
}

static double source_power(const lc_path_starts *p, const lc_path_source *source)
{
    switch (source->what) {
    case LC_PATH_LIGHT: return power_of(p, &p->scene->lights[source->index]);
    case LC_PATH_BALL: return power_of(p, &p->balls[source->index]);
    case LC_PATH_SKY: return power_of(p, &p->sky[source->index]);
    default: break;
    }
    const lc_emitter e = lc_emitter_of(p->scene, source->index);
    return LC_PI * e.power / e.n_sides;
}

lc_status lc_path_starts_init(lc_path_starts *p, const lc_scene *scene, size_t n_lights, uint64_t seed)
{
    *p = (lc_path_starts){ .scene = scene };
    bound_scene(p);
    lc_status st = LC_OK;
    for (size_t i = 0; i < n_lights && !st; i++) st = add(p, LC_PATH_LIGHT, i);
    for (size_t i = 0; i < scene->n_meshes && !st; i++) st = add_mesh(p, i);
    if (!st) st = add_sky(p, seed);
    if (!st && p->n && !(p->sums = lc_alloc(scene->ctx, p->n + 1, sizeof *p->sums))) st = LC_ERR_MEMORY;
    for (size_t i = 0; i < p->n && !st; i++) p->sums[i + 1] = p->sums[i] + source_power(p, &p->sources[i]);
    return st;
}

void lc_path_starts_free(lc_path_starts *p)
{
    const lc_context *ctx = p->scene->ctx;
    if (p->sums) lc_free(ctx, p->sums, p->n + 1, sizeof *p->sums);
    if (p->sky) lc_free(ctx, p->sky, p->scene->n_envs * SKY_LIGHTS, sizeof *p->sky);
    lc_free(ctx, p->balls, p->cap_balls, sizeof *p->balls);
    lc_free(ctx, p->sources, p->cap, sizeof *p->sources);
    *p = (lc_path_starts){ .scene = p->scene };
}

/* An oriented light at a random place of a triangle, with the emission of that place on all of its area. */
static void draw_place(const lc_scene *s, const lc_path_source *source, const double u[2], lc_light *light)
{
    const lc_emitter e = lc_emitter_of(s, source->index);
    const lc_mesh *mesh = &s->meshes[s->tri_mesh[source->index]];
    const double root = sqrt(u[0]), b[2] = { root * (1 - u[1]), root * u[1] };
    double rgb[3] = { 1, 1, 1 };
    if (mesh->emission_map) lc_area_map_at(s, source->index, b, rgb);
    const double area = e.twice / 2;
    const lc_f3 colour = lc_f3_make((float)(rgb[0] * area), (float)(rgb[1] * area), (float)(rgb[2] * area));
    const lc_f3 n = lc_emitter_normal(&e, source->what == LC_PATH_OTHER_SIDE ? -e.side : e.side);
    *light = (lc_light){
        .kind = LC_LIGHT_ORIENTED,
        .pos = lc_tri_light_at(s, source->index, lc_tri_point(s, source->index, b), n),
        .dir = n,
        .intensity = lc_f3_mul(mesh->emission, colour),
        .atten = { 0, 0, 1 },
        .group = mesh->group,
    };
}

double lc_path_start_draw(const lc_path_starts *p, double at, const double u[2], lc_light *light)
{
    size_t lo = 0, hi = p->n - 1;
    const double total = p->sums[p->n];
    while (lo < hi) {
        size_t mid = lo + (hi - lo) / 2;
        if (at * total < p->sums[mid + 1]) hi = mid;
        else lo = mid + 1;
    }
    const lc_path_source *source = &p->sources[lo];
    switch (source->what) {
    case LC_PATH_LIGHT: *light = p->scene->lights[source->index]; break;
    case LC_PATH_BALL: *light = p->balls[source->index]; break;
    case LC_PATH_SKY: *light = p->sky[source->index]; break;
    default: draw_place(p->scene, source, u, light); break;
    }
    return (p->sums[lo + 1] - p->sums[lo]) / total;
}
