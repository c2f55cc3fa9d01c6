/* isa_tmpl.c - all kernels, in the words of the vector header that was included before; included by isa_*.c.
 */
#include "isa/isa.h"

#include "simd/fmath_tmpl.c"

#include "shade/rows_tmpl.c"

#include "shade/fresnel_tmpl.c"

#include "shade/box_tmpl.c"

#include "shade/slope_tmpl.c"

#define LC_KERNEL_PARTS
#include "shade/light_kinds.h"
#include "shade/lobes.h"
#undef LC_KERNEL_PARTS

#include "shade/bounds_tmpl.c"

#include "shade/lower_tmpl.c"

#include "shade/estimate_tmpl.c"

#include "tree/ploc_tmpl.c"

#include "trace/bvh_tmpl.c"

#include "trace/shadow_tmpl.c"

#include "cut/lists_tmpl.c"

#define LC_KERNELS                                                                                           \
    {                                                                                                        \
        .shade = { bounds, lower_bounds, estimate }, .tree = { nearest },                                    \
        .trace = { closest, hidden, dimmed }, .cut = { place, partition }                                    \
    }
