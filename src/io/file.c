/* file.c - reads files of unknown size, and replaces files by rename. */
#include "io/file.h"

#include "base/arena.h"
#include "io/wait.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define READ_STEP ((size_t)1 << LC_SIZE(16, 12)) /* bytes read at first; less for fuzzers, for ASan */
#define TEMP_TRIES 1000 /* names tried for a temporary file */

lc_status lc_bytes_put(lc_bytes *bytes, size_t offset, const void *data, size_t n)
{
    if (n == 0) return LC_OK;
    if (offset > SIZE_MAX - n) return lc_fail(bytes->ctx, LC_ERR_MEMORY, "out of memory");
    lc_status status = lc_grow(bytes->ctx, &bytes->data, &bytes->cap, offset + n, 1);
    if (status != LC_OK) return status;
    memcpy((uint8_t *)bytes->data + offset, data, n);
    if (offset + n > bytes->len) bytes->len = offset + n;
    return LC_OK;
}

void lc_bytes_free(lc_bytes *bytes)
{
    lc_free(bytes->ctx, bytes->data, bytes->cap, 1);
    bytes->data = NULL;
    bytes->len = bytes->cap = 0;
}

/* ---- reading ---- */

static lc_status fail_reading(const lc_context *ctx, const char *path, int err)
{
    if (err == ECANCELED) return LC_ERR_CANCELLED;
    return lc_fail_at(ctx, LC_ERR_IO, (lc_pos){ path, 0, 0 }, "%s", lc_wait_text(err, false));
}

/* Appends up to n bytes of the file to `out`; *got is their number, 0 at the end of the file. */
static lc_status read_some(int fd, const char *path, size_t n, lc_bytes *out, size_t *got)
{
    *got = 0;
    lc_status status = lc_grow(out->ctx, &out->data, &out->cap, out->len + n, 1);
    if (status != LC_OK) return status;
    while (*got < n) {
        size_t k;
        int err = lc_wait_read(out->ctx, fd, (uint8_t *)out->data + out->len, n - *got, out->len > 0, &k);
        if (err) return fail_reading(out->ctx, path, err);
        if (k == 0) break;
        out->len += k;
        *got += k;
    }
    return LC_OK;
}

static lc_status read_all(int fd, const char *path, size_t max_len,
                          bool (*magic)(const uint8_t *head, size_t len), lc_bytes *out)
{
    size_t got;
    lc_status status = read_some(fd, path, 8, out, &got);
    if (status != LC_OK || (magic && !magic(out->data, out->len))) return status;

    // Ask once for what a regular file says it holds.
    struct stat st;
    if (fstat(fd, &st) == 0 && S_ISREG(st.st_mode) && st.st_size > 0 && (uintmax_t)st.st_size <= max_len) {
        status = lc_grow(out->ctx, &out->data, &out->cap, (size_t)st.st_size + READ_STEP, 1);
        if (status != LC_OK) return status;
    }
    while (got > 0) {
        if (out->len > max_len) {
            return lc_fail_at(out->ctx, LC_ERR_UNSUPPORTED, (lc_pos){ path, 0, 0 }, "larger than %zu bytes",
                              max_len);
        }
        status = read_some(fd, path, READ_STEP, out, &got);
        if (status != LC_OK) return status;
    }
    return LC_OK;
}

lc_status lc_bytes_load(const lc_context *ctx, const char *path, size_t max_len,
                        bool (*magic)(const uint8_t *head, size_t len), lc_bytes *out)
{
    *out = (lc_bytes){ ctx, NULL, 0, 0 };
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (fd < 0) return lc_fail_at(ctx, LC_ERR_IO, (lc_pos){ path, 0, 0 }, "%s", strerror(errno));
    lc_status status = read_all(fd, path, max_len, magic, out);
    close(fd);
    if (status != LC_OK) lc_bytes_free(out);
    return status;
}

/* ---- writing ---- */

/* The process's own, which is written to as it is, whatever it leads to. */
static bool is_stdout(const char *path) { return !strcmp(path, "/dev/stdout"); }

bool lc_file_is_special(const char *path)
{
    struct stat st;
    return is_stdout(path) || (stat(path, &st) == 0 && !S_ISREG(st.st_mode) && !S_ISDIR(st.st_mode));
}

