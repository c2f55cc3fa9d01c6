/* unit_gather.c - cuts of gather clusters: without an error they are the mean of the points' exact values,
 * whatever they begin with; roots are on average; and there may be little room. */
#include "cut/cut_gather.h"
#include "support/cut_scene.h"

#define MOST 256

typedef struct {
    lc_gather gather;
    lc_gather_point point[MOST];
    lc_point own[MOST]; /* with their own reflectances */
    uint32_t n;
} cluster;

static uint32_t parent[1000];

static void find_parents(const setup *s)
{
    memset(parent, 0xff, sizeof parent);
    for (uint32_t i = 0; i < s->tree->n_nodes; i++) {
        const uint32_t child[2] = { s->tree->data.nodes[i].left, s->tree->data.nodes[i].right };
        for (int k = 0; k < 2; k++)
            if (child[k] & LC_LEAF) parent[child[k] & ~LC_LEAF] = i;
    }
}

static lc_lobe lobe = LC_LOBE_NONE; /* of all points */

/* n points of a bent patch; textured: each has a reflectance of its own. */
static void make_cluster(cluster *x, uint32_t n, double size, bool textured)
{
    const lc_f3 at = rnd_in_box(1.1), normal = rnd_unit(),
                view = lc_f3_normalize(lc_f3_add(normal, rnd_in_box(0.3)));
    x->n = n;
    for (uint32_t i = 0; i < n; i++) {
        lc_material m = { .kd = { 0.6f, 0.5f, 0.4f }, .exponent = 20, .roughness = { 0.3f, 0.2f } };
        if (lobe != LC_LOBE_NONE) {
            m.lobe = lobe;
            m.ks = lc_f3_make(0.3f, 0.4f, 0.5f);
        }
        if (textured) m.kd = lc_f3_make((float)rnd(), (float)rnd(), (float)rnd());
        const lc_f3 pos = lc_f3_add(at, rnd_in_box(size)),
                    bent = lc_f3_normalize(lc_f3_add(normal, rnd_in_box(0.1)));
        lc_gather_point *p = &x->point[i];
        lc_point_init(p->p, pos, i % 3 ? bent : normal, view, &m, (float)(1e-10 * DIAG2));
        p->p[1] = p->p[0];
        lc_f3_store(p->org, pos);
        x->own[i] = p->p[0];
    }
    lc_gather_make(&x->gather, x->point, n);
}

static lc_f3 mean_exact(const setup *s, const cluster *x)
{
    double sum[3] = { 0, 0, 0 };
    for (uint32_t i = 0; i < x->n; i++) {
        point q = { .p = x->own[i] };
        lc_f3_store(q.org, lc_f3_load(q.p.pos));
        const lc_f3 e = exact(s, &q).radiance;
        sum[0] += (double)e.x / x->n, sum[1] += (double)e.y / x->n, sum[2] += (double)e.z / x->n;
    }
    return lc_f3_make((float)sum[0], (float)sum[1], (float)sum[2]);
}

static void open_gather(lc_cut *c, const setup *s, float error, uint32_t max_cut, float floor_lum)
{
    const lc_cut_desc d = { .error_ratio = error, .max_cut = max_cut, .floor = floor_lum, .z = 1,
                            .max_points = MOST, .parent = parent };
    if (lc_cut_init(c, ctx, s->tree, &s->visibility, &d, false)) abort();
}

static lc_cut_result shade_cluster(lc_cut *c, const cluster *x, uint64_t hash)
{
    lc_stats stats = { 0 };
    lc_cut_result r;
    lc_cut_shade_gather(c, &x->gather, hash, &stats, &r);
    CHECK(stats.points == 1 && stats.shadow_rays == r.rays && stats.cut_sum == r.size && !c->gather);
    return r;
}

