/* make_texture.c - Texture statements: all of pbrt's classes except ptex, and one that pbrt lacks:
 *
 *     wood   rings about the z axis of texture space: "rgb tex1" early wood, "rgb tex2" late wood,
 *            "float rings" per unit of length, "float variation", "integer octaves", "float roughness"
 *
 * Any other class becomes a constant of 1/2. For solid textures pbrt v3 applies the current matrix to points,
 * and v4 its inverse; so does this.
 */
#include "pbrt/make_texture.h"

#include "scene/noise.h"

#include <string.h>

#define NO_INPUT(v)                                                                                          \
    {                                                                                                        \
        LC_NO_TEXTURE, { v, v, v }                                                                           \
    }

/* ---- inputs ---- */

/* The texture that a parameter names; LC_NONE if the parameter is absent or the name unknown. */
static lc_status find_texture(lc_pbrt *p, const char *name, bool is_float, uint32_t *id,
                              const lc_pbrt_param **found)
{
    const lc_pbrt_param *par = *found = lc_pbrt_find(&p->params, name, LC_PBRT_TEXTURE);
    *id = LC_NONE;
    if (!par) return LC_OK;
    if (par->n != 1) return lc_pbrt_bad_param(&p->params, par, "needs the name of one texture");
    const char *texture = p->params.text[par->first];
    *id = lc_pbrt_map_get(is_float ? &p->float_textures : &p->colour_textures, texture);
    if (*id != LC_NONE) return LC_OK;
    return lc_pbrt_note_name(p, par->pos, "unknown texture", texture,
                             is_float ? "no such float texture; 0.5 is used"
                                      : "no such texture; grey is used");
}

lc_status lc_pbrt_get_input(lc_pbrt *p, const char *name, bool is_float, lc_build_value *in,
                            const lc_pbrt_param **found)
{
    const lc_pbrt_param *par = NULL;
    lc_f3 colour;
    double v;
    lc_status st = is_float ? lc_pbrt_get_float(&p->params, name, &v, &par)
                            : lc_pbrt_get_colour(p, name, LC_PBRT_FOR_ALBEDO, &colour, &par);
    *in = (lc_build_value)NO_INPUT(0);
    if (par && is_float) *in = (lc_build_value)NO_INPUT(v);
    if (par && !is_float)
        *in = (lc_build_value){ LC_NONE, { (double)colour.x, (double)colour.y, (double)colour.z } };
    if (!st && !par) {
        st = find_texture(p, name, is_float, &in->id, &par);
        if (par && in->id == LC_NONE) *in = (lc_build_value)NO_INPUT(0.5);
        if (in->id != LC_NONE) st = lc_build_texture_value(p->scene, in->id, in);
    }
    if (found) *found = par;
    return st;
}

/* Reads an input; *in keeps its value if the parameter is absent. */
static lc_status input(lc_pbrt *p, const char *name, bool is_float, lc_build_value *in)
{
    lc_build_value given;
    const lc_pbrt_param *par;
    lc_status st = lc_pbrt_get_input(p, name, is_float, &given, &par);
    if (!st && par) *in = given;
    return st;
}

/* ---- mappings ---- */

/* Sets the map from world to texture space to the current matrix or its inverse. */
static lc_status affine(lc_pbrt *p, lc_pos where, bool inverse, lc_build_pattern_desc *t)
{
    lc_xform x = p->ctm;
    lc_status st = LC_OK;
    if (inverse && !lc_xform_invert(&p->ctm, &x)) {
        x = lc_xform_identity();
        st = lc_pbrt_note(p, where, "texture transform", "a texture's matrix has no inverse and is ignored");
    }
    if (x.m[12] < 0 || x.m[12] > 0 || x.m[13] < 0 || x.m[13] > 0 || x.m[14] < 0 || x.m[14] > 0)
        st = lc_pbrt_note(p, where, "texture transform",
                          "a texture's matrix is a projection and taken as affine");
    memcpy(t->to_texture, x.m, sizeof t->to_texture);
    return st;
}

