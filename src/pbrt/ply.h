/* ply.h - reads PLY meshes: ASCII, and binary in either byte order.
 *
 *     element vertex    x y z, nx ny nz, u v (or s t, texture_u texture_v, texture_s texture_t)
 *     element face      vertex_indices or vertex_index
 *
 * Other elements and properties are skipped. Faces with more than three corners become triangle fans, so they
 * should be convex.
 */
#ifndef LC_PLY_H
#define LC_PLY_H

#include "io/readfile.h"

typedef struct lc_ply_mesh {
    uint32_t n_verts, n_tris;
    float *pos, *normal; /* n_verts * 3, finite; normal may be NULL */
    float *uv;           /* n_verts * 2, maybe not finite; may be NULL */
    uint32_t *index;     /* n_tris * 3, each below n_verts */
    size_t cap_index;
    uint64_t n_small_faces; /* faces with fewer than three corners, which are skipped */
} lc_ply_mesh;

/* where: the statement that refers to the file. LC_ERR_IO, _PARSE, _UNSUPPORTED, _MEMORY. */
lc_status lc_ply_load(const lc_context *ctx, lc_pos where, const char *path, lc_ply_mesh *out);
/* Parses a file in memory; data[size] must be 0. Messages give name:line:column, or the byte in binary
 * data. */
lc_status lc_ply_parse(const lc_context *ctx, const char *name, const char *data, size_t size,
                       lc_ply_mesh *out);
void lc_ply_free(const lc_context *ctx, lc_ply_mesh *mesh);

#endif
