/* unit_worst_first.c - which clusters a cut splits: hardly more than a strict heap, which splits the worst
 * again and again; and where the room is short, more work never makes a cut worse. All memory is
 * watched_memory.h's. */
#include "support/cut_scene.h"

/* The root of the sum of the squared bounds of what is left. */
static double root_of(const lc_cut *c)
{
    double sum = 0;
    for (uint32_t i = 0; i < n_left(c); i++) sum += (double)c->kept.bound[i] * (double)c->kept.bound[i];
    return sqrt(sum);
}

/* With z the whole cut is within its limit, and hardly finer than it need be: what splitting the worst
 * cluster again and again would have made at that limit has not many clusters fewer. */
TEST(whole_cut_keeps_its_limit)
{
    static const float zs[] = { 0.05f, 0.3f, 2 };
    setup s;
    uint64_t size[3] = { 0 };
    double slack = 0;
    uint32_t n = 0;
    make(&s, 2000, 7, 20, false);
    build_tree(&s, 1, 4);
    for (int k = 0; k < 3; k++) {
        lc_cut c;
        lc_cut_desc d = { .error_ratio = 0.02f, .floor = 1e-3f, .z = zs[k] };
        if (lc_cut_init(&c, ctx, s.tree, &s.visibility, &d, true)) abort();
        rng_ctr = 1u << 21;
        for (int i = 0; i < 60; i++) {
            point q = rnd_point();
            lc_cut_result r = shade(&c, &q, (uint64_t)i);
            const double most = 0.02 / (double)zs[k] * fmax(lum_of(r.radiance), 1e-3);
            CHECK(!lc_cut_validate(&c) && !r.at_limit);
            CHECKF(root_of(&c) <= most * (1 + 1e-5), "root %g, limit %g", root_of(&c), most);
            CHECK(fabs((double)r.max_error - root_of(&c) * 0.02 / most) <= 1e-4 * (double)r.max_error);
            size[k] += r.size;
            if (n_left(&c) > 30) {
                slack += root_of(&c) / most;
                n++;
            }
        }
        lc_cut_free(&c);
    }
    CHECK(size[0] < size[1] && size[1] < size[2]);
    printf("  %u cuts, root over its limit %.3f on average\n", n, slack / n);
    CHECK(n > 20 && slack / n > 0.9);
    unmake(&s);
}

/* ---- a strict heap ---- */

/* The cluster of the largest bound is split, again and again, every ray traced at once, until the cut is
 * within its limit or holds max_cut clusters: the order that cut.h keeps only from round to round. */
typedef struct {
    double bound, e; /* e: luminance of the estimate */
    uint32_t link;
} strict_cluster;

typedef struct {
    const setup *s;
    const point *q;
    uint32_t slot, n, n_done;
    strict_cluster heap[4096];
    double done, total, sum2; /* done: luminance of lights, of total */
} strict_cut;

static void strict_push(strict_cut *h, uint32_t link)
{
    const lc_light_tree *t = h->s->tree;
    const uint32_t rep = lc_rep_of(t, link, h->slot);
    const lc_light_rec *l = &t->data.lights[rep];
    const bool leaf = link & LC_LEAF;
    const float *intensity = leaf ? l->intensity : t->data.nodes[link].intensity;
    float bound[LC_LANES] = { 1 };
    if (!leaf) ctx->shade_kernels->bounds(&t->data, &link, 1, lc_kind_of_node(t, link), &h->q->p, bound);
    if (!(bound[0] > 0)) return;
    const lc_f3 mg = one_transfer(&h->q->p, lc_kind_of_light(t, rep), l, lc_light_atten(&t->data, rep));
    const double e = is_hidden(h->s, h->q, rep) ? 0 : lum_of(lc_f3_mul(mg, lc_f3_load(intensity)));
    if (leaf) {
        h->done += e;
        h->n_done++;
        return;
    }
    uint32_t at = h->n++;
    for (; at && h->heap[(at - 1) / 2].bound < (double)bound[0]; at = (at - 1) / 2)
        h->heap[at] = h->heap[(at - 1) / 2];
    h->heap[at] = (strict_cluster){ (double)bound[0], e, link };
}

static strict_cluster strict_pop(strict_cut *h)
{
    const strict_cluster top = h->heap[0], last = h->heap[--h->n];
    uint32_t at = 0;
    for (uint32_t child; (child = 2 * at + 1) < h->n; at = child) {
        if (child + 1 < h->n && h->heap[child + 1].bound > h->heap[child].bound) child++;
        if (!(h->heap[child].bound > last.bound)) break;
        h->heap[at] = h->heap[child];
    }
    h->heap[at] = last;
    return top;
}

