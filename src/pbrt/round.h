/* round.h - what round shapes share: rings of vertices about the z axis, and the triangles between them. */
#ifndef LC_PBRT_ROUND_H
#define LC_PBRT_ROUND_H

#include "pbrt/state.h"

typedef struct lc_pbrt_sweep {
    double degrees; /* 0 <= degrees <= 360 */
    uint32_t n;     /* segments */
} lc_pbrt_sweep;

#define LC_PBRT_ROUND_SEGMENTS 128 /* at first */
/* Segments around of the next round shape, were it whole; after many triangles it has fewer. */
uint32_t lc_pbrt_segments(const lc_pbrt *p);
/* Reads phimax; a partial sweep has as many segments as its share, at least three. */
lc_status lc_pbrt_get_sweep(lc_pbrt *p, uint32_t segments, lc_pbrt_sweep *out);
/* Triangles between rings of `around` + 1 vertices each, the first ring's at index 0. At a tip those without
 * area are left out. */
uint32_t lc_pbrt_join_rings(lc_pbrt *p, uint32_t n_rings, uint32_t around, bool tip_first, bool tip_last);
/* Texture coordinates of a ring whose first vertex is given: u goes around, v is the same. */
void lc_pbrt_ring_uv(lc_pbrt *p, size_t first, uint32_t around, double v);
/* Sets counts and arrays; *area_ratio: exact area over that of the triangles. */
void lc_pbrt_finish_round(lc_pbrt *p, lc_mesh_desc *mesh, uint32_t n_verts, uint32_t n_tris, bool normals,
                          double exact, double *area_ratio);
lc_status lc_pbrt_no_area(lc_pbrt *p, const lc_pbrt_stmt *s); /* notes it */

#endif
