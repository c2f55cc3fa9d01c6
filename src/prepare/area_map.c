/* area_map.c - distributes lights over a triangle by the power of its emission map.
 *
 * The triangle is divided into four recursively until the pieces are as small as texels and there are at
 * least four for each light. The pieces, in the order of the recursion, in which successive ones touch, are
 * cut into runs of equal power: one run for each light.
 */
#include "prepare/area_map.h"

#include "base/rng.h"
#include "prepare/triangle.h"
#include "scene/material_eval.h"

#include <string.h>

#define MAX_DEPTH LC_SIZE(10u, 5u) /* limits the pieces to 4^10, about 10^6 */
#define PIECES_A_LIGHT 4.0
#define MOST_SPAN 4.0 /* of a triangle, in maps: beyond it pieces are larger than texels */

/* Points of the triangle are given by their barycentric coordinates, the weights of vertices 1 and 2. */
typedef struct walk {
    lc_scene *scene;
    const lc_mipmap *map;
    size_t tri;
    double uv[3][2];          /* of its vertices */
    double width;             /* of a piece, in texels */
    double weight[3];         /* power of each channel */
    double sum[3];            /* colour of all pieces, or of the current run so far */
    /* n_parts: the number of pieces. The others are set only when lights are made. */
    const lc_light *base;
    double total, before;     /* power of all pieces, and of those visited */
    uint32_t n_lights, made;  /* lights wanted, and made */
    double n_parts;
    bool placed;              /* the current light has its position, in `place` */
    lc_f3 place;
    uint64_t seed;
    lc_status status;
} walk;

typedef void leaf_fn(walk *w, const double corner[3][2], const double rgb[3]);

static void between(const double a[2], const double b[2], double out[2])
{
    out[0] = (a[0] + b[0]) / 2;
    out[1] = (a[1] + b[1]) / 2;
}

/* The colour of a piece, >= 0: the map at its centroid, filtered over its width. */
static void look_up(const walk *w, const double c[3][2], double rgb[3])
{
    double b1 = (c[0][0] + c[1][0] + c[2][0]) / 3, b2 = (c[0][1] + c[1][1] + c[2][1]) / 3, st[2];
    for (int k = 0; k < 2; k++) st[k] = (1 - b1 - b2) * w->uv[0][k] + b1 * w->uv[1][k] + b2 * w->uv[2][k];
    lc_mipmap_lookup(w->map, st[0], 1 - st[1], w->width, LC_WRAP_CLAMP, LC_FILTER_BILINEAR, rgb);
    for (int k = 0; k < 3; k++) rgb[k] = fmax(rgb[k], 0);
}

/* Divides a piece into four at each level, in an order in which successive ones touch: a corner, the middle,
 * the other two corners. Calls leaf for the pieces of the last level. */
static void visit(walk *w, const double c[3][2], uint32_t depth, leaf_fn *leaf)
{
    double mid[3][2], rgb[3];
    if (!depth) {
        look_up(w, c, rgb);
        leaf(w, c, rgb);
        return;
    }
    for (int i = 0; i < 3; i++) between(c[i], c[(i + 1) % 3], mid[i]);
    const double part[4][3][2] = {
        { { c[0][0], c[0][1] }, { mid[0][0], mid[0][1] }, { mid[2][0], mid[2][1] } },
        { { mid[0][0], mid[0][1] }, { mid[1][0], mid[1][1] }, { mid[2][0], mid[2][1] } },
        { { mid[0][0], mid[0][1] }, { c[1][0], c[1][1] }, { mid[1][0], mid[1][1] } },
        { { mid[2][0], mid[2][1] }, { mid[1][0], mid[1][1] }, { c[2][0], c[2][1] } }
    };
    for (int i = 0; i < 4; i++) visit(w, part[i], depth - 1, leaf);
}

static void add_up(walk *w, const double c[3][2], const double rgb[3])
{
    (void)c;
    for (int k = 0; k < 3; k++) w->sum[k] += rgb[k];
}

static double power_of(const walk *w, const double rgb[3])
{
    return w->weight[0] * rgb[0] + w->weight[1] * rgb[1] + w->weight[2] * rgb[2];
}

/* A random point of the piece, in world space, for the current light. */
static lc_f3 place_in(const walk *w, const double c[3][2])
{
    const double u = sqrt(lc_unit(lc_hash4(w->seed, w->made, 0, 0))),
                 v = lc_unit(lc_hash4(w->seed, w->made, 0, 1)), a[3] = { 1 - u, u * (1 - v), u * v },
                 b[2] = { a[0] * c[0][0] + a[1] * c[1][0] + a[2] * c[2][0],
                          a[0] * c[0][1] + a[1] * c[1][1] + a[2] * c[2][1] };
    return lc_tri_light_at(w->scene, w->tri, lc_tri_point(w->scene, w->tri, b), w->base->dir);
}

