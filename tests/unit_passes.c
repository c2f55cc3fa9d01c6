/* unit_passes.c - passes, whose mean is the picture; coarse pictures, which are interpolated between shaded
 * pixels and differ little from those that are not. */
#include "support/pictures.h"
#include "support/scene_text.h"
#include "support/test.h"
#include "support/watched_memory.h"

#include <math.h>

#define SIDE 50 /* pixels: no multiple of a block */

static lc_context *ctx;
static const char *const names[3] = { "R", "G", "B" };

/* What text is between the camera and the world. */
#define VIEW                                                                                                 \
    "Film \"rgb\" \"integer xresolution\" 50 \"integer yresolution\" 50\nIntegrator \"directlighting\"\n"    \
    "LookAt 0 0 -5  0 0 0  0 1 0\n"
#define PINHOLE "Camera \"perspective\" \"float fov\" 40\n"
#define WALL                                                                                                 \
    "Shape \"trianglemesh\" \"point3 P\" [-9 -9 0 9 -9 0 9 9 0 -9 9 0] \"integer indices\" [0 1 2 0 2 3]\n"  \
    " \"point2 uv\" [0 0 1 0 1 1 0 1]\n"
/* A box with a ball under a grid of lamps. */
#define LAMPS                                                                                                \
    "Material \"diffuse\" \"rgb reflectance\" [.7 .5 .3]\n" WALL                                             \
    "AttributeBegin Rotate 60 1 0 0 Translate 0 0 1 " WALL "AttributeEnd\n"                                  \
    "AttributeBegin Translate 0.3 0 -1 Shape \"sphere\" \"float radius\" 0.8 AttributeEnd\n"

static lc_scene *lamps(const char *view)
{
    char text[16384] = "";
    size_t at = 0;
    for (int i = 0; i < 49; i++)
        at += (size_t)snprintf(text + at, sizeof text - at,
                               "LightSource \"point\" \"point3 from\" [%d %d %g] \"rgb I\" [%d 3 2]\n",
                               i % 7 - 3, i / 7 - 3, -2 - 0.1 * (i % 5), 1 + i % 3);
    return scene_from_text(ctx, NULL, VIEW "%sWorldBegin\n%s" LAMPS, view, text);
}

static lc_image *render_in(lc_context *c, const lc_scene *scene, const lc_render_desc *d)
{
    lc_image *image = NULL;
    log_clear();
    CHECKF(!lc_render(c, scene, d, &image, NULL), "%s", last_error);
    return image;
}

static lc_image *render(const lc_scene *scene, const lc_render_desc *d) { return render_in(ctx, scene, d); }

/* The largest difference of two pictures, relative to the second and its mean. */
static double difference(const lc_image *a, const lc_image *b)
{
    double worst = 0;
    for (int c = 0; c < 3 && a && b; c++) {
        const float *x = lc_image_channel(a, names[c]), *y = lc_image_channel(b, names[c]);
        double mean = 0;
        for (int i = 0; i < SIDE * SIDE; i++) mean += (double)y[i] / (SIDE * SIDE);
        CHECK(mean > 0);
        for (int i = 0; i < SIDE * SIDE; i++) {
            const double base = (double)y[i] > mean ? (double)y[i] : mean,
                         off = fabs((double)x[i] - (double)y[i]) / base;
            if (!(off <= worst)) worst = off;
        }
    }
    return a && b ? worst : INFINITY;
}

/* ---- passes ---- */

/* The first pass, as the mean of all. */
static lc_image *mean_of_passes(const lc_scene *scene, lc_render_desc d, uint32_t n)
{
    static double sum[3][SIDE * SIDE];
    lc_image *first = NULL;
    memset(sum, 0, sizeof sum);
    d.n_passes = n;
    for (d.pass = 0; d.pass < n; d.pass++) {
        lc_image *pass = render(scene, &d);
        CHECK(fabs(lc_image_get_number(pass, "samplesPerPixel", 0) - 1) <= 0);
        for (int c = 0; c < 3; c++)
            for (int i = 0; i < SIDE * SIDE; i++)
                sum[c][i] += (double)lc_image_channel(pass, names[c])[i] / n;
        if (d.pass) lc_image_destroy(pass);
        else first = pass;
    }
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < SIDE * SIDE; i++) lc_image_channel(first, names[c])[i] = (float)sum[c][i];
    return first;
}

