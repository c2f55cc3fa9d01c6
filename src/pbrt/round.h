/* round.h - what shapes with rotational symmetry share: rings of vertices about the z axis, triangles between
 * them. */
#ifndef LC_PBRT_ROUND_H
#define LC_PBRT_ROUND_H

#include "pbrt/shape_handler.h"

typedef struct lc_pbrt_sweep {
    double degrees; /* 0 <= degrees <= 360 */
    uint32_t n;     /* segments */
} lc_pbrt_sweep;

#define LC_PBRT_ROUND_SEGMENTS 128 /* around the first shapes of a file; see round.c */
#define LC_PBRT_MOVING_SEGMENTS 48 /* at most, around lamps that move, which have lights at many places */
/* The number of segments around the next round shape for a full turn; it decreases with the triangles made so
 * far. */
uint32_t lc_pbrt_segments(const lc_pbrt *p);
/* Reads phimax. A partial sweep has a proportional number of segments, at least three. */
lc_status lc_pbrt_get_sweep(lc_pbrt *p, uint32_t segments, lc_pbrt_sweep *out);
/* Makes the triangles between rings of `around` + 1 vertices each, of which the first starts at vertex 0, and
 * returns their number. Degenerate triangles at a tip are omitted. */
uint32_t lc_pbrt_join_rings(lc_pbrt *p, uint32_t n_rings, uint32_t around, bool tip_first, bool tip_last);
/* Sets the texture coordinates of the ring that starts at vertex `first`: u increases around it, v is
 * constant. */
void lc_pbrt_ring_uv(lc_pbrt *p, size_t first, uint32_t around, double v);
/* Sets *mesh and *area_ratio from the shape's exact area, and counts the triangles. */
void lc_pbrt_finish_round(lc_pbrt *p, lc_pbrt_mesh *mesh, uint32_t n_verts, uint32_t n_tris, bool normals,
                          double exact, double *area_ratio);
/* Notes that the shape has no area and is skipped. */
lc_status lc_pbrt_no_area(lc_pbrt *p, const lc_pbrt_stmt *s);

#endif
