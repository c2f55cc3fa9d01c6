/* unit_interval.c - the planes cut.lower, cut.upper, cut.estimate and cut.halfwidth against the exact picture
 * of the same points: no pixel is outside of what is proved, at most 5 % are further from the estimate than
 * the half-width, and the estimates are not off on the whole. The picture itself does not change.
 *
 *     build/tests/unit_interval              the scenes of tests/golden
 *     build/tests/unit_interval scene ...    and prints a line of a table for each
 */
#include "cut/interval.h"
#include "support/pictures.h"
#include "support/test.h"

#include "support/files.h"

#define RND_KEY 95
#include "support/rnd.h"

#define OUTSIDE_MOST 0.05
/* The sum of all pixels, over the root of the sum of squared half-widths h: what is drawn from a range of r
 * has a standard deviation of at most r / 2, and h^2 is 0.5 ln(40) r^2; four of them: 4 / (2 * 1.358). */
#define SUM_OFF_MOST 1.47
/* Relative: the picture's luminance is of floats that were summed and rounded, by 24 bits. */
#define READ_OFF 1e-6

typedef struct {
    const char *name;
    lc_method method;
    uint32_t spp;
    float error, error_ratio; /* asked of pixels, else of clusters */
    uint32_t max_cut;
} way;

static const way ways[] = {
    { "2 %", LC_METHOD_CUTS, 1, 0, 0.02f, 1000 },
    { "2 %, few clusters", LC_METHOD_CUTS, 1, 0, 0.02f, 20 },
    { "50 %, 3 samples", LC_METHOD_CUTS, 3, 0, 0.5f, 1000 },
    { "of pixels, 8 samples", LC_METHOD_CUTS, 8, 0.05f, 0.02f, 1000 },
    { "every light", LC_METHOD_EXACT, 2, 0, 0.02f, 1000 },
};
#define N_WAYS (sizeof ways / sizeof *ways)

typedef struct {
    lc_context *ctx;
    lc_scene *scene;
    const char *path;
    bool part; /* of the film only */
} setup;

typedef struct {
    uint32_t pixels, below, above, outside, unsure;
    double width, half, half2, mean, mean_estimate; /* sums: upper - lower, half-width, exact, estimate */
} tally;

static lc_image *render(const setup *s, const way *w, lc_method method, uint32_t aovs)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    d.method = method;
    d.spp = w->spp;
    d.error = w->error;
    d.error_ratio = w->error_ratio;
    d.max_cut = w->max_cut;
    d.aovs = aovs;
    for (int k = 0; k < 4 && s->part; k++) d.crop[k] = k % 2 ? 28 : 8;
    if (lc_render(s->ctx, s->scene, &d, &image, NULL)) abort();
    return image;
}

static double lum_at(const lc_image *image, uint32_t x, uint32_t y)
{
    return 0.2126 * pixel_at(image, "R", x, y) + 0.7152 * pixel_at(image, "G", x, y) +
           0.0722 * pixel_at(image, "B", x, y);
}

static void add_pixel(const lc_image *with, const lc_image *exact, uint32_t x, uint32_t y, tally *t)
{
    const double truth = lum_at(exact, x, y), slack = READ_OFF * truth;
    const double lower = pixel_at(with, "cut.lower", x, y), upper = pixel_at(with, "cut.upper", x, y);
    const double estimate = pixel_at(with, "cut.estimate", x, y);
    const double half = pixel_at(with, "cut.halfwidth", x, y);
    t->pixels++;
    t->below += truth + slack >= lower ? 0 : 1;
    t->above += truth - slack <= upper ? 0 : 1;
    t->outside += fabs(estimate - truth) <= half + slack ? 0 : 1;
    t->unsure += upper > lower * 1.001 + 1e-30;
    t->width += upper - lower;
    t->half += half;
    t->half2 += half * half;
    t->mean += truth;
    t->mean_estimate += estimate;
}

