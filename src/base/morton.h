/* morton.h - points in the order of a space-filling curve. */
#ifndef LC_MORTON_H
#define LC_MORTON_H

#include "base/arena.h"
#include "base/vec.h"

/* order[i] becomes the index of the i-th of n points along the Z curve, place(user, i) being point i. The
 * curve runs through the 2^63 cells of the cube about the points, and where more than LC_MORTON_FEW share a
 * cell, through those of the cube about these, and so on: points far from all others don't coarsen it. Points
 * still equal stand by index. */
#define LC_MORTON_FEW 16
lc_status lc_morton_order(const lc_context *ctx, uint32_t n, lc_f3 (*place)(const void *user, uint32_t i),
                          const void *user, uint32_t *order);

#endif
