/* reconstruct.h - coarse pictures: a pixel of each block is shaded, the others are interpolated between the
 * four that are nearest where these show surfaces like theirs, and shaded themselves where they do not.
 *
 *     + . . . + . . .       +  shaded: pixel 1, 1 of each block, counted on the film, so that crops agree
 *     . . . . . . . .       .  its camera ray is traced, so edges, textures, emission and the background
 *     . . p . . . . .          are as they are in any picture
 *     . . . . . . . .
 *     + . . . + . . .       p = emission + sum over surfaces of weight * albedo * (sum w L / sum w albedo)
 *
 * L is what a shaded pixel's surface reflects; w is bilinear, times how alike the surfaces are ([Kopf07] with
 * the albedo divided out, as a ratio of sums: a black surface among white ones says nothing of the light).
 * Where none of the four is alike the twelve around them are asked. Few pixels are shaded, by rough cuts, and
 * each by another slot of representatives: so L is first smoothed, by neighbours that are alike.
 *
 *     lc_coarse_strip: shaded pixels, by strips of the film -> lc_coarse_smooth, by rows of these
 *                                                           -> lc_coarse_pixel: every pixel, by tiles
 */
#ifndef LC_RECONSTRUCT_H
#define LC_RECONSTRUCT_H

#include "render/render_job.h"

#define LC_MAX_COARSE 8 /* pixels a side of a block */

/* Whether the job's descriptor asks for a picture that can be made so. LC_ERR_ARG. */
lc_status lc_coarse_check(const lc_context *ctx, const lc_scene *scene, const lc_render_desc *d);
/* Room for the shaded pixels in reach of a crop. LC_ERR_MEMORY. */
lc_status lc_coarse_init(lc_render_job *j, const uint32_t crop[4]);
void lc_coarse_free(lc_render_job *j);
/* How many strips there are, and one of them, for lc_parallel. */
uint64_t lc_coarse_n_strips(const lc_render_job *j);
void lc_coarse_strip(void *job, uint32_t thread, uint64_t item);
/* How many rows of shaded pixels there are, and one of them smoothed, for lc_parallel. */
uint64_t lc_coarse_n_rows(const lc_render_job *j);
void lc_coarse_smooth(void *job, uint32_t thread, uint64_t row);
/* A pixel of the picture, once all strips are done. False: cancelled, nothing stored. */
bool lc_coarse_pixel(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y);

#endif
