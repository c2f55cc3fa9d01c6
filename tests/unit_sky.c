/* unit_sky.c - this renderer's own LightSource "sun" and "sky": the sun's lights against a uniform disc of
 * its irradiance, its visible disc against the radiance of that, the sky against the formula of CIE's clear
 * sky. */
#include "prepare/env_light.h"
#include "scene/sun.h"
#include "shade/cluster.h"
#include "shade/light_target.h"
#include "shade/point_init.h"
#include "support/one_scene.h"

#define RND_KEY 733
#include "support/rnd.h"

static lc_status load(const char *text) { return parse_format("WorldBegin %s", text); }

TEST(sun_fills_its_disc)
{
    double sum = 0, mean[3] = { 0, 0, 0 }, widest = 0, second = 0;
    CHECK(load("Rotate -90 1 0 0 LightSource \"sun\" \"vector3 direction\" [0 3 4] \"rgb E\" [10 20 30] "
               "\"float angle\" 2 \"integer lights\" 500") == LC_OK);
    CHECK(scene->n_lights == 500);
    const lc_f3 sun = lc_f3_make(0, 0.8f, -0.6f); /* +z is turned to +y */
    for (size_t i = 0; i < scene->n_lights; i++) {
        const lc_light *l = &scene->lights[i];
        double angle = acos(fmin(-(double)lc_f3_dot(l->dir, sun), 1));
        CHECK(l->kind == LC_LIGHT_SKY);
        widest = fmax(widest, angle);
        second += (angle * angle + (double)l->radius * (double)l->radius / 2) / 500;
        sum += (double)l->intensity.y;
        mean[0] += (double)l->dir.x / 500;
        mean[1] += (double)l->dir.y / 500;
        mean[2] += (double)l->dir.z / 500;
        for (size_t k = 0; k < i; k++) CHECK(memcmp(&l->dir, &scene->lights[k].dir, sizeof l->dir));
    }
    double r = LC_PI / 180;
    CHECKF(fabs(sum - 20) < 1e-4 && widest <= r * 1.001 && widest > 0.97 * r, "%g %g", sum, widest);
    CHECKF(fabs(second / (r * r) - 0.5) < 0.01, "%g", second / (r * r)); /* 1/2 for a uniform disc */
    CHECK(fabs(mean[0]) < 1e-4 && fabs(mean[1] + 0.8) < 3e-4 && fabs(mean[2] - 0.6) < 3e-4);
    CHECK(load("LightSource \"sun\" \"float angle\" 0") == LC_OK && scene->n_lights == 1);
    CHECK(load("LightSource \"sun\" \"vector3 direction\" [0 0 0]") == LC_ERR_PARSE);
    CHECK(load("LightSource \"sun\" \"integer lights\" 0") == LC_ERR_PARSE);
}

/* The unit vector `angle` radians from the direction of the sun at 0 3 4, on the side that `turn` gives. */
static lc_f3 beside(double angle, double turn)
{
    double s = sin(angle), c = cos(angle), x = s * cos(turn), y = s * sin(turn);
    return lc_f3_make((float)x, (float)(0.6 * c + 0.8 * y), (float)(0.8 * c - 0.6 * y));
}

