/* progress.h - progress on stderr: on a terminal one line that is rewritten, else plain lines; and the
 * signals that end a render. */
#ifndef LC_CLI_PROGRESS_H
#define LC_CLI_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct cli_progress {
    const char *what;
    bool quiet, terminal, colour;
    double start, last;
    double before;  /* fraction that was done when this run began */
    bool line_open; /* the line on the terminal is to be cleared */
} cli_progress;

void cli_progress_start(cli_progress *p, const char *what, bool quiet);
/* For lc_render_desc.progress; user is a cli_progress. Nonzero after SIGINT or SIGTERM. */
int cli_progress_step(void *user, uint64_t done, uint64_t total);
void cli_progress_end(cli_progress *p);

/* From now on SIGUSR1 asks for the checkpoint to be saved, and so does SIGHUP where hangup is set and SIGHUP
 * is not ignored. */
void cli_catch_save_signals(bool hangup);
/* True once after each such signal. */
bool cli_asked_to_save(void);

/* Seconds of a monotonic clock. */
double cli_now(void);

/* From now on SIGINT and SIGTERM only set a flag; a second one ends the process at once. */
void cli_catch_signals(void);
/* From now on they end the process at once, unless one was caught: for work that looks for none. */
void cli_leave_signals(void);
/* The signal that was caught; 0: none. */
int cli_caught_signal(void);
/* So that files can be written after a signal: forgets it and returns it, 0: none; and has it caught again.
 */
int cli_forget_signal(void);
void cli_remember_signal(int sig);
/* Ends the process by the signal, so that the shell knows it as the cause. */
void cli_die_by_signal(int sig);

#endif
