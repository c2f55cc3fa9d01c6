/* bench_record.h - keeps the rays that a render traces, so that they can be traced again alone.
 *
 * The recorder replaces the kernel table of a BVH by one whose ray kernels store their arguments and call the
 * real kernels. Until it is stopped the scene may be rendered by one thread only. Consecutive rays of one
 * origin form a group, as if the renderer had known all of them when it sent the first.
 */
#ifndef LC_CLI_BENCH_RECORD_H
#define LC_CLI_BENCH_RECORD_H

#include "trace/bvh.h"

/* Camera rays of a block, which is kept or dropped together with the shadow rays that follow from them. */
#define RECORD_BLOCK 4096u

typedef struct record_group {
    float org[3];
    uint32_t n;     /* shadow rays */
    uint64_t first; /* its first target */
    bool far;
} record_group;

typedef struct record_camera {
    float org[3], dir[3], t_max;
} record_camera;

/* A group that is not complete yet. */
typedef struct record_open {
    float *target;
    size_t cap;
    uint32_t n, n_hidden;
} record_open;

typedef struct bench_record {
    const lc_context *ctx;
    lc_bvh *bvh;
    const lc_trace_kernels *real;
    lc_trace_kernels table;
    uint64_t every;          /* one block of this many is kept */
    uint64_t n_camera_seen, n_shadow_seen;
    record_group *groups;
    record_camera *cameras;
    float *target;           /* max_targets * 3: x y z, as in the files of `bench rays` */
    size_t n_groups, cap_groups, n_cameras, cap_cameras, n_targets, max_targets;
    uint64_t n_hidden;       /* of the shadow rays kept */
    float org[3];            /* of the open groups */
    record_open open[2];     /* by `far` */
    lc_status status;
} bench_record;

/* Starts to record one block of `every`, at most max_targets shadow rays. Only one recorder may be active. */
lc_status bench_record_start(bench_record *r, const lc_context *ctx, lc_bvh *bvh, uint64_t every,
                             size_t max_targets);
/* Restores the kernels. Fails if memory ran out while recording. */
lc_status bench_record_stop(bench_record *r);
void bench_record_free(bench_record *r);

#endif
