/* unit_light_tree.c - light trees: what lc_light_tree_validate and, for small sets, a slow check of every node against
 * every light say; the builder against naive agglomeration; how often a light represents a node. */
#include "light_tree.h"
#include "rng.h"
#include "shade.h"
#include "stats.h"
#include "test.h"

#include <stdlib.h>

#define RND_KEY 20240607
#include "rnd.h"

static lc_context *ctx;

static lc_light rnd_light(lc_light_kind kind)
{
    lc_light l = { .kind = kind, .dir = rnd_unit(), .atten = { 0, 0, 1 } };
    l.pos = lc_f3_make((float)rnd_in(-1, 2), (float)rnd_in(-3, 4), (float)rnd_in(5, 6));
    l.intensity = lc_f3_make((float)rnd_in(0.1, 1), (float)rnd_in(0, 2), (float)rnd_in(0, 1));
    if (rnd() < 0.3)
        for (int k = 0; k < 3; k++) l.atten[k] = (float)rnd_in(0.1, 3);
    return l;
}

/* n lights of the kinds whose bit is set. */
static lc_light *rnd_lights(size_t n, uint32_t kinds)
{
    lc_light *l = malloc(n * sizeof *l);
    for (size_t i = 0; i < n; i++) {
        uint32_t kind;
        do kind = rnd_n(LC_LIGHT_KINDS);
        while (!(kinds >> kind & 1));
        l[i] = rnd_light((lc_light_kind)kind);
    }
    return l;
}

#define DIAG2 59.0 /* of the box of rnd_light */

static lc_light_tree *build(const lc_light *lights, size_t n, uint64_t seed, uint32_t n_reps)
{
    lc_light_tree *t;
    lc_light_tree_desc d = { lights, n, DIAG2, seed, n_reps };
    if (lc_light_tree_build(ctx, &d, &t)) abort();
    return t;
}

/* ---- the slow check ---- */

/* Lights under a node, to out; returns how many. stack: room for a small tree. */
static uint32_t lights_below(const lc_light_tree *t, uint32_t id, uint32_t *out)
{
    uint32_t stack[4096], n = 0, k = 0;
    stack[n++] = id;
    while (n) {
        uint32_t link = t->link[stack[--n]];
        if (link & LC_LEAF) out[k++] = link & ~LC_LEAF;
        else stack[n++] = link, stack[n++] = link + 1;
    }
    return k;
}

static double least_cosine(const lc_light_tree *t, uint32_t id, const uint32_t *below, uint32_t n)
{
    const lc_node_block *b = &t->blocks[id / LC_BLOCK];
    uint32_t lane = id % LC_BLOCK;
    double least = 1;
    for (uint32_t i = 0; i < n; i++) {
        long double dot = 0, a2 = 0, d2 = 0;
        for (int k = 0; k < 3; k++) {
            long double a = b->axis[k][lane], d = t->lights[below[i]].dir[k];
            dot += a * d, a2 += a * a, d2 += d * d;
        }
        least = fmin(least, (double)(dot / sqrtl(a2 * d2)));
    }
    return least;
}

