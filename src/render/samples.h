/* samples.h - pixels whose samples share cuts. */
#ifndef LC_SAMPLES_H
#define LC_SAMPLES_H

#include "render/render_job.h"

/* Adds all samples of a pixel, those on surfaces alike by one cut; the job's `shared` is set. False:
 * cancelled. */
bool lc_add_shared_samples(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, lc_pixel *px);

/* Room for the lit points of a pixel, of a thread; most: of a gather cluster, times two. NULL: no memory. */
lc_pixel_points *lc_pixel_points_create(const lc_context *ctx, uint32_t most);
void lc_pixel_points_free(const lc_context *ctx, lc_pixel_points *p);

#endif
