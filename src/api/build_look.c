/* build_look.c - public calls of what surfaces look like and of pictures that emit: textures, materials,
 * environments, photometric tables. */
#include "api/build.h"

#include "api/host.h"
#include "base/desc.h"
#include "image/mipmap.h"

#define MAX_TEXEL 1e13f               /* of an environment, radiance */
#define MAX_TEXT  ((uint64_t)1 << 24) /* bytes of a photometric file */

static lc_status bad(const lc_scene *s, const char *call, const char *what)
{
    return lc_fail(s->ctx, LC_ERR_ARG, "%s: %s", call, what);
}

/* ---- pictures ---- */

/* A host's picture. */
typedef struct picture {
    uint32_t width, height, n_channels;
    lc_build_texels kind;
    const void *texels;
} picture;

static size_t n_values(const picture *p) { return (size_t)p->width * p->height * p->n_channels; }

static const char *fault(const picture *p)
{
    if (!(p->width >= 1 && p->width <= LC_MAX_SIDE && p->height >= 1 && p->height <= LC_MAX_SIDE) ||
        (uint64_t)p->width * p->height > LC_MAX_PIXELS)
        return "width and height must be 1 to 65535, their product at most 2^28";
    if ((unsigned)p->kind > LC_BUILD_FLOATS) return "kind is none of lc_build_texels";
    if (!p->texels) return "texels are NULL";
    const float *v = p->texels;
    for (size_t i = 0; p->kind == LC_BUILD_FLOATS && i < n_values(p); i++)
        if (!(fabsf(v[i]) <= LC_MAX_INTENSITY)) return "texels: a value is not finite or beyond 1e15";
    return NULL;
}

static lc_status make_map(const lc_scene *s, const picture *p, lc_mipmap *out)
{
    const lc_encoding encoding = { p->kind == LC_BUILD_SRGB8 ? LC_ENCODING_SRGB : LC_ENCODING_LINEAR, 1 };
    const lc_raster raster = { .width = p->width,
                               .height = p->height,
                               .n_channels = p->n_channels,
                               .kind = p->kind == LC_BUILD_FLOATS ? LC_RASTER_F32 : LC_RASTER_U8,
                               .data = (void *)(uintptr_t)p->texels };
    return lc_mipmap_build(s->ctx, &raster, encoding, out);
}

static void add_picture(lc_scene *s, const picture *p)
{
    lc_digest *d = &s->inputs.digest;
    lc_digest_u64(d, (uint64_t)p->width << 32 | p->height);
    lc_digest_u64(d, (uint64_t)p->kind << 32 | p->n_channels);
    lc_digest_add(d, p->texels, n_values(p) * (p->kind == LC_BUILD_FLOATS ? sizeof(float) : 1));
}

/* ---- textures ---- */

const char *lc_build_check_texture(const lc_scene *s, uint32_t id, bool number)
{
    if (id == LC_NO_TEXTURE) return NULL;
    if (id >= s->textures.n) return "is not one of the scene's";
    return number && !s->textures.items[id].is_float ? "must have one channel" : NULL;
}

static const char *texture_fault(const lc_build_texture_desc *d)
{
    if (d->n_channels != 1 && d->n_channels != 3) return "n_channels must be 1 or 3";
    for (int i = 0; i < 2; i++) {
        if (!(fabs(d->repeat[i]) >= 1e-6 && fabs(d->repeat[i]) <= 1e6)) return "repeat must be 1e-6 to 1e6";
        if (!(fabs(d->offset[i]) <= 1e6)) return "offset must be at most 1e6";
    }
    if ((unsigned)d->wrap > LC_BUILD_BLACK) return "wrap is none of lc_build_wrap";
    if ((unsigned)d->filter > LC_BUILD_TRILINEAR) return "filter is none of lc_build_filter";
    return d->scale >= 0 && d->scale <= 1e6f ? NULL : "scale must be 0 to 1e6";
}

