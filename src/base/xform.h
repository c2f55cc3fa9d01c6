/* xform.h - 4x4 transforms in double precision, as pbrt's statements build them: row-major, column vectors.
 *
 * Angles are in degrees. Sine and cosine are our own: multiples of 90 degrees are exact, and the bits
 * depend on + - * / only.
 */
#ifndef LC_XFORM_H
#define LC_XFORM_H

#include "base/vec.h"

typedef struct lc_xform {
    double m[16];
} lc_xform;

void lc_sincos_deg(double degrees, double *sine, double *cosine);

lc_xform lc_xform_identity(void);
lc_xform lc_xform_mul(const lc_xform *a, const lc_xform *b); /* b first, then a */
lc_xform lc_xform_translate(const double t[3]);
lc_xform lc_xform_scale(const double s[3]);
/* False when the axis is zero. */
bool lc_xform_rotate(double degrees, const double axis[3], lc_xform *out);
/* World to camera; v: eye, target, up. False when eye = target or up is parallel to the view. */
bool lc_xform_look_at(const double v[9], lc_xform *out);
bool lc_xform_invert(const lc_xform *a, lc_xform *out); /* false when singular */
bool lc_xform_finite(const lc_xform *a);
double lc_xform_det3(const lc_xform *a); /* of the upper left 3x3; negative = mirrored */

/* Divides by w where the last row asks for it; what does not fit into float comes out as infinity or NaN. */
void lc_xform_point(const lc_xform *a, const double p[3], float out[3]);
void lc_xform_vector(const lc_xform *a, const double v[3], double out[3]);
/* Rows of the 3x3 that transforms normals: det(a) times the inverse transpose, times the sign of det(a). */
void lc_xform_normal_rows(const lc_xform *a, double rows[9]);
void lc_xform_normal(const double rows[9], const float n[3], float out[3]);

#endif
