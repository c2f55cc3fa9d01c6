/* unit_lamps.c - lights made from lamps where no number is asked for: their flux, that no light stands for
 * much of what a visible point gets, a panel seen from close by against its closed form; the same lights for
 * any number of threads. */
#include "base/rng.h"
#include "prepare/emitter.h"
#include "prepare/lamp_lights.h"
#include "shade/light_target.h"
#include "shade/point_init.h"
#include "support/one_scene.h"
#include "support/pictures.h"

#define RND_KEY 727
#include "support/rnd.h"

static lc_load_desc direct = LC_LOAD_DESC_INIT;

#define VIEW                                                                                                 \
    "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 40 LookAt 0 2 -6  0 0 0  0 1 0 "        \
    "Camera \"perspective\" \"float fov\" 50 Sampler \"independent\" \"integer pixelsamples\" 1 "            \
    "WorldBegin "
#define FLOOR                                                                                                \
    "Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5] Shape \"trianglemesh\" "                            \
    "\"point3 P\" [-3 0 -3 3 0 -3 3 0 3 -3 0 3] \"integer indices\" [0 2 1 0 3 2] "
#define LAMP(L, at, side)                                                                                    \
    "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [" L "] Translate " at " Scale " side " 1 " side   \
    " Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 0 1 0 0 1] \"integer indices\" [0 1 2 0 2 3] "      \
    "AttributeEnd "

TEST(flux_is_exact)
{
    double got[3];
    CHECK(load_text(&direct, VIEW FLOOR LAMP("1 2 3", "0 1 0", "2") LAMP("5 0 0", "0 .02 0", ".1")) == LC_OK);
    sum_of_lights(got);
    const double want[3] = { 4 + 0.05, 8, 12 };
    for (int c = 0; c < 3; c++) CHECKF(fabs(got[c] / want[c] - 1) < 1e-5, "%g, not %g", got[c], want[c]);
    CHECK(scene->n_emissive_tris == 4);
    for (size_t i = 0; i < scene->n_lights; i++) CHECK(scene->lights[i].dir.y < -0.999f);
}

/* Lights are off their lamp, the more the larger its coordinates; they are its own all the same. */
TEST(lamps_know_their_lights)
{
    static const char *const at[] = { "0 1 0", ".9 40 .9" };
    for (int i = 0; i < 2; i++) {
        char text[4096];
        snprintf(text, sizeof text, VIEW FLOOR LAMP("9 9 9", "%s", ".05"), at[i]);
        CHECK(load_text(&direct, text) == LC_OK && scene->lamps.n == 1 && scene->n_lights > 0);
        const double spacing = (double)scene->lamps.lamp[0].spacing, n = (double)scene->n_lights;
        CHECKF(fabs(spacing / sqrt(0.05 * 0.05 / n) - 1) < 1e-3, "%g apart, %g lights", spacing, n);
    }
}

/* Double precision, from the formula: what a light of the floor's reflectance gives at a point above y = 0.
 */
static double given(const lc_light *l, const double x[3])
{
    const double d[3] = { (double)l->pos.x - x[0], (double)l->pos.y - x[1], (double)l->pos.z - x[2] };
    double d2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    double down = -(d[0] * (double)l->dir.x + d[1] * (double)l->dir.y + d[2] * (double)l->dir.z);
    return d[1] > 0 && down > 0 ? d[1] * down / (d2 * d2) * (double)l->intensity.y : 0;
}

/* Points of the floor that no light hides from another; half of them next to the small lamp. */
TEST(no_light_stands_for_much)
{
    CHECK(load_text(&direct, VIEW FLOOR LAMP("1 1 1", "-1 1 -1", "1") LAMP("9 9 9", ".5 .05 .5", ".05")) ==
          LC_OK);
    double most = 0;
    for (uint64_t i = 0; i < 400; i++) {
        double size = i & 1 ? 2 : 0.1, mid = i & 1 ? 0 : 0.525, sum = 0, largest = 0;
        const double x[3] = { mid + size * (lc_unit(lc_hash2(i, 0)) - 0.5), 0,
                              mid + size * (lc_unit(lc_hash2(i, 1)) - 0.5) };
        for (size_t k = 0; k < scene->n_lights; k++) {
            double f = given(&scene->lights[k], x);
            sum += f;
            largest = fmax(largest, f);
        }
        most = fmax(most, largest / sum);
    }
    printf("  %zu lights, greatest share %.4f\n", scene->n_lights, most);
    CHECKF(most <= 4 * LC_LAMP_SHARE, "%g", most); /* points between those that were looked at */
    CHECK(scene->n_lights <= LC_LAMP_LIGHTS + 4);
}

