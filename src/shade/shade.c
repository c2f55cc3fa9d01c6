/* shade.c - estimates. What one_bound.c must dominate is exactly this arithmetic. */
#include "shade/shade.h"

#include "base/fmath.h"
#include "shade/coat.h"
#include "shade/dir_pack.h"

static lc_f3 drop_below(lc_f3 a, float least)
{
    return lc_f3_make(a.x < least ? 0 : a.x, a.y < least ? 0 : a.y, a.z < least ? 0 : a.z);
}

static float transfer(float f) { return f < LC_MIN_TRANSFER ? 0 : f < LC_MAX_TRANSFER ? f : LC_MAX_TRANSFER; }

static float no_less(float a, float least) { return a > least ? a : least; }

/* A unit vector across n: along `wish` where that has a direction along the surface, else across the axis
 * that n is farthest from. */
static lc_f3 tangent_of(lc_f3 n, lc_f3 wish)
{
    float x = fabsf(n.x), y = fabsf(n.y), z = fabsf(n.z);
    lc_f3 t = lc_f3_sub(wish, lc_f3_scale(n, lc_f3_dot(n, wish)));
    lc_f3 axis = lc_f3_make(x <= y && x <= z, y < x && y <= z, z < x && z < y);
    return lc_f3_normalize(lc_f3_dot(t, t) > 1e-4f ? t : lc_f3_cross(axis, n));
}

static void init_frame(lc_point *p, lc_f3 n, lc_f3 unit, lc_f3 view, const lc_material *m)
{
    float ax = m->roughness[0], ay = m->roughness[1], cos_o = lc_f3_dot(n, view);
    lc_f3 tx = lc_f3_scale(unit, 1 / ax), ty = lc_f3_scale(lc_f3_cross(n, unit), 1 / ay);
    lc_f3_store(p->tangent[0], tx);
    lc_f3_store(p->tangent[1], ty);
    lc_f3_store(p->view, lc_f3_make(lc_f3_dot(tx, view), lc_f3_dot(ty, view), no_less(cos_o, 0)));
    p->sharp = (1 + 0x1p-20f) / (ax < ay ? ax : ay);
}

/* Returns the factor of ks. */
static float init_ward(lc_point *p, lc_f3 n, lc_f3 view, const lc_material *m)
{
    init_frame(p, n, tangent_of(n, m->tangent), view, m);
    return (float)(0.25 / LC_PI) /
           (m->roughness[0] * m->roughness[1] * sqrtf(no_less(lc_f3_dot(n, view), LC_WARD_MIN_COS)));
}

/* Length of (ax w.x, ay w.y, w.z), x and y along the tangents over roughness. */
static float stretched(const lc_point *p, float x, float y, float z)
{
    x *= p->square[0];
    y *= p->square[1];
    return sqrtf(x * x + y * y + z * z);
}

/* Share of light that a smooth dielectric lets through, 0 < c: half of 4 c g / (c + g)^2 + 4 eta^2 c g /
 * (eta^2 c + g)^2, with g = eta times the cosine inside. */
static float transmitted(const lc_point *p, float c)
{
    float g = sqrtf(p->bend + c * c), s = c + g, t = p->eta2 * c + g;
    float half = (1 / (s * s) + p->eta2 / (t * t)) * (c * g);
    return half + half;
}

static float reflected(const lc_point *p, float c) { return no_less(1 - transmitted(p, c), 0); }

/* Share of light that a smooth conductor reflects, of N^2 = (eta + i k)^2 - sin^2 = t + i turn. */
static float conductor(float rise, float turn, float c)
{
    float cc = c * c, ss = 1 - cc, t = rise + cc, w = sqrtf(t * t + turn * turn); /* w: |N|^2 */
    /* a: real part of N. */
    float b = no_less(sqrtf(0.5f * (w + fabsf(t))), LC_TINY_PART), a = t > 0 ? b : 0.5f * turn / b;
    float ca = c * a, t1 = w + cc, t2 = ca + ca, t3 = cc * w + ss * ss, t4 = t2 * ss;
    float rs = (t1 - t2) / (t1 + t2), f = 0.5f * (rs + rs * ((t3 - t4) / (t3 + t4)));
    f = no_less(f, 0);
    return f < 1 ? f : 1;
}

