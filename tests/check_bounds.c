/* check_bounds.c - the promise of one_bound.h: bound >= what it bounds, for every cluster, point and
 * material.
 *
 *     check_bounds [--seed S] [--count N] [--only MATERIAL] [--extreme | --terms]
 *
 * Without --count: all properties, 80,000 random clusters a kind and material, and a tenth as many where one
 * light dominates at an extreme of a term. With it: N of one of these (--terms: the latter), and the table
 * only. The reference is ref_bounds.c, the cases are those of gen_clusters.c.
 */
#include "base/rng.h"
#include "shade/cluster.h"
#include "shade/dir_pack.h"
#include "shade/point_init.h"
#include "support/gen_clusters.h"
#include "support/one_bound.h"
#include "support/ref_bounds.h"
#include "support/test.h"

#include <math.h>
#include <stdlib.h>

static uint64_t seed = 20240607;
static uint64_t count = 80000;
static gen_style style = GEN_ADVERSARIAL;
static const char *only; /* material of the table, or NULL */

static const char *const kind_names[LC_LIGHT_KINDS] = { "point", "oriented", "directional", "spot",
                                                         "virtual", "ball", "sky", "luminaire" };
static bool is_oriented(uint32_t kind) { return kind == LC_LIGHT_ORIENTED || kind == LC_LIGHT_VIRTUAL; }
static const char *const brdf_names[GEN_BRDFS] = {
    "lambert", "phong", "ward", "ward-an", "ggx", "ggx-an", "any"
};

static void make(gen_case *c, uint64_t i, uint32_t kind, uint32_t brdf, gen_style how)
{
    gen_src s = gen_src_key(lc_hash4(seed, kind * 2 + (brdf & 1) + (brdf >> 1) * 6, (uint64_t)how, i));
    gen_case_make(c, &s, (lc_light_kind)kind, (gen_brdf)brdf, how);
}

static void show(const gen_case *c, uint32_t bad)
{
    gen_case t = *c;
    gen_case_shrink(&t, bad);
    gen_case_print(&t);
}

/* One line of the table; returns the number of bad cases. */
static uint64_t run_line(uint32_t kind, uint32_t brdf)
{
    static const uint32_t columns[5] = { GEN_BAD_BOUND_FLOAT | GEN_BAD_BOUND_NAN, GEN_BAD_BOUND_EXACT,
                                         GEN_BAD_SHADE, GEN_BAD_CONE | GEN_BAD_BOX, GEN_BAD_LOWER };
    uint64_t bad[5] = { 0 }, all = 0, nodes = 0, live = 0, inf = 0, below = 0, tiny = 0;
    double tightest = HUGE_VAL, normal = HUGE_VAL, closest = 0;
    uint32_t seen = 0;
    for (uint64_t i = 0; i < count; i++) {
        gen_case c;
        gen_result r;
        make(&c, i, kind, brdf, style);
        gen_case_run(&c, &r);
        nodes += r.n_nodes;
        below += r.below_exact;
        live += r.root_float > 0;
        inf += r.root_bound > (double)FLT_MAX;
        if (r.closest_lower > closest) closest = r.closest_lower;
        if (r.tightest < tightest) tightest = r.tightest;
        if (!r.tiny && r.tightest < normal) normal = r.tightest;
        if (!r.bad) continue;
        all++;
        tiny += r.tiny;
        for (int k = 0; k < 5; k++) bad[k] += (r.bad & columns[k]) != 0;
        if (r.bad & ~seen) {
            printf("  case %llu\n", (unsigned long long)i);
            show(&c, r.bad & ~seen);
        }
        seen |= r.bad;
    }
    printf("  %-11s %-7s %10llu %11llu %5.1f%% %5.1f%% %8llu %8llu %8llu %8llu %8llu %8llu %8.0f %11.8f "
           "%11.8f %10.8f %9llu\n",
           kind_names[kind], brdf_names[brdf], (unsigned long long)count, (unsigned long long)nodes,
           100 * (double)live / (double)count, 100 * (double)inf / (double)count, (unsigned long long)bad[0],
           (unsigned long long)bad[1], (unsigned long long)bad[2], (unsigned long long)bad[3],
           (unsigned long long)bad[4], (unsigned long long)tiny, 1e6 * (double)all / (double)count, tightest,
           normal, closest,
           (unsigned long long)below);
    fflush(stdout);
    return all;
}

/* lit: root sum > 0. <float, <exact: violations. shade: estimate off the reference. store: box or cone. tiny:
 * how many of the bad cases have a member near underflow. per 10^6: bad cases per million, the strength of
 * the cases against a bound that is broken on purpose. tightest: least bound / float sum, of all and of cases
 * not tiny. >low: lower bounds above the float sum; lower: the greatest quotient of the two. <ref: nodes
 * below the double sum with no allowance for the estimate's rounding, for information.
 */
