/* material_v4.c - the materials of pbrt v4, with its defaults.
 *
 *     diffuse              Lambert
 *     coateddiffuse        Lambert below a dielectric whose surface is a GGX lobe; what lies between absorbs
 *     conductor            GGX; a mirror if smooth
 *     coatedconductor      one conductor that reflects at normal incidence what both layers do together
 *     dielectric           glass, smooth whatever its roughness
 *     diffusetransmission  Lambert on both sides
 *     subsurface, hair     Lambert
 */
#include "pbrt/make_material.h"

#include "base/fmath.h"

#include <math.h>
#include <string.h>

static const lc_f3 ONE = { 1, 1, 1 }, NONE = { 0, 0, 0 };

lc_status lc_pbrt_diffuse(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    (void)where;
    return lc_pbrt_get_albedo(p, "reflectance", &look->m.kd, &look->maps.kd);
}

/* What lies between two layers: it absorbs, 1 a unit of its thickness, whether or not it scatters; and how
 * often light is reflected by the lower one, in every other one of "maxdepth" events. */
static lc_status layers(lc_pbrt *p, lc_pos where, const char *thickness, double *depth, uint32_t *times)
{
    static const char *const silent[] = { "g", "nsamples" };
    lc_build_value albedo = LC_PBRT_VALUE(0);
    int64_t events = 10;
    *depth = 0.01;
    for (size_t i = 0; i < sizeof silent / sizeof *silent; i++) lc_pbrt_mark(&p->params, silent[i]);
    lc_status st = lc_pbrt_get_mean(p, thickness, depth);
    if (!st) st = lc_pbrt_get_int(&p->params, "maxdepth", &events, NULL);
    if (!st) st = lc_pbrt_get_tint(p, "albedo", &albedo);
    *depth = fmin(fmax(*depth, 0), (double)LC_MAX_COAT_DEPTH);
    events = events < 0 ? 0 : events > 1000 ? 1000 : events;
    *times = (uint32_t)((events + 1) / 2);
    if (st || lc_pbrt_is_black(&albedo)) return st;
    return lc_pbrt_note(p, where, "coat albedo", "what scatters inside a coat is ignored");
}

lc_status lc_pbrt_coated_diffuse(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    double index = 1.5, depth = 0;
    bool smooth = false;
    lc_status st = lc_pbrt_get_albedo(p, "reflectance", &look->m.kd, &look->maps.kd);
    if (!st) st = lc_pbrt_get_index(p, "eta", &index);
    if (!st) st = layers(p, where, "thickness", &depth, &look->m.coat_terms);
    if (!look->m.coat_terms) { /* 0 would mean without limit */
        look->m.kd = NONE;
        look->maps.kd = LC_NONE;
    }
    look->coat_thickness = (float)depth;
    if (!st) st = lc_pbrt_get_alpha(p, "", 0, look, &smooth);
    lc_pbrt_be_glossy(&look->m, ONE);
    lc_pbrt_set_index(&look->m, index);
    look->m.coat = true;
    look->m.smooth = smooth;
    return st;
}

/* A conductor with eta = 1 and the k that reflects the given colour at normal incidence, as in pbrt. */
static lc_status reflectance_metal(lc_pbrt *p, lc_pbrt_look *look, const lc_build_value *share)
{
    double eta[3] = { 1, 1, 1 }, k[3];
    (void)p;
    for (int c = 0; c < 3; c++) lc_metal_of_share(share->value[c], &eta[c], &k[c]);
    look->m.fresnel = LC_FRESNEL_CONDUCTOR;
    look->m.eta = ONE;
    look->m.k = lc_f3_make((float)k[0], (float)k[1], (float)k[2]);
    look->maps.ks = share->id;
    look->maps.metal = share->id != LC_NONE;
    return LC_OK;
}

lc_status lc_pbrt_conductor(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    bool smooth = false;
    lc_build_value share = LC_PBRT_VALUE(1);
    (void)where;
    lc_pbrt_be_glossy(&look->m, ONE);
    look->m.kd = NONE;
    lc_status st = lc_pbrt_get_tint(p, "reflectance", &share);
    if (!st && lc_pbrt_find(&p->params, "reflectance", LC_PBRT_ANY)) st = reflectance_metal(p, look, &share);
    else if (!st) st = lc_pbrt_get_metal(p, "eta", "k", 1, &look->m);
    if (!st) st = lc_pbrt_get_alpha(p, "", 0, look, &smooth);
    if (smooth) lc_pbrt_be_mirror(&look->m);
    return st;
}

/* Changes a conductor so that it reflects at normal incidence what it does below a coat of this index and
 * optical depth, of which light meets the conductor so many times at most. */
