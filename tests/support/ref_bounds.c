/* ref_bounds.c - see ref_bounds.h.
 *
 * [Miksik07] M. Miksik, Implementing Lightcuts, CESCG 2007. Equation numbers are of that report.
 * [Walter05b] B. Walter, Notes on the Ward BRDF, PCG-05-06, 2005.
 * [Walter07] Walter et al., Microfacet models for refraction through rough surfaces, EGSR 2007.
 */
#include "support/ref_bounds.h"
#include "support/ref_shine.h"

#include "shade/dir_pack.h"
#include "support/ref_receivers.h"

#include <complex.h>
#include <math.h>

#define U 0x1p-24 /* half an ulp of float, relative */

static double dot3(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void load(double a[3], const float b[3])
{
    for (int k = 0; k < 3; k++) a[k] = (double)b[k];
}

static void load_f3(double a[3], lc_f3 b) { a[0] = (double)b.x, a[1] = (double)b.y, a[2] = (double)b.z; }

static double clamp(double x, double lo, double hi) { return x < lo ? lo : x > hi ? hi : x; }

double ref_luminance(const double rgb[3])
{
    return (double)0.2126f * rgb[0] + (double)0.7152f * rgb[1] + (double)0.0722f * rgb[2];
}

/* ---- smooth surfaces ---- */

double ref_dielectric(double eta, double c)
{
    double inside2 = 1 - (1 - c * c) / (eta * eta);
    if (c <= 0 || inside2 <= 0) return 1;
    double ci = sqrt(inside2), p = (eta * c - ci) / (eta * c + ci), s = (c - eta * ci) / (c + eta * ci);
    return (p * p + s * s) / 2;
}

/* n2: square of the complex index. */
static double conductor(double complex n2, double c)
{
    double complex inside = csqrt(n2 - (1 - c * c)); /* index times the cosine inside */
    double complex s = (c - inside) / (c + inside), p = (n2 * c - inside) / (n2 * c + inside);
    return (creal(s * conj(s)) + creal(p * conj(p))) / 2;
}

double ref_conductor(double eta, double k, double c) { return conductor((eta + I * k) * (eta + I * k), c); }

double ref_mean_dielectric(double eta)
{
    const int n = 1000; /* good to 2e-7 */
    double sum = 0;
    for (int i = 0; i < n; i++) { /* the cosine's square is uniform; finer towards grazing */
        double u = (i + 0.5) / n;
        sum += ref_dielectric(eta, u * u) * 4 * u * u * u;
    }
    return sum / n;
}

/* A frame whose x is along the material's tangent where that points along the surface; what stands before the
 * exponential of [Walter05b] but 1 / sqrt(cos_i); before r^2 of GGX. */
static void make_rough(ref_point *r, const double n[3], const double o[3], const lc_material *m)
{
    double a[2] = { (double)m->roughness[0], (double)m->roughness[1] }, t[3], x[3], y[3], len;
    double eta = (double)m->eta.x, fi = m->coat ? 1 - (1 - ref_mean_dielectric(eta)) / (eta * eta) : 0,
           mean = sqrt(a[0] * a[1]);
    fi /= 1 + (1.1 + 1.125 / fmax(eta - 1, 0.001)) * pow(mean, 1.75);
    load_f3(t, m->tangent);
    for (int k = 0; k < 3; k++) x[k] = t[k] - dot3(n, t) * n[k];
    len = sqrt(dot3(x, x));
    for (int k = 0; k < 3; k++) x[k] /= len;
    y[0] = n[1] * x[2] - n[2] * x[1];
    y[1] = n[2] * x[0] - n[0] * x[2];
    y[2] = n[0] * x[1] - n[1] * x[0];
    for (int k = 0; k < 3; k++) {
        double ks = k == 0 ? (double)m->ks.x : k == 1 ? (double)m->ks.y : (double)m->ks.z;
        r->tangent[0][k] = x[k] / a[0];
        r->tangent[1][k] = y[k] / a[1];
        r->specular[k] = ks / (4 * LC_PI * a[0] * a[1] * sqrt(fmax(dot3(n, o), (double)LC_WARD_MIN_COS)));
        if (m->lobe == LC_LOBE_GGX) r->specular[k] = ks / (2 * LC_PI * a[0] * a[1]);
        if (!m->coat) continue;
        double kd = r->diffuse[k] * LC_PI, c = dot3(n, o), lean = ref_lean(eta, mean);
        c = sqrt(c * c + (1 - c * c) * lean * lean);
        r->diffuse[k] *= (1 - ref_dielectric(eta, c)) / (eta * eta * (1 - kd * fi)) *
                         (1 - 0.1 * mean - 0.2 * mean * mean);
    }
    r->view[0] = dot3(r->tangent[0], o);
    r->view[1] = dot3(r->tangent[1], o);
    r->view[2] = fmax(dot3(n, o), 0);
}

void ref_point_make(ref_point *r, lc_f3 n, lc_f3 view, const lc_material *m)
{
    double nn[3], o[3], kd[3], ks[3];
    load_f3(nn, n);
    load_f3(o, view);
    load_f3(kd, m->kd);
    load_f3(ks, m->ks);
    for (int k = 0; k < 3; k++) {
        r->mirror[k] = 2 * dot3(nn, o) * nn[k] - o[k];
        r->diffuse[k] = kd[k] / LC_PI;
        r->specular[k] = ks[k] * ((double)m->exponent + 2) / (2 * LC_PI);
    }
    if (m->lobe == LC_LOBE_PHASE)
        for (int k = 0; k < 3; k++) {
            r->diffuse[k] = 0;
            r->specular[k] = ks[k] * (1 - (double)m->exponent * (double)m->exponent) / (4 * LC_PI);
        }
    else if (m->lobe == LC_LOBE_ROUND)
        for (int k = 0; k < 3; k++) r->specular[k] = ks[k] / (m->exponent > 0 ? LC_PI : 1);
    else if (m->lobe != LC_LOBE_PHONG) make_rough(r, nn, o, m);
}

/* ---- transfer ---- */

/* f_A of [Miksik07] 2.2.2 at squared distance d2 */
static double falloff(const double atten[3], double d2)
{
    return atten[0] + atten[1] * sqrt(d2) + atten[2] * d2;
}

/* spot.h's smooth step, a jump where both cosines are one. */
static double profile(double cos_total, double cos_start, double cos_phi)
{
    if (cos_phi <= cos_total) return 0;
    double t = cos_start > cos_total ? (cos_phi - cos_total) / (cos_start - cos_total) : 1;
    return t < 1 ? t * t * (3 - 2 * t) : 1;
}

static double emission(const lc_light *l, double cos_phi)
{
    if (l->kind != LC_LIGHT_SPOT) return lc_is_aimed(l->kind) ? cos_phi : 1;
    return profile((double)l->spot.cos_total, (double)l->spot.cos_start, cos_phi);
}

/* ---- luminaires ---- */

static const lc_profiles *profiles;

void ref_set_profiles(const lc_profiles *all) { profiles = all; }

static const lc_profile *profile_of(const lc_light *l)
{
    return &profiles->item[l->luminaire.profile & ~LC_PROFILE_MIRRORED];
}

/* The table's value at two angles in degrees. */
static double table_at(const lc_profile *p, double azimuth, double polar)
{
    const float *x = p->azimuth, *y = p->polar;
    uint32_t i = 0, j = 0;
    while (azimuth < (double)x[0]) azimuth += 360;
    while (azimuth >= (double)x[0] + 360) azimuth -= 360;
    if (azimuth > (double)x[p->n_azimuth - 1] || polar < (double)y[0] || polar > (double)y[p->n_polar - 1])
        return 0;
    while (i + 2 < p->n_azimuth && (double)x[i + 1] <= azimuth) i++;
    while (j + 2 < p->n_polar && (double)y[j + 1] <= polar) j++;
    double f = (azimuth - (double)x[i]) / ((double)x[i + 1] - (double)x[i]), v[2],
           g = (polar - (double)y[j]) / ((double)y[j + 1] - (double)y[j]);
    for (uint32_t k = 0; k < 2; k++) {
        const float *a = p->value + (size_t)i * p->n_polar + j + k;
        v[k] = (double)a[0] * (1 - f) + (double)a[p->n_polar] * f;
    }
    return v[0] * (1 - g) + v[1] * g;
}

/* azimuth, polar: of the direction from the light. */
static void light_angles(const lc_light *l, const double to_light[3], double angle[2])
{
    double zero[3], dir[3], ninety[3], away[3];
    load_f3(zero, lc_dir_unpack(l->luminaire.zero));
    load_f3(dir, l->dir);
    double sign = l->luminaire.profile & LC_PROFILE_MIRRORED ? -1 : 1;
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        ninety[k] = sign * (zero[a] * dir[b] - zero[b] * dir[a]);
        away[k] = -to_light[k];
    }
    double x = dot3(zero, away), y = dot3(ninety, away);
    angle[0] = atan2(y, x) * (180 / LC_PI);
    angle[1] = atan2(hypot(x, y), dot3(dir, away)) * (180 / LC_PI);
}

