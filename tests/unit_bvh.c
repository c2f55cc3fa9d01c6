/* unit_bvh.c - rays through the BVH against a loop over all triangles in doubles, by Moeller and Trumbore's
 * test, which shares nothing with the kernels. No ray from inside leaves a closed mesh; every instruction set
 * gives the bits of plain C, and any number of threads builds the same bytes. */
#include "base/stats.h"
#include "support/isas.h"
#include "support/logged.h"
#include "support/vec_d.h"
#include "trace/bvh_build.h"

#define RND_KEY 77001
#include "support/meshes.h"

static lc_context *ctx;

/* ---- the reference ---- */

typedef struct {
    double t;
    double margin; /* least barycentric weight: > 0 inside of the triangle, < 0 outside */
    double sine;   /* of the angle between ray and plane */
} ref_hit;

/* False: the triangle is degenerate, or the ray parallel to it. */
static bool ref_tri(uint32_t tri, const float org[3], const float dir[3], ref_hit *h)
{
    double e1[3], e2[3], s[3], d[3], p[3], q[3], n[3];
    const float *v0 = lc_tri_vertex(m.pos, m.index, tri, 0), *v1 = lc_tri_vertex(m.pos, m.index, tri, 1);
    const float *v2 = lc_tri_vertex(m.pos, m.index, tri, 2);
    for (int k = 0; k < 3; k++) {
        e1[k] = (double)v1[k] - v0[k];
        e2[k] = (double)v2[k] - v0[k];
        s[k] = (double)org[k] - v0[k];
        d[k] = (double)dir[k];
    }
    cross_d(d, e2, p);
    cross_d(e1, e2, n);
    cross_d(s, e1, q);
    double det = dot_d(e1, p), len = sqrt(dot_d(n, n) * dot_d(d, d));
    if (!(fabs(det) > 1e-14 * len) || !(len > 0)) return false;
    double u = dot_d(s, p) / det, v = dot_d(d, q) / det;
    h->t = dot_d(e2, q) / det;
    h->margin = fmin(fmin(u, v), 1 - u - v);
    h->sine = fabs(det) / len;
    return true;
}

/* The closest hit by plain C, with which every instruction set must agree to the bit. */
static lc_hit closest(const lc_bvh *b, const float org[3], const float dir[3], float t_max)
{
    lc_hit first, hit;
    lc_isa_kernels(LC_ISA_SCALAR)->trace.closest(&b->data, org, dir, t_max, &first);
    EACH_ISA(isa) {
        lc_isa_kernels(isa)->trace.closest(&b->data, org, dir, t_max, &hit);
        CHECKF(!memcmp(&first, &hit, sizeof hit), "%s: tri %u t %g, scalar: tri %u t %g", lc_isa_name(isa),
               hit.tri, (double)hit.t, first.tri, (double)first.t);
    }
    return first;
}

/* Whether the target is occluded, likewise. */
static uint8_t hidden(const lc_bvh *b, const float org[3], const float target[3], bool far)
{
    uint8_t first = 9, other = 9;
    const float *const list[3] = { &target[0], &target[1], &target[2] };
    lc_isa_kernels(LC_ISA_SCALAR)->trace.hidden(&b->data, org, 1, list, far, &first, NULL);
    EACH_ISA(isa) {
        lc_isa_kernels(isa)->trace.hidden(&b->data, org, 1, list, far, &other, NULL);
        CHECK(other == first);
    }
    return first;
}

static uint32_t n_rays, n_hits, n_unsure;

/* The library's hit is a hit of the reference, and the reference has none that is nearer, but for rounding:
 * eps is the rounding of a coordinate relative to the size of a triangle, and counts more the smaller the
 * angle between ray and triangle is. */
static void check_ray(const lc_bvh *b, const float org[3], const float dir[3], double eps)
{
    lc_hit hit = closest(b, org, dir, FLT_MAX);
    double nearest = INFINITY;
    bool hit_ok = hit.tri == LC_NONE, unsure = false;
    uint32_t nearest_tri = LC_NONE;
    for (uint32_t i = 0; i < m.n_tris; i++) {
        ref_hit r;
        if (!ref_tri(i, org, dir, &r)) {
            if (i == hit.tri) hit_ok = unsure = true; /* edge-on, where the reference is undefined */
            continue;
        }
        double tol = eps / r.sine;
        if (i == hit.tri) {
            double te = fabs(r.t) + 1;
            hit_ok = r.margin > -tol && fabs((double)hit.t - r.t) <= tol * te;
            CHECKF(hit_ok, "tri %u: t %.9g, reference %.9g, margin %g, sine %g", i, (double)hit.t, r.t,
                   r.margin, r.sine);
        }
        if (r.margin > tol && r.t > tol && r.t + tol * (r.t + 1) < nearest) {
            nearest = r.t + tol * (r.t + 1);
            nearest_tri = i;
        }
    }
    CHECKF(hit_ok, "tri %u is no hit", hit.tri);
    CHECKF((double)hit.t <= nearest || unsure, "tri %u at %.9g, but tri %u at most at %.9g", hit.tri,
           (double)hit.t, nearest_tri, nearest);
    n_rays++;
    n_hits += hit.tri != LC_NONE;
    n_unsure += unsure;
}

