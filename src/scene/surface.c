/* surface.c - the position from barycentric coordinates (more accurate than origin + t dir), normals, and the
 * offset of shadow-ray origins. */
#include "scene/surface.h"

#include "scene/instance.h"
#include "scene/material_eval.h"

/* (1 - u - w) v[0] + u v[1] + w v[2]. */
static lc_f3 mix(const float *const v[3], float u, float w)
{
    float s = 1 - u - w;
    return lc_f3_make(s * v[0][0] + u * v[1][0] + w * v[2][0], s * v[0][1] + u * v[1][1] + w * v[2][1],
                      s * v[0][2] + u * v[1][2] + w * v[2][2]);
}

lc_f3 lc_surface_behind(const lc_surface *s)
{
    return lc_f3_sub(s->pos, lc_f3_sub(lc_f3_load(s->ray_org), s->pos));
}

/* Transforms the corners of an instance's triangle to the world, to the same bits as pbrt/object.c does when
 * it copies an object. */
static void place_corners(const lc_instance *at, bool has_normals, lc_corners *c)
{
    double rows[9];
    lc_xform x = { { 0 } };
    for (int i = 0; i < 12; i++) x.m[i] = at->to_world[i];
    x.m[15] = 1;
    if (has_normals) lc_xform_normal_rows(&x, rows);
    for (int k = 0; k < 3; k++) {
        lc_instance_point(at, c->p[k], c->placed_p[k]);
        c->p[k] = c->placed_p[k];
        if (!has_normals) continue;
        lc_xform_normal(rows, c->n[k], c->placed_n[k]);
        c->n[k] = c->placed_n[k];
    }
}

/* How much a shadow ray's rounding into object space adds to the `size` of its origin: an error of e along
 * each axis of object space shifts the ray by e |M^T n|_1 along n, and e is proportional to the triangle's
 * largest coordinate. */
static float object_size(const lc_scene *scene, const lc_hit *hit, lc_f3 n)
{
    const lc_instance *at = &scene->instances[hit->instance];
    double size = 0, sum = 0;
    for (size_t k = 0; k < 3; k++)
        size = fmax(size,
                    (double)lc_f3_max_abs(lc_f3_load(lc_tri_vertex(scene->pos, scene->index, hit->tri, k))));
    for (int j = 0; j < 3; j++)
        sum += fabs((double)n.x * at->to_world[j] + (double)n.y * at->to_world[4 + j] +
                    (double)n.z * at->to_world[8 + j]);
    return (float)(size * sum);
}

void lc_hit_corners(const lc_scene *scene, const lc_mesh *mesh, const lc_hit *hit, lc_corners *c)
{
    for (size_t k = 0; k < 3; k++) {
        c->p[k] = lc_tri_vertex(scene->pos, scene->index, hit->tri, k);
        if (mesh->has_normals) c->n[k] = lc_tri_vertex(scene->normal, scene->index, hit->tri, k);
    }
    if (hit->instance != LC_NONE) place_corners(&scene->instances[hit->instance], mesh->has_normals, c);
}

bool lc_hit_normals(const lc_mesh *mesh, const lc_hit *hit, const lc_corners *c, lc_f3 *ng, lc_f3 *ns)
{
    const float *const *v = c->p;
    lc_f3 p0 = lc_f3_load(v[0]), e1 = lc_f3_sub(lc_f3_load(v[1]), p0), e2 = lc_f3_sub(lc_f3_load(v[2]), p0);
    *ng = *ns = lc_f3_normalize(lc_f3_cross(e1, e2));
    if (!mesh->has_normals) return false;
    lc_f3 n = lc_f3_normalize(mix(c->n, hit->u, hit->v));
    if (!(lc_f3_dot(n, n) > 0)) return false;
    *ns = n;
    return true;
}

/* Evaluates the material's textures and returns the shading normal. ng is the normal by winding order, ns the
 * shading normal without textures; it stays if bump or normal maps would tilt it below the surface. */
