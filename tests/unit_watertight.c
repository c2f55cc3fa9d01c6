/* unit_watertight.c - closed meshes let no ray out: all rays from inside of random ones, half of them towards
 * edges and vertices, hit something, as rays for the nearest hit and as groups of shadow rays to near and far
 * ends, by every instruction set.
 *
 *     build/tests/unit_watertight             2 * 10^6 rays
 *     build/tests/unit_watertight 1e8 [SEED]  as many as asked for
 *
 * A mesh may be so far from the origin that rounding moves its vertices to few places, and triangles fold or
 * vanish. It stays closed, so that a point that was inside by more than a rounding step still is. */
#include "support/isas.h"
#include "support/logged.h"

#define RND_KEY 91001
#include "support/meshes.h"

#define GROUP 64
#define RAYS_PER_MESH 20000

typedef enum { BALL, ROUGH_BALL, BOX, HILLS, TORUS, STYLES } style;

static lc_context *ctx;
static uint64_t rays, misses;

/* ---- meshes of size 1 about 0 ---- */

static lc_f3 on_torus(uint32_t i, uint32_t k, uint32_t n, double bump)
{
    const double turn = 6.283185307179586;
    double a = turn * (i % n) / n, b = turn * (k % n) / n, r = 0.3 + bump * lc_unit(lc_hash2(i % n, k % n));
    return lc_f3_make((float)((0.7 + r * cos(b)) * cos(a)), (float)((0.7 + r * cos(b)) * sin(a)),
                      (float)(r * sin(b)));
}

static void torus(uint32_t n, double bump)
{
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < n; k++) put_vert(on_torus(i, k, n, bump));
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < n; k++) {
            uint32_t j = (i + 1) % n * n, l = (k + 1) % n, at = i * n;
            put_tri(at + k, j + k, j + l);
            put_tri(at + k, j + l, at + l);
        }
}

/* A box with a height field as its top: each vertex of the top, also where it meets the walls, is moved down
 * by an amount of its own. */
static void hills(uint32_t n)
{
    cube(n);
    for (uint32_t i = 0; i < m.n_verts; i++) {
        float *p = m.pos + 3 * (size_t)i;
        uint64_t key = lc_hash2((uint64_t)(int64_t)lrintf(p[0] * 4096),
                                (uint64_t)(int64_t)lrintf(p[1] * 4096));
        if (p[2] >= 1) p[2] -= (float)(0.9 * lc_unit(key));
    }
}

static void make_mesh(style s, uint32_t n)
{
    clear();
    if (s == TORUS) {
        torus(n + 10, 0.1 * rnd());
        return;
    }
    if (s == HILLS) hills(n);
    else cube(n);
    if (s == BALL || s == ROUGH_BALL) displace(true, s == ROUGH_BALL ? 0.4 : 0);
}

/* A point well inside of the mesh of that style. */
static lc_f3 inside(style s)
{
    double a = rnd_in(0, 6.283185307179586);
    if (s == TORUS)
        return lc_f3_make((float)(0.7 * cos(a)), (float)(0.7 * sin(a)), (float)rnd_in(-0.05, 0.05));
    lc_f3 p = lc_f3_scale(rnd_unit(), 0.3f * (float)rnd());
    return s == HILLS ? lc_f3_add(p, lc_f3_make(0, 0, -0.5f)) : p;
}

/* ---- rays ---- */

/* To a random vertex, edge or direction; of any length, as kernels may depend on it. */
static lc_f3 direction(lc_f3 o, uint32_t i)
{
    const uint32_t *t = m.index + 3 * (size_t)rnd_n(m.n_tris), k = rnd_n(3);
    lc_f3 p = vert(t[k]), q = vert(t[(k + 1) % 3]);
    float s = (float)rnd();
    if (i % 4 == 1) return lc_f3_sub(p, o);
    if (i % 4 == 3) return lc_f3_sub(lc_f3_add(lc_f3_scale(p, 1 - s), lc_f3_scale(q, s)), o);
    if (i % 32 == 0)
        return lc_f3_make(k == 0 ? s - 0.5f : 0, k == 1 ? s - 0.5f : 0, k == 2 ? s - 0.5f : -0.0f);
    return lc_f3_scale(rnd_unit(), powf(2, (float)rnd_in(-20, 20)));
}

