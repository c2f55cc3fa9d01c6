/* unit_motion.c - motion while the shutter is open: where things are between two transforms, the ramp of a
 * moving edge against its closed form, by shapes, instances, the camera and calls; the mean of pictures of
 * scenes that stand still; cuts against every light; the same bytes by any number of threads; what stands
 * still and says so; memory that runs out. */
#include "base/motion.h"
#include "support/rendered.h"
#include "support/rnd.h"
#include "support/scene_text.h"
#include "support/test.h"
#include "support/watched_memory.h"

#include <math.h>
#include <stdlib.h>

static lc_context *ctx;

/* ---- between two transforms ---- */

/* Rodrigues' formula, by the C library. */
static lc_xform turned(double degrees, const double axis[3])
{
    const double r = degrees * acos(-1) / 180, c = cos(r), s = sin(r),
                 len = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    lc_xform x = lc_xform_identity();
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int k = 3 - i - j;
            const double cross = i == j ? 0 : (j == (i + 1) % 3 ? -1 : 1) * axis[k] / len;
            x.m[4 * i + j] = (i == j ? c : 0) + (1 - c) * axis[i] * axis[j] / (len * len) + s * cross;
        }
    return x;
}

static double apart(const lc_xform *a, const lc_xform *b)
{
    double most = 0;
    for (int i = 0; i < 16; i++) most = fmax(most, fabs(a->m[i] - b->m[i]));
    return most;
}

static lc_xform placed(const double at[3], double degrees, const double axis[3], const double scale[3])
{
    const lc_xform t = lc_xform_translate(at), r = turned(degrees, axis), s = lc_xform_scale(scale);
    const lc_xform tr = lc_xform_mul(&t, &r);
    return lc_xform_mul(&tr, &s);
}

TEST(between_two_transforms_things_turn_about_one_axis)
{
        for (int i = 0; i < 2000; i++) {
        double at[2][3], scale[2][3], axis[3], mid[3], size[3];
        const double from = rnd_in(-180, 180), by = rnd_in(-179, 179), t = rnd();
        for (int k = 0; k < 3; k++) {
            axis[k] = rnd_in(-1, 1) + (k ? 0 : 1.1);
            for (int e = 0; e < 2; e++) {
                at[e][k] = rnd_in(-5, 5);
                scale[e][k] = rnd_in(0.2, 3) * (i % 3 ? 1 : -1); /* mirrored at both ends */
            }
            mid[k] = (1 - t) * at[0][k] + t * at[1][k];
            size[k] = (1 - t) * scale[0][k] + t * scale[1][k];
        }
        const lc_xform a = placed(at[0], from, axis, scale[0]), b = placed(at[1], from + by, axis, scale[1]),
                       want = placed(mid, from + t * by, axis, size);
        lc_xform got;
        CHECK(lc_xform_between(&a, &b, t, &got));
        CHECKF(apart(&got, &want) < 1e-9, "%g of the way, %g degrees of %g: off by %g", t, by, from,
               apart(&got, &want));
        CHECK(lc_xform_between(&a, &b, 0, &got) && !memcmp(&got, &a, sizeof a));
        CHECK(lc_xform_between(&a, &b, 1, &got) && !memcmp(&got, &b, sizeof b));
        CHECK(lc_xform_between(&a, &a, t, &got) && !memcmp(&got, &a, sizeof a));
    }
}

TEST(a_transform_that_flattens_is_between_nothing)
{
    const lc_xform a = lc_xform_identity(), flat = lc_xform_scale((const double[3]){ 1, 0, 1 });
    lc_xform got;
    CHECK(!lc_xform_between(&a, &flat, 0.5, &got) && !lc_xform_between(&flat, &a, 0.5, &got));
}

/* ---- the ramp of an edge ---- */

#define WIDTH  64
#define HEIGHT 4
#define SPP    64

/* 16 units wide, 4 pixels a unit; light comes from the viewer, so a white surface has radiance 1 / pi. */
#define FILM                                                                                                 \
    "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 4\n"                                    \
    "PixelFilter \"box\" \"float xradius\" .5 \"float yradius\" .5\n"                                        \
    "Sampler \"independent\" \"integer pixelsamples\" 64\nIntegrator \"path\" \"integer maxdepth\" 1\n"
#define ORTHO "Camera \"orthographic\" \"float screenwindow\" [-8 8 -.5 .5] "
#define SUN   "LightSource \"distant\" \"point3 from\" [0 0 -1] \"point3 to\" [0 0 0] \"rgb L\" [1 1 1]\n"
#define WHITE "Material \"diffuse\" \"rgb reflectance\" [1 1 1]\n"
/* From x = -6 to -2; 4 further to the right where it ends. */
#define CARD                                                                                                 \
    "Shape \"trianglemesh\" \"point3 P\" [-6 -9 0 -2 -9 0 -2 9 0 -6 9 0] \"integer indices\" "               \
    "[0 1 2 0 2 3]\n"

