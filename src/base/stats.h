/* stats.h - per-thread counters of a render; sums of integers, so any order of joining gives the same. */
#ifndef LC_STATS_H
#define LC_STATS_H

#include "base/base.h"

/* Seconds of a monotonic clock. */
double lc_now(void);

/* What the time of a render goes to. */
typedef enum lc_phase {
    LC_PHASE_CAMERA,    /* camera rays and what they hit */
    LC_PHASE_BOUNDS,    /* tree nodes fetched and bounded */
    LC_PHASE_ESTIMATES, /* transfers of lights */
    LC_PHASE_HEAP,      /* choosing, placing and summing of clusters */
    LC_PHASE_SHADOW,    /* shadow rays */
    LC_PHASE_OTHER,
    LC_PHASES
} lc_phase;

typedef struct lc_stats {
    uint64_t points, shadow_rays, bounds, camera_rays, at_limit, dark, nonfinite;
    uint64_t cut_sum;
    uint64_t glossy; /* of points: those with a lobe */
    uint64_t proved, proof_tests; /* clusters proved hidden, triangles looked at for that */
    uint64_t ticks[LC_PHASES], last_tick; /* of the samples that are timed */
    bool timed;
    bool (*go_on)(
        void *user); /* NULL, or false: the work is no longer wanted, and what was begun may end unfinished */
    void *go_on_user;
} lc_stats;

/* A clock of no particular unit, for shares of time only. */
static inline uint64_t lc_ticks(void)
{
#if defined(__x86_64__)
    return __builtin_ia32_rdtsc();
#else
    return (uint64_t)(1e9 * lc_now());
#endif
}

/* Starts the clock for this sample: for one in sixteen, as reading it a hundred times a point costs some
 * percent. */
static inline void lc_phase_start(lc_stats *s)
{
    s->timed = (s->camera_rays & 15) == 0;
    if (s->timed) s->last_tick = lc_ticks();
}

/* All time since the last call goes to this phase. */
static inline void lc_phase_end(lc_stats *s, lc_phase phase)
{
    if (!s->timed) return;
    uint64_t now = lc_ticks();
    s->ticks[phase] += now - s->last_tick;
    s->last_tick = now;
}

#endif
