/* reflect.c - the parameters that materials share: reflectances, roughness, indices of refraction. */
#include "pbrt/make_material.h"

#include "pbrt/spectrum.h"

#include <stdio.h>

#define MIN_INDEX 0.01 /* limits a dielectric's relative index from below */
#include <string.h>

static double clamp(double v, double least, double most) { return fmin(fmax(v, least), most); }

/* ---- colours and numbers ---- */

lc_status lc_pbrt_get_tint(lc_pbrt *p, const char *name, lc_build_value *in)
{
    const lc_pbrt_param *par;
    lc_build_value given;
    bool clamped = false;
    lc_status st = lc_pbrt_get_input(p, name, false, &given, &par);
    if (st || !par) return st;
    *in = given;
    for (int k = 0; k < 3; k++) {
        clamped |= given.value[k] < 0 || given.value[k] > 1;
        in->value[k] = clamp(given.value[k], 0, 1);
    }
    return clamped ? lc_pbrt_note(p, par->pos, "reflectance", "a reflectance outside 0..1 is clamped")
                   : LC_OK;
}

lc_status lc_pbrt_product(lc_pbrt *p, lc_pos where, const lc_build_value *a, const lc_build_value *b,
                          lc_build_value *out)
{
    lc_build_pattern_desc t = LC_BUILD_PATTERN_DESC_INIT;
    t.kind = LC_PATTERN_SCALE;
    t.in[0] = *a;
    t.in[1] = *b;
    t.in[2] = LC_PBRT_VALUE(1);
    for (int k = 0; k < 3; k++) out->value[k] = t.in[0].value[k] * t.in[1].value[k];
    out->id = LC_NONE;
    if (t.in[0].id == LC_NONE && t.in[1].id == LC_NONE) return LC_OK;
    lc_status st = lc_pbrt_at(p, where);
    return st ? st : lc_build_pattern(p->scene, &t, &out->id);
}

void lc_pbrt_set_tint(const lc_build_value *in, lc_f3 *value, uint32_t *map)
{
    *value = lc_f3_make((float)clamp(in->value[0], 0, 1), (float)clamp(in->value[1], 0, 1),
                        (float)clamp(in->value[2], 0, 1));
    *map = in->id;
}

lc_status lc_pbrt_get_albedo(lc_pbrt *p, const char *name, lc_f3 *value, uint32_t *map)
{
    lc_build_value in = { *map, { (double)value->x, (double)value->y, (double)value->z } };
    lc_status st = lc_pbrt_get_tint(p, name, &in);
    lc_pbrt_set_tint(&in, value, map);
    return st;
}

bool lc_pbrt_is_black(const lc_build_value *in)
{
    return in->id == LC_NONE && !(in->value[0] > 0 || in->value[1] > 0 || in->value[2] > 0);
}

lc_status lc_pbrt_get_mean(lc_pbrt *p, const char *name, double *out)
{
    const lc_pbrt_param *par;
    lc_build_value in;
    lc_status st = lc_pbrt_get_input(p, name, true, &in, &par);
    if (st || !par) return st;
    *out = in.value[0];
    if (in.id == LC_NONE) return LC_OK;
    return lc_pbrt_note_name(p, par->pos, "textured parameter", name, "the texture's mean takes its place");
}

/* ---- roughness ---- */

static lc_status get_axis(lc_pbrt *p, const char *prefix, const char *name, lc_build_value *in)
{
    char full[64];
    const lc_pbrt_param *par;
    lc_build_value given;
    snprintf(full, sizeof full, "%s%s", prefix, name);
    lc_status st = lc_pbrt_get_input(p, full, true, &given, &par);
    if (!st && par) *in = given;
    if (!st && par && in->value[0] < 0) st = lc_pbrt_bad_param(&p->params, par, "is negative");
    return st;
}

lc_status lc_pbrt_get_alpha(lc_pbrt *p, const char *prefix, double usual, lc_pbrt_look *look, bool *smooth)
{
    char name[64];
    bool remap = true;
    double outside = -1;
    lc_build_value in[2] = { LC_PBRT_VALUE(usual), LC_PBRT_VALUE(0) };
    lc_status st = get_axis(p, prefix, "roughness", &in[0]);
    in[1] = in[0];
    if (!st) st = get_axis(p, prefix, "uroughness", &in[0]);
    if (!st) st = get_axis(p, prefix, "vroughness", &in[1]);
    if (!st) st = lc_pbrt_get_bool(&p->params, "remaproughness", &remap);
    snprintf(name, sizeof name, "%sremaproughness", prefix);
    if (!st && *prefix) st = lc_pbrt_get_bool(&p->params, name, &remap);
    if (st) return st;
    look->m.lobe = LC_LOBE_GGX;
    look->maps.remap = !remap ? LC_REMAP_NONE : p->v4 ? LC_REMAP_SQRT : LC_REMAP_POLYNOMIAL;
    *smooth = true;
    for (int axis = 0; axis < 2; axis++) {
        double alpha = lc_roughness_alpha(look->maps.remap, in[axis].value[0]);
        look->m.roughness[axis] = (float)clamp(alpha, (double)LC_MIN_ROUGHNESS, (double)LC_MAX_ROUGHNESS);
        look->maps.roughness[axis] = in[axis].id;
        *smooth &= in[axis].id == LC_NONE && alpha < LC_SMOOTH;
        if (in[axis].id == LC_NONE && ((float)alpha < LC_MIN_ROUGHNESS || (float)alpha > LC_MAX_ROUGHNESS))
            outside = alpha;
    }
    if (outside < 0 || *smooth || !p->params.n) return LC_OK;
    return lc_pbrt_note(p, p->params.items[0].pos, "roughness",
                        "a roughness, alpha %.3g, is clamped to %g..%g", outside, (double)LC_MIN_ROUGHNESS,
                        (double)LC_MAX_ROUGHNESS);
}

