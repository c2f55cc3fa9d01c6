/* likeness.h - how far the light on one surface says what it is on another. */
#ifndef LC_LIKENESS_H
#define LC_LIKENESS_H

#include "scene/sight.h"

/* A surface as a pixel shows it. */
typedef struct lc_face {
    lc_f3 pos, n, ng;
    lc_f3 albedo; /* kd + ks */
    uint32_t material, n_mirrors;
    bool lobed;
} lc_face;

void lc_face_set(lc_face *f, const lc_lit *lit);
/* From 1, where they are in one plane, to 0: they are of other directions, in other planes, seen by another
 * number of mirrors, or one of them has a lobe that the other has not. Symmetric. */
float lc_likeness(const lc_face *a, const lc_face *b);

#endif
