/* file.h - whole files: read into memory; written so that a name always has a complete file.
 *
 * The room io/ is the library's access to files:
 *
 *     path -> lc_reader (readfile.h) -> pieces of bytes, unpacked if they are gzip (gunzip.h)
 *     path -> lc_file_read, lc_bytes_load -> all bytes in memory
 *     bytes -> lc_file_write, lc_file_replace -> temporary file -> rename -> path
 */
#ifndef LC_FILE_H
#define LC_FILE_H

#include "base/context.h"

/* A growing block of bytes. Empty if zeroed; ctx must be set. */
typedef struct lc_bytes {
    const lc_context *ctx;
    void *data;
    size_t len, cap;
} lc_bytes;

/* Writes n bytes at an offset and grows the block as needed; a gap is filled with zeros. LC_ERR_MEMORY. */
lc_status lc_bytes_put(lc_bytes *bytes, size_t offset, const void *data, size_t n);
void lc_bytes_free(lc_bytes *bytes);

/* Reads a file, pipe or device to its end. LC_ERR_UNSUPPORTED if it has more than max_len bytes; LC_ERR_IO,
 * _MEMORY. If `magic` is not NULL and magic(the first 8 bytes) is false, the result is those bytes alone. */
lc_status lc_bytes_load(const lc_context *ctx, const char *path, size_t max_len,
                        bool (*magic)(const uint8_t *head, size_t len), lc_bytes *out);

/* lc_file_write of lightcuts.h, of a block of bytes: all files but checkpoints are written by these two. */
lc_status lc_file_replace(const lc_context *ctx, const char *path, const void *data, size_t len);

/* Forces the name of a new file to the disk, with its folder; of a symbolic link the target's. A folder that
 * cannot be synced is not an error. */
void lc_file_sync_folder(const char *path);

/* True if the path exists and is a pipe, a socket or a device. */
bool lc_file_is_special(const char *path);

#endif
