/* evidence.c - weights of bounds, by what other points found. */
#include "cut/evidence.h"

#include <math.h>
#include <string.h>

#define PRIOR 2.0f      /* rows that the bound itself counts for */
#define VARIANCE 0.01f  /* of x, at which the weight is 1; z makes up for it */
#define RUN 64          /* nodes at a time */
#define UP_TO_BOUND 1.001f /* of estimates over bounds, with more than their rounding */

/* Nodes of bound 0 are not in `kept`, which is in the start's order. */
void lc_evidence_keep(lc_cut *c, const lc_cut_start *start, lc_evidence_row *row)
{
    const lc_cut_list *kept = &c->kept;
    uint32_t n = 0;
    for (uint32_t i = 0; i < start->n_nodes; i++) {
        row->ratio[i] = 0;
        if (n == kept->n || kept->link[n] != start->link[i]) continue;
        const float e = lc_luminance(lc_f3_make(kept->e[0][n], kept->e[1][n], kept->e[2][n]));
        if (e <= UP_TO_BOUND * kept->bound[n]) /* else its lights are alike */
            row->ratio[i] = e / kept->bound[n];
        row->blocker[n] = c->occlusion && !(e > 0) ? lc_occlusion_noted(c->occlusion, kept->rep[n]) : LC_NONE;
        row->node[n++] = i;
    }
    row->n = n;
    memcpy(row->bound, kept->bound, n * sizeof(float));
    memcpy(row->rep, kept->rep, n * sizeof(uint32_t));
    for (int k = 0; k < 3; k++) {
        memcpy(row->transfer[k], kept->transfer[k], n * sizeof(float));
        memcpy(row->e[k], kept->e[k], n * sizeof(float));
    }
}

/* A run of nodes: sums over the rows of other slots, one row after the other. */
static void weigh_run(const lc_evidence *ev, uint32_t first, uint32_t n, uint32_t slot, float *weight)
{
    float sum[RUN] = { 0 }, sum2[RUN] = { 0 };
    uint32_t m = 0;
    for (uint32_t r = 0; r < ev->n_rows; r++) {
        const float *x = ev->row[r].ratio + first;
        if (ev->row[r].slot == slot) continue;
        m++;
        for (uint32_t i = 0; i < n; i++) {
            sum[i] += x[i];
            sum2[i] += x[i] * x[i];
        }
    }
    const float inv = m ? 1 / (float)m : 0, total = m ? PRIOR + (float)(m - 1) : PRIOR;
    for (uint32_t i = 0; i < n; i++) {
        const float s2 = sum2[i] - sum[i] * sum[i] * inv;
        weight[i] = sqrtf((PRIOR + (s2 > 0 ? s2 : 0) * (1 / VARIANCE)) / total);
    }
}

void lc_evidence_weigh(const lc_evidence *ev, uint32_t n, uint32_t slot, float *weight)
{
    for (uint32_t at = 0; at < n; at += RUN)
        weigh_run(ev, at, n - at < RUN ? n - at : RUN, slot, weight + at);
}