static const char *slow_check_node(const lc_light_tree *t, uint32_t id, const uint32_t *below, uint32_t n)
{
    const lc_node_block *b = &t->blocks[id / LC_BLOCK];
    uint32_t lane = id % LC_BLOCK, kind = t->lights[below[0]].kind;
    bool mixed = false, rep_ok;
    for (uint32_t i = 0; i < n; i++) mixed |= t->lights[below[i]].kind != kind;
    if (lc_node_is_virtual(t, id) != (mixed && n > 1)) return "virtual";
    for (int k = 0; k < 3; k++) {
        long double sum = 0;
        for (uint32_t i = 0; i < n; i++) sum += (long double)t->lights[below[i]].intensity[k];
        long double p = (long double)b->power[k][lane];
        if (p < sum * (1 - 1e-15L) || p > sum * (1 + 0x1p-22L)) return "power";
    }
    for (uint32_t s = 0; s < t->n_reps; s++) {
        rep_ok = false;
        for (uint32_t i = 0; i < n; i++) rep_ok |= t->rep[(size_t)id * t->n_reps + s] == below[i];
        if (!rep_ok) return "rep";
    }
    if (mixed) return NULL;
    for (int k = 0; k < 3; k++) {
        float least = INFINITY;
        for (uint32_t i = 0; i < n; i++) {
            const lc_light_rec *l = &t->lights[below[i]];
            long double p = kind == LC_LIGHT_DIRECTIONAL ? -l->dir[k] : l->pos[k];
            if (fabsl(p - (long double)b->center[k][lane]) > (long double)b->half[k][lane]) return "box";
            least = fminf(least, l->atten[k]);
        }
        if (kind != LC_LIGHT_DIRECTIONAL && memcmp(&least, &b->atten[k][lane], sizeof least)) return "atten";
    }
    if (kind == LC_LIGHT_ORIENTED && (double)b->cos_cone[lane] > least_cosine(t, id, below, n) && b->cos_cone[lane] > -1)
        return "cone";
    return NULL;
}

static const char *slow_check(const lc_light_tree *t)
{
    uint32_t stack[4096], below[2048], n = 0;
    if (t->n_lights) stack[n++] = 0;
    while (n) {
        uint32_t id = stack[--n];
        const char *wrong = slow_check_node(t, id, below, lights_below(t, id, below));
        if (wrong) return wrong;
        if (!lc_node_is_leaf(t, id)) stack[n++] = t->link[id], stack[n++] = t->link[id] + 1;
    }
    return NULL;
}

static void expect_valid(const lc_light *l, size_t n, uint32_t n_reps, bool slow, const char *what)
{
    double t0 = lc_now();
    lc_light_tree *t = build(l, n, 7, n_reps);
    double t1 = lc_now();
    const char *wrong = lc_light_tree_validate(t);
    CHECKF(!wrong, "%s, %zu lights: %s", what, n, wrong);
    if (slow && !wrong) {
        wrong = slow_check(t);
        CHECKF(!wrong, "%s, %zu lights, slow check: %s", what, n, wrong);
    }
    if (n >= 5000) printf("  %s, %zu lights: build %.2f s, check %.2f s\n", what, n, t1 - t0, lc_now() - t1);
    lc_light_tree_destroy(t);
}

TEST(random_sets_are_valid)
{
    static const size_t sizes[] = { 1, 2, 3, 4, 5, 8, 17, 60, 300 };
    for (uint32_t kinds = 1; kinds < 8; kinds++)
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
            for (uint32_t rep = 0; rep < 4; rep++) {
                lc_light *l = rnd_lights(sizes[i], kinds);
                expect_valid(l, sizes[i], rep == 3 ? LC_MAX_REPS : 1 + rep, true, "random");
                free(l);
            }
    lc_light *l = rnd_lights(20000, 7);
    expect_valid(l, 20000, 1, false, "mixed");
    free(l);
}

TEST(no_lights)
{
    lc_light_tree *t = build(NULL, 0, 1, 1);
    CHECK(!lc_light_tree_validate(t) && t->n_lights == 0);
    lc_light_tree_destroy(t);
}

/* Narrow and wide sets of directions. */
TEST(cones_of_every_width)
{
    for (int i = 0; i < 200; i++) {
        lc_light *l = rnd_lights(40, 2);
        lc_f3 axis = rnd_unit();
        double spread = pow(10, rnd_in(-8, 1));
        for (int k = 0; k < 40; k++)
            l[k].dir = lc_f3_normalize(lc_f3_add(axis, lc_f3_scale(l[k].dir, (float)spread)));
        expect_valid(l, 40, 1, true, "cone");
        free(l);
    }
}