static void run_table(void)
{
    printf("  %-11s %-7s %10s %11s %6s %6s %8s %8s %8s %8s %8s %8s %8s %11s %11s %10s %9s\n", "kind", "brdf",
           "cases", "nodes", "lit", "inf", "<float", "<exact", "shade", "store", ">low", "tiny", "per 10^6",
           "tightest", "not tiny", "lower", "<ref");
    uint64_t lines = 0, sum = 0;
    for (uint32_t kind = 0; kind < LC_LIGHT_KINDS; kind++) {
        for (uint32_t brdf = 0; brdf < GEN_BRDFS; brdf++) {
            if (only && strcmp(brdf_names[brdf], only)) continue;
            uint64_t bad = run_line(kind, brdf);
            lines++;
            sum += bad;
            CHECKF(bad == 0, "%s %s: %llu", kind_names[kind], brdf_names[brdf], (unsigned long long)bad);
        }
    }
    printf("  bad: %llu of %llu cases, %.2f per 10^6\n", (unsigned long long)sum,
           (unsigned long long)(lines * count), 1e6 * (double)sum / (double)(lines * count));
}

TEST(bound_holds) { run_table(); }

TEST(bound_holds_where_a_term_is_extreme)
{
    style = GEN_EXTREME_TERM;
    count /= 10;
    run_table();
    count *= 10;
    style = GEN_ADVERSARIAL;
}

/* The reference's own bound dominates its own sum: two derivations of one paper. Cosines are good to 1e-16
 * and a power of at most 100 multiplies that: 1e-9 is ample. Oriented: the cone of the reference takes
 * directions for unit, which in float they are to 2^-24 = 6e-8, and tan(phi) multiplies that: 1e-6. Ward: the
 * reference takes tangents and n for perpendicular and o for unit, which in float they are to 2e-7; over
 * roughness 0.05 and the height of h, and times the derivative of e^-x^2, some 1e-4 / height: 1e-3; GGX's
 * falls more slowly. Luminaires: near its axis 6e-8 of a cosine are 3.5e-4 of the angle by which the table is
 * asked: 1e-4.
 */
TEST(reference_holds)
{
    for (uint32_t kind = 0; kind < LC_LIGHT_KINDS; kind++) {
        for (uint64_t i = 0; i < 8000; i++) {
            gen_case c;
            make(&c, i, kind, (uint32_t)(i % GEN_BRDFS), GEN_ORDINARY);
            lc_point p;
            lc_point_init(&p, c.pos, c.normal, c.view, &c.mat, c.min_d2);
            uint32_t all = (1u << c.n) - 1;
            double sum = ref_cluster_sum(&p, c.lights, all);
            double slack = sum * (p.lobe >= LC_LOBE_WARD       ? 1e-3
                                  : kind == LC_LIGHT_LUMINAIRE ? 1e-4
                                  : is_oriented(kind)          ? 1e-6
                                                               : 1e-9),
                   ub;
            ub = ref_cluster_bound(&p, c.lights, all, true);
            CHECKF(ub >= sum - slack, "case %llu: %.9g %.9g", (unsigned long long)i, ub, sum);
            CHECK(ref_cluster_bound(&p, c.lights, all, false) >= ref_cluster_bound(&p, c.lights, all, true));
        }
    }
}

static float bound_of(const gen_case *c, const lc_point *p)
{
    lc_cluster all;
    lc_cluster_from_light(&all, &c->lights[0]);
    for (uint32_t i = 1; i < c->n; i++) {
        lc_cluster one;
        lc_cluster_from_light(&one, &c->lights[i]);
        lc_cluster_join(&all, &all, &one);
    }
    lc_node node = { .left = LC_NONE };
    lc_atten atten;
    lc_cluster_store(&all, &node, &atten);
    return gen_bound(&all, &node, &atten, p);
}

