/* pbrt_material.c - materials. diffuse, matte and mirror are exact, and phong, ward and ggx are ours: "rgb Kd", "rgb Ks" and "float
 * exponent", or "float roughness", "uroughness", "vroughness"; ggx is as ward, by Schlick. Each of these
 * may be a texture. Any other material is a diffuse one of a sensible colour. */
#include "pbrt_state.h"

#include <string.h>

typedef enum material_kind { EXACT, APPROXIMATE, INVISIBLE, PHONG, WARD, MIRROR, GLASS, THIN, LEAF } material_kind;

static const struct material {
    const char *name, *colour; /* parameter that holds the colour, or NULL */
    float grey;                /* the colour when there is none; pbrt's default where it has one */
    material_kind kind;
} materials[] = {
    { "diffuse", "reflectance", 0.5f, EXACT },
    { "matte", "Kd", 0.5f, EXACT },
    { "phong", "Kd", 0.5f, PHONG },
    { "mirror", NULL, 0, MIRROR },
    { "ward", "Kd", 0.5f, WARD },
    { "ggx", "Kd", 0.5f, GGX },
    { "", NULL, 0, INVISIBLE },
    { "none", NULL, 0, INVISIBLE },
    { "interface", NULL, 0, INVISIBLE },
    { "coateddiffuse", "reflectance", 0.5f, APPROXIMATE },
    { "diffusetransmission", "reflectance", 0.25f, LEAF },
    { "dielectric", NULL, 0, GLASS },
    { "glass", NULL, 0, GLASS },
    { "thindielectric", NULL, 0, THIN },
    { "subsurface", "reflectance", 0.5f, APPROXIMATE },
    { "conductor", "reflectance", 0.5f, APPROXIMATE },
    { "coatedconductor", "reflectance", 0.5f, APPROXIMATE },
    { "plastic", "Kd", 0.25f, APPROXIMATE },
    { "uber", "Kd", 0.25f, APPROXIMATE },
    { "substrate", "Kd", 0.5f, APPROXIMATE },
    { "translucent", "Kd", 0.25f, APPROXIMATE },
    { "kdsubsurface", "Kd", 0.5f, APPROXIMATE },
    { "disney", "color", 0.5f, APPROXIMATE },
};

static const struct material *material_of(const char *name)
{
    static const struct material other = { "other", NULL, 0.5f, APPROXIMATE };
    for (size_t i = 0; i < sizeof materials / sizeof *materials; i++)
        if (!strcmp(materials[i].name, name)) return &materials[i];
    return &other;
}

static lc_f3 to_colour(const double v[3])
{
    return lc_f3_make((float)fmin(fmax(v[0], 0), 1), (float)fmin(fmax(v[1], 0), 1), (float)fmin(fmax(v[2], 0), 1));
}

/* A reflectance parameter, clamped to 0..1; of a texture the mean, and *map is its number. */
static lc_status get_albedo(lc_pbrt *p, const char *name, lc_f3 *out, uint32_t *map)
{
    const lc_pbrt_param *par;
    lc_tex_input in;
    lc_status st = lc_pbrt_get_input(p, name, false, &in, &par);
    if (st || !par) return st;
    *out = to_colour(in.value);
    *map = in.id;
    for (int k = 0; k < 3; k++)
        if (in.value[k] < 0 || in.value[k] > 1)
            return lc_pbrt_note(p, par->pos, "reflectance", "a reflectance outside 0..1 is clamped");
    return LC_OK;
}

static lc_status get_phong(lc_pbrt *p, lc_material *m, lc_material_maps *maps)
{
    const lc_pbrt_param *par;
    lc_tex_input in;
    lc_status st = get_albedo(p, "Ks", &m->ks, &maps->ks);
    if (!st) st = lc_pbrt_get_input(p, "exponent", true, &in, &par);
    if (st) return st;
    double exponent = par ? in.value[0] : 50;
    if (par) maps->exponent = in.id;
    if (exponent < 0) return lc_pbrt_bad_param(&p->params, par, "is negative");
    if (exponent > (double)LC_MAX_EXPONENT) {
        exponent = (double)LC_MAX_EXPONENT;
        st = lc_pbrt_note(p, par->pos, "phong exponent", "a Phong exponent above %g is clamped",
                          (double)LC_MAX_EXPONENT);
    }
    m->exponent = (float)exponent;
    return st;
}

