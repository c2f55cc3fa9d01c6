/* cpu.h - how many processors this process may use. */
#ifndef LC_CPU_H
#define LC_CPU_H

#include "base/base.h"

#define LC_MAX_THREADS 1024 /* limits the arrays on lc_parallel's stack */

/* The number of processors that affinity and control groups allow, 1..LC_MAX_THREADS. */
uint32_t lc_cpu_threads(void);
/* The number of processors that control groups allow (cgroup.c), rounded up; 0: no limit. root is prefixed to
 * all paths: "", except in tests. */
uint32_t lc_cpu_quota(const char *root);

#endif
