/* infinite.c - LightSource "infinite": a constant, or an image "filename" (v4) or "mapname" (v3).
 *
 * A square image given by "filename" has pbrt-v4's equal-area mapping; all others are latitude-longitude
 * maps.
 */
#include "pbrt/light_source.h"

#include "io/readfile.h"
#include "scene/sequence.h"

#include <string.h>

#define MAX_NAME 4096

/* A name with a number, where no file has the very name: the picture of the scene's frame. *there stays false
 * for other names. */
static lc_status read_sequence(lc_pbrt *p, lc_pos where, const char *name, lc_pbrt_picture what,
                               lc_mipmap *out, bool *there)
{
    char one[MAX_NAME];
    const char *path;
    const size_t n = lc_frame_name(name, p->scene->frame, one, sizeof one);
    if (!n || n >= sizeof one || what == LC_PBRT_STILL) return LC_OK;
    lc_status st = lc_pbrt_find_file(&p->lex, where, one, &path);
    if (!st) st = lc_scene_add_sequence(p->scene, where, path, name, what == LC_PBRT_OF_SKY, out);
    *there = !st;
    return st;
}

lc_status lc_pbrt_light_map(lc_pbrt *p, lc_pos where, const char *name, lc_pbrt_picture what, lc_mipmap *out,
                            bool *there)
{
    const char *path;
    *there = false;
    if (p->lex.no_files)
        return lc_pbrt_note(p, where, "light image",
                            "'%.150s': this scene may not open files; a constant takes its place", name);
    lc_status st = lc_pbrt_find_file(&p->lex, where, name, &path);
    if (st) return st;
    if (!lc_file_exists(path) && ((st = read_sequence(p, where, name, what, out, there)) || *there))
        return st;
    if (!lc_file_exists(path))
        return lc_pbrt_note(p, where, "light image", "'%.150s': no such file; a constant takes its place",
                            path);
    st = lc_picture_read(p->ctx, where, path, out);
    *there = !st;
    return st;
}

lc_status lc_pbrt_constant_map(lc_pbrt *p, lc_mipmap *out)
{
    float white[3] = { 1, 1, 1 };
    const lc_raster raster = { 1, 1, 3, LC_RASTER_F32, white };
    return lc_mipmap_build(p->ctx, &raster, (lc_encoding){ LC_ENCODING_LINEAR, 1 }, out);
}

static lc_status get_map(lc_pbrt *p, lc_env *env, bool *is_image)
{
    const char *v4 = NULL, *v3 = NULL;
    const lc_pbrt_param *v4_par, *v3_par;
    lc_status st = lc_pbrt_get_text(&p->params, "filename", &v4, &v4_par);
    if (!st) st = lc_pbrt_get_text(&p->params, "mapname", &v3, &v3_par);
    *is_image = false;
    if (!st && v4 && *v4) st = lc_pbrt_light_map(p, v4_par->pos, v4, LC_PBRT_OF_SKY, &env->map, is_image);
    else if (!st && v3 && *v3)
        st = lc_pbrt_light_map(p, v3_par->pos, v3, LC_PBRT_OF_SKY, &env->map, is_image);
    env->mapping = LC_ENV_EQUAL_AREA;
    if (*is_image && (!(v4 && *v4) || lc_env_width(env) != lc_env_height(env))) env->mapping = LC_ENV_LATLONG;
    return st || *is_image ? st : lc_pbrt_constant_map(p, &env->map);
}

/* The illuminance of a surface by the upper half of the map. It includes pbrt-v4's factor of 1/2: pbrt takes
 * texels for half as large as they are. */
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
    return 0.5 * sum;
}

static lc_status apply_illuminance(lc_pbrt *p, lc_env *env, bool is_image)
{
    double wanted = 0;
    lc_status st = lc_pbrt_get_float(&p->params, "illuminance", &wanted, NULL);
    if (st || !(wanted > 0)) return st;
    /* A sequence counts as white, or the illuminance would be another in each frame. */
    const lc_sequence *last = p->scene->sequences + p->scene->n_sequences;
    const bool varies = p->scene->n_sequences && last[-1].is_env && last[-1].map == p->scene->n_envs;
    double has = is_image && !varies ? upper_illuminance(env) : LC_PI;
    if (has > 0) env->scale = lc_f3_scale(env->scale, (float)(wanted / has));
    return LC_OK;
}

lc_status lc_pbrt_infinite_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_env env = { .scale = { 1, 1, 1 }, .to_world = p->ctm };
    bool is_image = false;
    if (!lc_xform_invert(&p->ctm, &env.to_light))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "the light's transform is singular");
    lc_status st = lc_pbrt_get_colour(p, "L", LC_PBRT_FOR_LIGHT, &env.scale, NULL);
    if (!st) st = lc_pbrt_light_scale(p, &env.scale);
    if (!st) st = get_map(p, &env, &is_image);
    if (!st) st = apply_illuminance(p, &env, is_image);
    if (!st) st = lc_scene_add_env(p->scene, s->pos, &env);
    if (st) lc_mipmap_free(p->ctx, &env.map);
    return st;
}
