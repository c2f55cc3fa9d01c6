/* unit_occlusion.c - proofs that a cluster is occluded: where one succeeds, shadow rays to places all over
 * the cluster's box, to its corners and faces first, are all blocked. Walls, gaps and folds for which the
 * answer is known are proved, or not proved, as they should be. */
#include "cut/occlusion_proof.h"
#include "shade/light.h"
#include "support/isas.h"
#include "support/logged.h"

#define RND_KEY 71077
#include "support/meshes.h"

static lc_context *ctx;

typedef struct {
    lc_bvh *bvh;
    lc_occluders *occluders;
    lc_light_rec light;
    lc_tree_data tree;
    lc_occlusion at;
} setup;

static void make(setup *s)
{
    const lc_occluders_desc desc = { m.pos, m.index, m.n_tris, NULL };
    memset(s, 0, sizeof *s);
    s->bvh = build_bvh(ctx);
    if (lc_occluders_build(ctx, &desc, &s->occluders)) abort();
    s->bvh->occluders = s->occluders;
    s->tree.lights = &s->light;
    const lc_visibility visibility = lc_bvh_visibility(s->bvh);
    lc_occlusion_init(&s->at, &visibility, &s->tree);
}

static void unmake(setup *s)
{
    lc_bvh_destroy(s->bvh);
    lc_occluders_destroy(s->occluders);
}

static bool hidden(const setup *s, lc_isa isa, const float org[3], lc_f3 to, bool far, uint32_t *block)
{
    const float *const target[3] = { &to.x, &to.y, &to.z };
    uint8_t out[LC_LANES];
    lc_isa_kernels(isa)->trace.hidden(&s->bvh->data, org, 1, target, far, out, block);
    return out[0];
}

static bool in_box(float p, float center, float half)
{
    return fabs((double)p - (double)center) <= (double)half;
}

/* A coordinate in the box, in exact arithmetic. where: -1 to 1 across the box. */
static float place(float center, float half, double where)
{
    float p = (float)((double)center + where * (double)half);
    while (!in_box(p, center, half)) p = nextafterf(p, center);
    return p;
}

/* A point of the box; style 0: a corner, 1: on a face or inside. */
static lc_f3 place3(const lc_node *n, int style)
{
    float p[3];
    for (int k = 0; k < 3; k++) {
        double where = style == 0 || rnd() < 0.3 ? (rnd() < 0.5 ? -1 : 1) : rnd_in(-1, 1);
        p[k] = place(n->center[k], n->half[k], where);
    }
    return lc_f3_load(p);
}

/* The nearest coordinate that a scene may contain. */
static float accepted(float x) { return fmaxf(-LC_MAX_COORD, fminf(x, LC_MAX_COORD)); }

/* Half a side of a box, at least as long as it takes to hold p. */
static float half_up_to(float half, float center, float p)
{
    half = fmaxf(half, fabsf(p - center));
    while (!in_box(p, center, half)) half = nextafterf(half, INFINITY);
    return half;
}

/* A box with the light in it, at a random place. */
static lc_node box_about(lc_f3 light, double size)
{
    lc_node n = { .left = 0 };
    const float p[3] = { light.x, light.y, light.z };
    for (int k = 0; k < 3; k++) {
        n.half[k] = (float)(size * (rnd() < 0.2 ? 0 : rnd()));
        n.center[k] = accepted((float)((double)p[k] + rnd_in(-1, 1) * (double)n.half[k]));
        n.half[k] = half_up_to(n.half[k], n.center[k], p[k]);
    }
    return n;
}

/* Checks that rays to corners, faces and the inside of a box are blocked. */
static void all_hidden(const setup *s, const float org[3], const lc_node *box, bool far)
{
    for (int i = 0; i < 24; i++) {
        lc_f3 to = place3(box, i < 8 ? 0 : 1);
        lc_isa isa = i % 2 ? LC_ISA_SCALAR : lc_isa_pick(LC_ISA_BEST);
        CHECKF(hidden(s, isa, org, to, far, NULL), "%s%s: org %a %a %a, to %a %a %a", lc_isa_name(isa),
               far ? " far" : "", (double)org[0], (double)org[1], (double)org[2], (double)to.x, (double)to.y,
               (double)to.z);
    }
}

typedef struct {
    uint64_t tried, proved, tests;
} tally;

