/* unit_glass_shadow.c - shadow rays through glass: panes, sheets, colours, a ball, instances and mixes
 * against Fresnel's equations in doubles; occluders behind glass; every instruction set; proofs. */
#include "cut/cut.h"
#include "scene/surface.h"
#include "shade/point_init.h"
#include "support/isas.h"
#include "support/near.h"
#include "support/one_scene.h"
#include "support/rnd.h"
#include "trace/bvh.h"

#define HEAD                                                                                                 \
    "LookAt 0 -9 9  0 0 0  0 0 1\nFilm \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 24\n"      \
    "Camera \"perspective\" \"float fov\" 40\nSampler \"independent\" \"integer pixelsamples\" 1\n"          \
    "WorldBegin\nLightSource \"point\" \"point3 from\" [0 0 5] \"rgb I\" [10 10 10]\n"                       \
    "Material \"diffuse\"\n" SQUARE("9", "0")
/* A square, x and y from -s to s at height z. */
#define SQUARE(s, z)                                                                                         \
    "Shape \"trianglemesh\" \"point3 P\" [-" s " -" s " " z " " s " -" s " " z " " s " " s " " z " -" s " "  \
    s " " z "] \"integer indices\" [0 1 2 0 2 3]\n"
#define GLASS "Material \"dielectric\" \"float eta\" 1.5\n"
#define PANE GLASS SQUARE("8", "2") SQUARE("8", "1.9")

static const lc_load_desc few = { .size = sizeof few, .area_lights = 64, .env_lights = 64, .n_reps = 1 };

static bool load(const char *body) { return load_text(&few, HEAD "%s", body) == LC_OK; }

/* Fresnel's reflectance of a boundary to index 1.5, in doubles. */
static double fresnel(double c)
{
    double t = sqrt(1 - (1 - c * c) / 2.25), s = (c - 1.5 * t) / (c + 1.5 * t);
    double p = (1.5 * c - t) / (1.5 * c + t);
    return (s * s + p * p) / 2;
}

/* What reaches (x, y, 0.01) from (0, 0, 5), by channels; false: nothing. */
static bool arrives(double x, double y, double v[3])
{
    const float org[3] = { (float)x, (float)y, 0.01f }, to[3] = { 0, 0, 5 };
    const float *const target[3] = { to, to + 1, to + 2 };
    float f[3] = { 1, 1, 1 }, *const through[3] = { f, f + 1, f + 2 };
    uint8_t hidden, other;
    const lc_visibility *vis = &scene->visibility;
    vis->hidden(vis->scene, org, 1, target, false, &hidden, NULL);
    if (vis->dimmed) {
        vis->dimmed(vis->scene, org, 1, target, false, &other, NULL, through);
        CHECK(other == hidden);
    }
    for (int k = 0; k < 3; k++) v[k] = hidden ? 0 : (double)f[k];
    return !hidden;
}

/* Checks what arrives where the ray is so far off, at many angles of it: of(cosine) times the colour. */
static void check_angles(double (*of)(double c), double r, double g, double b)
{
    for (int i = 0; i < 40; i++) {
        double x = rnd_in(-7, 7), y = rnd_in(-7, 7), c = 4.99 / sqrt(x * x + y * y + 4.99 * 4.99), v[3];
        const double want[3] = { r * of(c), g * of(c), b * of(c) };
        CHECK(arrives(x, y, v));
        for (int k = 0; k < 3; k++)
            CHECKF(near_abs(v[k], want[k], 2e-6), "(%g, %g): %g, not %g", x, y, v[k], want[k]);
    }
    for (int i = -6; i <= 6; i++) { /* along the diagonal that the triangles of a square have in common */
        double c = 4.99 / sqrt(2. * i * i + 4.99 * 4.99), v[3];
        CHECK(arrives(i, i, v) && near_abs(v[0], r * of(c), 2e-6));
        CHECKF(near_abs(v[1], g * of(c), 2e-6), "(%d, %d): %g, not %g", i, i, v[1], g * of(c));
    }
}

