/* unit_near_lights.c - lights near a small surface (tree/near_lights.h): never less than a sum over every
 * light in double precision, none is found where none is near, and a single light is found exactly. */
#include "shade/dir_pack.h"
#include "support/near.h"
#include "support/some_profiles.h"
#include "support/test.h"
#include "tree/light_tree.h"
#include "tree/near_lights.h"

#define RND_KEY 4711
#include "support/rnd.h"

#define MAX_LIGHTS 600
#define LOW        0.01 /* of the reach: lights below that height lie on the surface */

static lc_context *ctx;

static lc_light light_of(lc_light_kind kind, lc_f3 pos)
{
    lc_light l = { .kind = kind, .pos = pos, .dir = rnd_unit(), .atten = { 0, 0, 1 } };
    const float power = (float)pow(10, rnd_in(-3, 1));
    l.intensity = lc_f3_scale(lc_f3_make((float)rnd_in(0.1, 1), (float)rnd(), (float)rnd()), power);
    if (kind == LC_LIGHT_SPOT) l.spot = (lc_spot){ (float)rnd_in(-0.5, 0.5), (float)rnd_in(0.5, 1), 0 };
    else if (lc_is_sized(kind)) l.radius = (float)rnd_in(0.001, 0.1);
    else if (kind == LC_LIGHT_LUMINAIRE) be_luminaire(&l, rnd_n(2 * N_PROFILES), rnd_in(-4, 4));
    return l;
}

static lc_light_tree *build(const lc_light *lights, uint32_t n)
{
    lc_light_tree *t;
    const lc_light_tree_desc d = { .lights = lights,
                                   .n_lights = n,
                                   .profiles = some_profiles(),
                                   .diag2 = 12,
                                   .seed = 3,
                                   .n_reps = 4,
                                   .builder = LC_BUILDER_AUTO };
    if (lc_light_tree_build(ctx, &d, &t)) abort();
    CHECK(!lc_light_tree_validate(t));
    return t;
}

/* ---- every light ---- */

typedef struct {
    double sum;  /* of those that are near, without those that rounding may leave out */
    double most; /* with those that rounding may take in */
    uint32_t n, n_most;
    bool luminaire; /* is one of n */
} reference;

static double dot(const double a[3], lc_f3 b)
{
    return a[0] * (double)b.x + a[1] * (double)b.y + a[2] * (double)b.z;
}

/* Whether a light is near, with `room` taken from (or, below 0, given to) each limit; *height over the
 * planes: the greatest. */
static bool is_near(const lc_light_rec *l, lc_light_kind kind, const lc_near_point *p, uint32_t n,
                    double reach, double room, double *height)
{
    const bool half = kind == LC_LIGHT_ORIENTED || kind == LC_LIGHT_VIRTUAL;
    const lc_f3 dir = half ? lc_dir_unpack((const uint32_t[2]){ l->dir_a, l->dir_b }) : lc_f3_make(0, 0, 1);
    bool shines = !half;
    *height = 0;
    for (int k = 0; k < 3; k++) {
        double lo = INFINITY, hi = -INFINITY;
        for (uint32_t i = 0; i < n; i++) {
            const double at = (double)(&p[i].pos.x)[k];
            if (at < lo) lo = at;
            if (at > hi) hi = at;
        }
        if ((double)l->pos[k] < lo - reach + room || (double)l->pos[k] > hi + reach - room) return false;
    }
    for (uint32_t i = 0; i < n; i++) {
        double to[3];
        for (int k = 0; k < 3; k++) to[k] = (double)l->pos[k] - (double)(&p[i].pos.x)[k];
        if (dot(to, p[i].n) > *height) *height = dot(to, p[i].n);
        if (-dot(to, dir) > LOW * reach + room) shines = true;
    }
    return shines && *height > LOW * reach + room;
}

static reference refer(const lc_light_tree *t, const lc_near_point *p, uint32_t n, double reach, double least)
{
    reference r = { .n = 0 };
    for (uint32_t i = 0; i < t->n_lights; i++) {
        const lc_light_kind kind = lc_kind_of_light(t, i);
        const lc_light_rec *l = &t->data.lights[i];
        const double y = 0.2126 * (double)l->intensity[0] + 0.7152 * (double)l->intensity[1] +
                         0.0722 * (double)l->intensity[2];
        double height;
        if (lc_is_far(kind)) continue;
        if (is_near(l, kind, p, n, reach, 1e-6, &height)) {
            r.n++;
            r.luminaire |= kind == LC_LIGHT_LUMINAIRE;
            height = fmax(height + 1e-6, least);
            if (kind != LC_LIGHT_LUMINAIRE) r.sum += y / (height * height);
        }
        if (is_near(l, kind, p, n, reach, -1e-6, &height)) {
            r.n_most++;
            height = fmax(height - 1e-6, least);
            r.most += kind == LC_LIGHT_LUMINAIRE ? INFINITY : y / (height * height);
        }
    }
    return r;
}

