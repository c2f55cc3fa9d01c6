/* fresnel.c - the equations of unpolarised light. */
#include "shade/fresnel.h"

float lc_fresnel_dielectric(float cos_i, float eta)
{
    float sin2_t = (1 - cos_i * cos_i) / (eta * eta);
    if (sin2_t >= 1) return 1;
    float cos_t = sqrtf(1 - sin2_t);
    float p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t),
          s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    return (p * p + s * s) / 2;
}

float lc_fresnel_conductor(float cos_i, float eta, float k)
{
    float c2 = cos_i * cos_i, s2 = 1 - c2, eta2 = eta * eta, k2 = k * k;
    float t0 = eta2 - k2 - s2, root = sqrtf(t0 * t0 + 4 * eta2 * k2), twice_a2 = root + t0;
    float a = sqrtf(twice_a2 > 0 ? twice_a2 / 2 : 0), t1 = root + c2, t2 = 2 * cos_i * a;
    /* Rounding may leave less than 0. */
    float t3 = c2 * root + s2 * s2, t4 = t2 * s2, s = t1 > t2 ? (t1 - t2) / (t1 + t2) : 0;
    return t3 + t4 > 0 ? (s + s * ((t3 - t4) / (t3 + t4))) / 2 : s;
}

/* Of glass, on the side of lower index. */
static float reflected_by(const lc_material *m, float cos_i)
{
    const float f = lc_fresnel_dielectric(cos_i, m->eta.x);
    return m->thin ? lc_sheet_reflectance(f) : f;
}

lc_f3 lc_transmittance(const lc_material *m, float cos_i)
{
    return m->glass ? lc_f3_scale(m->kt, 1 - reflected_by(m, cos_i)) : lc_f3_make(0, 0, 0);
}

lc_f3 lc_glass_reflectance(const lc_material *m, float cos_i)
{
    return m->glass ? lc_f3_scale(m->ks, reflected_by(m, cos_i)) : lc_f3_make(0, 0, 0);
}

lc_f3 lc_reflectance(const lc_material *m, float cos_i, bool inside)
{
    float c = cos_i > 0 ? cos_i < 1 ? cos_i : 1 : 0, one_c = 1 - c,
          c5 = one_c * one_c * one_c * one_c * one_c;
    switch (m->fresnel) {
    case LC_FRESNEL_SCHLICK:
        return lc_f3_add(m->ks, lc_f3_scale(lc_f3_sub(lc_f3_make(1, 1, 1), m->ks), c5));
    case LC_FRESNEL_DIELECTRIC:
        return lc_f3_scale(m->ks, lc_fresnel_dielectric(c, inside ? 1 / m->eta.x : m->eta.x));
    case LC_FRESNEL_CONDUCTOR:
        return lc_f3_mul(m->ks, lc_f3_make(lc_fresnel_conductor(c, m->eta.x, m->k.x),
                                           lc_fresnel_conductor(c, m->eta.y, m->k.y),
                                           lc_fresnel_conductor(c, m->eta.z, m->k.z)));
    default:
        return m->ks;
    }
}
