/* curve.c - Shape "curve" as triangles: Bezier or B-spline segments of degree 2 or 3, each a strip or a tube
 * in steps.
 *
 *     ribbon           a strip across the normals N
 *     flat, cylinder   a tube with the normals of a cylinder, where pbrt has a strip that faces each ray
 *
 * A step deviates from the curve by at most OFF of its width, as long as the level's number of steps allows.
 * Curves get coarser as they become more: the first quarter of a million triangles have 8 sides and 16 steps,
 * the last a strip of two steps, and beyond 6 million triangles (1.2 GB, a million curves) there are no more.
 * A tube with few sides is made thicker, so that its width averaged over all directions is the curve's; by
 * Cauchy that mean is the perimeter over pi.
 */
#include "pbrt/shape_handler.h"

#include "base/fmath.h"

#include <stdio.h>
#include <string.h>

#define MAX_SIDES 8
#define MIN_SINE  1e-6 /* of the angle between two unit vectors: below, their cross product has no direction \
                        */
#define OFF  0.02      /* limits the deviation of a step, as a fraction of the curve's width; chosen */
#define FULL LC_SIZE((uint64_t)1 << 18, 1 << 9) /* triangles at the finest level */

static const struct level {
    uint64_t up_to;        /* the level applies until so many triangles of curves have been made */
    uint32_t sides, steps; /* 2 sides: a strip */
} levels[] = { { FULL, MAX_SIDES, 16 }, { 4 * FULL, 4, 8 }, { 8 * FULL, 3, 4 }, { 24 * FULL, 2, 2 } };
#define N_LEVELS (sizeof levels / sizeof *levels)

typedef struct spline {
    const double *points, *normals; /* normals: for ribbons, one more than segments; else NULL */
    size_t n_segments, degree;
    double width[2];
    bool bspline;
} spline;

typedef struct tube {
    uint32_t sides, steps, row;                               /* row: vertices of a ring */
    double swell, cosine[MAX_SIDES + 1], sine[MAX_SIDES + 1]; /* swell: factor by which the tube is thicker */
    double x[3], y[3], tangent[3];                            /* the orthonormal frame of the last ring */
    bool uv;
    size_t n_verts, n_tris;
} tube;

/* ---- vectors ---- */

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Normalizes v; false, with out unchanged, if v is not longer than `least`. */
static bool unit(const double v[3], double least, double out[3])
{
    double len = sqrt(dot(v, v));
    if (!(len > least)) return false;
    for (int k = 0; k < 3; k++) out[k] = v[k] / len;
    return true;
}

/* ---- curves ---- */

static void between(const double *a, const double *b, double share, double out[3])
{
    for (int k = 0; k < 3; k++) out[k] = (1 - share) * a[k] + share * b[k];
}

/* The control points of a segment as a cubic Bezier curve. */
static void fetch(const spline *c, size_t segment, double b[4][3])
{
    const double *p[4], *q[3];
    double ends[2][3], inner[2][3];
    for (size_t i = 0; i <= c->degree; i++)
        p[i] = c->points + 3 * (segment * (c->bspline ? 1 : c->degree) + i);
    if (c->degree == 3) {
        for (int i = 0; i < 4 && !c->bspline; i++) memcpy(b[i], p[i], sizeof b[i]);
        if (!c->bspline) return;
        between(p[1], p[2], 1.0 / 3, b[1]);
        between(p[1], p[2], 2.0 / 3, b[2]);
        between(p[0], p[1], 2.0 / 3, inner[0]);
        between(p[2], p[3], 1.0 / 3, inner[1]);
        between(inner[0], b[1], 0.5, b[0]);
        between(b[2], inner[1], 0.5, b[3]);
        return;
    }
    q[0] = p[0];
    q[1] = p[1];
    q[2] = p[2];
    if (c->bspline) {
        between(p[0], p[1], 0.5, ends[0]);
        between(p[1], p[2], 0.5, ends[1]);
        q[0] = ends[0];
        q[2] = ends[1];
    }
    memcpy(b[0], q[0], sizeof b[0]);
    memcpy(b[3], q[2], sizeof b[3]);
    between(q[0], q[1], 2.0 / 3, b[1]);
    between(q[2], q[1], 2.0 / 3, b[2]);
}

