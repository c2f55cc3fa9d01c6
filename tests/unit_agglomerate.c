/* unit_agglomerate.c - the exact builder of light trees, against a naive one that merges the two nearest
 * clusters of all in each step, in doubles. Where several pairs are equally near, the trees may differ; there
 * and on every other set each merged pair must be the nearest of each other among all clusters left, found by
 * a loop over them. */
#include "support/logged.h"
#include "support/watched_memory.h"
#include "tree/tree_build.h"

#include <math.h>

#define RND_KEY 20240819
#include "support/rnd.h"

static lc_context *ctx;

/* ---- sets ---- */

typedef enum {
    ROOM,
    ANY_DIRECTION,
    ONE_PLACE,
    ONE_PLACE_ANY_DIRECTION,
    ONE_PLACE_NARROW,
    ONE_PLACE_GRID,
    LINE,
    GRID,
    DECADES,
    BLACK,
    SOME_BLACK,
    SCALES,
    BLOBS,
    WALLS,
    OUTLIERS,
    GEOMETRIC,
    UNEQUAL,
    SHELL,
    ORIGIN,
    STYLES
} style;

static const char *const names[STYLES] = { "room",
                                           "any direction",
                                           "one place",
                                           "one place, any direction",
                                           "one place, narrow",
                                           "one place, grid of directions",
                                           "line",
                                           "grid",
                                           "30 decades",
                                           "black",
                                           "some black",
                                           "scales",
                                           "blobs",
                                           "walls",
                                           "outliers",
                                           "geometric",
                                           "one place, unequal",
                                           "shell",
                                           "about the origin" };

static lc_light any_light(lc_light_kind kind)
{
    lc_light l = { .kind = kind, .intensity = { 1, 1, 1 }, .atten = { 0, 0, 1 } };
    /* One number a statement: the order in which arguments are evaluated is the compiler's. */
    l.pos.z = (float)rnd_in(0, 10);
    l.pos.y = (float)rnd_in(3, 4);
    l.pos.x = (float)rnd_in(0, 10);
    const float z = (float)rnd_in(-0.5, 0.5), x = (float)rnd_in(-0.5, 0.5);
    l.dir = lc_f3_normalize(lc_f3_make(x, -1, z));
    return l;
}

static lc_light directed(lc_light l, double x, double y, double z)
{
    l.dir = lc_f3_normalize_d(x, y, z);
    return l;
}

/* Moved to one of the six sides of a cube, facing inwards. */
static lc_light on_wall(lc_light l)
{
    uint32_t side = rnd_n(6);
    float *pos = &l.pos.x, dir[3] = { 0, 0, 0 };
    pos[side / 2] = side % 2 ? 10 : 0;
    dir[side / 2] = side % 2 ? -1 : 1;
    l.dir = lc_f3_load(dir);
    l.intensity = lc_f3_make((float)rnd(), (float)rnd(), 0.5f);
    return l;
}

static lc_light one_light(style st, lc_light_kind kind, uint32_t i, uint32_t n)
{
    lc_light l = any_light(kind);
    lc_f3 place = lc_f3_make(1, 2, 3);
    double side = floor(sqrt(n)), row = floor(i / side), column = i - row * side;
    switch (st) {
    case ANY_DIRECTION: l.dir = rnd_unit(); break;
    case UNEQUAL: l.intensity.y = (float)rnd(); /* fall through */
    case ONE_PLACE: l.pos = place, l.dir = lc_f3_make(0, -1, 0); break;
    case ONE_PLACE_ANY_DIRECTION: /* of unequal intensity: once cones are whole spheres the metric is nothing
                                     else */
        l.pos = place;
        l.dir = rnd_unit();
        l.intensity.y = (float)rnd_in(0.5, 1);
        break;
    case ONE_PLACE_NARROW: {
        const double z = rnd_in(-0.005, 0.005), x = rnd_in(-0.005, 0.005);
        l = directed(l, x, -1, z);
        l.pos = place;
        break;
    }
    case ONE_PLACE_GRID: l = directed(l, column / side - 0.5, -1, row / side - 0.5), l.pos = place; break;
    case LINE:
        l = directed(l, lc_is_far(kind) ? i * 0.001 : 0, -1, 0),
        l.pos.x = l.pos.y = l.pos.z = (float)i;
        break;
    case GRID:
        l.pos = lc_f3_make((float)column, 0, (float)row);
        l = lc_is_far(kind) ? directed(l, column / 64, -1, row / 64) : directed(l, 0, -1, 0);
        break;
    case DECADES: l.intensity = lc_f3_scale(l.intensity, powf(10, (float)rnd_in(-15, 15))); break;
    case BLACK: l.intensity = lc_f3_make(0, 0, 0); break;
    case SOME_BLACK: l.intensity = lc_f3_scale(l.intensity, (float)rnd_n(2)); break;
    case SCALES: l.pos = lc_f3_scale(l.pos, powf(10, (float)rnd_in(-14, 10))); break;
    case BLOBS:
        l.pos = lc_f3_scale(lc_f3_add(l.pos, lc_f3_make(0, (float)(i % 7) * 100, 0)),
                            powf(0.1f, (float)(i % 7)));
        break;
    case WALLS: l = on_wall(l); break;
    case OUTLIERS:
        if (i % 50 == 0) {
            l.pos = lc_f3_scale(rnd_unit(), 1000);
            l.intensity = lc_f3_make(0.001f, 0.001f, 0.001f);
        }
        break;
    case GEOMETRIC: l.pos = lc_f3_make(ldexpf(1 + 1e-6f * (float)i, (int)(i % 60) - 40), 0, 0); break;
    case SHELL: l.dir = rnd_unit(), l.pos = lc_f3_scale(l.dir, 10); break;
    case ORIGIN: l.pos = lc_f3_scale(rnd_unit(), rnd() < 0.5 ? 1e-25f : 1e-19f); break;
    default: break;
    }
    return l;
}

