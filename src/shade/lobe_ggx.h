/* lobe_ggx.h - microfacets by [Walter07], and a diffuse surface below a coat: see material.h.
 *
 * Bound. Up to a constant, and with t <= sqrt(X^2 + Y^2) / N of slope_tmpl.c, a <= 1 the larger roughness,
 *
 *     f cos = F r^2 cos / (s(o) cos + s(i) o.n)
 *     r = |h|^2 / (X^2 + Y^2 + N^2),   |h|^2 = (ax X)^2 + (ay Y)^2 + N^2
 *       = (1 + ((ax X)^2 + (ay Y)^2) / N^2) / (1 + (X^2 + Y^2) / N^2)
 *      <= min(1 + a^2 t^2, max |h|^2 / min N^2) / (1 + t^2)
 *
 * since (1 + a^2 x) / (1 + x) decreases. The first is exact where ax = ay; the second lowers the bound of a
 * lobe that is long in one direction. |h|^2 = 2 + 2 i.o, two cosines about o. With b the smaller roughness
 * s(i)^2 >= cos^2 + b^2 (1 - cos^2): s(i) increases with the cosine, s(i) / cos decreases; and |p| s(i) >=
 * w.p with w = S u, S the symmetric matrix of s, u the unit vector along S e. With g the greatest cos / f(d),
 *
 *     cos / (s(o) cos + s(i) o.n) / f(d) <= g / (s(o) c0 + s0 o.n)
 *                                    and <= 1 / (least f(d) (s(o) + q o.n))
 *
 * with c0 the least cosine, s0 the greater of s there and min w.p / max |p|, q that of s / cos at the
 * greatest cosine and min w.p / z1.
 *
 * F decreases with the cosine c = |h| / 2: Schlick's plainly, a dielectric's up to an index of 2 + sqrt 3
 * (unit_ggx.c goes through them). A conductor's is no more than that of light polarised across the plane of
 * incidence. With w = |N|^2,
 *
 *     1 - 4 / ((w + x) / (c Re N) + 2),   x = c^2,   N^2 = x + p + i q,   p = eta^2 - k^2 - 1,   q = 2 eta k
 *
 * which decreases, too, as ln((w + x)^2 / (x (w + x + p))) has the derivative -(p^2 + q^2) / (w x (w + x)) by
 * x. A coat transmits more of steeper light: T is taken at the greatest cosine.
 * - t holds for the estimate's X, Y, N, as in slope_tmpl.c, and its squares of roughness are used. |h|^2 as
 *   the estimate adds it up: frames are perpendicular to 4u, tangents off by 5u in length and components by
 *   10u: 40u of |h|^2 and 70u; i.o as for COS_SLACK: 64u. We take 256u of both. s(i): same frame, 40u; 256u.
 * - w.p: u and w within 8u, three dot products 9u each, the widening 4u, all times |S| <= 1: 64uM.
 * - T: g 2.5u, squares of sums 9u, the rest: below 20u of T <= 1 in estimate and bound: F is raised by 64u.
 *   A coat's cosine c' has 3u more, and T / c' falls with it.
 * - Conductors: x + p is off by 2u x where it cancels, N by the root of that at most, 3.5e-4 c; the quotient
 *   of amplitudes by 2 c / |c + N|^2 times that, its square by twice as much: 1.4e-3, here and in the
 *   estimate. CONDUCTOR_SLACK is 3.9e-3.
 * - r^2 has 18u in the estimate and 20u here, the rest 12u: a SLACK of its own. Schlick's (1 - c)^5 has 9u in
 *   either; what HALF_SLACK leaves, 80u of c, is more than 400u of it.
 */
#ifdef LC_TABLE_PARTS

/* Length of (ax w.x, ay w.y, w.z), x and y along the tangents over roughness. */
static float stretched_length(const lc_point *p, float x, float y, float z)
{
    x *= p->square[0];
    y *= p->square[1];
    return sqrtf(x * x + y * y + z * z);
}

/* The diffuse part below the coat as seen from outside, without the transmittance on the way in; T(c') of the
 * view is half of 4 c g / (c + g)^2 + 4 eta^2 c g / (eta^2 c + g)^2, g = eta times the cosine inside. */
