/* build_emit.c - public calls of what emits: lights, those with pictures, the sun, environments, photometric
 * tables. */
#include "base/desc.h"
#include "base/rng.h"
#include "build/build.h"
#include "scene/named.h"
#include "scene/spot_picture.h"
#include "scene/sun.h"

#define MAX_TEXT       ((uint64_t)1 << 24) /* bytes of a photometric file */
#define MAX_ANGLES     16385u              /* of a table: those of a file, unfolded */
#define MAX_SUN_LIGHTS 100000u
#define MIN_KNOTS      LC_SIZE(65u, 9u)   /* along a side of an octahedron */
#define MAX_KNOTS      1025u              /* 12 MB */
#define GOLDEN_ANGLE   137.50776405003785 /* degrees */

/* ---- lights with pictures ---- */

/* Rows of the map's transform from the world to the light's x, y, z, and how far the frustum reaches. */
static void set_rows(const lc_build_light_desc *d, const lc_light *light, lc_spot_map *map)
{
    lc_xform frame, back;
    double x[3], most = 0;
    const float z[3] = { light->dir.x, light->dir.y, light->dir.z };
    if (lc_arg_frame(d, &frame) || d->kind == LC_BUILD_GONIOMETRIC) {
        (void)lc_xform_invert(&frame, &back); /* checked with the arguments */
        for (int k = 0; k < 12; k++) most = k % 4 < 3 ? fmax(most, fabs(back.m[k])) : most;
        for (int k = 0; k < 9; k++) map->to_light[k / 3][k % 3] = (float)(back.m[k / 3 * 4 + k % 3] / most);
        return;
    }
    lc_arg_across(d, light->dir, x);
    for (int k = 0; k < 3; k++) { /* y, towards the lower side of the picture, is x cross z */
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        map->to_light[0][k] = (float)x[k];
        map->to_light[1][k] = (float)(x[a] * (double)z[b] - x[b] * (double)z[a]);
        map->to_light[2][k] = z[k];
    }
}

/* The cosine to the widest of a frustum's corners. half: half the picture's sides at a distance of 1. */
static bool find_frustum(const lc_build_light_desc *d, const lc_light *light, const double half[2],
                         double *least)
{
    lc_xform frame;
    *least = 1 / sqrt(1 + half[0] * half[0] + half[1] * half[1]);
    if (!lc_arg_frame(d, &frame)) return true;
    *least = 1;
    for (int i = 0; i < 4; i++) {
        const double corner[3] = { i & 1 ? half[0] : -half[0], i & 2 ? half[1] : -half[1], 1 };
        lc_f3 to;
        if (!lc_arg_turned(&frame, corner, &to)) return false;
        *least = fmin(*least, (double)lc_f3_dot(to, light->dir));
    }
    return true;
}

static lc_status project(lc_scene *s, const lc_build_light_desc *d, lc_light *light, lc_spot_map *map,
                         double *power)
{
    double half[2], least;
    const lc_mipmap *picture = d->map != LC_NO_PICTURE ? lc_picture_map(s, d->map)
                                                       : lc_build_picture_of(s, d->picture);
    lc_status st = lc_spot_project(s->ctx, picture, d->fov, map, half, power);
    if (!st && !find_frustum(d, light, half, &least))
        st = lc_build_wrong(s, "lc_build_light", "the light's direction is zero or out of range");
    if (!st) lc_spot_set_frustum(light, least);
    return st;
}

/* Direction of a place on the octahedron, -1..1. */
static lc_f3 octahedron(double x, double y)
{
    double z = 1 - fabs(x) - fabs(y), fold = z < 0 ? -z : 0;
    x -= copysign(fold, x);
    y -= copysign(fold, y);
    return lc_f3_normalize_d(x, y, z);
}

