/* env_map.c - directions to map points and back, in double. */
#include "scene/env_map.h"

#include "base/fmath.h"

void lc_env_texel(const lc_env *env, uint32_t x, uint32_t y, double rgb[3])
{
    lc_mipmap_texel(&env->map, x, y, rgb);
    rgb[0] = fmax(rgb[0] * (double)env->scale.x, 0);
    rgb[1] = fmax(rgb[1] * (double)env->scale.y, 0);
    rgb[2] = fmax(rgb[2] * (double)env->scale.z, 0);
}

double lc_env_peak(const lc_env *env)
{
    double most = 0, rgb[3];
    if (env->map.is_codes) return (double)lc_f3_max(env->scale);
    for (uint32_t y = 0; y < lc_env_height(env); y++)
        for (uint32_t x = 0; x < lc_env_width(env); x++) {
            lc_env_texel(env, x, y, rgb);
            most = fmax(most, fmax(rgb[0], fmax(rgb[1], rgb[2])));
        }
    return most;
}

/* z of the directions at height y of a latitude-longitude map. */
static double line_z(const lc_env *env, double y)
{
    double sine, cosine;
    lc_sincos_deg(180 * y / lc_env_height(env), &sine, &cosine);
    return cosine;
}

double lc_env_solid_angle(const lc_env *env, uint32_t y)
{
    double w = lc_env_width(env), h = lc_env_height(env);
    if (env->mapping == LC_ENV_EQUAL_AREA) return 4 * LC_PI / (w * h);
    return 2 * LC_PI / w * (line_z(env, y) - line_z(env, y + 1.0));
}

static void latlong_direction(const lc_env *env, double x, double y, double w[3])
{
    double row = fmin(floor(y), lc_env_height(env) - 1.0), f = y - row, sine, cosine;
    double z = (1 - f) * line_z(env, row) + f * line_z(env, row + 1), r = sqrt(fmax((1 - z) * (1 + z), 0));
    lc_sincos_deg(360 * x / lc_env_width(env), &sine, &cosine);
    w[0] = r * cosine;
    w[1] = r * sine;
    w[2] = z;
}

void lc_equal_area_direction(double s, double t, double w[3])
{
    double u = 2 * s - 1, v = 2 * t - 1, au = fabs(u), av = fabs(v), signed_d = 1 - (au + av);
    double r = 1 - fabs(signed_d), sine, cosine;
    lc_sincos_deg(r > 0 ? 45 * ((av - au) / r + 1) : 45, &sine, &cosine);
    double side = r * sqrt(fmax(2 - r * r, 0));
    w[0] = copysign(cosine, u) * side;
    w[1] = copysign(sine, v) * side;
    w[2] = copysign(1 - r * r, signed_d);
}

void lc_env_direction(const lc_env *env, double x, double y, double w[3])
{
    if (env->mapping == LC_ENV_LATLONG) latlong_direction(env, x, y, w);
    else lc_equal_area_direction(x / lc_env_width(env), y / lc_env_height(env), w);
}

static void equal_area_place(const double w[3], double len, double *s, double *t)
{
    double r = sqrt(fmax(1 - fabs(w[2]) / len, 0));
    double v = r * lc_atan2(fabs(w[1]), fabs(w[0])) * (2 / LC_PI), u = r - v;
    if (w[2] < 0) {
        double swap = u;
        u = 1 - v;
        v = 1 - swap;
    }
    *s = 0.5 * (copysign(u, w[0]) + 1);
    *t = 0.5 * (copysign(v, w[1]) + 1);
}

void lc_env_place(const lc_env *env, const double w[3], double *s, double *t)
{
    double flat = sqrt(w[0] * w[0] + w[1] * w[1]), len = sqrt(flat * flat + w[2] * w[2]);
    *s = *t = 0.5;
    if (!(len > 0)) return;
    if (env->mapping == LC_ENV_EQUAL_AREA) {
        equal_area_place(w, len, s, t);
        return;
    }
    *s = lc_atan2(w[1], w[0]) / (2 * LC_PI);
    if (*s < 0) *s += 1;
    *t = lc_atan2(flat, w[2]) / LC_PI;
}

lc_f3 lc_env_radiance(const lc_env *env, lc_f3 dir)
{
    const double v[3] = { (double)dir.x, (double)dir.y, (double)dir.z };
    double w[3], s, t, rgb[3], edge = 0.5 / lc_env_height(env);
    lc_xform_vector(&env->to_light, v, w);
    lc_env_place(env, w, &s, &t);
    t = fmin(fmax(t, edge), 1 - edge); /* no interpolation across the poles */
    lc_mipmap_lookup(&env->map, s, t, 1, env->mapping == LC_ENV_LATLONG ? LC_WRAP_REPEAT : LC_WRAP_CLAMP,
                     LC_FILTER_BILINEAR, rgb);
    return lc_f3_make((float)fmax(rgb[0] * (double)env->scale.x, 0),
                      (float)fmax(rgb[1] * (double)env->scale.y, 0),
                      (float)fmax(rgb[2] * (double)env->scale.z, 0));
}
