/* lamp_lights.c - divides emitters until none of their lights stands for much of what a visible point gets.
 *
 *     triangles -> patches, one a side -> share of each at points of the picture -> divide those of the
 *     greatest share by four, score the parts -> ... -> lights
 *     spheres -> balls, whose parts are in one place and differ in where shadow rays go (light_target.h), but
 *     those that are large from where they are seen -> their triangles
 *
 * The share of a patch at a point is what its light contributes there, shadows ignored, over what all lamps
 * contribute, shadows estimated by a few rays. A patch knows the points where its share is greatest, and its
 * parts are scored there alone once there are many. A grid of points would miss the small bright places next
 * to lamps, so rays from the lamps add those that the camera sees. The bound on the shares falls by steps, so
 * that where the lights run out all patches have nearly the same greatest share; that at points of the grid
 * comes first.
 */
#include "prepare/lamp_lights.h"

#include "base/rng.h"
#include "prepare/area_map.h"
#include "prepare/ball_find.h"
#include "prepare/lamp_patches.h"
#include "prepare/triangle.h"

#include <stdlib.h>
#include <string.h>

#define MAX_DEPTH      12   /* divisions of a triangle */
#define BALL_DEPTH     2    /* of a ball, where samples of a pixel see other points of each part, ... */
#define BALL_SHARE     0.07f /* ... and its share. A sensor has one sample: balls are divided as others are */
#define FIRST_SHARE    0.25 /* the first step's bound */
#define MIN_MAP_LIGHTS 64   /* of a triangle with an emission map, if lights are left */

/* ---- patches and their lights ---- */

static void corner_between(const float a[2], const float b[2], float out[2])
{
    out[0] = (a[0] + b[0]) / 2;
    out[1] = (a[1] + b[1]) / 2;
}

lc_f3 lc_patch_point(const lc_patches *m, const lc_patch *p, const double weight[3])
{
    double c[2] = { 0, 0 };
    for (uint32_t i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++) c[k] += (double)p->b[i][k] * weight[i];
    return lc_tri_point(m->scene, lc_patch_source(m, p)->tri, c);
}

/* The corner near which the light of a patch lies: at the weights 2/3, 1/6, 1/6, which at random integrate
 * polynomials of degree 2; at centroids alone, 1/d^2 would come out too low. The three parts in the corners
 * of one patch have the three corners between them, so that what is linear is exact. */
static uint32_t corner_of(const lc_patches *m, const lc_patch *p)
{
    const uint32_t tri = lc_patch_source(m, p)->tri, part = p->path % 4, parent = p->path / 4;
    if (p->depth && part < 3) return (uint32_t)((lc_hash4(m->seed, tri, parent, 1) % 3 + part) % 3);
    return (uint32_t)(lc_hash4(m->seed, tri, p->path, 0) % 3);
}

/* A part of a ball is the ball with a part of its intensity: shadow rays to it go to a part of the disc that
 * the ball is seen as. */
static lc_light ball_part(const lc_patch *p, lc_light ball)
{
    ball.intensity = lc_f3_scale(ball.intensity, ldexpf(1, -2 * p->depth));
    ball.depth = p->depth;
    for (uint32_t i = 0; i < p->depth; i++) ball.part |= (p->path >> 2 * i & 3) << 2 * (p->depth - 1 - i);
    return ball;
}

lc_light lc_patch_light(const lc_patches *m, const lc_patch *p)
{
    const lc_lamp_source *source = lc_patch_source(m, p);
    if (source->is_ball) return ball_part(p, source->ball);
    const lc_emitter *e = &source->emitter;
    const double part = ldexp(1, -2 * p->depth);
    double weight[3] = { 1.0 / 6, 1.0 / 6, 1.0 / 6 };
    weight[corner_of(m, p)] = 2.0 / 3;
    lc_f3 flux = lc_f3_make((float)(e->flux[0] * part), (float)(e->flux[1] * part),
                            (float)(e->flux[2] * part));
    const lc_f3 n = lc_emitter_normal(e, p->sign);
    return (lc_light){ .kind = LC_LIGHT_ORIENTED,
                       .pos = lc_tri_light_at(m->scene, source->tri, lc_patch_point(m, p, weight), n),
                       .dir = n,
                       .intensity = lc_f3_mul(lc_patch_mesh(m, p)->emission, flux),
                       .atten = { 0, 0, 1 },
                       .group = lc_patch_mesh(m, p)->group };
}

/* Adds a source and room for its patches. */
static lc_status add_source(lc_patches *m, const lc_lamp_source *source, uint32_t n_patches)
{
    const lc_context *ctx = m->scene->ctx;
    lc_status st = lc_grow(ctx, (void **)&m->patches, &m->cap, m->n + n_patches, sizeof *m->patches);
    if (!st) st = lc_grow(ctx, (void **)&m->sources, &m->cap_sources, m->n_sources + 1, sizeof *m->sources);
    if (!st) m->sources[m->n_sources++] = *source;
    return st;
}

