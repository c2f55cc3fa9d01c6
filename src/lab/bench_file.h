/* bench_file.h - the exchange files of `lightcuts bench rays`, little endian, and generated meshes and rays.
 *
 *     mesh   "LCMESH1\0", uint32 n_verts, uint32 n_tris, float32 xyz[3 n_verts], uint32 index[3 n_tris]
 *     rays   "LCRAYS1\0", uint64 n_rays, uint32 group, uint32 0, per ray float32 origin xyz, target xyz
 */
#ifndef LC_CLI_BENCH_FILE_H
#define LC_CLI_BENCH_FILE_H

#include "io/readfile.h"

typedef struct bench_mesh {
    lc_file file; /* the memory of the arrays */
    const float *pos;      /* n_verts * 3, finite */
    const uint32_t *index; /* n_tris * 3, below n_verts */
    uint32_t n_verts, n_tris;
} bench_mesh;

typedef struct bench_segments {
    lc_file file;
    const float *ray; /* n * 6: origin, target; finite */
    uint64_t n;       /* at least 1 */
    uint32_t group;   /* this many consecutive rays share an origin; 0: unknown */
} bench_segments;

/* LC_ERR_IO, _PARSE (which names the byte), _MEMORY; all logged. Free the result with lc_file_free(.file). */
lc_status bench_read_mesh(const lc_context *ctx, const char *path, bench_mesh *out);
lc_status bench_read_segments(const lc_context *ctx, const char *path, bench_segments *out);

/* A closed box of 10 x 10 x 10 with n small boxes in it, 12 (n + 1) triangles. */
lc_status bench_make_mesh(const lc_context *ctx, uint32_t n_boxes, bench_mesh *out);
/* 64 segments from each of n_points random points in it to points below its ceiling. */
lc_status bench_make_segments(const lc_context *ctx, uint32_t n_points, bench_segments *out);

#endif
