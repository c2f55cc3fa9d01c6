/* infinite.c - LightSource "infinite": a constant, or an image "filename" (v4) or "mapname" (v3).
 *
 * A square image given by "filename" has pbrt-v4's equal-area mapping; all others are latitude-longitude
 * maps.
 */
#include "pbrt/light_source.h"

#include "io/readfile.h"

#include <string.h>

#define MAX_NAME 4096

/* A name with a number, where no file has the very name: the picture of the load's frame, and of others.
 * *there stays false for other names. */
static lc_status find_sequence(lc_pbrt *p, lc_pos where, const char *name, lc_pbrt_picture *out, bool *there)
{
    char one[MAX_NAME], folder[MAX_NAME];
    const char *path;
    uint32_t size[2];
    const uint32_t asked = lc_build_asked(p->scene)->frame;
    const size_t n = lc_frame_name(name, asked ? asked : 1, one, sizeof one);
    if (!n || n >= sizeof one) return LC_OK;
    lc_status st = lc_pbrt_find_file(&p->lex, where, one, &path);
    if (st) return st;
    const size_t before = strlen(path) - n; /* the path ends with the name */
    if (before >= sizeof folder)
        return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "the name of a sequence is too long");
    memcpy(folder, path, before);
    folder[before] = 0;
    st = lc_pbrt_at(p, where);
    if (!st) st = lc_build_sequence(p->scene, folder, name, &out->id, size);
    if (st) return st;
    *out = (lc_pbrt_picture){ out->id, size[0], size[1], true };
    *there = true;
    return LC_OK;
}

/* Integer images are decoded as sRGB. */
lc_status lc_pbrt_light_map(lc_pbrt *p, lc_pos where, const char *name, bool still, lc_pbrt_picture *out,
                            bool *there)
{
    const char *path;
    lc_file file;
    lc_raster raster = { 0 };
    *there = false;
    if (p->lex.no_files)
        return lc_pbrt_note(p, where, "light image",
                            "'%.150s': this scene may not open files; a constant takes its place", name);
    lc_status st = lc_pbrt_find_file(&p->lex, where, name, &path);
    if (st) return st;
    if (!still && !lc_file_exists(p->ctx, path) &&
        ((st = find_sequence(p, where, name, out, there)) || *there))
        return st;
    if (!lc_file_exists(p->ctx, path))
        return lc_pbrt_note(p, where, "light image", "'%.150s': no such file; a constant takes its place",
                            path);
    if ((st = lc_file_read(p->ctx, where, path, lc_raster_is, &file))) return st;
    lc_bytes bytes = { p->ctx, file.data, file.size, file.cap };
    st = lc_raster_decode(p->ctx, path, &bytes, &raster);
    *there = !st;
    lc_file_free(p->ctx, &file);
    *out = (lc_pbrt_picture){ 0, raster.width, raster.height, false };
    if (*there) st = lc_pbrt_at(p, where);
    if (*there && !st) st = lc_build_raster(p->scene, &raster, LC_BUILD_SRGB8, 0, &out->id);
    lc_raster_free(p->ctx, &raster);
    return st;
}

lc_status lc_pbrt_constant_map(lc_pbrt *p, lc_pbrt_picture *out)
{
    float white[3] = { 1, 1, 1 };
    const lc_raster raster = { 1, 1, 3, LC_RASTER_F32, white };
    *out = (lc_pbrt_picture){ 0, 1, 1, false };
    return lc_build_raster(p->scene, &raster, LC_BUILD_LINEAR8, 0, &out->id);
}

static lc_status get_map(lc_pbrt *p, lc_build_environment_desc *env, lc_pbrt_picture *map, bool *is_image)
{
    const char *v4 = NULL, *v3 = NULL;
    const lc_pbrt_param *v4_par, *v3_par;
    lc_status st = lc_pbrt_get_text(&p->params, "filename", &v4, &v4_par);
    if (!st) st = lc_pbrt_get_text(&p->params, "mapname", &v3, &v3_par);
    *is_image = false;
    if (!st && v4 && *v4) st = lc_pbrt_light_map(p, v4_par->pos, v4, false, map, is_image);
    else if (!st && v3 && *v3) st = lc_pbrt_light_map(p, v3_par->pos, v3, false, map, is_image);
    if (!st && !*is_image) st = lc_pbrt_constant_map(p, map);
    if (st) return st;
    env->picture = map->id;
    env->equal_area = !*is_image || (v4 && *v4 && map->width == map->height);
    return LC_OK;
}

/* pbrt-v4 takes texels for half as large as they are. white: of a constant, and as what a sequence counts. */
static lc_status apply_illuminance(lc_pbrt *p, lc_build_environment_desc *env, bool white, lc_f3 *scale)
{
    double wanted = 0;
    lc_status st = lc_pbrt_get_float(&p->params, "illuminance", &wanted, NULL);
    if (st || !(wanted > 0)) return st;
    if (white) *scale = lc_f3_scale(*scale, (float)(wanted / LC_PI));
    else env->illuminance = 2 * wanted;
    return LC_OK;
}

lc_status lc_pbrt_infinite_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_build_environment_desc env = LC_BUILD_ENVIRONMENT_DESC_INIT;
    lc_f3 scale = lc_f3_make(1, 1, 1);
    lc_xform inverse;
    lc_pbrt_picture map;
    bool is_image = false;
    if (!lc_xform_invert(&p->ctm, &inverse))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "the light's transform is singular");
    memcpy(env.to_world, p->ctm.m, sizeof env.to_world);
    lc_status st = lc_pbrt_get_colour(p, "L", LC_PBRT_FOR_LIGHT, &scale, NULL);
    if (!st) st = lc_pbrt_light_scale(p, &scale);
    if (!st) st = get_map(p, &env, &map, &is_image);
    if (!st) st = apply_illuminance(p, &env, !is_image || map.varies, &scale);
    lc_f3_store(env.scale, scale);
    if (!st) st = lc_pbrt_at(p, s->pos);
    return st ? st : lc_build_environment(p->scene, &env);
}
