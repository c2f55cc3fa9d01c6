/* unit_host.c - lights, trees and cuts for a host with a ray tracer of its own: pictures are its own sums,
 * cuts add up to them, bits depend on neither batches nor threads, wrong arguments are named, and whatever
 * allocation fails, nothing is left. The tracer is a few spheres. */
#include "lightcuts.h"
#include "support/logged.h"
#include "support/scene_text.h"
#include "support/watched_memory.h"

#define RND_KEY 2323
#include "support/rnd.h"

#include <math.h>
#include <pthread.h>

#define N_POINTS 640u
#define N_LIGHTS 400u
#define PI       3.14159265358979323846

static lc_context *ctx;
static lc_tree_light lights[N_LIGHTS];
static lc_shade_point points[N_POINTS];
static lc_shade_material materials[2];
static const double balls[][4] = { { 0.3, 0.2, 0.1, 0.3 }, { -0.4, 0.3, -0.2, 0.25 }, { 0, 0.6, 0.5, 0.2 } };

/* ---- the host ---- */

static bool blocked(const double o[3], const double d[3], bool far)
{
    for (int i = 0; i < 3; i++) {
        double a = 0, b = 0, c = -balls[i][3] * balls[i][3];
        for (int k = 0; k < 3; k++) {
            const double x = o[k] - balls[i][k];
            a += d[k] * d[k], b += d[k] * x, c += x * x;
        }
        const double root = b * b - a * c, t = (-b - sqrt(fmax(root, 0))) / a;
        if (root > 0 && t > 1e-4 && (far || t < 1 - 1e-4)) return true;
    }
    return false;
}

typedef struct {
    uint64_t rays;
    int cancel_at, calls, glass;
} host;

static int visible(void *user, const lc_shadow_rays *r)
{
    host *h = user;
    h->rays += r->n;
    for (uint32_t i = 0; i < r->n; i++) {
        double o[3], d[3];
        for (int k = 0; k < 3; k++) {
            o[k] = (double)r->org[k][i];
            d[k] = (double)r->to[k][i] - (r->far[i] ? 0 : o[k]);
        }
        r->hidden[i] = blocked(o, d, r->far[i]);
        CHECK(r->point[i] < N_POINTS && r->light[i] < N_LIGHTS && !r->blocker);
        const uint32_t kind = lights[r->light[i]].kind;
        CHECK(r->far[i] == (kind == LC_TREE_DIRECTIONAL || kind == LC_TREE_SKY));
        for (int k = 0; k < 3 && h->glass; k++) r->through[k][i] = 0.5f + 0.25f * (float)(k - 1);
    }
    return ++h->calls == h->cancel_at;
}

/* M G of a light at a point, of a diffuse material of reflectance 1, by the formulas of lightcuts.h. */
static double diffuse_mg(const lc_shade_point *p, const lc_tree_light *l)
{
    double d[3], d2 = 0, cos_r = 0, cos_l = 0;
    for (int k = 0; k < 3; k++) {
        d[k] = l->kind == LC_TREE_DIRECTIONAL ? -(double)l->direction[k]
                                              : (double)l->position[k] - (double)p->position[k];
        d2 += d[k] * d[k];
        cos_r += d[k] * (double)p->normal[k];
        cos_l -= d[k] * (double)l->direction[k];
    }
    cos_r /= sqrt(d2);
    cos_l /= sqrt(d2);
    if (cos_r <= 0) return 0;
    const float *a = l->attenuation;
    double f = (double)a[0] + (double)a[1] * sqrt(d2) + (double)a[2] * d2, g = 1 / (f > 0 ? f : d2);
    if (l->kind == LC_TREE_DIRECTIONAL) g = 1;
    if (l->kind == LC_TREE_ORIENTED || l->kind == LC_TREE_VIRTUAL) g *= fmax(cos_l, 0);
    if (l->kind == LC_TREE_SPOT) {
        double t = (cos_l - (double)l->cos_total) / ((double)l->cos_start - (double)l->cos_total);
        t = fmin(fmax(t, 0), 1);
        g = t * t * (3 - 2 * t) / d2;
    }
    return cos_r * g / PI;
}

