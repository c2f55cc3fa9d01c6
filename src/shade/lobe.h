/* lobe.h - what the home of a lobe (lobe_NAME.h) provides, and the table that the rest of the code asks.
 *
 *     #ifdef LC_TABLE_PARTS      for lobe.c alone: its functions, and its line of the table,
 *                                LC_LOBE_INFO_NAME
 *     #ifdef LC_KERNEL_PARTS     for the kernels: NAME_value and NAME_bound
 */
#ifndef LC_LOBE_H
#define LC_LOBE_H

#include "shade/point.h"

typedef struct lc_lobe_info {
    const char *name; /* in explanations */
    /* Sets what the kernels need of a point (unit n and view, n on the viewer's side) and returns the factor
     * of ks in lc_point.specular; changes *kd where the diffuse part lies below the lobe. */
    float (*init)(lc_point *p, lc_f3 n, lc_f3 view, const lc_material *m, lc_f3 *kd);
    /* Fraction of the light from a direction of cosine cos_i that the material reflects, by lobe and diffuse
     * part; R G B, may exceed 1. */
    lc_f3 (*albedo)(const lc_material *m, float cos_i);
    /* Whether the numbers that it alone reads are in range; NULL: it reads none. */
    bool (*check)(const lc_material *m);
} lc_lobe_info;

/* Whether a lobe may be narrow, about the direction of a mirror. */
static inline bool lc_lobe_is_narrow(lc_lobe lobe)
{
    return lobe != LC_LOBE_OREN_NAYAR && lobe != LC_LOBE_ROUND && lobe != LC_LOBE_PHASE;
}

extern const lc_lobe_info lc_lobes[LC_LOBES];

/* Whether all numbers are in the ranges that material.h gives; of those that a lobe does not read, finite. */
bool lc_material_in_range(const lc_material *m);

#endif
