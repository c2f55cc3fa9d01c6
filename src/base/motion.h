/* motion.h - where something is between two transforms: as in pbrt, its translation and its stretch change
 * evenly and its rotation turns about one axis at an even speed ([Shoemake92]). Computed by + - * / and sqrt,
 * so that its bits are the same on every machine.
 */
#ifndef LC_MOTION_H
#define LC_MOTION_H

#include "base/xform.h"

/* a at t = 0, b at t = 1; both affine and not singular, else false. At the ends, and where a and b are the
 * same, the bits are theirs. */
bool lc_xform_between(const lc_xform *a, const lc_xform *b, double t, lc_xform *out);

#endif
