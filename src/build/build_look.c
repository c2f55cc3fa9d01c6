/* build_look.c - public calls of what surfaces look like: textures, patterns, materials, mixes. */
#include "base/desc.h"
#include "build/build.h"
#include "image/mipmap.h"
#include "scene/noise.h"
#include "shade/coat.h"
#include "shade/lobe.h"

#include <stddef.h>

#define MAX_MIRROR_ETA 1000.0f /* of mirrors and glass, whose directions need no bounds */
#define MIN_MIRROR_ETA 0.01f
#define UNIT_TOLERANCE 1e-3f /* of the length of a unit vector: that of a host's own rounding */

static lc_status bad(const lc_scene *s, const char *call, const char *what)
{
    return lc_build_wrong(s, call, what);
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
    if (!id) return lc_fail(s->ctx, LC_ERR_ARG, "%s: id is NULL", call);
    const lc_build_texels_desc p = { d.width, d.height, d.n_channels, d.kind, d.texels, 0 };
    const char *wrong = texture_fault(&d);
    if (!wrong) wrong = lc_build_texels_fault(&p);
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
    if ((st = lc_build_make_map(s, &p, &map))) return st;
    st = lc_textures_add_image(&s->textures, &map, &t.image);
    if (st) lc_mipmap_free(s->ctx, &map);
    if (st) return st;
    if ((st = lc_textures_add(&s->textures, &t, id, &too_deep))) {
        lc_mipmap_free(s->ctx, &s->textures.images[--s->textures.n_images]);
        return st;
    }
    if (!lc_build_mark(s, LC_CALL_TEXTURE)) return LC_OK;
    lc_build_add_texels(s, &p);
    lc_digest_add(&s->inputs.digest, d.repeat, sizeof d.repeat);
    lc_digest_add(&s->inputs.digest, d.offset, sizeof d.offset);
    lc_digest_u64(&s->inputs.digest, (uint64_t)d.wrap << 32 | (uint64_t)d.filter);
    lc_digest_number(&s->inputs.digest, (double)d.scale);
    return LC_OK;
}

/* ---- patterns ---- */

_Static_assert((int)LC_PATTERN_WOOD + 1 == (int)LC_TEX_KINDS &&
                   (int)LC_PATTERN_CHECKER == (int)LC_TEX_CHECKER && (int)LC_PATTERN_FBM == (int)LC_TEX_FBM &&
                   (int)LC_MAPPING_CYLINDRICAL == (int)LC_MAP_CYLINDRICAL,
               "numbers of lightcuts.h");

static bool are_finite(const double *v, int n)
{
    double sum = 0;
    for (int i = 0; i < n; i++) sum += v[i] * 0; /* NaN unless all are finite */
    return sum <= 0;
}

static const char *pattern_fault(const lc_scene *s, const lc_build_pattern_desc *d)
{
    if ((unsigned)d->kind > LC_PATTERN_WOOD) return "kind is none of lc_build_pattern_kind";
    if (d->n_channels != 1 && d->n_channels != 3) return "n_channels must be 1 or 3";
    for (int i = 0; i < 4; i++) {
        if (d->in[i].id != LC_NO_TEXTURE && d->in[i].id >= s->textures.n)
            return "in: a texture is not one of the scene's";
        if (!are_finite(d->in[i].value, 3)) return "in: a value is not finite";
    }
    if (d->kind == LC_PATTERN_PICTURE && !lc_picture_is_still(s, d->picture))
        return "picture is not one of the scene's";
    if ((unsigned)d->wrap > LC_BUILD_BLACK) return "wrap is none of lc_build_wrap";
    if ((unsigned)d->filter > LC_BUILD_TRILINEAR) return "filter is none of lc_build_filter";
    if ((unsigned)d->mapping > LC_MAPPING_CYLINDRICAL) return "mapping is none of lc_build_mapping";
    if (d->octaves < 0 || d->octaves > LC_MAX_OCTAVES) return "octaves must be 0 to 32";
    if (!are_finite(d->grey, 3)) return "grey is not finite";
    if (!are_finite(&d->scale, 1)) return "scale is not finite";
    if (!are_finite(&d->roughness, 1) || !are_finite(&d->variation, 1))
        return "roughness or variation is not finite";
    if (!are_finite(d->repeat, 2) || !are_finite(d->offset, 2)) return "repeat or offset is not finite";
    if (!are_finite(d->v1, 3) || !are_finite(d->v2, 3)) return "v1 or v2 is not finite";
    return are_finite(d->to_texture, 12) ? NULL : "to_texture is not finite";
}

