/* unit_env.c - environment maps: mappings, irradiance kept by the lights made of them, where these lie,
 * conventions of v3 and v4. */
#include "base/rng.h"
#include "pbrt/parse.h"
#include "prepare/env_light.h"
#include "support/last_error.h"
#include "support/near.h"
#include "support/poor.h"
#include "support/test.h"

#include <stdlib.h>
#include <unistd.h>

static char dir[] = "/tmp/unit_env.XXXXXX";
static lc_context *ctx;
static lc_scene *scene;

static void begin(void)
{
    lc_scene_destroy(scene);
    last_error[0] = 0;
    if (lc_scene_create(ctx, &scene)) abort();
}

/* A map of w x h texels, random with a few suns, added to a new scene. */
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
    begin();
    if (lc_mipmap_build(ctx, &raster, (lc_encoding){ LC_ENCODING_LINEAR, 1 }, &env.map)) abort();
    if (lc_scene_add_env(scene, (lc_pos){ 0, 0, 0 }, &env)) abort();
    free(texels);
    return &scene->envs[0];
}

/* Irradiance of the whole map, from every direction, by its definition. */
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

static void sum_of_lights(double sum[3])
{
    sum[0] = sum[1] = sum[2] = 0;
    for (size_t i = 0; i < scene->n_lights; i++) {
        lc_f3 v = scene->lights[i].intensity;
        sum[0] += (double)v.x;
        sum[1] += (double)v.y;
        sum[2] += (double)v.z;
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
            if (!k) { /* evenly over the sphere */
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
        for (int c = 0; c < 3; c++) CHECKF(near_abs(mean[c], 0, 0.01), "%g", mean[c]); /* equal areas */
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

/* No two lights from the same direction; each from where the map is not black; the same for a seed, another
 * for another. */
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
            double off = fmin(fmin(s * 64 - floor(s * 64), ceil(s * 64) - s * 64),
                              fmin(t * 64 - floor(t * 64), ceil(t * 64) - t * 64));
            /* Rounded to floats it may lie next door. */
            CHECKF(rgb[0] > 0 || off < 1e-4, "%u: %g %g", i, s * 64, t * 64);
        }
    }
    CHECK(!memcmp(ways[0], ways[1], n * sizeof **ways) && memcmp(ways[0], ways[2], n * sizeof **ways));
    qsort(ways[0], n, sizeof **ways, by_bytes);
    for (uint32_t i = 1; i < n; i++) CHECK(memcmp(&ways[0][i - 1], &ways[0][i], sizeof **ways));
    for (int k = 0; k < 3; k++) free(ways[k]);
}

/* ---- scenes ---- */

static void write_pfm(const char *name, uint32_t w, uint32_t h, uint32_t x, uint32_t y)
{
    char path[128];
    snprintf(path, sizeof path, "%s/%s", dir, name);
    FILE *f = fopen(path, "wb");
    if (!f) abort();
    fprintf(f, "PF\n%u %u\n-1\n", w, h);
    for (uint32_t j = h; j-- > 0;) /* from the bottom */
        for (uint32_t i = 0; i < w; i++) {
            float v = i == x && j == y ? 1 : 0, rgb[3] = { v, v / 2, v / 4 };
            fwrite(rgb, sizeof rgb, 1, f);
        }
    fclose(f);
}

static lc_status load(const char *text)
{
    char path[128];
    snprintf(path, sizeof path, "%s/s.pbrt", dir);
    FILE *f = fopen(path, "wb");
    if (!f) abort();
    fputs(text, f);
    fclose(f);
    begin();
    return lc_pbrt_parse(scene, path);
}

static bool light_is(double x, double y, double z)
{
    if (lc_env_lights_make(scene, 1, 5, 0) || scene->n_lights != 1) return false;
    lc_f3 d = scene->lights[0].dir;
    return (double)d.x * x + (double)d.y * y + (double)d.z * z < -0.999;
}

