/* near_gather.h - rays to the surfaces within the reach of a point, and by a narrow lobe to any. */
#ifndef LC_NEAR_GATHER_H
#define LC_NEAR_GATHER_H

#include "scene/sight.h"
#include "shade/point.h"
#include "trace/bvh.h"

/* Where a ray ends. */
typedef struct lc_near_end {
    lc_hit hit;  /* tri: LC_NONE: it leaves the scene; only where it is reflected */
    lc_f3 dir;   /* unit, along the ray there */
    lc_f3 to;    /* what leaves the point of a radiance of 1 from there, R G B, by this one of the rays: (1 -
                  * part) over the rays' density and number, times what glass on the way lets through and
                  * mirrors reflect */
    float width; /* of what the ray stands for there; INFINITY where it is within reach */
    bool reflected; /* by glass: lamps and the sky shine by it, too */
} lc_near_end;

typedef struct lc_near_ends {
    const lc_scene *scene;
    void (*end)(void *user, const lc_near_end *end);
    void *user;
} lc_near_ends;

/* Rays first .. first + n - 1 of the sequence of a key (base/sample.h): points whose rays follow each other
 * share what is even about them. Both are multiples of 4. */
typedef struct lc_near_rays {
    uint64_t key;
    uint32_t first, n;
} lc_near_rays;

/* Rays by the cosine about the point's normal; where it has a narrow lobe a quarter of them by that. Where
 * virtual lights do not meet the lobe at all (lc_point.lobe_by_rays) a share of the rays that goes by what
 * the lobe reflects is for it alone, at any distance. soft: what virtual lights meet there, with a reach.
 * Rays go straight through glass; those by such a lobe go on at mirrors. Some of the rays that meet glass
 * within reach are followed, besides, to where it reflects them, at any distance. */
void lc_near_gather(const lc_near_ends *ends, const lc_lit *lit, const lc_point *soft, lc_near_rays rays);

#endif
