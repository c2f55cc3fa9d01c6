/* readfile.c - see readfile.h. */
#include "readfile.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static lc_status fail(const lc_context *ctx, lc_pos where, lc_status status, const char *path,
                      const char *why)
{
    if (where.line) return lc_fail_at(ctx, status, where, "cannot open '%s': %s", path, why);
    return lc_fail(ctx, status, "cannot open '%s': %s", path, why);
}

/* Reads to the end of fd; size_hint is what the file system says. */
static lc_status read_all(const lc_context *ctx, lc_pos where, const char *path, int fd, size_t size_hint,
                          lc_file *f)
{
    for (;;) {
        size_t want = f->size < size_hint ? size_hint - f->size : 65536;
        void *data = f->data;
        /* One byte for the zero, one to notice that the file goes on. */
        lc_status st = lc_grow(ctx, &data, &f->cap, f->size + want + 2, 1);
        f->data = data;
        if (st) return st;
        ssize_t n = read(fd, f->data + f->size, f->cap - f->size - 1);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return fail(ctx, where, LC_ERR_IO, path, strerror(errno));
        if (n == 0) break;
        f->size += (size_t)n;
        if (f->size > LC_FILE_MAX) return fail(ctx, where, LC_ERR_PARSE, path, "larger than 8 GiB");
    }
    f->data[f->size] = 0;
    if (f->size >= 2 && (unsigned char)f->data[0] == 0x1f && (unsigned char)f->data[1] == 0x8b)
        return fail(ctx, where, LC_ERR_UNSUPPORTED, path, "compressed by gzip; unpack it first");
    return LC_OK;
}

lc_status lc_file_read(const lc_context *ctx, lc_pos where, const char *path, lc_file *out)
{
    *out = (lc_file){ 0 };
    /* A pipe without a writer would block open() for ever. */
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (fd < 0) return fail(ctx, where, LC_ERR_IO, path, strerror(errno));
    struct stat info;
    lc_status st = LC_OK;
    if (fstat(fd, &info) < 0)
        st = fail(ctx, where, LC_ERR_IO, path, strerror(errno));
    else if (S_ISDIR(info.st_mode))
        st = fail(ctx, where, LC_ERR_IO, path, "is a directory");
    else if (!S_ISREG(info.st_mode))
        st = fail(ctx, where, LC_ERR_IO, path, "is not a regular file");
    else if (info.st_size < 0 || (uint64_t)info.st_size > LC_FILE_MAX)
        st = fail(ctx, where, LC_ERR_PARSE, path, "larger than 8 GiB");
    if (!st) {
        out->dev = (uint64_t)info.st_dev;
        out->ino = (uint64_t)info.st_ino;
        st = read_all(ctx, where, path, fd, (size_t)info.st_size, out);
    }
    close(fd);
    if (st) lc_file_free(ctx, out);
    return st;
}

lc_status lc_file_read_stdin(const lc_context *ctx, lc_file *out)
{
    *out = (lc_file){ 0 };
    lc_status st = read_all(ctx, (lc_pos){ 0 }, "standard input", STDIN_FILENO, 0, out);
    if (st) lc_file_free(ctx, out);
    return st;
}

lc_status lc_file_from_memory(const lc_context *ctx, const void *data, size_t size, lc_file *out)
{
    *out = (lc_file){ .size = size, .cap = size + 1 };
    out->data = lc_alloc(ctx, size + 1, 1);
    if (!out->data) return LC_ERR_MEMORY;
    if (size) memcpy(out->data, data, size);
    return LC_OK;
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