/* What is below the coat, as it is seen from outside but for what it lets in. */
static lc_f3 below_coat(const lc_point *p, const lc_material *m)
{
    return lc_f3_scale(lc_coat_below(m), p->view[2] > LC_MIN_COS ? transmitted(p, p->view[2]) : 0);
}

/* Returns the factor of ks. What lies below a coat goes to *kd. */
static float init_ggx(lc_point *p, lc_f3 n, lc_f3 view, const lc_material *m, lc_f3 *kd)
{
    const double eta[3] = { (double)m->eta.x, (double)m->eta.y, (double)m->eta.z };
    const double k[3] = { (double)m->k.x, (double)m->k.y, (double)m->k.z };
    float factor = (float)(0.5 / LC_PI) / (m->roughness[0] * m->roughness[1]);
    /* twice: then it is across to the last digit. */
    if (lc_f3_dot(n, view) < 0) view = tangent_of(n, tangent_of(n, view));
    init_frame(p, n, tangent_of(n, tangent_of(n, m->tangent)), view, m);
    lc_f3_store(p->to_view, view);
    for (int i = 0; i < 2; i++) p->square[i] = m->roughness[i] * m->roughness[i];
    p->masking = stretched(p, p->view[0], p->view[1], p->view[2]);
    p->fresnel = m->fresnel == LC_FRESNEL_NONE ? LC_FRESNEL_SCHLICK : m->fresnel;
    p->coat = m->coat;
    p->eta2 = (float)(eta[0] * eta[0]);
    p->bend = (float)(eta[0] * eta[0] - 1);
    lc_f3 rise = lc_f3_scale(lc_f3_make(no_less(1 - m->ks.x, 0), no_less(1 - m->ks.y, 0),
                                        no_less(1 - m->ks.z, 0)),
                             factor);
    if (m->fresnel == LC_FRESNEL_SCHLICK && lc_f3_max(m->ks) > 0) lc_f3_store(p->rise, rise);
    for (int i = 0; i < 3 && m->fresnel == LC_FRESNEL_CONDUCTOR; i++) {
        p->rise[i] = (float)(eta[i] * eta[i] - k[i] * k[i] - 1);
        p->turn[i] = (float)(2 * eta[i] * k[i]);
    }
    if (m->coat) *kd = below_coat(p, m);
    return factor;
}

