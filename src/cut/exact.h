/* exact.h - the exact method: every light, with the estimate and the shadow rays that cuts use. */
#ifndef LC_EXACT_H
#define LC_EXACT_H

#include "cut/cut.h"

/* For the arguments see lc_cut_shade. The size is the number of lights. */
void lc_exact_shade(const lc_light_tree *tree, const lc_visibility *visibility, const lc_point *point,
                    const float ray_org[3], lc_stats *stats, lc_cut_result *out);

#endif