/* Tries to prove that a box is occluded, if its light is, and checks the proof. False: there is none. */
static bool try(setup *s, const float org[3], lc_f3 light, const lc_node *box, bool far, tally *t)
{
    uint32_t block, other;
    s->light = (lc_light_rec){ .pos = { light.x, light.y, light.z } };
    if (!hidden(s, LC_ISA_SCALAR, org, light, far, &block)) return false;
    EACH_ISA(isa) CHECK(hidden(s, isa, org, light, far, &other) && other == block);
    lc_occlusion_start(&s->at, org);
    lc_occlusion_note(&s->at, 0, block);
    uint32_t by = lc_occlusion_by(&s->at, 0, far);
    CHECK(by == lc_occlusion_by(&s->at, 0, far));
    t->tried++;
    if (by == LC_NONE) return false;
    bool proved = lc_occlusion_proves(&s->at, box, by, true, far, LC_MAX_PATCH, &t->tests);
    CHECK(proved == lc_occlusion_proves(&s->at, box, by, true, far, LC_MAX_PATCH, &t->tests));
    if (!proved) return false;
    t->proved++;
    all_hidden(s, org, box, far);
    return true;
}

/* ---- any mesh ---- */

#define N_MESHES 16

static void make_mesh(int style)
{
    static const float scale[] = { 1e-12f, 1e-9f, 1e-4f, 1e4f, 1e9f, 1e12f };
    if (style < 6) odd_mesh(style);
    else clear();
    if (style == 6) cube(1);
    if (style == 7) {
        cube(3);
        displace(true, 0.4);
    }
    if (style == 8) {
        cube(8);
        displace(true, 0);
    }
    if (style >= 9 && style < 15) {
        cornell();
        move(scale[style - 9], zero);
    }
    if (style == 15) {
        cube(2);
        displace(true, 0.9);
        move(1, lc_f3_make(300, 0, 0));
    }
    /* All triangles get the same orientation, so that those about a vertex form a patch. */
    if (style == 7 || style == 8 || style == 15)
        for (uint32_t i = 0; i < m.n_tris; i++) {
            uint32_t *t = m.index + 3 * (size_t)i, swap = t[1];
            lc_f3 a = vert(t[0]), n = lc_f3_cross(lc_f3_sub(vert(t[1]), a), lc_f3_sub(vert(t[2]), a));
            if (style == 15) a.x -= 300;
            if (lc_f3_dot(n, a) < 0) {
                t[1] = t[2];
                t[2] = swap;
            }
        }
}

static void extent(lc_f3 *c, float *r)
{
    lc_box b = lc_box_empty();
    for (uint32_t i = 0; i < m.n_verts; i++) lc_box_add(&b, vert(i));
    *c = lc_f3_scale(lc_f3_add(b.lo, b.hi), 0.5f);
    *r = 0.5f * lc_f3_max_abs(lc_f3_sub(b.hi, b.lo));
}

static lc_f3 rnd_near(lc_f3 c, float r)
{
    float p[3] = { c.x, c.y, c.z };
    for (int k = 0; k < 3; k++) p[k] = accepted(p[k] + (float)rnd_in(-1, 1) * r);
    return lc_f3_load(p);
}

static lc_f3 rnd_org(lc_f3 c, float r)
{
    const uint32_t *t = m.index + 3 * (size_t)rnd_n(m.n_tris);
    double kind = rnd();
    if (kind < 0.4) return rnd_near(c, 2 * r);
    if (kind < 0.5) return rnd_near(c, 30 * r);
    float u = (float)rnd(), v = (float)rnd() * (1 - u); /* on a triangle or close to it */
    lc_f3 p = lc_f3_add(lc_f3_scale(vert(t[0]), 1 - u - v),
                        lc_f3_add(lc_f3_scale(vert(t[1]), u), lc_f3_scale(vert(t[2]), v)));
    return rnd_near(p, kind < 0.9 ? 1e-4f * r : 0);
}

/* Makes one of the meshes; its centre and half its extent. */
static void make_any(setup *s, int style, lc_f3 *c, float *r)
{
    make_mesh(style);
    for (uint32_t i = 0; i < 3 * m.n_verts; i++) m.pos[i] = accepted(m.pos[i]);
    extent(c, r);
    make(s);
}

