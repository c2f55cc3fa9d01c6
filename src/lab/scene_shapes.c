/* scene_shapes.c - the shapes of the generated scenes, as triangles. */
#include "lab/scene_gen.h"

#include <math.h>

#define MAX_PATH 64

static const gen_v3 no_normal = { 0, 0, 0 };

static void quad_of(gen *g, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    gen_triangle(g, a, b, c);
    gen_triangle(g, a, c, d);
}

void gen_quad(gen *g, gen_v3 a, gen_v3 b, gen_v3 c, gen_v3 d)
{
    gen_need(g, 4, 2, 0);
    uint32_t i = gen_vertex(g, a, no_normal);
    gen_vertex(g, b, no_normal);
    gen_vertex(g, c, no_normal);
    gen_vertex(g, d, no_normal);
    quad_of(g, i, i + 1, i + 2, i + 3);
}

void gen_block(gen *g, gen_v3 lo, gen_v3 hi)
{
    gen_need(g, 8, 10, 0);
    uint32_t b = g->n_vertices;
    for (int k = 0; k < 8; k++)
        gen_vertex(g, gen_v(k & 1 ? hi.x : lo.x, k & 2 ? hi.y : lo.y, k & 4 ? hi.z : lo.z), no_normal);
    quad_of(g, b, b + 2, b + 3, b + 1);
    quad_of(g, b + 4, b + 5, b + 7, b + 6);
    quad_of(g, b, b + 4, b + 6, b + 2);
    quad_of(g, b + 1, b + 3, b + 7, b + 5);
    quad_of(g, b + 2, b + 6, b + 7, b + 3);
}

void gen_box(gen *g, gen_v3 lo, gen_v3 hi)
{
    gen_need(g, 8, 12, 0);
    uint32_t b = g->n_vertices;
    gen_block(g, lo, hi);
    quad_of(g, b, b + 1, b + 5, b + 4);
}

void gen_prism(gen *g, const double (*xy)[2], int n, double z0, double z1)
{
    uint32_t m = (uint32_t)n;
    gen_need(g, 2 * m, 4 * m - 4, 0);
    uint32_t b = g->n_vertices;
    for (int i = 0; i < n; i++) gen_vertex(g, gen_v(xy[i][0], xy[i][1], z0), no_normal);
    for (int i = 0; i < n; i++) gen_vertex(g, gen_v(xy[i][0], xy[i][1], z1), no_normal);
    for (uint32_t i = 0; i < m; i++) {
        uint32_t j = (i + 1) % m;
        quad_of(g, b + i, b + j, b + m + j, b + m + i);
    }
    for (uint32_t i = 1; i + 1 < m; i++) {
        gen_triangle(g, b, b + i, b + i + 1);
        gen_triangle(g, b + m, b + m + i, b + m + i + 1);
    }
}

/* ---- rounded box: a sphere of 4(n+1) columns and 2(n+1) rows whose octants are pulled apart ---- */

static uint32_t soft_ring(gen *g, gen_v3 lo, gen_v3 hi, double radius, int n, int row)
{
    int upper = row > n;
    double lat = (upper ? (double)(row - n - 1) / n : (double)(row - n) / n) * 0.25;
    double y = upper ? hi.y - radius : lo.y + radius, cl = gen_cos(lat), sl = gen_sin(lat);
    uint32_t first = g->n_vertices;
    for (int quarter = 0; quarter < 4; quarter++)
        for (int i = 0; i <= n; i++) {
            double lon = 0.25 * (quarter + (double)i / n);
            gen_v3 d = gen_v(cl * gen_cos(lon), sl, cl * gen_sin(lon));
            double x = quarter == 0 || quarter == 3 ? hi.x - radius : lo.x + radius;
            double z = quarter < 2 ? hi.z - radius : lo.z + radius;
            gen_vertex(g, gen_add(gen_v(x, y, z), gen_mul(d, radius)), d);
        }
    return first;
}

static void soft_band(gen *g, uint32_t below, uint32_t above, int n, int pole)
{
    uint32_t per = (uint32_t)n + 1, cols = 4 * per;
    for (uint32_t i = 0; i < cols; i++) {
        uint32_t j = (i + 1) % cols;
        int between = i % per == per - 1;
        if (pole != -1 || between) gen_triangle(g, below + i, above + j, below + j);
        if (pole != 1 || between) gen_triangle(g, below + i, above + i, above + j);
    }
}

void gen_soft_box(gen *g, gen_v3 lo, gen_v3 hi, double radius, int n)
{
    int rows = 2 * (n + 1);
    uint32_t per = (uint32_t)n + 1, m = (uint32_t)n;
    gen_need(g, (uint32_t)rows * 4 * per, 8 * (m + 2) + 8 * (2 * m - 1) * (m + 1) + 4, 1);
    uint32_t first = g->n_vertices, below = first, above = first;
    for (int row = 0; row < rows; row++) {
        above = soft_ring(g, lo, hi, radius, n, row);
        if (row) soft_band(g, below, above, n, row == 1 ? -1 : row == rows - 1 ? 1 : 0);
        below = above;
    }
    quad_of(g, first, first + per, first + 2 * per, first + 3 * per);
    quad_of(g, above, above + 3 * per, above + 2 * per, above + per);
}

