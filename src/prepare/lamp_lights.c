/* lamp_lights.c - divides emitters until none of their lights stands for much of what a visible point gets.
 *
 *     triangles -> patches, one a side -> share of each at points of the picture -> divide those of the
 *     greatest share by four, score the parts -> ... -> lights
 *
 * The share of a patch at a point is what its light contributes there, shadows ignored, over what all lamps
 * contribute, shadows estimated by a few rays. A patch knows the points where its share is greatest, and its
 * parts are scored there alone once there are many. A grid of points would miss the small bright places next
 * to lamps, so rays from the lamps add those that the camera sees. The bound on the shares falls by steps, so
 * that where the lights run out all patches have nearly the same greatest share.
 */
#include "prepare/lamp_lights.h"

#include "base/pool.h"
#include "base/rng.h"
#include "base/sample_dir.h"
#include "prepare/area_map.h"
#include "prepare/emitter.h"
#include "prepare/view_grid.h"
#include "scene/surface.h"
#include "shade/light_kind.h"

#include <stdlib.h>
#include <string.h>

#define BLOCK 64                                 /* patches scored together */
#define WORK ((size_t)LC_SIZE(1 << 23, 1 << 16)) /* most pairs of a patch and a point scored in one go */
#define MIN_SIDE LC_SIZE(8, 4)                   /* points a side of the picture */
#define MAX_SIDE LC_SIZE(64, 8)
#define NEAR 12                                  /* points that a patch knows */
#define MAX_PROBES LC_SIZE(1 << 17, 1 << 8)      /* points found by rays from patches */
#define MAX_PATCH_PROBES 8
#define NEAREST 512       /* points of the picture among which a probe's nearest is looked for */
#define RAYS 16           /* shadow rays of a point, for the fraction that is visible */
#define MIN_VISIBLE (0.5 / RAYS)
#define MAX_DEPTH 12
#define FIRST_SHARE 0.25
#define GRAZING 1e-3f     /* least cosine at a lamp that counts; in its own plane no point sees it */
#define DARK 0.2          /* of the mean: the least light that shares are taken of */
#define GREY 0.5f         /* reflectance of the points */
#define MIN_MAP_LIGHTS 64 /* of a triangle with an emission map, if lights are left */

typedef struct patch {
    uint32_t tri;
    int8_t sign;   /* lc_emitter_normal */
    uint8_t depth; /* it is a 4^-depth of the triangle */
    uint32_t path; /* which: a digit to the base of 4 each division, after a 1, or for the other side a 2 */
    uint32_t n_near, near[NEAR];
    float b[3][2]; /* corners: weights of vertices 1 and 2 */
    float share;
} patch;

/* A point of the picture. */
typedef struct place {
    lc_f3 pos, n;
} place;

typedef struct maker {
    lc_scene *scene;
    uint64_t seed;
    lc_view_grid view;
    uint32_t n_points, n_probes; /* those of the grid, then n_probes for each of the first patches */
    place *places;
    float *total; /* of each point, luminance; 0: no point */
    patch *patches;
    size_t n, cap, first; /* first: of those to be scored */
    size_t n_blocks;
    struct block *blocks; /* of all patches, while they are scored for the first time; then NULL */
    float *sums;          /* n_threads * n_blocks */
} maker;

/* ---- patches and their lights ---- */

static void corner_between(const float a[2], const float b[2], float out[2])
{
    out[0] = (a[0] + b[0]) / 2;
    out[1] = (a[1] + b[1]) / 2;
}

static bool has_map(const maker *m, const patch *p)
{
    return m->scene->meshes[m->scene->tri_mesh[p->tri]].emission_map > 0;
}

/* The point of a patch at weights of its corners. */
static lc_f3 point_of(const lc_scene *s, const patch *p, const double weight[3])
{
    double c[2] = { 0, 0 }, x[3];
    for (uint32_t i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++) c[k] += (double)p->b[i][k] * weight[i];
    for (size_t k = 0; k < 3; k++)
        x[k] = (1 - c[0] - c[1]) * (double)lc_tri_vertex(s->pos, s->index, p->tri, 0)[k] +
               c[0] * (double)lc_tri_vertex(s->pos, s->index, p->tri, 1)[k] +
               c[1] * (double)lc_tri_vertex(s->pos, s->index, p->tri, 2)[k];
    return lc_f3_make((float)x[0], (float)x[1], (float)x[2]);
}