TEST(what_is_proved_hidden_is_hidden)
{
    static setup s;
    tally all = { 0, 0, 0 };
    for (int style = 0; style < N_MESHES; style++) {
        tally t = { 0, 0, 0 };
        lc_f3 c;
        float r;
        make_any(&s, style, &c, &r);
        for (int i = 0; i < 30000 / SLOW; i++) {
            float org[3];
            bool far = rnd() < 0.3;
            lc_f3 from = rnd_org(c, r),
                  light = far ? rnd_unit() : rnd_near(c, rnd() < 0.9 ? 1.5f * r : 100 * r);
            lc_f3_store(org, from);
            lc_node box = box_about(light, (far ? 1 : (double)r) * pow(10, rnd_in(-6, 0)));
            try(&s, org, light, &box, far, &t);
        }
        printf("  mesh %2d: %6u triangles, %6llu boxes, %6llu proved by %.1f triangles\n", style, m.n_tris,
               (unsigned long long)t.tried, (unsigned long long)t.proved,
               (double)t.tests / (double)(t.tried ? t.tried : 1) / 2);
        all.tried += t.tried;
        all.proved += t.proved;
        unmake(&s);
    }
    CHECKF(all.proved > 50000 / SLOW, "%llu of %llu", (unsigned long long)all.proved,
           (unsigned long long)all.tried);
}

/* Lights as close behind a wall's plane as proofs allow, seen at angles of 1e-2 to 1e-6 to that plane, where
 * the rounding of its distance decides. */
TEST(proofs_at_grazing_planes)
{
    static setup s;
    tally t = { 0, 0, 0 };
    for (int i = 0; i < 4000 / SLOW; i++) {
        lc_f3 c = rnd_near(zero, 2), n = rnd_unit(), x = lc_f3_normalize(lc_f3_cross(n, rnd_unit()));
        lc_f3 y = lc_f3_cross(n, x);
        clear();
        lc_f3 top = lc_f3_add(c, lc_f3_scale(x, 2)), up = lc_f3_scale(y, 3);
        put_three(lc_f3_add(c, lc_f3_scale(x, -3)), lc_f3_add(top, up), lc_f3_sub(top, up));
        make(&s);
        for (int k = 0; k < 40; k++) {
            float org[3], height = powf(10, (float)rnd_in(-6, -2)), r = 0.5f * (float)rnd_in(0.1, 1);
            lc_f3 from = lc_f3_add(c, lc_f3_scale(rnd_unit(), 0.3f));
            from = lc_f3_add(from, lc_f3_scale(n, height - lc_f3_dot(lc_f3_sub(from, c), n)));
            lc_f3_store(org, from);
            float below = height * (1 + LC_SHADOW_EPS * (float)rnd_in(0.5, 6));
            lc_f3 along = lc_f3_normalize(lc_f3_cross(n, rnd_unit()));
            lc_f3 light = lc_f3_add(lc_f3_add(from, lc_f3_scale(along, r)), lc_f3_scale(n, -below));
            lc_node box = box_about(light, pow(10, rnd_in(-9, -6)));
            try(&s, org, light, &box, false, &t);
        }
        unmake(&s);
    }
    printf("  %llu tried, %llu proved\n", (unsigned long long)t.tried, (unsigned long long)t.proved);
    CHECK(t.proved > t.tried / 100 && t.tried > 10000 / SLOW);
}

/* Points reuse the triangle of a proof for a point close to them, from which the triangle may not cover the
 * box: a proof that starts from any triangle must be right. */
TEST(a_proof_may_begin_at_any_triangle)
{
    static setup s;
    uint64_t n_proved = 0, n_tests = 0;
    for (int style = 0; style < N_MESHES; style++) {
        lc_f3 c;
        float r, org[3];
        make_any(&s, style, &c, &r);
        for (int i = 0; i < 100000 / SLOW && s.occluders->n; i++) {
            bool far = rnd() < 0.3;
            lc_f3 light = far ? rnd_unit() : rnd_near(c, rnd() < 0.9 ? 1.5f * r : 100 * r);
            lc_f3_store(org, rnd_org(c, r));
            lc_node box = box_about(light, (far ? 1 : (double)r) * pow(10, rnd_in(-6, 0)));
            lc_occlusion_start(&s.at, org);
            if (!lc_occlusion_proves(&s.at, &box, rnd_n(s.occluders->n), false, far, LC_MAX_PATCH, &n_tests))
                continue;
            n_proved++;
            all_hidden(&s, org, &box, far);
        }
        unmake(&s);
    }
    CHECKF(n_proved > 5000 / SLOW, "%llu proved", (unsigned long long)n_proved);
}