#define MANY 160 /* a side */

/* MANY * MANY lamps of two sides just above the floor. */
static char *many_lamps(void)
{
    enum { CORNER = 30 };
    char *text = malloc((size_t)MANY * MANY * (4 * CORNER + 6 * 8) + 256), *at = text;
    if (!text) abort();
    at += sprintf(at, "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"bool twosided\" true "
                      "Shape \"trianglemesh\" \"point3 P\" [");
    for (int i = 0; i < MANY * MANY; i++)
        for (int k = 0; k < 4; k++)
            at += sprintf(at, "%.4f .006 %.4f ", (i % MANY + (k == 1 || k == 2) * 0.3) * 6 / MANY - 3,
                          (i / MANY + k / 2 * 0.3) * 6 / MANY - 3);
    at += sprintf(at, "] \"integer indices\" [");
    for (int i = 0; i < 4 * MANY * MANY; i += 4)
        at += sprintf(at, "%d %d %d %d %d %d ", i, i + 1, i + 2, i, i + 2, i + 3);
    sprintf(at, "]");
    return text;
}

/* More lamps than there is room to divide, each of which stands for most of the light of a spot next to it:
 * one that lights all of the picture is divided all the same. */
TEST(spots_do_not_starve_the_picture)
{
    uint32_t high = 0;
    char *many = many_lamps();
    CHECK(load_text(&direct, VIEW FLOOR LAMP("9 9 9", "-1 2 -1", "2") "%s", many) == LC_OK);
    free(many);
    for (size_t i = 0; i < scene->n_lights; i++) high += scene->lights[i].pos.y > 1;
    printf("  %u of %zu lights in the large lamp; stated %.5f, %.5f by %u points\n", high, scene->n_lights,
           scene->lamp_error.median, scene->lamp_error.high, scene->lamp_error.n_points);
    CHECKF(high >= 500, "%u", high);
    CHECK(scene->n_lights <= LC_LAMP_LIGHTS + 4 * MANY * MANY + 2);
}

/* What is far away, or behind, has a light for each triangle and no more. */
TEST(lights_are_where_they_matter)
{
    uint32_t near = 0, far = 0;
    CHECK(load_text(&direct, VIEW FLOOR LAMP("1 1 1", "0 .05 0", ".1") LAMP("1 1 1", "900 50 0", ".1")) ==
          LC_OK);
    for (size_t i = 0; i < scene->n_lights; i++) {
        near += scene->lights[i].pos.x < 9;
        far += scene->lights[i].pos.x > 9;
    }
    CHECKF(near > 500 && far == 2, "%u, %u", near, far);
    /* nothing is seen */
    CHECK(load_text(&direct,
                    "Film \"rgb\" LookAt 0 9 0  0 99 0  1 0 0 Camera \"perspective\" WorldBegin " FLOOR LAMP(
                        "1 1 1", "0 1 0", "1")) == LC_OK);
    CHECK(scene->n_lights == 2);
}

/* Radiance of a white floor below a panel of radiance 1, at (x, z): the form factor of a parallel rectangle,
 * four corners of [Lambert]'s contour integral. */
static double below_panel(double x, double z, double h)
{
    double sum = 0;
    for (int i = 0; i < 4; i++) {
        double a = 0.5 + (i & 1 ? x : -x), b = 0.5 + (i & 2 ? z : -z);
        double ra = sqrt(h * h + a * a), rb = sqrt(h * h + b * b);
        sum += (a / ra * atan(b / ra) + b / rb * atan(a / rb)) / (2 * LC_PI);
    }
    return sum;
}

