/* unit_indirect.c - the virtual lights of indirect illumination: their flux against closed forms for closed
 * rooms, walls, mirrors, glass and leaves; the radiance of a ball's wall; their radii against a loop over all
 * pairs; independence of threads and instruction set. */
#include "base/rng.h"
#include "prepare/vpl_radius.h"
#include "scene/scene.h"
#include "support/isas.h"
#include "support/near.h"
#include "support/one_scene.h"
#include "support/watched_memory.h"

static lc_scene *load_on(lc_context *where, uint32_t n_lights, uint32_t max_depth)
{
    lc_load_desc ld = LC_LOAD_DESC_INIT;
    ld.indirect_lights = n_lights;
    ld.max_depth = max_depth;
    ld.area_lights = 100;
    return scene_from_file(where, &ld, scene_path());
}

static lc_scene *load(uint32_t n_lights, uint32_t max_depth) { return load_on(ctx, n_lights, max_depth); }

/* Flux of the virtual lights that face along +axis or -axis, by sign, or of all for sign 0. Destroys the
 * scene. */
static double flux(lc_scene *s, int axis, float sign)
{
    double sum = 0;
    for (size_t i = s ? s->n_lights - s->indirect.n_lights : 0; s && i < s->n_lights; i++) {
        const lc_light *l = &s->lights[i];
        const float dir[3] = { l->dir.x, l->dir.y, l->dir.z };
        if (sign * dir[axis] >= 0) sum += (double)l->intensity.y * LC_PI;
    }
    lc_scene_destroy(s);
    return sum;
}

#define HEAD                                                                                                 \
    "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 24\nSampler \"independent\" \"integer " \
    "pixelsamples\" 1\n"                                                                                     \
    "Camera \"perspective\" \"float fov\" 60\nWorldBegin\n"
#define GREY(a) "Material \"diffuse\" \"rgb reflectance\" [" a " " a " " a "]\n"
/* A square, x and y from -s to s at depth z. */
#define WALL(s, z)                                                                                           \
    "Shape \"trianglemesh\" \"point3 P\" [-" s " -" s " " z " -" s " " s " " z " " s " " s " " z " " s       \
    " -" s " " z "]"                                                                                         \
    " \"integer indices\" [0 1 2 0 2 3]\n"
#define BALL(r) "Shape \"sphere\" \"float radius\" " r "\n"

/* In a closed room of albedo a the virtual lights of a light of flux F have F (a + a^2 + ...), one term for
 * each bounce. */
TEST(furnace)
{
    scene_write("%s", HEAD "LightSource \"point\" \"rgb I\" [1 1 1]\n" GREY(".5") BALL("3"));
    double sum = 0, term = 1;
    for (uint32_t depth = 2; depth < 6; depth++) {
        sum += term *= 0.5;
        double got = flux(load(20000, depth), 0, 0);
        CHECKF(near_rel(got, 4 * LC_PI * sum, 0.02), "depth %u: %g of %g", depth, got, 4 * LC_PI * sum);
    }
    CHECK(near_rel(flux(load(20000, 1000), 0, 0), 4 * LC_PI, 0.02));
    lc_scene *s = load(5000, 2);
    if (s) CHECK(s->indirect.n_lights == 5000 && s->indirect.n_paths == 5000); /* each path hits the wall */
    lc_scene_destroy(s);
    s = load(5000, 1);
    if (s) CHECK(s->indirect.n_lights == 0 && s->n_lights == 1);
    lc_scene_destroy(s);
}

/* The radiance of the wall inside a ball is E a / pi, with the irradiance E = F / (A (1 - a)), in which the
 * direct E0 = F / A is included. */
TEST(radiance_in_a_ball)
{
    const double a = 0.6, want = 4 * LC_PI / (4 * LC_PI * 9) / (1 - a) * a / LC_PI;
    lc_render_desc rd = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    scene_write("%s", HEAD "LightSource \"point\" \"rgb I\" [1 1 1]\n" GREY(".6") BALL("3"));
    lc_scene *s = load(30000, 100);
    lc_status st = s ? lc_render(ctx, s, &rd, &image, NULL) : LC_ERR_ARG;
    double sum = 0;
    for (int i = 0; !st && i < 24 * 24; i++) sum += (double)lc_image_channel(image, "G")[i] / (24 * 24);
    CHECKF(near_rel(sum, want, 0.02), "%g of %g", sum, want);
    if (s) CHECKF(s->indirect.loss > 0 && s->indirect.loss < 0.02, "loss %g", s->indirect.loss);
    lc_image_destroy(image);
    lc_scene_destroy(s);
}

