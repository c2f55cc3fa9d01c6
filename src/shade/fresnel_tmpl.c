/* fresnel_tmpl.c - the fraction of light that smooth surfaces transmit and reflect, VF_LANES at a time;
 * included by isa_tmpl.c. lobe_ggx.h and material.h have the formulas. */
#include "shade/point.h"

/* Fraction that a smooth dielectric transmits at a cosine of c. */
LC_INLINE vf transmitted(const lc_point *p, vf c)
{
    const vf eta2 = vf_set(p->eta2);
    vf g = vf_sqrt(p->eta2_minus_1 + c * c), s = c + g, t = eta2 * c + g;
    vf half = (1 / (s * s) + eta2 / (t * t)) * (c * g);
    return half + half;
}

/* Fraction that a coat lets in: T(c') of material.h. */
LC_INLINE vf let_in(const lc_point *p, vf c)
{
    return transmitted(p, vf_sqrt(p->coat_lean + p->coat_upright * (c * c)));
}

/* Reflectance of a conductor for light polarised across the plane of incidence; t2, w: for `conductor`. */
LC_INLINE vf conductor_across(float n2_real_minus_1, float n2_imag, vf c, vf *t2, vf *w)
{
    vf cc = c * c, t = n2_real_minus_1 + cc;
    *w = vf_sqrt(t * t + n2_imag * n2_imag);
    vf b = vf_max(vf_sqrt(0.5f * (*w + vf_abs(t))), vf_set(LC_TINY_PART)),
       a = vf_sel_gt(t, vf_set(0), b, 0.5f * n2_imag / b);
    vf ca = c * a, t1 = *w + cc;
    *t2 = ca + ca;
    return (t1 - *t2) / (t1 + *t2);
}

LC_INLINE vf conductor(float n2_real_minus_1, float n2_imag, vf c)
{
    vf t2, w, rs = conductor_across(n2_real_minus_1, n2_imag, c, &t2, &w), cc = c * c, ss = 1 - cc;
    vf t3 = cc * w + ss * ss, t4 = t2 * ss;
    vf f = 0.5f * (rs + rs * ((t3 - t4) / (t3 + t4)));
    return vf_min(vf_max(f, vf_set(0)), vf_set(1));
}