static void add_light(walk *w)
{
    lc_light light = *w->base;
    double f = 1 / w->n_parts;
    light.pos = w->place;
    light.intensity = lc_f3_mul(light.intensity, lc_f3_make((float)(w->sum[0] * f), (float)(w->sum[1] * f),
                                                            (float)(w->sum[2] * f)));
    if (w->placed && !w->status) w->status = lc_scene_add_light(w->scene, (lc_pos){ 0, 0, 0 }, &light);
    w->made++;
    w->placed = false;
    w->sum[0] = w->sum[1] = w->sum[2] = 0;
}

/* Adds a piece to the run of the current light, and completes every light whose run ends inside the piece. */
static void distribute(walk *w, const double c[3][2], const double rgb[3])
{
    double power = power_of(w, rgb), after = w->before + power, from = w->before;
    if (!(power > 0)) return;
    while (from < after && w->made < w->n_lights) {
        double pick = w->total * (w->made + lc_unit(lc_hash4(w->seed, w->made, 0, 2))) / w->n_lights;
        double end = w->made + 1 < w->n_lights ? w->total * (w->made + 1.0) / w->n_lights : INFINITY,
               to = fmin(end, after);
        for (int k = 0; k < 3; k++) w->sum[k] += (to - from) / power * rgb[k];
        if (!w->placed && pick <= to) {
            w->place = place_in(w, c);
            w->placed = true;
        }
        if (end <= after) add_light(w);
        from = to;
    }
    w->before = after;
}

static const double whole[3][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 } };

/* Sets up the walk and returns the depth of the recursion for k lights. */
static uint32_t begin(walk *w, const lc_scene *scene, size_t tri, uint32_t k)
{
    const lc_mesh *mesh = &scene->meshes[scene->tri_mesh[tri]];
    double longest = 0;
    uint32_t depth = 0;
    w->tri = tri;
    w->map = &scene->emission_maps[mesh->emission_map - 1];
    for (size_t v = 0; v < 3; v++) lc_textured_uv(scene, mesh, (uint32_t)tri, v, w->uv[v]);
    for (size_t v = 0; v < 3; v++) {
        double du = (w->uv[v][0] - w->uv[(v + 1) % 3][0]) * w->map->levels[0].width;
        double dv = (w->uv[v][1] - w->uv[(v + 1) % 3][1]) * w->map->levels[0].height;
        longest = fmax(longest, fmax(fabs(du), fabs(dv)));
    }
    const double most = MOST_SPAN * fmax(w->map->levels[0].width, w->map->levels[0].height);
    while (depth < MAX_DEPTH &&
           (fmin(longest, most) > ldexp(1, (int)depth) || ldexp(1, 2 * (int)depth) < PIECES_A_LIGHT * k))
        depth++;
    w->width = fmax(longest / ldexp(1, (int)depth), 1);
    w->n_parts = ldexp(1, 2 * (int)depth);
    return depth;
}

void lc_area_map_mean(const lc_scene *scene, size_t tri, double rgb[3])
{
    walk w = { .n_lights = 0 };
    visit(&w, whole, begin(&w, scene, tri, 1), add_up);
    for (int k = 0; k < 3; k++) rgb[k] = w.sum[k] / w.n_parts;
}

void lc_area_map_at(const lc_scene *scene, size_t tri, const double b[2], double rgb[3])
{
    walk w = { .n_lights = 0 };
    const double here[3][2] = { { b[0], b[1] }, { b[0], b[1] }, { b[0], b[1] } };
    begin(&w, scene, tri, 1);
    look_up(&w, here, rgb);
}

lc_status lc_area_map_lights(lc_scene *scene, size_t tri, uint32_t k, const lc_light *base, uint64_t seed)
{
    walk w = { .scene = scene, .base = base, .n_lights = k, .seed = seed };
    uint32_t depth = begin(&w, scene, tri, k);
    w.weight[0] = (double)base->intensity.x;
    w.weight[1] = (double)base->intensity.y;
    w.weight[2] = (double)base->intensity.z;
    visit(&w, whole, depth, add_up);
    w.total = power_of(&w, w.sum);
    memset(w.sum, 0, sizeof w.sum);
    visit(&w, whole, depth, distribute);
    if (w.made < k) add_light(&w); /* the last run is not ended inside a piece */
    return w.status;
}
