/* group_sums.c - see group_sums.h. */
#include "render/group_sums.h"

#include <string.h>

lc_status lc_groups_make_rooms(lc_render_job *j, size_t n_shared)
{
    const uint32_t n = j->scene->groups.n;
    for (uint32_t i = 0; i < j->ctx->n_threads && n; i++) {
        lc_render_worker *w = &j->workers[i];
        w->groups = lc_alloc(j->ctx, 1, sizeof *w->groups);
        if (!w->groups) return LC_ERR_MEMORY;
        w->groups->n = n;
        w->cut.of_group = w->groups->cut;
        w->groups->n_shared = w->shared ? n_shared * n : 0;
        if (w->shared &&
            !(w->groups->shared = lc_alloc(j->ctx, w->groups->n_shared, sizeof *w->groups->shared)))
            return LC_ERR_MEMORY;
    }
    return LC_OK;
}

void lc_groups_free_room(const lc_context *ctx, lc_render_worker *w)
{
    if (w->groups) lc_free(ctx, w->groups->shared, w->groups->n_shared, sizeof *w->groups->shared);
    lc_free(ctx, w->groups, 1, sizeof *w->groups);
    w->groups = NULL;
}

lc_f3 *lc_groups_begin_sample(lc_group_sums *g)
{
    if (!g) return NULL;
    memset(g->sample, 0, g->n * sizeof *g->sample);
    return g->sample;
}

void lc_groups_add_cut(lc_group_sums *g, lc_f3 weight)
{
    for (uint32_t i = 0; g && i < g->n; i++) {
        const double *cut = g->cut[i];
        const lc_f3 rgb = lc_f3_make((float)cut[0], (float)cut[1], (float)cut[2]);
        g->sample[i] = lc_f3_add(g->sample[i], lc_f3_mul(rgb, weight));
    }
}

void lc_groups_end_sample(lc_group_sums *g)
{
    for (uint32_t i = 0; g && i < g->n; i++) g->pixel[i] = lc_f3_add(g->pixel[i], g->sample[i]);
}

lc_f3 *lc_groups_begin_pixel(lc_group_sums *g)
{
    if (!g) return NULL;
    memset(g->pixel, 0, g->n * sizeof *g->pixel);
    return g->pixel;
}

void lc_groups_share(lc_group_sums *g, size_t at, double weight)
{
    for (uint32_t i = 0; g && i < g->n; i++) {
        double *sum = g->shared[at * g->n + i];
        sum[0] += weight * (double)g->sample[i].x;
        sum[1] += weight * (double)g->sample[i].y;
        sum[2] += weight * (double)g->sample[i].z;
    }
}

lc_f3 *lc_groups_of_shared(lc_group_sums *g, size_t at)
{
    for (uint32_t i = 0; g && i < g->n; i++) {
        const double *sum = g->shared[at * g->n + i];
        g->pixel[i] = lc_f3_make((float)sum[0], (float)sum[1], (float)sum[2]);
    }
    return g ? g->pixel : NULL;
}
