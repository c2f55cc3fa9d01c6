/* unit_env.c - environment maps and the directional lights made from them: mappings against their inverse and
 * their areas, the sum of the lights against the integral of the map, where the lights lie, and the
 * directions that pbrt-v3 and pbrt-v4 give to a map's texels. */
#include "base/rng.h"
#include "prepare/env_light.h"
#include "scene/sun.h"
#include "support/near.h"
#include "support/one_scene.h"
#include "support/watched_memory.h"

#define RND_KEY 31
#include "support/rnd.h"

/* A map of w x h random texels, a few of them as bright as suns, added to a new scene. */
static lc_env *random_map(uint32_t w, uint32_t h, lc_env_mapping mapping)
{
    float *texels = malloc((size_t)w * h * 3 * sizeof *texels);
    for (size_t i = 0; i < (size_t)w * h; i++)
        for (size_t c = 0; c < 3; c++) {
            double u = lc_unit(lc_hash4(7, i, c, w));
            texels[3 * i + c] = (float)(u * (i % 97 == 5 ? 3000 : i % 3 ? 1 : 0));
        }
    lc_raster raster = { w, h, 3, LC_RASTER_F32, texels };
    lc_env env = { .mapping = mapping,
                   .scale = { 2, 1, 0.5f },
                   .to_world = lc_xform_identity(),
                   .to_light = lc_xform_identity() };
    scene_begin();
    if (lc_mipmap_build(ctx, &raster, (lc_encoding){ LC_ENCODING_LINEAR, 1 }, &env.map)) abort();
    if (lc_scene_add_env(scene, (lc_pos){ 0, 0, 0 }, &env)) abort();
    free(texels);
    return &scene->envs[0];
}

/* Sum of radiance times solid angle over the texels, the solid angles by their definition. */
static void integral(const lc_env *e, double sum[3])
{
    double rgb[3];
    uint32_t w = lc_env_width(e), h = lc_env_height(e);
    sum[0] = sum[1] = sum[2] = 0;
    for (uint32_t y = 0; y < h; y++) {
        double band = cos(LC_PI * y / h) - cos(LC_PI * (y + 1) / h);
        double solid = e->mapping == LC_ENV_EQUAL_AREA ? 4 * LC_PI / w / h : 2 * LC_PI / w * band;
        for (uint32_t x = 0; x < w; x++) {
            lc_env_texel(e, x, y, rgb);
            for (int c = 0; c < 3; c++) sum[c] += rgb[c] * solid;
        }
    }
}

TEST(places_and_directions)
{
    for (int k = 0; k < 2; k++) {
        lc_env *e = random_map(k ? 16 : 32, 16, k ? LC_ENV_EQUAL_AREA : LC_ENV_LATLONG);
        double solid = 0, mean[3] = { 0 };
        for (uint32_t y = 0; y < 16; y++) solid += lc_env_solid_angle(e, y) * lc_env_width(e);
        CHECK(near_abs(solid, 4 * LC_PI, 1e-12));
        for (int i = 0; i < 100000; i++) {
            double x = lc_unit(lc_hash2(1, (uint64_t)i)) * lc_env_width(e),
                   y = lc_unit(lc_hash2(2, (uint64_t)i)) * 16, w[3], s, t, v[3];
            if (!k) { /* the row and the place in it of a direction that is uniform over the sphere */
                double z = 1 - 2 * y / 16, line = acos(z) * 16 / LC_PI, row = floor(line);
                y = row + (cos(LC_PI * row / 16) - z) / (cos(LC_PI * row / 16) - cos(LC_PI * (row + 1) / 16));
            }
            lc_env_direction(e, x, y, w);
            CHECK(near_abs(w[0] * w[0] + w[1] * w[1] + w[2] * w[2], 1, 1e-12));
            lc_env_place(e, w, &s, &t);
            CHECKF(near_abs(s * lc_env_width(e), x, 1e-5) && near_abs(floor(t * 16), floor(y), 0),
                   "%g %g: %g %g", x, y, s, t);
            if (k) CHECK(near_abs(t * 16, y, 1e-5));
            lc_env_direction(e, s * lc_env_width(e), k ? t * 16 : y, v);
            for (int c = 0; c < 3; c++) {
                CHECK(near_abs(v[c], w[c], 1e-6));
                mean[c] += w[c] / 100000;
            }
        }
        for (int c = 0; c < 3; c++)
            CHECKF(near_abs(mean[c], 0, 0.01), "%g", mean[c]); /* uniform over the sphere */
    }
}

