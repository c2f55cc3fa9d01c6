/* bilinear.c - Shape "bilinearmesh" as triangles.
 *
 *     p01 -- p11      indices: p00 p10 p01 p11; u runs from p00 to p10, v from p00 to p01
 *      |      |
 *     p00 -- p10
 *
 * A planar patch becomes two triangles. A patch that is not planar, or whose texture mapping is not affine,
 * becomes a grid of n x n cells, whose distance from the patch is at most the twist |p00 - p10 - p01 + p11| /
 * (4 n^2).
 */
#include "pbrt/shape_handler.h"

#define MAX_SIDE LC_SIZE(16, 4) /* limits n */
#define MAX_TRIS (8u << 20)     /* limits the triangles of a shape: its patches then get fewer cells */
#define MAX_OFF                                                                                              \
    1e-3 /* limits the distance from the patch, as a fraction of its diagonal;                               \
          * chosen */

typedef struct patch {
    double p[4][3], n[4][3], uv[4][2];
} patch;

typedef struct patches {
    const double *pos, *normal, *uv; /* of the shape; normal and uv may be NULL */
    const uint32_t *index;
    size_t n;
} patches;

static void fetch(const patches *all, size_t i, patch *out)
{
    static const double corner[4][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 }, { 1, 1 } };
    for (size_t k = 0; k < 4; k++) {
        size_t v = all->index[4 * i + k];
        for (size_t c = 0; c < 3; c++) {
            out->p[k][c] = all->pos[3 * v + c];
            out->n[k][c] = all->normal ? all->normal[3 * v + c] : 0;
        }
        for (size_t c = 0; c < 2; c++) out->uv[k][c] = all->uv ? all->uv[2 * v + c] : corner[k][c];
    }
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++) out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void difference(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++) out[k] = a[k] - b[k];
}

/* The number of cells along a side, n. With in_plane a twist within the plane counts, too. */
static uint32_t side_of(const patch *q, bool in_plane)
{
    double d0[3], d1[3], n[3], twist[3];
    difference(q->p[3], q->p[0], d0);
    difference(q->p[2], q->p[1], d1);
    for (int k = 0; k < 3; k++) twist[k] = q->p[0][k] - q->p[1][k] - q->p[2][k] + q->p[3][k];
    cross(d0, d1, n);
    double size = sqrt(fmax(dot(d0, d0), dot(d1, d1))), len = sqrt(dot(n, n));
    double off = in_plane || !(len > 0) ? sqrt(dot(twist, twist)) : fabs(dot(twist, n)) / len;
    uint32_t side = 1;
    while (side < MAX_SIDE && off > MAX_OFF * 4 * side * side * size) side *= 2;
    return side;
}

static void mix(const double *c00, const double *c10, const double *c01, const double *c11, double u,
                double v, int n, double *out)
{
    for (int k = 0; k < n; k++)
        out[k] = (1 - v) * ((1 - u) * c00[k] + u * c10[k]) + v * ((1 - u) * c01[k] + u * c11[k]);
}

/* The shading normal: interpolated from given normals, or that of the bilinear surface. */
static void normal_at(const patch *q, bool given, double u, double v, double out[3])
{
    double du[3], dv[3];
    if (given) {
        mix(q->n[0], q->n[1], q->n[2], q->n[3], u, v, 3, out);
        return;
    }
    for (int k = 0; k < 3; k++) {
        du[k] = (1 - v) * (q->p[1][k] - q->p[0][k]) + v * (q->p[3][k] - q->p[2][k]);
        dv[k] = (1 - u) * (q->p[2][k] - q->p[0][k]) + u * (q->p[3][k] - q->p[1][k]);
    }
    cross(du, dv, out);
}

typedef struct output {
    bool normals, given, uv; /* the mesh has normals; they are given in the file; the mesh has uv */
    size_t n_verts, n_tris;
} output;

static void put_patch(lc_pbrt *p, const patch *q, uint32_t side, output *o)
{
    uint32_t first = (uint32_t)o->n_verts, row = side + 1;
    for (uint32_t j = 0; j <= side; j++)
        for (uint32_t i = 0; i <= side; i++, o->n_verts++) {
            double u = (double)i / side, v = (double)j / side, out[3];
            mix(q->p[0], q->p[1], q->p[2], q->p[3], u, v, 3, out);
            for (size_t k = 0; k < 3; k++) p->pos[3 * o->n_verts + k] = (float)out[k];
            if (o->normals) {
                normal_at(q, o->given, u, v, out);
                double max = fmax(fabs(out[0]), fmax(fabs(out[1]), fabs(out[2])));
                for (size_t k = 0; k < 3; k++)
                    p->normal[3 * o->n_verts + k] = (float)(max > 0 ? out[k] / max : 0);
            }
            if (!o->uv) continue;
            mix(q->uv[0], q->uv[1], q->uv[2], q->uv[3], u, v, 2, out);
            for (size_t k = 0; k < 2; k++) p->uv[2 * o->n_verts + k] = (float)out[k];
        }
    for (uint32_t j = 0; j < side; j++)
        for (uint32_t i = 0; i < side; i++) {
            uint32_t a = first + j * row + i, b = a + 1, c = a + row, d = c + 1;
            const uint32_t made[6] = { a, b, d, a, d, c };
            for (size_t k = 0; k < 6; k++) p->index[3 * o->n_tris + k] = made[k];
            o->n_tris += 2;
        }
}

