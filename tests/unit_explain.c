/* unit_explain.c - lc_explain against the picture and the light tree: the pixel has the picture's bits, the
 * clusters of the cut are a partition of the lights, estimates and exact values add up to the pixel, bounds
 * are not below them, and the splits lead from the roots to the cut. Runs from the root of the repository. */
#include "scene/scene.h"
#include "shade/point_init.h"
#include "support/near.h"
#include "support/pictures.h"
#include "support/watched_memory.h"
#include "tree/light_tree.h"

typedef struct {
    lc_context *ctx;
    lc_scene *scene;
    lc_render_desc desc;
    lc_image *image;
} setup;

static void load(setup *s, const char *path, uint32_t n_reps, lc_method method, uint32_t spp)
{
    lc_load_desc ld = LC_LOAD_DESC_INIT;
    ld.indirect_lights = LC_NO_LIGHTS;
    *s = (setup){ .ctx = watched_context(2), .desc = LC_RENDER_DESC_INIT };
    ld.area_lights = 256;
    ld.n_reps = n_reps;
    s->desc.method = method;
    s->desc.spp = spp;
    s->desc.aovs = LC_AOV_ALL;
    if (lc_scene_load(s->ctx, path, &ld, &s->scene)) abort();
}

static void unload(setup *s)
{
    lc_image_destroy(s->image);
    lc_scene_destroy(s->scene);
    lc_context_destroy(s->ctx);
    CHECKF(blocks_live == 0 && bytes_live == 0, "%zu bytes left", bytes_live);
    CHECKF(!guards_broken, "%d bytes written outside of blocks", guards_broken);
}

static float at(const setup *s, const char *channel, uint32_t x, uint32_t y)
{
    return (float)pixel_at(s->image, channel, x, y);
}

static bool same(float a, float b) { return !(a < b) && !(a > b); }

/* Two sums of the same terms in another order: 2e-6 is some 30 roundings of 2^-24; sums are about 1 here, so
 * that 1e-12 is the same as 0. */
static bool sums_agree(double a, double b) { return near_rel(a, b, 2e-6) || near_abs(a, b, 1e-12); }

/* ---- one explanation ---- */

/* Every light is below exactly one cluster of the cut, and clusters have as many lights as they say. */
static void check_partition(const setup *s, const lc_explanation *x)
{
    const lc_light_tree *t = s->scene->tree;
    uint8_t *seen = calloc(t->n_lights + 1u, 1);
    uint32_t *stack = malloc((t->n_nodes + 2u) * sizeof *stack), total = 0;
    for (uint32_t i = 0; i < x->n_clusters; i++) {
        uint32_t n = 0, id = x->clusters[i].id, lights = 0;
        stack[n++] = id < t->n_nodes ? id : LC_LEAF | (id - t->n_nodes);
        while (n) {
            uint32_t link = stack[--n];
            if (link & LC_LEAF) {
                CHECK(!seen[link & ~LC_LEAF]++);
                lights++;
            } else {
                stack[n++] = t->data.nodes[link].left;
                stack[n++] = t->data.nodes[link].right;
            }
        }
        CHECKF(lights == x->clusters[i].n_lights, "%u lights, not %u", lights, x->clusters[i].n_lights);
        total += lights;
    }
    CHECKF(total == t->n_lights, "%u lights of %u", total, t->n_lights);
    free(stack);
    free(seen);
}

static double lum(const double c[3]) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

