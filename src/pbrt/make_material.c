/* make_material.c - Material statements: the table of classes, materials by name, mixes. material_v3.c,
 * material_v4.c and material_own.c read the classes; an unknown class becomes grey and diffuse. */
#include "pbrt/make_material.h"

#include <string.h>

#define MIN_CONDUCTOR_ETA 2e-3f /* its square is above LC_MIN_CONDUCTOR */

static lc_status invisible(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    (void)where;
    lc_pbrt_mark_all(&p->params);
    look->invisible = true;
    return LC_OK;
}

static const char diffuse_instead[] = "a diffuse material takes its place";

static const struct class
{
    const char *name;
    lc_pbrt_reader *read;
    const char *note; /* how the class is approximated; NULL: exact, except for what its reader notes */
} classes[] = {
    { "diffuse", lc_pbrt_diffuse, NULL },
    { "matte", lc_pbrt_matte, NULL },
    { "coateddiffuse", lc_pbrt_coated_diffuse,
      "a Lambertian surface below a GGX coat; paths between the two are summed up by a formula" },
    { "dielectric", lc_pbrt_dielectric, NULL },
    { "conductor", lc_pbrt_conductor, NULL },
    { "plastic", lc_pbrt_plastic, NULL },
    { "uber", lc_pbrt_uber, NULL },
    { "substrate", lc_pbrt_substrate,
      "Lambert and GGX with Schlick's Fresnel for Ashikhmin and Shirley's blend" },
    { "metal", lc_pbrt_metal, NULL },
    { "glass", lc_pbrt_glass, NULL },
    { "mirror", lc_pbrt_mirror, NULL },
    { "mix", lc_pbrt_mix, NULL },
    { "translucent", lc_pbrt_translucent, NULL },
    { "diffusetransmission", lc_pbrt_diffuse_transmission, NULL },
    { "thindielectric", lc_pbrt_thin_dielectric, NULL },
    { "coatedconductor", lc_pbrt_coated_conductor,
      "one conductor that reflects what both layers do together along the normal" },
    { "", invisible, NULL },
    { "none", invisible, NULL },
    { "interface", invisible, NULL },
    { "subsurface", lc_pbrt_subsurface, diffuse_instead },
    { "kdsubsurface", lc_pbrt_kd_subsurface, diffuse_instead },
    { "disney", lc_pbrt_disney, "Lambert and GGX of its color, metallic and roughness" },
    { "hair", lc_pbrt_hair, diffuse_instead },
    { "phong", lc_pbrt_phong, NULL },
    { "ward", lc_pbrt_ward, NULL },
    { "ggx", lc_pbrt_ggx, NULL },
};

static lc_status unknown_class(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    (void)where;
    (void)look;
    lc_pbrt_mark_all(&p->params);
    return LC_OK;
}

static const struct class *class_of(const char *name)
{
    static const struct class other = { "other", unknown_class, diffuse_instead };
    for (size_t i = 0; i < sizeof classes / sizeof *classes; i++)
        if (!strcmp(classes[i].name, name)) return &classes[i];
    return &other;
}

/* ---- mixes ---- */

static float within(float v, float least, float most) { return fminf(fmaxf(v, least), most); }

/* Limits indices of refraction to the range for which the bounds of lobes hold. */
static void limit_index(lc_material *m)
{
    float *eta[3] = { &m->eta.x, &m->eta.y, &m->eta.z }, *k[3] = { &m->k.x, &m->k.y, &m->k.z };
    if (m->lobe != LC_LOBE_GGX) return;
    if (m->coat || m->fresnel == LC_FRESNEL_DIELECTRIC) m->eta.x = within(m->eta.x, LC_MIN_ETA, LC_MAX_ETA);
    for (int c = 0; c < 3 && m->fresnel == LC_FRESNEL_CONDUCTOR; c++) {
        *eta[c] = within(*eta[c], MIN_CONDUCTOR_ETA, LC_MAX_CONDUCTOR);
        *k[c] = within(*k[c], 0, LC_MAX_CONDUCTOR);
    }
}

