/* layout.h - every struct that a kernel reads; sizes asserted.
 *
 * Light tree: a cluster is a cache line, a light half of one, each in rows of four words, so that kernels load a row of as
 * many clusters or lights as they have lanes and transpose it. Lights are the leaves: there is no node for them. 96 bytes a
 * light, if it falls off as 1/d^2; other attenuation lies in arrays of its own.
 * (Blocks of 16 lanes, a cache line a field, lost: a split touched 14 lines for two nodes. Pairs of siblings with nodes for
 * the leaves too were as fast, at 209 bytes a light.)
 *
 * Distance floor. Estimate and bound use d2 = max(|y - x|^2, min_d2) wherever they divide by f(d), so a point on a
 * light gives a finite number; min_d2 is 1e-10 of the squared diagonal of the scene.
 */
#ifndef LC_LAYOUT_H
#define LC_LAYOUT_H

#include "light.h"
#include "material.h"

/* Estimates are exactly 0 where a cosine is at most LC_MIN_COS or M G of a channel is below LC_MIN_TRANSFER, lobes
 * where cos^n or e^-x is below LC_MIN_LOBE, and M G is
 * at most LC_MAX_TRANSFER: with the limits of light.h nothing that is multiplied or summed is denormal or infinite. */
#define LC_MIN_COS 1e-9f
#define LC_MIN_LOBE 1e-12f
#define LC_MIN_TRANSFER 1e-19f
#define LC_MAX_TRANSFER 1e20f
#define LC_WARD_MIN_COS 0.02f /* under the root of Ward's lobe cosines are no less: see material.h */
#define LC_TINY_PART 1e-20f /* of a complex index, where that is divided by */
#define LC_MIN_REFLECTANCE 1e-10f /* diffuse and specular of lc_point below this are 0 */
#define LC_TINY_D2 1e-36f /* squares of lengths below this count as this where a cosine is formed: no division by 0 */

/* A cluster of at least two lights. Its box is of positions (directional: of unit directions towards the light) as centre and
 * half extent: every member p has |p_k - center_k| <= half_k in exact arithmetic. A child is a node, or LC_LEAF | light. */
typedef struct lc_node {
    float center[3];   /* world space */
    float cos_cone;    /* oriented, spot: cosine of the cone's half angle, rounded down; -1 = all directions */
    float half[3];     /* >= 0, rounded up */
    uint32_t left;     /* child */
    float power[3];    /* summed intensity R G B, rounded up; also what the estimate uses */
    uint32_t right;    /* child */
    float axis[3];     /* oriented, spot: unit axis of the cone that holds every emission direction */
    uint32_t rep;      /* of slot 0: the light that represents it, which represents one of its children, too */
} lc_node;
_Static_assert(sizeof(lc_node) == 64, "a cache line");

#define LC_LEAF 0x80000000u

/* One light as the estimate reads it. Where the kind's place in the tree is needed it follows from the index. */
typedef struct lc_light_rec {
    float pos[3];       /* directional: unit direction towards the light */
    uint32_t dir_a;     /* oriented, spot: the way light travels, see direction.h */
    float intensity[3];
    uint32_t dir_b;
} lc_light_rec;
_Static_assert(sizeof(lc_light_rec) == 32, "half a cache line");

#define LC_DIR_FLAG 0x40000000u
#define LC_DIR_SIGN 1u

/* A, B, C of f(d), and a word unused: of a light, or the least ones of a cluster. */
typedef float lc_atten[4];

/* What the kernels read of a light tree. Attenuation arrays are NULL where all are 0, 0, 1: inverse square. */
typedef struct lc_tree_data {
    lc_node *nodes;
    lc_light_rec *lights;
    lc_atten *node_atten, *light_atten;
    lc_spot_rec *node_spot, *light_spot; /* of spots alone, whose first node and light are: */
    uint32_t first_spot_node, first_spot_light;
    const lc_spot_map *spot_maps;
} lc_tree_data;

typedef enum lc_lobe { LC_LOBE_NONE, LC_LOBE_PHONG, LC_LOBE_WARD, LC_LOBE_GGX } lc_lobe; /* beside the diffuse one */

/* What estimate and bound need to know of one shading point. Filled by lc_point_init (shade.h). */
typedef struct lc_point {
    float pos[3];      /* world space */
    float n[3];        /* unit shading normal, on the viewer's side */
    float ng[3];       /* geometric normal, on that side: lights behind are hidden; 0: not known, or n. lc_point_init leaves it 0. */
    float mirror[3];   /* unit, 2 (n.o) n - o, o towards the viewer */
    float diffuse[3];  /* kd / pi */
    float specular[3]; /* Phong: ks (n + 2) / (2 pi); Ward: ks / (4 pi ax ay sqrt(co)); GGX: ks / (2 pi ax ay) */
    float exponent;
    float min_d2;
    lc_lobe lobe;      /* LC_LOBE_NONE where specular is 0, but below a coat */
    /* Ward, GGX: h along these is what is squared. */
    float tangent[2][3]; /* unit tangent over ax, bitangent over ay */
    float view[3];       /* tangent.o, bitangent.o, n.o >= 0 */
    float sharp;         /* no less than the tangents' lengths */
    /* GGX */
    lc_fresnel fresnel;
    bool coat;           /* diffuse lies below it, what passes on the way out counted already */
    float to_view[3];    /* unit, world space, not below the horizon */
    float square[2];     /* ax^2, ay^2 */
    float masking;       /* length of (ax o.x, ay o.y, o.z) */
    float rise[3];       /* Schlick: what specular grows by towards grazing; conductor: eta^2 - k^2 - 1 */
    float turn[3];       /* conductor: 2 eta k */
    float eta2, bend;    /* dielectric, coat: eta^2, eta^2 - 1 */
} lc_point;

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