static void check_mean(const char *view, lc_render_desc d, uint32_t n)
{
    lc_scene *scene = lamps(view);
    lc_image *mean = mean_of_passes(scene, d, n);
    d.spp = n;
    lc_image *whole = render(scene, &d);
    const double off = difference(mean, whole);
    CHECKF(off < 2e-6, "%s: %g", view, off);
    d.spp = 1;
    lc_image *one = render(scene, &d);
    CHECK(difference(one, whole) > 0.01);
    lc_image_destroy(mean);
    lc_image_destroy(whole);
    lc_image_destroy(one);
    lc_scene_destroy(scene);
}

TEST(the_mean_of_all_passes_is_the_picture)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    d.method = LC_METHOD_EXACT;
    check_mean(PINHOLE, d, 16);
    check_mean("Camera \"perspective\" \"float fov\" 40 \"float lensradius\" 0.2 \"float focaldistance\" 3\n",
               d, 6);
    d.method = LC_METHOD_CUTS;
    d.error_ratio = 0;
    d.max_cut = 0;
    check_mean(PINHOLE, d, 4);
}

TEST(so_it_is_where_pixels_share_samples)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    d.method = LC_METHOD_EXACT;
    check_mean(PINHOLE "PixelFilter \"mitchell\"\n", d, 8);
}

TEST(cuts_of_passes_choose_other_lights)
{
    lc_scene *scene = lamps(PINHOLE);
    lc_render_desc d = LC_RENDER_DESC_INIT;
    d.method = LC_METHOD_EXACT;
    d.spp = 16;
    lc_image *whole = render(scene, &d);
    d.method = LC_METHOD_CUTS;
    d.error_ratio = 0.5f;
    lc_image *mean = mean_of_passes(scene, d, 16);
    d.spp = 0;
    d.n_passes = 16;
    lc_image *pass = render(scene, &d);
    const double one = difference(pass, whole), all = difference(mean, whole);
    CHECKF(all < one / 2, "%g of a pass, %g of all", one, all);
    lc_image_destroy(whole);
    lc_image_destroy(mean);
    lc_image_destroy(pass);
    lc_scene_destroy(scene);
}

/* ---- coarse pictures ---- */

/* How far a coarse picture is from the one in which all pixels are shaded; *points: of those shaded in it, as
 * a share. */
static double error_of(const lc_scene *scene, uint32_t coarse, double *points)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_render_stats stats = LC_RENDER_STATS_INIT;
    lc_image *image = NULL;
    d.method = LC_METHOD_EXACT;
    d.spp = 1;
    lc_image *all = render(scene, &d);
    d.coarse = coarse;
    CHECK(!lc_render(ctx, scene, &d, &image, &stats));
    *points = (double)stats.points / (SIDE * SIDE);
    const double off = difference(image, all);
    lc_image_destroy(image);
    lc_image_destroy(all);
    return off;
}

/* Shares of pixels that are shaded, of each, with one more row and column around. */
static const double fewest[3] = { 0.3, 0.09, 0.03 };

TEST(an_evenly_lit_plane_is_exact_with_its_texture)
{
    lc_scene *scene = scene_from_text(
        ctx, NULL,
        VIEW PINHOLE "WorldBegin LightSource \"distant\" \"point3 from\" [1 2 -3] \"rgb L\" [3 2 1]\n"
        "Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" 60 \"float vscale\" 37\n"
        " \"rgb tex1\" [.9 .2 .4] \"rgb tex2\" [.1 .6 .3]\n"
        "Material \"diffuse\" \"texture reflectance\" \"t\"\n" WALL);
    double points;
    for (uint32_t i = 0, coarse = 2; coarse <= 8; coarse *= 2, i++) {
        const double off = error_of(scene, coarse, &points);
        CHECKF(off < 1e-5, "blocks of %u: %g", coarse, off);
        CHECKF(points < fewest[i], "blocks of %u: %g of all pixels shaded", coarse, points);
    }
    lc_scene_destroy(scene);
}

/* A card before a wall, the lamp where the camera is, so that no shadow is seen: the card is many times as
 * bright. What is off is by smoothing light that falls off fast, at the edges from one side. */
