/* check_lists.c - the kernels place and partition, which sort clusters into the lists of a cut: by every
 * instruction set contents, counts and sum are bit for bit those of a loop over single clusters. Nothing is
 * written past the spare elements, and nothing is read past the lanes of the inputs. */
#include "support/isas.h"
#include "tree/light_tree.h"

#include <stdlib.h>

#define RND_KEY 4711
#include "support/rnd.h"

#define CASES 30000
#define MOST 40 /* pairs */
#define NODES 64
#define BEFORE 24 /* most elements in a list before the call; most parents before the first used */
#define GUARD 32
#define ROOM (BEFORE + 2 * MOST + LC_CUT_SPARE + GUARD)
#define GUARD_WORD 0xDEADBEEFu

typedef struct list {
    uint32_t word[LC_CUT_WORDS][ROOM]; /* in the order of lc_cut_list */
    uint32_t n;
} list;

/* The arguments of place. Inputs have exactly the promised size, so that ASan sees reads beyond it. */
typedef struct job {
    lc_node *nodes;
    lc_light_rec *lights;
    uint32_t n, first;
    float limit;
    list parent, open, left, leaf;
    float *bound, *fresh, *transfer[3];
    uint32_t *link, *rep;
    const float **intensity;
} job;

static float as_float(uint32_t bits)
{
    float f;
    memcpy(&f, &bits, sizeof f);
    return f;
}

static uint32_t as_bits(float f)
{
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    return bits;
}

/* ---- random cases ---- */

/* 0 for three of ten, else anywhere in the range of transfers. */
static float rnd_transfer(void) { return rnd() < 0.3 ? 0 : powf(10, (float)rnd_in(-18, 19)); }

/* Styles: 0 and 1 mixed, 2 all 0, 3 all infinite, 4 all above the limit, 5 none above it, 6 at the limit. */
static float rnd_bound(int style, float limit)
{
    double r = rnd();
    if (style == 2) return 0;
    if (style == 3) return INFINITY;
    if (style == 4) return limit < 1e30f ? limit * 2 + (float)r : INFINITY;
    if (style == 5) return limit < 1e30f ? limit * (float)r : (float)r;
    if (style == 6)
        return r < 0.3 ? nextafterf(limit, INFINITY) : r < 0.6 && limit > 0 ? nextafterf(limit, 0) : limit;
    if (r < 0.2) return 0;
    if (r < 0.25) return INFINITY;
    if (r < 0.3) return limit;
    return r < 0.35 ? 1e-40f : powf(10, (float)rnd_in(-4, 4));
}

static float rnd_limit(void)
{
    double r = rnd();
    return r < 0.1 ? 0 : r < 0.15 ? INFINITY : r < 0.2 ? 1e-42f : powf(10, (float)rnd_in(-3, 3));
}

static uint32_t rnd_rep(void) { return rnd_n(100000) | (rnd() < 0.5 ? LC_PENDING : 0); }
static uint32_t rnd_link(double leaves) { return rnd() < leaves ? LC_LEAF | rnd_n(NODES) : rnd_n(NODES); }

static void clear(list *l)
{
    for (uint32_t w = 0; w < LC_CUT_WORDS; w++)
        for (uint32_t i = 0; i < ROOM; i++) l->word[w][i] = GUARD_WORD;
    l->n = 0;
}

/* n random clusters, of which `leaves` is the share of leaves. */
static void fill(list *l, uint32_t n, int style, float limit, double leaves)
{
    clear(l);
    l->n = n;
    for (uint32_t i = 0; i < n; i++) {
        l->word[0][i] = as_bits(rnd_bound(style, limit));
        l->word[1][i] = rnd_link(leaves);
        l->word[2][i] = rnd_rep();
        for (uint32_t w = 3; w < 9; w++) l->word[w][i] = as_bits(rnd_transfer());
        l->word[9][i] = as_bits(rnd() < 0.3 ? 1 : powf(10, (float)rnd_in(-1, 1)));
    }
}

static void *must(size_t n, size_t size)
{
    void *p = calloc(n + LC_LANES, size);
    if (!p) abort();
    return p;
}

static void make_children(job *j, int style)
{
    double leaves = rnd() < 0.3 ? 0 : rnd() < 0.2 ? 1 : 0.3;
    j->bound = must(2 * j->n, sizeof *j->bound);
    j->fresh = must(2 * j->n, sizeof *j->fresh);
    j->intensity = must(2 * j->n, sizeof *j->intensity);
    j->link = must(2 * j->n, sizeof *j->link);
    j->rep = must(j->n, sizeof *j->rep);
    for (int k = 0; k < 3; k++) j->transfer[k] = must(j->n, sizeof *j->transfer[k]);
    for (uint32_t i = 0; i < 2 * j->n; i++) {
        j->bound[i] = rnd_bound(style, j->limit);
        j->link[i] = rnd_link(leaves);
        j->intensity[i] = j->link[i] & LC_LEAF ? j->lights[j->link[i] & ~LC_LEAF].intensity
                                           : j->nodes[j->link[i]].intensity;
    }
    for (uint32_t i = 0; i < j->n; i++) {
        bool left = rnd() < 0.5, dark = rnd() < 0.2;
        j->fresh[2 * i] = left ? 1 : 0;
        j->fresh[2 * i + 1] = left ? 0 : 1;
        j->rep[i] = rnd_n(100000);
        for (int k = 0; k < 3; k++) j->transfer[k][i] = dark ? 0 : rnd_transfer();
    }
}