static void check_cluster(const setup *s, const lc_explanation *x, const lc_explained_cluster *c)
{
    double estimate[3] = { (double)c->estimate[0], (double)c->estimate[1], (double)c->estimate[2] };
    CHECK(c->n_lights > 0 && c->n_seen <= c->n_lights && c->seen >= -1 && c->seen <= 1);
    if (c->n_lights > 1) {
        CHECKF((double)c->bound * (1 + 2e-6) >= lum(c->exact), "bound %g, exact %g", (double)c->bound,
               lum(c->exact));
        CHECKF((double)c->bound * (1 + 2e-6) >= lum(estimate), "bound %g, estimate %g", (double)c->bound,
               lum(estimate));
    } else {
        for (int k = 0; k < 3; k++) CHECK(sums_agree(estimate[k], c->exact[k]));
    }
    CHECK(c->light < s->scene->n_lights);
    if (c->light >= s->scene->n_lights) return;
    const lc_light *l = &s->scene->lights[c->light];
    lc_light_rec rec;
    lc_light_rec_init(&rec, l);
    CHECK((uint32_t)l->kind == c->kind && !memcmp(rec.pos, c->light_pos, sizeof rec.pos));
    CHECK(!memcmp(rec.intensity, c->light_intensity, sizeof rec.intensity));
    for (int k = 0; k < 3; k++)
        CHECK(rec.pos[k] >= c->lo[k] - 1e-5f * fabsf(c->lo[k]) &&
              rec.pos[k] <= c->hi[k] + 1e-5f * fabsf(c->hi[k]));
    CHECK((c->parent == LC_NO_CLUSTER) == (c->made == 0) && c->made <= x->n_rounds);
}

/* The exact value is within what is proved of it. */
static void check_interval(const lc_explanation *x)
{
    const double exact[3] = { (double)x->exact[0], (double)x->exact[1], (double)x->exact[2] };
    CHECKF(x->lower <= lum(exact) && lum(exact) <= x->upper, "%g .. %g, exact %g", x->lower, x->upper,
           lum(exact));
    CHECK(x->lower <= x->estimate && x->estimate <= x->upper && x->half_width >= 0);
}

/* The clusters that were split, in order: each had a bound above the limit of its round, its parent was split
 * before, and it has two children with its lights. */
static void check_splits(const lc_explanation *x)
{
    const lc_explained_cluster *c = x->clusters, *split = c + x->n_clusters;
    uint32_t n = 0, n_roots = 0;
    for (uint32_t i = 0; i < x->n_rounds; i++)
        for (uint32_t k = 0; k < x->rounds[i].n_split && n < x->n_splits; k++, n++) {
            CHECK(split[n].split == i + 1 && split[n].made <= i);
            if (i < x->n_start_rounds) continue; /* the limits were those of another point */
            CHECKF((double)split[n].bound > x->rounds[i].limit, "bound %g, limit %g", (double)split[n].bound,
                   x->rounds[i].limit);
        }
    CHECK(n == x->n_splits);
    for (uint32_t i = 0; i < x->n_clusters + x->n_splits; i++) n_roots += c[i].made == 0;
    CHECKF(x->n_clusters == x->n_splits + n_roots, "%u clusters, %u splits, %u roots", x->n_clusters,
           x->n_splits, n_roots);
    for (uint32_t i = 0; i < x->n_splits; i++) {
        uint32_t children = 0, lights = 0;
        for (uint32_t k = 0; k < x->n_clusters + x->n_splits; k++)
            if (c[k].parent == split[i].id) {
                CHECK(c[k].made == split[i].split);
                children++;
                lights += c[k].n_lights;
            }
        CHECK(children == 2 && lights == split[i].n_lights);
    }
}

static void check_sums(const setup *s, const lc_explanation *x)
{
    double estimate[3] = { 0 }, exact[3] = { 0 };
    uint32_t rays = 0;
    for (uint32_t i = 0; i < x->n_clusters; i++) {
        const lc_explained_cluster *c = &x->clusters[i];
        for (int k = 0; k < 3; k++) {
            estimate[k] += (double)c->estimate[k];
            exact[k] += c->exact[k];
        }
        CHECK(c->split == 0 && (!i || !x->at_limit || c->n_lights));
        rays += c->seen >= 0;
        if (c->hidden) CHECK(c->n_seen == 0 && c->n_lights > 1 && !(c->estimate[1] > 0));
        else if (c->n_lights > 1 && !x->at_limit) CHECK((double)c->bound <= x->limit * (1 + 1e-5));
    }
    for (int k = 0; k < 3; k++) {
        CHECKF(sums_agree(estimate[k], (double)x->radiance[k]), "estimates sum to %g, radiance %g",
               estimate[k], (double)x->radiance[k]);
        CHECKF(sums_agree(exact[k], (double)x->exact[k]), "sums of lights %g, exact %g", exact[k],
               (double)x->exact[k]);
    }
    CHECKF(x->rays <= rays + x->n_splits && x->rays <= s->scene->tree->n_lights, "%u rays", x->rays);
}