static void fill_octahedron(const lc_env *env, bool grey, lc_spot_map *map)
{
    for (uint32_t y = 0; y < map->height; y++)
        for (uint32_t x = 0; x < map->width; x++) {
            float *to = map->texels + ((size_t)y * map->width + x) * 3;
            lc_f3 v = lc_env_radiance(env, octahedron(2.0 * x / (map->width - 1) - 1,
                                                      2.0 * y / (map->height - 1) - 1));
            lc_f3_store(to, v);
            if (grey) to[0] = to[1] = to[2] = (v.x + v.y + v.z) / 3;
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

/* The map of all directions; its pole is the light's y. */
static lc_status shine(lc_scene *s, const lc_build_light_desc *d, lc_light *light, lc_spot_map *map,
                       double *power)
{
    const lc_env env = { .mapping = d->equal_area ? LC_ENV_EQUAL_AREA : LC_ENV_LATLONG,
                         .map = *lc_picture_map(s, d->map), /* lent */
                         .scale = { 1, 1, 1 },
                         .to_world = lc_xform_identity(),
                         .to_light = lc_xform_identity() };
    uint32_t w = lc_env_width(&env), h = lc_env_height(&env), side = 2 * (w > h ? w : h) + 1;
    if (d->equal_area && w != h)
        return lc_build_wrong(s, "lc_build_light", "map: width and height must be equal with equal_area");
    side = side < MIN_KNOTS ? MIN_KNOTS : side > MAX_KNOTS ? MAX_KNOTS : side;
    map->width = map->height = side;
    for (int k = 0; k < 3; k++) {
        float y = map->to_light[1][k];
        map->to_light[1][k] = map->to_light[2][k];
        map->to_light[2][k] = y;
    }
    light->spot.cos_total = -2; /* every direction */
    light->spot.cos_start = -1.5f;
    map->texels = lc_alloc_raw(s->ctx, (size_t)side * side * 3, sizeof *map->texels);
    if (!map->texels) return LC_ERR_MEMORY;
    fill_octahedron(&env, d->grey, map);
    *power = power_of(&env);
    return LC_OK;
}

static void digest_map(lc_scene *s, const lc_build_light_desc *d, const lc_spot_map *map)
{
    const bool projects = d->kind == LC_BUILD_PROJECTOR;
    if (!lc_build_mark(s, projects ? LC_CALL_PROJECTOR : LC_CALL_GONIOMETRIC)) return;
    lc_digest_u64(&s->inputs.digest, (uint64_t)d->map << 32 | d->picture);
    lc_digest_u64(&s->inputs.digest, (d->equal_area ? 2u : 0) | (d->grey ? 1u : 0));
    lc_digest_number(&s->inputs.digest, d->fov);
    lc_digest_add(&s->inputs.digest, map->to_light, sizeof map->to_light);
}

/* Gives a checked projector or goniometric light its map. */
static lc_status make_map(lc_scene *s, const lc_build_light_desc *d, lc_light *light)
{
    lc_spot_map map = { .projected = d->kind == LC_BUILD_PROJECTOR };
    double power = 0;
    set_rows(d, light, &map);
    lc_status st = map.projected ? project(s, d, light, &map, &power) : shine(s, d, light, &map, &power);
    if (!st && power > 0 && d->power > 0)
        light->intensity = lc_f3_scale(light->intensity, (float)(d->power * (1 / power)));
    if (!st) {
        lc_spot_normalise(&map, &light->intensity);
        st = lc_scene_add_spot_map(s, &map, &light->spot.map);
        if (!st && (st = lc_build_status(s, lc_scene_check_light(s, s->at, light, light)))) s->n_spot_maps--;
    }
    if (st) lc_spot_map_free(s->ctx, &map);
    if (!st) digest_map(s, d, &map);
    return st;
}

/* A spot whose falloff is not the usual one has it as a map. */
static lc_status make_ramp(lc_scene *s, lc_light *light)
{
    lc_spot_map ramp;
    lc_spot_ramp(light, &ramp);
    return lc_scene_add_spot_map(s, &ramp, &light->spot.map);
}

/* ---- lights ---- */

/* Room for one more, after which lc_build_keep_light cannot fail for a host. */
static lc_status make_room(lc_scene *s)
{
    lc_given *g = &s->given;
    const lc_status st = lc_names_begin(s, LC_NAMED_LIGHT, s->by_calls ? g->n_lights : s->n_lights);
    if (st || !s->by_calls) return st;
    return lc_grow(s->ctx, (void **)&g->lights, &g->cap_lights, g->n_lights + 1, sizeof *g->lights);
}

lc_status lc_build_keep_light(lc_scene *s, const lc_light *light)
{
    const lc_status st = make_room(s);
    if (st) return st;
    if (!s->by_calls) return lc_scene_put_light(s, s->at, light);
    s->given.lights[s->given.n_lights++] = *light;
    return LC_OK;
}

lc_status lc_build_light(lc_scene *s, const lc_build_light_desc *desc)
{
    lc_light light;
    lc_build_light_desc d = LC_BUILD_LIGHT_DESC_INIT;
    lc_status st = lc_build_take(s, "lc_build_light", NULL, 0, NULL);
    if (st) return st;
    if (!desc || desc->size != sizeof *desc) { /* many lights come with the size known here: no copy */
        if ((st = lc_build_take(s, "lc_build_light_desc", &d, sizeof d, desc))) return st;
        desc = &d;
    }
    const uint32_t had = s->groups.n;
    st = lc_arg_light_of(s, "lc_build_light", desc, &light);
    if (!st) st = lc_build_begin_group(s, "lc_build_light", desc->group);
    if (!st) st = make_room(s);
    if (!st && desc->kind >= LC_BUILD_PROJECTOR) st = make_map(s, desc, &light);
    if (!st && desc->kind == LC_BUILD_SPOT && desc->falloff == LC_FALLOFF_SQUARED) st = make_ramp(s, &light);
    light.group = s->groups.now;
    if (!st) st = lc_build_keep_light(s, &light);
    return lc_build_end_group(s, had, st);
}

int lc_build_is_lit(const lc_scene *s)
{
    if (!s) return 0;
    bool lit = s->n_lights || s->n_envs || s->suns;
    for (size_t i = 0; i < s->given.n_lights && !lit; i++) lit = lc_f3_max(s->given.lights[i].intensity) > 0;
    for (size_t i = 0; i < s->n_meshes && !lit; i++) lit = lc_f3_max(s->meshes[i].emission) > 0;
    return lit;
}

/* ---- the sun ---- */

/* Two unit vectors that are orthogonal to a unit vector and to each other. */
static void frame_of(lc_f3 n, lc_f3 *x, lc_f3 *y)
{
    lc_f3 axis = fabsf(n.x) < 0.5f ? lc_f3_make(1, 0, 0) : lc_f3_make(0, 1, 0);
    *x = lc_f3_normalize(lc_f3_cross(axis, n));
    *y = lc_f3_cross(n, *x);
}

/* Lights on a spiral over the disc, each a disc for the same area of it; their places are drawn in so that
 * all of them have the disc's variance. */
static lc_status add_sun_lights(lc_scene *s, lc_f3 to_sun, lc_f3 e, double angle, uint32_t n)
{
    lc_light light = { .kind = LC_LIGHT_DIRECTIONAL,
                       .atten = { 1, 0, 0 },
                       .intensity = lc_f3_scale(e, 1 / (float)n) };
    double sine, cosine, radius;
    lc_f3 x, y;
    frame_of(to_sun, &x, &y);
    lc_sincos_deg(angle / 2, &sine, &cosine);
    radius = sine / cosine;
    if (radius > 0) {
        light.kind = LC_LIGHT_SKY;
        light.radius = (float)(radius / sqrt(n));
        radius *= sqrt(1 - 1.0 / n);
    }
    for (uint32_t i = 0; i < n; i++) {
        double r = radius * sqrt((i + lc_unit(lc_hash2(i, n))) / n);
        lc_sincos_deg(GOLDEN_ANGLE * i, &sine, &cosine);
        double a = r * cosine, b = r * sine;
        light.dir = lc_f3_normalize_d(-((double)to_sun.x + a * (double)x.x + b * (double)y.x),
                                      -((double)to_sun.y + a * (double)x.y + b * (double)y.y),
                                      -((double)to_sun.z + a * (double)x.z + b * (double)y.z));
        if (light.kind == LC_LIGHT_SKY) light.turn = i;
        lc_light kept;
        lc_status st = lc_build_status(s, lc_scene_check_light(s, s->at, &light, &kept));
        kept.group = s->groups.now;
        if (!st) st = lc_build_keep_light(s, &kept);
        if (st) return st;
    }
    return LC_OK;
}

lc_status lc_build_sun(lc_scene *s, const lc_build_sun_desc *desc)
{
    static const char call[] = "lc_build_sun";
    lc_build_sun_desc d = LC_BUILD_SUN_DESC_INIT;
    const lc_xform world = lc_xform_identity();
    lc_f3 dir;
    lc_status st = lc_build_take(s, "lc_build_sun_desc", &d, sizeof d, desc);
    if (st) return st;
    if (!lc_arg_turned(&world, d.direction, &dir))
        return lc_build_wrong(s, call, "direction is 0 or not finite");
    for (int k = 0; k < 3; k++)
        if (!(d.irradiance[k] >= 0 && d.irradiance[k] <= LC_MAX_INTENSITY))
            return lc_build_wrong(s, call, "irradiance is negative, not finite or above 1e15");
    if (!(d.angle >= 0 && d.angle <= 90)) return lc_build_wrong(s, call, "angle must be 0 to 90");
    if (d.n_lights < 1 || d.n_lights > MAX_SUN_LIGHTS)
        return lc_build_wrong(s, call, "n_lights must be 1 to 100000");
    const lc_f3 e = lc_f3_load(d.irradiance);
    const size_t before = s->given.n_lights;
    if ((st = lc_build_begin_group(s, call, NULL))) return st;
    st = add_sun_lights(s, dir, e, d.angle, d.angle > 0 ? d.n_lights : 1);
    if (!st && d.angle > 0) st = lc_scene_add_sun(s, dir, e, d.angle);
    if (st && s->by_calls) s->given.n_lights = before;
    if (st || !lc_build_mark(s, LC_CALL_SUN)) return st;
    lc_digest_add(&s->inputs.digest, &dir, sizeof dir);
    lc_digest_add(&s->inputs.digest, d.irradiance, sizeof d.irradiance);
    lc_digest_number(&s->inputs.digest, d.angle);
    lc_build_mark_group(s);
    return LC_OK;
}

/* ---- environments ---- */

static lc_status turn_environment(const lc_scene *s, const lc_build_environment_desc *d, lc_env *env)
{
    memcpy(env->to_world.m, d->to_world, sizeof env->to_world.m);
    if (lc_xform_finite(&env->to_world) && lc_xform_invert(&env->to_world, &env->to_light)) return LC_OK;
    return lc_build_wrong(s, "lc_build_environment", "to_world is singular or not finite");
}

/* What the upper half of the map makes on a surface that faces it. */
static double upper_illuminance(const lc_env *env)
{
    double sum = 0, rgb[3], w[3];
    for (uint32_t y = 0; y < lc_env_height(env); y++) {
        double solid = lc_env_solid_angle(env, y);
        for (uint32_t x = 0; x < lc_env_width(env); x++) {
            lc_env_direction(env, x + 0.5, y + 0.5, w);
            if (!(w[2] > 0)) continue;
            lc_env_texel(env, x, y, rgb);
            sum += (0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]) * w[2] * solid;
        }
    }
    return sum;
}

/* white: it is, or counts as that: where it varies the scale would be another in each frame. */
static lc_status scale_environment(const lc_scene *s, const lc_build_environment_desc *d, lc_env *env,
                                   bool white)
{
    const double has = !(d->illuminance > 0) ? 0 : white ? LC_PI : upper_illuminance(env);
    if (has > 0) env->scale = lc_f3_scale(env->scale, (float)(d->illuminance / has));
    if (lc_env_peak(env) <= LC_MAX_ENV_RADIANCE) return LC_OK;
    return lc_build_wrong(s, "lc_build_environment", "scale or illuminance gives a radiance above 1e13");
}

/* But for its scale, which can be set again: lc_given_id adds what became of it. */
static void digest_environment(lc_scene *s, const lc_build_environment_desc *d, bool square)
{
    if (!s->by_calls) return;
    lc_digest_add(&s->inputs.digest, d->to_world, sizeof d->to_world);
    lc_digest_u64(&s->inputs.digest, square);
    lc_build_mark_group(s);
}

static lc_status add_environment(lc_scene *s, const char *call, const lc_build_environment_desc *d,
                                 const lc_env *env)
{
    lc_status st = lc_build_begin_group(s, call, d->group);
    if (!st) st = lc_names_begin(s, LC_NAMED_ENVIRONMENT, s->n_envs);
    return st ? st : lc_build_status(s, lc_scene_add_env(s, s->at, env));
}

static lc_status environment_of_picture(lc_scene *s, const lc_build_environment_desc *d)
{
    static const char call[] = "lc_build_environment";
    lc_env env = { .mapping = d->equal_area ? LC_ENV_EQUAL_AREA : LC_ENV_LATLONG,
                   .scale = lc_f3_load(d->scale) };
    bool copied;
    if (d->picture >= s->given.n_pictures)
        return lc_build_wrong(s, call, "picture is not one of the scene's");
    const lc_mip_level *size = &lc_picture_map(s, d->picture)->levels[0];
    if (d->equal_area && size->width != size->height)
        return lc_build_wrong(s, call, "width and height must be equal with equal_area");
    if (!(d->illuminance >= 0 && isfinite(d->illuminance)))
        return lc_build_wrong(s, call, "illuminance is negative or not finite");
    lc_status st = turn_environment(s, d, &env);
    if (!st) st = lc_picture_for_environment(s, d->picture, &env.map, &copied);
    if (st) return st;
    const uint32_t had = s->groups.n;
    st = scale_environment(s, d, &env, !lc_picture_is_still(s, d->picture));
    if (!st) st = add_environment(s, call, d, &env);
    if (st) {
        lc_picture_leave(s, d->picture, &env.map, copied);
        return lc_build_end_group(s, had, st);
    }
    lc_picture_keep(s, d->picture, copied);
    if (lc_build_mark(s, LC_CALL_ENVIRONMENT)) lc_digest_u64(&s->inputs.digest, d->picture);
    digest_environment(s, d, d->equal_area != 0);
    return LC_OK;
}

lc_status lc_build_environment(lc_scene *s, const lc_build_environment_desc *desc)
{
    static const char call[] = "lc_build_environment";
    static const float white[3] = { 1, 1, 1 };
    lc_build_environment_desc d = LC_BUILD_ENVIRONMENT_DESC_INIT;
    lc_status st = lc_build_take(s, "lc_build_environment_desc", &d, sizeof d, desc);
    if (st) return st;
    if (d.picture != LC_NO_PICTURE) return environment_of_picture(s, &d);
    lc_build_texels_desc p = { d.width, d.height, 3, d.kind, d.texels, 0 };
    if (!d.texels) p = (lc_build_texels_desc){ 1, 1, 3, LC_BUILD_FLOATS, white, 0 };
    const bool square = !d.texels || d.equal_area;
    const char *wrong = lc_build_texels_fault(&p);
    if (!wrong && square && p.width != p.height) wrong = "width and height must be equal with equal_area";
    for (int k = 0; k < 3; k++)
        if (!(d.scale[k] >= 0 && d.scale[k] <= LC_MAX_INTENSITY))
            wrong = "scale is negative, not finite or above 1e15";
    if (!(d.illuminance >= 0 && isfinite(d.illuminance))) wrong = "illuminance is negative or not finite";
    if (wrong) return lc_build_wrong(s, call, wrong);
    lc_env env = { .mapping = square ? LC_ENV_EQUAL_AREA : LC_ENV_LATLONG, .scale = lc_f3_load(d.scale) };
    if ((st = turn_environment(s, &d, &env))) return st;
    if ((st = lc_build_make_map(s, &p, &env.map))) return st;
    const uint32_t had = s->groups.n;
    st = scale_environment(s, &d, &env, !d.texels);
    if (!st) st = add_environment(s, call, &d, &env);
    if (st) {
        lc_mipmap_free(s->ctx, &env.map);
        return lc_build_end_group(s, had, st);
    }
    if (lc_build_mark(s, LC_CALL_ENVIRONMENT)) lc_build_add_texels(s, &p);
    digest_environment(s, &d, square);
    return LC_OK;
}

/* ---- photometric tables ---- */

static bool rises(const float *v, uint32_t n, float least, float most)
{
    bool rising = v[0] >= least && v[n - 1] <= most;
    for (uint32_t i = 1; i < n; i++) rising &= v[i] > v[i - 1];
    return rising;
}

/* Whether two directions are unit and at right angles. */
static bool are_axes(const double a[3], const double b[3])
{
    double aa = 0, ab = 0, bb = 0;
    for (int k = 0; k < 3; k++) {
        aa += a[k] * a[k];
        ab += a[k] * b[k];
        bb += b[k] * b[k];
    }
    return fabs(aa - 1) < 1e-3 && fabs(bb - 1) < 1e-3 && fabs(ab) < 1e-3;
}

static const char *table_fault(const lc_build_luminaire_desc *d)
{
    if (!d->azimuth && !d->polar && !d->candela) return "text is NULL, and so is the table";
    if (!d->azimuth || d->n_azimuth < 2 || d->n_azimuth > MAX_ANGLES ||
        !rises(d->azimuth, d->n_azimuth, -360, 720))
        return "azimuth: 2 to 16385 rising angles of -360 to 720 are needed";
    if (!d->polar || d->n_polar < 2 || d->n_polar > MAX_ANGLES || !rises(d->polar, d->n_polar, 0, 180))
        return "polar: 2 to 16385 rising angles of 0 to 180 are needed";
    if (!d->candela) return "candela is NULL";
    for (size_t i = 0; i < (size_t)d->n_azimuth * d->n_polar; i++)
        if (!(d->candela[i] >= 0 && d->candela[i] <= LC_MAX_INTENSITY))
            return "candela: a value is negative or not finite";
    if (!are_axes(d->axis, d->zero)) return "axis and zero are not unit and at right angles";
    if (!(d->lumens >= 0 && isfinite(d->lumens))) return "lumens is negative or not finite";
    if (d->n_tilt > LC_PHOTO_MAX_ANGLES || (d->n_tilt && (!d->tilt_angle || !d->tilt_factor)))
        return "n_tilt must be at most 4096, its arrays not NULL";
    for (uint32_t i = 0; i < d->n_tilt; i++)
        if (!isfinite(d->tilt_angle[i]) || (i && !(d->tilt_angle[i] > d->tilt_angle[i - 1])) ||
            !(d->tilt_factor[i] >= 0 && d->tilt_factor[i] <= (double)LC_MAX_INTENSITY))
            return "tilt_angle must rise, tilt_factor be 0 or more";
    return NULL;
}

/* What lights need of a table besides the profile. */
static lc_status keep_table(const lc_scene *s, const lc_build_luminaire_desc *d, lc_photometry *out)
{
    const size_t n = d->n_tilt;
    *out = (lc_photometry){ .lumens = d->lumens, .n_tilt = d->n_tilt };
    lc_arena_init(&out->memory, s->ctx);
    memcpy(out->axis, d->axis, sizeof out->axis);
    memcpy(out->zero, d->zero, sizeof out->zero);
    out->tilt_angle = lc_arena_alloc(&out->memory, n, sizeof *out->tilt_angle);
    out->tilt_factor = lc_arena_alloc(&out->memory, n, sizeof *out->tilt_factor);
    if (!out->tilt_angle || !out->tilt_factor) return LC_ERR_MEMORY;
    if (n) memcpy(out->tilt_angle, d->tilt_angle, n * sizeof *out->tilt_angle);
    if (n) memcpy(out->tilt_factor, d->tilt_factor, n * sizeof *out->tilt_factor);
    return LC_OK;
}

static void digest_table(lc_digest *to, const lc_build_luminaire_desc *d)
{
    lc_digest_u64(to, (uint64_t)d->n_azimuth << 32 | d->n_polar);
    lc_digest_add(to, d->azimuth, d->n_azimuth * sizeof *d->azimuth);
    lc_digest_add(to, d->polar, d->n_polar * sizeof *d->polar);
    lc_digest_add(to, d->candela, (size_t)d->n_azimuth * d->n_polar * sizeof *d->candela);
    lc_digest_add(to, d->axis, sizeof d->axis);
    lc_digest_add(to, d->zero, sizeof d->zero);
    lc_digest_number(to, d->lumens);
    lc_digest_u64(to, d->n_tilt);
    if (d->n_tilt) lc_digest_add(to, d->tilt_angle, d->n_tilt * sizeof *d->tilt_angle);
    if (d->n_tilt) lc_digest_add(to, d->tilt_factor, d->n_tilt * sizeof *d->tilt_factor);
}

/* Reads the text, which the parsers need with a zero behind it. */
static lc_status read_text(const lc_scene *s, const lc_build_luminaire_desc *d, lc_photometry *out)
{
    const size_t n = (size_t)d->length;
    char *text = lc_alloc_raw(s->ctx, n + 1, 1);
    if (!text) return LC_ERR_MEMORY;
    memcpy(text, d->text, n);
    text[n] = 0;
    const lc_status st = d->eulumdat ? lc_ldt_parse(s->ctx, "lc_build_luminaire", text, n, out)
                                     : lc_ies_parse(s->ctx, "lc_build_luminaire", text, n, false, out);
    lc_free(s->ctx, text, n + 1, 1);
    return lc_as_arg(st);
}

lc_status lc_build_luminaire(lc_scene *s, const lc_build_luminaire_desc *desc, uint32_t *id)
{
    static const char call[] = "lc_build_luminaire";
    lc_build_luminaire_desc d = LC_BUILD_LUMINAIRE_DESC_INIT;
    lc_status st = lc_build_take(s, "lc_build_luminaire_desc", &d, sizeof d, desc);
    if (st) return st;
    if (!id) return lc_fail(s->ctx, LC_ERR_ARG, "%s: id is NULL", call);
    const char *wrong = d.text ? d.length > MAX_TEXT ? "length must be at most 2^24" : NULL : table_fault(&d);
    if (wrong) return lc_build_wrong(s, call, wrong);
    lc_given *g = &s->given;
    st = lc_grow(s->ctx, (void **)&g->fixtures, &g->cap_fixtures, g->n_fixtures + 1, sizeof *g->fixtures);
    if (st) return st;
    lc_fixture *f = &g->fixtures[g->n_fixtures];
    *f = (lc_fixture){ .profile = 0 };
    st = d.text ? read_text(s, &d, &f->file) : keep_table(s, &d, &f->file);
    lc_profile_desc profile = { f->file.azimuth, f->file.polar, f->file.candela, f->file.n_azimuth,
                                f->file.n_polar };
    if (!d.text) profile = (lc_profile_desc){ d.azimuth, d.polar, d.candela, d.n_azimuth, d.n_polar };
    if (!st) st = lc_profiles_add(s->ctx, &s->profiles, &profile, &f->profile, &f->peak);
    if (st) {
        lc_photometry_free(&f->file);
        return st;
    }
    *id = (uint32_t)g->n_fixtures++;
    if (!lc_build_mark(s, LC_CALL_LUMINAIRE)) return LC_OK;
    if (!d.text) digest_table(&s->inputs.digest, &d);
    if (d.text) lc_digest_u64(&s->inputs.digest, d.eulumdat != 0);
    if (d.text) lc_digest_add(&s->inputs.digest, d.text, (size_t)d.length);
    return LC_OK;
}
