/* sky.c - two light sources that pbrt lacks, in the light's space with +z up. Both take "scale".
 *
 *     "sun"   vector3 direction   towards the sun, default 0 0 1
 *             rgb E               irradiance on a surface across the direction, W/m^2, default 1
 *             float angle         diameter in degrees, default 0.53
 *             integer lights      directional lights that represent it, default 64
 *     "sky"   vector3 sun         towards the sun
 *             rgb L               radiance at the zenith, W/(m^2 sr), default 1
 *
 * The sky is the CIE standard clear sky, type 12 [CIE03], in one colour and black below the horizon: an
 * environment map, which camera rays show. The sun's lights are on a spiral over its disc, each for the same
 * area of it; camera rays show the disc.
 */
#include "pbrt/light_source.h"

#include "base/fmath.h"
#include "base/rng.h"
#include "scene/sun.h"

#define SKY_W 512u
#define SKY_H 256u
#define MAX_SUN_LIGHTS 100000

/* Two unit vectors that are orthogonal to a unit vector and to each other. */
static void frame_of(lc_f3 n, lc_f3 *x, lc_f3 *y)
{
    lc_f3 axis = fabsf(n.x) < 0.5f ? lc_f3_make(1, 0, 0) : lc_f3_make(0, 1, 0);
    *x = lc_f3_normalize(lc_f3_cross(axis, n));
    *y = lc_f3_cross(n, *x);
}

static lc_status add_sun(lc_pbrt *p, lc_pos where, lc_f3 to_sun, lc_f3 e, double angle, uint32_t n)
{
    lc_light light = { .kind = LC_LIGHT_DIRECTIONAL,
                       .atten = { 1, 0, 0 },
                       .intensity = lc_f3_scale(e, 1 / (float)n) };
    double sine, cosine, radius, turn = 137.50776405003785;
    lc_f3 x, y;
    frame_of(to_sun, &x, &y);
    lc_sincos_deg(angle / 2, &sine, &cosine);
    radius = sine / cosine;
    for (uint32_t i = 0; i < n; i++) {
        double r = radius * sqrt((i + lc_unit(lc_hash2(i, n))) / n);
        lc_sincos_deg(turn * i, &sine, &cosine);
        double a = r * cosine, b = r * sine;
        light.dir = lc_f3_normalize_d(-((double)to_sun.x + a * (double)x.x + b * (double)y.x),
                                      -((double)to_sun.y + a * (double)x.y + b * (double)y.y),
                                      -((double)to_sun.z + a * (double)x.z + b * (double)y.z));
        lc_status st = lc_scene_add_light(p->scene, where, &light);
        if (st) return st;
    }
    return LC_OK;
}

lc_status lc_pbrt_sun_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    double to[3] = { 0, 0, 1 }, angle = 0.53;
    int64_t n = 64;
    lc_f3 e = lc_f3_make(1, 1, 1), dir;
    const lc_pbrt_param *par;
    lc_status st = lc_pbrt_get_triple(&p->params, "direction", to, NULL);
    if (!st) st = lc_pbrt_light_direction(p, s->pos, to, &dir);
    if (!st) st = lc_pbrt_get_colour(p, "E", LC_PBRT_FOR_LIGHT, &e, NULL);
    if (!st) st = lc_pbrt_light_scale(p, &e);
    if (!st) st = lc_pbrt_get_float(&p->params, "angle", &angle, &par);
    if (!st && !(angle >= 0 && angle <= 90))
        return lc_pbrt_bad_param(&p->params, par, "is not 0 to 90 degrees");
    if (!st) st = lc_pbrt_get_int(&p->params, "lights", &n, &par);
    if (!st && (n < 1 || n > MAX_SUN_LIGHTS)) return lc_pbrt_bad_param(&p->params, par, "is not 1 to 100000");
    if (!st) st = add_sun(p, s->pos, dir, e, angle, angle > 0 ? (uint32_t)n : 1);
    return st || !(angle > 0) ? st : lc_scene_add_sun(p->scene, dir, e, angle);
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

static lc_status paint(lc_pbrt *p, const double sun[3], lc_env *env)
{
    float *texels = lc_alloc_raw(p->ctx, SKY_W * SKY_H * 3, sizeof *texels);
    const lc_raster raster = { SKY_W, SKY_H, 3, LC_RASTER_F32, texels };
    if (!texels) return LC_ERR_MEMORY;
    env->map.levels[0].width = SKY_W; /* as lc_env_direction reads them */
    env->map.levels[0].height = SKY_H;
    for (uint32_t y = 0; y < SKY_H; y++)
        for (uint32_t x = 0; x < SKY_W; x++) {
            double w[3];
            lc_env_direction(env, x + 0.5, y + 0.5, w);
            for (size_t c = 0; c < 3; c++) texels[((size_t)y * SKY_W + x) * 3 + c] = (float)sky(w, sun);
        }
    lc_status st = lc_mipmap_build(p->ctx, &raster, (lc_encoding){ LC_ENCODING_LINEAR, 1 }, &env->map);
    lc_free(p->ctx, texels, SKY_W * SKY_H * 3, sizeof *texels);
    return st;
}

lc_status lc_pbrt_sky_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_env env = { .mapping = LC_ENV_LATLONG, .scale = { 1, 1, 1 }, .to_world = p->ctm };
    double sun[3] = { 0, 0, 1 }, len;
    const lc_pbrt_param *par;
    if (!lc_xform_invert(&p->ctm, &env.to_light))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "the light's transform is singular");
    lc_status st = lc_pbrt_get_triple(&p->params, "sun", sun, &par);
    if (st) return st;
    len = sqrt(sun[0] * sun[0] + sun[1] * sun[1] + sun[2] * sun[2]);
    if (!(len > 0 && len <= DBL_MAX)) return lc_pbrt_bad_param(&p->params, par, "is zero or out of range");
    if (sun[2] < 0) return lc_pbrt_bad_param(&p->params, par, "is below the horizon");
    for (int k = 0; k < 3; k++) sun[k] /= len;
    st = lc_pbrt_get_colour(p, "L", LC_PBRT_FOR_LIGHT, &env.scale, NULL);
    if (!st) st = lc_pbrt_light_scale(p, &env.scale);
    if (!st) st = paint(p, sun, &env);
    if (st) return st;
    st = lc_scene_add_env(p->scene, s->pos, &env);
    if (st) lc_mipmap_free(p->ctx, &env.map);
    return st;
}
