/* spot_light.c - LightSource "spot", "projection" and "goniometric": lights whose intensity depends on
 * direction (light_spot.h).
 *
 * Pictures: "filename" (v4) or "mapname" (v3). v4 turns projections upside down against v3, and wants
 * goniometric maps square, by equal area, where v3's are by latitude and longitude; in both a goniometric
 * light's y and z are exchanged. A map's greatest value of each channel goes into the intensity, so that
 * kernels look up values of 0..1.
 */
#include "pbrt/light_source.h"

#include "photometry/photometry.h"
#include "scene/spot_picture.h"

#include <string.h>

#define MIN_KNOTS LC_SIZE(65u, 9u) /* along a side of an octahedron */
#define MAX_KNOTS 1025u            /* 12 MB */

/* ---- spot ---- */

/* The profile is pbrt-v4's smooth step between the cosines of the cone and of the angle where the falloff
 * begins; v3, which raises the same quotient to the fourth power, is read the same way. */
lc_status lc_pbrt_spot_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_light light = { .kind = LC_LIGHT_SPOT, .intensity = { 1, 1, 1 } };
    double to[3] = { 0, 0, 1 }, from[3] = { 0, 0, 0 }, cone = 30, delta = 5;
    const lc_pbrt_param *par;
    lc_status st = lc_pbrt_light_position(p, "from", NULL, &light.pos);
    if (!st) st = lc_pbrt_get_triple(&p->params, "from", from, NULL);
    if (!st) st = lc_pbrt_get_triple(&p->params, "to", to, NULL);
    for (int k = 0; k < 3; k++) to[k] -= from[k];
    if (!st) st = lc_pbrt_light_direction(p, s->pos, to, &light.dir);
    if (!st) st = lc_pbrt_get_float(&p->params, "coneangle", &cone, &par);
    if (!st && !(cone >= 0 && cone <= 180))
        return lc_pbrt_bad_param(&p->params, par, "is not 0 to 180 degrees");
    if (!st) st = lc_pbrt_get_float(&p->params, "conedeltaangle", &delta, &par);
    if (!st && !(fabs(delta) <= 180)) return lc_pbrt_bad_param(&p->params, par, "is not 0 to 180 degrees");
    double cos_total, cos_start;
    lc_spot_cosines(cone, delta, &cos_total, &cos_start);
    light.spot.cos_total = (float)cos_total;
    light.spot.cos_start = (float)cos_start;
    if (!st) st = lc_pbrt_get_colour(p, "I", LC_PBRT_FOR_LIGHT, &light.intensity, NULL);
    if (!st) st = lc_pbrt_light_scale(p, &light.intensity);
    /* v4's integral of the smooth step over solid angle: exact, as it is symmetric about its middle */
    double solid = 2 * LC_PI * ((1 - cos_start) + (cos_start - cos_total) / 2);
    if (!st && solid > 0) st = lc_pbrt_light_photometric(p, "power", 1 / solid, &light.intensity);
    return st || !(solid > 0) ? st : lc_scene_add_light(p->scene, s->pos, &light);
}

/* ---- maps ---- */

typedef struct shine {
    lc_light light;
    lc_env env;       /* the picture */
    lc_spot_map map;
    bool is_v4;       /* by what names the picture */
} shine;

static lc_status get_picture(lc_pbrt *p, shine *l)
{
    const char *v4 = NULL, *v3 = NULL;
    const lc_pbrt_param *v4_par, *v3_par;
    bool there = false;
    lc_status st = lc_pbrt_get_text(&p->params, "filename", &v4, &v4_par);
    if (!st) st = lc_pbrt_get_text(&p->params, "mapname", &v3, &v3_par);
    l->is_v4 = v4 && *v4;
    if (!st && l->is_v4) st = lc_pbrt_light_map(p, v4_par->pos, v4, LC_PBRT_STILL, &l->env.map, &there);
    else if (!st && v3 && *v3) st = lc_pbrt_light_map(p, v3_par->pos, v3, LC_PBRT_STILL, &l->env.map, &there);
    if (!st && !there) st = lc_pbrt_constant_map(p, &l->env.map);
    return st;
}

/* Position, axis, intensity; rows of the map's transform by x, y, z of the light. */
static lc_status get_frame(lc_pbrt *p, lc_pos where, shine *l)
{
    const double axis[3] = { 0, 0, 1 };
    lc_xform back;
    l->light = (lc_light){ .kind = LC_LIGHT_SPOT, .intensity = { 1, 1, 1 } };
    if (!lc_xform_invert(&p->ctm, &back))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "the light's transform is singular");
    double most = 0;
    for (int k = 0; k < 12; k++) most = k % 4 < 3 ? fmax(most, fabs(back.m[k])) : most;
    for (int k = 0; k < 9; k++) l->map.to_light[k / 3][k % 3] = (float)(back.m[k / 3 * 4 + k % 3] / most);
    lc_status st = lc_pbrt_light_position(p, "from", NULL, &l->light.pos);
    if (!st) st = lc_pbrt_light_direction(p, where, axis, &l->light.dir);
    if (!st) st = lc_pbrt_get_colour(p, "I", LC_PBRT_FOR_LIGHT, &l->light.intensity, NULL);
    if (!st) st = lc_pbrt_light_scale(p, &l->light.intensity);
    return st;
}

