/* render.c - lc_render: pre-pass for the dark floor, then tiles over threads.
 *
 * Every pixel depends on scene, descriptor and its own coordinates only. Sample positions and representative
 * slots come from (seed, pixel, sample, dimension); the pre-pass looks at a fixed grid over the whole film
 * whatever the crop.
 */
#include "render/render.h"

#include "base/pool.h"
#include "base/sample.h"
#include "cut/exact.h"
#include "render/film.h"
#include "render/render_tile.h"
#include "scene/instance.h"
#include "scene/sight.h"
#include "scene/sun.h"
#include "shade/point_init.h"

#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#define TILE LC_TILE         /* pixels a side */
#define BLOCK 4              /* pixels a side that share out the slots of representatives */
#define PREPASS_SIDE LC_SIZE(32, 8) /* grid of the pre-pass */
#define PREPASS_RATIO 0.1f   /* its error ratio and cut limit: its mean is wanted to a few percent */
#define PREPASS_MAX_CUT 128

/* Few lights: every one of them is evaluated where that is expected to take no longer than cuts. Cost in
 * nanoseconds, with AVX-512 on Zen 4, 2026-11; the same everywhere, as the picture depends on the choice. A
 * ray costs RAY_COST for each doubling of the triangles. Fitted to the quotient of both methods' times on
 * cornell, stairs, room, cube, grid and bulbs with 100 to 1000 lights: within 17 % of it; they cross between
 * 170 and 450 lights. What lobes add was measured on the student report's scenes with and without them: cuts
 * of 20 to 60 clusters of 100 lights cost 500 to 1000 ns more a point, all lights 300. */
#define ALWAYS_FEW 16       /* lights: not even asked */
#define NEVER_FEW 4096
#define CHOICE_SIDE LC_SIZE(16, 6) /* grid of the points that are tried */
#define LIGHT_COST 4.2      /* an estimate of the exact method */
#define SPLIT_COST 23.0     /* two bounds, an estimate, two clusters placed */
#define CUT_COST 200.0      /* a cut, whatever its size */
#define PROOF_COST 63.0     /* a triangle that a proof looks at, and what else the hidden cost */
#define LOBE_LIGHT_COST 3.0 /* more of each where the material has a lobe */
#define LOBE_SPLIT_COST 7.0
#define LOBE_CUT_COST 400.0
#define RAY_COST 2.3
#define CUT_RAY_SHARE 1.55  /* of rays of cuts, which go in smaller groups */
#define EXACT_GAIN 1.1      /* what the exact method may cost more, as it has no error */

enum { DIM_FILM, DIM_LENS, DIM_SLOT };

/* Cuts of a block's points begin with the cut that was made for its middle, sample 0: what they are all alike
 * in need not be found again, and what is left to do is done in large groups. Only on surfaces like that one:
 * elsewhere its cut is of no use. Against the roots (2026-11; stairs, room, cornell at half size, one
 * thread): 0.73, 0.75, 0.75 of the time, cuts 1.03, 1.04, 1.01 times as large, mrse 0.95; that was with a
 * corner's cut, the middle's takes another 0.05 off. Blocks of 8 pixels are as fast, of 2 0.2 slower;
 * clusters of at least 1.5 times the limit only, 0.05. */
typedef struct {
    uint32_t x, y;  /* the pixel that makes it */
    bool made, lit; /* lit: the rest means something */
    lc_f3 pos, n;
    float reach2;
    lc_cut_start start;
} guide;

#define GUIDE_AT 1 /* of BLOCK, each way: the pixel that makes a block's guide */
#define GUIDE_REACH 0.05f /* of the distance that light has come */
#define GUIDE_COS 0.8f    /* between normals */

typedef struct {
    lc_cut cut;
    lc_stats stats;
    guide guide;
    uint64_t *cut_hist; /* points by cut size, 0 .. cut.max_size */
    uint64_t cut_max;   /* of the tile */
    uint64_t asked;     /* work that was done when go_on was last called */
    float *tile; /* its pixels for tile_load and tile_done, plane by plane; NULL: nobody asks for them */
} worker;

typedef struct {
    lc_context *ctx;
    const lc_scene *scene;
    const lc_render_desc *desc;
    lc_film film;
    uint32_t spp, max_depth, tiles_x, tiles_y;
    worker *workers;
    lc_mutex *mutex;         /* of the progress callback */
    atomic_uint_fast64_t done, loaded;  /* pixels; loaded: of done, those given by tile_load */
    atomic_uint_fast64_t next_call;     /* of progress, in nanoseconds of lc_now */
    atomic_uint_fast64_t loaded_max;    /* largest cut of loaded tiles */
    uint64_t total;          /* pixels */
    uint32_t n_planes;
    atomic_bool cancelled;
    double *prepass; /* luminance by grid cell */
    bool exact;      /* every light at every point */
    double pixel;    /* textures are filtered over: a length at distance 1 */
    uint32_t lens_order; /* 2^k - 1 below spp: points of the lens are taken in another order than those of the
                            film */
} job;

#define ASK_STEP 1000 /* rays and lights between looks at the clock: 10 us and more */
/* Nanoseconds between calls of progress: what a user sees, and how soon a signal is heard. */
#define CALL_STEP 20000000u

