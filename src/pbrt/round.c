/* round.c - spheres and disks as triangles.
 *
 * The first quarter of a million triangles (16 spheres) have 128 segments around, so the silhouette is within
 * 1 - cos(pi / 128) = 0.03 % of the radius. Later shapes are coarser, since in scenes with thousands of
 * spheres they are small: ten thousand take 1.4 million triangles, and each further one 48. Vertices lie on
 * the true surface. The faces have less area; the ratio is returned, and emission is multiplied by it to
 * preserve the power.
 */
#include "pbrt/round.h"

#include "base/fmath.h"

#define FULL                                                                                                 \
    LC_SIZE((uint64_t)1 << 18, 0) /* triangles at the finest level; none in fuzzers, which need              \
                                   * speed */

#define MIN_STEP 1e-3 /* least distance of a ring from a sphere's edge, as a fraction of a step */

static const struct {
    uint64_t up_to; /* the level applies until so many triangles of round shapes have been made */
    uint32_t segments;
} levels[] = {
    { FULL, LC_PBRT_ROUND_SEGMENTS }, { 2 * FULL, 64 }, { 3 * FULL, 32 }, { 4 * FULL, 16 }, { UINT64_MAX, 8 }
};

uint32_t lc_pbrt_segments(const lc_pbrt *p)
{
    size_t i = 0;
    while (p->n_round_tris >= levels[i].up_to) i++;
    const uint32_t n = levels[i].segments;
    return n > LC_PBRT_MOVING_SEGMENTS && lc_pbrt_is_moving_lamp(p) ? LC_PBRT_MOVING_SEGMENTS : n;
}

lc_status lc_pbrt_get_sweep(lc_pbrt *p, uint32_t segments, lc_pbrt_sweep *out)
{
    out->degrees = 360;
    lc_status st = lc_pbrt_get_float(&p->params, "phimax", &out->degrees, NULL);
    out->degrees = fmin(fmax(out->degrees, 0), 360);
    out->n = (uint32_t)ceil(segments * out->degrees / 360);
    if (out->n < 3) out->n = 3;
    return st;
}

static void put_vertex(float *v, double x, double y, double z)
{
    v[0] = (float)x;
    v[1] = (float)y;
    v[2] = (float)z;
}

uint32_t lc_pbrt_join_rings(lc_pbrt *p, uint32_t n_rings, uint32_t around, bool tip_first, bool tip_last)
{
    uint32_t *out = p->index, row = around + 1;
    for (uint32_t i = 0; i + 1 < n_rings; i++)
        for (uint32_t j = 0; j < around; j++) {
            uint32_t a = i * row + j, b = a + 1, c = a + row, d = c + 1;
            if (i || !tip_first) {
                *out++ = a;
                *out++ = b;
                *out++ = d;
            }
            if (i + 2 < n_rings || !tip_last) {
                *out++ = a;
                *out++ = d;
                *out++ = c;
            }
        }
    return (uint32_t)((size_t)(out - p->index) / 3);
}

/* The area of the triangles made. */
static double area_of(const lc_pbrt *p, uint32_t n_tris)
{
    double sum = 0;
    for (size_t t = 0; t < n_tris; t++) {
        const float *v[3];
        double a[3], b[3];
        for (int k = 0; k < 3; k++) v[k] = p->pos + 3 * (size_t)p->index[3 * t + (size_t)k];
        for (int k = 0; k < 3; k++) {
            a[k] = (double)v[1][k] - v[0][k];
            b[k] = (double)v[2][k] - v[0][k];
        }
        double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
        sum += 0.5 * sqrt(x * x + y * y + z * z);
    }
    return sum;
}

void lc_pbrt_finish_round(lc_pbrt *p, lc_pbrt_mesh *mesh, uint32_t n_verts, uint32_t n_tris, bool normals,
                          double exact, double *area_ratio)
{
    mesh->n_verts = n_verts;
    mesh->n_tris = n_tris;
    p->n_round_tris += n_tris;
    mesh->pos = p->pos;
    mesh->normal = normals ? p->normal : NULL;
    mesh->index = p->index;
    double ratio = exact / area_of(p, n_tris);
    *area_ratio = ratio > 0.25 && ratio < 4 ? ratio : 1; /* outside of this only by under- or overflow */
}

void lc_pbrt_ring_uv(lc_pbrt *p, size_t first, uint32_t around, double v)
{
    for (size_t j = 0; j <= around; j++) {
        p->uv[2 * (first + j)] = (float)((double)j / around);
        p->uv[2 * (first + j) + 1] = (float)v;
    }
}

lc_status lc_pbrt_no_area(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    return lc_pbrt_note(p, s->pos, "shape without area", "a %s without area is skipped", s->text[0]);
}

/* The heights of a sphere's rings: `half` equal steps of latitude, cut off at zmin and zmax. */
static uint32_t sphere_rings(double radius, double zmin, double zmax, uint32_t half, double *z)
{
    uint32_t n = 0;
    z[n++] = zmin;
    for (uint32_t k = 1; k < half; k++) {
        double sine, cosine;
        lc_sincos_deg(180.0 * k / half, &sine, &cosine);
        double ring = -radius * cosine;
        /* A ring next to the edge would only make slivers. */
        if (ring > zmin + MIN_STEP * radius / half && ring < zmax - MIN_STEP * radius / half) z[n++] = ring;
    }
    z[n++] = zmax;
    return n;
}

