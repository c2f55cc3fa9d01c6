/* env_light.c - cuts environment maps into rectangles of equal weighted power, a light for each.
 *
 *     map -> summed-area table of power -> CANDIDATES rectangles -> importance of each (env_importance.h)
 *         -> summed-area table of weighted power -> n_lights rectangles -> lights
 *
 * A rectangle for k lights is cut across its longer side into one for k / 2 lights and one for the rest; the
 * summed-area table tells where. Cuts may pass through texels. Weights matter indoors, where most of the sky
 * is occluded at every visible point; measured: tests/results/virtual-lights.md. They decide where to cut,
 * not which lights to keep: keeping lights with a probability would preserve the map's irradiance only on
 * average.
 */
#include "prepare/env_light.h"

#include "base/rng.h"
#include "prepare/env_importance.h"
#include "prepare/sky_deviation.h"

#include <string.h>

#define CANDIDATES LC_SIZE(4096, 96) /* lights whose importance is measured */
#define VIEW_SIDE LC_SIZE(64, 6)     /* side of the view grid at whose points it is measured */
#define LEAST_RADIUS 1e-6            /* of a light's disc */
#define MOST_RADIUS 0.5
#define MIN_SIDE LC_SIZE(64, 8)      /* texels; the map is subdivided to at least this if it is weighted */

typedef struct rect {
    double lo[2], hi[2]; /* x, y in texels of the table */
} rect;

typedef struct table {
    lc_scene *scene;
    const lc_context *ctx;
    const lc_env *env;
    uint32_t fine, w, h; /* each texel of the map is cut into fine * fine, so the table has w * h */
    double *power;       /* (w + 1) * (h + 1): the power of the texels left of x and above y */
    double *weighted;    /* (w + 1) * (h + 1): the same for weighted power; NULL: not weighted */
    double *cut_by;      /* the one of the two that decides where to cut */
    double *solid;       /* h: solid angle of one texel of the row */
    uint64_t seed;
    uint64_t n_made;     /* lights */
    lc_light *candidates; /* instead of lights of the scene; NULL: none are being made */
    rect *tried;          /* rectangles of the candidates, or NULL */
    double *weights;      /* CANDIDATES */
    rect *parts;          /* of the lights that the scene was given, or NULL */
    size_t first;         /* of these */
} table;

/* ---- power of rectangles ---- */

static double power_of(const double rgb[3]) { return (rgb[0] + rgb[1] + rgb[2]) / 3; }

/* The summed-area table `sums` at (x, y), bilinear inside a texel, whose power is spread evenly over it. */
static double sum_to(const table *t, const double *sums, double x, double y)
{
    size_t ix = (size_t)fmin(x, t->w - 1.0), iy = (size_t)fmin(y, t->h - 1.0), row = (size_t)t->w + 1;
    const double *s = sums + iy * row + ix;
    double fx = x - (double)ix, fy = y - (double)iy;
    return (1 - fy) * ((1 - fx) * s[0] + fx * s[1]) + fy * ((1 - fx) * s[row] + fx * s[row + 1]);
}

static double sum_in(const table *t, const double *sums, const rect *r)
{
    return (sum_to(t, sums, r->hi[0], r->hi[1]) - sum_to(t, sums, r->lo[0], r->hi[1])) -
           (sum_to(t, sums, r->hi[0], r->lo[1]) - sum_to(t, sums, r->lo[0], r->lo[1]));
}

/* The sum over the part of the rectangle below coordinate `at` on an axis. */
static double sum_before(const table *t, const double *sums, const rect *r, int axis, double at)
{
    rect part = *r;
    part.hi[axis] = at;
    return sum_in(t, sums, &part);
}

/* The coordinate on an axis below which this fraction of the rectangle's sum lies. Inside a texel the sum is
 * linear. */