/* A valid bound that is useless would pass everything else. */
TEST(as_tight_as_reference)
{
    printf("  %-11s %-7s %9s %9s %9s %9s | %9s %9s %9s\n", "kind", "brdf", "mean", "geo mean", "no joint",
           "ref/exact", "ub/exact", "only ub>0", "only ref>0");
    for (uint32_t kind = 0; kind < LC_LIGHT_KINDS; kind++) {
        for (uint32_t brdf = 0; brdf < GEN_BRDFS; brdf++) {
            double mean = 0, geo = 0, plain = 0, ref_exact = 0, ub_exact = 0;
            uint64_t n = 0, n_lit = 0, only_ub = 0, only_ref = 0;
            for (uint64_t i = 0; i < 12000; i++) {
                gen_case c;
                make(&c, i, kind, brdf, GEN_ORDINARY);
                if (c.n == 1) continue;
                lc_point p;
                lc_point_init(&p, c.pos, c.normal, c.view, &c.mat, c.min_d2);
                uint32_t all = (1u << c.n) - 1;
                double ref = ref_cluster_bound(&p, c.lights, all, true), ub = (double)bound_of(&c, &p);
                double exact = ref_cluster_sum(&p, c.lights, all);
                only_ub += ub > 0 && !(ref > 0);
                only_ref += ref > 0 && !(ub > 0);
                if (!(ref > 0 && ub > 0)) continue;
                mean += ub / ref;
                geo += log(ub / ref);
                n++;
                plain += ub / ref_cluster_bound(&p, c.lights, all, false);
                if (exact > 1e-3 * ref) {
                    ref_exact += log(ref / exact);
                    ub_exact += log(ub / exact);
                    n_lit++;
                }
            }
            double dn = (double)n, dl = (double)n_lit;
            mean /= dn;
            plain /= dn;
            geo = exp(geo / dn);
            printf("  %-11s %-7s %9.4f %9.4f %9.4f %9.4f | %9.4f %9llu %9llu\n", kind_names[kind],
                   brdf_names[brdf], mean, geo, plain, exp(ref_exact / dl), exp(ub_exact / dl),
                   (unsigned long long)only_ub, (unsigned long long)only_ref);
            /* Ward: neither bound is always the lower one, and differences stand in an exponent */
            /* near the foot of a spot's profile or a luminaire's table a rounded cosine is a large factor */
            if (brdf >= GEN_WARD_ISO || kind == LC_LIGHT_SPOT || kind == LC_LIGHT_LUMINAIRE) mean = geo;
            /* A luminaire's bound looks its greatest value up in a tree of ranges of the angle, the reference
             * in the range itself. */
            const double most = kind == LC_LIGHT_LUMINAIRE ? 1.15 : 1.05;
            CHECKF(mean <= most, "%s %s: %g", kind_names[kind], brdf_names[brdf], mean);
        }
    }
}

/* The same from below. The reference's bound is below its sum: cosines are good to 1e-16, directions to 6e-8.
 * It takes distances from an axis at the box's corners, the kernel those of the whole offset's length. */
TEST(lower_bounds_are_as_tight_as_reference)
{
    printf("  %-11s %-7s %9s %9s %9s | %9s %9s\n", "kind", "brdf", "lb/ref", "lb/diffuse", "lb/sum", "lb>0",
           "ref>0");
    for (uint32_t kind = 0; kind < LC_LIGHT_KINDS; kind++) {
        for (uint32_t brdf = 0; brdf < GEN_BRDFS; brdf++) {
            double of_ref = 0, of_diffuse = 0, of_sum = 0;
            uint64_t n = 0, n_lb = 0, n_ref = 0;
            for (uint64_t i = 0; i < 8000; i++) {
                gen_case c;
                gen_result r;
                make(&c, i, kind, brdf, GEN_ORDINARY);
                /* what stands for a lobe is bounded by 0 */
                for (uint32_t k = 0; k < c.n && kind == LC_LIGHT_VIRTUAL; k++)
                    c.lights[k].shine.roughness = 0;
                gen_case_run(&c, &r);
                lc_point p;
                lc_point_init(&p, c.pos, c.normal, c.view, &c.mat, c.min_d2);
                uint32_t all = (1u << c.n) - 1;
                double ref = ref_cluster_lower(&p, c.lights, all), sum = ref_cluster_sum(&p, c.lights, all);
                CHECKF(ref <= sum * (1 + 1e-6) + 1e-12, "case %llu: %.9g %.9g", (unsigned long long)i, ref,
                       sum);
                n_lb += r.root_lower > 0;
                n_ref += ref > 0;
                if (!(ref > 0)) continue;
                for (int k = 0; k < 3; k++) p.specular[k] = p.schlick_delta[k] = 0;
                double diffuse = ref_cluster_sum(&p, c.lights, all);
                of_ref += r.root_lower / ref;
                of_diffuse += r.root_lower / diffuse;
                of_sum += r.root_lower / sum;
                n++;
            }
            if (!n) continue;
            double dn = (double)n;
            printf("  %-11s %-7s %9.4f %9.4f %9.4f | %9llu %9llu\n", kind_names[kind], brdf_names[brdf],
                   of_ref / dn, of_diffuse / dn, of_sum / dn, (unsigned long long)n_lb,
                   (unsigned long long)n_ref);
            CHECKF(of_ref / dn >= 0.98, "%s %s: %g", kind_names[kind], brdf_names[brdf], of_ref / dn);
            CHECKF(n_lb <= n_ref && (double)n_lb >= 0.95 * (double)n_ref, "%s %s", kind_names[kind],
                   brdf_names[brdf]);
        }
    }
}

/* Relative error of Ward's exponential: with M <= sqrt 3 |p| and `bend` of 18u M^2 / (2 |p|) + 16u M,
 * tangential and normal part of |p| h are moved by at most 166u (T + 2 s), s their quotient, which also is
 * where the bound's second step starts. */