static lc_scene *scene_of(const char *view, const char *world)
{
    lc_load_desc d = LC_LOAD_DESC_INIT;
    d.spp = SPP;
    return scene_from_text(ctx, &d, "%s" FILM "WorldBegin\n" SUN WHITE "%s", view, world);
}

/* What share of the time a point at x is covered by a card from -6 to -2 whose way is `from` to `to`. */
static double covered(double x, double from, double to)
{
    const double enters = (x + 2 - from) / (to - from), leaves = (x + 6 - from) / (to - from);
    return fmin(fmax(leaves, 0), 1) - fmin(fmax(enters, 0), 1);
}

/* The mean over a pixel. */
static double ramp(uint32_t px, double from, double to)
{
    double sum = 0;
    for (int i = 0; i < 200; i++) sum += covered(-8 + (px + (i + 0.5) / 200) / 4, from, to) / 200;
    return sum;
}

/* Checks all pixels; from and to: where the card is on its way when the shutter opens and closes. */
static void check_ramp(const char *what, const lc_scene *s, double from, double to)
{
    lc_image *image = rendered(ctx, s);
    double worst = 0, sum = 0, want = 0;
    for (uint32_t x = 0; x < WIDTH; x++)
        for (uint32_t y = 0; y < HEIGHT; y++) {
            const double got = pixel_at(image, "G", x, y) * acos(-1);
            worst = fmax(worst, fabs(got - ramp(x, from, to)));
            sum += got;
            want += ramp(x, from, to);
        }
    /* one sample of 64, and the edge crosses a pixel in a sixteenth of the time */
    CHECKF(worst < 0.05, "%s: a pixel is off by %g", what, worst);
    CHECKF(fabs(sum / want - 1) < 0.008, "%s: the mean is off by %g", what, sum / want - 1);
    lc_image_destroy(image);
}

#define MOVES(x) "ActiveTransform EndTime Translate " x " 0 0 ActiveTransform All\n"
#define EYE      "LookAt 0 0 -10 0 0 0 0 1 0\n"

