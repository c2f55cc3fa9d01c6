/* exact.c - the exact method: every light, in batches, whose shadow rays are traced together. */
#include "cut/exact.h"

#define BATCH 64         /* lights */
#define CANCEL_PERIOD 256 /* batches from one test for cancellation to the next: some milliseconds */

/* Lights first .. first + n - 1, all of one kind, n <= BATCH. */
static uint32_t shade_exactly(const lc_light_tree *t, const lc_visibility *visibility, const lc_point *p,
                              const float org[3], lc_light_kind kind, uint32_t first, uint32_t n,
                              lc_stats *stats, double sum[3], double (*of_group)[3])
{
    _Alignas(64) float f[6][BATCH];
    float *const out[6] = { f[0], f[1], f[2], f[3], f[4], f[5] };
    const float *const target[3] = { f[3], f[4], f[5] };
    uint8_t hidden[BATCH];
    uint32_t lit[BATCH], m = 0;
    float thr[3][BATCH], *const through[3] = { thr[0], thr[1], thr[2] };
    bool dims = false;
    t->ctx->shade_kernels->estimate(&t->data, first, NULL, n, kind, p, out);
    lc_shadow_targets(t, kind, p, NULL, first, n, out + 3);
    for (uint32_t i = 0; i < n; i++) {
        lit[m] = i;
        m += f[0][i] > 0 || f[1][i] > 0 || f[2][i] > 0;
    }
    for (uint32_t i = 0; i < m && m < n; i++) /* in place, since lit[i] >= i */
        for (int k = 3; k < 6; k++) f[k][i] = f[k][lit[i]];
    lc_phase_end(stats, LC_PHASE_ESTIMATES);
    if (m) dims = lc_cut_hidden(visibility, p, org, m, target, lc_is_far(kind), hidden, NULL, through);
    lc_phase_end(stats, LC_PHASE_SHADOW);
    for (uint32_t i = 0; i < m; i++) {
        uint32_t at = lit[i];
        const float *power = t->data.lights[first + at].intensity;
        const float v = hidden[i] ? 0 : 1; /* a factor: a branch could not be predicted */
        for (int k = 0; k < 3 && dims; k++) f[k][at] *= hidden[i] ? 0 : thr[k][i];
        for (int k = 0; k < 3; k++) sum[k] += (double)(v * (f[k][at] * power[k]));
        if (!of_group) continue;
        double *own = of_group[t->group[first + at]];
        for (int k = 0; k < 3; k++) own[k] += (double)(v * (f[k][at] * power[k]));
    }
    return m;
}

void lc_exact_shade(const lc_light_tree *t, const lc_visibility *visibility, const lc_point *p,
                    const float org[3], lc_stats *stats, lc_cut_result *out)
{
    lc_exact_shade_groups(t, visibility, p, org, NULL, stats, out);
}

void lc_exact_shade_groups(const lc_light_tree *t, const lc_visibility *visibility, const lc_point *p,
                           const float org[3], double (*of_group)[3], lc_stats *stats, lc_cut_result *out)
{
    double sum[3] = { 0, 0, 0 };
    for (uint32_t g = 0; of_group && g < t->n_groups; g++)
        for (int k = 0; k < 3; k++) of_group[g][k] = 0;
    *out = (lc_cut_result){ .size = t->n_lights };
    for (int kind = 0; kind < LC_LIGHT_KINDS; kind++)
        for (uint32_t first = t->first_light[kind], n, end = t->first_light[kind + 1]; first < end;
             first += n) {
            n = end - first < BATCH ? end - first : BATCH;
            out->rays += shade_exactly(t, visibility, p, org, (lc_light_kind)kind, first, n, stats, sum,
                                       of_group);
            if (n == BATCH && first / BATCH % CANCEL_PERIOD == CANCEL_PERIOD - 1 && stats->go_on &&
                !stats->go_on(stats->go_on_user))
                return;
        }
    out->radiance = lc_f3_make((float)sum[0], (float)sum[1], (float)sum[2]);
    stats->points++;
    stats->shadow_rays += out->rays;
    stats->cut_sum += out->size;
}
