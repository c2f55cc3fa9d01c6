/* file.h - whole files: read into memory, written under their final name only when complete. */
#ifndef LC_FILE_H
#define LC_FILE_H

#include "base/context.h"

/* Bytes that grow at the end; a zeroed one with ctx set is empty. */
typedef struct lc_bytes {
    const lc_context *ctx;
    void *data;
    size_t len, cap;
} lc_bytes;

/* Puts n bytes at an offset, growing as needed; a gap is zeros. */
lc_status lc_bytes_put(lc_bytes *bytes, size_t offset, const void *data, size_t n);
void lc_bytes_free(lc_bytes *bytes);

/* The whole of a file, pipe or device, but not more than max_len bytes (LC_ERR_UNSUPPORTED). When `magic` is
 * not NULL, reading stops after 8 bytes unless magic(those bytes) is true: then the result is those bytes
 * alone. */
lc_status lc_bytes_load(const lc_context *ctx, const char *path, size_t max_len,
                        bool (*magic)(const uint8_t *head, size_t len), lc_bytes *out);

/* Regular and new files: temporary name in the same folder, fsync, rename; on failure nothing is left
 * behind and the old file is as it was. Devices and pipes are written directly. LC_ERR_IO, logged with path.
 */
lc_status lc_file_replace(const lc_context *ctx, const char *path, const void *data, size_t len);

/* True when the path is there and is a pipe, a socket or a device. */
bool lc_file_is_special(const char *path);

#endif
