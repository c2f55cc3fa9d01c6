/* unit_texture.c - lookups in images, mappings and patterns against plain code in doubles, which shares
 * nothing with the library; mean values that textures state against means over many points. */
#include "base/arena.h"
#include "scene/noise.h"
#include "scene/texture.h"
#include "support/logged.h"

#include <float.h>
#include <math.h>

#define RND_KEY 77
#include "support/rnd.h"

static lc_context *ctx;

/* ---- images ---- */

static double srgb(double v) { return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4); }

/* A raster of random samples. */
static lc_raster make_raster(uint32_t w, uint32_t h, uint32_t n, lc_raster_kind kind)
{
    lc_raster r;
    size_t count = (size_t)w * h * n;
    CHECK(!lc_raster_init(ctx, "t", &(lc_raster){ w, h, n, kind, NULL }, SIZE_MAX, 1, &r));
    for (size_t i = 0; i < count; i++) {
        double v = rnd();
        if (kind == LC_RASTER_U8) ((uint8_t *)r.data)[i] = (uint8_t)(v * 256);
        if (kind == LC_RASTER_U16) ((uint16_t *)r.data)[i] = (uint16_t)(v * 65536);
        if (kind == LC_RASTER_F32) ((float *)r.data)[i] = (float)(v * 10 - 2);
    }
    return r;
}

static double plain_texel(const lc_raster *r, lc_encoding e, int64_t x, int64_t y, lc_wrap wrap, uint32_t c)
{
    int64_t w = r->width, h = r->height;
    bool outside = x < 0 || y < 0 || x >= w || y >= h;
    if (outside && wrap == LC_WRAP_BLACK) return 0;
    x = wrap == LC_WRAP_REPEAT ? ((x % w) + w) % w : x < 0 ? 0 : x >= w ? w - 1 : x;
    y = wrap == LC_WRAP_REPEAT ? ((y % h) + h) % h : y < 0 ? 0 : y >= h ? h - 1 : y;
    size_t at = (size_t)(y * w + x) * r->n_channels + (r->n_channels >= 3 ? c : 0);
    if (r->kind == LC_RASTER_F32) return (double)((const float *)r->data)[at];
    double v = r->kind == LC_RASTER_U8 ? ((const uint8_t *)r->data)[at] / 255.0
                                       : ((const uint16_t *)r->data)[at] / 65535.0;
    return e.kind == LC_ENCODING_SRGB ? srgb(v) : e.kind == LC_ENCODING_LINEAR ? v : pow(v, (double)e.gamma);
}

static double plain_bilinear(const lc_raster *r, lc_encoding e, double s, double t, lc_wrap wrap, uint32_t c)
{
    double x = s * r->width - 0.5, y = t * r->height - 0.5, fx = x - floor(x), fy = y - floor(y);
    int64_t ix = (int64_t)floor(x), iy = (int64_t)floor(y);
    return plain_texel(r, e, ix, iy, wrap, c) * (1 - fx) * (1 - fy) +
           plain_texel(r, e, ix + 1, iy, wrap, c) * fx * (1 - fy) +
           plain_texel(r, e, ix, iy + 1, wrap, c) * (1 - fx) * fy +
           plain_texel(r, e, ix + 1, iy + 1, wrap, c) * fx * fy;
}

