/* shine.h - how virtual lights shine that stand for what a lobe reflects. */
#ifndef LC_SHINE_H
#define LC_SHINE_H

#include "shade/light.h"

/* Sets *shine for light that comes from unit `from` to a surface of unit normal n, and is reflected by a
 * GGX lobe of that roughness, > 0 and at most 1. Returns the intensity along n, W/sr, for each W that the
 * lobe reflects: with it the light has the flux 1. from.n is raised to LC_SHINE_COS. */
float lc_shine_make(lc_shine *shine, float roughness, lc_f3 from, lc_f3 n);

#endif
