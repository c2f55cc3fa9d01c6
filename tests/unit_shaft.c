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
static void all_free(const lc_bvh_data *bvh, lc_shaft_from *from, const target_box *b, tally *t)
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
static bool looks_free(const lc_bvh_data *bvh, lc_shaft_from *from, const target_box *b, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        float to[3];
        place3(b, i, to);
        if (hidden(bvh, lc_isa_pick(LC_ISA_BEST), from->org[rnd_n(from->n)], to, b->far)) return false;
    }
    return true;
}

/* Tries to prove a box, from the root and from the list of a larger one, and checks the proof. */
static bool try(const lc_bvh_data *bvh, lc_shaft_from *from, const target_box *b, tally *t)
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
    /* Planes of the larger shaft may prove by an ulp what those of the smaller one do not. */
    bool of_list = lc_shaft_open(bvh, from, b->center, b->half, b->far, &other, &other, &work);
    CHECK(of_list || !large);
    proved |= of_list;
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

/* ---- where proofs end ---- */

/* Boxes as tight as they can be: the builder's are padded. */
static void unpad(lc_bvh *bvh)
{
    for (uint32_t n = 0; n < bvh->data.n_nodes; n++)
        for (uint32_t i = 0; i < 8; i++) {
            const uint32_t child = bvh->nodes[n].child[i];
            if (child == LC_NONE || !(child & LC_BVH_LEAF)) continue;
            const lc_tri_block *b = &bvh->blocks[child & ~LC_BVH_LEAF];
            for (int k = 0; k < 3; k++) {
                float lo = INFINITY, hi = -INFINITY;
                for (int v = 0; v < 3; v++)
                    for (int t = 0; t < 8; t++) {
                        if (b->tri[t] == LC_NONE) continue;
                        lo = fminf(lo, b->v[v][k][t]);
                        hi = fmaxf(hi, b->v[v][k][t]);
                    }
                bvh->nodes[n].lo[k][i] = lo;
                bvh->nodes[n].hi[k][i] = hi;
            }
        }
}

static bool proves(const lc_bvh_data *bvh, lc_shaft_from *from, const target_box *b, tally *t)
{
    lc_shaft_list list;
    return lc_shaft_open(bvh, from, b->center, b->half, b->far, NULL, &list, &t->work);
}

/* The box a fraction of the way from one to another. */
static target_box between(const target_box *a, const target_box *b, double s)
{
    target_box c = *a;
    for (int k = 0; k < 3; k++) {
        c.center[k] = (float)((double)a->center[k] + s * ((double)b->center[k] - (double)a->center[k]));
        c.half[k] = (float)((double)a->half[k] + s * ((double)b->half[k] - (double)a->half[k]));
    }
    return c;
}

/* Moves a box that is proved towards one that is not, as far as the proof goes, and asks rays there. */
static void to_the_border(const lc_bvh_data *bvh, lc_shaft_from *from, const target_box *a,
                          const target_box *b, tally *t)
{
    double proved = 0, not = 1;
    t->boxes++;
    if (!proves(bvh, from, a, t) || proves(bvh, from, b, t)) return;
    t->proved++;
    for (int i = 0; i < 50; i++) {
        const double s = 0.5 * (proved + not);
        const target_box c = between(a, b, s);
        if (proves(bvh, from, &c, t)) proved = s;
        else not = s;
    }
    const target_box c = between(a, b, proved);
    all_free(bvh, from, &c, t);
}

/* A triangle: any, one with an edge along an axis, one in a plane of two axes, or a needle. */
static void border_triangle(int style)
{
    lc_f3 p[3];
    float x[3][3];
    for (int i = 0; i < 3; i++) {
        p[i] = rnd_in_box(1);
        if (style == 3 && i == 2) p[2] = lc_f3_add(p[0], lc_f3_scale(rnd_unit(), 1e-5f));
        lc_f3_store(x[i], p[i]);
    }
    const uint32_t axis = rnd_n(3), other = (axis + 1) % 3;
    if (style == 1) x[1][axis] = x[0][axis], x[1][other] = x[0][other];
    if (style == 2) x[1][axis] = x[2][axis] = x[0][axis];
    put_three(lc_f3_load(x[0]), lc_f3_load(x[1]), lc_f3_load(x[2]));
}