/* ---- cases ---- */

/* Points of a small surface, which is bent a little in every other case. */
static uint32_t rnd_surface(lc_near_point p[4], double size)
{
    const lc_f3 at = rnd_in_box(1), n = rnd_unit(), u = lc_f3_normalize(lc_f3_cross(n, rnd_unit())),
                v = lc_f3_cross(n, u);
    const bool bent = rnd() < 0.5;
    for (uint32_t i = 0; i < 4; i++) {
        const float a = (float)(size * (i % 2 + rnd_in(-0.2, 0.2))),
                    b = (float)(size * (i / 2 + rnd_in(-0.2, 0.2)));
        p[i].pos = lc_f3_add(at, lc_f3_add(lc_f3_scale(u, a), lc_f3_scale(v, b)));
        p[i].n = bent ? lc_f3_normalize(lc_f3_add(n, lc_f3_scale(rnd_unit(), 0.1f))) : n;
    }
    return rnd() < 0.2 ? 1 + rnd_n(4) : 4;
}

/* Lights all over the box, and as many about a point, on either side of it. */
static lc_light_tree *rnd_tree(uint32_t n, uint32_t kinds, lc_f3 about, double size)
{
    static lc_light lights[MAX_LIGHTS];
    for (uint32_t i = 0; i < n; i++) {
        uint32_t kind;
        do kind = rnd_n(LC_LIGHT_KINDS);
        while (!(kinds >> kind & 1));
        lc_f3 pos = rnd_in_box(1);
        if (rnd() < 0.5)
            pos = lc_f3_add(about, lc_f3_scale(rnd_unit(), (float)(size * pow(10, rnd_in(-2, 1)))));
        lights[i] = light_of((lc_light_kind)kind, pos);
    }
    return build(lights, n);
}

static const uint32_t kinds_of[] = {
    1u << LC_LIGHT_POINT,      1u << LC_LIGHT_ORIENTED,
    1u << LC_LIGHT_SPOT,       1u << LC_LIGHT_VIRTUAL,
    1u << LC_LIGHT_BALL,       ((1u << LC_LIGHT_KINDS) - 1) & ~(1u << LC_LIGHT_LUMINAIRE),
    (1u << LC_LIGHT_KINDS) - 1
};
#define N_KINDS_OF (sizeof kinds_of / sizeof *kinds_of)

/* `enough` from far below what there is to far above, and without an end. */
TEST(never_less_than_what_every_light_adds_up_to)
{
    uint32_t infinite = 0, finite = 0, whole = 0, n_near = 0;
    for (uint32_t c = 0; c < 4000; c++) {
        lc_near_point p[4];
        const double size = pow(10, rnd_in(-2, -0.5)), reach = size * rnd_in(0.2, 2),
                     least = size * rnd_in(0.05, 0.5);
        const uint32_t n = rnd_surface(p, size), n_lights = 1 + rnd_n(c % 8 ? 60 : MAX_LIGHTS);
        lc_light_tree *t = rnd_tree(n_lights, kinds_of[c % N_KINDS_OF], p[0].pos, size);
        const double f_reach = (double)(float)reach, f_least = (double)(float)least;
        const reference r = refer(t, p, n, f_reach, f_least);
        n_near += r.n > 0;
        for (uint32_t k = 0; k < 5; k++) {
            const double enough = k == 4      ? DBL_MAX
                                  : r.sum > 0 ? r.sum * pow(10, rnd_in(-2, 4))
                                              : 1,
                         got = lc_near_lights(t, p, n, (float)reach, (float)least, enough);
            CHECKF(got >= r.sum * (1 - 1e-5), "case %u: %g of %g, enough %g", c, got, r.sum, enough);
            CHECKF(got <= enough || isinf(got), "case %u: %g is above %g", c, got, enough);
            if (k == 4 && !(kinds_of[c % N_KINDS_OF] >> LC_LIGHT_LUMINAIRE))
                CHECKF(!isinf(got), "case %u", c);
            if (r.sum * (1 - 1e-5) > enough || r.luminaire) CHECKF(isinf(got), "case %u: %g", c, got);
            infinite += isinf(got) ? 1 : 0;
            finite += got > 0 && !isinf(got);
            whole += got > r.most * (1 + 1e-5) && !isinf(got);
        }
        lc_light_tree_destroy(t);
    }
    printf("  %u of 4000 with near lights; %u answers infinite, %u finite, %u of clusters taken whole\n",
           n_near, infinite, finite, whole);
    CHECK(n_near > 1000 && infinite > 1000 && finite > 1000 && whole > 300);
}

