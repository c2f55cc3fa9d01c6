/* first_cuts.h - the cuts of the first of a pixel's samples that has any, by whose luminance those of the
 * others are limited (lc_cut.alike). A pixel's samples have slots that together are spread evenly; by one
 * limit they end at nearly the same clusters, so that their errors make up for each other. The first sample
 * is one that every part of a picture renders.
 */
#ifndef LC_FIRST_CUTS_H
#define LC_FIRST_CUTS_H

#include "scene/sight.h"

#include <float.h>
#include <math.h>

typedef struct lc_first_cuts {
    uint32_t n; /* lit points of that sample that have their cut */
    uint32_t material[LC_MAX_LIT];
    double luminance[LC_MAX_LIT];
} lc_first_cuts;

/* What the cut of lit point k of another sample is limited by; 0: its own. */
static inline double lc_first_alike(const lc_first_cuts *first, const lc_surface *s, uint32_t k)
{
    return k < first->n && first->material[k] == s->material_id ? fmax(first->luminance[k], DBL_MIN) : 0;
}

/* Takes the next lit point's cut of the first sample. */
static inline void lc_first_add(lc_first_cuts *first, const lc_surface *s, lc_f3 radiance)
{
    first->material[first->n] = s->material_id;
    first->luminance[first->n++] = (double)lc_luminance(radiance);
}

#endif
