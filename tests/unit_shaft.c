/* unit_shaft.c - proofs that a box is visible from a block of points: where one succeeds, shadow rays from
 * all the points to places all over the box, to its corners and faces first, are all free. Boxes for which
 * the answer is known are proved, or not proved, as they should be. */
#include "support/isas.h"
#include "support/logged.h"
#include "trace/shaft.h"

#define RND_KEY 20210
#include "support/meshes.h"

static lc_context *ctx;

typedef struct {
    float center[3], half[3];
    bool far;
} target_box;

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

/* A point of the box. corner: 0 .. 7, or more for one on a face or inside. */
static void place3(const target_box *b, uint32_t corner, float p[3])
{
    for (uint32_t k = 0; k < 3; k++) {
        double where = corner < 8 ? (corner >> k & 1 ? 1 : -1)
                                  : rnd() < 0.3 ? (rnd() < 0.5 ? -1 : 1) : rnd_in(-1, 1);
        p[k] = place(b->center[k], b->half[k], where);
    }
}

static void set_box(target_box *b, lc_f3 center, float half, bool far)
{
    lc_f3_store(b->center, center);
    for (int k = 0; k < 3; k++) b->half[k] = half;
    b->far = far;
}

/* Extends a box to a point. */
static void extend(target_box *b, const float p[3])
{
    for (int k = 0; k < 3; k++)
        while (!in_box(p[k], b->center[k], b->half[k])) {
            float off = fabsf(p[k] - b->center[k]);
            b->half[k] = off > b->half[k] ? off : nextafterf(b->half[k], INFINITY);
        }
}

typedef struct {
    uint64_t boxes, proved, rays, open, missed; /* open: not proved, and no random ray was hidden */
    lc_shaft_work work;
} tally;

static bool hidden(const lc_bvh_data *bvh, lc_isa isa, const float org[3], const float to[3], bool far)
{
    const float *const target[3] = { &to[0], &to[1], &to[2] };
    uint8_t out[LC_LANES];
    lc_isa_kernels(isa)->trace.hidden(bvh, org, 1, target, far, out, NULL);
    return out[0];
}

/* Rays from all points to corners, faces and the inside of a box are free. */
static void all_free(const lc_bvh_data *bvh, const lc_shaft_from *from, const target_box *b, tally *t)
{
    float to[3][32];
    const float *const target[3] = { to[0], to[1], to[2] };
    for (uint32_t i = 0; i < 32; i++) {
        float p[3];
        place3(b, i, p);
        for (int k = 0; k < 3; k++) to[k][i] = p[k];
    }
    for (uint32_t o = 0; o < from->n; o++) {
        uint8_t out[32 + LC_LANES];
        uint64_t loss[32][3];
        const lc_isa isa = isa_in_turn(t->rays / 32);
        lc_isa_kernels(isa)->trace.dimmed(bvh, from->org[o], 32, target, b->far, out, NULL, loss);
        t->rays += 32;
        for (uint32_t i = 0; i < 32; i++)
            CHECKF(!out[i] && !(loss[i][0] | loss[i][1] | loss[i][2]), "%s%s: org %a %a %a, to %a %a %a",
                   lc_isa_name(isa), b->far ? " far" : "", (double)from->org[o][0], (double)from->org[o][1],
                   (double)from->org[o][2], (double)to[0][i], (double)to[1][i], (double)to[2][i]);
    }
}

/* Whether n random rays into the box are all free. */
static bool looks_free(const lc_bvh_data *bvh, const lc_shaft_from *from, const target_box *b, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        float to[3];
        place3(b, i, to);
        if (hidden(bvh, lc_isa_pick(LC_ISA_BEST), from->org[rnd_n(from->n)], to, b->far)) return false;
    }
    return true;
}