/* ---- from boxes of points ---- */

static lc_point_box points_about(lc_f3 org, double size)
{
    lc_point_box b;
    float p[3];
    lc_f3_store(p, org);
    for (int k = 0; k < 3; k++) {
        b.half[k] = (float)(size * (rnd() < 0.2 ? 0 : rnd()));
        b.center[k] = accepted((float)((double)p[k] + rnd_in(-1, 1) * (double)b.half[k]));
    }
    for (int k = 0; k < 3; k++) b.half[k] = half_up_to(b.half[k], b.center[k], p[k]);
    return b;
}

/* Checks rays from corners of the box of points, from its faces and its inside. */
static void all_hidden_from(const setup *s, const lc_point_box *from, const lc_node *box, bool far)
{
    const lc_node points = { .center = { from->center[0], from->center[1], from->center[2] },
                             .half = { from->half[0], from->half[1], from->half[2] } };
    for (int i = 0; i < 6; i++) {
        float org[3];
        lc_f3_store(org, place3(&points, i < 4 ? 0 : 1));
        CHECK(lc_point_box_holds(from, org));
        all_hidden(s, org, box, far);
    }
}

/* Tries it from the triangle that occludes the light from one of the points, or from any. */
static bool proves_from(setup *s, const float org[3], const lc_point_box *from, lc_f3 light,
                        const lc_node *box, bool far)
{
    uint32_t block, by = rnd_n(s->occluders->n);
    uint64_t n_tests = 0;
    bool passed = rnd() < 0.7;
    if (passed) {
        s->light = (lc_light_rec){ .pos = { light.x, light.y, light.z } };
        if (!hidden(s, LC_ISA_SCALAR, org, light, far, &block)) return false;
        lc_occlusion_start(&s->at, org);
        lc_occlusion_note(&s->at, 0, block);
        by = lc_occlusion_by(&s->at, 0, far);
        if (by == LC_NONE) return false;
    }
    if (!lc_occlusion_proves_from(&s->at, from, box, by, passed, far, LC_MAX_PATCH, &n_tests)) return false;
    all_hidden_from(s, from, box, far);
    return true;
}

TEST(what_is_proved_from_a_box_is_hidden_from_it)
{
    static setup s;
    uint64_t n_proved = 0, n_one = 0;
    for (int style = 0; style < N_MESHES; style++) {
        lc_f3 c;
        float r, org[3];
        make_any(&s, style, &c, &r);
        for (int i = 0; i < 30000 / SLOW && s.occluders->n; i++) {
            const bool far = rnd() < 0.3;
            const lc_f3 at = rnd_org(c, r),
                        light = far ? rnd_unit() : rnd_near(c, rnd() < 0.9 ? 1.5f * r : 100 * r);
            const lc_node box = box_about(light, (far ? 1 : (double)r) * pow(10, rnd_in(-6, 0)));
            const lc_point_box from = points_about(at, (double)r * pow(10, rnd_in(-6, 0)));
            lc_f3_store(org, at);
            n_proved += proves_from(&s, org, &from, light, &box, far);
            n_one += lc_f3_max_abs(lc_f3_load(from.half)) > 0.01f * r;
        }
        unmake(&s);
    }
    printf("  %llu proved\n", (unsigned long long)n_proved);
    CHECKF(n_proved > 20000 / SLOW && n_one, "%llu proved", (unsigned long long)n_proved);
}

