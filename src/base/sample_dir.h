/* sample_dir.h - points of a disc and directions about an axis, from numbers of the unit square. */
#ifndef LC_SAMPLE_DIR_H
#define LC_SAMPLE_DIR_H

#include "base/vec.h"
#include "base/xform.h"

/* x, y evenly on the unit disc, at the radius sqrt(u[0]). */
static inline void lc_sample_disc(const double u[2], double *x, double *y)
{
    double sine, cosine, r = sqrt(u[0]);
    lc_sincos_deg(360 * u[1], &sine, &cosine);
    *x = r * cosine;
    *y = r * sine;
}

/* x t + y b + z n made unit; n unit, t and b some unit vectors across it and each other ([Duff17]). */
static inline lc_f3 lc_sample_frame(lc_f3 n, double x, double y, double z)
{
    double s = n.z < 0 ? -1 : 1, nx = (double)n.x, ny = (double)n.y, nz = (double)n.z;
    double a = -1 / (s + nz), b = nx * ny * a;
    return lc_f3_normalize_d((1 + s * nx * nx * a) * x + b * y + nx * z,
                             s * b * x + (s + ny * ny * a) * y + ny * z, -s * nx * x - ny * y + nz * z);
}

#endif
