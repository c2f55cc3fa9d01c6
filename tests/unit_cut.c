/* unit_cut.c - cuts of light trees. Every cut is a partition of the lights within the allowed size; the bound
 * of each cluster in it is at least the sum over its lights, and at most the error ratio of the estimate.
 * With all leaves the estimate is the exact value, which a loop over the lights gives; with fewer clusters
 * its mean over representatives is, and so is that of each cluster. All memory is watched_memory.h's. */
#include "support/cut_scene.h"

/* ---- properties of every cut ---- */

/* Sum of the luminance of all lights below a link; shadows: of those that are visible. */
static double sum_below(const setup *s, uint32_t top, const point *q, bool shadows)
{
    const lc_light_tree *t = s->tree;
    const lc_point *p = &q->p;
    uint32_t stack[2048], n = 0;
    double sum = 0;
    stack[n++] = top;
    while (n) {
        uint32_t link = stack[--n];
        if (!(link & LC_LEAF)) {
            stack[n++] = t->data.nodes[link].left;
            stack[n++] = t->data.nodes[link].right;
            continue;
        }
        uint32_t light = link & ~LC_LEAF;
        if (shadows && is_hidden(s, q, light)) continue;
        const lc_light_rec *l = &t->data.lights[light];
        lc_light_kind kind = lc_kind_of_light(t, light);
        lc_f3 mg;
        if (kind == LC_LIGHT_SPOT) mg = one_spot_transfer(p, l, lc_light_own(&t->data, kind, light), NULL);
        else if (kind == LC_LIGHT_LUMINAIRE)
            mg = one_luminaire_transfer(p, l, lc_light_own(&t->data, kind, light), t->data.profiles);
        else mg = one_transfer(p, kind, l, lc_light_atten(&t->data, light));
        sum += lum_of(lc_f3_mul(mg, lc_f3_load(l->intensity)));
    }
    return sum;
}

static uint64_t n_proved, n_zero; /* in all checked cuts: clusters proved to be occluded, and of bound 0 */

/* All clusters but those proved to be occluded. */
static uint32_t n_clusters(const lc_cut *c) { return n_left(c) + c->n_done - c->n_hidden; }

/* The size of the cut: clusters of bound 0 do not count, but at most `limit` of them. */
static uint32_t size_of(const lc_cut *c, uint32_t limit)
{
    uint32_t zero = 0;
    for (uint32_t i = 0; i < c->n_done - c->n_hidden; i++) zero += !(c->done[i] & LC_LEAF);
    n_zero += zero;
    return n_clusters(c) - (zero < limit ? zero : limit);
}

