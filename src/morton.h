/* morton.h - points in the order of a space-filling curve. */
#ifndef LC_MORTON_H
#define LC_MORTON_H

#include "arena.h"

/* order[i] becomes the index of the i-th of n points along the Z curve of a grid of 2^21 cells a side; points of one cell stand
 * by index. cell(user, i, c) gives point i's cell. */
lc_status lc_morton_order(const lc_context *ctx, uint32_t n, void (*cell)(const void *user, uint32_t i, uint32_t c[3]),
                          const void *user, uint32_t *order);

#endif