TEST(bilinear_agrees)
{
    static const lc_raster_kind kinds[3] = { LC_RASTER_U8, LC_RASTER_U16, LC_RASTER_F32 };
    static const lc_encoding encodings[3] = { { LC_ENCODING_SRGB, 1 },
                                              { LC_ENCODING_LINEAR, 1 },
                                              { LC_ENCODING_GAMMA, 2.2f } };
    for (int k = 0; k < 27; k++) {
        lc_raster r = make_raster(7 + (uint32_t)k, 5, (uint32_t)k % 4 + 1, kinds[k % 3]);
        lc_encoding e = encodings[k / 3 % 3];
        lc_wrap wrap = (lc_wrap)(k / 9);
        lc_mipmap m;
        double got[3];
        CHECK(!lc_mipmap_build(ctx, &r, e, &m) && m.is_codes == (k % 3 == 0));
        for (uint64_t i = 0; i < 2000; i++) {
            double s = 4 * rnd() - 1.5, t = 4 * rnd() - 1.5;
            lc_mipmap_lookup(&m, s, t, 0.5, wrap, LC_FILTER_BILINEAR, got);
            for (uint32_t c = 0; c < 3; c++) {
                double want = plain_bilinear(&r, e, s, t, wrap, c);
                CHECKF(fabs(got[c] - want) <= 2e-7 * (1 + fabs(want)), "case %d (%g, %g): %.9g for %.9g", k,
                       s, t, got[c], want);
            }
            lc_mipmap_lookup(&m, s, t, 0, wrap, LC_FILTER_POINT, got);
            double want = plain_texel(&r, e, (int64_t)floor(s * r.width), (int64_t)floor(t * r.height), wrap,
                                      1);
            CHECK(fabs(got[1] - want) <= 2e-7 * (1 + fabs(want)));
        }
        lc_mipmap_free(ctx, &m);
        lc_raster_free(ctx, &r);
    }
}

/* Each level has the mean of the image, as the area of every texel is shared out among those of the next
 * level. Levels of codes are rounded by up to half a code each. */
TEST(levels_keep_the_mean)
{
    static const uint32_t sizes[][2] = { { 8, 8 },   { 7, 5 }, { 1, 9 }, { 13, 1 },
                                         { 33, 31 }, { 1, 1 }, { 2, 3 } };
    for (size_t k = 0; k < 14; k++) {
        bool codes = k >= 7;
        lc_raster r = make_raster(sizes[k % 7][0], sizes[k % 7][1], 1, codes ? LC_RASTER_U8 : LC_RASTER_F32);
        const lc_encoding linear = { LC_ENCODING_LINEAR, 1 };
        lc_mipmap m;
        CHECK(!lc_mipmap_build(ctx, &r, linear, &m));
        double want = 0;
        for (uint32_t i = 0; i < r.width * r.height; i++)
            want += plain_texel(&r, linear, i % r.width, i / r.width, LC_WRAP_CLAMP, 0) /
                    (r.width * r.height);
        CHECK(m.levels[m.n_levels - 1].width == 1 && m.levels[m.n_levels - 1].height == 1);
        double got[3];
        lc_mipmap_mean(&m, got);
        double slack = codes ? 0.5 / 255 * (m.n_levels - 1) + 1e-6 : 1e-6 * (1 + fabs(want));
        CHECKF(fabs(got[0] - want) <= slack, "%u x %u: %.9g for %.9g", r.width, r.height, got[0], want);
        lc_mipmap_lookup(&m, 0.3, 0.8, 1e30, LC_WRAP_CLAMP, LC_FILTER_TRILINEAR, got);
        CHECK(fabs(got[0] - want) <= slack);
        lc_mipmap_free(ctx, &m);
        lc_raster_free(ctx, &r);
    }
}

/* Filter widths of 2 and 4 texels belong to levels 1 and 2, and 2 sqrt 2 is halfway between them. The
 * bilinear filter takes the lower level. */
TEST(trilinear_between_levels)
{
    lc_raster r = make_raster(16, 16, 3, LC_RASTER_F32);
    lc_mipmap m;
    double a[3], b[3], half[3], low[3];
    CHECK(!lc_mipmap_build(ctx, &r, (lc_encoding){ LC_ENCODING_LINEAR, 1 }, &m) && m.n_levels == 5);
    for (uint64_t i = 0; i < 500; i++) {
        double s = rnd(), t = rnd();
        lc_mipmap_lookup(&m, s, t, 2, LC_WRAP_REPEAT, LC_FILTER_TRILINEAR, a);
        lc_mipmap_lookup(&m, s, t, 4, LC_WRAP_REPEAT, LC_FILTER_TRILINEAR, b);
        lc_mipmap_lookup(&m, s, t, 2 * sqrt(2), LC_WRAP_REPEAT, LC_FILTER_TRILINEAR, half);
        lc_mipmap_lookup(&m, s, t, 3.99, LC_WRAP_REPEAT, LC_FILTER_BILINEAR, low);
        for (int c = 0; c < 3; c++)
            CHECK(fabs(half[c] - 0.5 * (a[c] + b[c])) < 1e-9 && fabs(low[c] - a[c]) < 1e-9);
    }
    /* Texel (1, 2) of level 1 covers four texels of level 0. */
    lc_mipmap_lookup(&m, 1.5 / 8, 2.5 / 8, 2, LC_WRAP_REPEAT, LC_FILTER_TRILINEAR, a);
    double want = 0;
    for (int i = 0; i < 4; i++)
        want += (double)((const float *)r.data)[3 * ((4 + i / 2) * 16 + 2 + i % 2)] / 4;
    CHECK(fabs(a[0] - want) < 1e-6);
    lc_mipmap_free(ctx, &m);
    lc_raster_free(ctx, &r);
}