/* Points about the height above a wall at which lights just below it are stopped no more. */
TEST(proofs_from_boxes_at_grazing_planes)
{
    static setup s;
    uint64_t n_proved = 0;
    for (int i = 0; i < 4000 / SLOW; i++) {
        lc_f3 c = rnd_near(zero, 2), n = rnd_unit(), x = lc_f3_normalize(lc_f3_cross(n, rnd_unit()));
        lc_f3 y = lc_f3_cross(n, x), top = lc_f3_add(c, lc_f3_scale(x, 2)), up = lc_f3_scale(y, 3);
        clear();
        put_three(lc_f3_add(c, lc_f3_scale(x, -3)), lc_f3_add(top, up), lc_f3_sub(top, up));
        make(&s);
        for (int k = 0; k < 40; k++) {
            float org[3], height = powf(10, (float)rnd_in(-5, -2)), r = 0.5f * (float)rnd_in(0.1, 1);
            lc_f3 at = lc_f3_add(c, lc_f3_scale(rnd_unit(), 0.3f));
            at = lc_f3_add(at, lc_f3_scale(n, height - lc_f3_dot(lc_f3_sub(at, c), n)));
            lc_f3_store(org, at);
            float below = height * (1 + (float)pow(10, rnd_in(-4, 0)));
            lc_f3 along = lc_f3_normalize(lc_f3_cross(n, rnd_unit()));
            lc_f3 light = lc_f3_add(lc_f3_add(at, lc_f3_scale(along, r)), lc_f3_scale(n, -below));
            const lc_node box = box_about(light, (double)height * pow(10, rnd_in(-6, -1)));
            const lc_point_box from = points_about(at, (double)height * pow(10, rnd_in(-5, 0.5)));
            n_proved += proves_from(&s, org, &from, light, &box, false);
        }
        unmake(&s);
    }
    printf("  %llu proved\n", (unsigned long long)n_proved);
    CHECK(n_proved > 2000 / SLOW);
}

/* Light boxes and boxes of points at the silhouette of a wall, where the products of both sizes decide. */
TEST(proofs_from_boxes_at_an_edge)
{
    static setup s;
    uint64_t n_proved = 0, n_tried = 0;
    for (int i = 0; i < 2000 / SLOW; i++) {
        lc_f3 a = rnd_near(zero, 1), b = rnd_near(zero, 1), d = rnd_near(zero, 1);
        clear();
        put_three(a, b, d);
        make(&s);
        for (int k = 0; k < 60 && s.occluders->n; k++) {
            float org[3], u = (float)pow(10, rnd_in(-4, 0)) * 0.3f, t = (float)rnd_in(0.2, 3);
            lc_f3 in = lc_f3_add(lc_f3_add(lc_f3_scale(a, 0.5f - u / 2), lc_f3_scale(b, 0.5f - u / 2)),
                                 lc_f3_scale(d, u));
            lc_f3 at = rnd_near(in, 2), light = lc_f3_add(in, lc_f3_scale(lc_f3_sub(in, at), t));
            lc_f3_store(org, at);
            const double size = (double)u * pow(10, rnd_in(-1.5, 0.3));
            const lc_node box = box_about(light, size * pow(10, rnd_in(-2, 0)));
            const lc_point_box from = points_about(at, size * pow(10, rnd_in(-2, 0)));
            n_tried++;
            n_proved += proves_from(&s, org, &from, light, &box, false);
        }
        unmake(&s);
    }
    printf("  %llu of %llu proved\n", (unsigned long long)n_proved, (unsigned long long)n_tried);
    CHECK(n_proved > n_tried / 50 && n_proved < n_tried);
}

/* ---- known cases ---- */

static lc_node box_at(float x, float y, float z, float half)
{
    return (lc_node){ .center = { x, y, z }, .half = { half, half, half } };
}

static bool proves(setup *s, lc_f3 from, const lc_node *box, bool far)
{
    float org[3];
    tally t = { 0, 0, 0 };
    lc_f3_store(org, from);
    return try(s, org, lc_f3_load(box->center), box, far, &t);
}

/* A wall of n x n squares in the plane z = 0 from -1 to 1; apart: each square has its own vertices. */
static void wall(uint32_t n, bool apart)
{
    clear();
    for (uint32_t i = 0; i < n * n; i++) {
        float x[2], y[2]; /* of the sides, with the bits that the neighbours have */
        for (uint32_t k = 0; k < 2; k++) {
            x[k] = 2 * (float)(i % n + k) / (float)n - 1;
            y[k] = 2 * (float)(i / n + k) / (float)n - 1;
        }
        lc_f3 a = lc_f3_make(x[0], y[0], 0), b = lc_f3_make(x[1], y[0], 0), c = lc_f3_make(x[1], y[1], 0),
              d = lc_f3_make(x[0], y[1], 0);
        if (apart) {
            put_three(a, b, c);
            put_three(a, c, d);
            continue;
        }
        uint32_t first = put_vert(a);
        put_vert(b);
        put_vert(c);
        put_vert(d);
        put_tri(first, first + 1, first + 2);
        put_tri(first, first + 2, first + 3);
    }
}