static double find_cut(const table *t, const double *sums, const rect *r, int axis, double fraction)
{
    double from = r->lo[axis], to = r->hi[axis], before = 0, target = fraction * sum_in(t, sums, r);
    int64_t a = (int64_t)floor(from) + 1, b = (int64_t)ceil(to) - 1;
    while (a <= b) {
        int64_t line = a + (b - a) / 2;
        double p = sum_before(t, sums, r, axis, (double)line);
        if (p <= target) {
            from = (double)line;
            before = p;
            a = line + 1;
        } else {
            to = (double)line;
            b = line - 1;
        }
    }
    double after = sum_before(t, sums, r, axis, to),
           f = after > before ? (target - before) / (after - before) : 0.5;
    return from + fmin(fmax(f, 0), 1) * (to - from);
}

/* ---- lights ---- */

/* The length of the intersection of [lo, hi] and [i, i + 1]. */
static double overlap(double lo, double hi, uint32_t i) { return fmax(fmin(hi, i + 1.0) - fmax(lo, i), 0); }

/* What a rectangle sheds: its irradiance R, G, B on a surface across the light; by power, its middle and the
 * variance each way, texels. */
typedef struct {
    double rgb[3], middle[2], variance[2];
} shed;

/* First and second moments of an interval's overlap with [i, i + 1]. */
static void moments_of(double lo, double hi, uint32_t i, double m[2])
{
    const double a = fmax(lo, i), b = fmin(hi, i + 1.0);
    m[0] = (a + b) / 2;
    m[1] = (a * a + a * b + b * b) / 3;
}

static shed sum_up_rect(const table *t, const rect *r)
{
    shed s = { .rgb = { 0, 0, 0 } };
    double rgb[3], power = 0, first[2] = { 0, 0 }, second[2] = { 0, 0 };
    for (uint32_t y = (uint32_t)r->lo[1]; y < t->h && y < r->hi[1]; y++) {
        double row[3] = { 0, 0, 0 }, at[2], sums[3] = { 0, 0, 0 };
        const double share = overlap(r->lo[1], r->hi[1], y) * t->solid[y];
        for (uint32_t x = (uint32_t)r->lo[0]; x < t->w && x < r->hi[0]; x++) {
            const double part = overlap(r->lo[0], r->hi[0], x);
            lc_env_texel(t->env, x / t->fine, y / t->fine, rgb);
            moments_of(r->lo[0], r->hi[0], x, at);
            for (int c = 0; c < 3; c++) row[c] += part * rgb[c];
            const double p = part * power_of(rgb);
            sums[0] += p;
            sums[1] += p * at[0];
            sums[2] += p * at[1];
        }
        moments_of(r->lo[1], r->hi[1], y, at);
        for (int c = 0; c < 3; c++) s.rgb[c] += share * row[c];
        power += share * sums[0];
        first[0] += share * sums[1];
        second[0] += share * sums[2];
        first[1] += share * sums[0] * at[0];
        second[1] += share * sums[0] * at[1];
    }
    for (int axis = 0; axis < 2; axis++) {
        s.middle[axis] = power > 0 ? first[axis] / power : (r->lo[axis] + r->hi[axis]) / 2;
        s.middle[axis] = fmin(fmax(s.middle[axis], r->lo[axis]), r->hi[axis]);
        s.variance[axis] = power > 0 ? fmax(second[axis] / power - s.middle[axis] * s.middle[axis], 0) : 0;
    }
    return s;
}

/* Sets the light's direction and radius to those of an even disc whose mean direction is the rectangle's, of
 * length 1 - radius^2 / 4. Where that is, four points say to the second order: a standard deviation to either
 * side of the middle, each way. */
static void set_disc(const table *t, const shed *s, lc_light *light)
{
    double mean[3] = { 0, 0, 0 }, w[3], v[3], len2 = 0;
    for (int i = 0; i < 4; i++) {
        const double x = s->middle[0] + (i & 1 ? 1 : -1) * sqrt(s->variance[0]),
                     y = s->middle[1] + (i & 2 ? 1 : -1) * sqrt(s->variance[1]);
        lc_env_direction(t->env, x / t->fine, y / t->fine, w);
        for (int k = 0; k < 3; k++) mean[k] += w[k] / 4;
    }
    for (int k = 0; k < 3; k++) len2 += mean[k] * mean[k];
    lc_xform_vector(&t->env->to_world, mean, v);
    light->dir = lc_f3_normalize_d(-v[0], -v[1], -v[2]);
    light->radius = (float)fmin(fmax(2 * sqrt(fmax(1 - sqrt(len2), 0)), LEAST_RADIUS), MOST_RADIUS);
}

