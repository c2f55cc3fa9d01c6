/* material.c - materials: metallic-roughness and the extensions that the scene's materials can express.
 *
 *     f0   = ((ior - 1) / (ior + 1))^2
 *     kd   = base (1 - metallic) (1 - f0 specular)         Lambert
 *     lobe = GGX, alpha = roughness^2, of reflectance
 *            metallic = 0: a dielectric's Fresnel, times specular
 *            else          Schlick's, from f0 specular (1 - metallic) + base metallic at normal incidence
 *
 * specular is KHR_materials_specular's factor times its colour. Transmission mixes in smooth glass whose
 * transmitted light has the base colour; opacity is the mesh's alpha.
 */
#include "gltf/state.h"

#include <string.h>

#define VALUE(v)  ((lc_build_value){ LC_NO_TEXTURE, { v, v, v } })
#define SMOOTH    1e-3 /* alpha below which a surface is a mirror */
#define MIN_ALPHA 1e-3
#define MIN_IOR   1.0
#define MAX_IOR   3.5

/* What is read of a material. */
typedef struct reading {
    uint32_t object, pbr;
    double base[4], metallic, roughness, ior, specular[3], transmission;
    lc_build_value base_map, metallic_map, roughness_map; /* id LC_NONE: none */
    bool thick;
} reading;

static double clamp(double v, double least, double most) { return fmin(fmax(v, least), most); }

static lc_status find_info(const lc_gltf *g, uint32_t object, const char *name, uint32_t *info)
{
    return lc_gltf_member(g, object, name, LC_JSON_OBJECT, info);
}

/* ---- reading ---- */

static lc_status read_base(lc_gltf *g, lc_gltf_look *look, reading *r)
{
    uint32_t info;
    lc_status st = lc_gltf_numbers(g, r->pbr, "baseColorFactor", 4, r->base, NULL);
    for (int i = 0; i < 4; i++) r->base[i] = clamp(r->base[i], 0, 1);
    if (!st) st = find_info(g, r->pbr, "baseColorTexture", &info);
    if (st || info == LC_NONE) return st;
    return lc_gltf_texture(g, look, info, LC_GLTF_SRGB, -1, 1, -1, &r->base_map);
}

static lc_status read_metal(lc_gltf *g, lc_gltf_look *look, reading *r)
{
    uint32_t info;
    lc_status st = lc_gltf_number(g, r->pbr, "metallicFactor", 0, 1, &r->metallic);
    if (!st) st = lc_gltf_number(g, r->pbr, "roughnessFactor", 0, 1, &r->roughness);
    if (!st) st = find_info(g, r->pbr, "metallicRoughnessTexture", &info);
    if (st || info == LC_NONE) return st;
    if (r->metallic > 0)
        st = lc_gltf_texture(g, look, info, LC_GLTF_LINEAR, 2, r->metallic, -1, &r->metallic_map);
    if (!st && r->roughness > 0)
        st = lc_gltf_texture(g, look, info, LC_GLTF_LINEAR, 1, r->roughness, -1, &r->roughness_map);
    return st;
}

static lc_status read_extensions(lc_gltf *g, reading *r)
{
    double factor = 1, colour[3] = { 1, 1, 1 }, thickness = 0;
    uint32_t ior = lc_gltf_extension(g, r->object, "KHR_materials_ior");
    uint32_t specular = lc_gltf_extension(g, r->object, "KHR_materials_specular");
    uint32_t through = lc_gltf_extension(g, r->object, "KHR_materials_transmission");
    uint32_t volume = lc_gltf_extension(g, r->object, "KHR_materials_volume");
    lc_status st = lc_gltf_number(g, ior, "ior", 0, 1e6, &r->ior);
    if (!st) st = lc_gltf_number(g, specular, "specularFactor", 0, 1, &factor);
    if (!st) st = lc_gltf_numbers(g, specular, "specularColorFactor", 3, colour, NULL);
    if (!st) st = lc_gltf_number(g, through, "transmissionFactor", 0, 1, &r->transmission);
    if (!st) st = lc_gltf_number(g, volume, "thicknessFactor", 0, 1e30, &thickness);
    for (int i = 0; i < 3; i++) r->specular[i] = clamp(factor * colour[i], 0, 1);
    r->thick = thickness > 0;
    if (!st && (lc_json_find(&g->json, specular, "specularTexture") != LC_NONE ||
                lc_json_find(&g->json, specular, "specularColorTexture") != LC_NONE))
        st = lc_gltf_note(g, specular, "specular texture", "textures of KHR_materials_specular are ignored");
    if (!st && lc_json_find(&g->json, through, "transmissionTexture") != LC_NONE)
        st = lc_gltf_note(g, through, "transmission texture",
                          "textures of KHR_materials_transmission are ignored");
    if (!st && (r->ior < MIN_IOR || r->ior > MAX_IOR))
        st = lc_gltf_note(g, ior, "ior", "an index of refraction of %g is clamped to %g..%g", r->ior, MIN_IOR,
                          MAX_IOR);
    r->ior = clamp(r->ior, MIN_IOR, MAX_IOR);
    return st;
}