/* The flux after one reflection is albedo times the flux of each kind of light on a plate or in a room. */
TEST(kinds_of_light)
{
    scene_write(
        "%s", HEAD
        "LightSource \"distant\" \"point3 from\" [3 0 -4] \"point3 to\" [0 0 0] \"rgb L\" [2 2 2]\n" GREY(
            ".5") WALL("1", "4") "Translate 0 0 1 " GREY("0") BALL(".1"));
    double got = flux(load(40000, 2), 0, 0);
    CHECKF(near_rel(got, 0.5 * 2 * 4 * 0.8, 0.01), "%g", got);
    scene_write("%s", HEAD "LightSource \"infinite\" \"rgb L\" [1 1 1]\n" GREY(".5") WALL("1", "4"));
    CHECK(near_rel(flux(load(4000, 2), 0, 0), 2 * LC_PI * 4 * 0.5, 0.03));
    scene_write("%s", HEAD GREY(".5") BALL("3") "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1]\n" GREY("0")
                          WALL(".5", "1"));
    CHECK(near_rel(flux(load(4000, 2), 0, 0), LC_PI * 0.5, 0.02));
    scene_write("%s", HEAD "LightSource \"oriented\" \"vector3 direction\" [0 0 1] \"rgb I\" [1 1 1]\n" GREY(
                          ".5") WALL("1000", "1"));
    CHECK(near_rel(flux(load(4000, 2), 0, 0), LC_PI * 0.5, 0.01));
    /* A square receives a sixth of a point light's flux from a distance of half its side: a face of a cube.
     */
    scene_write("%s", HEAD "LightSource \"point\" \"rgb I\" [1 1 1]\n" GREY(".5") WALL("1", "1"));
    CHECK(near_rel(flux(load(4000, 2), 0, 0), 4 * LC_PI / 6 * 0.5, 0.02));
    /* Two lights share the paths by their power; the sum of the flux is the same. */
    scene_write("%s", HEAD
                "LightSource \"point\" \"rgb I\" [1 1 1]\nLightSource \"point\" \"rgb I\" [9 9 9]\n" GREY(
                    ".5") BALL("3"));
    CHECK(near_rel(flux(load(4000, 2), 0, 0), 40 * LC_PI * 0.5, 0.02));
}

/* With attenuation 1 / d a wall at distance 3 receives three times as much as with 1 / d^2. */
TEST(attenuation)
{
    scene_write("%s", HEAD "LightSource \"point\" \"rgb I\" [1 1 1] \"float B\" 1 \"float C\" 0\n" GREY(".5")
                          BALL("3"));
    CHECK(near_rel(flux(load(4000, 2), 0, 0), 3 * 4 * LC_PI * 0.5, 0.02));
}