/* Where nothing is enough no cluster is taken whole, and the answer says whether a light is near. */
TEST(none_is_found_where_none_is_near)
{
    uint32_t n_none = 0, n_some = 0;
    for (uint32_t c = 0; c < 4000; c++) {
        lc_near_point p[4];
        const double size = pow(10, rnd_in(-2, -0.5)), reach = (double)(float)(size * rnd_in(0.2, 2));
        const uint32_t n = rnd_surface(p, size);
        lc_light_tree *t = rnd_tree(1 + rnd_n(20), kinds_of[c % N_KINDS_OF], p[0].pos, size);
        const reference r = refer(t, p, n, reach, size / 4);
        const double got = lc_near_lights(t, p, n, (float)reach, (float)(size / 4), 0);
        if (r.n) CHECKF(isinf(got), "case %u: %g, but %u are near", c, got, r.n);
        if (!r.n_most) CHECKF(got <= 0, "case %u: %g, but none is near", c, got);
        n_none += !r.n_most;
        n_some += r.n > 0;
        lc_light_tree_destroy(t);
    }
    printf("  none is near in %u of 4000 cases, some in %u\n", n_none, n_some);
    CHECK(n_none > 500 && n_some > 1000);
}

/* Only clusters are taken whole. */
TEST(a_single_light_is_found_exactly)
{
    uint32_t n_near = 0;
    for (uint32_t c = 0; c < 4000; c++) {
        lc_near_point p[4];
        const double size = pow(10, rnd_in(-2, -0.5)), reach = (double)(float)(size * rnd_in(0.5, 2)),
                     least = (double)(float)(size / 4);
        const uint32_t n = rnd_surface(p, size);
        lc_light_tree *t = rnd_tree(1, kinds_of[c % N_KINDS_OF], p[0].pos, size);
        const reference r = refer(t, p, n, reach, least);
        const double got = lc_near_lights(t, p, n, (float)reach, (float)least, DBL_MAX);
        CHECKF(got >= r.sum * (1 - 1e-5) && got <= r.most * (1 + 1e-5), "case %u: %g of %g to %g", c, got,
               r.sum, r.most);
        if (r.n && !r.luminaire) {
            CHECK(isinf(lc_near_lights(t, p, n, (float)reach, (float)least, 0.9 * r.sum)));
            n_near++;
        }
        lc_light_tree_destroy(t);
    }
    CHECKF(n_near > 500, "%u", n_near);
}

/* ---- what is easily got wrong ---- */

static const lc_near_point floor_of[4] = { { { 0, 0, 0 }, { 0, 0, 1 } },
                                           { { 1, 0, 0 }, { 0, 0, 1 } },
                                           { { 0, 1, 0 }, { 0, 0, 1 } },
                                           { { 1, 1, 0 }, { 0, 0, 1 } } };

static double near_floor(const lc_light_tree *t, float reach, double enough)
{
    return lc_near_lights(t, floor_of, 4, reach, 0.25f, enough);
}

TEST(no_lights_and_lights_at_infinity)
{
    static lc_light lights[50];
    lc_light_tree *t = build(lights, 0);
    CHECK(near_floor(t, 1, 0) <= 0 && near_floor(t, 1, DBL_MAX) <= 0 && near_floor(t, 0, 1) <= 0);
    lc_light_tree_destroy(t);
    for (uint32_t i = 0; i < 50; i++)
        lights[i] = light_of(LC_LIGHT_DIRECTIONAL, lc_f3_make(0.5f, 0.5f, 0.5f));
    t = build(lights, 50);
    CHECK(near_floor(t, 1, 0) <= 0 && near_floor(t, 1, DBL_MAX) <= 0);
    lc_light_tree_destroy(t);
}

