/* reconstruct.c - see reconstruct.h. */
#include "render/reconstruct.h"

#include "render/guide.h"
#include "render/likeness.h"
#include "render/pixel_sights.h"
#include "render/sample_keys.h"
#include "scene/sun.h"

#include <math.h>

#define MARGIN   2 /* shaded pixels around the four next to a pixel that it may depend on: by FAR, smoothed */
#define FAR      1 /* around the four that are asked where these show other surfaces */
#define MAX_KEYS 2 /* surfaces of a pixel that are looked at; others, seen in glass, are taken as they come */

/* All chosen by eye and by the error of pictures, tests/results/preview.md. */
#define LEAST_WEIGHT    0.01f /* of all four, below which a pixel is shaded */
#define LEAST_ALBEDO    0.05f /* of the pixel's, that those around must have for it to be lit by them */
#define MOST_APART      1.8f  /* of their mean: how far the most and the least of those around may differ */

/* What it reflects, times weights; and its albedo, times the same. */
typedef struct {
    lc_f3 radiance, albedo;
} light;

struct lc_coarse_point {
    uint32_t n;   /* keys */
    lc_face keys[MAX_KEYS];
    light own[MAX_KEYS], smooth[MAX_KEYS]; /* by itself; with those around it that are alike */
    lc_f3 rest;   /* what all others reflect, as it reaches the camera */
};

struct lc_coarse {
    uint32_t size, at; /* pixels a side of a block; which of them is shaded, each way */
    uint32_t last[2];  /* number of the film's last shaded pixel each way */
    uint32_t first[2], n[2]; /* those that there is room for */
    struct lc_coarse_point *points;
};

lc_status lc_coarse_check(const lc_context *ctx, const lc_scene *scene, const lc_render_desc *d)
{
    const uint32_t c = d->coarse;
    if (c <= 1) return LC_OK;
    if (c > LC_MAX_COARSE || c & (c - 1))
        return lc_fail(ctx, LC_ERR_ARG, "coarse must be 0 or a power of two up to %d", LC_MAX_COARSE);
    if (d->aovs & LC_AOV_INTERVAL)
        return lc_fail(ctx, LC_ERR_ARG, "coarse pictures prove no intervals of pixels");
    if (d->tile_load) return lc_fail(ctx, LC_ERR_ARG, "tiles of coarse pictures cannot be loaded");
    if (scene->groups.n)
        return lc_fail(ctx, LC_ERR_ARG, "coarse pictures have no planes of groups of lights");
    if (scene->sensors) return lc_fail(ctx, LC_ERR_ARG, "coarse pictures are of cameras, not of sensors");
    return LC_OK;
}

/* Shaded pixels along an axis: the last that is at or before a pixel, and where one is. */
static uint32_t before(const struct lc_coarse *c, int axis, uint32_t at)
{
    const uint32_t i = at < c->at ? 0 : (at - c->at) / c->size;
    return i < c->last[axis] ? i : c->last[axis];
}

static uint32_t place_of(const struct lc_coarse *c, uint32_t i) { return i * c->size + c->at; }

static size_t n_points(const struct lc_coarse *c) { return (size_t)c->n[0] * c->n[1]; }

lc_status lc_coarse_init(lc_render_job *j, const uint32_t crop[4])
{
    const uint32_t side[2] = { j->scene->film.width, j->scene->film.height };
    struct lc_coarse *c = j->coarse = lc_alloc(j->ctx, 1, sizeof *c);
    if (!c) return LC_ERR_MEMORY;
    c->size = j->desc->coarse;
    c->at = side[0] > 1 && side[1] > 1; /* in its block the pixel that makes the guide */
    for (int k = 0; k < 2; k++) {
        c->last[k] = (side[k] - 1 - c->at) / c->size;
        c->first[k] = before(c, k, crop[2 * k]);
        c->first[k] -= c->first[k] < MARGIN ? c->first[k] : MARGIN;
        const uint32_t end = before(c, k, crop[2 * k + 1] - 1) + 1 + MARGIN;
        c->n[k] = (end < c->last[k] ? end : c->last[k]) + 1 - c->first[k];
    }
    c->points = lc_alloc_raw(j->ctx, n_points(c), sizeof *c->points);
    return c->points ? LC_OK : LC_ERR_MEMORY;
}