/* The mapping of a solid texture. */
static lc_status map_3d(lc_pbrt *p, lc_pos where, lc_build_pattern_desc *t)
{
    return affine(p, where, p->v4, t);
}

static lc_status map_2d(lc_pbrt *p, lc_pos where, lc_build_pattern_desc *t)
{
    static const struct {
        const char *name;
        lc_build_mapping kind;
    } kinds[] = { { "uv", LC_MAPPING_UV },
                  { "planar", LC_MAPPING_PLANAR },
                  { "spherical", LC_MAPPING_SPHERICAL },
                  { "cylindrical", LC_MAPPING_CYLINDRICAL } };
    const char *name = "uv";
    const lc_pbrt_param *par;
    lc_status st = lc_pbrt_get_text(&p->params, "mapping", &name, &par);
    if (st) return st;
    size_t k = 0;
    while (k < 4 && strcmp(kinds[k].name, name)) k++;
    t->mapping = k < 4 ? kinds[k].kind : LC_MAPPING_UV;
    if (k == 4) st = lc_pbrt_note_name(p, par->pos, "texture mapping", name, "uv takes its place");
    if (!st) st = lc_pbrt_get_float(&p->params, "udelta", &t->offset[0], NULL);
    if (!st) st = lc_pbrt_get_float(&p->params, "vdelta", &t->offset[1], NULL);
    if (!st && t->mapping == LC_MAPPING_UV) {
        st = lc_pbrt_get_float(&p->params, "uscale", &t->repeat[0], NULL);
        return st ? st : lc_pbrt_get_float(&p->params, "vscale", &t->repeat[1], NULL);
    }
    if (!st && t->mapping == LC_MAPPING_PLANAR) {
        st = lc_pbrt_get_triple(&p->params, "v1", t->v1, NULL);
        if (!st) st = lc_pbrt_get_triple(&p->params, "v2", t->v2, NULL);
        if (st || !p->v4) return st; /* v3's planar mapping is in world space */
    }
    return st ? st : affine(p, where, true, t);
}

/* ---- classes ---- */

static bool is_number(const lc_build_pattern_desc *t) { return t->n_channels == 1; }

typedef lc_status reader(lc_pbrt *p, lc_pos where, lc_build_pattern_desc *t);

static lc_status constant(lc_pbrt *p, lc_pos where, lc_build_pattern_desc *t)
{
    (void)where;
    t->in[0] = (lc_build_value)NO_INPUT(1);
    return input(p, "value", is_number(t), &t->in[0]);
}

/* v3: "tex1" times "tex2". v4: "tex" times "scale", a float; a colour is accepted, too. */
static lc_status scale(lc_pbrt *p, lc_pos where, lc_build_pattern_desc *t)
{
    (void)where;
    for (int i = 0; i < 3; i++) t->in[i] = (lc_build_value)NO_INPUT(1);
    lc_status st = input(p, "tex1", is_number(t), &t->in[0]);
    if (!st) st = input(p, "tex2", is_number(t), &t->in[1]);
    if (!st) st = input(p, "tex", is_number(t), &t->in[0]);
    if (st) return st;
    const lc_pbrt_param *named = lc_pbrt_find(&p->params, "scale",
                                              LC_PBRT_TEXTURE | LC_PBRT_FLOAT | LC_PBRT_INT);
    bool is_float = named && (named->type != LC_PBRT_TEXTURE || named->n != 1 ||
                              lc_pbrt_map_get(&p->float_textures, p->params.text[named->first]) != LC_NONE);
    return input(p, "scale", is_float || is_number(t), &t->in[2]);
}

static lc_status mix(lc_pbrt *p, lc_pos where, lc_build_pattern_desc *t)
{
    (void)where;
    t->in[1] = (lc_build_value)NO_INPUT(1);
    t->in[2] = (lc_build_value)NO_INPUT(0.5);
    lc_status st = input(p, "tex1", is_number(t), &t->in[0]);
    if (!st) st = input(p, "tex2", is_number(t), &t->in[1]);
    return st ? st : input(p, "amount", true, &t->in[2]);
}

