/* vec_d.h - vectors of doubles, for references that share nothing with the library's vectors of floats. */
#ifndef VEC_D_H
#define VEC_D_H

#include <math.h>

static inline double dot_d(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double len_d(const double a[3]) { return sqrt(dot_d(a, a)); }

static inline void cross_d(const double a[3], const double b[3], double c[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static inline void normalize_d(double a[3])
{
    double len = len_d(a);
    for (int k = 0; k < 3; k++) a[k] /= len;
}

/* Unit, about the normal +z: its cosine with the normal, and its azimuth. */
static inline void direction_d(double cosine, double azimuth, double out[3])
{
    double sine = sqrt(1 - cosine * cosine);
    out[0] = sine * cos(azimuth);
    out[1] = sine * sin(azimuth);
    out[2] = cosine;
}

#endif