/* Of mirrors, whose indices bound nothing, those that make no sense. */
static void limit_mirror(lc_material *m)
{
    float *eta[3] = { &m->eta.x, &m->eta.y, &m->eta.z }, *k[3] = { &m->k.x, &m->k.y, &m->k.z };
    if (!m->mirror || m->glass || m->fresnel != LC_FRESNEL_CONDUCTOR) return;
    for (int c = 0; c < 3; c++) {
        *eta[c] = within(*eta[c], 0, LC_MAX_CONDUCTOR);
        *k[c] = within(*k[c], 0, LC_MAX_CONDUCTOR);
        if (*eta[c] * *eta[c] + *k[c] * *k[c] < LC_MIN_CONDUCTOR) *eta[c] = MIN_CONDUCTOR_ETA;
    }
}

static lc_build_material_desc desc_of(const lc_pbrt_look *look)
{
    static const uint32_t gloss[] = { [LC_LOBE_PHONG] = LC_GLOSS_PHONG,
                                      [LC_LOBE_WARD] = LC_GLOSS_WARD,
                                      [LC_LOBE_OREN_NAYAR] = LC_GLOSS_OREN_NAYAR,
                                      [LC_LOBE_GGX] = LC_GLOSS_GGX };
    const lc_material *m = &look->m;
    const lc_material_maps *maps = &look->maps;
    const bool metal = m->fresnel == LC_FRESNEL_CONDUCTOR;
    lc_build_material_desc d = LC_BUILD_MATERIAL_DESC_INIT;
    lc_f3_store(d.diffuse, m->kd);
    lc_f3_store(d.glossy, m->ks);
    lc_f3_store(d.transmitted, m->kt);
    d.exponent = m->exponent;
    d.specular = !m->mirror  ? LC_BUILD_ROUGH
                 : !m->glass ? LC_BUILD_MIRROR
                 : m->thin   ? LC_BUILD_THIN_GLASS
                             : LC_BUILD_GLASS;
    d.gloss = gloss[m->lobe];
    memcpy(d.roughness, m->roughness, sizeof d.roughness);
    d.fresnel = (uint32_t)m->fresnel;
    lc_f3_store(d.eta, metal ? m->eta : lc_f3_make(m->eta.x, m->eta.x, m->eta.x));
    lc_f3_store(d.k, m->k);
    d.coat = m->coat;
    d.coat_thickness = look->coat_thickness;
    d.coat_terms = m->coat_terms;
    d.smooth = m->smooth;
    d.metal = maps->metal;
    d.remap = (lc_build_remap)maps->remap;
    d.diffuse_texture = maps->kd;
    d.glossy_texture = maps->ks;
    d.transmitted_texture = maps->kt;
    d.exponent_texture = maps->exponent;
    d.roughness_texture = maps->roughness[0];
    d.roughness_texture_v = maps->roughness[1];
    d.bump_texture = maps->bump;
    d.normal_texture = maps->normal;
    return d;
}

static lc_status add_mix(lc_pbrt *p, const lc_pbrt_look *look, uint32_t *id)
{
    lc_build_mix_desc d = LC_BUILD_MIX_DESC_INIT;
    lc_f3 share;
    memcpy(d.materials, look->maps.mix, sizeof d.materials);
    lc_pbrt_set_tint(&look->share, &share, &d.share_texture);
    lc_f3_store(d.share, share);
    return lc_build_mix(p->scene, &d, id);
}

