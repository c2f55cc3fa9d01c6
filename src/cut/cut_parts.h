/* cut_parts.h - what the files of the cut share: the scratch of one call and the calls of each part. Which
 * file holds what: README.md. */
#ifndef LC_CUT_PARTS_H
#define LC_CUT_PARTS_H

#include "cut/cut_data.h"

/* A light and a range of a gather cluster's points: LC_PAIR | level << light_bits | light; which range of the
 * level it is its representative's point tells. As a link it is no node and no light. */
#define LC_PAIR 0x40000000u

#define LC_CUT_BATCH 64 /* clusters that are split, and lights that are estimated and traced, at a time */

/* One call of lc_cut_shade, and the batch it works on. A batch of splits is the parents pairs.first ..
 * pairs.first + pairs.n - 1 of the list `split` and their children, pair by pair, in runs of one light kind.
 */
typedef struct lc_cut_step {
    const lc_point *point;   /* of a gather cluster, the one that is estimated now */
    const lc_point *bounded; /* what bounds are for */
    const float *org; /* x y z, where shadow rays start */
    lc_stats *stats;
    lc_cut_pairs pairs; /* its arrays are the ones below */
    _Alignas(64) uint32_t link[2 * LC_CUT_BATCH + LC_LANES]; /* of the children */
    uint32_t rep[LC_CUT_BATCH + LC_LANES];                   /* new representatives */
    uint32_t node[2 * LC_CUT_BATCH];                         /* the children that are no lights */
    float fresh[2 * LC_CUT_BATCH + LC_LANES], bound[2 * LC_CUT_BATCH + LC_LANES];
    float node_bound[2 * LC_CUT_BATCH + LC_LANES];
    const float *intensity[2 * LC_CUT_BATCH];
    uint32_t n_bounded;                    /* children that are no lights */
    float f[6][LC_CUT_BATCH + LC_LANES]; /* of new representatives: M G, target of the shadow ray */
    uint32_t at[LC_CUT_BATCH];           /* of a gather cluster: their points */
    float part[2 * LC_CUT_BATCH][4];     /* intensities of pairs */
} lc_cut_step;

/* ---- a cut in steps, between which its pending rays are traced ---- */

/* Sets what a step is for; its batch may be anyone's. */
void lc_cut_set_step(lc_cut_step *step, const lc_cut *cut, const lc_point *point, const float org[3],
                     lc_stats *stats);
/* True: all pending rays have to be traced, and lc_cut_go_on be called with the change of the total's
 * luminance; false: lc_cut_end has the result. */
bool lc_cut_begin(lc_cut *cut, lc_cut_step *step, uint64_t hash);
bool lc_cut_go_on(lc_cut *cut, lc_cut_step *step, double change);
void lc_cut_end(lc_cut *cut, lc_cut_step *step, lc_cut_result *out);

#define LC_CUT_RAY_LISTS 3
/* Shadow rays of a cut, an element of each array a ray. */
typedef struct lc_cut_rays {
    float *to[3];    /* where it goes; far: the direction */
    uint32_t *light; /* the representative */
    uint8_t *far, *list;
    uint32_t *at;    /* in the list */
} lc_cut_rays;

/* Where the next pending ray is looked for; all 0 at first. */
typedef struct lc_cut_cursor {
    uint32_t list, at;
} lc_cut_cursor;

/* Hands out pending rays, which no longer are, until there are `room` or no more; returns their number. Those
 * that go behind the geometric surface are settled at once. */
uint32_t lc_cut_take_rays(lc_cut *cut, const lc_point *point, lc_cut_cursor *next, uint32_t room,
                          const lc_cut_rays *out, double *change);
/* Takes the answers to n rays: occluded, by what (see visibility.h), or the fractions of R G B that arrive;
 * through, blocker: or NULL. Adds to *change the change of the total's luminance. */
void lc_cut_settle(lc_cut *cut, const lc_cut_rays *rays, uint32_t n, const uint8_t *hidden,
                   float *const through[3], const uint32_t *blocker, double *change);
/* Sums the lights of `leaf`, whose rays have all been settled. */
void lc_cut_leaves_done(lc_cut *cut);

/* Adds a list's estimates to the sums of their groups. No ray of it may be pending. */
void lc_cut_add_to_groups(const lc_cut *cut, const lc_cut_list *list);

/* ---- the parts ---- */

/* Puts the roots into `open`, or with a start its clusters into `kept`; after a start no ray is pending,
 * unless the cut defers them. Returns the total's luminance. */
double lc_cut_place_roots(lc_cut *cut, lc_cut_step *step);
double lc_cut_place_start(lc_cut *cut, lc_cut_step *step);
/* Bounds, estimates and traces n nodes and appends them to `kept`; weight: of bounds, NULL: 1. */
double lc_cut_start_nodes(lc_cut *cut, lc_cut_step *step, const uint32_t *link, const float *weight,
                          uint32_t n);
/* Saves the cut as it is now to start_out, with what can be proved for all of its points. */
void lc_cut_save_start(lc_cut *cut, lc_stats *stats);

/* Factor <= 1 on the error ratio. No ray may be pending. */
double lc_cut_ratio_factor(const lc_cut *cut);
/* The sum of squared bounds of all clusters. */
double lc_cut_sum2(const lc_cut *cut);
/* The bound above which clusters are split next so that the root of that sum falls to rss: those below it
 * have no larger root together, so that splitting the worst cluster again and again would split all above it,
 * too. INFINITY where the root is no larger. */
