/* shape_handler.h - what the handlers of Shape share: each turns one class of shape into a triangle mesh. */
#ifndef LC_PBRT_SHAPE_HANDLER_H
#define LC_PBRT_SHAPE_HANDLER_H

#include "pbrt/state.h"

lc_pbrt_handler lc_pbrt_shape;

/* Makes positions and normals in object space in p->pos, p->normal and p->index, and describes them in *mesh,
 * which has no triangles if the shape has no area. *area_ratio is 1 on entry and is set to the true area over
 * that of the triangles. In round.c, quadric.c, loop_subdiv.c, bilinear.c, curve.c. */
typedef lc_status lc_pbrt_shape_handler(lc_pbrt *p, const lc_pbrt_stmt *s, lc_pbrt_mesh *mesh,
                                        double *area_ratio);
lc_pbrt_shape_handler lc_pbrt_sphere, lc_pbrt_disk, lc_pbrt_cylinder, lc_pbrt_cone, lc_pbrt_paraboloid,
    lc_pbrt_hyperboloid, lc_pbrt_loop_subdiv, lc_pbrt_bilinear_mesh, lc_pbrt_curve;

/* Checks the parameter's indices and copies them to p->index, which must have room. A face has `group` (3 or
 * 4). */
lc_status lc_pbrt_copy_indices(lc_pbrt *p, const lc_pbrt_param *par, uint32_t group, uint32_t n_verts);
/* Makes room in p->pos, p->index and, with `normals`, p->normal. LC_ERR_MEMORY. */
lc_status lc_pbrt_mesh_room(lc_pbrt *p, size_t n_verts, size_t n_tris, bool normals);
/* Makes room in p->uv if *wanted: the current material, alpha or emission needs texture coordinates.
 * LC_ERR_MEMORY. */
lc_status lc_pbrt_uv_room(lc_pbrt *p, size_t n_verts, bool *wanted);

#endif