#define ANGLE_OFF 1e-4 /* degrees: of the angles that a kernel computes, see light_luminaire.h */

/* Least and greatest value for angles within ANGLE_OFF: of a bilinear function at the corners of each piece,
 * and 0 where the table ends. */
static void table_range(const lc_light *l, const double angle[2], double *lo, double *hi)
{
    const lc_profile *p = profile_of(l);
    double off = ANGLE_OFF / fmax(sin(angle[1] * LC_PI / 180), 1e-9), at[2][32];
    uint32_t n[2] = { 0, 0 };
    off = fmin(off, 180);
    for (int s = -1; s <= 1; s++) {
        at[0][n[0]++] = angle[0] + s * off;
        at[1][n[1]++] = clamp(angle[1] + s * ANGLE_OFF, 0, 180);
    }
    for (uint32_t i = 0; i < p->n_azimuth; i++)
        for (int turn = -1; turn <= 1; turn++) {
            double a = (double)p->azimuth[i] + 360 * turn;
            if (fabs(a - angle[0]) <= off) at[0][n[0]++] = a;
        }
    for (uint32_t j = 0; j < p->n_polar; j++)
        if (fabs((double)p->polar[j] - angle[1]) <= ANGLE_OFF) at[1][n[1]++] = (double)p->polar[j];
    *lo = HUGE_VAL;
    *hi = 0;
    for (uint32_t i = 0; i < n[0]; i++)
        for (uint32_t j = 0; j < n[1]; j++) {
            double v = table_at(p, at[0][i], at[1][j]);
            *lo = fmin(*lo, v);
            *hi = fmax(*hi, v);
        }
    *lo *= 1 - 8 * U;
    *hi *= 1 + 8 * U;
}

/* What M G is made of: cosines at the receiver, about the mirror direction, at the light; 1/f; Ward, GGX: i
 * and h = i + o by tangents over roughness and n, and the lengths of the former two. */
typedef struct terms {
    double cos_r, cos_m, cos_e, inv_f, i[3], h[3], sharp[2];
    double angle[2], sin_r; /* luminaires: azimuth, polar; sine at the receiver */
    ref_shining shine;
} terms;

static void load_atten(double a[3], const lc_light *l)
{
    for (int k = 0; k < 3; k++) a[k] = lc_is_attenuated(l->kind) ? (double)l->atten[k] : k == 2;
}

