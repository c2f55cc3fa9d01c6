/* wait.c - looks after each STEP whether to stop. A signal may come just before a call that blocks, so no
 * call here blocks for longer. */
#include "io/wait.h"

#include "base/stats.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define STEP 50            /* milliseconds */
#define READER_SECONDS 10. /* for which a pipe that is written may have no reader */
#define WRITER_SECONDS 2.  /* for which a pipe that is read may have no writer */

/* Waits for a step, or less if the descriptor is ready. */
static int wait_a_step(const lc_context *ctx, int fd, short events, short *ready)
{
    struct pollfd p = { fd, events, 0 };
    if (lc_stopped(ctx)) return ECANCELED;
    int n = poll(&p, fd < 0 ? 0 : 1, STEP);
    *ready = p.revents;
    return n < 0 && errno != EINTR ? errno : 0;
}

int lc_wait_open_writer(const lc_context *ctx, const char *path, bool is_pipe, int *fd)
{
    short ready;
    const double end = lc_now() + READER_SECONDS;
    for (;;) {
        *fd = open(path, O_WRONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
        if (*fd >= 0) return 0;
        if (errno != EINTR && (errno != ENXIO || !is_pipe)) return errno;
        int err = lc_now() > end ? ETIMEDOUT : wait_a_step(ctx, -1, 0, &ready);
        if (err) return err;
    }
}

int lc_wait_write(const lc_context *ctx, int fd, const void *data, size_t n, size_t *done)
{
    short ready;
    for (;;) {
        ssize_t k = write(fd, data, n);
        *done = k > 0 ? (size_t)k : 0;
        if (k >= 0) return 0;
        if (errno != EINTR && errno != EAGAIN) return errno;
        int err = errno == EINTR ? 0 : wait_a_step(ctx, fd, POLLOUT, &ready);
        if (err) return err;
    }
}

int lc_wait_read(const lc_context *ctx, int fd, void *to, size_t n, bool any, size_t *got)
{
    struct stat st;
    short ready = 0;
    const bool is_pipe = !fstat(fd, &st) && S_ISFIFO(st.st_mode);
    const double end = lc_now() + WRITER_SECONDS;
    for (;;) {
        ssize_t k = read(fd, to, n);
        *got = k > 0 ? (size_t)k : 0;
        if (k > 0 || (k == 0 && (any || !is_pipe || ready & POLLHUP))) return 0;
        /* 0: no writer yet, EAGAIN: one that has written nothing yet */
        if (k < 0 && errno != EINTR && errno != EAGAIN) return errno;
        int err = k == 0 && lc_now() > end ? ETIMEDOUT : wait_a_step(ctx, fd, POLLIN, &ready);
        if (err) return err;
    }
}

const char *lc_wait_text(int err, bool writing)
{
    if (err == ETIMEDOUT) return writing ? "no process reads this pipe" : "no process writes to this pipe";
    return strerror(err);
}