TEST(coincident_lights)
{
    for (int kind = 0; kind < LC_LIGHT_KINDS; kind++) {
        size_t n = 100000;
        lc_light *l = malloc(n * sizeof *l), one = rnd_light((lc_light_kind)kind);
        for (size_t i = 0; i < n; i++) l[i] = one;
        expect_valid(l, 300, 2, true, "coincident");
        expect_valid(l, n, 2, false, "coincident");
        for (size_t i = 0; i < n; i++) l[i].intensity = lc_f3_make((float)(1 + i % 7), 1, 1);
        expect_valid(l, n, 2, false, "coincident, unequal");
        free(l);
    }
}

/* Equal lights on an exact grid: every distance ties. */
TEST(grid_of_equal_lights)
{
    for (int kind = 0; kind < LC_LIGHT_KINDS; kind++) {
        lc_light *l = malloc(10000 * sizeof *l);
        for (int i = 0; i < 10000; i++) {
            l[i] = (lc_light){ .kind = (lc_light_kind)kind, .intensity = { 1, 1, 1 }, .atten = { 0, 0, 1 } };
            l[i].pos = lc_f3_make((float)(i % 100), 0, (float)(i / 100));
            l[i].dir = lc_f3_make(0, -1, 0);
            if (kind == LC_LIGHT_DIRECTIONAL)
                l[i].dir = lc_f3_normalize(lc_f3_make((float)(i % 100) / 64, -1, (float)(i / 100) / 64));
        }
        expect_valid(l, 10000, 1, false, "grid");
        free(l);
    }
}

TEST(lines_and_scales)
{
    for (int style = 0; style < 6; style++)
        for (int kind = 0; kind < LC_LIGHT_KINDS; kind++) {
            size_t n = 1500;
            lc_light *l = rnd_lights(n, 1u << kind);
            for (size_t i = 0; i < n; i++) {
                float f = (float)i;
                if (style == 0) l[i].pos = lc_f3_make(f, f, f);
                if (style == 1) l[i].pos = lc_f3_make(ldexpf(1, (int)(i % 90) - 60), 0, 0); /* geometric: a deep tree */
                if (style == 2) l[i].intensity = lc_f3_scale(l[i].intensity, powf(10, (float)rnd_in(-15, 15)));
                if (style == 3) l[i].pos = lc_f3_scale(l[i].pos, 1e-12f);
                if (style == 4) l[i].pos = lc_f3_add(l[i].pos, lc_f3_make(1e6f, -1e7f, 1e5f));
                if (style == 5) l[i].pos = lc_f3_scale(l[i].pos, powf(10, (float)rnd_in(-14, 14)));
            }
            expect_valid(l, n, 1, true, "style");
            free(l);
        }
}

/* Coordinates so far apart that their difference doesn't fit into a double. */
TEST(boxes_are_exact)
{
    static const float tiny[] = { 1e-20f, -1e-20f, 1e-10f, 1e-30f, 3e-39f };
    for (size_t i = 0; i < sizeof tiny / sizeof *tiny; i++)
        for (int sign = -1; sign <= 1; sign += 2) {
            lc_light l[2] = { rnd_light(LC_LIGHT_POINT), rnd_light(LC_LIGHT_POINT) };
            l[0].pos = lc_f3_make((float)(sign * 2), 1, 1);
            l[1].pos = lc_f3_make(tiny[i], 1, 1);
            expect_valid(l, 2, 1, true, "far apart");
        }
}

/* ---- representatives ---- */

#define N_FREQ 24
#define FREQ_SEEDS 6000

