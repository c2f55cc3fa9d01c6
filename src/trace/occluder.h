/* occluder.h - the largest opaque triangles of the world, and which of them share an edge:
 * cut/occlusion_proof.h walks over them to prove that a whole cluster is occluded. Read-only after building.
 *
 * Memory: 64 bytes an occluder, LC_MAX_OCCLUDERS at most, and 1.5 bits for each triangle of the world.
 */
#ifndef LC_OCCLUDER_H
#define LC_OCCLUDER_H

#include "base/arena.h"

/* Limits the memory, to 16 MB: triangles smaller than so many others occlude little. Chosen. */
#define LC_MAX_OCCLUDERS LC_SIZE((uint32_t)1 << 18, 64)

typedef struct lc_occluder {
    float v[3][4];    /* [axis][vertex], world space, -0 stored as 0; column 3: the normal N, the cross
                       * product of edges 0-1 and 0-2 as rounded in float */
    uint32_t next[3]; /* the occluder of the same orientation across the edge from vertex k; or LC_NONE */
    float n1;         /* |N_x| + |N_y| + |N_z| */
} lc_occluder;
_Static_assert(sizeof(lc_occluder) == 64, "a cache line");

typedef struct lc_occluders {
    const lc_context *ctx;
    lc_occluder *all; /* n, in the order of their triangles */
    uint32_t n, n_words;
    uint64_t *bits;   /* n_words: bit t % 64 of word t / 64 is set if triangle t is an occluder */
    uint32_t *rank;   /* n_words: the number of occluders before each word */
} lc_occluders;

typedef struct lc_occluders_desc {
    const float *pos;          /* vertices * 3 */
    const uint32_t *index;     /* n_tris * 3 */
    size_t n_tris;             /* triangles 0 .. n_tris - 1 of the scene: those of the world */
    const uint32_t *may_pass; /* a bit for each triangle, 32 a word, set if light may pass it; NULL: none */
} lc_occluders_desc;

/* LC_ERR_MEMORY. */
lc_status lc_occluders_build(const lc_context *ctx, const lc_occluders_desc *desc, lc_occluders **out);
void lc_occluders_destroy(lc_occluders *occluders); /* NULL is fine */

/* The index of the occluder that is triangle tri of the scene, or LC_NONE. */
static inline uint32_t lc_occluder_of(const lc_occluders *o, uint32_t tri)
{
    if (tri / 64 >= o->n_words) return LC_NONE;
    uint64_t word = o->bits[tri / 64], bit = (uint64_t)1 << tri % 64;
    return word & bit ? o->rank[tri / 64] + (uint32_t)__builtin_popcountll(word & (bit - 1)) : LC_NONE;
}

#endif
