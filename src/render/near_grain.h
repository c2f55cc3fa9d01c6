/* near_grain.h - the grain that rays to surfaces nearby (scene/near_bounce.h) leave in pixels. */
#ifndef LC_NEAR_GRAIN_H
#define LC_NEAR_GRAIN_H

#include "render/render_job.h"

/* What a pixel's luminance is off by on account of its rays: light of what is near by two sets of them, the
 * pixel's own and another; their difference over the root of 2. 0 where there are no virtual lights. */
double lc_near_grain(const lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y);

#endif
