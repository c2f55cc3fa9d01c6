/* textured.c - see textured.h. Coordinates and what a pixel sees are worked out in double from the triangle's floats. */
#include "textured.h"

#define MIN_COS 0.015625 /* seen at a flatter angle, a pixel's area grows no more */

typedef struct {
    double x, y, z;
} d3;

static d3 sub(const float *a, const float *b) { return (d3){ (double)a[0] - b[0], (double)a[1] - b[1], (double)a[2] - b[2] }; }
static d3 cross(d3 a, d3 b) { return (d3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x }; }
static double dot(d3 a, d3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/* Length of the gradient, in the triangle's plane, of what grows by d1 along e1 and by d2 along e2; n = e1 x e2. */
static double gradient(d3 e1, d3 e2, d3 n, double d1, double d2)
{
    d3 a = cross(e2, n), b = cross(n, e1);
    d3 g = { d1 * a.x + d2 * b.x, d1 * a.y + d2 * b.y, d1 * a.z + d2 * b.z };
    double n2 = dot(n, n);
    return n2 > 0 ? sqrt(dot(g, g)) / n2 : 0;
}

static const float corners[3][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 } }; /* pbrt's, of triangles without uv */

static const float *uv_of(const lc_scene *scene, const lc_mesh *mesh, size_t tri, size_t vertex)
{
    return mesh->has_uv ? scene->uv + 2 * (size_t)scene->index[3 * tri + vertex] : corners[vertex];
}

void lc_textured_uv(const lc_scene *scene, const lc_mesh *mesh, size_t tri, size_t vertex, double uv[2])
{
    const float *t = uv_of(scene, mesh, tri, vertex);
    uv[0] = (double)t[0], uv[1] = (double)t[1];
}

static lc_tex_point point_of(const lc_scene *scene, const lc_mesh *mesh, const lc_hit *hit, lc_f3 dir, double pixel)
{
    const float *v[3], *t[3];
    double w[3] = { 1 - (double)hit->u - hit->v, (double)hit->u, (double)hit->v };
    lc_tex_point p = { .width = 0 };
    for (size_t k = 0; k < 3; k++) {
        v[k] = lc_tri_vertex(scene->pos, scene->index, hit->tri, k);
        t[k] = uv_of(scene, mesh, hit->tri, k);
        for (int i = 0; i < 3; i++) p.pos[i] += w[k] * (double)v[k][i];
        for (int i = 0; i < 2; i++) p.uv[i] += w[k] * (double)t[k][i];
    }
    d3 e1 = sub(v[1], v[0]), e2 = sub(v[2], v[0]), n = cross(e1, e2);
    p.grad_u = gradient(e1, e2, n, (double)t[1][0] - t[0][0], (double)t[2][0] - t[0][0]);
    p.grad_v = gradient(e1, e2, n, (double)t[1][1] - t[0][1], (double)t[2][1] - t[0][1]);
    /* the side of a square as large as the pixel's area on the surface */
    double len = sqrt(dot(n, n)), cosine = len > 0 ? fabs(dot(n, (d3){ (double)dir.x, (double)dir.y, (double)dir.z })) / len : 1;
    p.width = (double)hit->t * pixel / sqrt(fmax(cosine, MIN_COS));
    return p;
}

/* dp/du of p = p0 + s e1 + t e2, uv linear in s and t, times the determinant, whose sign no lobe cares for. */
lc_f3 lc_textured_tangent(const lc_scene *scene, const lc_mesh *mesh, const lc_hit *hit)
{
    const float *v[3], *t[3];
    if (!mesh->has_uv) return lc_f3_make(0, 0, 0);
    for (size_t k = 0; k < 3; k++) {
        v[k] = lc_tri_vertex(scene->pos, scene->index, hit->tri, k);
        t[k] = scene->uv + 2 * (size_t)scene->index[3 * (size_t)hit->tri + k];
    }
    d3 e1 = sub(v[1], v[0]), e2 = sub(v[2], v[0]);
    double d1 = (double)t[1][1] - t[0][1], d2 = (double)t[2][1] - t[0][1], most = fmax(fabs(d1), fabs(d2));
    double det = ((double)t[1][0] - t[0][0]) * d2 - ((double)t[2][0] - t[0][0]) * d1;
    if (!(fabs(det) > 0 && most > 0)) return lc_f3_make(0, 0, 0);
    d1 /= most, d2 /= most;
    return lc_f3_normalize_d(d2 * e1.x - d1 * e2.x, d2 * e1.y - d1 * e2.y, d2 * e1.z - d1 * e2.z);
}

static float within(double v, double least, double most) { return (float)fmin(fmax(v, least), most); }

static void set_colour(const lc_scene *scene, uint32_t id, const lc_tex_point *p, lc_f3 *out)
{
    double v[3];
    if (id == LC_NONE) return;
    lc_texture_eval(&scene->textures, id, p, v);
    *out = lc_f3_make(within(v[0], 0, 1), within(v[1], 0, 1), within(v[2], 0, 1));
}

static void set_number(const lc_scene *scene, uint32_t id, const lc_tex_point *p, float least, float most, float *out)
{
    double v[3];
    if (id == LC_NONE) return;
    lc_texture_eval(&scene->textures, id, p, v);
    *out = within(v[0], (double)least, (double)most);
}

void lc_textured_material(const lc_scene *scene, const lc_mesh *mesh, const lc_hit *hit, lc_f3 dir, double pixel,
                          lc_material *m)
{
    const lc_material_maps *maps = &scene->maps[mesh->material_id];
    lc_tex_point p = point_of(scene, mesh, hit, dir, pixel);
    set_colour(scene, maps->kd, &p, &m->kd);
    set_colour(scene, maps->ks, &p, &m->ks);
    set_number(scene, maps->exponent, &p, 0, LC_MAX_EXPONENT, &m->exponent);
    for (int k = 0; k < 2; k++) set_number(scene, maps->roughness[k], &p, LC_MIN_ROUGHNESS, LC_MAX_ROUGHNESS, &m->roughness[k]);
}

lc_f3 lc_textured_emission(const lc_scene *scene, const lc_mesh *mesh, const lc_hit *hit, lc_f3 dir, double pixel)
{
    const lc_mipmap *map = &scene->emission_maps[mesh->emission_map - 1];
    lc_tex_point p = point_of(scene, mesh, hit, dir, pixel);
    double width = p.width * fmax(p.grad_u * map->levels[0].width, p.grad_v * map->levels[0].height), rgb[3];
    lc_mipmap_lookup(map, p.uv[0], 1 - p.uv[1], fmax(width, 1), LC_WRAP_CLAMP, LC_FILTER_TRILINEAR, rgb);
    return lc_f3_make((float)fmax(rgb[0], 0), (float)fmax(rgb[1], 0), (float)fmax(rgb[2], 0));
}