static double ward_slack(const lc_point *p, lc_f3 v)
{
    double h[3], s;
    for (int k = 0; k < 3; k++) {
        const float *axis = k < 2 ? p->tangent[k] : p->n;
        h[k] = (double)lc_f3_dot(lc_f3_load(axis), v) + (double)p->view[k];
    }
    s = sqrt(h[0] * h[0] + h[1] * h[1]) / h[2];
    return exp(0x1p-24 * (2 * s * 166 * ((double)p->max_tangent_length + 2 * s) / h[2] + 32 * s * s)) - 1;
}

/* Relative error of GGX's lobe: r^2 by the slope s as above, d ln r^2 / ds < 4 s / (1 + s^2); |h|^2 256u and
 * HALF_SLACK (256u) off, four times for D, and half of it of Fresnel's cosine: Schlick 5 (1 - c)^4,
 * dielectric no more than 5, and 128u, over F; two masking terms, 256u each. */
static double ggx_slack(const lc_point *p, lc_f3 v)
{
    double h[3], h2 = 0, s, f = 1, k = 0;
    for (int i = 0; i < 3; i++) {
        const float *axis = i < 2 ? p->tangent[i] : p->n;
        h[i] = (double)lc_f3_dot(lc_f3_load(axis), v) + (double)p->view[i];
        h2 += h[i] * h[i] * (double)(i < 2 ? p->square[i] : 1);
        if ((double)p->specular[i] > 0)
            f = fmin(f, (double)p->specular[i] / ((double)p->specular[i] + (double)p->schlick_delta[i]));
    }
    s = sqrt(h[0] * h[0] + h[1] * h[1]) / h[2];
    if (p->fresnel == LC_FRESNEL_DIELECTRIC) {
        k = ref_dielectric(sqrt((double)p->eta2), sqrt(h2) / 2);
        f = k;
    }
    double lobe = 4 * s / (1 + s * s) * 166 * ((double)p->max_tangent_length + 2 * s) / h[2];
    h2 = fmin(h2, 1);
    return 0x1p-24 * (lobe + 512 * (4 / h2 + 1) + (5 * 512 / h2 + 128) / f);
}

/* One light: the bound is the estimate, but for the slacks of bounds_tmpl.c: of z (14u M, M <= sqrt 3 |p|),
 * of squares (18u M^2 of |p|^2 and of r^2), of powers (2^-15 + 8.4e-6, and half of the exponent times 32u and
 * what cos^2 has from z and the squares) and of products (64u); and, for oriented lights, the cone: a cosine
 * of 1 rounded down by k ulp, 1 - k 2^-24, is an angle of sqrt(2 k 2^-24), which moves cos(phi) by that times
 * sin(phi). k <= 5: 2 for a direction off the sphere (cone_holds_every_direction), 2 for a rounded axis, 1 to
 * round down. */
TEST(zero_extent_is_tight)
{
    for (uint32_t kind = 0; kind < LC_LIGHT_KINDS; kind++) {
        if (lc_is_sized((lc_light_kind)kind)) continue; /* its box is around its surface */
        if (kind == LC_LIGHT_LUMINAIRE) continue;       /* its emission is bounded by ranges of angles */
        double worst = 0, sum = 0, share = 0;
        uint64_t n = 0;
        for (uint64_t i = 0; i < 20000; i++) {
            gen_case c;
            make(&c, i, kind, (uint32_t)(i % GEN_ANY_LOBE), GEN_ORDINARY);
            c.n = 1;
            if (kind == LC_LIGHT_VIRTUAL) c.lights[0].shine.roughness = 0; /* bounds do not know of lobes */
            c.mat.exponent = fminf(c.mat.exponent, 20);
            lc_point p;
            lc_point_init(&p, c.pos, c.normal, c.view, &c.mat, c.min_d2);
            const lc_light *l = &c.lights[0];
            lc_f3 v =
                lc_is_far(l->kind) ? lc_f3_neg(l->dir) : lc_f3_normalize(lc_f3_sub(l->pos, c.pos));
            double cos_r = (double)lc_f3_dot(v, c.normal), cos_e = -(double)lc_f3_dot(v, l->dir);
            if (cos_r < 0.05 || (is_oriented(kind) && cos_e < 0.05)) continue;
            double exact = ref_cluster_sum(&p, &c.lights[0], 1), rel = (double)bound_of(&c, &p) / exact - 1,
                   limit = 6e-5 + 1.5e-6 / cos_r + 4.5e-6 * (double)c.mat.exponent;
            if (p.lobe == LC_LOBE_GGX && p.fresnel == LC_FRESNEL_CONDUCTOR) continue;
            if (p.lobe == LC_LOBE_GGX) limit += ggx_slack(&p, v);
            if (p.lobe == LC_LOBE_WARD) limit += 1.1 * ward_slack(&p, v);
            double off = sqrt(fmax(0, 1 - cos_e * cos_e)) * sqrt(10 * 0x1p-24), t = 0;
            /* The same of the smooth step, whose relative slope is at most 2 / t. */
            if (kind == LC_LIGHT_SPOT) {
                double width = (double)l->spot.cos_start - (double)l->spot.cos_total;
                t = fmin((cos_e - (double)l->spot.cos_total) / width, 1);
                if (t < 0.1) continue;
                limit += 2 * (off + 80 * 0x1p-24) / width / t * 1.2 + 2e-5;
            }
            if (is_oriented(kind))
                limit += sqrt(fmax(0, 1 - cos_e * cos_e)) / cos_e * sqrt(10 * 0x1p-24);
            CHECKF(rel <= limit, "%s case %llu: %g", kind_names[kind], (unsigned long long)i, rel);
            if (rel > worst) worst = rel;
            if (rel / limit > share) share = rel / limit;
            sum += rel;
            n++;
        }
        printf("  %-11s mean %.3g worst %.3g, worst of what is allowed %.3g, of %llu\n", kind_names[kind],
               sum / (double)n, worst, share, (unsigned long long)n);
    }
}

