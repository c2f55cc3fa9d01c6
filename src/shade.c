/* shade.c - estimates. What bounds.c must dominate is exactly this arithmetic. */
#include "shade.h"

#include "direction.h"
#include "fmath.h"

static lc_f3 drop_below(lc_f3 a, float least)
{
    return lc_f3_make(a.x < least ? 0 : a.x, a.y < least ? 0 : a.y, a.z < least ? 0 : a.z);
}

static float transfer(float f) { return f < LC_MIN_TRANSFER ? 0 : f < LC_MAX_TRANSFER ? f : LC_MAX_TRANSFER; }

static float no_less(float a, float least) { return a > least ? a : least; }

/* A unit vector across n: along `wish` where that has a direction along the surface, else across the axis that n is
 * farthest from. */
static lc_f3 tangent_of(lc_f3 n, lc_f3 wish)
{
    float x = fabsf(n.x), y = fabsf(n.y), z = fabsf(n.z);
    lc_f3 t = lc_f3_sub(wish, lc_f3_scale(n, lc_f3_dot(n, wish)));
    lc_f3 axis = lc_f3_make(x <= y && x <= z, y < x && y <= z, z < x && z < y);
    return lc_f3_normalize(lc_f3_dot(t, t) > 1e-4f ? t : lc_f3_cross(axis, n));
}

/* The frame; returns the factor of ks. */
static float init_ward(lc_point *p, lc_f3 n, lc_f3 view, const lc_material *m)
{
    float ax = m->roughness[0], ay = m->roughness[1], cos_o = lc_f3_dot(n, view);
    lc_f3 unit = tangent_of(n, m->tangent), tx = lc_f3_scale(unit, 1 / ax), ty = lc_f3_scale(lc_f3_cross(n, unit), 1 / ay);
    lc_f3_store(p->tangent[0], tx);
    lc_f3_store(p->tangent[1], ty);
    lc_f3_store(p->view, lc_f3_make(lc_f3_dot(tx, view), lc_f3_dot(ty, view), no_less(cos_o, 0)));
    p->sharp = (1 + 0x1p-20f) / (ax < ay ? ax : ay);
    return (float)(0.25 / LC_PI) / (ax * ay * sqrtf(no_less(cos_o, LC_WARD_MIN_COS)));
}

void lc_point_init(lc_point *p, lc_f3 pos, lc_f3 n, lc_f3 view, const lc_material *m, float min_d2)
{
    const bool ward = m->gloss == LC_GLOSS_WARD;
    *p = (lc_point){ .exponent = m->exponent, .min_d2 = min_d2 };
    float k = ward ? init_ward(p, n, view, m) : (m->exponent + 2) * (float)(0.5 / LC_PI);
    lc_f3_store(p->pos, pos);
    lc_f3_store(p->n, n);
    lc_f3 r = lc_f3_sub(lc_f3_scale(n, 2 * lc_f3_dot(n, view)), view);
    lc_f3_store(p->mirror, lc_f3_normalize(r));
    lc_f3 specular = drop_below(lc_f3_scale(m->ks, k), LC_MIN_REFLECTANCE);
    lc_f3_store(p->diffuse, drop_below(lc_f3_scale(m->kd, (float)(1 / LC_PI)), LC_MIN_REFLECTANCE));
    lc_f3_store(p->specular, specular);
    p->lobe = !(lc_f3_max(specular) > 0) ? LC_LOBE_NONE : ward ? LC_LOBE_WARD : LC_LOBE_PHONG;
}

static float phong(const lc_point *p, lc_f3 d, float inv_len)
{
    float cos_m = lc_f3_dot(lc_f3_load(p->mirror), d) * inv_len;
    float lobe = cos_m > LC_MIN_COS ? lc_pow01(cos_m < 1 ? cos_m : 1, p->exponent) : 0;
    return lobe < LC_MIN_LOBE ? 0 : lobe;
}

