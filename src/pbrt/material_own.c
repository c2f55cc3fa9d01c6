/* material_own.c - materials that pbrt lacks. Each parameter may be a texture.
 *
 *     phong        "rgb Kd", "rgb Ks", "float exponent"
 *     ward, ggx    "rgb Kd", "rgb Ks", "float roughness", "float uroughness", "float vroughness"
 */
#include "pbrt/make_material.h"

lc_status lc_pbrt_phong(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    const lc_pbrt_param *par;
    lc_material *m = &look->m;
    lc_build_value in;
    (void)where;
    lc_status st = lc_pbrt_get_albedo(p, "Kd", &m->kd, &look->maps.kd);
    if (!st) st = lc_pbrt_get_albedo(p, "Ks", &m->ks, &look->maps.ks);
    if (!st) st = lc_pbrt_get_input(p, "exponent", true, &in, &par);
    if (st) return st;
    double exponent = par ? in.value[0] : 50;
    if (par) look->maps.exponent = in.id;
    if (exponent < 0) return lc_pbrt_bad_param(&p->params, par, "is negative");
    if (exponent > (double)LC_MAX_EXPONENT) {
        exponent = (double)LC_MAX_EXPONENT;
        st = lc_pbrt_note(p, par->pos, "phong exponent", "a Phong exponent above %g is clamped",
                          (double)LC_MAX_EXPONENT);
    }
    m->exponent = (float)exponent;
    return st;
}

/* Reads one of Ward's two roughnesses; *value and *map keep their values if the parameter is absent. */
static lc_status get_roughness(lc_pbrt *p, const char *name, float *value, uint32_t *map)
{
    const lc_pbrt_param *par;
    lc_build_value in;
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

lc_status lc_pbrt_ward(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    lc_material *m = &look->m;
    lc_material_maps *maps = &look->maps;
    (void)where;
    lc_status st = lc_pbrt_get_albedo(p, "Kd", &m->kd, &maps->kd);
    if (!st) st = lc_pbrt_get_albedo(p, "Ks", &m->ks, &maps->ks);
    m->lobe = LC_LOBE_WARD;
    m->roughness[0] = 0.1f;
    if (!st) st = get_roughness(p, "roughness", &m->roughness[0], &maps->roughness[0]);
    m->roughness[1] = m->roughness[0];
    maps->roughness[1] = maps->roughness[0];
    if (!st) st = get_roughness(p, "uroughness", &m->roughness[0], &maps->roughness[0]);
    if (!st) st = get_roughness(p, "vroughness", &m->roughness[1], &maps->roughness[1]);
    return st;
}

lc_status lc_pbrt_ggx(lc_pbrt *p, lc_pos where, lc_pbrt_look *look)
{
    lc_status st = lc_pbrt_ward(p, where, look);
    look->m.lobe = LC_LOBE_GGX;
    return st;
}
