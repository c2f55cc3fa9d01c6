/* watch.c - see watch.h. Files are looked at by name every now and then: that works on every file system, and
 * editors that put a new file under the old name are no case of their own. */
#include "cli/watch.h"

#include "cli/cli.h"
#include "cli/progress.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#define STEP       0.2 /* seconds between looks, */
#define LOOK_SHARE 50  /* or so many times as long as a look takes */
#define CALM       0.3 /* seconds without a change after which a scene counts as written, */
#define MAX_CALM   5.0 /* or after so many seconds of changes */

typedef struct {
    bool there;
    uint64_t dev, ino, size;
    struct timespec time;
} stamp;

typedef struct cli_watched {
    char *path;
    stamp seen;
} watched;

static stamp stamp_of(const char *path)
{
    struct stat st;
    if (stat(path, &st)) return (stamp){ 0 };
    return (stamp){ true, (uint64_t)st.st_dev, (uint64_t)st.st_ino, (uint64_t)st.st_size, st.st_mtim };
}

static bool same(const stamp *a, const stamp *b)
{
    return a->there == b->there && a->dev == b->dev && a->ino == b->ino && a->size == b->size &&
           a->time.tv_sec == b->time.tv_sec && a->time.tv_nsec == b->time.tv_nsec;
}

/* FNV-1a. */
static uint64_t mix(uint64_t hash, const void *data, size_t n)
{
    const unsigned char *p = data;
    for (size_t i = 0; i < n; i++) hash = (hash ^ p[i]) * 0x100000001b3u;
    return hash;
}

static uint64_t mix_number(uint64_t hash, uint64_t x) { return mix(hash, &x, sizeof x); }

/* ---- the files ---- */

/* The entry of a name: its file's, or the free one where it would stand. */
static size_t entry_of(const cli_watch *w, const char *path)
{
    size_t at = (size_t)mix(0xcbf29ce484222325u, path, strlen(path)) & (w->size - 1);
    while (w->table[at] && strcmp(w->files[w->table[at] - 1].path, path)) at = (at + 1) & (w->size - 1);
    return at;
}

/* Room for one file more; false: no memory. */
static bool grow(cli_watch *w)
{
    if (w->n < w->cap) return true;
    const size_t cap = w->cap ? 2 * w->cap : 64;
    watched *files = realloc(w->files, cap * sizeof *files);
    if (files) w->files = files;
    uint32_t *table = files ? calloc(2 * cap, sizeof *table) : NULL;
    if (!table) return false;
    free(w->table);
    w->table = table;
    w->size = 2 * cap;
    w->cap = cap;
    for (size_t i = 0; i < w->n; i++) w->table[entry_of(w, w->files[i].path)] = (uint32_t)i + 1;
    return true;
}

void cli_watch_note(void *user, const char *path)
{
    cli_watch *w = user;
    if (w->n && w->table[entry_of(w, path)]) return;
    char *copy = w->n < UINT32_MAX - 1 && grow(w) ? strdup(path) : NULL;
    if (!copy) {
        w->short_of_memory = true;
        return;
    }
    w->files[w->n] = (watched){ copy, stamp_of(path) };
    w->table[entry_of(w, copy)] = (uint32_t)++w->n;
}

static void forget(cli_watch *w)
{
    for (size_t i = 0; i < w->n; i++) free(w->files[i].path);
    free(w->files);
    free(w->table);
    *w = (cli_watch){ 0 };
}

/* ---- changes ---- */

/* Looks at all files; *sum is another number when any of them is another file than at the last look. */
static void look(cli_watch *w, uint64_t *sum)
{
    const double t0 = cli_now();
    *sum = 0xcbf29ce484222325u;
    for (size_t i = 0; i < w->n; i++) {
        const stamp now = stamp_of(w->files[i].path);
        if (!w->changed && !same(&now, &w->files[i].seen)) w->changed = w->files[i].path;
        *sum = mix_number(*sum, now.there);
        *sum = mix_number(*sum, now.dev);
        *sum = mix_number(*sum, now.ino);
        *sum = mix_number(*sum, now.size);
        *sum = mix_number(*sum, (uint64_t)now.time.tv_sec);
        *sum = mix_number(*sum, (uint64_t)now.time.tv_nsec);
    }
    const double took = cli_now() - t0, pause = took * LOOK_SHARE;
    w->next = t0 + took + (pause > STEP ? pause : STEP);
}

bool cli_watch_changed(cli_watch *w)
{
    uint64_t sum;
    if (!w->changed && cli_now() >= w->next) look(w, &sum);
    return w->changed != NULL;
}

/* Sleeps for part of a step; a signal shortens it. */
static void rest(void)
{
    const struct timespec t = { 0, (long)(STEP / 4 * 1e9) };
    nanosleep(&t, NULL);
}

/* Waits for a change, and then until it is over. False: a signal came. */
static bool wait_for_change(cli_watch *w)
{
    uint64_t sum, before = 0;
    double since, begin;
    while (!cli_caught_signal() && !cli_watch_changed(w)) rest();
    for (begin = since = cli_now(); !cli_caught_signal(); rest()) {
        if (cli_now() >= w->next || !before) {
            look(w, &sum);
            if (sum != before) since = cli_now();
            before = sum;
        }
        if (cli_now() - since >= CALM || cli_now() - begin >= MAX_CALM) return true;
    }
    return false;
}

int cli_watch_loop(cli_watch *w, int (*once)(void *user, bool again), void *user, bool quiet)
{
    int status;
    for (bool again = false;; again = true) {
        if (again) cli_leave_signals(); /* while a scene is loaded nothing looks for them */
        status = once(user, again);
        if (cli_caught_signal()) break;
        if (!again && (status == CLI_USAGE || status == CLI_FAILED || !w->n || !w->files[0].seen.there))
            break;
        if (w->short_of_memory)
            fprintf(stderr, "lightcuts: warning: out of memory: not all files of the scene are watched\n");
        if (!quiet && !w->changed)
            fprintf(stderr, "lightcuts: watching %zu file%s; Ctrl-C ends\n", w->n, w->n == 1 ? "" : "s");
        cli_catch_signals();
        if (!wait_for_change(w)) break;
        if (!quiet) fprintf(stderr, "lightcuts: '%s' has changed\n", cli_shown(w->changed));
        forget(w);
        cli_log_anew();
    }
    forget(w);
    return status;
}
