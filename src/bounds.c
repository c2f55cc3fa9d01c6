/* bounds.c - one block at a time, for tests and for the few places that need no more. */
#include "bounds.h"

#include "kernels.h"

void lc_bounds_block(const lc_node_block *block, uint32_t first, uint32_t n, lc_light_kind kind, const lc_point *point,
                     float ub[LC_BLOCK])
{
    const uint32_t pair = 0;
    _Alignas(64) float all[LC_LANES];
    lc_kernels_scalar.bounds(block, &pair, 1, kind, point, all);
    for (uint32_t k = first; k < first + n; k++) ub[k] = all[k];
}