static void check_all(const setup *s, const lc_explanation *x)
{
    check_partition(s, x);
    for (uint32_t i = 0; i < x->n_clusters + x->n_splits; i++) check_cluster(s, x, &x->clusters[i]);
    check_splits(x);
    check_interval(x);
    check_sums(s, x);
}

/* ---- against the picture ---- */

static void check_pixel(const setup *s, const lc_explanation *x, uint32_t px, uint32_t py)
{
    static const char *const rgb[] = { "R", "G", "B" }, *const p[] = { "P.X", "P.Y", "P.Z" },
                             *const n[] = { "N.X", "N.Y", "N.Z" };
    CHECK(x->hit == (at(s, "cut.size", px, py) > 0 || at(s, "Z", px, py) > 0));
    for (int k = 0; k < 3; k++) {
        float want = at(s, rgb[k], px, py);
        CHECKF(same(x->pixel[k], want), "pixel %u,%u: %.9g, picture %.9g", px, py, (double)x->pixel[k],
               (double)want);
        if (x->hit)
            CHECK(same(x->position[k], at(s, p[k], px, py)) && same(x->normal[k], at(s, n[k], px, py)));
    }
    if (!x->hit) return;
    if (x->all_lights) {
        CHECK(same(at(s, "cut.size", px, py), (float)s->scene->tree->n_lights));
        return;
    }
    uint32_t n_counted = 0;
    for (uint32_t i = 0; i < x->n_clusters; i++)
        n_counted += !x->clusters[i].hidden && (x->clusters[i].n_lights == 1 || x->clusters[i].bound > 0);
    /* Clusters of bound 0 do not count, but at most max_cut of them. */
    uint32_t limit = s->desc.max_cut;
    CHECK(n_counted == x->cut_size || (limit && x->n_clusters - n_counted > limit));
    CHECK(same(at(s, "cut.size", px, py), (float)x->cut_size) &&
          same(at(s, "cut.rays", px, py), (float)x->rays));
    CHECK(same(at(s, "cut.error", px, py), x->max_error));
}

static void explain_grid(const char *path, uint32_t n_reps, lc_method method, uint32_t max_cut)
{
    setup s;
    uint32_t hits = 0, all = 0, clusters = 0;
    load(&s, path, n_reps, method, 1);
    s.desc.max_cut = max_cut;
    if (lc_render(s.ctx, s.scene, &s.desc, &s.image, NULL)) abort();
    for (uint32_t y = 1; y < s.scene->film.height; y += s.scene->film.height / 6)
        for (uint32_t x = 0; x < s.scene->film.width; x += s.scene->film.width / 7) {
            lc_explanation *e;
            CHECK(!lc_explain(s.ctx, s.scene, &s.desc, x, y, 0, &e));
            if (!e) continue;
            check_pixel(&s, e, x, y);
            if (e->hit) check_all(&s, e);
            hits += e->hit != 0;
            all += e->all_lights != 0;
            clusters += e->n_clusters;
            lc_explanation_destroy(e);
        }
    printf("  %s, %u slots, %s, at most %u: %u points, %u clusters%s\n", path, n_reps,
           method == LC_METHOD_EXACT  ? "exact"
           : method == LC_METHOD_CUTS ? "cuts"
                                      : "lightcuts",
           max_cut, hits, clusters, all ? ", all lights in the picture" : "");
    CHECK(hits > 5 && clusters > hits);
    unload(&s);
}

TEST(a_pixel_is_the_pictures)
{
    explain_grid("tests/golden/cloud.pbrt", 1, LC_METHOD_LIGHTCUTS, 1000);
    explain_grid("tests/golden/cloud.pbrt", 16, LC_METHOD_CUTS, 40);
    explain_grid("tests/golden/box.pbrt", 5, LC_METHOD_CUTS, 0);
    explain_grid("tests/golden/mixed.pbrt", 32, LC_METHOD_CUTS, 1000);
    explain_grid("tests/golden/textured.pbrt", 1, LC_METHOD_LIGHTCUTS, 1000);
}