float lc_cut_rss_limit(const lc_cut *cut, double rss);
/* The bound above which clusters are split next where they are split worst first; at least `limit`. */
float lc_cut_worst_limit(const lc_cut *cut, float limit);
/* Fills `split` from `open` with what the next round splits. `open` keeps the clusters above the limit for
 * which there is no room. */
void lc_cut_select(lc_cut *cut, float limit, lc_stats *stats);
/* Tests whether the node is occluded by the triangle and at most max_triangles in all, and notes it in
 * `hidden` if so. passed: a ray to one of the node's lights is known to meet the triangle. */
bool lc_cut_prove(lc_cut *cut, uint32_t link, uint32_t occluder, bool passed, uint32_t max_triangles,
                  lc_stats *stats);

/* Replaces the clusters of `split` by their children. Returns the change of the total's luminance. */
double lc_cut_split(lc_cut *cut, lc_cut_step *step, float limit);

/* Trace the pending rays of all lists, or of `leaf` alone, whose lights are done then. Return the change of
 * the total's luminance. */
double lc_cut_trace(lc_cut *cut, lc_cut_step *step);
double lc_cut_trace_leaves(lc_cut *cut, lc_cut_step *step);

/* All clusters and lights but the hidden ones. */
static inline uint32_t lc_cut_n_clusters(const lc_cut *c)
{
    return c->open.n + c->split.n + c->kept.n + c->n_done;
}

/* What max_cut limits. Clusters of bound 0 do not count, but at most max_size of them are left out, for which
 * there is memory. */
static inline uint32_t lc_cut_size(const lc_cut *c)
{
    return lc_cut_n_clusters(c) - (c->n_zero_bound < c->max_size ? c->n_zero_bound : c->max_size);
}

static inline void lc_cut_copy(lc_cut_list *to, uint32_t at, const lc_cut_list *from, uint32_t i)
{
    to->bound[at] = from->bound[i];
    to->link[at] = from->link[i];
    to->rep[at] = from->rep[i];
    to->weight[at] = from->weight[i];
    for (int k = 0; k < 3; k++) {
        to->transfer[k][at] = from->transfer[k][i];
        to->e[k][at] = from->e[k][i];
    }
}

/* Returns the luminance of the estimate. */
static inline double lc_cut_append(lc_cut_list *list, float bound, uint32_t link, uint32_t rep,
                                   const float transfer[3], const float *intensity)
{
    uint32_t at = list->n++;
    list->bound[at] = bound;
    list->link[at] = link;
    list->rep[at] = rep;
    list->weight[at] = 1;
    for (int k = 0; k < 3; k++) {
        list->transfer[k][at] = transfer[k];
        list->e[k][at] = transfer[k] * intensity[k];
    }
    return (double)lc_luminance(lc_f3_make(list->e[0][at], list->e[1][at], list->e[2][at]));
}

static inline bool lc_cut_is_node(uint32_t link) { return !(link & (LC_LEAF | LC_PAIR)); }

static inline lc_light_kind lc_cut_kind_of(const lc_cut *c, uint32_t link)
{
    return lc_cut_is_node(link) ? lc_kind_of_node(c->tree, link)
                                : lc_kind_of_light(c->tree, link & c->light_mask);
}

/* Representative of a cluster, or the light itself. */
static inline uint32_t lc_cut_rep_of(const lc_cut *c, uint32_t link)
{
    return link & LC_LEAF ? link & ~LC_LEAF : c->reps[link * c->reps_stride];
}

/* Summed intensity of a cluster or light, R G B; prefetches the rest of it. */
static inline const float *lc_cut_intensity_of(const lc_tree_data *t, uint32_t link)
{
    if (link & LC_LEAF) {
        const lc_light_rec *light = &t->lights[link & ~LC_LEAF];
        __builtin_prefetch(light);
        return light->intensity;
    }
    const lc_node *node = &t->nodes[link];
    __builtin_prefetch(node);
    return node->intensity;
}

/* Bounds of n nodes of one kind, at most twice LC_CUT_BATCH; the first: of points with a lobe. */
void lc_cut_lobed_bounds(const lc_cut *c, const uint32_t *node, uint32_t n, lc_light_kind kind, float *bound);
static inline void lc_cut_bounds(const lc_cut *c, const lc_cut_step *s, const uint32_t *node, uint32_t n,
                                 lc_light_kind kind, float *bound)
{
    if (c->gather && c->gather->lobed) lc_cut_lobed_bounds(c, node, n, kind, bound);
    else c->ctx->shade_kernels->bounds(&c->tree->data, node, n, kind, s->bounded, bound);
    if (!c->gather) lc_lower_bounds_of_alike(c->tree, node, n, bound);
}

/* M G and shadow ray targets of the new representatives first .. first + n - 1, all of one kind. */
static inline void lc_cut_estimate(const lc_cut *c, lc_cut_step *s, uint32_t first, uint32_t n,
                                   lc_light_kind kind)
{
    float *const out[6] = { s->f[0] + first, s->f[1] + first, s->f[2] + first,
                            s->f[3] + first, s->f[4] + first, s->f[5] + first };
    c->ctx->shade_kernels->estimate(&c->tree->data, 0, s->rep + first, n, kind, s->point, out);
}

#endif