static terms light_terms(const lc_point *p, const lc_light *l)
{
    double dir[3], n[3], m[3], atten[3], v[3], w[3];
    load_f3(dir, l->dir);
    load(n, p->n);
    load(m, p->mirror);
    load_atten(atten, l);
    bool far = lc_is_far(l->kind);
    ref_towards(p, l, v);
    double d2 = dot3(v, v), d = sqrt(fmax(d2, (double)LC_TINY_D2)); /* no shorter: point.h */
    for (int k = 0; k < 3; k++) w[k] = v[k] / d;
    terms t = { dot3(n, w), dot3(m, w), 1, 1, { 0 }, { 0 }, { 0 }, { 0 }, 0, { 1, 1, 1 } };
    for (int k = 0; k < 3; k++)
        t.sin_r = hypot(t.sin_r, n[(k + 1) % 3] * w[(k + 2) % 3] - n[(k + 2) % 3] * w[(k + 1) % 3]);
    for (int k = 0; k < 2; k++) {
        double tangent[3];
        load(tangent, p->tangent[k]);
        t.i[k] = dot3(tangent, w);
        t.sharp[k] = sqrt(dot3(tangent, tangent));
    }
    t.i[2] = dot3(n, w);
    for (int k = 0; k < 3; k++) t.h[k] = t.i[k] + (double)p->view[k];
    if (lc_is_aimed(l->kind)) {
        double len = sqrt(dot3(dir, dir));
        t.cos_e = len > 0 ? -dot3(dir, w) / len : 0;
        t.shine = ref_shine(l, w, t.cos_e);
    }
    if (l->kind == LC_LIGHT_LUMINAIRE) light_angles(l, v, t.angle);
    if (!far) t.inv_f = 1 / falloff(atten, fmax(d2, (double)p->min_d2));
    return t;
}

/* [Walter05b]'s lobe without specular: roots of cosines as material.h says. */
static double ward(double x, double y, double z, double cos_r)
{
    return z > 0 ? exp(-(x * x + y * y) / (z * z)) / sqrt(fmax(cos_r, (double)LC_WARD_MIN_COS)) : 0;
}

/* [Walter07]: D G / (4 cos_i cos_o) times 2 pi ax ay, for i and o by tangents over roughness and n; both
 * cosines > 0. */
static double ggx(const lc_point *p, const double i[3], double o_n)
{
    double a2[3] = { (double)p->square[0], (double)p->square[1], 1 }, h2 = 0, e = 0, s[2] = { 0, 0 };
    double o[3] = { (double)p->view[0], (double)p->view[1], o_n };
    for (int k = 0; k < 3; k++) {
        double h = i[k] + o[k], x = a2[k] * i[k], y = a2[k] * o[k];
        h2 += a2[k] * h * h;
        e += h * h;
        s[0] += x * x;
        s[1] += y * y;
    }
    e /= h2; /* of h of length 1: (hx / ax)^2 + (hy / ay)^2 + hz^2 */
    double lambda[2] = { (sqrt(s[0]) / i[2] - 1) / 2, (sqrt(s[1]) / o_n - 1) / 2 };
    return 2 / (e * e) / (1 + lambda[0] + lambda[1]) / (4 * i[2] * o_n);
}

/* Reflectance times the constant before the lobe. */
static double fresnel(const lc_point *p, int channel, double c)
{
    double f = (double)p->specular[channel];
    if (p->fresnel == LC_FRESNEL_SCHLICK) return f + (double)p->schlick_delta[channel] * pow(1 - c, 5);
    if (p->fresnel == LC_FRESNEL_DIELECTRIC) return f * ref_dielectric(sqrt(1 + (double)p->eta2_minus_1), c);
    return f * conductor(1 + (double)p->n2_real_minus_1[channel] + I * (double)p->n2_imag[channel], c);
}

static double coat_in(const lc_point *p, double cos_r)
{
    const double c = fmin(cos_r, 1), leant = sqrt(c * c + (1 - c * c) * (double)p->coat_lean);
    return p->coat ? 1 - ref_dielectric(sqrt(1 + (double)p->eta2_minus_1), leant) : 1;
}

/* |h| / 2, the cosine between h and either direction. */
static double half_cosine(const lc_point *p, double x, double y, double z)
{
    return fmin(sqrt((double)p->square[0] * x * x + (double)p->square[1] * y * y + z * z) / 2, 1);
}

static double emission_of(const lc_light *l, const terms *t)
{
    if (l->kind == LC_LIGHT_LUMINAIRE) return table_at(profile_of(l), t->angle[0], t->angle[1]);
    return emission(l, t->cos_e) * t->shine.exact;
}

void ref_transfer(const lc_point *p, const lc_light *l, double mg[3])
{
    terms t = light_terms(p, l);
    if (p->lobe == LC_LOBE_PHASE) {
        ref_phase_transfer(p, t.cos_r, emission_of(l, &t) * t.inv_f, mg);
        return;
    }
    double pm = p->lobe == LC_LOBE_PHONG        ? pow(clamp(t.cos_m, 0, 1), (double)p->exponent)
                : p->lobe == LC_LOBE_WARD       ? ward(t.h[0], t.h[1], t.h[2], fmin(t.cos_r, 1))
                : p->lobe == LC_LOBE_OREN_NAYAR ? oren_nayar(p, t.i[0], t.cos_r)
                : p->lobe == LC_LOBE_ROUND      ? round_lobe(p, t.sin_r, fmin(t.cos_r, 1))
                                                : 0;
    for (int c = 0; c < 3; c++) {
        double lobe = (double)p->specular[c] * pm, c_h = half_cosine(p, t.h[0], t.h[1], t.h[2]);
        /* the cosine of o is no less, for the quotients */
        if (p->lobe == LC_LOBE_GGX)
            lobe = t.cos_r > 0 ? fresnel(p, c, c_h) * ggx(p, t.i, fmax((double)p->view[2], 1e-12)) : 0;
        mg[c] = combine(p, c, fmin(t.cos_r, 1), coat_in(p, t.cos_r), lobe, fmin(emission_of(l, &t), 1),
                        t.inv_f);
    }
}

