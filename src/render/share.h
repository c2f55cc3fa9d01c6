/* share.h - pixels whose samples neighbours share. */
#ifndef LC_SHARE_H
#define LC_SHARE_H

#include "render/render_job.h"

/* Sets the side of the groups; call it when the numbers of tiles are known. */
void lc_choose_group(lc_render_job *j);
uint64_t lc_n_groups(const lc_render_job *j);
/* Renders a group of tiles, for lc_parallel. */
void lc_render_group(void *job, uint32_t thread, uint64_t item);

#endif