TEST(sun_is_seen)
{
    const double r = 0.265 * LC_PI / 180, radiance = 10 / (LC_PI * sin(r) * sin(r));
    CHECK(load("LightSource \"sun\" \"vector3 direction\" [0 3 4] \"rgb E\" [10 20 5]") == LC_OK &&
          scene->n_lights == 64);
    CHECK(lc_f3_max(lc_background(scene, LC_SKY_EVEN, beside(0, 0))) <= 0);
    for (int i = 0; i < 360; i++) {
        lc_f3 in = lc_background(scene, LC_SKY_ALL, beside(r * 0.9999, i)),
              out = lc_background(scene, LC_SKY_ALL, beside(r * 1.0001, i));
        CHECK(lc_f3_max(out) <= 0);
        CHECKF(fabs((double)in.x / radiance - 1) < 1e-5, "%g, not %g", (double)in.x, radiance);
    }
    lc_f3 centre = lc_background(scene, LC_SKY_ALL, beside(0, 0));
    CHECK(fabs((double)centre.y / (2 * radiance) - 1) < 1e-5 &&
          fabs((double)centre.z / (0.5 * radiance) - 1) < 1e-5);
    CHECK(load("LightSource \"sun\" LightSource \"sun\"") == LC_OK); /* both are visible */
    const double both = (double)lc_background(scene, LC_SKY_ALL, lc_f3_make(0, 0, 1)).x;
    CHECK(fabs(both / (0.2 * radiance) - 1) < 1e-5);
    CHECK(load("LightSource \"sun\" \"float angle\" 0 LightSource \"sun\" \"float angle\" 1e-30") == LC_OK &&
          !scene->suns);
}

/* Relative luminance of [CIE03], sky type 12. */
static double clear_sky(double cos_zenith, double cos_sun, double cos_between)
{
    double f = 1 + 10 * (exp(-3 * acos(cos_between)) - exp(-3 * LC_PI / 2)) +
               0.45 * cos_between * cos_between;
    double f0 = 1 + 10 * (exp(-3 * acos(cos_sun)) - exp(-3 * LC_PI / 2)) + 0.45 * cos_sun * cos_sun;
    return f / f0 * (1 - exp(-0.32 / cos_zenith)) / (1 - exp(-0.32));
}

TEST(sky_is_the_clear_one)
{
    CHECK(load("Rotate -90 1 0 0 LightSource \"sky\" \"vector3 sun\" [3 0 4] \"rgb L\" [1 2 3] \"float "
               "scale\" 2") == LC_OK);
    CHECK(scene->n_envs == 1);
    const lc_f3 sun = lc_f3_make(0.6f, 0.8f, 0);
    lc_f3 v = lc_background(scene, LC_SKY_ALL, lc_f3_make(0, 1, 0));
    /* At the pole the map shows the nearest texel, 0.35 degrees away. */
    CHECKF(fabs((double)v.x - 2) < 0.04 && fabs((double)v.z - 6) < 0.12, "%g %g", (double)v.x, (double)v.z);
    CHECK(!(lc_f3_max(lc_background(scene, LC_SKY_ALL, lc_f3_normalize(lc_f3_make(0.3f, -0.1f, 0.2f)))) > 0));
    for (int i = 0; i < 1000; i++) {
        double z = 0.03 + 0.96 * (i + 0.5) / 1000, phi = i * 2.4;
        lc_f3 w = lc_f3_normalize_d(sqrt(1 - z * z) * cos(phi), z, sqrt(1 - z * z) * sin(phi));
        double between = (double)lc_f3_dot(w, sun), want = 2 * clear_sky(z, 0.8, between),
               got = (double)lc_background(scene, LC_SKY_ALL, w).x;
        if (between < 0.9995) CHECKF(fabs(got / want - 1) < 0.02, "%d: %g, not %g", i, got, want);
    }
    CHECK(!lc_env_lights_make(scene, 1000, 5, 1) && scene->n_lights == 1000);
    CHECK(load("LightSource \"sky\" \"vector3 sun\" [0 0 -1]") == LC_ERR_PARSE);
    CHECK(load("LightSource \"sky\" \"vector3 sun\" [0 0 0]") == LC_ERR_PARSE);
}

