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

/* The same in a fraction of the time, by the codes' upper bits only: points that differ in the LC_MORTON_FINE
 * lowest bits alone are ordered by index. box: around all points. code[i]: of the i-th point, with all its
 * bits. */
#define LC_MORTON_FINE 30
lc_status lc_morton_coarse(const lc_context *ctx, uint32_t n, const lc_box *box,
                           lc_f3 (*place)(const void *user, uint32_t i), const void *user, uint32_t *order,
                           uint64_t *code);

#endif