/* Tries to prove a box, from the root and from the list of a larger one, and checks the proof. */
static bool try(const lc_bvh_data *bvh, const lc_shaft_from *from, const target_box *b, tally *t)
{
    lc_shaft_list list, other;
    lc_shaft_work work = { 0 };
    bool proved = lc_shaft_open(bvh, from, b->center, b->half, b->far, NULL, &list, &t->work);
    CHECK(proved == !list.n && list.n <= LC_SHAFT_LIST);
    target_box larger = *b;
    for (int i = 0; i < 2; i++) {
        float p[3] = { 0, 0, 0 };
        for (int k = 0; k < 3; k++) {
            p[k] = b->center[k] + (float)rnd_in(-2, 2) * b->half[k];
            if (!b->far && !(fabsf(p[k]) <= LC_SHAFT_POINTS * 1e12f)) p[k] = b->center[k];
        }
        extend(&larger, p);
    }
    bool large = lc_shaft_open(bvh, from, larger.center, larger.half, b->far, NULL, &other, &work);
    CHECK(!large || proved);
    /* A list may be full, or what a search opens, for one of the two ways only. */
    if (lc_shaft_open(bvh, from, b->center, b->half, b->far, &other, &other, &work) && !proved) proved = true;
    if (proved) all_free(bvh, from, b, t);
    else if (t->boxes % 16 == 0 && looks_free(bvh, from, b, 200)) t->missed++;
    if (proved && t->boxes % 16 == 0) t->open++;
    t->boxes++;
    t->proved += proved;
    return proved;
}

/* ---- any mesh ---- */

#define N_MESHES 16