/* Sets the start that cuts of the cluster begin with: that of its first point. */
static void save_start(lc_cut *c, const cluster *x, lc_cut_start *start)
{
    lc_stats stats = { 0 };
    lc_cut_result r;
    start->has_points = false;
    c->start = NULL;
    c->start_out = start;
    lc_cut_shade(c, &x->own[0], x->point[0].org, 3, &stats, &r);
    c->start_out = NULL;
}

/* Each kind of light alone and some together, one light and many; points that are near and far apart, with
 * reflectances of their own; cuts from the roots and from a start. The error asked for is 1e-7, sums are of
 * some hundred floats: 2e-4. */
TEST(no_error_is_the_mean_of_exact_values)
{
    static cluster x;
    static lc_cut_start start;
    for (uint32_t kinds = 1; kinds < 1u << LC_LIGHT_KINDS; kinds = kinds * 2 + (kinds & 1 && kinds > 1)) {
        for (int way = 0; way < 4; way++) {
            setup s;
            lc_cut c;
            make(&s, way & 1 ? 24 : 1, kinds, 12, true);
            build_tree(&s, kinds, 4);
            find_parents(&s);
            open_gather(&c, &s, 1e-7f, 0, 0);
            for (int i = 0; i < 8; i++) {
                make_cluster(&x, 2 + rnd_n(30), i & 1 ? 0.3 : 0.01, i & 2);
                if (way & 2) save_start(&c, &x, &start);
                c.start = way & 2 ? &start : NULL;
                const lc_f3 want = mean_exact(&s, &x), got = shade_cluster(&c, &x, (uint64_t)i).radiance;
                CHECKF(lc_f3_max_abs(lc_f3_sub(got, want)) <= 2e-4f * lc_f3_max_abs(want),
                       "kinds %u, way %d: %g, not %g", kinds, way, (double)got.y, (double)want.y);
            }
            lc_cut_free(&c);
            unmake(&s);
        }
    }
}

/* The same of points with lobes, which keep their own reflectances. */
TEST(no_error_with_lobes)
{
    static const lc_lobe lobes[] = { LC_LOBE_PHONG, LC_LOBE_WARD, LC_LOBE_GGX, LC_LOBE_OREN_NAYAR };
    static cluster x;
    for (uint32_t k = 0; k < 4; k++)
        for (uint32_t kinds = 1; kinds < 1u << LC_LIGHT_KINDS; kinds = kinds * 2 + (kinds & 1 && kinds > 1)) {
            setup s;
            lc_cut c;
            lobe = lobes[k];
            make(&s, 24, kinds, 12, true);
            build_tree(&s, kinds, 4);
            find_parents(&s);
            open_gather(&c, &s, 1e-7f, 0, 0);
            for (int i = 0; i < 8; i++) {
                make_cluster(&x, 2 + rnd_n(30), i & 1 ? 0.3 : 0.01, i & 2);
                CHECK(x.gather.lobed && !x.gather.uneven);
                const lc_f3 want = mean_exact(&s, &x), got = shade_cluster(&c, &x, (uint64_t)i).radiance;
                CHECKF(lc_f3_max_abs(lc_f3_sub(got, want)) <= 2e-4f * lc_f3_max_abs(want),
                       "lobe %u, kinds %u: %g, not %g", k, kinds, (double)got.y, (double)want.y);
            }
            lc_cut_free(&c);
            unmake(&s);
        }
    lobe = LC_LOBE_NONE;
}

/* The mean over a cluster's points of what a node's lights give, unoccluded; luminance. */
static double mean_of_node(const setup *s, const cluster *x, uint32_t node)
{
    const lc_tree_data *t = &s->tree->data;
    uint32_t left[64], n = 1;
    double sum = 0;
    left[0] = node;
    while (n) {
        const uint32_t link = left[--n], light = link & ~LC_LEAF;
        float f[6][LC_LANES], *const out[6] = { f[0], f[1], f[2], f[3], f[4], f[5] };
        if (!(link & LC_LEAF)) {
            left[n++] = t->nodes[link].left;
            left[n++] = t->nodes[link].right;
            continue;
        }
        const float *power = t->lights[light].intensity;
        for (uint32_t i = 0; i < x->n; i++) {
            ctx->shade_kernels->estimate(t, 0, &light, 1, lc_kind_of_light(s->tree, light), x->point[i].p,
                                         out);
            sum += lum_of(lc_f3_make(f[0][0] * power[0], f[1][0] * power[1], f[2][0] * power[2])) / x->n;
        }
    }
    return sum;
}