TEST(irradiance_is_kept)
{
    const uint32_t counts[] = { 1, 2, 3, 100, 5000, 20000 };
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 6; i++) {
            lc_env *e = random_map(k == 1 ? 40 : 61, k == 1 ? 40 : 31,
                                   k == 1 ? LC_ENV_EQUAL_AREA : LC_ENV_LATLONG);
            double want[3], got[3], mean = 0, most = 0;
            integral(e, want);
            CHECK(lc_env_lights_make(scene, counts[i], 5, 11) == LC_OK &&
                  lc_scene_join_lights(scene) == LC_OK);
            CHECKF(scene->n_lights == counts[i], "%zu lights", scene->n_lights);
            sum_of_lights(got);
            for (int c = 0; c < 3; c++)
                CHECKF(near_abs(got[c], want[c], 1e-6 * want[c]), "%u: %.9g, not %.9g", counts[i], got[c],
                       want[c]);
            for (size_t l = 0; l < scene->n_lights; l++) {
                lc_f3 v = scene->lights[l].intensity;
                double p = ((double)v.x + (double)v.y + (double)v.z) / 3;
                mean += p / (double)scene->n_lights;
                most = fmax(most, p);
            }
            CHECKF(most < 1.0001 * mean, "%u: %g over %g", counts[i], most, mean);
        }
}

static int by_bytes(const void *a, const void *b) { return memcmp(a, b, sizeof(lc_f3)); }

/* Distance of a unit direction from that of the nearest texel that is not black. */
static double nearest_lit(const lc_env *e, const double w[3])
{
    double least = HUGE_VAL, rgb[3], v[3];
    for (uint32_t y = 0; y < 64; y++)
        for (uint32_t x = 0; x < 64; x++) {
            lc_env_texel(e, x, y, rgb);
            lc_env_direction(e, x + 0.5, y + 0.5, v);
            if (rgb[0] > 0) least = fmin(least, hypot(hypot(v[0] - w[0], v[1] - w[1]), v[2] - w[2]));
        }
    return least;
}

/* No two lights have the same direction, and none is far from what of the map is not black. Without a view to
 * weigh them by, no seed changes them. */
TEST(directions_of_lights)
{
    lc_f3 *ways[3];
    const uint32_t n = 20000;
    for (int k = 0; k < 3; k++) {
        lc_env *e = random_map(64, 64, LC_ENV_EQUAL_AREA);
        CHECK(lc_env_lights_make(scene, n, 5, k == 2 ? 5 : 4) == LC_OK &&
              lc_scene_join_lights(scene) == LC_OK && scene->n_lights == n);
        ways[k] = malloc(n * sizeof **ways);
        for (uint32_t i = 0; i < n; i++) {
            double s, t, rgb[3], w[3];
            lc_f3 d = ways[k][i] = scene->lights[i].dir;
            w[0] = -(double)d.x;
            w[1] = -(double)d.y;
            w[2] = -(double)d.z;
            lc_env_place(e, w, &s, &t);
            lc_env_texel(e, (uint32_t)fmin(s * 64, 63), (uint32_t)fmin(t * 64, 63), rgb);
            /* The middle of what texels shed may lie between them, which are 0.055 wide, 0.08 across. */
            CHECKF(rgb[0] > 0 || nearest_lit(e, w) < 2 * (double)scene->lights[i].radius + 0.07, "%u: %g %g",
                   i, s * 64, t * 64);
        }
    }
    CHECK(!memcmp(ways[0], ways[1], n * sizeof **ways) && !memcmp(ways[0], ways[2], n * sizeof **ways));
    qsort(ways[0], n, sizeof **ways, by_bytes);
    for (uint32_t i = 1; i < n; i++) CHECK(memcmp(&ways[0][i - 1], &ways[0][i], sizeof **ways));
    for (int k = 0; k < 3; k++) free(ways[k]);
}