static double one(double c) { return 1 - fresnel(c); }
static double two(double c) { return one(c) * one(c); }
static double four(double c) { return two(c) * two(c); }
static double sheet(double c) { return 1 - 2 * fresnel(c) / (1 + fresnel(c)); }
static double half_sheet(double c) { return 0.5 + 0.5 * sheet(c); }
static double all(double c) { return c > 0 ? 1 : 0; }
static double quarter(double c) { return 0.75 * all(c); }

TEST(panes)
{
    CHECK(load(GLASS SQUARE("8", "2")));
    check_angles(one, 1, 1, 1);
    CHECK(load(PANE));
    check_angles(two, 1, 1, 1);
    CHECK(load(GLASS SQUARE("8", "2") "ReverseOrientation\n" SQUARE("8", "1.9")));
    check_angles(two, 1, 1, 1);
    CHECK(load(PANE SQUARE("8", "3") SQUARE("8", "2.9")));
    check_angles(four, 1, 1, 1);
    CHECK(load("Material \"thindielectric\" \"float eta\" 1.5\n" SQUARE("8", "2")));
    check_angles(sheet, 1, 1, 1);
    CHECK(load("Material \"interface\"\n" SQUARE("8", "2")) && !scene->has_glass);
    check_angles(all, 1, 1, 1);
}

TEST(colours)
{
    CHECK(load("Material \"glass\" \"float index\" 1.5 \"rgb Kt\" [.5 .25 0]\n" SQUARE("8", "2")));
    check_angles(one, 0.5, 0.25, 0);
    CHECK(load("Material \"glass\" \"float index\" 1.5 \"rgb Kt\" [.5 .25 .125]\n" SQUARE("8", "2")
                   SQUARE("8", "3")));
    check_angles(two, 0.25, 0.0625, 0.015625);
    CHECK(load("Texture \"t\" \"spectrum\" \"constant\" \"rgb value\" [.5 1 .25]\n"
               "Material \"glass\" \"float index\" 1.5 \"texture Kt\" \"t\"\n" SQUARE("8", "2")));
    check_angles(one, 0.5, 1, 0.25);
    double v[3];
    CHECK(load("Material \"glass\" \"rgb Kt\" [0 0 0]\n" SQUARE("8", "2")) && !arrives(1, 2, v));
}