/* Error of one cosine in float. v_k = fl(y_k - x_k) is one rounding: relative U each. A dot product of three
 * terms adds U for the product and 2 U for the sums, so n.v is off by at most 4 U sum|n_k v_k| <= 4 U |v|.
 * |v|: squares (2 + 1) U, sums 2 U, halved by the root, plus its own rounding: 3.5 U; the quotient or a
 * reciprocal and a product 2 U; a direction that is unit to within rounding 2 U: 7.5 U relative, rounded to 8
 * U. */
static double cos_error(double c) { return 4 * U + 8 * U * fabs(c); }

/* The rest is relative. f: d2 5 U, two products and two sums 4 U, reciprocal 1 U: 10 U. Power 2 U (one ulp),
 * sum of lobes and products with specular, cosines, 1/f: 1 + 1 + 3 U. 17 U, rounded to 18 U; second order
 * terms are below 1e-12. Gradual underflow: a partial product is off by 2^-149, times the factors still to
 * come: at most rho, 1/f or their product with another denormal; the power may flush below 2^-126. */
/* The same for Ward: x of h is off by cos_error of a tangent of that length and the rounding of a sum;
 * exponent, the exponential and what stands before it by 6 + 3 U, beside what has been counted. */
static void ward_range(const terms *t, double er, double *lo, double *hi)
{
    double near[2], far[2], ez = cos_error(1) + 2 * U * fabs(t->h[2]);
    for (int k = 0; k < 2; k++) {
        double x = fabs(t->h[k]), e = t->sharp[k] * cos_error(1) + 2 * U * x;
        near[k] = fmax(x - e, 0) * (1 - 4 * U);
        far[k] = (x + e) * (1 + 4 * U);
    }
    *lo = ward(far[0], far[1], t->h[2] - ez, t->cos_r - er) * (1 - 6 * U);
    *hi = ward(near[0], near[1], t->h[2] + ez, t->cos_r + er) * (1 + 6 * U);
}

/* GGX: a conductor's N = sqrt(N^2) where terms of N^2 of size s cancel is off by the lesser of s 3U / |N| and
 * its root; that moves its reflectance by 4 c / (c^2 + |N|^2) of it, s and p alike. */
static double conductor_error(const lc_point *p, int channel, double c)
{
    double real = (double)p->n2_real_minus_1[channel], t = real + c * c;
    double n2 = hypot(t, (double)p->n2_imag[channel]);
    double e = 3 * U * (fabs(real) + c * c);
    return 8 * c / (c * c + n2) * fmin(e / sqrt(n2), sqrt(e)) + 64 * U;
}

static void fresnel_range(const lc_point *p, int channel, double c0, double c1, double *lo, double *hi)
{
    double a = fresnel(p, channel, c0), b = fresnel(p, channel, c1), s = (double)p->specular[channel], e = 0;
    if (p->fresnel == LC_FRESNEL_DIELECTRIC) e = s * 32 * U;
    if (p->fresnel == LC_FRESNEL_CONDUCTOR) /* neither rises nor falls: as much again */
        e = fabs(a - b) + s * fmax(conductor_error(p, channel, c0), conductor_error(p, channel, c1));
    *lo = fmax(fmin(a, b) - e, 0);
    *hi = fmax(a, b) + e;
    /* Schlick's power may be left out */
    if (p->fresnel == LC_FRESNEL_SCHLICK && pow(1 - c1, 5) < 2 * (double)LC_MIN_LOBE) *lo = fmin(*lo, s);
}

/* Of the fraction r = (ax^2 x^2 + ay^2 y^2 + z^2) / (x^2 + y^2 + z^2), h by tangents over roughness: monotone
 * in each of the squares, so least and greatest at corners. What is left is relative: r 9 U, twice, and two
 * more quotients and a root: 30 U. */
static void ggx_range(const lc_point *p, const terms *t, double er, double lo[3], double hi[3])
{
    double a2[2] = { (double)p->square[0], (double)p->square[1] }, h[2][3], s[2], r0 = 1, r1 = 0, i[2][2];
    double ez = cos_error(1) + 2 * U * fabs(t->h[2]),
           ci[2] = { fmax(t->cos_r - er, (double)LC_MIN_COS / 2), t->cos_r + er };
    if (ci[1] <= (double)LC_MIN_COS) ci[1] = (double)LC_MIN_COS;
    for (int k = 0; k < 2; k++) {
        double e = t->sharp[k] * cos_error(1), x = fabs(t->h[k]);
        h[0][k] = fmax(x - e - 2 * U * x, 0);
        h[1][k] = x + e + 2 * U * x;
        i[0][k] = fmax(fabs(t->i[k]) - e, 0);
        i[1][k] = fabs(t->i[k]) + e;
    }
    h[0][2] = fmax(t->h[2] - ez, (double)LC_MIN_COS / 2);
    h[1][2] = fmax(t->h[2] + ez, h[0][2]);
    for (int corner = 0; corner < 8; corner++) {
        double x = h[corner & 1][0], y = h[corner >> 1 & 1][1], z = h[corner >> 2][2];
        double r = (a2[0] * x * x + a2[1] * y * y + z * z) / (x * x + y * y + z * z);
        r0 = fmin(r0, r);
        r1 = fmax(r1, r);
    }
    for (int k = 0; k < 2; k++)
        s[k] = sqrt(pow(a2[0] * i[k][0], 2) + pow(a2[1] * i[k][1], 2) + ci[k] * ci[k]);
    double o_s = (double)p->masking, o_n = (double)p->view[2];
    double least = r0 * r0 / (o_s * ci[1] + o_n * s[1]) * (1 - 30 * U),
           most = r1 * r1 / (o_s * ci[0] + o_n * s[0]) * (1 + 30 * U);
    double c0 = half_cosine(p, h[0][0], h[0][1], h[0][2]) * (1 - 5 * U),
           c1 = half_cosine(p, h[1][0], h[1][1], h[1][2]) * (1 + 5 * U);
    for (int c = 0; c < 3; c++) {
        fresnel_range(p, c, c0, fmin(c1, 1), &lo[c], &hi[c]);
        lo[c] *= least;
        hi[c] *= most;
    }
}