/* z: how many standard errors a frequency is off; over all nodes, lights and slots, and chi-square of the root. */
TEST(representatives_are_as_frequent_as_bright)
{
    static uint32_t count[2 * N_FREQ][2][N_FREQ];
    uint32_t below[2048], both = 0;
    lc_light *l = rnd_lights(N_FREQ, 7);
    memset(count, 0, sizeof count);
    for (uint64_t seed = 0; seed < FREQ_SEEDS; seed++) {
        lc_light_tree *t = build(l, N_FREQ, lc_mix(seed), 3);
        for (uint32_t id = 0; id < 2 * N_FREQ; id++)
            for (uint32_t s = 0; s < 2 && id != 1; s++) count[id][s][t->rep[id * 3 + 2 * s]]++;
        both += t->rep[0] == t->rep[2];
        if (seed + 1 < FREQ_SEEDS) lc_light_tree_destroy(t);
        else {
            double worst = 0, chi2 = 0, same = 0, total = 0;
            for (uint32_t id = 0; id < 2 * N_FREQ; id++) {
                if (id == 1) continue;
                double sum = 0;
                uint32_t n = lights_below(t, id, below);
                for (uint32_t i = 0; i < n; i++) {
                    lc_f3 e = lc_f3_load(t->lights[below[i]].intensity);
                    sum += ((double)e.x + e.y + e.z) / 3;
                }
                for (uint32_t i = 0; i < n && n > 1; i++)
                    for (uint32_t s = 0; s < 2; s++) {
                        lc_f3 e = lc_f3_load(t->lights[below[i]].intensity);
                        double p = ((double)e.x + e.y + e.z) / 3 / sum, want = p * FREQ_SEEDS;
                        double off = count[id][s][below[i]] - want;
                        worst = fmax(worst, fabs(off) / sqrt(want * (1 - p)));
                        if (id == 0) chi2 += off * off / want, same += p * p / 2;
                        total++;
                    }
            }
            /* some 300 normal deviates: 4.5 is passed once in 500 sets; chi-square of 46 degrees: 46 +- 9.6 */
            CHECKF(worst < 4.5, "%.2f standard errors, %g frequencies", worst, total);
            CHECKF(chi2 < 46 + 4 * 9.6 && chi2 > 46 - 4 * 9.6, "chi-square %.1f of 46 degrees", chi2);
            double err = sqrt(same * (1 - same) / FREQ_SEEDS);
            CHECKF(fabs(both / (double)FREQ_SEEDS - same) < 4.5 * err, "slots 0 and 2 agree in %u, %g expected", both,
                   same * FREQ_SEEDS);
            lc_light_tree_destroy(t);
        }
    }
    free(l);
}

static bool same_tree(const lc_light_tree *a, const lc_light_tree *b, bool reps)
{
    size_t n = 2 * a->n_pairs;
    return a->n_pairs == b->n_pairs && a->n_blocks == b->n_blocks
           && !memcmp(a->blocks, b->blocks, a->n_blocks * sizeof *a->blocks) && !memcmp(a->link, b->link, n * sizeof *a->link)
           && !memcmp(a->pair_kind, b->pair_kind, a->n_pairs)
           && (!reps || !memcmp(a->rep, b->rep, n * a->n_reps * sizeof *a->rep));
}

TEST(same_input_same_tree)
{
    lc_light *l = rnd_lights(3000, 7);
    lc_light_tree *a = build(l, 3000, 5, 4), *b = build(l, 3000, 5, 4), *c = build(l, 3000, 6, 4);
    CHECK(same_tree(a, b, true));
    CHECK(same_tree(a, c, false)); /* the seed is of representatives only */
    CHECK(!same_tree(a, c, true));
    lc_light_tree_destroy(a), lc_light_tree_destroy(b), lc_light_tree_destroy(c);
    free(l);
}

/* ---- damage ---- */

#define N_HURT 48

typedef struct {
    lc_node_block blocks[(2 * N_HURT + LC_BLOCK - 1) / LC_BLOCK];
    uint32_t link[2 * N_HURT], rep[2 * N_HURT * 3];
    uint8_t pair_kind[N_HURT];
    lc_light_rec lights[N_HURT];
} saved;

static lc_light_tree *hurt_tree;
static saved before;