static lc_status add_light(table *t, const rect *r)
{
    const shed s = sum_up_rect(t, r);
    lc_light light = { .kind = LC_LIGHT_SKY, .group = t->env->group };
    set_disc(t, &s, &light);
    light.turn = (uint32_t)t->n_made;
    light.intensity = lc_f3_make((float)s.rgb[0], (float)s.rgb[1], (float)s.rgb[2]);
    uint64_t i = t->n_made++;
    if (!t->candidates) {
        if (t->parts) t->parts[t->scene->n_lights - t->first] = *r; /* the next one's if this is dark */
        return lc_scene_add_light(t->scene, (lc_pos){ 0, 0, 0 }, &light);
    }
    if (t->tried) { /* by their middles */
        t->tried[i] = *r;
        light.kind = LC_LIGHT_DIRECTIONAL;
    }
    t->candidates[i] = light;
    return LC_OK;
}

/* The axis, 0 for x or 1 for y, along which the rectangle subtends the larger angle. */
static int longer(const table *t, const rect *r)
{
    double across = (r->hi[0] - r->lo[0]) / t->w, down = (r->hi[1] - r->lo[1]) / t->h;
    if (t->env->mapping == LC_ENV_LATLONG) {
        double sine, cosine;
        lc_sincos_deg(90 * (r->lo[1] + r->hi[1]) / t->h, &sine, &cosine);
        across *= 2 * sine;
    }
    return down > across;
}

/* Cuts a rectangle into k of equal weighted power and makes a light for each. The recursion is as deep as k
 * has bits. */
static lc_status cut(table *t, const rect *r, uint32_t k)
{
    if (k == 1) return add_light(t, r);
    rect first = *r, second = *r;
    int axis = longer(t, r);
    first.hi[axis] = second.lo[axis] = find_cut(t, t->cut_by, r, axis, (k / 2) / (double)k);
    lc_status st = cut(t, &first, k / 2);
    return st ? st : cut(t, &second, k - k / 2);
}

/* ---- maps ---- */

/* Fills t->power and t->solid; returns the total power. */
static double fill(table *t)
{
    size_t row = (size_t)t->w + 1;
    double rgb[3];
    for (uint32_t y = 0; y < t->h; y++) {
        double sum = 0;
        t->solid[y] = lc_env_solid_angle(t->env, y / t->fine) / ((double)t->fine * t->fine);
        for (uint32_t x = 0; x < t->w; x++) {
            lc_env_texel(t->env, x / t->fine, y / t->fine, rgb);
            sum += power_of(rgb) * t->solid[y];
            t->power[(y + 1) * row + x + 1] = t->power[y * row + x + 1] + sum;
        }
    }
    return t->power[row * ((size_t)t->h + 1) - 1];
}

static size_t n_sums(const table *t) { return ((size_t)t->w + 1) * ((size_t)t->h + 1); }

/* Adds a rectangle's power times its weight to the texels that it covers. */
static void add_weighted(table *t, const rect *r, double weight)
{
    size_t row = (size_t)t->w + 1;
    double rgb[3];
    for (uint32_t y = (uint32_t)r->lo[1]; y < t->h && y < r->hi[1]; y++) {
        double share = overlap(r->lo[1], r->hi[1], y) * t->solid[y] * weight;
        for (uint32_t x = (uint32_t)r->lo[0]; x < t->w && x < r->hi[0]; x++) {
            lc_env_texel(t->env, x / t->fine, y / t->fine, rgb);
            t->weighted[(y + 1) * row + x + 1] += share * overlap(r->lo[0], r->hi[0], x) * power_of(rgb);
        }
    }
}