/* power: of the light at its present intensity, W. */
static lc_status add(lc_pbrt *p, lc_pos where, shine *l, double power)
{
    lc_status st = power > 0 ? lc_pbrt_light_photometric(p, "power", 1 / power, &l->light.intensity) : LC_OK;
    lc_spot_normalise(&l->map, &l->light.intensity);
    if (!st) st = lc_scene_add_spot_map(p->scene, &l->map, &l->light.spot.map);
    if (st) return st;
    l->map.texels = NULL;
    return lc_scene_add_light(p->scene, where, &l->light);
}

static lc_status finish(lc_pbrt *p, shine *l, lc_status st)
{
    lc_spot_map_free(p->ctx, &l->map);
    lc_mipmap_free(p->ctx, &l->env.map);
    return st;
}

/* ---- projection ---- */

static lc_status set_cone(lc_pbrt *p, lc_pos where, shine *l, const double half[2])
{
    double least = 1;
    for (int i = 0; i < 4; i++) {
        const double corner[3] = { i & 1 ? half[0] : -half[0], i & 2 ? half[1] : -half[1], 1 };
        lc_f3 d;
        lc_status st = lc_pbrt_light_direction(p, where, corner, &d);
        if (st) return st;
        least = fmin(least, (double)lc_f3_dot(d, l->light.dir));
    }
    lc_spot_set_frustum(&l->light, least);
    return LC_OK;
}

lc_status lc_pbrt_projection_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    shine l = { 0 };
    double half[2], fov, power;
    const lc_pbrt_param *par = NULL;
    lc_status st = get_frame(p, s->pos, &l);
    if (!st) st = get_picture(p, &l);
    if (st) return finish(p, &l, st);
    fov = l.is_v4 || p->v4 ? 90 : 45;
    st = lc_pbrt_get_float(&p->params, "fov", &fov, &par);
    if (!st && !(fov > 0 && fov < 180))
        st = lc_pbrt_bad_param(&p->params, par, "is not between 0 and 180 degrees");
    if (st) return finish(p, &l, st);
    for (int k = 0; k < 3 && l.is_v4; k++) l.map.to_light[1][k] = -l.map.to_light[1][k];
    st = lc_spot_project(p->ctx, &l.env.map, fov, &l.map, half, &power);
    if (!st) st = set_cone(p, s->pos, &l, half);
    if (!st) st = add(p, s->pos, &l, power);
    return finish(p, &l, st);
}

/* ---- goniometric ---- */

/* Direction of a place on the octahedron, -1..1. */
static lc_f3 octahedron(double x, double y)
{
    double z = 1 - fabs(x) - fabs(y), fold = z < 0 ? -z : 0;
    x -= copysign(fold, x);
    y -= copysign(fold, y);
    return lc_f3_normalize_d(x, y, z);
}

static void fill_octahedron(shine *l)
{
    for (uint32_t y = 0; y < l->map.height; y++)
        for (uint32_t x = 0; x < l->map.width; x++) {
            float *to = l->map.texels + ((size_t)y * l->map.width + x) * 3;
            lc_f3 v = lc_env_radiance(&l->env, octahedron(2.0 * x / (l->map.width - 1) - 1,
                                                          2.0 * y / (l->map.height - 1) - 1));
            lc_f3_store(to, v);
            if (l->is_v4) to[0] = to[1] = to[2] = (v.x + v.y + v.z) / 3;
            for (int c = 0; c < 3; c++) to[c] = fminf(to[c], LC_MAX_INTENSITY);
        }
}

/* Mean over solid angle of the channels' mean, times 4 pi. */
static double power_of(const lc_env *env)
{
    double sum = 0, rgb[3];
    for (uint32_t y = 0; y < lc_env_height(env); y++)
        for (uint32_t x = 0; x < lc_env_width(env); x++) {
            lc_env_texel(env, x, y, rgb);
            sum += (rgb[0] + rgb[1] + rgb[2]) / 3 * lc_env_solid_angle(env, y);
        }
    return sum;
}

lc_status lc_pbrt_goniometric_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    shine l = {
        .env = { .scale = { 1, 1, 1 }, .to_world = lc_xform_identity(), .to_light = lc_xform_identity() }
    };
    const char *name = NULL;
    lc_status st = lc_pbrt_get_text(&p->params, "filename", &name, NULL);
    if (!st && name && lc_photometry_is_name(name)) return lc_pbrt_luminaire_light(p, s);
    if (!st) st = get_frame(p, s->pos, &l);
    if (!st) st = get_picture(p, &l);
    if (st) return finish(p, &l, st);
    uint32_t w = lc_env_width(&l.env), h = lc_env_height(&l.env), side = 2 * (w > h ? w : h) + 1;
    l.env.mapping = l.is_v4 && w == h ? LC_ENV_EQUAL_AREA : LC_ENV_LATLONG;
    side = side < MIN_KNOTS ? MIN_KNOTS : side > MAX_KNOTS ? MAX_KNOTS : side;
    l.map.width = l.map.height = side;
    for (int k = 0; k < 3; k++) {
        float y = l.map.to_light[1][k];
        l.map.to_light[1][k] = l.map.to_light[2][k];
        l.map.to_light[2][k] = y;
    }
    l.light.spot.cos_total = -2; /* every direction */
    l.light.spot.cos_start = -1.5f;
    l.map.texels = lc_alloc_raw(p->ctx, (size_t)side * side * 3, sizeof *l.map.texels);
    if (!l.map.texels) return finish(p, &l, LC_ERR_MEMORY);
    fill_octahedron(&l);
    return finish(p, &l, add(p, s->pos, &l, power_of(&l.env)));
}
