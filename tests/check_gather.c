/* check_gather.c - the bound of a gather cluster paired with a cluster of lights is no less than what stands
 * for the pair by any of its points, nor than what the lights give the points on average, for every kind of
 * light.
 *
 *     check_gather [--seed S] [--count N]
 *
 * Lights are those of gen_clusters.c. Points lie in a box about the case's own, from a point to as large as
 * the lights' distance, with normals in a cone about the case's, and diffuse reflectances of their own. The
 * sums are of the kernels' estimates.
 */
#include "base/rng.h"
#include "cut/gather.h"
#include "shade/cluster.h"
#include "shade/point_init.h"
#include "support/gen_clusters.h"
#include "support/ref_bounds.h"
#include "support/test.h"

#include <math.h>
#include <stdlib.h>

#define MOST_POINTS 12

static uint64_t seed = 20241123, count = 60000;

static const char *const styles[] = { "ordinary", "adversarial", "extreme", "terms" };

typedef struct {
    gen_case lights;
    lc_gather gather;
    lc_gather_point point[MOST_POINTS];
    lc_point own[MOST_POINTS]; /* with reflectances of their own */
} pair;

static lc_f3 near_normal(gen_src *s, lc_f3 n, double angle)
{
    const float x = (float)gen_real(s, -1, 1), y = (float)gen_real(s, -1, 1), z = (float)gen_real(s, -1, 1);
    const lc_f3 any = lc_f3_make(x, y, z);
    const lc_f3 side = lc_f3_sub(any, lc_f3_scale(n, lc_f3_dot(n, any)));
    const float len = sqrtf(lc_f3_dot(side, side));
    if (!(len > 1e-3f)) return n;
    const double a = angle * gen_real(s, 0, 1);
    return lc_f3_normalize(lc_f3_add(lc_f3_scale(n, (float)cos(a)), lc_f3_scale(side, (float)sin(a) / len)));
}

/* Distance of the nearest light, or 1. */
static double distance_of(const gen_case *c)
{
    double least = HUGE_VAL;
    for (uint32_t i = 0; i < c->n && !lc_is_far(c->lights[0].kind); i++) {
        const lc_f3 d = lc_f3_sub(c->lights[i].pos, c->pos);
        least = fmin(least, sqrt((double)d.x * d.x + (double)d.y * d.y + (double)d.z * d.z));
    }
    return least < HUGE_VAL && least > 0 ? least : 1;
}

static void make(pair *x, uint64_t i, uint32_t kind, gen_style style)
{
    gen_src s = gen_src_key(lc_hash4(seed, kind, (uint64_t)style, i));
    gen_case *c = &x->lights;
    gen_case_make(c, &s, (lc_light_kind)kind, GEN_LAMBERT, style);
    const uint32_t n = 1 + gen_pick(&s, MOST_POINTS);
    const double size = distance_of(c) * pow(10, gen_real(&s, -6, 0.3)), bend = gen_pick(&s, 3) ? 0.6 : 0,
                 angle = gen_pick(&s, 2) ? bend : bend * pow(10, gen_real(&s, -5, 0));
    const bool flat = gen_pick(&s, 2);
    for (uint32_t k = 0; k < n; k++) {
        float off[3];
        for (int a = 0; a < 3; a++) off[a] = (float)(size * gen_real(&s, -1, 1));
        lc_f3 way = lc_f3_load(off);
        if (flat) way = lc_f3_sub(way, lc_f3_scale(c->normal, lc_f3_dot(way, c->normal)));
        if (!k) way = lc_f3_make(0, 0, 0);
        const lc_f3 pos = lc_f3_add(c->pos, way);
        lc_material m = c->mat;
        m.ks = lc_f3_make(0, 0, 0);
        m.kd = lc_f3_make((float)gen_real(&s, 0, 1), (float)gen_real(&s, 0, 1), (float)gen_real(&s, 0, 1));
        lc_gather_point *p = &x->point[k];
        lc_point_init(p->p, pos, angle > 0 ? near_normal(&s, c->normal, angle) : c->normal, c->view, &m,
                      c->min_d2);
        p->p[1] = p->p[0];
        lc_f3_store(p->org, pos);
        x->own[k] = p->p[0];
    }
    lc_gather_make(&x->gather, x->point, n);
}

static double bound_of(const pair *x)
{
    const gen_case *c = &x->lights;
    lc_cluster all, one;
    lc_cluster_from_light(&all, &c->lights[0]);
    for (uint32_t i = 1; i < c->n; i++) {
        lc_cluster_from_light(&one, &c->lights[i]);
        lc_cluster_join(&all, &all, &one);
    }
    lc_node node = { .left = LC_NONE };
    lc_atten atten;
    lc_cluster_store(&all, &node, &atten);
    return (double)gen_bound(&all, &node, &atten, x->gather.all);
}

