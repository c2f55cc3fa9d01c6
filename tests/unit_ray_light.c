/* unit_ray_light.c - points of media lie where the light is: beside integrals in doubles over all lights. */
#include "support/near.h"
#include "support/one_scene.h"
#include "support/pictures.h"
#include "support/rnd.h"

#include "scene/media.h"
#include "scene/ray_light.h"
#include "shade/dir_pack.h"
#include "tree/light_tree.h"

#include <math.h>
#include <stdlib.h>

static const lc_load_desc direct = {
    .size = sizeof direct, .area_lights = 3000, .env_lights = 64, .n_reps = 16,
    .indirect_lights = LC_NO_LIGHTS
};

#define G 0.3 /* of the medium */
#define SIGMA 0.04
#define SIZE 10.0 /* half of the box that has the lights */
#define RAYS 100
#define OFFSETS 4 /* for each ray */

static double phase(double c)
{
    return (1 - G * G) / (4 * LC_PI) / pow(1 + G * G + 2 * G * c, 1.5);
}

static double luminance(lc_f3 a)
{
    return 0.2126 * (double)a.x + 0.7152 * (double)a.y + 0.0722 * (double)a.z;
}

/* What a light of the tree sheds at a place of a ray, its luminance, in the direction back. */
static double of_light(const lc_light_tree *tree, uint32_t i, const double at[3], lc_f3 way)
{
    const lc_light_rec *l = &tree->data.lights[i];
    const lc_light_kind kind = lc_kind_of_light(tree, i);
    const double x = (double)l->pos[0] - at[0], y = (double)l->pos[1] - at[1], z = (double)l->pos[2] - at[2],
                 d = sqrt(x * x + y * y + z * z),
                 c = -(x * (double)way.x + y * (double)way.y + z * (double)way.z) / d;
    double emission = 1, f = d * d;
    if (lc_is_aimed(kind)) {
        const lc_f3 axis = lc_dir_unpack((const uint32_t[2]){ l->dir_a, l->dir_b });
        emission = -(x * (double)axis.x + y * (double)axis.y + z * (double)axis.z) / d;
    }
    if (kind == LC_LIGHT_SPOT) {
        const lc_spot_rec *spot = lc_light_own(&tree->data, kind, i);
        const double u = fmin(fmax((emission - (double)spot->cos_total) * (double)spot->inv_width, 0), 1);
        emission = u * u * (3 - 2 * u);
    }
    const float *k = lc_light_atten(&tree->data, i);
    if (k) f = (double)k[0] + (double)k[1] * d + (double)k[2] * d * d;
    return luminance(lc_f3_load(l->intensity)) * fmax(emission, 0) * phase(c) / f;
}

static double light_at(lc_f3 org, lc_f3 dir, double t)
{
    const double at[3] = { (double)org.x + t * (double)dir.x, (double)org.y + t * (double)dir.y,
                           (double)org.z + t * (double)dir.z };
    double sum = 0;
    for (uint32_t i = 0; i < scene->tree->n_lights; i++) sum += of_light(scene->tree, i, at, dir);
    return sum;
}

/* The integral of what is scattered from t0 to t1, in halves as long as they matter. */
static double integral(lc_f3 org, lc_f3 dir, double t0, double t1, double a, double b, double whole,
                       int depth)
{
    const double mid = (t0 + t1) / 2, m = light_at(org, dir, mid) * SIGMA * exp(-SIGMA * mid),
                 left = (t1 - t0) / 12 * (a + 4 * (light_at(org, dir, (t0 + mid) / 2) * SIGMA *
                                                   exp(-SIGMA * (t0 + mid) / 2)) + m),
                 right = (t1 - t0) / 12 * (m + 4 * (light_at(org, dir, (t1 + mid) / 2) * SIGMA *
                                                    exp(-SIGMA * (t1 + mid) / 2)) + b);
    if (depth > 4 && (depth > 15 || fabs(left + right - whole) < 1e-3 * (left + right + 1e-9)))
        return left + right;
    return integral(org, dir, t0, mid, a, m, left, depth + 1) +
           integral(org, dir, mid, t1, m, b, right, depth + 1);
}