/* The same by i.t sin(o) / max(ci, co), whose errors are plain; i.t off by cos_error, six operations. */
static void oren_nayar_range(const lc_point *p, const terms *t, double er, double *lo, double *hi)
{
    double et = cos_error(1), s = (double)p->view[0], co = (double)p->view[2];
    *lo = fmax(t->i[0] - et, 0) * s / fmax(t->cos_r + er, co) * (1 - 6 * U);
    *hi = fmax(t->i[0] + et, 0) * s / fmax(t->cos_r - er, co) * (1 + 6 * U);
}

void ref_transfer_range(const lc_point *p, const lc_light *l, double lo[3], double hi[3])
{
    terms t = light_terms(p, l);
    double er = cos_error(t.cos_r), em = cos_error(t.cos_m),
           ee = lc_is_aimed(l->kind) ? cos_error(t.cos_e) : 0;
    /* A spot's quotient and smooth step are six operations more, the quotient's errors counted twice: 12 U */
    double spot = l->kind == LC_LIGHT_SPOT ? 12 * U : 0;
    double e_lo = emission(l, fmin(t.cos_e, 1) - ee) * (1 - spot) * t.shine.lo,
           e_hi = emission(l, t.cos_e + ee) * (1 + spot) * t.shine.hi;
    if (l->kind == LC_LIGHT_LUMINAIRE) table_range(l, t.angle, &e_lo, &e_hi);
    if (p->lobe == LC_LOBE_PHASE) {
        const double e[2] = { ref_apart(p, l) ? e_lo : 0, e_hi };
        ref_phase_range(p, t.cos_r, er, e, t.inv_f, lo, hi);
        return;
    }
    double n = (double)p->exponent, pm_lo = 0, pm_hi = 0, gloss_lo[3], gloss_hi[3];
    if (p->lobe == LC_LOBE_WARD) ward_range(&t, er, &pm_lo, &pm_hi);
    if (p->lobe == LC_LOBE_PHONG) {
        /* 0^0 is 1 in C, 0 for a function that tests for cos <= 0 first: both are allowed */
        pm_lo = t.cos_m - em > 0 ? pow(fmin(t.cos_m - em, 1), n) : 0;
        pm_hi = pow(fmax(t.cos_m + em, 0), n);
    }
    if (p->lobe == LC_LOBE_OREN_NAYAR) oren_nayar_range(p, &t, er, &pm_lo, &pm_hi);
    if (p->lobe == LC_LOBE_ROUND) { /* parts of n x d are off by 4 U each; over the cosine that multiplies */
        pm_lo = round_lobe(p, fmax(t.sin_r - 16 * U, 0), fmin(t.cos_r, 1) - er) * (1 - 4 * U);
        pm_hi = round_lobe(p, t.sin_r + 16 * U, t.cos_r + er) * (1 + 4 * U);
    }
    /* Ward's limit is for the exponential alone */
    double least = (double)LC_MIN_LOBE * (1 + 1e-6) /
                   (p->lobe == LC_LOBE_WARD ? sqrt((double)LC_WARD_MIN_COS) : 1);
    if (pm_lo < least) pm_lo = 0;
    for (int c = 0; c < 3; c++) {
        gloss_lo[c] = (double)p->specular[c] * pm_lo;
        gloss_hi[c] = (double)p->specular[c] * pm_hi;
    }
    if (p->lobe == LC_LOBE_GGX) ggx_range(p, &t, er, gloss_lo, gloss_hi);
    double in_lo = coat_in(p, t.cos_r - er) * (1 - 32 * U),
           in_hi = p->coat ? coat_in(p, t.cos_r + er) * (1 + 32 * U) : 1;
    if (!p->coat) in_lo = 1;
    for (int c = 0; c < 3; c++) {
        double rho = (double)p->diffuse[c] + gloss_hi[c];
        double tiny = 0x1p-147 * (rho + t.inv_f + 1) + 0x1p-126 * (double)p->specular[c] * t.inv_f;
        lo[c] = combine(p, c, fmin(t.cos_r, 1) - er, in_lo, gloss_lo[c], e_lo, t.inv_f) * (1 - 18 * U) - tiny;
        hi[c] = combine(p, c, t.cos_r + er, in_hi, gloss_hi[c], e_hi, t.inv_f) * (1 + 18 * U) + tiny;
        if (lo[c] < 0 || t.inv_f < 0x1p-127) lo[c] = 0; /* f is inf in float, 1/f is 0 */
        /* The estimate's own definition (point.h): 0 at grazing cosines and where it is tiny, capped. */
        bool grazing = t.cos_r - er <= (double)LC_MIN_COS || e_lo <= (double)LC_MIN_COS;
        if (grazing || lo[c] < (double)LC_MIN_TRANSFER * (1 + 1e-6)) lo[c] = 0;
        lo[c] = fmin(lo[c], (double)LC_MAX_TRANSFER * (1 - 1e-6));
    }
}

