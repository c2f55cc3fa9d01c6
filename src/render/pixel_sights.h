/* pixel_sights.h - what the samples of a pixel show: their places on the film and the lens, in time and in
 * media, and their camera rays.
 *
 * Samples of a pixel are a (0,2)-sequence on the film, and others on the lens and in narrow lobes, in orders
 * of their own. Those that meet the same flat surface as the one before have most of that one's sight.
 */
#ifndef LC_PIXEL_SIGHTS_H
#define LC_PIXEL_SIGHTS_H

#include "render/render_job.h"
#include "scene/ray_light.h"
#include "scene/sight.h"

#define LC_EDGE_RAYS 4 /* for each sample at edges, see render/edges.h; a power of 2 */

/* A pixel's samples in turn. */
typedef struct lc_pixel_sights {
    const lc_render_job *job;
    uint32_t x, y, next; /* the sample */
    bool begun;
    uint64_t film, lens, lobe; /* keys of their numbers; 0: the middle */
    lc_pixel_light own, *light; /* where there are media */
    lc_f3 dir;           /* of the last sample's ray, */
    lc_sight sight;      /* and what it shows; set by the first */
} lc_pixel_sights;

/* Begins with sample `first`. Beyond the film coordinates are modulo 2^32. light: of the last pixel, and then
 * of this one; or NULL. */
void lc_pixel_sights_begin(lc_pixel_sights *s, const lc_render_job *j, uint32_t x, uint32_t y, uint32_t first,
                           lc_pixel_light *light);
/* What the next sample shows; as lc_sight_trace. One sample a pixel is of the pixel's centre and the lens's.
 * of_group: as of lc_sight_desc. */
bool lc_pixel_sights_next(lc_pixel_sights *s, lc_f3 *of_group);
/* The same for one sample alone. */
bool lc_sample_sight(const lc_render_job *j, uint32_t x, uint32_t y, uint32_t i, lc_pixel_light *light,
                     lc_f3 *of_group, lc_f3 *dir, lc_sight *s);

static inline uint64_t lc_pixel_number(const lc_render_job *j, uint32_t x, uint32_t y)
{
    return (uint64_t)y * j->scene->film.width + x;
}

#endif