TEST(a_moving_edge_is_a_ramp)
{
    static const struct {
        const char *what, *view, *world;
        double from, to;
    } cases[] = {
        { "a shape", EYE ORTHO, MOVES("4") CARD, 0, 4 },
        { "that moves back", EYE ORTHO, "ActiveTransform StartTime Translate 4 0 0\n" CARD, 0, 4 },
        { "an instance", EYE ORTHO,
          "ObjectBegin \"card\"\n" CARD "ObjectEnd\n" MOVES("4") "ObjectInstance \"card\"\n", 0, 4 },
        { "the camera", MOVES("4") EYE ORTHO, CARD, 0, 4 },
        { "camera and shape", MOVES("2") EYE ORTHO, MOVES("2") CARD, 0, 4 },
        { "a short shutter", EYE ORTHO "\"float shutteropen\" .25 \"float shutterclose\" 1.25\n",
          "AttributeBegin\n" MOVES("4") CARD "AttributeEnd\n", 1, 4 },
        { "a slow motion", "TransformTimes -1 1\n" EYE ORTHO, MOVES("4") CARD, 2, 4 },
        { "by a named place", EYE ORTHO,
          "AttributeBegin\n" MOVES("4") "CoordinateSystem \"far\"\nAttributeEnd\n"
          "CoordSysTransform \"far\"\n" CARD, 0, 4 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        lc_scene *s = scene_of(cases[i].view, cases[i].world);
        check_ramp(cases[i].what, s, cases[i].from, cases[i].to);
        lc_scene_destroy(s);
    }
}

/* The card by calls, from one x to another; a camera that looks at it. */
static lc_scene *card_by_calls(double from, double to, bool camera)
{
    static const float corners[] = { -6, -9, 0, -2, -9, 0, -2, 9, 0, -6, 9, 0 };
    static const uint32_t indices[] = { 0, 1, 2, 0, 2, 3 };
    const lc_xform a = lc_xform_translate((const double[3]){ camera ? 0 : from, 0, 0 }),
                   b = lc_xform_translate((const double[3]){ camera ? 0 : to, 0, 0 });
    lc_xform eye = lc_xform_translate((const double[3]){ camera ? to : 0, 0, 10 });
    lc_build_camera_desc c = LC_BUILD_CAMERA_DESC_INIT;
    lc_build_film_desc f = LC_BUILD_FILM_DESC_INIT;
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_mesh_desc q = LC_BUILD_MESH_DESC_INIT;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    uint32_t object = 0;
    lc_scene *s;
    f.width = WIDTH;
    f.height = HEIGHT;
    f.spp = SPP;
    f.filter = LC_BUILD_BOX;
    c.kind = LC_BUILD_ORTHOGRAPHIC;
    c.from[0] = camera ? -from : 0;
    c.from[2] = -10;
    c.at[0] = c.from[0];
    c.at[2] = 0;
    c.width = 1;
    for (int k = 0; k < 3; k++) m.diffuse[k] = 1;
    q.positions = corners;
    q.indices = indices;
    q.n_vertices = 4;
    q.n_triangles = 2;
    l.kind = LC_BUILD_DIRECTIONAL;
    l.direction[0] = l.direction[1] = 0;
    l.direction[2] = 1;
    for (int k = 0; k < 3; k++) l.intensity[k] = 1;
    CHECK(!lc_build_begin(ctx, &s) && !lc_build_film(s, &f) && !lc_build_camera(s, &c));
    CHECK(!lc_build_material(s, &m, &q.material) && !lc_build_light(s, &l));
    CHECK(!lc_build_object(s, &object) && !lc_build_mesh(s, &q));
    if (camera) CHECK(!lc_build_instance(s, object, a.m) && !lc_build_camera_motion(s, eye.m));
    else CHECKF(!lc_build_moving_instance(s, object, a.m, b.m), "%s", last_error);
    CHECKF(!lc_build_commit(s, NULL), "%s", last_error);
    return s;
}

TEST(calls_make_the_same_motion)
{
    bool same_id;
    lc_scene *s = card_by_calls(1, 5, false), *t = card_by_calls(1, 4, false), *u = card_by_calls(1, 5, true);
    check_ramp("an instance", s, 1, 5);
    check_ramp("a camera", u, 1, 5);
    CHECK(info_of(s).n_moving == 1 && !info_of(s).camera_moves);
    CHECK(info_of(u).n_moving == 0 && info_of(u).camera_moves);
    CHECK(!alike(ctx, s, t, &same_id) && !same_id && !alike(ctx, t, u, &same_id) && !same_id);
    lc_scene_destroy(t);
    t = card_by_calls(1, 5, false);
    CHECK(alike(ctx, s, t, &same_id) && same_id);
    lc_scene_destroy(s);
    lc_scene_destroy(t);
    lc_scene_destroy(u);
}

TEST(what_is_set_again_stands_still)
{
    bool same_id;
    const lc_xform middle = lc_xform_translate((const double[3]){ 3, 0, 0 });
    lc_scene *s = card_by_calls(1, 5, false), *still = card_by_calls(3, 3, false);
    CHECK(!lc_scene_set_instance(s, 0, middle.m) && !lc_scene_update(s, NULL));
    CHECK(alike(ctx, s, still, &same_id) && same_id && !info_of(s).n_moving);
    lc_scene_destroy(s);
    s = card_by_calls(1, 5, true);
    lc_camera_place place = LC_CAMERA_PLACE_INIT;
    CHECK(!lc_scene_get_camera(s, &place));
    CHECKF(fabs(place.from[0] + 3) < 1e-12, "in the middle of the time the camera is at %g", place.from[0]);
    CHECK(!lc_scene_move_camera(s, &place) && !lc_scene_update(s, NULL));
    check_ramp("a camera that stands still, by its first pixels", s, 2.999, 3.001);
    lc_scene_destroy(s);
    lc_scene_destroy(still);
}

TEST(one_sample_sees_the_middle)
{
    lc_scene *s = card_by_calls(1, 5, false), *still = card_by_calls(3, 3, false);
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image *a = NULL, *b = NULL;
    d.spp = 1;
    CHECK(!lc_render(ctx, s, &d, &a, NULL) && !lc_render(ctx, still, &d, &b, NULL));
    CHECK(same_planes(a, b));
    lc_image_destroy(a);
    lc_image_destroy(b);
    lc_scene_destroy(s);
    lc_scene_destroy(still);
}

/* ---- pictures of scenes that stand still ---- */

#define SIDE   24
#define STILLS 32

/* A slab that turns, grows and sinks above a floor, below three lights, one of them round; where it is, as
 * statements. */
static lc_scene *slab(const char *where, uint32_t spp)
{
    lc_load_desc d = LC_LOAD_DESC_INIT;
    d.spp = spp;
    return scene_from_text(
        ctx, &d,
        "LookAt 0 5 -9 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" 50\n"
        "Film \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d\n"
        "Integrator \"path\" \"integer maxdepth\" 1\nWorldBegin\n"
        "LightSource \"point\" \"point3 from\" [3 6 -2] \"rgb I\" [40 30 20]\n"
        "LightSource \"point\" \"point3 from\" [-4 5 1] \"rgb I\" [10 20 30]\n"
        "AttributeBegin\nTranslate 0 7 0\nAreaLightSource \"diffuse\" \"rgb L\" [5 5 5]\n"
        "Shape \"sphere\" \"float radius\" .7\nAttributeEnd\n"
        "Shape \"trianglemesh\" \"point3 P\" [-9 -1 -9 9 -1 -9 9 -1 9 -9 -1 9] \"integer indices\" "
        "[0 2 1 0 3 2]\n%sShape \"trianglemesh\" \"point3 P\" [-2 0 -1 2 0 -1 2 .5 1 -2 .5 1] "
        "\"integer indices\" "
        "[0 2 1 0 3 2]\n",
        SIDE, SIDE, where);
}

static lc_image *exactly(const lc_scene *s)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    d.method = LC_METHOD_EXACT;
    CHECKF(s && !lc_render(ctx, s, &d, &image, NULL), "%s", last_error);
    return image;
}