/* A mix lets its mean through, without noise. */
TEST(mixes)
{
    CHECK(load("MakeNamedMaterial \"a\" \"string type\" \"interface\"\n"
               "MakeNamedMaterial \"b\" \"string type\" \"thindielectric\" \"float eta\" 1.5\n"
               "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" .5\n" SQUARE("8", "2")));
    check_angles(half_sheet, 1, 1, 1);
    CHECK(load("Material \"uber\" \"rgb opacity\" [.25 .25 .25] \"rgb Ks\" [0 0 0]\n" SQUARE("8", "2")));
    check_angles(quarter, 1, 1, 1);
}

/* An object that is small or placed once is copied into the world. */
#define MORE "AttributeBegin Translate 0 0 -50 Shape \"sphere\" \"float radius\" 1 AttributeEnd\n"
#define FAR "Translate 90 0 0 ObjectInstance \"o\"\n"

TEST(instances)
{
    CHECK(load("ObjectBegin \"o\"\n" MORE GLASS SQUARE("4", "1") SQUARE("4", ".95")
               "ObjectEnd\nScale 2 2 2 ObjectInstance \"o\"\n" FAR));
    CHECK(scene->n_instances == 2);
    CHECK(!scene->bvh->data.alpha && scene->has_glass);
    check_angles(two, 1, 1, 1);
    /* A scale of other proportions: the angle is that in the world. */
    CHECK(load("ObjectBegin \"o\"\n" MORE GLASS
               "Shape \"trianglemesh\" \"point3 P\" [-9 -9 -9 9 -9 9 9 9 9 -9 9 -9] "
               "\"integer indices\" [0 1 2 0 2 3]\nObjectEnd\n"
               "Translate 0 0 2.5 Scale 1 1 .25 ObjectInstance \"o\"\n" FAR));
    CHECK(scene->n_instances == 2);
    for (int i = 0; i < 40; i++) { /* the plane z = 2.5 + x / 4 */
        double x = rnd_in(-4, 4), y = rnd_in(-4, 4), d = sqrt(x * x + y * y + 4.99 * 4.99), v[3];
        double c = fabs(x * 0.25 + 4.99) / d / sqrt(1.0625);
        CHECK(arrives(x, y, v));
        CHECKF(near_abs(v[0], one(c), 2e-6), "(%g, %g): %g, not %g", x, y, v[0], one(c));
    }
}

/* A solid ball: the ray crosses its surface twice, at the same angle. */
TEST(ball)
{
    CHECK(load("Translate 0 0 2.5\n" GLASS "Shape \"sphere\" \"float radius\" 1\n"));
    CHECK(note("glass") && note("glass")->count == 1);
    for (int i = 0; i < 60; i++) {
        double x = rnd_in(-1.8, 1.8), y = rnd_in(-1, 1), v[3], d = sqrt(x * x + y * y + 4.99 * 4.99);
        double off = 2.5 * sqrt(x * x + y * y) / d; /* of the ray from the centre */
        double c = sqrt(fmax(1 - off * off, 0));
        if (fabs(c - 0.3) < 0.3 && off < 1.03) continue; /* the silhouette of a mesh is no circle */
        CHECK(arrives(x, y, v));
        double want = off < 1 ? two(c) : 1;
        CHECKF(near_abs(v[0], want, 2e-3), "(%g, %g): %g, not %g", x, y, v[0], want);
    }
}

TEST(occluders)
{
    double v[3];
    for (int i = 0; i < 2; i++) {
        CHECK(load(i ? PANE "Material \"diffuse\"\n" SQUARE("1", "3")
                     : PANE "Material \"diffuse\"\n" SQUARE("1", "1")));
        CHECK(!arrives(0.1, 0.2, v) && arrives(6, 0, v) && v[0] < 1);
    }
    CHECK(load("Material \"mirror\"\n" SQUARE("8", "2")) && !arrives(1, 2, v) && !scene->has_glass);
}

/* No triangle of glass is an occluder, so a cluster behind glass is never proved to be occluded. */
TEST(proofs)
{
    CHECK(load(GLASS SQUARE("8", "2")));
    CHECK(scene->occluders->n == 2); /* the floor */
    for (uint32_t t = 2; t < 4; t++) CHECK(lc_occluder_of(scene->occluders, t) == LC_NONE);
}

/* One light after another with many lights: the picture of cuts is that of the exact method, and of a scene
 * without the pane times what the pane lets through. */
static double mean_of(lc_method method, lc_image **out)
{
    lc_render_desc rd = LC_RENDER_DESC_INIT;
    lc_render_stats stats = LC_RENDER_STATS_INIT;
    rd.method = method;
    rd.error_ratio = 1e-6f;
    lc_image *image = NULL;
    CHECK(lc_render(ctx, scene, &rd, &image, &stats) == LC_OK);
    double sum = 0;
    for (uint32_t i = 0; i < 24 * 24 && image; i++) sum += (double)lc_image_channel(image, "G")[i];
    if (out) *out = image;
    else lc_image_destroy(image);
    return sum;
}

static bool load_many(const char *more)
{
    static char text[1 << 14];
    size_t n = 0;
    for (int i = 0; i < 40; i++)
        n += (size_t)snprintf(text + n, sizeof text - n,
                              "LightSource \"point\" \"point3 from\" [%g %g %g] \"rgb I\" [1 1 1]\n",
                              (i % 8) * 0.3 - 1, (i / 8) * 0.3 - 0.7, 4 + 0.01 * i);
    return load_text(&few, HEAD "%s%s", text, more) == LC_OK;
}

TEST(methods)
{
    CHECK(load_many("Material \"interface\"\n"));
    double open = mean_of(LC_METHOD_EXACT, NULL);
    CHECK(load_many("Material \"glass\" \"float index\" 1 \"rgb Kr\" [0 0 0] \"rgb Kt\" [.5 .5 .5]\n"
                    SQUARE("8", "2")));
    const double want = 0.5 * 0.5 * open; /* the camera looks through it, too */
    double exact = mean_of(LC_METHOD_EXACT, NULL), cuts = mean_of(LC_METHOD_CUTS, NULL);
    CHECKF(near_abs(exact, want, 1e-4 * want) && near_abs(cuts, want, 1e-4 * want), "%g, %g, not %g", exact,
           cuts, want);
    lc_render_desc rd = LC_RENDER_DESC_INIT;
    lc_explanation *x = NULL;
    CHECK(lc_explain(ctx, scene, &rd, 12, 12, 0, &x) == LC_OK);
    double sum[2] = { 0, 0 };
    for (uint32_t i = 0; x && i < x->n_clusters; i++) {
        sum[0] += x->clusters[i].estimate[1];
        sum[1] += x->clusters[i].exact[1];
    }
    CHECKF(x && sum[1] > 0 && near_abs(sum[0], sum[1], 0.05 * sum[1]), "%g, exactly %g", sum[0], sum[1]);
    lc_explanation_destroy(x);
}

/* Bent and bumpy panes one behind the other, in the world or in two instances. */
static void load_pile(bool object)
{
    static char text[1 << 15];
    size_t n = 0;
    for (int i = 0; i < 150; i++)
        n += (size_t)snprintf(text + n, sizeof text - n,
                              "Shape \"trianglemesh\" \"point3 P\" [-1 -1 %g 1 -1 %g 1 1 %g -1 1 %g] "
                              "\"integer indices\" [0 1 2 0 2 3]\n",
                              1 + 0.005 * i, 1 + 0.01 * i, 1.1 + 0.005 * i, 1 + 0.0065 * i);
    const char *before = object ? "ObjectBegin \"o\"\n" : "";
    const char *after = "ObjectEnd ObjectInstance \"o\" Translate .3 .1 0 ObjectInstance \"o\"\n";
    CHECK(load_text(&few, HEAD "%sMaterial \"glass\" \"rgb Kt\" [.9 1 .8]\n%s%s", before, text,
                    object ? after : "") == LC_OK);
}

TEST(instruction_sets)
{
    uint32_t n_dim = 0;
    for (int object = 0; object < 2; object++) {
        load_pile(object);
        CHECK(scene->n_instances == (object ? 2 : 0));
        for (int i = 0; i < 100; i++) {
            const float org[3] = { (float)rnd_in(-1, 1), (float)rnd_in(-1, 1), (float)rnd_in(0.5, 3) };
            float t[3][64];
            const float *const target[3] = { t[0], t[1], t[2] };
            uint8_t first[64], got[64], alone;
            static uint64_t want[64][3], loss[64][3], single[1][3];
            for (int j = 0; j < 64; j++)
                for (int k = 0; k < 3; k++) t[k][j] = (k == 2 ? org[2] : 0) + (float)rnd_in(-1, 1);
            EACH_ISA(isa) {
                const lc_trace_kernels *kernels = &lc_isa_kernels(isa)->trace;
                kernels->dimmed(&scene->bvh->data, org, 64, target, false, got, NULL, loss);
                if (isa == LC_ISA_SCALAR) {
                    memcpy(first, got, sizeof got);
                    memcpy(want, loss, sizeof loss);
                }
                CHECK(!memcmp(first, got, sizeof got));
                for (uint32_t j = 0; j < 64; j++) {
                    const float *const to[3] = { t[0] + j, t[1] + j, t[2] + j };
                    kernels->dimmed(&scene->bvh->data, org, 1, to, false, &alone, NULL, single);
                    CHECK(alone == first[j]);
                    if (alone) continue;
                    CHECK(!memcmp(loss[j], want[j], sizeof want[j]));
                    CHECK(!memcmp(single[0], want[j], sizeof want[j]));
                    n_dim += want[j][0] > 0;
                }
            }
        }
    }
    CHECKF(n_dim > 2000, "%u rays dimmed", n_dim);
}

int main(void)
{
    ctx = quiet_context(0);
    temp_begin();
    RUN(every_instruction_set_is_here);
    RUN(panes);
    RUN(colours);
    RUN(mixes);
    RUN(instances);
    RUN(ball);
    RUN(occluders);
    RUN(proofs);
    RUN(methods);
    RUN(instruction_sets);
    one_scene_end();
    temp_end();
    return test_done();
}