TEST(proofs_end_before_rays_do)
{
    tally t = { 0 };
    for (int i = 0; i < 60000 / SLOW; i++) {
        clear();
        border_triangle(i % 4);
        if (i % 8 > 3) border_triangle(i % 3);
        lc_bvh *bvh = build_bvh(ctx);
        if (i % 16 > 7) unpad(bvh);
        float org[LC_SHAFT_POINTS][3];
        const uint32_t n = rnd() < 0.7 ? 1 : 2 + rnd_n(3);
        const lc_f3 on = on_triangle(0, rnd(), rnd());
        const bool close = rnd() < 0.3; /* as near to the triangle as hits do not count */
        const lc_f3 at = close ? rnd_near(on, powf(10, (float)rnd_in(-5, -3))) : rnd_in_box(3);
        for (uint32_t k = 0; k < n; k++) lc_f3_store(org[k], k ? rnd_near(at, 0.01f) : at);
        lc_shaft_from from;
        lc_shaft_from_init(&from, (const float (*)[3])org, n);
        /* From somewhere to where rays through the triangle end, or to its far side, or by growing. */
        target_box a, b;
        const bool far = rnd() < 0.2;
        const lc_f3 to = lc_f3_sub(on, at);
        set_box(&a, far ? rnd_unit() : rnd_in_box(3), 0, far);
        for (int k = 0; k < 3; k++) a.half[k] = rnd() < 0.2 ? 0 : powf(10, (float)rnd_in(-6, 0));
        b = a;
        if (far) lc_f3_store(b.center, lc_f3_normalize(close ? rnd_unit() : to));
        else lc_f3_store(b.center, lc_f3_add(at, close ? rnd_unit() : lc_f3_scale(to, (float)rnd_in(1, 3))));
        if (rnd() < 0.3) {
            for (int k = 0; k < 3; k++) {
                b.half[k] = a.half[k] + fabsf(b.center[k] - a.center[k]);
                b.center[k] = a.center[k];
            }
        }
        to_the_border(&bvh->data, &from, &a, &b, &t);
        lc_bvh_destroy(bvh);
    }
    print("border", &t);
    CHECK(t.proved > 10000 / SLOW);
}

/* Targets as close before a wall's plane, or behind that of a wall close to the points, as hits do not count.
 */
TEST(proofs_at_the_ends_of_rays)
{
    tally t = { 0 };
    for (int i = 0; i < 60000 / SLOW; i++) {
        const lc_f3 n = rnd_unit(), x = lc_f3_normalize(lc_f3_cross(n, rnd_unit())), y = lc_f3_cross(n, x);
        const lc_f3 c = rnd_in_box(3);
        float org[1][3];
        clear();
        const lc_f3 top = lc_f3_add(c, lc_f3_scale(x, 60)), up = lc_f3_scale(y, 99);
        put_three(lc_f3_add(c, lc_f3_scale(x, -90)), lc_f3_add(top, up), lc_f3_sub(top, up));
        lc_bvh *bvh = build_bvh(ctx);
        const bool near = i % 2;
        const float height = near ? powf(10, (float)rnd_in(-6, -3)) : 1;
        lc_f3_store(org[0], lc_f3_add(c, lc_f3_scale(n, height)));
        lc_shaft_from from;
        lc_shaft_from_init(&from, (const float (*)[3])org, 1);
        const lc_f3 beside = lc_f3_add(c, lc_f3_add(lc_f3_scale(x, (float)rnd_in(-2, 2)),
                                                    lc_f3_scale(y, (float)rnd_in(-2, 2))));
        /* t is height / (height + below): around 1 - LC_SHADOW_EPS, or around LC_SHADOW_EPS. */
        target_box a, b;
        const float half = powf(10, (float)rnd_in(-7, -5)) * (float)(rnd() < 0.3 ? 0 : 1);
        set_box(&a, lc_f3_add(beside, lc_f3_scale(n, near ? -2e4f * height : 0.01f)), half, false);
        set_box(&b, lc_f3_add(beside, lc_f3_scale(n, near ? -2e3f * height : -0.01f)), half, false);
        to_the_border(&bvh->data, &from, &a, &b, &t);
        lc_bvh_destroy(bvh);
    }
    print("ends", &t);
    CHECK(t.proved > 30000 / SLOW);
}