TEST(motion_is_the_mean_of_what_stands_still)
{
    static double mean[SIDE][SIDE];
    double worst = 0, sum = 0, off = 0;
    for (int i = 0; i < STILLS; i++) {
        char where[200];
        const double t = (i + 0.5) / STILLS;
        snprintf(where, sizeof where, "Translate %.17g %.17g 0\nRotate %.17g 0 1 0\nScale %.17g 1 1\n",
                 -1 + 2 * t, 1 - t, 30 + 100 * t, 1 + 0.5 * t);
        lc_scene *s = slab(where, 64);
        lc_image *image = exactly(s);
        for (uint32_t y = 0; y < SIDE; y++)
            for (uint32_t x = 0; x < SIDE; x++) mean[y][x] += pixel_at(image, "G", x, y) / STILLS;
        lc_image_destroy(image);
        lc_scene_destroy(s);
    }
    lc_scene *s = slab("ActiveTransform StartTime Translate -1 1 0 Rotate 30 0 1 0\n"
                       "ActiveTransform EndTime Translate 1 0 0 Rotate 130 0 1 0 Scale 1.5 1 1\n"
                       "ActiveTransform All\n",
                       512);
    lc_image *image = exactly(s);
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            const double d = fabs(pixel_at(image, "G", x, y) - mean[y][x]);
            worst = fmax(worst, d);
            off += d;
            sum += mean[y][x];
        }
    CHECKF(off / sum < 0.006, "pixels are off by %g of the mean", off / sum);
    CHECKF(worst * SIDE * SIDE / sum < 0.08, "a pixel is off by %g of the mean", worst * SIDE * SIDE / sum);
    lc_image_destroy(image);
    lc_scene_destroy(s);
}

/* ---- cuts ---- */

/* The slab below n lights. */
static lc_scene *under_lights(uint32_t n, uint32_t spp)
{
    char *lights = calloc(n, 100), *at = lights;
    rng_ctr = 0;
    for (uint32_t i = 0; i < n; i++)
        at += sprintf(at, "LightSource \"point\" \"point3 from\" [%.4f %.4f %.4f] \"rgb I\" [.3 .3 .3]\n",
                      rnd_in(-6, 6), rnd_in(3, 6), rnd_in(-6, 6));
    at = malloc(strlen(lights) + 500);
    sprintf(at, "%sAttributeBegin\nActiveTransform EndTime Translate 2 0 0 Rotate 40 0 1 0\n"
            "ActiveTransform All\n", lights);
    lc_scene *s = slab(at, spp);
    free(lights);
    free(at);
    return s;
}

TEST(cuts_keep_the_error_that_is_asked)
{
    for (uint32_t spp = 4; spp <= 16; spp *= 4) {
        lc_scene *s = under_lights(600, spp);
        lc_render_desc d = LC_RENDER_DESC_INIT;
        lc_image *cuts = NULL, *all = exactly(s);
        uint32_t within = 0;
        d.method = LC_METHOD_CUTS;
        CHECKF(!lc_render(ctx, s, &d, &cuts, NULL), "%s", last_error);
        for (uint32_t y = 0; y < SIDE; y++)
            for (uint32_t x = 0; x < SIDE; x++) {
                const double want = pixel_at(all, "G", x, y);
                within += fabs(pixel_at(cuts, "G", x, y) - want) <= 0.02 * want;
            }
        CHECKF(within >= 0.93 * SIDE * SIDE, "%u samples: %u of %u pixels within 2 %%", spp, within,
               SIDE * SIDE);
        lc_image_destroy(cuts);
        lc_image_destroy(all);
        lc_scene_destroy(s);
    }
}

/* A slab that turns in a corner, lit by what floor and wall reflect, too. */
static lc_scene *bounced(void)
{
    lc_load_desc d = LC_LOAD_DESC_INIT;
    d.spp = 9;
    d.indirect_lights = 1500;
    return scene_from_text(
        ctx, &d,
        "LookAt 0 5 -9 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" 50\n"
        "Film \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d\n"
        "Integrator \"path\" \"integer maxdepth\" 3\nWorldBegin\n"
        "LightSource \"point\" \"point3 from\" [3 6 -2] \"rgb I\" [40 30 20]\n"
        "Shape \"trianglemesh\" \"point3 P\" [-9 -1 -9 9 -1 -9 9 -1 3 -9 -1 3] "
        "\"integer indices\" [0 2 1 0 3 2]\n"
        "Shape \"trianglemesh\" \"point3 P\" [-9 -1 3 9 -1 3 9 9 3 -9 9 3] "
        "\"integer indices\" [0 2 1 0 3 2]\n"
        "ActiveTransform EndTime\nRotate 60 0 1 0\nActiveTransform All\n"
        "Shape \"trianglemesh\" \"point3 P\" [-2 -2 -1 2 -2 -1 2 1 1 -2 1 1] "
        "\"integer indices\" [0 2 1 0 3 2]\n",
        SIDE, SIDE);
}

static lc_scene *many_lights(void) { return under_lights(300, 9); }