static void check_cut(const setup *s, const lc_cut *c, const point *q, const lc_cut_result *r)
{
    const lc_light_tree *t = s->tree;
    uint32_t limit = c->desc.max_cut && c->desc.max_cut < s->n ? c->desc.max_cut : s->n, n_roots = 0;
    for (int k = 0; k < LC_LIGHT_KINDS; k++) n_roots += t->n_of_kind[k] > 0;
    if (limit < n_roots) limit = n_roots;
    const char *wrong = lc_cut_validate(c);
    CHECKF(!wrong, "%s", wrong);
    CHECKF(r->size <= limit && n_clusters(c) + c->n_hidden >= n_roots && r->size == size_of(c, limit),
           "size %u of %u", r->size, limit);
    /* A cut whose rounds do not fit is made again. */
    CHECKF(r->rays <= (c->worst_first ? 2 : 1) * (n_clusters(c) + c->n_hidden),
           "%u rays, %u clusters, %u hidden", r->rays, r->size, c->n_hidden);
    CHECK(lc_f3_finite(r->radiance) && r->radiance.x >= 0 && r->radiance.y >= 0 && r->radiance.z >= 0);
    double total = lum_of(r->radiance), left = 0,
           most = (double)c->desc.error_ratio * fmax(total, (double)c->desc.floor);
    CHECK(!r->at_limit || r->size == limit);
    double worst = 0;
    for (uint32_t i = 0; i < n_left(c); i++) {
        double bound = (double)c->kept.bound[i];
        uint32_t link = c->kept.link[i];
        worst = fmax(worst, bound);
        /* 1e-5: the library sums the total in float. */
        CHECKF(r->at_limit || bound <= most * (1 + 1e-5), "bound %g left, limit %g", bound, most);
        CHECK(bound > 0 && !(link & LC_LEAF) && !(c->kept.rep[i] & LC_PENDING));
        /* 1e-6: rounding of float products and of this sum. */
        double sum = sum_below(s, link, q, false);
        CHECKF(bound >= sum * (1 - 1e-6), "bound %g of lights that sum to %g", bound, sum);
        left += bound;
    }
    for (uint32_t i = 0; i < c->n_done; i++)
        if (!(c->done[i] & LC_LEAF)) {
            bool proved = i >= c->n_done - c->n_hidden;
            double sum = sum_below(s, c->done[i], q, proved);
            CHECKF(!(sum > 0), "a cluster of bound 0, or hidden, has lights that sum to %g", sum);
            n_proved += proved;
        }
    /* Estimate and exact value of each cluster left are within 0..bound; the others are exact. */
    lc_cut_result e = exact(s, q);
    double off = fabs(total - lum_of(e.radiance));
    CHECKF(off <= left * (1 + 1e-5) + 1e-5 * lum_of(e.radiance), "off by %g, bounds left sum to %g", off,
           left);
    CHECKF(!(total > 0) || !(worst > 0) || !isfinite(worst) ||
               fabs((double)r->max_error * total / worst - 1) < 1e-4,
           "max_error %g", (double)r->max_error);
}

TEST(cuts_partition_and_keep_their_promise)
{
    static const uint32_t sizes[] = { 1, 2, 3, 4, 7, 30, 250 }, max_cuts[] = { 1, 2, 3, 4, 5, 9, 40, 0 };
    static const float ratios[] = { 0, 0.02f, 0.3f };
    uint64_t at_limit = 0, within = 0, left = 0;
    for (uint32_t set = 0; set < LIGHT_SETS; set++)
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            const uint32_t kinds = light_set(set);
            setup s;
            make(&s, sizes[i], kinds, kinds % 2 ? 20 : 0, false);
            build_tree(&s, kinds, 1 + kinds % 3);
            for (size_t k = 0; k < sizeof max_cuts / sizeof *max_cuts; k++)
                for (size_t r = 0; r < 3; r++) {
                    lc_cut c;
                    open_cut(&c, &s, ratios[r], max_cuts[k], k % 2 ? 0.05f : 0);
                    for (int j = 0; j < 8; j++) {
                        point q = rnd_point();
                        lc_cut_result res = shade(&c, &q, rnd_n(1000));
                        check_cut(&s, &c, &q, &res);
                        at_limit += res.at_limit;
                        within += !res.at_limit;
                        left += n_left(&c);
                    }
                    lc_cut_free(&c);
                }
            unmake(&s);
        }
    printf("  %llu cuts at the limit, %llu within, %llu clusters left, %llu hidden, %llu of bound 0\n",
           (unsigned long long)at_limit, (unsigned long long)within, (unsigned long long)left,
           (unsigned long long)n_proved, (unsigned long long)n_zero);
    CHECK(at_limit > 1000 && within > 1000 && left > 10000 && n_proved > 100 && n_zero > 1000);
    CHECKF(!guards_broken, "%d bytes written outside of blocks", guards_broken);
}

/* Points on and very near lights, where bounds are largest. */
TEST(points_at_lights)
{
    for (uint32_t set = 0; set < LIGHT_SETS; set++) {
        const uint32_t kinds = light_set(set);
        setup s;
        make(&s, 200, kinds, 10, false);
        build_tree(&s, 3, 1);
        for (int i = 0; i < 60; i++) {
            lc_cut c;
            open_cut(&c, &s, i % 3 ? 0.02f : 0, i % 4 ? 0 : 30, 0);
            point q = rnd_point();
            lc_f3 at = lc_f3_add(s.lights[i].pos,
                                 lc_f3_scale(rnd_unit(), i % 2 ? 0 : powf(10, (float)rnd_in(-9, -2))));
            lc_f3_store(q.p.pos, at);
            lc_f3_store(q.org, at);
            lc_cut_result r = shade(&c, &q, 0);
            check_cut(&s, &c, &q, &r);
            lc_cut_free(&c);
        }
        unmake(&s);
    }
}

