/* ref_shine.h - how virtual lights shine that stand for a lobe (light_virtual.h), in double precision. */
#ifndef REF_SHINE_H
#define REF_SHINE_H

#include "shade/light.h"

/* The factor on the cosine's emission: exact, and the range that rounding allows. w: unit, towards the light;
 * cos_e: between the light's direction and -w. All 1 where the light has no lobe. */
typedef struct ref_shining {
    double exact, lo, hi;
} ref_shining;

ref_shining ref_shine(const lc_light *l, const double w[3], double cos_e);

#endif
