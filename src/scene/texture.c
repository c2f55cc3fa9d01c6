/* texture.c - evaluates the graph of textures, and builds it with bounds on depth and cost. */
#include "scene/texture.h"

#include "base/arena.h"
#include "scene/noise.h"

#include <math.h>
#include <string.h>

const char *lc_tex_kind_name(lc_tex_kind kind)
{
    static const char *const names[LC_TEX_KINDS] = { "constant", "scale",        "mix",      "directionmix",
                                                     "imagemap", "checkerboard", "dots",     "bilerp",
                                                     "uv",       "fbm",          "wrinkled", "windy",
                                                     "marble",   "wood" };
    return names[kind];
}

/* ---- evaluation ---- */

static void input(const lc_textures *set, const lc_tex_input *in, const lc_tex_point *p, double out[3])
{
    if (in->id == LC_NONE) memcpy(out, in->value, sizeof in->value);
    else lc_texture_eval(set, in->id, p, out);
}

/* (1 - w) in[0] + w in[1]. An input whose weight is 0 is not evaluated. */
static void blend(const lc_textures *set, const lc_texture *t, const lc_tex_point *p, double w, double out[3])
{
    double a[3] = { 0, 0, 0 }, b[3] = { 0, 0, 0 };
    if (w < 1 || w > 1) input(set, &t->in[0], p, a);
    if (w < 0 || w > 0) input(set, &t->in[1], p, b);
    for (int k = 0; k < 3; k++) out[k] = (1 - w) * a[k] + w * b[k];
}

/* The weight of in[1] in LC_TEX_DIRECTION: 1 - |n . v1|. */
static double across(const lc_texture *t, const lc_tex_point *p)
{
    const double *v = t->map.v1;
    return 1 - fmin(fabs(v[0] * p->n[0] + v[1] * p->n[1] + v[2] * p->n[2]), 1);
}

/* The second integral of the square wave that is 1 on even cells and -1 on odd ones. */
static double second_integral(double x)
{
    double y = x / 2 - floor(x / 2) - 0.5;
    return x / 2 + y * (1 - 2 * fabs(y));
}

/* Radii, in cells, outside of which the second difference in wave() is lost in rounding: below, the wave is
 * not filtered; above, its mean is 0. */
#define MIN_WAVE_RADIUS 1e-6 /* times |x|, if that is above 1 */
#define MAX_WAVE_RADIUS 1e6

/* The square wave at x, filtered with a triangle filter of radius r. */
static double wave(double x, double r)
{
    double cell = floor(x);
    if (!(r > MIN_WAVE_RADIUS * fmax(fabs(x), 1)) || (floor(x - r) >= cell && floor(x + r) <= cell))
        return floor(cell / 2) * 2 < cell ? -1 : 1;
    if (r > MAX_WAVE_RADIUS) return 0;
    return (second_integral(x + r) - 2 * second_integral(x) + second_integral(x - r)) / (r * r);
}

#define CHECKER_RADIUS 0.75 /* of the triangle filter, in pixel footprints; chosen */

/* The weight of in[1] in a checkerboard. */
static double checker(const lc_texture *t, const lc_tex_point *p)
{
    double at[3] = { 0, 0, 0 }, width[3] = { 0, 0, 0 }, product = 1;
    bool ok = t->solid ? lc_tex_map_3d(&t->map, p, at, width) : lc_tex_map_2d(&t->map, p, at, width);
    if (!ok) return 0.5;
    if (t->solid) width[1] = width[2] = width[0];
    for (int k = 0; k < (t->solid ? 3 : 2); k++)
        product *= wave(at[k], t->sharp ? 0 : CHECKER_RADIUS * width[k]);
    return 0.5 - 0.5 * product;
}

#define DOT_RADIUS 0.35 /* cells; pbrt's */

/* The weight of in[1]: 0 inside a dot, 1 outside. Half of the cells hold a dot, off their centre; as in
 * pbrt. */
static double dots(const lc_texture *t, const lc_tex_point *p)
{
    double st[2], width[2];
    if (!lc_tex_map_2d(&t->map, p, st, width)) return 1;
    double s = floor(st[0] + 0.5), r = floor(st[1] + 0.5), shift = 0.5 - DOT_RADIUS;
    if (!(lc_noise(s + 0.5, r + 0.5, 0.5) > 0)) return 1;
    double ds = st[0] - (s + shift * lc_noise(s + 1.5, r + 2.8, 0.5));
    double dt = st[1] - (r + shift * lc_noise(s + 4.5, r + 9.8, 0.5));
    return ds * ds + dt * dt < DOT_RADIUS * DOT_RADIUS ? 0 : 1;
}