static uint32_t strict_size(strict_cut *h, const setup *s, const point *q, uint32_t slot,
                            const lc_cut_desc *d)
{
    h->s = s;
    h->q = q;
    h->slot = slot;
    h->n = h->n_done = 0;
    h->done = 0;
    for (int k = 0; k < LC_LIGHT_KINDS; k++)
        if (s->tree->n_of_kind[k]) strict_push(h, s->tree->root[k]);
    for (;;) {
        uint32_t n_dark = 0;
        h->total = h->done, h->sum2 = 0; /* anew each time: bounds differ by many orders of magnitude */
        for (uint32_t i = 0; i < h->n; i++) {
            h->total += h->heap[i].e;
            h->sum2 += h->heap[i].bound * h->heap[i].bound;
            n_dark += h->heap[i].e > 0 ? 0 : 1;
        }
        if (!h->n || (d->max_cut && h->n + h->n_done >= d->max_cut)) break;
        /* Each cluster's ratio is lower where many representatives are occluded; see cut_select.c. */
        const double ratio = (double)d->error_ratio * (d->z > 0 || n_dark <= 100 ? 1 : sqrt(100.0 / n_dark)),
                     of = fmax(h->total, (double)d->floor) * ratio,
                     left = d->z > 0 ? (double)d->z * sqrt(h->sum2) : h->heap[0].bound;
        if (left <= of) break;
        const lc_node *node = &s->tree->data.nodes[strict_pop(h).link];
        strict_push(h, node->left);
        strict_push(h, node->right);
    }
    return h->n + h->n_done;
}

/* The root of the sum of the squared bounds that is left, of a cut and of the strict one, over the total. */
static double left_of(double root, double total) { return total > 0 ? root / total : 0; }

/* Cuts are hardly larger than by the strict heap, from the roots and from another's cut; with max_cut they
 * leave hardly more. */
TEST(hardly_larger_than_by_a_strict_heap)
{
    static const lc_cut_desc descs[] = {
        { 0.05f, 0, 1e-3f, 0, 0, NULL, 0, false },
        { 0.02f, 0, 1e-3f, 0, 0, NULL, 0, false },
        { 0.02f, 0, 1e-3f, 0.1f, 0, NULL, 0, false },
        { 0.02f, 0, 1e-3f, 0.3f, 0, NULL, 0, false },
        { 0.05f, 0, 1e-3f, 0.3f, 0, NULL, 0, false },
        { 0.001f, 100, 1e-3f, 0, 0, NULL, 0, false },
        { 0.001f, 400, 1e-3f, 0, 0, NULL, 0, false },
        { 0.001f, 400, 1e-3f, 0.3f, 0, NULL, 0, false },
    };
    static strict_cut h;
    static lc_cut_start start;
    setup s;
    make(&s, 3000, 7, 12, false);
    build_tree(&s, 3, 4);
    for (size_t k = 0; k < sizeof descs / sizeof *descs; k++) {
        const lc_cut_desc *d = &descs[k];
        double size[3] = { 0 }, left[3] = { 0 }; /* strict, from the roots, from a cut near by */
        lc_cut c;
        lc_visibility visibility = s.visibility;
        visibility.occluders = NULL; /* no proofs */
        if (lc_cut_init(&c, ctx, s.tree, &visibility, d, true)) abort();
        rng_ctr = 1u << 23;
        for (int i = 0; i < 60; i++) {
            point q = rnd_point(), near = q;
            const uint64_t slot = (uint64_t)(i & 3);
            lc_cut_result r[2];
            near.p.pos[0] += 0.03f;
            near.org[0] += 0.03f;
            size[0] += strict_size(&h, &s, &q, (uint32_t)slot, d);
            left[0] += left_of(sqrt(h.sum2), h.total);
            for (int way = 0; way < 2; way++) {
                c.start = NULL;
                c.start_out = way ? &start : NULL;
                if (way) {
                    shade(&c, &near, slot + 1);
                    c.start = &start;
                    c.start_out = NULL;
                }
                r[way] = shade(&c, &q, slot);
                size[1 + way] += r[way].size;
                left[1 + way] += left_of(root_of(&c), lum_of(r[way].radiance));
            }
        }
        printf("  ratio %g, z %g, max_cut %u: %.1f clusters by a strict heap, from the roots %.3f, guided "
               "%.3f times; "
               "left %.3f, %.3f\n",
               (double)d->error_ratio, (double)d->z, d->max_cut, size[0] / 60, size[1] / size[0],
               size[2] / size[0], left[1] / left[0], left[2] / left[0]);
        CHECKF(size[1] <= 1.03 * size[0], "%g times as large", size[1] / size[0]);
        CHECKF(size[2] <= 1.03 * size[0], "%g times as large from another's cut", size[2] / size[0]);
        for (int way = 1; way < 3 && d->max_cut; way++)
            CHECKF(left[way] <= 1.03 * left[0], "%g times as much left, way %d", left[way] / left[0], way);
        lc_cut_free(&c);
    }
    unmake(&s);
}

/* More work never makes a cut worse: where the room is short, a smaller ratio and more room leave no larger
 * error, with nothing in the way and where much of the light is hidden, which is proved. */