static void make_job(job *j, uint32_t i, lc_node *nodes, lc_light_rec *lights)
{
    int style = (int)(i / (MOST + 1) % 7);
    *j = (job){ .nodes = nodes, .lights = lights };
    j->n = i % (MOST + 1);
    j->first = rnd() < 0.5 ? 0 : rnd_n(BEFORE);
    j->limit = rnd_limit();
    fill(&j->parent, j->first + j->n, 0, 1, 0);
    fill(&j->open, rnd_n(BEFORE), 0, 1, 0);
    fill(&j->left, rnd_n(BEFORE), 0, 1, 0);
    fill(&j->leaf, rnd_n(BEFORE), 0, 1, 1);
    make_children(j, style);
}

static void free_job(job *j)
{
    free(j->intensity);
    free(j->bound);
    free(j->fresh);
    free(j->link);
    free(j->rep);
    for (int k = 0; k < 3; k++) free(j->transfer[k]);
}

/* ---- the reference: one cluster after the other ---- */

static void put(list *l, const uint32_t word[LC_CUT_WORDS])
{
    for (uint32_t w = 0; w < LC_CUT_WORDS; w++) l->word[w][l->n] = word[w];
    l->n++;
}

static float luminance(const uint32_t e[3])
{
    return lc_luminance(lc_f3_make(as_float(e[0]), as_float(e[1]), as_float(e[2])));
}

/* Puts child c of pair i into its list; returns its luminance. */
static float ref_child(job *j, uint32_t i, uint32_t c)
{
    const uint32_t at = j->first + i;
    const float weight = as_float(j->parent.word[9][at]), bound = j->bound[2 * i + c] * weight;
    uint32_t word[LC_CUT_WORDS] = { as_bits(bound), j->link[2 * i + c] };
    const float *intensity = j->intensity[2 * i + c];
    bool own = j->fresh[2 * i + c] > 0, lit = false;
    word[9] = as_bits(weight);
    for (uint32_t k = 0; k < 3; k++) {
        float t = own ? j->transfer[k][i] : as_float(j->parent.word[3 + k][at]);
        lit |= j->transfer[k][i] > 0;
        if (!(bound > 0)) t = 0;
        word[3 + k] = as_bits(t);
        word[6 + k] = as_bits(t * intensity[k]);
    }
    word[2] = own ? j->rep[i] | (lit ? LC_PENDING : 0) : j->parent.word[2][at];
    if (bound > 0) put(word[1] & LC_LEAF ? &j->leaf : bound > j->limit ? &j->open : &j->left, word);
    return luminance(word + 6);
}

/* Returns the sum of changes, one for each pair, in the kernels' order: four pairs in a tree, then four after
 * four. */
static double ref_place(job *j)
{
    double sum = 0;
    for (uint32_t i = 0; i < j->n; i += 4) {
        double change[4] = { 0, 0, 0, 0 };
        for (uint32_t k = 0; k < 4 && i + k < j->n; k++) {
            uint32_t at = j->first + i + k;
            const uint32_t e[3] = { j->parent.word[6][at], j->parent.word[7][at], j->parent.word[8][at] };
            float left = ref_child(j, i + k, 0), right = ref_child(j, i + k, 1);
            change[k] = (double)left + (double)right - (double)luminance(e);
        }
        sum += (change[0] + change[1]) + (change[2] + change[3]);
    }
    return sum;
}

static void ref_partition(const list *from, float limit, list *above, list *rest)
{
    for (uint32_t i = 0; i < from->n; i++) {
        uint32_t word[LC_CUT_WORDS];
        for (uint32_t w = 0; w < LC_CUT_WORDS; w++) word[w] = from->word[w][i];
        put(as_float(word[0]) > limit ? above : rest, word);
    }
}

/* ---- the kernels ---- */

static lc_cut_list view(list *l)
{
    lc_cut_list v = { .n = l->n, .link = l->word[1], .rep = l->word[2] };
    v.bound = (float *)(void *)l->word[0];
    v.weight = (float *)(void *)l->word[9];
    for (uint32_t k = 0; k < 3; k++) {
        v.transfer[k] = (float *)(void *)l->word[3 + k];
        v.e[k] = (float *)(void *)l->word[6 + k];
    }
    return v;
}