static lc_light *make_set(style st, lc_light_kind kind, uint32_t n)
{
    lc_light *l = malloc(n * sizeof *l);
    for (uint32_t i = 0; i < n; i++) l[i] = one_light(st, kind, i, n);
    return l;
}

/* The metric's weight of directions, 0 for lights without one: the squared diagonal of the box of positions,
 * or 1 if that is 0. */
static double weight(const lc_light *l, uint32_t n)
{
    lc_box b = lc_box_empty();
    if (!lc_is_aimed(l->kind)) return 0;
    for (uint32_t i = 0; i < n; i++) lc_box_add(&b, l[i].pos);
    double x = (double)b.hi.x - b.lo.x, y = (double)b.hi.y - b.lo.y, z = (double)b.hi.z - b.lo.z;
    return x * x + y * y + z * z > 0 ? x * x + y * y + z * z : 1;
}

/* ---- clusters by the definition, in doubles ---- */

typedef struct {
    float lo[3], hi[3], dlo[3], dhi[3];
    double power[3], cos_cone;
} cluster;

static cluster of_light(const lc_light *l)
{
    cluster c = { .cos_cone = 1 };
    lc_f3 p = lc_is_far(l->kind) ? lc_f3_neg(l->dir) : l->pos;
    lc_f3_store(c.lo, p);
    lc_f3_store(c.hi, p);
    lc_f3_store(c.dlo, l->dir);
    lc_f3_store(c.dhi, l->dir);
    c.power[0] = (double)l->intensity.x;
    c.power[1] = (double)l->intensity.y;
    c.power[2] = (double)l->intensity.z;
    return c;
}

/* The cone is the cap that the sphere through the corners of the box of directions cuts out of the unit
 * sphere; it is no narrower than either child's. */
static cluster joined(const cluster *a, const cluster *b)
{
    cluster c = { .cos_cone = fmin(a->cos_cone, b->cos_cone) };
    double s2 = 0, r2 = 0;
    for (int k = 0; k < 3; k++) {
        c.lo[k] = fminf(a->lo[k], b->lo[k]);
        c.hi[k] = fmaxf(a->hi[k], b->hi[k]);
        c.dlo[k] = fminf(a->dlo[k], b->dlo[k]);
        c.dhi[k] = fmaxf(a->dhi[k], b->dhi[k]);
        c.power[k] = a->power[k] + b->power[k];
        double s = (double)c.dlo[k] + (double)c.dhi[k], w = (double)c.dhi[k] - (double)c.dlo[k];
        s2 += s * s;
        r2 += w * w;
    }
    double s = sqrt(s2), cap = s < 0.1 ? -1 : (s2 + 4 - r2) / (4 * s);
    c.cos_cone = fmax(-1, fmin(c.cos_cone, cap));
    return c;
}

static double scalar(const cluster *c) { return (c->power[0] + c->power[1] + c->power[2]) / 3; }

static double metric(const cluster *a, const cluster *b, double c2)
{
    cluster u = joined(a, b);
    double alpha2 = 0;
    for (int k = 0; k < 3; k++)
        alpha2 += ((double)u.hi[k] - (double)u.lo[k]) * ((double)u.hi[k] - (double)u.lo[k]);
    return (scalar(a) + scalar(b)) * (alpha2 + c2 * (1 - u.cos_cone) * (1 - u.cos_cone));
}