static void expect_same_bytes(lc_scene *(*make)(void))
{
    lc_context *one = quiet_context(1), *three = quiet_context(3), *was = ctx;
    lc_image *image[3] = { NULL, NULL, NULL };
    for (int i = 0; i < 3; i++) {
        ctx = i ? three : one;
        lc_scene *s = make();
        lc_render_desc d = LC_RENDER_DESC_INIT;
        d.method = LC_METHOD_CUTS;
        d.aovs = LC_AOV_CUT;
        if (i == 2)
            for (int k = 0; k < 4; k++) d.crop[k] = k % 2 ? 19 : 6;
        CHECKF(!lc_render(ctx, s, &d, &image[i], NULL), "%s", last_error);
        lc_scene_destroy(s);
    }
    CHECK(same_planes(image[0], image[1]));
    for (uint32_t y = 6; y < 19; y++)
        for (uint32_t x = 6; x < 19; x++)
            CHECK(!(fabs(pixel_at(image[0], "G", x, y) - pixel_at(image[2], "G", x - 6, y - 6)) > 0));
    for (int i = 0; i < 3; i++) lc_image_destroy(image[i]);
    ctx = was;
    lc_context_destroy(one);
    lc_context_destroy(three);
}

TEST(threads_and_crops_give_the_same_bytes) { expect_same_bytes(many_lights); }
TEST(bounced_light_has_the_same_bytes) { expect_same_bytes(bounced); }

TEST(haze_and_glass_move_along)
{
    lc_scene *s = scene_of("MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" "
                           "[.001 .001 .001] \"rgb sigma_s\" [0 0 0]\n"
                           "MediumInterface \"\" \"fog\"\n" EYE ORTHO,
                           MOVES("4") CARD);
    lc_image *image = rendered(ctx, s);
    for (uint32_t x = 0; x < WIDTH; x++) {
        const double got = pixel_at(image, "G", x, 1) * acos(-1), want = ramp(x, 0, 4);
        CHECKF(got <= want + 0.05 && got >= want * 0.97 - 0.05, "haze, pixel %u: %g, not %g", x, got, want);
    }
    lc_image_destroy(image);
    lc_scene_destroy(s);
    s = scene_of(EYE ORTHO, MOVES("4") "Material \"interface\"\n" WHITE CARD);
    check_ramp("beside glass", s, 0, 4);
    lc_scene_destroy(s);
}

/* ---- lights ---- */

/* A wide plane, and before it a way of 5 along x. */
#define PLANE_AND_WAY                                                                                        \
    "Shape \"trianglemesh\" \"point3 P\" [-90 -90 0 90 -90 0 90 90 0 -90 90 0] \"integer indices\" "         \
    "[0 1 2 0 2 3]\nTranslate -3 0 -1.5\n" MOVES("5")

/* What a light that goes from x = a to b, `height` above a plane, gives to the plane at x, y from its way,
 * averaged over its time: the integral of height / d^3. */
static double lit_along(double x, double y, double height, double a, double b)
{
    const double c2 = y * y + height * height;
    return height / (c2 * (b - a)) *
           ((b - x) / sqrt((b - x) * (b - x) + c2) - (a - x) / sqrt((a - x) * (a - x) + c2));
}

static void check_light(const char *light, double scale)
{
    const double height = 1.5, a = -3, b = 2;
    lc_load_desc d = LC_LOAD_DESC_INIT;
    d.spp = SPP;
    lc_scene *s = scene_from_text(
        ctx, &d, EYE ORTHO FILM "WorldBegin\n" WHITE
        PLANE_AND_WAY "%s\n", light);
    CHECK(info_of(s).n_lights == 64);
    lc_image *image = exactly(s);
    for (uint32_t x = 0; x < WIDTH; x++) {
        const double at = -8 + (x + 0.5) / 4, want = scale * lit_along(at, 0.125, height, a, b),
                     got = pixel_at(image, "G", x, 1) * acos(-1);
        CHECKF(fabs(got - want) < 0.006 * want, "%s, pixel %u: %g, not %g", light, x, got, want);
    }
    lc_image_destroy(image);
    lc_scene_destroy(s);
}

TEST(a_light_that_moves_is_spread_along_its_way)
{
    check_light("LightSource \"point\" \"rgb I\" [3 3 3]", 3);
    check_light("LightSource \"point\" \"rgb I\" [1 1 1] \"float scale\" 2", 2);
    check_light("LightSource \"spot\" \"rgb I\" [1 1 1] \"float coneangle\" 180 \"float conedeltaangle\" 0",
                1);
}

/* ---- lamps ---- */

#define BLACK "Material \"diffuse\" \"rgb reflectance\" [0 0 0]\n"

/* It is seen where it is at each moment. */
TEST(a_lamp_that_moves_is_a_ramp)
{
    lc_scene *s = scene_of(EYE ORTHO, MOVES("4") BLACK "AreaLightSource \"diffuse\" \"rgb L\" "
                                                       "[.3183099 .3183099 .3183099] \"bool twosided\" true\n"
                                          CARD);
    check_ramp("a lamp", s, 0, 4);
    CHECK(info_of(s).n_triangles == 2 && info_of(s).n_moving == 1);
    lc_scene_destroy(s);
}

