/* shade.c - estimates. What bounds.c must dominate is exactly this arithmetic. */
#include "shade.h"

#include "fmath.h"

void lc_point_init(lc_point *p, lc_f3 pos, lc_f3 n, lc_f3 view, const lc_material *m, float min_d2)
{
    float k = (m->exponent + 2) * (float)(0.5 / LC_PI);
    lc_f3_store(p->pos, pos);
    lc_f3_store(p->n, n);
    lc_f3 r = lc_f3_sub(lc_f3_scale(n, 2 * lc_f3_dot(n, view)), view);
    lc_f3_store(p->mirror, lc_f3_normalize(r));
    lc_f3_store(p->diffuse, lc_f3_scale(m->kd, (float)(1 / LC_PI)));
    lc_f3_store(p->specular, lc_f3_scale(m->ks, k));
    p->exponent = m->exponent;
    p->min_d2 = min_d2;
    p->glossy = m->ks.x > 0 || m->ks.y > 0 || m->ks.z > 0;
}

/* BRDF times cosine, for unnormalised direction d of length 1 / inv_len. */
static lc_f3 material_term(const lc_point *p, lc_f3 d, float cos_r, float inv_len)
{
    lc_f3 f = lc_f3_load(p->diffuse);
    if (p->glossy) {
        float cos_m = lc_f3_dot(lc_f3_load(p->mirror), d) * inv_len;
        if (cos_m > 0)
            f = lc_f3_add(f, lc_f3_scale(lc_f3_load(p->specular), lc_pow01(cos_m < 1 ? cos_m : 1, p->exponent)));
    }
    return lc_f3_scale(f, cos_r);
}

lc_f3 lc_shade_light(const lc_point *p, const lc_light_rec *light)
{
    const lc_f3 zero = { 0, 0, 0 }, n = lc_f3_load(p->n), dir = lc_f3_load(light->dir);
    if (light->kind == LC_LIGHT_DIRECTIONAL) {
        lc_f3 d = lc_f3_neg(dir);
        float cos_r = lc_f3_dot(n, d);
        return cos_r > 0 ? material_term(p, d, cos_r, 1) : zero;
    }
    lc_f3 d = lc_f3_sub(lc_f3_load(light->pos), lc_f3_load(p->pos));
    float nd = lc_f3_dot(n, d);
    if (!(nd > 0)) return zero;
    float d2 = lc_f3_dot(d, d);
    float inv_len = 1 / sqrtf(d2 > LC_TINY_D2 ? d2 : LC_TINY_D2);
    float g = 1;
    if (light->kind == LC_LIGHT_ORIENTED) {
        g = -lc_f3_dot(dir, d) * inv_len;
        if (!(g > 0)) return zero;
    }
    float d2c = d2 > p->min_d2 ? d2 : p->min_d2;
    g /= light->atten[0] + light->atten[1] * sqrtf(d2c) + light->atten[2] * d2c;
    return lc_f3_scale(material_term(p, d, nd * inv_len, inv_len), g);
}

void lc_light_rec_init(lc_light_rec *rec, const lc_light *light)
{
    *rec = (lc_light_rec){ .kind = (uint32_t)light->kind };
    lc_f3_store(rec->pos, light->pos);
    lc_f3_store(rec->dir, light->dir);
    lc_f3_store(rec->intensity, light->intensity);
    for (int k = 0; k < 3; k++) rec->atten[k] = light->atten[k];
}