TEST(odd_arguments_do_no_harm)
{
    static const double odd[] = {
        0, -0.0, 1, -1, 1e-300, 1e18, -1e300, 0x1p-1074, 0.9999999999999999, -1e-18
    };
    lc_raster r = make_raster(5, 3, 3, LC_RASTER_U8);
    lc_mipmap m;
    CHECK(!lc_mipmap_build(ctx, &r, (lc_encoding){ LC_ENCODING_SRGB, 1 }, &m));
    for (uint64_t i = 0; i < 10 * 10 * 10 * 9; i++) {
        double out[3];
        lc_mipmap_lookup(&m, odd[i % 10], odd[i / 10 % 10], odd[i / 100 % 10], (lc_wrap)(i / 1000 % 3),
                         (lc_filter)(i / 3000), out);
        CHECK(out[0] >= 0 && out[0] <= 1.000001);
    }
    lc_mipmap_free(ctx, &m);
    lc_raster_free(ctx, &r);
    r = make_raster(2, 2, 1, LC_RASTER_F32);
    ((float *)r.data)[0] = NAN;
    ((float *)r.data)[1] = INFINITY;
    ((float *)r.data)[2] = FLT_MAX;
    ((float *)r.data)[3] = FLT_MAX;
    CHECK(!lc_mipmap_build(ctx, &r, (lc_encoding){ LC_ENCODING_SRGB, 1 }, &m));
    double out[3];
    lc_mipmap_mean(&m, out);
    CHECK(fabs(out[0] / (double)FLT_MAX - 0.5) < 1e-6);
    lc_mipmap_free(ctx, &m);
    lc_raster_free(ctx, &r);
}

/* ---- mappings ---- */

static const double identity[12] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 };

static lc_tex_map make_map(lc_tex_map_kind kind)
{
    lc_tex_map m = { kind, 1, 1, 0, 0, { 1, 0, 0 }, { 0, 1, 0 }, { 0 }, 1 };
    memcpy(m.to_texture, identity, sizeof identity);
    return m;
}