static void make(bool balls_too)
{
    rng_ctr = 0;
    memset(lights, 0, sizeof lights);
    memset(points, 0, sizeof points);
    memset(materials, 0, sizeof materials);
    for (uint32_t i = 0; i < N_LIGHTS; i++) {
        lc_tree_light *l = &lights[i];
        l->kind = i % (balls_too ? 7 : 5);
        lc_f3_store(l->position, rnd_in_box(1));
        lc_f3_store(l->direction, rnd_unit());
        for (int k = 0; k < 3; k++) l->intensity[k] = i % 7 == 3 ? 0 : (float)rnd();
        if (i % 3 == 0) l->attenuation[2] = 1, l->attenuation[0] = (float)rnd();
        l->cos_total = -0.2f;
        l->cos_start = 0.7f;
        l->radius = 0.01f;
    }
    for (uint32_t i = 0; i < N_POINTS; i++) {
        lc_shade_point *p = &points[i];
        const uint32_t at = i / 16 * 16;
        p->position[0] = (float)(at % 128) / 64 - 1 + (float)(i % 4) / 256;
        p->position[1] = -0.5f;
        p->position[2] = (float)(at / 128) / 3 - 1 + (float)(i / 4 % 4) / 256;
        p->normal[1] = p->view[1] = 1;
        p->offset = i % 2 ? 1e-4f : 0;
        p->material = i / 16 % 2;
    }
    for (int k = 0; k < 3; k++)
        materials[0].kd[k] = 0.5f, materials[1].kd[k] = 0.3f, materials[1].ks[k] = 0.2f;
    materials[1].gloss = LC_GLOSS_PHONG;
    materials[1].exponent = 12;
}

static lc_shade_batch batch_of(uint32_t first, uint32_t n)
{
    lc_shade_batch b = LC_SHADE_BATCH_INIT;
    b.first = first;
    b.points = points + first;
    b.n = n;
    b.materials = materials;
    b.n_materials = 2;
    return b;
}

static lc_tree *tree_of(void)
{
    lc_tree *t;
    if (lc_tree_create(ctx, lights, N_LIGHTS, NULL, &t)) abort();
    return t;
}

static lc_shader_desc desc_of(host *h, float ratio)
{
    lc_shader_desc d = LC_SHADER_DESC_INIT;
    d.visible = visible;
    d.visible_user = h;
    d.error_ratio = ratio;
    return d;
}

static lc_shade_stats shade_all(const lc_tree *t, const lc_shader_desc *d, uint32_t step, float (*rgb)[3])
{
    lc_shader *s;
    lc_shade_stats stats = LC_SHADE_STATS_INIT;
    if (lc_shader_create(t, d, &s)) abort();
    for (uint32_t at = 0; at < N_POINTS; at += step) {
        const lc_shade_batch b = batch_of(at, N_POINTS - at < step ? N_POINTS - at : step);
        CHECK(!lc_shade(s, &b, rgb + at, &stats));
    }
    lc_shader_destroy(s);
    return stats;
}

/* ---- tests ---- */