void lc_coarse_free(lc_render_job *j)
{
    if (!j->coarse) return;
    lc_free(j->ctx, j->coarse->points, n_points(j->coarse), sizeof *j->coarse->points);
    lc_free(j->ctx, j->coarse, 1, sizeof *j->coarse);
    j->coarse = NULL;
}

/* ---- shaded pixels ---- */

/* Which entries of the list are keys: surfaces, not points of media. Returns how many. */
static uint32_t find_keys(const lc_sight *s, uint32_t which[MAX_KEYS])
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < s->n_lit && n < MAX_KEYS; i++)
        if (s->lit[i].surface.material.lobe != LC_LOBE_PHASE) which[n++] = i;
    return n;
}

/* Guides of blocks pay where several of their pixels are shaded. */
static lc_guide *guide_of(const lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y)
{
    if (j->exact || j->coarse->size >= LC_PIXEL_BLOCK) return NULL;
    return lc_guide_of(j, &w->cut, &w->guide, x, y, j->first, lc_guide_work(w));
}

static void shade_point(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y,
                        struct lc_coarse_point *to)
{
    lc_f3 dir;
    lc_sight s;
    uint32_t which[MAX_KEYS], k = 0;
    to->n = 0;
    to->rest = lc_f3_make(0, 0, 0);
    lc_phase_start(&w->stats);
    w->stats.camera_rays++;
    const bool hit = lc_sample_sight(j, x, y, j->first, &w->light, NULL, &dir, &s);
    lc_phase_end(&w->stats, LC_PHASE_CAMERA);
    if (hit) {
        w->stats.camera_rays += s.n_rays;
        to->n = find_keys(&s, which);
        lc_guide *g = s.n_lit ? guide_of(j, w, x, y) : NULL;
        lc_sample_keys keys = lc_sample_keys_of(j, NULL, x, y, j->first);
        keys.slot = keys.point = lc_slot_hash(j, x / j->coarse->size, y / j->coarse->size, j->first);
        for (uint32_t i = 0; i < s.n_lit; i++) {
            lc_cut_result r;
            lc_shade_lit(j, w, &s.lit[i], i, g, &keys, &r);
            if (g) g->made = true;
            if (!lc_f3_finite(r.radiance)) r.radiance = lc_f3_make(0, 0, 0);
            if (k < to->n && which[k] == i) {
                lc_face_set(&to->keys[k], &s.lit[i]);
                to->own[k] = (light){ r.radiance, to->keys[k].albedo };
                k++;
            } else {
                to->rest = lc_f3_add(to->rest, lc_f3_mul(r.radiance, s.lit[i].weight));
            }
        }
    }
    lc_phase_end(&w->stats, LC_PHASE_OTHER);
    lc_phase_stop(&w->stats);
}

/* Rows of shaded pixels in a strip: those of a row of blocks that share guides. */
static uint32_t rows_of_strip(const struct lc_coarse *c)
{
    return c->size < LC_PIXEL_BLOCK ? LC_PIXEL_BLOCK / c->size : 1;
}

/* The first strip begins where its row of blocks does. */
static uint32_t first_row(const struct lc_coarse *c) { return c->first[1] - c->first[1] % rows_of_strip(c); }

uint64_t lc_coarse_n_strips(const lc_render_job *j)
{
    const struct lc_coarse *c = j->coarse;
    const uint32_t rows = rows_of_strip(c);
    return (c->first[1] + c->n[1] - first_row(c) + rows - 1) / rows;
}

void lc_coarse_strip(void *job, uint32_t thread, uint64_t item)
{
    lc_render_job *j = job;
    lc_render_worker *w = &j->workers[thread];
    struct lc_coarse *c = j->coarse;
    const uint32_t rows = rows_of_strip(c), y0 = first_row(c) + (uint32_t)item * rows;
    const double cpu = lc_thread_cpu();
    for (uint32_t x = c->first[0]; x < c->first[0] + c->n[0]; x++)
        for (uint32_t y = y0; y < y0 + rows; y++) {
            if (y < c->first[1] || y >= c->first[1] + c->n[1]) continue;
            if (!lc_job_go_on(j)) return;
            shade_point(j, w, place_of(c, x), place_of(c, y),
                        &c->points[(size_t)(y - c->first[1]) * c->n[0] + (x - c->first[0])]);
        }
    w->stats.cpu_seconds += lc_thread_cpu() - cpu;
}

