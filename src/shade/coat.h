/* coat.h - the diffuse surface below a dielectric coat. */
#ifndef LC_COAT_H
#define LC_COAT_H

#include "shade/material.h"

/* kd A / (eta^2 (1 - kd Fi)): times T of both directions over pi it is the coat's diffuse part. */
lc_f3 lc_coat_below(const lc_material *m);
/* Fraction of light from a direction of cosine cos_i that leaves again after scattering below the coat. */
lc_f3 lc_coat_albedo(const lc_material *m, float cos_i);

#endif
