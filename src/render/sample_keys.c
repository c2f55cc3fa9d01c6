/* sample_keys.c - see sample_keys.h. */
#include "render/sample_keys.h"

#include "render/pixel_sights.h"

static uint32_t number_in_block(uint32_t x, uint32_t y, uint64_t key)
{
    return lc_permute16(y % LC_PIXEL_BLOCK * LC_PIXEL_BLOCK + x % LC_PIXEL_BLOCK, key);
}

/* Picks a pixel's slot of representatives. The pixels of a block have 16 numbers in an order of its own, so
 * with at most as many slots all are in it equally often, and the block's mean is better than that of any 16
 * choices; samples of a pixel go on from its number, which is in the lowest four bits. Measured:
 * tests/results/representatives.md. */
uint64_t lc_slot_hash(const lc_render_job *j, uint32_t x, uint32_t y, uint32_t i)
{
    const uint64_t block = lc_pixel_number(j, x - x % LC_PIXEL_BLOCK, y - y % LC_PIXEL_BLOCK),
                   h = lc_job_key(j, block, 0, LC_DIM_SLOT);
    return (h & ~(uint64_t)15) | ((number_in_block(x, y, h) + 5 * i) & 15);
}

/* The numbers of samples in their block (lc_turn): a pixel's are in a row, in an order of its own that begins
 * with another one of the first 16. */
static uint64_t point_hash(const lc_render_job *j, uint32_t x, uint32_t y, uint32_t i)
{
    const uint64_t slot = lc_slot_hash(j, x, y, i);
    uint32_t bits = 4; /* of the number of samples of a pixel; 4 of the 16 of lc_turn are the pixel's */
    while (bits < 12 && (uint64_t)1 << bits < j->spp) bits++;
    const uint32_t of_pixel = (i & ((1u << bits) - 16)) | (uint32_t)(slot & 15),
                   of_block = number_in_block(x, y, slot >> 4) << bits | of_pixel;
    return (slot & ~(uint64_t)0xffff) | (of_block & 0xffff);
}

uint64_t lc_worker_slot(const lc_render_job *j, const lc_render_worker *w, uint32_t x, uint32_t y, uint32_t i)
{
    const uint32_t side = w->of_knots ? LC_PIXEL_BLOCK : 1;
    return lc_slot_hash(j, x / side, y / side, i + w->slot_shift);
}

lc_sample_keys lc_sample_keys_of(const lc_render_job *j, const lc_render_worker *w, uint32_t x, uint32_t y,
                                 uint32_t i)
{
    const uint64_t slot = w ? lc_worker_slot(j, w, x, y, i) : lc_slot_hash(j, x, y, i);
    const uint64_t near = lc_job_key(j, lc_pixel_number(j, x, y), 0, LC_DIM_NEAR);
    return (lc_sample_keys){ slot, point_hash(j, x, y, i), near, i };
}
