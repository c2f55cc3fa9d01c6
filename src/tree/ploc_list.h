/* ploc_list.h - what the kernel of the builder reads: the clusters that are left, in order, as arrays.
 *
 * Coordinates and powers are scaled so that no metric overflows (ploc.c).
 */
#ifndef LC_PLOC_LIST_H
#define LC_PLOC_LIST_H

#include "base/base.h"

/* Rows of lc_ploc_list.row; the last six of oriented lights only. */
enum { LC_PLOC_LO, LC_PLOC_HI = 3, LC_PLOC_POWER = 6, LC_PLOC_DLO, LC_PLOC_DHI = 10, LC_PLOC_ROWS = 13 };

#define LC_PLOC_CHUNK 256 /* positions that the kernel is asked for at a time, at most */
#define LC_PLOC_GROUP 8   /* positions of a group, where searches are kept to groups */

typedef struct lc_ploc_list {
    float *row[LC_PLOC_ROWS]; /* LC_LANES longer than n, the rest of any value */
    uint32_t n;
    bool oriented;
    float c2;                 /* weight of directions, in scaled units^2 */
} lc_ploc_list;

/* Kernels of the builder, of one instruction set. */
typedef struct lc_tree_kernels {
    /* offset[i] leads from position first + i of the list, i < n, to its nearest neighbour among the `radius`
     * before and behind it, or is 0 where it has none. grouped: of its group of LC_PLOC_GROUP positions only.
     */
    void (*nearest)(const lc_ploc_list *list, uint32_t first, uint32_t n, uint32_t radius, bool grouped,
                    float *offset);
} lc_tree_kernels;

#endif