/* Least attenuation of 0, 0, 1 is what no attenuation stands for, to the bit; inputs stay. */
TEST(inverse_square_needs_no_attenuation)
{
    for (uint64_t i = 0; i < 6000; i++) {
        uint32_t kind = (uint32_t)(i % 3);
        gen_case c;
        make(&c, i, kind, (uint32_t)(i / 3 % 2), i & 1 ? GEN_ADVERSARIAL : GEN_ORDINARY);
        const lc_atten one = { 0, 0, 1, 0 };
        lc_point p, p0;
        lc_node node = { .left = LC_NONE }, n0;
        lc_cluster all;
        lc_point_init(&p, c.pos, c.normal, c.view, &c.mat, c.min_d2);
        memcpy(&p0, &p, sizeof p);
        lc_cluster_from_light(&all, &c.lights[0]);
        for (uint32_t k = 1; k < c.n; k++) {
            lc_cluster two;
            lc_cluster_from_light(&two, &c.lights[k]);
            lc_cluster_join(&all, &all, &two);
        }
        lc_cluster_store(&all, &node, NULL);
        memcpy(&n0, &node, sizeof n0);
        float a = one_bound(&node, NULL, (lc_light_kind)kind, &p),
              b = one_bound(&node, &one, (lc_light_kind)kind, &p);
        CHECK(memcmp(&a, &b, sizeof a) == 0);
        CHECK(memcmp(&n0, &node, sizeof n0) == 0 && memcmp(&p0, &p, sizeof p) == 0);
        lc_light_rec rec;
        lc_light_rec_init(&rec, &c.lights[0]);
        lc_f3 x = one_transfer(&p, (lc_light_kind)kind, &rec, NULL),
              y = one_transfer(&p, (lc_light_kind)kind, &rec, one);
        CHECK(memcmp(&x, &y, sizeof x) == 0);
    }
}

/* Packed directions: unpacking gives what was rounded, rounding what was rounded stays, and rounding moves
 * little. */
TEST(directions_pack)
{
    double worst_len = 0, worst = 0;
    for (uint64_t i = 0; i < 400000; i++) {
        gen_case c;
        /* Not rounded yet. */
        make(&c, i / 16, LC_LIGHT_DIRECTIONAL, 0, i & 1 ? GEN_ADVERSARIAL : GEN_ORDINARY);
        lc_f3 d = c.lights[i % c.n].dir, r = lc_dir_round(d), again = lc_dir_round(r);
        CHECK(r.x == again.x && r.y == again.y && r.z == again.z);
        double len2 = (double)r.x * r.x + (double)r.y * r.y + (double)r.z * r.z;
        double off = fmax(fabs((double)r.x - d.x), fmax(fabs((double)r.y - d.y), fabs((double)r.z - d.z)));
        worst_len = fmax(worst_len, fabs(sqrt(len2) - 1));
        worst = fmax(worst, off);
    }
    printf("  length off by at most %.3g, a component by %.3g\n", worst_len, worst);
    CHECK(worst_len <= 0x1p-23 && worst <= 0x1p-22);
}

static bool same_boxes(const lc_cluster *a, const lc_cluster *b)
{
    bool same = a->kind == b->kind && a->least[0] == b->least[0] && a->least[1] == b->least[1];
    for (int k = 0; k < 3; k++) {
        same = same && a->lo[k] == b->lo[k] && a->hi[k] == b->hi[k] && a->atten[k] == b->atten[k];
        same = same && (!lc_is_aimed(a->kind) || (a->dlo[k] == b->dlo[k] && a->dhi[k] == b->dhi[k]));
        /* 15 additions in double, two orders */
        same = same && fabs(a->intensity[k] - b->intensity[k]) <= 32 * DBL_EPSILON * a->intensity[k];
    }
    return same;
}

