/* unit_glass.c - Fresnel's equations in doubles against the library's; glass seen from the camera against
 * what they give for a sheet and a slab; refraction, total reflection, depth, diffuse transmission. */
#include "scene/sight.h"
#include "shade/fresnel.h"
#include "support/near.h"
#include "support/scene_text.h"

static lc_context *ctx;

static const lc_load_desc direct = { .size = sizeof direct, .indirect_lights = LC_NO_LIGHTS };

#define LOAD(...) scene_from_text(ctx, &direct, __VA_ARGS__)

/* The green of the middle pixel; destroys the scene. */
static double green(lc_scene *scene, uint32_t max_depth, lc_render_stats *stats)
{
    lc_render_desc rd = LC_RENDER_DESC_INIT;
    lc_render_stats own = LC_RENDER_STATS_INIT;
    lc_image *image = NULL;
    rd.max_depth = max_depth;
    lc_status st = scene ? lc_render(ctx, scene, &rd, &image, stats ? stats : &own) : LC_ERR_ARG;
    CHECKF(!st, "%s", lc_status_name(st));
    double g = image ? (double)lc_image_channel(image, "G")[4] : NAN;
    lc_image_destroy(image);
    lc_scene_destroy(scene);
    return g;
}

#define HEAD                                                                                                 \
    "Film \"rgb\" \"integer xresolution\" 3 \"integer yresolution\" 3\nSampler \"independent\" \"integer "   \
    "pixelsamples\" 1\n"                                                                                     \
    "Camera \"perspective\" \"float fov\" 1\nWorldBegin\n"
/* A square, x and y from -s to s at depth z, whose normal is -z, or +z with ReverseOrientation. */
#define WALL(s, z)                                                                                           \
    "Shape \"trianglemesh\" \"point3 P\" [-" s " -" s " " z " -" s " " s " " z " " s " " s " " z " " s       \
    " -" s " " z "]"                                                                                         \
    " \"integer indices\" [0 1 2 0 2 3]\n"
/* A square that emits to both sides. */
#define LAMP(z)                                                                                              \
    "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"bool twosided\" true Material "          \
    "\"diffuse\" "                                                                                           \
    "\"rgb reflectance\" [0 0 0]\n" WALL("9", z) "AttributeEnd\n"

TEST(fresnel)
{
    CHECK(near_abs((double)lc_fresnel_dielectric(1, 1.5f), 0.04, 1e-7) &&
          near_abs((double)lc_fresnel_dielectric(1, 1 / 1.5f), 0.04, 1e-6));
    CHECK(near_abs((double)lc_fresnel_dielectric(0, 1.5f), 1, 0) &&
          near_abs((double)lc_fresnel_dielectric(0.5f, 1 / 1.5f), 1, 0));
    for (int i = 1; i <= 40; i++) {
        double c = i / 40., eta = 1.33, ct = sqrt(1 - (1 - c * c) / (eta * eta));
        double s = (c - eta * ct) / (c + eta * ct), p = (eta * c - ct) / (eta * c + ct),
               f = (s * s + p * p) / 2;
        CHECK(near_abs((double)lc_fresnel_dielectric((float)c, (float)eta), f, 1e-6));
        /* In the other direction along the same path. */
        CHECK(near_abs((double)lc_fresnel_dielectric((float)ct, (float)(1 / eta)), f, 5e-5));
        CHECK(near_abs((double)lc_fresnel_conductor((float)c, (float)eta, 0), f,
                       1e-6)); /* a conductor without absorption */
    }
    CHECK(near_abs((double)lc_fresnel_conductor(1, 0.2f, 3.9f), (0.64 + 15.21) / (1.44 + 15.21), 1e-6));
    CHECK(near_abs((double)lc_fresnel_conductor(0, 0.2f, 3.9f), 1, 1e-6));
    for (float c = 0; c < 1; c += 0.0007f)
        for (float e = 1e-3f; e < 2; e *= 1.37f)
            CHECK(lc_fresnel_conductor(c, 1, e * 1e-4f) >= 0 && lc_fresnel_conductor(c, e, 0) >= 0);
    lc_material m = { .ks = { 0.5f, 0.2f, 0 }, .fresnel = LC_FRESNEL_SCHLICK };
    CHECK(near_abs((double)lc_reflectance(&m, 1, false).y, 0.2, 1e-7) &&
          near_abs((double)lc_reflectance(&m, 0, false).z, 1, 1e-7));
    m.fresnel = LC_FRESNEL_DIELECTRIC;
    m.eta = lc_f3_make(1.5f, 1.5f, 1.5f);
    CHECK(near_abs((double)lc_reflectance(&m, 1, false).x, 0.02, 1e-7) &&
          near_abs((double)lc_reflectance(&m, 0.5f, true).y, 0.2, 1e-7));
}