TEST(light_does_not_bleed_over_the_edge_of_what_is_nearer)
{
    lc_scene *scene = scene_from_text(
        ctx, NULL,
        VIEW PINHOLE "WorldBegin LightSource \"point\" \"point3 from\" [0 0 -5] \"rgb I\" [9 9 9]\n"
        "Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5] Translate 0 0 3\n" WALL
        "AttributeBegin Translate 0.1 0.2 -4 Rotate 20 0 0 1 Scale 0.06 0.05 1 " WALL "AttributeEnd\n");
    double points;
    for (uint32_t coarse = 2; coarse <= 8; coarse *= 2) {
        const double off = error_of(scene, coarse, &points);
        CHECKF(off < 0.1, "blocks of %u: %g", coarse, off);
        CHECKF(points < 0.5, "blocks of %u: %g of all pixels shaded", coarse, points);
    }
    lc_scene_destroy(scene);
}

/* Two walls that meet: the light on them differs, and so do their normals. */
TEST(light_does_not_bleed_around_a_corner)
{
    lc_scene *scene = scene_from_text(
        ctx, NULL,
        VIEW PINHOLE "WorldBegin LightSource \"distant\" \"point3 from\" [1 0 -0.2] \"rgb L\" [3 2 1]\n"
        "Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n"
        "Shape \"trianglemesh\" \"point3 P\" [0 -9 2 0 9 2 -9 -9 -3 -9 9 -3 9 -9 -3 9 9 -3]\n"
        " \"integer indices\" [0 1 2 1 3 2 0 1 4 1 5 4]\n");
    double points;
    const double off = error_of(scene, 4, &points);
    CHECKF(off < 1e-5, "%g", off);
    CHECKF(points < 0.3, "%g of all pixels shaded", points);
    lc_scene_destroy(scene);
}

TEST(emission_and_what_is_behind_all_are_exact)
{
    lc_scene *scene = scene_from_text(
        ctx, NULL,
        VIEW PINHOLE "WorldBegin LightSource \"infinite\" \"rgb L\" [.2 .3 .4]\n"
        "AreaLightSource \"diffuse\" \"rgb L\" [5 4 3] \"bool twosided\" true\n"
        "Material \"diffuse\" \"rgb reflectance\" [0 0 0]\n"
        "Rotate 20 0 0 1 Scale 0.09 0.08 1\n" WALL);
    double points;
    CHECK(error_of(scene, 4, &points) < 1e-6);
    lc_scene_destroy(scene);
}

static bool same_crop(const lc_image *whole, const lc_image *part)
{
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    bool same = !lc_image_get_desc(part, &d);
    for (int c = 0; c < 3; c++)
        for (uint32_t y = 0; y < d.height && same; y++)
            same = !memcmp(lc_image_channel(part, names[c]) + (size_t)y * d.width,
                           lc_image_channel(whole, names[c]) + ((size_t)d.y0 + y) * SIDE + d.x0,
                           d.width * sizeof(float));
    return same;
}

/* Also as passes. */
static void check_bytes(const lc_scene *scene, lc_render_desc d)
{
    static const int32_t crops[][4] = {
        { 7, 31, 13, 14 }, { 0, 5, 44, 50 }, { 16, 48, 16, 32 }, { 49, 50, 0, 50 }
    };
    lc_image *image = render(scene, &d);
    for (size_t i = 0; i < sizeof crops / sizeof *crops; i++) {
        memcpy(d.crop, crops[i], sizeof d.crop);
        lc_image *part = render(scene, &d);
        CHECKF(same_crop(image, part), "blocks of %u, pass %u, crop %zu", d.coarse, d.pass, i);
        lc_image_destroy(part);
    }
    memset(d.crop, 0, sizeof d.crop);
    for (uint32_t threads = 1; threads <= 7; threads += 3) {
        lc_context *other = quiet_context_of(threads, threads > 1 ? LC_ISA_SCALAR : LC_ISA_BEST);
        lc_scene *again = scene_from_file(other, NULL, scene_path());
        lc_image *by = render_in(other, again, &d);
        CHECKF(same_planes(image, by), "blocks of %u, pass %u: %u threads", d.coarse, d.pass, threads);
        lc_image_destroy(by);
        lc_scene_destroy(again);
        lc_context_destroy(other);
    }
    lc_image_destroy(image);
}

