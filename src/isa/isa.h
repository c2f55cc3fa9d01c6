/* isa.h - which instruction sets have kernels (isa_list.h), and the kernels of each.
 *
 * The room isa/ compiles the templates of shade/, tree/, trace/ and cut/ once for each set; every set gives
 * the same bits. In goes the set that the user allows at most, out come tables of functions.
 */
#ifndef LC_ISA_H
#define LC_ISA_H

#include "cut/cut_list.h"
#include "lightcuts.h"
#include "shade/tree_data.h"
#include "trace/bvh_data.h"
#include "tree/ploc_list.h"

/* All kernels of one instruction set, a table for each room that calls them. */
typedef struct lc_kernels {
    lc_shade_kernels shade;
    lc_tree_kernels tree;
    lc_trace_kernels trace;
    lc_cut_kernels cut;
} lc_kernels;

/* LC_ISA_BEST + 1 .. LC_N_ISAS are the sets of isa_list.h. */
enum {
    LC_ISA_BEFORE_FIRST,
#define ISA(name, rank, test, flags) LC_ISA_ID_##name,
#include "isa/isa_list.h"
#undef ISA
    LC_ISA_AFTER_LAST,
    LC_N_ISAS = LC_ISA_AFTER_LAST - 1
};

#define ISA(name, rank, test, flags) extern const lc_kernels lc_kernels_##name;
#include "isa/isa_list.h"
#undef ISA

/* Whether CPU and operating system have it; isa: 1 .. LC_N_ISAS. */
bool lc_isa_supported(lc_isa isa);

/* Supported, and of no higher rank than the cap. */
bool lc_isa_within(lc_isa isa, lc_isa cap);

/* The supported set of the highest rank that is no higher than the cap's; cap: LC_ISA_BEST, or 1 ..
 * LC_N_ISAS. */
lc_isa lc_isa_pick(lc_isa cap);

const lc_kernels *lc_isa_kernels(lc_isa isa); /* isa: a supported one */

#endif
