/* xform.c - transforms, their inverse by Gauss-Jordan elimination, sine and cosine by Taylor series. */
#include "base/xform.h"

#include <string.h>

#define MIN_SINE2 1e-24 /* of the angle between view and up: below a sine of 1e-12 their product is rounding
                         * noise */

void lc_sincos_deg(double degrees, double *sine, double *cosine)
{
    /* Reduce to -45..45 degrees and a quadrant; fmod and the products of the quadrant are exact. */
    double d = fmod(degrees, 360);
    double quadrant = floor(d / 90 + 0.5);
    double x = (d - quadrant * 90) * (LC_PI / 180), x2 = x * x;
    /* Taylor series up to x^17 and x^18: the first omitted term is below 2^-59 at 45 degrees. */
    double s = 1, c = 1;
    for (int k = 17; k >= 3; k -= 2) s = 1 - x2 / (k * (k - 1)) * s;
    for (int k = 18; k >= 2; k -= 2) c = 1 - x2 / (k * (k - 1)) * c;
    s *= x;
    switch ((int)quadrant & 3) {
    case 0:
        *sine = s;
        *cosine = c;
        break;
    case 1:
        *sine = c;
        *cosine = -s;
        break;
    case 2:
        *sine = -s;
        *cosine = -c;
        break;
    default:
        *sine = -c;
        *cosine = s;
    }
}

lc_xform lc_xform_identity(void) { return (lc_xform){ { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 } }; }

lc_xform lc_xform_mul(const lc_xform *a, const lc_xform *b)
{
    lc_xform r;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            double sum = 0;
            for (int k = 0; k < 4; k++) sum += a->m[4 * i + k] * b->m[4 * k + j];
            r.m[4 * i + j] = sum;
        }
    return r;
}

lc_xform lc_xform_translate(const double t[3])
{
    return (lc_xform){ { 1, 0, 0, t[0], 0, 1, 0, t[1], 0, 0, 1, t[2], 0, 0, 0, 1 } };
}

lc_xform lc_xform_scale(const double s[3])
{
    return (lc_xform){ { s[0], 0, 0, 0, 0, s[1], 0, 0, 0, 0, s[2], 0, 0, 0, 0, 1 } };
}

static bool unit(const double v[3], double out[3])
{
    double max = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (!(max > 0) || !isfinite(max)) return false;
    double a = v[0] / max, b = v[1] / max, c = v[2] / max, len = sqrt(a * a + b * b + c * c);
    out[0] = a / len;
    out[1] = b / len;
    out[2] = c / len;
    return true;
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

bool lc_xform_rotate(double degrees, const double axis[3], lc_xform *out)
{
    double a[3], s, c;
    if (!unit(axis, a)) return false;
    lc_sincos_deg(degrees, &s, &c);
    *out = lc_xform_identity();
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) out->m[4 * i + j] = a[i] * a[j] * (1 - c) + (i == j ? c : 0);
    out->m[1] -= a[2] * s;
    out->m[2] += a[1] * s;
    out->m[4] += a[2] * s;
    out->m[6] -= a[0] * s;
    out->m[8] -= a[1] * s;
    out->m[9] += a[0] * s;
    return true;
}

bool lc_xform_look_at(const double v[9], lc_xform *out)
{
    double to[3] = { v[3] - v[0], v[4] - v[1], v[5] - v[2] };
    double dir[3], up[3], side[3], right[3], up2[3];
    if (!unit(to, dir) || !unit(v + 6, up)) return false;
    cross(up, dir, side);
    if (!(dot(side, side) > MIN_SINE2) || !unit(side, right)) return false;
    cross(dir, right, up2);
    const double *rows[3] = { right, up2, dir };
    *out = lc_xform_identity();
    for (int i = 0; i < 3; i++) {
        memcpy(out->m + 4 * i, rows[i], 3 * sizeof(double));
        out->m[4 * i + 3] = -dot(rows[i], v);
    }
    return true;
}