static lc_status cut(lc_pbrt *p, const lc_pbrt_stmt *s, const patches *all, lc_pbrt_mesh *mesh)
{
    size_t counts[MAX_SIDE + 1] = { 0 };
    output o = { .given = all->normal != NULL };
    patch q;
    uint32_t id, most = MAX_SIDE;
    lc_status st = lc_pbrt_current_material(p, &id);
    if (st) return st;
    const bool textured = (lc_build_traits(p->scene, id) & LC_TRAIT_TEXTURED) !=
                          0; /* o.uv may be set without */
    for (size_t i = 0; i < all->n; i++) {
        fetch(all, i, &q);
        counts[side_of(&q, textured)]++;
    }
    o.normals = o.given || counts[1] < all->n;
    for (;; most /= 2) {
        o.n_verts = o.n_tris = 0;
        for (uint32_t k = 1; k <= MAX_SIDE; k++) {
            size_t side = k < most ? k : most;
            o.n_verts += counts[k] * (side + 1) * (side + 1);
            o.n_tris += 2 * counts[k] * side * side;
        }
        if (most == 1 || o.n_tris <= MAX_TRIS) break;
    }
    st = lc_pbrt_mesh_room(p, o.n_verts, o.n_tris, o.normals);
    if (!st) st = lc_pbrt_uv_room(p, o.n_verts, &o.uv);
    if (!st && counts[1] < all->n)
        st = lc_pbrt_note_name(p, s->pos, "shape", s->text[0],
                               "what is not flat of it is approximated by triangles");
    if (st) return st;
    o.n_verts = o.n_tris = 0;
    for (size_t i = 0; i < all->n; i++) {
        fetch(all, i, &q);
        uint32_t side = side_of(&q, textured);
        put_patch(p, &q, side < most ? side : most, &o);
    }
    *mesh = (lc_pbrt_mesh){ .n_verts = (uint32_t)o.n_verts,
                            .n_tris = (uint32_t)o.n_tris,
                            .pos = p->pos,
                            .normal = o.normals ? p->normal : NULL,
                            .uv = o.uv ? p->uv : NULL,
                            .index = p->index };
    return LC_OK;
}

lc_status lc_pbrt_bilinear_mesh(lc_pbrt *p, const lc_pbrt_stmt *s, lc_pbrt_mesh *mesh, double *area_ratio)
{
    const lc_pbrt_param *pos = lc_pbrt_find(&p->params, "P", LC_PBRT_TRIPLE);
    const lc_pbrt_param *normal = lc_pbrt_find(&p->params, "N", LC_PBRT_TRIPLE);
    const lc_pbrt_param *uv = lc_pbrt_find(&p->params, "uv", LC_PBRT_FLOAT | LC_PBRT_INT | LC_PBRT_PAIR);
    const lc_pbrt_param *index = lc_pbrt_find(&p->params, "indices", LC_PBRT_INT | LC_PBRT_FLOAT);
    (void)area_ratio;
    lc_pbrt_mark(&p->params, "faceIndices");
    if (!pos) return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "bilinearmesh without vertices \"point3 P\"");
    size_t n_verts = pos->n / 3, n_index = index ? index->n : 4;
    if (!index && n_verts != 4)
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "bilinearmesh without \"integer indices\"");
    if (normal && normal->n != pos->n)
        return lc_fail_at(p->ctx, LC_ERR_PARSE, normal->pos, "%zu normals for %zu vertices", normal->n / 3,
                          n_verts);
    lc_status st = LC_OK;
    if (uv && uv->n < 2 * n_verts)
        st = lc_pbrt_note(p, uv->pos, "uv", "%zu texture coordinates for %zu vertices are ignored", uv->n / 2,
                          n_verts);
    if (!st) st = lc_pbrt_mesh_room(p, 0, n_index / 3 + 1, false);
    for (uint32_t i = 0; !st && !index && i < 4; i++) p->index[i] = i;
    if (!st && index) st = lc_pbrt_copy_indices(p, index, 4, (uint32_t)n_verts);
    if (st || !n_index) return st;
    uint32_t *corners = lc_alloc_raw(p->ctx, n_index, sizeof *corners);
    if (!corners) return LC_ERR_MEMORY;
    for (size_t i = 0; i < n_index; i++) corners[i] = p->index[i];
    patches all = { lc_pbrt_numbers(&p->params, pos), normal ? lc_pbrt_numbers(&p->params, normal) : NULL,
                    uv && uv->n >= 2 * n_verts ? lc_pbrt_numbers(&p->params, uv) : NULL, corners,
                    n_index / 4 };
    st = cut(p, s, &all, mesh);
    lc_free(p->ctx, corners, n_index, sizeof *corners);
    return st;
}