/* Whether anything is between org and target, likewise: where rounding cannot change the reference's answer,
 * the library's must be the same. */
static void check_segment(const lc_bvh *b, const float org[3], const float target[3], double eps)
{
    float dir[3];
    bool sure_hit = false, maybe_hit = false;
    for (int k = 0; k < 3; k++) dir[k] = target[k] - org[k];
    double lo = (double)LC_SHADOW_EPS, hi = 1 - (double)LC_SHADOW_EPS;
    for (uint32_t i = 0; i < m.n_tris; i++) {
        ref_hit r;
        if (!ref_tri(i, org, dir, &r)) {
            maybe_hit = true;
            continue;
        }
        double tol = eps / r.sine;
        sure_hit |= r.margin > tol && r.t > lo + tol && r.t < hi - tol;
        maybe_hit |= r.margin > -tol && r.t > lo - tol && r.t < hi + tol;
    }
    uint8_t got = hidden(b, org, target, false);
    CHECKF(!sure_hit || got == 1, "a blocked segment is open");
    CHECKF(maybe_hit || got == 0, "an open segment is blocked");
}

/* n rays from random origins to points in the box of half size r about c. */
static void check_mesh(uint32_t n, lc_f3 c, float r, double eps)
{
    lc_bvh *b = build_bvh(ctx);
    const char *wrong = lc_bvh_validate(b, m.pos, m.index, m.n_tris);
    CHECKF(!wrong, "%s", wrong);
    n_rays = n_hits = n_unsure = 0;
    for (uint32_t i = 0; i < n / SLOW; i++) {
        float org[3], at[3], dir[3];
        lc_f3_store(org, lc_f3_add(c, lc_f3_scale(rnd_unit(), r * (float)rnd_in(0, 3))));
        lc_f3_store(at, lc_f3_add(c, lc_f3_make((float)rnd_in(-1, 1) * r, (float)rnd_in(-1, 1) * r,
                                                (float)rnd_in(-1, 1) * r)));
        for (int k = 0; k < 3; k++) dir[k] = at[k] - org[k];
        if (i % 5 == 0) { /* along an axis */
            uint32_t axis = rnd_n(3);
            for (uint32_t k = 0; k < 3; k++) dir[k] = k != axis ? 0 : rnd() < 0.5 ? -r : r;
        }
        check_ray(b, org, dir, eps);
        check_segment(b, org, at, eps);
    }
    printf("  %u triangles, %u nodes: %u rays, %u hits, %u edge-on\n", m.n_tris, b->data.n_nodes, n_rays,
           n_hits, n_unsure);
    CHECK(n_hits > 0);
    lc_bvh_destroy(b);
}

/* eps: a coordinate of v - o is at most 4 here and is rounded a dozen times by 2^-24. For triangles of size s
 * the error of a barycentric weight is therefore about 4 * 12 * 2^-24 / s = 3e-6 / s. */
TEST(random_soup)
{
    clear();
    soup(3, 1);
    check_mesh(4000, zero, 1, 1e-4);
    clear();
    soup(500, 1);
    check_mesh(4000, zero, 1, 1e-4);
    clear();
    soup(3000, 0.1);
    check_mesh(2000, zero, 1, 1e-2);
}

TEST(cornell_box)
{
    clear();
    cornell();
    check_mesh(4000, zero, 1, 1e-4);
}

TEST(big_coordinates)
{
    lc_f3 by = { 1e4f, -2e4f, 5e3f };
    clear();
    soup(300, 100);
    move(100, by);
    check_mesh(3000, by, 100, 1e-2);
    clear();
    soup(300, 1);
    move(1e12f, zero);
    check_mesh(3000, zero, 1e12f, 1e-4);
    clear();
    soup(300, 1);
    move(1e-12f, zero);
    check_mesh(3000, zero, 1e-12f, 1e-4);
}

/* Points, needles and duplicates among ordinary triangles add no hits and lose none. */
TEST(degenerate_triangles)
{
    clear();
    for (int i = 0; i < 200; i++) {
        lc_f3 p = lc_f3_scale(rnd_unit(), 0.9f), d = lc_f3_scale(rnd_unit(), 0.5f);
        put_three(p, p, p);
        put_three(p, p, lc_f3_add(p, d));
        put_three(p, lc_f3_add(p, d), p);
        put_three(p, lc_f3_add(p, d), lc_f3_add(p, lc_f3_scale(d, 2))); /* collinear up to rounding */
    }
    soup(100, 1);
    check_mesh(4000, zero, 1, 1e-4);
}