static void add_coat(double index, double depth, uint32_t times, lc_material *m)
{
    const double f = (index - 1) / (index + 1) * ((index - 1) / (index + 1)), left = lc_exp_neg(-2 * depth);
    double eta[3], k[3];
    const double e[3] = { (double)m->eta.x, (double)m->eta.y, (double)m->eta.z },
                 a[3] = { (double)m->k.x, (double)m->k.y, (double)m->k.z };
    for (int c = 0; c < 3; c++) {
        const double below = lc_metal_share(e[c], a[c]) * left;
        double sum = 0;
        for (uint32_t i = 0; i < times; i++) sum = sum * f * below + below;
        eta[c] = e[c];
        lc_metal_of_share(f + (1 - f) * (1 - f) * sum, &eta[c], &k[c]);
    }
    m->eta = lc_f3_make((float)eta[0], (float)eta[1], (float)eta[2]);
    m->k = lc_f3_make((float)k[0], (float)k[1], (float)k[2]);
}

lc_status lc_pbrt_coated_conductor(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    double index = 1.5, depth = 0;
    uint32_t times = 0;
    bool smooth = false, smooth_coat = false;
    lc_build_value share = LC_PBRT_VALUE(1);
    lc_pbrt_look coat = *look;
    lc_pbrt_be_glossy(&look->m, ONE);
    look->m.kd = NONE;
    lc_status st = lc_pbrt_get_index(p, "interface.eta", &index);
    if (!st) st = layers(p, where, "interface.thickness", &depth, &times);
    if (!st) st = lc_pbrt_get_tint(p, "reflectance", &share);
    if (!st && lc_pbrt_find(&p->params, "reflectance", LC_PBRT_ANY)) st = reflectance_metal(p, look, &share);
    else if (!st) st = lc_pbrt_get_metal(p, "conductor.eta", "conductor.k", index, &look->m);
    if (!st) st = lc_pbrt_get_alpha(p, "interface.", 0, &coat, &smooth_coat);
    if (!st) st = lc_pbrt_get_alpha(p, "conductor.", 0, look, &smooth);
    if (!st && !look->maps.metal) add_coat(index, depth, times, &look->m);
    /* A smooth conductor below a rough coat takes the coat's roughness. */
    if (smooth && smooth_coat) lc_pbrt_be_mirror(&look->m);
    for (int axis = 0; axis < 2 && smooth && !smooth_coat; axis++) {
        look->m.roughness[axis] = coat.m.roughness[axis];
        look->maps.roughness[axis] = coat.maps.roughness[axis];
    }
    return st;
}

static lc_status glass(lc_pbrt *p, lc_pbrt_look *look)
{
    double index = 1.5;
    lc_material *m = &look->m;
    lc_status st = lc_pbrt_get_index(p, "eta", &index);
    lc_pbrt_be_mirror(m);
    lc_pbrt_set_index(m, index);
    m->glass = true;
    m->fresnel = LC_FRESNEL_DIELECTRIC;
    m->ks = m->kt = ONE;
    return st;
}

lc_status lc_pbrt_dielectric(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    bool smooth = true;
    lc_pbrt_look rough = *look;
    lc_status st = lc_pbrt_get_alpha(p, "", 0, &rough, &smooth);
    if (!st && !smooth) st = lc_pbrt_note(p, where, "rough glass", "rough glass is taken as smooth");
    return st ? st : glass(p, look);
}

lc_status lc_pbrt_thin_dielectric(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    (void)where;
    look->m.thin = true;
    return glass(p, look);
}

lc_status lc_pbrt_diffuse_transmission(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    lc_build_value kd = LC_PBRT_VALUE(0.25), kt = kd;
    double scale = 1;
    lc_status st = lc_pbrt_get_tint(p, "reflectance", &kd);
    if (!st) st = lc_pbrt_get_tint(p, "transmittance", &kt);
    if (!st) st = lc_pbrt_get_mean(p, "scale", &scale);
    if (!st && !(scale >= 0 && scale <= 1e6))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "diffusetransmission: scale is out of range");
    if (!st) st = lc_pbrt_product(p, where, &kd, &LC_PBRT_VALUE(scale), &kd);
    if (!st) st = lc_pbrt_product(p, where, &kt, &LC_PBRT_VALUE(scale), &kt);
    if (st) return st;
    lc_pbrt_set_tint(&kd, &look->m.kd, &look->maps.kd);
    lc_pbrt_set_tint(&kt, &look->m.kt, &look->maps.kt);
    return LC_OK;
}

lc_status lc_pbrt_subsurface(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    lc_status st = lc_pbrt_diffuse(p, where, look);
    lc_pbrt_mark_all(&p->params);
    return st;
}

lc_status lc_pbrt_hair(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    look->m.kd = lc_f3_make(0.25f, 0.16f, 0.1f); /* brown */
    lc_status st = lc_pbrt_diffuse(p, where, look);
    if (!st) st = lc_pbrt_get_albedo(p, "color", &look->m.kd, &look->maps.kd);
    lc_pbrt_mark_all(&p->params);
    return st;
}
