/* half_edge.h - which triangles of a mesh share an edge. Half-edge 3 f + k of face f runs from its corner k
 * to its next corner. */
#ifndef LC_HALF_EDGE_H
#define LC_HALF_EDGE_H

#include "base/context.h"

static inline uint32_t lc_half_edge_next(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
static inline uint32_t lc_half_edge_prev(uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

/* corner: n_faces * 3 vertex ids; n_faces * 3 < 2^32. Sets twin[h], n_faces * 3, to the half-edge that
 * connects the same vertices as h in the opposite direction; LC_NONE at a boundary and where both faces have
 * the same direction. Of three faces at an edge at most two become twins. LC_ERR_MEMORY. */
lc_status lc_find_twins(const lc_context *ctx, const uint32_t *corner, uint32_t n_faces, uint32_t *twin);

#endif