TEST(join_is_associative)
{
    for (uint64_t i = 0; i < 20000; i++) {
        gen_case c;
        make(&c, i, (uint32_t)(i % LC_LIGHT_KINDS), 0, GEN_ADVERSARIAL);
        lc_cluster one[GEN_MAX_LIGHTS], forward, back, half[2];
        for (uint32_t k = 0; k < c.n; k++) lc_cluster_from_light(&one[k], &c.lights[k]);
        forward = one[0];
        back = one[c.n - 1];
        half[0] = one[0];
        half[1] = one[c.n - 1];
        for (uint32_t k = 1; k < c.n; k++) {
            lc_cluster_join(&forward, &forward, &one[k]);
            lc_cluster_join(&back, &one[c.n - 1 - k], &back);
            if (k < c.n - 1) lc_cluster_join(&half[k & 1], &half[k & 1], &one[k]);
        }
        if (c.n > 1) lc_cluster_join(&half[0], &half[0], &half[1]);
        CHECK(same_boxes(&forward, &back));
        CHECK(same_boxes(&forward, &half[0]));
    }
}

TEST(cone_holds_every_direction)
{
    double loosest = 0;
    uint64_t n = 0, full = 0;
    for (uint64_t i = 0; i < 40000; i++) {
        gen_case c;
        make(&c, i, LC_LIGHT_ORIENTED, 0, i & 1 ? GEN_ADVERSARIAL : GEN_ORDINARY);
        lc_cluster all;
        lc_cluster_from_light(&all, &c.lights[0]);
        for (uint32_t k = 1; k < c.n; k++) {
            lc_cluster two;
            lc_cluster_from_light(&two, &c.lights[k]);
            lc_cluster_join(&all, &all, &two);
        }
        double axis[3], lo[3], hi[3], ref_axis[3], cone = lc_cluster_cone(&all, axis);
        CHECK(cone >= -1 && cone <= 1);
        for (int k = 0; k < 3; k++) {
            lo[k] = (double)all.dlo[k];
            hi[k] = (double)all.dhi[k];
        }
        double ref = ref_cone(lo, hi, ref_axis);
        n++;
        full += cone <= -1;
        if (cone <= -1) continue;
        /* how much wider than the reference's */
        double wider = acos(cone) - acos(ref);
        if (ref > -1 && wider > loosest) loosest = wider;
        double len = axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2];
        CHECKF(fabs(len - 1) < 1e-12, "%.17g", len);
        for (uint32_t k = 0; k < c.n; k++) {
            const float *d = &c.lights[k].dir.x;
            double dot = 0, d2 = 0, c2 = 0;
            for (int a = 0; a < 3; a++) {
                dot += axis[a] * (double)d[a];
                d2 += (double)d[a] * (double)d[a];
            }
            for (int a = 0; a < 3; a++) c2 += (lo[a] + hi[a]) * (lo[a] + hi[a]);
            /* A unit direction of three floats is off the sphere by 2^-24, which the circumsphere cannot
             * know: with |d| = 1 + e, d.axis >= (|d|^2 + |c|^2/4 - r2/4) / |c| = cone + 2 e / |c|, and e
             * again for the length. The stored cone has no such excuse: GEN_BAD_CONE. */
            double off = (2 / sqrt(c2) + 1) * 0x1p-24 + 4e-16;
            CHECKF(dot / sqrt(d2) >= cone - off, "case %llu: %.17g %.17g", (unsigned long long)i,
                   dot / sqrt(d2), cone);
        }
    }
    printf("  %llu clusters, %llu with all directions, at most %.3g rad wider than the reference\n",
           (unsigned long long)n, (unsigned long long)full, loosest);
}