/* The corner near which the light of a patch lies: at the weights 2/3, 1/6, 1/6, which at random integrate
 * polynomials of degree 2; at centroids alone, 1/d^2 would come out too low. The three parts in the corners
 * of one patch have the three corners between them, so that what is linear is exact. */
static uint32_t corner_of(const patch *p, uint64_t seed)
{
    uint32_t part = p->path % 4, parent = p->path / 4;
    if (p->depth && part < 3) return (uint32_t)((lc_hash4(seed, p->tri, parent, 1) % 3 + part) % 3);
    return (uint32_t)(lc_hash4(seed, p->tri, p->path, 0) % 3);
}

static lc_light light_of(const lc_scene *s, const patch *p, uint64_t seed)
{
    const lc_emitter e = lc_emitter_of(s, p->tri);
    const double part = ldexp(1, -2 * p->depth);
    double weight[3] = { 1.0 / 6, 1.0 / 6, 1.0 / 6 };
    weight[corner_of(p, seed)] = 2.0 / 3;
    lc_f3 flux = lc_f3_make((float)(e.flux[0] * part), (float)(e.flux[1] * part), (float)(e.flux[2] * part));
    return (lc_light){ .kind = LC_LIGHT_ORIENTED,
                       .pos = point_of(s, p, weight),
                       .dir = lc_emitter_normal(&e, p->sign),
                       .intensity = lc_f3_mul(s->meshes[s->tri_mesh[p->tri]].emission, flux),
                       .atten = { 0, 0, 1 } };
}

static lc_status find_patches(maker *m)
{
    lc_scene *s = m->scene;
    for (size_t t = 0; t < s->n_tris; t++) {
        const lc_emitter e = lc_emitter_of(s, t);
        if (!(e.power > 0)) continue;
        s->n_emissive_tris++;
        lc_status st = lc_grow(s->ctx, (void **)&m->patches, &m->cap, m->n + e.n_sides, sizeof *m->patches);
        if (st) return st;
        for (uint32_t i = 0; i < e.n_sides; i++)
            m->patches[m->n++] = (patch){ .tri = (uint32_t)t,
                                          .sign = (int8_t)(i ? -e.side : e.side),
                                          .path = i + 1,
                                          .b = { { 0, 0 }, { 1, 0 }, { 0, 1 } } };
    }
    return LC_OK;
}

/* ---- scores ---- */

static uint32_t in_block(const maker *m, size_t first)
{
    return (uint32_t)(m->n - first < BLOCK ? m->n - first : BLOCK);
}

/* Patches first .. first + n - 1. */
typedef struct block {
    uint32_t n;
    float mid[3][BLOCK], normal[3][BLOCK], radius[BLOCK]; /* of a ball around the patch */
    float strength[BLOCK]; /* luminance of the intensity, times the reflectance over pi */
    float most[BLOCK];     /* luminance of a point all around which the emitter is */
} block;

static void load_block(const maker *m, size_t first, uint32_t n, block *b)
{
    static const double third[3] = { 1.0 / 3, 1.0 / 3, 1.0 / 3 };
    b->n = n;
    for (uint32_t i = 0; i < n; i++) {
        const patch *p = &m->patches[first + i];
        const lc_light light = light_of(m->scene, p, m->seed);
        const lc_f3 mid = point_of(m->scene, p, third);
        float far = 0;
        for (int v = 0; v < 3; v++) {
            const double at[3] = { v == 0, v == 1, v == 2 };
            far = fmaxf(far, lc_f3_len(lc_f3_sub(point_of(m->scene, p, at), mid)));
        }
        for (int k = 0; k < 3; k++) {
            b->mid[k][i] = (&mid.x)[k];
            b->normal[k][i] = (&light.dir.x)[k];
        }
        b->radius[i] = far;
        b->strength[i] = lc_luminance(light.intensity) * (float)((double)GREY / LC_PI);
        b->most[i] = lc_luminance(m->scene->meshes[m->scene->tri_mesh[p->tri]].emission) * GREY;
    }
}