static lc_texture pattern_of(const lc_build_pattern_desc *d)
{
    double sum = 0;
    lc_texture t = { .kind = (lc_tex_kind)d->kind,
                     .is_float = d->n_channels == 1,
                     .map = { .kind = (lc_tex_map_kind)d->mapping,
                              .su = d->repeat[0],
                              .sv = d->repeat[1],
                              .du = d->offset[0],
                              .dv = d->offset[1] },
                     .image = LC_NONE,
                     .wrap = (lc_wrap)d->wrap,
                     .filter = (lc_filter)d->filter,
                     .scale = d->scale,
                     .invert = d->invert != 0,
                     .solid = d->solid != 0,
                     .sharp = d->sharp != 0,
                     .octaves = d->octaves,
                     .roughness = d->roughness,
                     .variation = d->variation };
    memcpy(t.map.v1, d->v1, sizeof t.map.v1);
    memcpy(t.map.v2, d->v2, sizeof t.map.v2);
    memcpy(t.map.to_texture, d->to_texture, sizeof t.map.to_texture);
    memcpy(t.grey, d->grey, sizeof t.grey);
    for (int i = 0; i < 12; i++) sum += i % 4 < 3 ? d->to_texture[i] * d->to_texture[i] : 0;
    t.map.stretch = sqrt(sum / 3);
    for (int i = 0; i < 4; i++) {
        t.in[i].id = d->in[i].id;
        memcpy(t.in[i].value, d->in[i].value, sizeof t.in[i].value);
    }
    return t;
}

static void digest_pattern(lc_scene *s, const lc_build_pattern_desc *d)
{
    lc_digest *to = &s->inputs.digest;
    if (!lc_build_mark(s, LC_CALL_PATTERN)) return;
    lc_digest_u64(to, (uint64_t)d->kind << 32 | d->n_channels);
    lc_digest_u64(to, (uint64_t)d->picture << 32 | (uint64_t)d->wrap << 16 | (uint64_t)d->filter);
    lc_digest_u64(to, (uint64_t)d->octaves << 32 | (uint64_t)d->mapping << 8 | (d->invert ? 4u : 0) |
                          (d->solid ? 2u : 0) | (d->sharp ? 1u : 0));
    for (int i = 0; i < 4; i++) {
        lc_digest_u64(to, d->in[i].id);
        lc_digest_add(to, d->in[i].value, sizeof d->in[i].value);
    }
    lc_digest_add(to, d->grey, sizeof d->grey);
    lc_digest_number(to, d->scale);
    lc_digest_number(to, d->roughness);
    lc_digest_number(to, d->variation);
    lc_digest_add(to, d->repeat, sizeof d->repeat);
    lc_digest_add(to, d->offset, sizeof d->offset);
    lc_digest_add(to, d->v1, sizeof d->v1);
    lc_digest_add(to, d->v2, sizeof d->v2);
    lc_digest_add(to, d->to_texture, sizeof d->to_texture);
}

lc_status lc_build_pattern(lc_scene *s, const lc_build_pattern_desc *desc, uint32_t *id)
{
    static const char call[] = "lc_build_pattern";
    lc_build_pattern_desc d = LC_BUILD_PATTERN_DESC_INIT;
    bool too_deep = false;
    lc_status st = lc_build_take(s, "lc_build_pattern_desc", &d, sizeof d, desc);
    if (st) return st;
    if (!id) return lc_fail(s->ctx, LC_ERR_ARG, "%s: id is NULL", call);
    const char *wrong = pattern_fault(s, &d);
    if (wrong) return bad(s, call, wrong);
    lc_texture t = pattern_of(&d);
    if (d.kind == LC_PATTERN_PICTURE) st = lc_picture_as_image(s, d.picture, &t.image);
    if (!st) st = lc_textures_add(&s->textures, &t, id, &too_deep);
    if (!st && too_deep) {
        st = lc_scene_note_at(s, s->at, "texture depth",
                              "textures of textures beyond %d deep or %u in all: the mean takes their place",
                              LC_TEX_MAX_DEPTH, LC_TEX_MAX_COST);
        if (st) s->textures.n--;
    }
    if (!st) digest_pattern(s, &d);
    return st;
}

lc_status lc_build_texture_value(const lc_scene *s, uint32_t texture, lc_build_value *out)
{
    if (!s) return LC_ERR_ARG;
    if (!out) return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_texture_value: out is NULL");
    if (texture >= s->textures.n)
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_texture_value: texture is not one of the scene's");
    const lc_texture *t = &s->textures.items[texture];
    out->id = t->kind == LC_TEX_CONSTANT ? LC_NO_TEXTURE : texture;
    memcpy(out->value, t->mean, sizeof out->value);
    return LC_OK;
}

/* ---- materials ---- */

