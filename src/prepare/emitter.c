/* emitter.c - see emitter.h. */
#include "prepare/emitter.h"

#include "prepare/area_map.h"

static double cross_of(const lc_scene *s, size_t tri, double n[3])
{
    const float *p0 = lc_tri_vertex(s->pos, s->index, tri, 0), *p1 = lc_tri_vertex(s->pos, s->index, tri, 1);
    const float *p2 = lc_tri_vertex(s->pos, s->index, tri, 2);
    double a[3], b[3];
    for (int k = 0; k < 3; k++) {
        a[k] = (double)p1[k] - p0[k];
        b[k] = (double)p2[k] - p0[k];
    }
    n[0] = a[1] * b[2] - a[2] * b[1];
    n[1] = a[2] * b[0] - a[0] * b[2];
    n[2] = a[0] * b[1] - a[1] * b[0];
    return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

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
    e.twice = cross_of(s, tri, e.cross);
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

double lc_tri_area(const lc_scene *s, size_t tri)
{
    double n[3];
    return 0.5 * cross_of(s, tri, n);
}

lc_f3 lc_tri_point(const lc_scene *s, size_t tri, const double b[2])
{
    double x[3];
    for (size_t k = 0; k < 3; k++)
        x[k] = (1 - b[0] - b[1]) * (double)lc_tri_vertex(s->pos, s->index, tri, 0)[k] +
               b[0] * (double)lc_tri_vertex(s->pos, s->index, tri, 1)[k] +
               b[1] * (double)lc_tri_vertex(s->pos, s->index, tri, 2)[k];
    return lc_f3_make((float)x[0], (float)x[1], (float)x[2]);
}

lc_box lc_mesh_box(const lc_scene *s, const lc_mesh *mesh)
{
    lc_box box = lc_box_empty();
    for (size_t t = mesh->first_tri; t < (size_t)mesh->first_tri + mesh->n_tris; t++)
        for (size_t v = 0; v < 3; v++) lc_box_add(&box, lc_f3_load(lc_tri_vertex(s->pos, s->index, t, v)));
    return box;
}