static double by_points(lc_f3 org, lc_f3 dir, double length, double offset, const lc_ray_light *light)
{
    lc_medium_point p[LC_MEDIUM_POINTS];
    lc_f3 through;
    const lc_media_draws how = { LC_MEDIUM_POINTS, offset, light };
    const uint32_t n = lc_media_draw(scene, org, dir, length, &how, p, &through);
    double sum = 0;
    for (uint32_t i = 0; i < n; i++) sum += (double)p[i].weight.x * light_at(org, dir, (double)p[i].t);
    return sum;
}

/* Root mean square of relative errors, each of at most 1. */
static void errors_of_rays(double rms[2], double *mean)
{
    double sum[2] = { 0, 0 }, points = 0;
    uint32_t n = 0;
    for (int i = 0; i < RAYS; i++) {
        const lc_f3 org = lc_f3_make((float)rnd_in(-SIZE, SIZE), (float)rnd_in(-SIZE, SIZE),
                                     (float)rnd_in(-SIZE, SIZE)),
                    dir = rnd_unit();
        const double length = rnd_in(2, 40), a = light_at(org, dir, 0) * SIGMA,
                     b = light_at(org, dir, length) * SIGMA * exp(-SIGMA * length),
                     want = integral(org, dir, 0, length, a, b, 0, 0);
        lc_ray_light light;
        lc_ray_light_find(scene, org, dir, &(const lc_ray_spread){ 0, 0, 1 }, (uint32_t)i, &light);
        if (!(want > 0)) continue;
        for (int k = 0; k < OFFSETS; k++, n++) {
            const double offset = (k + rnd()) / OFFSETS;
            for (int with = 0; with < 2; with++) {
                const double got = by_points(org, dir, length, offset, with ? &light : NULL),
                             e = fmin(fabs(got - want) / want, 1);
                sum[with] += e * e;
                points += with ? got / want : 0;
            }
        }
    }
    for (int with = 0; with < 2; with++) rms[with] = sqrt(sum[with] / n);
    *mean = points / n;
}

static void load_lights(int n, int kind)
{
    char *text = malloc((size_t)n * 400 + 4000);
    size_t at = (size_t)sprintf(
        text, "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\n"
              "Integrator \"volpath\" \"integer maxdepth\" 1\n"
              "MakeNamedMedium \"haze\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [0 0 0] "
              "\"rgb sigma_s\" [.04 .04 .04] \"float g\" .3\nMediumInterface \"\" \"haze\"\n"
              "Camera \"perspective\"\nWorldBegin\n"
              "Shape \"trianglemesh\" \"point3 P\" [-20 -20 -20 -20 -20 -19 -20 -19 -20] "
              "\"integer indices\" [0 1 2]\n");
    for (int i = 0; i < n; i++) {
        const double x = rnd_in(-SIZE, SIZE), y = rnd_in(-SIZE, SIZE), z = rnd_in(-SIZE, SIZE);
        const lc_f3 d = rnd_unit();
        if (kind == 0)
            at += (size_t)sprintf(text + at,
                                  "LightSource \"point\" \"point3 from\" [%g %g %g] \"rgb I\" [%g %g %g]\n",
                                  x, y, z, rnd(), rnd(), rnd());
        else if (kind == 1)
            at += (size_t)sprintf(text + at,
                                  "LightSource \"spot\" \"point3 from\" [%g %g %g] \"point3 to\" [%g %g %g] "
                                  "\"rgb I\" [%g %g %g] \"float coneangle\" %g \"float conedeltaangle\" %g\n",
                                  x, y, z, x + (double)d.x, y + (double)d.y, z + (double)d.z, rnd(), rnd(),
                                  rnd(), rnd_in(5, 60), rnd_in(1, 5));
        else
            at += (size_t)sprintf(text + at,
                                  "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [%g %g %g]\n"
                                  "Translate %g %g %g Rotate %g %g %g %g\n"
                                  "Shape \"trianglemesh\" \"point3 P\" [0 0 0 0.1 0 0 0 0.1 0] "
                                  "\"integer indices\" [0 1 2]\nAttributeEnd\n",
                                  rnd(), rnd(), rnd(), x, y, z, rnd_in(0, 360), (double)d.x, (double)d.y,
                                  (double)d.z);
    }
    CHECK(load_text(&direct, "%s", text) == LC_OK);
    free(text);
}