static void load_item(void *user, uint32_t thread, uint64_t item)
{
    maker *m = user;
    (void)thread;
    load_block(m, item * BLOCK, in_block(m, item * BLOCK), &m->blocks[item]);
}

static const block *get_block(const maker *m, size_t first, uint32_t n, block *own)
{
    if (m->blocks) return &m->blocks[first / BLOCK];
    load_block(m, first, n, own);
    return own;
}

/* Luminance that each patch of the block contributes to a point, shadows ignored. With reach 1, about what
 * the nearest part of the patch would contribute if all the patch were there; with reach 0, what its middle
 * would. */
static void contributions(const block *b, const place *at, float reach, float f[BLOCK])
{
    for (uint32_t i = 0; i < b->n; i++) {
        float x = b->mid[0][i] - at->pos.x, y = b->mid[1][i] - at->pos.y, z = b->mid[2][i] - at->pos.z;
        float r = b->radius[i] * reach, d2 = x * x + y * y + z * z + LC_TINY_D2, d = sqrtf(d2);
        float in = x * at->n.x + y * at->n.y + z * at->n.z + r;
        float out = -(x * b->normal[0][i] + y * b->normal[1][i] + z * b->normal[2][i]); /* of all the patch */
        float near = d - r > 0.25f * d ? d - r : 0.25f * d;
        in = in < d ? in : d;
        float v = in > 0 && out > GRAZING * d ? b->strength[i] * (in * out) / (d2 * near * near) : 0;
        f[i] = v < b->most[i] ? v : b->most[i];
    }
}

/* What a point gets from all patches: the sum, times the fraction of it that RAYS shadow rays, by
 * contribution, find visible. */
static void total_of_point(void *user, uint32_t thread, uint64_t item)
{
    maker *m = user;
    const place *at = &m->places[item];
    float *sums = m->sums + thread * m->n_blocks, f[BLOCK], to[3][RAYS];
    const float *const target[3] = { to[0], to[1], to[2] };
    uint8_t hidden[RAYS];
    double sum = 0, before = 0;
    uint32_t n = 0, seen = 0;
    for (size_t k = 0; k < m->n_blocks; k++) {
        contributions(&m->blocks[k], at, 0, f);
        sums[k] = 0;
        for (uint32_t i = 0; i < m->blocks[k].n; i++) sums[k] += f[i];
        sum += (double)sums[k];
    }
    for (size_t k = 0; k < m->n_blocks && n < RAYS && sum > 0; before += (double)sums[k++]) {
        if ((n + 0.5) / RAYS * sum >= before + (double)sums[k]) continue;
        contributions(&m->blocks[k], at, 0, f);
        double upto = before;
        for (uint32_t i = 0; i < m->blocks[k].n; i++) {
            upto += (double)f[i];
            for (; n < RAYS && (n + 0.5) / RAYS * sum < upto; n++)
                for (int c = 0; c < 3; c++) to[c][n] = m->blocks[k].mid[c][i];
        }
    }
    const lc_visibility *v = &m->scene->visibility;
    if (n) v->hidden(v->scene, m->view.org[item], n, target, false, hidden, NULL);
    for (uint32_t i = 0; i < n; i++) seen += !hidden[i];
    m->total[item] = (float)(sum * fmax(n ? (double)seen / n : 0, MIN_VISIBLE));
}

/* Shares of next to nothing do not matter. */
static void raise_dark(maker *m)
{
    double sum = 0;
    for (uint32_t k = 0; k < m->view.n; k++) sum += (double)m->total[k];
    const float least = (float)(DARK * sum / m->view.n);
    for (uint32_t k = 0; k < m->view.n; k++) m->total[k] = fmaxf(m->total[k], least);
}