lc_status lc_build_texture(lc_scene *s, const lc_build_texture_desc *desc, uint32_t *id)
{
    static const char call[] = "lc_build_texture";
    lc_build_texture_desc d = LC_BUILD_TEXTURE_DESC_INIT;
    lc_status st = lc_build_take(s, "lc_build_texture_desc", &d, sizeof d, desc);
    if (st) return st;
    if (!id) return bad(s, call, "id is NULL");
    const picture p = { d.width, d.height, d.n_channels, d.kind, d.texels };
    const char *wrong = texture_fault(&d);
    if (!wrong) wrong = fault(&p);
    if (wrong) return bad(s, call, wrong);
    const double third = 1.0 / 3, stretch = fmax(fabs(d.repeat[0]), fabs(d.repeat[1]));
    lc_texture t = { .kind = LC_TEX_IMAGE,
                     .is_float = d.n_channels == 1,
                     .map = { .kind = LC_MAP_UV, .stretch = stretch },
                     .wrap = (lc_wrap)d.wrap,
                     .filter = (lc_filter)d.filter,
                     .grey = { third, third, third },
                     .scale = (double)d.scale };
    for (int i = 0; i < 4; i++) t.in[i].id = LC_NONE;
    t.map.su = d.repeat[0];
    t.map.sv = d.repeat[1];
    t.map.du = d.offset[0];
    t.map.dv = d.offset[1];
    lc_mipmap map;
    bool too_deep;
    if ((st = make_map(s, &p, &map))) return st;
    st = lc_textures_add_image(&s->textures, &map, &t.image);
    if (st) lc_mipmap_free(s->ctx, &map);
    if (st) return st;
    if ((st = lc_textures_add(&s->textures, &t, id, &too_deep))) {
        lc_mipmap_free(s->ctx, &s->textures.images[--s->textures.n_images]);
        return st;
    }
    lc_build_mark(s, LC_CALL_TEXTURE);
    add_picture(s, &p);
    lc_digest_add(&s->inputs.digest, d.repeat, sizeof d.repeat);
    lc_digest_add(&s->inputs.digest, d.offset, sizeof d.offset);
    lc_digest_u64(&s->inputs.digest, (uint64_t)d.wrap << 32 | (uint64_t)d.filter);
    lc_digest_number(&s->inputs.digest, (double)d.scale);
    return LC_OK;
}

/* ---- materials ---- */

_Static_assert(LC_NO_TEXTURE == LC_NONE && LC_GLOSS_PHONG == 1, "numbers of lightcuts.h");

/* Its bytes are hashed. */
_Static_assert(sizeof(void *) != 8 || sizeof(lc_build_material_desc) == 120, "no bytes between fields");

/* The desc as one of the host's own materials. */
static lc_shade_material shade_of(const lc_build_material_desc *d)
{
    lc_shade_material m = { .gloss = d->gloss,
                            .exponent = d->exponent,
                            .roughness = { d->roughness[0], d->roughness[1] },
                            .fresnel = d->fresnel,
                            .coat = d->coat };
    for (int k = 0; k < 3; k++) {
        m.kd[k] = d->diffuse[k];
        m.ks[k] = d->glossy[k];
        m.eta[k] = d->eta[k];
        m.k[k] = d->k[k];
    }
    return m;
}

static bool is_fraction(const float v[3])
{
    for (int k = 0; k < 3; k++)
        if (!(v[k] >= 0 && v[k] <= 1)) return false;
    return true;
}

/* Indices where they are used. */
static const char *optics_fault(const lc_build_material_desc *d)
{
    const bool glass = d->specular >= LC_BUILD_GLASS, lobe = d->specular == LC_BUILD_ROUGH;
    if (lobe && d->gloss != LC_GLOSS_GGX) return NULL;
    const bool metal = !glass && d->fresnel == LC_REFLECT_CONDUCTOR;
    const bool clear = glass || d->fresnel == LC_REFLECT_DIELECTRIC || (lobe && d->coat);
    for (int i = 0; i < 3; i++) {
        const float eta = d->eta[i], k = d->k[i];
        if (clear && !(eta >= LC_MIN_ETA && eta <= LC_MAX_ETA)) return "eta must be 1 to 3.5";
        if (metal && !(eta >= 0 && k >= 0 && eta <= LC_MAX_CONDUCTOR && k <= LC_MAX_CONDUCTOR &&
                       eta * eta + k * k >= LC_MIN_CONDUCTOR))
            return "eta and k must be 0 to 1000 and not both 0";
    }
    return NULL;
}

