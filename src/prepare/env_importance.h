/* env_importance.h - how much of what the camera sees directions of an environment light. */
#ifndef LC_ENV_WORTH_H
#define LC_ENV_WORTH_H

#include "prepare/view_grid.h"

/* Of each of n directional lights a weight, LC_LEAST_WEIGHT to 1, by the mean luminance that it gives to
 * points of the view, shadows counted, were it as strong as all others. Neighbours in the list should be
 * neighbours in the sky. All 1 where nothing is lit. LC_ERR_MEMORY. */
#define LC_LEAST_WEIGHT 0.0625
lc_status lc_env_weights(const lc_vpl_view *view, const lc_light *lights, uint32_t n, uint64_t seed,
                         double *weights);

#endif