/* The point of a cubic Bezier curve at t and its derivative. */
static void at(const double b[4][3], double t, double point[3], double d[3])
{
    double q[3][3], r[2][3];
    for (int i = 0; i < 3; i++) between(b[i], b[i + 1], t, q[i]);
    for (int i = 0; i < 2; i++) between(q[i], q[i + 1], t, r[i]);
    between(r[0], r[1], t, point);
    for (int k = 0; k < 3; k++) d[k] = 3 * (r[1][k] - r[0][k]);
}

/* The number of steps of a segment: the chord of a step of 1 / n deviates by at most the largest second
 * derivative over 8 n^2. */
static uint32_t steps_of(const spline *c, const double b[4][3], uint32_t most)
{
    double bend = 0, width = fmax(c->width[0], c->width[1]);
    for (int i = 0; i < 2; i++) {
        double d[3];
        for (int k = 0; k < 3; k++) d[k] = 6 * (b[i][k] - 2 * b[i + 1][k] + b[i + 2][k]);
        bend = fmax(bend, sqrt(dot(d, d)));
    }
    double n = ceil(sqrt(bend / (8 * OFF * width)));
    return n >= 1 ? n < most ? (uint32_t)n : most : 1;
}

static size_t triangles(const spline *c, const struct level *level)
{
    size_t sum = 0;
    double b[4][3];
    for (size_t i = 0; i < c->n_segments; i++) {
        fetch(c, i, b);
        sum += 2 * (size_t)steps_of(c, b, level->steps) *
               (c->normals || level->sides == 2 ? 1 : level->sides);
    }
    return sum;
}

/* ---- rings ---- */

/* Rotates the frame to the tangent by the least angle; leaves it if there is no tangent. */
static void follow(tube *o, const double tangent[3])
{
    double x[3], t[3] = { tangent[0], tangent[1], tangent[2] };
    for (int k = 0; k < 3; k++) x[k] = o->x[k] - dot(o->x, t) * t[k];
    if (!unit(x, MIN_SINE, o->x)) {
        int axis = fabs(t[0]) < 0.6 ? 0 : fabs(t[1]) < 0.6 ? 1 : 2;
        double e[3] = { axis == 0, axis == 1, axis == 2 };
        cross(t, e, x);
        unit(x, 0, o->x);
    }
    cross(t, o->x, o->y);
    memcpy(o->tangent, t, sizeof t);
}

/* Sets a ribbon's frame: x lies in it, y is its normal, interpolated between two given normals at a constant
 * angular speed. */
static void follow_normal(tube *o, const double *from, const double *to, double t, const double tangent[3])
{
    double n[3], m[3], c[3], x[3], angle, least, ends, begins;
    if (!unit(from, 0, n) || !unit(to, 0, m)) return;
    cross(n, m, c);
    angle = lc_atan2(sqrt(dot(c, c)), dot(n, m)) * (180 / LC_PI);
    lc_sincos_deg(angle, &least, &x[0]);
    if (least > MIN_SINE) { /* else they are equal, or opposite with no defined rotation between them */
        lc_sincos_deg((1 - t) * angle, &begins, &x[0]);
        lc_sincos_deg(t * angle, &ends, &x[0]);
        for (int k = 0; k < 3; k++) n[k] = (begins * n[k] + ends * m[k]) / least;
    }
    cross(n, tangent, x);
    if (!unit(x, MIN_SINE, o->x)) return;
    cross(tangent, o->x, o->y);
}

static void put_ring(lc_pbrt *p, tube *o, const double centre[3], double radius, double u)
{
    for (uint32_t j = 0; j < o->row; j++) {
        size_t v = o->n_verts++;
        for (size_t k = 0; k < 3; k++) {
            double out = o->sides == 2 ? (j ? -o->x[k] : o->x[k])
                                       : o->cosine[j] * o->x[k] + o->sine[j] * o->y[k];
            p->pos[3 * v + k] = (float)(centre[k] + radius * out);
            p->normal[3 * v + k] = (float)(o->sides == 2 ? o->y[k] : out);
        }
        if (o->uv) {
            p->uv[2 * v] = (float)u;
            p->uv[2 * v + 1] = (float)((double)j / (o->row - 1));
        }
    }
}

