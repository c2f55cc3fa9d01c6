/* isa_avx512.c - the kernels, compiled for this instruction set. The BVH stays at eight lanes: a node has no
 * more. */
#define LC_ISA_LEVEL 3
#define LC_HALF_AS_WIDE lc_kernels_avx2 /* for what is left of a list */
#define LC_FN(name) name##_avx512
#include "isa/isa.h"
#include "simd/simd.h"
#include "simd/simd_list.h"
#include "simd/simd_ray.h"
#include "simd/simd_wide.h"

#include "simd/fmath_tmpl.c"
#include "shade/fresnel_tmpl.c"
#include "shade/bounds_tmpl.c"
#include "trace/bvh_tmpl.c"
#include "trace/shadow_tmpl.c"
#include "cut/lists_tmpl.c"
#include "shade/estimate_tmpl.c"
#include "tree/ploc_tmpl.c"

const lc_kernels LC_FN(lc_kernels) = {
    .shade = { LC_FN(bounds), LC_FN(estimate) },
    .tree = { LC_FN(nearest) },
    .trace = { LC_FN(closest), LC_FN(hidden) },
    .cut = { LC_FN(place), LC_FN(partition) },
};