TEST(mappings_agree)
{
    for (uint64_t i = 0; i < 5000; i++) {
        lc_tex_point p = {
            { 4 * rnd() - 2, 4 * rnd() - 2, 4 * rnd() - 2 }, { rnd(), rnd() }, 2, 3, 1e-3, { 0, 0, 1 }
        };
        double st[2], w[2];
        lc_tex_map m = make_map(LC_MAP_UV);
        m.su = 3;
        m.sv = -2;
        m.du = 0.25;
        m.dv = 7;
        CHECK(lc_tex_map_2d(&m, &p, st, w));
        CHECK(fabs(st[0] - (3 * p.uv[0] + 0.25)) < 1e-12 && fabs(st[1] - (7 - 2 * p.uv[1])) < 1e-12);
        CHECK(fabs(w[0] - 6e-3) < 1e-12 && fabs(w[1] - 6e-3) < 1e-12);
        m = make_map(LC_MAP_PLANAR);
        m.v1[1] = 2;
        m.du = 0.5;
        m.to_texture[3] = 10; /* the texture's space is moved along x */
        CHECK(lc_tex_map_2d(&m, &p, st, w));
        CHECK(fabs(st[0] - (p.pos[0] + 10 + 2 * p.pos[1] + 0.5)) < 1e-12 && fabs(st[1] - p.pos[1]) < 1e-12);
        CHECK(fabs(w[0] - sqrt(5) * 1e-3) < 1e-12);
        double len = sqrt(p.pos[0] * p.pos[0] + p.pos[1] * p.pos[1] + p.pos[2] * p.pos[2]);
        double about = atan2(p.pos[1], p.pos[0]) / (2 * LC_PI);
        if (about < 0) about += 1;
        m = make_map(LC_MAP_SPHERICAL);
        CHECK(lc_tex_map_2d(&m, &p, st, w));
        CHECK(fabs(st[0] - acos(p.pos[2] / len) / LC_PI) < 1e-9 && fabs(st[1] - about) < 1e-12);
        m = make_map(LC_MAP_CYLINDRICAL);
        CHECK(lc_tex_map_2d(&m, &p, st, w));
        CHECK(fabs(st[0] - about) < 1e-12 && fabs(st[1] - p.pos[2]) < 1e-12);
    }
    lc_tex_point nowhere = { { 1e300, 0, 0 }, { 0, 0 }, 0, 0, 0, { 0, 0, 1 } };
    lc_tex_map m = make_map(LC_MAP_PLANAR);
    double st[2], w[2];
    m.to_texture[0] = 1e300;
    CHECK(!lc_tex_map_2d(&m, &nowhere, st, w));
}

/* ---- patterns ---- */

static lc_textures set;

static lc_texture make_texture(lc_tex_kind kind)
{
    lc_texture t = { .kind = kind, .scale = 1, .roughness = 0.5, .octaves = 8, .map = make_map(LC_MAP_UV) };
    for (int i = 0; i < 4; i++) t.in[i] = (lc_tex_input){ LC_NONE, { 0, 0, 0 } };
    return t;
}

static uint32_t add(const lc_texture *t)
{
    uint32_t id = 0;
    bool deep;
    CHECK(!lc_textures_add(&set, t, &id, &deep) && !deep);
    return id;
}

static lc_tex_point at_uv(double u, double v, double width)
{
    return (lc_tex_point){ { u, v, 0 }, { u, v }, 1, 1, width, { 0, 0, 1 } };
}

/* The checkerboard filtered by a triangle of radius 3/4 of a pixel, by the midpoint rule. */
static double plain_checker(double s, double t, double width)
{
    const int n = 200;
    double sum = 0, weight = 0, r = 0.75 * width;
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++) {
            double ds = (2 * (i + 0.5) / n - 1) * r, dt = (2 * (j + 0.5) / n - 1) * r;
            double w = (r - fabs(ds)) * (r - fabs(dt));
            sum += w * (fmod(fabs(floor(s + ds) + floor(t + dt)), 2) > 0);
            weight += w;
        }
    return sum / weight;
}

TEST(checkerboard)
{
    lc_texture t = make_texture(LC_TEX_CHECKER);
    t.in[1].value[0] = 1;
    uint32_t id = add(&t);
    double v[3];
    for (uint64_t i = 0; i < 300; i++) {
        double s = 10 * rnd() - 5, u = 10 * rnd() - 5, width = i % 3 ? 2 * rnd() : 0;
        lc_tex_point p = at_uv(s, u, width);
        lc_texture_eval(&set, id, &p, v);
        double want = width > 0 ? plain_checker(s, u, width) : fmod(fabs(floor(s) + floor(u)), 2);
        CHECKF(fabs(v[0] - want) < 0.01, "(%g, %g) width %g: %g for %g", s, u, width, v[0], want);
    }
    lc_tex_point far = at_uv(3.5, 4.5, 1e9);
    lc_texture_eval(&set, id, &far, v);
    CHECK(fabs(v[0] - 0.5) < 1e-6);
    t.solid = true;
    id = add(&t);
    for (int i = 0; i < 8; i++) {
        lc_tex_point p = {
            { (i & 1) + 0.5, (i >> 1 & 1) + 0.5, (i >> 2) - 0.5 }, { 0, 0 }, 0, 0, 0, { 0, 0, 1 }
        };
        lc_texture_eval(&set, id, &p, v);
        CHECK(v[0] == (double)(((i & 1) + (i >> 1 & 1) + (i >> 2) + 1) % 2));
    }
}

