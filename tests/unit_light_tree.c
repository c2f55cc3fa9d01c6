/* unit_light_tree.c - light trees: what lc_light_tree_validate and, for small sets, a slow check of every
 * node against every light say; how often a light represents a node. */
#include "base/rng.h"
#include "base/stats.h"
#include "shade/dir_pack.h"
#include "shade/point_init.h"
#include "support/some_profiles.h"
#include "support/test.h"
#include "tree/light_tree.h"

#include <stdlib.h>

#define RND_KEY 20240607
#include "support/rnd.h"

static lc_context *ctx;

static lc_light rnd_light(lc_light_kind kind)
{
    lc_light l = { .kind = kind, .dir = rnd_unit(), .atten = { 0, 0, 1 } };
    l.pos = lc_f3_make((float)rnd_in(-1, 2), (float)rnd_in(-3, 4), (float)rnd_in(5, 6));
    l.intensity = lc_f3_make((float)rnd_in(0.1, 1), (float)rnd_in(0, 2), (float)rnd_in(0, 1));
    if (kind == LC_LIGHT_SPOT) l.spot = (lc_spot){ (float)rnd_in(-0.5, 0.5), (float)rnd_in(0.5, 1), 0 };
    else if (kind == LC_LIGHT_LUMINAIRE) be_luminaire(&l, rnd_n(2 * N_PROFILES), rnd_in(-4, 4));
    else if (lc_is_sized(kind)) l.radius = (float)rnd_in(0.001, 0.1);
    else if (rnd() < 0.3)
        for (int k = 0; k < 3; k++) l.atten[k] = (float)rnd_in(0.1, 3);
    return l;
}

/* n lights of the kinds whose bit is set. */
static lc_light *rnd_lights(size_t n, uint32_t kinds)
{
    lc_light *l = malloc(n * sizeof *l);
    for (size_t i = 0; i < n; i++) {
        uint32_t kind;
        do kind = rnd_n(kinds_in(kinds));
        while (!(kinds >> kind & 1));
        l[i] = rnd_light((lc_light_kind)kind);
    }
    return l;
}

#define DIAG2 59.0 /* of the box of rnd_light */

static lc_builder builder = LC_BUILDER_EXACT; /* of build */

static lc_light_tree *build(const lc_light *lights, size_t n, uint64_t seed, uint32_t n_reps)
{
    lc_light_tree *t;
    lc_light_tree_desc d = { .lights = lights,
                             .n_lights = n,
                             .profiles = some_profiles(),
                             .diag2 = DIAG2,
                             .seed = seed,
                             .n_reps = n_reps,
                             .builder = builder };
    if (lc_light_tree_build(ctx, &d, &t)) abort();
    return t;
}

/* ---- the slow check ---- */

static lc_f3 direction(const lc_light_rec *l)
{
    return lc_dir_unpack((const uint32_t[2]){ l->dir_a, l->dir_b });
}

/* Lights under a cluster, to out; returns how many. stack: room for a small tree. */
static uint32_t lights_below(const lc_light_tree *t, uint32_t id, uint32_t *out)
{
    uint32_t stack[4096], n = 0, k = 0;
    stack[n++] = id;
    while (n) {
        uint32_t link = stack[--n];
        if (link & LC_LEAF) out[k++] = link & ~LC_LEAF;
        else {
            stack[n++] = t->data.nodes[link].left;
            stack[n++] = t->data.nodes[link].right;
        }
    }
    return k;
}

static double least_cosine(const lc_light_tree *t, uint32_t id, const uint32_t *below, uint32_t n)
{
    const lc_node *b = &t->data.nodes[id];
    double least = 1;
    for (uint32_t i = 0; i < n; i++) {
        long double dot = 0, a2 = 0, d2 = 0;
        lc_f3 dir = direction(&t->data.lights[below[i]]);
        for (int k = 0; k < 3; k++) {
            long double a = b->axis[k], d = (&dir.x)[k];
            dot += a * d;
            a2 += a * a;
            d2 += d * d;
        }
        least = fmin(least, (double)(dot / sqrtl(a2 * d2)));
    }
    return least;
}

