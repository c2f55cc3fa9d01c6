/* exact.h - the exact method: every light, with the estimate and the shadow rays that cuts use. */
#ifndef LC_EXACT_H
#define LC_EXACT_H

#include "cut/cut.h"

/* For the arguments see lc_cut_shade. The size is the number of lights. */
void lc_exact_shade(const lc_light_tree *tree, const lc_visibility *visibility, const lc_point *point,
                    const float ray_org[3], lc_stats *stats, lc_cut_result *out);
/* The same; of_group: NULL, or where the radiance of each of the tree's groups goes. */
void lc_exact_shade_groups(const lc_light_tree *tree, const lc_visibility *visibility, const lc_point *point,
                           const float ray_org[3], double (*of_group)[3], lc_stats *stats,
                           lc_cut_result *out);

#endif