TEST(a_wall_hides_what_is_behind)
{
    static setup s;
    const lc_f3 eye = lc_f3_make(0.1f, 0.2f, 1);
    for (uint32_t n = 1; n < 4; n++)
        for (int apart = 0; apart < 2; apart++) {
            wall(n, apart);
            make(&s);
            lc_node behind = box_at(0, 0, -1, 0.5f), aside = box_at(1.5f, 0, -1, 0.5f),
                    through = box_at(0, 0, -0.2f, 0.3f);
            lc_node before = box_at(0, 0, 0.5f, 0.2f), far = box_at(0, 0, -1, 0.3f),
                    far_aside = box_at(0, 0, -1, 0.99f);
            CHECK(proves(&s, eye, &behind, false) && proves(&s, eye, &far, true));
            CHECK(!proves(&s, eye, &aside, false) && !proves(&s, eye, &through, false) &&
                  !proves(&s, eye, &before, false));
            CHECK(!proves(&s, eye, &far_aside, true));
            CHECK(!proves(&s, lc_f3_make(0.1f, 0.2f, 0), &behind, false)); /* in the wall's plane */
            unmake(&s);
        }
}

/* From a box of points a wall hides what it hides from each of them, and no more. */
TEST(a_wall_hides_from_a_box)
{
    static setup s;
    uint64_t n = 0;
    for (uint32_t sides = 1; sides < 4; sides++) {
        wall(sides, false);
        make(&s);
        const lc_node behind = box_at(0, 0, -1, 0.4f), far = box_at(0, 0, -1, 0.2f);
        const lc_point_box small = { { 0.1f, 0.2f, 1 }, { 0.3f, 0.3f, 0.1f } },
                           aside = { { 0, 0, 1 }, { 1.7f, 0.1f, 0.1f } },
                           through = { { 0, 0, 0.5f }, { 0.1f, 0.1f, 0.6f } };
        CHECK(lc_occlusion_proves_from(&s.at, &small, &behind, 0, false, false, LC_MAX_PATCH, &n));
        CHECK(lc_occlusion_proves_from(&s.at, &small, &far, 0, false, true, LC_MAX_PATCH, &n));
        CHECK(!lc_occlusion_proves_from(&s.at, &aside, &behind, 0, false, false, LC_MAX_PATCH, &n));
        CHECK(!lc_occlusion_proves_from(&s.at, &aside, &far, 0, false, true, LC_MAX_PATCH, &n));
        CHECK(!lc_occlusion_proves_from(&s.at, &through, &behind, 0, false, false, LC_MAX_PATCH, &n));
        unmake(&s);
    }
}

/* Triangles that share edges around a gap occlude nothing behind the gap; nor do they where the gap is filled
 * by a triangle with holes. */
TEST(a_gap_is_seen)
{
    static setup s;
    const lc_f3 eye = lc_f3_make(0.05f, 0.04f, 1);
    const lc_node box = box_at(0, 0, -1, 0.2f);
    wall(3, true);
    make(&s);
    CHECK(proves(&s, eye, &box, false));
    unmake(&s);
    uint32_t in_the_middle = 8; /* with 9 the square in the middle */
    uint32_t holes[1] = { 1u << in_the_middle };
    const lc_occluders_desc desc = { m.pos, m.index, m.n_tris, holes };
    make(&s);
    lc_occluders_destroy(s.occluders);
    if (lc_occluders_build(ctx, &desc, &s.occluders)) abort();
    CHECK(s.occluders->n == m.n_tris - 1 && lc_occluder_of(s.occluders, in_the_middle) == LC_NONE);
    for (uint32_t t = 0, n = 0; t < m.n_tris; t++)
        if (t != in_the_middle) CHECK(lc_occluder_of(s.occluders, t) == n++);
    CHECK(lc_occluder_of(s.occluders, m.n_tris) == LC_NONE &&
          lc_occluder_of(s.occluders, 1u << 30) == LC_NONE);
    s.bvh->occluders = s.occluders;
    const lc_visibility visibility = lc_bvh_visibility(s.bvh);
    lc_occlusion_init(&s.at, &visibility, &s.tree);
    CHECK(!proves(&s, eye, &box, false));
    unmake(&s);
    memmove(m.index + 3 * in_the_middle, m.index + 3 * in_the_middle + 3,
            3 * (m.n_tris - in_the_middle - 1) * sizeof *m.index);
    m.n_tris--;
    make(&s);
    CHECK(!proves(&s, eye, &box, false));
    unmake(&s);
}