TEST(with_ratio_0_the_picture_is_the_hosts_own_sum)
{
    static float rgb[N_POINTS][3];
    host h = { 0 };
    lc_shader_desc d = desc_of(&h, 0);
    make(false);
    lc_tree *t = tree_of();
    const lc_shade_stats stats = shade_all(t, &d, N_POINTS, rgb);
    CHECK(stats.points == N_POINTS && stats.rays == h.rays && stats.calls == (uint64_t)h.calls);
    for (uint32_t i = 0; i < N_POINTS; i++) {
        double want[3] = { 0, 0, 0 };
        if (points[i].material) continue;
        for (uint32_t l = 0; l < N_LIGHTS; l++) {
            double o[3], way[3];
            const bool far = lights[l].kind == LC_TREE_DIRECTIONAL;
            const double mg = diffuse_mg(&points[i], &lights[l]) * 0.5;
            for (int k = 0; k < 3; k++) {
                o[k] = (double)(points[i].position[k] + points[i].offset * points[i].normal[k]);
                way[k] = far ? -(double)lights[l].direction[k] : (double)lights[l].position[k] - o[k];
            }
            if (!(mg > 0) || blocked(o, way, far)) continue;
            for (int k = 0; k < 3; k++) want[k] += mg * (double)lights[l].intensity[k];
        }
        /* directions are stored in 2 x 30 bits and products are floats: 1e-5 of the sum */
        for (int k = 0; k < 3; k++)
            CHECKF(fabs((double)rgb[i][k] - want[k]) <= 1e-5 * want[k], "point %u: %g of %g", i,
                   (double)rgb[i][k], want[k]);
    }
    lc_tree_destroy(t);
}

typedef struct {
    double sum[3], by_host[3], bounds2, worst;
    uint32_t n, times;
} seen;
static seen cuts[N_POINTS];

static void take_cut(void *user, uint32_t point, const lc_cut_entry *e, uint32_t n)
{
    seen *s = &cuts[point];
    const float *kd = materials[0].kd;
    (void)user;
    *s = (seen){ .n = n, .times = s->times + 1 };
    for (uint32_t i = 0; i < n; i++) {
        const double mg = diffuse_mg(&points[point], &lights[e[i].light]);
        s->bounds2 += (double)e[i].bound * (double)e[i].bound;
        s->worst = fmax(s->worst, (double)e[i].bound);
        CHECK(e[i].light < N_LIGHTS && e[i].light % 7 != 3);
        for (int k = 0; k < 3; k++) {
            s->sum[k] += (double)e[i].radiance[k];
            s->by_host[k] += e[i].visible ? mg * (double)kd[k] * (double)e[i].weight[k] : 0;
            CHECK(e[i].visible || !(e[i].radiance[k] > 0));
        }
    }
}

/* The cuts of all points, with an error ratio of 0.03, given as `d` says. */
static void check_cuts(lc_shader_desc d)
{
    static float rgb[N_POINTS][3];
    lc_tree *t = tree_of();
    d.cut = take_cut;
    memset(cuts, 0, sizeof cuts);
    const lc_shade_stats stats = shade_all(t, &d, N_POINTS, rgb);
    for (uint32_t i = 0; i < N_POINTS; i++) {
        const seen *s = &cuts[i];
        const double lum = 0.2126 * s->sum[0] + 0.7152 * s->sum[1] + 0.0722 * s->sum[2];
        CHECK(s->times == 1 && s->n <= N_LIGHTS);
        for (int k = 0; k < 3; k++) {
            CHECKF(fabs(s->sum[k] - (double)rgb[i][k]) <= 1e-6 * s->sum[k], "%g %g", s->sum[k],
                   (double)rgb[i][k]);
            /* 1e-5: as above */
            if (!points[i].material) CHECK(fabs(s->by_host[k] - s->sum[k]) <= 1e-5 * s->sum[k]);
        }
        /* 1e-5: the library sums the total in float */
        if (!stats.cut_at_limit)
            CHECK((d.z > 0 ? (double)d.z * sqrt(s->bounds2) : s->worst) <= 0.03 * (1 + 1e-5) * lum);
    }
    lc_tree_destroy(t);
}

TEST(a_cut_is_a_sum_that_a_host_can_make_itself)
{
    host h = { 0 }, glass = { .glass = 1 };
    make(false);
    check_cuts(desc_of(&h, 0.03f));
    lc_shader_desc d = desc_of(&h, 0.03f);
    d.z = 2;
    check_cuts(d);
    d.z = 0;
    d.apart = 1;
    check_cuts(d);
    d.max_cut = 24; /* begun again from the roots */
    check_cuts(d);
    d = desc_of(&glass, 0.03f);
    d.dims = 1;
    check_cuts(d);
}

