/* quadric.c - cylinders, cones, paraboloids and hyperboloids: a curve swept about the z axis.
 *
 * The curve c(t), 0 <= t <= 1, has pbrt's direction of v, so the normal d/du x d/dv points to the same side
 * as pbrt's and as the winding order of the rings. An element of area is |normal| dt times the element of the
 * angle.
 */
#include "pbrt/round.h"

typedef struct curve curve;
struct curve {
    void (*at)(const curve *c, double t, double p[3], double d[3]); /* point and derivative */
    double a[3], b[3];                                              /* start and end */
    double steepness;                                               /* paraboloid: z = steepness r^2 */
    uint32_t steps;                                                 /* one more ring than steps is made */
};

static void on_line(const curve *c, double t, double p[3], double d[3])
{
    for (int k = 0; k < 3; k++) {
        p[k] = (1 - t) * c->a[k] + t * c->b[k];
        d[k] = c->b[k] - c->a[k];
    }
}

/* A parabola; the radius is linear in t. */
static void on_parabola(const curve *c, double t, double p[3], double d[3])
{
    on_line(c, t, p, d);
    p[2] = c->steepness * p[0] * p[0];
    d[2] = 2 * c->steepness * p[0] * d[0];
}

static double normal_at(const curve *c, double t, double n[3])
{
    double p[3], d[3];
    c->at(c, t, p, d);
    n[0] = p[0] * d[2];
    n[1] = p[1] * d[2];
    n[2] = -(p[0] * d[0] + p[1] * d[1]);
    return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

/* The area per radian of sweep, by Simpson's rule. */
static double area_per_radian(const curve *c)
{
    const int n = 256;
    double sum = 0, normal[3];
    for (int i = 0; i <= n; i++)
        sum += normal_at(c, (double)i / n, normal) * (i == 0 || i == n ? 1 : i % 2 ? 4 : 2);
    return sum / (3 * n);
}

/* The texture coordinate v at t; pbrt's is linear in z on a paraboloid. */
static double v_at(const curve *c, double t)
{
    double p[3], d[3], z0 = c->steepness * c->a[0] * c->a[0], z1 = c->steepness * c->b[0] * c->b[0];
    c->at(c, t, p, d);
    return c->at == on_parabola ? (p[2] - z0) / (z1 - z0) : t;
}

static void put_ring(lc_pbrt *p, const curve *c, uint32_t ring, const lc_pbrt_sweep *around, bool tip)
{
    double t = (double)ring / c->steps, v[3], d[3], n[3];
    c->at(c, t, v, d);
    /* The normal vanishes at a tip: take its direction a little further along. */
    double len = normal_at(c, tip ? t + (ring ? -1e-6 : 1e-6) : t, n);
    for (uint32_t j = 0; j <= around->n; j++) {
        double s, k;
        lc_sincos_deg(around->degrees * j / around->n, &s, &k);
        size_t at = 3 * ((size_t)ring * (around->n + 1) + j);
        const double pos[3] = { v[0] * k - v[1] * s, v[0] * s + v[1] * k, v[2] };
        const double normal[3] = { n[0] * k - n[1] * s, n[0] * s + n[1] * k, n[2] };
        for (size_t i = 0; i < 3; i++) {
            p->pos[at + i] = (float)pos[i];
            p->normal[at + i] = (float)(len > 0 ? normal[i] / len : 0);
        }
    }
}

static lc_status sweep_curve(lc_pbrt *p, const lc_pbrt_stmt *s, const curve *c, uint32_t segments,
                             lc_pbrt_mesh *mesh, double *area_ratio)
{
    lc_pbrt_sweep around;
    lc_status st = lc_pbrt_get_sweep(p, segments, &around);
    if (st) return st;
    double area = area_per_radian(c) * around.degrees * (LC_PI / 180);
    if (!(area > 0 && area <= DBL_MAX)) return lc_pbrt_no_area(p, s);
    uint32_t n_rings = c->steps + 1, row = around.n + 1;
    bool uv, tip_first = !(fabs(c->a[0]) + fabs(c->a[1]) > 0),
             tip_last = !(fabs(c->b[0]) + fabs(c->b[1]) > 0);
    st = lc_pbrt_mesh_room(p, (size_t)n_rings * row, 2 * (size_t)n_rings * around.n, true);
    if (!st) st = lc_pbrt_uv_room(p, (size_t)n_rings * row, &uv);
    if (st) return st;
    if (uv) mesh->uv = p->uv;
    for (uint32_t i = 0; i < n_rings; i++) {
        put_ring(p, c, i, &around, (!i && tip_first) || (i + 1 == n_rings && tip_last));
        if (uv) lc_pbrt_ring_uv(p, (size_t)i * row, around.n, v_at(c, (double)i / c->steps));
    }
    uint32_t n_tris = lc_pbrt_join_rings(p, n_rings, around.n, tip_first, tip_last);
    lc_pbrt_finish_round(p, mesh, n_rings * row, n_tris, true, area, area_ratio);
    return LC_OK;
}

lc_status lc_pbrt_cylinder(lc_pbrt *p, const lc_pbrt_stmt *s, lc_pbrt_mesh *mesh, double *area_ratio)
{
    double radius = 1, z0 = -1, z1 = 1;
    lc_status st = lc_pbrt_get_float(&p->params, "radius", &radius, NULL);
    if (!st) st = lc_pbrt_get_float(&p->params, "zmin", &z0, NULL);
    if (!st) st = lc_pbrt_get_float(&p->params, "zmax", &z1, NULL);
    if (st) return st;
    curve c = { on_line, { radius, 0, fmin(z0, z1) }, { radius, 0, fmax(z0, z1) }, 0, 1 };
    return sweep_curve(p, s, &c, lc_pbrt_segments(p), mesh, area_ratio);
}

lc_status lc_pbrt_cone(lc_pbrt *p, const lc_pbrt_stmt *s, lc_pbrt_mesh *mesh, double *area_ratio)
{
    double radius = 1, height = 1;
    lc_status st = lc_pbrt_get_float(&p->params, "radius", &radius, NULL);
    if (!st) st = lc_pbrt_get_float(&p->params, "height", &height, NULL);
    if (st) return st;
    uint32_t segments = lc_pbrt_segments(p);
    /* Several steps, so that u is accurate near a tip. */
    curve c = { on_line, { radius, 0, 0 }, { 0, 0, height }, 0, segments / 16 + 1 };
    return sweep_curve(p, s, &c, segments, mesh, area_ratio);
}

lc_status lc_pbrt_paraboloid(lc_pbrt *p, const lc_pbrt_stmt *s, lc_pbrt_mesh *mesh, double *area_ratio)
{
    double radius = 1, z0 = 0, z1 = 1;
    lc_status st = lc_pbrt_get_float(&p->params, "radius", &radius, NULL);
    if (!st) st = lc_pbrt_get_float(&p->params, "zmin", &z0, NULL);
    if (!st) st = lc_pbrt_get_float(&p->params, "zmax", &z1, NULL);
    if (st) return st;
    uint32_t segments = lc_pbrt_segments(p);
    double zmin = fmax(fmin(z0, z1), 0), zmax = fmax(z0, z1);
    if (!(radius > 0 && zmax > zmin)) return lc_pbrt_no_area(p, s);
    curve c = { on_parabola,
                { radius * sqrt(zmin / zmax), 0, 0 },
                { radius, 0, 0 },
                zmax / (radius * radius),
                segments / 4 };
    return sweep_curve(p, s, &c, segments, mesh, area_ratio);
}

lc_status lc_pbrt_hyperboloid(lc_pbrt *p, const lc_pbrt_stmt *s, lc_pbrt_mesh *mesh, double *area_ratio)
{
    uint32_t segments = lc_pbrt_segments(p);
    curve c = { on_line, { 0, 0, 0 }, { 1, 1, 1 }, 0, segments / 4 };
    lc_status st = lc_pbrt_get_triple(&p->params, "p1", c.a, NULL);
    if (!st) st = lc_pbrt_get_triple(&p->params, "p2", c.b, NULL);
    if (st) return st;
    if (!(fabs(c.b[2]) > 0)) /* exchanges the end points, as pbrt does */
        for (int k = 0; k < 3; k++) {
            double b = c.b[k];
            c.b[k] = c.a[k];
            c.a[k] = b;
        }
    return sweep_curve(p, s, &c, segments, mesh, area_ratio);
}
