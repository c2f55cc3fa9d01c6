/* ref_shine.c - see ref_shine.h. */
#include "support/ref_shine.h"

#include "shade/dir_pack.h"

#include <math.h>

#define OFF 0x1p-20 /* of cosines between unit vectors of floats */
#define ROUNDING 0x1p-19 /* of what follows, about 30 operations */

/* r of GGX: |h|^2 over the same stretched by 1 / a across the normal. */
static double stretched(double h2, double z, double a2)
{
    return h2 / (fmax(h2 - z * z, 0) / a2 + z * z);
}

static double smith(double ci, double co, double a2)
{
    co = fmin(co, 1);
    return sqrt(ci * ci + a2 * (1 - ci * ci)) * co + sqrt(co * co + a2 * (1 - co * co)) * ci;
}

ref_shining ref_shine(const lc_light *l, const double w[3], double cos_e)
{
    if (!lc_has_shine(l)) return (ref_shining){ 1, 1, 1 };
    const lc_f3 from = lc_dir_unpack(l->shine.from);
    const double i[3] = { (double)from.x, (double)from.y, (double)from.z },
                 n[3] = { (double)l->dir.x, (double)l->dir.y, (double)l->dir.z },
                 a2 = (double)l->shine.roughness * (double)l->shine.roughness, scale = (double)l->shine.scale,
                 least = (double)LC_SHINE_COS;
    double in = 0, iw = 0;
    for (int k = 0; k < 3; k++) {
        in += i[k] * n[k];
        iw += i[k] * w[k];
    }
    const double co = fmax(cos_e, 0), h2 = fmax(2 - 2 * iw, 0), ci = fmin(fmax(in, least), 1),
                 ci0 = fmin(fmax(in - OFF, least), 1), ci1 = fmin(fmax(in + OFF, least), 1),
                 co0 = fmax(co - OFF, 0), co1 = co + OFF;
    const double r = stretched(h2, ci + co, a2);
    const double near = fmax(h2 - 2 * OFF, 0), far = h2 + 2 * OFF, z0 = ci0 + co0, z1 = ci1 + co1,
                 r_near[2] = { stretched(near, z0, a2), stretched(near, z1, a2) },
                 r_far[2] = { stretched(far, z0, a2), stretched(far, z1, a2) },
                 r0 = fmin(fmin(r_near[0], r_near[1]), fmin(r_far[0], r_far[1])),
                 ends = fmax(fmax(r_near[0], r_near[1]), fmax(r_far[0], r_far[1])),
                 r1 = near < z1 * z1 ? fmax(ends, 1) : ends; /* r is greatest, 1, where h2 is z^2 */
    return (ref_shining){ fmin(scale * r * r / smith(ci, co, a2), 1),
                          fmin(scale * r0 * r0 / smith(ci1, co1, a2) * (1 - ROUNDING), 1),
                          fmin(scale * r1 * r1 / smith(ci0, co0, a2) * (1 + ROUNDING), 1) };
}
