/* check_ploc.c - the kernel that finds nearest neighbours for the parallel builder: by every instruction set
 * they are those of a loop over all pairs, and nothing is written past them. The metric of that loop, which
 * has the kernel's roundings, agrees with its definition in doubles. */
#include "support/isas.h"

#define RND_KEY 90210
#include "support/rnd.h"

#define CASES 4000
#define MOST 1500
#define GUARD 12345.0f

static float rows[LC_PLOC_ROWS][MOST + LC_LANES];

static float sorted(float a, float b, bool high) { return (a < b) == high ? b : a; }

/* ---- the reference ---- */

static float ref_metric(const lc_ploc_list *l, uint32_t i, uint32_t j)
{
    float w[3], size, s2 = 0, r2 = 0;
    for (int k = 0; k < 3; k++) w[k] = sorted(rows[LC_PLOC_HI + k][i], rows[LC_PLOC_HI + k][j], true)
                                       - sorted(rows[LC_PLOC_LO + k][i], rows[LC_PLOC_LO + k][j], false);
    size = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
    for (int k = 0; k < 3 && l->oriented; k++) {
        float lo = sorted(rows[LC_PLOC_DLO + k][i], rows[LC_PLOC_DLO + k][j], false);
        float hi = sorted(rows[LC_PLOC_DHI + k][i], rows[LC_PLOC_DHI + k][j], true);
        s2 += (lo + hi) * (lo + hi);
        r2 += (hi - lo) * (hi - lo);
    }
    if (l->oriented) {
        float s = sqrtf(s2), turn = 2;
        if (s > 0.1f) turn = fminf(fmaxf((r2 - (2 - s) * (2 - s)) / (4 * s), 0), 2);
        size += l->c2 * turn * turn;
    }
    return (rows[LC_PLOC_INTENSITY][i] + rows[LC_PLOC_INTENSITY][j]) * size;
}

/* Whether pair (i, j) comes before pair (i, best) in the order of pairs of equal metric. */
static bool before(float d, uint32_t i, uint32_t j, float best_d, uint32_t best)
{
    uint32_t low = i < j ? i : j, k = i < j ? j - i : i - j;
    uint32_t best_low = i < best ? i : best, best_k = i < best ? best - i : i - best;
    if (d != best_d || best == i) return d < best_d;
    if (k != best_k) return k < best_k;
    return low / k % 2 < best_low / k % 2;
}

static float ref_nearest(const lc_ploc_list *l, uint32_t i, uint32_t radius, bool grouped)
{
    uint32_t best = i;
    float best_d = INFINITY;
    for (uint32_t j = i > radius ? i - radius : 0; j < l->n && j <= i + radius; j++) {
        if (j == i || (grouped && i / LC_PLOC_GROUP != j / LC_PLOC_GROUP)) continue;
        float d = ref_metric(l, i, j);
        if (before(d, i, j, best_d, best)) {
            best = j;
            best_d = d;
        }
    }
    return best > i ? (float)(best - i) : -(float)(i - best);
}

/* ---- cases ---- */

/* Styles: 0 random, 1 ever wider gaps on a line, 2 equal gaps on a line, 3 all in one place, 4 black, 5
 * powers and sizes of many magnitudes. */
static void fill(lc_ploc_list *l, int style)
{
    for (uint32_t i = 0; i < l->n + LC_LANES; i++) {
        lc_f3 d = style == 2 ? lc_f3_make(0, 0, 1) : rnd_unit(), e = style == 2 ? d : rnd_unit();
        const float dir[3] = { d.x, d.y, d.z }, other[3] = { e.x, e.y, e.z };
        bool many = rnd() < 0.5; /* a range of directions, not one */
        for (int k = 0; k < 3; k++) {
            float x = (float)rnd(), y = (float)rnd();
            if (style == 1) x = y = k ? 0 : (float)(i * i) * 0x1p-24f;
            if (style == 2) x = y = k ? 0 : (float)i * 0x1p-12f;
            if (style == 3) x = y = 0.25f;
            if (style == 5) y = x + (1 - x) * powf(10, (float)rnd_in(-30, 0));
            rows[LC_PLOC_LO + k][i] = sorted(x, y, false);
            rows[LC_PLOC_HI + k][i] = sorted(x, y, true);
            rows[LC_PLOC_DLO + k][i] = many ? sorted(dir[k], other[k], false) : dir[k];
            rows[LC_PLOC_DHI + k][i] = many ? sorted(dir[k], other[k], true) : dir[k];
        }
        rows[LC_PLOC_INTENSITY][i] = style == 4   ? 0
                                 : style == 5 ? powf(10, (float)rnd_in(-38, 30))
                                 : style      ? 0x1p80f
                                              : (float)rnd();
    }
    for (int k = 0; k < LC_PLOC_ROWS; k++) l->row[k] = rows[k];
}

