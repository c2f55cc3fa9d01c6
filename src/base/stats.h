/* stats.h - per-thread counters and timers of a render. The counters are integers, so they may be added in
 * any order. */
#ifndef LC_STATS_H
#define LC_STATS_H

#include "base/base.h"

/* Seconds of a monotonic clock, and of processor time, to which other programs do not add: of the calling
 * thread, and of all threads of the process, including those that have ended. */
double lc_now(void);
double lc_thread_cpu(void);
double lc_process_cpu(void);

#define LC_CLOCK_SECONDS 5e-6 /* that reading both clocks may differ by */

/* What the time of a render is spent on. */
typedef enum lc_phase {
    LC_PHASE_CAMERA,    /* camera rays and the evaluation of their hits */
    LC_PHASE_BOUNDS,    /* error bounds of tree nodes, fetching them included */
    LC_PHASE_ESTIMATES, /* estimates of lights */
    LC_PHASE_REFINE,    /* selecting, storing and summing clusters */
    LC_PHASE_SHADOW,    /* shadow rays */
    LC_PHASE_OTHER,
    LC_PHASES
} lc_phase;

typedef struct lc_stats {
    uint64_t points, shadow_rays, bounds, camera_rays, at_limit, dark, nonfinite;
    uint64_t cut_sum; /* sum of the cuts' sizes */
    uint64_t glossy;  /* points with a lobe beside the diffuse one */
    uint64_t proved;  /* clusters proved to be occluded */
    uint64_t interpolated; /* pixels */
    uint64_t proof_tests; /* triangles tested in proofs */
    uint64_t ticks[LC_PHASES];            /* of the samples that were timed and not interrupted */
    uint64_t sample[LC_PHASES], last_tick; /* of the sample that is being timed */
    double wall, cpu;                     /* when it began */
    double cpu_seconds;                   /* processor time of the tiles */
    bool timed;
    bool (*go_on)(void *user); /* NULL, or returns false once the render is cancelled: long loops may stop
                                * then */
    void *go_on_user;
} lc_stats;

/* A fast clock without a defined unit, for fractions of time only. */
static inline uint64_t lc_ticks(void)
{
#if defined(__x86_64__)
    return __builtin_ia32_rdtsc();
#else
    return (uint64_t)(1e9 * lc_now());
#endif
}

/* Starts timing a sample. Only one sample in sixteen is timed, as reading the clock a hundred times a point
 * takes a few percent of the time; another one of each sixteen, since a block's first pixel
 * also makes what the block shares. */
static inline void lc_phase_start(lc_stats *s)
{
    s->timed = (s->camera_rays & 15) == (s->camera_rays >> 4 & 15);
    if (!s->timed) return;
    for (int k = 0; k < LC_PHASES; k++) s->sample[k] = 0;
    s->wall = lc_now();
    s->cpu = lc_thread_cpu();
    s->last_tick = lc_ticks();
}

/* Ends a sample. One during which the thread had to wait for a processor does not count: the wait would be
 * charged to one phase. */
static inline void lc_phase_stop(lc_stats *s)
{
    if (!s->timed) return;
    const double cpu = lc_thread_cpu() - s->cpu, wall = lc_now() - s->wall;
    s->timed = false;
    if (wall > 1.25 * cpu + LC_CLOCK_SECONDS) return;
    for (int k = 0; k < LC_PHASES; k++) s->ticks[k] += s->sample[k];
}

/* Adds the time since the last call to this phase. */
static inline void lc_phase_end(lc_stats *s, lc_phase phase)
{
    if (!s->timed) return;
    uint64_t now = lc_ticks();
    s->sample[phase] += now - s->last_tick;
    s->last_tick = now;
}

#endif
