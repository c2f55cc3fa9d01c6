/* coat.h - the diffuse surface below a dielectric coat. */
#ifndef LC_COAT_H
#define LC_COAT_H

#include "shade/material.h"

/* b^2 of the coat: how far its facets lean. 0..0.1. */
float lc_coat_lean(const lc_material *m);
/* kd A B^2 / eta^2 (1 + x + x^2 + ...): times T(c') of both directions over pi it is the coat's diffuse
 * part. */
lc_f3 lc_coat_below(const lc_material *m);
/* Fraction of light from a direction of cosine cos_i that leaves again after scattering below the coat. */
lc_f3 lc_coat_albedo(const lc_material *m, float cos_i);

/* Sets what the coat of index eta.x absorbs, depth >= 0: the optical depth across it along the normal. */
void lc_coat_absorb(lc_material *m, double depth);

#endif