static int rising(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* What the scene says of its own lights is about what n pixels are off by. */
static void check_lamp_error(double *off, size_t n)
{
    const lc_lamp_error *e = &scene->lamp_error;
    qsort(off, n, sizeof *off, rising);
    const double median = off[n / 2], high = off[n * 95 / 100];
    printf("  off by %.5f, %.5f; stated %.5f, %.5f by %u points\n", median, high, e->median, e->high,
           e->n_points);
    CHECK(e->n_points >= 24);
    CHECK(e->median > median / 3 && e->median < median * 3 && e->high > high / 3 && e->high < high * 3);
}

TEST(panel_from_close_by)
{
    static double offs[24 * 24];
    lc_render_desc rd = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    double rms = 0;
    CHECK(load_text(&direct,
                    "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 24 "
                    "LookAt 0 .015 0  0 0 0  0 0 1 Camera \"orthographic\" \"float screenwindow\" "
                    "[-.3 .3 -.3 .3] PixelFilter \"box\" Sampler \"stratified\" \"integer xsamples\" 1 "
                    "\"integer ysamples\" 1 \"bool jitter\" false WorldBegin "
                    "Material \"diffuse\" \"rgb reflectance\" [1 1 1] Shape \"trianglemesh\" "
                    "\"point3 P\" [-3 0 -3 3 0 -3 3 0 3 -3 0 3] \"integer indices\" [0 2 1 0 3 2] " LAMP(
                        "1 1 1", "-.5 .03 -.5", "1")) == LC_OK);
    rd.method = LC_METHOD_EXACT;
    rd.spp = 1;
    CHECK(lc_render(ctx, scene, &rd, &image, NULL) == LC_OK);
    if (!image) return;
    const float *g = lc_image_channel(image, "G");
    for (int i = 0; i < 24 * 24; i++) {
        double x = (i % 24 + 0.5) / 24 * 0.6 - 0.3, z = (i / 24 + 0.5) / 24 * 0.6 - 0.3;
        double off = (double)g[i] / below_panel(x, z, 0.03) - 1;
        rms += off * off / (24 * 24);
        offs[i] = fabs(off);
    }
    printf("  %zu lights, rms %.4f\n", scene->n_lights, sqrt(rms));
    CHECKF(sqrt(rms) <= 0.005, "%g", sqrt(rms));
    check_lamp_error(offs, 24 * 24);
    lc_image_destroy(image);
}

/* A rough ceiling of 2 side * side emissive triangles, in view as the floor is. */
static lc_status load_ceiling(uint32_t side)
{
    static const char begin[] = VIEW FLOOR "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] Shape "
                                           "\"trianglemesh\" \"point3 P\" [";
    const size_t room = sizeof begin + 40 * (size_t)(side + 1) * (side + 1) + 48 * (size_t)side * side;
    char *text = malloc(room), *to = text;
    if (!text) return LC_ERR_MEMORY;
    to += sprintf(to, "%s", begin);
    for (uint32_t z = 0; z <= side; z++)
        for (uint32_t x = 0; x <= side; x++)
            to += sprintf(to, "%.5f %.5f %.5f ", 4.0 * x / side - 2, 1 + 0.2 * lc_unit(lc_hash2(x, z)),
                          4.0 * z / side - 2);
    to += sprintf(to, "] \"integer indices\" [");
    for (uint32_t z = 0; z < side; z++)
        for (uint32_t x = 0; x < side; x++) {
            const uint32_t a = z * (side + 1) + x, b = a + side + 1;
            to += sprintf(to, "%u %u %u %u %u %u ", a, a + 1, b, a + 1, b + 1, b);
        }
    sprintf(to, "]");
    const lc_status st = load_text(&direct, "%s", text);
    free(text);
    return st;
}

/* Of more than 2^18 patches a few are looked at, and about the same is said of them as of a few less, within
 * what check_lamp_error allows 24 points: if one of each four in a row were the first, that would be the same
 * part of each divided patch, and 5 times less would be said. */
TEST(very_many_lamps)
{
    CHECK(load_ceiling(240) == LC_OK && scene->n_lights < 1 << 18);
    const lc_lamp_error all = scene->lamp_error;
    CHECK(load_ceiling(270) == LC_OK && scene->n_lights > 1 << 18);
    const lc_lamp_error few = scene->lamp_error;
    printf("  all: %g, %g; a few: %g, %g\n", all.median, all.high, few.median, few.high);
    CHECKF(few.median < 3 * all.median && few.median > all.median / 3, "%g, %g", all.median, few.median);
    CHECKF(few.high < 3 * all.high && few.high > all.high / 3, "%g, %g", all.high, few.high);
}

TEST(pictures_keep_their_sum)
{
    static float rgb[16 * 16 * 3];
    double got[3];
    for (size_t i = 0; i < 16 * 16; i++) rgb[3 * i + i % 3] = (float)(i % 16);
    pfm_write(temp_path("lamp.pfm"), 16, 16, rgb);
    CHECK(load_text(&direct,
                    VIEW FLOOR "AreaLightSource \"diffuse\" \"string filename\" \"lamp.pfm\" Shape "
                               "\"trianglemesh\" \"point3 P\" [0 1 0 1 1 0 1 1 1 0 1 1] \"point2 uv\" "
                               "[0 0 1 0 1 1 0 1] \"integer indices\" [0 1 2 0 2 3]") == LC_OK);
    sum_of_lights(got);
    CHECK(scene->n_lights >= 128);
    CHECK(!scene->lamp_error.n_points); /* nothing is said of textured lamps */
    for (size_t c = 0; c < 3; c++) {
        double want = 0;
        for (size_t i = 0; i < 16 * 16; i++) want += (double)rgb[3 * i + c] / (16 * 16);
        CHECKF(fabs(got[c] / want - 1) < 0.01, "%g, not %g", got[c], want);
    }
}

TEST(same_lights_for_any_threads)
{
    static const uint32_t threads[] = { 1, 2, 7 };
    static lc_light first[1 << 18];
    lc_context *own = ctx;
    size_t n = 0;
    for (int t = 0; t < 3; t++) {
        lc_scene_destroy(scene);
        scene = NULL;
        ctx = quiet_context_of(threads[t], t ? LC_ISA_BEST : LC_ISA_SCALAR);
        CHECK(load_text(&direct, VIEW FLOOR LAMP("1 1 1", "0 .1 0", ".3") LAMP("2 1 1", "-1 1 0", "1")) ==
              LC_OK);
        if (!t) {
            n = scene->n_lights;
            memcpy(first, scene->lights, n * sizeof *first);
        }
        CHECK(scene->n_lights == n && !memcmp(first, scene->lights, n * sizeof *first));
        lc_scene_destroy(scene);
        lc_context_destroy(ctx);
        scene = NULL;
    }
    ctx = own;
}

/* Those of several parts once. */
static uint32_t n_balls(void)
{
    uint32_t n = 0;
    for (size_t i = 0; i < scene->n_lights; i++)
        n += scene->lights[i].kind == LC_LIGHT_BALL && !scene->lights[i].part;
    return n;
}

/* The lights of a ball, all the parts of its disc, have its power; those that are seen small are few. */
TEST(balls_have_parts)
{
    static const char *const at[] = { "0 2 0", "0 10 0", "0 60 0" };
    static const size_t n[] = { 16, 4, 1 };
    for (int i = 0; i < 3; i++) {
        double sum = 0;
        uint64_t parts = 0;
        CHECK(load_text(&direct,
                        VIEW FLOOR "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [1 2 3] "
                                   "Translate %s Shape \"sphere\" \"float radius\" .1 AttributeEnd",
                        at[i]) == LC_OK);
        CHECKF(n_balls() == 1 && scene->n_lights == n[i], "at %s: %zu", at[i], scene->n_lights);
        for (size_t k = 0; k < scene->n_lights; k++) {
            sum += (double)scene->lights[k].intensity.y;
            parts |= 1ull << scene->lights[k].part;
            CHECK((size_t)1 << 2 * scene->lights[k].depth == n[i] && scene->lights[k].part < n[i]);
        }
        CHECKF(fabs(sum / (LC_PI * 0.01 * 2) - 1) < 1e-4, "%g", sum);
        CHECK(parts == (1ull << n[i]) - 1);
        /* to lobes it is as large as it is, not a 16th */
        CHECK(scene->lamps.n == 1 && (double)scene->lamps.lamp[0].spacing > 0.3);
    }
}

/* A small sphere is a ball; one that fills the view of what it lights is its triangles, and
 * so is what is no sphere: a part of one, one that shines inwards or both ways. */
TEST(spheres_are_balls)
{
    static const char *const others[] = { "Shape \"sphere\" \"float zmax\" .5",
                                          "ReverseOrientation Shape \"sphere\"",
                                          "Scale 1 2 1 Shape \"sphere\"" };
    const char lamp[] = "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [1 2 3] ";
    CHECK(load_text(&direct,
                    VIEW FLOOR "%s Translate 0 2 0 Shape \"sphere\" \"float radius\" .1 AttributeEnd",
                    lamp) == LC_OK);
    CHECK(n_balls() == 1);
    const lc_light *l = &scene->lights[0];
    CHECK(fabs((double)l->pos.y - 2) < 1e-6 && fabs((double)l->radius - 0.1) < 1e-6);
    CHECK(load_text(&direct, VIEW FLOOR "%s Translate 0 1.2 0 Shape \"sphere\" AttributeEnd", lamp) == LC_OK);
    CHECK(scene->n_lights > 1000 && n_balls() == 0);
    for (int i = 0; i < 3; i++) {
        CHECK(load_text(&direct, VIEW FLOOR "%s Translate 0 90 0 %s AttributeEnd", lamp, others[i]) == LC_OK);
        CHECKF(n_balls() == 0, "%s", others[i]);
    }
}

/* A ball that outshines a lamp leaves it fewer lights: its own surface does not hide it. */
TEST(balls_are_seen)
{
    CHECK(load_text(&direct, VIEW FLOOR LAMP("1 1 1", "-1 1 -1", "1")) == LC_OK);
    const size_t alone = scene->n_lights;
    CHECK(
        load_text(&direct,
                  VIEW FLOOR LAMP("1 1 1", "-1 1 -1",
                                  "1") "AttributeBegin AreaLightSource "
                                       "\"diffuse\" \"rgb L\" [500 500 500] Translate 1 2 0 Shape \"sphere\" "
                                       "\"float radius\" .1 AttributeEnd") == LC_OK);
    CHECKF(n_balls() == 1 && scene->n_lights < alone, "%zu, alone %zu", scene->n_lights, alone);
}

/* Of what a sphere gives a surface the part that comes from where side.(x - p) > 0, by a grid over the disc
 * of the cone that it fills: (w.n) / (w.e) of the direction w over each cell, e to its middle; with no n, in
 * a medium, 1 / (w.e). */
static double part_of_sphere(lc_f3 to, double radius, const lc_f3 *n, lc_f3 side)
{
    enum { CELLS = 200 };
    const double far = (double)lc_f3_len(to), sine = radius / far;
    const lc_f3 e = lc_f3_normalize(to), x = lc_sample_frame(e, 1, 0, 0), y = lc_f3_cross(e, x);
    double all = 0, seen = 0;
    for (int i = 0; i < CELLS * CELLS; i++) {
        const double u = (i % CELLS + 0.5) * 2 / CELLS - 1, v = (i / CELLS + 0.5) * 2 / CELLS - 1,
                     r2 = u * u + v * v;
        if (r2 > 1) continue;
        const double along = sqrt(1 - r2 * sine * sine), way = far * along - radius * sqrt(1 - r2);
        const lc_f3 s = lc_f3_add(lc_f3_scale(x, (float)(sine * u)), lc_f3_scale(y, (float)(sine * v))),
                    w = lc_f3_add(s, lc_f3_scale(e, (float)along));
        const double f = (n ? (double)lc_f3_dot(w, *n) : 1) / along;
        all += f;
        if (way * (double)lc_f3_dot(w, side) > 0) seen += f;
    }
    return seen / all;
}

/* The floor under a ball is what its closed form says, by cuts and by the exact method, and its shadow is as
 * soft as that of the sphere: each column of pixels is what a half plane leaves over. */
TEST(balls_are_exact_and_soft)
{
    static const lc_method methods[] = { LC_METHOD_EXACT, LC_METHOD_CUTS };
    for (int i = 0; i < 2; i++) {
        lc_render_desc rd = LC_RENDER_DESC_INIT;
        lc_image *image = NULL;
        double most = 0;
        CHECK(load_text(&direct,
                        "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64 "
                        "LookAt 0 .5 0  0 0 0  0 0 1 Camera \"orthographic\" \"float screenwindow\" "
                        "[-1 1 -1 1] WorldBegin Material \"diffuse\" \"rgb reflectance\" [1 1 1] "
                        "Shape \"trianglemesh\" \"point3 P\" [-3 0 -3 3 0 -3 3 0 3 -3 0 3] "
                        "\"integer indices\" [0 2 1 0 3 2] "
                        "Shape \"trianglemesh\" \"point3 P\" [-9 1 -9 0 1 -9 0 1 9 -9 1 9] "
                        "\"integer indices\" [0 1 2 0 2 3] AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] "
                        "Translate 0 2 0 Shape \"sphere\" \"float radius\" .5") == LC_OK);
        CHECK(n_balls() == 1);
        CHECKF(scene->lamp_error.median < 1e-6 && scene->lamp_error.high > 0.01, "%g, %g",
               scene->lamp_error.median, scene->lamp_error.high);
        rd.method = methods[i];
        rd.spp = 4;
        CHECK(lc_render(ctx, scene, &rd, &image, NULL) == LC_OK);
        if (!image) return;
        const float *g = lc_image_channel(image, "G");
        for (int x = 0; x < 64; x++) {
            double got = 0, want = 0;
            for (int z = 0; z < 64; z++) {
                const double px = (x + 0.5) / 32 - 1, pz = (z + 0.5) / 32 - 1, d2 = px * px + pz * pz + 4;
                const lc_f3 up = { 0, 1, 0 }, to = { (float)-px, 2, (float)-pz };
                const lc_f3 plane = lc_f3_normalize(lc_f3_make(1, (float)px, 0)); /* its edge at x 0, y 1 */
                got += (double)g[z * 64 + x] / 64;
                want += 0.25 * 2 / sqrt(d2) / d2 / 64 * (z % 8 ? 0 : 8 * part_of_sphere(to, 0.5, &up, plane));
            }
            most = fmax(most, fabs(got - want));
            CHECKF(fabs(got - want) < 0.0008, "column %d: %g, not %g", x, got, want);
        }
        printf("  at most %.2g off, of 0.06\n", most);
        lc_image_destroy(image);
    }
}

/* Shadow rays go to points that are seen, however near, and the part of them on one side of a plane is the
 * part of the light from there: of the sample numbers in a block, by one light or many parts of it. */
TEST(points_of_balls_are_seen)
{
    double most = 0;
    for (int i = 0; i < 300; i++) {
        enum { POINTS = 1024 };
        const double far = pow(10, rnd_in(i % 3 ? 0.15 : 0.004, i % 3 ? 1 : 3)), radius = rnd_in(0.01, 2);
        const lc_f3 centre = rnd_in_box(5), way = rnd_unit();
        const uint32_t depth = rnd_n(LC_BALL_DEPTH + 1), block = rnd_n(65536), medium = rnd_n(4) == 0;
        const lc_f3 to = lc_f3_scale(way, (float)(-far * radius));
        lc_light light = { .kind = LC_LIGHT_BALL, .pos = centre, .intensity = { 1, 1, 1 },
                           .radius = (float)radius };
        lc_point p = { .lobe = medium ? LC_LOBE_PHASE : LC_LOBE_NONE };
        double on_side = 0;
        lc_f3 n, across;
        do n = rnd_unit();
        while (!((double)lc_f3_dot(n, to) > radius));
        across = lc_sample_frame(way, rnd() - 0.5, rnd() - 0.5, 0);
        const lc_f3 side = lc_f3_add(across, lc_f3_scale(way, (float)rnd_in(-0.7, 0.7) / (float)far));
        lc_f3_store(p.pos, lc_f3_sub(centre, to));
        lc_f3_store(p.n, n);
        for (uint32_t k = 0; k < POINTS; k++) {
            lc_light_rec rec;
            float at[3];
            light.depth = depth;
            light.part = k & ((1u << 2 * depth) - 1);
            lc_light_rec_init(&rec, &light);
            p.turn = lc_turn(k >> 2 * depth, block);
            lc_ball_target(&rec, &p, at);
            const lc_f3 from = lc_f3_sub(lc_f3_load(at), centre);
            const double out = (double)lc_f3_dot(from, way) / radius;
            CHECKF(out > 1 / far - 1e-3 / far && out < 1.0001, "at %g radii: cosine %g", far, out);
            CHECK(fabs((double)lc_f3_len(from) / radius - 1) < 1e-4);
            on_side += (double)lc_f3_dot(lc_f3_sub(lc_f3_load(at), lc_f3_load(p.pos)), side) > 0;
        }
        if (i % 3 == 0) continue; /* rounding decides, or the horizon */
        const double got = on_side / POINTS, want = part_of_sphere(to, radius, medium ? NULL : &n, side);
        most = fmax(most, fabs(got - want));
        CHECKF(fabs(got - want) < 0.02, "at %g radii: %g on the side, not %g", far, got, want);
    }
    printf("  parts of the disc at most %.3f off\n", most);
}

/* The edge of the disc, however numbers are rounded there. */
TEST(edges_of_discs_are_numbers)
{
    for (int i = 0; i < 100000; i++) {
        const double u[2] = { LC_BALL_INSIDE * (1 - (i & 1) * 0x1p-32), (i / 2) / 50000.0 };
        double x, y;
        lc_target_disc(u, &x, &y);
        for (int k = 0; k < 4; k++) {
            const double at = lc_tilt_disc(x, y, k * k * k * 1e3);
            CHECKF(at * at + y * y < 1, "%g, %g: %g", x, y, at);
        }
    }
}

/* A ball near a floor does not hide itself: no pixel of the floor is darker than the closed form. */
TEST(balls_do_not_hide_themselves)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_load_desc l = direct;
    lc_image *image = NULL;
    l.spp = 1;
    CHECK(load_text(&l, "Film \"rgb\" \"integer xresolution\" 120 \"integer yresolution\" 120 "
                        "LookAt 0 8 0  0 0 0  0 0 1 "
                        "Camera \"orthographic\" \"float screenwindow\" [-4 4 -4 4] "
                        "PixelFilter \"box\" WorldBegin "
                        "Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5] "
                        "Shape \"trianglemesh\" \"point3 P\" [-9 0 -9 9 0 -9 9 0 9 -9 0 9] "
                        "\"integer indices\" [0 2 1 0 3 2] AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] "
                        "Translate 0 1.5 0 Shape \"sphere\" \"float radius\" .4") == LC_OK);
    d.method = LC_METHOD_EXACT;
    CHECK(n_balls() == 1 && !lc_render(ctx, scene, &d, &image, NULL));
    for (uint32_t y = 0; image && y < 120; y++)
        for (uint32_t x = 0; x < 120; x++) {
            const double u = -4 + (x + 0.5) / 15, v = -4 + (y + 0.5) / 15, d2 = u * u + v * v + 1.5 * 1.5,
                         want = 0.5 * 0.4 * 0.4 * 1.5 / (d2 * sqrt(d2)),
                         got = (double)lc_image_channel(image, "G")[y * 120 + x];
            if (u * u + v * v < 0.3) continue; /* the ball itself is seen there */
            CHECKF(fabs(got - want) < 0.02 * want, "%g, %g: %g, not %g", u, v, got, want);
        }
    lc_image_destroy(image);
}