/* Creates a new file with a unique name in the folder of `path`; returns its descriptor, or -1. */
static int open_temp(const char *path, mode_t mode, char temp[PATH_MAX])
{
    const char *slash = strrchr(path, '/');
    int dir_len = slash ? (int)(slash - path) + 1 : 0;
    for (int i = 0; i < TEMP_TRIES; i++) {
        int n = snprintf(temp, PATH_MAX, "%.*s.lightcuts-%ld-%d.tmp", dir_len, path, (long)getpid(), i);
        if (n < 0 || n >= PATH_MAX) {
            errno = ENAMETOOLONG;
            return -1;
        }
        int fd = open(temp, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
        if (fd >= 0 || errno != EEXIST) return fd;
    }
    return -1;
}

void lc_file_sync_folder(const char *path)
{
    char dir[PATH_MAX], real[PATH_MAX];
    if (realpath(path, real)) path = real;
    const char *slash = strrchr(path, '/');
    int n = slash ? snprintf(dir, sizeof dir, "%.*s/", (int)(slash - path), path)
                  : snprintf(dir, sizeof dir, ".");
    if (n < 0 || (size_t)n >= sizeof dir) return;
    int fd = open(dir, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0) return;
    (void)fsync(fd);
    close(fd);
}

/* A file on its way to its name. */
struct lc_sink {
    const lc_context *ctx;
    const char *path;
    int fd, err;              /* err: 0 or errno of the first failure, after which nothing more is written */
    bool renamed;             /* temp becomes target; false: a device or pipe is written to */
    char temp[PATH_MAX], target[PATH_MAX];
};

lc_status lc_sink_put(lc_sink *s, const void *data, size_t n)
{
    for (const uint8_t *p = data; n && !s->err;) {
        size_t k;
        s->err = lc_wait_write(s->ctx, s->fd, p, n < ((size_t)1 << 30) ? n : (size_t)1 << 30, &k);
        p += k;
        n -= k;
    }
    return s->err == ECANCELED ? LC_ERR_CANCELLED : s->err ? LC_ERR_IO : LC_OK;
}

/* Opens the temporary file for `path`. Returns 0 or errno. */
static int open_replacement(lc_sink *s, const struct stat *old)
{
    // A symbolic link stays one: what it points to is replaced.
    size_t len = strlen(s->path);
    if (len == 0) return ENOENT;
    if (s->path[len - 1] == '/') return EISDIR;
    if (len >= sizeof s->target) return ENAMETOOLONG;
    if (!old || !realpath(s->path, s->target)) memcpy(s->target, s->path, len + 1);
    const char *slash = strrchr(s->target, '/');
    if (strlen(slash ? slash + 1 : s->target) > NAME_MAX) return ENAMETOOLONG;
    if (old && access(s->target, W_OK) != 0) return errno;
    s->renamed = true;
    s->fd = open_temp(s->target, 0666, s->temp);
    if (s->fd < 0) return errno;
    if (old) (void)fchmod(s->fd, old->st_mode & 07777);
    return 0;
}

static int open_sink(lc_sink *s)
{
    struct stat st;
    if (is_stdout(s->path)) {
        s->fd = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
        return s->fd < 0 ? errno : 0;
    }
    bool there = stat(s->path, &st) == 0;
    if (!there && errno != ENOENT) return errno;
    if (there && S_ISDIR(st.st_mode)) return EISDIR;
    if (!there || S_ISREG(st.st_mode)) return open_replacement(s, there ? &st : NULL);
    return lc_wait_open_writer(s->ctx, s->path, S_ISFIFO(st.st_mode), &s->fd);
}

/* Removes the temporary file, unless another file has its name by now. */
static void remove_temp(const lc_sink *s, const struct stat *own)
{
    struct stat there;
    if (!lstat(s->temp, &there) && there.st_dev == own->st_dev && there.st_ino == own->st_ino)
        (void)unlink(s->temp);
}

/* Puts the file in place, or removes it. */
static void close_sink(lc_sink *s, bool keep)
{
    struct stat own;
    bool known = fstat(s->fd, &own) == 0;
    if (keep && !s->err && s->renamed && fsync(s->fd) != 0 && errno != EINVAL && errno != ENOTSUP)
        s->err = errno;
    if (close(s->fd) != 0 && !s->err && errno != EINTR) s->err = errno;
    if (!s->renamed) return;
    if (keep && !s->err && rename(s->temp, s->target) != 0) s->err = errno;
    if (keep && !s->err) lc_file_sync_folder(s->target);
    else if (known) remove_temp(s, &own);
    else (void)unlink(s->temp);
}

static lc_status write_file(const lc_context *ctx, const char *path,
                            lc_status (*fill)(void *user, lc_sink *sink), void *user)
{
    lc_sink s = { .ctx = ctx, .path = path };
    lc_status status = LC_OK;
    s.err = open_sink(&s);
    if (!s.err) {
        status = fill(user, &s);
        close_sink(&s, status == LC_OK);
    }
    if (!s.err) return status;
    if (s.err == ECANCELED) return LC_ERR_CANCELLED;
    return lc_fail_at(ctx, LC_ERR_IO, (lc_pos){ path, 0, 0 }, "cannot write: %s", lc_wait_text(s.err, true));
}

lc_status lc_file_write(lc_context *ctx, const char *path, lc_status (*fill)(void *user, lc_sink *sink),
                        void *user)
{
    return ctx && path && fill ? write_file(ctx, path, fill, user) : LC_ERR_ARG;
}

typedef struct {
    const void *data;
    size_t len;
} block;

static lc_status put_block(void *user, lc_sink *sink)
{
    const block *b = user;
    return lc_sink_put(sink, b->data, b->len);
}

lc_status lc_file_replace(const lc_context *ctx, const char *path, const void *data, size_t len)
{
    block b = { data, len };
    return write_file(ctx, path, put_block, &b);
}
