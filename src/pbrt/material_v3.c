/* material_v3.c - the materials of pbrt v2 and v3, with v3's defaults.
 *
 *     matte        Lambert, or Oren and Nayar's with sigma > 0; their model's sigma is at most 1 rad
 *     plastic      Lambert + GGX of a dielectric with index 1.5, times Ks, as in pbrt
 *     uber         the same with a given index; what opacity leaves is transmitted. Glass or a mirror if it
 *                  is only specular
 *     substrate    Lambert of Kd (1 - Ks) + GGX with Schlick's Fresnel from Ks, in place of the model of
 *                  Ashikhmin and Shirley
 *     metal        GGX of a conductor; a mirror if smooth
 *     glass        smooth, whatever its roughness
 *     translucent  Lambert on both sides + GGX on the viewer's side
 *     disney       Lambert + GGX with Schlick's Fresnel
 */
#include "pbrt/make_material.h"

#include <string.h>

static const lc_f3 ONE = { 1, 1, 1 };

lc_status lc_pbrt_matte(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    (void)where;
    double sigma = 0;
    lc_status st = lc_pbrt_get_albedo(p, "Kd", &look->m.kd, &look->maps.kd);
    if (!st) st = lc_pbrt_get_mean(p, "sigma", &sigma);
    if (st || !(sigma > 0)) return st;
    float rad = (float)fmin(sigma * LC_PI / 180, (double)LC_MAX_ROUGHNESS);
    lc_material *m = &look->m;
    m->lobe = LC_LOBE_OREN_NAYAR;
    m->roughness[0] = m->roughness[1] = fmaxf(rad, LC_MIN_ROUGHNESS);
    m->ks = m->kd;
    look->maps.ks = look->maps.kd;
    return LC_OK;
}

lc_status lc_pbrt_mirror(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    lc_material *m = &look->m;
    (void)where;
    lc_pbrt_be_mirror(m);
    m->fresnel = LC_FRESNEL_NONE;
    m->ks = lc_f3_make(0.9f, 0.9f, 0.9f);
    lc_status st = lc_pbrt_get_albedo(p, "reflectance", &m->ks, &look->maps.ks);
    return st ? st : lc_pbrt_get_albedo(p, "Kr", &m->ks, &look->maps.ks);
}

/* Reads the index from "eta" or else "index". */
static lc_status get_eta(lc_pbrt *p, lc_material *m)
{
    double index = 1.5;
    lc_status st = lc_pbrt_get_index(p, "index", &index);
    if (!st) st = lc_pbrt_get_index(p, "eta", &index);
    lc_pbrt_set_index(m, index);
    return st;
}

/* Sets a diffuse part and the lobe of a dielectric. */
static lc_status glossy(lc_pbrt *p, lc_pbrt_look *look, const lc_build_value *kd, const lc_build_value *ks)
{
    lc_pbrt_be_glossy(&look->m, ONE);
    lc_pbrt_set_tint(kd, &look->m.kd, &look->maps.kd);
    lc_pbrt_set_tint(ks, &look->m.ks, &look->maps.ks);
    return lc_pbrt_get_alpha(p, "", 0.1, look, &look->m.smooth);
}

lc_status lc_pbrt_plastic(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    lc_build_value kd = LC_PBRT_VALUE(0.25), ks = kd;
    (void)where;
    lc_status st = lc_pbrt_get_tint(p, "Kd", &kd);
    if (!st) st = lc_pbrt_get_tint(p, "Ks", &ks);
    lc_pbrt_set_index(&look->m, 1.5);
    return st ? st : glossy(p, look, &kd, &ks);
}

/* Makes the look perfectly specular: reflection by kr, transmission by kt. */
static void specular(lc_pbrt_look *look, const lc_build_value *kr, const lc_build_value *kt)
{
    lc_material *m = &look->m;
    lc_pbrt_be_mirror(m);
    m->fresnel = LC_FRESNEL_DIELECTRIC;
    m->glass = !lc_pbrt_is_black(kt);
    lc_pbrt_set_tint(kr, &m->ks, &look->maps.ks);
    lc_pbrt_set_tint(kt, &m->kt, &look->maps.kt);
}

lc_status lc_pbrt_uber(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    lc_build_value kd = LC_PBRT_VALUE(0.25), ks = kd, kr = LC_PBRT_VALUE(0), kt = kr;
    lc_status st = lc_pbrt_get_tint(p, "Kd", &kd);
    if (!st) st = lc_pbrt_get_tint(p, "Ks", &ks);
    if (!st) st = lc_pbrt_get_tint(p, "Kr", &kr);
    if (!st) st = lc_pbrt_get_tint(p, "Kt", &kt);
    if (!st) st = lc_pbrt_get_tint(p, "opacity", &look->opacity);
    if (!st) st = get_eta(p, &look->m);
    if (!st) st = glossy(p, look, &kd, &ks);
    if (st || (lc_pbrt_is_black(&kr) && lc_pbrt_is_black(&kt))) return st;
    if (lc_pbrt_is_black(&kd) && lc_pbrt_is_black(&ks)) {
        look->maps = (lc_material_maps)LC_NO_MAPS;
        specular(look, &kr, &kt);
        return LC_OK;
    }
    return lc_pbrt_note(p, where, "uber Kr, Kt",
                        "uber: perfect reflection and transmission beside Kd and Ks are ignored");
}