/* Prints and checks what a way of rendering gives. */
static void check_way(const setup *s, const way *w, bool table)
{
    lc_image *plain = render(s, w, w->method, LC_AOV_CUT), *exact = render(s, w, LC_METHOD_EXACT, LC_AOV_CUT);
    lc_image *with = render(s, w, w->method, LC_AOV_CUT | LC_AOV_INTERVAL);
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    tally t = { 0 };
    uint32_t changed = 0;
    lc_image_get_desc(with, &d);
    for (uint32_t y = 0; y < d.height; y++)
        for (uint32_t x = 0; x < d.width; x++) {
            add_pixel(with, exact, x, y, &t);
            changed += lum_at(plain, x, y) < lum_at(with, x, y) || lum_at(plain, x, y) > lum_at(with, x, y);
        }
    CHECKF(!t.below && !t.above, "%s, %s: %u pixels below, %u above what is proved", s->path, w->name,
           t.below, t.above);
    CHECKF((double)t.outside <= OUTSIDE_MOST * (double)t.pixels, "%s, %s: %u of %u pixels outside", s->path,
           w->name, t.outside, t.pixels);
    CHECKF(fabs(t.mean_estimate - t.mean) <= SUM_OFF_MOST * sqrt(t.half2) + READ_OFF * t.mean,
           "%s, %s: the sum is %g, estimated %g", s->path, w->name, t.mean, t.mean_estimate);
    CHECKF(w->method != LC_METHOD_EXACT || !t.unsure, "%s: %u pixels are not known", s->path,
           t.unsure);
    CHECKF(!changed, "%s, %s: %u pixels changed", s->path, w->name, changed);
    if (table)
        printf("| %s, %s | %u | %u | %.1f %% | %.1f %% | %u | %+.2f %% |\n", s->path, w->name,
               t.pixels, (t.below + t.above),
               50 * t.width / fmax(t.mean, 1e-30), 100 * t.half / fmax(t.mean, 1e-30),
               t.outside, 100 * (t.mean_estimate / fmax(t.mean, 1e-30) - 1));
    lc_image_destroy(plain);
    lc_image_destroy(exact);
    lc_image_destroy(with);
}

static void check_scene(const char *path, bool part, bool table)
{
    setup s = { .path = path, .part = part };
    lc_context_desc cd = LC_CONTEXT_DESC_INIT;
    lc_load_desc ld = LC_LOAD_DESC_INIT;
    ld.area_lights = 300;
    ld.env_lights = 300;
    ld.indirect_lights = 300;
    if (lc_context_create(&cd, &s.ctx) || lc_scene_load(s.ctx, path, &ld, &s.scene)) abort();
    for (size_t i = 0; i < N_WAYS; i++) check_way(&s, &ways[i], table);
    lc_scene_destroy(s.scene);
    lc_context_destroy(s.ctx);
}

static void check_text(const char *name, const char *text)
{
    const char *path = temp_path(name);
    file_text(path, text);
    check_scene(path, false, getenv("LC_TEST_TABLE") != NULL);
}

static int n_paths;
static char **paths;

TEST(of_scenes)
{
    static const char *const golden[] = { "bounced", "box", "cloud", "ggx", "glass", "mirror",
                                          "mixed", "textured", "ward" };
    char path[64];
    for (int i = 0; i < n_paths; i++) check_scene(paths[i], false, true);
    for (size_t i = 0; i < sizeof golden / sizeof *golden && !n_paths; i++) {
        snprintf(path, sizeof path, "tests/golden/%s.pbrt", golden[i]);
        check_scene(path, true, false);
    }
}

#define CAMERA "LookAt 0 0 9  0 0 0  0 1 0 Camera \"perspective\" \"float fov\" 60 "
#define SMALL "\"integer xresolution\" 24 \"integer yresolution\" 24 "
#define FLOOR "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] " \
              "\"point3 P\" [-9 -9 0 9 -9 0 9 9 0 -9 9 0]\n"

static char *text, *text_end;
static void put(const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    text_end += vsprintf(text_end, fmt, args);
    va_end(args);
}
static void put_light(double x, double y, double z, const char *more)
{
    put("LightSource \"point\" \"point3 from\" [%g %g %g] %s\n", x, y, z, more);
}