/* ---- the exact value, and means equal to it ---- */

/* Lights that differ in intensity alone are one light to the cut: of few of these in many copies each, a cut
 * has as many clusters as lights that differ, and is exact. Balls are not: shadow rays to them differ. */
TEST(equal_lights_are_one)
{
    for (uint32_t kind = 0; kind < LC_LIGHT_KINDS; kind++) {
        setup s;
        lc_cut c;
        const uint32_t n = 600, differ = 5;
        make(&s, n, 1u << kind, 0, true);
        for (uint32_t i = differ; i < n; i++) {
            lc_f3 intensity = s.lights[i].intensity;
            s.lights[i] = s.lights[i % differ];
            s.lights[i].intensity = intensity;
        }
        build_tree(&s, 7, 4);
        bool one = !lc_is_sized((lc_light_kind)kind);
        CHECK(!s.tree->alike == !one);
        open_cut(&c, &s, 1e-6f, 0, 0);
        for (int i = 0; i < 200; i++) {
            point q = rnd_point();
            lc_cut_result r = shade(&c, &q, (uint64_t)i), e = exact(&s, &q);
            double want = lum_of(e.radiance);
            /* where nothing arrives the limit is 0, which splits all that has a bound */
            CHECKF(!one || n_clusters(&c) <= differ || !(want > 0), "kind %u: %u clusters, %g", kind,
                   n_clusters(&c), want);
            CHECKF(!one || fabs(lum_of(r.radiance) - want) <= 1e-5 * want, "kind %u: %g, not %g", kind,
                   lum_of(r.radiance), want);
        }
        lc_cut_free(&c);
        unmake(&s);
    }
}

/* One bit of any field that estimates depend on makes lights differ. */
TEST(nearly_equal_lights_are_not_one)
{
    for (int field = 0; field < 4; field++) {
        setup s;
        make(&s, 2, 1u << (field == 3 ? LC_LIGHT_SPOT : LC_LIGHT_ORIENTED), 0, true);
        s.lights[1] = s.lights[0];
        lc_light *l = &s.lights[1];
        if (field == 0) l->pos.y = nextafterf(l->pos.y, 2);
        if (field == 1) l->dir = lc_f3_neg(l->dir);
        if (field == 2) l->atten[1] = 0.5f;
        if (field == 3) l->spot.cos_total = nextafterf(l->spot.cos_total, 1);
        build_tree(&s, 7, 4);
        CHECKF(!s.tree->alike, "field %d", field);
        unmake(&s);
    }
}

TEST(no_error_allowed_is_exact)
{
    double worst = 0;
    uint32_t lit = 0;
    for (uint32_t set = 0; set < LIGHT_SETS; set++) {
        const uint32_t kinds = light_set(set);
        setup s;
        lc_cut c;
        make(&s, 400, kinds, 20, false);
        build_tree(&s, 9, 2);
        open_cut(&c, &s, 0, 0, 0);
        for (int i = 0; i < 150; i++) {
            point q = rnd_point();
            lc_cut_result r = shade(&c, &q, (uint64_t)i), e = exact(&s, &q);
            double size = (double)lc_f3_max(e.radiance),
                   off = (double)lc_f3_max_abs(lc_f3_sub(r.radiance, e.radiance));
            CHECKF(off <= 1e-5 * size, "off by %g of %g", off, size);
            CHECK(!r.at_limit && n_left(&c) == 0 && !(r.max_error > 0));
            worst = fmax(worst, size > 0 ? off / size : 0);
            lit += size > 0;
        }
        lc_cut_free(&c);
        unmake(&s);
    }
    printf("  largest relative difference %.2g at %u lit points\n", worst, lit);
    CHECK(lit > 500);
}

