/* material.h - reflection parameters.
 *
 * Modified Phong ([Miksik07] eq. 6): f = kd / pi + ks (n + 2) / (2 pi) cos(alpha)^n, alpha between the mirror
 * direction and the direction to the light. ks = 0 is Lambert. A mirror reflects ks of what comes from the one direction.
 */
#ifndef LC_MATERIAL_H
#define LC_MATERIAL_H

#include "vec.h"

/* At a point. */
typedef struct lc_material {
    lc_f3 kd;       /* 0..1 per channel */
    lc_f3 ks;       /* 0..1 per channel */
    float exponent; /* n, 0..LC_MAX_EXPONENT */
    bool mirror;    /* perfect: kd and exponent are 0 and don't count */
} lc_material;

/* Textures that give the values of a material at a point, LC_NONE: the same everywhere. */
typedef struct lc_material_maps {
    uint32_t kd, ks, exponent;
} lc_material_maps;

#define LC_MAX_EXPONENT 1e5f

#endif