/* ---- textures of textures ---- */

static lc_status add(lc_gltf *g, const lc_build_pattern_desc *t, lc_build_value *out)
{
    uint32_t id;
    lc_status st = lc_build_pattern(g->scene, t, &id);
    return st ? st : lc_build_texture_value(g->scene, id, out);
}

static lc_build_pattern_desc pattern(lc_build_pattern_kind kind, const lc_build_value *a,
                                     const lc_build_value *b, const lc_build_value *c)
{
    lc_build_pattern_desc t = LC_BUILD_PATTERN_DESC_INIT;
    t.kind = kind;
    t.in[0] = *a;
    t.in[1] = *b;
    t.in[2] = *c;
    return t;
}

/* *out = a b */
static lc_status product(lc_gltf *g, const lc_build_value *a, const lc_build_value *b, lc_build_value *out)
{
    lc_build_pattern_desc t = pattern(LC_PATTERN_SCALE, a, b, &VALUE(1));
    bool one = b->id == LC_NO_TEXTURE;
    for (int k = 0; k < 3; k++) one &= !(b->value[k] < 1 || b->value[k] > 1);
    if (one) {
        *out = t.in[0];
        return LC_OK;
    }
    for (int k = 0; k < 3; k++) out->value[k] = t.in[0].value[k] * t.in[1].value[k];
    out->id = LC_NO_TEXTURE;
    return t.in[0].id == LC_NO_TEXTURE && t.in[1].id == LC_NO_TEXTURE ? LC_OK : add(g, &t, out);
}

/* *out = (1 - w) a + w b */
static lc_status blend(lc_gltf *g, const lc_build_value *a, const lc_build_value *b, const lc_build_value *w,
                       lc_build_value *out)
{
    lc_build_pattern_desc t = pattern(LC_PATTERN_MIX, a, b, w);
    for (int k = 0; k < 3; k++) out->value[k] = (1 - w->value[k]) * a->value[k] + w->value[k] * b->value[k];
    out->id = LC_NO_TEXTURE;
    if (w->id == LC_NO_TEXTURE && !(w->value[0] > 0)) *out = t.in[0];
    else if (w->id == LC_NO_TEXTURE && !(w->value[0] < 1)) *out = t.in[1];
    else if (t.in[0].id != LC_NO_TEXTURE || t.in[1].id != LC_NO_TEXTURE || w->id != LC_NO_TEXTURE)
        return add(g, &t, out);
    return LC_OK;
}

static void set_tint(const lc_build_value *in, float value[3], uint32_t *map)
{
    for (int k = 0; k < 3; k++) value[k] = (float)clamp(in->value[k], 0, 1);
    *map = in->id;
}

/* ---- making ---- */

static lc_status set_roughness(lc_gltf *g, const reading *r, lc_build_material_desc *m)
{
    double alpha = r->roughness * r->roughness;
    if (r->roughness_map.id != LC_NO_TEXTURE) {
        lc_build_pattern_desc t = pattern(LC_PATTERN_SCALE, &r->roughness_map, &r->roughness_map, &VALUE(1));
        lc_build_value squared;
        t.n_channels = 1;
        lc_status st = add(g, &t, &squared);
        if (st) return st;
        alpha = squared.value[0];
        m->roughness_texture = squared.id;
    } else if (alpha < SMOOTH) {
        m->smooth = 1;
    }
    m->roughness[0] = m->roughness[1] = (float)clamp(alpha, MIN_ALPHA, 1);
    return LC_OK;
}

