/* edges.h - pixels at the edges of what emits: lamps, skies, and both seen in mirrors and through glass.
 *
 *     samples -> cuts -> light of surfaces  --\
 *             `-> what they emit               >-- the pixel
 *     LC_EDGE_RAYS times as many rays       --/
 *
 * Where what a pixel's samples show emitted differs, as much of it as is off by one sample is more than all
 * that cuts may be off by, and it costs camera rays alone. So there the mean of what is emitted is that of
 * more rays, which continue the samples' sequences, and what is lit is weighted by what an even light would
 * show of it:
 *
 *     pixel = emitted(all rays) + lit(samples) even(all rays) / even(samples)
 *
 * Not where --spp or a host says how many samples there are, in passes, and where neighbouring pixels share
 * samples, which then have as many.
 */
#ifndef LC_EDGES_H
#define LC_EDGES_H

#include "render/render_job.h"

/* Whether pixels may have more rays. */
bool lc_render_has_edges(const lc_scene *scene, const lc_render_desc *desc);
/* Notes what a sample of the pixel shows emitted. */
void lc_edges_note(lc_pixel *px, lc_f3 emitted);
/* Puts what more rays say in place of what the samples say, of all samples' sums: rgb, groups of lights,
 * interval. */
void lc_edges_smooth(const lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, lc_pixel *px);

#endif