/* What a small square that shines down gives to a plane: the integral of height^2 / d^4, over its way. */
static double lit_by_square(double x, double y, double height, double a, double b)
{
    const double c2 = y * y + height * height, c = sqrt(c2), from = a - x, to = b - x;
    return height * height / (b - a) *
           (to / (2 * c2 * (c2 + to * to)) + atan(to / c) / (2 * c * c2) -
            from / (2 * c2 * (c2 + from * from)) - atan(from / c) / (2 * c * c2));
}

TEST(light_of_a_lamp_that_moves_is_spread_along_its_way)
{
    const double height = 1.5, side = 0.02, radiance = 7500;
    lc_load_desc d = LC_LOAD_DESC_INIT;
    d.spp = SPP;
    lc_scene *s = scene_from_text(
        ctx, &d, EYE ORTHO FILM "WorldBegin\n" WHITE
        PLANE_AND_WAY
        "AreaLightSource \"diffuse\" \"rgb L\" [%g %g %g]\nShape \"trianglemesh\" "
        "\"point3 P\" [-.01 -.01 0 .01 -.01 0 .01 .01 0 -.01 .01 0] \"integer indices\" [0 1 2 0 2 3]\n",
        radiance, radiance, radiance);
    lc_image *image = exactly(s);
    for (uint32_t x = 0; x < WIDTH; x++) {
        const double at = -8 + (x + 0.5) / 4,
                     want = radiance * side * side * lit_by_square(at, 0.125, height, -3, 2),
                     got = pixel_at(image, "G", x, 1) * acos(-1);
        CHECKF(fabs(got - want) < 0.01 * want, "pixel %u: %g, not %g", x, got, want);
    }
    lc_image_destroy(image);
    lc_scene_destroy(s);
}

/* The mean of a corner of floor and wall under a ball that moves by `way`; group: of that light. */
static double corner_by_ball(double way, uint32_t depth, double *of_group)
{
    static const char *const patterns[] = { "lamp=area" };
    lc_load_desc d = LC_LOAD_DESC_INIT;
    lc_render_desc r = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    double sum = 0;
    d.spp = 16;
    d.max_depth = depth;
    d.indirect_lights = depth > 1 ? 4000 : LC_NO_LIGHTS;
    d.groups = patterns;
    d.n_groups = 1;
    lc_scene *s = scene_from_text(
        ctx, &d,
        "LookAt 0 5 -9 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" 50\n"
        "Film \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d\n"
        "Integrator \"path\"\nWorldBegin\n"
        "Shape \"trianglemesh\" \"point3 P\" [-9 -1 -9 9 -1 -9 9 -1 3 -9 -1 3] "
        "\"integer indices\" [0 2 1 0 3 2]\n"
        "Shape \"trianglemesh\" \"point3 P\" [-9 -1 3 9 -1 3 9 9 3 -9 9 3] "
        "\"integer indices\" [0 2 1 0 3 2]\n"
        "Translate %g 9 1\nActiveTransform EndTime\nTranslate %g 0 0\nActiveTransform All\n" BLACK
        "AreaLightSource \"diffuse\" \"rgb L\" [9 9 9]\nShape \"sphere\"\n",
        SIDE, SIDE, -way / 2, way);
    r.method = LC_METHOD_EXACT;
    CHECKF(s && !lc_render(ctx, s, &r, &image, NULL), "%s", last_error);
    *of_group = 0;
    for (uint32_t y = 0; image && y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            sum += pixel_at(image, "G", x, y);
            *of_group += pixel_at(image, "lamp.G", x, y);
        }
    lc_image_destroy(image);
    lc_scene_destroy(s);
    return sum;
}

/* A ball that hardly moves gives what one gives that stands still: it does not stand in the light of where it
 * was and will be. */
TEST(a_lamp_does_not_stand_in_its_own_light)
{
    double still_group, group;
    for (uint32_t depth = 1; depth <= 3; depth += 2) {
        const double still = corner_by_ball(0, depth, &still_group), got = corner_by_ball(0.1, depth, &group);
        CHECKF(still > 0 && fabs(got / still - 1) < 0.01, "depth %u: %g, not %g", depth, got, still);
        CHECKF(fabs(group / got - 1) < 1e-5 && fabs(still_group / still - 1) < 1e-5,
               "depth %u: %g of %g are of the lamp's group", depth, group, got);
    }
}

