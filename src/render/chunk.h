/* chunk.h - the attributes of a part of a picture. */
#ifndef LC_CHUNK_H
#define LC_CHUNK_H

#include "base/context.h"

#define LC_CHUNK_ATTR "lightcuts/chunk"          /* "3/16" */
#define LC_CHUNK_CROP_ATTR "lightcuts/chunkOf"   /* "0,800,0,600", the whole crop */
#define LC_CHUNK_SCENE_ATTR "lightcuts/sceneId"  /* 16 hexadecimal digits, as is the next */
#define LC_CHUNK_OPTIONS_ATTR "lightcuts/optionsId"
#define LC_CHUNK_BUILD_ATTR "lightcuts/buildId"  /* lc_build_id; older parts have neither this nor: */
#define LC_CHUNK_DIGEST_ATTR "lightcuts/digest"  /* 16 digits, of lc_chunk_digest */

typedef struct lc_chunk {
    uint32_t k, n, crop[4];
    lc_identity id;
} lc_chunk;

/* False: no part, or its pixels are not those that k, n and crop mean. */
bool lc_chunk_read(const lc_image *image, lc_chunk *out);
/* Of pixels and attributes as they are in a file; without LC_CHUNK_DIGEST_ATTR itself. */
uint64_t lc_chunk_digest(const lc_image *image);
/* Whether the part has a digest and is what that was made of. */
bool lc_chunk_is_whole(const lc_image *image);
/* The build that rendered the part; "": an older one, which left neither build nor digest. */
const char *lc_chunk_build(const lc_image *image);

#endif
