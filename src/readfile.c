/* readfile.c - see readfile.h. */
#include "readfile.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static lc_status fail(const lc_context *ctx, const lc_reader *r, lc_status status, const char *why)
{
    if (r->where.line) return lc_fail_at(ctx, status, r->where, "cannot open '%s': %s", r->path, why);
    return lc_fail(ctx, status, "cannot open '%s': %s", r->path, why);
}

/* ---- pieces ---- */

lc_status lc_reader_open(const lc_context *ctx, lc_pos where, const char *path, lc_reader *r)
{
    *r = (lc_reader){ .path = path, .where = where };
    /* A pipe without a writer would block open() for ever. */
    r->fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (r->fd < 0) return fail(ctx, r, LC_ERR_IO, strerror(errno));
    r->owned = true;
    struct stat info;
    lc_status st = LC_OK;
    if (fstat(r->fd, &info) < 0)
        st = fail(ctx, r, LC_ERR_IO, strerror(errno));
    else if (S_ISDIR(info.st_mode))
        st = fail(ctx, r, LC_ERR_IO, "is a directory");
    else if (!S_ISREG(info.st_mode))
        st = fail(ctx, r, LC_ERR_IO, "is not a regular file");
    else if (info.st_size < 0 || (uint64_t)info.st_size > LC_FILE_MAX)
        st = fail(ctx, r, LC_ERR_PARSE, "larger than 8 GiB");
    if (st) {
        lc_reader_close(r);
        return st;
    }
    r->size = (size_t)info.st_size;
    r->dev = (uint64_t)info.st_dev;
    r->ino = (uint64_t)info.st_ino;
    return LC_OK;
}

void lc_reader_stdin(lc_reader *r) { *r = (lc_reader){ .path = "standard input", .fd = STDIN_FILENO }; }

void lc_reader_memory(const void *data, size_t size, lc_reader *r)
{
    *r = (lc_reader){ .path = "memory", .fd = -1, .memory = data, .size = size };
}

static lc_status read_memory(lc_reader *r, char *to, size_t n, size_t *got)
{
    *got = n < r->size - r->n_read ? n : r->size - r->n_read;
    if (*got) memcpy(to, r->memory + r->n_read, *got);
    r->n_read += *got;
    return LC_OK;
}

lc_status lc_reader_read(const lc_context *ctx, lc_reader *r, char *to, size_t n, size_t *got)
{
    if (r->fd < 0) return read_memory(r, to, n, got);
    bool first = !r->n_read;
    *got = 0;
    while (*got < n) {
        ssize_t k = read(r->fd, to + *got, n - *got < ((size_t)1 << 30) ? n - *got : (size_t)1 << 30);
        if (k < 0 && errno == EINTR) continue;
        if (k < 0) return fail(ctx, r, LC_ERR_IO, strerror(errno));
        if (k == 0) break;
        *got += (size_t)k;
        r->n_read += (size_t)k;
        if (r->n_read > LC_FILE_MAX) return fail(ctx, r, LC_ERR_PARSE, "larger than 8 GiB");
    }
    if (first && *got >= 2 && !memcmp(to, "\x1f\x8b", 2))
        return fail(ctx, r, LC_ERR_UNSUPPORTED, "compressed by gzip; unpack it first");
    return LC_OK;
}

void lc_reader_close(lc_reader *r)
{
    if (r->owned) close(r->fd);
    r->owned = false;
}

/* ---- whole files ---- */

/* Reads to the end; the file may have grown since it was opened. */
static lc_status read_all(const lc_context *ctx, lc_reader *r, lc_file *f)
{
    for (;;) {
        void *data = f->data;
        /* One byte for the zero, one to notice that the file goes on. */
        size_t want = f->size < r->size ? r->size - f->size : 65536, got;
        lc_status st = lc_grow(ctx, &data, &f->cap, f->size + want + 2, 1);
        f->data = data;
        if (st) return st;
        size_t room = f->cap - f->size - 1;
        if ((st = lc_reader_read(ctx, r, f->data + f->size, room, &got))) return st;
        f->size += got;
        f->data[f->size] = 0;
        if (got < room) return LC_OK;
    }
}

lc_status lc_file_read(const lc_context *ctx, lc_pos where, const char *path, lc_file *out)
{
    lc_reader r;
    *out = (lc_file){ 0 };
    lc_status st = lc_reader_open(ctx, where, path, &r);
    if (st) return st;
    st = read_all(ctx, &r, out);
    lc_reader_close(&r);
    if (st) lc_file_free(ctx, out);
    return st;
}

void lc_file_free(const lc_context *ctx, lc_file *file)
{
    lc_free(ctx, file->data, file->cap, 1);
    *file = (lc_file){ 0 };
}

bool lc_file_exists(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0;
}
