/* subdiv.h - Loop subdivision of triangle meshes with boundaries, as pbrt does it.
 *
 *          c                c
 *         / \              / \        even vertices are a, b, c moved; odd ones lie near the middles of
 * edges. /   \     ->     x - x       Half-edge 3 f + k of face f runs from its corner k to the next.
 *       /     \          / \ / \
 *      a ----- b        a - x - b
 *
 * Edges of one face, or of two that run along them the same way, are boundary.
 */
#ifndef LC_SUBDIV_H
#define LC_SUBDIV_H

#include "base/arena.h"

typedef struct lc_subdiv {
    uint32_t n_verts, n_faces;
    double *pos;      /* n_verts * 3 */
    uint32_t *corner; /* n_faces * 3, each below n_verts */
} lc_subdiv;

/* Four faces for each, in the arena. n_faces * 12 and the vertices fit 32 bits. LC_ERR_MEMORY. */
lc_status lc_subdiv_refine(lc_arena *arena, const lc_subdiv *in, lc_subdiv *out);
/* Moves the vertices to where they come to lie after infinitely many steps, at a boundary by pbrt's weights,
 * which are a little off. Normals of that surface: n_verts * 3, of any length, 0 where there is none; their
 * side is pbrt's: where corners run clockwise. LC_ERR_MEMORY. */
lc_status lc_subdiv_limit(lc_arena *arena, lc_subdiv *mesh, double *normal);

#endif
