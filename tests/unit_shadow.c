/* unit_shadow.c - shadow rays of one origin, which are traced in groups: by every instruction set each ray
 * must get the answer, and the occluding block, that plain C gives for the ray alone. (unit_bvh.c compares
 * single rays with a reference.) */
#include "shade/light.h"
#include "support/isas.h"
#include "support/logged.h"

#define RND_KEY 88001
#include "support/meshes.h"

#define MOST 200 /* rays in a group */
#define GUARD 16  /* bytes after the answers, rounded up to LC_LANES, that must not be written */

static lc_context *ctx;

/* Fans of long slivers that cross each other and share corners and edges; every third is parallel to an axis.
 */
static void slivers(void)
{
    for (int i = 0; i < 60; i++) {
        lc_f3 d = i % 3 ? rnd_unit() : lc_f3_make(i % 9 == 0, i % 9 == 3, i % 9 == 6),
              p = lc_f3_scale(rnd_unit(), 0.5f);
        lc_f3 side = lc_f3_scale(rnd_unit(), powf(10, (float)rnd_in(-6, -1)));
        uint32_t a = put_vert(lc_f3_sub(p, lc_f3_scale(d, 50))),
                 b = put_vert(lc_f3_add(p, lc_f3_scale(d, 50)));
        uint32_t last = put_vert(lc_f3_add(p, side));
        put_tri(a, b, last);
        for (int k = 0; k < 5; k++) {
            uint32_t next = put_vert(lc_f3_add(vert(last), lc_f3_add(side, lc_f3_scale(rnd_unit(), 1e-7f))));
            put_tri(k % 2 ? a : b, last, next);
            last = next;
        }
    }
}

#define N_MESHES 16

static void make_mesh(int style)
{
    static const float scale[] = { 1e-12f, 1e-10f, 1e-7f, 1e4f, 1e11f, 1e12f };
    clear();
    if (style < 6) odd_mesh(style);
    else if (style == 6) slivers();
    else if (style == 7) {
        slivers();
        move(1e3f, lc_f3_make(1e4f, 0, -1e4f));
    } else if (style < 14) {
        cornell();
        soup(100, 0.5);
        move(scale[style - 8], zero);
    } else if (style == 14) {
        slivers();
        move(1e10f, zero);
    } else soup(2, 1);
}

typedef struct group {
    float org[3], target[3][MOST];
    uint32_t n;
    bool far;
} group;

/* The nearest point that a scene may contain. */
static lc_f3 accepted(lc_f3 p)
{
    const float most = LC_MAX_COORD;
    return lc_f3_make(fmaxf(-most, fminf(p.x, most)), fmaxf(-most, fminf(p.y, most)),
                      fmaxf(-most, fminf(p.z, most)));
}

static lc_f3 rnd_point(lc_f3 c, float r)
{
    return lc_f3_add(c, lc_f3_make((float)rnd_in(-1, 1) * r, (float)rnd_in(-1, 1) * r,
                                   (float)rnd_in(-1, 1) * r));
}

/* A point of a triangle: 0 a corner, 1 the middle of an edge, 2 on an edge, 3 inside. */
static lc_f3 rnd_on(int where)
{
    const uint32_t *t = m.index + 3 * (size_t)rnd_n(m.n_tris), k = rnd_n(3);
    lc_f3 p = vert(t[k]), q = vert(t[(k + 1) % 3]), r = vert(t[(k + 2) % 3]);
    float u = (float)rnd(), v = (float)rnd() * (1 - u);
    if (where == 0) return p;
    if (where == 1) return lc_f3_scale(lc_f3_add(p, q), 0.5f);
    if (where == 2) v = 0;
    return lc_f3_add(lc_f3_scale(p, 1 - u - v), lc_f3_add(lc_f3_scale(q, u), lc_f3_scale(r, v)));
}

/* Along one or two axes: the other components are 0, of either sign. */
static lc_f3 rnd_axis(float r)
{
    float d[3];
    uint32_t axis = rnd_n(3);
    bool two = rnd() < 0.3;
    for (uint32_t k = 0; k < 3; k++) {
        float l = r * (float)rnd_in(-3, 3);
        d[k] = k == axis || (two && k == (axis + 1) % 3) ? l : l < 0 ? -0.0f : 0;
    }
    return lc_f3_load(d);
}

#define N_STYLES 7

