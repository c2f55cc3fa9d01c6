/* lobe_ward.h - Ward's lobe as [Walter05b] writes it; material.h has the formula, slope_tmpl.c the bound. */
#ifdef LC_TABLE_PARTS

/* Returns the factor of ks. */
static float ward_init(lc_point *p, lc_f3 n, lc_f3 view, const lc_material *m, lc_f3 *kd)
{
    (void)kd;
    init_frame(p, n, tangent_of(n, m->tangent), view, m);
    return (float)(0.25 / LC_PI) /
           (m->roughness[0] * m->roughness[1] * sqrtf(no_less(lc_f3_dot(n, view), LC_WARD_MIN_COS)));
}

#define LC_LOBE_INFO_ward .name = "ward", .init = ward_init, .albedo = sum_albedo

#endif

#ifdef LC_KERNEL_PARTS

#define GRAZING 7.0710683f /* 1 / sqrt(LC_WARD_MIN_COS), rounded up */
#define MAX_EXPONENT 100 /* e^-x is below LC_MIN_LOBE from 27.7 on */

/* Factor of the specular reflectance, also for lanes that are not lit. */
LC_INLINE vf ward_factor(const lc_point *p, const vf d[3], vf cos_r, vf inv_len, vf lit)
{
    const vf zero = vf_set(0), min_cos = vf_set(LC_WARD_MIN_COS), most = vf_set(MAX_EXPONENT);
    vf tx[3], ty[3];
    set_row(tx, p->tangent[0]);
    set_row(ty, p->tangent[1]);
    vf x = dot_rows(tx, d) * inv_len + p->view[0];
    vf y = dot_rows(ty, d) * inv_len + p->view[1], z = cos_r + p->view[2];
    vf e = (x * x + y * y) / (z * z);
    e = vf_sel_gt(lit, zero, e, most);
    e = vf_sel_gt(most, e, e, most);
    if (!vf_any_gt(vf_set(-(float)LC_LEAST_LN), e)) return zero;
    vf lobe = decay(e);
    lobe = vf_sel_gt(vf_set(LC_MIN_LOBE), lobe, zero, lobe);
    return lobe / vf_sqrt(vf_sel_gt(cos_r, min_cos, cos_r, min_cos));
}

LC_INLINE void ward_value(const lc_point *p, const vf d[3], vf cos_r, vf inv_len, vf lit, vf f[3])
{
    vf factor = ward_factor(p, d, cos_r, inv_len, lit);
    for (int k = 0; k < 3; k++) f[k] = f[k] + p->specular[k] * factor;
}

/* Greatest e^-(X^2 + Y^2) / N^2. */
LC_INLINE vf max_ward(const lc_point *p, const rel_box *box)
{
    vf clear, slope = least_slope(p, box, &clear);
    vf lobe = decay_ub(slope * slope * (1 - 32 * U));
    return vf_sel_gt(clear, vf_set(NEAR), lobe, vf_set(1));
}

/* Greatest sqrt(cos) / f(d), from g, the greatest cos / f(d). Twice the result is finite. */
LC_INLINE vf ward_geometry(cluster_lanes *l, const lc_point *p, const rel_box *box, bool far, vf g)
{
    const vf most = g * GRAZING;
    vf k[4], f, root = vf_sqrt(g);
    if (!far) {
        if (l->atten) f = least_f(l, p, box, k);
        else f = vf_max(box->d2, vf_set(p->min_d2));
        root = root / vf_sqrt(f);
    }
    return vf_min(vf_min(root, most), vf_set(FLT_MAX / 2));
}

LC_INLINE vf ward_bound(cluster_lanes *l, const lc_point *p, const rel_box *box, const range *n, bool far,
                        vf g, vf diffuse, v3 intensity)
{
    (void)n;
    vf lobe = max_ward(p, box) * ward_geometry(l, p, box, far, g);
    return diffuse * g + dot(weights(p->specular), intensity) * lobe;
}

#undef GRAZING
#undef MAX_EXPONENT

#endif