static const char *number_fault(const lc_build_material_desc *d)
{
    if (!is_fraction(d->diffuse) || !is_fraction(d->glossy)) return "diffuse and glossy must be 0 to 1";
    if (!is_fraction(d->transmitted)) return "transmitted must be 0 to 1";
    if (!(d->exponent >= 0 && d->exponent <= LC_MAX_EXPONENT)) return "exponent must be 0 to 100000";
    if ((unsigned)d->specular > LC_BUILD_THIN_GLASS) return "specular is none of lc_build_specular";
    if (d->fresnel > LC_REFLECT_ALL) return "fresnel is none of LC_REFLECT_";
    for (int i = 0; i < 2 && d->specular == LC_BUILD_ROUGH && d->gloss > LC_GLOSS_PHONG; i++)
        if (!(d->roughness[i] >= LC_MIN_ROUGHNESS && d->roughness[i] <= LC_MAX_ROUGHNESS))
            return "roughness must be 0.001 to 1";
    return optics_fault(d);
}

static lc_status check_material(const lc_scene *s, const lc_build_material_desc *d)
{
    static const char call[] = "lc_build_material";
    const struct {
        const char *name;
        uint32_t id;
        bool number;
    } textures[] = { { "diffuse_texture", d->diffuse_texture, false },
                     { "glossy_texture", d->glossy_texture, false },
                     { "transmitted_texture", d->transmitted_texture, false },
                     { "roughness_texture", d->roughness_texture, true },
                     { "bump_texture", d->bump_texture, true },
                     { "normal_texture", d->normal_texture, false } };
    const char *wrong = number_fault(d);
    if (wrong) return bad(s, call, wrong);
    const lc_shade_material m = shade_of(d);
    wrong = d->specular == LC_BUILD_ROUGH ? lc_arg_material_fault(&m) : NULL;
    if (wrong) return bad(s, call, wrong + (*wrong == '.' || *wrong == ' '));
    for (size_t i = 0; i < sizeof textures / sizeof *textures; i++)
        if ((wrong = lc_build_check_texture(s, textures[i].id, textures[i].number)))
            return lc_fail(s->ctx, LC_ERR_ARG, "%s: %s %s", call, textures[i].name, wrong);
    return LC_OK;
}

/* A value that a texture gives; where it lies is not known, the texture's mean is taken. */
static void set_tint(const lc_scene *s, uint32_t texture, lc_f3 *value, uint32_t *map)
{
    *map = texture;
    if (texture == LC_NO_TEXTURE) return;
    const double *mean = s->textures.items[texture].mean;
    *value = lc_f3_make((float)fmin(fmax(mean[0], 0), 1), (float)fmin(fmax(mean[1], 0), 1),
                        (float)fmin(fmax(mean[2], 0), 1));
}

static void set_roughness(const lc_scene *s, uint32_t texture, lc_material *m, lc_material_maps *maps)
{
    maps->roughness[0] = maps->roughness[1] = texture;
    if (texture == LC_NO_TEXTURE) return;
    const double mean = s->textures.items[texture].mean[0];
    m->roughness[0] = m->roughness[1] =
        (float)fmin(fmax(mean, (double)LC_MIN_ROUGHNESS), (double)LC_MAX_ROUGHNESS);
}

static lc_material material_of(const lc_build_material_desc *d)
{
    const lc_shade_material shade = shade_of(d);
    if (d->specular == LC_BUILD_ROUGH) {
        lc_material m = lc_arg_material_of(&shade);
        m.kt = lc_f3_load(d->transmitted);
        return m;
    }
    const bool glass = d->specular != LC_BUILD_MIRROR;
    return (lc_material){ .ks = lc_f3_load(d->glossy),
                          .kt = lc_f3_load(glass ? d->transmitted : (const float[3]){ 0, 0, 0 }),
                          .lobe = LC_LOBE_PHONG,
                          .fresnel = glass ? LC_FRESNEL_DIELECTRIC : (lc_fresnel)d->fresnel,
                          .eta = lc_f3_load(d->eta),
                          .k = lc_f3_load(d->k),
                          .mirror = true,
                          .glass = glass,
                          .thin = d->specular == LC_BUILD_THIN_GLASS };
}

