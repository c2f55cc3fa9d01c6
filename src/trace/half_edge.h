/* half_edge.h - which triangles of a mesh share an edge. Half-edge 3 f + k of face f runs from its corner k
 * to the next. */
#ifndef LC_TWINS_H
#define LC_TWINS_H

#include "base/context.h"

static inline uint32_t lc_half_edge_next(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
static inline uint32_t lc_half_edge_prev(uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

/* corner: n_faces * 3 vertices, n_faces * 3 < 2^32. twin[h]: the half-edge that runs along h the other way;
 * LC_NONE where there is none, as at a boundary and where two run the same way. Of three faces at an edge two
 * at most are twins. LC_ERR_MEMORY. */
lc_status lc_find_twins(const lc_context *ctx, const uint32_t *corner, uint32_t n_faces, uint32_t *twin);

#endif
