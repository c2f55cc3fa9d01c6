/* env_light.c - see env_light.h. A table of sums over all rectangles from the corner finds where to cut: a rectangle for k lights is
 * cut across its longer side into one for k / 2 and one for the rest, by power. Cuts go through texels. */
#include "env_light.h"

#include "rng.h"

#include <string.h>

typedef struct rect {
    double lo[2], hi[2]; /* texels: x, y */
} rect;

typedef struct table {
    lc_scene *scene;
    const lc_env *env;
    uint32_t w, h;
    double *sums;      /* (w + 1) * (h + 1): power of the texels left of x and above y */
    double *solid;     /* h: solid angle of a texel */
    uint64_t seed;
    uint64_t n_made;
} table;

/* ---- power of rectangles ---- */

static double power_of(const double rgb[3]) { return (rgb[0] + rgb[1] + rgb[2]) / 3; }

static double sum_to(const table *t, double x, double y)
{
    size_t ix = (size_t)fmin(x, t->w - 1.0), iy = (size_t)fmin(y, t->h - 1.0), row = (size_t)t->w + 1;
    const double *s = t->sums + iy * row + ix;
    double fx = x - (double)ix, fy = y - (double)iy;
    return (1 - fy) * ((1 - fx) * s[0] + fx * s[1]) + fy * ((1 - fx) * s[row] + fx * s[row + 1]);
}

static double power_in(const table *t, const rect *r)
{
    return (sum_to(t, r->hi[0], r->hi[1]) - sum_to(t, r->lo[0], r->hi[1])) -
           (sum_to(t, r->hi[0], r->lo[1]) - sum_to(t, r->lo[0], r->lo[1]));
}

static double power_before(const table *t, const rect *r, int axis, double at)
{
    rect part = *r;
    part.hi[axis] = at;
    return power_in(t, &part);
}

/* Where `share` of the rectangle's power lies before. Between lines of texels power rises linearly. */
static double find_cut(const table *t, const rect *r, int axis, double share)
{
    double from = r->lo[axis], to = r->hi[axis], before = 0, target = share * power_in(t, r);
    int64_t a = (int64_t)floor(from) + 1, b = (int64_t)ceil(to) - 1;
    while (a <= b) {
        int64_t line = a + (b - a) / 2;
        double p = power_before(t, r, axis, (double)line);
        if (p <= target) from = (double)line, before = p, a = line + 1;
        else to = (double)line, b = line - 1;
    }
    double after = power_before(t, r, axis, to), f = after > before ? (target - before) / (after - before) : 0.5;
    return from + fmin(fmax(f, 0), 1) * (to - from);
}

/* ---- lights ---- */

/* Length of [lo, hi] in [i, i + 1]. */
static double overlap(double lo, double hi, uint32_t i) { return fmax(fmin(hi, i + 1.0) - fmax(lo, i), 0); }

static void irradiance(const table *t, const rect *r, double sum[3])
{
    double rgb[3];
    sum[0] = sum[1] = sum[2] = 0;
    for (uint32_t y = (uint32_t)r->lo[1]; y < t->h && y < r->hi[1]; y++) {
        double row[3] = { 0, 0, 0 }, share = overlap(r->lo[1], r->hi[1], y) * t->solid[y];
        for (uint32_t x = (uint32_t)r->lo[0]; x < t->w && x < r->hi[0]; x++) {
            double part = overlap(r->lo[0], r->hi[0], x);
            lc_env_texel(t->env, x, y, rgb);
            for (int c = 0; c < 3; c++) row[c] += part * rgb[c];
        }
        for (int c = 0; c < 3; c++) sum[c] += share * row[c];
    }
}

/* A point of the rectangle, by power: a row's place first, then the place in that row. */
static void pick(const table *t, const rect *r, double p[2])
{
    rect row = *r;
    p[1] = find_cut(t, r, 1, lc_unit(lc_hash4(t->seed, t->n_made, 0, 0)));
    double line = fmin(floor(p[1]), t->h - 1.0);
    row.lo[1] = fmax(r->lo[1], line);
    row.hi[1] = fmin(r->hi[1], line + 1);
    p[0] = find_cut(t, &row, 0, lc_unit(lc_hash4(t->seed, t->n_made, 0, 1)));
}

