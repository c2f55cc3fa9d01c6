/* cut_scene.h - scenes, points and cuts of the tests of cuts. */
#ifndef TEST_CUT_SCENE_H
#define TEST_CUT_SCENE_H

#include "cut/cut.h"
#include "cut/exact.h"
#include "shade/point_init.h"
#include "support/one_bound.h"
#include "support/some_profiles.h"
#include "support/watched_memory.h"
#include "trace/bvh.h"

#define RND_KEY 5150
#include "support/rnd.h"

static lc_context *ctx;

/* ---- scenes ---- */

typedef struct {
    lc_bvh *bvh;
    lc_light_tree *tree;
    lc_light *lights;
    uint32_t n;
    lc_occluders *occluders;
    lc_visibility visibility;
    float pos[9 * 40];
    uint32_t index[3 * 40], n_tris;
} setup;

typedef struct {
    lc_point p;
    float org[3];
} point;

#define DIAG2 12.0

/* Builds what is traced of the setup's triangles, in place of what there is. */
static inline void build_triangles(setup *s)
{
    const lc_occluders_desc occluders = { s->pos, s->index, s->n_tris, NULL };
    lc_bvh_destroy(s->bvh);
    lc_occluders_destroy(s->occluders);
    if (lc_bvh_build(ctx, s->pos, s->index, s->n_tris, &s->bvh)) abort();
    if (lc_occluders_build(ctx, &occluders, &s->occluders)) abort();
    s->bvh->occluders = s->occluders;
    s->visibility = lc_bvh_visibility(s->bvh);
}

/* n lights of the kinds whose bits are set in `kinds`, and n_tris triangles, in the box -1..1. white: grey
 * intensities, for which estimates by representatives are unbiased in every channel. */
static inline void make(setup *s, uint32_t n, uint32_t kinds, uint32_t n_tris, bool white)
{
    *s = (setup){ .n = n, .n_tris = n_tris };
    s->lights = malloc((n + 1) * sizeof *s->lights);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t kind;
        do kind = rnd_n(kinds_in(kinds));
        while (!(kinds >> kind & 1));
        lc_light l = {
            .kind = (lc_light_kind)kind, .pos = rnd_in_box(1), .dir = rnd_unit(), .atten = { 0, 0, 1 }
        };
        float grey = (float)rnd_in(0.1, 1);
        l.intensity = white ? lc_f3_make(grey, grey, grey)
                            : lc_f3_make((float)rnd(), (float)rnd(), (float)rnd());
        if (kind == LC_LIGHT_SPOT) l.spot = (lc_spot){ (float)rnd_in(-0.5, 0.5), (float)rnd_in(0.5, 1), 0 };
        else if (kind == LC_LIGHT_LUMINAIRE) be_luminaire(&l, rnd_n(2 * N_PROFILES), rnd_in(-4, 4));
        else if (lc_is_sized(l.kind)) l.radius = (float)rnd_in(0.001, 0.1);
        else if (rnd() < 0.3)
            for (int k = 0; k < 3; k++) l.atten[k] = (float)rnd_in(0.1, 1);
        s->lights[i] = l;
    }
    for (uint32_t t = 0; t < n_tris; t++) {
        lc_f3 p = rnd_in_box(1);
        uint32_t *index = s->index + 3 * t;
        for (uint32_t v = 0; v < 3; v++) {
            index[v] = 3 * t + v;
            lc_f3_store(s->pos + 3 * (3 * t + v), lc_f3_add(p, lc_f3_scale(rnd_unit(), v ? 0.7f : 0)));
        }
        if (t % 4) { /* strips of four triangles */
            index[0] = index[-1];
            index[1] = index[-2];
        }
    }
    build_triangles(s);
}

static inline void build_tree(setup *s, uint64_t seed, uint32_t n_reps)
{
    lc_light_tree_desc d = { .lights = s->lights,
                             .n_lights = s->n,
                             .profiles = some_profiles(),
                             .diag2 = DIAG2,
                             .seed = seed,
                             .n_reps = n_reps,
                             .builder = LC_BUILDER_AUTO };
    lc_light_tree_destroy(s->tree);
    if (lc_light_tree_build(ctx, &d, &s->tree)) abort();
    CHECK(!lc_light_tree_validate(s->tree));
}

static inline void unmake(setup *s)
{
    lc_light_tree_destroy(s->tree);
    lc_bvh_destroy(s->bvh);
    lc_occluders_destroy(s->occluders);
    free(s->lights);
}

static inline point rnd_point(void)
{
    point q;
    lc_material m = { .kd = { (float)rnd(), (float)rnd(), (float)rnd() } };
    lc_f3 pos = rnd_in_box(1.2), n = rnd_unit(), view = rnd_unit();
    if (lc_f3_dot(n, view) < 0) n = lc_f3_neg(n);
    if (rnd() < 0.4) {
        m.ks = lc_f3_make((float)rnd(), (float)rnd(), (float)rnd());
        m.exponent = powf(10, (float)rnd_in(0, 3));
    }
    lc_point_init(&q.p, pos, n, view, &m, (float)(1e-10 * DIAG2));
    lc_f3_store(q.org, pos);
    return q;
}

static inline lc_cut_result shade(lc_cut *c, const point *q, uint64_t hash)
{
    lc_stats stats = { 0 };
    lc_cut_result r;
    lc_cut_shade(c, &q->p, q->org, hash, &stats, &r);
    CHECK(stats.points == 1 && stats.cut_sum == r.size && stats.shadow_rays == r.rays &&
          stats.at_limit == r.at_limit);
    return r;
}

static inline lc_cut_result exact(const setup *s, const point *q)
{
    lc_stats stats = { 0 };
    lc_cut_result r;
    lc_exact_shade(s->tree, &s->visibility, &q->p, q->org, &stats, &r);
    CHECK(r.size == s->n && r.rays <= s->n && stats.shadow_rays == r.rays);
    return r;
}

static inline void open_cut(lc_cut *c, const setup *s, float ratio, uint32_t max_cut, float floor_lum)
{
    lc_cut_desc d = { .error_ratio = ratio, .max_cut = max_cut, .floor = floor_lum };
    if (lc_cut_init(c, ctx, s->tree, &s->visibility, &d, true)) abort();
}

static inline double lum_of(lc_f3 c)
{
    return 0.2126 * (double)c.x + 0.7152 * (double)c.y + 0.0722 * (double)c.z;
}

/* Clusters of the cut that are no leaves and have a bound above 0. */
static inline uint32_t n_left(const lc_cut *c) { return c->kept.n; }

static inline bool is_hidden(const setup *s, const point *q, uint32_t light)
{
    const lc_light_kind kind = lc_kind_of_light(s->tree, light);
    float to[3];
    const float *const target[3] = { to, to + 1, to + 2 };
    uint8_t hidden[LC_LANES];
    lc_light_target(kind, &s->tree->data.lights[light], &q->p, to);
    s->bvh->kernels->hidden(&s->bvh->data, q->org, 1, target, lc_is_far(kind), hidden, NULL);
    return hidden[0];
}

#endif