/* The end of a ray. r: size of the scene; at: a point that all rays of the group share. */
static lc_f3 rnd_target(int style, lc_f3 o, lc_f3 c, lc_f3 at, float r)
{
    if (style == 0) return rnd_point(c, 1.5f * r);
    if (style == 1) return rnd_point(at, 0.02f * r);
    if (style == 2) return rnd_on((int)rnd_n(4)); /* the ray ends on a triangle */
    /* The ray passes through a point of a triangle. */
    if (style == 3)
        return lc_f3_add(o, lc_f3_scale(lc_f3_sub(rnd_on((int)rnd_n(3)), o), rnd() < 0.5 ? 2 : 5));
    if (style == 4) return lc_f3_add(o, rnd_axis(r));
    /* Null directions and short rays. */
    if (style == 5) return rnd() < 0.5 ? o : rnd_point(o, r * powf(10, (float)rnd_in(-8, 0)));
    return rnd_target((int)rnd_n(6), o, c, at, r);
}

static void make_group(group *g, int style, lc_f3 c, float r)
{
    double kind = rnd();
    lc_f3 o = kind < 0.3   ? rnd_on((int)rnd_n(4))
              : kind < 0.9 ? rnd_point(c, 1.2f * r)
                           : rnd_point(c, 30 * r),
          at = rnd_point(c, r);
    if (rnd() < 0.2)
        o = lc_f3_add(rnd_on(3), lc_f3_scale(rnd_unit(), 1e-4f * r)); /* an origin as cut.c has them */
    o = accepted(o);
    lc_f3_store(g->org, o);
    g->n = 1 + rnd_n(MOST);
    g->far = rnd() < 0.3;
    for (uint32_t i = 0; i < g->n; i++) {
        lc_f3 t = accepted(rnd_target(style, o, c, at, r));
        if (g->far) t = lc_f3_sub(t, o);
        g->target[0][i] = t.x;
        g->target[1][i] = t.y;
        g->target[2][i] = t.z;
    }
}

/* Traces rays first .. first + n - 1. False if anything but the answers is written. */
static bool trace_data(lc_isa isa, const lc_bvh_data *data, const group *g, uint32_t first, uint32_t n,
                       uint8_t *out, uint32_t *block)
{
    uint8_t got[MOST + LC_LANES + GUARD];
    const float *const target[3] = { g->target[0] + first, g->target[1] + first, g->target[2] + first };
    memset(got, 77, sizeof got);
    lc_isa_kernels(isa)->trace.hidden(data, g->org, n, target, g->far, got, block);
    memcpy(out, got, n);
    bool ok = true;
    for (uint32_t i = 0; i < n; i++) ok &= got[i] <= 1;
    for (uint32_t i = (n + LC_LANES - 1) / LC_LANES * LC_LANES; i < sizeof got; i++) ok &= got[i] == 77;
    return ok;
}

/* The occluding blocks are those of plain C: one for each occluded ray, none for the others. */
static bool blocks_agree(lc_isa isa, const lc_bvh_data *data, const group *g, uint32_t first, uint32_t n)
{
    static uint32_t want[MOST], got[MOST];
    uint8_t hidden[MOST];
    bool ok = trace_data(LC_ISA_SCALAR, data, g, first, n, hidden, want) &&
              trace_data(isa, data, g, first, n, hidden, got);
    for (uint32_t i = 0; i < n; i++)
        ok &= got[i] == want[i] && (hidden[i] ? got[i] < data->n_blocks : got[i] == LC_NONE);
    return ok;
}

/* Traces rays first .. first + n - 1. False if anything but the answers is written, or if they or the blocks
 * differ when rays take turns, as they do in a tree that is too large for the caches. */
static bool trace(lc_isa isa, const lc_bvh *b, const group *g, uint32_t first, uint32_t n, uint8_t *out)
{
    uint8_t in_turns[MOST];
    lc_bvh_data large = b->data;
    large.n_blocks = LC_BVH_LEAF;
    return trace_data(isa, &b->data, g, first, n, out, NULL) &&
           trace_data(isa, &large, g, first, n, in_turns, NULL) && !memcmp(out, in_turns, n) &&
           blocks_agree(isa, &b->data, g, first, n) && blocks_agree(isa, &large, g, first, n);
}

