/* surface.c - position from barycentric weights (better than origin + t dir), normals, offset of shadow rays. */
#include "surface.h"

#include "textured.h"

static lc_f3 mix(const float *v[3], float u, float w)
{
    float s = 1 - u - w;
    return lc_f3_make(s * v[0][0] + u * v[1][0] + w * v[2][0], s * v[0][1] + u * v[1][1] + w * v[2][1],
                      s * v[0][2] + u * v[1][2] + w * v[2][2]);
}

/* The interpolated position is within 4 ulp of the plane, ulp of the largest coordinate; shadow rays start twice that
 * and the rounding of the start itself above it. */
static void set_ray_origin(lc_surface *s, lc_f3 ng, float size)
{
    lc_f3 o = lc_f3_add(s->pos, lc_f3_scale(ng, 10 * 0x1p-23f * size));
    lc_f3_store(s->ray_org, o);
}

bool lc_surface_hit(const lc_scene *scene, lc_f3 org, lc_f3 dir, double pixel, lc_surface *out)
{
    return lc_surface_hit_after(scene, org, dir, 0, pixel, out);
}

bool lc_surface_hit_after(const lc_scene *scene, lc_f3 org, lc_f3 dir, float way, double pixel, lc_surface *out)
{
    const float o[3] = { org.x, org.y, org.z }, d[3] = { dir.x, dir.y, dir.z };
    const float *v[3];
    lc_hit hit;
    scene->bvh->kernels->closest(&scene->bvh->data, o, d, FLT_MAX, &hit);
    if (hit.tri == LC_NONE) return false;
    hit.t += way;
    const lc_mesh *mesh = &scene->meshes[scene->tri_mesh[hit.tri]];
    for (size_t k = 0; k < 3; k++) v[k] = lc_tri_vertex(scene->pos, scene->index, hit.tri, k);
    lc_f3 p0 = lc_f3_load(v[0]), e1 = lc_f3_sub(lc_f3_load(v[1]), p0), e2 = lc_f3_sub(lc_f3_load(v[2]), p0);
    lc_f3 ng = lc_f3_normalize(lc_f3_cross(e1, e2)), ns = ng;
    bool back = mesh->flip;
    out->pos = mix(v, hit.u, hit.v);
    float size = fmaxf(lc_f3_max_abs(p0), fmaxf(lc_f3_max_abs(lc_f3_load(v[1])), lc_f3_max_abs(lc_f3_load(v[2]))));
    if (mesh->has_normals) {
        for (size_t k = 0; k < 3; k++) v[k] = lc_tri_vertex(scene->normal, scene->index, hit.tri, k);
        lc_f3 n = lc_f3_normalize(mix(v, hit.u, hit.v));
        if (lc_f3_dot(n, n) > 0) ns = n, back = lc_f3_dot(ng, n) < 0;
    }
    bool away = lc_f3_dot(ng, dir) > 0; /* the winding's side faces away from the viewer */
    if (away) ng = lc_f3_neg(ng);
    if (lc_f3_dot(ns, ng) < 0) ns = lc_f3_neg(ns);
    out->n = ns;
    out->ng = ng;
    out->t = hit.t;
    out->emission = back == away || mesh->two_sided ? mesh->emission : lc_f3_make(0, 0, 0);
    if (mesh->emission_map && lc_f3_max(out->emission) > 0)
        out->emission = lc_f3_mul(out->emission, lc_textured_emission(scene, mesh, &hit, dir, pixel));
    out->material = scene->materials[mesh->material_id];
    if (mesh->textured) lc_textured_material(scene, mesh, &hit, dir, pixel, &out->material);
    if (mesh->brushed) out->material.tangent = lc_textured_tangent(scene, mesh, &hit);
    set_ray_origin(out, ng, size);
    return true;
}