TEST(calls_make_lamps_that_move)
{
    static const float corners[] = { -6, -9, 0, -2, -9, 0, -2, 9, 0, -6, 9, 0 };
    static const uint32_t indices[] = { 0, 1, 2, 0, 2, 3 };
    const lc_xform a = lc_xform_identity(), b = lc_xform_translate((const double[3]){ 4, 0, 0 }),
                   flat = lc_xform_scale((const double[3]){ 1, 0, 1 });
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_mesh_desc q = LC_BUILD_MESH_DESC_INIT;
    lc_scene *s;
    CHECK(lc_build_moving_lamp(NULL, &q, a.m, b.m) == LC_ERR_ARG);
    CHECK(!lc_build_begin(ctx, &s) && !lc_build_usual_camera(s) && !lc_build_material(s, &m, &q.material));
    q.positions = corners;
    q.indices = indices;
    q.n_vertices = 4;
    q.n_triangles = 2;
    CHECK(lc_build_moving_lamp(s, NULL, a.m, b.m) == LC_ERR_ARG);
    CHECK(lc_build_moving_lamp(s, &q, a.m, b.m) == LC_ERR_ARG && strstr(last_error, "must be above 0"));
    q.emission[1] = 1;
    CHECK(lc_build_moving_lamp(s, &q, NULL, b.m) == LC_ERR_ARG);
    CHECK(lc_build_moving_lamp(s, &q, a.m, NULL) == LC_ERR_ARG);
    CHECK(lc_build_moving_lamp(s, &q, a.m, flat.m) == LC_ERR_ARG);
    q.n_triangles = 0;
    CHECK(lc_build_moving_lamp(s, &q, a.m, b.m) == LC_ERR_ARG && strstr(last_error, "no triangles"));
    q.n_triangles = 2;
    CHECKF(!lc_build_moving_lamp(s, &q, a.m, b.m), "%s", last_error);
    q.emission[1] = 0;
    CHECK(lc_build_mesh(s, &q) == LC_ERR_ARG && strstr(last_error, "before its instances"));
    CHECKF(!lc_build_commit(s, NULL), "%s", last_error);
    CHECK(info_of(s).n_moving == 1 && info_of(s).n_triangles == 2 && info_of(s).n_lights >= 128);
    lc_scene_destroy(s);
}

static double total(const lc_scene *s)
{
    lc_image *image = exactly(s);
    double sum = 0;
    for (uint32_t x = 0; x < WIDTH; x++)
        for (uint32_t y = 0; y < HEIGHT; y++) sum += pixel_at(image, "G", x, y);
    lc_image_destroy(image);
    return sum;
}

/* What is seen of it and what it gives follow its emission. */
TEST(a_lamp_that_moves_is_dimmed)
{
    static const float twice[3] = { 2, 2, 2 }, none[3] = { 0, 0, 0 };
    lc_load_desc d = LC_LOAD_DESC_INIT;
    uint32_t at = 0;
    d.spp = SPP;
    lc_scene *s = scene_from_text(
        ctx, &d, EYE ORTHO FILM "WorldBegin\n" WHITE
        PLANE_AND_WAY
        "AreaLightSource \"diffuse\" \"rgb L\" [3 3 3] \"bool twosided\" true\nShape \"trianglemesh\" "
        "\"point3 P\" [-.5 -.5 0 .5 -.5 0 .5 .5 0 -.5 .5 0] \"integer indices\" [0 1 2 0 2 3]\n");
    const double before = total(s);
    CHECK(!lc_scene_find(s, LC_NAMED_MESH, "area", &at) && at != LC_NO_THING);
    CHECKF(!lc_scene_dim_emission(s, at, twice) && !lc_scene_update(s, NULL), "%s", last_error);
    CHECKF(fabs(total(s) / before - 2) < 1e-3, "%g, before %g", total(s), before);
    CHECKF(!lc_scene_set_emission(s, at, none) && !lc_scene_update(s, NULL), "%s", last_error);
    CHECKF(!(total(s) > 0), "%g", total(s));
    CHECK(lc_scene_set_emission(s, at + 1, twice) == LC_ERR_ARG);
    lc_scene_destroy(s);
}

/* Large ones have fewer places, and many have few: 8, 8, 4, 4, 4, 4, 1, 1. */
TEST(many_lamps_that_move_have_few_places)
{
    enum { TRIANGLES = 120000 };
    static uint32_t indices[3 * TRIANGLES];
    static const float corners[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0 };
    const lc_xform a = lc_xform_identity(), b = lc_xform_translate((const double[3]){ 4, 0, 0 });
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_mesh_desc q = LC_BUILD_MESH_DESC_INIT;
    lc_load_desc d = LC_LOAD_DESC_INIT;
    lc_scene *s;
    d.area_lights = 16;
    for (uint32_t i = 0; i < 3 * TRIANGLES; i++) indices[i] = i % 3;
    CHECK(!lc_build_begin(ctx, &s) && !lc_build_usual_camera(s) && !lc_build_material(s, &m, &q.material));
    q.positions = corners;
    q.indices = indices;
    q.n_vertices = 3;
    q.n_triangles = TRIANGLES;
    q.emission[0] = 1;
    for (int i = 0; i < 8; i++) CHECKF(!lc_build_moving_lamp(s, &q, a.m, b.m), "%s", last_error);
    CHECKF(!lc_build_commit(s, &d), "%s", last_error);
    CHECKF(info_of(s).n_meshes == 8 + 34, "%llu", (unsigned long long)info_of(s).n_meshes);
    CHECK(info_of(s).n_triangles == 8 * TRIANGLES);
    lc_scene_destroy(s);
}