static void check_case(uint32_t number, const lc_ploc_list *l, uint32_t first, uint32_t n, uint32_t radius,
                       bool grouped)
{
    static float want[MOST], got[MOST + LC_LANES];
    for (uint32_t i = 0; i < n; i++) want[i] = ref_nearest(l, first + i, radius, grouped);
    EACH_ISA(isa) {
        bool clean = true;
        for (uint32_t i = 0; i < MOST + LC_LANES; i++) got[i] = GUARD;
        lc_isa_kernels(isa)->tree.nearest(l, first, n, radius, grouped, got);
        for (uint32_t i = n; i < MOST + LC_LANES; i++) clean = clean && got[i] == GUARD;
        uint32_t at = 0;
        while (at < n && want[at] == got[at]) at++;
        CHECKF(clean, "%s, case %u", lc_isa_name(isa), number);
        CHECKF(at == n, "%s, case %u: %u of %u + %u, list of %u, radius %u, grouped %d: %g, not %g",
               lc_isa_name(isa), number, at, first, n, l->n, radius, grouped, (double)got[at],
               (double)want[at]);
    }
}

TEST(nearest_as_over_all_pairs)
{
    for (uint32_t i = 0; i < CASES; i++) {
        bool large = i % 20 == 0;
        lc_ploc_list l = { .n = 2 + rnd_n(large   ? MOST - 1
                                          : i % 3 ? 300
                                                  : 20),
                           .oriented = rnd() < 0.5,
                           .c2 = (float)rnd() };
        uint32_t first = rnd() < 0.3 ? 0 : rnd_n(l.n), n = rnd() < 0.5 ? l.n - first : 1 + rnd_n(l.n - first);
        uint32_t radius = rnd() < 0.3 ? l.n + 5 : rnd() < 0.5 ? 1 + rnd_n(40) : 1 + rnd_n(l.n);
        fill(&l, (int)(i / 2 % 6));
        check_case(i, &l, first, n, radius, rnd() < 0.2);
    }
}

/* No metric is infinite or NaN, for which a cluster would have no neighbour. */
TEST(everyone_has_a_neighbour)
{
    for (int style = 0; style < 6; style++) {
        lc_ploc_list l = { .n = 500, .oriented = true, .c2 = 1 };
        float offset[500];
        fill(&l, style);
        lc_isa_kernels(LC_ISA_SCALAR)->tree.nearest(&l, 0, l.n, 9, false, offset);
        for (uint32_t i = 0; i < l.n; i++) CHECK(offset[i] != 0);
        lc_isa_kernels(LC_ISA_SCALAR)->tree.nearest(&l, 0, l.n, 9, true, offset);
        for (uint32_t i = 0; i < l.n; i++) CHECK(offset[i] != 0);
    }
}

/* [Miksik07] eq. 3, with the cone about the box of directions. */
static double exact_metric(const lc_ploc_list *l)
{
    double size = 0, s2 = 0, r2 = 0;
    for (int k = 0; k < 3; k++) {
        double w = fmax((double)rows[LC_PLOC_HI + k][0], (double)rows[LC_PLOC_HI + k][1])
                   - fmin((double)rows[LC_PLOC_LO + k][0], (double)rows[LC_PLOC_LO + k][1]);
        double lo = fmin((double)rows[LC_PLOC_DLO + k][0], (double)rows[LC_PLOC_DLO + k][1]);
        double hi = fmax((double)rows[LC_PLOC_DHI + k][0], (double)rows[LC_PLOC_DHI + k][1]);
        size += w * w;
        s2 += (lo + hi) * (lo + hi);
        r2 += (hi - lo) * (hi - lo);
    }
    double s = sqrt(s2), cos_beta = s < 0.1 ? -1 : fmax(-1, (s2 + 4 - r2) / (4 * s));
    return ((double)rows[LC_PLOC_INTENSITY][0] + (double)rows[LC_PLOC_INTENSITY][1]) *
           (size + (double)l->c2 * (1 - cos_beta) * (1 - cos_beta));
}

/* The tolerance covers a dozen roundings of 2^-24, and the length of directions, which is 1 up to 2^-24: that
 * changes 1 - cos(beta) by as much / s. */
TEST(metric_as_defined)
{
    lc_ploc_list l = { .n = 2, .oriented = true, .c2 = 0.5f };
    for (uint32_t i = 0; i < 20000; i++) {
        fill(&l, 0);
        double want = exact_metric(&l), got = (double)ref_metric(&l, 0, 1);
        CHECKF(fabs(got - want) <= 2e-5 * want, "%g, not %g", got, want);
    }
}

int main(void)
{
    printf("seed %llu, best %s\n", (unsigned long long)rng_key, lc_isa_name(lc_isa_pick(LC_ISA_BEST)));
    RUN(every_instruction_set_is_here);
    RUN(nearest_as_over_all_pairs);
    RUN(everyone_has_a_neighbour);
    RUN(metric_as_defined);
    return test_done();
}
