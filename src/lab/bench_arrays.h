/* bench_arrays.h - a light tree as a structure of arrays, for `lightcuts bench layout` to time against the
 * renderer's array of records (shade/tree_data.h).
 *
 *     block    16 clusters: 16 rows of 16 words, a cache line a row
 *     row       0-2      3-5      6-8      9          10-12   13     14     15
 *               centre   half     power    cos_cone   axis    left   right  rep
 *               x y z    x y z    R G B               x y z
 *
 * Cluster i is lane i % 16 of block i / 16. The bounds are those of shade/bounds_tmpl.c in the simplest case,
 * operation by operation: point lights of inverse square and a receiver that is only diffuse. The
 * same rounding gives the same bits.
 */
#ifndef LC_BENCH_ARRAYS_H
#define LC_BENCH_ARRAYS_H

#include "isa/isa.h"
#include "tree/light_tree.h"

enum {
    ROW_CENTER = 0,
    ROW_HALF = 3,
    ROW_POWER = 6,
    ROW_COS_CONE = 9,
    ROW_AXIS = 10,
    ROW_LEFT = 13,
    ROW_RIGHT = 14,
    ROW_REP = 15,
    N_ROWS = 16,
    N_BOUND_ROWS = 9, /* that a bound reads: centre, half, power */
    N_LINK_ROWS = 3   /* that a split reads besides */
};
#define BLOCK_WORDS (N_ROWS * LC_LANES)

typedef struct bench_arrays {
    float *word; /* n_blocks * BLOCK_WORDS; links as their bits; the last block repeats the last cluster */
    uint32_t n_nodes, n_blocks;
} bench_arrays;

/* LC_ERR_MEMORY. Free it also then. */
lc_status bench_arrays_init(const lc_context *ctx, const lc_tree_data *tree, uint32_t n_nodes,
                            bench_arrays *out);
void bench_arrays_free(const lc_context *ctx, bench_arrays *a);

/* What the bounds need of a point, found once a call. */
typedef struct bench_receiver {
    float pos[3], n[3], abs_n[3];
    float weight[3]; /* of the power's R G B in the bound */
    float min_d2;
} bench_receiver;
bench_receiver bench_receiver_of(const lc_point *p);

/* ub[i]: bound of cluster index[i], or of i where index is NULL. ub has room for n rounded up to LC_LANES. */
typedef void bench_array_bounds_fn(const float *word, const uint32_t *index, uint32_t n,
                                   const bench_receiver *r, float *ub);
/* The same loop, compiled for the instruction set. */
bench_array_bounds_fn *bench_array_bounds(lc_isa isa);

#if defined(__x86_64__)
bench_array_bounds_fn bench_array_bounds_avx2, bench_array_bounds_avx512; /* isa_avx_arrays.c */
#endif

#endif