/* ---- scenes ---- */

/* A black map but for the texel (x, y). */
static void write_map(const char *name, uint32_t w, uint32_t h, uint32_t x, uint32_t y)
{
    float *rgb = calloc((size_t)w * h, 3 * sizeof *rgb), *at = rgb + 3 * ((size_t)y * w + x);
    if (!rgb) abort();
    at[0] = 1;
    at[1] = 0.5f;
    at[2] = 0.25f;
    pfm_write(temp_path(name), w, h, rgb);
    free(rgb);
}

static lc_status load(const char *text) { return parse_text_file("%s", text); }

/* The one light made from the map comes from (x, y, z). */
static bool light_is(double x, double y, double z)
{
    if (lc_env_lights_make(scene, 1, 5, 0) || scene->n_lights != 1) return false;
    lc_f3 d = scene->lights[0].dir;
    return (double)d.x * x + (double)d.y * y + (double)d.z * z < -0.999;
}

TEST(conventions)
{
    write_map("top.pfm", 128, 64, 3, 0);     /* latitude and longitude: the first row is at +z */
    write_map("side.pfm", 128, 64, 32, 32);  /* a quarter of the way around from +x: +y */
    write_map("square.pfm", 65, 65, 32, 32); /* equal areas: +z is in the middle */
    write_map("right.pfm", 65, 65, 64, 32);  /* +x in the middle of the right side */
    write_map("below.pfm", 65, 65, 32, 64);  /* +y in the middle of the last row */
    CHECK(load("WorldBegin LightSource \"infinite\" \"string mapname\" \"top.pfm\"") == LC_OK &&
          light_is(0, 0, 1));
    CHECK(load("WorldBegin LightSource \"infinite\" \"string mapname\" \"side.pfm\"") == LC_OK &&
          light_is(0, 1, 0));
    CHECK(load("WorldBegin Rotate -90 1 0 0 LightSource \"infinite\" \"string mapname\" \"top.pfm\"") ==
              LC_OK &&
          light_is(0, 1, 0));
    CHECK(load("WorldBegin LightSource \"infinite\" \"string filename\" \"square.pfm\"") == LC_OK &&
          light_is(0, 0, 1));
    CHECK(load("WorldBegin LightSource \"infinite\" \"string filename\" \"right.pfm\"") == LC_OK &&
          light_is(1, 0, 0));
    CHECK(load("WorldBegin LightSource \"infinite\" \"string filename\" \"below.pfm\"") == LC_OK &&
          light_is(0, 1, 0));
    CHECK(load("WorldBegin Scale 1 -1 1 LightSource \"infinite\" \"string filename\" \"below.pfm\"") ==
              LC_OK &&
          light_is(0, -1, 0));
    CHECK(load("WorldBegin LightSource \"infinite\" \"string filename\" \"lost.pfm\"") == LC_OK &&
          scene->n_notes == 1);
    CHECK(load("WorldBegin LightSource \"infinite\" \"point3 portal\" [0 0 0 1 0 0 1 1 0 0 1 0]") == LC_OK &&
          scene->n_notes == 1);
    CHECK(load("WorldBegin Scale 0 1 1 LightSource \"infinite\"") == LC_ERR_PARSE);
}

