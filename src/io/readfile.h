/* readfile.h - input files of a scene, whole or piece by piece. Folders, pipes and devices are rejected,
 * except as stdin.
 *
 * Files are read, not mapped: one that another program truncates meanwhile simply ends. Files that begin like
 * gzip data are decompressed, whatever their name; sizes and limits apply to the decompressed bytes.
 */
#ifndef LC_READFILE_H
#define LC_READFILE_H

#include "base/arena.h"
#include "io/gunzip.h"

#define LC_FILE_MAX ((size_t)1 << 33) /* limits decompressed bytes; a scene of 10^7 lights has 1.1 GB */

typedef struct lc_reader {
    const char *path;  /* for messages; owned by the caller */
    lc_pos where;      /* the statement that refers to the file; if where.line is 0, messages name only
                        * path */
    int fd;            /* -1: memory */
    bool owned;        /* lc_reader_close closes fd */
    const char *memory;
    size_t size;       /* of the memory, or of the file when it was opened; 0: unknown, as for stdin and
                        * gzip */
    size_t n_raw;      /* bytes read from the file so far */
    size_t n_read;     /* bytes returned so far, decompressed */
    char head[2];      /* the first bytes, read to detect gzip data */
    uint8_t n_head;    /* how many of them have not been returned yet */
    bool begun;        /* head has been read */
    lc_gunzip *gunzip; /* NULL: the data are not compressed */
    uint64_t dev, ino; /* the file's identity; 0, 0 for stdin and memory */
} lc_reader;

/* LC_ERR_IO, _PARSE (too large), _MEMORY. On success it must be closed. */
lc_status lc_reader_open(const lc_context *ctx, lc_pos where, const char *path, lc_reader *out);
void lc_reader_stdin(lc_reader *out);
/* The data remain the caller's, who must keep them. */
void lc_reader_memory(const void *data, size_t size, lc_reader *out);
/* Reads n bytes to `to`, fewer at the end of the file. LC_ERR_IO, _MEMORY, _PARSE (too large, damaged gzip
 * data). */
lc_status lc_reader_read(const lc_context *ctx, lc_reader *r, char *to, size_t n, size_t *got);
void lc_reader_close(lc_reader *r);

/* A whole file in memory. */
typedef struct lc_file {
    char *data; /* size bytes, then a zero */
    size_t size, cap;
} lc_file;

/* Fails as lc_reader_open and lc_reader_read do. If `is` is not NULL and is(the first bytes) is false, the
 * result is these bytes alone: a file that is none of a kind is neither read nor unpacked to its end. */
lc_status lc_file_read(const lc_context *ctx, lc_pos where, const char *path,
                       bool (*is)(const uint8_t *head, size_t len), lc_file *out);
/* A file of a copy of these bytes. LC_ERR_MEMORY. */
lc_status lc_file_of_memory(const lc_context *ctx, const void *data, size_t size, lc_file *out);
void lc_file_free(const lc_context *ctx, lc_file *file);
/* Up to n of the first bytes of a regular file, which is not noted as read; 0 if it cannot be opened. */
size_t lc_file_peek(const char *path, uint8_t *head, size_t n);
/* False only if there certainly is no such file; any other error shows when it is opened. */
bool lc_file_exists(const lc_context *ctx, const char *path);

#endif