static float ward(const lc_point *p, lc_f3 d, float cos_r, float inv_len)
{
    float x = lc_f3_dot(lc_f3_load(p->tangent[0]), d) * inv_len + p->view[0];
    float y = lc_f3_dot(lc_f3_load(p->tangent[1]), d) * inv_len + p->view[1], z = cos_r + p->view[2];
    float lobe = lc_decay((x * x + y * y) / (z * z));
    return lobe < LC_MIN_LOBE ? 0 : lobe / sqrtf(no_less(cos_r, LC_WARD_MIN_COS));
}

/* BRDF times cosine times g times tint, for unnormalised direction d of length 1 / inv_len. */
static lc_f3 material_term(const lc_point *p, lc_f3 d, float cos_r, float inv_len, float g, lc_f3 tint)
{
    lc_f3 f = lc_f3_load(p->diffuse);
    if (p->lobe != LC_LOBE_NONE) {
        float lobe = p->lobe == LC_LOBE_WARD ? ward(p, d, cos_r, inv_len) : phong(p, d, inv_len);
        if (lobe > 0) f = lc_f3_add(f, lc_f3_scale(lc_f3_load(p->specular), lobe));
    }
    f = lc_f3_scale(lc_f3_mul(f, tint), cos_r * g);
    return lc_f3_make(transfer(f.x), transfer(f.y), transfer(f.z));
}

/* A spot, or where it is NULL a point or oriented light. */
static lc_f3 shade_near(const lc_point *p, lc_light_kind kind, const lc_light_rec *light, const float *atten, const lc_spot_rec *spot,
                        const lc_spot_map *spot_maps)
{
    const lc_f3 zero = { 0, 0, 0 }, d = lc_f3_sub(lc_f3_load(light->pos), lc_f3_load(p->pos));
    float nd = lc_f3_dot(lc_f3_load(p->n), d), d2 = lc_f3_dot(d, d), tint[3] = { 1, 1, 1 };
    if (!(nd > 0)) return zero;
    float inv_len = 1 / sqrtf(d2 > LC_TINY_D2 ? d2 : LC_TINY_D2), cos_r = nd * inv_len, g = 1;
    if (!(cos_r > LC_MIN_COS)) return zero;
    if (lc_is_aimed(kind)) {
        const uint32_t dir[2] = { light->dir_a, light->dir_b };
        g = -lc_f3_dot(lc_dir_unpack(dir), d) * inv_len;
        if (spot) g = lc_spot_emission(spot, g);
        if (!(g > LC_MIN_COS)) return zero;
    }
    if (spot && spot->map) {
        const float to[3] = { -d.x, -d.y, -d.z };
        lc_spot_colour(&spot_maps[spot->map - 1], to, tint);
    }
    float d2c = d2 > p->min_d2 ? d2 : p->min_d2;
    g /= atten ? atten[0] + atten[1] * sqrtf(d2c) + atten[2] * d2c : d2c;
    return material_term(p, d, cos_r, inv_len, g, lc_f3_load(tint));
}

lc_f3 lc_shade_light(const lc_point *p, lc_light_kind kind, const lc_light_rec *light, const float *atten)
{
    const lc_f3 zero = { 0, 0, 0 }, one = { 1, 1, 1 }, pos = lc_f3_load(light->pos);
    LC_ASSERT(kind != LC_LIGHT_SPOT);
    if (kind != LC_LIGHT_DIRECTIONAL) return shade_near(p, kind, light, atten, NULL, NULL);
    float cos_r = lc_f3_dot(lc_f3_load(p->n), pos);
    return cos_r > LC_MIN_COS ? material_term(p, pos, cos_r, 1, 1, one) : zero;
}

lc_f3 lc_shade_spot(const lc_point *p, const lc_light_rec *light, const lc_spot_rec *spot, const lc_spot_map *spot_maps)
{
    return shade_near(p, LC_LIGHT_SPOT, light, NULL, spot, spot_maps);
}

void lc_light_rec_init(lc_light_rec *rec, const lc_light *light)
{
    uint32_t dir[2] = { 0, 0 };
    if (lc_is_aimed(light->kind)) lc_dir_pack(light->dir, dir);
    lc_f3_store(rec->pos, light->kind == LC_LIGHT_DIRECTIONAL ? lc_f3_neg(light->dir) : light->pos);
    lc_f3_store(rec->intensity, light->intensity);
    rec->dir_a = dir[0], rec->dir_b = dir[1];
}
