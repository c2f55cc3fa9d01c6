/* evidence.h - what the points of a block of pixels found at the clusters of their start.
 *
 * A bound takes every light of a cluster as visible and as well placed as any, so most estimates are off by
 * far less. How much less is not known from one representative; but the points of a block each ask another
 * one. Where all of them agree, wholly visible or wholly hidden, the cluster needs no splitting; what they
 * disagree on is in a penumbra. So a cluster's bound is multiplied by a weight,
 *
 *     x_j = estimate / bound of row j,   w^2 = (PRIOR + sum (x_j - mean)^2 / VARIANCE) / (PRIOR + n - 1)
 *
 * the deviation over the bound, drawn to 1 while rows are few. Its children inherit the weight.
 *
 *     start      node 0     node 1     node 2   ...
 *     row 0      x e ...    x e ...    x e ...     of a point: one slot of representatives
 *     row 1
 *     ...
 *
 * A point never counts rows of its own slot: a cut that is chosen by the visibility of its own
 * representatives would be biased. Weighted bounds are no bounds any more, so this is only for cuts whose
 * error is asked with a z, which is found with the weights ([Nabata16] chooses cuts by deviations too).
 * Measured: tests/results/asked-error.md.
 */
#ifndef LC_EVIDENCE_H
#define LC_EVIDENCE_H

#include "cut/cut_data.h"

#define LC_EVIDENCE_ROWS 16 /* as many as a block has pixels */

/* A point's representatives of the start's nodes, those of bound 0 left out: fields as in lc_cut_list. */
typedef struct lc_evidence_row {
    uint32_t slot;
    uint32_t n, n_rays;
    float ratio[LC_MAX_START];   /* x of all nodes of the start */
    uint32_t node[LC_MAX_START]; /* n: which nodes of the start the following are of */
    float bound[LC_MAX_START];
    uint32_t rep[LC_MAX_START];
    float transfer[3][LC_MAX_START], e[3][LC_MAX_START];
    uint32_t blocker[LC_MAX_START]; /* what stopped the ray, for lc_occlusion_note; LC_NONE: nothing */
} lc_evidence_row;

typedef struct lc_evidence {
    uint32_t n_rows;
    lc_evidence_row row[LC_EVIDENCE_ROWS];
} lc_evidence;

/* Takes over what lc_cut_start_nodes put into `kept`. */
void lc_evidence_keep(lc_cut *cut, const lc_cut_start *start, lc_evidence_row *row);
/* Weights of the first n nodes of a start for a point of a slot, > 0. */
void lc_evidence_weigh(const lc_evidence *evidence, uint32_t n, uint32_t slot, float *weight);

#endif
