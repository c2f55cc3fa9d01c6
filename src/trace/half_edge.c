/* half_edge.c - matches half-edges by a hash table of vertex pairs, with open addressing. */
#include "trace/half_edge.h"

#include "base/arena.h"
#include "base/rng.h"

#include <string.h>

lc_status lc_find_twins(const lc_context *ctx, const uint32_t *corner, uint32_t n_faces, uint32_t *twin)
{
    uint32_t n = 3 * n_faces;
    size_t cap = 16;
    while (cap < 2 * (size_t)n) cap *= 2;
    uint32_t *slots = lc_alloc_raw(ctx, cap, sizeof *slots);
    if (!slots) return LC_ERR_MEMORY;
    memset(slots, 0xff, cap * sizeof *slots);
    for (uint32_t h = 0; h < n; h++) {
        uint32_t a = corner[h], b = corner[lc_half_edge_next(h)], lo = a < b ? a : b, hi = a < b ? b : a;
        size_t i = lc_mix((uint64_t)lo << 32 | hi) & (cap - 1);
        twin[h] = LC_NONE;
        for (;; i = (i + 1) & (cap - 1)) {
            uint32_t o = slots[i];
            if (o == LC_NONE) break;
            uint32_t c = corner[o], d = corner[lc_half_edge_next(o)];
            if ((c < d ? c : d) != lo || (c < d ? d : c) != hi) continue;
            if (c == b && twin[o] == LC_NONE && a != b) {
                twin[h] = o;
                twin[o] = h;
            }
            break; /* the table keeps the first half-edge of an edge: a third face finds it taken */
        }
        slots[i] = slots[i] == LC_NONE ? h : slots[i];
    }
    lc_free(ctx, slots, cap, sizeof *slots);
    return LC_OK;
}
