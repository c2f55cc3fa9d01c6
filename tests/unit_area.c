/* unit_area.c - the lights made from emissive triangles: their power against integrals of the emission, as a
 * whole and for each part of an emissive picture; their number; that no two lie in one place. */
#include "base/rng.h"
#include "prepare/area_light.h"
#include "support/one_scene.h"

#define W 64
#define H 32

/* The emissive picture a.pfm: dark on the left, with a few very bright texels, blue in the lower half. */
static void texel(uint32_t x, uint32_t y, float rgb[3])
{
    for (int c = 0; c < 3; c++) rgb[c] = (float)lc_unit(lc_hash4(5, x, y, (uint64_t)c)) * (float)x / W;
    if ((x * 7 + y * 13) % 97 == 0) rgb[0] = 40;
    if (y >= H / 2) {
        rgb[0] = rgb[1] = 0;
        rgb[2] += 1;
    }
}

static void write_picture(void)
{
    static float rgb[H][W][3];
    for (uint32_t y = 0; y < H; y++)
        for (uint32_t x = 0; x < W; x++) texel(x, y, rgb[y][x]);
    pfm_write(temp_path("a.pfm"), W, H, rgb[0][0]);
}

/* Power over pi that an area of 1 with the whole picture on it emits. */
static void integral(double sum[3])
{
    float rgb[3];
    sum[0] = sum[1] = sum[2] = 0;
    for (uint32_t y = 0; y < H; y++)
        for (uint32_t x = 0; x < W; x++) {
            texel(x, y, rgb);
            for (int c = 0; c < 3; c++) sum[c] += (double)rgb[c] / (W * H);
        }
}

static void load(const char *text, uint32_t n_lights)
{
    CHECKF(parse_text_file("WorldBegin %s", text) == LC_OK, "%s", last_error);
    CHECK(lc_area_lights_make(scene, n_lights, 3) == LC_OK && lc_scene_join_lights(scene) == LC_OK);
}

static int by_place(const void *a, const void *b)
{
    return memcmp(&((const lc_light *)a)->pos, &((const lc_light *)b)->pos, sizeof(lc_f3));
}

/* No two lights have the same position. Sorts the lights. */
static void check_places(void)
{
    qsort(scene->lights, scene->n_lights, sizeof *scene->lights, by_place);
    for (size_t i = 1; i < scene->n_lights; i++) CHECK(by_place(&scene->lights[i - 1], &scene->lights[i]));
}

#define QUAD                                                                     \
    "Shape \"trianglemesh\" \"point3 P\" [0 0 0  2 0 0  2 .5 0  0 .5 0] " \
    "\"point2 uv\" [0 0 1 0 1 1 0 1] \"integer indices\" [0 1 2 0 2 3]"

TEST(pictures_keep_their_power)
{
    static const uint32_t numbers[] = { 1, 2, 7, 100, 3000, 100000 };
    double want[3], got[3];
    integral(want);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        load("AreaLightSource \"diffuse\" \"string filename\" \"a.pfm\" \"float scale\" 2 " QUAD, numbers[i]);
        size_t n = numbers[i] < 2 ? 2 : numbers[i];
        CHECKF(scene->n_lights + 2 >= n && scene->n_lights <= n + 1, "%zu of %u", scene->n_lights,
               numbers[i]);
        sum_of_lights(got);
        for (int c = 0; c < 3; c++)
            CHECKF(fabs(got[c] / (2 * want[c]) - 1) < 0.005, "%u: %g, not %g", numbers[i], got[c],
                   2 * want[c]);
        check_places();
    }
    for (int c = 0; c < 3; c++)
        printf("  100000 lights: sum of channel %d off by %.2g\n", c, got[c] / (2 * want[c]) - 1);
}

/* Each block of 8 x 8 texels gets the share of the lights that it has of the power, and its lights add up to
 * the colour of its texels. */
