/* progress.h - progress on stderr: one rewritten line on a terminal, plain lines elsewhere; and the signals
 * that end a render. */
#ifndef LC_CLI_PROGRESS_H
#define LC_CLI_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct cli_progress {
    const char *what;
    bool quiet, terminal, colour;
    double start, last;
    double before;  /* share that was done when the work began */
    bool line_open; /* a rewritten line stands on the terminal */
} cli_progress;

void cli_progress_start(cli_progress *p, const char *what, bool quiet);
/* For lc_render_desc.progress; user is a cli_progress. Nonzero after SIGINT or SIGTERM. */
int cli_progress_step(void *user, uint64_t done, uint64_t total);
void cli_progress_end(cli_progress *p);

/* From now on SIGUSR1, and with `hangup` SIGHUP unless it is ignored, only ask for the checkpoint to be
 * saved. */
void cli_catch_save_signals(bool hangup);
/* True once after each of them. */
bool cli_asked_to_save(void);

/* Seconds of a monotonic clock. */
double cli_now(void);

/* From now on SIGINT and SIGTERM only set a flag; a second one ends the process at once. */
void cli_catch_signals(void);
/* The signal caught, 0 for none. */
int cli_caught_signal(void);
/* Ends the process by the signal, so that the shell sees it. */
void cli_die_by_signal(int sig);

#endif