static void say(const char *what, lc_isa isa, int mesh_style, const group *g, uint32_t i, int got, int want)
{
    CHECKF(false, "%s: %s, mesh %d, ray %u of %u%s: %d, alone by scalar %d; org %a %a %a target %a %a %a",
           what, lc_isa_name(isa), mesh_style, i, g->n, g->far ? " far" : "", got, want, (double)g->org[0],
           (double)g->org[1], (double)g->org[2], (double)g->target[0][i], (double)g->target[1][i],
           (double)g->target[2][i]);
}

/* The group as a whole, ray by ray, and a part of it. Returns how many rays are occluded. */
static uint32_t check_group(const lc_bvh *b, const group *g, int mesh_style)
{
    uint8_t want[MOST], got[MOST];
    uint32_t n_hidden = 0, part = rnd_n(g->n);
    for (uint32_t i = 0; i < g->n; i++) {
        CHECK(trace(LC_ISA_SCALAR, b, g, i, 1, &want[i]));
        n_hidden += want[i];
    }
    EACH_ISA(isa) {
        CHECK(trace(isa, b, g, 0, g->n, got));
        for (uint32_t i = 0; i < g->n; i++)
            if (got[i] != want[i]) say("group", isa, mesh_style, g, i, got[i], want[i]);
        CHECK(trace(isa, b, g, part, g->n - part, got + part));
        for (uint32_t i = part; i < g->n; i++)
            if (got[i] != want[i]) say("part", isa, mesh_style, g, i, got[i], want[i]);
        for (uint32_t i = 0; i < g->n; i++) {
            uint8_t alone;
            CHECK(trace(isa, b, g, i, 1, &alone));
            if (alone != want[i]) say("alone", isa, mesh_style, g, i, alone, want[i]);
        }
    }
    return n_hidden;
}

/* Centre and half size of the mesh without regard to outliers: mean and mean distance of the vertices. */
static void extent(lc_f3 *c, float *r)
{
    double sum[3] = { 0, 0, 0 }, dist = 0;
    for (uint32_t i = 0; i < m.n_verts; i++)
        for (uint32_t k = 0; k < 3; k++) sum[k] += (double)m.pos[3 * i + k] / m.n_verts;
    *c = lc_f3_make((float)sum[0], (float)sum[1], (float)sum[2]);
    for (uint32_t i = 0; i < m.n_verts; i++)
        for (uint32_t k = 0; k < 3; k++) dist += fabs((double)m.pos[3 * i + k] - sum[k]) / m.n_verts / 2;
    *r = (float)dist;
}

TEST(groups_answer_as_rays_alone)
{
    static group g;
    uint32_t all_hidden = 0, all_rays = 0;
    for (int mesh_style = 0; mesh_style < N_MESHES; mesh_style++) {
        uint32_t n_rays = 0, n_hidden = 0;
        lc_f3 c;
        float r;
        make_mesh(mesh_style);
        for (uint32_t i = 0; i < m.n_verts; i++) lc_f3_store(m.pos + 3 * (size_t)i, accepted(vert(i)));
        extent(&c, &r);
        lc_bvh *b = build_bvh(ctx);
        for (int i = 0; i < 420 / SLOW; i++) {
            make_group(&g, i % N_STYLES, c, r);
            n_rays += g.n;
            n_hidden += check_group(b, &g, mesh_style);
        }
        printf("  mesh %d: %u triangles, %u rays, %u hidden\n", mesh_style, m.n_tris, n_rays, n_hidden);
        all_rays += n_rays;
        all_hidden += n_hidden;
        lc_bvh_destroy(b);
    }
    CHECKF(all_hidden > all_rays / 10 && all_hidden < all_rays - all_rays / 10, "%u of %u hidden", all_hidden,
           all_rays);
}

/* A group of no rays, and a scene of no triangles. */
TEST(nothing_to_trace)
{
    static group g = { .n = MOST };
    uint8_t got[MOST];
    clear();
    lc_bvh *b = build_bvh(ctx);
    EACH_ISA(isa) {
        CHECK(trace(isa, b, &g, 0, 0, got));
        CHECK(trace(isa, b, &g, 0, MOST, got));
        for (int i = 0; i < MOST; i++) CHECK(!got[i]);
    }
    lc_bvh_destroy(b);
}

int main(void)
{
    ctx = quiet_context(0);
    printf("seed %llu, best %s\n", (unsigned long long)rng_key, lc_isa_name(lc_isa_pick(LC_ISA_BEST)));
    RUN(every_instruction_set_is_here);
    RUN(nothing_to_trace);
    RUN(groups_answer_as_rays_alone);
    lc_context_destroy(ctx);
    return test_done();
}