TEST(lights_lie_where_the_picture_is_bright)
{
    double all[3];
    const uint32_t n = 100000;
    float rgb[3];
    load("AreaLightSource \"diffuse\" \"string filename\" \"a.pfm\" " QUAD, n);
    integral(all);
    for (uint32_t block = 0; block < 32; block++) {
        uint32_t x0 = block % 8 * 8, y0 = block / 8 * 8, in = 0;
        double want[3] = { 0, 0, 0 }, got[3] = { 0, 0, 0 };
        for (uint32_t i = 0; i < 64; i++) {
            texel(x0 + i % 8, y0 + i / 8, rgb);
            for (int c = 0; c < 3; c++) want[c] += (double)rgb[c] / (W * H);
        }
        for (size_t i = 0; i < scene->n_lights; i++) {
            const lc_light *l = &scene->lights[i];
            double x = (double)l->pos.x / 2 * W, y = (1 - (double)l->pos.y / 0.5) * H;
            if (x < x0 || x >= x0 + 8 || y < y0 || y >= y0 + 8) continue;
            got[0] += (double)l->intensity.x;
            got[1] += (double)l->intensity.y;
            got[2] += (double)l->intensity.z;
            in++;
        }
        double share = (want[0] + want[1] + want[2]) / (all[0] + all[1] + all[2]);
        /* Bilinear interpolation moves the light of half a texel over the edge of a block of eight. */
        double edge = 0.12 * (all[0] + all[1] + all[2]) / 32 + 0.12 * (want[0] + want[1] + want[2]);
        CHECKF(fabs(in - share * n) < 0.12 * (n / 32.0 + share * n), "block %u: %u, not %g", block, in,
               share * n);
        for (int c = 0; c < 3; c++)
            CHECKF(fabs(got[c] - want[c]) < edge, "block %u: %g, not %g", block, got[c], want[c]);
    }
}

/* Two spheres of 16,000 triangles each: the number of lights is about the wanted one, at least one a sphere,
 * and their sum is always the whole power. */
TEST(small_triangles_share_lights)
{
    static const char spheres[] =
        "AreaLightSource \"diffuse\" \"rgb L\" [1 2 3] Shape \"sphere\" Translate 3 0 0 "
        "AreaLightSource \"diffuse\" \"rgb L\" [3 0 1] \"bool twosided\" true Shape \"sphere\"";
    static const uint32_t numbers[] = { 1, 10, 1000, 20000, 100000 };
    static const double want[] = { 7, 2, 5 }; /* times the area of a sphere */
    double got[3];
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        load(spheres, numbers[i]);
        /* A two-sided triangle with an odd share of the lights gets one light less. */
        CHECKF((double)scene->n_lights + 2 >= numbers[i] * 0.9 && scene->n_lights <= numbers[i] + 3,
               "%zu of %u", scene->n_lights, numbers[i]);
        CHECK(scene->n_emissive_tris == scene->n_tris);
        sum_of_lights(got);
        for (int c = 0; c < 3; c++)
            CHECKF(fabs(got[c] / (4 * LC_PI * want[c]) - 1) < 1e-5, "%u: %g, not %g", numbers[i], got[c],
                   4 * LC_PI * want[c]);
        check_places();
    }
    /* Lights lie evenly on the first sphere and face outwards. */
    uint32_t octant[8] = { 0 };
    load(spheres, 4000);
    for (size_t i = 0; i < scene->n_lights; i++) {
        const lc_light *l = &scene->lights[i];
        if ((double)l->pos.x > 1.5) continue;
        CHECK((double)lc_f3_dot(l->pos, l->dir) > 0.99);
        octant[(l->pos.x > 0) + 2 * (l->pos.y > 0) + 4 * (l->pos.z > 0)]++;
    }
    uint32_t all = 0;
    for (int i = 0; i < 8; i++) all += octant[i];
    for (int i = 0; i < 8; i++)
        CHECKF(fabs(octant[i] * 8.0 / all - 1) < 0.1, "octant %d: %u of %u", i, octant[i], all);
}

/* Half of the lights are shared out by power, half evenly among the lamps. */
TEST(weak_lamps_have_lights_too)
{
    uint32_t n = 0;
    load("AreaLightSource \"diffuse\" \"rgb L\" [999 999 999] " QUAD
         " Translate 9 0 0 AreaLightSource \"diffuse\" " QUAD,
         1000);
    for (size_t i = 0; i < scene->n_lights; i++) n += (double)scene->lights[i].pos.x > 4;
    CHECKF(n >= 248 && n <= 252, "%u", n);
}