lc_status lc_build_material(lc_scene *s, const lc_build_material_desc *desc, uint32_t *id)
{
    lc_build_material_desc d = LC_BUILD_MATERIAL_DESC_INIT;
    lc_status st = lc_build_take(s, "lc_build_material_desc", &d, sizeof d, desc);
    if (st) return st;
    if (!id) return bad(s, "lc_build_material", "id is NULL");
    if ((st = check_material(s, &d))) return st;
    lc_material m = material_of(&d);
    lc_material_maps maps = LC_NO_MAPS;
    const bool rough = d.specular == LC_BUILD_ROUGH, lobe = rough && d.gloss != LC_GLOSS_NONE;
    if (rough) set_tint(s, d.diffuse_texture, &m.kd, &maps.kd);
    if (!rough || lobe) set_tint(s, d.glossy_texture, &m.ks, &maps.ks);
    if (d.specular != LC_BUILD_MIRROR) set_tint(s, d.transmitted_texture, &m.kt, &maps.kt);
    if (lobe && d.gloss != LC_GLOSS_PHONG) set_roughness(s, d.roughness_texture, &m, &maps);
    maps.bump = d.bump_texture;
    maps.normal = d.normal_texture;
    if ((st = lc_scene_add_material(s, &m, id))) return st;
    lc_scene_map_material(s, *id, &maps);
    lc_build_mark(s, LC_CALL_MATERIAL);
    lc_digest_add(&s->inputs.digest, &d, sizeof d);
    return LC_OK;
}

lc_status lc_build_mix(lc_scene *s, const lc_build_mix_desc *desc, uint32_t *id)
{
    static const char call[] = "lc_build_mix";
    lc_build_mix_desc d = LC_BUILD_MIX_DESC_INIT;
    lc_status st = lc_build_take(s, "lc_build_mix_desc", &d, sizeof d, desc);
    if (st) return st;
    if (!id) return bad(s, call, "id is NULL");
    if (d.materials[0] >= s->n_materials || d.materials[1] >= s->n_materials)
        return bad(s, call, "materials are not the scene's");
    if (!is_fraction(d.share)) return bad(s, call, "share must be 0 to 1");
    const char *wrong = lc_build_check_texture(s, d.share_texture, false);
    if (wrong) return lc_fail(s->ctx, LC_ERR_ARG, "%s: share_texture %s", call, wrong);
    if (s->maps[d.materials[0]].depth >= LC_MAX_MIX || s->maps[d.materials[1]].depth >= LC_MAX_MIX)
        return bad(s, call, "materials are mixes of mixes more than 16 deep");
    lc_material_maps maps = LC_NO_MAPS;
    maps.mix[0] = d.materials[0];
    maps.mix[1] = d.materials[1];
    maps.share = lc_f3_load(d.share);
    set_tint(s, d.share_texture, &maps.share, &maps.share_map);
    const lc_f3 part = maps.share;
    const lc_material m = s->materials[d.materials[(double)part.x + (double)part.y + (double)part.z >= 1.5]];
    if ((st = lc_scene_add_material(s, &m, id))) return st;
    lc_scene_map_material(s, *id, &maps);
    lc_build_mark(s, LC_CALL_MIX);
    lc_digest_add(&s->inputs.digest, d.materials, sizeof d.materials);
    lc_digest_add(&s->inputs.digest, d.share, sizeof d.share);
    lc_digest_u64(&s->inputs.digest, d.share_texture);
    return LC_OK;
}

/* ---- what emits ---- */

const lc_mipmap *lc_build_picture_of(const lc_scene *s, uint32_t texture)
{
    return &s->textures.images[s->textures.items[texture].image];
}

lc_status lc_build_emission_map(lc_scene *s, uint32_t texture, uint32_t *id)
{
    static const char call[] = "lc_build_mesh";
    lc_given *g = &s->given;
    const lc_texture *t = &s->textures.items[texture];
    for (size_t i = 0; i < g->n_emission_maps; i++)
        if (g->emission_maps[i][0] == texture) {
            *id = g->emission_maps[i][1];
            return LC_OK;
        }
    if (t->is_float) return bad(s, call, "emission_texture must have three channels");
    if (fabs(t->map.su - 1) + fabs(t->map.sv - 1) + fabs(t->map.du) + fabs(t->map.dv) + fabs(t->scale - 1) >
        0)
        return bad(s, call, "emission_texture must have repeat 1, offset 0 and scale 1");
    lc_mipmap map;
    lc_status st = lc_grow(s->ctx, (void **)&g->emission_maps, &g->cap_emission_maps, g->n_emission_maps + 1,
                           sizeof *g->emission_maps);
    if (!st) st = lc_mipmap_copy(s->ctx, lc_build_picture_of(s, texture), &map);
    if (st) return st;
    if ((st = lc_scene_add_emission_map(s, &map, id))) {
        lc_mipmap_free(s->ctx, &map);
        return st;
    }
    g->emission_maps[g->n_emission_maps][0] = texture;
    g->emission_maps[g->n_emission_maps++][1] = *id;
    return LC_OK;
}

