/* zlib_alloc.h - makes zlib use the context's allocator. */
#ifndef LC_ZLIB_ALLOC_H
#define LC_ZLIB_ALLOC_H

#include "base/context.h"

#include <zlib.h>

/* A stream to pass to inflateInit or deflateInit. */
z_stream lc_zlib_stream(const lc_context *ctx);

#endif
