/* interpolate.h - where an error of pixels is asked: those between others lit alike are interpolated.
 *
 *     k . . . k      k  knots: the first pixel of each block of 4 x 4, shaded by cuts from the roots on
 *     . . . . .      m  the middle: shaded, too, where the knots around it show one surface whose light
 *     . . m . .         they agree upon. Where it does not agree with them, all others are shaded
 *     . . . . .      .  else the camera rays of a pixel are traced, so that textures and edges are as in any
 *     k . . . k         picture, and where all of them show that surface, its light is interpolated:
 *
 *     pixel = albedo * (bilinear L of the knots + half of what the middle's L differs), L = radiance / albedo
 *
 * That is the idea of reconstruction cuts [Walter05, 4], but that the light as a whole is interpolated rather
 * than each cluster's. The error of interpolated pixels is found on the pilots with that of the others, and
 * where not as many of them are within what is asked, none is interpolated (calibrate.c). Knots depend on
 * their place on the film alone and may lie beyond its right and lower edge, so crops and tiles agree.
 */
#ifndef LC_INTERPOLATE_H
#define LC_INTERPOLATE_H

#include "render/render_job.h"

#define LC_INTERPOLATE_FROM 65536 /* pixels of the film: with fewer, pilots' knots take more than they save */

/* Whether the pixels of a job can be interpolated at all. */
bool lc_may_interpolate(const lc_render_job *j);
/* Knots of a crop that tiles share, once the film is there. LC_ERR_MEMORY; free them also then. */
lc_status lc_knots_init(lc_render_job *j, const uint32_t crop[4]);
void lc_knots_free(lc_render_job *j);
/* Room for a worker to look at a block. LC_ERR_MEMORY. */
lc_status lc_block_light_init(const lc_render_job *j, lc_render_worker *w);
void lc_block_light_free(const lc_render_job *j, lc_render_worker *w);

/* What is known of the last block is not of other cuts. */
void lc_block_light_forget(lc_render_worker *w);

/* Adds all samples of a pixel as lc_add_samples does, or what is interpolated for them; *between: which of
 * these. Where tiles share no knots it makes its own. False: cancelled. */
bool lc_add_pixel(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, lc_pixel *px, bool *between);
/* A pixel of the film. False: cancelled, nothing stored. */
bool lc_interpolated_pixel(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y);

#endif
