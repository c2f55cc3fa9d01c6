/* readfile.c - checks, reads and if necessary decompresses input files. */
#include "io/readfile.h"

#include "io/inputs.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define HEAD 4096 /* bytes by which a file is judged */

static lc_status fail(const lc_context *ctx, const lc_reader *r, lc_status status, const char *why)
{
    if (r->where.line) return lc_fail_at(ctx, status, r->where, "cannot open '%s': %s", r->path, why);
    return lc_fail(ctx, status, "cannot open '%s': %s", r->path, why);
}

/* ---- bytes of the file ---- */

static lc_status raw_memory(lc_reader *r, char *to, size_t n, size_t *got)
{
    *got = n < r->size - r->n_raw ? n : r->size - r->n_raw;
    if (*got) memcpy(to, r->memory + r->n_raw, *got);
    r->n_raw += *got;
    return LC_OK;
}

static lc_status raw(const lc_context *ctx, void *user, char *to, size_t n, size_t *got)
{
    lc_reader *r = user;
    if (r->fd < 0) return raw_memory(r, to, n, got);
    *got = 0;
    while (*got < n) {
        ssize_t k = read(r->fd, to + *got, n - *got < ((size_t)1 << 30) ? n - *got : (size_t)1 << 30);
        if (k < 0 && errno == EINTR) continue;
        if (k < 0) return fail(ctx, r, LC_ERR_IO, strerror(errno));
        if (k == 0) break;
        *got += (size_t)k;
        r->n_raw += (size_t)k;
        if (r->n_raw > LC_FILE_MAX) return fail(ctx, r, LC_ERR_PARSE, "larger than 8 GiB");
    }
    return LC_OK;
}

/* Reads the first bytes and detects gzip data. */
static lc_status begin(const lc_context *ctx, lc_reader *r)
{
    size_t got;
    lc_status st = r->fd < 0 ? LC_OK : lc_inputs_add(ctx, r->fd);
    if (!st) st = raw(ctx, r, r->head, sizeof r->head, &got);
    if (st) return st;
    r->begun = true;
    r->n_head = (uint8_t)got;
    if (!lc_gunzip_is(r->head, got)) return LC_OK;
    r->n_head = 0;
    if (r->fd >= 0) r->size = 0;
    return lc_gunzip_open(ctx, r->head, got, &r->gunzip);
}

/* ---- pieces ---- */

static lc_status check_file(const lc_context *ctx, lc_reader *r)
{
    struct stat info;
    if (fstat(r->fd, &info) < 0) return fail(ctx, r, LC_ERR_IO, strerror(errno));
    if (S_ISDIR(info.st_mode)) return fail(ctx, r, LC_ERR_IO, "is a directory");
    if (!S_ISREG(info.st_mode)) return fail(ctx, r, LC_ERR_IO, "is not a regular file");
    if (info.st_size < 0 || (uint64_t)info.st_size > LC_FILE_MAX)
        return fail(ctx, r, LC_ERR_PARSE, "larger than 8 GiB");
    r->size = (size_t)info.st_size;
    r->dev = (uint64_t)info.st_dev;
    r->ino = (uint64_t)info.st_ino;
    return LC_OK;
}

lc_status lc_reader_open(const lc_context *ctx, lc_pos where, const char *path, lc_reader *r)
{
    *r = (lc_reader){ .path = path, .where = where };
    char real[PATH_MAX];
    lc_inputs_ask(ctx, path);
    /* The scene's own file, which no statement names, may be a link to elsewhere. */
    if (where.line && !lc_inputs_allow(ctx->inputs, &path, real))
        return fail(ctx, r, LC_ERR_IO, "is outside of the sandbox");
    /* O_NONBLOCK: opening a pipe without a writer would block forever. */
    r->fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    if (r->fd < 0) return fail(ctx, r, LC_ERR_IO, strerror(errno));
    r->owned = true;
    lc_status st = check_file(ctx, r);
    if (!st) st = begin(ctx, r);
    if (st) lc_reader_close(r);
    return st;
}

void lc_reader_stdin(lc_reader *r) { *r = (lc_reader){ .path = "standard input", .fd = STDIN_FILENO }; }

void lc_reader_memory(const void *data, size_t size, lc_reader *r)
{
    *r = (lc_reader){ .path = "memory", .fd = -1, .memory = data, .size = size };
}