/* What all lights give a point: the kernels' estimates times a scale, summed in double. */
static double estimate_of(const gen_case *c, const lc_point *p, lc_f3 scale)
{
    double sum = 0;
    for (uint32_t i = 0; i < c->n; i++) {
        const lc_f3 mg = gen_shade(p, &c->lights[i]), l = lc_f3_mul(mg, c->lights[i].intensity);
        sum += (double)lc_luminance(lc_f3_mul(l, scale));
    }
    return sum;
}

typedef struct {
    uint64_t bad, lit, n_loose;
    double tightest, loose; /* least bound over sum; sum of logarithms of bound over the greatest sum */
} tally;

static void run(uint32_t kind, gen_style style, tally *t)
{
    for (uint64_t i = 0; i < count; i++) {
        pair x;
        make(&x, i, kind, style);
        const double bound = bound_of(&x);
        double most = 0, mean = 0;
        for (uint32_t k = 0; k < x.gather.n; k++) {
            const lc_gather_point *p = &x.point[k];
            most = fmax(most, estimate_of(&x.lights, p->p, lc_f3_load(p->scale)));
            mean += estimate_of(&x.lights, &x.own[k], lc_f3_make(1, 1, 1)) / x.gather.n;
        }
        most = fmax(most, mean);
        if (!(bound >= most)) {
            if (!t->bad++)
                printf("  %s case %llu: bound %.9g, a point gets %.9g, %u points, half %g %g %g, cone %g\n",
                       styles[style], (unsigned long long)i, bound, most, x.gather.n,
                       (double)x.gather.all[0].half[0], (double)x.gather.all[0].half[1],
                       (double)x.gather.all[0].half[2], (double)x.gather.all[0].cone[1]);
        }
        if (!(most > 0) || !(bound < HUGE_VAL)) continue;
        t->lit++;
        t->tightest = fmin(t->tightest, bound / most);
        t->loose += log(bound / most);
    }
}

TEST(bound_holds_for_every_point)
{
    static const gen_style all[] = { GEN_ORDINARY, GEN_ADVERSARIAL, GEN_EXTREME_TERM };
    printf("  %-11s %-11s %9s %9s %9s %10s %9s\n", "kind", "style", "cases", "lit", "bad", "tightest",
           "geo mean");
    for (uint32_t kind = 0; kind < LC_LIGHT_KINDS; kind++)
        for (uint32_t k = 0; k < 3; k++) {
            tally t = { .tightest = HUGE_VAL };
            run(kind, all[k], &t);
            printf("  %-11s %-11s %9llu %9llu %9llu %10.7f %9.3f\n", lc_light_kinds[kind].name,
                   styles[all[k]], (unsigned long long)count, (unsigned long long)t.lit,
                   (unsigned long long)t.bad, t.tightest, exp(t.loose / (double)t.lit));
            CHECKF(!t.bad, "%s %s: %llu bounds are too low", lc_light_kinds[kind].name, styles[all[k]],
                   (unsigned long long)t.bad);
        }
}

/* One point, and points that are one, have the bound of the point. */
TEST(one_point_has_its_own_bound)
{
    for (uint32_t kind = 0; kind < LC_LIGHT_KINDS; kind++)
        for (uint64_t i = 0; i < 2000; i++) {
            pair x;
            make(&x, i, kind, GEN_ORDINARY);
            lc_point one = x.own[0];
            lc_gather_point same[2] = { { .p = { one, one } }, { .p = { one, one } } };
            for (int k = 0; k < 2; k++) lc_f3_store(same[k].org, lc_f3_load(one.pos));
            lc_gather_make(&x.gather, same, 1 + (uint32_t)(i & 1));
            const double a = bound_of(&x);
            x.gather.all[0] = one;
            const double b = bound_of(&x);
            CHECK(!memcmp(&a, &b, sizeof a));
        }
}

int main(int argc, char **argv)
{
    for (int i = 1; i + 1 < argc; i += 2) {
        if (!strcmp(argv[i], "--seed")) seed = strtoull(argv[i + 1], NULL, 10);
        if (!strcmp(argv[i], "--count")) count = strtoull(argv[i + 1], NULL, 10);
    }
    RUN(bound_holds_for_every_point);
    RUN(one_point_has_its_own_bound);
    return test_done();
}