static lc_f3 below_coat(const lc_point *p, const lc_material *m)
{
    const float c = sqrtf(p->coat_lean + p->coat_upright * (p->view[2] * p->view[2]));
    const float g = sqrtf(p->eta2_minus_1 + c * c), s = c + g, t = p->eta2 * c + g;
    const float half = (1 / (s * s) + p->eta2 / (t * t)) * (c * g);
    return lc_f3_scale(lc_coat_below(m), p->view[2] > LC_MIN_COS ? half + half : 0);
}

/* Returns the factor of ks. With a coat the diffuse part below it is written to *kd. */
static float ggx_init(lc_point *p, lc_f3 n, lc_f3 view, const lc_material *m, lc_f3 *kd)
{
    const double eta[3] = { (double)m->eta.x, (double)m->eta.y, (double)m->eta.z };
    const double k[3] = { (double)m->k.x, (double)m->k.y, (double)m->k.z };
    float factor = (float)(0.5 / LC_PI) / (m->roughness[0] * m->roughness[1]);
    /* Twice, so that the result is perpendicular to within rounding. */
    if (lc_f3_dot(n, view) < 0) view = tangent_of(n, tangent_of(n, view));
    init_frame(p, n, tangent_of(n, tangent_of(n, m->tangent)), view, m);
    lc_f3_store(p->to_view, view);
    for (int i = 0; i < 2; i++) p->square[i] = m->roughness[i] * m->roughness[i];
    p->masking = stretched_length(p, p->view[0], p->view[1], p->view[2]);
    p->fresnel = m->fresnel == LC_FRESNEL_NONE ? LC_FRESNEL_SCHLICK : m->fresnel;
    p->coat = m->coat;
    p->coat_lean = m->coat ? lc_coat_lean(m) : 0;
    p->coat_upright = 1 - p->coat_lean;
    p->eta2 = (float)(eta[0] * eta[0]);
    p->eta2_minus_1 = (float)(eta[0] * eta[0] - 1);
    lc_f3 delta = lc_f3_scale(lc_f3_make(no_less(1 - m->ks.x, 0), no_less(1 - m->ks.y, 0),
                                        no_less(1 - m->ks.z, 0)),
                              factor);
    if (m->fresnel == LC_FRESNEL_SCHLICK && lc_f3_max(m->ks) > 0) lc_f3_store(p->schlick_delta, delta);
    for (int i = 0; i < 3 && m->fresnel == LC_FRESNEL_CONDUCTOR; i++) {
        p->n2_real_minus_1[i] = (float)(eta[i] * eta[i] - k[i] * k[i] - 1);
        p->n2_imag[i] = (float)(2 * eta[i] * k[i]);
    }
    if (m->coat) *kd = below_coat(p, m);
    return factor;
}

/* The lobe and the diffuse part below it. */
static lc_f3 ggx_albedo(const lc_material *m, float cos_i)
{
    return lc_f3_add(m->coat ? lc_coat_albedo(m, cos_i) : m->kd, lc_lobe_reflected(m, cos_i));
}

/* Whether the indices of refraction are in the range that reflectances and bounds allow. */
static bool ggx_check(const lc_material *m)
{
    const float *eta = &m->eta.x, *k = &m->k.x;
    if ((m->coat || m->fresnel == LC_FRESNEL_DIELECTRIC) && !(eta[0] >= LC_MIN_ETA && eta[0] <= LC_MAX_ETA))
        return false;
    for (int i = 0; i < 3 && m->fresnel == LC_FRESNEL_CONDUCTOR; i++)
        if (!(eta[i] >= 0 && eta[i] <= LC_MAX_CONDUCTOR && k[i] >= 0 && k[i] <= LC_MAX_CONDUCTOR &&
              eta[i] * eta[i] + k[i] * k[i] >= LC_MIN_CONDUCTOR))
            return false;
    return true;
}

#define LC_LOBE_INFO_ggx .name = "ggx", .init = ggx_init, .albedo = ggx_albedo, .check = ggx_check

#endif

#ifdef LC_KERNEL_PARTS

#define HALF_SLACK (256 * U)      /* of |h|^2, absolute and relative, and of s(i)^2 */
#define TRANSMIT_SLACK (64 * U)   /* of F of a dielectric */
#define CONDUCTOR_SLACK 0x1p-8f   /* of F of a conductor */