_Static_assert(LC_NO_TEXTURE == LC_NONE && LC_GLOSS_PHONG == 1, "numbers of lightcuts.h");

/* Its bytes are hashed up to the end of the last field. */
#define MATERIAL_BYTES (offsetof(lc_build_material_desc, coat_terms) + sizeof(uint32_t))
_Static_assert(sizeof(void *) != 8 || MATERIAL_BYTES == 148, "no bytes between fields");

_Static_assert((int)LC_REMAP_AS_IS == (int)LC_REMAP_NONE && (int)LC_REMAP_ROOT == (int)LC_REMAP_SQRT &&
                   (int)LC_REMAP_LOG == (int)LC_REMAP_POLYNOMIAL,
               "numbers of lightcuts.h");

bool lc_arg_is_unit(const float v[3]) { return fabsf(lc_f3_len(lc_f3_load(v)) - 1) < UNIT_TOLERANCE; }

bool lc_arg_is_zero(const float v[3]) { return fabsf(v[0]) + fabsf(v[1]) + fabsf(v[2]) <= 0; }

_Static_assert(LC_REFLECT_SCHLICK == (int)LC_FRESNEL_SCHLICK &&
                   LC_REFLECT_DIELECTRIC == (int)LC_FRESNEL_DIELECTRIC &&
                   LC_REFLECT_CONDUCTOR == (int)LC_FRESNEL_CONDUCTOR &&
                   LC_REFLECT_ALL == (int)LC_FRESNEL_NONE,
               "numbers of lightcuts.h");

lc_material lc_arg_material_of(const lc_shade_material *in)
{
    static const lc_lobe lobes[] = { LC_LOBE_PHONG, LC_LOBE_PHONG, LC_LOBE_WARD, LC_LOBE_OREN_NAYAR,
                                     LC_LOBE_GGX };
    const bool narrow = in->gloss == LC_GLOSS_WARD || in->gloss == LC_GLOSS_GGX;
    lc_material m = { .kd = lc_f3_load(in->kd), .lobe = lobes[in->gloss] };
    if (in->gloss == LC_GLOSS_NONE) return m;
    m.ks = lc_f3_load(in->ks);
    if (in->gloss == LC_GLOSS_PHONG) m.exponent = in->exponent;
    else memcpy(m.roughness, in->roughness, sizeof m.roughness);
    if (narrow) m.tangent = lc_f3_load(in->tangent);
    if (in->gloss != LC_GLOSS_GGX) return m;
    m.fresnel = (lc_fresnel)in->fresnel;
    m.coat = in->coat != 0;
    m.eta = lc_f3_load(in->eta);
    m.k = lc_f3_load(in->k);
    return m;
}

const char *lc_arg_material_fault(const lc_shade_material *in)
{
    if (in->gloss > LC_GLOSS_GGX) return ".gloss is none of LC_GLOSS_";
    if (in->gloss == LC_GLOSS_GGX && in->fresnel > LC_REFLECT_ALL) return ".fresnel is none of LC_REFLECT_";
    const lc_material m = lc_arg_material_of(in);
    if (in->gloss >= LC_GLOSS_WARD && !(m.roughness[0] > 0 && m.roughness[1] > 0))
        return ".roughness is out of range";
    if ((m.lobe == LC_LOBE_WARD || m.lobe == LC_LOBE_GGX) && !lc_arg_is_zero(in->tangent) &&
        !lc_arg_is_unit(in->tangent))
        return ".tangent is neither 0 nor of length 1";
    return lc_material_in_range(&m) ? NULL : " has a number out of range";
}

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
        if (clear && lobe && !(eta >= LC_MIN_ETA && eta <= LC_MAX_ETA)) return "eta must be 1 to 3.5";
        if (clear && !(eta >= MIN_MIRROR_ETA && eta <= MAX_MIRROR_ETA)) return "eta must be 0.01 to 1000";
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
    if (!(d->coat_thickness >= 0 && d->coat_thickness <= LC_MAX_COAT_DEPTH))
        return "coat_thickness must be 0 to 1000";
    if ((unsigned)d->remap > LC_REMAP_LOG) return "remap is none of lc_build_remap";
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
                     { "roughness_texture_v", d->roughness_texture_v, true },
                     { "exponent_texture", d->exponent_texture, true },
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

static void set_roughness(const lc_scene *s, const lc_build_material_desc *d, lc_material *m,
                          lc_material_maps *maps)
{
    maps->remap = (lc_remap)d->remap;
    maps->roughness[0] = d->roughness_texture;
    maps->roughness[1] = d->roughness_texture_v;
    for (int i = 0; i < 2; i++) {
        if (maps->roughness[i] == LC_NO_TEXTURE) continue;
        const double alpha = lc_roughness_alpha(maps->remap, s->textures.items[maps->roughness[i]].mean[0]);
        m->roughness[i] = (float)fmin(fmax(alpha, (double)LC_MIN_ROUGHNESS), (double)LC_MAX_ROUGHNESS);
    }
}

