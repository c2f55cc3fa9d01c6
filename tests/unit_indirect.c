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
    /* Half of the flux hits a mirror, which reflects half of that to the wall. */
    scene_write(
        "%s", HEAD
        "LightSource \"point\" \"rgb I\" [1 1 1]\nMaterial \"mirror\" \"rgb reflectance\" [.5 .5 .5]\n" WALL(
            "1000", "-1") GREY(".5") WALL("1000", "1"));
    CHECK(near_rel(flux(load(4000, 2), 0, 0), LC_PI, 0.02)); /* reflection by the mirror is a bounce */
    CHECK(near_rel(flux(load(4000, 3), 0, 0), LC_PI * 1.5, 0.02));
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

/* Attenuation A is the squared radius: an eighth of the squared distance to the eighth nearest light, found
 * in a loop over all lights; 0 where there are fewer. */
TEST(radii)
{
    static lc_light l[700];
    static float d2[700];
    for (size_t n = 1; n <= 700; n = n * 3 / 2 + 1) {
        for (size_t i = 0; i < n; i++) {
            float u[3];
            for (size_t k = 0; k < 3; k++) u[k] = (float)lc_unit(lc_hash4(3, n, i, k));
            l[i] = (lc_light){ .pos = { u[0], u[1] * u[1], i % 7 ? 0 : u[2] }, .atten = { 0, 0, 1 } };
        }
        if (n > 30) l[n - 1] = l[n - 2]; /* two in one place */
        CHECK(lc_vpl_radii(ctx, l, n) == LC_OK);
        for (size_t i = 0; i < n; i++) {
            size_t m = 0;
            for (size_t k = 0; k < n; k++) {
                lc_f3 d = lc_f3_sub(l[k].pos, l[i].pos);
                if (k != i) d2[m++] = d.x * d.x + d.y * d.y + d.z * d.z;
            }
            qsort(d2, m, sizeof *d2, rising);
            float want = m >= LC_VPL_NEIGHBOURS ? d2[LC_VPL_NEIGHBOURS - 1] / LC_VPL_NEIGHBOURS : 0;
            CHECKF(near_rel((double)l[i].atten[0], (double)want, 1e-5), "%zu of %zu: %g, %g", i, n,
                   (double)l[i].atten[0], (double)want);
        }
    }
}

TEST(defaults)
{
    static const struct {
        const char *integrator;
        uint32_t n, depth, want;
    } cases[] = { { "path", 0, 0, 20000 },        { "volpath", 0, 0, 20000 }, { "path", 0, 1, 0 },
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
    RUN(every_allocation_may_fail);
    one_scene_end();
    temp_end();
    return test_done();
}