/* The latitude of the ring at height z. */
static double latitude(double z, double radius)
{
    double c = fmin(fmax(z / radius, -1), 1);
    return lc_atan2(c, sqrt((1 - c) * (1 + c)));
}

lc_status lc_pbrt_sphere(lc_pbrt *p, const lc_pbrt_stmt *s, lc_pbrt_mesh *mesh, double *area_ratio)
{
    double radius = 1, z[66];
    lc_status st = lc_pbrt_get_float(&p->params, "radius", &radius, NULL);
    double z0 = -radius, z1 = radius;
    if (!st) st = lc_pbrt_get_float(&p->params, "zmin", &z0, NULL);
    if (!st) st = lc_pbrt_get_float(&p->params, "zmax", &z1, NULL);
    double zmin = fmax(fmin(z0, z1), -radius), zmax = fmin(fmax(z0, z1), radius);
    uint32_t segments = lc_pbrt_segments(p);
    lc_pbrt_sweep around;
    if (!st) st = lc_pbrt_get_sweep(p, segments, &around);
    if (st) return st;
    if (!(radius > 0 && zmin < zmax && around.degrees > 0)) return lc_pbrt_no_area(p, s);
    uint32_t n_rings = sphere_rings(radius, zmin, zmax, segments / 2, z), row = around.n + 1;
    st = lc_pbrt_mesh_room(p, (size_t)n_rings * row, 2 * (size_t)n_rings * around.n, true);
    if (st) return st;
    bool uv;
    if ((st = lc_pbrt_uv_room(p, (size_t)n_rings * row, &uv))) return st;
    if (uv) mesh->uv = p->uv;
    for (uint32_t i = 0; i < n_rings && uv; i++)
        lc_pbrt_ring_uv(p, (size_t)i * row, around.n,
                        (latitude(z[i], radius) - latitude(zmin, radius)) /
                            (latitude(zmax, radius) - latitude(zmin, radius)));
    for (uint32_t j = 0; j < row; j++) {
        double sine, cosine;
        lc_sincos_deg(around.degrees * j / around.n, &sine, &cosine);
        for (uint32_t i = 0; i < n_rings; i++) {
            double c = fmin(fmax(z[i] / radius, -1), 1), r = sqrt((1 - c) * (1 + c));
            size_t at = 3 * ((size_t)i * row + j);
            put_vertex(p->pos + at, radius * r * cosine, radius * r * sine, z[i]);
            put_vertex(p->normal + at, r * cosine, r * sine, c);
        }
    }
    uint32_t n_tris = lc_pbrt_join_rings(p, n_rings, around.n, zmin <= -radius, zmax >= radius);
    double exact = around.degrees * (LC_PI / 180) * radius * (zmax - zmin);
    lc_pbrt_finish_round(p, mesh, n_rings * row, n_tris, true, exact, area_ratio);
    return LC_OK;
}

lc_status lc_pbrt_disk(lc_pbrt *p, const lc_pbrt_stmt *s, lc_pbrt_mesh *mesh, double *area_ratio)
{
    double height = 0, radius = 1, inner = 0;
    lc_status st = lc_pbrt_get_float(&p->params, "height", &height, NULL);
    if (!st) st = lc_pbrt_get_float(&p->params, "radius", &radius, NULL);
    if (!st) st = lc_pbrt_get_float(&p->params, "innerradius", &inner, NULL);
    lc_pbrt_sweep around;
    if (!st) st = lc_pbrt_get_sweep(p, lc_pbrt_segments(p), &around);
    if (st) return st;
    if (!(inner >= 0 && radius > inner && around.degrees > 0)) return lc_pbrt_no_area(p, s);
    uint32_t row = around.n + 1;
    if ((st = lc_pbrt_mesh_room(p, 2 * (size_t)row, 2 * (size_t)around.n, false))) return st;
    bool uv;
    if ((st = lc_pbrt_uv_room(p, 2 * (size_t)row, &uv))) return st;
    if (uv) {
        mesh->uv = p->uv;
        lc_pbrt_ring_uv(p, 0, around.n, 0);
        lc_pbrt_ring_uv(p, row, around.n, 1);
    }
    /* The outer ring comes first, so that triangles are counter-clockwise seen from +z. */
    for (uint32_t j = 0; j < row; j++) {
        double sine, cosine;
        lc_sincos_deg(around.degrees * j / around.n, &sine, &cosine);
        put_vertex(p->pos + 3 * (size_t)j, radius * cosine, radius * sine, height);
        put_vertex(p->pos + 3 * ((size_t)row + j), inner * cosine, inner * sine, height);
    }
    uint32_t n_tris = lc_pbrt_join_rings(p, 2, around.n, false, !(inner > 0));
    double exact = around.degrees * (LC_PI / 360) * (radius * radius - inner * inner);
    lc_pbrt_finish_round(p, mesh, 2 * row, n_tris, false, exact, area_ratio);
    return LC_OK;
}
