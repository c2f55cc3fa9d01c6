/* ball_find.c - see ball_find.h. */
#include "prepare/ball_find.h"

#include "prepare/emitter.h"
#include "prepare/triangle.h"

#define MIN_TRIANGLES 40
#define ROUND 1e-3   /* of the radius: how far vertices may be off it */
#define MIN_AREA 0.8 /* of a sphere's: a mesh of 48 triangles has 0.83, an icosahedron 0.76 */

/* Whether the triangle's vertices are on the sphere and its emitting side faces outwards; adds its area. */
static bool is_on_sphere(const lc_scene *s, uint32_t tri, const double centre[3], double radius, double *area)
{
    const lc_emitter e = lc_emitter_of(s, tri);
    double out = 0;
    for (size_t v = 0; v < 3; v++) {
        const float *p = lc_tri_vertex(s->pos, s->index, tri, v);
        double d2 = 0;
        for (int k = 0; k < 3; k++) {
            double d = (double)p[k] - centre[k];
            d2 += d * d;
            out += d * e.cross[k] * e.side;
        }
        if (!(fabs(sqrt(d2) - radius) <= ROUND * radius)) return false;
    }
    *area += 0.5 * e.twice;
    return out > 0 || !(e.twice > 0);
}

bool lc_ball_find(const lc_scene *s, uint32_t id, lc_light *light)
{
    const lc_mesh *mesh = &s->meshes[id];
    if (mesh->n_tris < MIN_TRIANGLES || mesh->two_sided || mesh->emission_map || mesh->alpha != LC_NONE)
        return false;
    const lc_box box = lc_mesh_box(s, mesh);
    const double centre[3] = { ((double)box.lo.x + (double)box.hi.x) / 2,
                               ((double)box.lo.y + (double)box.hi.y) / 2,
                               ((double)box.lo.z + (double)box.hi.z) / 2 };
    const double radius = ((double)box.hi.x - (double)box.lo.x) / 2;
    double area = 0;
    if (!(radius > 0)) return false;
    for (uint32_t t = mesh->first_tri; t < mesh->first_tri + mesh->n_tris; t++)
        if (!is_on_sphere(s, t, centre, radius, &area)) return false;
    if (!(area >= MIN_AREA * 4 * LC_PI * radius * radius)) return false;
    *light = (lc_light){ .kind = LC_LIGHT_BALL,
                         .pos = lc_f3_make((float)centre[0], (float)centre[1], (float)centre[2]),
                         .intensity = lc_f3_scale(mesh->emission, (float)(area / 4)),
                         .radius = (float)radius,
                         .group = mesh->group };
    return light->radius > 0;
}
