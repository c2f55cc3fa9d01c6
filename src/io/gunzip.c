/* gunzip.c - inflates one member after another with zlib. */
#include "io/gunzip.h"

#include "base/arena.h"
#include "io/zlib_alloc.h"

#include <string.h>

#define PIECE ((size_t)1 << 16)
#define GZIP_WINDOW (15 + 16) /* zlib's windowBits: the largest window, 15, and gzip's header and trailer */

struct lc_gunzip {
    const lc_context *ctx;
    z_stream z;
    bool between; /* between members: one has ended, and no other has begun */
    char in[PIECE];
};

lc_status lc_gunzip_open(const lc_context *ctx, const char *head, size_t len, lc_gunzip **out)
{
    lc_gunzip *g = *out = lc_alloc_raw(ctx, 1, sizeof *g);
    if (!g) return LC_ERR_MEMORY;
    g->ctx = ctx;
    g->z = lc_zlib_stream(ctx);
    g->between = false;
    memcpy(g->in, head, len);
    g->z.next_in = (Bytef *)g->in;
    g->z.avail_in = (uInt)len;
    if (inflateInit2(&g->z, GZIP_WINDOW) == Z_OK) return LC_OK;
    lc_free(ctx, g, 1, sizeof *g);
    *out = NULL;
    return LC_ERR_MEMORY;
}

/* Skips the zeros between members. False if no further member begins in the data read so far. */
static bool next_member(lc_gunzip *g)
{
    while (g->z.avail_in && !*g->z.next_in) {
        g->z.next_in++;
        g->z.avail_in--;
    }
    if (!g->z.avail_in) return false;
    inflateReset(&g->z);
    g->between = false;
    return true;
}

/* Reads the next piece of compressed data. */
static lc_status feed(lc_gunzip *g, lc_gunzip_pull *pull, void *user)
{
    size_t len;
    lc_status st = pull(g->ctx, user, g->in, PIECE, &len);
    if (st) return st;
    g->z.next_in = (Bytef *)g->in;
    g->z.avail_in = (uInt)len;
    return LC_OK;
}

lc_status lc_gunzip_read(lc_gunzip *g, lc_gunzip_pull *pull, void *user, char *to, size_t n, size_t *got,
                         const char **why)
{
    *got = 0;
    while (*got < n) {
        lc_status st = g->z.avail_in ? LC_OK : feed(g, pull, user);
        if (st) return st;
        if (!g->z.avail_in && g->between) return LC_OK;
        if (!g->z.avail_in) {
            *why = "they end too early";
            return LC_ERR_PARSE;
        }
        if (g->between && !next_member(g)) continue;
        uInt room = (uInt)(n - *got < ((size_t)1 << 30) ? n - *got : (size_t)1 << 30);
        g->z.next_out = (Bytef *)to + *got;
        g->z.avail_out = room;
        int rv = inflate(&g->z, Z_NO_FLUSH);
        *got += room - g->z.avail_out;
        if (rv == Z_MEM_ERROR) return LC_ERR_MEMORY;
        g->between = rv == Z_STREAM_END;
        /* Z_BUF_ERROR: zlib could make no progress yet. */
        if (rv == Z_OK || rv == Z_STREAM_END || rv == Z_BUF_ERROR) continue;
        *why = g->z.msg ? g->z.msg : "not deflate's";
        return LC_ERR_PARSE;
    }
    return LC_OK;
}

void lc_gunzip_close(lc_gunzip *g)
{
    if (!g) return;
    inflateEnd(&g->z);
    lc_free(g->ctx, g, 1, sizeof *g);
}
