/* pbrt_material.c - materials and textures. diffuse and matte are exact, and phong is ours: "rgb Kd", "rgb
 * Ks", "float exponent". Any other material is a diffuse one of a sensible colour, any other texture a
 * constant. */
#include "pbrt_state.h"

#include <string.h>

typedef enum material_kind { EXACT, APPROXIMATE, INVISIBLE, PHONG } material_kind;

static const struct material {
    const char *name, *colour; /* parameter that holds the colour, or NULL */
    float grey;                /* the colour when there is none; pbrt's default where it has one */
    material_kind kind;
} materials[] = {
    { "diffuse", "reflectance", 0.5f, EXACT },
    { "matte", "Kd", 0.5f, EXACT },
    { "phong", "Kd", 0.5f, PHONG },
    { "", NULL, 0, INVISIBLE },
    { "none", NULL, 0, INVISIBLE },
    { "interface", NULL, 0, INVISIBLE },
    { "coateddiffuse", "reflectance", 0.5f, APPROXIMATE },
    { "diffusetransmission", "reflectance", 0.25f, APPROXIMATE },
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

/* A reflectance parameter, clamped to 0..1. */
static lc_status get_albedo(lc_pbrt *p, const char *name, lc_f3 *out)
{
    const lc_pbrt_param *par = NULL;
    lc_status st = lc_pbrt_get_colour(p, name, LC_PBRT_FOR_ALBEDO, out, &par);
    if (st || !par) return st;
    lc_f3 c = lc_f3_make(fminf(fmaxf(out->x, 0), 1), fminf(fmaxf(out->y, 0), 1), fminf(fmaxf(out->z, 0), 1));
    bool same =
        c.x >= out->x && c.x <= out->x && c.y >= out->y && c.y <= out->y && c.z >= out->z && c.z <= out->z;
    *out = c;
    return same ? LC_OK : lc_pbrt_note(p, par->pos, "reflectance", "a reflectance outside 0..1 is clamped");
}

static lc_status get_phong(lc_pbrt *p, lc_material *m)
{
    const lc_pbrt_param *par;
    double exponent = 50;
    lc_status st = get_albedo(p, "Ks", &m->ks);
    if (!st) st = lc_pbrt_get_float(&p->params, "exponent", &exponent, &par);
    if (st) return st;
    if (exponent < 0) return lc_pbrt_bad_param(&p->params, par, "is negative");
    if (exponent > (double)LC_MAX_EXPONENT) {
        exponent = (double)LC_MAX_EXPONENT;
        st = lc_pbrt_note(p, par->pos, "phong exponent", "a Phong exponent above %g is clamped",
                          (double)LC_MAX_EXPONENT);
    }
    m->exponent = (float)exponent;
    return st;
}

/* Adds the material of this name with the statement's parameters to the scene. */
static lc_status add_material(lc_pbrt *p, lc_pos where, const char *name, lc_pbrt_material *out)
{
    const struct material *kind = material_of(name);
    lc_material m = { .kd = { kind->grey, kind->grey, kind->grey } };
    lc_status st = kind->colour ? get_albedo(p, kind->colour, &m.kd) : LC_OK;
    if (!st && kind->kind == PHONG) st = get_phong(p, &m);
    if (!st && kind->kind == APPROXIMATE)
        st = lc_pbrt_note_name(p, where, "material", name, "a diffuse material takes its place");
    if (!st && kind->kind == EXACT && lc_pbrt_find(&p->params, "sigma", LC_PBRT_ANY))
        st = lc_pbrt_note(p, where, "matte sigma", "Oren-Nayar's sigma is ignored: plain diffuse");
    if (kind->kind == APPROXIMATE || kind->kind == INVISIBLE) lc_pbrt_mark_all(&p->params);
    p->owner = name;
    out->invisible = kind->kind == INVISIBLE;
    return st ? st : lc_scene_add_material(p->scene, &m, &out->id);
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

/* ---- textures ---- */

/* One input of a texture: colour, number or the name of another texture. */
static lc_status get_input(lc_pbrt *p, const char *name, bool is_float, lc_f3 *out)
{
    double v;
    const lc_pbrt_param *par;
    if (!is_float) return lc_pbrt_get_colour(p, name, LC_PBRT_FOR_ALBEDO, out, NULL);
    lc_status st = lc_pbrt_get_float(&p->params, name, &v, &par);
    if (!st && par) *out = lc_f3_make((float)v, (float)v, (float)v);
    if (st || par) return st;
    par = lc_pbrt_find(&p->params, name, LC_PBRT_TEXTURE);
    uint32_t id =
        par && par->n == 1 ? lc_pbrt_map_get(&p->float_textures, p->params.text[par->first]) : LC_NONE;
    if (id != LC_NONE) *out = p->textures[id];
    return LC_OK;
}

/* A colour texture's "scale" may be a number, also one from a float texture. */
static lc_status get_factor(lc_pbrt *p, bool is_float, lc_f3 *out)
{
    lc_status st = get_input(p, "scale", true, out);
    return st || is_float ? st : get_input(p, "scale", false, out);
}

/* Mean value of a texture of this class. */
static lc_status mean_value(lc_pbrt *p, const char *class_name, bool is_float, lc_f3 *out)
{
    lc_f3 a = lc_f3_make(1, 1, 1), b = a, k = a;
    lc_status st = LC_OK;
    if (!strcmp(class_name, "constant")) return get_input(p, "value", is_float, out);
    if (!strcmp(class_name, "scale") || !strcmp(class_name, "mix") || !strcmp(class_name, "checkerboard")) {
        bool scale = !strcmp(class_name, "scale");
        if (!strcmp(class_name, "checkerboard")) b = lc_f3_make(0, 0, 0);
        if (!strcmp(class_name, "mix")) a = lc_f3_make(0, 0, 0);
        st = get_input(p, "tex1", is_float, &a);
        if (!st) st = get_input(p, "tex2", is_float, &b);
        if (!st && scale) st = get_input(p, "tex", is_float, &a);
        if (!st && scale) st = get_factor(p, is_float, &k);
        *out = scale ? lc_f3_mul(lc_f3_mul(a, b), k) : lc_f3_scale(lc_f3_add(a, b), 0.5f);
        return st;
    }
    *out = lc_f3_make(0.5f, 0.5f, 0.5f);
    if (strcmp(class_name, "imagemap")) return LC_OK;
    st = get_factor(p, true, &k);
    *out = lc_f3_mul(*out, k);
    return st;
}

lc_status lc_pbrt_texture(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    bool is_float = !strcmp(s->text[1], "float");
    if (!is_float && strcmp(s->text[1], "spectrum") && strcmp(s->text[1], "color"))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->text_pos[1],
                          "texture type '%.80s' is none of float, spectrum, color", s->text[1]);
    lc_f3 value = lc_f3_make(1, 1, 1);
    lc_status st = mean_value(p, s->text[2], is_float, &value);
    p->owner = s->text[2];
    bool constant = !strcmp(s->text[2], "constant");
    if (!constant) lc_pbrt_mark_all(&p->params);
    /* Float textures shape nothing that is rendered, so only colours are worth a note. */
    if (!st && !constant && !is_float)
        st = lc_pbrt_note_name(p, s->pos, "texture", s->text[2], "a constant colour takes its place");
    if (st) return st;
    value = lc_f3_make(fminf(value.x, FLT_MAX), fminf(value.y, FLT_MAX), fminf(value.z, FLT_MAX));
    if (!lc_f3_finite(value)) value = lc_f3_make(0.5f, 0.5f, 0.5f);
    void *items = p->textures;
    st = lc_grow(p->ctx, &items, &p->cap_textures, p->n_textures + 1, sizeof *p->textures);
    p->textures = items;
    if (!st)
        st = lc_pbrt_map_put(is_float ? &p->float_textures : &p->colour_textures, &p->arena, s->text[0],
                             (uint32_t)p->n_textures);
    if (!st) p->textures[p->n_textures++] = value;
    return st;
}