/* False once the render is cancelled. Calls progress when it is time and no other thread does. */
static bool go_on(void *user)
{
    job *j = user;
    if (atomic_load_explicit(&j->cancelled, memory_order_relaxed)) return false;
    if (!j->desc->progress || !j->mutex) return true;
    uint64_t now = (uint64_t)(lc_now() * 1e9);
    if (now < atomic_load_explicit(&j->next_call, memory_order_relaxed) || !lc_mutex_try(j->mutex))
        return true;
    if (now >= atomic_load_explicit(&j->next_call, memory_order_relaxed)) {
        uint64_t done = atomic_load_explicit(&j->done, memory_order_relaxed);
        /* done == total only once, by the end of render_all */
        if (done < j->total && j->desc->progress(j->desc->progress_user, done, j->total))
            atomic_store(&j->cancelled, true);
        atomic_store_explicit(&j->next_call, (uint64_t)(lc_now() * 1e9) + CALL_STEP, memory_order_relaxed);
    }
    lc_mutex_unlock(j->mutex);
    return !atomic_load_explicit(&j->cancelled, memory_order_relaxed);
}

static void widen_lobe(lc_material *m)
{
    m->exponent = fminf(m->exponent, LC_VIRTUAL_EXPONENT);
    for (int k = 0; k < 2; k++) m->roughness[k] = fmaxf(m->roughness[k], LC_VIRTUAL_ROUGHNESS);
}

static void init_point(const lc_scene *scene, const lc_lit *lit, lc_point *p)
{
    const lc_surface *s = &lit->surface;
    lc_material m = s->material;
    if (scene->indirect.n_lights) widen_lobe(&m);
    lc_point_init(p, s->pos, s->n, lit->view, &m, scene->min_d2);
    /* what is behind n sheds nothing anyhow */
    if (memcmp(&s->n, &s->ng, sizeof s->n)) lc_f3_store(p->ng, s->ng);
}

static uint64_t key(const job *j, uint64_t pixel, uint64_t sample, uint64_t dimension)
{
    return lc_hash4(j->desc->seed, pixel, sample, dimension);
}

static uint64_t pixel_of(const job *j, uint32_t x, uint32_t y)
{
    return (uint64_t)y * j->scene->film.width + x;
}

/* A permutation of 0 .. 15 for each key: rounds of what can be undone, addition, an odd factor, a shifted
 * xor. */
static uint32_t permute16(uint32_t k, uint64_t key)
{
    for (int round = 0; round < 4; round++, key >>= 8) {
        k = (k + (uint32_t)key) * ((uint32_t)(key >> 3) | 1) & 15;
        k ^= k >> 2;
    }
    return k;
}

/* Picks a pixel's slot of representatives. The pixels of a block have 16 numbers in an order of its own, so
 * with at most as many slots all are in it equally often, and the block's mean is better than that of any 16
 * choices; samples of a pixel go on from its number. Against independent choices, both with slots as
 * tree_fill.c fills them (16 slots, half size, 2026-11; stairs, room, cornell): error of the means of 4 x 4
 * pixels in penumbrae 0.70, 0.71, 0.92 times, of pixels the same. */
static uint64_t slot_hash(const job *j, uint32_t x, uint32_t y, uint32_t i)
{
    if (j->scene->tree->n_reps == 1) return 0;
    uint64_t h = key(j, pixel_of(j, x - x % BLOCK, y - y % BLOCK), 0, DIM_SLOT);
    return h >> 32 << 4 | ((permute16(y % BLOCK * BLOCK + x % BLOCK, h) + 5 * i) & 15);
}

static bool guides(const guide *g, const lc_surface *s)
{
    lc_f3 way = lc_f3_sub(s->pos, g->pos);
    return g->lit && lc_f3_dot(s->n, g->n) > GUIDE_COS && lc_f3_dot(way, way) <= g->reach2;
}

static void set_guide(guide *g, const lc_surface *s)
{
    g->lit = true;
    g->pos = s->pos;
    g->n = s->n;
    g->reach2 = GUIDE_REACH * GUIDE_REACH * s->t * s->t;
}

/* A cut that makes a guide, or is guided by one that is made; or neither, where g is NULL. */
static void cut_shade(lc_cut *c, guide *g, const lc_point *p, const lc_surface *s, uint64_t hash,
                      lc_stats *stats, lc_cut_result *out)
{
    c->start_out = g && !g->made ? &g->start : NULL;
    c->start = g && g->made && guides(g, s) ? &g->start : NULL;
    if (c->start_out) set_guide(g, s);
    lc_cut_shade(c, p, s->ray_org, hash, stats, out);
}

/* Radiance of one lit surface, as it leaves it. */
static void shade_lit(const job *j, worker *w, const lc_lit *lit, guide *g, uint64_t hash, lc_cut_result *out)
{
    const lc_surface *s = &lit->surface;
    lc_point p;
    init_point(j->scene, lit, &p);
    w->stats.glossy += p.lobe != LC_LOBE_NONE;
    if (j->exact) {
        lc_exact_shade(j->scene->tree, &j->scene->visibility, &p, s->ray_org, &w->stats, out);
    } else {
        cut_shade(&w->cut, g, &p, s, hash, &w->stats, out);
        w->cut_hist[out->size]++;
    }
    if (out->size > w->cut_max) w->cut_max = out->size;
}