/* A thin sheet in front of a lamp reflects r, the sum over all orders of reflection between its two sides. */
TEST(sheet)
{
    const double r = 2 * 0.04 / 1.04;
    const char *scene = HEAD LAMP("6") "Material \"thindielectric\" \"float eta\" 1.5\n" WALL("9", "2");
    CHECK(near_abs(green(LOAD("%s", scene), 5, NULL), 1 - r, 1e-4));
    CHECK(near_abs(green(LOAD("%s" LAMP("-3"), scene), 5, NULL), 1, 1e-4)); /* the camera sees 1 everywhere */
    CHECK(near_abs(green(LOAD("%s Translate 0 0 1\n" WALL("9", "2"), scene), 2, NULL), (1 - r) * (1 - r),
                   1e-4));
    CHECK(near_abs(green(LOAD("%s Translate 0 0 1\n" WALL("9", "2"), scene), 1, NULL), 0, 0));
}

/* Two boundaries: radiance is divided by eta^2 at the first and multiplied by it at the second. Each counts
 * for the depth. */
TEST(slab)
{
    const double r = 0.04, t2 = 0.96 * 0.96;
    const char *scene = HEAD LAMP(
        "6") "Material \"dielectric\"\n" WALL("9", "2") "ReverseOrientation\n" WALL("9", "3");
    double want[5] = { 0, 0, t2, t2, t2 };
    for (uint32_t depth = 1; depth < 5; depth++)
        CHECKF(near_abs(green(LOAD("%s", scene), depth, NULL), want[depth], 2e-3), "depth %u", depth);
    CHECK(near_abs(green(LOAD("%s", scene), 50, NULL), t2 / (1 - r * r), 2e-3));
    CHECK(near_abs(green(LOAD("%s" LAMP("-3"), scene), 50, NULL), 1, 4e-3));
    /* A lamp inside the glass looks eta^2 times darker. */
    scene = HEAD "Material \"glass\" \"float index\" 1.5 \"rgb Kt\" [.5 .5 .5]\n" WALL("9", "2") LAMP("6");
    CHECK(near_abs(green(LOAD("%s", scene), 3, NULL), 0.96 * 0.5 / 2.25, 1e-4));
}

static lc_scene *floor_below(const char *more)
{
    return LOAD(HEAD "LightSource \"point\" \"rgb I\" [1 1 1]\nMaterial \"diffuse\"\n" WALL("90", "6")
                    WALL("90", "-6") "%s",
                more);
}

