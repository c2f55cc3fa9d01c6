/* cpu.h - which instruction set and how many processors may be used. */
#ifndef LC_CPU_H
#define LC_CPU_H

#include "base.h"
#include "lightcuts.h"

#define LC_MAX_THREADS 1024

lc_isa lc_cpu_isa(void);       /* the best set that this program has kernels for and that CPU and OS support */
uint32_t lc_cpu_threads(void);
/* Processors that control groups allow, rounded up; 0: no limit. root: "", but for tests. */
uint32_t lc_cpu_quota(const char *root); /* processors this process may run on, at least 1 */

#endif
