/* fresnel.h - the fraction of light that a smooth surface reflects. */
#ifndef LC_FRESNEL_H
#define LC_FRESNEL_H

#include "shade/material.h"

/* Reflectance of a boundary where the index beyond is eta times the index on this side, for a cosine of 0..1;
 * 1 is total reflection. */
float lc_fresnel_dielectric(float cos_i, float eta);
float lc_fresnel_conductor(float cos_i, float eta, float k);

/* Reflectance of a thin sheet whose surfaces reflect f, with all inner reflections: f + (1 - f)^2 f / (1 -
 * f^2). */
static inline float lc_sheet_reflectance(float f) { return 2 * f / (1 + f); }

/* The fraction of light, per channel, that a boundary of glass transmits; 0 for other materials. cos_i: the
 * cosine on the side of lower index, 0..1. */
lc_f3 lc_transmittance(const lc_material *m, float cos_i);
/* The fraction that such a boundary reflects. */
lc_f3 lc_glass_reflectance(const lc_material *m, float cos_i);

/* ks of a material times its reflectance, per channel. inside: light comes from the side of index eta.x. */
lc_f3 lc_reflectance(const lc_material *m, float cos_i, bool inside);

#endif