TEST(only_degenerate_triangles)
{
    clear();
    for (int i = 0; i < 1000; i++) put_three(zero, zero, zero);
    lc_bvh *b = build_bvh(ctx);
    CHECK(!lc_bvh_validate(b, m.pos, m.index, m.n_tris));
    for (int i = 0; i < 1000; i++) {
        float o[3], d[3];
        lc_f3_store(o, i % 2 ? rnd_unit() : zero);
        lc_f3_store(d, lc_f3_neg(lc_f3_load(o)));
        CHECK(closest(b, o, d, FLT_MAX).tri == LC_NONE);
    }
    lc_bvh_destroy(b);
}

TEST(no_triangles)
{
    clear();
    lc_bvh *b = build_bvh(ctx);
    const float o[3] = { 0, 0, 0 }, d[3] = { 0, 0, 1 };
    CHECK(!lc_bvh_validate(b, m.pos, m.index, 0));
    CHECK(closest(b, o, d, FLT_MAX).tri == LC_NONE);
    CHECK(!hidden(b, o, d, false) && !hidden(b, o, d, true));
    lc_bvh_destroy(b);
}

/* The number of levels; node 0 is at level 1. */
static uint32_t depth_of(const lc_bvh *b)
{
    uint32_t *level = calloc(b->data.n_nodes + 1u, sizeof *level), most = b->data.n_nodes ? 1 : 0;
    if (most) level[0] = 1;
    for (uint32_t w = 0; w < b->data.n_nodes; w++) /* children follow their parents */
        for (int i = 0; i < 8; i++) {
            uint32_t c = b->nodes[w].child[i];
            if (c == LC_NONE || (c & LC_BVH_LEAF)) continue;
            CHECK(c > w);
            level[c] = level[w] + 1;
            most = level[c] > most ? level[c] : most;
        }
    free(level);
    return most;
}

/* Of equal hits the one with the lowest id counts, wherever it is in the tree. */
TEST(identical_triangles)
{
    uint32_t n = 100000;
    clear();
    for (int k = 0; k < 3; k++) put_vert(lc_f3_make(k == 0, k == 1, k == 2));
    for (uint32_t i = 0; i < n; i++) put_tri(0, 1, 2);
    double t0 = lc_now();
    lc_bvh *b = build_bvh(ctx);
    const char *wrong = lc_bvh_validate(b, m.pos, m.index, n);
    CHECKF(!wrong, "%s", wrong);
    CHECKF(depth_of(b) < LC_BVH_MAX_DEPTH, "%u levels", depth_of(b));
    printf("  %u nodes, %u levels, %.2f s\n", b->data.n_nodes, depth_of(b), lc_now() - t0);
    for (int i = 0; i < 20; i++) {
        float o[3] = { 0, 0, 0 },
              d[3] = { (float)rnd_in(0.1, 1), (float)rnd_in(0.1, 1), (float)rnd_in(0.1, 1) };
        lc_hit h = closest(b, o, d, FLT_MAX);
        CHECKF(h.tri == 0, "tri %u", h.tri);
        CHECK(hidden(b, o, (const float[]){ 9 * d[0], 9 * d[1], 9 * d[2] }, false));
    }
    lc_bvh_destroy(b);
}

static bool same_bytes(const lc_bvh *a, const lc_bvh *b)
{
    return a->data.n_nodes == b->data.n_nodes && a->data.n_blocks == b->data.n_blocks
           && !memcmp(a->nodes, b->nodes, a->data.n_nodes * sizeof *a->nodes)
           && !memcmp(a->blocks, b->blocks, a->data.n_blocks * sizeof *a->blocks);
}

/* Meshes from one leaf to several levels of ranges that all threads split together. */
static void thread_mesh(int style)
{
    clear();
    if (style == 0) soup(5, 0.5);
    if (style == 1) soup(4000, 0.1);
    if (style == 2) soup(30000, 0.05);
    if (style == 3) { /* 170 thousand triangles, with coordinates 0 and -0 */
        cube(120);
        displace(true, 0.2);
    }
    if (style == 4) {
        cube(60);
        move(1e15f, zero);
    }
    if (style == 5) { /* areas overflow to infinity */
        soup(20000, 0.5);
        move(3e38f, zero);
    }
    if (style == 6) {
        soup(20000, 0.5);
        move(1e-38f, zero);
    }
    for (uint32_t i = 0; style == 7 && i < 50000; i++) { /* degenerate to points and lines */
        float x = i % 3 ? 1 : (float)i;
        put_three(lc_f3_make(x, 0, -0.0f), lc_f3_make(x, 0, 0), lc_f3_make(x, 0, 0));
    }
}