/* v3 calls its reflectance Kr. */
static lc_status get_mirror(lc_pbrt *p, lc_material *m, lc_material_maps *maps)
{
    m->mirror = true;
    m->fresnel = LC_FRESNEL_NONE;
    m->ks = lc_f3_make(0.9f, 0.9f, 0.9f);
    lc_status st = get_albedo(p, "reflectance", &m->ks, &maps->ks);
    return st ? st : get_albedo(p, "Kr", &m->ks, &maps->ks);
}

/* Smooth; v3 calls the index index or eta, and has the tints Kr and Kt. */
static lc_status get_glass(lc_pbrt *p, lc_material *m, bool thin)
{
    double eta = 1.5;
    uint32_t map;
    m->glass = true, m->thin = thin, m->fresnel = LC_FRESNEL_DIELECTRIC;
    m->ks = m->kt = lc_f3_make(1, 1, 1);
    lc_status st = lc_pbrt_get_float(&p->params, "index", &eta, NULL);
    if (!st) st = lc_pbrt_get_float(&p->params, "eta", &eta, NULL);
    if (!st) st = get_albedo(p, "Kr", &m->ks, &map);
    if (!st) st = get_albedo(p, "Kt", &m->kt, &map);
    m->eta = lc_f3_make((float)eta, (float)eta, (float)eta);
    lc_pbrt_mark_all(&p->params);
    return st;
}

/* One of Ward's two; *value keeps its value and *map its texture where the parameter is absent. */
static lc_status get_roughness(lc_pbrt *p, const char *name, float *value, uint32_t *map)
{
    const lc_pbrt_param *par;
    lc_tex_input in;
    lc_status st = lc_pbrt_get_input(p, name, true, &in, &par);
    if (st || !par) return st;
    if (in.value[0] < 0) return lc_pbrt_bad_param(&p->params, par, "is negative");
    *value = (float)fmin(fmax(in.value[0], (double)LC_MIN_ROUGHNESS), (double)LC_MAX_ROUGHNESS);
    *map = in.id;
    if (in.id == LC_NONE && ((float)in.value[0] < LC_MIN_ROUGHNESS || (float)in.value[0] > LC_MAX_ROUGHNESS))
        return lc_pbrt_note(p, par->pos, "ward roughness", "a roughness outside %g..%g is clamped",
                            (double)LC_MIN_ROUGHNESS, (double)LC_MAX_ROUGHNESS);
    return LC_OK;
}

static lc_status get_ward(lc_pbrt *p, lc_material *m, lc_material_maps *maps)
{
    lc_status st = get_albedo(p, "Ks", &m->ks, &maps->ks);
    m->gloss = LC_GLOSS_WARD;
    m->roughness[0] = 0.1f;
    if (!st) st = get_roughness(p, "roughness", &m->roughness[0], &maps->roughness[0]);
    m->roughness[1] = m->roughness[0], maps->roughness[1] = maps->roughness[0];
    if (!st) st = get_roughness(p, "uroughness", &m->roughness[0], &maps->roughness[0]);
    if (!st) st = get_roughness(p, "vroughness", &m->roughness[1], &maps->roughness[1]);
    return st;
}

