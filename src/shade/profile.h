/* profile.h - the photometric tables of a scene's luminaires: copies as kernels read them, and the greatest
 * values that bounds are made of. */
#ifndef LC_PROFILE_H
#define LC_PROFILE_H

#include "base/context.h"
#include "shade/light_luminaire.h"

/* Copies a table: angles in degrees as in lc_profile, candela n_azimuth * n_polar >= 0; *peak is the
 * greatest. *id is its number. LC_ERR_MEMORY, _UNSUPPORTED: too many. */
typedef struct lc_profile_desc {
    const float *azimuth, *polar, *candela;
    uint32_t n_azimuth, n_polar;
} lc_profile_desc;
lc_status lc_profiles_add(const lc_context *ctx, lc_profiles *all, const lc_profile_desc *desc, uint32_t *id,
                          float *peak);
/* Makes the sets; called when all profiles are there. LC_ERR_MEMORY. */
lc_status lc_profiles_finish(const lc_context *ctx, lc_profiles *all);
void lc_profiles_free(const lc_context *ctx, lc_profiles *all);

#endif