TEST(same_bytes_for_any_number_of_threads)
{
    static const uint32_t threads[] = { 1, 2, 3, 7 };
    for (int style = 0; style < 8; style++) {
        thread_mesh(style);
        lc_bvh *first = NULL;
        for (int i = 0; i < 4; i++) {
            lc_context *c = quiet_context(threads[i]);
            c->bvh = ctx->bvh;
            lc_bvh *b = build_bvh(c);
            b->ctx = ctx;
            lc_context_destroy(c);
            const char *wrong = i ? NULL : lc_bvh_validate(b, m.pos, m.index, m.n_tris);
            CHECKF(!wrong, "style %d: %s", style, wrong);
            CHECKF(!i || same_bytes(first, b), "style %d, %u threads", style, threads[i]);
            CHECKF(depth_of(b) < LC_BVH_MAX_DEPTH, "%u levels", depth_of(b));
            if (i) lc_bvh_destroy(b);
            else first = b;
        }
        lc_bvh_destroy(first);
    }
}

TEST(equal_distances_give_the_lowest_id)
{
    clear();
    soup(60, 1);
    uint32_t n = m.n_tris;
    for (int copy = 0; copy < 20; copy++) /* the same triangles twenty times more */
        for (uint32_t i = 0; i < n; i++) put_tri(m.index[3 * i], m.index[3 * i + 1], m.index[3 * i + 2]);
    lc_bvh *b = build_bvh(ctx);
    uint32_t hits = 0;
    for (int i = 0; i < 20000 / SLOW; i++) {
        float o[3], d[3];
        lc_f3_store(o, lc_f3_scale(rnd_unit(), 2));
        lc_f3_store(d, rnd_unit());
        lc_hit h = closest(b, o, d, FLT_MAX);
        CHECKF(h.tri == LC_NONE || h.tri < n, "tri %u of %u", h.tri, n);
        hits += h.tri != LC_NONE;
    }
    CHECK(hits > 100);
    lc_bvh_destroy(b);
}

/* Triangles on a line at geometric distances, of which a split in the middle separates one at a time. */
TEST(triangles_on_a_line)
{
    for (int style = 0; style < 3; style++) {
        clear();
        for (int i = 0; i < 20000; i++) {
            float x = style == 0   ? (float)i
                      : style == 1 ? ldexpf(1, i % 200 - 100)
                                   : powf(1.004f, (float)i - 10000);
            put_three(lc_f3_make(x, 0, 0), lc_f3_make(x, 1, 0), lc_f3_make(x, 0, 1));
        }
        double t0 = lc_now();
        lc_bvh *b = build_bvh(ctx);
        const char *wrong = lc_bvh_validate(b, m.pos, m.index, m.n_tris);
        CHECKF(!wrong, "%s", wrong);
        CHECKF(depth_of(b) < LC_BVH_MAX_DEPTH, "%u levels", depth_of(b));
        printf("  style %d: %u levels, %.2f s\n", style, depth_of(b), lc_now() - t0);
        const float o[3] = { -1, 0.2f, 0.2f }, d[3] = { 1, 0, 0 }, far_o[3] = { 1e19f, 0.2f, 0.2f },
                    back[3] = { -1, 0, 0 };
        lc_hit h = closest(b, o, d, FLT_MAX);
        CHECK(style != 0 || (h.tri == 0 && h.t == 1));
        CHECK(h.tri != LC_NONE && closest(b, far_o, back, FLT_MAX).tri != LC_NONE);
        lc_bvh_destroy(b);
    }
}

TEST(validator_finds_damage)
{
    clear();
    cube(8);
    lc_bvh *b = build_bvh(ctx);
    CHECK(!lc_bvh_validate(b, m.pos, m.index, m.n_tris));
    for (uint32_t k = 0; k < b->data.n_blocks; k++) {
        lc_tri_block keep = b->blocks[k];
        b->blocks[k].tri[0] = LC_NONE;
        CHECK(lc_bvh_validate(b, m.pos, m.index, m.n_tris));
        b->blocks[k] = keep;
        b->blocks[k].tri[0] = (keep.tri[0] + 1) % m.n_tris;
        CHECK(lc_bvh_validate(b, m.pos, m.index, m.n_tris));
        b->blocks[k] = keep;
        b->blocks[k].v[1][2][0] += 1e-6f;
        CHECK(lc_bvh_validate(b, m.pos, m.index, m.n_tris));
        b->blocks[k] = keep;
    }
    for (uint32_t w = 0; w < b->data.n_nodes; w++)
        for (int i = 0; i < 8; i++) {
            lc_bvh_node keep = b->nodes[w];
            if (keep.child[i] == LC_NONE) continue;
            for (int k = 0; k < 3; k++) {
                b->nodes[w].hi[k][i] = keep.lo[k][i] + (keep.hi[k][i] - keep.lo[k][i]) * 0.4f - 1e-3f;
                CHECKF(lc_bvh_validate(b, m.pos, m.index, m.n_tris), "node %u, child %d, axis %d", w, i, k);
                b->nodes[w] = keep;
            }
            b->nodes[w] = keep;
            b->nodes[w].child[i] = LC_NONE;
            CHECK(lc_bvh_validate(b, m.pos, m.index, m.n_tris));
            b->nodes[w] = keep;
        }
    CHECK(!lc_bvh_validate(b, m.pos, m.index, m.n_tris));
    lc_bvh_destroy(b);
}