TEST(points_lie_where_the_light_is)
{
    static const struct {
        const char *name;
        int kind, n;
        double most, gain; /* rms; over that without looking for light */
    } cases[] = {
        { "point lights", 0, 3, 0.03, 0.5 },  { "point lights", 0, 60, 0.03, 0.5 },
        { "point lights", 0, 300, 0.03, 0.5 }, { "spots", 1, 60, 0.13, 0.85 },
        { "spots", 1, 300, 0.05, 0.5 },       { "triangles", 2, 3, 0.04, 0.5 },
        { "triangles", 2, 60, 0.04, 0.5 },    { "triangles", 2, 300, 0.04, 0.5 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double rms[2], mean;
        load_lights(cases[i].n, cases[i].kind);
        errors_of_rays(rms, &mean);
        printf("  %d %s: rms %.3f, without %.3f, mean %.4f\n", cases[i].n, cases[i].name, rms[1], rms[0],
               mean);
        CHECK(rms[1] < cases[i].most && rms[1] < cases[i].gain * rms[0] && near_abs(mean, 1, 0.01));
    }
}

/* No lights, and none that a medium scatters: nothing is found, and points are placed without. */
TEST(nothing_to_find)
{
    lc_ray_light light;
    load_lights(0, 0);
    const lc_f3 org = lc_f3_make(0, 0, 0), dir = lc_f3_make(0, 0, 1);
    lc_ray_light_find(scene, org, dir, &(const lc_ray_spread){ 0, 0, 1 }, 0, &light);
    CHECK(light.n == 0 && !light.varies);
    lc_medium_point p[LC_MEDIUM_POINTS];
    lc_f3 through;
    CHECK(lc_media_draw(scene, org, dir, 5, &(const lc_media_draws){ 4, 0.5, &light }, p, &through) == 4);
    CHECK(near_rel((double)through.x, exp(-SIGMA * 5), 1e-6));
}

#define WIDTH 32
#define HEIGHT 24

/* Lamps in fog over a floor, before a wall that is a mirror; seen through a lens. */
static void load_street(void)
{
    char *text = malloc(100 * 120 + 4000);
    size_t at = (size_t)sprintf(
        text, "Film \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d\nPixelFilter \"box\"\n"
              "Integrator \"volpath\" \"integer maxdepth\" 5\n"
              "MakeNamedMedium \"haze\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [0 0 0] "
              "\"rgb sigma_s\" [.02 .02 .02]\nMediumInterface \"\" \"haze\"\n"
              "LookAt 0 3 -30 0 2 0 0 1 0\nCamera \"perspective\" \"float fov\" 40 "
              "\"float lensradius\" 0.1 \"float focaldistance\" 20\nWorldBegin\n"
              "Shape \"trianglemesh\" \"point3 P\" [-50 0 -50 50 0 -50 50 0 50 -50 0 50] "
              "\"integer indices\" [0 1 2 0 2 3]\nMaterial \"conductor\" \"float roughness\" 0\n"
              "Shape \"trianglemesh\" \"point3 P\" [-9 0 9 9 0 9 9 9 9 -9 9 9] "
              "\"integer indices\" [0 1 2 0 2 3]\n",
        WIDTH, HEIGHT);
    for (int i = 0; i < 100; i++)
        at += (size_t)sprintf(text + at, "LightSource \"point\" \"point3 from\" [%g %g %g]\n",
                              rnd_in(-20, 20), rnd_in(3, 6), rnd_in(-25, 8));
    CHECK(load_text(&direct, "%s", text) == LC_OK);
    free(text);
}

static lc_image *street_picture(uint32_t spp, uint64_t seed)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image *out = NULL;
    d.spp = spp;
    d.seed = seed;
    CHECK(scene && lc_render(ctx, scene, &d, &out, NULL) == LC_OK);
    return out;
}

