/* unit_sky.c - this renderer's own LightSource "sun" and "sky": the sun's lights against a uniform disc of
 * its irradiance, its visible disc against the radiance of that, the sky against the formula of CIE's clear
 * sky. */
#include "prepare/env_light.h"
#include "scene/sun.h"
#include "support/one_scene.h"

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
        second += angle * angle / 500;
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
    CHECK(lc_f3_max(lc_scene_background(scene, beside(0, 0))) <= 0);
    for (int i = 0; i < 360; i++) {
        lc_f3 in = lc_background(scene, beside(r * 0.9999, i)),
              out = lc_background(scene, beside(r * 1.0001, i));
        CHECK(lc_f3_max(out) <= 0);
        CHECKF(fabs((double)in.x / radiance - 1) < 1e-5, "%g, not %g", (double)in.x, radiance);
    }
    lc_f3 centre = lc_background(scene, beside(0, 0));
    CHECK(fabs((double)centre.y / (2 * radiance) - 1) < 1e-5 &&
          fabs((double)centre.z / (0.5 * radiance) - 1) < 1e-5);
    CHECK(load("LightSource \"sun\" LightSource \"sun\"") == LC_OK); /* both are visible */
    CHECK(fabs((double)lc_background(scene, lc_f3_make(0, 0, 1)).x / (0.2 * radiance) - 1) < 1e-5);
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
    lc_f3 v = lc_scene_background(scene, lc_f3_make(0, 1, 0));
    /* At the pole the map shows the nearest texel, 0.35 degrees away. */
    CHECKF(fabs((double)v.x - 2) < 0.04 && fabs((double)v.z - 6) < 0.12, "%g %g", (double)v.x, (double)v.z);
    CHECK(!(lc_f3_max(lc_scene_background(scene, lc_f3_normalize(lc_f3_make(0.3f, -0.1f, 0.2f)))) > 0));
    for (int i = 0; i < 1000; i++) {
        double z = 0.03 + 0.96 * (i + 0.5) / 1000, phi = i * 2.4;
        lc_f3 w = lc_f3_normalize_d(sqrt(1 - z * z) * cos(phi), z, sqrt(1 - z * z) * sin(phi));
        double between = (double)lc_f3_dot(w, sun), want = 2 * clear_sky(z, 0.8, between),
               got = (double)lc_scene_background(scene, w).x;
        if (between < 0.9995) CHECKF(fabs(got / want - 1) < 0.02, "%d: %g, not %g", i, got, want);
    }
    CHECK(!lc_env_lights_make(scene, 1000, 5, 1) && scene->n_lights == 1000);
    CHECK(load("LightSource \"sky\" \"vector3 sun\" [0 0 -1]") == LC_ERR_PARSE);
    CHECK(load("LightSource \"sky\" \"vector3 sun\" [0 0 0]") == LC_ERR_PARSE);
}

int main(void)
{
    ctx = quiet_context(0);
    RUN(sun_fills_its_disc);
    RUN(sun_is_seen);
    RUN(sky_is_the_clear_one);
    one_scene_end();
    return test_done();
}
