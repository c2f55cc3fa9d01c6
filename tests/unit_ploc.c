/* unit_ploc.c - the parallel builder of light trees: every result is a tree of all lights, of at most the
 * promised depth even for sets made to be hard, and the same for any number of threads and instruction set.
 * For few lights, where it looks at all pairs, it is compared with greedy merging in doubles. */
#include "support/isas.h"
#include "support/watched_memory.h"
#include "tree/tree_build.h"

#define RND_KEY 60606
#include "support/rnd.h"

static lc_status build(const lc_build_input *in, uint32_t threads, lc_isa isa, lc_build_pair *pairs)
{
    lc_context ctx = { .allocator = watched,
                       .n_threads = threads,
                       .isa = isa,
                       .tree_kernels = &lc_isa_kernels(lc_isa_pick(isa))->tree };
    return lc_ploc(&ctx, in, pairs);
}

/* ---- lights ---- */

enum {
    ROOM,
    LINE,
    GAPS,
    DOUBLING,
    ONE_PLACE,
    TWO_PLACES,
    POWERS,
    RISING,
    BLACK,
    HUGE_ONE,
    TINY,
    FACETS,
    INTERLEAVED,
    STYLES
};
static const char *const names[STYLES] = { "room",       "line",       "growing gaps", "doubling gaps",
                                           "one place",  "two places", "30 decades",   "rising powers",
                                           "black",      "huge",       "tiny",         "facets",
                                           "interleaved" };

static void put(lc_light *l, int style, uint32_t i, uint32_t n)
{
    double x = i, scale = style == HUGE_ONE ? 1e12 : style == TINY ? 1e-30 : 1;
    *l = (lc_light){ .dir = rnd_unit(), .atten = { 0, 0, 1 }, .intensity = { 1, 1, 1 } };
    l->pos = lc_f3_make((float)(scale * rnd_in(-1, 1)), (float)(scale * rnd_in(-1, 1)),
                        (float)(scale * rnd_in(-1, 1)));
    if (style == LINE) l->pos = lc_f3_make((float)x, 0, 0);
    if (style == GAPS) l->pos = lc_f3_make((float)(x * x / n), 0, 0);
    if (style == DOUBLING) l->pos = lc_f3_make((float)(1e12 * exp2(((double)i - n) * 60 / n)), 0, 0);
    if (style == ONE_PLACE) l->pos = lc_f3_make(3, 4, 5);
    if (style == TWO_PLACES) l->pos = lc_f3_make(i % 2 ? 3 : 4, 4, 5);
    if (style <= POWERS && style >= LINE) l->dir = lc_f3_make(0, 0, 1);
    if (style == POWERS) l->intensity = lc_f3_scale(l->intensity, powf(10, (float)rnd_in(-15, 15)));
    if (style == RISING) {
        l->pos = lc_f3_make(0, 0, (float)i);
        l->intensity.x = powf(10, (float)(30 * x / n - 15));
    }
    if (style == BLACK) l->intensity = lc_f3_make(0, 0, 0);
    if (style == HUGE_ONE) l->intensity = lc_f3_make(1e15f, 1e15f, 1e15f);
    if (style == TINY) l->intensity = lc_f3_make(1e-18f, 0, 0);
    if (style == FACETS) l->dir = lc_f3_make(i % 3 == 0, i % 3 == 1, i % 3 == 2);
    if (style == INTERLEAVED) {
        l->pos = lc_f3_make((float)(i / 8), 0, 0);
        l->dir = lc_f3_normalize(lc_f3_make((float)(i % 8 * (i % 8)), 1, 0));
    }
}

static lc_light *make(int style, uint32_t n, lc_light_kind kind)
{
    lc_light *l = malloc(n * sizeof *l);
    if (!l) abort();
    for (uint32_t i = 0; i < n; i++) {
        put(&l[i], style, i, n);
        l[i].kind = kind;
    }
    return l;
}