double ref_cluster_sum(const lc_point *p, const lc_light *lights, uint32_t members)
{
    double sum = 0;
    for (uint32_t i = 0; i < 32; i++) {
        if (!(members >> i & 1)) continue;
        double mg[3], in[3];
        ref_transfer(p, &lights[i], mg);
        load_f3(in, lights[i].intensity);
        for (int c = 0; c < 3; c++) mg[c] *= in[c];
        sum += ref_luminance(mg);
    }
    return sum;
}

/* ---- bounds ---- */

/* Some orthonormal frame with z = axis. */
static void make_frame(double f[3][3], const double axis[3])
{
    double len = sqrt(dot3(axis, axis));
    for (int k = 0; k < 3; k++) f[2][k] = axis[k] / len;
    const double *z = f[2];
    int small = fabs(z[0]) < fabs(z[1]) ? 0 : 1;
    if (fabs(z[2]) < fabs(z[small])) small = 2;
    double e[3] = { 0, 0, 0 };
    e[small] = 1;
    double *x = f[0], *y = f[1];
    x[0] = e[1] * z[2] - e[2] * z[1];
    x[1] = e[2] * z[0] - e[0] * z[2];
    x[2] = e[0] * z[1] - e[1] * z[0];
    len = sqrt(dot3(x, x));
    for (int k = 0; k < 3; k++) x[k] /= len;
    y[0] = z[1] * x[2] - z[2] * x[1];
    y[1] = z[2] * x[0] - z[0] * x[2];
    y[2] = z[0] * x[1] - z[1] * x[0];
}

/* Rotates the 8 corners into the frame and boxes them. */
static void rotate_box(const double f[3][3], const double lo[3], const double hi[3], double rlo[3],
                       double rhi[3])
{
    for (int k = 0; k < 3; k++) {
        rlo[k] = HUGE_VAL;
        rhi[k] = -HUGE_VAL;
    }
    for (int corner = 0; corner < 8; corner++) {
        double q[3];
        for (int k = 0; k < 3; k++) q[k] = corner >> k & 1 ? hi[k] : lo[k];
        for (int k = 0; k < 3; k++) {
            double t = dot3(f[k], q);
            rlo[k] = fmin(rlo[k], t);
            rhi[k] = fmax(rhi[k], t);
        }
    }
}

static double min_square(double lo, double hi) { return lo > 0 ? lo * lo : hi < 0 ? hi * hi : 0; }
static double max_square(double lo, double hi) { return fmax(lo * lo, hi * hi); }

double ref_cos_box(const double lo[3], const double hi[3], const double axis[3])
{
    double f[3][3], rlo[3], rhi[3];
    make_frame(f, axis);
    rotate_box(f, lo, hi, rlo, rhi);
    double z = rhi[2];
    if (z == 0) return 0; /* all in z <= 0 */
    double t2 = z > 0 ? min_square(rlo[0], rhi[0]) + min_square(rlo[1], rhi[1])
                      : max_square(rlo[0], rhi[0]) + max_square(rlo[1], rhi[1]);
    return clamp(z / sqrt(t2 + z * z), -1, 1);
}

double ref_cone(const double lo[3], const double hi[3], double axis[3])
{
    double c2 = 0, r2 = 0;
    for (int k = 0; k < 3; k++) {
        axis[k] = lo[k] + hi[k];
        c2 += axis[k] * axis[k];
        r2 += (hi[k] - lo[k]) * (hi[k] - lo[k]);
    }
    double c = sqrt(c2);
    if (c2 < 0.01) {
        axis[0] = axis[1] = 0;
        axis[2] = 1;
        return -1;
    }
    for (int k = 0; k < 3; k++) axis[k] /= c;
    return clamp((c2 + 4 - r2) / (4 * c), -1, 1);
}

/* Maximum of cos(theta) / d^2 over the box of v, n the normal: both factors are taken at one and the same
 * point, so this is never above the product of their separate maxima. */
static double joint_bound(const double lo[3], const double hi[3], const double n[3])
{
    double f[3][3], rlo[3], rhi[3];
    make_frame(f, n);
    rotate_box(f, lo, hi, rlo, rhi);
    double h0 = fmax(rlo[2], 0), h1 = rhi[2];
    if (h1 <= 0) return 0;
    double r2 = min_square(rlo[0], rhi[0]) + min_square(rlo[1], rhi[1]);
    double h = clamp(sqrt(r2 / 2), h0, h1), p2 = h * h + r2;
    return p2 > 0 ? h / (p2 * sqrt(p2)) : HUGE_VAL;
}

/* Boxes of the members. v: y - x, or the unit direction towards the light; e: unit emission direction. */
typedef struct ref_cluster {
    double vlo[3], vhi[3], elo[3], ehi[3], atten[3], power[3], spot[2];
    uint32_t profiles; /* bits */
    lc_light_kind kind;
} ref_cluster;

static void gather(ref_cluster *c, const lc_point *p, const lc_light *lights, uint32_t members)
{
    for (int k = 0; k < 3; k++) {
        c->vlo[k] = c->elo[k] = c->atten[k] = HUGE_VAL;
        c->vhi[k] = c->ehi[k] = -HUGE_VAL;
        c->power[k] = 0;
    }
    c->spot[0] = c->spot[1] = 1;
    c->profiles = 0;
    for (uint32_t i = 0; i < 32; i++) {
        if (!(members >> i & 1)) continue;
        const lc_light *l = &lights[i];
        c->kind = l->kind;
        double x[3], y[3], dir[3], in[3], atten[3];
        load(x, p->pos);
        load_f3(y, l->pos);
        load_f3(dir, l->dir);
        load_f3(in, l->intensity);
        load_atten(atten, l);
        if (l->kind == LC_LIGHT_SPOT) {
            c->spot[0] = fmin(c->spot[0], (double)l->spot.cos_total);
            c->spot[1] = fmin(c->spot[1], (double)l->spot.cos_start);
        }
        if (l->kind == LC_LIGHT_LUMINAIRE) c->profiles |= 1u << (l->luminaire.profile & 31);
        for (int k = 0; k < 3; k++) {
            double v = lc_is_far(l->kind) ? -dir[k] : y[k] - x[k];
            double r = ref_sky_half(l);
            c->vlo[k] = fmin(c->vlo[k], v - r);
            c->vhi[k] = fmax(c->vhi[k], v + r);
            c->elo[k] = fmin(c->elo[k], dir[k]);
            c->ehi[k] = fmax(c->ehi[k], dir[k]);
            c->atten[k] = fmin(c->atten[k], atten[k]);
            c->power[k] += in[k];
        }
    }
}

