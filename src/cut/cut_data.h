/* cut_data.h - the data of a cut: what a caller sets, what lc_cut_shade leaves, and the scratch between.
 *
 * Types only; cut.h has the calls and the data flow, cut_parts.h what the files of the cut share.
 */
#ifndef LC_CUT_DATA_H
#define LC_CUT_DATA_H

#include "base/stats.h"
#include "cut/cut_list.h"
#include "cut/gather.h"
#include "cut/occlusion_proof.h"
#include "tree/light_tree.h"

#define LC_MAX_START 2048  /* clusters and lights of a start: bounds its memory, 8 kB */
#define LC_MAX_HIDDEN 2048 /* clusters of one cut that may be proved to be occluded */

/* A cluster that was proved to be occluded. */
typedef struct lc_hidden_cluster {
    uint32_t link;
    uint32_t occluder; /* the triangle where the proof began */
} lc_hidden_cluster;

/* The cut of one point, with which cuts of points near it begin in place of the roots. Nodes, lights and
 * hidden clusters together hold every light once. */
typedef struct lc_cut_start {
    uint32_t n_nodes, n_lights, n_hidden;
    uint32_t link[LC_MAX_START]; /* the nodes in rising order, then the lights */
    lc_hidden_cluster hidden[LC_MAX_HIDDEN];

    /* Set before the cut that is saved here: where shadow rays of the points start that begin with it. */
    bool has_points;
    lc_point_box points;
    uint32_t n_block; /* the first of `hidden` are proved to be occluded from all of them */
    const struct lc_evidence *evidence; /* of its nodes, see evidence.h; NULL: none */
} lc_cut_start;

typedef struct lc_cut_desc {
    float error_ratio; /* of one cluster; lowered in cuts with many occluded representatives */
    uint32_t max_cut;  /* 0: no limit; at least the number of roots is allowed */
    float floor;       /* the dark floor: luminance of reflected radiance, W/(m^2 sr) */
    float z;           /* 0: error_ratio limits each cluster. Else it limits the whole cut: z times the root
                          of the sum of its squared bounds */
    uint32_t max_points; /* of a gather cluster; 0: there are none */
    const uint32_t *parent; /* of each light, its node; for gather clusters alone */
    float dark;             /* above 1, of pixels nearly dark: z is divided by it */
    bool worst_first;       /* from the roots on, as max_cut is known to leave no room for all */
} lc_cut_desc;

/* What a cut is of the pixel whose error is asked for, where other points have other cuts. The pixel's
 * radiance is taken as own times the cut's plus rest. */
typedef struct lc_cut_part {
    float share; /* of the pixel's samples */
    float own;   /* the same and that of samples whose cuts are still to be made */
    double rest; /* luminance of the others */
} lc_cut_part;

/* Clusters that were split together. */
typedef struct lc_cut_round {
    uint32_t n_split;
    uint32_t rays; /* traced before the round */
    float limit;   /* each of the clusters had a bound above it */
    double total;  /* luminance of the cut before the round, V = 1 where no ray was traced yet */
} lc_cut_round;

/* Scratch of a thread. After lc_cut_shade it holds the cut: the clusters of `kept`, and if `record` is set
 * the links of `done`, of which the last n_hidden are those of `hidden`. */
typedef struct lc_cut {
    const lc_context *ctx;
    const lc_light_tree *tree;
    lc_visibility visibility;
    lc_cut_desc desc;
    uint32_t max_size; /* desc.max_cut, at least the number of roots, at most the number of lights */
    bool record;       /* note every node of the cut and every split */

    /* Between calls: where the next cut begins, and where it is saved as a start for others. */
    const lc_cut_start *start; /* NULL: the roots */
    lc_cut_start *start_out;   /* NULL: nowhere */
    bool start_saved;          /* start_out is filled in, or NULL */
    bool start_only;           /* the cut ends where it is saved */
    uint32_t row;              /* of the start's evidence: this point's; LC_NONE: none */
    lc_cut_part part;          /* with desc.z; 1, 1, 0: all of the pixel */
    double alike;              /* with desc.z: luminance by the cut of a point alike; 0: not known */
    bool in_block;             /* the point is in the start's box of points */
    uint32_t n_start_history, n_start_rounds; /* with record: what led to the start that was saved last */

    /* The slot: the representative of node i is reps[i * reps_stride]. */
    const uint32_t *reps;
    size_t reps_stride;
    uint32_t slot;

    /* The gather cluster whose cut it is, NULL: one point. See cut_gather.c for the names of its pairs. */
    const lc_gather *gather;
    uint32_t light_bits, light_mask; /* of a representative's word: the light */
    uint32_t turn;                   /* runs of new representatives so far, each of another point */
    uint64_t hash;

    lc_cut_list open;  /* bound above the limit, or not yet compared */
    lc_cut_list split; /* to be split in this round */
    lc_cut_list kept;  /* bound within the limit */
    lc_cut_list leaf;  /* lights whose shadow ray is pending */
    float *memory;     /* of the four lists */
    float *scratch;    /* a word for each element of a list */
    float *weight;     /* LC_MAX_START: of the start's nodes, by its evidence */

    uint32_t *done;    /* links of lights, and of clusters that contribute 0 */
    uint32_t n_done;   /* lights in `leaf` included; counted even where the links are not written */
    uint32_t n_zero_bound; /* of these, clusters whose bound is 0 */
    double done_sum[3];    /* radiance of the lights that are done */
    /* NULL, or where the radiance of each of the tree's groups is summed, R G B. A caller's; set it between
     * calls. */
    double (*of_group)[3];
    uint32_t n_traced; /* the first clusters of `kept`, none of which has a pending ray */
    bool short_of_room; /* a round did not fit */
    bool worst_first;   /* clusters are split by falling bounds, as max_size leaves no room for all */
    double factor;      /* on the error ratio, <= 1 */

    /* While it is refined. */
    double total; /* luminance of all estimates, V = 1 where a ray is pending */
    double ratio; /* the error ratio of the last limit */
    bool traced;  /* no ray is pending */
    bool defers;  /* set by a caller that traces the rays itself: those of a start are left pending, too */
    uint32_t rays_given; /* of its row of the start's evidence, which were counted when they were traced */
    uint64_t first_ray, rays_before; /* counts of rays when the cut, and its refinement, began */

    lc_occlusion *occlusion; /* NULL: nothing is ever proved to be occluded */
    lc_hidden_cluster *hidden;
    uint32_t n_hidden, max_hidden; /* they do not count towards max_size */
    bool last_room_tested; /* all clusters above the limit were tested for occlusion, to use the last of the
                              room well; at most once a cut */

    uint32_t *history;    /* with record: the nodes that were split, round after round */
    lc_cut_round *rounds; /* with record */
    uint32_t n_history, n_rounds;
} lc_cut;

typedef struct lc_cut_result {
    lc_f3 radiance;
    uint32_t size;   /* clusters and lights as max_cut counts them */
    uint32_t rays;   /* shadow rays */
    float max_error; /* largest bound of `kept` over the luminance of the estimate, 0 where `kept` is empty;
                        with desc.z the half-width: what error_ratio limits, of the luminance it goes by */
    bool at_limit;   /* max_cut was met: some bound may be above the limit */
    bool dark;       /* only the dark floor keeps every bound within the limit */
} lc_cut_result;

#endif