/* Needles along the rays' line, beyond the targets or behind the points: their normals are noise, and so is
 * where rays meet their planes. */
TEST(proofs_beside_noise)
{
    tally t = { 0 };
    for (int i = 0; i < 100000 / SLOW; i++) {
        const lc_f3 from_at = rnd_in_box(1), to = rnd_in_box(1), d = lc_f3_sub(to, from_at);
        const float off = powf(10, (float)rnd_in(-8, -3)), wide = i % 3 ? off : 0.3f;
        float org[1][3];
        clear();
        for (int k = 0; k < 4; k++) {
            lc_f3 p[3];
            const bool beyond = rnd() < 0.5;
            const lc_f3 aside = lc_f3_scale(rnd_unit(), wide);
            for (int v = 0; v < 3; v++) {
                const float s = (float)(beyond ? rnd_in(1.01, 3) : rnd_in(-2, -0.01));
                p[v] = lc_f3_add(rnd_near(lc_f3_add(from_at, lc_f3_scale(d, s)), off),
                                 lc_f3_scale(aside, (float)rnd_in(-1, 1)));
            }
            put_three(p[0], p[1], p[2]);
        }
        lc_bvh *bvh = build_bvh(ctx);
        lc_f3_store(org[0], rnd_near(from_at, off));
        lc_shaft_from from;
        lc_shaft_from_init(&from, (const float (*)[3])org, 1);
        target_box b;
        set_box(&b, to, off * (float)rnd_in(0, 2), false);
        try(&bvh->data, &from, &b, &t);
        set_box(&b, d, off * (float)rnd_in(0, 2), true);
        try(&bvh->data, &from, &b, &t);
        lc_bvh_destroy(bvh);
    }
    print("noise", &t);
    CHECK(t.proved > 1000 / SLOW);
}

/* A box so large that the place of its near face is rounded, and the edge of a triangle beside that face. */
TEST(proofs_beside_a_large_box)
{
    tally t = { 0 };
    for (int i = 0; i < 60000 / SLOW; i++) {
        const uint32_t axis = rnd_n(3), up = (axis + 1) % 3, along = (axis + 2) % 3;
        const float size = powf(10, (float)rnd_in(0, 3));
        float org[1][3], v[3][3];
        target_box a, b;
        lc_f3_store(org[0], rnd_in_box(1));
        org[0][axis] = (float)rnd_in(0.2, 0.4);
        for (int k = 0; k < 3; k++) {
            v[k][axis] = k == 2 ? -1 : 0.3f * (float)rnd();
            v[k][up] = (float)rnd_in(-9, 9);
            v[k][along] = (float)rnd_in(2.8, 2.99);
        }
        v[1][axis] = v[0][axis];
        v[1][along] = v[0][along];
        v[0][up] = -30;
        v[1][up] = 30;
        clear();
        put_three(lc_f3_load(v[0]), lc_f3_load(v[1]), lc_f3_load(v[2]));
        lc_bvh *bvh = build_bvh(ctx);
        if (i % 2) unpad(bvh);
        set_box(&a, zero, 0, false);
        a.center[axis] = size;
        a.center[along] = 3;
        a.half[axis] = size - 0.5f;
        a.half[up] = 0.1f * (float)rnd();
        b = a;
        b.half[axis] = size + 0.5f;
        lc_shaft_from from;
        lc_shaft_from_init(&from, (const float (*)[3])org, 1);
        to_the_border(&bvh->data, &from, &a, &b, &t);
        lc_bvh_destroy(bvh);
    }
    print("large", &t);
    CHECK(t.proved > 30000 / SLOW);
}

/* ---- known cases ---- */

static bool proves_at(const lc_bvh *bvh, lc_f3 from_at, lc_f3 center, float half, bool far)
{
    tally t = { 0 };
    lc_shaft_from from;
    target_box b;
    float org[1][3];
    lc_f3_store(org[0], from_at);
    lc_shaft_from_init(&from, (const float (*)[3])org, 1);
    set_box(&b, center, half, far);
    return try(&bvh->data, &from, &b, &t);
}

