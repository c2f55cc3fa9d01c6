/* unit_method.c - few lights: the choice between cuts and every light rests on counts, so that it is the same
 * for any number of threads, and what is chosen is the picture of one of the two ways; both agree with each
 * other within the error that is asked for. */
#include "support/test.h"

#include "lightcuts.h"

#include <math.h>
#include <stdlib.h>

#define SIDE 48
#define RATIO 0.02

/* A box of two walls and a ball under n lamps; `at` changes where they are. */
static void write_scene(const char *path, int n, int at)
{
    FILE *f = fopen(path, "w");
    if (!f) abort();
    fprintf(
        f,
        "Film \"rgb\" \"integer xresolution\" [%d] \"integer yresolution\" [%d]\nLookAt 0 2 6 0 1 0 0 1 0\n",
        SIDE, SIDE);
    fprintf(f, "Camera \"perspective\" \"float fov\" [50]\nIntegrator \"directlighting\" \nWorldBegin\n"
               "Material \"diffuse\" \"rgb reflectance\" [.6 .5 .4]\n");
    for (int i = 0; i < n; i++) {
        double a = i * 2.399963 + at, r = sqrt((i + 0.5) / n) * 3;
        fprintf(f, "LightSource \"point\" \"rgb I\" [%g 1 1] \"point3 from\" [%g %g %g]\n", 0.5 + i % 3,
                r * cos(a), 2.5 + i % 5 * 0.2, r * sin(a));
    }
    fprintf(f, "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-9 0 9 9 0 9 9 0 -9 "
               "-9 0 -9]\n"
               "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-9 0 -3 9 0 -3 9 6 -3 "
               "-9 6 -3]\n"
               "Translate 0 1 0 Shape \"sphere\" \"float radius\" [1]\n");
    fclose(f);
}

typedef struct {
    float rgb[3][SIDE * SIDE];
    int exact;
} picture;

static void render(const char *path, uint32_t threads, lc_method method, picture *out)
{
    lc_context_desc cd = LC_CONTEXT_DESC_INIT;
    lc_render_desc rd = LC_RENDER_DESC_INIT;
    lc_context *ctx;
    lc_scene *scene;
    lc_image *image;
    lc_render_stats stats = LC_RENDER_STATS_INIT;
    cd.n_threads = threads;
    rd.method = method;
    rd.error_ratio = (float)RATIO;
    if (lc_context_create(&cd, &ctx) || lc_scene_load(ctx, path, NULL, &scene) ||
        lc_render(ctx, scene, &rd, &image, &stats))
        abort();
    for (int k = 0; k < 3; k++)
        memcpy(out->rgb[k], lc_image_channel(image, (const char *[]){ "R", "G", "B" }[k]),
               sizeof out->rgb[k]);
    out->exact = stats.exact;
    lc_image_destroy(image);
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
}

static double luminance(const picture *p, int i)
{
    return 0.2126 * (double)p->rgb[0][i] + 0.7152 * (double)p->rgb[1][i] + 0.0722 * (double)p->rgb[2][i];
}

static int rising(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Median of the pixels' relative differences, and the ratio of the means. */
static double difference(const picture *a, const picture *b, double *mean_ratio)
{
    static double error[SIDE * SIDE];
    double sum_a = 0, sum_b = 0;
    int n = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        double x = luminance(a, i), y = luminance(b, i);
        sum_a += x;
        sum_b += y;
        if (y > 0) error[n++] = fabs(x - y) / y;
    }
    qsort(error, (size_t)n, sizeof *error, rising);
    *mean_ratio = sum_a / sum_b;
    return n ? error[n / 2] : 1;
}

static int n_exact, n_cuts; /* what was chosen */

static void check(int n, int at)
{
    static picture chosen, again, cuts, all;
    char path[64];
    double mean;
    snprintf(path, sizeof path, "build/unit_method_%d.pbrt", at);
    write_scene(path, n, at);
    render(path, 1, LC_METHOD_LIGHTCUTS, &chosen);
    render(path, 2, LC_METHOD_LIGHTCUTS, &again);
    render(path, 2, LC_METHOD_CUTS, &cuts);
    render(path, 2, LC_METHOD_EXACT, &all);
    remove(path);
    CHECK(!memcmp(&chosen, &again, sizeof chosen));
    CHECKF(!memcmp(chosen.rgb, chosen.exact ? all.rgb : cuts.rgb, sizeof chosen.rgb), "%d lights", n);
    CHECK(!cuts.exact && all.exact);
    double median = difference(&cuts, &all, &mean);
    CHECKF(median <= RATIO && fabs(mean - 1) <= RATIO, "%d lights: median %g, ratio of means %g", n, median,
           mean);
    n_exact += chosen.exact;
    n_cuts += !chosen.exact;
}

TEST(both_ways_agree_within_the_error_asked_for)
{
    for (int i = 0; i < 4; i++) check(40 << (2 * i), i);
}

TEST(few_lights_are_all_evaluated_and_many_are_not)
{
    CHECKF(n_exact > 0 && n_cuts > 0, "%d exact, %d cuts", n_exact, n_cuts);
}

int main(void)
{
    RUN(both_ways_agree_within_the_error_asked_for);
    RUN(few_lights_are_all_evaluated_and_many_are_not);
    return test_done();
}
