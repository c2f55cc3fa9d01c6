/* stats.c - the clocks. */
#include "base/stats.h"

#include <time.h>

static double seconds_of(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double lc_thread_cpu(void) { return seconds_of(CLOCK_THREAD_CPUTIME_ID); }

double lc_process_cpu(void) { return seconds_of(CLOCK_PROCESS_CPUTIME_ID); }

double lc_now(void) { return seconds_of(CLOCK_MONOTONIC); }
