/* lobe_phong.h - modified Phong ([Miksik07] eq. 6), alpha between the mirror direction and that to the light:
 *
 *     ks (n + 2) / (2 pi) cos(alpha)^n
 *
 * Estimates and bounds are as box_tmpl.c says.
 */
#ifdef LC_TABLE_PARTS

static float phong_init(lc_point *p, lc_f3 n, lc_f3 view, const lc_material *m, lc_f3 *kd)
{
    (void)p;
    (void)n;
    (void)view;
    (void)kd;
    return (m->exponent + 2) * (float)(0.5 / LC_PI);
}

#define LC_LOBE_INFO_phong .name = "phong", .init = phong_init, .albedo = sum_albedo

#endif

#ifdef LC_KERNEL_PARTS

/* cos(alpha)^n. */
LC_INLINE vf phong_power(const lc_point *p, const vf d[3], vf inv_len, vf lit)
{
    const vf zero = vf_set(0), one = vf_set(1);
    vf mirror[3];
    set_row(mirror, p->mirror);
    vf cos_m = dot_rows(mirror, d) * inv_len;
    cos_m = vf_sel_gt(lit, zero, cos_m, zero);
    cos_m = vf_sel_gt(cos_m, vf_set(LC_MIN_COS), vf_sel_gt(one, cos_m, cos_m, one), zero);
    if (!vf_any_gt(cos_m, zero)) return zero;
    vf lobe = pow01(cos_m, p->exponent);
    return vf_sel_gt(vf_set(LC_MIN_LOBE), lobe, zero, lobe);
}

/* Adds the lobe to f, the diffuse reflectance R G B, for directions d of any length. */
LC_INLINE void phong_value(const lc_point *p, const vf d[3], vf cos_r, vf inv_len, vf lit, vf f[3])
{
    vf power = phong_power(p, d, inv_len, lit);
    (void)cos_r;
    for (int k = 0; k < 3; k++) f[k] = f[k] + p->specular[k] * power;
}

/* Greatest cos(alpha)^n. */
LC_INLINE vf max_phong(const lc_point *p, const rel_box *box)
{
    const vf one = vf_set(1), zero = vf_set(0);
    range m = range_make(box, set3(p->mirror), false);
    vf q = least_q(&m, box->d2);
    vf cos2 = vf_min(m.z1 * m.z1 / q * COS2_SLACK, one);
    cos2 = vf_sel_gt(q, vf_set(NEAR * NEAR), cos2, one);
    vf lobe = pow01_ub(cos2, 0.5f * p->exponent);
    return vf_sel_gt(m.z1, zero, lobe, zero);
}

/* Bound of lobe and diffuse part. diffuse: of the latter, without g; g: greatest receiver cosine times 1 /
 * f(d). */
LC_INLINE vf phong_bound(cluster_lanes *l, const lc_point *p, const rel_box *box, const range *n, bool far,
                         vf g, vf diffuse, v3 intensity)
{
    (void)l;
    (void)n;
    (void)far;
    return (diffuse + dot(weights(p->specular), intensity) * max_phong(p, box)) * g;
}

#endif