LC_INLINE vf stretched(const lc_point *p, vf x, vf y, vf z)
{
    x = x * p->square[0];
    y = y * p->square[1];
    return vf_sqrt(x * x + y * y + z * z);
}

/* out: R G B of GGX's lobe. */
LC_INLINE void ggx_fresnel(const lc_point *p, vf c, vf lobe, vf out[3])
{
    const vf one = vf_set(1);
    if (p->fresnel == LC_FRESNEL_SCHLICK) {
        vf m = one - c, m2 = m * m, w = m2 * m2 * m;
        w = vf_sel_gt(vf_set(LC_MIN_LOBE), w, vf_set(0), w);
        for (int k = 0; k < 3; k++) out[k] = (p->specular[k] + p->schlick_delta[k] * w) * lobe;
    } else if (p->fresnel == LC_FRESNEL_DIELECTRIC) {
        vf f = vf_max(one - transmitted(p, c), vf_set(0));
        for (int k = 0; k < 3; k++) out[k] = p->specular[k] * f * lobe;
    } else {
        for (int k = 0; k < 3; k++)
            out[k] = p->specular[k] * conductor(p->n2_real_minus_1[k], p->n2_imag[k], c) * lobe;
    }
}

LC_INLINE void ggx_lobe(const lc_point *p, const vf d[3], vf cos_r, vf inv_len, vf out[3])
{
    const vf o_n = vf_set(p->view[2]);
    vf tx[3], ty[3];
    set_row(tx, p->tangent[0]);
    set_row(ty, p->tangent[1]);
    vf x = dot_rows(tx, d) * inv_len, y = dot_rows(ty, d) * inv_len;
    vf shadowing = stretched(p, x, y, cos_r), z = cos_r + o_n;
    x = x + p->view[0];
    y = y + p->view[1];
    x = x * x;
    y = y * y;
    z = z * z;
    vf h2 = x * p->square[0] + y * p->square[1] + z, r = h2 / (x + y + z);
    vf lobe = r * r / (p->masking * cos_r + shadowing * o_n);
    ggx_fresnel(p, vf_min(0.5f * vf_sqrt(h2), vf_set(1)), lobe, out);
}

LC_INLINE void ggx_value(const lc_point *p, const vf d[3], vf cos_r, vf inv_len, vf lit, vf f[3])
{
    vf lobe[3], coat = p->coat ? let_in(p, cos_r) : vf_set(1);
    (void)lit;
    ggx_lobe(p, d, cos_r, inv_len, lobe);
    for (int k = 0; k < 3; k++) f[k] = f[k] * coat + lobe[k];
}

/* Greatest reflectance for a cosine of at least c, times the intensity. */
LC_INLINE vf max_fresnel(const lc_point *p, vf c, v3 intensity)
{
    const vf one = vf_set(1);
    v3 s = weights(p->specular);
    if (p->fresnel == LC_FRESNEL_SCHLICK) {
        vf m = one - c, m2 = m * m, w = m2 * m2 * m;
        return dot(s, intensity) + dot(weights(p->schlick_delta), intensity) * w;
    }
    if (p->fresnel == LC_FRESNEL_DIELECTRIC) {
        vf f = one - transmitted(p, vf_max(c, vf_set(LC_MIN_COS))) + TRANSMIT_SLACK;
        return dot(s, intensity) * vf_min(f, one);
    }
    vf f[3], t2, w;
    for (int k = 0; k < 3; k++)
        f[k] = vf_min(conductor_across(p->n2_real_minus_1[k], p->n2_imag[k], c, &t2, &w) + CONDUCTOR_SLACK,
                      one);
    s = (v3){ s.x * f[0], s.y * f[1], s.z * f[2] };
    return dot(s, intensity);
}

/* Least and greatest |h|^2. */
LC_INLINE void half_range(const lc_point *p, const rel_box *box, vf far2, vf *least, vf *most)
{
    const vf zero = vf_set(0), two = vf_set(2), slack = vf_set(HALF_SLACK);
    range away = range_make(box, set3(p->to_view), true), to = { zero, -away.z0, away.r2 };
    /* Where all members are behind, the greatest cosine is at the greatest distance. */
    vf c0 = max_cos(&away, vf_sel_gt(zero, away.z1, far2, least_q(&away, box->d2)));
    vf c1 = max_cos(&to, vf_sel_gt(zero, to.z1, far2, least_q(&to, box->d2)));
    *least = vf_max(two - slack - two * c0, zero) * (1 - HALF_SLACK);
    *most = (two + slack + two * c1) * (1 + HALF_SLACK);
}

