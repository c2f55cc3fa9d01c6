/* morton.h - sorts points along a space-filling curve, the Z curve of Morton codes. */
#ifndef LC_MORTON_H
#define LC_MORTON_H

#include "base/arena.h"
#include "base/vec.h"

/* Sets order[i] to the index of the i-th of n points along the curve; place(user, i) returns point i, from
 * any thread. The curve passes through the 2^63 cells of the cube around all points. Where more than
 * LC_MORTON_FEW points share a cell it passes through the cells of the cube around those, and so on, so that
 * outliers do not coarsen the order of the others. Points that remain equal are ordered by index. The order
 * does not depend on the number of threads. LC_ERR_MEMORY. */
#define LC_MORTON_FEW 16
lc_status lc_morton_order(const lc_context *ctx, uint32_t n, lc_f3 (*place)(const void *user, uint32_t i),
                          const void *user, uint32_t *order);

/* The same in a fraction of the time, by fewer cells: a point's key has its place along the curve in the
 * upper half, its index in the lower. cell: below LC_MORTON_CELLS; the lowest bit of the one along z does
 * not count. */
#define LC_MORTON_CELLS 2048
static inline uint64_t lc_morton_key(const uint32_t cell[3], uint32_t index)
{
    uint64_t code = 0;
    for (int k = 0; k < 3; k++) { /* moves the bits to every third */
        uint64_t x = cell[k];
        x = (x | x << 16) & 0x070000ff;
        x = (x | x << 8) & 0x0700f00f;
        x = (x | x << 4) & 0x430c30c3;
        x = (x | x << 2) & 0x49249249;
        code |= x << (2 - k);
    }
    return code >> 1 << 32 | index;
}
/* Sorts n keys by their upper halves; equal ones keep their order. Returns key or spare, whichever then holds
 * them, or NULL if there is no memory. */
uint64_t *lc_morton_sort_keys(const lc_context *ctx, uint32_t n, uint64_t *key, uint64_t *spare);

#endif