/* No area, no radiance: no light, and nothing else goes wrong. */
TEST(nothing_emits)
{
    CHECK(load_text(&direct,
                    VIEW FLOOR "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] Shape \"trianglemesh\" "
                               "\"point3 P\" [0 1 0 1 1 0 2 1 0] \"integer indices\" [0 1 2 0 0 0] "
                               "AreaLightSource \"diffuse\" \"rgb L\" [0 0 0] Shape \"trianglemesh\" "
                               "\"point3 P\" [0 1 0 1 1 0 1 1 1] \"integer indices\" [0 1 2]") == LC_OK);
    CHECK(scene->n_lights == 0);
}

int main(void)
{
    direct.indirect_lights = LC_NO_LIGHTS;
    ctx = quiet_context(2);
    RUN(flux_is_exact);
    RUN(lamps_know_their_lights);
    RUN(no_light_stands_for_much);
    RUN(spots_do_not_starve_the_picture);
    RUN(lights_are_where_they_matter);
    RUN(panel_from_close_by);
    RUN(very_many_lamps);
    RUN(pictures_keep_their_sum);
    RUN(same_lights_for_any_threads);
    RUN(balls_have_parts);
    RUN(spheres_are_balls);
    RUN(balls_are_seen);
    RUN(balls_are_exact_and_soft);
    RUN(points_of_balls_are_seen);
    RUN(edges_of_discs_are_numbers);
    RUN(balls_do_not_hide_themselves);
    RUN(nothing_emits);
    one_scene_end();
    return test_done();
}