/* From an image's R, G, B to the texture's value: grey for a float texture, scaled, inverted. */
static void finish_image(const lc_texture *t, double out[3])
{
    double grey = t->grey[0] * out[0] + t->grey[1] * out[1] + t->grey[2] * out[2];
    for (int k = 0; k < 3; k++) {
        out[k] = t->scale * (t->is_float ? grey : out[k]);
        if (t->invert) out[k] = fmax(1 - out[k], 0);
    }
}

static void image(const lc_textures *set, const lc_texture *t, const lc_tex_point *p, double out[3])
{
    const lc_mipmap *m = &set->images[t->image];
    double st[2] = { 0, 0 }, width[2] = { 0, 0 };
    if (!lc_tex_map_2d(&t->map, p, st, width)) {
        lc_mipmap_mean(m, out);
    } else {
        double texels = fmax(width[0] * m->levels[0].width, width[1] * m->levels[0].height);
        lc_mipmap_lookup(m, st[0], 1 - st[1], texels, t->wrap, t->filter, out);
    }
    finish_image(t, out);
}

/* Interpolates between in[0] .. in[3] at the corners of the unit square. */
static void bilerp(const lc_textures *set, const lc_texture *t, const lc_tex_point *p, double out[3])
{
    double st[2], width[2], v[3];
    if (!lc_tex_map_2d(&t->map, p, st, width)) st[0] = st[1] = 0;
    out[0] = out[1] = out[2] = 0;
    for (int i = 0; i < 4; i++) {
        double w = (i & 2 ? st[0] : 1 - st[0]) * (i & 1 ? st[1] : 1 - st[1]);
        input(set, &t->in[i], p, v);
        for (int k = 0; k < 3; k++) out[k] += w * v[k];
    }
}

static void coordinates(const lc_texture *t, const lc_tex_point *p, double out[3])
{
    double st[2], width[2];
    if (!lc_tex_map_2d(&t->map, p, st, width)) st[0] = st[1] = 0;
    out[0] = st[0] - floor(st[0]);
    out[1] = st[1] - floor(st[1]);
    out[2] = 0;
}

static void solid(const lc_textures *set, const lc_texture *t, const lc_tex_point *p, double out[3])
{
    double q[3], width, weight = 0.5;
    bool ok = lc_tex_map_3d(&t->map, p, q, &width);
    out[0] = out[1] = out[2] = 0;
    if (ok) lc_tex_solid(t, q, width, &weight, out);
    if (t->kind == LC_TEX_WOOD) blend(set, t, p, weight, out);
}

void lc_texture_eval(const lc_textures *set, uint32_t id, const lc_tex_point *p, double out[3])
{
    const lc_texture *t = &set->items[id];
    double v[3];
    switch (t->kind) {
    case LC_TEX_CONSTANT: input(set, &t->in[0], p, out); break;
    case LC_TEX_SCALE:
        input(set, &t->in[0], p, out);
        for (int i = 1; i < 3; i++) {
            input(set, &t->in[i], p, v);
            for (int k = 0; k < 3; k++) out[k] *= v[k];
        }
        break;
    case LC_TEX_MIX:
        input(set, &t->in[2], p, v);
        blend(set, t, p, v[0], out);
        break;
    case LC_TEX_DIRECTION: blend(set, t, p, across(t, p), out); break;
    case LC_TEX_IMAGE: image(set, t, p, out); break;
    case LC_TEX_CHECKER: blend(set, t, p, checker(t, p), out); break;
    case LC_TEX_DOTS: blend(set, t, p, dots(t, p), out); break;
    case LC_TEX_BILERP: bilerp(set, t, p, out); break;
    case LC_TEX_UV: coordinates(t, p, out); break;
    default: solid(set, t, p, out);
    }
}

/* ---- building ---- */

