/* stats.c - the monotonic clock. */
#include "base/stats.h"

#include <time.h>

double lc_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