static lc_status add_look(lc_pbrt *p, lc_pos where, lc_pbrt_look *look, uint32_t *id)
{
    lc_status st = lc_pbrt_at(p, where);
    if (st) return st;
    *id = look->same;
    if (look->same != LC_NONE) return LC_OK;
    if (look->maps.mix[0] != LC_NONE) return add_mix(p, look, id);
    limit_index(&look->m);
    limit_mirror(&look->m);
    const lc_build_material_desc d = desc_of(look);
    return lc_build_material(p->scene, &d, id);
}

/* Adds a material that transmits everything unchanged. */
static lc_status add_clear(lc_pbrt *p, uint32_t *id)
{
    lc_build_material_desc d = LC_BUILD_MATERIAL_DESC_INIT;
    d.specular = LC_BUILD_THIN_GLASS;
    for (int k = 0; k < 3; k++) d.transmitted[k] = d.eta[k] = 1;
    return lc_build_material(p->scene, &d, id);
}

static lc_status add_grey(lc_pbrt *p, float kd, uint32_t *id)
{
    lc_build_material_desc d = LC_BUILD_MATERIAL_DESC_INIT;
    for (int k = 0; k < 3; k++) d.diffuse[k] = kd;
    return lc_build_material(p->scene, &d, id);
}

/* The id of a material for a mix: an earlier one by name. */
static lc_status get_part(lc_pbrt *p, lc_pos where, const char *name, uint32_t *id, uint32_t *depth)
{
    uint32_t at = name ? lc_pbrt_map_get(&p->material_names, name) : LC_NONE;
    *depth = 0;
    if (at != LC_NONE) {
        *id = p->materials[at].id;
        if (p->materials[at].invisible) return add_clear(p, id);
        *depth = p->materials[at].depth;
        return LC_OK;
    }
    lc_status st = lc_pbrt_note_name(p, where, "unknown material", name ? name : "",
                                     "no such material; grey diffuse is used");
    return st ? st : add_grey(p, 0.5f, id);
}

/* Makes the look a mix of two materials of the scene, with so many mixes within them; share is the weight of
 * the second. */
static lc_status be_mix(lc_pbrt *p, lc_pos where, const uint32_t parts[2], uint32_t depth,
                        const lc_build_value *share, lc_pbrt_look *look)
{
    double mean = (share->value[0] + share->value[1] + share->value[2]) / 3;
    look->maps = (lc_material_maps)LC_NO_MAPS;
    look->share = *share;
    memcpy(look->maps.mix, parts, sizeof look->maps.mix);
    look->depth = depth + 1;
    if (depth < LC_MAX_MIX) return LC_OK;
    look->same = parts[mean < 0.5 ? 0 : 1];
    look->depth = depth;
    return lc_pbrt_note(p, where, "mix depth",
                        "mixes of mixes beyond %d deep: one of the two takes their place", LC_MAX_MIX);
}

static bool is_float_param(lc_pbrt *p, const char *name)
{
    const lc_pbrt_param *par = lc_pbrt_find(&p->params, name, LC_PBRT_FLOAT | LC_PBRT_INT | LC_PBRT_TEXTURE);
    if (!par || par->type != LC_PBRT_TEXTURE) return par != NULL;
    return par->n == 1 && lc_pbrt_map_get(&p->float_textures, p->params.text[par->first]) != LC_NONE;
}

/* v3: "amount" is the weight of "namedmaterial1". v4: the weight of the second of "materials". */
lc_status lc_pbrt_mix(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    const char *names[2] = { NULL, NULL };
    const lc_pbrt_param *both = lc_pbrt_find(&p->params, "materials", LC_PBRT_TEXT), *par;
    lc_build_value share = LC_PBRT_VALUE(0.5), given;
    uint32_t id[2], depth[2];
    bool is_float = is_float_param(p, "amount");
    lc_status st = LC_OK;
    if (both && both->n != 2) return lc_pbrt_bad_param(&p->params, both, "needs the names of two materials");
    for (size_t i = 0; i < 2 && both; i++) names[i] = p->params.text[both->first + i];
    if (!both) st = lc_pbrt_get_text(&p->params, "namedmaterial2", &names[0], NULL);
    if (!st && !both) st = lc_pbrt_get_text(&p->params, "namedmaterial1", &names[1], NULL);
    if (!st && !is_float) st = lc_pbrt_get_tint(p, "amount", &share);
    if (!st && is_float) st = lc_pbrt_get_input(p, "amount", true, &given, &par);
    if (!st && is_float) share = given;
    for (int i = 0; i < 2 && !st; i++) st = get_part(p, where, names[i], &id[i], &depth[i]);
    return st ? st : be_mix(p, where, id, depth[0] > depth[1] ? depth[0] : depth[1], &share, look);
}