/* Radiance of all that is seen, as it reaches the camera; fills what the statistics and planes want. The
 * first surface makes the guide where that is not made yet. */
static void shade(const job *j, worker *w, const lc_sight *sight, guide *g, uint64_t hash, lc_cut_result *sum)
{
    *sum = (lc_cut_result){ .size = 0 };
    for (uint32_t i = 0; i < sight->n_lit; i++) {
        lc_cut_result r;
        shade_lit(j, w, &sight->lit[i], g, hash + i, &r);
        if (g) g->made = true;
        sum->radiance = lc_f3_add(sum->radiance, lc_f3_mul(r.radiance, sight->lit[i].weight));
        sum->size += r.size;
        sum->rays += r.rays;
        sum->max_error = r.max_error > sum->max_error ? r.max_error : sum->max_error;
    }
}

static void add_sample(const job *j, lc_pixel *px, const lc_sight *sight, lc_f3 dir, float weight,
                       const lc_cut_result *r)
{
    const lc_surface *s = &sight->first;
    const double *axis = j->scene->camera.axis;
    float cos_axis = (float)(axis[0] * (double)dir.x + axis[1] * (double)dir.y + axis[2] * (double)dir.z);
    px->rgb = lc_f3_add(px->rgb, lc_f3_scale(lc_f3_add(r->radiance, sight->emission), weight));
    px->n = lc_f3_add(px->n, s->n);
    px->p = lc_f3_add(px->p, s->pos);
    px->albedo = lc_f3_add(px->albedo, lc_f3_add(s->material.kd, s->material.ks));
    px->z += s->t * cos_axis;
    px->cut += (float)r->size;
    px->rays += (float)r->rays;
    px->error += r->max_error;
    px->hits++;
}

/* Camera ray of sample i of a pixel; returns its weight. One sample is of the pixel's centre and the lens's.
 */
static float sample_ray(const job *j, uint32_t x, uint32_t y, uint32_t i, lc_f3 *org, lc_f3 *dir)
{
    uint64_t pixel = pixel_of(j, x, y);
    double u[2], offset[2] = { 0, 0 }, lens[2] = { 0.5, 0.5 }, weight = 1;
    if (j->spp > 1) {
        lc_sample_pair(key(j, pixel, 0, DIM_FILM), i, u);
        weight = lc_pixel_filter_sample(&j->scene->filter, u, offset);
        uint64_t h = key(j, pixel, 0, DIM_LENS);
        lc_sample_pair(h, i ^ (uint32_t)(lc_mix(h) & j->lens_order), lens);
    }
    lc_camera_ray(&j->scene->camera, x + 0.5 + offset[0], y + 0.5 + offset[1], lens, org, dir);
    return (float)weight;
}

/* Makes a guide apart, where its pixel is not of this tile or not the first to be asked for. */
static void make_guide(const job *j, lc_cut *c, guide *g)
{
    lc_f3 org, dir;
    lc_sight s;
    lc_point p;
    lc_stats stats = { 0 };
    lc_cut_result r;
    (void)sample_ray(j, g->x, g->y, 0, &org, &dir);
    if (lc_sight_trace(j->scene, org, dir, j->pixel, j->max_depth, &s) && s.n_lit) {
        init_point(j->scene, &s.lit[0], &p);
        cut_shade(c, g, &p, &s.lit[0].surface, slot_hash(j, g->x, g->y, 0), &stats, &r);
    }
    g->made = true;
}

static uint32_t guide_pixel(uint32_t at) { return at - at % BLOCK + GUIDE_AT; }

/* Makes g the guide of a pixel; sample 0 of the pixel that makes it does so itself, whatever was made before.
 */
static guide *guide_of(const job *j, lc_cut *c, guide *g, uint32_t x, uint32_t y, uint32_t sample)
{
    const uint32_t at_x = guide_pixel(x), at_y = guide_pixel(y);
    const bool makes = x == at_x && y == at_y && !sample;
    if (!g->made || g->x != at_x || g->y != at_y || makes) {
        g->x = at_x;
        g->y = at_y;
        g->made = g->lit = false;
    }
    if (!g->made && !makes) make_guide(j, c, g);
    return g;
}

/* Reading the clock for every sample would cost some percent where a pixel takes half a microsecond. */
static bool time_to_ask(worker *w)
{
    uint64_t work = w->stats.camera_rays + w->stats.shadow_rays + w->stats.cut_sum;
    if (work - w->asked < ASK_STEP) return false;
    w->asked = work;
    return true;
}