#define MEAN_SEEDS 3000
#define MEAN_POINTS 16

/* With error ratio 0 the cut depends on bounds only and not on representatives, so that for any size of the
 * cut the mean over the choice of representatives is the exact value. max_cut 1: the roots only. */
static void mean_is_exact(uint32_t max_cut, uint32_t kinds, uint32_t n_tris, uint32_t n_reps)
{
    static double sum[MEAN_POINTS], sum2[MEAN_POINTS];
    point q[MEAN_POINTS];
    setup s;
    double worst = 0, z2 = 0;
    uint32_t noisy = 0;
    memset(sum, 0, sizeof sum);
    memset(sum2, 0, sizeof sum2);
    make(&s, 40, kinds, n_tris, true);
    for (int i = 0; i < MEAN_POINTS; i++) q[i] = rnd_point();
    for (uint64_t seed = 0; seed < MEAN_SEEDS; seed++) {
        lc_cut c;
        build_tree(&s, lc_mix(seed + 1), n_reps);
        open_cut(&c, &s, 0, max_cut, 0);
        for (int i = 0; i < MEAN_POINTS; i++) {
            lc_cut_result r = shade(&c, &q[i], lc_mix(seed));
            CHECK(r.size <= max_cut || r.size <= LC_LIGHT_KINDS);
            double y = lum_of(r.radiance);
            sum[i] += y;
            sum2[i] += y * y;
        }
        lc_cut_free(&c);
    }
    for (int i = 0; i < MEAN_POINTS; i++) {
        double want = lum_of(exact(&s, &q[i]).radiance), mean = sum[i] / MEAN_SEEDS;
        double err = sqrt(fmax(sum2[i] / MEAN_SEEDS - mean * mean, 0) / MEAN_SEEDS);
        if (err > 1e-4 * want) {
            double z = (mean - want) / err;
            worst = fmax(worst, fabs(z));
            z2 += z * z;
            noisy++;
            CHECKF(fabs(z) < 4.5, "mean %g, exact %g, standard error %g", mean, want, err);
        } else { /* the same for all seeds */
            CHECKF(fabs(mean - want) <= 1e-3 * want, "mean %g, exact %g", mean, want);
        }
    }
    printf("  max_cut %u, kinds %u: %u noisy points, worst %.2f standard errors, rms %.2f\n", max_cut, kinds,
           noisy, worst, sqrt(z2 / (noisy ? noisy : 1)));
    CHECK(noisy >= MEAN_POINTS / 2);
    unmake(&s);
}

TEST(roots_alone_are_exact_on_average)
{
    for (uint32_t kinds = 1; kinds < 8; kinds++) mean_is_exact(1, kinds, kinds == 2 ? 0 : 12, 1);
    mean_is_exact(1, 7, 12, 3);
}

TEST(small_cuts_are_exact_on_average)
{
    mean_is_exact(2, 7, 12, 1);
    mean_is_exact(6, 7, 12, 2);
    mean_is_exact(12, 5, 0, 1);
}

#define CUT_POINTS 12
#define CUT_SIZE 10

/* The estimates of one cluster of a cut, summed over the seeds. */
typedef struct {
    uint32_t link;
    double sum, sum2;
} estimated;

static void judge_cluster(const setup *s, const point *q, const estimated *e, double *worst, uint32_t *noisy)
{
    double want = sum_below(s, e->link, q, true), mean = e->sum / MEAN_SEEDS;
    double err = sqrt(fmax(e->sum2 / MEAN_SEEDS - mean * mean, 0) / MEAN_SEEDS);
    if (err > 1e-4 * want) {
        *worst = fmax(*worst, fabs(mean - want) / err);
        ++*noisy;
        CHECKF(fabs(mean - want) < 4.5 * err, "mean %g, exact %g, standard error %g", mean, want, err);
    } else {
        CHECKF(fabs(mean - want) <= 1e-3 * want + 1e-30, "mean %g, exact %g", mean, want);
    }
}