TEST(both_sides)
{
    double one[3], two[3];
    load("AreaLightSource \"diffuse\" \"string filename\" \"a.pfm\" " QUAD, 1000);
    sum_of_lights(one);
    for (size_t i = 0; i < scene->n_lights; i++) CHECK(scene->lights[i].dir.z > 0);
    load("AreaLightSource \"diffuse\" \"string filename\" \"a.pfm\" \"bool twosided\" true " QUAD, 1000);
    sum_of_lights(two);
    double front = 0;
    for (size_t i = 0; i < scene->n_lights; i++)
        front += scene->lights[i].dir.z > 0 ? (double)scene->lights[i].intensity.z : 0;
    CHECK(scene->n_lights >= 998 && scene->n_lights <= 1001);
    CHECK(fabs(front - one[2]) < 1e-3 * one[2]);
    for (int c = 0; c < 3; c++) CHECKF(fabs(two[c] - 2 * one[c]) < 1e-3 * two[c], "%g %g", two[c], one[c]);
    check_places();
}

static double luminous(void)
{
    double sum[3];
    sum_of_lights(sum);
    return LC_PI * (0.2126 * sum[0] + 0.7152 * sum[1] + 0.0722 * sum[2]);
}

/* "power" is the power of each shape; in pbrt each triangle of a mesh is a shape. */
TEST(power_is_of_each_shape)
{
    load("AreaLightSource \"diffuse\" \"float power\" 50 Shape \"sphere\" \"float radius\" 3", 100);
    CHECKF(fabs(luminous() - 50) < 0.01, "%g", luminous());
    load("AreaLightSource \"diffuse\" \"float power\" 50 \"bool twosided\" true Shape \"disk\" \"float "
         "innerradius\" 0.3",
         100);
    CHECKF(fabs(luminous() - 50) < 0.01, "%g", luminous());
    load("AreaLightSource \"diffuse\" \"float power\" 50 " QUAD, 100);
    CHECKF(fabs(luminous() - 100) < 0.02, "%g", luminous());
    load("AreaLightSource \"diffuse\" \"float power\" 50 Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 "
         "3 0 1 3 0]",
         100);
    CHECKF(fabs(luminous() - 50) < 0.02, "%g", luminous());
    load("AreaLightSource \"diffuse\" \"float power\" 50 \"string filename\" \"a.pfm\" " QUAD, 10000);
    CHECKF(fabs(luminous() - 100) < 0.2, "%g", luminous());
}

/* How often a load noted something of a kind. */
static uint64_t noted(const char *kind) { return note(kind) ? note(kind)->count : 0; }

TEST(lamps_that_give_no_light_are_named)
{
    static const float black[2][2][3];
    pfm_write(temp_path("black.pfm"), 2, 2, black[0][0]);
    load("AreaLightSource \"diffuse\" " QUAD, 10);
    CHECK(!noted("area light without area") && !noted("black area light") && scene->n_lights);
    load("AreaLightSource \"diffuse\" \"rgb L\" [0 0 0] " QUAD, 10); /* as it is meant */
    CHECK(!noted("area light without area") && !noted("black area light") && !scene->n_lights);
    load("AreaLightSource \"diffuse\" \"string filename\" \"black.pfm\" " QUAD QUAD, 10);
    CHECK(!noted("area light without area") && noted("black area light") == 2 && !scene->n_lights);
    load("AreaLightSource \"diffuse\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 1 0 2 2 0 5 5 0] "
         "\"integer indices\" [0 1 2 1 2 3 3 3 3]", 10);
    CHECK(noted("area light without area") == 1 && !noted("black area light") && !scene->n_lights);
    load("AreaLightSource \"diffuse\" \"string filename\" \"a.pfm\" " QUAD, 10);
    CHECK(!noted("area light without area") && !noted("black area light") && scene->n_lights);
}

int main(void)
{
    ctx = quiet_context(0);
    temp_begin();
    write_picture();
    RUN(lamps_that_give_no_light_are_named);
    RUN(pictures_keep_their_power);
    RUN(lights_lie_where_the_picture_is_bright);
    RUN(small_triangles_share_lights);
    RUN(weak_lamps_have_lights_too);
    RUN(both_sides);
    RUN(power_is_of_each_shape);
    one_scene_end();
    temp_end();
    return test_done();
}