/* Figure 2: the box of x - y_i about the axis of the cone of emission directions. */
static double emission_bound(const ref_cluster *c)
{
    double axis[3], lo[3], hi[3];
    double cos_cone = ref_cone(c->elo, c->ehi, axis);
    if (cos_cone <= -1) return 1;
    for (int k = 0; k < 3; k++) {
        lo[k] = -c->vhi[k];
        hi[k] = -c->vlo[k];
    }
    double theta = acos(ref_cos_box(lo, hi, axis)), beta = acos(cos_cone);
    return theta <= beta ? 1 : cos(theta - beta);
}

/* Greatest value of the members' tables in the range of polar angles that the boxes of positions and
 * directions leave. */
static double luminaire_bound(const ref_cluster *c)
{
    double axis[3], back[3], lo[3], hi[3], cone = ref_cone(c->elo, c->ehi, axis), from = 0, to = 180,
                                           most = 0;
    for (int k = 0; k < 3; k++) {
        lo[k] = -c->vhi[k];
        hi[k] = -c->vlo[k];
        back[k] = -axis[k];
    }
    if (cone > -1) {
        from = fmax(acos(ref_cos_box(lo, hi, axis)) - acos(cone), 0) * 180 / LC_PI;
        to = 180 - fmax(acos(ref_cos_box(lo, hi, back)) - acos(cone), 0) * 180 / LC_PI;
    }
    for (uint32_t id = 0; id < profiles->n; id++) {
        const lc_profile *p = &profiles->item[id];
        for (uint32_t i = 0; i < p->n_azimuth && c->profiles >> id & 1; i++) {
            double azimuth = (double)p->azimuth[i];
            most = fmax(most, fmax(table_at(p, azimuth, from), table_at(p, azimuth, to)));
            for (uint32_t j = 0; j < p->n_polar; j++)
                if ((double)p->polar[j] >= from && (double)p->polar[j] <= to)
                    most = fmax(most, table_at(p, azimuth, (double)p->polar[j]));
        }
    }
    return most;
}

/* Range of x / sqrt(x^2 + y^2) where x is in x0..x1 and y^2 in y0..y1. */
static void ratio_range(double x0, double x1, double y0, double y1, double *lo, double *hi)
{
    double below = x0 * x0 + (x0 < 0 ? y0 : y1), above = x1 * x1 + (x1 > 0 ? y0 : y1);
    *lo = below > 0 ? x0 / sqrt(below) : x0 < 0 ? -1 : 0;
    *hi = above > 0 ? x1 / sqrt(above) : x1 > 0 ? 1 : 0;
}

/* [Walter05b]: greatest n.h over the box of v, in the frame with z = o and n in the plane of x and z. */
static double max_half_cosine(const double lo[3], const double hi[3], const double n[3], const double o[3])
{
    double f[3][3], rlo[3], rhi[3], cos_n = clamp(dot3(n, o), 0, 1), sin_n = 0, cp, unused, clo, chi;
    make_frame(f, o);
    double x[3];
    for (int k = 0; k < 3; k++) x[k] = n[k] - dot3(n, f[2]) * f[2][k];
    sin_n = sqrt(dot3(x, x));
    if (sin_n > 1e-9) {
        for (int k = 0; k < 3; k++) f[0][k] = x[k] / sin_n;
        const double *z = f[2], *u = f[0];
        f[1][0] = z[1] * u[2] - z[2] * u[1];
        f[1][1] = z[2] * u[0] - z[0] * u[2];
        f[1][2] = z[0] * u[1] - z[1] * u[0];
    }
    rotate_box(f, lo, hi, rlo, rhi);
    double y0 = min_square(rlo[1], rhi[1]), y1 = max_square(rlo[1], rhi[1]);
    ratio_range(rlo[0], rhi[0], y0, y1, &unused, &cp);
    ratio_range(rlo[2], rhi[2], min_square(rlo[0], rhi[0]) + y0, max_square(rlo[0], rhi[0]) + y1, &clo, &chi);
    double hmin = sqrt(fmax(1 + clo, 0) / 2), hmax = sqrt((1 + chi) / 2);
    double ch = cp >= 0 ? sqrt(cos_n * cos_n / (cos_n * cos_n + sin_n * sin_n * cp * cp)) : 1;
    if (!(ch >= 0)) ch = 1; /* 0 / 0 */
    ch = clamp(ch, hmin, hmax);
    return fmin(sin_n * sqrt(fmax(1 - ch * ch, 0)) * cp + cos_n * ch, 1);
}

/* o, and the lengths of the tangents. */
static void viewer(const lc_point *p, const double n[3], double o[3], double sharp[2])
{
    for (int k = 0; k < 3; k++) o[k] = (double)p->view[2] * n[k];
    for (int t = 0; t < 2; t++) {
        double a[3];
        load(a, p->tangent[t]);
        sharp[t] = sqrt(dot3(a, a));
        for (int k = 0; k < 3; k++) o[k] += (double)p->view[t] * a[k] / (sharp[t] * sharp[t]);
    }
}