/* Directions of a light of the sky are unit, within its radius and its cluster's box, even over its disc. */
TEST(directions_fill_discs)
{
    for (int i = 0; i < 2000; i++) {
        lc_light light = { .kind = LC_LIGHT_SKY,
                           .dir = rnd_unit(),
                           .intensity = { 1, 1, 1 },
                           .radius = (float)pow(10, rnd_in(-6, 0)) };
        const float *dir = &light.dir.x;
        double sum[3] = { 0, 0, 0 }, square = 0;
        lc_light_rec rec;
        lc_cluster box;
        lc_point p = { .pos = { 0, 0, 0 } };
        lc_light_rec_init(&rec, &light);
        lc_cluster_from_light(&box, &light);
        for (p.turn = 0; p.turn < LC_TARGET_POINTS; p.turn++) {
            float to[3];
            double len2 = 0, along = 0, across2 = 0;
            lc_sky_target(&rec, &p, to);
            for (int k = 0; k < 3; k++) {
                len2 += (double)to[k] * (double)to[k];
                along -= (double)to[k] * (double)dir[k];
                CHECK(to[k] >= box.lo[k] && to[k] <= box.hi[k]);
            }
            for (int k = 0; k < 3; k++) {
                const double s = ((double)to[k] / along + (double)dir[k]) / (double)light.radius;
                sum[k] += s / LC_TARGET_POINTS;
                across2 += s * s;
            }
            const double slack = 1e-6 / (double)light.radius;
            CHECKF(fabs(len2 - 1) < 1e-6 && across2 < (1 + slack) * (1 + slack), "%g %g", len2, across2);
            square += across2 / LC_TARGET_POINTS;
        }
        if (light.radius < 1e-4f) continue; /* rounded */
        CHECKF(fabs(square - 0.5) < 0.05, "radius %g: %g", (double)light.radius, square);
        for (int k = 0; k < 3; k++) CHECKF(fabs(sum[k]) < 0.1, "to one side, %g", sum[k]);
    }
}

/* A floor beside a long wall, x = 0 to y = 4, that hides angles up to a from an even sky of radiance 1: the
 * floor gets pi (1 + cos a) / 2. */
#define FLOOR_BY_A_WALL                                                                                      \
    "Film \"rgb\" \"integer xresolution\" 96 \"integer yresolution\" 96 LookAt 4.5 20 0  4.5 0 0  0 0 1 "    \
    "Camera \"orthographic\" \"float screenwindow\" [-4 4 -4 4] PixelFilter \"box\" "                        \
    "WorldBegin LightSource \"infinite\" \"rgb L\" [1 1 1] Material \"diffuse\" \"rgb reflectance\" "        \
    "[.5 .5 .5] Shape \"trianglemesh\" \"point3 P\" [-99 0 -99 99 0 -99 99 0 99 -99 0 99] "                \
    "\"integer indices\" [0 2 1 0 3 2] Shape \"trianglemesh\" \"point3 P\" "                               \
    "[0 -1 -9999 0 4 -9999 0 4 9999 0 -1 9999] \"integer indices\" [0 2 1 0 3 2]"

#define FILM 96

/* The radiance of a pixel of FLOOR_BY_A_WALL: half of what is seen of the sky, (1 + cos a) / 2. */
static double want_of(uint32_t px)
{
    const double x = 0.5 + (px + 0.5) / 12;
    return 0.5 * (1 + x / hypot(x, 4)) / 2;
}

static void wall_errors(const lc_load_desc *l, double pixels[FILM * FILM], double blocks[FILM * FILM / 64])
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    CHECK(load_text(l, "%s", FLOOR_BY_A_WALL) == LC_OK);
    d.method = LC_METHOD_EXACT;
    CHECK(!lc_render(ctx, scene, &d, &image, NULL));
    for (uint32_t b = 0; image && b < FILM * FILM / 64; b++) {
        double got = 0, want = 0;
        for (uint32_t i = 0; i < 64; i++) {
            const uint32_t px = 8 * (b % (FILM / 8)) + i % 8,
                       at = (8 * (b / (FILM / 8)) + i / 8) * FILM + px;
            const double y = (double)lc_image_channel(image, "G")[at];
            pixels[at] = fabs(y / want_of(px) - 1);
            want += want_of(px);
            got += y;
        }
        blocks[b] = fabs(got / want - 1);
    }
    lc_image_destroy(image);
}