/* A lower bound of the length of (ax w.x, ay w.y, w.z) for unit w of cosine c; it increases with c. */
LC_INLINE vf least_stretched(const lc_point *p, vf c)
{
    vf cc = c * c, square = vf_set(p->square[0] < p->square[1] ? p->square[0] : p->square[1]);
    return vf_sqrt((cc + square * vf_max(1 - cc, vf_set(0))) * (1 - HALF_SLACK));
}

/* A lower bound of |p| s(i) over the box: the linear w.p of above, which is exact at the box centre. */
LC_INLINE vf linear_stretched(const lc_point *p, const rel_box *box)
{
    const vf a = vf_set(p->square[0]), b = vf_set(p->square[1]);
    v3 tx = set3(p->tangent[0]), ty = set3(p->tangent[1]), n = set3(p->n);
    vf x = dot(tx, box->c) * a, y = dot(ty, box->c) * b, z = dot(n, box->c);
    vf inv = 1 / vf_sqrt(vf_max(x * x + y * y + z * z, vf_set(TINY)));
    v3 w = along(along(scale3(tx, x * inv * a), ty, y * inv * b), n, z * inv);
    vf low = dot(w, box->c) - dot(abs3(w), box->half);
    return vf_max(low - box->m_sum * (64 * U), vf_set(0));
}

/* Greatest cos / (s(o) cos + s(i) o.n) / f(d), the lesser of the two bounds of above; near: least receiver
 * cosine. */
LC_INLINE vf ggx_geometry(cluster_lanes *l, const lc_point *p, const rel_box *box, bool far_kind, vf g,
                          vf cos_r, vf near, vf z1, vf far)
{
    const vf one = vf_set(1), o_s = vf_set(p->masking), o_n = vf_set(p->view[2]);
    const bool isotropic = !(p->square[0] < p->square[1] || p->square[0] > p->square[1]);
    vf linear = isotropic ? vf_set(0) : linear_stretched(p, box);
    vf k[4], f = one, both = g / (o_s * near + o_n * vf_max(linear / far, least_stretched(p, near)));
    if (!far_kind) f = l->atten ? least_f(l, p, box, k) : vf_max(box->d2, vf_set(p->min_d2));
    vf apart = one / (f * (o_s + o_n * vf_max(linear / z1, least_stretched(p, cos_r) / cos_r)));
    return vf_min(vf_min(both, apart), vf_set(FLT_MAX / 2));
}

/* Bound of lobe and diffuse part. diffuse: of the latter, without coat and g. */
LC_INLINE vf ggx_bound(cluster_lanes *l, const lc_point *p, const rel_box *box, const range *n,
                       bool far, vf g, vf diffuse, v3 intensity)
{
    const vf one = vf_set(1), zero = vf_set(0), o_n = vf_set(p->view[2]);
    vf far2 = dot(box->m, box->m), clear, h_least, h_most, slope = least_slope(p, box, &clear);
    vf near = vf_min(vf_max(n->z0 / vf_sqrt(far2) * (1 - 32 * U), zero), one);
    vf cos_r = vf_min(max_cos(n, least_q(n, box->d2)) + COS_SLACK, one);
    half_range(p, box, far2, &h_least, &h_most);
    vf t2 = vf_sel_gt(clear, vf_set(NEAR), slope * slope * (1 - 32 * U), zero);
    float square = p->square[0] > p->square[1] ? p->square[0] : p->square[1];
    vf z = o_n + near, r = vf_min(one + square * t2, h_most / (z * z)) / (one + t2);
    vf lobe = r * r * SLACK * ggx_geometry(l, p, box, far, g, cos_r, near, n->z1, vf_sqrt(far2));
    if (p->coat) diffuse = diffuse * (let_in(p, cos_r) * SLACK);
    return diffuse * g + max_fresnel(p, 0.5f * vf_sqrt(h_least), intensity) * lobe;
}

#undef HALF_SLACK
#undef TRANSMIT_SLACK
#undef CONDUCTOR_SLACK

#endif