/* False: cancelled, nothing stored. */
static bool render_pixel(job *j, worker *w, uint32_t x, uint32_t y)
{
    lc_pixel px = { .hits = 0 };
    for (uint32_t i = 0; i < j->spp; i++) {
        if (time_to_ask(w) && !go_on(j)) return false;
        lc_f3 org, dir;
        lc_sight s;
        lc_cut_result r;
        lc_phase_start(&w->stats);
        float weight = sample_ray(j, x, y, i, &org, &dir);
        px.weight += weight;
        w->stats.camera_rays++;
        lc_phase_end(&w->stats, LC_PHASE_OTHER);
        bool hit = lc_sight_trace(j->scene, org, dir, j->pixel, j->max_depth, &s);
        lc_phase_end(&w->stats, LC_PHASE_CAMERA);
        if (!hit) {
            px.rgb = lc_f3_add(px.rgb, lc_f3_scale(lc_background(j->scene, dir), weight));
            continue;
        }
        w->stats.camera_rays += s.n_rays;
        shade(j, w, &s, j->exact ? NULL : guide_of(j, &w->cut, &w->guide, x, y, i), slot_hash(j, x, y, i),
              &r);
        add_sample(j, &px, &s, dir, weight, &r);
        lc_phase_end(&w->stats, LC_PHASE_OTHER);
    }
    /* The exact method may have stopped halfway. */
    if (atomic_load_explicit(&j->cancelled, memory_order_relaxed)) return false;
    if (!lc_film_store(&j->film, x, y, &px)) w->stats.nonfinite++;
    return true;
}

static uint32_t min_u(uint32_t a, uint32_t b) { return a < b ? a : b; }

/* Takes the tile from who has it already. */
static bool load_tile(job *j, worker *w, lc_tile *t)
{
    if (!j->desc->tile_load || !j->desc->tile_load(j->desc->tile_user, t)) return false;
    lc_film_set_tile(&j->film, t);
    lc_tile_add_counts(&w->stats, &t->counts);
    atomic_fetch_add(&j->loaded, (uint64_t)(t->x1 - t->x0) * (t->y1 - t->y0));
    uint64_t old = atomic_load(&j->loaded_max);
    while (t->counts.cut_max > old &&
           !atomic_compare_exchange_weak(&j->loaded_max, &old, t->counts.cut_max)) {}
    return true;
}

/* What is in the tile of the block that begins at, or the tile has from, a pixel on; first the one that makes
 * the block's guide. */
static bool render_block(job *j, worker *w, const lc_tile *t, uint32_t x0, uint32_t y0)
{
    const uint32_t x1 = min_u(x0 + BLOCK - x0 % BLOCK, t->x1), y1 = min_u(y0 + BLOCK - y0 % BLOCK, t->y1);
    const uint32_t at_x = guide_pixel(x0), at_y = guide_pixel(y0);
    const bool makes = at_x >= x0 && at_x < x1 && at_y >= y0 && at_y < y1;
    if (makes && !render_pixel(j, w, at_x, at_y)) return false;
    for (uint32_t y = y0; y < y1; y++)
        for (uint32_t x = x0; x < x1; x++)
            if (!(makes && x == at_x && y == at_y) && !render_pixel(j, w, x, y)) return false;
    atomic_fetch_add_explicit(&j->done, (uint64_t)(x1 - x0) * (y1 - y0), memory_order_relaxed);
    return true;
}

static void render_tile(void *user, uint32_t thread, uint64_t item)
{
    job *j = user;
    worker *w = &j->workers[thread];
    const uint32_t *c = j->film.crop;
    if (!go_on(j)) return;
    uint32_t x0 = c[0] + (uint32_t)(item % j->tiles_x) * TILE,
             y0 = c[2] + (uint32_t)(item / j->tiles_x) * TILE;
    lc_tile t = { .index = (uint32_t)item,
                  .x0 = x0,
                  .x1 = min_u(x0 + TILE, c[1]),
                  .y0 = y0,
                  .y1 = min_u(y0 + TILE, c[3]),
                  .n_planes = j->n_planes,
                  .pixels = w->tile };
    uint64_t width = t.x1 - x0;
    if (load_tile(j, w, &t)) {
        atomic_fetch_add(&j->done, width * (t.y1 - y0));
        return;
    }
    lc_stats before = w->stats;
    w->cut_max = 0;
    for (uint32_t y = y0; y < t.y1; y += BLOCK - y % BLOCK)
        for (uint32_t x = x0; x < t.x1; x += BLOCK - x % BLOCK)
            if (!render_block(j, w, &t, x, y)) return;
    if (!j->desc->tile_done) return;
    lc_film_get_tile(&j->film, &t);
    lc_tile_counts_between(&before, &w->stats, w->cut_max, &t.counts);
    j->desc->tile_done(j->desc->tile_user, &t);
}

/* Radiance seen at a cell of a grid of side * side over the whole film; false: nothing there that is lit. */
static bool shade_cell(job *j, uint32_t thread, uint64_t item, uint32_t side, lc_cut_result *r)
{
    lc_f3 org, dir;
    lc_sight s;
    double u = ((double)(item % side) + 0.5) / side, v = ((double)(item / side) + 0.5) / side;
    const double lens[2] = { 0.5, 0.5 };
    lc_camera_ray(&j->scene->camera, u * j->scene->film.width, v * j->scene->film.height, lens, &org, &dir);
    if (!go_on(j) || !lc_sight_trace(j->scene, org, dir, j->pixel, j->max_depth, &s) || !s.n_lit)
        return false;
    shade(j, &j->workers[thread], &s, NULL, key(j, item, 0, DIM_SLOT), r);
    return true;
}