static void set_exponent(const lc_scene *s, uint32_t texture, lc_material *m, lc_material_maps *maps)
{
    maps->exponent = texture;
    if (texture == LC_NO_TEXTURE) return;
    m->exponent = (float)fmin(fmax(s->textures.items[texture].mean[0], 0), (double)LC_MAX_EXPONENT);
}

/* A conductor by what it reflects along the normal, which is the texture's mean where it is not evaluated. */
static void set_metal(const lc_scene *s, uint32_t texture, lc_material *m, lc_material_maps *maps)
{
    const double *mean = s->textures.items[texture].mean;
    double eta[3] = { 1, 1, 1 }, k[3];
    for (int c = 0; c < 3; c++) lc_metal_of_share(fmin(fmax(mean[c], 0), 1), &eta[c], &k[c]);
    m->eta = lc_f3_make(1, 1, 1);
    m->k = lc_f3_make((float)k[0], (float)k[1], (float)k[2]);
    maps->ks = texture;
    maps->metal = true;
}

static lc_material material_of(const lc_build_material_desc *d)
{
    const lc_shade_material shade = shade_of(d);
    if (d->specular == LC_BUILD_ROUGH) {
        lc_material m = lc_arg_material_of(&shade);
        m.kt = lc_f3_load(d->transmitted);
        m.smooth = d->smooth && m.lobe == LC_LOBE_GGX;
        m.coat_terms = d->coat_terms;
        if (m.coat && d->coat_thickness > 0) lc_coat_absorb(&m, (double)d->coat_thickness);
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
    if (!id) return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_material: id is NULL");
    if (d.roughness_texture_v == LC_SAME_TEXTURE) d.roughness_texture_v = d.roughness_texture;
    if ((st = check_material(s, &d))) return st;
    lc_material m = material_of(&d);
    lc_material_maps maps = LC_NO_MAPS;
    const bool rough = d.specular == LC_BUILD_ROUGH, lobe = rough && d.gloss != LC_GLOSS_NONE;
    if (rough) set_tint(s, d.diffuse_texture, &m.kd, &maps.kd);
    const bool metal = d.metal && m.fresnel == LC_FRESNEL_CONDUCTOR && d.glossy_texture != LC_NO_TEXTURE;
    if (metal) set_metal(s, d.glossy_texture, &m, &maps);
    else if (!rough || lobe) set_tint(s, d.glossy_texture, &m.ks, &maps.ks);
    if (d.specular != LC_BUILD_MIRROR) set_tint(s, d.transmitted_texture, &m.kt, &maps.kt);
    if (lobe && d.gloss != LC_GLOSS_PHONG) set_roughness(s, &d, &m, &maps);
    if (lobe && d.gloss == LC_GLOSS_PHONG) set_exponent(s, d.exponent_texture, &m, &maps);
    maps.bump = d.bump_texture;
    maps.normal = d.normal_texture;
    if ((st = lc_scene_add_material(s, &m, id))) return st;
    lc_scene_map_material(s, *id, &maps);
    if (lc_build_mark(s, LC_CALL_MATERIAL)) lc_digest_add(&s->inputs.digest, &d, MATERIAL_BYTES);
    return LC_OK;
}

uint32_t lc_build_traits(const lc_scene *s, uint32_t material)
{
    if (!s || material >= s->n_materials) return 0;
    return (lc_scene_wants_uv(s, material) ? LC_TRAIT_UV : 0) |
           (lc_scene_is_textured(s, material) ? LC_TRAIT_TEXTURED : 0) |
           (s->maps[material].clear ? LC_TRAIT_CLEAR : 0);
}

lc_status lc_build_mix(lc_scene *s, const lc_build_mix_desc *desc, uint32_t *id)
{
    static const char call[] = "lc_build_mix";
    lc_build_mix_desc d = LC_BUILD_MIX_DESC_INIT;
    lc_status st = lc_build_take(s, "lc_build_mix_desc", &d, sizeof d, desc);
    if (st) return st;
    if (!id) return lc_fail(s->ctx, LC_ERR_ARG, "%s: id is NULL", call);
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
    if (!lc_build_mark(s, LC_CALL_MIX)) return LC_OK;
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
    if (t->kind != LC_TEX_IMAGE || t->map.kind != LC_MAP_UV || t->invert)
        return bad(s, call, "emission_texture must be a picture over u and v");
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