TEST(bits_depend_on_neither_batches_nor_instruction_sets)
{
    static float rgb[4][N_POINTS][3];
    host h = { 0 };
    const lc_shader_desc d = desc_of(&h, 0.05f);
    make(true);
    lc_tree *t = tree_of();
    shade_all(t, &d, N_POINTS, rgb[0]);
    shade_all(t, &d, 16, rgb[1]);
    shade_all(t, &d, 336, rgb[2]);
    lc_tree_destroy(t);
    lc_context *const usual = ctx;
    ctx = quiet_context_of(1, LC_ISA_SCALAR);
    t = tree_of();
    shade_all(t, &d, N_POINTS, rgb[3]);
    lc_tree_destroy(t);
    lc_context_destroy(ctx);
    ctx = usual;
    for (int i = 1; i < 4; i++) CHECKF(!memcmp(rgb[0], rgb[i], sizeof rgb[0]), "%d", i);
}

typedef struct {
    const lc_tree *tree;
    float rgb[N_POINTS][3];
    bool done;
} job;

static void *run(void *user)
{
    job *j = user;
    host h = { 0 };
    const lc_shader_desc d = desc_of(&h, 0.05f);
    shade_all(j->tree, &d, N_POINTS, j->rgb);
    j->done = true;
    return NULL;
}

TEST(eight_threads_shade_with_one_tree)
{
    static job jobs[8];
    pthread_t thread[8];
    make(true);
    lc_tree *t = tree_of();
    for (int i = 0; i < 8; i++) {
        jobs[i].tree = t;
        if (pthread_create(&thread[i], NULL, run, &jobs[i])) abort();
    }
    for (int i = 0; i < 8; i++) pthread_join(thread[i], NULL);
    for (int i = 0; i < 8; i++) CHECK(jobs[i].done && !memcmp(jobs[0].rgb, jobs[i].rgb, sizeof jobs[0].rgb));
    lc_tree_destroy(t);
}

static int count_only(void *user, const lc_shadow_rays *r)
{
    *(uint64_t *)user += r->n;
    return 0;
}

TEST(ten_thousand_points_and_lights_are_asked_for_by_64_rays_and_more)
{
    enum { N = 10000 };
    static lc_tree_light many[N];
    static lc_shade_point here[N];
    static float rgb[N][3];
    uint64_t rays = 0;
    make(false);
    for (int i = 0; i < N; i++) {
        here[i] = points[0];
        here[i].position[0] = (float)(i % 100) / 50 - 1;
        here[i].position[2] = (float)i / (N / 2) - 1;
        lc_f3_store(many[i].position, lc_f3_add(rnd_in_box(1), lc_f3_make(0, 0.6f, 0)));
        for (int k = 0; k < 3; k++) many[i].intensity[k] = 1;
    }
    lc_tree *t = NULL;
    lc_shader *s = NULL;
    lc_shader_desc d = LC_SHADER_DESC_INIT;
    lc_shade_stats stats = LC_SHADE_STATS_INIT;
    lc_shade_batch b = batch_of(0, UNDER_TSAN ? 512 : N);
    b.points = here;
    d.visible = count_only;
    d.visible_user = &rays;
    CHECK(!lc_tree_create(ctx, many, N, NULL, &t) && !lc_shader_create(t, &d, &s));
    CHECK(!lc_shade(s, &b, rgb, &stats) && stats.rays == rays && rays > 0);
    CHECKF(stats.rays >= 64 * stats.calls, "%g rays a call", (double)rays / (double)stats.calls);
    lc_shader_destroy(s);
    lc_tree_destroy(t);
}

