/* bvh.h - the eight-wide bounding volume hierarchy over the scene's triangles. Read-only after building. */
#ifndef LC_BVH_H
#define LC_BVH_H

#include "base/arena.h"
#include "trace/bvh_data.h"

typedef struct lc_bvh lc_bvh;
struct lc_bvh {
    const lc_context *ctx;
    lc_bvh_data data;
    lc_bvh_node *nodes;
    lc_tri_block *blocks;
    const lc_trace_kernels *kernels; /* the context's, unless somebody listens: bench_record.h */
    const struct lc_occluders *occluders; /* of its triangles, or NULL; not its own */
};

/* pos: vertices * 3; index: n_tris * 3, in range; numbers finite. n_tris may be 0. */
lc_status lc_bvh_build(const lc_context *ctx, const float *pos, const uint32_t *index, size_t n_tris,
                       lc_bvh **out);
void lc_bvh_destroy(lc_bvh *bvh);
size_t lc_bvh_bytes(const lc_bvh *bvh);
/* NULL when every triangle is in exactly one block and inside all boxes above it, else what is wrong. */
const char *lc_bvh_validate(const lc_bvh *bvh, const float *pos, const uint32_t *index, size_t n_tris);

#endif