/* Against the reference's frame; its o lies on the horizon where that of the case is below it. */
static void check_ggx(const lc_point *p, const ref_point *r, const lc_material *m)
{
    const double eta[3] = { (double)m->eta.x, (double)m->eta.y, (double)m->eta.z };
    const double k[3] = { (double)m->k.x, (double)m->k.y, (double)m->k.z };
    double len = 0, s = 0, d = 0, ks[3] = { (double)m->ks.x, (double)m->ks.y, (double)m->ks.z };
    for (int i = 0; i < 3; i++) {
        double a = i < 2 ? (double)m->roughness[i] : 1, o = a * (double)p->view[i],
               n2 = eta[i] * eta[i] - k[i] * k[i] - 1;
        len += o * o;
        s += a * a * o * o;
        d += (double)p->to_view[i] * (double)p->to_view[i];
        if (i < 2) CHECK(fabs((double)p->square[i] - a * a) <= 0x1p-24 * a * a);
        double delta = m->fresnel == LC_FRESNEL_SCHLICK ? r->specular[i] * (1 - ks[i]) / ks[i] : 0;
        if (m->fresnel == LC_FRESNEL_SCHLICK && ks[i] > 0)
            CHECK(fabs((double)p->schlick_delta[i] - delta) <= 8 * 0x1p-24 * delta);
        if (m->fresnel != LC_FRESNEL_CONDUCTOR) continue;
        CHECK(fabs((double)p->n2_real_minus_1[i] - n2) <= 0x1p-24 * fabs(n2));
        CHECK(fabs((double)p->n2_imag[i] - 2 * eta[i] * k[i]) <= 0x1p-24 * 2 * eta[i] * k[i]);
    }
    s = (double)p->masking - sqrt(s);
    CHECKF(fabs(len - 1) <= 64 * 0x1p-24 && fabs(d - 1) <= 8 * 0x1p-24 && fabs(s) <= 16 * 0x1p-24, "%g %g %g",
           len - 1, d - 1, s);
    CHECK(p->coat == m->coat && fabs((double)p->eta2 - eta[0] * eta[0]) <= 0x1p-24 * eta[0] * eta[0]);
}

/* lc_point_init: products and sums of unit numbers; mirror: dot 3 ulp, doubled, product and difference: 8
 * units of 2^-24 absolute. Reflectances: four roundings; Ward: seven, and half of the error of n.o, 3, over
 * 0.02. */
TEST(point_init_agrees)
{
    for (uint64_t i = 0; i < 20000; i++) {
        gen_case c;
        make(&c, i, (uint32_t)(i % 3), (uint32_t)(i / 3 % GEN_ANY_LOBE), GEN_ADVERSARIAL);
        lc_f3 t = c.mat.tangent;
        float n_t = lc_f3_dot(t, c.normal);
        if (lc_f3_dot(t, t) - n_t * n_t < 2e-4f) { /* any frame will do */
            c.mat.lobe = LC_LOBE_PHONG;
            c.mat.coat = false;
        }
        lc_point p;
        ref_point r;
        lc_point_init(&p, c.pos, c.normal, c.view, &c.mat, c.min_d2);
        ref_point_make(&r, c.normal, c.view, &c.mat);
        bool glossy = false;
        double len = 0, error = 0, more = c.mat.lobe == LC_LOBE_WARD ? 82 : 4;
        for (int k = 0; k < 3; k++) {
            CHECK(p.pos[k] == (&c.pos.x)[k] && p.n[k] == (&c.normal.x)[k]);
            CHECKF(fabs((double)p.mirror[k] - r.mirror[k]) <= 8 * 0x1p-24, "%g",
                   (double)p.mirror[k] - r.mirror[k]);
            /* below a coat: 16 more, and what o.n, of 4 units, moves T(o), no steeper than T / (o.n); Fi is
             * within 4e-7, 1 - Fi above 0.05 */
            double off = 4 * 0x1p-24 * r.diffuse[k],
                   below = 8e-6 + 20 * 0x1p-24 + 4 * 0x1p-24 / fmax(r.view[2], 1e-9);
            if (p.coat) off = below * fmax(r.diffuse[k], (double)p.diffuse[k]) + (double)LC_MIN_REFLECTANCE;
            CHECKF(fabs((double)p.diffuse[k] - r.diffuse[k]) <= off + 0x1p-149, "%g %g", (double)p.diffuse[k],
                   r.diffuse[k]);
            CHECK(fabs((double)p.specular[k] - r.specular[k]) <= more * 0x1p-24 * r.specular[k] + 0x1p-149);
            glossy = glossy || r.specular[k] > 0 || c.mat.coat;
            len += (double)p.mirror[k] * (double)p.mirror[k];
        }
        CHECKF(fabs(len - 1) <= 16 * 0x1p-24, "%.9g", len);
        bool ward = c.mat.lobe == LC_LOBE_WARD, ggx = c.mat.lobe == LC_LOBE_GGX;
        CHECK(p.lobe == (!glossy ? LC_LOBE_NONE : ggx ? LC_LOBE_GGX : ward ? LC_LOBE_WARD : LC_LOBE_PHONG));
        if (ggx) check_ggx(&p, &r, &c.mat);
        CHECK(p.exponent == c.mat.exponent && p.min_d2 == c.min_d2);
        if (!ward && !ggx) continue;
        /* o by the two tangents, and the tangents themselves, times roughness: the projection takes away at
         * most 0.99 */
        for (int axis = 0; axis < 2; axis++) {
            double a = (double)c.mat.roughness[axis];
            error = fmax(error, a * fabs((double)p.view[axis] - r.view[axis]));
            for (int k = 0; k < 3; k++)
                error = fmax(error, a * fabs((double)p.tangent[axis][k] - r.tangent[axis][k]));
            CHECK(a * (double)p.max_tangent_length >= 1 || c.mat.roughness[!axis] < c.mat.roughness[axis]);
        }
        CHECKF(error <= 400 * 0x1p-24 && fabs((double)p.view[2] - r.view[2]) <= 4 * 0x1p-24, "%g", error);
    }
}