TEST(a_host_can_stop_and_empty_inputs_are_dark)
{
    float rgb[N_POINTS][3];
    host h = { .cancel_at = 3 };
    lc_shader_desc d = desc_of(&h, 0.05f);
    lc_shader *s;
    make(true);
    lc_tree *t = tree_of(), *none = NULL;
    const lc_shade_batch b = batch_of(0, N_POINTS), empty = LC_SHADE_BATCH_INIT;
    CHECK(!lc_shader_create(t, &d, &s) && lc_shade(s, &b, rgb, NULL) == LC_ERR_CANCELLED && h.calls == 3);
    CHECK(!lc_shade(s, &b, rgb, NULL) && h.calls > 4 && !lc_shade(s, &empty, NULL, NULL));
    lc_shader_destroy(s);
    CHECK(!lc_tree_create(ctx, NULL, 0, NULL, &none) && !lc_shader_create(none, &d, &s));
    CHECK(!lc_shade(s, &b, rgb, NULL) && !(rgb[7][0] > 0) && !(rgb[7][0] < 0));
    lc_shader_destroy(s);
    lc_tree_info info = LC_TREE_INFO_INIT;
    lc_tree_get_info(t, &info);
    CHECK(info.n_given == N_LIGHTS && info.n_lights == N_LIGHTS - 57 && info.n_of_kind[LC_TREE_BALL] > 50);
    lc_tree_destroy(none);
    lc_tree_destroy(t);
    lc_tree_destroy(NULL);
    lc_shader_destroy(NULL);
}

/* A slab over the floor, and a wall. */
static const char *const room =
    "WorldBegin\nMaterial \"diffuse\"\n"
    "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3 4 5 6 4 6 7] \"point3 P\" "
    "[-0.6 0 -0.6  0.6 0 -0.6  0.6 0 0.6  -0.6 0 0.6  0.8 -2 -2  0.8 2 -2  0.8 2 2  0.8 -2 2]\n";

typedef struct {
    lc_scene *scene;
    uint64_t rays, blockers;
    int spoil; /* blockers are overwritten */
} passing;

static int pass_on(void *user, const lc_shadow_rays *r)
{
    passing *p = user;
    const int stop = lc_scene_visible(p->scene, r);
    p->rays += r->n;
    for (uint32_t i = 0; i < r->n && r->blocker; i++) {
        p->blockers += r->hidden[i] && r->blocker[i] != UINT32_MAX;
        if (p->spoil) r->blocker[i] = 0xfffffff0u - i;
    }
    return stop;
}

TEST(a_loaded_scene_answers_rays_and_its_proofs_save_some)
{
    static float rgb[4][N_POINTS][3];
    passing p = { 0 };
    uint64_t rays[4];
    make(true);
    for (uint32_t i = 0; i < N_LIGHTS; i++) lights[i].position[1] = fabsf(lights[i].position[1]);
    p.scene = scene_from_text(ctx, NULL, "%s", room);
    lc_tree *t = tree_of();
    lc_shader_desc d = LC_SHADER_DESC_INIT;
    d.visible_user = &p;
    d.visible = pass_on;
    d.error_ratio = 0;
    for (int i = 0; i < 4; i++) { /* without proofs, with them, with those of a host that overwrites them */
        d.occluders = i == 1 || i == 2 ? p.scene : NULL;
        p.spoil = i == 2;
        if (i == 3) d.visible = lc_scene_visible, d.visible_user = p.scene;
        rays[i] = shade_all(t, &d, N_POINTS, rgb[i]).rays;
    }
    CHECK(p.blockers > 0 && p.rays == rays[0] + rays[1] + rays[2] && rays[0] == rays[3]);
    CHECKF(rays[1] < rays[0], "%g of %g rays", (double)rays[1], (double)rays[0]);
    for (uint32_t i = 0; i < N_POINTS; i++)
        for (int k = 0; k < 3; k++) /* a proof is of what every ray would have met: rounding of sums alone */
            CHECK(fabsf(rgb[0][i][k] - rgb[1][i][k]) <= 1e-5f * rgb[0][i][k] &&
                  fabsf(rgb[0][i][k] - rgb[2][i][k]) <= 1e-5f * rgb[0][i][k]);
    CHECK(!memcmp(rgb[0], rgb[3], sizeof rgb[0]));
    lc_tree_destroy(t);
    lc_scene_destroy(p.scene);
}