/* Every light has an edge of its shadow there; by lights of one direction each, blocks of pixels are off by
 * up to 0.63 %, 0.24 % rms. */
TEST(shadows_of_the_sky_have_no_bands)
{
    static double pixels[FILM * FILM], blocks[FILM * FILM / 64];
    const uint32_t n = FILM * FILM / 64;
    lc_load_desc l = LC_LOAD_DESC_INIT;
    double worst = 0, sum2 = 0;
    l.indirect_lights = LC_NO_LIGHTS;
    l.env_lights = 1500;
    l.spp = 1;
    wall_errors(&l, pixels, blocks);
    for (uint32_t b = 0; b < n; b++) {
        worst = fmax(worst, blocks[b]);
        sum2 += blocks[b] * blocks[b] / n;
    }
    printf("  blocks off by %.2g at most, %.2g rms\n", worst, sqrt(sum2));
    CHECKF(worst < 0.0045 && sqrt(sum2) < 0.0018, "blocks off by %g, %g rms", worst, sqrt(sum2));
}

static int rising(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Blocks along the wall are all off by the same, unlike normal errors, whose median is less. */
static void check_stated(const char *what, double *off, uint32_t n, double median, double high)
{
    qsort(off, n, sizeof *off, rising);
    const double m = off[n / 2], h = off[n * 95 / 100];
    printf("  %s off by %.2g, 95 %% by less than %.2g, stated %.2g, %.2g\n", what, m, h, median, high);
    CHECKF(median > m / 3.5 && median < m * 1.7 && high > h / 1.7 && high < h * 1.7,
           "%s off by %g, %g, stated %g, %g", what, m, h, median, high);
}

/* Beside the closed form. */
TEST(what_the_sky_is_off_by_is_stated)
{
    static double pixels[FILM * FILM], blocks[FILM * FILM / 64];
    lc_scene_info i = LC_SCENE_INFO_INIT;
    lc_load_desc l = LC_LOAD_DESC_INIT;
    double before = 1;
    l.indirect_lights = LC_NO_LIGHTS;
    l.spp = 1;
    for (l.env_lights = 100; l.env_lights < 2000; l.env_lights *= 4) {
        wall_errors(&l, pixels, blocks);
        CHECK(lc_scene_get_info(scene, &i) == LC_OK);
        check_stated("blocks", blocks, FILM * FILM / 64, i.sky_median, i.sky_high);
        check_stated("pixels", pixels, FILM * FILM, i.sky_grain_median, i.sky_grain_high);
        CHECK(i.sky_high < before);
        before = i.sky_high;
    }
    /* In the open lights at the horizon are all off to the same side: pictures are 0.067 % too dark. */
    l.env_lights = 6400;
    CHECK(load_text(&l, "%s", "Camera \"perspective\" Film \"image\" \"integer xresolution\" 16 "
                              "\"integer yresolution\" 16 WorldBegin LightSource \"infinite\" "
                              "Translate 0 0 2 Shape \"disk\" \"float radius\" 9") == LC_OK);
    CHECK(lc_scene_get_info(scene, &i) == LC_OK);
    CHECKF(i.sky_high > 3e-4 && i.sky_high < 3e-3 && i.sky_grain_high < 2e-3, "in the open %g %g", i.sky_high,
           i.sky_grain_high);
    CHECK(load_text(&l, "%s", "Camera \"perspective\" WorldBegin LightSource \"point\" Translate 0 0 2 "
                              "Shape \"disk\"") == LC_OK);
    CHECK(lc_scene_get_info(scene, &i) == LC_OK && i.sky_median < 0 && i.sky_high < 0);
}

int main(void)
{
    ctx = quiet_context(0);
    RUN(directions_fill_discs);
    RUN(shadows_of_the_sky_have_no_bands);
    RUN(what_the_sky_is_off_by_is_stated);
    RUN(sun_fills_its_disc);
    RUN(sun_is_seen);
    RUN(sky_is_the_clear_one);
    one_scene_end();
    return test_done();
}