/* ---- indices ---- */

lc_status lc_pbrt_get_index(lc_pbrt *p, const char *name, double *out)
{
    double s[LC_PBRT_CIE_N], v = *out;
    const lc_pbrt_param *par, *any = lc_pbrt_find(&p->params, name, LC_PBRT_ANY);
    lc_f3 colour = lc_f3_make((float)v, (float)v, (float)v);
    lc_status st = lc_pbrt_get_spectrum(p, name, s, &par);
    if (st || !any) return st;
    if (par) v = lc_pbrt_spectrum_mean(p, s);
    else if (lc_pbrt_find(&p->params, name, LC_PBRT_RGB | LC_PBRT_XYZ)) {
        st = lc_pbrt_get_colour(p, name, LC_PBRT_FOR_ALBEDO, &colour, NULL);
        v = (double)lc_luminance(colour);
    } else st = lc_pbrt_get_mean(p, name, &v);
    if (st) return st;
    if (!(v >= 0 && v <= 1000)) return lc_pbrt_bad_param(&p->params, any, "is no index of refraction");
    *out = v > 0 ? fmax(v, MIN_INDEX) : 1; /* pbrt-v4 takes 0 as 1 */
    return LC_OK;
}

void lc_pbrt_set_index(lc_material *m, double index)
{
    m->eta = lc_f3_make((float)index, (float)index, (float)index);
}

/* Reads eta or k of a metal: a spectrum, or a colour if it is given as one. */
static lc_status get_constants(lc_pbrt *p, const char *name, const char *usual, double s[LC_PBRT_CIE_N],
                               double rgb[3], bool *is_rgb)
{
    double pairs[2 * LC_PBRT_NAMED_MAX], v = -1;
    const lc_pbrt_param *par;
    lc_f3 colour = lc_f3_make(0, 0, 0);
    *is_rgb = lc_pbrt_find(&p->params, name, LC_PBRT_RGB | LC_PBRT_XYZ | LC_PBRT_BLACKBODY) != NULL;
    if (*is_rgb) {
        lc_status st = lc_pbrt_get_colour(p, name, LC_PBRT_FOR_ALBEDO, &colour, NULL);
        rgb[0] = (double)colour.x;
        rgb[1] = (double)colour.y;
        rgb[2] = (double)colour.z;
        for (int k = 0; k < 3; k++) rgb[k] = clamp(rgb[k], 0, 1000);
        return st;
    }
    lc_pbrt_resample(pairs, lc_pbrt_named_spectrum(usual, pairs), false, s);
    lc_status st = lc_pbrt_get_spectrum(p, name, s, &par);
    if (!st && !par) st = lc_pbrt_get_mean(p, name, &v);
    for (int i = 0; i < LC_PBRT_CIE_N && !st; i++) s[i] = clamp(v >= 0 ? v : s[i], 0, 1000);
    if (!st) lc_pbrt_spectrum_albedo(p, s, rgb);
    return st;
}

/* Converts spectra of eta and k to values for each channel: the reflectance at normal incidence is converted
 * to a colour, and eta, on which the result then depends little, is limited to the range of its spectrum. */
static void project(lc_pbrt *p, const double eta_s[LC_PBRT_CIE_N], const double k_s[LC_PBRT_CIE_N],
                    double outside, double eta[3], double k[3])
{
    double share_s[LC_PBRT_CIE_N], share[3], least = 1000, most = 0;
    for (int i = 0; i < LC_PBRT_CIE_N; i++) {
        share_s[i] = lc_metal_share(eta_s[i] / outside, k_s[i] / outside);
        least = fmin(least, eta_s[i]);
        most = fmax(most, eta_s[i]);
    }
    lc_pbrt_spectrum_albedo(p, share_s, share);
    for (int c = 0; c < 3; c++) {
        eta[c] = clamp(eta[c], least, most) / outside;
        lc_metal_of_share(share[c], &eta[c], &k[c]);
    }
}

lc_status lc_pbrt_get_metal(lc_pbrt *p, const char *eta_name, const char *k_name, double outside,
                            lc_material *m)
{
    double eta_s[LC_PBRT_CIE_N], k_s[LC_PBRT_CIE_N], eta[3], k[3];
    bool eta_rgb, k_rgb;
    lc_status st = get_constants(p, eta_name, "metal-Cu-eta", eta_s, eta, &eta_rgb);
    if (!st) st = get_constants(p, k_name, "metal-Cu-k", k_s, k, &k_rgb);
    if (st) return st;
    if (!eta_rgb && !k_rgb) project(p, eta_s, k_s, outside, eta, k);
    else
        for (int c = 0; c < 3; c++) {
            eta[c] /= outside;
            k[c] /= outside;
        }
    m->eta = lc_f3_make((float)eta[0], (float)eta[1], (float)eta[2]);
    m->k = lc_f3_make((float)k[0], (float)k[1], (float)k[2]);
    m->fresnel = LC_FRESNEL_CONDUCTOR;
    return LC_OK;
}

/* ---- lobes ---- */

void lc_pbrt_be_mirror(lc_material *m)
{
    m->mirror = true;
    m->lobe = LC_LOBE_PHONG;
    m->kd = lc_f3_make(0, 0, 0);
    m->roughness[0] = m->roughness[1] = 0;
}

void lc_pbrt_be_glossy(lc_material *m, lc_f3 ks)
{
    m->lobe = LC_LOBE_GGX;
    m->fresnel = LC_FRESNEL_DIELECTRIC;
    m->ks = ks;
}