/* v4's directionmix: blends between surfaces perpendicular to a direction and parallel to it. */
static lc_status direction_mix(lc_pbrt *p, lc_pos where, lc_build_pattern_desc *t)
{
    double dir[3] = { 0, 1, 0 };
    (void)where;
    t->in[1] = (lc_build_value)NO_INPUT(1);
    lc_status st = lc_pbrt_get_triple(&p->params, "dir", dir, NULL);
    lc_xform_vector(&p->ctm, dir, t->v1);
    lc_f3 unit = lc_f3_normalize_d(t->v1[0], t->v1[1], t->v1[2]);
    t->v1[0] = (double)unit.x;
    t->v1[1] = (double)unit.y;
    t->v1[2] = (double)unit.z;
    if (!st) st = input(p, "tex1", is_number(t), &t->in[0]);
    return st ? st : input(p, "tex2", is_number(t), &t->in[1]);
}

static lc_status checkerboard(lc_pbrt *p, lc_pos where, lc_build_pattern_desc *t)
{
    int64_t dimension = 2;
    const char *filter = "closedform";
    const lc_pbrt_param *par;
    t->in[0] = (lc_build_value)NO_INPUT(1);
    lc_status st = lc_pbrt_get_int(&p->params, "dimension", &dimension, &par);
    if (st) return st;
    if (dimension != 2 && dimension != 3) return lc_pbrt_bad_param(&p->params, par, "is neither 2 nor 3");
    t->solid = dimension == 3;
    st = t->solid ? map_3d(p, where, t) : map_2d(p, where, t);
    if (!st) st = lc_pbrt_get_text(&p->params, "aamode", &filter, NULL);
    t->sharp = !strcmp(filter, "none");
    if (!st) st = input(p, "tex1", is_number(t), &t->in[0]);
    return st ? st : input(p, "tex2", is_number(t), &t->in[1]);
}

static lc_status dots(lc_pbrt *p, lc_pos where, lc_build_pattern_desc *t)
{
    t->in[0] = (lc_build_value)NO_INPUT(1);
    lc_status st = map_2d(p, where, t);
    if (!st) st = input(p, "inside", is_number(t), &t->in[0]);
    return st ? st : input(p, "outside", is_number(t), &t->in[1]);
}

static lc_status bilerp(lc_pbrt *p, lc_pos where, lc_build_pattern_desc *t)
{
    static const char *const names[4] = { "v00", "v01", "v10", "v11" };
    lc_status st = map_2d(p, where, t);
    for (int i = 0; i < 4 && !st; i++) {
        if (i & 1) t->in[i] = (lc_build_value)NO_INPUT(1);
        st = input(p, names[i], is_number(t), &t->in[i]);
    }
    return st;
}

static lc_status uv(lc_pbrt *p, lc_pos where, lc_build_pattern_desc *t) { return map_2d(p, where, t); }

static lc_status noise(lc_pbrt *p, lc_pos where, lc_build_pattern_desc *t)
{
    int64_t octaves = 8;
    const lc_pbrt_param *par;
    lc_status st = map_3d(p, where, t);
    if (!st) st = lc_pbrt_get_int(&p->params, "octaves", &octaves, &par);
    if (st) return st;
    if (octaves < 0 || octaves > LC_MAX_OCTAVES) return lc_pbrt_bad_param(&p->params, par, "is not 0 to 32");
    t->octaves = (int)octaves;
    return lc_pbrt_get_float(&p->params, "roughness", &t->roughness, NULL);
}

static lc_status marble(lc_pbrt *p, lc_pos where, lc_build_pattern_desc *t)
{
    lc_status st = noise(p, where, t);
    t->variation = 0.2;
    if (!st) st = lc_pbrt_get_float(&p->params, "scale", &t->scale, NULL);
    return st ? st : lc_pbrt_get_float(&p->params, "variation", &t->variation, NULL);
}

