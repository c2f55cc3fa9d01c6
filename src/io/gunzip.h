/* gunzip.h - decompresses gzip data piece by piece.
 *
 *     member | member | ... | zeros       [RFC 1952]; each member ends with a checksum, which zlib verifies
 */
#ifndef LC_GUNZIP_H
#define LC_GUNZIP_H

#include "base/context.h"

typedef struct lc_gunzip lc_gunzip;

/* The source of compressed data: reads n bytes to `to`, fewer at their end. It logs its failures. */
typedef lc_status lc_gunzip_pull(const lc_context *ctx, void *user, char *to, size_t n, size_t *got);

static inline bool lc_gunzip_is(const char *head, size_t len)
{
    return len >= 2 && head[0] == '\x1f' && head[1] == '\x8b';
}

/* head: the len <= 2 bytes that have been read already, to detect gzip data. LC_ERR_MEMORY. */
lc_status lc_gunzip_open(const lc_context *ctx, const char *head, size_t len, lc_gunzip **out);
/* Reads n decompressed bytes to `to`, fewer at the end. LC_ERR_PARSE is not logged, but described in *why;
 * other failures are logged. */
lc_status lc_gunzip_read(lc_gunzip *g, lc_gunzip_pull *pull, void *user, char *to, size_t n, size_t *got,
                         const char **why);
void lc_gunzip_close(lc_gunzip *g); /* NULL is fine */

#endif