static void prepass_cell(void *user, uint32_t thread, uint64_t item)
{
    job *j = user;
    lc_cut_result r;
    if (shade_cell(j, thread, item, PREPASS_SIDE, &r)) j->prepass[item] = (double)lc_luminance(r.radiance);
}

static void choice_cell(void *user, uint32_t thread, uint64_t item)
{
    lc_cut_result r;
    shade_cell(user, thread, item, CHOICE_SIDE, &r);
}

static void free_workers(job *j)
{
    for (uint32_t i = 0; i < j->ctx->n_threads && j->workers; i++) {
        if (!j->workers[i].cut.ctx) continue;
        lc_free(j->ctx, j->workers[i].tile, (size_t)LC_N_PLANES * TILE * TILE, sizeof(float));
        lc_free(j->ctx, j->workers[i].cut_hist, (size_t)j->workers[i].cut.max_size + 2, sizeof(uint64_t));
        lc_cut_free(&j->workers[i].cut);
    }
    lc_free(j->ctx, j->workers, j->ctx->n_threads, sizeof *j->workers);
    j->workers = NULL;
}

static lc_status make_workers(job *j, const lc_cut_desc *desc)
{
    j->workers = lc_alloc(j->ctx, j->ctx->n_threads, sizeof *j->workers);
    if (!j->workers) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < j->ctx->n_threads; i++) {
        worker *w = &j->workers[i];
        lc_status st = lc_cut_init(&w->cut, j->ctx, j->scene->tree, &j->scene->visibility, desc, false);
        if (st) return st;
        w->cut_hist = lc_alloc(j->ctx, (size_t)w->cut.max_size + 2, sizeof *w->cut_hist);
        if (!w->cut_hist) return LC_ERR_MEMORY;
        w->stats.go_on = go_on;
        w->stats.go_on_user = j;
        bool tiles = j->desc->tile_load || j->desc->tile_done;
        if (tiles && !(w->tile = lc_alloc(j->ctx, (size_t)LC_N_PLANES * TILE * TILE, sizeof(float))))
            return LC_ERR_MEMORY;
    }
    return LC_OK;
}

/* Mean luminance over the grid, cells added in order. */
static lc_status prepass(job *j, double *mean)
{
    const size_t n = PREPASS_SIDE * PREPASS_SIDE;
    lc_cut_desc desc = { PREPASS_RATIO, PREPASS_MAX_CUT, 0 };
    j->prepass = lc_alloc(j->ctx, n, sizeof *j->prepass);
    lc_status st = j->prepass ? make_workers(j, &desc) : LC_ERR_MEMORY;
    *mean = 0;
    if (!st) {
        lc_parallel(j->ctx, n, prepass_cell, j);
        for (size_t i = 0; i < n; i++) *mean += isfinite(j->prepass[i]) ? j->prepass[i] / (double)n : 0;
    }
    lc_free(j->ctx, j->prepass, n, sizeof *j->prepass);
    free_workers(j);
    return st;
}

/* Counts of both methods over a grid: shading points, shadow rays, bounds. */
static lc_status try_method(job *j, const lc_cut_desc *cut, bool exact, lc_stats *sum)
{
    bool was = j->exact;
    lc_status st = make_workers(j, cut);
    j->exact = exact;
    if (!st) lc_parallel(j->ctx, CHOICE_SIDE * CHOICE_SIDE, choice_cell, j);
    for (uint32_t i = 0; i < j->ctx->n_threads && !st; i++) {
        sum->points += j->workers[i].stats.points;
        sum->glossy += j->workers[i].stats.glossy;
        sum->shadow_rays += j->workers[i].stats.shadow_rays;
        sum->bounds += j->workers[i].stats.bounds;
        sum->proof_tests += j->workers[i].stats.proof_tests;
    }
    j->exact = was;
    free_workers(j);
    return st;
}

/* Bits of n less a half: a logarithm that is the same everywhere. */
static double doublings(uint64_t n)
{
    double bits = -0.5;
    for (; n; n >>= 1) bits++;
    return bits;
}

/* Is the exact method expected to be no slower than these cuts? Never where it would go past max_cut. */
static lc_status exact_pays(job *j, const lc_cut_desc *cut, bool *pays)
{
    lc_stats cuts = { 0 }, all = { 0 };
    double n = j->scene->tree->n_lights,
           ray = RAY_COST * doublings(j->scene->n_tris + lc_instanced_tris(j->scene));
    *pays = false;
    if ((cut->max_cut && cut->max_cut < n) || n > NEVER_FEW) return LC_OK;
    *pays = n <= ALWAYS_FEW;
    if (*pays) return LC_OK;
    lc_status st = try_method(j, cut, false, &cuts);
    if (!st) st = try_method(j, cut, true, &all);
    if (st) return st;
    double points = (double)all.points, lobes = points > 0 ? (double)all.glossy / points : 0;
    double exact = points * n * (LIGHT_COST + lobes * LOBE_LIGHT_COST) + (double)all.shadow_rays * ray;
    double by_cuts = points * (CUT_COST + lobes * LOBE_CUT_COST) +
                     (double)cuts.bounds / 2 * (SPLIT_COST + lobes * LOBE_SPLIT_COST) +
                     (double)cuts.shadow_rays * CUT_RAY_SHARE * ray + (double)cuts.proof_tests * PROOF_COST;
    *pays = exact <= EXACT_GAIN * by_cuts;
    return LC_OK;
}

