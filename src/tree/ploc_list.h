/* ploc_list.h - the live clusters in order, as arrays that the kernel of the builder ploc.c reads.
 *
 * Coordinates and intensities are scaled so that no metric overflows (ploc.c).
 */
#ifndef LC_PLOC_LIST_H
#define LC_PLOC_LIST_H

#include "base/base.h"

/* Rows of lc_ploc_list.row; the last six of oriented lights only. */
enum { LC_PLOC_LO, LC_PLOC_HI = 3, LC_PLOC_INTENSITY = 6, LC_PLOC_DLO, LC_PLOC_DHI = 10, LC_PLOC_ROWS = 13 };

#define LC_PLOC_CHUNK 256 /* greatest number of positions that the kernel searches at a time */
#define LC_PLOC_GROUP 8   /* positions of a group, in rounds whose searches stay within groups */

typedef struct lc_ploc_list {
    float *row[LC_PLOC_ROWS]; /* n + LC_LANES long; what is past n is unused */
    uint32_t n;
    bool oriented;
    float c2;                 /* weight of directions, in scaled units^2 */
} lc_ploc_list;

/* Kernels of the builder, of one instruction set. */
typedef struct lc_tree_kernels {
    /* Writes to offset[i], i < n, the distance in positions from position first + i of the list to its
     * nearest neighbour among the `radius` before it and after it, or 0 where there is none. grouped: only
     * neighbours in its group of LC_PLOC_GROUP positions count. */
    void (*nearest)(const lc_ploc_list *list, uint32_t first, uint32_t n, uint32_t radius, bool grouped,
                    float *offset);
} lc_tree_kernels;

#endif