/* Turns a table of values per texel into a summed-area table, in place. */
static void sum_up(const table *t, double *sums)
{
    size_t row = (size_t)t->w + 1;
    for (uint32_t y = 0; y < t->h; y++) {
        double sum = 0;
        for (uint32_t x = 0; x < t->w; x++) {
            double *s = &sums[(y + 1) * row + x + 1];
            sum += *s;
            *s = s[-(ptrdiff_t)row] + sum;
        }
    }
}

/* Measures the importance of CANDIDATES rectangles of equal power and fills t->weighted. Equal power gives
 * bright parts of the sky more candidates. */
static lc_status try_candidates(table *t, const rect *all, const lc_view_grid *view)
{
    const lc_context *ctx = t->ctx;
    t->weighted = lc_alloc(ctx, n_sums(t), sizeof *t->weighted);
    t->tried = lc_alloc_raw(ctx, CANDIDATES, sizeof *t->tried);
    t->candidates = lc_alloc_raw(ctx, CANDIDATES, sizeof *t->candidates);
    t->weights = lc_alloc_raw(ctx, CANDIDATES, sizeof *t->weights);
    lc_status st = t->weighted && t->tried && t->candidates && t->weights ? LC_OK : LC_ERR_MEMORY;
    if (!st) st = cut(t, all, CANDIDATES);
    if (!st) st = lc_env_importance(view, t->candidates, CANDIDATES, t->seed, t->weights);
    if (!st) {
        for (uint32_t i = 0; i < CANDIDATES; i++) add_weighted(t, &t->tried[i], t->weights[i]);
        sum_up(t, t->weighted);
        t->cut_by = t->weighted;
    }
    lc_free(ctx, t->tried, CANDIDATES, sizeof *t->tried);
    lc_free(ctx, t->candidates, CANDIDATES, sizeof *t->candidates);
    lc_free(ctx, t->weights, CANDIDATES, sizeof *t->weights);
    t->scene->n_env_tried += t->n_made;
    t->tried = NULL;
    t->candidates = NULL;
    t->n_made = 0;
    return st;
}

/* A direction of a light's part; see lc_sky_parts. */
static void direction_in_part(const void *map, uint32_t i, const double u[2], float to[3])
{
    const table *t = map;
    rect column = t->parts[i];
    double w[3], v[3];
    const double x = find_cut(t, t->power, &column, 0, u[0]);
    column.lo[0] = fmax(column.lo[0], floor(x)); /* within a column of texels power does not depend on x */
    column.hi[0] = fmin(column.hi[0], floor(x) + 1);
    lc_env_direction(t->env, x / t->fine, find_cut(t, t->power, &column, 1, u[1]) / t->fine, w);
    lc_xform_vector(&t->env->to_world, w, v);
    lc_f3_store(to, lc_f3_normalize_d(v[0], v[1], v[2]));
}

/* Makes k lights, and sees how far the picture is off with them. */
static lc_status make_lights(table *t, const rect *all, uint32_t k, lc_sky_deviation *deviation)
{
    t->first = t->scene ? t->scene->n_lights : 0;
    if (deviation && !(t->parts = lc_alloc_raw(t->ctx, k, sizeof *t->parts))) return LC_ERR_MEMORY;
    lc_status st = cut(t, all, k);
    if (!st && deviation && t->scene->n_lights > t->first) {
        const lc_sky_parts parts = { .lights = t->scene->lights + t->first,
                                     .n = (uint32_t)(t->scene->n_lights - t->first),
                                     .direction = direction_in_part,
                                     .map = t };
        st = lc_sky_deviation_add(deviation, &parts);
    }
    lc_free(t->ctx, t->parts, k, sizeof *t->parts);
    return st;
}