/* The picture by one and 16 samples beside one by many: no sparks about lamps, and none of those that samples
 * of a pixel see differently, or mirrors show. */
TEST(lamps_in_fog_have_no_sparks)
{
    load_street();
    lc_image *truth = street_picture(256, 9);
    for (uint32_t spp = 1; spp <= 16; spp *= 16) {
        lc_image *p = street_picture(spp, 0);
        double squares = 0, most = 0, sums[2] = { 0, 0 };
        for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
            const double got = pixel_at(p, "G", i % WIDTH, i / WIDTH),
                         want = pixel_at(truth, "G", i % WIDTH, i / WIDTH), e = (got - want) / want;
            squares += e * e;
            most = fmax(most, e);
            sums[0] += got;
            sums[1] += want;
        }
        const double rms = sqrt(squares / (WIDTH * HEIGHT));
        printf("  %u samples: rms %.4f, largest %.3f, mean %.4f\n", spp, rms, most, sums[0] / sums[1]);
        CHECK(rms < 0.043 && most < 0.45 && near_rel(sums[0], sums[1], 0.01));
        lc_image_destroy(p);
    }
    lc_image_destroy(truth);
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

#define SEEDS 24

/* What pilots say of the grain is what pixels by every light are off by from the mean of pictures whose
 * points lie elsewhere; of one sample, as further ones would be elsewhere in the pixel, too. */
TEST(grain_of_points_is_stated)
{
    static double mean[WIDTH * HEIGHT], first[WIDTH * HEIGHT];
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_render_stats stats = LC_RENDER_STATS_INIT;
    lc_image *out = NULL;
    load_street();
    d.spp = 1;
    d.method = LC_METHOD_CUTS;
    d.error = 0.02f;
    CHECK(lc_render(ctx, scene, &d, &out, &stats) == LC_OK);
    lc_image_destroy(out);
    d.method = LC_METHOD_EXACT;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        d.seed = seed;
        CHECK(lc_render(ctx, scene, &d, &out, NULL) == LC_OK);
        for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
            const double v = pixel_at(out, "G", i % WIDTH, i / WIDTH);
            mean[i] += v / SEEDS;
            if (!seed) first[i] = v;
        }
        lc_image_destroy(out);
    }
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) first[i] = fabs(first[i] / mean[i] - 1);
    qsort(first, WIDTH * HEIGHT, sizeof *first, by_size);
    const double median = first[WIDTH * HEIGHT / 2], high = first[WIDTH * HEIGHT * 19 / 20],
                 stated = (double)stats.calibration.medium_median,
                 stated_high = (double)stats.calibration.medium_high;
    printf("  stated %.2f, %.2f %%, measured %.2f, %.2f %%\n", 100 * stated, 100 * stated_high, 100 * median,
           100 * high);
    CHECK(near_rel(stated, median, 0.3) && near_rel(stated_high, high, 0.3) && high > 0.001);
}

int main(void)
{
    temp_begin();
    ctx = quiet_context(0);
    RUN(points_lie_where_the_light_is);
    RUN(nothing_to_find);
    RUN(lamps_in_fog_have_no_sparks);
    RUN(grain_of_points_is_stated);
    one_scene_end();
    temp_end();
    return test_done();
}
