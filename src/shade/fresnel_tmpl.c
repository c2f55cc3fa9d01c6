/* fresnel_tmpl.c - smooth surfaces; included by isa_*.c. The operations of shade.c in the same order, so the
 * same bits. */
#include "shade/point.h"

LC_INLINE vf transmitted(const lc_point *p, vf c)
{
    const vf eta2 = vf_set(p->eta2);
    vf g = vf_sqrt(p->bend + c * c), s = c + g, t = eta2 * c + g;
    vf half = (1 / (s * s) + eta2 / (t * t)) * (c * g);
    return half + half;
}

/* What a conductor reflects of light across the plane; t2, w: for `conductor`. */
LC_INLINE vf conductor_across(float rise, float turn, vf c, vf *t2, vf *w)
{
    vf cc = c * c, t = rise + cc;
    *w = vf_sqrt(t * t + turn * turn);
    vf b = vf_max(vf_sqrt(0.5f * (*w + vf_abs(t))), vf_set(LC_TINY_PART)),
       a = vf_sel_gt(t, vf_set(0), b, 0.5f * turn / b);
    vf ca = c * a, t1 = *w + cc;
    *t2 = ca + ca;
    return (t1 - *t2) / (t1 + *t2);
}

LC_INLINE vf conductor(float rise, float turn, vf c)
{
    vf t2, w, rs = conductor_across(rise, turn, c, &t2, &w), cc = c * c, ss = 1 - cc;
    vf t3 = cc * w + ss * ss, t4 = t2 * ss;
    vf f = 0.5f * (rs + rs * ((t3 - t4) / (t3 + t4)));
    return vf_min(vf_max(f, vf_set(0)), vf_set(1));
}