static void restore(void)
{
    memcpy(hurt_tree->blocks, before.blocks, sizeof before.blocks);
    memcpy(hurt_tree->link, before.link, sizeof before.link);
    memcpy(hurt_tree->rep, before.rep, sizeof before.rep);
    memcpy(hurt_tree->pair_kind, before.pair_kind, sizeof before.pair_kind);
    memcpy(hurt_tree->lights, before.lights, sizeof before.lights);
}

static uint32_t n_hurt; /* damages tried by the running test */

static void expect_complaint(uint32_t id, int line)
{
    const char *wrong = lc_light_tree_validate(hurt_tree);
    n_hurt++;
    CHECKF(wrong, "damage of line %d to node %u goes unseen", line, id);
    restore();
}
#define HURT(change) (change, expect_complaint(id, __LINE__))

static void begin_damage(uint32_t kinds)
{
    lc_light *l = rnd_lights(N_HURT, kinds);
    hurt_tree = build(l, N_HURT, 11, 3);
    free(l);
    memcpy(before.blocks, hurt_tree->blocks, sizeof before.blocks);
    memcpy(before.link, hurt_tree->link, sizeof before.link);
    memcpy(before.rep, hurt_tree->rep, sizeof before.rep);
    memcpy(before.pair_kind, hurt_tree->pair_kind, sizeof before.pair_kind);
    memcpy(before.lights, hurt_tree->lights, sizeof before.lights);
    n_hurt = 0;
}

static void end_damage(void)
{
    CHECK(n_hurt > N_HURT);
    CHECK(!lc_light_tree_validate(hurt_tree));
    lc_light_tree_destroy(hurt_tree);
}

TEST(damaged_links_are_found)
{
    for (uint32_t kinds = 1; kinds < 8; kinds++) {
        begin_damage(kinds);
        lc_light_tree *t = hurt_tree;
        for (uint32_t id = 0; id < 2 * N_HURT; id++) {
            if (id == 1) continue;
            uint32_t link = t->link[id];
            HURT(t->link[id] = (link & LC_LEAF) | 0x7ffffff0u);
            HURT(t->link[id] = id & ~1u);
            HURT(t->link[id] = 0);
            if (link & LC_LEAF) {
                HURT(t->link[id] ^= 1);
                HURT(t->link[id] = LC_LEAF | N_HURT);
                HURT(t->link[id] = 2);
            } else {
                HURT(t->link[id]++);
                HURT(t->link[id] = link == 2 ? 4 : 2);
                HURT(t->link[id] = 2 * N_HURT);
                HURT(t->link[id] = LC_LEAF | t->rep[3 * id]);
                HURT(t->pair_kind[link / 2] = (uint8_t)((t->pair_kind[link / 2] + 1) % 4));
                HURT(t->pair_kind[link / 2] = 77);
            }
        }
        uint32_t id = 0;
        HURT(t->pair_kind[0] = (uint8_t)((t->pair_kind[0] + 1) % 3));
        t->n_of_kind[0]++, expect_complaint(0, __LINE__), t->n_of_kind[0]--;
        t->n_pairs--, expect_complaint(0, __LINE__), t->n_pairs++;
        t->n_reps = 0, expect_complaint(0, __LINE__), t->n_reps = 3;
        HURT(t->lights[5].kind = 3);
        HURT(t->lights[5].kind = (t->lights[5].kind + 1) % 3);
        end_damage();
    }
}

