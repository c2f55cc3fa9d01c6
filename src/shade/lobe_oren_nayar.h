/* lobe_oren_nayar.h - rough diffuse surfaces, V-shaped grooves of Lambertian sides ([Oren94] eq. 30), sigma
 * being the standard deviation of the sides' angles, lc_material.roughness[0], in rad:
 *
 *     f = kd / pi (A + B max(0, cos(phi_i - phi_o)) sin(alpha) tan(beta))
 *     A = 1 - sigma^2 / (2 (sigma^2 + 0.33)),   B = 0.45 sigma^2 / (sigma^2 + 0.09)
 *
 * alpha is the greater and beta the lesser of the angles of i and o to the normal. With ks = kd the lobe is
 *
 *     ks B / pi max(i.t, 0) / max(ci, co),   t = o - co n
 *
 * since i.t = sin(alpha) sin(beta) cos(phi_i - phi_o), and cos(beta) is the greater of the cosines.
 */
#ifdef LC_TABLE_PARTS

#include "base/fmath.h"

static float oren_nayar_init(lc_point *p, lc_f3 n, lc_f3 view, const lc_material *m, lc_f3 *kd)
{
    float s2 = m->roughness[0] * m->roughness[0], cos_o = no_less(lc_f3_dot(n, view), 0);
    lc_f3 across = lc_f3_sub(view, lc_f3_scale(n, lc_f3_dot(n, view)));
    lc_f3_store(p->tangent[0], lc_f3_normalize(across));
    p->view[0] = lc_f3_len(across); /* sine */
    p->view[2] = no_less(cos_o, LC_MIN_COS);
    *kd = lc_f3_scale(*kd, 1 - 0.5f * s2 / (s2 + 0.33f));
    return (float)(0.45 / LC_PI) * s2 / (s2 + 0.09f);
}

/* The integral over the hemisphere: kd A + ks B / pi (s (x - s c) + 2/3 s / c (1 - s^3)), x the angle of
 * incidence, c its cosine, s its sine. */
static lc_f3 oren_nayar_albedo(const lc_material *m, float cos_i)
{
    float s2 = m->roughness[0] * m->roughness[0], c = cos_i < 1 ? cos_i : 1;
    c = no_less(c, LC_MIN_COS);
    double s = sqrt((1 - (double)c) * (1 + (double)c));
    double lobe = s * (lc_atan2(s, (double)c) - s * (double)c) + 2.0 / 3 * s / (double)c * (1 - s * s * s);
    float a = 1 - 0.5f * s2 / (s2 + 0.33f), b = (float)(0.45 / LC_PI) * s2 / (s2 + 0.09f);
    return lc_f3_add(lc_f3_scale(m->kd, a), lc_f3_scale(m->ks, b * (float)lobe));
}

#define LC_LOBE_INFO_oren_nayar .name = "oren-nayar", .init = oren_nayar_init, .albedo = oren_nayar_albedo

#endif

#ifdef LC_KERNEL_PARTS

LC_INLINE void oren_nayar_value(const lc_point *p, const vf d[3], vf cos_r, vf inv_len, vf lit, vf f[3])
{
    const vf zero = vf_set(0), cos_o = vf_set(p->view[2]);
    vf t[3];
    (void)lit;
    set_row(t, p->tangent[0]);
    vf along_t = dot_rows(t, d) * inv_len;
    along_t = vf_sel_gt(along_t, zero, along_t, zero);
    vf lobe = along_t * p->view[0] / vf_sel_gt(cos_r, cos_o, cos_r, cos_o);
    for (int k = 0; k < 3; k++) f[k] = f[k] + p->specular[k] * lobe;
}

/* The lobe times ci is at most sin(o) times the greatest cosine about the tangent times ci / max(ci, co): the
 * least of 1 and ci / co. */
LC_INLINE vf oren_nayar_bound(cluster_lanes *l, const lc_point *p, const rel_box *box, const range *n,
                              bool far, vf g, vf diffuse, v3 intensity)
{
    const vf one = vf_set(1), zero = vf_set(0);
    range t = range_make(box, set3(p->tangent[0]), false);
    vf lobe = max_cos(&t, least_q(&t, box->d2)) * p->view[0] * SLACK, k[4], f = one;
    (void)n;
    lobe = vf_sel_gt(t.z1, zero, lobe, zero);
    if (!far) {
        if (l->atten) f = least_f(l, p, box, k);
        else f = vf_max(box->d2, vf_set(p->min_d2));
    }
    vf geometry = vf_min(vf_min(one / f, g / p->view[2]), vf_set(FLT_MAX / 2));
    return diffuse * g + dot(weights(p->specular), intensity) * (lobe * geometry);
}

#endif