/* Grey lights of intensity 1 at one place: 40 of them give 40 / 0.5^2, be they taken one by one or whole. */
TEST(all_lights_in_one_place)
{
    static lc_light lights[40];
    for (uint32_t i = 0; i < 40; i++) {
        lights[i] = light_of(LC_LIGHT_POINT, lc_f3_make(0.5f, 0.5f, 0.5f));
        lights[i].intensity = lc_f3_make(1, 1, 1);
    }
    lc_light_tree *t = build(lights, 40);
    const double got = near_floor(t, 1, 1000);
    CHECKF(got >= 160 * (1 - 1e-5) && got <= 640 * (1 + 1e-5), "%g", got); /* whole: as of height 0.25 */
    CHECK(isinf(near_floor(t, 1, 159)) && near_floor(t, 0.4f, 0) <= 0);
    CHECKF(near_rel(near_floor(t, 1, DBL_MAX), 640, 1e-5), "%g", near_floor(t, 1, DBL_MAX));
    lc_light_tree_destroy(t);
}

/* Heights of a light over the middle of the floor and the reach, and what is to be found. */
TEST(heights_and_reach)
{
    static const struct {
        float x, z, reach;
        double want;
    } cases[] = {
        { 0.5f, 0.5f, 1, 4 },    { 0.5f, 1, 1, 1 },      { 0.5f, 1.001f, 1, 0 },
        { 0.5f, 0.1f, 1, 16 },                           /* as if it were 0.25 high */
        { 0.5f, 0.011f, 1, 16 }, { 0.5f, 0.009f, 1, 0 }, /* on the floor */
        { 0.5f, -0.5f, 1, 0 },                           /* below it */
        { 1.9f, 0.5f, 1, 4 },    { -0.9f, 0.5f, 1, 4 },  { 2.1f, 0.5f, 1, 0 },
        { 0.5f, 0.5f, 0, 0 },    { 0.5f, 0, 0, 0 } /* nothing within a reach of 0 */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        lc_light l = light_of(LC_LIGHT_POINT, lc_f3_make(cases[i].x, 0.5f, cases[i].z));
        l.intensity = lc_f3_make(1, 1, 1);
        lc_light_tree *t = build(&l, 1);
        const double got = near_floor(t, cases[i].reach, DBL_MAX);
        CHECKF(fabs(got - cases[i].want) <= 1e-5 * cases[i].want, "case %zu: %g for %g", i, got,
               cases[i].want);
        lc_light_tree_destroy(t);
    }
}

/* A small piece of a surface lights nothing behind it; spots and luminaires are near wherever they aim. */
TEST(lights_that_shine_away)
{
    static const struct {
        lc_light_kind kind;
        float dir_z;
        double want;
    } cases[] = {
        { LC_LIGHT_ORIENTED, -1, 4 },        { LC_LIGHT_ORIENTED, 1, 0 }, { LC_LIGHT_VIRTUAL, -1, 4 },
        { LC_LIGHT_VIRTUAL, 1, 0 },          { LC_LIGHT_SPOT, -1, 4 },    { LC_LIGHT_BALL, 1, 4 },
        { LC_LIGHT_LUMINAIRE, -1, INFINITY }
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        lc_light l = light_of(cases[i].kind, lc_f3_make(0.5f, 0.5f, 0.5f));
        l.intensity = lc_f3_make(1, 1, 1);
        l.dir = lc_f3_make(0, 0, cases[i].dir_z);
        lc_light_tree *t = build(&l, 1);
        const double got = near_floor(t, 1, DBL_MAX);
        CHECKF(isinf(cases[i].want) ? isinf(got) : fabs(got - cases[i].want) <= 1e-5 * cases[i].want,
               "case %zu: %g for %g", i, got, cases[i].want);
        lc_light_tree_destroy(t);
    }
}

int main(void)
{
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    desc.n_threads = 1;
    if (lc_context_create(&desc, &ctx)) abort();
    RUN(never_less_than_what_every_light_adds_up_to);
    RUN(none_is_found_where_none_is_near);
    RUN(a_single_light_is_found_exactly);
    RUN(no_lights_and_lights_at_infinity);
    RUN(all_lights_in_one_place);
    RUN(heights_and_reach);
    RUN(lights_that_shine_away);
    lc_context_destroy(ctx);
    return test_done();
}