/* ---- watertightness ---- */

static uint64_t tight_rays, misses;

/* A ray that must hit, traced by one of the instruction sets in turn. */
static void tight_dir(const lc_bvh *b, lc_f3 o, lc_f3 dir, const char *what)
{
    const float org[3] = { o.x, o.y, o.z }, d[3] = { dir.x, dir.y, dir.z };
    lc_hit hit;
    lc_isa_kernels(isa_in_turn(tight_rays++))->trace.closest(&b->data, org, d, FLT_MAX, &hit);
    if (hit.tri != LC_NONE) return;
    misses++;
    CHECKF(false, "%s: org %a %a %a dir %a %a %a goes through", what, (double)o.x, (double)o.y, (double)o.z,
           (double)dir.x, (double)dir.y, (double)dir.z);
}

static void tight_ray(const lc_bvh *b, lc_f3 o, lc_f3 at, const char *what)
{
    tight_dir(b, o, lc_f3_sub(at, o), what);
}

/* n rays from points at most r from the centre c of a closed mesh that is star-shaped about c. */
static void tight_mesh(uint32_t n, lc_f3 c, float r)
{
    lc_bvh *b = build_bvh(ctx);
    CHECK(!lc_bvh_validate(b, m.pos, m.index, m.n_tris));
    for (uint32_t i = 0; i < n / SLOW; i++) {
        lc_f3 o = i % 4 ? lc_f3_add(c, lc_f3_scale(rnd_unit(), r * (float)rnd())) : c;
        const uint32_t *t = m.index + 3 * (size_t)rnd_n(m.n_tris);
        uint32_t k = rnd_n(3);
        lc_f3 p = vert(t[k]), q = vert(t[(k + 1) % 3]);
        float s = (float)rnd();
        tight_dir(b, o, rnd_unit(), "random");
        tight_ray(b, o, p, "vertex");
        tight_ray(b, o, lc_f3_scale(lc_f3_add(p, q), 0.5f), "midpoint");
        tight_ray(b, o, lc_f3_add(lc_f3_scale(p, 1 - s), lc_f3_scale(q, s)), "edge");
        if (i % 8 == 0) {
            float l = i % 16 ? 1 + s : -1 - s;
            tight_dir(b, o, lc_f3_make(k == 0 ? l : 0, k == 1 ? l : 0, k == 2 ? l : 0), "axis");
        }
    }
    lc_bvh_destroy(b);
}

TEST(closed_meshes_are_watertight)
{
    static const float scales[] = { 1, 1e-4f, 1e-2f, 1e2f, 1e4f };
    static const lc_f3 offsets[] = { { 0, 0, 0 }, { 1e4f, -1e4f, 1e4f }, { 1e4f, 0, 0 }, { 0, 3, -7 } };
    tight_rays = misses = 0;
    for (uint32_t s = 0; s < 5; s++)
        for (uint32_t off = 0; off < 4; off++)
            for (int style = 0; style < 5; style++) {
                /* Styles: a box of 12 triangles, a box of many, a ball, a rough ball, a coarse ball. */
                lc_f3 by = offsets[off];
                clear();
                cube(style == 0 ? 1 : style == 4 ? 3 : 20);
                if (style >= 2) displace(true, style == 3 ? 0.4 : 0);
                /* At an offset of 1e4 floats are 1e-3 apart: smaller meshes would fold over themselves. */
                float scale = off && scales[s] < 1 ? 1 / scales[s] : scales[s];
                move(scale, by);
                tight_mesh(5200, by, 0.4f * scale);
            }
    printf("  %llu rays, %llu misses\n", (unsigned long long)tight_rays, (unsigned long long)misses);
    CHECK(tight_rays >= 2000000 / SLOW);
    CHECK(misses == 0);
}