lc_status lc_build_environment(lc_scene *s, const lc_build_environment_desc *desc)
{
    static const char call[] = "lc_build_environment";
    static const float white[3] = { 1, 1, 1 };
    lc_build_environment_desc d = LC_BUILD_ENVIRONMENT_DESC_INIT;
    lc_status st = lc_build_take(s, "lc_build_environment_desc", &d, sizeof d, desc);
    if (st) return st;
    picture p = { d.width, d.height, 3, d.kind, d.texels };
    if (!d.texels) p = (picture){ 1, 1, 3, LC_BUILD_FLOATS, white };
    const bool square = !d.texels || d.equal_area;
    const char *wrong = fault(&p);
    if (!wrong && square && p.width != p.height) wrong = "width and height must be equal with equal_area";
    float most = p.kind == LC_BUILD_FLOATS ? 0 : 1;
    for (size_t i = 0; !wrong && p.kind == LC_BUILD_FLOATS && i < n_values(&p); i++)
        most = fmaxf(most, ((const float *)p.texels)[i]);
    for (int k = 0; k < 3; k++)
        if (!(d.scale[k] >= 0 && d.scale[k] * most <= MAX_TEXEL && d.scale[k] <= LC_MAX_INTENSITY))
            wrong = "scale is negative or not finite, or gives a radiance above 1e13";
    if (wrong) return bad(s, call, wrong);
    lc_env env = { .mapping = square ? LC_ENV_EQUAL_AREA : LC_ENV_LATLONG, .scale = lc_f3_load(d.scale) };
    if ((st = lc_arg_to_world(s, call, d.to_world, &env.to_world))) return st;
    if (!lc_xform_invert(&env.to_world, &env.to_light)) return bad(s, call, "to_world is singular");
    const uint32_t had = s->groups.n;
    if ((st = make_map(s, &p, &env.map))) return st;
    st = lc_build_begin_group(s, call, d.group);
    if (!st) st = lc_as_arg(lc_scene_add_env(s, LC_BY_CALL, &env));
    if (st) {
        lc_mipmap_free(s->ctx, &env.map);
        return lc_build_end_group(s, had, st);
    }
    lc_build_mark(s, LC_CALL_ENVIRONMENT);
    add_picture(s, &p);
    lc_digest_add(&s->inputs.digest, d.scale, sizeof d.scale);
    lc_digest_add(&s->inputs.digest, d.to_world, sizeof d.to_world);
    lc_digest_u64(&s->inputs.digest, square);
    lc_build_mark_group(s);
    return LC_OK;
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
    if (!id) return bad(s, call, "id is NULL");
    if (!d.text) return bad(s, call, "text is NULL");
    if (d.length > MAX_TEXT) return bad(s, call, "length must be at most 2^24");
    lc_given *g = &s->given;
    st = lc_grow(s->ctx, (void **)&g->fixtures, &g->cap_fixtures, g->n_fixtures + 1, sizeof *g->fixtures);
    if (st) return st;
    lc_fixture *f = &g->fixtures[g->n_fixtures];
    *f = (lc_fixture){ .profile = 0 };
    st = read_text(s, &d, &f->file);
    const lc_profile_desc profile = { f->file.azimuth, f->file.polar, f->file.candela, f->file.n_azimuth,
                                      f->file.n_polar };
    if (!st) st = lc_profiles_add(s->ctx, &s->profiles, &profile, &f->profile, &f->peak);
    if (st) {
        lc_photometry_free(&f->file);
        return st;
    }
    *id = (uint32_t)g->n_fixtures++;
    lc_build_mark(s, LC_CALL_LUMINAIRE);
    lc_digest_u64(&s->inputs.digest, d.eulumdat != 0);
    lc_digest_add(&s->inputs.digest, d.text, (size_t)d.length);
    return LC_OK;
}