/* Whether the camera sees a point on the side of the surface that its normal points to. */
static bool is_seen(const lc_scene *s, const lc_surface *at)
{
    const lc_camera *c = &s->camera;
    const float *o = at->ray_org;
    const lc_f3 eye = lc_f3_make((float)c->origin[0], (float)c->origin[1], (float)c->origin[2]);
    const lc_f3 way = lc_f3_sub(lc_f3_load(o), eye);
    const float *const target[3] = { &eye.x, &eye.y, &eye.z };
    uint8_t hidden;
    double px, py;
    if (!(lc_f3_dot(way, at->n) < 0) || !lc_camera_project(c, way, &px, &py)) return false;
    if (!(px >= 0 && px < c->width && py >= 0 && py < c->height)) return false;
    s->visibility.hidden(s->visibility.scene, o, 1, target, false, &hidden, NULL);
    return !hidden;
}

static float total_nearest(const maker *m, lc_f3 pos)
{
    float least = INFINITY, total = 0;
    uint32_t step = m->view.n / NEAREST + 1;
    for (uint32_t k = 0; k < m->view.n; k += step) {
        lc_f3 d = lc_f3_sub(m->places[k].pos, pos);
        if (lc_f3_dot(d, d) < least) {
            least = lc_f3_dot(d, d);
            total = m->total[k];
        }
    }
    return total;
}

/* Traces rays from a patch by the cosine; those that meet what the camera sees add points. */
static void probe(void *user, uint32_t thread, uint64_t item)
{
    maker *m = user;
    const patch *p = &m->patches[item];
    const lc_light light = light_of(m->scene, p, m->seed);
    float f[BLOCK];
    block b;
    (void)thread;
    load_block(m, item, 1, &b);
    for (uint32_t k = 0; k < m->n_probes; k++) {
        const double u[2] = { (k + lc_unit(lc_hash4(m->seed, item, k, 2))) / m->n_probes,
                              lc_unit(lc_hash4(m->seed, item, k, 3)) };
        const uint32_t i = m->view.n + (uint32_t)item * m->n_probes + k;
        double x, y;
        lc_surface s;
        lc_sample_disc(u, &x, &y);
        lc_f3 dir = lc_sample_frame(light.dir, x, y, sqrt(1 - u[0]));
        m->total[i] = 0;
        if (!lc_surface_hit(m->scene, lc_emit_clear(&light, light.dir), dir, 0, &s)) continue;
        if (!is_seen(m->scene, &s)) continue;
        m->places[i] = (place){ s.pos, s.n };
        contributions(&b, &m->places[i], 0, f);
        m->total[i] = total_nearest(m, s.pos) + f[0];
    }
}

/* Remembers a point where the share is among the greatest. */
static void remember(patch *p, float shares[NEAR], uint32_t point, float share)
{
    uint32_t i = p->n_near;
    if (!(share > 0) || (i == NEAR && share <= shares[NEAR - 1])) return;
    if (i == NEAR) i--;
    else p->n_near++;
    for (; i > 0 && shares[i - 1] < share; i--) {
        shares[i] = shares[i - 1];
        p->near[i] = p->near[i - 1];
    }
    shares[i] = share;
    p->near[i] = point;
}

static void score_everywhere(void *user, uint32_t thread, uint64_t item)
{
    maker *m = user;
    size_t first = m->first + item * BLOCK;
    float f[BLOCK], shares[BLOCK][NEAR];
    block own;
    (void)thread;
    const block *b = get_block(m, first, in_block(m, first), &own);
    for (uint32_t i = 0; i < b->n; i++) m->patches[first + i].n_near = 0;
    for (uint32_t k = 0; k < m->n_points; k++) {
        if (m->blocks && k == m->view.n) k += (uint32_t)first * m->n_probes; /* the patches' own probes */
        if (m->blocks && k == m->view.n + ((uint32_t)first + b->n) * m->n_probes) break;
        if (!(m->total[k] > 0)) continue;
        contributions(b, &m->places[k], 1, f);
        for (uint32_t i = 0; i < b->n; i++)
            remember(&m->patches[first + i], shares[i], k, f[i] / m->total[k]);
    }
    for (uint32_t i = 0; i < b->n; i++)
        m->patches[first + i].share = m->patches[first + i].n_near ? shares[i][0] : 0;
}