/* From far outside into the silhouette: the rounding of the distant origin opens no gaps. */
TEST(watertight_from_afar)
{
    tight_rays = misses = 0;
    for (int style = 0; style < 3; style++) {
        clear();
        cube(style == 0 ? 1 : 16);
        if (style) displace(true, style == 2 ? 0.3 : 0);
        lc_bvh *b = build_bvh(ctx);
        for (int i = 0; i < 60000 / SLOW; i++) {
            lc_f3 o = lc_f3_scale(rnd_unit(), powf(10, (float)rnd_in(0.5, 4)));
            lc_f3 at = lc_f3_scale(rnd_unit(), 0.3f); /* a ball of radius 0.7 is inside of all three meshes */
            const uint32_t *t = m.index + 3 * (size_t)rnd_n(m.n_tris);
            tight_ray(b, o, at, "afar");
            lc_f3 v = vert(t[0]), w = vert(t[1]); /* on the near side and well inside of the silhouette */
            if (style == 0 || lc_f3_dot(lc_f3_normalize(v), lc_f3_normalize(o)) < 0.9f) continue;
            tight_ray(b, o, v, "afar, vertex");
            if (lc_f3_dot(lc_f3_normalize(w), lc_f3_normalize(o)) < 0.9f) continue;
            tight_ray(b, o, lc_f3_scale(lc_f3_add(v, w), 0.5f), "afar, midpoint");
        }
        lc_bvh_destroy(b);
    }
    printf("  %llu rays, %llu misses\n", (unsigned long long)tight_rays, (unsigned long long)misses);
    CHECK(misses == 0);
}

/* All shadow rays from inside of a closed mesh to lights outside are blocked. */
TEST(closed_meshes_are_light_tight)
{
    clear();
    cube(20);
    displace(true, 0.3);
    lc_bvh *b = build_bvh(ctx);
    for (int i = 0; i < 100000 / SLOW; i++) {
        float o[3], target[3];
        const uint32_t *t = m.index + 3 * (size_t)rnd_n(m.n_tris);
        lc_f3 p = vert(t[0]), q = vert(t[1]);
        lc_f3_store(o, lc_f3_scale(rnd_unit(), 0.4f * (float)rnd()));
        float s = i % 2 ? 0.5f : (float)rnd();
        lc_f3 at = lc_f3_add(lc_f3_scale(p, 1 - s), lc_f3_scale(q, s));
        lc_f3_store(target, lc_f3_add(lc_f3_load(o), lc_f3_scale(lc_f3_sub(at, lc_f3_load(o)), 5)));
        CHECK(hidden(b, o, target, false));
    }
    lc_bvh_destroy(b);
}

/* ---- ends of rays ---- */

/* A wall at x = 1; org.x = 0. */
TEST(ends_of_shadow_rays)
{
    clear();
    put_three(lc_f3_make(1, -10, -10), lc_f3_make(1, 20, -10), lc_f3_make(1, -10, 20));
    lc_bvh *b = build_bvh(ctx);
    const float o[3] = { 0, 0, 0 };
    static const struct {
        double length; /* along x; the wall is at the fraction 1 / length of the segment */
        int hidden;
    } cases[] = { { 0.5, 0 }, { 1, 0 }, { 1.00005, 0 }, { 1.0002, 1 }, { 2, 1 }, { 9000, 1 }, { 11000, 0 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        float l = (float)cases[i].length;
        const float to[3] = { l, 0.1f * l, -0.1f * l }, away[3] = { -l, 0, 0 };
        CHECKF(hidden(b, o, to, false) == cases[i].hidden, "segment of %g", cases[i].length);
        CHECK(!hidden(b, o, away, false));
    }
    /* The closest hit has 0 < t <= t_max. */
    const float d[3] = { 1, 0, 0 }, on[3] = { 1, 0, 0 };
    CHECK(closest(b, o, d, 1).tri == 0);
    CHECK(closest(b, o, d, nextafterf(1, 0)).tri == LC_NONE);
    CHECK(closest(b, on, d, FLT_MAX).tri == LC_NONE);
    lc_hit h = closest(b, o, (const float[]){ 0.5f, 0, 0 }, FLT_MAX);
    CHECK(h.tri == 0 && h.t == 2);
    /* u and v are weights: P = (1 - u - v) p0 + u p1 + v p2. */
    h = closest(b, o, (const float[]){ 1, 5, -2.5f }, FLT_MAX);
    CHECKF(fabsf(h.u - 0.5f) < 1e-6f && fabsf(h.v - 0.25f) < 1e-6f, "u %g v %g", (double)h.u, (double)h.v);
    /* A null direction hits nothing. */
    CHECK(closest(b, o, o, FLT_MAX).tri == LC_NONE);
    lc_bvh_destroy(b);
}

/* Rays to a light at infinity are blocked by anything along the direction, wherever the origin is. */
TEST(shadow_rays_to_infinity)
{
    static const float at[] = { 0, 1, 1e3f, 1e4f, 1e6f };
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        float x = at[i];
        clear(); /* a wall 4096 away and 80 wide, about the ray of direction (0.6, 0, 0.8) */
        lc_f3 c = lc_f3_make(x + 0.6f * 4096, x, x + 0.8f * 4096);
        put_three(lc_f3_add(c, lc_f3_make(0, -40, -40)), lc_f3_add(c, lc_f3_make(0, 80, -40)),
                  lc_f3_add(c, lc_f3_make(0, -40, 80)));
        lc_bvh *b = build_bvh(ctx);
        const float o[3] = { x, x, x };
        float dirs[][3] = { { 0.6f, 0, 0.8f }, { 0.8f, 0, 0.6f }, { -0.6f, 0, -0.8f } };
        for (int k = 0; k < 3; k++) {
            CHECKF(hidden(b, o, dirs[k], true) == (k == 0), "at %g, direction %d", (double)x, k);
        }
        lc_bvh_destroy(b);
    }
}

