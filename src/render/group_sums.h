/* group_sums.h - what each group of lights contributes to a picture, summed beside it: the same estimates,
 * added up group by group, so that all groups together are the picture but for rounding.
 *
 *     cut.of_group -> sample -> lc_pixel.of_group, or with shared samples the pixels in reach -> film
 */
#ifndef LC_GROUP_SUMS_H
#define LC_GROUP_SUMS_H

#include "render/render_job.h"

typedef struct lc_group_sums {
    uint32_t n;
    double cut[LC_MAX_GROUPS][3];  /* of the last cut: lc_cut.of_group */
    lc_f3 sample[LC_MAX_GROUPS];   /* of the sample that is being rendered */
    lc_f3 pixel[LC_MAX_GROUPS];    /* of the pixel: lc_pixel.of_group */
    double (*shared)[3];           /* n for each of lc_render_worker.shared; NULL */
    size_t n_shared;
} lc_group_sums;

/* Room for each worker, where the scene has groups; n_shared: of lc_render_worker.shared. LC_ERR_MEMORY; free
 * it also then. */
lc_status lc_groups_make_rooms(lc_render_job *j, size_t n_shared);
void lc_groups_free_room(const lc_context *ctx, lc_render_worker *w);

/* The calls below take a worker's sums, and do nothing where these are NULL. */

/* Where the sight of a sample, which begins, adds what is emitted; NULL without groups. */
lc_f3 *lc_groups_begin_sample(lc_group_sums *g);
/* Adds the last cut, or the exact method's sums, times a weight to the sample. */
void lc_groups_add_cut(lc_group_sums *g, lc_f3 weight);
/* Adds the sample to the pixel. */
void lc_groups_end_sample(lc_group_sums *g);
/* Begins a pixel: its sums are 0. */
lc_f3 *lc_groups_begin_pixel(lc_group_sums *g);
/* Of shared pixel `at`: adds the sample times a weight; takes the sums for the film. */
void lc_groups_share(lc_group_sums *g, size_t at, double weight);
lc_f3 *lc_groups_of_shared(lc_group_sums *g, size_t at);

#endif