TEST(more_work_is_never_worse)
{
    static const float ratios[] = { 0.3f, 0.1f, 0.05f, 0.02f, 0.01f, 0.001f };
    static const uint32_t rooms[] = { 60, 150, 400 };
    enum {
        N_RATIOS = sizeof ratios / sizeof *ratios,
        N_ROOMS = sizeof rooms / sizeof *rooms,
        N_POINTS = 300
    };
    for (uint32_t n_tris = 0; n_tris <= 20; n_tris += 20) {
        setup s;
        uint32_t n_short = 0;
        double worst[2] = { 0 }, rms[N_ROOMS][N_RATIOS] = { { 0 } };
        make(&s, 4000, 1, n_tris, false);
        build_tree(&s, 1, 1);
        for (size_t m = 0; m < N_ROOMS; m++)
            for (size_t k = 0; k < N_RATIOS; k++) {
                lc_cut c;
                open_cut(&c, &s, ratios[k], rooms[m], 0);
                rng_ctr = 1u << 22;
                for (int i = 0; i < N_POINTS; i++) {
                    point q = rnd_point();
                    lc_cut_result r = shade(&c, &q, 0);
                    const double want = lum_of(exact(&s, &q).radiance), off = lum_of(r.radiance) - want;
                    rms[m][k] += want > 0 ? off * off / (want * want) / N_POINTS : 0;
                    n_short += r.at_limit;
                }
                rms[m][k] = sqrt(rms[m][k]);
                if (k) worst[0] = fmax(worst[0], rms[m][k] / rms[m][k - 1]);
                if (m) worst[1] = fmax(worst[1], rms[m][k] / rms[m - 1][k]);
                lc_cut_free(&c);
            }
        printf("  %u triangles: at most %.3f times the error at a smaller ratio, %.3f with more room; 60: "
               "%.3f to "
               "%.3f, 400: %.3f to %.3f\n",
               n_tris, worst[0], worst[1], rms[0][0], rms[0][N_RATIOS - 1], rms[N_ROOMS - 1][0],
               rms[N_ROOMS - 1][N_RATIOS - 1]);
        CHECK(worst[0] <= 1.03 && worst[1] <= 1.03);
        CHECK(n_short > 200);
        unmake(&s);
    }
}

/* Where the room is known to be short, worst first from the roots on: the same cuts without those that are
 * given up for them, so with fewer bounds; where there was room after all, the limit is kept as well. */
TEST(worst_first_from_the_roots_on)
{
    uint32_t n_short = 0, n_roomy = 0;
    uint64_t n_bounds[2] = { 0 };
    setup s;
    make(&s, 4000, 1, 20, false);
    build_tree(&s, 1, 4);
    for (uint32_t room = 60; room <= 960; room *= 4) {
        lc_cut c[2];
        for (int k = 0; k < 2; k++) {
            const lc_cut_desc d = { .error_ratio = 0.1f, .max_cut = room, .worst_first = k > 0 };
            if (lc_cut_init(&c[k], ctx, s.tree, &s.visibility, &d, true)) abort();
        }
        rng_ctr = 1u << 24;
        for (int i = 0; i < 200; i++) {
            const point q = rnd_point();
            lc_cut_result r[2];
            for (int k = 0; k < 2; k++) {
                lc_stats stats = { 0 };
                lc_cut_shade(&c[k], &q.p, q.org, (uint64_t)i, &stats, &r[k]);
                n_bounds[k] += c[0].worst_first ? stats.bounds : 0;
                CHECK(!lc_cut_validate(&c[k]));
            }
            n_short += c[0].worst_first;
            n_roomy += !c[0].worst_first && r[1].size > 1;
            if (c[0].worst_first) {
                CHECK(!memcmp(&r[0].radiance, &r[1].radiance, sizeof r[0].radiance));
                CHECK(r[0].size == r[1].size && r[0].at_limit == r[1].at_limit);
            } else {
                CHECK(!r[1].at_limit && r[1].max_error <= 0.1f * (1 + 1e-5f));
            }
        }
        for (int k = 0; k < 2; k++) lc_cut_free(&c[k]);
    }
    printf("  %u short of room, %u not; bounds of the first %llu, %llu from the roots on\n", n_short, n_roomy,
           (unsigned long long)n_bounds[0], (unsigned long long)n_bounds[1]);
    CHECK(n_short > 100 && n_roomy > 50);
    CHECK(n_bounds[1] < n_bounds[0]);
    unmake(&s);
}

int main(void)
{
    ctx = watched_context(0);
    printf("seed %llu\n", (unsigned long long)rng_key);
    RUN(whole_cut_keeps_its_limit);
    RUN(hardly_larger_than_by_a_strict_heap);
    RUN(more_work_is_never_worse);
    RUN(worst_first_from_the_roots_on);
    return test_done();
}
