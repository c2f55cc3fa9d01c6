/* emitter.c - see emitter.h. */
#include "prepare/emitter.h"

#include "prepare/area_map.h"
#include "prepare/triangle.h"

/* By the normals if the mesh has them, else by its flip flag. */
static double side_of(const lc_scene *s, const lc_mesh *mesh, size_t tri, const double n[3])
{
    if (mesh->has_normals) {
        double d = 0;
        for (size_t v = 0; v < 3; v++)
            for (size_t k = 0; k < 3; k++) d += n[k] * lc_tri_vertex(s->normal, s->index, tri, v)[k];
        if (d != 0) return d > 0 ? 1 : -1;
    }
    return mesh->flip ? -1 : 1;
}

lc_emitter lc_emitter_of(const lc_scene *s, size_t tri)
{
    const lc_mesh *mesh = &s->meshes[s->tri_mesh[tri]];
    lc_emitter e = { .n_sides = mesh->two_sided ? 2 : 1 };
    double rgb[3] = { 1, 1, 1 };
    if (!lc_mesh_is_lamp(mesh)) return e;
    e.twice = lc_tri_cross(s, tri, e.cross);
    e.side = side_of(s, mesh, tri, e.cross);
    if (mesh->emission_map) lc_area_map_mean(s, tri, rgb);
    double area = 0.5 * e.twice;
    double l = (rgb[0] * (double)mesh->emission.x + rgb[1] * (double)mesh->emission.y +
                rgb[2] * (double)mesh->emission.z) /
               3;
    for (int k = 0; k < 3; k++) e.flux[k] = rgb[k] * area;
    e.power = l * area * e.n_sides;
    return e;
}