TEST(refraction_and_total_reflection)
{
    const char *slab =
        "Material \"dielectric\" \"float eta\" 1.5\n" WALL("90", "2") "ReverseOrientation\n" WALL("90", "3");
    lc_scene *scene = floor_below(slab);
    static lc_sight s;
    const lc_sight_desc how = { .max_depth = 9, .n_points = 1, .offset = 0.5 };
    lc_f3 dir = lc_f3_normalize_d(1, 0, 1);
    if (scene) {
        /* The path advances by `shift` along x in the slab of thickness 1, and by 1 for each unit of z
         * outside of it. */
        double sine = sqrt(0.5) / 1.5, shift = sine / sqrt(1 - sine * sine);
        CHECK(lc_sight_trace(scene, lc_f3_make(0, 0, 0), dir, &how, &s) && s.n_lit > 2);
        CHECKF(s.lit[0].n_mirrors == 2 && near_abs((double)s.lit[0].surface.pos.x, 5 + shift, 1e-3),
               "%u %g %g %g", s.lit[0].n_mirrors, (double)s.lit[0].surface.pos.x,
               (double)s.lit[0].surface.pos.z, 5 + shift);
        double f = (double)lc_fresnel_dielectric((float)sqrt(0.5), 1.5f);
        CHECK(near_abs((double)s.lit[0].weight.x, (1 - f) * (1 - f), 1e-5) &&
              near_abs((double)s.lit[1].weight.x, f, 1e-5));
        /* From inside the slab, at an angle beyond the critical one of 41.8 degrees, and at one below it. */
        CHECK(lc_sight_trace(scene, lc_f3_make(0, 0, 2.5f), dir, &how, &s) && s.n_lit == 0 && s.n_rays == 9);
        CHECK(lc_sight_trace(scene, lc_f3_make(0, 0, 2.5f), lc_f3_normalize_d(0.5, 0, 1), &how, &s) &&
              s.lit[0].n_mirrors == 1);
        CHECK(s.lit[0].weight.x > 2 && s.n_lit > 1);
    }
    lc_scene_destroy(scene);
}

/* Twenty sheets: the list of surfaces seen is bounded, and the one of the greatest weight is first. */
TEST(many_sheets)
{
    char more[4096] = "Material \"thindielectric\" \"float eta\" 1.8\n";
    static lc_sight s;
    const lc_sight_desc how = { .max_depth = LC_MAX_DEPTH, .n_points = 1, .offset = 0.5 };
    for (int i = 0; i < 20; i++) {
        size_t len = strlen(more);
        snprintf(more + len, sizeof more - len, "Translate 0 0 .1 " WALL("9", "1"));
    }
    lc_scene *scene = floor_below(more);
    if (scene) {
        CHECK(lc_sight_trace(scene, lc_f3_make(0, 0, 0), lc_f3_make(0, 0, 1), &how, &s));
        CHECKF(s.n_lit == LC_MAX_ROUGH, "%u", s.n_lit);
        float sum = 0;
        for (uint32_t i = 0; i < s.n_lit; i++) {
            sum += s.lit[i].weight.y;
            CHECK(i == 0 || s.lit[i].weight.y <= s.lit[i - 1].weight.y);
        }
        CHECKF(sum > 0.2f && sum <= 1.0001f, "%g", (double)sum);
    }
    lc_scene_destroy(scene);
}

/* A leaf with a light on the camera's side, and with one behind it. */
TEST(leaf)
{
    const char *leaf = HEAD "LightSource \"point\" \"point3 from\" [0 0 %d] \"rgb I\" [1 1 1]\n"
                            "Material \"diffusetransmission\" \"rgb reflectance\" [.4 .4 .4] \"rgb "
                            "transmittance\" [.1 .1 .1]\n" WALL("9", "2");
    lc_render_stats stats = LC_RENDER_STATS_INIT;
    CHECK(near_abs(green(LOAD(leaf, 0), 1, &stats), 0.4 / LC_PI / 4, 1e-6) && stats.points == 18);
    CHECK(near_abs(green(LOAD(leaf, 4), 1, &stats), 0.1 / LC_PI / 4, 1e-6));
}

int main(void)
{
    ctx = quiet_context(2);
    temp_begin();
    RUN(fresnel);
    RUN(sheet);
    RUN(slab);
    RUN(refraction_and_total_reflection);
    RUN(many_sheets);
    RUN(leaf);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