TEST(even_part_and_peaks_add_up)
{
    float map[8 * 8 * 3];
    for (int i = 0; i < 8 * 8 * 3; i++) map[i] = (float)rnd_in(0, 1);
    for (int k = 0; k < 3; k++) map[3 * 19 + k] = 40;
    pfm_write(temp_path("peak.pfm"), 8, 8, map);
    CHECK(load("WorldBegin LightSource \"infinite\" \"string filename\" \"peak.pfm\" \"float scale\" 3\n"
               "LightSource \"sun\" \"vector3 direction\" [0 3 4] \"rgb E\" [10 20 5]") == LC_OK);
    uint32_t n_peaks = 0;
    CHECK(!scene->n_notes);
    for (int i = 0; i < 20000; i++) {
        const lc_f3 dir = i ? rnd_unit() : lc_f3_make(0, 0.6f, 0.8f),
                    all = lc_background(scene, LC_SKY_ALL, dir),
                    even = lc_background(scene, LC_SKY_EVEN, dir),
                    peaks = lc_background(scene, LC_SKY_PEAKS, dir);
        const double sum = (double)even.y + (double)peaks.y;
        CHECKF(near_rel(sum, (double)all.y, 1e-5) && even.y >= 0 && peaks.y >= 0, "%g of %g", sum,
               (double)all.y);
        CHECKF(lc_luminance(even) < 4.001f * 3 * (0.5f + 40.f / 64), "%g", (double)even.y);
        if (i) n_peaks += peaks.y > 0;
        else CHECKF((double)peaks.y > 1e4, "a sun of %g", (double)peaks.y);
        lc_f3 of_group = lc_f3_make(0, 0, 0);
        lc_background_of_groups(scene, LC_SKY_PEAKS, dir, lc_f3_make(1, 2, 3), &of_group);
        CHECK(near_rel((double)of_group.y, 2 * (double)peaks.y, 1e-5));
    }
    CHECKF(n_peaks > 50 && n_peaks < 2000, "%u", n_peaks); /* about the one texel in 64 */
}

TEST(background)
{
    CHECK(load("WorldBegin Rotate -90 1 0 0 LightSource \"infinite\" \"string mapname\" \"side.pfm\" \"float "
               "scale\" 4 "
               "LightSource \"infinite\" \"rgb L\" [1 2 3]") == LC_OK);
    double w[3];
    lc_env_direction(&scene->envs[0], 32.5, 32.5, w); /* the middle of the texel; y goes to -z */
    lc_f3 at = lc_background(scene, LC_SKY_ALL, lc_f3_normalize_d(w[0], w[2], -w[1]));
    CHECKF(near_abs((double)at.x, 5, 0.01) && near_abs((double)at.y, 4, 0.01) &&
               near_abs((double)at.z, 4, 0.01),
           "%g", (double)at.x);
    at = lc_background(scene, LC_SKY_ALL, lc_f3_make(0, 0, 1));
    CHECK(near_abs((double)at.x, 1, 1e-6) && near_abs((double)at.z, 3, 1e-6));
}

static void check_sum(const char *light, double r, double g, double b)
{
    double sum[3];
    CHECKF(parse_text_file("Film \"rgb\" WorldBegin LightSource \"infinite\" %s", light) == LC_OK &&
               lc_env_lights_make(scene, 1000, 5, 0) == LC_OK,
           "%s", last_error);
    sum_of_lights(sum);
    CHECKF(near_abs(sum[0], r, 1e-5 * r) && near_abs(sum[1], g, 1e-5 * g) && near_abs(sum[2], b, 1e-5 * b),
           "%s: %g %g %g", light, sum[0], sum[1], sum[2]);
}

TEST(parameters)
{
    double all = 4 * LC_PI, texel = all / 65 / 65;
    check_sum("", all, all, all);
    check_sum("\"rgb L\" [1 2 3] \"float scale\" 2", 2 * all, 4 * all, 6 * all);
    check_sum("\"rgb L\" [1 2 3] \"float illuminance\" 6.2831853", 2 * all, 4 * all, 6 * all);
    check_sum("\"string filename\" \"square.pfm\"", texel, texel / 2, texel / 4);
    check_sum("\"string filename\" \"square.pfm\" \"rgb L\" [1 2 4]", texel, texel, texel);
    /* pbrt-v4 takes half of luminance times solid angle for the illuminance of a texel at the zenith. */
    double k = 2 / (0.2126 + 0.7152 / 2 + 0.0722 / 4);
    check_sum("\"string filename\" \"square.pfm\" \"float illuminance\" 5", 5 * k, 2.5 * k, 1.25 * k);
}