TEST(bytes_do_not_depend_on_threads_instruction_sets_and_crops)
{
    lc_scene *scene = lamps(PINHOLE);
    lc_render_desc d = LC_RENDER_DESC_INIT;
    d.method = LC_METHOD_CUTS;
    d.error_ratio = 0.4f;
    for (d.coarse = 1; d.coarse <= 8; d.coarse *= 2) {
        d.pass = d.n_passes = 0;
        if (d.coarse > 1) check_bytes(scene, d);
        d.pass = 5;
        d.n_passes = 16;
        check_bytes(scene, d);
    }
    lc_scene_destroy(scene);
}

/* ---- what is refused ---- */

static int no_tile(void *user, lc_tile *tile)
{
    (void)user;
    (void)tile;
    return 0;
}

static void check_refused(const lc_scene *scene, const lc_render_desc *d, const char *what)
{
    lc_image *image = NULL;
    log_clear();
    CHECKF(lc_render(ctx, scene, d, &image, NULL) == LC_ERR_ARG && !image, "%s", what);
    CHECKF(strstr(last_error, what), "%s: %s", what, last_error);
}

TEST(what_makes_no_sense_is_refused)
{
    lc_scene *scene = lamps(PINHOLE);
    const lc_render_desc usual = LC_RENDER_DESC_INIT;
    lc_render_desc d = usual;
    lc_explanation *x = NULL;
    d.pass = 1;
    check_refused(scene, &d, "pass 1 of 0");
    d.pass = d.n_passes = 4;
    check_refused(scene, &d, "pass 4 of 4");
    d.pass = 0;
    d.error = 0.02f;
    check_refused(scene, &d, "no error of pixels");
    d.error = 0;
    CHECK(lc_explain(ctx, scene, &d, 1, 1, 0, &x) == LC_ERR_ARG && !x);
    d = usual;
    for (d.coarse = 3; d.coarse < 17; d.coarse += d.coarse + 1) check_refused(scene, &d, "power of two");
    d.coarse = 16;
    check_refused(scene, &d, "power of two");
    d.coarse = 4;
    d.error = 0.02f;
    check_refused(scene, &d, "no error of pixels");
    d.error = 0;
    d.aovs = LC_AOV_INTERVAL;
    check_refused(scene, &d, "no intervals");
    d.aovs = 0;
    d.tile_load = no_tile;
    check_refused(scene, &d, "cannot be loaded");
    d.tile_load = NULL;
    CHECK(lc_explain(ctx, scene, &d, 1, 1, 0, &x) == LC_ERR_ARG && !x);
    lc_scene_destroy(scene);
    scene = lamps(PINHOLE "PixelFilter \"mitchell\"\n");
    d = usual;
    d.n_passes = 65;
    check_refused(scene, &d, "no 65 passes with this pixel filter");
    d.n_passes = 64;
    lc_image_destroy(render(scene, &d));
    lc_scene_destroy(scene);
}

static lc_status render_coarse(lc_context *c)
{
    lc_scene *scene;
    lc_image *image = NULL;
    lc_render_desc d = LC_RENDER_DESC_INIT;
    d.coarse = 4;
    d.method = LC_METHOD_CUTS;
    lc_status st = lc_scene_load(c, scene_path(), NULL, &scene);
    if (!st) st = lc_render(c, scene, &d, &image, NULL);
    CHECK(!st == (image != NULL));
    lc_image_destroy(image);
    lc_scene_destroy(scene);
    return st;
}

TEST(memory_may_end_anywhere)
{
    lc_scene_destroy(lamps(PINHOLE));
    starve(render_coarse, 60);
}

int main(void)
{
    temp_begin();
    ctx = quiet_context_of(2, LC_ISA_BEST);
    RUN(the_mean_of_all_passes_is_the_picture);
    RUN(so_it_is_where_pixels_share_samples);
    RUN(cuts_of_passes_choose_other_lights);
    RUN(an_evenly_lit_plane_is_exact_with_its_texture);
    RUN(light_does_not_bleed_over_the_edge_of_what_is_nearer);
    RUN(light_does_not_bleed_around_a_corner);
    RUN(emission_and_what_is_behind_all_are_exact);
    RUN(bytes_do_not_depend_on_threads_instruction_sets_and_crops);
    RUN(what_makes_no_sense_is_refused);
    RUN(memory_may_end_anywhere);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