static uint32_t percentile(const uint64_t *hist, uint32_t limit, uint64_t total, double share)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i <= limit; i++)
        if ((sum += hist[i]) && (double)sum >= share * (double)total) return i;
    return 0;
}

static void cut_stats(const job *j, lc_render_stats *out)
{
    uint64_t *hist = j->workers[0].cut_hist;
    uint32_t limit = j->workers[0].cut.max_size;
    uint64_t points = 0; /* but for loaded tiles */
    if (j->exact) {
        out->cut_median = out->cut_p99 = out->cut_max = out->points ? j->scene->tree->n_lights : 0;
        return;
    }
    for (uint32_t t = 1; t < j->ctx->n_threads; t++)
        for (uint32_t i = 0; i <= limit; i++) hist[i] += j->workers[t].cut_hist[i];
    for (uint32_t i = 0; i <= limit; i++) points += hist[i];
    out->cut_median = percentile(hist, limit, points, 0.5);
    out->cut_p99 = percentile(hist, limit, points, 0.99);
    out->cut_max = (uint32_t)atomic_load(&j->loaded_max);
    for (uint32_t i = 0; i <= limit; i++)
        if (hist[i] && i > out->cut_max) out->cut_max = i;
}

/* Shares of the timed samples, of all threads' seconds. */
static void phase_stats(const job *j, lc_render_stats *out)
{
    double ticks[LC_PHASES] = { 0 }, sum = 0;
    for (uint32_t t = 0; t < j->ctx->n_threads; t++)
        for (int k = 0; k < LC_PHASES; k++) ticks[k] += (double)j->workers[t].stats.ticks[k];
    for (int k = 0; k < LC_PHASES; k++) sum += ticks[k];
    double scale = sum > 0 ? out->seconds * j->ctx->n_threads / sum : 0;
    out->phase_camera = ticks[LC_PHASE_CAMERA] * scale;
    out->phase_bounds = ticks[LC_PHASE_BOUNDS] * scale;
    out->phase_estimates = ticks[LC_PHASE_ESTIMATES] * scale;
    out->phase_heap = ticks[LC_PHASE_HEAP] * scale;
    out->phase_shadow_rays = ticks[LC_PHASE_SHADOW] * scale;
    out->phase_other = ticks[LC_PHASE_OTHER] * scale;
}

static void join_stats(const job *j, lc_render_stats *out)
{
    uint64_t cut_sum = 0;
    for (uint32_t t = 0; t < j->ctx->n_threads; t++) {
        const lc_stats *s = &j->workers[t].stats;
        out->points += s->points;
        out->shadow_rays += s->shadow_rays;
        out->bounds_evaluated += s->bounds;
        out->camera_rays += s->camera_rays;
        out->cut_at_limit += s->at_limit;
        out->points_dark += s->dark;
        out->nonfinite += s->nonfinite;
        cut_sum += s->cut_sum;
    }
    out->cut_mean = out->points ? (double)cut_sum / (double)out->points : 0;
    cut_stats(j, out);
    phase_stats(j, out);
}

/* What the lights and their tree were made with: numbers that were asked for, or the defaults in their place.
 */
static lc_status set_load_attributes(lc_image *im, const lc_scene *scene)
{
    static const char *const builder[] = { "auto", "exact", "ploc" };
    const lc_load_desc *l = &scene->load;
    uint32_t by_scene = scene->traces_paths ? LC_DEFAULT_INDIRECT : 0;
    uint32_t indirect = l->indirect_lights == LC_NO_LIGHTS ? 0
                        : l->indirect_lights               ? l->indirect_lights
                                                           : by_scene;
    lc_status st = lc_image_set_text(im, "lightcuts/builder", builder[l->builder]);
    if (!st) st = lc_image_set_number(im, "lightcuts/areaLights", l->area_lights);
    if (!st) st = lc_image_set_number(im, "lightcuts/envLights", l->env_lights);
    if (!st) st = lc_image_set_number(im, "lightcuts/indirectLights", indirect);
    return st;
}

/* The options that shape the picture, so that a file says how it was made; the manual page lists them. */
static lc_status set_attributes(const job *j)
{
    static const char *const method[] = { "lightcuts", "exact", "cuts" };
    lc_image *im = j->film.image;
    const lc_render_desc *d = j->desc;
    char seed[32];
    snprintf(seed, sizeof seed, "%llu", (unsigned long long)d->seed);
    lc_status st = lc_image_set_text(im, "software", "lightcuts " LC_VERSION);
    if (!st) st = lc_image_set_matrix(im, "worldToCamera", j->scene->camera.world_to_camera);
    if (!st) st = lc_image_set_number(im, "samplesPerPixel", j->spp);
    if (!st) st = lc_image_set_text(im, "lightcuts/method", method[d->method]);
    if (!st) st = lc_image_set_text(im, "lightcuts/seed", seed);
    if (!st) st = lc_image_set_number(im, "lightcuts/maxDepth", j->max_depth);
    if (!st) st = set_load_attributes(im, j->scene);
    if (st || d->method == LC_METHOD_EXACT) return st;
    st = lc_image_set_number(im, "lightcuts/errorRatio", (double)d->error_ratio);
    if (!st) st = lc_image_set_number(im, "lightcuts/maxCut", d->max_cut);
    if (!st) st = lc_image_set_number(im, "lightcuts/darkFloor", (double)d->dark_floor);
    if (!st) st = lc_image_set_number(im, "lightcuts/representatives", j->scene->tree->n_reps);
    return st;
}

