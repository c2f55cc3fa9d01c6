/* area_light.c - distributes lights over the emissive triangles.
 *
 * On a triangle: k stratified points. The unit square is cut into k jittered cells of a rank-1 lattice and
 * mapped to the triangle. Points on a grid would give exact ties in the light tree and visible bands.
 *
 * Between triangles: half of the lights are distributed by power, half evenly over the emissive meshes. A
 * weak lamp may be close, or reflected by a glossy surface, where a handful of lights would show as dots.
 *
 * Triangles whose part is less than one light are grouped with the next such triangles of their mesh until
 * the group has one. Its light lies in one of them, chosen by power, and has the flux of all. So every
 * emissive mesh has a light and exactly its power and colour, and the number of lights exceeds n_lights by at
 * most one for each side of a mesh.
 */
#include "prepare/area_light.h"

#include "base/context.h"
#include "base/rng.h"
#include "prepare/area_map.h"
#include "prepare/emitter.h"
#include "prepare/triangle.h"

#define INV_GOLDEN_RATIO 0.61803398874989484820 /* generator of the rank-1 lattice */
#define ROUNDING 1e-6 /* lights: sums that miss an integer by rounding still reach it */

/* Appends k lights like `light` at stratified points of the triangle. sign: 0 or 1, for the two sides. */
static lc_status spread(lc_scene *s, size_t tri, uint32_t k, lc_light *light, uint64_t sign, uint64_t seed)
{
    for (uint32_t i = 0; i < k; i++) {
        double u = (i + lc_unit(lc_hash4(seed, tri, i, sign))) / k;
        double v = i * INV_GOLDEN_RATIO + lc_unit(lc_hash4(seed, tri, 0, 2 + sign));
        v += lc_unit(lc_hash4(seed, tri, i, 4 + sign)) / k;
        v -= floor(v);
        const double b[2] = { v * sqrt(u), (1 - v) * sqrt(u) };
        light->pos = lc_tri_light_at(s, tri, lc_tri_point(s, tri, b), light->dir);
        lc_status st = lc_scene_add_light(s, (lc_pos){ 0, 0, 0 }, light);
        if (st) return st;
    }
    return LC_OK;
}

/* Small triangles of a mesh that share one light, or a single triangle that has k. */
typedef struct group {
    double power, flux[3]; /* sums over the group */
    double first;          /* number of lights, rounded down, for the triangles before the group */
    size_t tri;            /* the triangle in which the light lies */
    uint32_t n;            /* triangles */
} group;

/* Appends k lights for each emitting side of the group. */
static lc_status add_lights(lc_scene *s, const group *g, uint32_t k, uint64_t seed)
{
    const lc_emitter e = lc_emitter_of(s, g->tri);
    const lc_mesh *mesh = &s->meshes[s->tri_mesh[g->tri]];
    double side = e.side;
    lc_status st = LC_OK;
    for (uint32_t i = 0; i < e.n_sides && !st; i++, side = -side) {
        lc_light light = { .kind = LC_LIGHT_ORIENTED, .atten = { 0, 0, 1 } };
        light.dir = lc_emitter_normal(&e, side);
        light.group = mesh->group;
        if (mesh->emission_map && g->n == 1) {
            light.intensity = lc_f3_scale(mesh->emission, (float)(0.5 * e.twice));
            st = lc_area_map_lights(s, g->tri, k, &light, lc_hash4(seed, g->tri, 0, 6 + (side > 0)));
            continue;
        }
        lc_f3 flux = lc_f3_make((float)(g->flux[0] / k), (float)(g->flux[1] / k), (float)(g->flux[2] / k));
        light.intensity = lc_f3_mul(mesh->emission, flux);
        st = spread(s, g->tri, k, &light, side > 0, seed);
    }
    return st;
}

/* Adds a triangle to the group; it becomes g->tri with a probability proportional to its power. */
static void join(group *g, size_t tri, double power, const double flux[3], double first, uint64_t seed)
{
    if (!g->n) *g = (group){ .first = first };
    g->n++;
    g->power += power;
    for (int k = 0; k < 3; k++) g->flux[k] += flux[k];
    if (g->n == 1 || lc_unit(lc_hash4(seed, tri, 0, 8)) * g->power < power) g->tri = tri;
}

typedef struct powers {
    double *of_mesh, total;
    size_t n_meshes; /* meshes with power above 0 */
} powers;

static lc_status make_lights(lc_scene *scene, const powers *p, uint32_t n_lights, uint64_t seed)
{
    double before = 0;
    group small = { .n = 0 };
    lc_status st = LC_OK;
    for (size_t t = 0; t < scene->n_tris && !st; t++) {
        const lc_emitter e = lc_emitter_of(scene, t);
        uint32_t mesh = scene->tri_mesh[t], sides = e.n_sides;
        double power = e.power;
        if (small.n && scene->tri_mesh[small.tri] != mesh) {
            st = add_lights(scene, &small, 1, seed);
            small.n = 0;
        }
        if (!(power > 0) || st) continue;
        scene->n_emissive_tris++;
        /* Lights for this triangle, not rounded; rounding the running sum keeps the total. */
        double share = n_lights *
                       (0.5 * power / p->total + 0.5 * power / p->of_mesh[mesh] / (double)p->n_meshes);
        double first = floor(before + ROUNDING), last = floor(before + share + ROUNDING);
        before += share;
        if (share + ROUNDING >= sides && last - first >= sides) {
            group alone = { .n = 0 };
            join(&alone, t, power, e.flux, first, seed);
            st = add_lights(scene, &alone, (uint32_t)(last - first) / sides, seed);
        } else {
            join(&small, t, power, e.flux, first, seed);
            if (last - small.first >= sides) {
                st = add_lights(scene, &small, 1, seed);
                small.n = 0;
            }
        }
    }
    if (small.n && !st) st = add_lights(scene, &small, 1, seed);
    return st;
}

lc_status lc_area_lights_make(lc_scene *scene, uint32_t n_lights, uint64_t seed)
{
    if (!scene->n_meshes) return LC_OK;
    powers p = { .of_mesh = lc_alloc(scene->ctx, scene->n_meshes, sizeof *p.of_mesh) };
    if (!p.of_mesh) return LC_ERR_MEMORY;
    for (size_t i = 0; i < scene->n_meshes; i++) p.of_mesh[i] = 0;
    for (size_t t = 0; t < scene->n_tris; t++) p.of_mesh[scene->tri_mesh[t]] += lc_emitter_of(scene, t).power;
    for (size_t i = 0; i < scene->n_meshes; i++) {
        p.total += p.of_mesh[i];
        p.n_meshes += p.of_mesh[i] > 0;
    }
    lc_status st = p.total > 0 ? make_lights(scene, &p, n_lights, seed) : LC_OK;
    lc_free(scene->ctx, p.of_mesh, scene->n_meshes, sizeof *p.of_mesh);
    return st;
}
