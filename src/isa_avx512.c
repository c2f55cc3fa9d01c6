/* isa_avx512.c - the kernels, compiled for this instruction set. The BVH stays at eight lanes: a node has no more. */
#define LC_ISA_LEVEL 3
#define LC_HALF_AS_WIDE lc_kernels_avx2 /* for what is left of a list */
#define LC_FN(name) name##_avx512
#include "kernels.h"
#include "simd.h"
#include "simd_list.h"
#include "simd_ray.h"
#include "simd_wide.h"

#include "fmath_tmpl.c"
#include "fresnel_tmpl.c"
#include "bounds_tmpl.c"
#include "bvh_tmpl.c"
#include "stream_tmpl.c"
#include "cut_tmpl.c"
#include "shade_tmpl.c"
#include "ploc_tmpl.c"

const lc_kernels LC_FN(lc_kernels) = { LC_FN(bounds), LC_FN(estimate), LC_FN(place), LC_FN(partition), LC_FN(closest), LC_FN(hidden),
                                      LC_FN(nearest) };