/* Makes k lights for one map. view: NULL, not weighted. */
static lc_status make(table *t, uint32_t k, const lc_view_grid *view, lc_sky_deviation *deviation)
{
    rect all = { { 0, 0 }, { t->w, t->h } };
    const lc_context *ctx = t->ctx;
    t->power = lc_alloc(ctx, n_sums(t), sizeof *t->power);
    t->solid = lc_alloc(ctx, t->h, sizeof *t->solid);
    lc_status st = t->power && t->solid ? LC_OK : LC_ERR_MEMORY;
    if (!st && fill(t) > 0) {
        t->cut_by = t->power;
        if (view && view->n && k > 1) st = try_candidates(t, &all, view);
        if (!st) st = make_lights(t, &all, k, deviation);
    }
    lc_free(ctx, t->power, n_sums(t), sizeof *t->power);
    lc_free(ctx, t->weighted, n_sums(t), sizeof *t->weighted);
    lc_free(ctx, t->solid, t->h, sizeof *t->solid);
    return st;
}

/* A weighted map must have enough texels to tell directions apart; a constant map, for one, has a single
 * one. */
static void init_table(table *t, const lc_scene *scene, size_t env, bool weighted, uint64_t seed)
{
    uint32_t w = lc_env_width(&scene->envs[env]), h = lc_env_height(&scene->envs[env]), side = w < h ? w : h;
    *t = (table){ .ctx = scene->ctx, .env = &scene->envs[env], .seed = lc_hash2(seed, env) };
    t->fine = weighted ? (MIN_SIDE + side - 1) / side : 1;
    t->w = w * t->fine;
    t->h = h * t->fine;
}

static double env_power(const lc_env *env)
{
    double sum = 0, rgb[3];
    for (uint32_t y = 0; y < lc_env_height(env); y++) {
        double solid = lc_env_solid_angle(env, y);
        for (uint32_t x = 0; x < lc_env_width(env); x++) {
            lc_env_texel(env, x, y, rgb);
            sum += power_of(rgb) * solid;
        }
    }
    return sum;
}

static lc_status make_all(lc_scene *scene, uint32_t n_lights, uint64_t seed, const lc_view_grid *view,
                          lc_sky_deviation *deviation)
{
    double total = 0, before = 0;
    for (size_t i = 0; i < scene->n_envs; i++) total += env_power(&scene->envs[i]);
    for (size_t i = 0; i < scene->n_envs && total > 0; i++) {
        table t;
        init_table(&t, scene, i, view->n > 0, seed);
        t.scene = scene;
        /* The lights for this map; rounding the running sum keeps the total. */
        double power = env_power(t.env), first = floor(before / total * n_lights + 0.5);
        before += power;
        uint32_t k = (uint32_t)(floor(before / total * n_lights + 0.5) - first);
        if (!(power > 0)) continue;
        lc_status st = make(&t, k ? k : 1, view, deviation);
        if (st) return st;
    }
    return LC_OK;
}

lc_status lc_env_lights_make(lc_scene *scene, uint32_t n_lights, uint32_t max_depth, uint64_t seed)
{
    lc_view_grid view = { 0 };
    lc_sky_deviation deviation = { .light = NULL };
    const bool sees = scene->n_envs && scene->bvh;
    lc_status st = sees ? lc_view_grid_init(&view, scene, VIEW_SIDE, max_depth) : LC_OK;
    if (!st && sees) st = lc_sky_deviation_init(&deviation, scene, max_depth, seed);
    if (!st) st = make_all(scene, n_lights, seed, &view, sees ? &deviation : NULL);
    if (!st && sees) lc_sky_deviation_find(&deviation, &scene->sky_error);
    lc_sky_deviation_free(&deviation);
    lc_view_grid_free(&view);
    return st;
}

lc_status lc_env_lights_by_power(const lc_scene *scene, size_t env, uint32_t n, uint64_t seed,
                                 lc_light *lights, uint32_t *n_made)
{
    table t;
    init_table(&t, scene, env, true, seed);
    t.candidates = lights;
    lc_status st = make(&t, n, NULL, NULL);
    *n_made = (uint32_t)t.n_made;
    return st;
}