/* ---- lathe ---- */

static uint32_t lathe_ring(gen *g, double radius, double y, double nr, double ny, int n)
{
    uint32_t first = g->n_vertices;
    for (int i = 0; i < n; i++) {
        double c = gen_cos((double)i / n), s = gen_sin((double)i / n);
        gen_vertex(g, gen_v(radius * c, y, radius * s), gen_v(nr * c, ny, nr * s));
    }
    return first;
}

static void edge_normal(const double (*p)[2], int i, double n[2])
{
    double dr = p[i + 1][0] - p[i][0], dy = p[i + 1][1] - p[i][1], d = sqrt(dr * dr + dy * dy);
    n[0] = dy / d;
    n[1] = -dr / d;
}

/* Normal at the start (end = 0) or end of profile edge i: shared with its neighbour unless the bend is sharp.
 */
static void corner_normal(const double (*p)[2], int n_profile, int i, int end, double n[2])
{
    int other = end ? i + 1 : i - 1;
    double m[2];
    edge_normal(p, i, n);
    if (other < 0 || other > n_profile - 2) return;
    edge_normal(p, other, m);
    if (n[0] * m[0] + n[1] * m[1] > 0.7) {
        n[0] += m[0];
        n[1] += m[1];
    }
}

void gen_lathe(gen *g, const double (*profile)[2], int n_profile, int n_segments)
{
    uint32_t m = (uint32_t)n_segments;
    for (int i = 0; i + 1 < n_profile; i++) {
        double n0[2], n1[2];
        corner_normal(profile, n_profile, i, 0, n0);
        corner_normal(profile, n_profile, i, 1, n1);
        gen_need(g, 2 * m, 2 * m, 1);
        uint32_t a = lathe_ring(g, profile[i][0], profile[i][1], n0[0], n0[1], n_segments);
        uint32_t b = lathe_ring(g, profile[i + 1][0], profile[i + 1][1], n1[0], n1[1], n_segments);
        for (uint32_t k = 0; k < m; k++) {
            uint32_t l = (k + 1) % m;
            if (profile[i][0] > 0) gen_triangle(g, a + k, b + l, a + l);
            if (profile[i + 1][0] > 0) gen_triangle(g, a + k, b + k, b + l);
        }
    }
}

void gen_ball(gen *g, gen_v3 centre, double radius, int n_segments, int n_rings)
{
    double profile[MAX_PATH][2];
    if (n_rings >= MAX_PATH) n_rings = MAX_PATH - 1;
    for (int i = 0; i <= n_rings; i++) {
        double a = 0.5 * (double)i / n_rings;
        profile[i][0] = i == 0 || i == n_rings ? 0 : radius * gen_sin(a);
        profile[i][1] = -radius * gen_cos(a);
    }
    gen_push(g, centre.x, centre.y, centre.z, 0);
    gen_lathe(g, (const double(*)[2])profile, n_rings + 1, n_segments);
    gen_pop(g);
}

/* ---- tube ---- */

/* The ring about path[i], perpendicular to the mean of the two directions there. */
static uint32_t tube_ring(gen *g, const gen_v3 *path, int n_path, int i, double radius, int n_segments)
{
    gen_v3 before = i > 0 ? gen_unit(gen_sub(path[i], path[i - 1])) : gen_v(0, 0, 0);
    gen_v3 after = i + 1 < n_path ? gen_unit(gen_sub(path[i + 1], path[i])) : gen_v(0, 0, 0);
    gen_v3 along = gen_unit(gen_add(before, after));
    gen_v3 side = fabs(along.y) < 0.9 ? gen_v(0, 1, 0) : gen_v(1, 0, 0);
    gen_v3 a = gen_unit(gen_cross(side, along)), b = gen_cross(along, a);
    uint32_t first = g->n_vertices;
    for (int k = 0; k < n_segments; k++) {
        double t = (double)k / n_segments;
        gen_v3 d = gen_add(gen_mul(a, gen_cos(t)), gen_mul(b, gen_sin(t)));
        gen_vertex(g, gen_add(path[i], gen_mul(d, radius)), d);
    }
    return first;
}

static void tube_end(gen *g, uint32_t ring, int n_segments, gen_v3 out)
{
    uint32_t first = g->n_vertices, m = (uint32_t)n_segments;
    const gen_frame *f = &g->stack[g->depth];
    gen_v3 n = gen_add(gen_mul(f->ax, out.x), gen_add(gen_mul(f->ay, out.y), gen_mul(f->az, out.z)));
    for (uint32_t k = 0; k < m; k++) {
        g->p[g->n_vertices] = g->p[ring + k];
        g->n[g->n_vertices++] = gen_unit(n);
    }
    for (uint32_t k = 1; k + 1 < m; k++) gen_triangle(g, first, first + k, first + k + 1);
}