lc_status lc_pbrt_substrate(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    lc_build_value kd = LC_PBRT_VALUE(0.5), ks = kd;
    lc_status st = lc_pbrt_get_tint(p, "Kd", &kd);
    if (!st) st = lc_pbrt_get_tint(p, "Ks", &ks);
    lc_build_value rest = { LC_NONE, { 1 - ks.value[0], 1 - ks.value[1], 1 - ks.value[2] } };
    if (!st) st = lc_pbrt_product(p, where, &kd, &rest, &kd);
    if (!st) st = glossy(p, look, &kd, &ks);
    look->m.fresnel = LC_FRESNEL_SCHLICK;
    return st;
}

lc_status lc_pbrt_metal(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    bool smooth = false;
    (void)where;
    lc_pbrt_be_glossy(&look->m, ONE);
    look->m.kd = lc_f3_make(0, 0, 0);
    lc_status st = lc_pbrt_get_metal(p, "eta", "k", 1, &look->m);
    if (!st) st = lc_pbrt_get_alpha(p, "", 0.01, look, &smooth);
    if (smooth) lc_pbrt_be_mirror(&look->m);
    return st;
}

lc_status lc_pbrt_glass(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    lc_build_value kr = LC_PBRT_VALUE(1), kt = kr;
    double u = 0, v = 0;
    lc_status st = lc_pbrt_get_tint(p, "Kr", &kr);
    if (!st) st = lc_pbrt_get_tint(p, "Kt", &kt);
    if (!st) st = get_eta(p, &look->m);
    if (!st) st = lc_pbrt_get_mean(p, "uroughness", &u);
    if (!st) st = lc_pbrt_get_mean(p, "vroughness", &v);
    lc_pbrt_mark(&p->params, "remaproughness");
    specular(look, &kr, &kt);
    look->m.glass = true;
    if (st || !(u > 0 || v > 0)) return st;
    return lc_pbrt_note(p, where, "rough glass", "rough glass is taken as smooth");
}

lc_status lc_pbrt_translucent(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    lc_build_value kd = LC_PBRT_VALUE(0.25), ks = kd, reflect = LC_PBRT_VALUE(0.5), transmit = reflect,
                   kt = kd;
    lc_status st = lc_pbrt_get_tint(p, "Kd", &kd);
    if (!st) st = lc_pbrt_get_tint(p, "Ks", &ks);
    if (!st) st = lc_pbrt_get_tint(p, "reflect", &reflect);
    if (!st) st = lc_pbrt_get_tint(p, "transmit", &transmit);
    if (!st) st = lc_pbrt_product(p, where, &kd, &transmit, &kt);
    if (!st) st = lc_pbrt_product(p, where, &kd, &reflect, &kd);
    bool lobe_through = !lc_pbrt_is_black(&ks) && !lc_pbrt_is_black(&transmit);
    if (!st) st = lc_pbrt_product(p, where, &ks, &reflect, &ks);
    if (st) return st;
    lc_pbrt_set_tint(&kt, &look->m.kt, &look->maps.kt);
    lc_pbrt_set_index(&look->m, 1.5);
    st = glossy(p, look, &kd, &ks);
    if (st || !lobe_through) return st;
    return lc_pbrt_note(p, where, "translucent lobe", "translucent: glossy transmission is ignored");
}

lc_status lc_pbrt_disney(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    lc_build_value colour = LC_PBRT_VALUE(0.5), kd, ks;
    double metallic = 0, index = 1.5, roughness = 0.5;
    lc_status st = lc_pbrt_get_tint(p, "color", &colour);
    if (!st) st = lc_pbrt_get_mean(p, "metallic", &metallic);
    if (!st) st = lc_pbrt_get_mean(p, "roughness", &roughness);
    if (!st) st = lc_pbrt_get_index(p, "eta", &index);
    metallic = fmin(fmax(metallic, 0), 1);
    double f0 = (index - 1) / (index + 1), rest = 1 - metallic;
    if (!st) st = lc_pbrt_product(p, where, &colour, &LC_PBRT_VALUE(rest), &kd);
    if (!st) st = lc_pbrt_product(p, where, &colour, &LC_PBRT_VALUE(metallic), &ks);
    if (st) return st;
    lc_pbrt_be_glossy(&look->m, ONE);
    look->m.fresnel = LC_FRESNEL_SCHLICK;
    lc_pbrt_set_tint(&kd, &look->m.kd, &look->maps.kd);
    if (metallic < 1) ks.id = LC_NONE; /* a sum of texture and constant is replaced by its mean */
    for (int k = 0; k < 3; k++) ks.value[k] += rest * f0 * f0;
    lc_pbrt_set_tint(&ks, &look->m.ks, &look->maps.ks);
    double alpha = fmin(fmax(roughness * roughness, (double)LC_MIN_ROUGHNESS), (double)LC_MAX_ROUGHNESS);
    look->m.roughness[0] = look->m.roughness[1] = (float)alpha;
    lc_pbrt_mark_all(&p->params);
    return LC_OK;
}

lc_status lc_pbrt_kd_subsurface(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    (void)where;
    lc_status st = lc_pbrt_get_albedo(p, "Kd", &look->m.kd, &look->maps.kd);
    lc_pbrt_mark_all(&p->params);
    return st;
}
