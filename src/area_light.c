/* area_light.c - k points on a triangle, stratified: the unit square is cut into k jittered cells of a rank-1 lattice
 * and folded onto the triangle. Gridded points would give exact ties in the light tree and visible bands. */
#include "area_light.h"

#include "area_map.h"
#include "rng.h"

/* Twice the area vector of a triangle, double. */
static double cross_of(const lc_scene *s, size_t tri, double n[3])
{
    const float *p0 = lc_tri_vertex(s->pos, s->index, tri, 0), *p1 = lc_tri_vertex(s->pos, s->index, tri, 1);
    const float *p2 = lc_tri_vertex(s->pos, s->index, tri, 2);
    double a[3], b[3];
    for (int k = 0; k < 3; k++) a[k] = (double)p1[k] - p0[k], b[k] = (double)p2[k] - p0[k];
    n[0] = a[1] * b[2] - a[2] * b[1];
    n[1] = a[2] * b[0] - a[0] * b[2];
    n[2] = a[0] * b[1] - a[1] * b[0];
    return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

/* Which side of the winding emits: normals decide where there are any, else the flip flag. */
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

/* Emitted power of a triangle, the scalar that lights are shared out by. */
static double power_of(const lc_scene *s, size_t tri, double *area, double n[3])
{
    const lc_mesh *mesh = &s->meshes[s->tri_mesh[tri]];
    *area = 0.5 * cross_of(s, tri, n);
    double rgb[3] = { 1, 1, 1 };
    if (mesh->emission_map && lc_f3_max(mesh->emission) > 0) lc_area_map_mean(s, tri, rgb);
    double l = (rgb[0] * (double)mesh->emission.x + rgb[1] * (double)mesh->emission.y + rgb[2] * (double)mesh->emission.z) / 3;
    return l * *area * (mesh->two_sided ? 2 : 1);
}

static lc_status add_lights(lc_scene *s, size_t tri, uint32_t k, double area, const double n[3], double side,
                            uint64_t seed)
{
    const lc_mesh *mesh = &s->meshes[s->tri_mesh[tri]];
    const float *p[3];
    for (size_t v = 0; v < 3; v++) p[v] = lc_tri_vertex(s->pos, s->index, tri, v);
    lc_light light = { .kind = LC_LIGHT_ORIENTED, .atten = { 0, 0, 1 } };
    light.intensity = lc_f3_scale(mesh->emission, (float)(area / k));
    light.dir = lc_f3_normalize_d(n[0] * side / (2 * area), n[1] * side / (2 * area), n[2] * side / (2 * area));
    if (mesh->emission_map) {
        light.intensity = lc_f3_scale(mesh->emission, (float)area);
        return lc_area_map_lights(s, tri, k, &light, lc_hash4(seed, tri, 0, 6 + (side > 0)));
    }
    for (uint32_t i = 0; i < k; i++) {
        uint64_t sign = side > 0;
        double u = (i + lc_unit(lc_hash4(seed, tri, i, sign))) / k;
        double v = i * 0.61803398874989484820 + lc_unit(lc_hash4(seed, tri, 0, 2 + sign));
        v += lc_unit(lc_hash4(seed, tri, i, 4 + sign)) / k;
        v -= floor(v);
        double b0 = 1 - sqrt(u), b1 = v * sqrt(u), b2 = 1 - b0 - b1;
        light.pos = lc_f3_make((float)(b0 * p[0][0] + b1 * p[1][0] + b2 * p[2][0]),
                               (float)(b0 * p[0][1] + b1 * p[1][1] + b2 * p[2][1]),
                               (float)(b0 * p[0][2] + b1 * p[1][2] + b2 * p[2][2]));
        lc_status st = lc_scene_add_light(s, (lc_pos){ 0, 0, 0 }, &light);
        if (st) return st;
    }
    return LC_OK;
}

lc_status lc_area_lights_make(lc_scene *scene, uint32_t n_lights, uint64_t seed)
{
    double total = 0, before = 0, area, n[3];
    for (size_t t = 0; t < scene->n_tris; t++) total += power_of(scene, t, &area, n);
    if (!(total > 0)) return LC_OK;
    for (size_t t = 0; t < scene->n_tris; t++) {
        double power = power_of(scene, t, &area, n);
        if (!(power > 0)) continue;
        const lc_mesh *mesh = &scene->meshes[scene->tri_mesh[t]];
        scene->n_emissive_tris++;
        /* The share of this triangle: rounding the running sum keeps the total. */
        double first = floor(before / total * n_lights), last = floor((before + power) / total * n_lights);
        before += power;
        uint32_t sides = mesh->two_sided ? 2 : 1, k = (uint32_t)(last - first) / sides;
        if (!k) k = 1;
        double side = side_of(scene, mesh, t, n);
        for (uint32_t i = 0; i < sides; i++) {
            lc_status st = add_lights(scene, t, k, area, n, i ? -side : side, seed);
            if (st) return st;
        }
    }
    return LC_OK;
}