static lc_status add_light(table *t, const rect *r)
{
    lc_light light = { .kind = LC_LIGHT_DIRECTIONAL, .atten = { 1, 0, 0 } };
    double rgb[3], p[2], w[3], v[3];
    irradiance(t, r, rgb);
    pick(t, r, p);
    lc_env_direction(t->env, p[0], p[1], w);
    lc_xform_vector(&t->env->to_world, w, v);
    light.intensity = lc_f3_make((float)rgb[0], (float)rgb[1], (float)rgb[2]);
    light.dir = lc_f3_normalize_d(-v[0], -v[1], -v[2]);
    t->n_made++;
    return lc_scene_add_light(t->scene, (lc_pos){ 0, 0, 0 }, &light);
}

/* The axis along which the rectangle is longer, seen from the scene. */
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

/* Goes as deep as k has bits. */
static lc_status cut(table *t, const rect *r, uint32_t k)
{
    if (k == 1) return add_light(t, r);
    rect first = *r, second = *r;
    int axis = longer(t, r);
    first.hi[axis] = second.lo[axis] = find_cut(t, r, axis, (k / 2) / (double)k);
    lc_status st = cut(t, &first, k / 2);
    return st ? st : cut(t, &second, k - k / 2);
}

/* ---- maps ---- */

static double fill(table *t)
{
    size_t row = (size_t)t->w + 1;
    double rgb[3];
    for (uint32_t y = 0; y < t->h; y++) {
        double sum = 0;
        t->solid[y] = lc_env_solid_angle(t->env, y);
        for (uint32_t x = 0; x < t->w; x++) {
            lc_env_texel(t->env, x, y, rgb);
            sum += power_of(rgb) * t->solid[y];
            t->sums[(y + 1) * row + x + 1] = t->sums[y * row + x + 1] + sum;
        }
    }
    return t->sums[row * ((size_t)t->h + 1) - 1];
}

static lc_status make(table *t, uint32_t k)
{
    rect all = { { 0, 0 }, { t->w, t->h } };
    const lc_context *ctx = t->scene->ctx;
    size_t n = ((size_t)t->w + 1) * ((size_t)t->h + 1);
    t->sums = lc_alloc(ctx, n, sizeof *t->sums);
    t->solid = lc_alloc(ctx, t->h, sizeof *t->solid);
    lc_status st = t->sums && t->solid ? LC_OK : LC_ERR_MEMORY;
    if (!st && fill(t) > 0) st = cut(t, &all, k);
    lc_free(ctx, t->sums, n, sizeof *t->sums);
    lc_free(ctx, t->solid, t->h, sizeof *t->solid);
    return st;
}

static double env_power(const lc_env *env)
{
    double sum = 0, rgb[3];
    for (uint32_t y = 0; y < lc_env_height(env); y++) {
        double solid = lc_env_solid_angle(env, y);
        for (uint32_t x = 0; x < lc_env_width(env); x++) lc_env_texel(env, x, y, rgb), sum += power_of(rgb) * solid;
    }
    return sum;
}

lc_status lc_env_lights_make(lc_scene *scene, uint32_t n_lights, uint64_t seed)
{
    double total = 0, before = 0;
    for (size_t i = 0; i < scene->n_envs; i++) total += env_power(&scene->envs[i]);
    for (size_t i = 0; i < scene->n_envs && total > 0; i++) {
        table t = { .scene = scene, .env = &scene->envs[i], .w = lc_env_width(&scene->envs[i]), .h = lc_env_height(&scene->envs[i]) };
        t.seed = lc_hash2(seed, i);
        /* The share of this map: rounding the running sum keeps the total. */
        double power = env_power(t.env), first = floor(before / total * n_lights + 0.5);
        before += power;
        uint32_t k = (uint32_t)(floor(before / total * n_lights + 0.5) - first);
        if (!(power > 0)) continue;
        lc_status st = make(&t, k ? k : 1);
        if (st) return st;
    }
    return LC_OK;
}