TEST(mirrors_glass_and_leaves)
{
    /* Half of the flux hits a mirror, which reflects half of that to the wall. The mirror's own lights are in
     * tests/unit_reflected_light.c. */
    scene_write(
        "%s", HEAD
        "LightSource \"point\" \"rgb I\" [1 1 1]\nMaterial \"mirror\" \"rgb reflectance\" [.5 .5 .5]\n" WALL(
            "1000", "-1") GREY(".5") WALL("1000", "1"));
    CHECK(near_rel(flux(load(4000, 2), 2, -1), LC_PI, 0.02)); /* reflection by the mirror is a bounce */
    CHECK(near_rel(flux(load(4000, 3), 2, -1), LC_PI * 1.5, 0.02));
    /* Clear glass absorbs nothing, whatever path the light takes. */
    scene_write("%s", HEAD "LightSource \"point\" \"rgb I\" [1 1 1]\n" GREY(".5")
                          BALL("3") "Material \"dielectric\"\n" BALL("1"));
    CHECK(near_rel(flux(load(4000, 3), 0, 0), 4 * LC_PI * 0.96 * 0.5, 0.03));
    scene_write("%s", HEAD "LightSource \"oriented\" \"vector3 direction\" [0 0 1] \"rgb I\" [1 1 1]\n"
                           "Material \"diffusetransmission\" \"rgb reflectance\" [.4 .4 .4] \"rgb "
                           "transmittance\" [.2 .2 .2]\n" WALL("1000", "1"));
    /* The lights behind the leaf are kept by chance, as they illuminate nothing that the camera sees: their
     * sum has more noise. */
    CHECK(near_rel(flux(load(40000, 2), 2, -1), LC_PI * 0.4, 0.01) &&
          near_rel(flux(load(40000, 2), 2, 1), LC_PI * 0.2, 0.05));
    scene_write("%s",
                HEAD "LightSource \"oriented\" \"vector3 direction\" [0 0 1] \"rgb I\" [1 1 1]\n"
                     "Material \"diffusetransmission\" \"rgb reflectance\" [.4 .4 .4] \"rgb transmittance\" "
                     "[.2 .2 .2]\n" WALL("1000", "1") GREY(".5") WALL("1000", "2") WALL("1000", "-1"));
    CHECK(near_rel(flux(load(8000, 3), 0, 0), LC_PI * (0.6 + 0.5 * 0.6), 0.02));
}

/* The lights do not depend on the number of threads and on the instruction set. */
TEST(same_everywhere)
{
    scene_write("%s", HEAD "LightSource \"infinite\" \"rgb L\" [1 2 1]\n" GREY(".7") WALL("4", "3")
                          WALL("4", "-3") "Material \"dielectric\"\n" BALL("1")
                              GREY(".2") "Translate 1 1 1 " BALL("1"));
    lc_scene *a = load(3000, 8);
    EACH_ISA(isa) {
        lc_context *other = quiet_context_of((uint32_t)isa * 2 - 1, isa);
        lc_scene *b = load_on(other, 3000, 8);
        bool same = a && b && a->n_lights == b->n_lights && a->indirect.n_paths == b->indirect.n_paths;
        CHECK(same && !(a->indirect.loss < b->indirect.loss) && !(a->indirect.loss > b->indirect.loss));
        for (size_t i = 0; same && i < a->n_lights; i++) {
            const lc_light *x = &a->lights[i], *y = &b->lights[i];
            CHECK(!memcmp(&x->pos, &y->pos, sizeof x->pos) && !memcmp(&x->dir, &y->dir, sizeof x->dir) &&
                  !memcmp(&x->intensity, &y->intensity, sizeof x->intensity) &&
                  !memcmp(x->atten, y->atten, sizeof x->atten));
        }
        lc_scene_destroy(b);
        lc_context_destroy(other);
    }
    lc_scene_destroy(a);
}