/* Pairs of lights, one of each behind a plate: each cluster is all of its bound or nothing, by the toss of a
 * coin. No less than 1 % of the pixels are beyond half of the half-width then. */
TEST(of_coins)
{
    text_end = text = malloc(1 << 20);
    put(CAMERA "Film \"rgb\" " SMALL "WorldBegin Material \"diffuse\"\n" FLOOR);
    for (int i = 0; i < 400; i++) {
        const double x = i % 20 - 9.5, y = i / 20 - 9.5;
        put_light(x, y, 7, "");
        put_light(x, y + 0.01, 7, "");
        put("Shape \"trianglemesh\" \"integer indices\" [0 1 2] \"point3 P\" [%g %g 6.999 %g %g 6.999 %g %g "
            "6.999]\n", x - 0.01, y + 0.007, x + 0.01, y + 0.007, x, y + 0.03);
    }
    check_text("coins.pbrt", text);
    free(text);
}

/* Lights of all colours under a film that turns colours, and pixels that are sums with negative weights. */
TEST(of_colours)
{
    char colour[64];
    text_end = text = malloc(1 << 20);
    put(CAMERA "Film \"rgb\" \"float whitebalance\" 4000 \"float iso\" 200 " SMALL
        "PixelFilter \"mitchell\" WorldBegin Material \"diffuse\" \"rgb reflectance\" [.9 .3 .1]\n" FLOOR);
    for (int i = 0; i < 500; i++) {
        snprintf(colour, sizeof colour, "\"rgb I\" [%g %g %g]", rnd(), i % 3 ? rnd() : 0, i % 5 ? 0 : rnd());
        put_light(rnd_in(-8, 8), rnd_in(-8, 8), rnd_in(0.5, 6), colour);
    }
    for (int i = 0; i < 60; i++) {
        const double x = rnd_in(-8, 8), y = rnd_in(-8, 8), z = rnd_in(0.1, 3);
        put("Shape \"trianglemesh\" \"integer indices\" [0 1 2] \"point3 P\" [%g %g %g %g %g %g %g %g %g]\n",
            x, y, z, x + rnd(), y + rnd(), z, x, y + rnd(), z + rnd());
    }
    check_text("colours.pbrt", text);
    free(text);
}

/* Sums of coins by the library's own figure: 5 % at most are beyond the half-width, and not far fewer than
 * Hoeffding's inequality leaves of coins, 0.7 %. */
TEST(half_width_of_coins)
{
    const int n_coins = 400, n = 20000;
    int beyond = 0, beyond_half = 0;
    for (int i = 0; i < n; i++) {
        lc_interval sum = { 0 };
        for (int k = 0; k < n_coins; k++) {
            const double heads = rnd_n(2);
            lc_interval_add(&sum, &(lc_interval){ 0, 1, heads, 1 }, 0.25);
        }
        const double off = fabs(sum.estimate - 0.125 * n_coins), half = lc_interval_half_width(&sum);
        beyond += off > half;
        beyond_half += off > half / 2;
    }
    CHECKF(beyond <= n / 20 && beyond >= n / 1000, "%d of %d", beyond, n);
    CHECKF(beyond_half > n / 20, "%d of %d", beyond_half, n);
}

/* A negative weight turns an interval round; rounding widens it whatever its signs. */
TEST(of_sums)
{
    lc_interval sum = { 1, 2, 1.5, 1 };
    lc_interval_add(&sum, &(lc_interval){ 10, 20, 15, 4 }, -0.5);
    CHECK(sum.lower <= -9 && sum.lower >= -9 && sum.upper <= -3 && sum.upper >= -3);
    CHECK(sum.range2 <= 2 && sum.range2 >= 2);
    const lc_interval was = sum;
    lc_interval_round(&sum, 1);
    CHECK(sum.lower < was.lower && sum.upper > was.upper);
}

int main(int argc, char **argv)
{
    n_paths = argc - 1;
    paths = argv + 1;
    temp_begin();
    RUN(of_scenes);
    if (n_paths) return test_done();
    RUN(of_coins);
    RUN(of_colours);
    RUN(half_width_of_coins);
    RUN(of_sums);
    temp_end();
    return test_done();
}
