/* fault_shim.h - calls of the C library that fail on demand. The linker's --wrap leads every call of the
 * program to the shim, which counts it and lets the n-th of a class fail. Streams of fopen and stdout are
 * made of the same calls. */
#ifndef FAULT_SHIM_H
#define FAULT_SHIM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum fault_class { FAULT_ALLOC, FAULT_IO, FAULT_THREAD, FAULT_CLASSES } fault_class;

typedef struct fault_plan {
    fault_class class;
    long nth;     /* counted from 1; 0: none fails */
    bool ever;    /* all calls of the class after it fail, too */
    int err;      /* errno of calls that fail */
    size_t most;  /* bytes that read and write move at a time, 0: any number */
    bool stutter; /* every other read and write ends with EINTR */
} fault_plan;

#define FAULT_MAX_SITES 4096

/* What the parent of a process under test sees: zeroed memory shared with it. A site is the address that a
 * call returns to. */
typedef struct fault_seen {
    long calls[FAULT_CLASSES]; /* since fault_start */
    long failed;
    bool stays; /* a file was not removed because that failed */
    uint32_t n_sites[FAULT_CLASSES], n_failed[FAULT_CLASSES];
    uintptr_t sites[FAULT_CLASSES][FAULT_MAX_SITES], failed_sites[FAULT_CLASSES][FAULT_MAX_SITES];
    long first[FAULT_CLASSES][FAULT_MAX_SITES]; /* number of a site's first call */
} fault_seen;

/* From here on calls count, and stdout is a stream of the shim's. */
void fault_start(const fault_plan *plan, fault_seen *seen);
void fault_stop(void);

#endif
