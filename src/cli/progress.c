/* progress.c - see progress.h. */
#include "cli/progress.h"

#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define TERMINAL_STEP 0.25 /* seconds between updates of the line on a terminal */
#define PLAIN_STEP 10.0    /* seconds between lines elsewhere */

static atomic_int caught, save; /* set by signal handlers, which run in any thread */

static void on_signal(int sig)
{
    atomic_store(&caught, sig);
}

/* Without SA_RESTART, so that a signal interrupts system calls that wait. */
void cli_catch_signals(void)
{
    struct sigaction act = { .sa_handler = on_signal, .sa_flags = (int)SA_RESETHAND };
    sigaction(SIGINT, &act, NULL);
    sigaction(SIGTERM, &act, NULL);
}

void cli_leave_signals(void)
{
    if (atomic_load(&caught)) return;
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
}

static void on_save_signal(int sig)
{
    (void)sig;
    atomic_store(&save, 1);
}

/* The handlers stay installed, and interrupted system calls go on: these signals end nothing. */
void cli_catch_save_signals(bool hangup)
{
    struct sigaction act = { .sa_handler = on_save_signal, .sa_flags = SA_RESTART }, old;
    sigaction(SIGUSR1, &act, NULL);
    if (hangup && !sigaction(SIGHUP, NULL, &old) && old.sa_handler != SIG_IGN) sigaction(SIGHUP, &act, NULL);
}

bool cli_asked_to_save(void)
{
    return atomic_exchange(&save, 0);
}

int cli_caught_signal(void) { return atomic_load(&caught); }

int cli_forget_signal(void) { return atomic_exchange(&caught, 0); }
void cli_remember_signal(int sig) { atomic_store(&caught, sig); }

void cli_die_by_signal(int sig)
{
    signal(sig, SIG_DFL);
    raise(sig);
    exit(128 + sig);
}

double cli_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void cli_progress_start(cli_progress *p, const char *what, bool quiet)
{
    const char *no_color = getenv("NO_COLOR"), *term = getenv("TERM");
    *p = (cli_progress){ .what = what, .quiet = quiet, .start = cli_now() };
    p->terminal = isatty(STDERR_FILENO) && (!term || strcmp(term, "dumb"));
    p->colour = p->terminal && !(no_color && *no_color);
    p->last = p->terminal ? 0 : p->start;
}

static void format_time(char *text, size_t size, double seconds)
{
    unsigned s = seconds < 0 ? 0 : seconds > 3.6e8 ? 360000000u : (unsigned)(seconds + 0.5);
    if (s >= 3600) snprintf(text, size, "%u:%02u:%02u", s / 3600, s / 60 % 60, s % 60);
    else snprintf(text, size, "%u:%02u", s / 60, s % 60);
}

int cli_progress_step(void *user, uint64_t done, uint64_t total)
{
    cli_progress *p = user;
    double t = cli_now(), share = total ? (double)done / (double)total : 1;
    char left[32];
    if (atomic_load(&caught)) return 1;
    const bool begun = share > p->before; /* what comes first, as calibration, is not done again */
    if (!begun) p->start = t;
    if (p->quiet || t - p->last < (p->terminal ? TERMINAL_STEP : PLAIN_STEP)) return 0;
    p->last = t;
    if (begun) format_time(left, sizeof left, (t - p->start) * (1 - share) / (share - p->before));
    else snprintf(left, sizeof left, "?");
    if (p->terminal) {
        fprintf(stderr, "\r%s%s %5.1f %%%s  %s left   ", p->colour ? "\033[1m" : "", p->what, 100 * share,
                p->colour ? "\033[0m" : "", left);
        p->line_open = true;
    } else {
        fprintf(stderr, "%s %.1f %%, %s left\n", p->what, 100 * share, left);
    }
    return 0;
}

void cli_progress_end(cli_progress *p)
{
    if (p->line_open) fputs("\r                                                  \r", stderr);
    p->line_open = false;
}
