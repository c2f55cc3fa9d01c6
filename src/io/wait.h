/* wait.h - pipes and devices without blocking: a call that waits for another process ends when the context's
 * stop says so, and when nobody opens the other end. */
#ifndef LC_WAIT_H
#define LC_WAIT_H

#include "base/context.h"

#include <sys/types.h>

/* All: 0 or errno, ECANCELED when stopped.
 * Opens what is no regular file to write. ETIMEDOUT: a pipe that no process reads for some seconds. */
int lc_wait_open_writer(const lc_context *ctx, const char *path, bool is_pipe, int *fd);
/* write and read of a descriptor with O_NONBLOCK: at least one byte, or 0 at the end. `any`: bytes were read
 * before. ETIMEDOUT: a pipe that no process opens to write for some seconds. */
int lc_wait_write(const lc_context *ctx, int fd, const void *data, size_t n, size_t *done);
int lc_wait_read(const lc_context *ctx, int fd, void *to, size_t n, bool any, size_t *got);
/* strerror, but with words for what a pipe lacks. */
const char *lc_wait_text(int err, bool writing);

#endif