/* The mean of each cluster's estimate is its exact value. The cut of error ratio 0 and a given size is the
 * same for all representatives, so that each of its clusters appears for each seed. */
static void clusters_mean_is_exact(uint32_t kinds, uint32_t n_reps)
{
    static estimated all[CUT_POINTS][CUT_SIZE];
    point q[CUT_POINTS];
    setup s;
    double worst = 0;
    uint32_t noisy = 0, n_left_of[CUT_POINTS] = { 0 };
    memset(all, 0, sizeof all);
    make(&s, 80, kinds, 12, true);
    for (int i = 0; i < CUT_POINTS; i++) q[i] = rnd_point();
    for (uint64_t seed = 0; seed < MEAN_SEEDS; seed++) {
        lc_cut c;
        build_tree(&s, lc_mix(seed + 1), n_reps);
        s.visibility.occluders = NULL; /* which clusters are proved to be hidden depends on representatives */
        open_cut(&c, &s, 0, CUT_SIZE, 0);
        for (int i = 0; i < CUT_POINTS; i++) {
            shade(&c, &q[i], lc_mix(seed));
            CHECK(!seed || n_left(&c) == n_left_of[i]);
            n_left_of[i] = n_left(&c);
            for (uint32_t k = 0; k < n_left(&c); k++) {
                estimated *e = &all[i][k];
                double y = lum_of(lc_f3_make(c.kept.e[0][k], c.kept.e[1][k], c.kept.e[2][k]));
                CHECK(!seed || e->link == c.kept.link[k]);
                e->link = c.kept.link[k];
                e->sum += y;
                e->sum2 += y * y;
            }
        }
        lc_cut_free(&c);
    }
    for (int i = 0; i < CUT_POINTS; i++)
        for (uint32_t k = 0; k < n_left_of[i]; k++) judge_cluster(&s, &q[i], &all[i][k], &worst, &noisy);
    printf("  kinds %u, %u slots: %u noisy clusters, worst %.2f standard errors\n", kinds, n_reps, noisy,
           worst);
    CHECK(noisy >= CUT_POINTS);
    unmake(&s);
}

TEST(clusters_are_exact_on_average)
{
    for (uint32_t kinds = 1; kinds < 8; kinds *= 2) clusters_mean_is_exact(kinds, 1);
    clusters_mean_is_exact(7, 16);
    clusters_mean_is_exact(3, LC_MAX_REPS);
}

/* ---- limits, reuse, damage ---- */

TEST(no_lights_is_black)
{
    setup s;
    lc_cut c;
    make(&s, 0, 7, 3, false);
    build_tree(&s, 1, 1);
    open_cut(&c, &s, 0.02f, 10, 0);
    point q = rnd_point();
    lc_cut_result r = shade(&c, &q, 5), e = exact(&s, &q);
    CHECK(r.size == 0 && r.rays == 0 && e.size == 0 && !r.at_limit);
    CHECK(!(r.radiance.x > 0) && !(e.radiance.x > 0));
    lc_cut_free(&c);
    unmake(&s);
}

/* Results have the same bits whatever the scratch memory was used for before. */
TEST(scratch_leaves_no_trace)
{
    setup s;
    lc_cut used, fresh;
    make(&s, 300, 7, 20, false);
    build_tree(&s, 1, 4);
    open_cut(&used, &s, 0.02f, 60, 0.01f);
    for (int i = 0; i < 300; i++) {
        point q = rnd_point();
        open_cut(&fresh, &s, 0.02f, 60, 0.01f);
        lc_cut_result a = shade(&used, &q, (uint64_t)i), b = shade(&fresh, &q, (uint64_t)i);
        CHECK(!memcmp(&a.radiance, &b.radiance, sizeof a.radiance) && a.size == b.size && a.rays == b.rays);
        CHECK(!memcmp(&a.max_error, &b.max_error, sizeof a.max_error) && a.dark == b.dark &&
              a.at_limit == b.at_limit);
        lc_cut_free(&fresh);
    }
    lc_cut_free(&used);
    unmake(&s);
}