/* ---- pixels between them ---- */

static void add_light(light *sum, const light *l, float w)
{
    sum->radiance = lc_f3_add(sum->radiance, lc_f3_scale(l->radiance, w));
    sum->albedo = lc_f3_add(sum->albedo, lc_f3_scale(l->albedo, w));
}

static void smooth_point(struct lc_coarse *c, uint32_t x, uint32_t y)
{
    struct lc_coarse_point *p = &c->points[(size_t)y * c->n[0] + x];
    for (uint32_t k = 0; k < p->n; k++) {
        p->smooth[k] = (light){ 0 };
        for (uint32_t v = y ? y - 1 : 0; v <= y + 1 && v < c->n[1]; v++)
            for (uint32_t u = x ? x - 1 : 0; u <= x + 1 && u < c->n[0]; u++) {
                const struct lc_coarse_point *q = &c->points[(size_t)v * c->n[0] + u];
                if (k >= q->n) continue;
                const float w = (u == x ? 2.f : 1.f) * (v == y ? 2.f : 1.f);
                add_light(&p->smooth[k], &q->own[k], w * lc_likeness(&p->keys[k], &q->keys[k]));
            }
    }
}

void lc_coarse_smooth(void *job, uint32_t thread, uint64_t row)
{
    lc_render_job *j = job;
    (void)thread;
    for (uint32_t x = 0; x < j->coarse->n[0]; x++) smooth_point(j->coarse, x, (uint32_t)row);
}

uint64_t lc_coarse_n_rows(const lc_render_job *j) { return j->coarse->n[1]; }

/* A pixel that is to be interpolated. */
typedef struct {
    uint32_t n;
    lc_face keys[MAX_KEYS];
    lc_f3 weight[MAX_KEYS];
    float total;                             /* of the weights of those around */
    light light[MAX_KEYS]; /* sums */
    lc_f3 rest;
    float least, most;                       /* luminance by one of them alone */
} blend;

/* What a surface would reflect that is lit as another. */
static float luminance_by(const lc_face *to, const light *from)
{
    const float albedo = lc_luminance(from->albedo);
    return albedo > 0 ? lc_luminance(from->radiance) / albedo * lc_luminance(to->albedo) : -1;
}

static void add_point(blend *b, const struct lc_coarse_point *p, float w)
{
    float sum = 0;
    if (p->n != b->n || !(w > 0)) return;
    for (uint32_t k = 0; k < b->n; k++) w *= lc_likeness(&b->keys[k], &p->keys[k]);
    if (!(w > 0)) return;
    b->total += w;
    b->rest = lc_f3_add(b->rest, lc_f3_scale(p->rest, w));
    for (uint32_t k = 0; k < b->n; k++) {
        add_light(&b->light[k], &p->smooth[k], w / 16);
        const float by = luminance_by(&b->keys[k], &p->smooth[k]);
        if (by < 0) return;
        sum += by * lc_luminance(b->weight[k]);
    }
    b->least = fminf(b->least, sum);
    b->most = fmaxf(b->most, sum);
}

/* The radiance by one channel; false: those around are too dark to know. */
static bool divide(float radiance, float around, float total, float albedo, float *out)
{
    *out = 0;
    if (!(albedo > 0)) return true;
    if (!(around > LEAST_ALBEDO * albedo * total)) return false;
    *out = radiance / around * albedo;
    return true;
}