TEST(conventions)
{
    write_pfm("top.pfm", 128, 64, 3, 0);      /* latitude-longitude: the first row is +z */
    write_pfm("side.pfm", 128, 64, 32, 32);   /* a quarter around from +x: +y */
    write_pfm("square.pfm", 65, 65, 32, 32);  /* the middle: +z */
    write_pfm("right.pfm", 65, 65, 64, 32);   /* the middle of the right side: +x */
    write_pfm("below.pfm", 65, 65, 32, 64);   /* of the last row: +y */
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

TEST(background)
{
    CHECK(load("WorldBegin Rotate -90 1 0 0 LightSource \"infinite\" \"string mapname\" \"side.pfm\" \"float "
               "scale\" 4 "
               "LightSource \"infinite\" \"rgb L\" [1 2 3]") == LC_OK);
    double w[3];
    lc_env_direction(&scene->envs[0], 32.5, 32.5, w); /* the middle of the texel; y goes to -z */
    lc_f3 at = lc_scene_background(scene, lc_f3_normalize_d(w[0], w[2], -w[1]));
    CHECKF(near_abs((double)at.x, 5, 0.01) && near_abs((double)at.y, 4, 0.01) &&
               near_abs((double)at.z, 4, 0.01),
           "%g", (double)at.x);
    at = lc_scene_background(scene, lc_f3_make(0, 0, 1));
    CHECK(near_abs((double)at.x, 1, 1e-6) && near_abs((double)at.z, 3, 1e-6));
}

static void check_sum(const char *light, double r, double g, double b)
{
    char text[256];
    double sum[3];
    snprintf(text, sizeof text, "Film \"rgb\" WorldBegin LightSource \"infinite\" %s", light);
    CHECKF(load(text) == LC_OK && lc_env_lights_make(scene, 1000, 5, 0) == LC_OK, "%s", last_error);
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
    /* pbrt-v4's illuminance: half of luminance times solid angle, as the texel is at the zenith */
    double k = 2 / (0.2126 + 0.7152 / 2 + 0.0722 / 4);
    check_sum("\"string filename\" \"square.pfm\" \"float illuminance\" 5", 5 * k, 2.5 * k, 1.25 * k);
}

/* ---- what matters to the picture ---- */

/* A room that is open above, seen from inside: most lights come from there, and all together are the sky
 * still. */
static lc_scene *open_room(uint32_t n_threads, uint32_t n_lights, const char *light)
{
    char path[128];
    lc_context *c;
    lc_scene *s = NULL;
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    lc_load_desc load_desc = LC_LOAD_DESC_INIT;
    desc.n_threads = n_threads;
    load_desc.env_lights = n_lights;
    snprintf(path, sizeof path, "%s/room.pbrt", dir);
    FILE *f = fopen(path, "wb");
    if (!f || lc_context_create(&desc, &c)) abort();
    fprintf(f,
            "LookAt 0 0 1  1 0 0  0 0 1 Camera \"perspective\" \"float fov\" 60 WorldBegin LightSource "
            "\"infinite\" %s "
            "Shape \"trianglemesh\" \"point3 P\" [-2 -2 0 2 -2 0 2 2 0 -2 2 0 -2 -2 4 2 -2 4 2 2 4 -2 2 4] "
            "\"integer indices\" [0 1 2 0 2 3 0 1 5 0 5 4 1 2 6 1 6 5 2 3 7 2 7 6 3 0 4 3 4 7]",
            light);
    fclose(f);
    CHECK(lc_scene_load(c, path, &load_desc, &s) == LC_OK);
    return s;
}

static void close_room(lc_scene *s)
{
    lc_context *c = s->ctx;
    lc_scene_destroy(s);
    lc_context_destroy(c);
}

TEST(lights_where_they_matter)
{
    const char *const lights[] = { "", "\"string filename\" \"soft.pfm\"" };
    char path[128];
    snprintf(path, sizeof path, "%s/soft.pfm", dir);
    FILE *f = fopen(path, "wb");
    if (!f) abort();
    fprintf(f, "PF\n100 100\n-1\n");
    for (int i = 0; i < 10000; i++) fwrite((float[3]){ 1, 1, 1 }, sizeof(float[3]), 1, f);
    fclose(f);
    for (int k = 0; k < 2; k++) {
        lc_scene *s = open_room(1, 2000, lights[k]), *again = open_room(3, 2000, lights[k]);
        double sum = 0;
        uint32_t n_above = 0;
        CHECK(s->n_lights == 2000 && s->n_env_lights == 2000 && s->n_env_tried > 2000 &&
              again->n_lights == 2000);
        for (size_t i = 0; i < s->n_lights; i++) {
            sum += (double)s->lights[i].intensity.y;
            n_above += s->lights[i].dir.z < -0.7f; /* 0.15 of the sphere */
        }
        CHECKF(near_abs(sum, 4 * LC_PI, 1e-5), "%.9g", sum);
        CHECKF(n_above > 1000, "%u of 2000 lights", n_above);
        CHECK(!memcmp(s->lights, again->lights, s->n_lights * sizeof *s->lights));
        close_room(s);
        close_room(again);
    }
}

/* ---- memory ---- */

TEST(every_allocation_fails_in_turn)
{
    char path[128];
    CHECK(
        load("Camera \"perspective\" WorldBegin LightSource \"infinite\" \"string filename\" \"square.pfm\" "
             "Shape \"sphere\" LightSource \"infinite\"") == LC_OK);
    lc_context *small = poor_context();
    snprintf(path, sizeof path, "%s/s.pbrt", dir);
    lc_status st = LC_ERR_MEMORY;
    long n = 0;
    for (; st == LC_ERR_MEMORY && n < 1000; n++) {
        lc_scene *s;
        lc_load_desc load_desc = LC_LOAD_DESC_INIT;
        load_desc.env_lights = 50;
        allocations_left = n;
        st = lc_scene_load(small, path, &load_desc, &s);
        allocations_left = -1;
        lc_scene_destroy(s);
    }
    CHECKF(st == LC_OK && n > 20, "status %d after %ld", st, n);
    lc_context_destroy(small);
}

int main(void)
{
    if (!mkdtemp(dir) || !(ctx = quiet_context(0))) return 1;
    RUN(places_and_directions);
    RUN(irradiance_is_kept);
    RUN(directions_of_lights);
    RUN(conventions);
    RUN(background);
    RUN(parameters);
    RUN(lights_where_they_matter);
    RUN(every_allocation_fails_in_turn);
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
    char clean[64];
    snprintf(clean, sizeof clean, "rm -r %s", dir);
    if (system(clean)) printf("could not remove %s\n", dir);
    return test_done();
}
