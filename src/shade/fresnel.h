/* fresnel.h - share of light that a smooth surface reflects. */
#ifndef LC_FRESNEL_H
#define LC_FRESNEL_H

#include "shade/material.h"

/* Of a boundary to an index eta times as high, from the side of cosine cos_i, 0..1; 1 is total reflection. */
float lc_fresnel_dielectric(float cos_i, float eta);
float lc_fresnel_conductor(float cos_i, float eta, float k);

/* Of a material's ks, per channel. inside: light comes from where the index is eta.x. */
lc_f3 lc_reflectance(const lc_material *m, float cos_i, bool inside);

#endif