/* A square in the plane z from -r to r. */
static void square(float z, float r)
{
    const uint32_t first = put_vert(lc_f3_make(-r, -r, z));
    put_vert(lc_f3_make(r, -r, z));
    put_vert(lc_f3_make(r, r, z));
    put_vert(lc_f3_make(-r, r, z));
    put_tri(first, first + 1, first + 2);
    put_tri(first, first + 2, first + 3);
}

TEST(a_wall_stands_between_or_beside)
{
    clear();
    square(0, 1);
    lc_bvh *bvh = build_bvh(ctx);
    const lc_f3 eye = lc_f3_make(0.1f, 0.2f, 1), down = lc_f3_make(0, 0, -1), up = lc_f3_make(0, 0, 1);
    CHECK(!proves_at(bvh, eye, lc_f3_make(0, 0, -1), 0.1f, false));
    CHECK(!proves_at(bvh, eye, lc_f3_make(0, 0, -1), 5, false));
    CHECK(!proves_at(bvh, eye, lc_f3_make(1.8f, 0, -1), 0.3f, false)); /* an edge is in the shaft */
    CHECK(proves_at(bvh, eye, lc_f3_make(3, 0, -1), 0.3f, false));
    CHECK(proves_at(bvh, eye, lc_f3_make(0, 0, 0.5f), 0.4f, false));
    CHECK(proves_at(bvh, eye, lc_f3_make(0, 0, 2), 1.9f, false));
    CHECK(!proves_at(bvh, eye, lc_f3_make(0, 0, 2), 2.1f, false));
    CHECK(proves_at(bvh, eye, up, 0.5f, true) && !proves_at(bvh, eye, down, 0.5f, true));
    CHECK(proves_at(bvh, eye, lc_f3_make(1, 0, -0.3f), 0.1f, true));
    /* On the wall, on either side of it and a little under it, hits do not count near the start. */
    for (int side = -1; side < 2; side++) {
        const lc_f3 on = lc_f3_make(0.3f, 0.2f, (float)side * 1e-6f);
        CHECK(proves_at(bvh, on, lc_f3_make(0, 0, 1), 0.9f, false));
        CHECK(proves_at(bvh, on, lc_f3_make(0, 0, -1), 0.9f, false));
    }
    CHECK(proves_at(bvh, lc_f3_make(0, 0, 1e-6f), up, 0.9f, true));
    /* Lights on the wall, and a little behind it. */
    CHECK(proves_at(bvh, eye, lc_f3_make(0.3f, 0.3f, 0), 0, false));
    CHECK(proves_at(bvh, eye, lc_f3_make(0.3f, 0.3f, 0), 0.9e-4f, false));
    CHECK(!proves_at(bvh, eye, lc_f3_make(0.3f, 0.3f, 0), 1.2e-4f, false));
    lc_bvh_destroy(bvh);
}

/* A tree of boxes, each within its parent, from the lists of their parents. */
TEST(lists_serve_what_is_below)
{
    clear();
    cornell();
    soup(200, 0.1);
    lc_bvh *bvh = build_bvh(ctx);
    tally t = { 0 };
    uint64_t same = 0, all = 0;
    for (int i = 0; i < 2000 / SLOW; i++) {
        lc_shaft_from from;
        lc_shaft_list list, whole;
        rnd_from(&from, zero, 1);
        target_box b;
        set_box(&b, rnd_in_box(0.5), 0.5f, false);
        bool clear = proves(&bvh->data, &from, &b, &t);
        lc_shaft_open(&bvh->data, &from, b.center, b.half, false, NULL, &list, &t.work);
        for (int depth = 0; depth < 12; depth++) {
            for (int k = 0; k < 3; k++) {
                b.half[k] *= 0.7f;
                b.center[k] += (float)rnd_in(-0.4, 0.4) * b.half[k];
            }
            bool of_list = lc_shaft_open(&bvh->data, &from, b.center, b.half, false, &list, &list, &t.work);
            bool of_root = lc_shaft_open(&bvh->data, &from, b.center, b.half, false, NULL, &whole, &t.work);
            CHECK(!clear || of_list);
            all += of_root;
            same += of_root && of_list;
            if (of_list) all_free(&bvh->data, &from, &b, &t);
            clear = of_list;
        }
    }
    printf("  %llu of %llu proved from lists\n", (unsigned long long)same, (unsigned long long)all);
    CHECK(all > 3000 / SLOW && same * 100 >= all * 99);
    lc_bvh_destroy(bvh);
}

