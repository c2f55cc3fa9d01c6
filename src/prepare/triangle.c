/* triangle.c - see triangle.h. */
#include "prepare/triangle.h"

double lc_tri_cross(const lc_scene *s, size_t tri, double n[3])
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

double lc_tri_area(const lc_scene *s, size_t tri)
{
    double n[3];
    return 0.5 * lc_tri_cross(s, tri, n);
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

lc_f3 lc_tri_light_at(const lc_scene *s, size_t tri, lc_f3 p, lc_f3 n)
{
    float size = 0;
    for (size_t v = 0; v < 3; v++)
        size = fmaxf(size, lc_f3_max_abs(lc_f3_load(lc_tri_vertex(s->pos, s->index, tri, v))));
    return lc_f3_off(p, n, size);
}

lc_box lc_mesh_box(const lc_scene *s, const lc_mesh *mesh)
{
    lc_box box = lc_box_empty();
    for (size_t t = mesh->first_tri; t < (size_t)mesh->first_tri + mesh->n_tris; t++)
        for (size_t v = 0; v < 3; v++) lc_box_add(&box, lc_f3_load(lc_tri_vertex(s->pos, s->index, t, v)));
    return box;
}
