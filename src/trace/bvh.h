/* bvh.h - the eight-wide bounding volume hierarchy (BVH) over the scene's triangles. Read-only after
 * building.
 *
 * The room trace/ answers what rays hit. In go triangles; out come nearest hits (camera rays), visibility
 * (shadow rays) and the triangles near an occluder, over which whole clusters are proved to be occluded.
 *
 *     positions, indices -> lc_bvh (bvh_build.h) -> kernels closest, hidden (bvh_data.h)
 *                        -> lc_occluders (occluder.h)
 *     both               -> lc_visibility (visibility.h), all that cuts know of this room
 */
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
    const lc_trace_kernels *kernels; /* the context's; a benchmark may wrap them: lab/bench_record.h */
    const struct lc_occluders *occluders; /* over its triangles, or NULL; owned by the caller */
    bool has_glass; /* shadow rays may be dimmed, by its triangles or by instances; set by the caller */
};

/* pos: vertices * 3, finite; index: n_tris * 3, in range. Neither is kept. n_tris may be 0. LC_ERR_MEMORY. */
lc_status lc_bvh_build(const lc_context *ctx, const float *pos, const uint32_t *index, size_t n_tris,
                       lc_bvh **out);
void lc_bvh_destroy(lc_bvh *bvh);
size_t lc_bvh_bytes(const lc_bvh *bvh);
/* Returns NULL if every triangle is in exactly one block and inside all boxes above it, else what is
 * wrong. */
const char *lc_bvh_validate(const lc_bvh *bvh, const float *pos, const uint32_t *index, size_t n_tris);

#endif