static const char *slow_check_node(const lc_light_tree *t, uint32_t id, const uint32_t *below, uint32_t n)
{
    const lc_node *b = &t->data.nodes[id];
    lc_light_kind kind = lc_kind_of_node(t, id);
    for (uint32_t i = 0; i < n; i++)
        if (lc_kind_of_light(t, below[i]) != kind) return "kind";
    for (int k = 0; k < 3; k++) {
        long double sum = 0;
        for (uint32_t i = 0; i < n; i++) sum += (long double)t->data.lights[below[i]].intensity[k];
        long double p = (long double)b->intensity[k];
        if (p < sum * (1 - 1e-15L) || p > sum * (1 + 0x1p-22L)) return "power";
    }
    for (uint32_t s = 0; s < t->n_reps; s++) {
        uint32_t own = lc_rep_of(t, id, s), is_below = 0;
        for (uint32_t i = 0; i < n; i++) is_below += below[i] == own;
        if (is_below != 1 || (own != lc_rep_of(t, b->left, s) && own != lc_rep_of(t, b->right, s)))
            return "rep";
    }
    for (int k = 0; k < 3; k++) {
        float least = INFINITY;
        for (uint32_t i = 0; i < n; i++) {
            long double p = t->data.lights[below[i]].pos[k];
            const float *atten = lc_light_atten(&t->data, below[i]);
            if (fabsl(p - (long double)b->center[k]) > (long double)b->half[k]) return "box";
            if (atten) least = fminf(least, atten[k]);
        }
        if (kind > LC_LIGHT_ORIENTED) continue;
        if (!t->data.node_atten != !t->data.light_atten) return "atten";
        if (t->data.node_atten && memcmp(&least, &t->data.node_atten[id][k], sizeof least)) return "atten";
    }
    if (lc_is_aimed(kind) && (double)b->cos_cone > least_cosine(t, id, below, n) && b->cos_cone > -1)
        return "cone";
    return NULL;
}

static const char *slow_check(const lc_light_tree *t)
{
    uint32_t below[2048];
    for (uint32_t id = 0; id < t->n_nodes; id++) {
        const char *wrong = slow_check_node(t, id, below, lights_below(t, id, below));
        if (wrong) return wrong;
    }
    return NULL;
}

/* With both builders. */
static void expect_valid(const lc_light *l, size_t n, uint32_t n_reps, bool slow, const char *what)
{
    for (builder = LC_BUILDER_EXACT; builder <= LC_BUILDER_PLOC; builder++) {
        double t0 = lc_now();
        lc_light_tree *t = build(l, n, 7, n_reps);
        double t1 = lc_now();
        const char *wrong = lc_light_tree_validate(t);
        CHECKF(!wrong, "%s, %zu lights: %s", what, n, wrong);
        if (slow && !wrong) {
            wrong = slow_check(t);
            CHECKF(!wrong, "%s, %zu lights, slow check: %s", what, n, wrong);
        }
        if (n >= 5000)
            printf("  %s, %zu lights, %s: build %.2f s, check %.2f s\n", what, n,
                   builder == LC_BUILDER_PLOC ? "ploc" : "exact", t1 - t0, lc_now() - t1);
        lc_light_tree_destroy(t);
    }
    builder = LC_BUILDER_EXACT;
}

TEST(random_sets_are_valid)
{
    static const size_t sizes[] = { 1, 2, 3, 4, 5, 8, 17, 60, 300 };
    for (uint32_t set = 0; set < LIGHT_SETS; set++)
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
            for (uint32_t rep = 0; rep < 4; rep++) {
                lc_light *l = rnd_lights(sizes[i], light_set(set));
                expect_valid(l, sizes[i], rep == 3 ? LC_MAX_REPS : 1 + rep, true, "random");
                free(l);
            }
    lc_light *l = rnd_lights(20000, 7);
    expect_valid(l, 20000, 1, false, "mixed");
    free(l);
}