void lc_point_init(lc_point *p, lc_f3 pos, lc_f3 n, lc_f3 view, const lc_material *m, float min_d2)
{
    static const lc_lobe lobes[] = {
        [LC_GLOSS_PHONG] = LC_LOBE_PHONG, [LC_GLOSS_WARD] = LC_LOBE_WARD, [LC_GLOSS_GGX] = LC_LOBE_GGX
    };
    lc_f3 kd = m->kd;
    float k;
    *p = (lc_point){ .exponent = m->exponent, .min_d2 = min_d2 };
    if (m->gloss == LC_GLOSS_GGX) k = init_ggx(p, n, view, m, &kd);
    else k = m->gloss == LC_GLOSS_WARD ? init_ward(p, n, view, m) : (m->exponent + 2) * (float)(0.5 / LC_PI);
    lc_f3_store(p->pos, pos);
    lc_f3_store(p->n, n);
    lc_f3 r = lc_f3_sub(lc_f3_scale(n, 2 * lc_f3_dot(n, view)), view);
    lc_f3_store(p->mirror, lc_f3_normalize(r));
    lc_f3 specular = drop_below(lc_f3_scale(m->ks, k), LC_MIN_REFLECTANCE);
    lc_f3_store(p->diffuse, drop_below(lc_f3_scale(kd, (float)(1 / LC_PI)), LC_MIN_REFLECTANCE));
    lc_f3_store(p->specular, specular);
    p->lobe = lc_f3_max(specular) > 0 || p->coat ? lobes[m->gloss] : LC_LOBE_NONE;
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

/* What the surface reflects at cosine c, times the constant before GGX's lobe. */
static lc_f3 fresnel(const lc_point *p, float c)
{
    lc_f3 f = lc_f3_load(p->specular);
    const float *rise = p->rise, *turn = p->turn;
    if (p->fresnel == LC_FRESNEL_SCHLICK) {
        float m = 1 - c, m2 = m * m, w = m2 * m2 * m;
        return lc_f3_add(f, lc_f3_scale(lc_f3_load(rise), w < LC_MIN_LOBE ? 0 : w));
    }
    if (p->fresnel == LC_FRESNEL_DIELECTRIC) return lc_f3_scale(f, reflected(p, c));
    return lc_f3_mul(f, lc_f3_make(conductor(rise[0], turn[0], c), conductor(rise[1], turn[1], c),
                                   conductor(rise[2], turn[2], c)));
}

/* r is that of material.h; |h| is twice the cosine between h and the viewer. */
static lc_f3 ggx(const lc_point *p, lc_f3 d, float cos_r, float inv_len)
{
    float x = lc_f3_dot(lc_f3_load(p->tangent[0]), d) * inv_len,
          y = lc_f3_dot(lc_f3_load(p->tangent[1]), d) * inv_len;
    float shadowing = stretched(p, x, y, cos_r), z = cos_r + p->view[2];
    x += p->view[0];
    y += p->view[1];
    x *= x;
    y *= y;
    z *= z;
    float h2 = x * p->square[0] + y * p->square[1] + z, r = h2 / (x + y + z), c = 0.5f * sqrtf(h2);
    float lobe = r * r / (p->masking * cos_r + shadowing * p->view[2]);
    return lc_f3_scale(fresnel(p, c < 1 ? c : 1), lobe);
}

static lc_f3 gloss(const lc_point *p, lc_f3 d, float cos_r, float inv_len)
{
    if (p->lobe == LC_LOBE_GGX) return ggx(p, d, cos_r, inv_len);
    return lc_f3_scale(lc_f3_load(p->specular),
                       p->lobe == LC_LOBE_WARD ? ward(p, d, cos_r, inv_len) : phong(p, d, inv_len));
}

/* BRDF times cosine times g times tint, for unnormalised direction d of length 1 / inv_len. */
static lc_f3 material_term(const lc_point *p, lc_f3 d, float cos_r, float inv_len, float g, lc_f3 tint)
{
    lc_f3 f = lc_f3_load(p->diffuse);
    if (p->coat) f = lc_f3_scale(f, transmitted(p, cos_r));
    if (p->lobe != LC_LOBE_NONE) f = lc_f3_add(f, gloss(p, d, cos_r, inv_len));
    f = lc_f3_scale(lc_f3_mul(f, tint), cos_r * g);
    return lc_f3_make(transfer(f.x), transfer(f.y), transfer(f.z));
}

/* A spot, or where it is NULL a point or oriented light. */
static lc_f3 shade_near(const lc_point *p, lc_light_kind kind, const lc_light_rec *light, const float *atten,
                        const lc_spot_rec *spot, const lc_spot_map *spot_maps)
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

lc_f3 lc_shade_spot(const lc_point *p, const lc_light_rec *light, const lc_spot_rec *spot,
                    const lc_spot_map *spot_maps)
{
    return shade_near(p, LC_LIGHT_SPOT, light, NULL, spot, spot_maps);
}

void lc_light_rec_init(lc_light_rec *rec, const lc_light *light)
{
    uint32_t dir[2] = { 0, 0 };
    if (lc_is_aimed(light->kind)) lc_dir_pack(light->dir, dir);
    lc_f3_store(rec->pos, light->kind == LC_LIGHT_DIRECTIONAL ? lc_f3_neg(light->dir) : light->pos);
    lc_f3_store(rec->intensity, light->intensity);
    rec->dir_a = dir[0];
    rec->dir_b = dir[1];
}
