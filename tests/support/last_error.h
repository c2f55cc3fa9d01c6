/* last_error.h - a context that says nothing, and what its last error was. Include it once a program. */
#ifndef LAST_ERROR_H
#define LAST_ERROR_H

#include "lightcuts.h"

#include <stdio.h>

static char last_error[4096];

static void log_to_buffer(void *user, lc_log_level level, const char *text)
{
    (void)user;
    if (level == LC_LOG_ERROR) snprintf(last_error, sizeof last_error, "%s", text);
}

/* n_threads: 0: as many as there are processors. NULL: none could be made. */
static inline lc_context *quiet_context(uint32_t n_threads)
{
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    lc_context *ctx;
    desc.log = log_to_buffer;
    desc.n_threads = n_threads;
    return lc_context_create(&desc, &ctx) ? NULL : ctx;
}

#endif