static lc_f3 textured_normal(const lc_scene *scene, const lc_mesh *mesh, const float *const corner[3],
                             const lc_hit *hit, lc_f3 dir, double pixel, lc_f3 ns, lc_f3 ng, lc_material *m)
{
    bool turned = !mesh->has_normals && mesh->flip; /* ns points by winding order, not to the outer side */
    lc_f3 own = turned ? lc_f3_neg(ns) : ns, tilted = own;
    lc_textured_material(scene, mesh, corner, hit, dir, pixel, m, &tilted);
    bool below = (lc_f3_dot(tilted, ng) > 0) != (lc_f3_dot(own, ng) > 0);
    if (below) return ns;
    return turned ? lc_f3_neg(tilted) : tilted;
}

bool lc_surface_hit(const lc_scene *scene, lc_f3 org, lc_f3 dir, double pixel, lc_surface *out)
{
    return lc_surface_hit_after(scene, org, dir, 0, pixel, out);
}

void lc_closest_hit(const lc_scene *scene, lc_f3 org, lc_f3 dir, lc_hit *hit)
{
    const float o[3] = { org.x, org.y, org.z }, d[3] = { dir.x, dir.y, dir.z };
    scene->bvh->kernels->closest(&scene->bvh->data, o, d, FLT_MAX, hit);
}

bool lc_surface_hit_after(const lc_scene *scene, lc_f3 org, lc_f3 dir, float length, double pixel,
                          lc_surface *out)
{
    lc_hit hit;
    lc_closest_hit(scene, org, dir, &hit);
    if (hit.tri == LC_NONE) return false;
    hit.t += length;
    lc_surface_of(scene, &hit, dir, pixel, out);
    return true;
}

static float largest_coordinate(const float *const v[3])
{
    float size = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) size = fabsf(v[i][k]) > size ? fabsf(v[i][k]) : size;
    return size;
}

bool lc_is_flat(const lc_scene *scene, const lc_hit *hit)
{
    const lc_mesh *mesh = &scene->meshes[scene->tri_mesh[hit->tri]];
    return hit->instance == LC_NONE && !mesh->has_normals && !mesh->textured && !mesh->brushed &&
           !mesh->emission_map;
}

void lc_surface_move(const lc_scene *scene, const lc_hit *hit, lc_surface *s)
{
    const float *v[3];
    for (size_t k = 0; k < 3; k++) v[k] = lc_tri_vertex(scene->pos, scene->index, hit->tri, k);
    s->pos = mix(v, hit->u, hit->v);
    s->t = hit->t;
    lc_f3_store(s->ray_org, lc_f3_off(s->pos, s->ng, largest_coordinate(v)));
}

void lc_surface_of(const lc_scene *scene, const lc_hit *hit, lc_f3 dir, double pixel, lc_surface *out)
{
    lc_corners c;
    lc_f3 ng, ns;
    const lc_mesh *mesh = &scene->meshes[scene->tri_mesh[hit->tri]];
    lc_hit_corners(scene, mesh, hit, &c);
    const float *const *v = c.p;
    bool back = mesh->flip != (hit->instance != LC_NONE && scene->instances[hit->instance].mirrored);
    out->pos = mix(v, hit->u, hit->v);
    if (lc_hit_normals(mesh, hit, &c, &ng, &ns)) back = lc_f3_dot(ng, ns) < 0;
    float size = largest_coordinate(v);
    if (hit->instance != LC_NONE) size += object_size(scene, hit, ng);
    out->material_id = mesh->material_id;
    out->moment = scene->moment;
    out->group = mesh->group;
    out->material = scene->materials[mesh->material_id];
    if (mesh->textured) ns = textured_normal(scene, mesh, v, hit, dir, pixel, ns, ng, &out->material);
    bool away = lc_f3_dot(ng, dir) > 0; /* the normal by winding order points away from the viewer */
    if (away) ng = lc_f3_neg(ng);
    if (lc_f3_dot(ns, ng) < 0) ns = lc_f3_neg(ns);
    out->n = ns;
    out->ng = ng;
    out->t = hit->t;
    out->front = back == away;
    out->only_seen = mesh->n_places > 0;
    out->emission = out->front || mesh->two_sided ? mesh->emission : lc_f3_make(0, 0, 0);
    if (mesh->emission_map && lc_f3_max(out->emission) > 0)
        out->emission = lc_f3_mul(out->emission, lc_textured_emission(scene, mesh, v, hit, dir, pixel));
    if (mesh->brushed) out->material.tangent = lc_textured_tangent(scene, mesh, v, hit);
    lc_f3_store(out->ray_org, lc_f3_off(out->pos, ng, size));
}