/* False: the pixel is to be shaded. */
static bool finish(const lc_render_job *j, const blend *b, lc_f3 *rgb)
{
    if (!(b->total > LEAST_WEIGHT)) return false;
    const float mean = fmaxf(0.5f * (b->least + b->most), j->floor);
    if (b->most - b->least > MOST_APART * mean) return false;
    *rgb = lc_f3_scale(b->rest, 1 / b->total);
    for (uint32_t k = 0; k < b->n; k++) {
        const lc_f3 l = b->light[k].radiance, around = b->light[k].albedo, own = b->keys[k].albedo;
        lc_f3 c;
        if (!divide(l.x, around.x, b->total, own.x, &c.x) || !divide(l.y, around.y, b->total, own.y, &c.y) ||
            !divide(l.z, around.z, b->total, own.z, &c.z))
            return false;
        *rgb = lc_f3_add(*rgb, lc_f3_mul(c, b->weight[k]));
    }
    return true;
}

/* A tent over those up to `far` beyond the four; at the film's edges what is there. */
static void add_around(const struct lc_coarse *c, blend *b, const uint32_t i[2], const float u[2],
                       uint32_t far)
{
    const float width = (float)(1 + far);
    for (uint32_t y = i[1] < far ? 0 : i[1] - far; y <= i[1] + 1 + far && y <= c->last[1]; y++)
        for (uint32_t x = i[0] < far ? 0 : i[0] - far; x <= i[0] + 1 + far && x <= c->last[0]; x++) {
            const float wx = width - fabsf((float)x - (float)i[0] - u[0]),
                        wy = width - fabsf((float)y - (float)i[1] - u[1]);
            if (wx > 0 && wy > 0)
                add_point(b, &c->points[(size_t)(y - c->first[1]) * c->n[0] + (x - c->first[0])], wx * wy);
        }
}

/* What the pixel's surfaces reflect, by the shaded pixels around it. */
static bool interpolate(const lc_render_job *j, uint32_t x, uint32_t y, const lc_sight *s, lc_f3 *rgb)
{
    const struct lc_coarse *c = j->coarse;
    const uint32_t at[2] = { x, y };
    uint32_t which[MAX_KEYS], i[2];
    float u[2];
    blend b = { .n = find_keys(s, which), .least = INFINITY, .most = 0 };
    for (uint32_t k = 0; k < b.n; k++) {
        lc_face_set(&b.keys[k], &s->lit[which[k]]);
        b.weight[k] = s->lit[which[k]].weight;
    }
    for (int k = 0; k < 2; k++) {
        i[k] = before(c, k, at[k]);
        u[k] = ((float)at[k] - (float)place_of(c, i[k])) / (float)c->size;
    }
    add_around(c, &b, i, u, 0);
    if (!(b.total > LEAST_WEIGHT)) add_around(c, &b, i, u, FAR);
    return finish(j, &b, rgb);
}

bool lc_coarse_pixel(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y)
{
    lc_pixel px = { .weight = 1 };
    lc_f3 dir, rgb = { 0, 0, 0 };
    lc_sight s;
    if (lc_time_to_ask(w) && !lc_job_go_on(j)) return false;
    lc_phase_start(&w->stats);
    w->stats.camera_rays++;
    const bool hit = lc_sample_sight(j, x, y, j->first, &w->light, NULL, &dir, &s);
    lc_phase_end(&w->stats, LC_PHASE_CAMERA);
    if (!hit) {
        px.rgb = lc_background(j->scene, LC_SKY_ALL, dir);
    } else {
        w->stats.camera_rays += s.n_rays;
        lc_add_to_planes(j, &px, &s, dir);
        if (s.n_lit && !interpolate(j, x, y, &s, &rgb)) {
            lc_cut_result r;
            const lc_sample_keys keys = lc_sample_keys_of(j, NULL, x, y, j->first);
            lc_shade_sight(j, w, &s, NULL, &keys, &r);
            rgb = r.radiance;
            px.cut = (float)r.size;
            px.rays = (float)r.rays;
            px.error = r.max_error;
        }
        px.rgb = lc_f3_add(rgb, s.emission);
    }
    lc_phase_end(&w->stats, LC_PHASE_OTHER);
    lc_phase_stop(&w->stats);
    if (atomic_load_explicit(&j->cancelled, memory_order_relaxed)) return false;
    if (!lc_film_store(&j->film, x, y, &px)) w->stats.nonfinite++;
    return true;
}