/* A copy whose boxes are infinite, so that every triangle is tested. */
static lc_bvh_data without_boxes(const lc_bvh *b)
{
    lc_bvh_node *nodes = aligned_alloc(64, b->data.n_nodes * sizeof *nodes);
    memcpy(nodes, b->nodes, b->data.n_nodes * sizeof *nodes);
    for (uint32_t w = 0; w < b->data.n_nodes; w++)
        for (int i = 0; i < 8; i++)
            for (int k = 0; k < 3 && nodes[w].child[i] != LC_NONE; k++) {
                nodes[w].lo[k][i] = -FLT_MAX;
                nodes[w].hi[k][i] = FLT_MAX;
            }
    return (lc_bvh_data){
        .nodes = nodes, .blocks = b->blocks, .n_nodes = b->data.n_nodes, .n_blocks = b->data.n_blocks
    };
}

/* A segment that starts on a triangle or a little above it; its end is often almost in the triangle's plane.
 */
static void odd_segment(int i, lc_f3 *o, lc_f3 *to)
{
    uint32_t t = rnd_n(m.n_tris);
    lc_f3 p = lc_f3_load(lc_tri_vertex(m.pos, m.index, t, 0)),
          q = lc_f3_load(lc_tri_vertex(m.pos, m.index, t, 1));
    lc_f3 r = lc_f3_load(lc_tri_vertex(m.pos, m.index, t, 2));
    float u = (float)rnd(), v = (float)rnd() * (1 - u), size = lc_f3_len(lc_f3_sub(q, p));
    lc_f3 on = lc_f3_add(lc_f3_scale(p, 1 - u - v), lc_f3_add(lc_f3_scale(q, u), lc_f3_scale(r, v)));
    *o = lc_f3_add(on, lc_f3_scale(rnd_unit(), i % 3 ? size * powf(10, (float)rnd_in(-8, 0)) : 0));
    *to = lc_f3_add(i % 2 ? on : *o, lc_f3_scale(rnd_unit(), size * powf(10, (float)rnd_in(-8, 1))));
    if (i % 5 == 0) *to = lc_f3_add(lc_f3_scale(p, 1 - v), lc_f3_scale(r, v));
}

/* No box keeps a shadow ray from a triangle that the triangle test accepts, as boxes are padded by more than
 * the test's rounding. The nearest hit may differ where two hits are equally near up to rounding. */
TEST(boxes_lose_no_hit)
{
    const lc_trace_kernels *k = &lc_isa_kernels(lc_isa_pick(LC_ISA_BEST))->trace;
    for (int style = 0; style < 6; style++) {
        uint32_t n = 40000 / SLOW, n_hidden = 0, lost = 0, lost_closest = 0;
        odd_mesh(style);
        lc_bvh *b = build_bvh(ctx);
        lc_bvh_data all = without_boxes(b);
        for (uint32_t i = 0; i < n; i++) {
            lc_f3 o, to;
            odd_segment((int)i, &o, &to);
            const float org[3] = { o.x, o.y, o.z }, dir[3] = { to.x - o.x, to.y - o.y, to.z - o.z };
            const float *const list[3] = { &to.x, &to.y, &to.z };
            uint8_t got, want;
            lc_hit hit, best;
            if (!(lc_f3_len(lc_f3_load(dir)) > 0)) continue;
            k->hidden(&b->data, org, 1, list, false, &got, NULL);
            k->hidden(&all, org, 1, list, false, &want, NULL);
            CHECK(want >= got);
            k->closest(&b->data, org, dir, FLT_MAX, &hit);
            k->closest(&all, org, dir, FLT_MAX, &best);
            lost += got != want;
            n_hidden += want;
            lost_closest += hit.tri != best.tri;
        }
        printf("  style %d: %u segments, %u hidden, %u lost by boxes; closest: %u differ\n", style, n,
               n_hidden, lost, lost_closest);
        CHECK(n_hidden > 0 && lost == 0 && lost_closest <= n / 1000);
        free((void *)all.nodes);
        lc_bvh_destroy(b);
    }
}