static void miss(const char *what, lc_isa isa, lc_f3 o, lc_f3 d)
{
    misses++;
    CHECKF(false, "%s, %s: org %a %a %a dir %a %a %a goes through", what, lc_isa_name(isa), (double)o.x,
           (double)o.y, (double)o.z, (double)d.x, (double)d.y, (double)d.z);
}

/* A group of rays from one point: each ray alone for its nearest hit, then all as directions, and all as
 * segments that end outside. */
static void group(const lc_bvh *b, lc_f3 o, float size)
{
    float dir[3][GROUP], end[3][GROUP], org[3];
    uint8_t out[2][GROUP + LC_LANES];
    lc_isa isa = isa_in_turn(rays / GROUP);
    const lc_trace_kernels *kernels = &lc_isa_kernels(isa)->trace;
    lc_f3_store(org, o);
    for (uint32_t i = 0; i < GROUP; i++) {
        lc_f3 d = direction(o, i);
        if (!(lc_f3_dot(d, d) > 0)) d = lc_f3_make(1, 0, 0);
        double length = sqrt((double)d.x * d.x + (double)d.y * d.y + (double)d.z * d.z);
        dir[0][i] = d.x;
        dir[1][i] = d.y;
        dir[2][i] = d.z;
        float far = (float)(20 * (double)size / length);
        end[0][i] = o.x + far * d.x;
        end[1][i] = o.y + far * d.y;
        end[2][i] = o.z + far * d.z;
        lc_hit hit;
        kernels->closest(&b->data, org, (float[3]){ d.x, d.y, d.z }, FLT_MAX, &hit);
        if (hit.tri == LC_NONE) miss("nearest", isa, o, d);
    }
    const float *const dirs[3] = { dir[0], dir[1], dir[2] }, *const ends[3] = { end[0], end[1], end[2] };
    kernels->hidden(&b->data, org, GROUP, dirs, true, out[0], NULL);
    kernels->hidden(&b->data, org, GROUP, ends, false, out[1], NULL);
    for (uint32_t i = 0; i < GROUP; i++)
        for (int k = 0; k < 2; k++) {
            lc_f3 to = k ? lc_f3_make(end[0][i], end[1][i], end[2][i])
                         : lc_f3_make(dir[0][i], dir[1][i], dir[2][i]);
            if (!out[k][i]) miss(k ? "segment" : "direction", isa, o, to);
        }
    rays += 3 * GROUP;
}

static void one_mesh(style s, float scale, double offset)
{
    uint32_t n = 1 + rnd_n(rnd() < 0.2 ? 40 : 12);
    lc_f3 by = lc_f3_scale(rnd_unit(), (float)(offset * (double)scale));
    make_mesh(s, n);
    move(scale, by);
    lc_bvh *b = build_bvh(ctx);
    for (uint64_t end = rays + RAYS_PER_MESH / SLOW; rays < end;)
        group(b, lc_f3_add(lc_f3_scale(inside(s), scale), by), scale);
    lc_bvh_destroy(b);
}

static double wanted = 2e6 / SLOW;

/* Meshes of sizes 1e-6 to 1e6 whose centres are up to 1e5 sizes away from the origin. */
TEST(no_ray_leaves_a_closed_mesh)
{
    uint64_t meshes = 0;
    for (; (double)rays < wanted; meshes++) {
        float scale = (float)pow(10, rnd_in(-6, 6));
        double offset = meshes % 3 == 0 ? 0 : pow(10, rnd_in(-1, 5));
        one_mesh((style)(meshes % STYLES), scale, offset);
    }
    printf("  %llu rays in %llu meshes, %llu misses\n", (unsigned long long)rays, (unsigned long long)meshes,
           (unsigned long long)misses);
    CHECK(misses == 0);
}

int main(int argc, char **argv)
{
    if (argc > 1) wanted = strtod(argv[1], NULL);
    if (argc > 2) rng_key = strtoull(argv[2], NULL, 10);
    ctx = quiet_context(0);
    RUN(every_instruction_set_is_here);
    RUN(no_ray_leaves_a_closed_mesh);
    lc_context_destroy(ctx);
    return test_done();
}
