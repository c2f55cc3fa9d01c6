/* readfile.h - input files, whole or piece by piece. Folders, pipes and devices are refused, but stdin may be
 * anything.
 *
 * Nothing is mapped: a file that another program cuts short while it is read just ends there. What begins as
 * gzip data do is unpacked while it is read, whatever its name; sizes and limits are of the unpacked bytes.
 */
#ifndef LC_READFILE_H
#define LC_READFILE_H

#include "base/arena.h"
#include "io/gunzip.h"

#define LC_FILE_MAX ((size_t)1 << 33) /* bytes, once unpacked; scenes of 10^7 lights have 1.1 GB */

typedef struct lc_reader {
    const char *path;  /* for messages; the caller keeps it */
    lc_pos where;      /* what refers to the file; with where.line == 0 messages name the path alone */
    int fd;            /* -1: memory */
    bool owned;        /* close fd */
    const char *memory;
    size_t size;       /* of the memory; of the file when it was opened; 0: not known, as of stdin and gzip */
    size_t n_raw;      /* bytes so far, as they stand in the file */
    size_t n_read;     /* bytes so far, unpacked */
    char head[2];      /* read to know gzip by */
    uint8_t n_head;    /* of them not handed out yet */
    bool begun;        /* head was read */
    lc_gunzip *gunzip; /* NULL: nothing to unpack */
    uint64_t dev, ino; /* identity; 0, 0 for stdin and memory */
} lc_reader;

/* LC_ERR_IO, _PARSE (too large), _MEMORY. Close it when done, not on failure. */
lc_status lc_reader_open(const lc_context *ctx, lc_pos where, const char *path, lc_reader *out);
void lc_reader_stdin(lc_reader *out);
void lc_reader_memory(const void *data, size_t size, lc_reader *out); /* the caller keeps data */
/* Fills n bytes, or fewer at the end of the file. LC_ERR_IO, _MEMORY, _PARSE (too large, damaged gzip). */
lc_status lc_reader_read(const lc_context *ctx, lc_reader *r, char *to, size_t n, size_t *got);
void lc_reader_close(lc_reader *r);

/* A whole file in memory. */
typedef struct lc_file {
    char *data; /* size bytes and a zero */
    size_t size, cap;
} lc_file;

/* As lc_reader_open and lc_reader_read; also LC_ERR_MEMORY. */
lc_status lc_file_read(const lc_context *ctx, lc_pos where, const char *path, lc_file *out);
void lc_file_free(const lc_context *ctx, lc_file *file);
/* Also true where that cannot be told: opening it will say why. */
bool lc_file_exists(const char *path);

#endif