static bool alike(lc_f3 a, lc_f3 b)
{
    lc_f3 d = lc_f3_sub(a, b);
    return lc_f3_max_abs(d) <= 1e-5f * lc_f3_max_abs(b);
}

/* A cut that starts from the cut of another point has the properties of every cut, of which some are that its
 * hidden clusters are hidden, also those that were proved to be for a box of points; one that starts from the
 * point's own cut has its clusters and its value. */
TEST(cuts_from_other_cuts)
{
    static lc_cut_start start;
    uint32_t n_guided = 0, n_at_limit = 0, n_shared = 0, n_outside = 0;
    for (uint32_t kinds = 1; kinds < 16; kinds++) {
        setup s;
        lc_cut from_roots, guided;
        uint32_t max_cut = kinds % 3 ? 0 : 40;
        make(&s, 400, kinds, 20, false);
        build_tree(&s, kinds, 5);
        open_cut(&from_roots, &s, 0.02f, max_cut, 0);
        open_cut(&guided, &s, 0.02f, max_cut, 0);
        for (int i = 0; i < 60; i++) {
            point q = rnd_point(), other = q;
            uint64_t hash = lc_mix((uint64_t)i);
            if (i % 2) {
                other.p.pos[0] += 0.05f;
                other.org[0] += 0.05f;
            }
            if (i % 5 == 4) other = rnd_point();
            start.has_points = i % 3 > 0;
            for (int k = 0; k < 3; k++) {
                start.points.half[k] = i % 3 == 1 ? 0.06f : 0.001f;
                start.points.center[k] = q.org[k];
            }
            from_roots.start_out = &start;
            lc_cut_result a = shade(&from_roots, &q, hash);
            uint32_t n = start.n_nodes + start.n_lights, n_block = start.n_block;
            CHECK(n_block <= start.n_hidden && (start.has_points || !n_block));
            uint32_t all = n_clusters(&from_roots);
            CHECKF(n <= all && (max_cut ? n <= max_cut / 2 : n + n_block >= all), "%u of %u", n, all);
            CHECK(max_cut || start.has_points || n == all);
            from_roots.start_out = NULL;
            guided.start = &start;
            lc_cut_result b = shade(&guided, &other, hash + (uint64_t)(i & 4)), e = exact(&s, &other);
            check_cut(&s, &guided, &other, &b);
            const bool inside = start.has_points && lc_point_box_holds(&start.points, other.org);
            CHECK(guided.in_block == inside && (!inside || guided.worst_first || guided.n_hidden >= n_block));
            n_shared += inside ? n_block : 0;
            n_outside += inside ? 0 : n_block;
            CHECK(n_clusters(&guided) + guided.n_hidden >= n &&
                  b.size == size_of(&guided, max_cut ? max_cut : s.n));
            float lum = lc_luminance(b.radiance);
            for (uint32_t k = 0; k < guided.kept.n && !b.at_limit; k++)
                CHECK(guided.kept.bound[k] <= 0.02f * lum * 1.0001f);
            if (n_clusters(&guided) + guided.n_hidden == s.n) CHECK(alike(b.radiance, e.radiance));
            if (!max_cut && !(i % 2) && i % 5 != 4 && !(i & 4)) {
                CHECKF(b.size == a.size || (start.has_points && b.size < a.size), "%u clusters, %u", b.size,
                       a.size);
                CHECK(alike(a.radiance, b.radiance));
                n_guided++;
            }
            n_at_limit += b.at_limit;
        }
        lc_cut_free(&from_roots);
        lc_cut_free(&guided);
        unmake(&s);
    }
    CHECK(n_guided > 100 && n_at_limit > 10);
    CHECKF(n_shared > 100 && n_outside > 100, "%u, %u", n_shared, n_outside);
}

