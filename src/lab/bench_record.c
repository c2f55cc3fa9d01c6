/* bench_record.c - see bench_record.h. */
#include "lab/bench_record.h"

#include <string.h>

static bench_record *current; /* the recorder in use: kernels have no argument for it */

static bool keeps(const bench_record *r)
{
    uint64_t block = r->n_camera_seen ? (r->n_camera_seen - 1) / RECORD_BLOCK : 0;
    return !r->status && block % r->every == 0;
}

static void close_group(bench_record *r, bool far)
{
    record_open *o = &r->open[far];
    if (o->n && o->n <= r->max_targets - r->n_targets && !r->status) {
        r->status = lc_grow(r->ctx, (void **)&r->groups, &r->cap_groups, r->n_groups + 1, sizeof *r->groups);
        if (r->status) return;
        record_group *g = &r->groups[r->n_groups++];
        *g = (record_group){ { r->org[0], r->org[1], r->org[2] }, o->n, r->n_targets, far };
        memcpy(r->target + 3 * r->n_targets, o->target, (size_t)o->n * 3 * sizeof(float));
        r->n_targets += o->n;
        r->n_hidden += o->n_hidden;
    }
    o->n = o->n_hidden = 0;
}

static void close_groups(bench_record *r)
{
    close_group(r, false);
    close_group(r, true);
}

static void add(bench_record *r, const float org[3], uint32_t n, const float *const target[3], bool far,
                const uint8_t *hidden)
{
    if (memcmp(r->org, org, sizeof r->org) != 0) {
        close_groups(r);
        memcpy(r->org, org, sizeof r->org);
    }
    record_open *o = &r->open[far];
    r->status = lc_grow(r->ctx, (void **)&o->target, &o->cap, 3 * ((size_t)o->n + n), sizeof(float));
    if (r->status) return;
    for (uint32_t i = 0; i < n; i++, o->n++) {
        for (int k = 0; k < 3; k++) o->target[3 * (size_t)o->n + (size_t)k] = target[k][i];
        o->n_hidden += hidden[i];
    }
}

static void record_hidden(const lc_bvh_data *bvh, const float org[3], uint32_t n,
                          const float *const target[3], bool far, uint8_t *hidden, uint32_t *block)
{
    bench_record *r = current;
    r->real->hidden(bvh, org, n, target, far, hidden, block);
    r->n_shadow_seen += n;
    if (keeps(r)) add(r, org, n, target, far, hidden);
}

static void record_dimmed(const lc_bvh_data *bvh, const float org[3], uint32_t n,
                          const float *const target[3], bool far, uint8_t *hidden, uint32_t *block,
                          uint64_t (*loss)[3])
{
    bench_record *r = current;
    r->real->dimmed(bvh, org, n, target, far, hidden, block, loss);
    r->n_shadow_seen += n;
    if (keeps(r)) add(r, org, n, target, far, hidden);
}

static void record_closest(const lc_bvh_data *bvh, const float org[3], const float dir[3], float t_max,
                           lc_hit *hit)
{
    bench_record *r = current;
    r->real->closest(bvh, org, dir, t_max, hit);
    close_groups(r);
    r->n_camera_seen++;
    if (!keeps(r)) return;
    r->status = lc_grow(r->ctx, (void **)&r->cameras, &r->cap_cameras, r->n_cameras + 1, sizeof *r->cameras);
    if (r->status) return;
    r->cameras[r->n_cameras++] =
        (record_camera){ { org[0], org[1], org[2] }, { dir[0], dir[1], dir[2] }, t_max };
}

lc_status bench_record_start(bench_record *r, const lc_context *ctx, lc_bvh *bvh, uint64_t every,
                             size_t max_targets)
{
    *r = (bench_record){ .ctx = ctx, .bvh = bvh, .real = bvh->kernels, .table = *bvh->kernels, .every = every,
                         .max_targets = max_targets };
    r->target = lc_alloc(ctx, max_targets, 3 * sizeof(float));
    if (!r->target) return LC_ERR_MEMORY;
    r->table.hidden = record_hidden;
    r->table.dimmed = record_dimmed;
    r->table.closest = record_closest;
    bvh->kernels = &r->table;
    current = r;
    return LC_OK;
}

lc_status bench_record_stop(bench_record *r)
{
    close_groups(r);
    r->bvh->kernels = r->real;
    current = NULL;
    return r->status;
}

void bench_record_free(bench_record *r)
{
    lc_free(r->ctx, r->target, r->max_targets, 3 * sizeof(float));
    for (int far = 0; far < 2; far++) lc_free(r->ctx, r->open[far].target, r->open[far].cap, sizeof(float));
    lc_free(r->ctx, r->groups, r->cap_groups, sizeof *r->groups);
    lc_free(r->ctx, r->cameras, r->cap_cameras, sizeof *r->cameras);
}
