/* bench_record.h - the rays that a render traces, kept so that they can be traced again alone.
 *
 * The recorder puts a table of kernels into a BVH whose ray kernels remember what they were asked before they
 * ask the real ones. While it is there the scene must be rendered by one thread. Rays in a row of one origin
 * make one group, as if the renderer had known them all when it sent the first.
 */
#ifndef LC_CLI_BENCH_RECORD_H
#define LC_CLI_BENCH_RECORD_H

#include "trace/bvh.h"

/* Camera rays, and the shadow rays that follow from them: kept or left out together. */
#define RECORD_BLOCK 4096u

typedef struct record_group {
    float org[3];
    uint32_t n;     /* shadow rays */
    uint64_t first; /* of their targets */
    bool far;
} record_group;

typedef struct record_camera {
    float org[3], dir[3], t_max;
} record_camera;

/* Rays of a group that is not complete yet. */
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
    uint64_t every;          /* one block of so many is kept */
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

/* Starts recording; one block in `every`, at most max_targets shadow rays. One recorder at a time. */
lc_status bench_record_start(bench_record *r, const lc_context *ctx, lc_bvh *bvh, uint64_t every,
                             size_t max_targets);
/* Puts the real kernels back. Fails when memory ran out meanwhile. */
lc_status bench_record_stop(bench_record *r);
void bench_record_free(bench_record *r);

#endif