TEST(damaged_numbers_are_found)
{
    uint32_t below[2048];
    for (uint32_t kinds = 1; kinds < 8; kinds++) {
        begin_damage(kinds);
        lc_light_tree *t = hurt_tree;
        for (uint32_t id = 0; id < 2 * N_HURT; id++) {
            if (id == 1) continue;
            lc_node_block *b = &t->blocks[id / LC_BLOCK];
            uint32_t k = id % LC_BLOCK, n = lights_below(t, id, below);
            bool is_virtual = lc_node_is_virtual(t, id);
            uint32_t kind = t->lights[below[0]].kind;
            for (int i = 0; i < 3; i++) {
                HURT(b->power[i][k] = nextafterf(b->power[i][k], 0));
                HURT(b->power[i][k] *= 1.00001f);
                HURT(b->power[i][k] = NAN);
                HURT(b->power[i][k] = INFINITY);
                if (is_virtual) continue;
                HURT(b->half[i][k] = n > 1 ? nextafterf(b->half[i][k], 0) : -1e-30f);
                HURT(b->half[i][k] = NAN);
                HURT(b->center[i][k] = b->center[i][k] + b->half[i][k] * 0.5f + 0.001f);
                HURT(b->center[i][k] = NAN);
                if (kind == LC_LIGHT_DIRECTIONAL) continue;
                HURT(b->atten[i][k] = nextafterf(b->atten[i][k], 100));
                HURT(b->atten[i][k] = nextafterf(b->atten[i][k], -100));
            }
            if (is_virtual || kind != LC_LIGHT_ORIENTED) continue;
            double least = least_cosine(t, id, below, n);
            HURT(b->cos_cone[k] = 1.01f);
            HURT(b->cos_cone[k] = -1.01f);
            HURT(b->cos_cone[k] = NAN);
            if (b->cos_cone[k] <= -1) continue;
            if (least < 0.99999) HURT(b->cos_cone[k] = (float)(least + 1e-6));
            if (b->cos_cone[k] > 0) HURT((b->axis[0][k] *= -1, b->axis[1][k] *= -1, b->axis[2][k] *= -1));
            HURT(b->axis[0][k] += 2);
            /* A cone narrower than the box of directions gives, but right. */
            b->cos_cone[k] = nextafterf((float)least, -2);
            CHECK(!lc_light_tree_validate(t));
            restore();
        }
        for (uint32_t id = 0; id < N_HURT; id++) { /* here: of lights */
            HURT(t->lights[id].intensity[1] *= 1.001f);
            HURT(t->lights[id].intensity[1] += 0.1f);
            if (t->lights[id].kind == LC_LIGHT_POINT) HURT(t->lights[id].pos[2] += 1e-5f);
            if (t->lights[id].kind == LC_LIGHT_DIRECTIONAL) HURT(t->lights[id].dir[2] += 1e-6f);
            if (t->lights[id].kind != LC_LIGHT_DIRECTIONAL) HURT(t->lights[id].atten[2] *= 0.99f);
        }
        end_damage();
    }
}

TEST(damaged_representatives_are_found)
{
    uint32_t below[2048];
    for (uint32_t kinds = 1; kinds < 8; kinds++) {
        begin_damage(kinds);
        lc_light_tree *t = hurt_tree;
        for (uint32_t id = 0; id < 2 * N_HURT; id++) {
            if (id == 1) continue;
            uint32_t n = lights_below(t, id, below), first = t->link[id];
            for (uint32_t s = 0; s < 3; s++) {
                HURT(t->rep[3 * id + s] = N_HURT);
                for (uint32_t light = 0; light < N_HURT; light++) {
                    bool fine = lc_node_is_leaf(t, id) ? light == below[0]
                                                       : light == t->rep[3 * first + s] || light == t->rep[3 * (first + 1) + s];
                    if (!fine && (n > 1 || light % 8 == 0)) HURT(t->rep[3 * id + s] = light);
                }
            }
        }
        end_damage();
    }
}

int main(void)
{
    if (lc_context_create(NULL, &ctx)) return 1;
    printf("seed %llu\n", (unsigned long long)rng_key);
    RUN(no_lights);
    RUN(random_sets_are_valid);
    RUN(cones_of_every_width);
    RUN(lines_and_scales);
    RUN(boxes_are_exact);
    RUN(representatives_are_as_frequent_as_bright);
    RUN(same_input_same_tree);
    RUN(damaged_links_are_found);
    RUN(damaged_numbers_are_found);
    RUN(damaged_representatives_are_found);
    RUN(grid_of_equal_lights);
    RUN(coincident_lights);
    lc_context_destroy(ctx);
    return test_done();
}
