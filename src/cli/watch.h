/* watch.h - --watch: the files that a scene is read from, and whether one of them has changed. */
#ifndef LC_CLI_WATCH_H
#define LC_CLI_WATCH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Empty if zeroed. */
typedef struct cli_watch {
    struct cli_watched *files;
    size_t n, cap;
    uint32_t *table; /* 1 + number of a file by its name, size entries, a power of two; 0: free */
    size_t size;
    double next;          /* cli_now from which on the files are looked at again */
    const char *changed;  /* the first file that was seen to differ; NULL: none */
    bool short_of_memory; /* files are missing here */
} cli_watch;

/* For lc_load_desc.reads; user is a cli_watch. Keeps what the file is before it is read, so that no change is
 * missed. */
void cli_watch_note(void *user, const char *path);
/* Whether a file has changed, appeared or gone since it was noted; looks a few times a second, whenever it is
 * called. For one thread at a time. */
bool cli_watch_changed(cli_watch *w);
/* Calls once until a signal ends the process: at the beginning, and after each change, when nothing has
 * changed for a moment. `again` is false for the first call, which decides with a status of CLI_USAGE or
 * CLI_FAILED, or with a scene that is not there, that there is nothing to wait for. once notes files. Returns
 * the status of the last call. */
int cli_watch_loop(cli_watch *w, int (*once)(void *user, bool again), void *user, bool quiet);

#endif