/* Makes the triangles between the last two rings, except degenerate ones at a ring that is a point. */
static void join(lc_pbrt *p, tube *o, bool first_is_point, bool last_is_point)
{
    uint32_t last = (uint32_t)o->n_verts - o->row, first = last - o->row;
    for (uint32_t j = 0; j + 1 < o->row; j++) {
        const uint32_t t[2][3] = { { first + j, first + j + 1, last + j + 1 },
                                   { first + j, last + j + 1, last + j } };
        if (!first_is_point) memcpy(p->index + 3 * o->n_tris++, t[0], sizeof t[0]);
        if (!last_is_point) memcpy(p->index + 3 * o->n_tris++, t[1], sizeof t[1]);
    }
}

static void put_segment(lc_pbrt *p, const spline *c, size_t segment, tube *o)
{
    double b[4][3], size = 0, before = 0;
    fetch(c, segment, b);
    uint32_t n = steps_of(c, b, o->steps);
    for (int i = 0; i < 3; i++) {
        double d[3] = { b[i + 1][0] - b[i][0], b[i + 1][1] - b[i][1], b[i + 1][2] - b[i][2] };
        size = fmax(size, sqrt(dot(d, d)));
    }
    for (uint32_t i = 0; i <= n; i++) {
        double t = (double)i / n, point[3], near[3], d[3], tangent[3],
               u = ((double)segment + t) / (double)c->n_segments;
        double radius = 0.5 * ((1 - u) * c->width[0] + u * c->width[1]);
        memcpy(tangent, o->tangent, sizeof tangent);
        at(b, t, point, d);
        /* Where control points coincide the derivative vanishes: take it a little further along. */
        if (!unit(d, 1e-9 * size, tangent)) {
            at(b, t + (i < n ? 1e-3 : -1e-3), near, d);
            unit(d, 0, tangent);
        }
        follow(o, tangent);
        if (c->normals) follow_normal(o, c->normals + 3 * segment, c->normals + 3 * segment + 3, t, tangent);
        put_ring(p, o, point, radius * o->swell, t);
        if (i) join(p, o, !(before > 0), !(radius > 0));
        before = radius;
    }
}

static lc_status put_all(lc_pbrt *p, const spline *c, const struct level *level, size_t most,
                         lc_pbrt_mesh *mesh)
{
    tube o = { .sides = c->normals ? 2 : level->sides,
               .steps = level->steps,
               .swell = 1,
               .x = { 1, 0, 0 },
               .tangent = { 0, 0, 1 } };
    o.row = o.sides == 2 ? 2 : o.sides + 1;
    for (uint32_t j = 0; j < o.row && o.sides > 2; j++)
        lc_sincos_deg(360.0 * j / o.sides, &o.sine[j], &o.cosine[j]);
    double sine, cosine;
    lc_sincos_deg(180.0 / o.sides, &sine, &cosine);
    if (!c->normals) o.swell = LC_PI / (o.sides * sine);
    size_t n_verts = (most / (2 * (o.row - 1)) + c->n_segments) * o.row;
    lc_status st = lc_pbrt_mesh_room(p, n_verts, most, true);
    if (!st) st = lc_pbrt_uv_room(p, n_verts, &o.uv);
    for (size_t i = 0; i < c->n_segments && !st; i++) put_segment(p, c, i, &o);
    if (st) return st;
    *mesh = (lc_pbrt_mesh){ .n_verts = (uint32_t)o.n_verts,
                            .n_tris = (uint32_t)o.n_tris,
                            .pos = p->pos,
                            .normal = p->normal,
                            .uv = o.uv ? p->uv : NULL,
                            .index = p->index };
    p->n_curve_tris += o.n_tris;
    return LC_OK;
}

/* ---- the statement ---- */