static lc_build_pair *agglomerate(const lc_light *l, uint32_t n)
{
    lc_build_pair *pairs = malloc(n * sizeof *pairs);
    lc_build_input in = { l, NULL, n, l->kind, weight(l, n) };
    if (lc_agglomerate(ctx, &in, pairs)) abort();
    return pairs;
}

/* ---- pairs are nearest ---- */

static bool is_tree(const lc_build_pair *pairs, uint32_t n)
{
    bool ok = true;
    uint8_t *used = calloc(2 * (size_t)n, 1);
    for (uint32_t i = 0; i + 1 < n && ok; i++) {
        const uint32_t *c = pairs[i].child;
        ok = c[0] < c[1] && c[1] < n + i && !used[c[0]] && !used[c[1]];
        if (ok) used[c[0]] = used[c[1]] = 1;
    }
    free(used);
    return ok; /* n - 1 merges of clusters that were not merged before: one cluster is left */
}

/* Repeats the merges. Returns how many of the pairs had a cluster left that is nearer to one of the two. */
static uint32_t not_nearest(const lc_light *l, uint32_t n, const lc_build_pair *pairs, double c2)
{
    cluster *c = malloc(2 * (size_t)n * sizeof *c);
    uint8_t *dead = calloc(2 * (size_t)n, 1);
    uint32_t bad = 0;
    for (uint32_t i = 0; i < n; i++) c[i] = of_light(&l[i]);
    for (uint32_t i = 0; i + 1 < n; i++) {
        uint32_t a = pairs[i].child[0], b = pairs[i].child[1];
        double d = metric(&c[a], &c[b], c2);
        bool nearer = false;
        for (uint32_t k = 0; k < n + i; k++)
            if (!dead[k] && k != a && k != b)
                nearer |= metric(&c[a], &c[k], c2) < d || metric(&c[b], &c[k], c2) < d;
        bad += nearer;
        dead[a] = dead[b] = 1;
        c[n + i] = joined(&c[a], &c[b]);
    }
    free(c);
    free(dead);
    return bad;
}

static void expect_nearest(style st, lc_light_kind kind, uint32_t n)
{
    lc_light *l = make_set(st, kind, n);
    lc_build_pair *pairs = agglomerate(l, n);
    bool tree = is_tree(pairs, n);
    CHECKF(tree, "%s, kind %d, %u lights", names[st], kind, n);
    uint32_t bad = tree ? not_nearest(l, n, pairs, weight(l, n)) : 0;
    CHECKF(!bad, "%s, kind %d, %u lights: %u pairs are not nearest", names[st], kind, n, bad);
    free(l);
    free(pairs);
}

TEST(pairs_are_nearest)
{
    static const uint32_t sizes[] = { 2, 3, 4, 5, 6, 9, 16, 17, 33, 64, 65, 100, 257, 600 };
    for (int st = 0; st < STYLES; st++)
        for (int kind = 0; kind < LC_LIGHT_KINDS; kind++)
            for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
                expect_nearest((style)st, (lc_light_kind)kind, sizes[i]);
}

TEST(one_light_is_no_pair)
{
    lc_light l = any_light(LC_LIGHT_POINT);
    lc_build_input in = { &l, NULL, 1, LC_LIGHT_POINT, 0 };
    CHECK(!lc_agglomerate(ctx, &in, NULL));
}

/* ---- naive agglomeration ---- */

static int by_value(const void *a, const void *b)
{
    uint64_t x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return x < y ? -1 : x > y;
}

/* The set of lights of each cluster as the sum of the hashes of their indices, sorted. */
static void sets_of(const lc_build_pair *pairs, uint32_t n, uint64_t *sets)
{
    uint64_t *set = malloc(2 * (size_t)n * sizeof *set);
    for (uint32_t i = 0; i < n; i++) set[i] = lc_mix(i);
    for (uint32_t i = 0; i + 1 < n; i++)
        sets[i] = set[n + i] = set[pairs[i].child[0]] + set[pairs[i].child[1]];
    qsort(sets, n - 1, sizeof *sets, by_value);
    free(set);
}

/* Merges the two clusters of least metric until one is left. */
static void naive_pairs(const lc_light *l, uint32_t n, double c2, lc_build_pair *pairs)
{
    cluster *c = malloc(n * sizeof *c);
    uint32_t *id = malloc(n * sizeof *id), n_live = n;
    for (uint32_t i = 0; i < n; i++) {
        c[i] = of_light(&l[i]);
        id[i] = i;
    }
    for (uint32_t next = n; n_live > 1; next++) {
        uint32_t a = 0, b = 1;
        double best = INFINITY;
        for (uint32_t i = 0; i < n_live; i++)
            for (uint32_t k = i + 1; k < n_live; k++) {
                double d = metric(&c[i], &c[k], c2);
                if (d < best) {
                    best = d;
                    a = i;
                    b = k;
                }
            }
        pairs[next - n] = (lc_build_pair){ { id[a], id[b] } };
        c[a] = joined(&c[a], &c[b]);
        id[a] = next;
        c[b] = c[--n_live];
        id[b] = id[n_live];
    }
    free(c);
    free(id);
}