static lc_status read_unpacked(const lc_context *ctx, lc_reader *r, char *to, size_t n, size_t *got)
{
    char text[96];
    const char *why = NULL;
    lc_status st = lc_gunzip_read(r->gunzip, raw, r, to, n, got, &why);
    if (!why) return st;
    snprintf(text, sizeof text, "damaged gzip data: %s", why);
    return fail(ctx, r, st, text);
}

static lc_status read_plain(const lc_context *ctx, lc_reader *r, char *to, size_t n, size_t *got)
{
    size_t head = n < r->n_head ? n : r->n_head;
    memcpy(to, r->head, head);
    r->head[0] = r->head[1]; /* if one byte remains, it is the second */
    r->n_head = (uint8_t)(r->n_head - head);
    lc_status st = raw(ctx, r, to + head, n - head, got);
    *got += head;
    return st;
}

lc_status lc_reader_read(const lc_context *ctx, lc_reader *r, char *to, size_t n, size_t *got)
{
    *got = 0;
    bool first = !r->n_read;
    lc_status st = r->begun ? LC_OK : begin(ctx, r);
    if (st) return st;
    st = r->gunzip ? read_unpacked(ctx, r, to, n, got) : read_plain(ctx, r, to, n, got);
    r->n_read += *got;
    if (ctx->inputs && first) lc_digest_mark(&ctx->inputs->digest);
    if (ctx->inputs) lc_digest_add(&ctx->inputs->digest, to, *got);
    if (!st && r->n_read > LC_FILE_MAX) return fail(ctx, r, LC_ERR_PARSE, "larger than 8 GiB");
    return st;
}

void lc_reader_close(lc_reader *r)
{
    if (r->owned) close(r->fd);
    r->owned = false;
    lc_gunzip_close(r->gunzip);
    r->gunzip = NULL;
}

/* ---- whole files ---- */

/* Reads to the end, even if the file has grown since it was opened. */
static lc_status read_all(const lc_context *ctx, lc_reader *r, lc_file *f)
{
    for (;;) {
        void *data = f->data;
        /* Two more: one byte for the zero, one to detect that the file continues. */
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

/* Reads the first bytes. *whole: the rest is wanted, too. */
static lc_status read_head(const lc_context *ctx, lc_reader *r, bool (*is)(const uint8_t *head, size_t len),
                           lc_file *f, bool *whole)
{
    void *data = NULL;
    lc_status st = lc_grow(ctx, &data, &f->cap, HEAD + 2, 1);
    f->data = data;
    if (!st) st = lc_reader_read(ctx, r, f->data, HEAD, &f->size);
    *whole = !st && is((const uint8_t *)f->data, f->size);
    return st;
}

lc_status lc_file_read(const lc_context *ctx, lc_pos where, const char *path,
                       bool (*is)(const uint8_t *head, size_t len), lc_file *out)
{
    bool whole = true;
    lc_reader r;
    *out = (lc_file){ 0 };
    lc_status st = lc_reader_open(ctx, where, path, &r);
    if (st) return st;
    if (is) st = read_head(ctx, &r, is, out, &whole);
    if (!st && whole) st = read_all(ctx, &r, out);
    lc_reader_close(&r);
    if (st) lc_file_free(ctx, out);
    return st;
}

lc_status lc_file_of_memory(const lc_context *ctx, const void *data, size_t size, lc_file *out)
{
    *out = (lc_file){ .data = lc_alloc_raw(ctx, size + 1, 1), .size = size, .cap = size + 1 };
    if (!out->data) return LC_ERR_MEMORY;
    if (size) memcpy(out->data, data, size);
    out->data[size] = 0;
    return LC_OK;
}

void lc_file_free(const lc_context *ctx, lc_file *file)
{
    lc_free(ctx, file->data, file->cap, 1);
    *file = (lc_file){ 0 };
}

size_t lc_file_peek(const char *path, uint8_t *head, size_t n)
{
    struct stat info;
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    size_t got = 0;
    if (fd < 0) return 0;
    if (!fstat(fd, &info) && S_ISREG(info.st_mode))
        for (ssize_t k = 1; k > 0 && got < n; got += k > 0 ? (size_t)k : 0) k = read(fd, head + got, n - got);
    close(fd);
    return got;
}

bool lc_file_exists(const lc_context *ctx, const char *path)
{
    struct stat info;
    lc_inputs_ask(ctx, path);
    return stat(path, &info) == 0 || (errno != ENOENT && errno != ENOTDIR && errno != ENAMETOOLONG);
}
