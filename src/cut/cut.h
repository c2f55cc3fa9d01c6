/* cut.h - chooses a cut of the light tree for one shading point and sums its estimates ([Walter05] 4,
 * [Miksik07] 2.2).
 *
 * Start at the roots, one a kind of light; while the largest error bound in the cut is above error_ratio *
 * max(total, floor), replace clusters above that limit by their children. All of them have to go as long as
 * the total stays, so a round takes every one at once: one call of the bounds kernel, one of the estimates.
 * Shadow rays wait until no bound is above the limit, and then go out together. Near max_cut only the worst
 * are taken. The guarantee is per cluster: every cluster left has a bound of at most that limit, or is proved
 * to be hidden. It is not a guarantee about their sum, though cuts with many hidden representatives have a
 * lower limit for its sake, and shadows are bounded by 1. A start takes the roots' place: any cut will do,
 * and what is above the limit in it is split.
 *
 * Against replacing the worst four at a time (2026-11, stairs, room, cornell at half size): cuts 0.1 to 0.6 %
 * larger, rmse -1 to +1 %, a quarter to a half of the time.
 *
 * floor is a luminance: dark_floor times the picture's mean. Where the estimate is below it the relative test
 * would never pass (the point sees almost no light), and an error that small can't be seen beside the rest of
 * the picture. Default 0.2, so that at 2 % no cluster is off by more than 0.4 % of the mean; measured on
 * stairs (10,000 lights, 400x300, 2026-11) against 0.02: mean cut 202 for 252, points at max_cut 403 for
 * 6938, rmse the same to four digits.
 */
#ifndef LC_CUT_H
#define LC_CUT_H

#include "base/stats.h"
#include "cut/cut_list.h"
#include "cut/occlusion_proof.h"
#include "tree/light_tree.h"

#define LC_MAX_START 2048

/* A cluster that was proved to be hidden. */
typedef struct lc_cut_hid {
    uint32_t link, by; /* by: the occluder where the proof began */
} lc_cut_hid;

#define LC_MAX_HID 2048

/* Clusters of a point's cut that cuts of points near it may begin with, in place of the roots. */
typedef struct lc_cut_start {
    uint32_t n_nodes, n_lights, n_hidden;
    uint32_t link[LC_MAX_START]; /* nodes in rising order, lights */
    lc_cut_hid hidden[LC_MAX_HID];
} lc_cut_start;

typedef struct lc_cut_desc {
    float error_ratio; /* of a cluster; of cuts with much that is hidden less, see share in cut.c */
    uint32_t max_cut;  /* 0: no limit; never below the number of kinds; hidden clusters, and those of bound 0,
                          don't count */
    float floor;      /* luminance of reflected radiance, W/(m^2 sr) */
} lc_cut_desc;

/* Clusters that were split at the same time. */
typedef struct lc_cut_round {
    uint32_t n_split, rays; /* rays: traced before */
    float limit;            /* every one of them had a bound above it */
    double total;           /* luminance of the cut before, with visibility 1 where no ray was traced yet */
} lc_cut_round;

/* Per-thread scratch, and after lc_cut_shade the cut itself: left, and done: leaves, which are exact, and
 * clusters that can't contribute, the last n_hid of them because they are hidden, as hid has them. While
 * refining, open holds the clusters above the limit, split those to be split, leaf those that are done but
 * for their shadow rays. */
typedef struct lc_cut {
    const lc_context *ctx;
    const lc_light_tree *tree;
    lc_visibility visibility;
    lc_cut_desc desc;
    uint32_t limit;      /* clusters that fit */
    lc_cut_list open, split, left, leaf;
    float *memory;       /* of the lists */
    float *key;          /* scratch of the choice of the worst */
    uint32_t *done;      /* links of light tree nodes; kept only when keep_done, or for `kept` */
    uint32_t n_done;     /* leaves that are in the list leaf included */
    uint32_t n_zero;     /* of them: can't shed anything at the point */
    uint32_t n_traced;   /* clusters of left, the first, of which no ray is pending */
    lc_cut_hid *hid;
    uint32_t n_hid, most_hid; /* beside the limit: they cost nothing */
    lc_occlusion *occlusion; /* NULL: nothing is ever proved hidden */
    uint32_t *history; /* nodes that were split, in order, round after round; kept only when keep_done, as are
                          rounds */
    lc_cut_round *rounds;
    uint32_t n_history, n_rounds;
    bool keep_done;
    double done_sum[3];  /* radiance of the done ones */
    const uint32_t *reps;  /* of the slot: node id has reps[id * reps_stride] */
    size_t reps_stride;
    uint32_t slot;
    const lc_cut_start *start; /* of the next cuts; NULL: the roots */
    lc_cut_start *kept;        /* NULL, or where the next cuts are kept */
    bool is_kept;
    bool asked; /* those above the limit, for the last time, whether they are hidden */
    uint32_t kept_history, kept_rounds; /* with keep_done: what led to the last that was kept; cuts that begin
                                           with it go on from there */
} lc_cut;

typedef struct lc_cut_result {
    lc_f3 radiance;
    uint32_t size, rays; /* size: as max_cut counts */
    float max_error; /* largest bound left / luminance of the estimate; 0 where nothing is left */
    bool at_limit, dark;
} lc_cut_result;

/* keep_done: record every node of the cut and every split, for validation and for explain.c. */
lc_status lc_cut_init(lc_cut *cut, const lc_context *ctx, const lc_light_tree *tree,
                      const lc_visibility *visibility, const lc_cut_desc *desc, bool keep_done);
void lc_cut_free(lc_cut *cut);

/* Which of n lights of a point are hidden, by triangles or behind the surface: there a shading normal may see
 * a light, and shadow rays miss the surface itself, for near their start they see nothing. For the arguments
 * see visibility.h; block is LC_NONE where the surface alone hides. */
void lc_cut_hidden(const lc_visibility *visibility, const lc_point *point, const float org[3], uint32_t n,
                   const float *const target[3], bool far, uint8_t *hidden, uint32_t *block);

/* ray_org: where shadow rays start, the point moved off its surface. hash picks the representatives' slot. */
void lc_cut_shade(lc_cut *cut, const lc_point *point, const float ray_org[3], uint64_t hash, lc_stats *stats,
                  lc_cut_result *out);

/* NULL when left and done nodes partition the lights, else what is wrong. The cut must have been kept. */
const char *lc_cut_validate(const lc_cut *cut);

#endif
