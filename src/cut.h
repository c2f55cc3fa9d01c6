/* cut.h - chooses a cut of the light tree for one shading point and sums its estimates ([Walter05] 4, [Miksik07] 2.2).
 *
 * Start at the root; while the largest error bound in the cut is above error_ratio * max(total, floor), replace the
 * worst clusters, at most four of those above that limit at a time, by their children: all of them have to go as long as
 * the total stays, and one kernel call bounds their eight children. Stop at max_cut clusters. The guarantee is per cluster: every cluster left has a bound of at
 * most that limit. It is not a guarantee about their sum, and shadows are bounded by 1.
 *
 * floor is a luminance: dark_floor times the picture's mean. Where the estimate is below it the relative test would
 * never pass (the point sees almost no light), and an error that small can't be seen beside the rest of the picture.
 */
#ifndef LC_CUT_H
#define LC_CUT_H

#include "bvh.h"
#include "light_tree.h"
#include "stats.h"

typedef struct lc_cut_desc {
    float error_ratio;
    uint32_t max_cut; /* 0: no limit */
    float floor;      /* luminance of reflected radiance, W/(m^2 sr) */
} lc_cut_desc;

/* A cluster in the cut: 32 bytes, so that two share a cache line. */
typedef struct lc_cut_node {
    uint32_t id;
    uint32_t rep;      /* light index */
    float transfer[3]; /* M G V of the representative */
    float lum;         /* luminance of the estimate */
    uint32_t pad[2];
} lc_cut_node;

/* What the heap moves about. */
typedef struct lc_cut_key {
    float bound;       /* luminance, > 0 */
    uint32_t node;     /* index into lc_cut.nodes */
} lc_cut_key;

/* Per-thread scratch, and after lc_cut_shade the cut itself: heap and parked hold clusters whose bound is not 0, done
 * leaves and clusters that can't contribute. Parked are those whose bound was within the limit when they came: half of
 * all, which so never go through the heap. They are looked at again when nothing in the heap is above the limit. */
typedef struct lc_cut {
    const lc_context *ctx;
    const lc_light_tree *tree;
    const lc_bvh *bvh;
    lc_cut_desc desc;
    uint32_t limit;          /* clusters that fit */
    lc_cut_key *heap;        /* binary max-heap by bound, then lowest node id */
    lc_cut_node *nodes;
    uint32_t *free_nodes;    /* indices of nodes in neither, a stack of limit + 1 - n_heap - n_parked */
    lc_cut_key *parked;
    float worst_parked;
    uint32_t n_heap, n_parked;
    uint32_t *done;          /* node ids; kept only when keep_done */
    uint32_t n_done;
    bool keep_done;
    double done_sum[3];      /* radiance of the done ones */
    uint32_t slot;
} lc_cut;

typedef struct lc_cut_result {
    lc_f3 radiance;
    uint32_t size, rays;
    float max_error; /* largest bound left / luminance of the estimate; 0 where nothing is left */
    bool at_limit, dark;
} lc_cut_result;

/* keep_done: record every node of the cut, for validation. */
lc_status lc_cut_init(lc_cut *cut, const lc_context *ctx, const lc_light_tree *tree, const lc_bvh *bvh,
                      const lc_cut_desc *desc, bool keep_done);
void lc_cut_free(lc_cut *cut);

/* ray_org: where shadow rays start, the point moved off its surface. hash picks the representatives' slot. */
void lc_cut_shade(lc_cut *cut, const lc_point *point, const float ray_org[3], uint64_t hash, lc_stats *stats,
                  lc_cut_result *out);

/* Every light at the point, by the same estimate and the same rays. */
void lc_exact_shade(const lc_light_tree *tree, const lc_bvh *bvh, const lc_point *point, const float ray_org[3],
                    lc_stats *stats, lc_cut_result *out);

/* NULL when heap and done nodes partition the lights, else what is wrong. The cut must have been kept. */
const char *lc_cut_validate(const lc_cut *cut);

#endif