bool lc_xform_invert(const lc_xform *a, lc_xform *out)
{
    lc_xform w = *a, r = lc_xform_identity();
    for (int col = 0; col < 4; col++) {
        int pivot = col;
        for (int i = col + 1; i < 4; i++)
            if (fabs(w.m[4 * i + col]) > fabs(w.m[4 * pivot + col])) pivot = i;
        double p = w.m[4 * pivot + col];
        if (!(fabs(p) > 0)) return false;
        for (int k = 0; k < 4; k++) {
            double t = w.m[4 * col + k], u = r.m[4 * col + k];
            w.m[4 * col + k] = w.m[4 * pivot + k] / p;
            r.m[4 * col + k] = r.m[4 * pivot + k] / p;
            if (pivot != col) {
                w.m[4 * pivot + k] = t;
                r.m[4 * pivot + k] = u;
            }
        }
        for (int i = 0; i < 4; i++) {
            double f = w.m[4 * i + col];
            if (i == col || !(fabs(f) > 0)) continue;
            for (int k = 0; k < 4; k++) {
                w.m[4 * i + k] -= f * w.m[4 * col + k];
                r.m[4 * i + k] -= f * r.m[4 * col + k];
            }
        }
    }
    *out = r;
    return lc_xform_finite(out);
}

bool lc_xform_finite(const lc_xform *a)
{
    for (int i = 0; i < 16; i++)
        if (!isfinite(a->m[i])) return false;
    return true;
}

double lc_xform_det3(const lc_xform *a)
{
    double c[3];
    const double r0[3] = { a->m[0], a->m[1], a->m[2] }, r1[3] = { a->m[4], a->m[5], a->m[6] };
    const double r2[3] = { a->m[8], a->m[9], a->m[10] };
    cross(r1, r2, c);
    return dot(r0, c);
}

/* Converts to float. Beyond the range of float, where C leaves the conversion undefined, the result is
 * infinity. */
static float narrow(double x)
{
    return fabs(x) <= (double)FLT_MAX ? (float)x : x > 0 ? INFINITY : x < 0 ? -INFINITY : NAN;
}

void lc_xform_point(const lc_xform *a, const double p[3], float out[3])
{
    const double *m = a->m;
    double w = m[12] * p[0] + m[13] * p[1] + m[14] * p[2] + m[15];
    for (int i = 0; i < 3; i++) {
        double x = m[4 * i] * p[0] + m[4 * i + 1] * p[1] + m[4 * i + 2] * p[2] + m[4 * i + 3];
        out[i] = narrow(x / w);
    }
}

void lc_xform_vector(const lc_xform *a, const double v[3], double out[3])
{
    for (int i = 0; i < 3; i++) out[i] = a->m[4 * i] * v[0] + a->m[4 * i + 1] * v[1] + a->m[4 * i + 2] * v[2];
}

void lc_xform_normal_rows(const lc_xform *a, double rows[9])
{
    /* Scaling by the largest element keeps the cofactors in range; only directions matter. */
    double max = 0;
    for (int i = 0; i < 11; i++)
        if (i % 4 != 3) max = fmax(max, fabs(a->m[i]));
    double inv = max > 0 ? 1 / max : 0, r[3][3];
    if (!isfinite(inv)) inv = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) r[i][j] = a->m[4 * i + j] * inv;
    cross(r[1], r[2], rows);
    cross(r[2], r[0], rows + 3);
    cross(r[0], r[1], rows + 6);
    if (dot(r[0], rows) < 0)
        for (int i = 0; i < 9; i++) rows[i] = -rows[i];
}

void lc_xform_normal(const double rows[9], const float n[3], float out[3])
{
    double x = (double)n[0], y = (double)n[1], z = (double)n[2];
    for (int k = 0; k < 3; k++) out[k] = (float)(rows[3 * k] * x + rows[3 * k + 1] * y + rows[3 * k + 2] * z);
}
