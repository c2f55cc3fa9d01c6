/* point.h - a shading point as the kernels read it, and the limits within which estimates stay.
 *
 * Distance floor. Estimate and bound use d2 = max(|y - x|^2, min_d2) wherever they divide by f(d), so a point
 * on a light gives a finite number; min_d2 is 1e-10 of the squared diagonal of the scene.
 */
#ifndef LC_POINT_H
#define LC_POINT_H

#include "shade/material.h"

/* Estimates are exactly 0 where a cosine is at most LC_MIN_COS or M G of a channel is below LC_MIN_TRANSFER,
 * lobes where cos^n or e^-x is below LC_MIN_LOBE, and M G is at most LC_MAX_TRANSFER: with the limits of
 * light.h nothing that is multiplied or summed is denormal or infinite. */
#define LC_MIN_COS 1e-9f
#define LC_MIN_LOBE 1e-12f
#define LC_MIN_TRANSFER 1e-19f
#define LC_MAX_TRANSFER 1e20f
#define LC_WARD_MIN_COS 0.02f /* under the root of Ward's lobe cosines are no less: see material.h */
#define LC_TINY_PART 1e-20f /* of a complex index, where that is divided by */
#define LC_MIN_REFLECTANCE 1e-10f /* diffuse and specular of lc_point below this are 0 */
/* Squares of lengths below this count as this where a cosine is formed: no division by 0. */
#define LC_TINY_D2 1e-36f

/* What estimate and bound need to know of one shading point. Filled by lc_point_init (shade.h). */
typedef struct lc_point {
    float pos[3];      /* world space */
    float n[3];        /* unit shading normal, on the viewer's side */
    float ng[3];       /* geometric normal, on that side: lights behind are hidden; 0: not known, or n.
                          lc_point_init leaves it 0. */
    float mirror[3];   /* unit, 2 (n.o) n - o, o towards the viewer */
    float diffuse[3];  /* kd / pi */
    float specular[3]; /* Phong: ks (n + 2) / (2 pi); Ward: ks / (4 pi ax ay sqrt(co)); GGX: ks / (2 pi ax ay)
                        */
    float exponent;
    float min_d2;
    lc_lobe lobe;      /* LC_LOBE_NONE where specular is 0, but below a coat */
    /* Ward, GGX: h along these is what is squared. */
    float tangent[2][3]; /* unit tangent over ax, bitangent over ay */
    float view[3];       /* tangent.o, bitangent.o, n.o >= 0 */
    float sharp;         /* no less than the tangents' lengths */
    /* GGX */
    lc_fresnel fresnel;
    bool coat;           /* diffuse lies below it, what passes on the way out counted already */
    float to_view[3];    /* unit, world space, not below the horizon */
    float square[2];     /* ax^2, ay^2 */
    float masking;       /* length of (ax o.x, ay o.y, o.z) */
    float rise[3];       /* Schlick: what specular grows by towards grazing; conductor: eta^2 - k^2 - 1 */
    float turn[3];       /* conductor: 2 eta k */
    float eta2, bend;    /* dielectric, coat: eta^2, eta^2 - 1 */
} lc_point;

#endif
