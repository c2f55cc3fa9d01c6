/* motion.c - see motion.h. A linear map is a rotation after a stretch, M = R S, which is found by taking the
 * mean of a matrix and its inverse transpose again and again (the polar decomposition). */
#include "base/motion.h"

#include "base/fmath.h"

#include <string.h>

#define MAX_STEPS 64     /* each but the first few doubles the digits */
#define CONVERGED 1e-14
#define ALIKE (1 - 1e-9) /* cosine of half the angle between rotations: above, they are mixed evenly */

typedef struct {
    double w, v[3];
} quaternion;

/* The inverse transpose of the linear part. False if that is singular. */
static bool inverse_transpose(const lc_xform *a, lc_xform *out)
{
    lc_xform inverse;
    if (!lc_xform_invert(a, &inverse)) return false;
    *out = lc_xform_identity();
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) out->m[4 * i + j] = inverse.m[4 * j + i];
    return lc_xform_finite(out);
}

/* r: the rotation, with a mirroring where there is one; s: the stretch, so that the linear part is r s. */
static bool polar(const lc_xform *m, lc_xform *r, lc_xform *s)
{
    lc_xform linear = *m, other, back = lc_xform_identity();
    linear.m[3] = linear.m[7] = linear.m[11] = 0;
    *r = linear;
    double change = 1;
    for (int step = 0; step < MAX_STEPS && change > CONVERGED; step++) {
        if (!inverse_transpose(r, &other)) return false;
        change = 0;
        for (int i = 0; i < 12; i++) {
            const double mean = (r->m[i] + other.m[i]) / 2;
            change = fmax(change, fabs(mean - r->m[i]));
            r->m[i] = mean;
        }
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) back.m[4 * i + j] = r->m[4 * j + i];
    *s = lc_xform_mul(&back, &linear);
    return lc_xform_finite(r) && lc_xform_finite(s);
}

/* From a rotation matrix, by its largest component. */
static quaternion quaternion_of(const lc_xform *r)
{
    const double *m = r->m, trace = m[0] + m[5] + m[10];
    quaternion q;
    if (trace > 0) {
        const double s = sqrt(trace + 1);
        q.w = s / 2;
        q.v[0] = (m[9] - m[6]) / (2 * s);
        q.v[1] = (m[2] - m[8]) / (2 * s);
        q.v[2] = (m[4] - m[1]) / (2 * s);
        return q;
    }
    const int larger = m[5] > m[0] ? 1 : 0, i = m[10] > m[5 * larger] ? 2 : larger, j = (i + 1) % 3,
              k = 3 - i - j;
    const double s = sqrt(fmax(m[5 * i] - m[5 * j] - m[5 * k] + 1, 1e-300));
    q.w = (m[4 * k + j] - m[4 * j + k]) / (2 * s);
    q.v[i] = s / 2;
    q.v[j] = (m[4 * j + i] + m[4 * i + j]) / (2 * s);
    q.v[k] = (m[4 * k + i] + m[4 * i + k]) / (2 * s);
    return q;
}

static lc_xform matrix_of(const quaternion *q)
{
    lc_xform r = lc_xform_identity();
    const double w = q->w, x = q->v[0], y = q->v[1], z = q->v[2];
    const double m[9] = { 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
                          2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                          2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y) };
    for (int i = 0; i < 9; i++) r.m[i / 3 * 4 + i % 3] = m[i];
    return r;
}

static quaternion mix(const quaternion *a, const quaternion *b, double of_a, double of_b)
{
    quaternion q = { of_a * a->w + of_b * b->w, { 0, 0, 0 } };
    double sum = q.w * q.w;
    for (int k = 0; k < 3; k++) {
        q.v[k] = of_a * a->v[k] + of_b * b->v[k];
        sum += q.v[k] * q.v[k];
    }
    const double scale = 1 / sqrt(sum);
    q.w *= scale;
    for (int k = 0; k < 3; k++) q.v[k] *= scale;
    return q;
}

/* Along the shorter way. */
static quaternion slerp(const quaternion *a, quaternion b, double t)
{
    double c = a->w * b.w + a->v[0] * b.v[0] + a->v[1] * b.v[1] + a->v[2] * b.v[2];
    if (c < 0) {
        b = (quaternion){ -b.w, { -b.v[0], -b.v[1], -b.v[2] } };
        c = -c;
    }
    if (c > ALIKE) return mix(a, &b, 1 - t, t);
    const double angle = lc_atan2(sqrt(1 - c * c), c) * (180 / LC_PI);
    double of_a, of_b, unused;
    lc_sincos_deg((1 - t) * angle, &of_a, &unused);
    lc_sincos_deg(t * angle, &of_b, &unused);
    return mix(a, &b, of_a, of_b);
}

bool lc_xform_between(const lc_xform *a, const lc_xform *b, double t, lc_xform *out)
{
    lc_xform r[2], s[2];
    *out = t < 1 ? *a : *b;
    if (!(t > 0) || !(t < 1) || !memcmp(a, b, sizeof *a)) return true;
    if (!polar(a, &r[0], &s[0]) || !polar(b, &r[1], &s[1])) return false;
    for (int i = 0; i < 2; i++)
        if (lc_xform_det3(&r[i]) < 0) /* a rotation after a stretch that mirrors */
            for (int k = 0; k < 12; k++) {
                r[i].m[k] = -r[i].m[k];
                s[i].m[k] = -s[i].m[k];
            }
    const quaternion q0 = quaternion_of(&r[0]), q = slerp(&q0, quaternion_of(&r[1]), t);
    lc_xform stretch = lc_xform_identity();
    for (int k = 0; k < 12; k++) stretch.m[k] = (1 - t) * s[0].m[k] + t * s[1].m[k];
    *out = matrix_of(&q);
    *out = lc_xform_mul(out, &stretch);
    for (int k = 3; k < 12; k += 4) out->m[k] = (1 - t) * a->m[k] + t * b->m[k];
    return lc_xform_finite(out);
}