/* The same clusters, and nothing written beyond the spare elements after the list's greatest length. */
static bool same(const list *want, const list *got, uint32_t longest)
{
    if (want->n != got->n) return false;
    for (uint32_t w = 0; w < LC_CUT_WORDS; w++) {
        if (memcmp(want->word[w], got->word[w], want->n * sizeof want->word[w][0])) return false;
        for (uint32_t i = (longest > got->n ? longest : got->n) + LC_CUT_SPARE; i < ROOM; i++)
            if (got->word[w][i] != GUARD_WORD) return false;
    }
    return true;
}

static double run_place(const lc_kernels *k, job *j)
{
    lc_cut_list parent = view(&j->parent), open = view(&j->open), left = view(&j->left),
                leaf = view(&j->leaf);
    lc_cut_pairs p = { .n = j->n,
                       .parent = &parent,
                       .first = j->first,
                       .bound = j->bound,
                       .link = j->link,
                       .intensity = j->intensity,
                       .fresh = j->fresh,
                       .rep = j->rep,
                       .transfer = { j->transfer[0], j->transfer[1], j->transfer[2] },
                       .limit = j->limit };
    double sum = k->cut.place(&p, &open, &left, &leaf);
    j->open.n = open.n;
    j->left.n = left.n;
    j->leaf.n = leaf.n;
    return sum;
}

static void check_place(lc_isa isa, uint32_t i, const job *j)
{
    static job want, got;
    want = *j;
    got = *j;
    double want_sum = ref_place(&want), got_sum = run_place(lc_isa_kernels(isa), &got);
    CHECKF(!memcmp(&want_sum, &got_sum, sizeof want_sum), "%s, case %u: sum %a, not %a", lc_isa_name(isa), i,
           got_sum, want_sum);
    CHECKF(same(&want.open, &got.open, 0), "%s, case %u, %u pairs", lc_isa_name(isa), i, j->n);
    CHECKF(same(&want.left, &got.left, 0), "%s, case %u, %u pairs", lc_isa_name(isa), i, j->n);
    CHECKF(same(&want.leaf, &got.leaf, 0), "%s, case %u, %u pairs", lc_isa_name(isa), i, j->n);
    CHECK(!memcmp(&want.parent, &got.parent, sizeof want.parent));
}

static float rnd_power(void) { return rnd() < 0.1 ? 0 : powf(10, (float)rnd_in(-15, 15)); }

TEST(place_as_one_by_one)
{
    lc_node *nodes = aligned_alloc(64, NODES * sizeof *nodes);
    lc_light_rec *lights = aligned_alloc(64, NODES * sizeof *lights);
    static job j;
    if (!nodes || !lights) abort();
    for (uint32_t i = 0; i < NODES; i++)
        for (uint32_t k = 0; k < 3; k++) {
            nodes[i].intensity[k] = rnd_power();
            lights[i].intensity[k] = rnd_power();
        }
    for (uint32_t i = 0; i < CASES; i++) {
        make_job(&j, i, nodes, lights);
        EACH_ISA(isa) check_place(isa, i, &j);
        free_job(&j);
    }
    free(nodes);
    free(lights);
}

/* where: 0 into two other lists, 1 the list itself is `above`, 2 the list itself is `rest` */
static void check_partition(lc_isa isa, uint32_t i, const list *from, const list others[2], float limit,
                            int where)
{
    static list want[2], got[2], source;
    for (int k = 0; k < 2; k++) {
        want[k] = got[k] = where == k + 1 ? *from : others[k];
        if (where == k + 1) want[k].n = 0;
    }
    source = *from;
    lc_cut_list to[2] = { view(&got[0]), view(&got[1]) }, apart = view(&source);
    ref_partition(from, limit, &want[0], &want[1]);
    lc_isa_kernels(isa)->cut.partition(where ? &to[where - 1] : &apart, limit, &to[0], &to[1]);
    for (int k = 0; k < 2; k++) {
        got[k].n = to[k].n;
        CHECKF(same(&want[k], &got[k], where == k + 1 ? from->n : 0),
               "%s, case %u: %u clusters, limit %g, in place %d, list %d", lc_isa_name(isa), i, from->n,
               (double)limit, where, k);
    }
    CHECK(where || (apart.n == 0 && !memcmp(source.word, from->word, sizeof source.word)));
}

TEST(partition_as_one_by_one)
{
    static list from, others[2];
    for (uint32_t i = 0; i < CASES; i++) {
        float limit = rnd_limit();
        fill(&from, i % (2 * MOST + 1), (int)(i / (2 * MOST + 1) % 7), limit, 0.2);
        fill(&others[0], rnd_n(BEFORE), 0, 1, 0);
        fill(&others[1], rnd_n(BEFORE), 0, 1, 0);
        EACH_ISA(isa)
            for (int where = 0; where < 3; where++) check_partition(isa, i, &from, others, limit, where);
    }
}

int main(void)
{
    printf("seed %llu, best %s\n", (unsigned long long)rng_key, lc_isa_name(lc_isa_pick(LC_ISA_BEST)));
    RUN(every_instruction_set_is_here);
    RUN(place_as_one_by_one);
    RUN(partition_as_one_by_one);
    return test_done();
}