static bool same_tree(const lc_light_tree *a, const lc_light_tree *b, bool reps)
{
    bool same = a->n_nodes == b->n_nodes && a->n_lights == b->n_lights &&
                !memcmp(a->root, b->root, sizeof a->root);
    for (uint32_t i = 0; i < a->n_nodes && same; i++) {
        lc_node x = a->data.nodes[i], y = b->data.nodes[i];
        if (!reps) x.rep = y.rep = 0;
        same = !memcmp(&x, &y, sizeof x);
    }
    same = same && !memcmp(a->data.lights, b->data.lights, a->n_lights * sizeof *a->data.lights);
    if (!reps || a->n_reps < 2) return same;
    return same && !memcmp(a->reps, b->reps, a->n_nodes * a->n_reps * sizeof *a->reps);
}

/* The finished tree, not only its shape, is the same for any number of threads and every instruction set. */
TEST(same_tree_for_threads_and_instruction_sets)
{
    static const uint32_t threads[] = { 1, 2, 3, 8 };
    const uint32_t n_threads = ctx->n_threads;
    const lc_isa isa = ctx->isa;
    lc_light *l = rnd_lights(60000, 7);
    for (builder = LC_BUILDER_EXACT; builder <= LC_BUILDER_PLOC; builder++) {
        lc_light_tree *want = NULL;
        for (int i = 0; i < 4; i++) {
            ctx->n_threads = threads[i];
            ctx->isa = LC_ISA_SCALAR + i < (int)isa ? (lc_isa)(LC_ISA_SCALAR + i) : isa;
            lc_light_tree *t = build(l, 60000, 3, 3);
            CHECKF(!want || same_tree(want, t, true), "builder %d, %u threads, %s", (int)builder, threads[i],
                   lc_isa_name(ctx->isa));
            if (want) lc_light_tree_destroy(t);
            else want = t;
        }
        lc_light_tree_destroy(want);
    }
    builder = LC_BUILDER_EXACT;
    ctx->n_threads = n_threads;
    ctx->isa = isa;
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

TEST(a_million_coincident_lights)
{
    size_t n = 1000000;
    lc_light *l = malloc(n * sizeof *l), one = rnd_light(LC_LIGHT_ORIENTED);
    for (size_t i = 0; i < n; i++) l[i] = one;
    expect_valid(l, n, 1, false, "coincident");
    free(l);
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
            if (kind == LC_LIGHT_SPOT) l[i].spot = (lc_spot){ 0.5f, 0.75f, 0 };
            if (kind == LC_LIGHT_LUMINAIRE) be_luminaire(&l[i], 0, 0);
            if (lc_is_sized((lc_light_kind)kind)) l[i].radius = 0.01f;
            if (lc_is_far((lc_light_kind)kind))
                l[i].dir = lc_f3_normalize(lc_f3_make((float)(i % 100) / 64, -1, (float)(i / 100) / 64));
        }
        expect_valid(l, 10000, 1, false, "grid");
        free(l);
    }
}

enum { LINE, GEOMETRIC, DECADES, TINY, FAR_AWAY, SCALES, BLACK, HALF_BLACK, QUADRATIC, OUTLIER, STYLES };