TEST(an_exact_picture_is_explained_by_cuts)
{
    explain_grid("tests/golden/mixed.pbrt", 1, LC_METHOD_EXACT, 1000);
    explain_grid("tests/golden/box.pbrt", 1, LC_METHOD_LIGHTCUTS, 1000);
}

TEST(samples_add_up)
{
    setup s;
    load(&s, "tests/golden/cloud.pbrt", 8, LC_METHOD_CUTS, 3);
    if (lc_render(s.ctx, s.scene, &s.desc, &s.image, NULL)) abort();
    for (uint32_t x = 0; x < s.scene->film.width; x += 5) {
        uint32_t y = s.scene->film.height / 2;
        double sum = 0;
        for (uint32_t i = 0; i < 3; i++) {
            lc_explanation *e;
            CHECK(!lc_explain(s.ctx, s.scene, &s.desc, x, y, i, &e));
            if (e) sum += (double)e->pixel[1];
            lc_explanation_destroy(e);
        }
        CHECKF(sums_agree(sum / 3, (double)at(&s, "G", x, y)), "mean %g, picture %g", sum / 3,
               (double)at(&s, "G", x, y));
    }
    unload(&s);
}

TEST(wrong_arguments_are_refused)
{
    setup s;
    lc_explanation *e = (lc_explanation *)&s;
    load(&s, "tests/golden/cloud.pbrt", 1, LC_METHOD_CUTS, 2);
    CHECK(lc_explain(s.ctx, s.scene, &s.desc, s.scene->film.width, 0, 0, &e) == LC_ERR_ARG && !e);
    CHECK(lc_explain(s.ctx, s.scene, &s.desc, 0, s.scene->film.height, 0, &e) == LC_ERR_ARG && !e);
    CHECK(lc_explain(s.ctx, s.scene, &s.desc, 0, 0, 2, &e) == LC_ERR_ARG && !e);
    CHECK(lc_explain(NULL, s.scene, &s.desc, 0, 0, 0, &e) == LC_ERR_ARG);
    CHECK(lc_explain(s.ctx, NULL, &s.desc, 0, 0, 0, &e) == LC_ERR_ARG);
    CHECK(lc_explain(s.ctx, s.scene, NULL, 0, 0, 0, &e) == LC_ERR_ARG);
    CHECK(lc_explain(s.ctx, s.scene, &s.desc, 0, 0, 0, NULL) == LC_ERR_ARG);
    s.desc.error_ratio = NAN;
    CHECK(lc_explain(s.ctx, s.scene, &s.desc, 0, 0, 0, &e) == LC_ERR_ARG && !e);
    lc_explanation_destroy(NULL);
    unload(&s);
}

TEST(every_allocation_may_fail)
{
    setup s;
    lc_explanation *e = NULL;
    load(&s, "tests/golden/mixed.pbrt", 2, LC_METHOD_CUTS, 1);
    long before = blocks_live, tried = 0;
    for (; !e && tried < 200; tried++) {
        allocations_left = tried;
        lc_status st = lc_explain(s.ctx, s.scene, &s.desc, s.scene->film.width / 2, s.scene->film.height / 2,
                                  0, &e);
        CHECK(st == (e ? LC_OK : LC_ERR_MEMORY));
        if (!e) CHECKF(blocks_live == before, "%ld blocks lost", blocks_live - before);
    }
    allocations_left = -1;
    printf("  %ld allocations\n", tried - 1);
    CHECK(e && tried > 8);
    lc_explanation_destroy(e);
    CHECK(blocks_live == before);
    unload(&s);
}

int main(void)
{
    RUN(a_pixel_is_the_pictures);
    RUN(an_exact_picture_is_explained_by_cuts);
    RUN(samples_add_up);
    RUN(wrong_arguments_are_refused);
    RUN(every_allocation_may_fail);
    return test_done();
}
