/* guide.h - the cut that the cuts of a block of pixels begin with. */
#ifndef LC_GUIDE_H
#define LC_GUIDE_H

#include "render/render_job.h"

/* Where the work of a guide that is made apart is counted. */
static inline lc_stats *lc_guide_work(lc_render_worker *w)
{
    return w->pilot ? &w->apart : w->guide.evidence ? &w->stats : NULL;
}

/* Makes g the guide of a pixel; the first sample of the pixel that makes it does so itself, whatever was made
 * before.
 * Rays and bounds of a guide that is made apart are added to work, or to nothing where that is NULL. */
lc_guide *lc_guide_of(const lc_render_job *j, lc_cut *c, lc_guide *g, uint32_t x, uint32_t y,
                      uint32_t sample, lc_stats *work);
void lc_guide_make(const lc_render_job *j, lc_cut *c, lc_guide *g, lc_stats *work);
/* The row of evidence that sample 0 of a pixel has; LC_NONE: it has none. */
uint32_t lc_guide_row(const lc_guide *g, uint32_t x, uint32_t y);
/* What the cut of a point may begin with; NULL: the roots. */
const lc_cut_start *lc_guide_start(const lc_guide *g, lc_f3 pos, lc_f3 n);
uint32_t lc_guide_pixel(uint32_t at); /* coordinate of the pixel that makes the guide of a pixel at `at` */
/* A cut that makes a guide, or begins with one that is made; or neither, where g is NULL. */
void lc_guided_cut(lc_cut *c, lc_guide *g, const lc_point *p, const lc_surface *s, uint64_t hash,
                   lc_stats *stats, lc_cut_result *out);

#endif