static void make_mesh(int style)
{
    static const float scale[] = { 1e-12f, 1e-6f, 1e-4f, 1e4f, 1e6f, 1e11f };
    if (style < 6) odd_mesh(style);
    else clear();
    if (style == 6) cube(1);
    if (style == 7 || style == 15) {
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
    if (style == 15) { /* and cracks, coplanar and degenerate triangles */
        for (uint32_t i = 0; i < m.n_verts; i += 5) m.pos[3 * i] = nextafterf(m.pos[3 * i], 2);
        for (uint32_t i = 0; i < 40; i++) {
            uint32_t v[3] = { rnd_n(m.n_verts), rnd_n(m.n_verts), rnd_n(m.n_verts) };
            lc_f3 a = vert(v[0]), b = vert(v[1]), c = lc_f3_scale(lc_f3_add(a, b), 0.5f);
            if (i % 4 == 0) put_three(a, a, b);
            if (i % 4 == 1) put_three(a, b, c);
            if (i % 4 == 2) put_tri(m.index[3 * i], m.index[3 * i + 1], m.index[3 * i + 2]);
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
    lc_f3 d = rnd_in_box(1);
    return lc_f3_add(c, lc_f3_scale(d, r));
}

static lc_f3 on_triangle(uint32_t tri, double u, double v)
{
    const uint32_t *t = m.index + 3 * (size_t)tri;
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    return lc_f3_add(lc_f3_scale(vert(t[0]), (float)(1 - u - v)),
                     lc_f3_add(lc_f3_scale(vert(t[1]), (float)u), lc_f3_scale(vert(t[2]), (float)v)));
}

/* A point of a triangle, moved off it on either side as scene/surface.c does. */
static lc_f3 moved_off(uint32_t tri, lc_f3 p, float side)
{
    const uint32_t *t = m.index + 3 * (size_t)tri;
    lc_f3 a = vert(t[0]), b = vert(t[1]), c = vert(t[2]);
    lc_f3 n = lc_f3_normalize(lc_f3_cross(lc_f3_sub(b, a), lc_f3_sub(c, a)));
    float size = fmaxf(lc_f3_max_abs(a), fmaxf(lc_f3_max_abs(b), lc_f3_max_abs(c)));
    return lc_f3_add(p, lc_f3_scale(n, side * 10 * 0x1p-23f * size));
}

/* A block of points: near one place, on a triangle, or on two. */
static void rnd_from(lc_shaft_from *from, lc_f3 c, float r)
{
    float org[LC_SHAFT_POINTS][3];
    const uint32_t n = rnd() < 0.3 ? 1 : 1 + rnd_n(LC_SHAFT_POINTS);
    const uint32_t tri = rnd_n(m.n_tris), two = rnd_n(m.n_tris);
    const double kind = rnd(), u = rnd(), v = rnd(), spread = pow(10, rnd_in(-5, -0.5));
    const lc_f3 at = rnd_near(c, kind < 0.1 ? 30 * r : 1.3f * r);
    const float side = rnd() < 0.5 ? -1 : 1;
    for (uint32_t i = 0; i < n; i++) {
        double du = spread * rnd(), dv = spread * rnd();
        uint32_t on = kind < 0.8 || i % 2 ? tri : two;
        lc_f3 p;
        if (kind < 0.4) p = rnd_near(at, (float)spread * r);
        else p = on_triangle(on, u * (1 - spread) + du, v * (1 - spread) + dv);
        if (kind >= 0.5) p = moved_off(on, p, side);
        lc_f3_store(org[i], p);
    }
    lc_shaft_from_init(from, org, n);
}

/* A box of lights: anywhere, on a triangle, flat, or of directions. */
static target_box rnd_box(lc_f3 c, float r)
{
    target_box b;
    const double kind = rnd(), size = pow(10, rnd_in(-5, 0));
    const uint32_t tri = rnd_n(m.n_tris);
    if (kind < 0.2) {
        set_box(&b, rnd_unit(), 0, true);
        for (int k = 0; k < 3; k++) b.half[k] = (float)(size * rnd());
        return b;
    }
    set_box(&b, rnd_near(c, kind < 0.25 ? 50 * r : 1.3f * r), 0, false);
    if (kind < 0.6)
        for (int k = 0; k < 3; k++) b.half[k] = (float)(size * (double)r * (rnd() < 0.2 ? 0 : rnd()));
    if (kind >= 0.6) { /* lights of one triangle */
        const double u = rnd(), v = rnd();
        lc_f3_store(b.center, on_triangle(tri, u, v));
        for (int i = 0; i < 4; i++) {
            float p[3];
            lc_f3_store(p, on_triangle(tri, u * (1 - size) + size * rnd(), v * (1 - size) + size * rnd()));
            extend(&b, p);
        }
    }
    return b;
}

static void print(const char *what, const tally *t)
{
    printf("  %s: %llu boxes, %llu proved, %llu rays; of those that look free %.0f %% proved; %.1f nodes, "
           "%.1f blocks\n",
           what, (unsigned long long)t->boxes, (unsigned long long)t->proved, (unsigned long long)t->rays,
           100 * (double)t->open / (double)(t->open + t->missed ? t->open + t->missed : 1),
           (double)t->work.nodes / (double)t->work.shafts, (double)t->work.blocks / (double)t->work.shafts);
}

TEST(what_is_proved_visible_is_visible)
{
    uint64_t rays = 0, proved = 0, boxes = 0;
    for (int style = 0; style < N_MESHES; style++) {
        tally t = { 0 };
        char name[32];
        lc_f3 c;
        float r;
        make_mesh(style);
        extent(&c, &r);
        lc_bvh *bvh = build_bvh(ctx);
        for (int i = 0; i < 20000 / SLOW; i++) {
            lc_shaft_from from;
            rnd_from(&from, c, r);
            target_box b = rnd_box(c, r);
            try(&bvh->data, &from, &b, &t);
        }
        snprintf(name, sizeof name, "mesh %2d", style);
        print(name, &t);
        rays += t.rays;
        proved += t.proved;
        boxes += t.boxes;
        lc_bvh_destroy(bvh);
    }
    CHECKF(rays >= 1000000 / SLOW && proved > boxes / 10, "%llu rays", (unsigned long long)rays);
}

int main(void)
{
    ctx = quiet_context(0);
    printf("seed %llu, best %s\n", (unsigned long long)rng_key, lc_isa_name(lc_isa_pick(LC_ISA_BEST)));
    RUN(every_instruction_set_is_here);
    RUN(what_is_proved_visible_is_visible);
    lc_context_destroy(ctx);
    return test_done();
}