/* The sides of a triangle. near: a patch whose points they know to begin with; may be NULL. */
static lc_status add_triangle(lc_patches *m, uint32_t tri, const lc_patch *near)
{
    const lc_lamp_source source = { .tri = tri, .emitter = lc_emitter_of(m->scene, tri) };
    const lc_emitter *e = &source.emitter;
    if (!(e->power > 0)) return LC_OK;
    lc_status st = add_source(m, &source, e->n_sides);
    for (uint32_t i = 0; i < e->n_sides && !st; i++) {
        lc_patch *p = &m->patches[m->n++];
        *p = (lc_patch){ .source = (uint32_t)m->n_sources - 1,
                         .sign = (int8_t)(i ? -e->side : e->side),
                         .path = i + 1,
                         .b = { { 0, 0 }, { 1, 0 }, { 0, 1 } } };
        if (!near) continue;
        p->n_near = near->n_near;
        p->n_grid = near->n_grid;
        memcpy(p->near, near->near, sizeof p->near);
        memcpy(p->grid, near->grid, sizeof p->grid);
    }
    return st;
}

static lc_status find_patches(lc_patches *m)
{
    lc_scene *s = m->scene;
    lc_status st = LC_OK;
    for (size_t i = 0; i < s->n_meshes && !st; i++) {
        const lc_mesh *mesh = &s->meshes[i];
        lc_lamp_source ball = { .tri = mesh->first_tri, .is_ball = true };
        if (!lc_mesh_is_lamp(mesh)) continue;
        if (lc_ball_find(s, (uint32_t)i, &ball.ball)) {
            st = add_source(m, &ball, 1);
            if (!st) m->patches[m->n++] = (lc_patch){ .source = (uint32_t)m->n_sources - 1 };
            for (size_t t = 0; t < mesh->n_tris; t++)
                s->n_emissive_tris += lc_tri_area(s, mesh->first_tri + t) > 0;
            continue;
        }
        const size_t before = m->n_sources;
        for (uint32_t t = mesh->first_tri; t < mesh->first_tri + mesh->n_tris && !st; t++)
            st = add_triangle(m, t, NULL);
        s->n_emissive_tris += m->n_sources - before;
    }
    return st;
}

/* ---- division ---- */

/* Replaces the spheres that a ball cannot stand for by their triangles. */
static lc_status open_large(lc_patches *m)
{
    size_t n = m->n, kept = 0;
    lc_status st = LC_OK;
    for (size_t i = 0; i < n && !st; i++) {
        const lc_patch p = m->patches[i];
        const lc_mesh *mesh = lc_patch_mesh(m, &p);
        for (uint32_t t = mesh->first_tri; p.large && t < mesh->first_tri + mesh->n_tris && !st; t++)
            st = add_triangle(m, t, &p);
    }
    const size_t n_new = m->n - n;
    for (size_t i = 0; i < m->n; i++)
        if (!m->patches[i].large) m->patches[kept++] = m->patches[i];
    m->n = kept;
    m->first = kept - n_new;
    if (!st) lc_patches_score_known(m);
    return st;
}

static bool has_map(const lc_patches *m, const lc_patch *p) { return lc_patch_mesh(m, p)->emission_map > 0; }

/* Patches are divided while their share of this kind is above `least` and there are less than `most`. */
typedef struct bound {
    int which;
    float least;
    size_t most;
} bound;

static bool divisible(const lc_patches *m, const lc_patch *p, const bound *b)
{
    const bool ball = lc_patch_source(m, p)->is_ball, sampled = ball && !m->scene->sensors;
    const int most = sampled ? BALL_DEPTH : ball ? LC_BALL_DEPTH : MAX_DEPTH;
    return p->share[b->which] > (sampled ? fmaxf(b->least, BALL_SHARE) : b->least) && p->depth < most &&
           !has_map(m, p);
}

void lc_patch_divide(const lc_patch *p, lc_patch parts[4])
{
    float mid[3][2];
    for (int i = 0; i < 3; i++) corner_between(p->b[i], p->b[(i + 1) % 3], mid[i]);
    for (int k = 0; k < 4; k++) {
        parts[k] = *p;
        parts[k].depth++;
        parts[k].path = p->path * 4 + (uint32_t)k;
        for (int i = 0; i < LC_SHARES; i++) parts[k].share[i] = 0;
        for (int i = 0; i < 3; i++) /* the corner k, or the middle */
            memcpy(parts[k].b[i],
                   k == 3             ? mid[i]
                   : i == k           ? p->b[k]
                   : i == (k + 1) % 3 ? mid[k]
                                      : mid[(k + 2) % 3],
                   sizeof mid[0]);
    }
}

static int falling(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x < y) - (x > y);
}

/* Raises the bound so that no more patches are above it than there is room to divide. */
static lc_status raise_bound(const lc_patches *m, bound *b)
{
    const size_t may = m->n < b->most ? (b->most - m->n) / 3 : 0;
    size_t n = 0;
    for (size_t i = 0; i < m->n; i++) n += divisible(m, &m->patches[i], b);
    if (n <= may) return LC_OK;
    float *shares = lc_alloc_raw(m->scene->ctx, n, sizeof *shares);
    if (!shares) return LC_ERR_MEMORY;
    size_t at = 0;
    for (size_t i = 0; i < m->n; i++)
        if (divisible(m, &m->patches[i], b)) shares[at++] = m->patches[i].share[b->which];
    qsort(shares, n, sizeof *shares, falling);
    b->least = shares[may];
    lc_free(m->scene->ctx, shares, n, sizeof *shares);
    return LC_OK;
}