/* light_spot.h: a member's emission is at most 1 + 18u times that of the members' least cosines, in float. */
TEST(spot_profiles_are_within_18u)
{
    double worst = 0;
    for (uint64_t i = 0; i < 1000000; i++) {
        gen_src s = gen_src_key(lc_hash4(seed, 6, 0, i));
        double least = gen_real(&s, -1, 1), width = pow(10, gen_real(&s, -8, 0)), more[2];
        for (int k = 0; k < 2; k++) more[k] = gen_pick(&s, 3) ? width * pow(10, gen_real(&s, -8, 1)) : 0;
        float total = (float)least, start = fminf(fmaxf((float)(least + width), total), 1);
        lc_spot_rec node, light;
        lc_spot_rec_init(&node, total, start, 0);
        light.cos_total = fminf((float)((double)total + more[0]), 1);
        light.cos_start = fminf(fmaxf((float)((double)start + more[1]), light.cos_total), 1);
        lc_spot_rec_init(&light, light.cos_total, light.cos_start, 0);
        double t = gen_real(&s, 0, 1.01);
        float cosine = (float)((double)light.cos_total +
                               t * ((double)light.cos_start - (double)light.cos_total)),
              e = lc_spot_emission(&light, cosine), most = lc_spot_emission(&node, cosine);
        if (!(e > FLT_MIN)) continue;
        double above = ((double)e / (double)most - 1) * 0x1p24;
        CHECKF(above <= 18, "case %llu: %g", (unsigned long long)i, above);
        worst = fmax(worst, above);
    }
    printf("  at most %.3g u above the cluster's\n", worst);
}

/* Two numbers worked out by hand. A point light of 10 W/sr two units above a white diffuser: 10 / pi / 4. An
 * oriented one that looks sideways by 60 degrees: half of it. */
TEST(worked_example)
{
    lc_material m = { .kd = { 1, 1, 1 } };
    lc_point p;
    lc_point_init(&p, lc_f3_make(0, 0, 0), lc_f3_make(0, 0, 1), lc_f3_make(0, 0, 1), &m, 1e-10f);
    lc_light l = {
        .pos = { 0, 0, 2 }, .dir = { 0, 0, -1 }, .intensity = { 10, 10, 10 }, .atten = { 0, 0, 1 }
    };
    double mg[3];
    ref_transfer(&p, &l, mg);
    CHECKF(fabs(10 * mg[1] - 0.7957747154594767) < 1e-7, "%.17g", 10 * mg[1]);
    l.kind = LC_LIGHT_ORIENTED;
    l.dir = lc_f3_make(0.8660254f, 0, -0.5f);
    ref_transfer(&p, &l, mg);
    CHECKF(fabs(10 * mg[1] - 0.3978873577297384) < 1e-7, "%.17g", 10 * mg[1]);
    lc_light_rec rec;
    lc_light_rec_init(&rec, &l);
    CHECK(fabs(10 * (double)one_transfer(&p, l.kind, &rec, NULL).y - 0.3978873577297384) < 1e-6);
}

int main(int argc, char **argv)
{
    bool table = false;
    for (int i = 1; i < argc; i++) {
        bool more = i + 1 < argc;
        if (!strcmp(argv[i], "--seed") && more) seed = strtoull(argv[++i], NULL, 0);
        else if (!strcmp(argv[i], "--count") && more) {
            count = strtoull(argv[++i], NULL, 0);
            table = true;
        } else if (!strcmp(argv[i], "--only") && more) only = argv[++i];
        else if (!strcmp(argv[i], "--extreme")) style = GEN_EXTREME;
        else if (!strcmp(argv[i], "--terms")) style = GEN_EXTREME_TERM;
        else
            return fprintf(stderr, "usage: check_bounds [--seed S] [--count N] [--only MATERIAL] "
                                   "[--extreme | --terms]\n"),
                   2;
    }
    printf("seed %llu\n", (unsigned long long)seed);
    if (!table) RUN(bound_holds_where_a_term_is_extreme);
    RUN(bound_holds);
    if (table) return test_done();
    RUN(worked_example);
    RUN(reference_holds);
    RUN(as_tight_as_reference);
    RUN(lower_bounds_are_as_tight_as_reference);
    RUN(zero_extent_is_tight);
    RUN(inverse_square_needs_no_attenuation);
    RUN(directions_pack);
    RUN(join_is_associative);
    RUN(cone_holds_every_direction);
    RUN(point_init_agrees);
    RUN(spot_profiles_are_within_18u);
    return test_done();
}
