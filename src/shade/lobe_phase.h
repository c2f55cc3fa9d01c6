/* lobe_phase.h - points of a participating medium: Henyey and Greenstein's phase function ([Henyey41]). With
 * c the cosine between the directions to the viewer and to the light, and g the mean cosine of scattering,
 * lc_material.exponent, -LC_MAX_PHASE .. LC_MAX_PHASE, above 0 forward:
 *
 *     ks (1 - g^2) / (4 pi) / D^(3/2),   D = 1 + g^2 + 2 g c = (1 - |g|)^2 + 2 |g| x,   x = 1 + c sign(g)
 *
 * A medium has no normal and scatters light from all sides: no cosine multiplies it, and there is no horizon.
 * The point's n is the direction to the viewer. The form with x keeps its digits where D is small.
 */
#ifdef LC_TABLE_PARTS

/* view: (1 - |g|)^2, 2 |g|, the sign of g. */
static float phase_init(lc_point *p, lc_f3 n, lc_f3 view, const lc_material *m, lc_f3 *kd)
{
    const float g = m->exponent, size = fabsf(g);
    (void)n;
    (void)view;
    *kd = lc_f3_make(0, 0, 0);
    lc_f3_store(p->view, lc_f3_make((1 - size) * (1 - size), 2 * size, g < 0 ? -1.0f : 1.0f));
    return (float)((1 - (double)g * (double)g) / (4 * LC_PI));
}

#define LC_LOBE_INFO_phase .name = "phase", .init = phase_init, .albedo = sum_albedo

#endif

#ifdef LC_KERNEL_PARTS

LC_INLINE void phase_value(const lc_point *p, const vf d[3], vf cos_v, vf inv_len, vf lit, vf f[3])
{
    (void)d;
    (void)inv_len;
    (void)lit;
    vf x = vf_max(1 + cos_v * p->view[2], vf_set(0)), q = p->view[0] + p->view[1] * x,
       value = 1 / (q * vf_sqrt(q));
    for (int k = 0; k < 3; k++) f[k] = f[k] + p->specular[k] * value;
}

/* It grows with the cosine about -n sign(g). D is no more than the estimate's: its rounding is relative, 3u
 * in both, and the cosine's is in COS_SLACK; so the lobe is within 8u of exact, in both. */
LC_INLINE vf phase_bound(cluster_lanes *l, const lc_point *p, const rel_box *box, const range *n, bool far,
                         vf g, vf diffuse, v3 intensity)
{
    const vf one = vf_set(1), zero = vf_set(0);
    range a = *n;
    (void)g;
    (void)diffuse;
    if (p->view[2] > 0) a.z1 = 0 - n->z0;
    /* Where the cosine is below 0 for all members, it is greatest at the greatest distance. */
    vf q = vf_sel_gt(zero, a.z1, dot(box->m, box->m), least_q(&a, box->d2));
    vf x = vf_max(one - (max_cos(&a, q) + vf_set(COS_SLACK)), zero), d = p->view[0] + p->view[1] * x;
    vf f = one, k[4];
    if (!far) {
        if (l->atten) f = least_f(l, p, box, k);
        else f = vf_max(box->d2, vf_set(p->min_d2));
    }
    vf geometry = vf_min(one / f, vf_set(FLT_MAX / 2));
    return dot(weights(p->specular), intensity) * (one / (d * vf_sqrt(d))) * geometry;
}

#endif
