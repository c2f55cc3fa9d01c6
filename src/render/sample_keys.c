/* sample_keys.c - see sample_keys.h. */
#include "render/sample_keys.h"

#include "render/pixel_sights.h"

/* Picks a pixel's slot of representatives. The pixels of a block have 16 numbers in an order of its own, so
 * with at most as many slots all are in it equally often, and the block's mean is better than that of any 16
 * choices; samples of a pixel go on from its number, which is in the lowest four bits. Measured:
 * tests/results/representatives.md. */
uint64_t lc_slot_hash(const lc_render_job *j, uint32_t x, uint32_t y, uint32_t i)
{
    if (j->scene->tree->n_reps == 1) return 0;
    const uint64_t block = lc_pixel_number(j, x - x % LC_PIXEL_BLOCK, y - y % LC_PIXEL_BLOCK),
                   h = lc_job_key(j, block, 0, LC_DIM_SLOT);
    return h >> 32 << 4 |
           ((lc_permute16(y % LC_PIXEL_BLOCK * LC_PIXEL_BLOCK + x % LC_PIXEL_BLOCK, h) + 5 * i) & 15);
}

uint64_t lc_worker_slot(const lc_render_job *j, const lc_render_worker *w, uint32_t x, uint32_t y, uint32_t i)
{
    const uint32_t side = w->of_knots ? LC_PIXEL_BLOCK : 1;
    return lc_slot_hash(j, x / side, y / side, i + w->slot_shift);
}

lc_sample_keys lc_sample_keys_of(const lc_render_job *j, const lc_render_worker *w, uint32_t x, uint32_t y,
                                 uint32_t i)
{
    const uint64_t own = lc_slot_hash(j, x, y, i), slot = w ? lc_worker_slot(j, w, x, y, i) : own;
    return (lc_sample_keys){ slot, own, lc_job_key(j, lc_pixel_number(j, x, y), 0, LC_DIM_NEAR), i };
}
