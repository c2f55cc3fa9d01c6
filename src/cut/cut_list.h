/* cut_list.h - clusters of a cut as arrays, so that eight of them are placed, moved and compared at a time.
 */
#ifndef LC_CUT_LIST_H
#define LC_CUT_LIST_H

#include "shade/tree_data.h"

/* Clusters whose bound is not 0. Kernels write up to eight elements past the end: arrays are LC_CUT_SPARE
 * longer. */
typedef struct lc_cut_list {
    uint32_t n;
    float *bound;       /* luminance, > 0 */
    uint32_t *link;     /* node, or LC_LEAF | light */
    uint32_t *rep; /* light index, and LC_PENDING while its shadow ray is to be traced: V is taken as 1 until
                      then */
    float *transfer[3]; /* M G V of the representative */
    float *e[3];        /* the estimate: transfer times power */
} lc_cut_list;

#define LC_PENDING 0x80000000u
#define LC_CUT_SPARE 16
#define LC_CUT_WORDS 9 /* an element: bound, link, rep, transfer, e */

/* The children of some clusters of a list, a pair each. */
typedef struct lc_cut_pairs {
    uint32_t n;                /* pairs */
    const lc_cut_list *parent;
    uint32_t first;            /* of the parents in it */
    const float *bound;        /* two a pair; of a leaf: anything > 0 */
    const uint32_t *link;      /* two a pair */
    const float *const *power; /* two a pair: where four floats lie, R G B of the summed power first */
    const float *fresh; /* two a pair: 1 for the child with a representative of its own, 0 for the other */
    const uint32_t *rep;       /* one a pair: that representative */
    const float *transfer[3];  /* one a pair: its M G */
    float limit;
} lc_cut_pairs;

/* Kernels over lists, of one instruction set. */
typedef struct lc_cut_kernels {
    /* Puts children into the lists: above the limit to open, else to left, leaves to leaf, bounds of 0
     * nowhere. Returns the change of the total's luminance. */
    double (*place)(const lc_cut_pairs *pairs, lc_cut_list *open, lc_cut_list *left, lc_cut_list *leaf);
    /* Moves the clusters of a list with a bound above the limit to one list, the others to another. Either
     * may be the list itself. */
    void (*partition)(lc_cut_list *from, float limit, lc_cut_list *above, lc_cut_list *rest);
} lc_cut_kernels;

#endif