/* The opaque part: Lambert and a lobe. */
static lc_status make_opaque(lc_gltf *g, const reading *r, const lc_build_value *base,
                             lc_build_material_desc *m)
{
    double f0 = (r->ior - 1) / (r->ior + 1) * ((r->ior - 1) / (r->ior + 1));
    lc_build_value metal = r->metallic_map.id != LC_NO_TEXTURE ? r->metallic_map : VALUE(r->metallic);
    lc_build_value rest = VALUE(0), none = VALUE(0), shine = VALUE(0), kd, ks;
    bool dielectric = metal.id == LC_NO_TEXTURE && !(r->metallic > 0), matte = dielectric;
    for (int k = 0; k < 3; k++) {
        shine.value[k] = f0 * r->specular[k];
        rest.value[k] = 1 - shine.value[k];
        matte &= !(shine.value[k] > 0);
    }
    lc_status st = product(g, base, &rest, &kd);
    if (!st) st = blend(g, &kd, &none, &metal, &kd);
    if (!st) st = blend(g, &shine, base, &metal, &ks);
    if (st) return st;
    set_tint(&kd, m->diffuse, &m->diffuse_texture);
    if (matte) return LC_OK;
    if (dielectric)
        for (int k = 0; k < 3; k++) ks.value[k] = r->specular[k];
    m->gloss = LC_GLOSS_GGX;
    m->fresnel = dielectric ? LC_REFLECT_DIELECTRIC : LC_REFLECT_SCHLICK;
    m->eta[0] = m->eta[1] = m->eta[2] = (float)r->ior;
    set_tint(&ks, m->glossy, &m->glossy_texture);
    st = set_roughness(g, r, m);
    if (m->smooth && metal.id == LC_NO_TEXTURE && !(r->metallic < 1)) m->specular = LC_BUILD_MIRROR;
    return st;
}

/* Glass, mixed with the opaque part by the fraction that is transmitted. */
static lc_status make_glass(lc_gltf *g, const reading *r, const lc_build_value *base, uint32_t *id)
{
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_mix_desc mix = LC_BUILD_MIX_DESC_INIT;
    m.specular = r->thick ? LC_BUILD_GLASS : LC_BUILD_THIN_GLASS;
    m.glossy[0] = m.glossy[1] = m.glossy[2] = 1;
    m.eta[0] = m.eta[1] = m.eta[2] = (float)r->ior;
    set_tint(base, m.transmitted, &m.transmitted_texture);
    mix.materials[0] = *id;
    lc_status st = lc_build_material(g->scene, &m, &mix.materials[1]);
    if (st) return st;
    float share = (float)(r->transmission * (1 - r->metallic));
    if (!(share < 1)) {
        *id = mix.materials[1];
        return LC_OK;
    }
    mix.share[0] = mix.share[1] = mix.share[2] = share;
    return lc_build_mix(g->scene, &mix, id);
}

static lc_status read_alpha(lc_gltf *g, lc_gltf_look *look, const reading *r)
{
    const char *mode = NULL;
    double cutoff = 0.5;
    uint32_t info;
    lc_status st = lc_gltf_text(g, r->object, "alphaMode", &mode);
    if (!st) st = lc_gltf_number(g, r->object, "alphaCutoff", 0, 1e30, &cutoff);
    if (!st) st = find_info(g, r->pbr, "baseColorTexture", &info);
    if (st || !mode || !strcmp(mode, "OPAQUE")) return st;
    bool mask = !strcmp(mode, "MASK");
    if (!mask && strcmp(mode, "BLEND"))
        return lc_gltf_note(g, r->object, "alphaMode", "'%.40s' is no alphaMode", mode);
    lc_build_value a = VALUE(mask ? (r->base[3] >= cutoff ? 1 : 0) : r->base[3]);
    if (info != LC_NONE) {
        /* the image's alpha times the factor, against the cutoff */
        double limit = mask ? (r->base[3] > 0 ? cutoff / r->base[3] : 2) : -1;
        lc_build_value map = VALUE(0);
        st = lc_gltf_texture(g, look, info, LC_GLTF_ALPHA, 0, mask ? 1 : r->base[3], limit, &map);
        if (st) return st;
        if (map.id != LC_NO_TEXTURE) a = map;
    }
    look->alpha = a;
    return LC_OK;
}