/* The parts of one patch, at the points that it knew. */
static void score_nearby(void *user, uint32_t thread, uint64_t item)
{
    maker *m = user;
    patch *p = &m->patches[m->first + 4 * item];
    float f[BLOCK];
    block b;
    (void)thread;
    load_block(m, m->first + 4 * item, 4, &b);
    for (uint32_t k = 0; k < p->n_near; k++) {
        contributions(&b, &m->places[p->near[k]], 1, f);
        for (uint32_t i = 0; i < 4; i++) p[i].share = fmaxf(p[i].share, f[i] / m->total[p->near[k]]);
    }
}

static void score(maker *m)
{
    size_t n = m->n - m->first;
    if (m->n * m->n_points <= WORK) lc_parallel(m->scene->ctx, (n + BLOCK - 1) / BLOCK, score_everywhere, m);
    else lc_parallel(m->scene->ctx, n / 4, score_nearby, m);
}

/* ---- division ---- */

static bool divisible(const maker *m, const patch *p, float share)
{
    return p->share > share && p->depth < MAX_DEPTH && !has_map(m, p);
}

static void divide(const patch *p, patch parts[4])
{
    float mid[3][2];
    for (int i = 0; i < 3; i++) corner_between(p->b[i], p->b[(i + 1) % 3], mid[i]);
    for (int k = 0; k < 4; k++) {
        parts[k] = *p;
        parts[k].depth++;
        parts[k].path = p->path * 4 + (uint32_t)k;
        parts[k].share = 0;
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

/* Raises the share so that no more patches are above it than may be divided. */
static lc_status raise_share(const maker *m, float *share, size_t may)
{
    size_t n = 0;
    for (size_t i = 0; i < m->n; i++) n += divisible(m, &m->patches[i], *share);
    if (n <= may) return LC_OK;
    float *shares = lc_alloc_raw(m->scene->ctx, n, sizeof *shares);
    if (!shares) return LC_ERR_MEMORY;
    size_t at = 0;
    for (size_t i = 0; i < m->n; i++)
        if (divisible(m, &m->patches[i], *share)) shares[at++] = m->patches[i].share;
    qsort(shares, n, sizeof *shares, falling);
    *share = shares[may];
    lc_free(m->scene->ctx, shares, n, sizeof *shares);
    return LC_OK;
}

/* Replaces the patches above the share by their parts, which go to the end, and scores these. */
static lc_status divide_all(maker *m, float share, size_t *n_divided)
{
    size_t n = m->n, kept = 0;
    *n_divided = 0;
    for (size_t i = 0; i < n; i++) *n_divided += divisible(m, &m->patches[i], share);
    if (!*n_divided) return LC_OK;
    lc_status st = lc_grow(m->scene->ctx, (void **)&m->patches, &m->cap, n + 4 * *n_divided,
                           sizeof *m->patches);
    if (st) return st;
    for (size_t i = 0; i < n; i++)
        if (divisible(m, &m->patches[i], share)) {
            divide(&m->patches[i], &m->patches[m->n]);
            m->n += 4;
        }
    for (size_t i = 0; i < m->n; i++)
        if (i >= n || !divisible(m, &m->patches[i], share)) m->patches[kept++] = m->patches[i];
    m->n = kept;
    m->first = kept - 4 * *n_divided;
    score(m);
    return LC_OK;
}

static lc_status divide_by_steps(maker *m)
{
    bool full = false;
    for (float step = FIRST_SHARE; !full; step = fmaxf(step / 2, (float)LC_LAMP_SHARE)) {
        size_t n_divided = 1;
        while (n_divided && !full) {
            size_t room = m->n < LC_LAMP_LIGHTS ? LC_LAMP_LIGHTS - m->n : 0;
            float share = step;
            lc_status st = raise_share(m, &share, room / 3);
            full = share > step;
            if (!st) st = divide_all(m, share, &n_divided);
            if (st) return st;
        }
        if (step <= (float)LC_LAMP_SHARE) break;
    }
    return LC_OK;
}

/* ---- the whole ---- */

static lc_status add_map_lights(maker *m, const patch *p, size_t room)
{
    const lc_scene *s = m->scene;
    const lc_emitter e = lc_emitter_of(s, p->tri);
    lc_light light = light_of(s, p, m->seed);
    double k = fmax(ceil((double)p->share / LC_LAMP_SHARE), MIN_MAP_LIGHTS);
    light.intensity = lc_f3_scale(s->meshes[s->tri_mesh[p->tri]].emission, (float)(0.5 * e.twice));
    return lc_area_map_lights(m->scene, p->tri, (uint32_t)fmax(fmin(k, (double)room), 1), &light,
                              lc_hash4(m->seed, p->tri, 0, 6 + (p->sign > 0)));
}

static lc_status add_lights(maker *m)
{
    size_t n_maps = 0;
    lc_status st = LC_OK;
    for (size_t i = 0; i < m->n; i++) n_maps += has_map(m, &m->patches[i]);
    for (size_t i = 0; i < m->n && !st; i++) {
        const patch *p = &m->patches[i];
        if (has_map(m, p)) {
            st = add_map_lights(m, p, LC_LAMP_LIGHTS / n_maps);
            continue;
        }
        lc_light light = light_of(m->scene, p, m->seed);
        st = lc_scene_add_light(m->scene, (lc_pos){ 0, 0, 0 }, &light);
    }
    return st;
}

static lc_status find_points(maker *m, uint32_t max_depth)
{
    const lc_context *ctx = m->scene->ctx;
    double side = fmax(fmin(sqrt((double)WORK / (double)m->n), MAX_SIDE), MIN_SIDE);
    lc_status st = lc_view_grid_init(&m->view, m->scene, (uint32_t)side, max_depth);
    if (st || !m->view.n) return st;
    m->n_probes = (uint32_t)fmin(MAX_PROBES / (double)m->n, MAX_PATCH_PROBES);
    m->n_points = m->view.n + (uint32_t)m->n * m->n_probes;
    m->places = lc_alloc_raw(ctx, m->n_points, sizeof *m->places);
    m->total = lc_alloc_raw(ctx, m->n_points, sizeof *m->total);
    if (!m->places || !m->total) return LC_ERR_MEMORY;
    for (uint32_t k = 0; k < m->view.n; k++)
        m->places[k] = (place){ lc_f3_load(m->view.points[k].pos), lc_f3_load(m->view.points[k].n) };
    return LC_OK;
}

static lc_status score_first(maker *m)
{
    const lc_context *ctx = m->scene->ctx;
    lc_status st = LC_OK;
    m->n_blocks = (m->n + BLOCK - 1) / BLOCK;
    m->sums = lc_alloc_raw(ctx, m->n_blocks * ctx->n_threads, sizeof *m->sums);
    m->blocks = lc_alloc_raw(ctx, m->n_blocks, sizeof *m->blocks);
    if (m->sums && m->blocks) {
        lc_parallel(ctx, m->n_blocks, load_item, m);
        lc_parallel(ctx, m->view.n, total_of_point, m);
        raise_dark(m);
        if (m->n_probes) lc_parallel(ctx, m->n, probe, m);
        lc_parallel(ctx, m->n_blocks, score_everywhere, m);
    } else {
        st = LC_ERR_MEMORY;
    }
    lc_free(ctx, m->sums, m->n_blocks * ctx->n_threads, sizeof *m->sums);
    lc_free(ctx, m->blocks, m->n_blocks, sizeof *m->blocks);
    m->blocks = NULL;
    return st;
}

lc_status lc_lamp_lights_make(lc_scene *scene, uint32_t max_depth, uint64_t seed)
{
    maker m = { .scene = scene, .seed = seed };
    lc_status st = find_patches(&m);
    if (!st && m.n) st = find_points(&m, max_depth);
    if (!st && m.view.n) st = score_first(&m);
    if (!st && m.view.n) st = divide_by_steps(&m);
    if (!st) st = add_lights(&m);
    lc_free(scene->ctx, m.places, m.n_points, sizeof *m.places);
    lc_free(scene->ctx, m.total, m.n_points, sizeof *m.total);
    lc_view_grid_free(&m.view);
    lc_free(scene->ctx, m.patches, m.cap, sizeof *m.patches);
    return st;
}
