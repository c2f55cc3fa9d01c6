/* stats.h - per-thread counters of a render; sums of integers, so any order of joining gives the same. */
#ifndef LC_STATS_H
#define LC_STATS_H

#include "base.h"

typedef struct lc_stats {
    uint64_t points, shadow_rays, bounds, camera_rays, at_limit, dark, nonfinite;
    uint64_t cut_sum;
} lc_stats;

/* Seconds of a monotonic clock. */
double lc_now(void);

#endif