/* ---- what stands still ---- */

TEST(what_stands_still_is_said)
{
    lc_scene *s = scene_of(EYE ORTHO, MOVES("4") "LightSource \"infinite\" \"rgb L\" [1 1 1]\n" CARD);
    lc_note note = LC_NOTE_INIT;
    bool said = false;
    for (uint32_t i = 0; s && !lc_scene_get_note(s, i, &note); i++)
        said |= strstr(note.text, "stands where it is at the start") != NULL;
    CHECK(said);
    lc_scene_destroy(s);
}

TEST(hostile_motion_is_refused)
{
    const lc_xform a = lc_xform_identity(), flat = lc_xform_scale((const double[3]){ 1, 0, 1 });
    lc_xform bad = a;
    uint32_t object = 0;
    lc_scene *s;
    bad.m[3] = NAN;
    CHECK(lc_build_moving_instance(NULL, 0, a.m, a.m) == LC_ERR_ARG);
    CHECK(lc_build_camera_motion(NULL, a.m) == LC_ERR_ARG);
    CHECK(!lc_build_begin(ctx, &s) && !lc_build_object(s, &object));
    CHECK(lc_build_moving_instance(s, object, a.m, NULL) == LC_ERR_ARG && strstr(last_error, "to is NULL"));
    CHECK(lc_build_moving_instance(s, object, NULL, a.m) == LC_ERR_ARG);
    CHECK(lc_build_moving_instance(s, object, a.m, flat.m) == LC_ERR_ARG);
    CHECK(lc_build_moving_instance(s, object, bad.m, a.m) == LC_ERR_ARG);
    CHECK(lc_build_moving_instance(s, object + 1, a.m, a.m) == LC_ERR_ARG);
    CHECK(lc_build_camera_motion(s, a.m) == LC_ERR_ARG && strstr(last_error, "there is no camera"));
    CHECK(!lc_build_usual_camera(s));
    CHECK(lc_build_camera_motion(s, NULL) == LC_ERR_ARG);
    CHECK(lc_build_camera_motion(s, bad.m) == LC_ERR_ARG && lc_build_camera_motion(s, flat.m) == LC_ERR_ARG);
    lc_scene_destroy(s);
    s = scene_of(EYE ORTHO, "ActiveTransform EndTime Scale 1 0 1 ActiveTransform All\n" CARD);
    check_ramp("a shape that is flattened stands still", s, 0, 0.001);
    lc_scene_destroy(s);
    s = scene_of("ActiveTransform EndTime Scale 1 -1 1 ActiveTransform All\n" EYE ORTHO,
                 "ActiveTransform EndTime Scale 1 -1 1 ActiveTransform All\n" CARD);
    check_ramp("there is no way to a mirror image", s, 0, 0.001);
    lc_scene_destroy(s);
    s = scene_of(EYE ORTHO, "ActiveTransform EndTime Scale 1 1e-4 1 ActiveTransform All\n" CARD);
    check_ramp("a shape whose transform becomes extreme stands still", s, 0, 0.001);
    lc_scene_destroy(s);
}

static lc_status render_in(lc_context *c)
{
    lc_scene *s;
    lc_image *image = NULL;
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_status st = lc_scene_load(c, scene_path(), NULL, &s);
    if (!st) st = lc_render(c, s, &d, &image, NULL);
    lc_image_destroy(image);
    lc_scene_destroy(s);
    return st;
}

TEST(memory_may_end_anywhere)
{
    lc_scene *s = scene_of(MOVES("1") EYE ORTHO "Sampler \"independent\" \"integer pixelsamples\" 2\n",
                           MOVES("4") CARD "AreaLightSource \"diffuse\"\n" CARD);
    lc_scene_destroy(s);
    starve(render_in, 300);
}

int main(void)
{
    temp_begin();
    ctx = quiet_context(0);
    RUN(between_two_transforms_things_turn_about_one_axis);
    RUN(a_transform_that_flattens_is_between_nothing);
    RUN(a_moving_edge_is_a_ramp);
    RUN(calls_make_the_same_motion);
    RUN(what_is_set_again_stands_still);
    RUN(one_sample_sees_the_middle);
    RUN(motion_is_the_mean_of_what_stands_still);
    RUN(cuts_keep_the_error_that_is_asked);
    RUN(threads_and_crops_give_the_same_bytes);
    RUN(bounced_light_has_the_same_bytes);
    RUN(haze_and_glass_move_along);
    RUN(a_lamp_that_moves_is_a_ramp);
    RUN(light_of_a_lamp_that_moves_is_spread_along_its_way);
    RUN(a_lamp_does_not_stand_in_its_own_light);
    RUN(calls_make_lamps_that_move);
    RUN(a_lamp_that_moves_is_dimmed);
    RUN(many_lamps_that_move_have_few_places);
    RUN(a_light_that_moves_is_spread_along_its_way);
    RUN(what_stands_still_is_said);
    RUN(hostile_motion_is_refused);
    RUN(memory_may_end_anywhere);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