#define BAD_LIGHT(change, message)                                                                           \
    do {                                                                                                     \
        lc_tree *bad = (lc_tree *)(void *)&bad;                                                              \
        lc_tree_light l[2] = { lights[1], lights[3] };                                                       \
        log_clear();                                                                                         \
        l[1].change;                                                                                         \
        EXPECT_FAILURE(lc_tree_create(ctx, l, 2, NULL, &bad), LC_ERR_ARG, message);                          \
        CHECK(!bad);                                                                                         \
    } while (0)

TEST(wrong_lights_are_named)
{
    make(true);
    BAD_LIGHT(kind = 7, "error: lights[1].kind is 7: there are 7 kinds");
    BAD_LIGHT(position[1] = NAN, "lights[1]: error: light position is not finite or beyond 1e+12 units");
    BAD_LIGHT(intensity[0] = -1, "lights[1]: error: light intensity is negative, not finite or above 1e+15");
    BAD_LIGHT(direction[2] = 3, "lights[1]: error: light direction is zero or not finite");
    BAD_LIGHT(cos_total = 0.9f, "lights[1]: error: the spot light's angles are out of range");
    lc_tree *t;
    lc_tree_desc d = LC_TREE_DESC_INIT;
#define BAD_TREE(change, message)                                                                            \
    do {                                                                                                     \
        d = (lc_tree_desc)LC_TREE_DESC_INIT;                                                                 \
        log_clear();                                                                                         \
        d.change;                                                                                            \
        EXPECT_FAILURE(lc_tree_create(ctx, lights, 2, &d, &t), LC_ERR_ARG, message);                         \
    } while (0)
    BAD_TREE(size = 1, "error: desc: its size of 1 bytes is wrong"
             ", or a field that is set is not known: its INIT sets the size");
    BAD_TREE(n_reps = 33, "error: desc.n_reps is 33: 1 to 32, or 0");
    BAD_TREE(builder = (lc_builder)7, "error: desc.builder is none of lc_builder");
    BAD_TREE(diagonal = NAN, "error: desc.diagonal must be 0 to 1e+13");
    log_clear();
    EXPECT_FAILURE(lc_tree_create(ctx, NULL, 2, NULL, &t), LC_ERR_ARG, "error: lights is NULL");
    CHECK(lc_tree_create(NULL, lights, 2, NULL, &t) == LC_ERR_ARG && !t);
}

