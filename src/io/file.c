/* file.c - reads files of unknown size, and replaces files by rename. */
#include "io/file.h"

#include "base/arena.h"

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

/* Appends up to n bytes of the file to `out`; *got is their number, 0 at the end of the file. */
static lc_status read_some(int fd, const char *path, size_t n, lc_bytes *out, size_t *got)
{
    *got = 0;
    lc_status status = lc_grow(out->ctx, &out->data, &out->cap, out->len + n, 1);
    if (status != LC_OK) return status;
    while (*got < n) {
        ssize_t k = read(fd, (uint8_t *)out->data + out->len, n - *got);
        if (k < 0 && errno == EINTR) continue;
        if (k < 0) return lc_fail_at(out->ctx, LC_ERR_IO, (lc_pos){ path, 0, 0 }, "%s", strerror(errno));
        if (k == 0) break;
        out->len += (size_t)k;
        *got += (size_t)k;
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
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) return lc_fail_at(ctx, LC_ERR_IO, (lc_pos){ path, 0, 0 }, "%s", strerror(errno));
    lc_status status = read_all(fd, path, max_len, magic, out);
    close(fd);
    if (status != LC_OK) lc_bytes_free(out);
    return status;
}

/* ---- writing ---- */

bool lc_file_is_special(const char *path)
{
    struct stat st;
    return stat(path, &st) == 0 && !S_ISREG(st.st_mode) && !S_ISDIR(st.st_mode);
}

/* Writes all data and closes fd in any case. Returns 0 or errno. */
static int write_and_close(int fd, const uint8_t *data, size_t len, bool sync)
{
    int err = 0;
    while (len > 0 && !err) {
        ssize_t k = write(fd, data, len < ((size_t)1 << 30) ? len : (size_t)1 << 30);
        if (k < 0 && errno == EINTR) continue;
        if (k < 0) {
            err = errno;
        } else {
            data += k;
            len -= (size_t)k;
        }
    }
    if (!err && sync && fsync(fd) != 0 && errno != EINVAL && errno != ENOTSUP) err = errno;
    if (close(fd) != 0 && !err && errno != EINTR) err = errno;
    return err;
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

static int replace_file(const char *path, const struct stat *old, const void *data, size_t len)
{
    // A symbolic link stays one: what it points to is replaced.
    char real[PATH_MAX], temp[PATH_MAX];
    const char *target = old && realpath(path, real) ? real : path;
    size_t path_len = strlen(path);
    if (path_len == 0) return ENOENT;
    if (path[path_len - 1] == '/') return EISDIR;
    const char *slash = strrchr(target, '/');
    if (strlen(slash ? slash + 1 : target) > NAME_MAX) return ENAMETOOLONG;
    if (old && access(target, W_OK) != 0) return errno;

    int fd = open_temp(target, 0666, temp);
    if (fd < 0) return errno;
    if (old) (void)fchmod(fd, old->st_mode & 07777);
    int err = write_and_close(fd, data, len, true);
    if (!err && rename(temp, target) != 0) err = errno;
    if (err) {
        (void)unlink(temp);
        return err;
    }
    lc_file_sync_folder(target);
    return 0;
}

lc_status lc_file_replace(const lc_context *ctx, const char *path, const void *data, size_t len)
{
    struct stat st;
    bool there = stat(path, &st) == 0;
    int err;
    if (!there && errno != ENOENT) {
        err = errno;
    } else if (there && S_ISDIR(st.st_mode)) {
        err = EISDIR;
    } else if (there && !S_ISREG(st.st_mode)) {
        int fd = open(path, O_WRONLY | O_CLOEXEC);
        err = fd < 0 ? errno : write_and_close(fd, data, len, false);
    } else {
        err = replace_file(path, there ? &st : NULL, data, len);
    }
    if (err) return lc_fail_at(ctx, LC_ERR_IO, (lc_pos){ path, 0, 0 }, "cannot write: %s", strerror(err));
    return LC_OK;
}