/* Makes a look that is not opaque a mix with a material that transmits everything. */
static lc_status apply_opacity(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    const double *v = look->opacity.value;
    uint32_t parts[2]; /* clear, opaque */
    if (look->opacity.id == LC_NONE && v[0] >= 1 && v[1] >= 1 && v[2] >= 1) return LC_OK;
    lc_status st = add_look(p, where, look, &parts[1]);
    if (!st) st = add_clear(p, &parts[0]);
    return st ? st : be_mix(p, where, parts, look->depth, &look->opacity, look);
}

/* ---- statements ---- */

/* Reads v4's "displacement" or v3's "bumpmap": a float texture. */
static lc_status get_bump(lc_pbrt *p, const char *name, uint32_t *id)
{
    const lc_pbrt_param *par;
    lc_build_value in;
    lc_status st = lc_pbrt_get_input(p, name, true, &in, &par);
    if (!st && par) *id = in.id;
    return st;
}

/* Reads v4's "normalmap": the name of an image. */
static lc_status get_normal_map(lc_pbrt *p, uint32_t *id)
{
    const lc_encoding linear = { .kind = LC_ENCODING_LINEAR };
    const char *name = NULL;
    const lc_pbrt_param *par;
    lc_build_pattern_desc t = LC_BUILD_PATTERN_DESC_INIT;
    lc_status st = lc_pbrt_get_text(&p->params, "normalmap", &name, &par);
    if (st || !name) return st;
    t.kind = LC_PATTERN_PICTURE;
    st = lc_pbrt_find_image(p, par->pos, name, linear, &t.picture);
    if (st || t.picture == LC_NO_PICTURE) return st;
    return lc_build_pattern(p->scene, &t, id);
}

/* Adds a material of the class `name` with the statement's parameters to the scene. */
static lc_status add_material(lc_pbrt *p, lc_pos where, const char *name, lc_pbrt_material *out)
{
    const struct class *class = class_of(name);
    lc_pbrt_look look = {
        .m = { .kd = { 0.5f, 0.5f, 0.5f } }, .maps = LC_NO_MAPS, .opacity = LC_PBRT_VALUE(1), .same = LC_NONE
    };
    lc_status st = class->read(p, where, &look);
    if (!st) st = get_bump(p, "bumpmap", &look.maps.bump);
    if (!st) st = get_bump(p, "displacement", &look.maps.bump);
    if (!st) st = get_normal_map(p, &look.maps.normal);
    if (!st) st = apply_opacity(p, where, &look);
    if (!st && class->note) st = lc_pbrt_note_name(p, where, "material", name, class->note);
    p->owner = name;
    out->invisible = look.invisible;
    if (!st) st = add_look(p, where, &look, &out->id);
    out->depth = look.depth;
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
    p->attrs.material_name = NULL;
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
    p->attrs.material_name = NULL;
    if (lc_build_asked(p->scene)->n_groups &&
        !(p->attrs.material_name = lc_arena_text(&p->arena, s->text[0], strlen(s->text[0]))))
        return LC_ERR_MEMORY;
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
    lc_status st = *shared == LC_NONE ? add_grey(p, black ? 0 : 0.5f, shared) : LC_OK;
    *id = *shared;
    return st;
}