/* ---- more lights where they matter to the picture ---- */

/* A room without a ceiling, seen from inside. Its context is its own. */
static lc_scene *open_room(uint32_t n_threads, uint32_t n_lights, const char *light)
{
    lc_load_desc desc = LC_LOAD_DESC_INIT;
    desc.indirect_lights = LC_NO_LIGHTS;
    desc.env_lights = n_lights;
    return scene_from_text(
        quiet_context(n_threads), &desc,
        "LookAt 0 0 1  1 0 0  0 0 1 Camera \"perspective\" \"float fov\" 60 WorldBegin LightSource "
        "\"infinite\" %s "
        "Shape \"trianglemesh\" \"point3 P\" [-2 -2 0 2 -2 0 2 2 0 -2 2 0 -2 -2 4 2 -2 4 2 2 4 -2 2 4] "
        "\"integer indices\" [0 1 2 0 2 3 0 1 5 0 5 4 1 2 6 1 6 5 2 3 7 2 7 6 3 0 4 3 4 7]",
        light);
}

static void close_room(lc_scene *s)
{
    lc_context *c = s->ctx;
    lc_scene_destroy(s);
    lc_context_destroy(c);
}

/* Most lights come from above, where the room is open; all together they still have the power of the sky. */
TEST(lights_where_they_matter)
{
    static float even[100 * 100 * 3];
    const char *const lights[] = { "", "\"string filename\" \"soft.pfm\"" };
    for (size_t i = 0; i < sizeof even / sizeof *even; i++) even[i] = 1;
    pfm_write(temp_path("soft.pfm"), 100, 100, even);
    for (int k = 0; k < 2; k++) {
        lc_scene *s = open_room(1, 2000, lights[k]), *again = open_room(3, 2000, lights[k]);
        double sum = 0;
        uint32_t n_above = 0;
        if (!s || !again) return; /* which has failed the test */
        CHECK(s->n_lights == 2000 && s->n_env_lights == 2000 && s->n_env_tried > 2000 &&
              again->n_lights == 2000);
        for (size_t i = 0; i < s->n_lights; i++) {
            sum += (double)s->lights[i].intensity.y;
            n_above += s->lights[i].dir.z < -0.7f; /* a cap of 0.15 of the sphere */
        }
        CHECKF(near_abs(sum, 4 * LC_PI, 1e-5), "%.9g", sum);
        CHECKF(n_above > 1000, "%u of 2000 lights", n_above);
        CHECK(!memcmp(s->lights, again->lights, s->n_lights * sizeof *s->lights));
        close_room(s);
        close_room(again);
    }
}

/* ---- memory ---- */

static lc_status load_starved(lc_context *c)
{
    lc_load_desc desc = LC_LOAD_DESC_INIT;
    desc.indirect_lights = LC_NO_LIGHTS;
    desc.env_lights = 50;
    return load_file_in(c, &desc, scene_path());
}

TEST(every_allocation_may_fail)
{
    CHECK(
        load("Camera \"perspective\" WorldBegin LightSource \"infinite\" \"string filename\" \"square.pfm\" "
             "Shape \"sphere\" LightSource \"infinite\"") == LC_OK);
    starve(load_starved, 20);
}

int main(void)
{
    ctx = quiet_context(0);
    temp_begin();
    RUN(places_and_directions);
    RUN(irradiance_is_kept);
    RUN(directions_of_lights);
    RUN(conventions);
    RUN(even_part_and_peaks_add_up);
    RUN(background);
    RUN(parameters);
    RUN(lights_where_they_matter);
    RUN(every_allocation_may_fail);
    one_scene_end();
    temp_end();
    return test_done();
}