/* Greatest value of ward() by max_half_cosine, the larger roughness, and the greatest cosine. */
static double ward_bound(const lc_point *p, const ref_cluster *c, const double n[3], double cos_r)
{
    double o[3], sharp[2];
    viewer(p, n, o, sharp);
    double m = max_half_cosine(c->vlo, c->vhi, n, o), least = fmin(sharp[0], sharp[1]);
    if (m <= 0) return 0;
    return exp(-(1 - m * m) / (m * m) * least * least) / sqrt(fmax(cos_r, (double)LC_WARD_MIN_COS));
}

/* Greatest lobe times cos_r: F D G / (4 n.o) with D's bracket by the larger roughness, G by masking alone or
 * shadowing alone by the smaller, F at the greatest angle between the directions; conductors: 1. */
static void ggx_bound(const lc_point *p, const ref_cluster *c, const double n[3], double cos_r,
                      double lobe[3])
{
    double o[3], sharp[2], back[3], x2 = (double)p->square[0], y2 = (double)p->square[1], a2 = fmax(x2, y2),
                                    b2 = fmin(x2, y2);
    viewer(p, n, o, sharp);
    for (int k = 0; k < 3; k++) back[k] = -o[k];
    /* e >= 1 / (a2 r). */
    double m = fmax(max_half_cosine(c->vlo, c->vhi, n, o), 0), r = 1 / ((1 - m * m) / a2 + m * m) / a2;
    double o_n = (double)p->view[2], cr = fmin(cos_r, 1),
           g1 = 2 / (1 + sqrt(1 + b2 * (1 - cr * cr) / (cr * cr)));
    double geometry = fmin(1 / (o_n + (double)p->masking), o_n > 0 ? g1 / (2 * o_n) : HUGE_VAL);
    double hd = sqrt((1 - ref_cos_box(c->vlo, c->vhi, back)) / 2);
    for (int k = 0; k < 3; k++) {
        double f = p->fresnel == LC_FRESNEL_CONDUCTOR ? (double)p->specular[k] : fresnel(p, k, hd);
        lobe[k] = f * a2 * a2 * r * r * geometry;
    }
}

double ref_cluster_bound(const lc_point *p, const lc_light *lights, uint32_t members, bool joint)
{
    ref_cluster c;
    gather(&c, p, lights, members);
    double n[3], m[3], rho[3], gloss[3], d2 = 0;
    load(n, p->n);
    load(m, p->mirror);
    /* n and mirror are unit to within rounding: their lengths are part of what ref_transfer computes */
    double len_n = sqrt(dot3(n, n)), len_m = sqrt(dot3(m, m));
    double cos_r = fmax(ref_cos_box(c.vlo, c.vhi, n), 0) * len_n;
    double cos_m = p->lobe == LC_LOBE_PHONG ? fmin(fmax(ref_cos_box(c.vlo, c.vhi, m), 0) * len_m, 1) : 0;
    double pm = p->lobe == LC_LOBE_PHONG ? pow(cos_m, (double)p->exponent) : 0;
    /* Not with the joint bound: another cosine. */
    double pw = p->lobe == LC_LOBE_WARD ? ward_bound(p, &c, n, cos_r) : 0;
    for (int k = 0; k < 3; k++) gloss[k] = (double)p->specular[k] * pw * cos_r;
    if (p->lobe == LC_LOBE_GGX && cos_r > 0) ggx_bound(p, &c, n, cos_r, gloss);
    if (p->lobe == LC_LOBE_OREN_NAYAR) {
        double t[3];
        load(t, p->tangent[0]);
        double share = fmax(ref_cos_box(c.vlo, c.vhi, t), 0) * fmin(1, cos_r / (double)p->view[2]);
        for (int k = 0; k < 3; k++) gloss[k] = (double)p->specular[k] * (double)p->view[0] * share;
    }
    if (p->lobe == LC_LOBE_ROUND) {
        const double back[3] = { -n[0], -n[1], -n[2] },
                     low = p->exponent > 0 ? fmin(ref_cos_box(c.vlo, c.vhi, back), 0) : 0;
        for (int k = 0; k < 3; k++) gloss[k] = (double)p->specular[k] * sqrt(1 - low * low);
    }
    for (int k = 0; k < 3; k++) {
        rho[k] = ((double)p->diffuse[k] * coat_in(p, cos_r) + (double)p->specular[k] * pm) * c.power[k];
        gloss[k] *= c.power[k];
    }
    if (p->lobe == LC_LOBE_PHASE) { /* no horizon */
        const double way = p->view[2] > 0 ? -1 : 1, to[3] = { way * n[0], way * n[1], way * n[2] };
        ref_phase_transfer(p, way * ref_cos_box(c.vlo, c.vhi, to), 1, gloss);
        for (int k = 0; k < 3; k++) gloss[k] *= c.power[k];
        cos_r = 1;
    }
    double material = ref_luminance(rho), lobe = ref_luminance(gloss);
    if (material + lobe <= 0 || cos_r <= 0) return 0;
    if (lc_is_far(c.kind)) return material * cos_r + lobe;
    for (int k = 0; k < 3; k++) d2 += min_square(c.vlo[k], c.vhi[k]);
    double inv_f = 1 / falloff(c.atten, fmax(d2, (double)p->min_d2)), separate = cos_r * inv_f,
           geometry = separate;
    if (joint && c.atten[2] > 0) geometry = fmin(geometry, len_n * joint_bound(c.vlo, c.vhi, n) / c.atten[2]);
    double cos_e = lc_is_aimed(c.kind) ? emission_bound(&c) : 1;
    if (c.kind == LC_LIGHT_SPOT) cos_e = profile(c.spot[0], c.spot[1], cos_e);
    if (c.kind == LC_LIGHT_LUMINAIRE) cos_e = luminaire_bound(&c);
    return cos_e > 0 ? (material * geometry + lobe * inv_f) * cos_e : 0;
}