/* Adds the material of this name with the statement's parameters to the scene. */
static lc_status add_material(lc_pbrt *p, lc_pos where, const char *name, lc_pbrt_material *out)
{
    const struct material *kind = material_of(name);
    lc_material m = { .kd = { kind->grey, kind->grey, kind->grey } };
    lc_material_maps maps = LC_NO_MAPS;
    lc_status st = kind->colour ? get_albedo(p, kind->colour, &m.kd, &maps.kd) : LC_OK;
    if (!st && kind->kind == PHONG) st = get_phong(p, &m, &maps);
    if (!st && kind->kind == MIRROR) st = get_mirror(p, &m, &maps);
    if (!st && kind->kind == LEAF) m.kt = lc_f3_make(0.25f, 0.25f, 0.25f), st = get_albedo(p, "transmittance", &m.kt, &maps.kt);
    if (!st && (kind->kind == GLASS || kind->kind == THIN)) st = get_glass(p, &m, kind->kind == THIN);
    if (!st && kind->kind == WARD) st = get_ward(p, &m, &maps);
    if (!st && (kind->kind == WARD || kind->kind == GGX)) st = get_ward(p, &m, &maps);
    if (kind->kind == GGX) m.gloss = LC_GLOSS_GGX;
    if (!st && kind->kind == APPROXIMATE)
        st = lc_pbrt_note_name(p, where, "material", name, "a diffuse material takes its place");
    if (!st && kind->kind == EXACT && lc_pbrt_find(&p->params, "sigma", LC_PBRT_ANY))
        st = lc_pbrt_note(p, where, "matte sigma", "Oren-Nayar's sigma is ignored: plain diffuse");
    if (kind->kind == APPROXIMATE || kind->kind == INVISIBLE) lc_pbrt_mark_all(&p->params);
    p->owner = name;
    out->invisible = kind->kind == INVISIBLE;
    if (!st) st = lc_scene_add_material(p->scene, &m, &out->id);
    if (!st) lc_scene_map_material(p->scene, out->id, &maps);
    return st;
}

static void use(lc_pbrt *p, const lc_pbrt_material *m)
{
    p->attrs.material_id = m->id;
    p->attrs.invisible = m->invisible;
}

lc_status lc_pbrt_do_material(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_pbrt_material m;
    lc_status st = add_material(p, s->pos, s->text[0], &m);
    if (!st) use(p, &m);
    return st;
}

lc_status lc_pbrt_make_named_material(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    const char *type = NULL;
    lc_pbrt_material m;
    lc_status st = lc_pbrt_get_text(&p->params, "type", &type, NULL);
    if (st) return st;
    if (!type)
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "MakeNamedMaterial '%.80s' has no \"string type\"",
                          s->text[0]);
    if ((st = add_material(p, s->pos, type, &m))) return st;
    void *items = p->materials;
    st = lc_grow(p->ctx, &items, &p->cap_materials, p->n_materials + 1, sizeof *p->materials);
    p->materials = items;
    if (!st) st = lc_pbrt_map_put(&p->material_names, &p->arena, s->text[0], (uint32_t)p->n_materials);
    if (!st) p->materials[p->n_materials++] = m;
    return st;
}

lc_status lc_pbrt_named_material(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    uint32_t id = lc_pbrt_map_get(&p->material_names, s->text[0]);
    if (id != LC_NONE) {
        use(p, &p->materials[id]);
        return LC_OK;
    }
    p->attrs.material_id = LC_NONE;
    p->attrs.invisible = false;
    return lc_pbrt_note_name(p, s->text_pos[0], "unknown material", s->text[0],
                             "no such material; grey diffuse is used");
}

lc_status lc_pbrt_current_material(lc_pbrt *p, uint32_t *id)
{
    bool black = p->attrs.invisible;
    uint32_t *shared = black ? &p->black_material : &p->default_material;
    *id = p->attrs.material_id;
    if (!black && *id != LC_NONE) return LC_OK;
    lc_material m = { .kd = lc_f3_make(0.5f, 0.5f, 0.5f) };
    if (black) m.kd = lc_f3_make(0, 0, 0);
    lc_status st = *shared == LC_NONE ? lc_scene_add_material(p->scene, &m, shared) : LC_OK;
    *id = *shared;
    return st;
}
