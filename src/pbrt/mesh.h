/* mesh.h - a shape of a pbrt file as a mesh, on its way to the scene. */
#ifndef LC_PBRT_MESH_H
#define LC_PBRT_MESH_H

#include "base/vec.h"
#include "build/reader.h"

/* The fraction of rays that a shape stops: alpha for camera rays, alpha * shadow for shadow rays. */
typedef struct lc_pbrt_alpha {
    lc_build_value alpha, shadow;
} lc_pbrt_alpha;

/* A mesh in the making; its arrays are the parser's. */
typedef struct lc_pbrt_mesh {
    uint32_t n_verts, n_tris;
    const float *pos;      /* n_verts * 3 */
    const float *uv;       /* n_verts * 2; NULL: (0,0) (1,0) (1,1) on each triangle */
    const float *normal;   /* n_verts * 3; NULL: the triangles' own */
    const uint32_t *index; /* n_tris * 3 */
    uint32_t material_id;
    bool flip;      /* ReverseOrientation xor a mirroring transform */
    lc_f3 emission; /* W/(m^2 sr); 0: does not emit */
    bool two_sided;
    const lc_pbrt_alpha *alpha; /* NULL: opaque */
    uint32_t emission_map;      /* as in lc_pbrt_attrs */
} lc_pbrt_mesh;

/* The names by which the group of an emissive shape is chosen: the file's group, the shape's kind and the
 * material, or NULL. */
typedef struct lc_pbrt_lamp_names {
    const char *own, *kind, *material;
} lc_pbrt_lamp_names;

/* A mesh as the scene's calls take it. */
lc_build_mesh_desc lc_pbrt_mesh_desc(const lc_pbrt_mesh *mesh);
#endif
