/* xform.h - 4x4 transforms in double precision, as pbrt's statements build them: row-major, acting on column
 * vectors.
 *
 * Angles are in degrees. Sine and cosine are computed here by + - * / alone, so their bits are the same on
 * every machine, and exact at multiples of 90 degrees.
 */
#ifndef LC_XFORM_H
#define LC_XFORM_H

#include "base/vec.h"

typedef struct lc_xform {
    double m[16];
} lc_xform;

void lc_sincos_deg(double degrees, double *sine, double *cosine);

lc_xform lc_xform_identity(void);
lc_xform lc_xform_mul(const lc_xform *a, const lc_xform *b); /* a b: applies b first */
lc_xform lc_xform_translate(const double t[3]);
lc_xform lc_xform_scale(const double s[3]);
/* A rotation about an axis of any length; false if that is 0. */
bool lc_xform_rotate(double degrees, const double axis[3], lc_xform *out);
/* The world-to-camera transform for v = eye, target, up. False if eye = target or up is parallel to the
 * view. */
bool lc_xform_look_at(const double v[9], lc_xform *out);
bool lc_xform_invert(const lc_xform *a, lc_xform *out); /* false if a is singular */
bool lc_xform_finite(const lc_xform *a);
double lc_xform_det3(const lc_xform *a); /* of the upper left 3x3; negative: a inverts orientation */

/* Transforms a point and divides by w. Results beyond the range of float become infinity or NaN. */
void lc_xform_point(const lc_xform *a, const double p[3], float out[3]);
/* Transforms a direction by the upper left 3x3. */
void lc_xform_vector(const lc_xform *a, const double v[3], double out[3]);
/* The rows of a 3x3 matrix that transforms normals: the inverse transpose times |det(a)|, up to a positive
 * factor. */
void lc_xform_normal_rows(const lc_xform *a, double rows[9]);
void lc_xform_normal(const double rows[9], const float n[3], float out[3]);

#endif
