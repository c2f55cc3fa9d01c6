/* host.h - trees and shaders of a host that has surfaces and a ray tracer of its own.
 *
 *     host_lights.c   lights in, a tree out
 *     host_points.c   checks a batch; a point as the kernels read it
 *     host_rays.c     rays of several cuts, gathered for one call of the host; the scene's own answer
 *     host_shade.c    cuts of several points side by side
 *
 * A batch is shaded in groups of LC_HOST_BLOCKS blocks of LC_HOST_BLOCK points. First the guides of all
 * blocks, one a block, side by side, then block by block the others, which begin with the guide's cut:
 *
 *     lanes    0 1 2 .. 15        each refines its cut until it needs rays
 *              | | |    |
 *              rays of all -> the host's `visible`, at most LC_HOST_RAYS a call -> each goes on
 *
 * What a lane computes depends on its own rays only, not on how many lanes there are.
 */
#ifndef LC_HOST_H
#define LC_HOST_H

#include "build/build.h"
#include "cut/cut_parts.h"
#include "lightcuts.h"

#define LC_HOST_BLOCK  16   /* points that share a guide */
#define LC_HOST_BLOCKS 16   /* of a group */
#define LC_HOST_LANES  16   /* the most cuts side by side */
#define LC_HOST_GUIDE  5    /* of a block, the point that is its guide: of 4x4 pixels by rows a middle one */
#define LC_HOST_RAYS   1024 /* of a call of `visible` */

struct lc_tree {
    lc_context *ctx;
    lc_light_tree *tree;
    uint32_t *given; /* of each light of the tree its place in what the host gave */
    size_t n_given;
    float min_d2; /* distance floor, scene units^2 */
};

/* A cut in the making. */
typedef struct lc_host_lane {
    lc_cut cut;
    lc_point point;
    float org[3];
    uint32_t at;      /* of the point in the batch */
    bool waits;       /* for rays */
    bool worst_first; /* cut.worst_first when it last went on: it begins again when that is set */
    double change;    /* of the total, by the rays answered so far */
    lc_stats stats;
    lc_cut_entry *lights; /* with desc.cut: lights that are done */
    uint32_t n_lights;
} lc_host_lane;

/* Rays on their way, those of a lane in a row. */
typedef struct lc_host_rays {
    uint32_t n, n_runs;
    struct {
        lc_host_lane *lane;
        uint32_t first, n;
    } run[LC_HOST_LANES];
    float org[3][LC_HOST_RAYS], to[3][LC_HOST_RAYS], through[3][LC_HOST_RAYS];
    uint32_t point[LC_HOST_RAYS], light[LC_HOST_RAYS], blocker[LC_HOST_RAYS], at[LC_HOST_RAYS];
    uint8_t far[LC_HOST_RAYS], hidden[LC_HOST_RAYS], list[LC_HOST_RAYS];
} lc_host_rays;

struct lc_shader {
    const lc_tree *tree;
    lc_shader_desc desc;
    uint32_t n_lanes;
    lc_host_lane *lanes;
    lc_cut_start *starts; /* one a block of a group; NULL: each point is apart */
    lc_cut_step step;
    lc_host_rays *rays;
    lc_cut_entry *entries; /* with desc.cut */
    size_t n_entries;      /* that a cut may have */
    uint64_t n_calls;
    bool cancelled;
};

/* LC_OK, or LC_ERR_ARG after a line that names what is wrong. */
lc_status lc_host_check_batch(const lc_tree *tree, const lc_shade_batch *batch);
/* Sets point and org of a lane. turn: see lc_point. */
void lc_host_set_point(lc_host_lane *lane, const lc_tree *tree, const lc_shade_batch *batch, uint32_t turn);

/* Has all rays answered for which lanes wait. */
void lc_host_trace(lc_shader *shader, uint32_t n_lanes);

#endif
