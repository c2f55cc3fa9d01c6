/* cpu.c - the processors of the scheduler's affinity mask, limited by the control groups' quota. */
#include "base/cpu.h"

#include <sched.h>

uint32_t lc_cpu_threads(void)
{
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set)) return 1;
    int n = CPU_COUNT(&set), quota = (int)lc_cpu_quota("");
    if (quota && quota < n) n = quota;
    return n < 1 ? 1 : n > LC_MAX_THREADS ? LC_MAX_THREADS : (uint32_t)n;
}