TEST(equals_naive_agglomeration)
{
    static const style without_ties[] = {
        ROOM,     ANY_DIRECTION, ONE_PLACE_ANY_DIRECTION, ONE_PLACE_NARROW, DECADES, SCALES, WALLS,
        OUTLIERS, SHELL
    };
    uint64_t want[512], got[512];
    lc_build_pair naive[512];
    for (size_t s = 0; s < sizeof without_ties / sizeof *without_ties; s++)
        for (int kind = 0; kind < LC_LIGHT_KINDS; kind++)
            for (uint32_t n = 2; n <= 350; n += n < 12 ? 1 : n < 100 ? 29 : 113) {
                style st = without_ties[s];
                bool tie = !lc_is_aimed((lc_light_kind)kind) &&
                           (st == ONE_PLACE_ANY_DIRECTION || st == ONE_PLACE_NARROW || st == WALLS);
                if (tie || (st == OUTLIERS && lc_is_far((lc_light_kind)kind))) continue;
                lc_light *l = make_set(st, (lc_light_kind)kind, n);
                lc_build_pair *pairs = agglomerate(l, n);
                naive_pairs(l, n, weight(l, n), naive);
                sets_of(pairs, n, got);
                sets_of(naive, n, want);
                CHECKF(!memcmp(want, got, (n - 1) * sizeof *got), "%s, kind %d, %u lights", names[st], kind,
                       n);
                free(l);
                free(pairs);
            }
}

/* ---- independence of threads and of the order of lights ---- */

TEST(threads_change_nothing)
{
    uint32_t n = 9000, threads = ctx->n_threads;
    for (int st = 0; st < STYLES; st++) {
        lc_build_pair *pairs[3];
        lc_light *l = make_set((style)st, LC_LIGHT_ORIENTED, n);
        for (uint32_t i = 0; i < 3; i++) {
            ctx->n_threads = i == 2 ? 7 : i + 1;
            pairs[i] = agglomerate(l, n);
        }
        CHECKF(is_tree(pairs[0], n), "%s", names[st]);
        for (int i = 1; i < 3; i++)
            CHECKF(!memcmp(pairs[0], pairs[i], (n - 1) * sizeof **pairs), "%s", names[st]);
        for (int i = 0; i < 3; i++) free(pairs[i]);
        free(l);
    }
    ctx->n_threads = threads;
}

TEST(lights_by_index)
{
    enum { N = 400 };
    lc_light l[3 * N], chosen[N];
    uint32_t index[N];
    lc_build_pair a[N], b[N];
    for (uint32_t i = 0; i < 3 * N; i++) l[i] = any_light(i % 3 ? LC_LIGHT_POINT : LC_LIGHT_ORIENTED);
    for (uint32_t i = 0; i < N; i++) chosen[i] = l[index[i] = 3 * i];
    lc_build_input all = { chosen, NULL, N, LC_LIGHT_ORIENTED, 50 },
                   some = { l, index, N, LC_LIGHT_ORIENTED, 50 };
    CHECK(!lc_agglomerate(ctx, &all, a) && !lc_agglomerate(ctx, &some, b));
    CHECK(!memcmp(a, b, (N - 1) * sizeof *a));
}

/* ---- memory ---- */

#define N_STARVED 3000

static lc_light *starved_lights;
static lc_build_pair starved_pairs[N_STARVED];

static lc_status agglomerate_in(lc_context *c)
{
    lc_build_input in = { starved_lights, NULL, N_STARVED, LC_LIGHT_ORIENTED, 50 };
    return lc_agglomerate(c, &in, starved_pairs);
}

TEST(every_allocation_may_fail)
{
    starved_lights = make_set(ROOM, LC_LIGHT_ORIENTED, N_STARVED);
    starve(agglomerate_in, 8);
    free(starved_lights);
}

int main(void)
{
    ctx = quiet_context(0);
    printf("seed %llu\n", (unsigned long long)rng_key);
    RUN(one_light_is_no_pair);
    RUN(pairs_are_nearest);
    RUN(equals_naive_agglomeration);
    RUN(threads_change_nothing);
    RUN(lights_by_index);
    RUN(every_allocation_may_fail);
    lc_context_destroy(ctx);
    return test_done();
}
