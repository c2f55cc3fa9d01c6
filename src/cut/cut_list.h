/* cut_list.h - lists of clusters, and the table of the kernels over them.
 *
 * A list is one array for each field, so that kernels place, compare and move as many clusters at a time as
 * they have lanes:
 *
 *     bound     b0 b1 b2 ...
 *     link      l0 l1 l2 ...
 *     ...
 */
#ifndef LC_CUT_LIST_H
#define LC_CUT_LIST_H

#include "shade/tree_data.h"

/* Clusters whose bound is above 0. Kernels write up to eight elements past the end, so arrays are
 * LC_CUT_SPARE elements longer than what they hold. */
typedef struct lc_cut_list {
    uint32_t n;
    float *bound;       /* luminance, > 0 */
    uint32_t *link;     /* node, or LC_LEAF | light */
    uint32_t *rep;      /* representative's index; with LC_PENDING while its shadow ray is not yet traced */
    float *transfer[3]; /* M G V of the representative, R G B; V = 1 while the ray is pending */
    float *e[3];        /* the estimate, R G B: transfer times summed intensity */
    float *weight;      /* by which the bound was multiplied, see evidence.h; mostly 1 */
} lc_cut_list;

#define LC_PENDING 0x80000000u
#define LC_CUT_SPARE 16
#define LC_CUT_WORDS 10 /* of an element: bound, link, rep, transfer, e, weight */

/* The children of n clusters of a list, a pair for each. */
typedef struct lc_cut_pairs {
    uint32_t n;
    const lc_cut_list *parent;
    uint32_t first;            /* the parents are first .. first + n - 1 of the list */
    const float *bound;        /* two for each pair, without weight; any value > 0 for a light */
    const uint32_t *link;      /* two for each pair */
    const float *const
        *intensity;            /* two for each pair: four readable floats, the first R G B of the intensity */
    const float *fresh;        /* two for each pair: 1 for the child whose representative is new, 0 for the
                                  child that has its parent's */
    const uint32_t *rep;       /* one for each pair: the new representative */
    const float *transfer[3];  /* one for each pair: its M G */
    float limit;
} lc_cut_pairs;

/* Kernels over lists, of one instruction set. */
typedef struct lc_cut_kernels {
    /* Appends clusters with a bound above the limit to `open`, other clusters to `kept`, lights to `leaf`;
     * children whose bound is 0 are dropped. Returns the change of the total's luminance. */
    double (*place)(const lc_cut_pairs *pairs, lc_cut_list *open, lc_cut_list *kept, lc_cut_list *leaf);
    /* Moves the clusters of a list with a bound above the limit to `above`, the others to `rest`. Either may
     * be the list itself. */
    void (*partition)(lc_cut_list *from, float limit, lc_cut_list *above, lc_cut_list *rest);
} lc_cut_kernels;

#endif