TEST(noise_is_noise)
{
    double most = 0, sum = 0, rough = 0;
    for (uint64_t i = 0; i < 200000; i++) {
        double x = 300 * rnd() - 150, y = 300 * rnd() - 150, z = 300 * rnd() - 150, v = lc_noise(x, y, z);
        most = fmax(most, fabs(v));
        sum += v;
        rough = fmax(rough, fabs(lc_noise(x + 1e-4, y, z) - v));
    }
    CHECKF(most > 0.7 && most < 1.1, "largest %g", most);
    CHECKF(fabs(sum / 200000) < 0.01, "mean %g", sum / 200000);
    CHECKF(rough < 1e-3, "step %g", rough);
    CHECK(lc_noise(3, -5, 255) == 0 && lc_noise(NAN, 0, 0) == 0 && lc_noise(1e300, 0.5, 0.5) == 0);
    CHECK(lc_noise(0.3, 0.6, 0.2) == lc_noise(256.3, 0.6, -255.8) ||
          fabs(lc_noise(0.3, 0.6, 0.2) - lc_noise(256.3, 0.6, -255.8)) < 1e-12);
    double p[3] = { 1.3, 2.6, 3.9 };
    CHECK(fabs(lc_fbm(p, 0, 0.5, 1) - lc_noise(1.3, 2.6, 3.9)) < 1e-15);
    CHECK(fabs(lc_fbm(p, 0, 0.5, 2) - lc_noise(1.3, 2.6, 3.9) -
               0.5 * lc_noise(1.99 * 1.3, 1.99 * 2.6, 1.99 * 3.9)) < 1e-12);
    CHECK(lc_fbm(p, 10, 0.5, 8) == 0 && fabs(lc_turbulence(p, 10, 0.5, 2) - 0.3) < 1e-15);
    CHECK(fabs(lc_fbm(p, 0.25, 0.5, 8) - lc_noise(1.3, 2.6, 3.9)) < 1e-15); /* -1 - log2(1/4) is one octave */
}

/* The mean that a texture states, which far lookups use, is about that over many points. */
TEST(means_are_about_right)
{
    for (int k = LC_TEX_CHECKER; k < LC_TEX_KINDS; k++) {
        lc_texture t = make_texture((lc_tex_kind)k);
        for (int i = 0; i < 4; i++) t.in[i].value[0] = 0.2 + 0.2 * i;
        t.variation = 0.2;
        if (k == LC_TEX_WOOD) t.scale = 8;
        uint32_t id = add(&t);
        double sum = 0, v[3];
        const int n = 40000;
        for (uint64_t i = 0; i < (uint64_t)n; i++) {
            double size = k == LC_TEX_BILERP ? 1 : 50;
            lc_tex_point p = at_uv(size * rnd(), size * rnd(), 0);
            p.pos[2] = 50 * rnd();
            lc_texture_eval(&set, id, &p, v);
            sum += v[0] / n;
        }
        CHECKF(fabs(sum - set.items[id].mean[0]) < 0.05, "%s: %g, stated %g",
               lc_tex_kind_name((lc_tex_kind)k), sum, set.items[id].mean[0]);
    }
}