/* Of points with lobes, of which there are no more than have their bounds asked, none is below what a node's
 * lights give; of more, none is 0 where they give anything. */
TEST(bounds_with_lobes)
{
    static cluster x;
    for (int way = 0; way < 64; way++) {
        setup s;
        lc_cut c;
        lobe = way & 1 ? LC_LOBE_PHONG : LC_LOBE_GGX;
        make(&s, 40, 1u << way % LC_LIGHT_KINDS, 0, true);
        build_tree(&s, 7, 4);
        find_parents(&s);
        open_gather(&c, &s, 0.1f, 0, 0);
        make_cluster(&x, way & 2 ? 2 + rnd_n(15) : 40, 0.3, false);
        c.gather = &x.gather;
        for (uint32_t node = 0; node < s.tree->n_nodes; node++) {
            float bound[LC_LANES];
            lc_cut_lobed_bounds(&c, &node, 1, lc_kind_of_node(s.tree, node), bound);
            const double gives = mean_of_node(&s, &x, node);
            CHECKF(x.n > 16 ? bound[0] > 0 || !(gives > 0) : (double)bound[0] >= gives * (1 - 1e-5),
                   "%u points, node %u: %g, gives %g", x.n, node, (double)bound[0], gives);
        }
        c.gather = NULL;
        lc_cut_free(&c);
        unmake(&s);
    }
    lobe = LC_LOBE_NONE;
}

/* One directional light beside point lights: it has no parent in the tree. */
TEST(a_light_that_is_a_root)
{
    static cluster x;
    static lc_cut_start start;
    for (uint32_t kind = 0; kind < LC_LIGHT_KINDS; kind++)
        for (int i = 0; i < 4; i++) {
            setup s;
            lc_cut c;
            const uint32_t other = kind == LC_LIGHT_POINT ? LC_LIGHT_ORIENTED : LC_LIGHT_POINT;
            make(&s, 40, 1u << other, 6, true);
            setup one;
            make(&one, 1, 1u << kind, 0, true);
            s.lights[7] = one.lights[0];
            unmake(&one);
            build_tree(&s, 5, 4);
            find_parents(&s);
            open_gather(&c, &s, 1e-7f, i & 1 ? 0 : 10000, 0);
            make_cluster(&x, 16, 0.05, true);
            if (i & 2) save_start(&c, &x, &start);
            c.start = i & 2 ? &start : NULL;
            const lc_f3 want = mean_exact(&s, &x), got = shade_cluster(&c, &x, 9).radiance;
            CHECKF(lc_f3_max_abs(lc_f3_sub(got, want)) <= 2e-4f * lc_f3_max_abs(want), "kind %u: %g, not %g",
                   kind, (double)got.y, (double)want.y);
            lc_cut_free(&c);
            unmake(&s);
        }
}

/* A wall across x = 0 up to `top`, of two triangles, that points below look over at lights behind it. */
static void make_wall(setup *s, uint32_t kind, float top)
{
    static const float corner[4][2] = { { -5, -5 }, { 5, -5 }, { 5, 1 }, { -5, 1 } };
    static const uint32_t index[6] = { 0, 1, 2, 0, 2, 3 };
    make(s, 40, 1u << kind, 0, true);
    for (int i = 0; i < 4; i++)
        lc_f3_store(s->pos + 3 * i, lc_f3_make(0, corner[i][0], i < 2 ? corner[i][1] : top));
    memcpy(s->index, index, sizeof index);
    s->n_tris = 2;
    build_triangles(s);
    for (uint32_t i = 0; i < s->n; i++) {
        lc_light *l = &s->lights[i];
        const lc_f3 at = lc_f3_add(lc_f3_make(1, 0, 0), rnd_in_box(0.1));
        if (lc_is_far(l->kind)) l->dir = lc_f3_neg(lc_f3_normalize(at));
        else l->pos = at;
        l->radius = lc_is_far(l->kind) ? 0.2f : 0.3f;
    }
}

