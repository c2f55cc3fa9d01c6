/* texture_image.c - imagemap textures: the image, loaded once for each encoding, and how it is sampled.
 *
 *     v4    "encoding" (sRGB, linear, gamma X), "filter", "wrap"
 *     v3    "gamma", "trilinear", "wrap"
 *
 * Integer images are sRGB by default. EWA filtering is approximated by trilinear filtering, whose footprint
 * is round.
 */
#include "pbrt/make_texture.h"

#include "base/decimal.h"
#include "image/pixels.h"
#include "io/readfile.h"

#include <stdio.h>
#include <string.h>

static lc_status get_encoding(lc_pbrt *p, lc_encoding *out)
{
    bool gamma = true;
    const char *text = "sRGB";
    const lc_pbrt_param *par;
    double power;
    lc_status st = lc_pbrt_get_bool(&p->params, "gamma", &gamma);
    if (!st) st = lc_pbrt_get_text(&p->params, "encoding", &text, &par);
    if (st) return st;
    *out = (lc_encoding){ gamma ? LC_ENCODING_SRGB : LC_ENCODING_LINEAR, 1 };
    if (!strcmp(text, "sRGB")) return LC_OK;
    if (!strcmp(text, "linear")) {
        out->kind = LC_ENCODING_LINEAR;
    } else if (!strncmp(text, "gamma ", 6) && lc_decimal_parse(text + 6, strlen(text + 6), &power) &&
               power >= 1e-3 && power <= 1e3) {
        *out = (lc_encoding){ LC_ENCODING_GAMMA, (float)power };
    } else {
        return lc_pbrt_note_name(p, par->pos, "texture encoding", text, "sRGB takes its place");
    }
    return LC_OK;
}

static lc_status get_wrap(lc_pbrt *p, lc_build_wrap *out)
{
    static const char *const names[] = { "repeat", "clamp", "black" };
    const char *text = names[0];
    const lc_pbrt_param *par;
    lc_status st = lc_pbrt_get_text(&p->params, "wrap", &text, &par);
    if (st) return st;
    for (int i = 0; i < 3; i++)
        if (!strcmp(text, names[i])) {
            *out = (lc_build_wrap)i;
            return LC_OK;
        }
    *out = LC_BUILD_REPEAT;
    return lc_pbrt_note_name(p, par->pos, "texture wrap", text, "repeat takes its place");
}

static lc_status get_filter(lc_pbrt *p, lc_pos where, lc_build_filter *out)
{
    static const char *const names[] = { "point", "bilinear", "trilinear" };
    const char *text = p->v4 ? "bilinear" : "EWA";
    const lc_pbrt_param *par;
    bool trilinear = false;
    lc_status st = lc_pbrt_get_bool(&p->params, "trilinear", &trilinear);
    if (trilinear) text = "trilinear";
    if (!st) st = lc_pbrt_get_text(&p->params, "filter", &text, &par);
    if (st) return st;
    lc_pbrt_mark(&p->params, "maxanisotropy");
    *out = LC_BUILD_TRILINEAR;
    for (int i = 0; i < 3; i++)
        if (!strcmp(text, names[i])) {
            *out = (lc_build_filter)i;
            return LC_OK;
        }
    if (!strcmp(text, "EWA") || !strcmp(text, "ewa"))
        return lc_pbrt_note(p, where, "texture filter EWA",
                            "the EWA filter is approximated by a trilinear one");
    return lc_pbrt_note_name(p, par->pos, "texture filter", text, "trilinear takes its place");
}

/* Decodes the file into a new picture of the scene. */
static lc_status load(lc_pbrt *p, lc_pos where, const char *path, lc_encoding encoding, uint32_t *picture)
{
    lc_file file;
    lc_raster raster = { 0 };
    const lc_build_texels kind = encoding.kind == LC_ENCODING_SRGB ? LC_BUILD_SRGB8 : LC_BUILD_LINEAR8;
    lc_status st = lc_file_read(p->ctx, where, path, lc_raster_is, &file);
    if (st) return st;
    lc_bytes bytes = { p->ctx, file.data, file.size, file.cap };
    st = lc_raster_decode(p->ctx, path, &bytes, &raster);
    lc_file_free(p->ctx, &file);
    if (!st) st = lc_pbrt_at(p, where);
    if (!st)
        st = lc_build_raster(p->scene, &raster, kind, encoding.kind == LC_ENCODING_GAMMA ? encoding.gamma : 0,
                             picture);
    lc_raster_free(p->ctx, &raster);
    return st;
}

lc_status lc_pbrt_find_image(lc_pbrt *p, lc_pos where, const char *name, lc_encoding encoding,
                             uint32_t *picture)
{
    char key[4352];
    const char *path;
    *picture = LC_NO_PICTURE;
    if (p->lex.no_files)
        return lc_pbrt_note(p, where, "texture image",
                            "'%.150s': this scene may not open files; grey is used", name);
    lc_status st = lc_pbrt_find_file(&p->lex, where, name, &path);
    if (st) return st;
    int n = snprintf(key, sizeof key, "%d %a %s", (int)encoding.kind, (double)encoding.gamma, path);
    bool fits = n > 0 && (size_t)n < sizeof key;
    if (fits) *picture = lc_pbrt_map_get(&p->image_names, key);
    if (*picture != LC_NO_PICTURE) return LC_OK;
    if (!lc_file_exists(p->ctx, path))
        return lc_pbrt_note(p, where, "texture image", "'%.150s': no such file; grey is used", path);
    st = load(p, where, path, encoding, picture);
    if (st || !fits) return st;
    return lc_pbrt_map_put(&p->image_names, &p->arena, key, *picture);
}

lc_status lc_pbrt_get_image(lc_pbrt *p, lc_pos where, lc_build_pattern_desc *t, bool *there)
{
    const char *name = NULL;
    const lc_pbrt_param *par;
    lc_encoding encoding;
    bool invert = false;
    lc_status st = lc_pbrt_get_text(&p->params, "filename", &name, &par);
    if (st) return st;
    if (!name) return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "imagemap without \"string filename\"");
    st = get_encoding(p, &encoding);
    if (!st) st = get_wrap(p, &t->wrap);
    if (!st) st = get_filter(p, where, &t->filter);
    if (!st) st = lc_pbrt_get_float(&p->params, "scale", &t->scale, NULL);
    if (!st) st = lc_pbrt_get_bool(&p->params, "invert", &invert);
    if (!st) st = lc_pbrt_find_image(p, par->pos, name, encoding, &t->picture);
    *there = t->picture != LC_NO_PICTURE;
    t->invert = invert;
    /* Float textures take the mean of the channels in v4 and their luminance in v3. */
    static const double mean[3] = { 1.0 / 3, 1.0 / 3, 1.0 / 3 }, luminance[3] = { 0.2126, 0.7152, 0.0722 };
    memcpy(t->grey, p->v4 ? mean : luminance, sizeof t->grey);
    return st;
}