static lc_status check_desc(const lc_context *ctx, const lc_scene *scene, const lc_render_desc *d,
                            uint32_t crop[4])
{
    const lc_film_desc *f = &scene->film;
    if (d->size != sizeof *d || d->method < LC_METHOD_LIGHTCUTS || d->method > LC_METHOD_CUTS)
        return LC_ERR_ARG;
    if (!(d->error_ratio >= 0) || !isfinite(d->error_ratio) || !(d->dark_floor >= 0) ||
        !isfinite(d->dark_floor))
        return lc_fail(ctx, LC_ERR_ARG, "error ratio and dark floor must be finite and at least 0");
    if (d->spp > LC_MAX_SPP) return lc_fail(ctx, LC_ERR_ARG, "more than %u samples per pixel", LC_MAX_SPP);
    bool scene_crop = !d->crop[0] && !d->crop[1] && !d->crop[2] && !d->crop[3];
    for (int i = 0; i < 4; i++) {
        if (d->crop[i] < 0)
            return lc_fail(ctx, LC_ERR_ARG, "crop is outside the film of %u x %u", f->width, f->height);
        crop[i] = scene_crop ? f->crop[i] : (uint32_t)d->crop[i];
    }
    if (crop[0] >= crop[1] || crop[2] >= crop[3] || crop[1] > f->width || crop[3] > f->height)
        return lc_fail(ctx, LC_ERR_ARG, "crop is empty or outside the film of %u x %u", f->width, f->height);
    return LC_OK;
}

static lc_cut_desc cut_desc(const job *j, const lc_render_stats *stats)
{
    return (lc_cut_desc){ j->desc->error_ratio, j->desc->max_cut,
                          j->desc->dark_floor * (float)stats->mean_luminance };
}

/* Whether cuts are made at all, and the mean luminance for their dark floor. */
static lc_status choose_method(job *j, lc_render_stats *stats)
{
    lc_status st = LC_OK;
    uint32_t n = j->scene->tree->n_lights, max_cut = j->desc->max_cut;
    stats->exact = j->exact = j->desc->method == LC_METHOD_EXACT;
    if (j->exact) return LC_OK;
    bool few = j->desc->method == LC_METHOD_LIGHTCUTS && n <= ALWAYS_FEW && !(max_cut && max_cut < n);
    if (!few && j->desc->dark_floor > 0 && j->desc->error_ratio > 0) st = prepass(j, &stats->mean_luminance);
    lc_cut_desc cut = cut_desc(j, stats);
    if (!st && j->desc->method == LC_METHOD_LIGHTCUTS) st = exact_pays(j, &cut, &j->exact);
    stats->exact = j->exact;
    return st;
}

static lc_status render_all(job *j, const uint32_t crop[4], lc_render_stats *stats)
{
    const lc_film_desc *f = &j->scene->film;
    double t0 = lc_now();
    lc_status st = choose_method(j, stats);
    if (!st && atomic_load(&j->cancelled)) st = LC_ERR_CANCELLED;
    if (st) return st;
    lc_cut_desc cut = cut_desc(j, stats);
    if (j->exact) cut.max_cut = 1; /* no cuts are made */
    st = make_workers(j, &cut);
    if (!st) st = lc_film_init(&j->film, j->ctx, crop, f, j->desc->aovs);
    if (st) return st;
    j->tiles_x = (crop[1] - crop[0] + TILE - 1) / TILE;
    j->tiles_y = (crop[3] - crop[2] + TILE - 1) / TILE;
    j->n_planes = lc_image_n_channels(j->film.image);
    lc_parallel(j->ctx, (uint64_t)j->tiles_x * j->tiles_y, render_tile, j);
    if (atomic_load(&j->cancelled)) return LC_ERR_CANCELLED;
    if (j->desc->progress && j->desc->progress(j->desc->progress_user, j->total, j->total))
        return LC_ERR_CANCELLED;
    stats->seconds = lc_now() - t0;
    stats->pixels = j->total;
    stats->pixels_loaded = atomic_load(&j->loaded);
    join_stats(j, stats);
    return set_attributes(j);
}

static void init_job(job *j, lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc)
{
    *j = (job){ .ctx = ctx, .scene = scene, .desc = desc, .spp = desc->spp ? desc->spp : scene->film.spp };
    j->max_depth = min_u(desc->max_depth ? desc->max_depth : scene->max_depth, LC_MAX_DEPTH);
    /* samples share a pixel; as in pbrt, one sees no less than an eighth of it */
    while (j->lens_order * 2 + 1 < j->spp) j->lens_order = j->lens_order * 2 + 1;
    j->pixel = scene->camera.pixel * fmax(0.125, 1 / sqrt((double)j->spp));
}