static lc_status read_emission(lc_gltf *g, lc_gltf_look *look, uint32_t object)
{
    double factor[3] = { 0, 0, 0 }, strength = 1;
    uint32_t info, extension = lc_gltf_extension(g, object, "KHR_materials_emissive_strength");
    lc_status st = lc_gltf_numbers(g, object, "emissiveFactor", 3, factor, NULL);
    if (!st) st = lc_gltf_number(g, extension, "emissiveStrength", 0, 1e30, &strength);
    if (!st) st = find_info(g, object, "emissiveTexture", &info);
    if (st) return st;
    for (int i = 0; i < 3; i++) factor[i] = clamp(factor[i] * strength, 0, 1e30);
    look->emission = lc_f3_make((float)factor[0], (float)factor[1], (float)factor[2]);
    if (!(lc_f3_max(look->emission) > 0) || info == LC_NONE) return LC_OK;
    uint32_t id;
    st = lc_gltf_image(g, info, LC_GLTF_SRGB, -1, &id);
    if (!st) look->emission_picture = id;
    return st ? st : lc_gltf_place_texture(g, look, info);
}

static lc_status read_normal(lc_gltf *g, lc_gltf_look *look, uint32_t object, lc_build_material_desc *m)
{
    uint32_t info;
    double scale = 1;
    lc_build_value map;
    lc_status st = find_info(g, object, "normalTexture", &info);
    if (st || info == LC_NONE) return st;
    st = lc_gltf_texture(g, look, info, LC_GLTF_LINEAR, -1, 1, -1, &map);
    if (!st) st = lc_gltf_number(g, info, "scale", -1e30, 1e30, &scale);
    if (!st) m->normal_texture = map.id;
    if (!st && (scale < 1 || scale > 1))
        st = lc_gltf_note(g, info, "normal scale", "the scale of a normal map is ignored");
    return st;
}

static lc_status make(lc_gltf *g, uint32_t object, lc_gltf_look *look)
{
    reading r = { .object = object, .base = { 1, 1, 1, 1 }, .metallic = 1, .roughness = 1, .ior = 1.5 };
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_value factor, base;
    look->alpha = VALUE(1);
    look->emission_picture = LC_NO_PICTURE;
    r.base_map = r.metallic_map = r.roughness_map = VALUE(1);
    lc_status st = lc_gltf_member(g, object, "pbrMetallicRoughness", LC_JSON_OBJECT, &r.pbr);
    if (!st) st = read_base(g, look, &r);
    if (!st) st = read_metal(g, look, &r);
    if (!st) st = read_extensions(g, &r);
    factor = (lc_build_value){ LC_NO_TEXTURE, { r.base[0], r.base[1], r.base[2] } };
    if (!st) st = product(g, &r.base_map, &factor, &base);
    if (!st) st = lc_gltf_bool(g, object, "doubleSided", &look->two_sided);
    if (!st) st = read_alpha(g, look, &r);
    if (!st) st = read_emission(g, look, object);
    if (lc_gltf_extension(g, object, "KHR_materials_unlit") != LC_NONE) {
        r.metallic = r.transmission = 0;
        r.metallic_map = VALUE(0);
        memset(r.specular, 0, sizeof r.specular);
    }
    if (!st) st = make_opaque(g, &r, &base, &m);
    if (!st) st = read_normal(g, look, object, &m);
    if (!st) st = lc_build_material(g->scene, &m, &look->id);
    if (!st && r.transmission > 0 && r.metallic < 1) st = make_glass(g, &r, &base, &look->id);
    look->made = !st;
    return st;
}

lc_status lc_gltf_material(lc_gltf *g, uint32_t idx, const lc_gltf_look **out)
{
    uint32_t n = g->lists[LC_GLTF_MATERIALS].n;
    lc_gltf_look *look = &g->looks[idx == LC_NONE ? n : idx];
    *out = look;
    if (look->made) return LC_OK;
    lc_status st = make(g, idx == LC_NONE ? LC_NONE : lc_gltf_item(g, LC_GLTF_MATERIALS, idx), look);
    return st ? st
              : lc_build_feature(
                    g->scene, "material", "metallic-roughness", LC_SUPPORT_APPROXIMATED,
                    "Lambert below GGX, the former times what the latter lets pass along the normal");
}
