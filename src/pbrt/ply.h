/* ply.h - PLY meshes: ASCII, binary little and big endian.
 *
 * Read are x y z, nx ny nz and u v (also s t, texture_u texture_v, texture_s texture_t) of `vertex` and
 * vertex_indices (or vertex_index) of `face`; any other element or property is skipped. Faces of more than
 * three corners become fans, so they should be convex.
 */
#ifndef LC_PLY_H
#define LC_PLY_H

#include "io/readfile.h"

typedef struct lc_ply_mesh {
    uint32_t n_verts, n_tris;
    float *pos, *normal; /* n_verts * 3, finite; normal may be NULL */
    float *uv;           /* n_verts * 2 or NULL; may hold anything */
    uint32_t *index;     /* n_tris * 3, each below n_verts */
    size_t cap_index;
    uint64_t n_small_faces; /* left out: fewer than three corners */
} lc_ply_mesh;

/* where: what refers to the file. LC_ERR_IO, _PARSE, _UNSUPPORTED, _MEMORY. */
lc_status lc_ply_load(const lc_context *ctx, lc_pos where, const char *path, lc_ply_mesh *out);
/* From memory; data[size] must be 0. Messages say name:line:column, or the byte in binary data. */
lc_status lc_ply_parse(const lc_context *ctx, const char *name, const char *data, size_t size,
                       lc_ply_mesh *out);
void lc_ply_free(const lc_context *ctx, lc_ply_mesh *mesh);

#endif