lc_status lc_render(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc, lc_image **out,
                    lc_render_stats *stats)
{
    lc_render_stats own;
    uint32_t crop[4];
    if (!out) return LC_ERR_ARG;
    *out = NULL;
    if (!ctx || !scene || !desc) return LC_ERR_ARG;
    lc_status st = check_desc(ctx, scene, desc, crop);
    if (st) return st;
    if (!stats) stats = &own;
    *stats = (lc_render_stats){ 0 };
    job j;
    init_job(&j, ctx, scene, desc);
    j.total = (uint64_t)(crop[1] - crop[0]) * (crop[3] - crop[2]);
    j.mutex = lc_mutex_create(ctx);
    st = j.mutex ? render_all(&j, crop, stats) : LC_ERR_MEMORY;
    lc_mutex_destroy(ctx, j.mutex);
    free_workers(&j);
    if (st) lc_image_destroy(j.film.image);
    else *out = j.film.image;
    return st;
}

lc_status lc_render_crop(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc, uint32_t crop[4])
{
    if (!ctx || !scene || !desc || !crop) return LC_ERR_ARG;
    return check_desc(ctx, scene, desc, crop);
}

/* What cuts of the picture are made by; where it makes none, by those of LC_METHOD_CUTS. */
static lc_status probe_desc(job *j, lc_probe *p, lc_cut_desc *cut)
{
    const lc_render_desc *desc = j->desc;
    lc_render_desc cuts = *desc;
    lc_render_stats stats = { 0 };
    lc_status st = choose_method(j, &stats);
    p->all_lights = j->exact;
    if (!st && j->exact) {
        cuts.method = LC_METHOD_CUTS;
        j->desc = &cuts;
        st = choose_method(j, &stats);
        j->desc = desc;
    }
    *cut = cut_desc(j, &stats);
    p->mean_luminance = stats.mean_luminance;
    return st;
}

/* All that is lit but the first; the cut is scratch. */
static void shade_others(const job *j, lc_probe *p, guide *g, uint64_t hash)
{
    lc_stats stats = { 0 };
    for (uint32_t i = 1; i < p->sight.n_lit; i++) {
        const lc_lit *lit = &p->sight.lit[i];
        lc_point point;
        lc_cut_result r;
        init_point(j->scene, lit, &point);
        if (p->all_lights)
            lc_exact_shade(j->scene->tree, &j->scene->visibility, &point, lit->surface.ray_org, &stats, &r);
        else cut_shade(&p->cut, g, &point, &lit->surface, hash + i, &stats, &r);
        p->others = lc_f3_add(p->others, lc_f3_mul(r.radiance, lit->weight));
    }
}

lc_status lc_render_probe(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc, uint32_t x,
                          uint32_t y, uint32_t sample, lc_probe *p)
{
    job j;
    lc_cut_desc cut;
    lc_f3 org, dir;
    uint32_t crop[4];
    lc_stats stats = { 0 };
    *p = (lc_probe){ .hit = false };
    lc_status st = check_desc(ctx, scene, desc, crop);
    if (st) return st;
    init_job(&j, ctx, scene, desc);
    if (x >= scene->film.width || y >= scene->film.height)
        return lc_fail(ctx, LC_ERR_ARG, "pixel %u,%u is outside the film of %u x %u", x, y, scene->film.width,
                       scene->film.height);
    if (sample >= j.spp)
        return lc_fail(ctx, LC_ERR_ARG, "sample %u: a pixel has %u, counted from 0", sample, j.spp);
    st = probe_desc(&j, p, &cut);
    if (!st) st = lc_cut_init(&p->cut, ctx, scene->tree, &scene->visibility, &cut, true);
    if (st) return st;
    sample_ray(&j, x, y, sample, &org, &dir);
    p->hit = lc_sight_trace(scene, org, dir, j.pixel, j.max_depth, &p->sight);
    if (!p->hit) return LC_OK;
    const lc_lit *lit = &p->sight.lit[0];
    if (!p->sight.n_lit) {
        p->sight.lit[0] =
            (lc_lit){ .surface = p->sight.first, .view = lc_f3_neg(dir), .weight = { 1, 1, 1 } };
        return LC_OK;
    }
    guide *g = lc_alloc(ctx, 1, sizeof *g);
    if (!g) return LC_ERR_MEMORY;
    uint64_t hash = slot_hash(&j, x, y, sample);
    guide_of(&j, &p->cut, g, x, y, sample);
    bool is_guide = !g->made;
    if (is_guide) make_guide(&j, &p->cut, g);
    shade_others(&j, p, g, hash);
    g->made = false;
    /* again: its splits are kept for the cut that begins with it. */
    if (!is_guide) make_guide(&j, &p->cut, g);
    init_point(scene, lit, &p->point);
    cut_shade(&p->cut, g, &p->point, &lit->surface, hash, &stats, &p->by_cut);
    lc_free(ctx, g, 1, sizeof *g);
    return LC_OK;
}

void lc_probe_free(lc_probe *p)
{
    if (p->cut.ctx) lc_cut_free(&p->cut);
}