static lc_status wood(lc_pbrt *p, lc_pos where, lc_build_pattern_desc *t)
{
    static const lc_build_value early = { LC_NO_TEXTURE, { 0.50, 0.29, 0.13 } },
                                late = { LC_NO_TEXTURE, { 0.25, 0.12, 0.045 } };
    t->in[0] = is_number(t) ? (lc_build_value)NO_INPUT(0) : early;
    t->in[1] = is_number(t) ? (lc_build_value)NO_INPUT(1) : late;
    t->scale = 8;
    t->variation = 0.1;
    lc_status st = noise(p, where, t);
    if (!st) st = lc_pbrt_get_float(&p->params, "rings", &t->scale, NULL);
    if (!st) st = lc_pbrt_get_float(&p->params, "variation", &t->variation, NULL);
    if (!st) st = input(p, "tex1", is_number(t), &t->in[0]);
    return st ? st : input(p, "tex2", is_number(t), &t->in[1]);
}

static lc_status imagemap(lc_pbrt *p, lc_pos where, lc_build_pattern_desc *t)
{
    bool there;
    lc_status st = map_2d(p, where, t);
    if (!st) st = lc_pbrt_get_image(p, where, t, &there);
    if (st || there) return st;
    double grey = 0.5 * t->scale;
    t->kind = LC_PATTERN_CONSTANT;
    t->in[0] = (lc_build_value)NO_INPUT(grey);
    return LC_OK;
}

static const struct {
    const char *name;
    lc_build_pattern_kind kind;
    reader *read;
} classes[] = { { "constant", LC_PATTERN_CONSTANT, constant },
                { "scale", LC_PATTERN_SCALE, scale },
                { "mix", LC_PATTERN_MIX, mix },
                { "directionmix", LC_PATTERN_DIRECTION, direction_mix },
                { "imagemap", LC_PATTERN_PICTURE, imagemap },
                { "checkerboard", LC_PATTERN_CHECKER, checkerboard },
                { "dots", LC_PATTERN_DOTS, dots },
                { "bilerp", LC_PATTERN_BILERP, bilerp },
                { "uv", LC_PATTERN_UV, uv },
                { "fbm", LC_PATTERN_FBM, noise },
                { "wrinkled", LC_PATTERN_WRINKLED, noise },
                { "windy", LC_PATTERN_WINDY, noise },
                { "marble", LC_PATTERN_MARBLE, marble },
                { "wood", LC_PATTERN_WOOD, wood } };

static lc_status read_class(lc_pbrt *p, const lc_pbrt_stmt *s, lc_build_pattern_desc *t)
{
    size_t k = 0, n = sizeof classes / sizeof *classes;
    while (k < n && strcmp(classes[k].name, s->text[2])) k++;
    if (k < n) {
        t->kind = classes[k].kind;
        return classes[k].read(p, s->pos, t);
    }
    t->in[0] = (lc_build_value)NO_INPUT(0.5);
    lc_pbrt_mark_all(&p->params);
    return lc_pbrt_note_name(p, s->pos, "texture", s->text[2], "a constant of 0.5 takes its place");
}

lc_status lc_pbrt_texture(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    bool is_float = !strcmp(s->text[1], "float");
    if (!is_float && strcmp(s->text[1], "spectrum") && strcmp(s->text[1], "color"))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->text_pos[1],
                          "texture type '%.80s' is none of float, spectrum, color", s->text[1]);
    lc_build_pattern_desc t = LC_BUILD_PATTERN_DESC_INIT;
    t.n_channels = is_float ? 1 : 3;
    for (int i = 0; i < 4; i++) t.in[i] = (lc_build_value)NO_INPUT(0);
    p->owner = s->text[2];
    uint32_t id;
    lc_status st = read_class(p, s, &t);
    if (!st) st = lc_pbrt_at(p, s->pos);
    if (!st) st = lc_build_pattern(p->scene, &t, &id);
    if (st) return st;
    return lc_pbrt_map_put(is_float ? &p->float_textures : &p->colour_textures, &p->arena, s->text[0], id);
}
