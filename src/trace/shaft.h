/* shaft.h - proofs that a whole box of targets is visible from a whole block of points: nothing in the BVH
 * meets the shaft, the convex hull of the points and the box.
 *
 *     points   .---------------. box of targets      list: what of the BVH may meet the shaft
 *          .:::|:::: shaft ::::|                       (node, lanes)   children that are not opened yet
 *              '---------------'                       (block, lanes)  triangles
 *
 * Most clusters are not visible as a whole, which a hidden ray tells at no cost: ask rays first. Targets must
 * be in the box: those of lights with a surface are not in their cluster's.
 *
 * An empty list is the proof. Where one box holds another, its shaft holds the other's: a child's search
 * begins with the list of its parent, and children of a box that is proved to be visible are visible.
 *
 * A proof holds for the very answers of the kernels hidden and dimmed (bvh_data.h), their rounding and
 * LC_SHADOW_EPS included. Glass and triangles with holes count as solid, instances as their boxes.
 */
#ifndef LC_SHAFT_H
#define LC_SHAFT_H

#include "trace/bvh_data.h"

#define LC_SHAFT_POINTS 16
#define LC_SHAFT_LIST 48   /* room of a list; a full one is not opened further */
#define LC_SHAFT_KNOWN 64  /* halves of blocks that a block of points remembers */
#define LC_SHAFT_OPENED 64 /* nodes that one search opens at most */

/* Four triangles as the points see them, kept since many shafts of a block pass the same ones. */
typedef struct lc_shaft_tris {
    _Alignas(16) float v[3][3][4]; /* [corner][axis] */
    float n[3][4];                 /* N, and so on: see shaft.c */
    float h[2][4];                 /* least and greatest h of the points */
    float h_slack[4];
    float reach[4];                /* at least the largest coordinate of corners from any of the points */
    float s[3][4];
} lc_shaft_tris;

/* The points of a block: where its shadow rays start. Its searches are of one BVH, by one thread. */
typedef struct lc_shaft_from {
    lc_shaft_tris known[LC_SHAFT_KNOWN];
    uint32_t key[LC_SHAFT_KNOWN];  /* what is in `known`: block and half, or LC_NONE */
    float org[LC_SHAFT_POINTS][3]; /* world space */
    float base[3], radius[3];      /* every org_k is within radius_k of base_k */
    float reach;                   /* the largest radius */
    uint32_t n;                    /* 1 .. LC_SHAFT_POINTS */
} lc_shaft_from;

typedef struct lc_shaft_entry {
    uint32_t ref;  /* a node, or LC_BVH_LEAF | block; with LC_SHAFT_PLACED: of the BVH over the instances */
    uint32_t node; /* of a block: the node that has its box, in lane `lane` */
    uint8_t lanes; /* a bit for each child or triangle that may meet the shaft, not 0 */
    uint8_t lane;
} lc_shaft_entry;
#define LC_SHAFT_PLACED 0x40000000u

typedef struct lc_shaft_list {
    uint32_t n; /* 0: every ray is free */
    lc_shaft_entry at[LC_SHAFT_LIST];
} lc_shaft_list;

/* Added up by every search. */
typedef struct lc_shaft_work {
    uint64_t shafts, clear;
    uint64_t nodes, blocks; /* tests of eight boxes and of eight triangles */
} lc_shaft_work;

void lc_shaft_from_init(lc_shaft_from *from, const float (*org)[3], uint32_t n);

/* Lists what may meet the shaft from the points to the box of all targets t with |t_k - center_k| <= half_k;
 * far: of directions towards them, of any length. parent: the list of a box that holds this one, from the
 * same points in the same BVH; NULL: the search begins with the root. list may be the parent's. True: the
 * list is empty, so no shadow ray from any of the points to any target in the box is hidden or dimmed. */
bool lc_shaft_open(const lc_bvh_data *bvh, lc_shaft_from *from, const float center[3],
                   const float half[3], bool far, const lc_shaft_list *parent, lc_shaft_list *list,
                   lc_shaft_work *work);

#endif
