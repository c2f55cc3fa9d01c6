/* layout.h - every struct that a kernel reads; sizes asserted.
 *
 * Light tree nodes: a block is a pair of siblings, structure of arrays, two cache lines. Node ids are block * 2 + lane.
 * The bounds kernel takes several blocks at a time: a field of four is four loads of two floats into eight lanes.
 * (Blocks of 16 lanes, a cache line a field, lost: a split touched 14 lines for two nodes.)
 *
 *     lane        0     1
 *     center[0]   left  right     box of positions (directional: of unit directions towards the light) as centre and
 *     half[0]                     half extent: every member p has |p_k - center_k| <= half_k in exact arithmetic
 *     ...
 *
 * Distance floor. Estimate and bound use d2 = max(|y - x|^2, min_d2) wherever they divide by f(d), so a point on a
 * light gives a finite number; min_d2 is 1e-10 of the squared diagonal of the scene.
 */
#ifndef LC_LAYOUT_H
#define LC_LAYOUT_H

#include "light.h"

/* Estimates are exactly 0 where a cosine is at most LC_MIN_COS or M G of a channel is below LC_MIN_TRANSFER, lobes
 * where cos^n is below LC_MIN_LOBE, and M G is
 * at most LC_MAX_TRANSFER: with the limits of light.h nothing that is multiplied or summed is denormal or infinite. */
#define LC_MIN_COS 1e-9f
#define LC_MIN_LOBE 1e-12f
#define LC_MIN_TRANSFER 1e-19f
#define LC_MAX_TRANSFER 1e20f
#define LC_MIN_REFLECTANCE 1e-10f /* diffuse and specular of lc_point below this are 0 */
#define LC_TINY_D2 1e-36f /* squares of lengths below this count as this where a cosine is formed: no division by 0 */

typedef struct lc_node_block {
    float center[3][LC_BLOCK]; /* world space */
    float half[3][LC_BLOCK];   /* >= 0, rounded up */
    float atten[3][LC_BLOCK];  /* point, oriented: least A, B, C of the members */
    float power[3][LC_BLOCK];  /* summed intensity R G B, rounded up; also what the estimate uses */
    float axis[3][LC_BLOCK];   /* oriented: unit axis of the cone that holds every emission direction */
    float cos_cone[LC_BLOCK];  /* oriented: cosine of its half angle, rounded down; -1 = all directions */
} lc_node_block;
_Static_assert(sizeof(lc_node_block) == 2 * 64, "two cache lines");

/* What estimate and bound need to know of one shading point. Filled by lc_point_init (shade.h). */
typedef struct lc_point {
    float pos[3];      /* world space */
    float n[3];        /* unit shading normal, on the viewer's side */
    float mirror[3];   /* unit, 2 (n.o) n - o, o towards the viewer */
    float diffuse[3];  /* kd / pi */
    float specular[3]; /* ks (n + 2) / (2 pi) */
    float exponent;
    float min_d2;
    bool glossy;       /* some specular > 0 */
} lc_point;

/* One light as the estimate reads it: a cache line of four rows, so that a row of several lights is one transpose. */
typedef struct lc_light_rec {
    float pos[3];
    uint32_t kind; /* lc_light_kind */
    float atten[3];
    uint32_t pad_atten;
    float dir[3];  /* as lc_light.dir */
    uint32_t pad_dir;
    float intensity[3];
    uint32_t pad_intensity;
} lc_light_rec;
_Static_assert(sizeof(lc_light_rec) == 64, "one cache line");

/* Eight-wide BVH node. Lanes without a child have lo > hi. */
typedef struct lc_bvh_node {
    float lo[3][8], hi[3][8];
    uint32_t child[8]; /* node index, or LC_BVH_LEAF | block index */
    uint32_t pad[8];
} lc_bvh_node;
_Static_assert(sizeof(lc_bvh_node) == 4 * 64, "four cache lines");

/* Up to eight triangles, vertex by axis by lane. Lanes without a triangle have tri = LC_NONE and can't be hit. */
typedef struct lc_tri_block {
    float v[3][3][8]; /* [vertex][axis][lane] */
    uint32_t tri[8];
} lc_tri_block;
_Static_assert(sizeof(lc_tri_block) == 5 * 64, "five cache lines");

#define LC_BVH_LEAF 0x80000000u

#endif