/* Replaces the patches above the bound by their parts, which go to the end, and scores these. */
static lc_status divide_all(lc_patches *m, const bound *b, size_t *n_divided)
{
    size_t n = m->n, kept = 0;
    *n_divided = 0;
    for (size_t i = 0; i < n; i++) *n_divided += divisible(m, &m->patches[i], b);
    if (!*n_divided) return LC_OK;
    lc_status st = lc_grow(m->scene->ctx, (void **)&m->patches, &m->cap, n + 4 * *n_divided,
                           sizeof *m->patches);
    if (st) return st;
    for (size_t i = 0; i < n; i++)
        if (divisible(m, &m->patches[i], b)) {
            lc_patch_divide(&m->patches[i], &m->patches[m->n]);
            m->n += 4;
        }
    for (size_t i = 0; i < m->n; i++)
        if (i >= n || !divisible(m, &m->patches[i], b)) m->patches[kept++] = m->patches[i];
    m->n = kept;
    m->first = kept - 4 * *n_divided;
    lc_patches_score(m);
    return LC_OK;
}

static lc_status divide_by_steps(lc_patches *m, int which, size_t most)
{
    bool full = false;
    for (float step = FIRST_SHARE; !full; step = fmaxf(step / 2, (float)LC_LAMP_SHARE)) {
        size_t n_divided = 1;
        while (n_divided && !full) {
            bound b = { which, step, most };
            lc_status st = raise_bound(m, &b);
            full = b.least > step;
            if (!st) st = divide_all(m, &b, &n_divided);
            if (st) return st;
        }
        if (step <= (float)LC_LAMP_SHARE) break;
    }
    return LC_OK;
}

/* First what much of the picture sees: where lamps are many, there are more spots of a few pixels next to
 * them than there is room for. */
static lc_status divide(lc_patches *m)
{
    const size_t n = m->n;
    lc_status st = divide_by_steps(m, LC_SHARE_GRID, n + LC_LAMP_LIGHTS / 2);
    return st ? st : divide_by_steps(m, LC_SHARE_ALL, n + LC_LAMP_LIGHTS);
}

/* ---- the whole ---- */

static lc_status add_map_lights(lc_patches *m, const lc_patch *p, size_t room)
{
    const lc_lamp_source *source = lc_patch_source(m, p);
    lc_light light = lc_patch_light(m, p);
    double k = fmax(ceil((double)p->share[LC_SHARE_ALL] / LC_LAMP_SHARE), MIN_MAP_LIGHTS);
    light.intensity = lc_f3_scale(lc_patch_mesh(m, p)->emission, (float)(0.5 * source->emitter.twice));
    return lc_area_map_lights(m->scene, source->tri, (uint32_t)fmax(fmin(k, (double)room), 1), &light,
                              lc_hash4(m->seed, source->tri, 0, 6 + (p->sign > 0)));
}

static size_t count_maps(const lc_patches *m)
{
    size_t n = 0;
    for (size_t i = 0; i < m->n; i++) n += has_map(m, &m->patches[i]);
    return n;
}

static lc_status add_lights(lc_patches *m)
{
    const size_t n_maps = count_maps(m);
    lc_status st = LC_OK;
    for (size_t i = 0; i < m->n && !st; i++) {
        const lc_patch *p = &m->patches[i];
        if (has_map(m, p)) {
            st = add_map_lights(m, p, LC_LAMP_LIGHTS / n_maps);
            continue;
        }
        lc_light light = lc_patch_light(m, p);
        st = lc_scene_add_light(m->scene, (lc_pos){ 0, 0, 0 }, &light);
    }
    return st;
}

lc_status lc_lamp_lights_make(lc_scene *scene, uint32_t max_depth, uint64_t seed)
{
    lc_patches m = { .scene = scene, .seed = seed };
    lc_status st = find_patches(&m);
    if (!st && m.n) st = lc_patch_places_find(&m, max_depth);
    if (!st && m.view.n) st = lc_patches_score_first(&m);
    if (!st && m.view.n) st = open_large(&m);
    if (!st && m.view.n) st = divide(&m);
    if (!st) st = add_lights(&m);
    if (!st && m.view.n && !count_maps(&m)) st = lc_patches_deviation(&m, &scene->lamp_error);
    lc_free(scene->ctx, m.places, m.n_points, sizeof *m.places);
    lc_free(scene->ctx, m.total, m.n_points, sizeof *m.total);
    lc_view_grid_free(&m.view);
    lc_free(scene->ctx, m.patches, m.cap, sizeof *m.patches);
    lc_free(scene->ctx, m.sources, m.cap_sources, sizeof *m.sources);
    return st;
}
