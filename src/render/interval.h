/* interval.h - LC_AOV_INTERVAL: between what the luminance of pixels must lie, were every light evaluated;
 * see cut/interval.h. */
#ifndef LC_RENDER_INTERVAL_H
#define LC_RENDER_INTERVAL_H

#include "render/render_job.h"

/* Room for the cuts that are made for intervals alone, one for each worker. Fails with LC_ERR_MEMORY; free it
 * also then. */
lc_status lc_interval_make_rooms(lc_render_job *j, const lc_cut_desc *desc);
void lc_interval_free_room(const lc_context *ctx, lc_render_worker *w);

/* Of sample i of a pixel; rgb: its radiance, which is exact where every light is evaluated. False: cancelled,
 * *out is not set. */
bool lc_sample_interval(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, uint32_t i, lc_f3 rgb,
                        lc_interval *out);
/* Adds that of sample i to a pixel, if any is asked for. False: cancelled. */
bool lc_add_interval(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, uint32_t i, lc_f3 rgb,
                     lc_pixel *px);

#endif
