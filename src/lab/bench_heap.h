/* bench_heap.h - refinement by a max-heap of fixed size, as in [Walter05] 4, for `lightcuts bench layout` to
 * time against the renderer's rounds (cut/cut.h).
 *
 *     pop the worst n_pop clusters above the limit -> bounds of their children -> estimates of their new
 *     representatives -> push the children; until the worst is within the limit, or the heap is full
 *
 * The kernels, the tree, the sharing of representatives and the calls for visibility are those of the cut.
 * What differs is how many clusters there are in a kernel call and what choosing them costs. The tree has
 * point lights only.
 */
#ifndef LC_BENCH_HEAP_H
#define LC_BENCH_HEAP_H

#include "trace/visibility.h"
#include "tree/light_tree.h"

#define HEAP_MAX_POP 16

typedef struct heap_item {
    float bound;
    uint32_t slot; /* of the cluster: items are moved, clusters are not */
} heap_item;

typedef struct heap_cluster {
    uint32_t link, rep;
    float transfer[3], e[3]; /* M G V of the representative; the estimate */
} heap_cluster;

typedef struct bench_heap {
    const lc_context *ctx;
    const lc_light_tree *tree;
    lc_visibility visibility;
    float error_ratio;
    uint32_t max_cut;        /* clusters, but for those of bound 0 */
    uint32_t n_pop;          /* popped at a time, at most HEAP_MAX_POP */
    heap_item *item;         /* max_cut; item i is no less than items 2i + 1 and 2i + 2 */
    heap_cluster *cluster;   /* max_cut */
    uint32_t *free_slot;     /* max_cut */
    uint32_t n, n_done;         /* of the cut: clusters in the heap, and lights, which need no splitting */
    uint32_t n_used, n_free;    /* slots that had a cluster, and those of them that have none now */
    double sum[3];           /* radiance of the cut */
    uint64_t n_bounds;       /* of all cuts so far */
    uint32_t rep_slot;
} bench_heap;

/* LC_ERR_MEMORY. Free it also then. */
lc_status bench_heap_init(bench_heap *h, const lc_context *ctx, const lc_light_tree *tree,
                          const lc_visibility *visibility, float error_ratio, uint32_t max_cut,
                          uint32_t n_pop);
void bench_heap_free(bench_heap *h);

/* For the arguments see lc_cut_shade. Returns the size of the cut; its radiance is in sum. */
uint32_t bench_heap_shade(bench_heap *h, const lc_point *point, const float ray_org[3], uint64_t hash);

/* Of the last cut. */
double bench_heap_luminance(const bench_heap *h);

#endif
