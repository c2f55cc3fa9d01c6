/* env_importance.h - importance of environment directions, sampled at visible points. */
#ifndef LC_ENV_IMPORTANCE_H
#define LC_ENV_IMPORTANCE_H

#include "prepare/view_grid.h"

/* Sets weights[i], LC_MIN_ENV_WEIGHT..1, for each of n directional lights: proportional to the mean luminance
 * that the light would contribute to the points of the view, shadows included, if all lights had the same
 * irradiance. Directions of successive lights should be close to each other. All weights are 1 if nothing is
 * illuminated. LC_ERR_MEMORY. */
#define LC_MIN_ENV_WEIGHT 0.0625 /* limits how much an undersampled direction can lose; chosen */
lc_status lc_env_importance(const lc_view_grid *view, const lc_light *lights, uint32_t n, uint64_t seed,
                            double *weights);

#endif