/* Whether the ray from a point of a cluster to its part of a light is stopped; by which occluder. */
static bool is_stopped(const setup *s, lc_cut *c, const lc_gather_point *q, uint32_t light, uint32_t *by)
{
    const lc_light_kind kind = lc_kind_of_light(s->tree, light);
    float to[3];
    const float *const target[3] = { to, to + 1, to + 2 };
    uint8_t hidden[LC_LANES];
    uint32_t blocker[LC_LANES];
    lc_light_target(kind, &s->tree->data.lights[light], q->p, to);
    s->bvh->kernels->hidden(&s->bvh->data, q->org, 1, target, lc_is_far(kind), hidden, blocker);
    if (!hidden[0]) return false;
    lc_occlusion_start(c->occlusion, q->org);
    lc_occlusion_note(c->occlusion, light, blocker[0]);
    *by = lc_occlusion_by(c->occlusion, light, lc_is_far(kind));
    return true;
}

/* A wall that covers the middle of round lights and some of their rims: what is proved to be hidden from all
 * points is, from each of them in each turn. */
TEST(round_lights_behind_an_edge)
{
    static const lc_light_kind round[] = { LC_LIGHT_BALL, LC_LIGHT_SKY };
    static cluster x;
    uint32_t n_proved = 0, n_not = 0;
    for (int i = 0; i < 32; i++) {
        setup s;
        lc_cut c;
        lc_stats stats = { 0 };
        uint32_t by = LC_NONE, not_by;
        make_wall(&s, round[i & 1], 0.015f * (float)i);
        build_tree(&s, 5, 4);
        open_gather(&c, &s, 0.02f, 0, 0);
        make_cluster(&x, 32, 0.02, false);
        for (uint32_t k = 0; k < x.n; k++) {
            const lc_f3 at = lc_f3_add(lc_f3_make(-1, 0, 0), rnd_in_box(0.02)), toward = { 1, 0, 0 };
            const lc_material m = { .kd = { 0.6f, 0.5f, 0.4f } };
            lc_point_init(x.point[k].p, at, toward, toward, &m, (float)(1e-10 * DIAG2));
            x.point[k].p[0].turn = k;
            lc_f3_store(x.point[k].org, at);
        }
        lc_gather_make(&x.gather, x.point, x.n);
        c.gather = &x.gather;
        c.light_mask = LC_PAIR - 1;
        for (uint32_t light = 0; light < s.n; light++) {
            bool all = true;
            if (!is_stopped(&s, &c, &x.point[rnd_n(x.n)], light, &by) || by == LC_NONE) continue;
            const bool proved = lc_cut_gather_proves(&c, LC_PAIR | light, by, &stats);
            for (uint32_t k = 0; k < x.n; k++) all &= is_stopped(&s, &c, &x.point[k], light, &not_by);
            CHECKF(!proved || all, "%s, edge %d", lc_light_kinds[round[i & 1]].name, i);
            n_proved += proved;
            n_not += !all;
        }
        c.gather = NULL;
        lc_cut_free(&c);
        unmake(&s);
    }
    CHECKF(n_proved > 100 && n_not > 100, "%u proved, %u seen", n_proved, n_not);
}

/* As many points as there may be, and room for hardly a cut: nothing is written where there is no room, which
 * a sanitizer sees, and the size stays within it. */
