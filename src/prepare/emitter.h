/* emitter.h - an emissive triangle: its sides, area and power. */
#ifndef LC_EMITTER_H
#define LC_EMITTER_H

#include "scene/scene.h"

typedef struct lc_emitter {
    double cross[3], twice; /* cross product of two edges, and its length: twice the area */
    double side;            /* 1 if the side that cross points to emits, -1 if the other does */
    uint32_t n_sides;       /* 2: both emit */
    double flux[3];         /* area times the mean colour of the emission map, or white */
    double power;           /* mean of R, G and B over pi, of all sides; 0: does not emit */
} lc_emitter;

lc_emitter lc_emitter_of(const lc_scene *scene, size_t tri);
/* Unit normal of a side: sign is e->side, or for the other side -e->side. */
static inline lc_f3 lc_emitter_normal(const lc_emitter *e, double sign)
{
    return lc_f3_normalize_d(e->cross[0] * sign / e->twice, e->cross[1] * sign / e->twice,
                             e->cross[2] * sign / e->twice);
}

#endif
