/* dir_pack.h - a unit vector in two words.
 *
 * The two smaller components, a and b, are kept, and the largest is computed: w = +- sqrt(1 - a^2 - b^2).
 * |a|, |b| < 1, so bit 30 of both is free, LC_DIR_FLAG: set in a, w is x; set in b, w is y; else z.
 * LC_DIR_SIGN of a is the sign of w. Length: within 2^-23 of 1; components: within 2^-22 of those packed.
 */
#ifndef LC_DIR_PACK_H
#define LC_DIR_PACK_H

#include "shade/tree_data.h"

void lc_dir_pack(lc_f3 d, uint32_t word[2]); /* d: unit */
lc_f3 lc_dir_unpack(const uint32_t word[2]);

/* The nearest direction that packs without loss: lc_dir_unpack gives exactly its bits. */
lc_f3 lc_dir_round(lc_f3 d);

#endif