TEST(little_room)
{
    static cluster x;
    static lc_cut_start start;
    for (uint32_t max_cut = 1; max_cut < 300; max_cut += max_cut)
        for (int way = 0; way < 4; way++) {
            setup s;
            lc_cut c;
            make(&s, way & 1 ? 200 : 1, way & 1 ? 7 : 1, 6, true);
            build_tree(&s, 5, 4);
            find_parents(&s);
            open_gather(&c, &s, 1e-7f, max_cut, 0);
            make_cluster(&x, MOST, 0.1, true);
            if (way & 2) save_start(&c, &x, &start);
            c.start = way & 2 ? &start : NULL;
            const lc_cut_result r = shade_cluster(&c, &x, 9);
            CHECKF(r.size <= c.max_size && (max_cut < 3 || c.max_size <= max_cut), "%u of %u", r.size,
                   max_cut);
            lc_cut_free(&c);
            unmake(&s);
        }
}

/* Over trees, slots and the order of points the mean of the roots' estimates is the exact value, within five
 * standard errors of the trees' means. Finer cuts stop by what was estimated, which is no longer so. */
TEST(roots_are_exact_on_average)
{
    static cluster x;
    for (uint32_t kinds = 1; kinds < 8; kinds++) {
        setup s;
        double sum = 0, sum2 = 0, want = 0;
        const int n_trees = 1000, n_each = 16;
        make(&s, 60, kinds, 12, true);
        make_cluster(&x, 16, 0.1, kinds & 1);
        for (int t = 0; t < n_trees; t++) {
            lc_cut c;
            double mean = 0;
            build_tree(&s, lc_hash2(11, (uint64_t)t), n_each);
            find_parents(&s);
            if (!t) want = lum_of(mean_exact(&s, &x));
            open_gather(&c, &s, 1, 0, 1e9f);
            for (int i = 0; i < n_each; i++) {
                const uint64_t hash = (uint64_t)i | lc_hash2(7, (uint64_t)t) << 32;
                mean += lum_of(shade_cluster(&c, &x, hash).radiance) / n_each;
            }
            sum += mean / n_trees;
            sum2 += mean * mean / n_trees;
            lc_cut_free(&c);
        }
        const double off = sqrt(fmax(sum2 - sum * sum, 0) / n_trees);
        printf("  kinds %u: %g, exact %g, standard error %g\n", kinds, sum, want, off);
        CHECKF(fabs(sum - want) <= 5 * off, "kinds %u: %g, exact %g", kinds, sum, want);
        unmake(&s);
    }
}

/* Every level's ranges hold every point once. */
TEST(ranges_are_a_partition)
{
    for (uint32_t n = 1; n <= MOST; n += n < 40 ? 1 : 27)
        for (uint32_t level = 0; level <= 8; level++) {
            uint32_t end = 0;
            for (uint32_t at = 0, lo, hi; at < n; at = hi) {
                for (uint32_t k = 0; k < level; k++) {
                    lc_gather_range(n, k, at, &lo, &hi);
                    if (hi - lo == 1) break;
                }
                if (!level || hi - lo > 1) lc_gather_range(n, level, at, &lo, &hi);
                CHECK(lo == end && hi > lo && hi <= n);
                end = hi;
            }
            CHECK(end == n);
        }
    CHECK(lc_gather_capacity(1000) == 256 && lc_gather_capacity(1u << 25) == 64 &&
          lc_gather_capacity(1u << 27) == 1);
}

int main(void)
{
    ctx = watched_context(0);
    RUN(ranges_are_a_partition);
    RUN(no_error_is_the_mean_of_exact_values);
    RUN(no_error_with_lobes);
    RUN(bounds_with_lobes);
    RUN(a_light_that_is_a_root);
    RUN(round_lights_behind_an_edge);
    RUN(little_room);
    RUN(roots_are_exact_on_average);
    lc_context_destroy(ctx);
    return test_done();
}