TEST(dark_floor_stops_refinement)
{
    setup s;
    lc_cut plain, bright;
    uint32_t n_dark = 0;
    make(&s, 300, 7, 20, false);
    build_tree(&s, 1, 1);
    open_cut(&plain, &s, 0.02f, 0, 0);
    open_cut(&bright, &s, 0.02f, 0, 1e30f);
    for (int i = 0; i < 100; i++) {
        point q = rnd_point();
        lc_cut_result a = shade(&plain, &q, 0), b = shade(&bright, &q, 0);
        CHECK(!a.dark && !a.at_limit && !b.at_limit);
        CHECKF(b.size <= LC_LIGHT_KINDS && b.size <= a.size, "size %u, without floor %u", b.size, a.size);
        n_dark += b.dark;
    }
    CHECK(n_dark > 50);
    lc_cut_free(&plain);
    lc_cut_free(&bright);
    unmake(&s);
}

TEST(smaller_ratio_larger_cut)
{
    static const float ratios[] = { 1, 0.1f, 0.02f, 0.005f, 0 };
    setup s;
    uint64_t size[5] = { 0 };
    make(&s, 1000, 7, 20, false);
    build_tree(&s, 1, 1);
    for (int k = 0; k < 5; k++) {
        lc_cut c;
        open_cut(&c, &s, ratios[k], 0, 0);
        rng_ctr = 1u << 20; /* the same points for each ratio */
        for (int i = 0; i < 40; i++) {
            point q = rnd_point();
            size[k] += shade(&c, &q, 0).size;
        }
        CHECKF(k == 0 || size[k] > size[k - 1], "ratio %g: %llu", (double)ratios[k],
               (unsigned long long)size[k]);
        lc_cut_free(&c);
    }
    unmake(&s);
}

TEST(validator_finds_damage)
{
    setup s;
    lc_cut c;
    make(&s, 100, 7, 0, false);
    build_tree(&s, 1, 1);
    open_cut(&c, &s, 0.05f, 0, 0);
    for (int i = 0; i < 30; i++) {
        point q = rnd_point();
        shade(&c, &q, 0);
        CHECK(!lc_cut_validate(&c));
        if (c.n_done) {
            uint32_t keep = c.done[0];
            c.n_done--;
            CHECK(lc_cut_validate(&c));
            c.n_done++;
            c.done[0] = c.n_done > 1 ? c.done[1] : 0;
            CHECK(c.n_done == 1 || lc_cut_validate(&c));
            c.done[0] = keep;
        }
        if (n_left(&c)) {
            uint32_t *link = &c.kept.link[0], keep = *link;
            *link = s.tree->data.nodes[keep].left;
            CHECK(lc_cut_validate(&c));
            *link = s.tree->root[lc_kind_of_node(s.tree, keep)];
            CHECK(n_left(&c) + c.n_done == 1 || lc_cut_validate(&c));
            *link = keep;
        }
        CHECK(!lc_cut_validate(&c));
    }
    lc_cut_free(&c);
    unmake(&s);
}

TEST(no_memory_lost_or_overrun)
{
    lc_context_destroy(ctx);
    CHECKF(bytes_live == 0 && blocks_live == 0, "%zu bytes", bytes_live);
    CHECKF(!guards_broken, "%d bytes written outside of blocks", guards_broken);
}

int main(void)
{
    ctx = watched_context(0);
    printf("seed %llu\n", (unsigned long long)rng_key);
    RUN(no_lights_is_black);
    RUN(cuts_partition_and_keep_their_promise);
    RUN(points_at_lights);
    RUN(equal_lights_are_one);
    RUN(nearly_equal_lights_are_not_one);
    RUN(no_error_allowed_is_exact);
    RUN(roots_alone_are_exact_on_average);
    RUN(small_cuts_are_exact_on_average);
    RUN(clusters_are_exact_on_average);
    RUN(scratch_leaves_no_trace);
    RUN(cuts_from_other_cuts);
    RUN(dark_floor_stops_refinement);
    RUN(smaller_ratio_larger_cut);
    RUN(validator_finds_damage);
    RUN(no_memory_lost_or_overrun);
    return test_done();
}
