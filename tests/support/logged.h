/* logged.h - contexts that print nothing and keep what they log: the last error, the last warning, and how
 * many errors there were. Include it in one file of a program. */
#ifndef LOGGED_H
#define LOGGED_H

#include "lightcuts.h"
#include "support/test.h"

#include <stdlib.h>

static char last_error[4096], last_warning[4096]; /* since log_clear; "": none */
static int n_errors;

static inline void log_keep(void *user, lc_log_level level, const char *text)
{
    (void)user;
    if (level == LC_LOG_ERROR) n_errors++;
    if (level == LC_LOG_ERROR) snprintf(last_error, sizeof last_error, "%s", text);
    if (level == LC_LOG_WARNING) snprintf(last_warning, sizeof last_warning, "%s", text);
}

static inline void log_clear(void)
{
    last_error[0] = last_warning[0] = 0;
    n_errors = 0;
}

/* n_threads: 0 for as many as there are processors; isa: the best that may be used. */
static inline lc_context *quiet_context_of(uint32_t n_threads, lc_isa isa)
{
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    lc_context *made;
    desc.log = log_keep;
    desc.n_threads = n_threads;
    desc.isa = isa;
    if (lc_context_create(&desc, &made)) abort();
    return made;
}

static inline lc_context *quiet_context(uint32_t n_threads)
{
    return quiet_context_of(n_threads, LC_ISA_BEST);
}

/* `got` is the status of a call that had to fail with `want` and log one error, `message`. */
#define EXPECT_FAILURE(got, want, message) expect_failure(got, want, message, __LINE__)
static inline void expect_failure(lc_status got, lc_status want, const char *message, int line)
{
    CHECKF(got == want, "line %d: %s", line, lc_status_name(got));
    CHECKF(!strcmp(last_error, message), "line %d: \"%s\"", line, last_error);
    CHECKF(n_errors == 1, "line %d: %d errors", line, n_errors);
}

/* The call was refused with one line that names the argument. */
#define REFUSED(call, name)                                                                                  \
    do {                                                                                                     \
        log_clear();                                                                                         \
        CHECK((call) == LC_ERR_ARG);                                                                         \
        CHECKF(strstr(last_error, name) != NULL, "%s", last_error);                                          \
    } while (0)

/* Sets a field of a fresh descriptor to a wrong value: the call names it. */
#define WRONG(call, desc, set, name)                                                                         \
    do {                                                                                                     \
        desc##_used = desc;                                                                                  \
        desc##_used.set;                                                                                     \
        REFUSED(call, name);                                                                                 \
    } while (0)

#endif