/* The mean of a pattern without inputs. Those of the noises were measured over 10^6 random points. */
static void pattern_mean(const lc_textures *set, const lc_texture *t, double out[3])
{
    static const double marble[3] = { .83, .82, .86 };
    double v = 0;
    switch (t->kind) {
    case LC_TEX_IMAGE:
        lc_mipmap_mean(&set->images[t->image], out);
        finish_image(t, out);
        return;
    case LC_TEX_UV:
        out[0] = out[1] = 0.5;
        out[2] = 0;
        return;
    case LC_TEX_MARBLE: memcpy(out, marble, sizeof marble); return;
    case LC_TEX_WRINKLED:
        for (int i = 0; i < t->octaves; i++) v = v * t->roughness + 0.2;
        break;
    default: break;
    }
    out[0] = out[1] = out[2] = v;
}

static void set_mean(const lc_textures *set, lc_texture *t)
{
    /* Mean weight of in[1]: 1/2, but dots in half of the cells cover pi DOT_RADIUS^2 / 2 = 0.19 of the
     * area. */
    double in[4][3], w = t->kind == LC_TEX_DOTS ? 0.81 : 0.5;
    for (int i = 0; i < 4; i++)
        memcpy(in[i], t->in[i].id == LC_NONE ? t->in[i].value : set->items[t->in[i].id].mean, sizeof in[i]);
    pattern_mean(set, t, t->mean);
    for (int k = 0; k < 3; k++) {
        switch (t->kind) {
        case LC_TEX_CONSTANT: t->mean[k] = in[0][k]; break;
        case LC_TEX_SCALE: t->mean[k] = in[0][k] * in[1][k] * in[2][k]; break;
        case LC_TEX_BILERP: t->mean[k] = (in[0][k] + in[1][k] + in[2][k] + in[3][k]) / 4; break;
        case LC_TEX_MIX: w = in[2][0]; /* fall through */
        case LC_TEX_DIRECTION:
        case LC_TEX_CHECKER:
        case LC_TEX_DOTS:
        case LC_TEX_WOOD: t->mean[k] = (1 - w) * in[0][k] + w * in[1][k]; break;
        default: break;
        }
        if (!isfinite(t->mean[k])) t->mean[k] = 0.5;
    }
}

static void become_constant(lc_texture *t)
{
    t->kind = LC_TEX_CONSTANT;
    for (int i = 0; i < 4; i++) t->in[i].id = LC_NONE;
    memcpy(t->in[0].value, t->mean, sizeof t->mean);
}

/* Sets depth and cost, and replaces inputs that are constant textures by values. True if every input is a
 * value. */
static bool measure(const lc_textures *set, lc_texture *t)
{
    bool values = true;
    t->depth = t->cost = 1;
    for (int i = 0; i < 4; i++) {
        if (t->in[i].id == LC_NONE) continue;
        const lc_texture *from = &set->items[t->in[i].id];
        if (from->kind == LC_TEX_CONSTANT) {
            memcpy(t->in[i].value, from->mean, sizeof from->mean);
            t->in[i].id = LC_NONE;
            continue;
        }
        values = false;
        t->cost += from->cost;
        if (from->depth >= t->depth) t->depth = from->depth + 1;
    }
    return values;
}

lc_status lc_textures_add(lc_textures *set, const lc_texture *texture, uint32_t *id, bool *too_deep)
{
    lc_texture t = *texture;
    bool values = measure(set, &t);
    set_mean(set, &t);
    *too_deep = t.depth > LC_TEX_MAX_DEPTH || t.cost > LC_TEX_MAX_COST;
    if (*too_deep || (values && t.kind <= LC_TEX_MIX)) become_constant(&t);
    if (t.kind == LC_TEX_CONSTANT) t.depth = t.cost = 1;
    void *items = set->items;
    lc_status st = lc_grow(set->ctx, &items, &set->cap, set->n + 1, sizeof *set->items);
    set->items = items;
    if (st) return st;
    *id = (uint32_t)set->n;
    set->items[set->n++] = t;
    return LC_OK;
}

lc_status lc_textures_add_image(lc_textures *set, const lc_mipmap *m, uint32_t *id)
{
    void *images = set->images;
    lc_status st = lc_grow(set->ctx, &images, &set->cap_images, set->n_images + 1, sizeof *set->images);
    set->images = images;
    if (st) return st;
    *id = (uint32_t)set->n_images;
    set->images[set->n_images++] = *m;
    return LC_OK;
}

void lc_textures_free(lc_textures *set)
{
    for (size_t i = 0; i < set->n_images; i++) lc_mipmap_free(set->ctx, &set->images[i]);
    lc_free(set->ctx, set->images, set->cap_images, sizeof *set->images);
    lc_free(set->ctx, set->items, set->cap, sizeof *set->items);
}