TEST(wrong_shaders_and_points_are_named)
{
    static float rgb[N_POINTS][3];
    host h = { 0 };
    make(true);
    lc_tree *t = tree_of();
    lc_shader *s;
    lc_shader_desc d;
#define BAD_SHADER(change, message)                                                                          \
    do {                                                                                                     \
        d = desc_of(&h, 0.1f);                                                                               \
        log_clear();                                                                                         \
        d.change;                                                                                            \
        EXPECT_FAILURE(lc_shader_create(t, &d, &s), LC_ERR_ARG, message);                                    \
        CHECK(!s);                                                                                           \
    } while (0)
    BAD_SHADER(size = 12, "error: desc: its size of 12 bytes is wrong"
               ", or a field that is set is not known: its INIT sets the size");
    BAD_SHADER(visible = NULL, "error: desc.visible is NULL");
    BAD_SHADER(error_ratio = -1, "error: desc.error_ratio must be finite and not negative");
    BAD_SHADER(z = NAN, "error: desc.z must be finite and not negative");
    BAD_SHADER(floor = INFINITY, "error: desc.floor must be finite and not negative");
    d = desc_of(&h, 0.1f);
    if (lc_shader_create(t, &d, &s)) abort();
    lc_shade_batch b;
#define BAD_BATCH(change, message)                                                                           \
    do {                                                                                                     \
        make(true);                                                                                          \
        b = batch_of(0, N_POINTS);                                                                           \
        log_clear();                                                                                         \
        change;                                                                                              \
        EXPECT_FAILURE(lc_shade(s, &b, rgb, NULL), LC_ERR_ARG, message);                                     \
    } while (0)
    BAD_BATCH(b.size = 0, "error: batch: its size of 0 bytes is wrong"
              ", or a field that is set is not known: its INIT sets the size");
    BAD_BATCH(b.first = 8, "error: batch.first is no multiple of 16");
    BAD_BATCH(b.points = NULL, "error: batch.points is NULL");
    BAD_BATCH(b.materials = NULL, "error: batch.materials is NULL");
    BAD_BATCH(points[9].position[0] = INFINITY, "error: batch.points[9].position is not finite or too far");
    BAD_BATCH(points[9].normal[0] = 1, "error: batch.points[9].normal is not of length 1");
    BAD_BATCH(points[9].geometric[0] = NAN, "error: batch.points[9].geometric is neither 0 nor of length 1");
    BAD_BATCH(points[9].view[1] = 0, "error: batch.points[9].view is not of length 1");
    BAD_BATCH(points[9].offset = NAN, "error: batch.points[9].offset is out of range");
    BAD_BATCH(points[9].reach = -1, "error: batch.points[9].reach is negative");
    BAD_BATCH(points[9].material = 2, "error: batch.points[9].material is beyond n_materials");
    BAD_BATCH(materials[1].gloss = 5, "error: batch.materials[1].gloss is none of LC_GLOSS_");
    BAD_BATCH(materials[1].kd[2] = NAN, "error: batch.materials[1] has a number out of range");
    BAD_BATCH(materials[1].gloss = LC_GLOSS_GGX, "error: batch.materials[1].roughness is out of range");
    BAD_BATCH((materials[1].gloss = LC_GLOSS_GGX, materials[1].fresnel = 4),
              "error: batch.materials[1].fresnel is none of LC_REFLECT_");
    CHECK(!h.calls);
    lc_shader_destroy(s);
    lc_tree_destroy(t);
}

TEST(whatever_allocation_fails_nothing_is_left)
{
    lc_context *const usual = ctx;
    host h = { 0 };
    lc_shader_desc d = desc_of(&h, 0.1f);
    bool made = false;
    make(true);
    ctx = watched_context(1);
    d.cut = take_cut;
    const long before = atomic_load(&blocks_live);
    for (long n = 0; !made && n < 2000; n++) {
        lc_tree *t;
        lc_shader *s = NULL;
        atomic_store(&allocations_left, n);
        lc_status st = lc_tree_create(ctx, lights, N_LIGHTS, NULL, &t);
        CHECK(!st == !!t && (!st || st == LC_ERR_MEMORY));
        if (!st) st = lc_shader_create(t, &d, &s);
        CHECK(!st == !!s && (!st || st == LC_ERR_MEMORY));
        atomic_store(&allocations_left, -1);
        made = !st;
        lc_shader_destroy(s);
        lc_tree_destroy(t);
        CHECK(atomic_load(&blocks_live) == before);
    }
    CHECK(made && !atomic_load(&guards_broken));
    lc_context_destroy(ctx);
    ctx = usual;
}

int main(void)
{
    ctx = quiet_context(1);
    RUN(with_ratio_0_the_picture_is_the_hosts_own_sum);
    RUN(a_cut_is_a_sum_that_a_host_can_make_itself);
    RUN(bits_depend_on_neither_batches_nor_instruction_sets);
    RUN(eight_threads_shade_with_one_tree);
    RUN(ten_thousand_points_and_lights_are_asked_for_by_64_rays_and_more);
    RUN(a_host_can_stop_and_empty_inputs_are_dark);
    RUN(a_loaded_scene_answers_rays_and_its_proofs_save_some);
    RUN(wrong_lights_are_named);
    RUN(wrong_shaders_and_points_are_named);
    RUN(whatever_allocation_fails_nothing_is_left);
    lc_context_destroy(ctx);
    return test_done();
}