/* The edge of a fold has a triangle on both sides, but the space beyond it is not occluded. */
TEST(a_fold_hides_one_side)
{
    static setup s;
    clear();
    uint32_t a = put_vert(lc_f3_make(0, -1, 0)), b = put_vert(lc_f3_make(0, 1, 0));
    uint32_t c = put_vert(lc_f3_make(-2, 0, 0)), d = put_vert(lc_f3_make(-2, 0, -0.5f));
    put_tri(a, b, c);
    put_tri(b, a, d);
    make(&s);
    CHECK(s.occluders->all[0].next[0] == 1 && s.occluders->all[1].next[0] == 0);
    lc_node within = box_at(-1, 0, -2, 0.05f), across = box_at(0, 0, -2, 0.1f);
    across.center[0] = -0.05f;
    CHECK(proves(&s, lc_f3_make(-1, 0, 3), &within, false) &&
          !proves(&s, lc_f3_make(0, 0, 3), &across, false));
    unmake(&s);
}

/* Of too many triangles the largest become occluders, wherever they are in the list. */
TEST(the_largest_are_taken)
{
    const uint32_t n = 2 * LC_MAX_OCCLUDERS;
    float *pos = malloc(9 * (size_t)n * sizeof *pos), *size = malloc(n * sizeof *size), least = INFINITY,
          most = 0;
    uint32_t *index = malloc(3 * (size_t)n * sizeof *index), n_taken = 0;
    lc_occluders *o;
    for (uint32_t t = 0; t < n; t++) {
        size[t] = (float)pow(10, rnd_in(-3, 1));
        for (uint32_t k = 0; k < 9; k++)
            pos[9 * (size_t)t + k] = (float)(t % 1000) + (k == 3 || k == 7 ? size[t] : 0);
        for (uint32_t k = 0; k < 3; k++) index[3 * t + k] = 3 * t + k;
    }
    const lc_occluders_desc desc = { pos, index, n, NULL };
    if (lc_occluders_build(ctx, &desc, &o)) abort();
    for (uint32_t t = 0; t < n; t++) {
        uint32_t i = lc_occluder_of(o, t);
        if (i == LC_NONE) {
            most = fmaxf(most, size[t]);
            continue;
        }
        CHECK(i == n_taken++ && !memcmp(&o->all[i].v[0][0], &pos[9 * (size_t)t], sizeof *pos));
        least = fminf(least, size[t]);
    }
    CHECKF(n_taken == o->n && n_taken <= LC_MAX_OCCLUDERS &&
               n_taken > LC_MAX_OCCLUDERS - LC_MAX_OCCLUDERS / 50,
           "%u taken", n_taken);
    CHECKF(least > 0.99f * most, "taken down to %g, left up to %g", (double)least, (double)most);
    lc_occluders_destroy(o);
    free(pos);
    free(size);
    free(index);
}

int main(void)
{
    ctx = quiet_context(0);
    printf("seed %llu, best %s\n", (unsigned long long)rng_key, lc_isa_name(lc_isa_pick(LC_ISA_BEST)));
    RUN(every_instruction_set_is_here);
    RUN(a_wall_hides_what_is_behind);
    RUN(a_gap_is_seen);
    RUN(a_fold_hides_one_side);
    RUN(the_largest_are_taken);
    RUN(what_is_proved_hidden_is_hidden);
    RUN(proofs_at_grazing_planes);
    RUN(a_proof_may_begin_at_any_triangle);
    RUN(what_is_proved_from_a_box_is_hidden_from_it);
    RUN(proofs_from_boxes_at_grazing_planes);
    RUN(proofs_from_boxes_at_an_edge);
    RUN(a_wall_hides_from_a_box);
    lc_context_destroy(ctx);
    return test_done();
}
