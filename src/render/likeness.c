/* likeness.c - see likeness.h. */
#include "render/likeness.h"

#include <math.h>

/* Chosen by eye and by the error of pictures, tests/results/preview.md. */
#define LEAST_COS       0.9f  /* between normals: from here to 1 the weight rises from 0 to 1 */
#define LEAST_COS_LOBED 0.98f /* where they have a lobe */
#define MOST_SINE       0.25f /* of the way from one to the other against their planes: likewise, falling */

void lc_face_set(lc_face *f, const lc_lit *lit)
{
    const lc_surface *s = &lit->surface;
    *f = (lc_face){ .pos = s->pos,
                    .n = s->n,
                    .ng = s->ng,
                    .albedo = lc_f3_add(s->material.kd, s->material.ks),
                    .material = s->material_id,
                    .n_mirrors = lit->n_mirrors,
                    .lobed = lc_f3_max(s->material.ks) > 0 || s->material.coat };
}

float lc_likeness(const lc_face *a, const lc_face *b)
{
    if (a->n_mirrors != b->n_mirrors || a->lobed != b->lobed || (a->lobed && a->material != b->material))
        return 0;
    const float least = a->lobed ? LEAST_COS_LOBED : LEAST_COS,
                turned = (lc_f3_dot(a->n, b->n) - least) / (1 - least);
    if (!(turned > 0)) return 0;
    const lc_f3 way = lc_f3_sub(b->pos, a->pos);
    const float length2 = lc_f3_dot(way, way),
                off = fmaxf(fabsf(lc_f3_dot(way, a->ng)), fabsf(lc_f3_dot(way, b->ng)));
    if (!(length2 > 0)) return fminf(turned, 1);
    const float sine = off / sqrtf(length2);
    return sine < MOST_SINE ? fminf(turned, 1) * (1 - sine / MOST_SINE) : 0;
}