/* Makes light i of n one of a set that is hard in some way. */
static void hurt(lc_light *l, int style, size_t i)
{
    float f = (float)i;
    switch (style) {
    case LINE: l->pos = lc_f3_make(f, f, f); break;
    case GEOMETRIC: l->pos = lc_f3_make(ldexpf(1, (int)(i % 90) - 60), 0, 0); break; /* a deep tree */
    case DECADES: l->intensity = lc_f3_scale(l->intensity, powf(10, (float)rnd_in(-15, 15))); break;
    case TINY: l->pos = lc_f3_scale(l->pos, 1e-12f); break;
    case FAR_AWAY: l->pos = lc_f3_add(l->pos, lc_f3_make(1e6f, -1e7f, 1e5f)); break;
    case SCALES: l->pos = lc_f3_scale(l->pos, powf(10, (float)rnd_in(-14, 11))); break;
    case BLACK: l->intensity = lc_f3_make(0, 0, 0); break;
    case HALF_BLACK: l->intensity = i % 2 ? lc_f3_make(0, 0, 0) : l->intensity; break;
    case QUADRATIC: l->pos = lc_f3_make(f * f, 0, 0), l->intensity = lc_f3_make(1, 1, 1); break;
    case OUTLIER: l->pos = i == 7 ? lc_f3_make(1e10f, 0, 0) : l->pos; break;
    default: break;
    }
}