/* ---- instances, holes, glass ---- */

TEST(instances_count)
{
    static lc_instance at[2];
    float pos[4][3], half = 1.001f;
    uint32_t index[6] = { 0, 1, 0, 2, 3, 2 };
    lc_bvh *object, *boxes, *world;
    clear();
    cube(2);
    displace(true, 0);
    object = build_bvh(ctx);
    for (int i = 0; i < 2; i++) {
        at[i] = (lc_instance){ .to_object = { 1, 0, 0, i ? -4 : 4, 0, 1, 0, 0, 0, 0, 1, 0 },
                               .to_world = { 1, 0, 0, i ? 4 : -4, 0, 1, 0, 0, 0, 0, 1, 0 } };
        for (int k = 0; k < 3; k++) {
            pos[2 * i][k] = (k ? 0 : i ? 4 : -4) - half;
            pos[2 * i + 1][k] = (k ? 0 : i ? 4 : -4) + half;
        }
    }
    if (lc_bvh_build(ctx, pos[0], index, 2, &boxes)) abort();
    const lc_placed placed = { boxes->data, at, &object->data };
    clear();
    square(-3, 10);
    world = build_bvh(ctx);
    world->data.placed = &placed;
    CHECK(!proves_at(world, lc_f3_make(0, 0, 0), lc_f3_make(6, 0, 0), 0.1f, false));
    CHECK(proves_at(world, lc_f3_make(0, 0, 0), lc_f3_make(0, 6, 0), 1, false));
    CHECK(proves_at(world, lc_f3_make(0, 0, 0), lc_f3_make(1, 0, 0), 1, false));
    CHECK(!proves_at(world, lc_f3_make(0, 0, 0), lc_f3_make(-1, 0, 0), 0.1f, true));
    CHECK(proves_at(world, lc_f3_make(0, 0, 0), lc_f3_make(0, 1, 0), 0.1f, true));
    tally t = { 0 };
    for (int i = 0; i < 20000 / SLOW; i++) {
        lc_shaft_from from;
        rnd_from(&from, zero, 5);
        target_box b = rnd_box(zero, 5);
        try(&world->data, &from, &b, &t);
    }
    print("instances", &t);
    CHECK(t.proved > 2000 / SLOW);
    lc_bvh_destroy(world);
    lc_bvh_destroy(boxes);
    lc_bvh_destroy(object);
}

static bool passes(const void *user, const struct lc_hit *hit, const float dir[3], uint64_t loss[3])
{
    (void)user;
    (void)hit;
    (void)dir;
    loss[0] = loss[1] = loss[2] = 1;
    return false;
}

TEST(glass_is_not_proved)
{
    static uint32_t bits[MAX_TRIS / 32 + 1];
    const lc_alpha alpha = { bits, NULL, passes, NULL };
    memset(bits, 0xff, sizeof bits);
    clear();
    cornell();
    lc_bvh *bvh = build_bvh(ctx);
    bvh->data.alpha = &alpha;
    tally t = { 0 };
    for (int i = 0; i < 20000 / SLOW; i++) {
        lc_shaft_from from;
        rnd_from(&from, zero, 1);
        target_box b = rnd_box(zero, 1);
        try(&bvh->data, &from, &b, &t);
    }
    print("glass", &t);
    CHECK(t.proved > 2000 / SLOW && !proves_at(bvh, zero, lc_f3_make(0, 5, 0), 0.1f, false));
    lc_bvh_destroy(bvh);
}

int main(void)
{
    ctx = quiet_context(0);
    printf("seed %llu, best %s\n", (unsigned long long)rng_key, lc_isa_name(lc_isa_pick(LC_ISA_BEST)));
    RUN(every_instruction_set_is_here);
    RUN(a_wall_stands_between_or_beside);
    RUN(lists_serve_what_is_below);
    RUN(instances_count);
    RUN(glass_is_not_proved);
    RUN(what_is_proved_visible_is_visible);
    RUN(proofs_end_before_rays_do);
    RUN(proofs_at_the_ends_of_rays);
    RUN(proofs_beside_noise);
    RUN(proofs_beside_a_large_box);
    lc_context_destroy(ctx);
    return test_done();
}