/* By all ways to share n children out. */
static float least_opened(const lc_bvh_costs *l, const lc_bvh_costs *r, uint32_t n)
{
    float least = FLT_MAX;
    for (uint32_t k = 1; k < n; k++) least = fminf(least, l->at_most[k - 1] + r->at_most[n - k - 1]);
    return least;
}

TEST(plans_cost_the_least)
{
    enum { N = 64 };
    lc_bvh_costs made[N];
    for (int run = 0; run < 300; run++)
        for (uint32_t i = 0; i < N; i++) {
            const lc_bvh_costs *l = &made[rnd_n(i)], *r = &made[rnd_n(i)], *c = &made[i];
            const bool leaf = i < 8 || rnd() < 0.3;
            const float x = (float)rnd_in(1, leaf ? 4 : 6), y = (float)rnd_in(0, 2), area = x * y + y + x;
            lc_bin_node node = { .hi = { x, y, 1 }, .info = leaf ? LC_BIN_LEAF : 0 };
            made[i] = leaf ? lc_bvh_plan(&node, NULL, NULL) : lc_bvh_plan(&node, l, r);
            CHECK(c->at_most[0] == (leaf ? area : area + least_opened(l, r, 8)));
            for (uint32_t n = 2; n <= 7; n++) {
                const float opened = leaf ? FLT_MAX : least_opened(l, r, n),
                            want = fminf(c->at_most[n - 2], opened);
                CHECKF(c->at_most[n - 1] == want, "%u: %g, %g", n, (double)c->at_most[n - 1], (double)want);
                const uint32_t k = node.info >> 3 * (n - 2) & 7;
                if (!leaf && k) CHECK(k < n && l->at_most[k - 1] + r->at_most[n - k - 1] == want);
                else CHECK(leaf || want == c->at_most[n - 2]);
            }
        }
}

/* However the hierarchy was built, rays hit the same triangles at the same distances, and the same segments
 * are occluded. */
TEST(both_builds_give_the_same_answers)
{
    for (int style = 0; style < 5; style++) {
        const double far = style == 4 ? 1e15 : 0;
        uint32_t n_hidden = 0;
        thread_mesh(style);
        ctx->bvh = LC_BVH_BEST;
        lc_bvh *best = build_bvh(ctx);
        ctx->bvh = LC_BVH_FAST;
        lc_bvh *fast = build_bvh(ctx);
        ctx->bvh = LC_BVH_BEST;
        CHECK(style == 0 || !same_bytes(best, fast));
        for (int i = 0; i < 4000; i++) {
            float org[3], to[3], dir[3];
            for (int k = 0; k < 3; k++) {
                org[k] = (float)(far + rnd_in(-2, 2) * fmax(far * 1e-7, 1));
                to[k] = (float)(far + rnd_in(-2, 2) * fmax(far * 1e-7, 1));
                dir[k] = to[k] - org[k];
            }
            lc_hit a = closest(best, org, dir, FLT_MAX), b = closest(fast, org, dir, FLT_MAX);
            uint8_t h = hidden(best, org, to, false);
            CHECKF(!memcmp(&a, &b, sizeof a), "style %d, ray %d", style, i);
            CHECKF(h == hidden(fast, org, to, false), "style %d, segment %d", style, i);
            n_hidden += h;
        }
        CHECKF(style == 0 || style == 4 || (n_hidden > 0 && n_hidden < 4000), "style %d: %u", style,
               n_hidden);
        lc_bvh_destroy(best);
        lc_bvh_destroy(fast);
    }
}

/* Of either way to build. */
static void run_built(void)
{
    RUN(no_triangles);
    RUN(random_soup);
    RUN(cornell_box);
    RUN(big_coordinates);
    RUN(degenerate_triangles);
    RUN(only_degenerate_triangles);
    RUN(identical_triangles);
    RUN(same_bytes_for_any_number_of_threads);
    RUN(equal_distances_give_the_lowest_id);
    RUN(triangles_on_a_line);
    RUN(boxes_lose_no_hit);
}

int main(void)
{
    ctx = quiet_context(0);
    printf("seed %llu, best %s\n", (unsigned long long)rng_key, lc_isa_name(lc_isa_pick(LC_ISA_BEST)));
    RUN(every_instruction_set_is_here);
    RUN(ends_of_shadow_rays);
    RUN(shadow_rays_to_infinity);
    run_built();
    RUN(validator_finds_damage);
    RUN(closed_meshes_are_light_tight);
    RUN(watertight_from_afar);
    RUN(closed_meshes_are_watertight);
    RUN(both_builds_give_the_same_answers);
    RUN(plans_cost_the_least);
    ctx->bvh = LC_BVH_FAST;
    run_built();
    lc_context_destroy(ctx);
    return test_done();
}