/* ---- checks ---- */

/* Most pairs on a path from the root to a light; UINT32_MAX if the pairs are no tree of n lights. */
static uint32_t depth_of(const lc_build_pair *pairs, uint32_t n)
{
    uint8_t *used = calloc(2 * (size_t)n, 1);
    uint32_t *depth = calloc(2 * (size_t)n, sizeof *depth), most = 0;
    if (!used || !depth) abort();
    for (uint32_t i = 0; i + 1 < n && most != UINT32_MAX; i++)
        for (int k = 0; k < 2; k++) {
            uint32_t c = pairs[i].child[k];
            if (c >= n + i || used[c]++ || pairs[i].child[0] >= pairs[i].child[1]) {
                most = UINT32_MAX;
                break;
            }
            if (depth[c] + 1 > depth[n + i]) depth[n + i] = depth[c] + 1;
            if (depth[n + i] > most) most = depth[n + i];
        }
    free(used);
    free(depth);
    return most;
}

static void check_set(int style, uint32_t n, lc_light_kind kind)
{
    lc_light *lights = make(style, n, kind);
    lc_build_pair *pairs = malloc(n * sizeof *pairs);
    if (!pairs) abort();
    lc_build_input in = { lights, NULL, n, kind, lc_is_aimed((lc_light_kind)kind) ? 12 : 0 };
    CHECK(build(&in, 2, LC_ISA_BEST, pairs) == LC_OK);
    uint32_t depth = depth_of(pairs, n);
    CHECKF(depth <= 128 + 32 * log(fmax(1, n / 128.0)), "%s, %u lights of kind %d: depth %u", names[style], n,
           (int)kind, depth);
    if (n > 20000) printf("  %-14s kind %d, %u lights: depth %u\n", names[style], (int)kind, n, depth);
    free(lights);
    free(pairs);
}

TEST(trees_of_all_lights)
{
    static const uint32_t sizes[] = { 2, 3, 4, 7, 8, 9, 63, 300, 5000, 30000 };
    for (int style = 0; style < STYLES; style++)
        for (int kind = 0; kind < LC_LIGHT_KINDS; kind++)
            for (size_t i = 0; i < (lc_is_far((lc_light_kind)kind) ? 9 : 10); i++)
                check_set(style, sizes[i], (lc_light_kind)kind);
}

/* Equal lights in one place: every round halves the number of clusters. */
TEST(coincident_lights_are_balanced)
{
    uint32_t n = 1u << 17;
    lc_light *lights = make(ONE_PLACE, n, LC_LIGHT_ORIENTED);
    lc_build_pair *pairs = malloc(n * sizeof *pairs);
    lc_build_input in = { lights, NULL, n, LC_LIGHT_ORIENTED, 1 };
    if (!pairs) abort();
    CHECK(build(&in, 2, LC_ISA_BEST, pairs) == LC_OK);
    CHECK(depth_of(pairs, n) == 17);
    free(lights);
    free(pairs);
}

TEST(same_for_threads_and_instruction_sets)
{
    static const uint32_t threads[] = { 1, 2, 3, 8 };
    uint32_t n = 25001; /* enough for several threads to share */
    lc_build_pair *want = malloc(n * sizeof *want), *got = malloc(n * sizeof *got);
    if (!want || !got) abort();
    for (int kind = 0; kind < LC_LIGHT_KINDS; kind++)
        for (int style = 0; style < STYLES; style += 4) {
            lc_light *lights = make(style, n, (lc_light_kind)kind);
            lc_build_input in = { lights, NULL, n, (lc_light_kind)kind,
                                  lc_is_aimed((lc_light_kind)kind) ? 12 : 0 };
            CHECK(build(&in, 1, lc_isa_pick(LC_ISA_BEST), want) == LC_OK);
            for (uint32_t i = 0; i < 4; i++) {
                lc_isa isa = isa_in_turn(i);
                CHECK(build(&in, threads[i], isa, got) == LC_OK);
                CHECKF(!memcmp(want, got, (n - 1) * sizeof *got), "%s, %u threads, %s", names[style],
                       threads[i], lc_isa_name(isa));
            }
            free(lights);
        }
    free(want);
    free(got);
}

