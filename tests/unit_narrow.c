/* unit_narrow.c - narrow lobes under lamps: pixels of a GGX plate in and beside the highlight of a spherical
 * lamp against an integral over the lamp in double precision, with and without bounced light; the sky over a
 * wall. */
#include "scene/scene.h"
#include "support/near.h"
#include "support/pictures.h"
#include "support/scene_text.h"

#include <math.h>

static lc_context *ctx;

#define SIDE 33   /* pixels of the film, of which the middle column is looked at */
#define STEPS 400 /* of the integral, along each of two coordinates */
#define KS 0.5
#define RADIANCE 10.0

typedef struct v3 {
    double x, y, z;
} v3;

static const v3 eye = { 0, 2, -4 }, lamp = { 0, 2, 4 };
static v3 add(v3 a, double s, v3 b) { return (v3){ a.x + s * b.x, a.y + s * b.y, a.z + s * b.z }; }
static double dot(v3 a, v3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static v3 unit(v3 a) { return add((v3){ 0, 0, 0 }, 1 / sqrt(dot(a, a)), a); }

/* GGX of [Walter07] times the cosine of i, on the plane y = 0. */
static double brdf_cos(v3 i, v3 o, double alpha)
{
    const v3 h = unit(add(i, 1, o));
    double a2 = alpha * alpha, b = h.y * h.y * (a2 - 1) + 1, d = a2 / (LC_PI * b * b);
    double li = sqrt(1 + a2 * (1 / (i.y * i.y) - 1)), lo = sqrt(1 + a2 * (1 / (o.y * o.y) - 1));
    double g = 2 / (li + lo), f = KS + (1 - KS) * pow(1 - dot(h, o), 5);
    return i.y > 0 ? f * d * g / (4 * o.y) : 0;
}

/* Radiance from the plate's point at x towards the eye: over the cone of directions that the lamp fills. */
static double integral(v3 x, double radius, double alpha)
{
    const v3 o = unit(add(eye, -1, x)), to = add(lamp, -1, x), w = unit(to), u = { 1, 0, 0 };
    const v3 v = { w.y * u.z - w.z * u.y, w.z * u.x - w.x * u.z, w.x * u.y - w.y * u.x };
    double least = sqrt(1 - radius * radius / dot(to, to)), sum = 0;
    for (int a = 0; a < STEPS; a++)
        for (int b = 0; b < STEPS; b++) {
            double c = 1 - (a + 0.5) / STEPS * (1 - least), s = sqrt(1 - c * c), phi = 2 * LC_PI * b / STEPS;
            v3 i = add(add(add((v3){ 0, 0, 0 }, c, w), s * cos(phi), u), s * sin(phi), v);
            sum += brdf_cos(i, o, alpha);
        }
    return RADIANCE * sum * 2 * LC_PI * (1 - least) / (STEPS * STEPS);
}

static lc_image *render(double radius, double alpha, uint32_t n_lights, uint32_t n_indirect, const char *more)
{
    lc_load_desc load = LC_LOAD_DESC_INIT;
    lc_render_desc desc = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    load.area_lights = n_lights;
    load.indirect_lights = n_indirect;
    lc_scene *scene = scene_from_text(
        ctx, &load,
        "Film \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d\n"
        "Sampler \"independent\" \"integer pixelsamples\" 1\nIntegrator \"path\"\n"
        "LookAt 0 2 -4  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 20\nWorldBegin\n"
        "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [%g %g %g] Translate 0 2 4\n"
        "Material \"diffuse\" \"rgb reflectance\" [0 0 0] Shape \"sphere\" \"float radius\" %g AttributeEnd\n"
        "Material \"ggx\" \"rgb Kd\" [0 0 0] \"rgb Ks\" [%g %g %g] \"float roughness\" %g\n"
        "Shape \"trianglemesh\" \"point3 P\" [-3 0 -3  3 0 -3  3 0 3  -3 0 3] "
        "\"integer indices\" [0 1 2 0 2 3]\n%s",
        SIDE, SIDE, RADIANCE, RADIANCE, RADIANCE, radius, KS, KS, KS, alpha, more);
    CHECK(scene && !scene->indirect.n_lights == (n_indirect == LC_NO_LIGHTS));
    CHECK(scene && lc_render(ctx, scene, &desc, &image, NULL) == LC_OK);
    lc_scene_destroy(scene);
    return image;
}

TEST(plate_under_a_ball)
{
    static const struct { double radius, alpha; } cases[] = {
        { 0.3, 0.005 }, { 0.3, 0.02 }, { 0.3, 0.045 }, { 0.3, 0.1 }, { 0.03, 0.005 }, { 0.03, 0.02 }
    };
    const v3 forward = unit(add((v3){ 0, 0, 0 }, -1, eye)), up = { 0, -forward.z * -1, -forward.y };
    for (size_t i = 0; i < 2 * (sizeof cases / sizeof *cases); i++) {
        double radius = cases[i / 2].radius, alpha = cases[i / 2].alpha, want[SIDE], most = 0, worst = 0;
        lc_image *image = render(radius, alpha, 20000, i & 1 ? 1000 : LC_NO_LIGHTS, "");
        for (int y = 0; y < SIDE; y++) {
            v3 d = add(forward, (1 - 2 * (y + 0.5) / SIDE) * tan(LC_PI / 18), unit(up));
            want[y] = integral(add(eye, -eye.y / d.y, d), radius, alpha);
            most = fmax(most, want[y]);
        }
        for (int y = 0; y < SIDE && image; y++) {
            double got = pixel_at(image, "G", SIDE / 2, (uint32_t)y);
            worst = fmax(worst, fabs(got - want[y]) / (want[y] + 0.02 * most));
        }
        CHECKF(worst < 0.06, "radius %g, alpha %g, %s bounced light: off by %g", radius, alpha,
               i & 1 ? "with" : "without", worst);
        lc_image_destroy(image);
    }
}

/* A lamp behind a sheet of glass is shown once, dimmed: by its lights, whose shadow rays pass it. */
TEST(lamp_behind_glass)
{
    lc_image *open = render(0.3, 0.02, 20000, 1000, ""),
             *behind = render(0.3, 0.02, 20000, 1000,
                              "Material \"thindielectric\" Shape \"trianglemesh\" "
                              "\"point3 P\" [-9 -9 2  9 -9 2  9 9 2  -9 9 2] "
                              "\"integer indices\" [0 1 2 0 2 3]");
    double sum[2] = { 0, 0 };
    for (uint32_t i = 0; i < SIDE * SIDE && open && behind; i++) {
        sum[0] += pixel_at(open, "G", i % SIDE, i / SIDE);
        sum[1] += pixel_at(behind, "G", i % SIDE, i / SIDE);
    }
    printf("    behind glass %.4f of the light\n", sum[1] / sum[0]);
    CHECKF(near_abs(sum[1] / sum[0], 0.92, 0.01), "%g", sum[1] / sum[0]);
    lc_image_destroy(open);
    lc_image_destroy(behind);
}

/* ---- the sky ---- */

#define WALL_Z 4.0
#define WALL_Y 2.0

/* What the plate's point at x shows the eye of a sky of radiance 1 above and before a black wall: the
 * integral in rings about the mirror direction, closer together towards it. */
static double of_sky(v3 x, double alpha)
{
    enum { RINGS = 800, AROUND = 240 };
    const v3 o = unit(add(eye, -1, x)), m = { -o.x, o.y, -o.z }, u = unit((v3){ m.y, -m.x, 0 });
    const v3 v = { m.y * u.z - m.z * u.y, m.z * u.x - m.x * u.z, m.x * u.y - m.y * u.x };
    double sum = 0;
    for (int a = 0; a < RINGS; a++)
        for (int b = 0; b < AROUND; b++) {
            const double t = (a + 0.5) / RINGS, angle = LC_PI / 2 * t * t, s = sin(angle),
                         phi = 2 * LC_PI * (b + 0.5) / AROUND;
            const v3 i = add(add(add((v3){ 0, 0, 0 }, cos(angle), m), s * cos(phi), u), s * sin(phi), v);
            if (i.z > 0 && x.y + i.y / i.z * (WALL_Z - x.z) < WALL_Y) continue;
            sum += brdf_cos(i, o, alpha) * s * (LC_PI * t / RINGS) * (2 * LC_PI / AROUND);
        }
    return sum;
}

/* Across the edge of the wall: by 64 samples, rows in the mean of some columns. */
TEST(sky_over_a_wall)
{
    static const double alphas[] = { 0.01, 0.02, 0.045 };
    const v3 forward = unit(add((v3){ 0, 0, 0 }, -1, eye)), up = { 0, -forward.z * -1, -forward.y };
    for (size_t k = 0; k < sizeof alphas / sizeof *alphas; k++) {
        lc_load_desc load = LC_LOAD_DESC_INIT;
        lc_render_desc desc = LC_RENDER_DESC_INIT;
        lc_image *image = NULL;
        double worst = 0, least = 1, grain = 0;
        load.indirect_lights = LC_NO_LIGHTS;
        desc.spp = 64;
        lc_scene *scene = scene_from_text(
            ctx, &load,
            "Film \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d\nPixelFilter \"box\"\n"
            "LookAt 0 2 -4  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 20\nWorldBegin\n"
            "LightSource \"infinite\" \"rgb L\" [1 1 1]\n"
            "Material \"diffuse\" \"rgb reflectance\" [0 0 0]\n"
            "Shape \"trianglemesh\" \"point3 P\" [-90 -9 %g  90 -9 %g  90 %g %g  -90 %g %g] "
            "\"integer indices\" [0 1 2 0 2 3]\n"
            "Material \"ggx\" \"rgb Kd\" [0 0 0] \"rgb Ks\" [%g %g %g] \"float roughness\" %g\n"
            "Shape \"trianglemesh\" \"point3 P\" [-3 0 -3  3 0 -3  3 0 3  -3 0 3] "
            "\"integer indices\" [0 1 2 0 2 3]",
            SIDE, SIDE, WALL_Z, WALL_Z, WALL_Y, WALL_Z, WALL_Y, WALL_Z, KS, KS, KS, alphas[k]);
        CHECK(scene && lc_render(ctx, scene, &desc, &image, NULL) == LC_OK);
        for (int y = 0; y < SIDE && image; y++) {
            const v3 d = add(forward, (1 - 2 * (y + 0.5) / SIDE) * tan(LC_PI / 18), unit(up));
            const double want = of_sky(add(eye, -eye.y / d.y, d), alphas[k]);
            double got = 0;
            for (int x = -4; x <= 4; x++)
                got += pixel_at(image, "G", (uint32_t)(SIDE / 2 + x), (uint32_t)y) / 9;
            for (int x = -4; x <= 4; x++) {
                const double v = pixel_at(image, "G", (uint32_t)(SIDE / 2 + x), (uint32_t)y);
                grain += (v - got) * (v - got) / (9 * SIDE);
            }
            worst = fmax(worst, fabs(got - want));
            least = fmin(least, want);
        }
        printf("    roughness %g: off by %.4f at most; %.4f where the wall is; grain %.4f\n", alphas[k],
               worst, least, sqrt(grain));
        CHECKF(worst < 0.02 && sqrt(grain) < 0.005, "roughness %g: off by %g, grain %g", alphas[k], worst,
               sqrt(grain));
        lc_image_destroy(image);
        lc_scene_destroy(scene);
    }
}

/* With so few lights each would be a dot in this lobe, many times as bright as the lamp. */
TEST(few_lights_are_no_dots)
{
    lc_image *image = render(0.3, 0.005, 60, LC_NO_LIGHTS, "");
    double most = 0, want = integral((v3){ 0, 0, 0 }, 0.3, 0.005);
    for (uint32_t i = 0; i < SIDE * SIDE && image; i++)
        most = fmax(most, pixel_at(image, "G", i % SIDE, i / SIDE));
    CHECKF(most > 0.3 * want && most < 1.3 * want, "%g, of a lamp seen as %g", most, want);
    lc_image_destroy(image);
}

int main(void)
{
    ctx = quiet_context(2);
    temp_begin();
    RUN(plate_under_a_ball);
    RUN(few_lights_are_no_dots);
    RUN(lamp_behind_glass);
    RUN(sky_over_a_wall);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
