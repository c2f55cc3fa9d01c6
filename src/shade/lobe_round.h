/* lobe_round.h - receivers that are no plane, for illuminance: the half of a sphere or of an upright cylinder
 * that faces the normal's side. The other half is a point of its own with the normal reversed.
 *
 *     sphere     ks             scalar illuminance is the integral of radiance over all directions
 *     cylinder   ks sin / pi    cylindrical illuminance, of the side of a cylinder along the normal
 *
 * lc_material.exponent is 0 for the sphere, above 0 for the cylinder. The lobe is that over the receiver's
 * cosine, by which all lobes are multiplied. A light in the plane between the halves is in neither, which is
 * why that plane is not quite across the normal (scene/view.c).
 */
#ifdef LC_TABLE_PARTS

static float round_init(lc_point *p, lc_f3 n, lc_f3 view, const lc_material *m, lc_f3 *kd)
{
    (void)p;
    (void)n;
    (void)view;
    (void)kd;
    return m->exponent > 0 ? (float)(1 / LC_PI) : 1;
}

#define LC_LOBE_INFO_round .name = "round", .init = round_init, .albedo = sum_albedo

#endif

#ifdef LC_KERNEL_PARTS

/* The sine is the length of n x d, which is right also where the cosine is near 1. */
LC_INLINE void round_value(const lc_point *p, const vf d[3], vf cos_r, vf inv_len, vf lit, vf f[3])
{
    const vf one = vf_set(1);
    vf value = one;
    (void)lit;
    if (p->exponent > 0) {
        vf e[3] = { d[0] * inv_len, d[1] * inv_len, d[2] * inv_len }; /* squares of d may underflow */
        vf x = p->n[1] * e[2] - p->n[2] * e[1], y = p->n[2] * e[0] - p->n[0] * e[2],
           z = p->n[0] * e[1] - p->n[1] * e[0];
        value = vf_sqrt(x * x + y * y + z * z);
    }
    value = value / cos_r;
    for (int k = 0; k < 3; k++) f[k] = f[k] + p->specular[k] * value;
}

/* Times the cosine it is 1, or the sine: at most the root of 1 less the least squared cosine. */
LC_INLINE vf round_bound(cluster_lanes *l, const lc_point *p, const rel_box *box, const range *n, bool far,
                         vf g, vf diffuse, v3 intensity)
{
    const vf one = vf_set(1), zero = vf_set(0);
    vf f = one, most = one, k[4];
    if (p->exponent > 0) {
        vf z = vf_max(n->z0, zero), all = vf_max(dot(box->m, box->m), vf_set(TINY));
        most = vf_sqrt(vf_min(vf_max(one - z * z / all, zero) + 64 * U, one));
    }
    if (!far) {
        if (l->atten) f = least_f(l, p, box, k);
        else f = vf_max(box->d2, vf_set(p->min_d2));
    }
    vf geometry = vf_min(one / f, vf_set(FLT_MAX / 2));
    return diffuse * g + dot(weights(p->specular), intensity) * (most * geometry);
}

#endif
