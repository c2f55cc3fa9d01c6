/* zlib_alloc.h - zlib over the context's allocator. */
#ifndef LC_ZMEM_H
#define LC_ZMEM_H

#include "base/context.h"

#include <zlib.h>

/* A stream for inflateInit or deflateInit. */
z_stream lc_zlib_stream(const lc_context *ctx);

#endif
