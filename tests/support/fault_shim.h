/* fault_shim.h - calls of the C library that fail on demand. With the linker's --wrap every call of the
 * program goes to the shim, which counts it and lets the n-th of a class fail. The streams of fopen and
 * stdout use the same calls. */
#ifndef FAULT_SHIM_H
#define FAULT_SHIM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum fault_class { FAULT_ALLOC, FAULT_IO, FAULT_THREAD, FAULT_CLASSES } fault_class;

typedef struct fault_plan {
    fault_class class;
    long nth;     /* counted from 1; 0: none fails */
    bool ever;    /* all later calls of the class fail, too */
    int err;      /* errno of calls that fail */
    size_t most;  /* most bytes that a read or write transfers; 0: no limit */
    bool stutter; /* every other read and write fails with EINTR */
} fault_plan;

#define FAULT_MAX_SITES 4096

/* What the process under test did, in zeroed memory that it shares with its parent. A site is the address
 * that a call returns to. */
typedef struct fault_seen {
    long calls[FAULT_CLASSES]; /* since fault_start */
    long failed;
    bool stays; /* removing a file failed, so that it is still there */
    uint32_t n_sites[FAULT_CLASSES], n_failed[FAULT_CLASSES];
    uintptr_t sites[FAULT_CLASSES][FAULT_MAX_SITES], failed_sites[FAULT_CLASSES][FAULT_MAX_SITES];
    long first[FAULT_CLASSES][FAULT_MAX_SITES]; /* number of a site's first call */
} fault_seen;

/* From this call on calls are counted, and stdout is a stream of the shim. */
void fault_start(const fault_plan *plan, fault_seen *seen);
void fault_stop(void);

#endif
