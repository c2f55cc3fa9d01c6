/* occluder.h - the largest opaque triangles of the world, and which of them share an edge: what
 * occlusion_proof.h walks over to prove that a whole cluster is hidden. Read-only after building.
 *
 * Bytes: 64 a triangle, of LC_MAX_OCCLUDERS at most, and 1.5 bits for each triangle of the world. */
#ifndef LC_OCCLUDER_H
#define LC_OCCLUDER_H

#include "base/arena.h"

/* 262,144. Small triangles beside so many larger ones hide little, and a patch of few of them less. */
#define LC_MAX_OCCLUDERS LC_SIZE((uint32_t)1 << 18, 64)

typedef struct lc_occluder {
    float v[3]
           [4]; /* axis by vertex, world space, -0 as 0; last: N, what edge 0 1 times edge 0 2 is in floats */
    uint32_t next[3]; /* the occluder across the edge from vertex k to the next one, wound the same way;
                         LC_NONE: none */
    float n1;         /* |N_x| + |N_y| + |N_z| */
} lc_occluder;
_Static_assert(sizeof(lc_occluder) == 64, "a cache line");

typedef struct lc_occluders {
    const lc_context *ctx;
    lc_occluder *all; /* in the order of their triangles */
    uint32_t n, n_words;
    uint64_t *bits;   /* triangle t is one: bit t % 64 of word t / 64 */
    uint32_t *rank;   /* occluders before each word */
} lc_occluders;

typedef struct lc_occluders_desc {
    const float *pos;           /* vertices * 3 */
    const uint32_t *index;      /* n_tris * 3 */
    size_t n_tris;              /* triangles 0 .. n_tris - 1 of the scene */
    const uint32_t *has_holes;  /* a bit for each triangle, 32 in a word; NULL: none has */
} lc_occluders_desc;

lc_status lc_occluders_build(const lc_context *ctx, const lc_occluders_desc *desc, lc_occluders **out);
void lc_occluders_destroy(lc_occluders *occluders); /* NULL is fine */

/* The occluder that is this triangle; LC_NONE: it is none. */
static inline uint32_t lc_occluder_of(const lc_occluders *o, uint32_t tri)
{
    if (tri / 64 >= o->n_words) return LC_NONE;
    uint64_t word = o->bits[tri / 64], bit = (uint64_t)1 << tri % 64;
    return word & bit ? o->rank[tri / 64] + (uint32_t)__builtin_popcountll(word & (bit - 1)) : LC_NONE;
}

#endif
