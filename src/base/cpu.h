/* cpu.h - how many processors may be used. */
#ifndef LC_CPU_H
#define LC_CPU_H

#include "base/base.h"

#define LC_MAX_THREADS 1024

uint32_t lc_cpu_threads(void); /* processors this process may run on, at least 1 */
/* Processors that control groups allow, rounded up; 0: no limit. root: "", but for tests. */
uint32_t lc_cpu_quota(const char *root);

#endif
