/* zlib_alloc.c - each block stores its size, which the context's allocator needs to free it. */
#include "io/zlib_alloc.h"

#include "base/arena.h"

#include <string.h>

#define BLOCK_HEAD 64

static void *zlib_alloc(void *user, unsigned n, unsigned size)
{
    const lc_context *ctx = user;
    size_t bytes = (size_t)n * size + BLOCK_HEAD;
    uint8_t *block = lc_alloc(ctx, bytes, 1);
    if (!block) return NULL;
    memcpy(block, &bytes, sizeof bytes);
    return block + BLOCK_HEAD;
}

static void zlib_free(void *user, void *ptr)
{
    if (!ptr) return;
    uint8_t *block = (uint8_t *)ptr - BLOCK_HEAD;
    size_t bytes;
    memcpy(&bytes, block, sizeof bytes);
    lc_free(user, block, bytes, 1);
}

z_stream lc_zlib_stream(const lc_context *ctx)
{
    lc_context *user;
    memcpy(&user, &ctx, sizeof user); /* zlib's pointer is not const */
    return (z_stream){ .zalloc = zlib_alloc, .zfree = zlib_free, .opaque = user };
}
