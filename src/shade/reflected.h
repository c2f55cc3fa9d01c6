/* reflected.h - how much light a lobe reflects of all that comes from one direction. */
#ifndef LC_REFLECTED_H
#define LC_REFLECTED_H

#include "shade/material.h"

/* Fraction of light from a direction of cosine cos_i that the lobe alone reflects, in all directions. Of GGX
 * by its roughness, the geometric mean of both: at grazing angles facets turn most of it down or mask it.
 * Else lc_reflectance. */
lc_f3 lc_lobe_reflected(const lc_material *m, float cos_i);

#endif
