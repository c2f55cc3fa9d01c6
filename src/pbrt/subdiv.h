/* subdiv.h - Loop subdivision of triangle meshes with boundaries, as in pbrt ([Loop87]).
 *
 *          c                c         The even vertices are a, b and c, moved; the odd ones, x, are near the
 *         / \              / \        midpoints of edges. Half-edge 3 f + k of face f runs from its corner k
 *        /   \     ->     x - x       to its next corner.
 *       /     \          / \ / \
 *      a ----- b        a - x - b
 *
 * An edge is a boundary if it has one face, or two that run along it in the same direction.
 */
#ifndef LC_PBRT_SUBDIV_H
#define LC_PBRT_SUBDIV_H

#include "base/arena.h"

typedef struct lc_subdiv {
    uint32_t n_verts, n_faces;
    double *pos;      /* n_verts * 3 */
    uint32_t *corner; /* n_faces * 3, each below n_verts */
} lc_subdiv;

/* One subdivision step: four faces for each, allocated in the arena. n_faces * 12 and the vertices must fit
 * 32 bits. LC_ERR_MEMORY. */
lc_status lc_subdiv_refine(lc_arena *arena, const lc_subdiv *in, lc_subdiv *out);
/* Moves the vertices to their limit positions, at boundaries by pbrt's weights, which are not exactly the
 * limit's. normal: n_verts * 3, of any length, 0 where undefined; on pbrt's side, from which corners run
 * clockwise. LC_ERR_MEMORY. */
lc_status lc_subdiv_limit(lc_arena *arena, lc_subdiv *mesh, double *normal);

#endif