TEST(wood_has_rings)
{
    lc_texture t = make_texture(LC_TEX_WOOD);
    t.scale = 2; /* rings 1/2 wide, without noise */
    t.in[0].value[0] = 0.25;
    t.in[1].value[0] = 0.75;
    uint32_t id = add(&t);
    double v[3];
    static const double r[] = { 0, 0.2, 0.4, 0.45, 0.5 }, want[] = { 0, 0.5, 1, 0.5, 0 };
    for (int i = 0; i < 5; i++) {
        lc_tex_point p = {
            { 0.6 * (r[i] + 1e-9), -0.8 * (r[i] + 1e-9), 17 * i }, { 0, 0 }, 0, 0, 0, { 0, 0, 1 }
        };
        lc_texture_eval(&set, id, &p, v);
        CHECKF(fabs(v[0] - 0.25 - 0.5 * want[i]) < 1e-6, "ring %g: %g", r[i], v[0]);
    }
    lc_tex_point far = { { 3.3, 0, 0 }, { 0, 0 }, 0, 0, 5, { 0, 0, 1 } };
    lc_texture_eval(&set, id, &far, v);
    CHECK(fabs(v[0] - 0.5) < 1e-9);
}

/* ---- graphs ---- */

TEST(textures_of_textures)
{
    lc_texture uv = make_texture(LC_TEX_UV), mix = make_texture(LC_TEX_MIX),
               scale = make_texture(LC_TEX_SCALE);
    uint32_t id = add(&uv);
    double v[3];
    lc_tex_point p = at_uv(1.25, -0.4, 0);
    mix.in[0] = (lc_tex_input){ LC_NONE, { 1, 1, 1 } };
    mix.in[1].id = id;
    mix.in[2] = (lc_tex_input){ LC_NONE, { 0.25, 0.25, 0.25 } };
    uint32_t mixed = add(&mix);
    lc_texture_eval(&set, mixed, &p, v);
    CHECK(fabs(v[0] - (0.75 + 0.25 * 0.25)) < 1e-12 && fabs(v[1] - (0.75 + 0.25 * 0.6)) < 1e-12 &&
          fabs(v[2] - 0.75) < 1e-12);
    scale.in[0].id = mixed;
    scale.in[1] = (lc_tex_input){ LC_NONE, { 2, 2, 2 } };
    scale.in[2].id = id;
    lc_texture_eval(&set, add(&scale), &p, v);
    CHECK(fabs(v[0] - 2 * (0.75 + 0.25 * 0.25) * 0.25) < 1e-12);
    /* A texture of constants becomes a constant. */
    lc_texture fixed = make_texture(LC_TEX_SCALE);
    for (int i = 0; i < 3; i++) fixed.in[i].value[0] = i + 2;
    CHECK(set.items[add(&fixed)].kind == LC_TEX_CONSTANT && set.items[set.n - 1].mean[0] == 24);
}

TEST(deep_textures_become_constants)
{
    lc_texture t = make_texture(LC_TEX_UV);
    uint32_t id = add(&t);
    bool deep = false;
    int n = 0;
    for (; n < 1000 && !deep; n++) { /* a chain of textures */
        t = make_texture(LC_TEX_SCALE);
        t.in[0].id = id;
        t.in[1].value[0] = t.in[2].value[0] = 1;
        CHECK(!lc_textures_add(&set, &t, &id, &deep));
    }
    CHECK(n == LC_TEX_MAX_DEPTH && set.items[id].kind == LC_TEX_CONSTANT &&
          fabs(set.items[id].mean[0] - 0.5) < 1e-12);
    t = make_texture(LC_TEX_UV);
    id = add(&t);
    for (n = 0; n < 1000; n++) { /* each is evaluated with twice the cost of the one before */
        t = make_texture(LC_TEX_MIX);
        t.in[0].id = t.in[1].id = id;
        t.in[2].value[0] = 0.5;
        CHECK(!lc_textures_add(&set, &t, &id, &deep));
        if (deep) break;
    }
    CHECKF(n < 12, "%d doublings", n);
}

int main(void)
{
    ctx = quiet_context(1);
    set.ctx = ctx;
    RUN(bilinear_agrees);
    RUN(levels_keep_the_mean);
    RUN(trilinear_between_levels);
    RUN(odd_arguments_do_no_harm);
    RUN(mappings_agree);
    RUN(checkerboard);
    RUN(noise_is_noise);
    RUN(means_are_about_right);
    RUN(wood_has_rings);
    RUN(textures_of_textures);
    RUN(deep_textures_become_constants);
    lc_textures_free(&set);
    lc_context_destroy(ctx);
    return test_done();
}