/* Lights chosen by an index give the tree of a copy of these lights. */
TEST(index_as_a_copy)
{
    uint32_t n = 3000, half = n / 2, *index = malloc(half * sizeof *index);
    lc_light *all = make(ROOM, n, LC_LIGHT_POINT), *some = malloc(half * sizeof *some);
    lc_build_pair *want = malloc(half * sizeof *want), *got = malloc(half * sizeof *got);
    if (!index || !some || !want || !got) abort();
    for (uint32_t i = 0; i < half; i++) {
        index[i] = 2 * i + 1;
        some[i] = all[2 * i + 1];
    }
    lc_build_input copy = { some, NULL, half, LC_LIGHT_POINT, 0 },
                   by_index = { all, index, half, LC_LIGHT_POINT, 0 };
    CHECK(build(&copy, 1, LC_ISA_BEST, want) == LC_OK && build(&by_index, 1, LC_ISA_BEST, got) == LC_OK);
    CHECK(!memcmp(want, got, (half - 1) * sizeof *got));
    free(index);
    free(all);
    free(some);
    free(want);
    free(got);
}

/* ---- greedy merging ---- */

typedef struct {
    double lo[3], hi[3], power;
    bool live;
} box;

static double size_of(const box *a, const box *b)
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double w = fmax(a->hi[k], b->hi[k]) - fmin(a->lo[k], b->lo[k]);
        sum += w * w;
    }
    return (a->power + b->power) * sum;
}

static void join(box *out, const box *a, const box *b)
{
    for (int k = 0; k < 3; k++) {
        out->lo[k] = fmin(a->lo[k], b->lo[k]);
        out->hi[k] = fmax(a->hi[k], b->hi[k]);
    }
    out->power = a->power + b->power;
    out->live = true;
}

/* Sum of the metric over the pairs of a tree of point lights; pairs NULL: of the tree that merges the pair of
 * least metric in each step. */
static double sum_of(const lc_light *lights, const lc_build_pair *pairs, uint32_t n)
{
    box *b = calloc(2 * (size_t)n, sizeof *b);
    double sum = 0;
    if (!b) abort();
    for (uint32_t i = 0; i < n; i++) {
        const float x[3] = { lights[i].pos.x, lights[i].pos.y, lights[i].pos.z };
        for (int k = 0; k < 3; k++) b[i].lo[k] = b[i].hi[k] = (double)x[k];
        b[i].power = ((double)lights[i].intensity.x + (double)lights[i].intensity.y +
                      (double)lights[i].intensity.z) /
                     3;
        b[i].live = true;
    }
    for (uint32_t m = n; m < 2 * n - 1; m++) {
        uint32_t one = pairs ? pairs[m - n].child[0] : 0, two = pairs ? pairs[m - n].child[1] : 0;
        double least = INFINITY;
        for (uint32_t i = 0; i < m && !pairs; i++)
            for (uint32_t j = 0; j < i && b[i].live; j++)
                if (b[j].live && size_of(&b[i], &b[j]) < least) {
                    one = i;
                    two = j;
                    least = size_of(&b[i], &b[j]);
                }
        sum += size_of(&b[one], &b[two]);
        join(&b[m], &b[one], &b[two]);
        b[one].live = b[two].live = false;
    }
    free(b);
    return sum;
}

/* For few lights all pairs are looked at, and as the metric is reducible, pairs of mutual nearest neighbours
 * are those that greedy merging merges. */
