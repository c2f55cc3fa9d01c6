/* readfile.h - a whole input file in memory, zero-terminated. Folders, pipes and devices are refused. */
#ifndef LC_READFILE_H
#define LC_READFILE_H

#include "arena.h"

#define LC_FILE_MAX ((size_t)1 << 33) /* bytes; 30 MB is the largest text seen in public scenes */

typedef struct lc_file {
    char *data; /* size bytes and a zero */
    size_t size, cap;
    uint64_t dev, ino; /* identity; 0, 0 for stdin and memory */
} lc_file;

/* where: what refers to the file; with where.line == 0 the message names where.file alone.
 * LC_ERR_IO, _UNSUPPORTED (gzip), _PARSE (too large), _MEMORY. */
lc_status lc_file_read(const lc_context *ctx, lc_pos where, const char *path, lc_file *out);
lc_status lc_file_read_stdin(const lc_context *ctx, lc_file *out);
lc_status lc_file_from_memory(const lc_context *ctx, const void *data, size_t size,
                              lc_file *out); /* a copy */
void lc_file_free(const lc_context *ctx, lc_file *file);
bool lc_file_exists(const char *path);

#endif