void gen_tube(gen *g, const gen_v3 *path, int n_path, double radius, int n_segments)
{
    uint32_t m = (uint32_t)n_segments;
    gen_need(g, ((uint32_t)n_path + 2) * m, (uint32_t)(n_path - 1) * 2 * m + 2 * (m - 2), 1);
    uint32_t first = g->n_vertices, ring = first;
    for (int i = 0; i < n_path; i++) {
        uint32_t next = tube_ring(g, path, n_path, i, radius, n_segments);
        for (uint32_t k = 0; i > 0 && k < m; k++)
            quad_of(g, ring + k, next + k, next + (k + 1) % m, ring + (k + 1) % m);
        ring = next;
    }
    tube_end(g, first, n_segments, gen_sub(path[0], path[1]));
    tube_end(g, ring, n_segments, gen_sub(path[n_path - 1], path[n_path - 2]));
}

/* ---- sheet ---- */

void gen_sheet(gen *g, int nu, int nv, gen_sheet_fn *fn, const void *ctx)
{
    const double h = 1e-3;
    uint32_t cols = (uint32_t)nu + 1;
    gen_need(g, cols * ((uint32_t)nv + 1), 2 * (uint32_t)(nu * nv), 1);
    uint32_t first = g->n_vertices;
    for (int j = 0; j <= nv; j++)
        for (int i = 0; i <= nu; i++) {
            double u = (double)i / nu, v = (double)j / nv;
            double u0 = u > h ? u - h : 0, u1 = u < 1 - h ? u + h : 1, v0 = v > h ? v - h : 0,
                   v1 = v < 1 - h ? v + h : 1;
            gen_v3 du = gen_sub(fn(ctx, u1, v), fn(ctx, u0, v)), dv = gen_sub(fn(ctx, u, v1), fn(ctx, u, v0));
            gen_vertex(g, fn(ctx, u, v), gen_cross(du, dv));
        }
    for (uint32_t j = 0; j < (uint32_t)nv; j++)
        for (uint32_t i = 0; i < (uint32_t)nu; i++) {
            uint32_t a = first + j * cols + i;
            quad_of(g, a, a + 1, a + cols + 1, a + cols);
        }
}

/* ---- torus ---- */

typedef struct torus {
    double large, small;
} torus;

static gen_v3 torus_point(const void *ctx, double u, double v)
{
    const torus *t = ctx;
    double r = t->large + t->small * gen_cos(v);
    return gen_v(r * gen_cos(u), t->small * gen_sin(v), r * gen_sin(u));
}

void gen_torus(gen *g, double large, double small, int n_around, int n_tube)
{
    const torus t = { large, small };
    gen_sheet(g, n_around, n_tube, torus_point, &t);
}

/* ---- walls ---- */

static void wall_part(gen *g, double x0, double y0, double x1, double y1)
{
    if (x1 > x0 && y1 > y0)
        gen_quad(g, gen_v(x0, y0, 0), gen_v(x0, y1, 0), gen_v(x1, y1, 0), gen_v(x1, y0, 0));
}

void gen_holed_wall(gen *g, gen_rect wall, gen_rect hole, double depth)
{
    gen_rect h = hole;
    wall_part(g, wall.x0, wall.y0, h.x0, wall.y1);
    wall_part(g, h.x1, wall.y0, wall.x1, wall.y1);
    wall_part(g, h.x0, wall.y0, h.x1, h.y0);
    wall_part(g, h.x0, h.y1, h.x1, wall.y1);
    gen_quad(g, gen_v(h.x0, h.y0, 0), gen_v(h.x0, h.y0, depth), gen_v(h.x0, h.y1, depth),
             gen_v(h.x0, h.y1, 0));
    gen_quad(g, gen_v(h.x1, h.y0, 0), gen_v(h.x1, h.y1, 0), gen_v(h.x1, h.y1, depth),
             gen_v(h.x1, h.y0, depth));
    gen_quad(g, gen_v(h.x0, h.y1, 0), gen_v(h.x0, h.y1, depth), gen_v(h.x1, h.y1, depth),
             gen_v(h.x1, h.y1, 0));
    gen_quad(g, gen_v(h.x0, h.y0, 0), gen_v(h.x1, h.y0, 0), gen_v(h.x1, h.y0, depth),
             gen_v(h.x0, h.y0, depth));
}

void gen_frame_bars(gen *g, gen_rect r, double width, double depth)
{
    double w = width;
    gen_box(g, gen_v(r.x0 - w, r.y0 - w, -depth), gen_v(r.x0, r.y1 + w, 0));
    gen_box(g, gen_v(r.x1, r.y0 - w, -depth), gen_v(r.x1 + w, r.y1 + w, 0));
    gen_box(g, gen_v(r.x0, r.y0 - w, -depth), gen_v(r.x1, r.y0, 0));
    gen_box(g, gen_v(r.x0, r.y1, -depth), gen_v(r.x1, r.y1 + w, 0));
}