TEST(few_lights_as_greedy)
{
    uint32_t n = 120;
    lc_build_pair *pairs = malloc(n * sizeof *pairs);
    if (!pairs) abort();
    for (uint32_t i = 0; i < 20; i++) {
        lc_light *lights = make(ROOM, n, LC_LIGHT_POINT);
        for (uint32_t k = 0; k < n; k++) lights[k].intensity.x = (float)rnd_in(0.1, 3);
        lc_build_input in = { lights, NULL, n, LC_LIGHT_POINT, 0 };
        CHECK(build(&in, 1, LC_ISA_BEST, pairs) == LC_OK);
        double want = sum_of(lights, NULL, n), got = sum_of(lights, pairs, n);
        CHECKF(fabs(got - want) < 1e-6 * want, "%g, not %g", got, want);
        free(lights);
    }
    free(pairs);
}

/* A light far away does not change the quality of the tree of the others. */
TEST(far_light_is_put_last)
{
    uint32_t n = 20000;
    lc_light *lights = make(ROOM, n + 1, LC_LIGHT_POINT);
    lc_build_pair *pairs = malloc(n * sizeof *pairs);
    if (!pairs) abort();
    lc_build_input in = { lights, NULL, n, LC_LIGHT_POINT, 0 };
    for (int negative = 0; negative < 2; negative++) {
        in.n = n;
        CHECK(build(&in, 2, LC_ISA_BEST, pairs) == LC_OK);
        double want = sum_of(lights, pairs, n);
        lights[n].pos = lc_f3_make(negative ? -1e10f : 1e10f, 0, 0);
        in.n = n + 1;
        CHECK(build(&in, 2, LC_ISA_BEST, pairs) == LC_OK);
        CHECK(pairs[n - 1].child[0] == n);
        for (uint32_t i = 0; i + 1 < n; i++) /* the tree without the far light */
            for (int k = 0; k < 2; k++) pairs[i].child[k] -= pairs[i].child[k] > n;
        double got = sum_of(lights, pairs, n);
        CHECKF(fabs(got - want) < 0.01 * want, "%g, not %g", got, want);
    }
    free(lights);
    free(pairs);
}

/* ---- memory ---- */

static lc_light *starved_lights;

static lc_status build_starved(lc_context *c)
{
    static lc_build_pair pairs[500];
    lc_build_input in = { starved_lights, NULL, 500, LC_LIGHT_ORIENTED, 1 };
    return lc_ploc(c, &in, pairs);
}

TEST(every_allocation_may_fail)
{
    starved_lights = make(ROOM, 500, LC_LIGHT_ORIENTED);
    starve(build_starved, 12);
    free(starved_lights);
}

TEST(bytes_a_light)
{
    uint32_t n = 100000;
    lc_build_pair *pairs = malloc(n * sizeof *pairs);
    if (!pairs) abort();
    for (int kind = 0; kind < LC_LIGHT_KINDS; kind++) {
        lc_light *lights = make(ROOM, n, (lc_light_kind)kind);
        lc_build_input in = { lights, NULL, n, (lc_light_kind)kind, lc_is_aimed((lc_light_kind)kind) };
        bytes_most = 0;
        CHECK(build(&in, 1, LC_ISA_BEST, pairs) == LC_OK);
        double bytes = (double)bytes_most / n;
        printf("  kind %d: %.1f bytes a light\n", kind, bytes);
        CHECKF(bytes < (lc_is_aimed((lc_light_kind)kind) ? 125 : 75), "kind %d: %g", kind, bytes);
        free(lights);
    }
    free(pairs);
}

int main(void)
{
    RUN(every_instruction_set_is_here);
    RUN(trees_of_all_lights);
    RUN(coincident_lights_are_balanced);
    RUN(same_for_threads_and_instruction_sets);
    RUN(index_as_a_copy);
    RUN(few_lights_as_greedy);
    RUN(far_light_is_put_last);
    RUN(every_allocation_may_fail);
    RUN(bytes_a_light);
    return test_done();
}