TEST(lines_and_scales)
{
    static const size_t sizes[] = { 1500, 50000 };
    for (int style = 0; style < STYLES; style++)
        for (int kind = 0; kind < LC_LIGHT_KINDS; kind++)
            for (int k = 0; k < 2; k++) {
                char what[32];
                snprintf(what, sizeof what, "style %d, kind %d", style, kind);
                lc_light *l = rnd_lights(sizes[k], 1u << kind);
                for (size_t i = 0; i < sizes[k]; i++) hurt(&l[i], style, i);
                expect_valid(l, sizes[k], 1, !k, what);
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

#define N_FREQ 96
#define FREQ_SEEDS 2500

static double power_of(const lc_light_tree *t, uint32_t light)
{
    lc_f3 e = lc_f3_load(t->data.lights[light].intensity);
    return ((double)e.x + e.y + e.z) / 3;
}

static double power_below(const lc_light_tree *t, uint32_t link)
{
    uint32_t below[2048], n = lights_below(t, link, below);
    double sum = 0;
    for (uint32_t i = 0; i < n; i++) sum += power_of(t, below[i]);
    return sum;
}

typedef struct {
    uint16_t count[LC_MAX_REPS][N_FREQ][N_FREQ]; /* slot, node, light */
    double worst, worst_sum, chi2; /* standard errors: of one slot, of all together; of the root in slot 0 */
    uint32_t n;
} frequencies;

static void judge_node(frequencies *f, const lc_light_tree *t, uint32_t id)
{
    uint32_t below[2048], n = lights_below(t, id, below);
    double sum = power_below(t, id);
    for (uint32_t i = 0; i < n; i++) {
        double p = power_of(t, below[i]) / sum, want = p * FREQ_SEEDS, err = sqrt(want * (1 - p)), all = 0;
        for (uint32_t s = 0; s < LC_MAX_REPS; s++) {
            double off = f->count[s][id][below[i]] - want;
            f->worst = fmax(f->worst, fabs(off) / err);
            if (id == 0 && s == 0) f->chi2 += off * off / want;
            all += off;
            f->n++;
        }
        /* Or less: slots don't agree by chance. */
        f->worst_sum = fmax(f->worst_sum, fabs(all) / (err * sqrt(LC_MAX_REPS)));
    }
}

static void count_frequencies(frequencies *f, const lc_light *l)
{
    for (uint64_t seed = 0; seed < FREQ_SEEDS; seed++) {
        lc_light_tree *t = build(l, N_FREQ, lc_mix(seed), LC_MAX_REPS);
        for (uint32_t s = 0; s < LC_MAX_REPS; s++)
            for (uint32_t id = 0; id < t->n_nodes; id++) f->count[s][id][lc_rep_of(t, id, s)]++;
        for (uint32_t id = 0; id < t->n_nodes && seed + 1 == FREQ_SEEDS; id++) judge_node(f, t, id);
        lc_light_tree_destroy(t);
    }
}

/* Over all nodes, lights and slots, with both builders. */
TEST(representatives_are_as_frequent_as_bright)
{
    static frequencies f;
    for (int b = 0; b < 2; b++)
        for (uint32_t kind = 0; kind < LC_LIGHT_KINDS; kind++) {
            lc_light *l = rnd_lights(N_FREQ, 1u << kind);
            builder = b ? LC_BUILDER_PLOC : LC_BUILDER_EXACT;
            f = (frequencies){ .n = 0 };
            count_frequencies(&f, l);
            /* some 25000 normal deviates, 800 of sums: 5.5 is passed once in 1000 sets; chi-square of 95
             * degrees: 95 +- 13.8 */
            CHECKF(f.worst < 5.5, "kind %u: %.2f standard errors", kind, f.worst);
            CHECKF(f.worst_sum < 4.5, "kind %u: %.2f standard errors of all slots", kind, f.worst_sum);
            CHECKF(fabs(f.chi2 - 95) < 4 * 13.8, "kind %u: chi-square %.1f of 95 degrees", kind, f.chi2);
            printf("  builder %d, kind %u: %u frequencies, worst %.2f standard errors, of all slots %.2f, "
                   "chi-square %.0f\n",
                   b, kind, f.n, f.worst, f.worst_sum, f.chi2);
            free(l);
        }
    builder = LC_BUILDER_EXACT;
}

/* Of the slots of a node, as many choose a child as its share of the intensity says, but for one. */
TEST(slots_share_out_the_children)
{
    for (uint32_t n_reps = 1; n_reps <= LC_MAX_REPS; n_reps += 1 + n_reps / 3) {
        lc_light *l = rnd_lights(500, 7);
        lc_light_tree *t = build(l, 500, n_reps, n_reps);
        for (uint32_t id = 0; id < t->n_nodes; id++) {
            double left = power_below(t, t->data.nodes[id].left),
                   share = n_reps * left / (left + power_below(t, t->data.nodes[id].right));
            uint32_t n = 0;
            for (uint32_t s = 0; s < n_reps; s++)
                n += lc_rep_of(t, id, s) == lc_rep_of(t, t->data.nodes[id].left, s);
            CHECKF(fabs(n - share) < 1 + 1e-9, "%u of %u slots, share %.3f", n, n_reps, share);
        }
        lc_light_tree_destroy(t);
        free(l);
    }
}

/* Adds how far the number of a node's slots that come to a cluster below is from its share. */
static void add_below(const lc_light_tree *t, uint32_t id, uint32_t below, uint32_t depth,
                      double *worst, double sum[2])
{
    const double share = t->n_reps * power_below(t, below) / power_below(t, id);
    uint32_t n = 0;
    if (below & LC_LEAF) return;
    for (uint32_t s = 0; s < t->n_reps; s++) n += lc_rep_of(t, id, s) == lc_rep_of(t, below, s);
    if (depth) {
        *worst = fmax(*worst, fabs(n - share));
        sum[0] += (n - share) * (n - share);
        sum[1] += share * (1 - share / t->n_reps);
    }
    if (depth == 3) return;
    add_below(t, id, t->data.nodes[below].left, depth + 1, worst, sum);
    add_below(t, id, t->data.nodes[below].right, depth + 1, worst, sum);
}

/* And of those that choose a child as many choose each of its children, and of these, as their shares say:
 * the variance is at most a fifth of that of slots by chance. */
TEST(slots_share_out_what_is_below)
{
    double worst = 0, sum[2] = { 0, 0 };
    lc_light *l = rnd_lights(2000, 7);
    lc_light_tree *t = build(l, 2000, 16, 16);
    for (uint32_t id = 0; id < t->n_nodes; id++) add_below(t, id, id, 0, &worst, sum);
    printf("  worst %.2f slots, variance %.3f of that by chance\n", worst, sum[0] / sum[1]);
    CHECKF(worst < 3, "%g slots", worst);
    CHECKF(sum[0] < 0.2 * sum[1], "%g of the variance", sum[0] / sum[1]);
    lc_light_tree_destroy(t);
    free(l);
}

TEST(same_input_same_tree)
{
    lc_light *l = rnd_lights(3000, 7);
    lc_light_tree *a = build(l, 3000, 5, 4), *b = build(l, 3000, 5, 4), *c = build(l, 3000, 6, 4);
    CHECK(same_tree(a, b, true));
    CHECK(same_tree(a, c, false)); /* the seed is of representatives only */
    CHECK(!same_tree(a, c, true));
    lc_light_tree_destroy(a);
    lc_light_tree_destroy(b);
    lc_light_tree_destroy(c);
    free(l);
}

/* ---- damage ---- */

#define N_HURT 48

typedef struct {
    lc_light_tree tree;
    lc_node nodes[N_HURT];
    lc_light_rec lights[N_HURT];
    lc_atten node_atten[N_HURT], light_atten[N_HURT];
    uint32_t reps[N_HURT * 3];
} saved;

static lc_light_tree *hurt_tree;
static saved before;

static void copy(saved *s, lc_light_tree *t, bool back)
{
    struct {
        void *a, *b;
        size_t size;
    } parts[] = { { s->nodes, t->data.nodes, t->n_nodes * sizeof *s->nodes },
                  { s->lights, t->data.lights, sizeof s->lights },
                  { s->node_atten, t->data.node_atten, t->n_nodes * sizeof *s->node_atten },
                  { s->light_atten, t->data.light_atten, sizeof s->light_atten },
                  { s->reps, t->reps, 3 * t->n_nodes * sizeof *s->reps } };
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        if (back) memcpy(parts[i].b, parts[i].a, parts[i].size);
        else memcpy(parts[i].a, parts[i].b, parts[i].size);
    }
}

static void restore(void)
{
    *hurt_tree = before.tree;
    copy(&before, hurt_tree, true);
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
    l[0].atten[1] = 0.5f; /* so that there are attenuations, if it is not directional */
    if (kinds != 4) l[0].kind = kinds & 1 ? LC_LIGHT_POINT : LC_LIGHT_ORIENTED;
    hurt_tree = build(l, N_HURT, 11, 3);
    free(l);
    before.tree = *hurt_tree;
    if (kinds != 4) {
        copy(&before, hurt_tree, false);
    } else { /* no attenuations: give it room to copy */
        hurt_tree->data.node_atten = calloc(N_HURT, sizeof(lc_atten));
        hurt_tree->data.light_atten = calloc(N_HURT, sizeof(lc_atten));
        copy(&before, hurt_tree, false);
        before.tree = *hurt_tree;
    }
    n_hurt = 0;
}

static void end_damage(uint32_t kinds)
{
    CHECK(n_hurt > N_HURT);
    CHECK(!lc_light_tree_validate(hurt_tree));
    if (kinds == 4) {
        free(hurt_tree->data.node_atten);
        free(hurt_tree->data.light_atten);
        hurt_tree->data.node_atten = hurt_tree->data.light_atten = NULL;
    }
    lc_light_tree_destroy(hurt_tree);
}

TEST(damaged_links_are_found)
{
    for (uint32_t kinds = 1; kinds < 8; kinds++) {
        begin_damage(kinds);
        lc_light_tree *t = hurt_tree;
        for (uint32_t id = 0; id < t->n_nodes; id++) {
            lc_node *b = &t->data.nodes[id];
            for (int side = 0; side < 2; side++) {
                uint32_t *link = side ? &b->right : &b->left, was = *link;
                HURT(*link = (was & LC_LEAF) | 0x7ffffff0u);
                HURT(*link = id);
                HURT(*link = t->first_node[lc_kind_of_node(t, id)]);
                HURT(*link = side ? b->left : b->right);
                HURT(*link ^= LC_LEAF);
                HURT(*link ^= 1);
                HURT(*link = LC_LEAF | N_HURT);
                HURT(*link = t->n_nodes);
            }
        }
        uint32_t id = 0;
        for (int k = 0; k < LC_LIGHT_KINDS; k++) {
            HURT(t->root[k] = t->root[k] == LC_NONE ? 0 : LC_NONE);
            HURT(t->root[k] = LC_LEAF);
            HURT(t->n_of_kind[k]++);
            HURT(t->first_node[k]++);
            HURT(t->first_light[k + 1]++);
        }
        HURT(t->n_nodes--);
        HURT(t->n_lights--);
        HURT(t->n_reps = 0);
        end_damage(kinds);
    }
}

TEST(damaged_numbers_are_found)
{
    uint32_t below[2048];
    for (uint32_t kinds = 1; kinds < 8; kinds++) {
        begin_damage(kinds);
        lc_light_tree *t = hurt_tree;
        for (uint32_t id = 0; id < t->n_nodes; id++) {
            lc_node *b = &t->data.nodes[id];
            uint32_t n = lights_below(t, id, below);
            lc_light_kind kind = lc_kind_of_node(t, id);
            for (int i = 0; i < 3; i++) {
                HURT(b->intensity[i] = nextafterf(b->intensity[i], 0));
                HURT(b->intensity[i] *= 1.00001f);
                HURT(b->intensity[i] = NAN);
                HURT(b->intensity[i] = INFINITY);
                HURT(b->half[i] = nextafterf(b->half[i], 0));
                HURT(b->half[i] = NAN);
                HURT(b->center[i] = b->center[i] + b->half[i] * 0.5f + 0.001f);
                HURT(b->center[i] = NAN);
                if (lc_is_far(kind)) continue;
                HURT(t->data.node_atten[id][i] = nextafterf(t->data.node_atten[id][i], 100));
                HURT(t->data.node_atten[id][i] = nextafterf(t->data.node_atten[id][i], -100));
            }
            if (kind != LC_LIGHT_ORIENTED) continue;
            double least = least_cosine(t, id, below, n);
            HURT(b->cos_cone = 1.01f);
            HURT(b->cos_cone = -1.01f);
            HURT(b->cos_cone = NAN);
            if (b->cos_cone <= -1) continue;
            if (least < 0.99999) HURT(b->cos_cone = (float)(least + 1e-6));
            if (b->cos_cone > 0) HURT((b->axis[0] *= -1, b->axis[1] *= -1, b->axis[2] *= -1));
            HURT(b->axis[0] += 2);
            /* A cone narrower than the box of directions gives, but right. */
            b->cos_cone = nextafterf((float)least, -2);
            CHECK(!lc_light_tree_validate(t));
            restore();
        }
        for (uint32_t id = 0; id < N_HURT; id++) { /* here: of lights */
            lc_light_rec *l = &t->data.lights[id];
            lc_light_kind kind = lc_kind_of_light(t, id);
            if (t->n_of_kind[kind] < 2) continue;
            HURT(l->intensity[1] *= 1.001f);
            HURT(l->intensity[1] += 0.1f);
            HURT(l->pos[2] += 10);
            if (!lc_is_far(kind)) HURT(t->data.light_atten[id][2] = 0.01f);
        }
        end_damage(kinds);
    }
}

TEST(damaged_representatives_are_found)
{
    for (uint32_t kinds = 1; kinds < 8; kinds++) {
        begin_damage(kinds);
        lc_light_tree *t = hurt_tree;
        for (uint32_t s = 0; s < 3; s++) {
            for (uint32_t id = 0; id < t->n_nodes; id++) {
                uint32_t *rep = &t->reps[id * t->n_reps + s];
                if (s == 0) HURT(t->data.nodes[id].rep++);
                HURT(*rep |= LC_LEAF);
                HURT(*rep = N_HURT);
            }
        }
        end_damage(kinds);
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
    RUN(slots_share_out_the_children);
    RUN(slots_share_out_what_is_below);
    RUN(same_input_same_tree);
    RUN(same_tree_for_threads_and_instruction_sets);
    RUN(damaged_links_are_found);
    RUN(damaged_numbers_are_found);
    RUN(damaged_representatives_are_found);
    RUN(grid_of_equal_lights);
    RUN(coincident_lights);
    RUN(a_million_coincident_lights);
    lc_context_destroy(ctx);
    return test_done();
}
