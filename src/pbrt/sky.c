/* sky.c - two light sources that pbrt lacks, in the light's space with +z up. Both take "scale".
 *
 *     "sun"   vector3 direction   towards the sun, default 0 0 1
 *             rgb E               irradiance on a surface across the direction, W/m^2, default 1
 *             float angle         diameter in degrees, default 0.53
 *             integer lights      lights of the sky that represent it, default 64
 *     "sky"   vector3 sun         towards the sun
 *             rgb L               radiance at the zenith, W/(m^2 sr), default 1
 *
 * The sky is the CIE standard clear sky, type 12 [CIE03], in one colour and black below the horizon: an
 * environment map, which camera rays show. The sun's lights are on a spiral over its disc, each for the same
 * area of it; camera rays show the disc.
 */
#include "pbrt/light_source.h"

#include "base/fmath.h"
#include "scene/env_map.h"

#include <string.h>

#define SKY_W          512u
#define SKY_H          256u
#define MAX_SUN_LIGHTS 100000

lc_status lc_pbrt_sun_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_build_sun_desc sun = LC_BUILD_SUN_DESC_INIT;
    double to[3] = { 0, 0, 1 };
    int64_t n = 64;
    lc_f3 e = lc_f3_make(1, 1, 1);
    const lc_pbrt_param *par;
    lc_status st = lc_pbrt_get_triple(&p->params, "direction", to, NULL);
    if (!st) st = lc_pbrt_light_direction(p, s->pos, to, sun.direction);
    if (!st) st = lc_pbrt_get_colour(p, "E", LC_PBRT_FOR_LIGHT, &e, NULL);
    if (!st) st = lc_pbrt_light_scale(p, &e);
    if (!st) st = lc_pbrt_get_float(&p->params, "angle", &sun.angle, &par);
    if (!st && !(sun.angle >= 0 && sun.angle <= 90))
        return lc_pbrt_bad_param(&p->params, par, "is not 0 to 90 degrees");
    if (!st) st = lc_pbrt_get_int(&p->params, "lights", &n, &par);
    if (!st && (n < 1 || n > MAX_SUN_LIGHTS)) return lc_pbrt_bad_param(&p->params, par, "is not 1 to 100000");
    if (!st) st = lc_pbrt_at(p, s->pos);
    if (st) return st;
    lc_f3_store(sun.irradiance, e);
    sun.n_lights = (uint32_t)n;
    return lc_build_sun(p->scene, &sun);
}

/* ---- sky ---- */

/* The scattering indicatrix of [CIE03] as a function of the cosine of the angle to the sun. */
static double indicatrix(double cosine)
{
    double angle = lc_atan2(sqrt(fmax(1 - cosine * cosine, 0)), cosine);
    return 1 + 10 * (lc_exp_neg(-3 * angle) - lc_exp_neg(-1.5 * LC_PI)) + 0.45 * cosine * cosine;
}

/* The luminance gradation of [CIE03] as a function of the cosine of the angle to the zenith. */
static double gradation(double cosine) { return cosine > 0 ? 1 - lc_exp_neg(-0.32 / cosine) : 1; }

/* The radiance in direction w relative to the zenith's; w and sun are unit vectors. */
static double sky(const double w[3], const double sun[3])
{
    if (!(w[2] > 0)) return 0;
    double cosine = fmin(fmax(w[0] * sun[0] + w[1] * sun[1] + w[2] * sun[2], -1), 1);
    return indicatrix(cosine) * gradation(w[2]) / (indicatrix(sun[2]) * gradation(1));
}

static lc_status paint(lc_pbrt *p, const double sun[3], uint32_t *picture)
{
    float *texels = lc_alloc_raw(p->ctx, SKY_W * SKY_H * 3, sizeof *texels);
    const lc_raster raster = { SKY_W, SKY_H, 3, LC_RASTER_F32, texels };
    lc_env env = { .mapping = LC_ENV_LATLONG }; /* as lc_env_direction reads it */
    if (!texels) return LC_ERR_MEMORY;
    env.map.levels[0].width = SKY_W;
    env.map.levels[0].height = SKY_H;
    for (uint32_t y = 0; y < SKY_H; y++)
        for (uint32_t x = 0; x < SKY_W; x++) {
            double w[3];
            lc_env_direction(&env, x + 0.5, y + 0.5, w);
            for (size_t c = 0; c < 3; c++) texels[((size_t)y * SKY_W + x) * 3 + c] = (float)sky(w, sun);
        }
    lc_status st = lc_build_raster(p->scene, &raster, LC_BUILD_LINEAR8, 0, picture);
    lc_free(p->ctx, texels, SKY_W * SKY_H * 3, sizeof *texels);
    return st;
}

lc_status lc_pbrt_sky_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_build_environment_desc env = LC_BUILD_ENVIRONMENT_DESC_INIT;
    lc_f3 zenith = lc_f3_make(1, 1, 1);
    double sun[3] = { 0, 0, 1 }, len;
    const lc_pbrt_param *par;
    lc_xform inverse;
    if (!lc_xform_invert(&p->ctm, &inverse))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "the light's transform is singular");
    memcpy(env.to_world, p->ctm.m, sizeof env.to_world);
    lc_status st = lc_pbrt_get_triple(&p->params, "sun", sun, &par);
    if (st) return st;
    len = sqrt(sun[0] * sun[0] + sun[1] * sun[1] + sun[2] * sun[2]);
    if (!(len > 0 && len <= DBL_MAX)) return lc_pbrt_bad_param(&p->params, par, "is zero or out of range");
    if (sun[2] < 0) return lc_pbrt_bad_param(&p->params, par, "is below the horizon");
    for (int k = 0; k < 3; k++) sun[k] /= len;
    st = lc_pbrt_get_colour(p, "L", LC_PBRT_FOR_LIGHT, &zenith, NULL);
    if (!st) st = lc_pbrt_light_scale(p, &zenith);
    if (!st) st = lc_pbrt_at(p, s->pos);
    if (!st) st = paint(p, sun, &env.picture);
    lc_f3_store(env.scale, zenith);
    return st ? st : lc_build_environment(p->scene, &env);
}