static lc_status get_points(lc_pbrt *p, const lc_pbrt_stmt *s, spline *c)
{
    const lc_pbrt_param *par, *points = lc_pbrt_find(&p->params, "P", LC_PBRT_TRIPLE);
    const char *basis = "bezier";
    int64_t degree = 3;
    lc_status st = lc_pbrt_get_text(&p->params, "basis", &basis, &par);
    c->bspline = !strcmp(basis, "bspline");
    if (!st && !c->bspline && strcmp(basis, "bezier"))
        return lc_pbrt_bad_param(&p->params, par, "is neither bezier nor bspline");
    if (!st) st = lc_pbrt_get_int(&p->params, "degree", &degree, &par);
    if (st) return st;
    if (degree != 2 && degree != 3) return lc_pbrt_bad_param(&p->params, par, "is neither 2 nor 3");
    if (!points) return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "curve without control points \"point3 P\"");
    size_t n = points->n / 3;
    c->degree = (size_t)degree;
    if (n <= c->degree || (!c->bspline && (n - 1) % c->degree))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, points->pos, "%zu control points make no %s of degree %d", n,
                          c->bspline ? "B-spline" : "Bezier curve", (int)degree);
    c->n_segments = c->bspline ? n - c->degree : (n - 1) / c->degree;
    c->points = lc_pbrt_numbers(&p->params, points);
    return LC_OK;
}

static lc_status get_type(lc_pbrt *p, const lc_pbrt_stmt *s, spline *c)
{
    const lc_pbrt_param *par, *normals = lc_pbrt_find(&p->params, "N", LC_PBRT_TRIPLE);
    const char *type = "flat";
    lc_status st = lc_pbrt_get_text(&p->params, "type", &type, &par);
    if (st || !strcmp(type, "flat") || !strcmp(type, "cylinder")) return st;
    if (strcmp(type, "ribbon"))
        return lc_pbrt_bad_param(&p->params, par, "is none of flat, cylinder, ribbon");
    if (!normals || normals->n != 3 * (c->n_segments + 1))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, normals ? normals->pos : s->pos,
                          "a ribbon of %zu segments needs %zu normals \"normal N\"", c->n_segments,
                          c->n_segments + 1);
    c->normals = lc_pbrt_numbers(&p->params, normals);
    return LC_OK;
}

static lc_status get_width(lc_pbrt *p, spline *c)
{
    static const char *const names[] = { "width0", "width1" };
    const lc_pbrt_param *par;
    double width = 1;
    lc_status st = lc_pbrt_get_float(&p->params, "width", &width, &par);
    for (int i = 0; i < 2 && !st; i++) {
        const lc_pbrt_param *own;
        c->width[i] = width;
        st = lc_pbrt_get_float(&p->params, names[i], &c->width[i], &own);
        if (!st && c->width[i] < 0) return lc_pbrt_bad_param(&p->params, own ? own : par, "is negative");
    }
    return st;
}

lc_status lc_pbrt_curve(lc_pbrt *p, const lc_pbrt_stmt *s, lc_pbrt_mesh *mesh, double *area_ratio)
{
    spline c = { .n_segments = 0 };
    size_t level = 0, n = 0;
    char text[80];
    (void)area_ratio;
    lc_pbrt_mark(&p->params, "splitdepth");
    lc_status st = get_points(p, s, &c);
    if (!st) st = get_type(p, s, &c);
    if (!st) st = get_width(p, &c);
    if (st) return st;
    if (!(c.width[0] > 0 || c.width[1] > 0))
        return lc_pbrt_note(p, s->pos, "shape without area", "a curve without width is skipped");
    while (level < N_LEVELS && p->n_curve_tris >= levels[level].up_to) level++;
    while (level < N_LEVELS &&
           p->n_curve_tris + (n = triangles(&c, &levels[level])) > levels[N_LEVELS - 1].up_to)
        level++;
    if (level == N_LEVELS)
        return lc_pbrt_note(p, s->pos, "curve limit",
                            "curves of more than %llu triangles: the rest of them are left out",
                            (unsigned long long)levels[N_LEVELS - 1].up_to);
    snprintf(text, sizeof text, "made of triangles: %s, at most %u steps a segment",
             c.normals ? "a strip" : "a tube", levels[level].steps);
    st = lc_pbrt_note_name(p, s->pos, "shape", s->text[0], text);
    if (!st && level)
        st = lc_pbrt_note(p, s->pos, "coarse curves",
                          "from here on curves have fewer triangles, as they are many");
    return st ? st : put_all(p, &c, &levels[level], n, mesh);
}