static int rising(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Squared distances to the nearest light of each other path that faces the same way, by rising distance,
 * found in a loop over all lights; their number. */
static size_t distances(const lc_light *l, const uint32_t *path, size_t n, size_t i, float *d2)
{
    size_t m = 0;
    for (size_t k = 0, end; k < n; k = end) {
        float least = INFINITY;
        for (end = k; end < n && path[end] == path[k]; end++) {
            const lc_f3 d = lc_f3_sub(l[end].pos, l[i].pos);
            if (path[k] != path[i] && lc_f3_dot(l[i].dir, l[end].dir) > LC_SAME_WAY)
                least = fminf(least, d.x * d.x + d.y * d.y + d.z * d.z);
        }
        if (least < INFINITY) d2[m++] = least;
    }
    qsort(d2, m, sizeof *d2, rising);
    return m;
}

/* Attenuation A is the squared radius: a part of an eighth of the squared distance to the eighth nearest
 * path's light that faces the same way, all of them where there are fewer. */
TEST(radii)
{
    static const lc_f3 ways[3] = { { 0, 0, 1 }, { 0, 0.6f, 0.8f }, { 0, 0, -1 } };
    static lc_light l[700];
    static float d2[700];
    static uint32_t path[700];
    lc_light_places places;
    for (size_t n = 1; n <= 700; n = n * 3 / 2 + 1) {
        for (size_t i = 0; i < n; i++) {
            float u[3];
            for (size_t k = 0; k < 3; k++) u[k] = (float)lc_unit(lc_hash4(3, n, i, k));
            l[i] = (lc_light){ .pos = { u[0], u[1] * u[1] * u[1] * u[1] * u[1] * u[1], i % 7 ? 0 : u[2] },
                               .dir = ways[lc_hash4(3, n, i, 3) % 3],
                               .atten = { 0, 0, 1 } };
            path[i] = (uint32_t)(i ? path[i - 1] + lc_hash4(3, n, i, 4) % 2 : 5);
        }
        if (n > 30) l[n - 1] = l[n - 2]; /* two in one place */
        CHECK(lc_vpl_radii(ctx, l, path, n, &places) == LC_OK);
        lc_light_places_free(&places, ctx);
        for (size_t i = 0; i < n; i++) {
            size_t m = distances(l, path, n, i, d2);
            if (m > LC_VPL_NEIGHBOURS) m = LC_VPL_NEIGHBOURS;
            const double is = (double)l[i].atten[0];
            const double want = m ? (double)(LC_VPL_DISC * d2[m - 1] / (float)m) : 0;
            CHECKF(near_rel(is, want, 1e-5), "%zu of %zu: %g, %g", i, n, is, want);
        }
    }
}

TEST(defaults)
{
    static const struct {
        const char *integrator;
        uint32_t n, depth, want;
    } cases[] = { { "path", 0, 0, 16384 },        { "volpath", 0, 0, 16384 }, { "path", 0, 1, 0 },
                  { "path", LC_NO_LIGHTS, 0, 0 }, { "path", 70, 0, 70 },      { "directlighting", 0, 0, 0 },
                  { "whitted", 0, 0, 0 },         { "whitted", 80, 0, 80 } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        scene_write("Integrator \"%s\"\n%s", cases[i].integrator,
                    HEAD "LightSource \"point\" \"rgb I\" [1 1 1]\n" GREY(".5") BALL("3"));
        lc_scene *s = load(cases[i].n, cases[i].depth);
        if (s)
            CHECKF(s->indirect.n_lights >= cases[i].want && s->indirect.n_lights <= cases[i].want + 4,
                   "case %zu: %llu", i, (unsigned long long)s->indirect.n_lights);
        lc_scene_destroy(s);
    }
    scene_write("%s", HEAD GREY(".5") BALL("3")); /* no light */
    CHECK(flux(load(1000, 5), 0, 0) <= 0);
    scene_write("%s", HEAD "LightSource \"distant\" \"rgb L\" [1 1 1]\n"); /* no surface */
    CHECK(flux(load(1000, 5), 0, 0) <= 0);
    scene_write("%s", HEAD "LightSource \"point\" \"rgb I\" [1 1 1]\n" GREY("0") BALL("3")); /* black */
    CHECK(flux(load(1000, 5), 0, 0) <= 0);
}

/* A room with a box in it, below one light. */
static void write_room(const char *camera)
{
    scene_write("Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\nSampler \"independent\" "
                "\"integer pixelsamples\" 1\n%s Camera \"perspective\" \"float fov\" 60\nWorldBegin\n"
                "LightSource \"point\" \"point3 from\" [0 1.2 3] \"rgb I\" [1 1 1]\n" GREY(".7") BALL("6")
                    GREY(".5") "Translate 0 -.4 3\n" BALL(".7"),
                camera);
}

static lc_scene *load_seed(uint32_t n_lights, uint64_t seed, double error)
{
    lc_load_desc ld = LC_LOAD_DESC_INIT;
    ld.indirect_lights = n_lights;
    ld.indirect_error = error;
    ld.seed = seed;
    return scene_from_file(ctx, &ld, scene_path());
}

/* Luminances of the 64 blocks of the picture by all lights. */
static void blocks_of(lc_scene *s, double block[64])
{
    lc_render_desc rd = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    rd.method = LC_METHOD_EXACT;
    memset(block, 0, 64 * sizeof *block);
    CHECK(s && lc_render(ctx, s, &rd, &image, NULL) == LC_OK);
    for (uint32_t i = 0; image && i < 64 * 64; i++)
        block[i / 512 * 8 + i % 64 / 8] += (double)lc_image_channel(image, "G")[i] / 64;
    lc_image_destroy(image);
}

static int rising_double(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* What the picture says of its indirect light is how far pictures with other seeds are from their mean. Paths
 * are spread more evenly than by chance, which the statement leaves out. */
TEST(stated_deviation)
{
    enum { SEEDS = 8 };
    static double block[SEEDS][64], off[SEEDS * 64];
    double median = 0, high = 0;
    write_room("");
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        lc_scene *s = load_seed(600, seed + 1, 0);
        blocks_of(s, block[seed]);
        if (!s) return;
        median += s->indirect.median / SEEDS;
        high += s->indirect.high / SEEDS;
        lc_scene_destroy(s);
    }
    for (int i = 0; i < 64; i++) {
        double mean = 0;
        for (int k = 0; k < SEEDS; k++) mean += block[k][i] / SEEDS;
        for (int k = 0; k < SEEDS; k++)
            off[k * 64 + i] = fabs(block[k][i] / mean - 1) * sqrt(SEEDS / (SEEDS - 1.0));
    }
    qsort(off, SEEDS * 64, sizeof *off, rising_double);
    const double is_median = off[SEEDS * 32], is_high = off[SEEDS * 64 * 95 / 100];
    CHECKF(median > 0.9 * is_median && median < 2 * is_median, "median: stated %g, is %g", median, is_median);
    CHECKF(high > 0.9 * is_high && high < 2 * is_high, "high: stated %g, is %g", high, is_high);
}

/* What is near is gathered by rays, so that clamping takes little, and as much for any seed. */
TEST(steady_loss)
{
    double least = 1, most = 0;
    scene_write("Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\n"
                "Camera \"perspective\" \"float fov\" 70\nWorldBegin\n"
                "LightSource \"point\" \"point3 from\" [.3 .6 2] \"rgb I\" [1 1 1]\n" GREY(".7")
                "Shape \"trianglemesh\" \"point3 P\" [-1 -1 -1 1 -1 -1 1 1 -1 -1 1 -1 "
                "-1 -1 3 1 -1 3 1 1 3 -1 1 3]\n\"integer indices\" [0 1 5 0 5 4 1 2 6 1 6 5 2 3 7 2 7 6 3 0 "
                "4 3 4 7 4 5 6 4 6 7 0 2 1 0 3 2]\n");
    for (uint64_t seed = 1; seed <= 8; seed++) {
        lc_scene *s = load_seed(4000, seed, 0);
        if (!s) return;
        least = fmin(least, s->indirect.loss);
        most = fmax(most, s->indirect.loss);
        lc_scene_destroy(s);
    }
    printf("    %.5f to %.5f\n", least, most);
    CHECKF(least > 0 && most < 1.5 * least && most < 0.01, "clamping loses %g to %g", least, most);
}

/* There are as many lights as the asked error takes, unless a number is given. */
TEST(asked_error)
{
    write_room("");
    lc_scene *few = load_seed(0, 1, 0.02), *many = load_seed(0, 1, 0.0012), *given = load_seed(500, 1, 0.02);
    if (few && many && given) {
        CHECKF(few->indirect.n_lights < many->indirect.n_lights, "%llu lights off by %g, %llu by %g",
               (unsigned long long)few->indirect.n_lights, lc_indirect_deviation(&few->indirect),
               (unsigned long long)many->indirect.n_lights, lc_indirect_deviation(&many->indirect));
        const double off = lc_indirect_deviation(&many->indirect);
        CHECKF(off <= 0.0012, "%g", off);
        CHECK(lc_indirect_deviation(&given->indirect) > lc_indirect_deviation(&few->indirect));
        CHECK(given->indirect.n_lights >= 500 && given->indirect.n_lights < 504);
    }
    lc_scene_destroy(few);
    lc_scene_destroy(many);
    lc_scene_destroy(given);
}

static bool same_lights(const lc_scene *a, const lc_scene *b)
{
    bool same = a && b && a->n_lights == b->n_lights;
    for (size_t i = 0; same && i < a->n_lights; i++)
        same = !memcmp(&a->lights[i].pos, &b->lights[i].pos, sizeof a->lights[i].pos) &&
               !memcmp(&a->lights[i].intensity, &b->lights[i].intensity, sizeof a->lights[i].intensity);
    return same;
}

/* Virtual lights stay where they are when the camera turns, whatever the lights of lamps and sky do; but for
 * LC_INDIRECT_FROM_VIEW. */
TEST(same_for_all_cameras)
{
    static const char *const camera[2] = { "", "Rotate 40 0 1 0\n" };
    for (int from = LC_INDIRECT_FROM_SCENE; from <= LC_INDIRECT_FROM_VIEW; from++) {
        lc_load_desc ld = LC_LOAD_DESC_INIT;
        lc_scene *s[2];
        ld.indirect_lights = 3000;
        ld.indirect_from = (lc_indirect_from)from;
        for (int k = 0; k < 2; k++) {
            write_room(camera[k]);
            s[k] = scene_from_file(ctx, &ld, scene_path());
        }
        CHECK(same_lights(s[0], s[1]) == (from == LC_INDIRECT_FROM_SCENE));
        lc_scene_destroy(s[0]);
        lc_scene_destroy(s[1]);
    }
}

/* A glossy floor before a wall shows the light of the wall, not its virtual lights: the picture by few of
 * them is nowhere much brighter than that by many. */
TEST(no_dots_in_glossy_floors)
{
    static const char *const film = "Film \"rgb\" \"integer xresolution\" 48 \"integer yresolution\" 24\n"
                                    "Sampler \"independent\" \"integer pixelsamples\" 1\n";
    double most = 0, sum = 0;
    lc_render_desc rd = LC_RENDER_DESC_INIT;
    lc_image *few = NULL, *many = NULL;
    rd.method = LC_METHOD_EXACT;
    scene_write("%sLookAt 0 1 -3  0 0 0  0 1 0 Camera \"perspective\" \"float fov\" 35\nWorldBegin\n"
                "LightSource \"spot\" \"point3 from\" [0 2 -2] \"point3 to\" [0 .8 0] \"rgb I\" [9 9 9]\n"
                GREY(".5") WALL("2", "0.2")
                    "Material \"conductor\" \"float roughness\" .1 \"bool remaproughness\" false\n"
                    "Shape \"trianglemesh\" \"point3 P\" [-2 0 -4  2 0 -4  2 0 .2  -2 0 .2] "
                    "\"integer indices\" [0 2 1 0 3 2]\n",
                film);
    lc_scene *a = load_seed(1000, 3, 0), *b = load_seed(60000, 4, 0);
    CHECK(a && b && !lc_render(ctx, a, &rd, &few, NULL) && !lc_render(ctx, b, &rd, &many, NULL));
    for (uint32_t i = 48 * 14; few && many && i < 48 * 24; i++) { /* the floor */
        const double x = (double)lc_image_channel(few, "G")[i], y = (double)lc_image_channel(many, "G")[i];
        sum += y / (48 * 10);
        most = fmax(most, x - y);
    }
    CHECKF(sum > 0 && most < 0.3 * sum, "%g too bright, mean %g", most, sum);
    lc_image_destroy(few);
    lc_image_destroy(many);
    lc_scene_destroy(a);
    lc_scene_destroy(b);
}

static lc_status load_starved(lc_context *c)
{
    lc_load_desc desc = LC_LOAD_DESC_INIT;
    desc.indirect_lights = 100;
    return load_file_in(c, &desc, scene_path());
}

TEST(every_allocation_may_fail)
{
    scene_write("%s", HEAD "LightSource \"point\" \"rgb I\" [1 1 1]\n" GREY(".5") WALL("3", "1"));
    starve(load_starved, 20);
}

int main(void)
{
    ctx = quiet_context(2);
    temp_begin();
    RUN(every_instruction_set_is_here);
    RUN(furnace);
    RUN(radiance_in_a_ball);
    RUN(kinds_of_light);
    RUN(attenuation);
    RUN(mirrors_glass_and_leaves);
    RUN(same_everywhere);
    RUN(radii);
    RUN(defaults);
    RUN(stated_deviation);
    RUN(steady_loss);
    RUN(asked_error);
    RUN(same_for_all_cameras);
    RUN(no_dots_in_glossy_floors);
    RUN(every_allocation_may_fail);
    one_scene_end();
    temp_end();
    return test_done();
}
