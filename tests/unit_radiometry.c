/* unit_radiometry.c - radiances of pictures against closed forms, through the public calls only: every kind
 * of light and lobe, by cuts and by the exact method, both sides of a surface, the camera's geometry; and the
 * same bits for any crop, number of threads and instruction set. */
#include "support/isas.h"
#include "support/pictures.h"
#include "support/scene_text.h"
#include "support/vec_d.h"

#define PI 3.14159265358979323846

static char text[1 << 16]; /* of the scene, from begin on */
static size_t n_text;

LC_PRINTF(1, 2)
static void add(const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    n_text += (size_t)vsnprintf(text + n_text, sizeof text - n_text, fmt, args);
    va_end(args);
    if (n_text >= sizeof text) abort();
}

LC_PRINTF(1, 2)
static void begin(const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    n_text = (size_t)vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
}

/* What a scene is loaded and rendered with. */
typedef struct {
    uint32_t threads, area_lights, spp, aovs, n_reps;
    lc_isa isa;
    lc_method method;
    float error_ratio;
    int32_t crop[4];
} how;

typedef struct {
    lc_context *ctx;
    lc_image *image;
    lc_image_desc desc;
    lc_render_stats stats;
} shot;

/* Renders the text; false if that failed. */
static bool shoot(shot *s, const how *h)
{
    lc_load_desc ld = LC_LOAD_DESC_INIT;
    lc_render_desc rd = LC_RENDER_DESC_INIT;
    ld.indirect_lights = LC_NO_LIGHTS;
    *s = (shot){ .ctx = quiet_context_of(h->threads ? h->threads : 1, h->isa),
                 .desc = LC_IMAGE_DESC_INIT,
                 .stats = LC_RENDER_STATS_INIT };
    ld.area_lights = h->area_lights;
    ld.n_reps = h->n_reps;
    rd.method = h->method;
    rd.error_ratio = h->error_ratio;
    rd.spp = h->spp;
    rd.aovs = h->aovs;
    rd.max_cut = 0;
    memcpy(rd.crop, h->crop, sizeof rd.crop);
    lc_scene *scene = scene_from_text(s->ctx, &ld, "%s", text);
    lc_status st = scene ? lc_render(s->ctx, scene, &rd, &s->image, &s->stats) : LC_ERR_ARG;
    lc_scene_destroy(scene);
    CHECKF(!st, "%s: %s", lc_status_name(st), last_error);
    if (st) lc_context_destroy(s->ctx);
    else lc_image_get_desc(s->image, &s->desc);
    return !st;
}

static void drop(shot *s)
{
    lc_image_destroy(s->image);
    lc_context_destroy(s->ctx);
}

static double at(const shot *s, const char *name, uint32_t x, uint32_t y)
{
    return pixel_at(s->image, name, x, y);
}

/* The picture is one pixel; both methods must give `want`, within rel of its largest channel. */
static void expect_area(const double want[3], double rel, uint32_t area_lights, int line)
{
    static const char *const names[] = { "R", "G", "B" };
    double size = fmax(want[0], fmax(want[1], want[2]));
    for (int method = 0; method < 2; method++) {
        how h = { .method = method ? LC_METHOD_EXACT : LC_METHOD_LIGHTCUTS,
                  .area_lights = area_lights,
                  .spp = 1 };
        shot s;
        if (!shoot(&s, &h)) return;
        for (int k = 0; k < 3; k++) {
            double got = at(&s, names[k], 0, 0);
            CHECKF(fabs(got - want[k]) <= rel * size, "line %d, method %d, %s: %.9g, not %.9g (%.2g off)",
                   line, method, names[k], got, want[k], size > 0 ? (got - want[k]) / size : got);
        }
        drop(&s);
    }
}
#define EXPECT(want) expect_area(want, 1e-5, 0, __LINE__)
#define EXPECT_NEAR(want, rel, lights) expect_area(want, rel, lights, __LINE__)

static const double black[3] = { 0, 0, 0 };

/* A film of one pixel, whose only ray goes from the eye to the origin, a point of the floor y = 0. */
static void floor_scene(const double eye[3], const char *film, const char *material)
{
    begin("LookAt %.17g %.17g %.17g  0 0 0  0 0.1 1\nCamera \"perspective\" \"float fov\" 30\n", eye[0],
          eye[1], eye[2]);
    add("Film \"image\" \"integer xresolution\" 1 \"integer yresolution\" 1 %s\nWorldBegin\n%s\n", film,
        material);
    add("Shape \"trianglemesh\" \"point3 P\" [-9 0 -9  9 0 -9  9 0 10  -9 0 10] \"integer indices\" [0 1 2 0 "
        "2 3]\n");
}

static const double above[3] = { 0.3, 3, -0.2 }, below[3] = { 0.3, -3, -0.2 };
#define MATTE "Material \"matte\" \"rgb Kd\" [0.2 0.5 0.8]"
static const double rho[3] = { 0.2, 0.5, 0.8 };
static const double watts[3] = { 10, 20, 5 };
#define INTENSITY "\"rgb I\" [10 20 5]"

/* The radiance of the matte floor, rho / pi * I * factor. */
static void matte_answer(double factor, double want[3])
{
    for (int k = 0; k < 3; k++) want[k] = rho[k] / PI * watts[k] * factor;
}

static const double places[][3] = {
    { 0, 2, 0 }, { 0.7, 1.9, -0.4 }, { -3, 0.5, 2 }, { 0.2, 0.4, 0 }, { 200, 300, -100 }
};
#define N_PLACES (sizeof places / sizeof *places)

TEST(point_lights)
{
    double want[3];
    for (size_t i = 0; i < N_PLACES; i++) {
        const double *p = places[i], d = len_d(p);
        floor_scene(above, "", MATTE);
        add("LightSource \"point\" \"point3 from\" [%.17g %.17g %.17g] " INTENSITY "\n", p[0], p[1], p[2]);
        matte_answer(p[1] / d / (d * d), want);
        EXPECT(want);
    }
}

TEST(attenuation)
{
    static const double abc[][3] = {
        { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 2, 0.5, 0.25 }, { 0, 3, 1e-3 }
    };
    static const char *const kinds[] = { "point", "oriented" };
    double want[3];
    for (size_t i = 0; i < sizeof abc / sizeof *abc; i++)
        for (int k = 0; k < 2; k++) {
            const double *p = places[1], d = len_d(p), *a = abc[i];
            floor_scene(above, "", MATTE);
            add("LightSource \"%s\" \"point3 from\" [%.17g %.17g %.17g] \"vector3 direction\" [0 -1 "
                "0] " INTENSITY " \"float A\" %g \"float B\" %g \"float C\" %g\n",
                kinds[k], p[0], p[1], p[2], a[0], a[1], a[2]);
            matte_answer((k ? p[1] / d : 1) * p[1] / d / (a[0] + a[1] * d + a[2] * d * d), want);
            EXPECT(want);
        }
}

TEST(oriented_lights)
{
    static const double dirs[][3] = {
        { 0, -1, 0 }, { 0.3, -2, 0.2 }, { 1, -0.1, 0 }, { -5, -1, 0.3 }, { 0, 1, 0 }
    };
    double want[3];
    for (size_t i = 0; i < N_PLACES; i++)
        for (size_t k = 0; k < sizeof dirs / sizeof *dirs; k++) {
            const double *p = places[i], d = len_d(p), *w = dirs[k];
            double cos_phi = fmax(-dot_d(p, w) / (d * len_d(w)), 0);
            floor_scene(above, "", MATTE);
            add("LightSource \"oriented\" \"point3 position\" [%.17g %.17g %.17g] \"vector3 direction\" [%g "
                "%g %g] " INTENSITY "\n",
                p[0], p[1], p[2], w[0], w[1], w[2]);
            matte_answer(cos_phi * p[1] / d / (d * d), want);
            EXPECT(want);
        }
}

TEST(distant_lights)
{
    double want[3];
    for (size_t i = 0; i < N_PLACES; i++) {
        const double *p = places[i];
        floor_scene(above, "", MATTE);
        add("LightSource \"distant\" \"point3 from\" [%.17g %.17g %.17g] \"point3 to\" [0 0 0] \"rgb L\" [10 "
            "20 5]\n",
            p[0], p[1], p[2]);
        matte_answer(p[1] / len_d(p), want);
        EXPECT(want);
    }
}

/* Radiances of several lights add up. */
TEST(mixed_lights)
{
    double want[3], factor = 0;
    floor_scene(above, "", MATTE);
    for (size_t i = 0; i < 3; i++) {
        const double *p = places[i], d = len_d(p);
        add("LightSource \"point\" \"point3 from\" [%g %g %g] " INTENSITY "\n", p[0], p[1], p[2]);
        add("LightSource \"oriented\" \"point3 position\" [%g %g %g] \"vector3 direction\" [0 -1 "
            "0] " INTENSITY "\n",
            p[0], p[1], p[2]);
        add("LightSource \"distant\" \"point3 from\" [%g %g %g] \"rgb L\" [10 20 5]\n", p[0], p[1], p[2]);
        /* The distant light shines from there to its default, (0, 0, 1). */
        double e[3] = { p[0], p[1], p[2] - 1 };
        factor += p[1] / (d * d * d) * (1 + p[1] / d) + e[1] / len_d(e);
    }
    matte_answer(factor, want);
    EXPECT(want);
}

TEST(modified_phong)
{
    static const double exponents[] = { 0, 1, 7.5, 60, 2000 };
    static const double kd[3] = { 0.2, 0.5, 0.8 }, ks[3] = { 0.7, 0.1, 0.3 };
    double want[3];
    for (size_t i = 0; i < sizeof exponents / sizeof *exponents; i++)
        for (int k = 0; k < 3; k++) {
            double eye[3] = { 1.5, 3, -0.5 }, n = exponents[i], d;
            /* The light is close to the mirror direction (-1.5, 3, 0.5). */
            double p[3] = { -1.5 + 0.1 * k, 2.8, 0.5 + 0.05 * k };
            const double mirror[3] = { -eye[0], eye[1], -eye[2] };
            char material[200];
            snprintf(
                material, sizeof material,
                "Material \"phong\" \"rgb Kd\" [0.2 0.5 0.8] \"rgb Ks\" [0.7 0.1 0.3] \"float exponent\" %g",
                n);
            d = len_d(p);
            double cos_a = dot_d(p, mirror) / (d * len_d(mirror)), lobe = (n + 2) / (2 * PI) * pow(cos_a, n);
            static const char *const lights[] = { "point", "oriented", "distant" };
            double g[3] = { 1 / (d * d), p[1] / d / (d * d), 1 };
            for (int kind = 0; kind < 3; kind++) {
                floor_scene(eye, "", material);
                add("LightSource \"%s\" \"point3 from\" [%g %g %g] ", lights[kind], p[0], p[1], p[2]);
                add(kind == 2 ? "\"point3 to\" [0 0 0] \"rgb L\" [10 20 5]\n" : "\"rgb I\" [10 20 5] ");
                if (kind == 1) add("\"vector3 direction\" [0 -1 0]\n");
                for (int c = 0; c < 3; c++)
                    want[c] = (kd[c] / PI + ks[c] * lobe) * watts[c] * p[1] / d * g[kind];
                /* The error of a float cosine is some 2e-7, that of its n-th power n times as much. */
                EXPECT_NEAR(want, 1e-5 + n * 4e-7, 0);
            }
        }
}

/* [Walter05b]; u of the floor, the direction of uroughness, is (cos, 0, sin) of an angle. */
TEST(ward)
{
    static const double angles[] = { 0, 0.5, 2 }, kd[3] = { 0.2, 0.5, 0.8 }, ks[3] = { 0.7, 0.1, 0.3 };
    const double eye[3] = { 1.5, 3, -0.5 }, p[3] = { -1.3, 2.8, 0.7 }, a[2] = { 0.15, 0.4 };
    double want[3], o[3], i[3], d = len_d(p);
    for (int k = 0; k < 3; k++) {
        o[k] = eye[k] / len_d(eye);
        i[k] = p[k] / d;
    }
    for (size_t n = 0; n < sizeof angles / sizeof *angles; n++)
        for (int oriented = 0; oriented < 2; oriented++) {
            double c = cos(angles[n]), s = sin(angles[n]), x = 0, y = 0;
            begin("LookAt %.17g %.17g %.17g  0 0 0  0 0.1 1\nCamera \"perspective\" \"float fov\" 30\n",
                  eye[0], eye[1], eye[2]);
            add("Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\nWorldBegin\nMaterial "
                "\"ward\" \"rgb Kd\" "
                "[0.2 0.5 0.8] \"rgb Ks\" [0.7 0.1 0.3] \"float uroughness\" %g \"float vroughness\" %g\n",
                a[0], a[1]);
            add("Shape \"trianglemesh\" \"point3 P\" [-9 0 -9  9 0 -9  9 0 10  -9 0 10] \"integer indices\" "
                "[0 1 2 0 2 3]"
                "\"point2 uv\" [%g %g %g %g %g %g %g %g]\n",
                -9 * c - 9 * s, 9 * s - 9 * c, 9 * c - 9 * s, -9 * s - 9 * c, 9 * c + 10 * s, 10 * c - 9 * s,
                10 * s - 9 * c, 10 * c + 9 * s); /* u = x cos + z sin, v = z cos - x sin */
            add("LightSource \"%s\" \"point3 from\" [%g %g %g] " INTENSITY, oriented ? "oriented" : "point",
                p[0], p[1], p[2]);
            add(oriented ? " \"vector3 direction\" [0 -1 0]\n" : "\n");
            x = ((i[0] + o[0]) * c + (i[2] + o[2]) * s) / a[0];
            y = ((i[2] + o[2]) * c - (i[0] + o[0]) * s) / a[1];
            double e = exp(-(x * x + y * y) / ((i[1] + o[1]) * (i[1] + o[1]))),
                   g = (oriented ? i[1] : 1) / (d * d);
            for (int k = 0; k < 3; k++)
                want[k] = (kd[k] / PI + ks[k] * e / (4 * PI * a[0] * a[1] * sqrt(i[1] * o[1]))) * i[1] * g *
                          watts[k];
            EXPECT(want);
        }
}

TEST(both_sides_of_a_surface)
{
    double want[3];
    matte_answer(0.25, want);
    for (int eye = 0; eye < 2; eye++)
        for (int side = 0; side < 2; side++)
            for (int reverse = 0; reverse < 2; reverse++) {
                floor_scene(eye ? above : below, "", reverse ? MATTE "\nReverseOrientation" : MATTE);
                add("LightSource \"point\" \"point3 from\" [0 %d 0] " INTENSITY "\n", side ? 2 : -2);
                if (eye == side) EXPECT(want);
                else EXPECT(black);
            }
}

TEST(film_scale_multiplies)
{
    double want[3], one[3];
    matte_answer(0.25, one);
    floor_scene(above, "\"float scale\" 2.5", MATTE);
    add("LightSource \"point\" \"point3 from\" [0 2 0] " INTENSITY "\n");
    for (int k = 0; k < 3; k++) want[k] = 2.5 * one[k];
    EXPECT(want);
    begin("LookAt 0 3 0  0 0 0  0 0 1\nFilm \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1 "
          "\"float iso\" 150\n"
          "Camera \"perspective\" \"float shutteropen\" 0 \"float shutterclose\" 0.5\nWorldBegin\n"
          "Material \"diffuse\" \"rgb reflectance\" [0.2 0.5 0.8]\n"
          "Shape \"disk\" \"float radius\" 4\nRotate 90 1 0 0\nShape \"disk\" \"float radius\" 4\n"
          "Identity LightSource \"point\" \"point3 from\" [0 2 0] " INTENSITY "\n");
    for (int k = 0; k < 3; k++) want[k] = 0.75 * one[k];
    EXPECT(want);
}

TEST(light_scale_and_transform)
{
    double want[3];
    matte_answer(3 * 0.25, want);
    floor_scene(above, "", MATTE);
    add("Translate 5 0 0 Scale 2 2 2 LightSource \"point\" \"point3 from\" [-2.5 1 0] " INTENSITY
        " \"float scale\" 3\n");
    EXPECT(want);
}

TEST(shadows)
{
    static const char *const lights[] = {
        "LightSource \"point\" \"point3 from\" [0 4 0] " INTENSITY,
        "LightSource \"oriented\" \"point3 position\" [0 4 0] \"vector3 direction\" [0 -1 0] " INTENSITY,
        "LightSource \"distant\" \"point3 from\" [0 1 0] \"point3 to\" [0 0 0] \"rgb L\" [10 20 5]",
    };
    /* A blocker at height h above the origin; the eye is to the side, so that the blocker is not in the way.
     */
    static const double heights[] = { 0.01, 0.5, 3.9, 4.1, 1000 }, eye[3] = { 3, 1, 0.5 };
    static const double lit[3] = { 1. / 16, 1. / 16, 1 };
    double want[3];
    for (int kind = 0; kind < 3; kind++)
        for (size_t i = 0; i < sizeof heights / sizeof *heights; i++) {
            double h = heights[i], s = h < 0.1 ? 0.01 : 0.2;
            floor_scene(eye, "", MATTE);
            add("%s\nShape \"trianglemesh\" \"point3 P\" [%g %g %g  %g %g %g  0 %g %g] \"integer indices\" "
                "[0 1 2]\n",
                lights[kind], -s, h, -s, s, h, -s, h, 2 * s); /* around the y axis */
            bool open = kind < 2 && h > 4;
            matte_answer(lit[kind], want);
            if (open) EXPECT(want);
            else EXPECT(black);
        }
}

/* ---- area lights ---- */

/* A square emitter of half side a at height h, of radiance L = watts, that faces down; `before`: directives
 * before its shape. */
static void square_light(double a, double h, const char *before, const char *params)
{
    floor_scene((const double[]){ 3, 1, 0.5 }, "", MATTE);
    add("AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [10 20 5] %s\n%s\n", params, before);
    add("Shape \"trianglemesh\" \"point3 P\" [%.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g] "
        "\"integer indices\" [0 1 2 0 2 3]\nAttributeEnd\n", -a, h, -a, a, h, -a, a, h, a, -a, h, a);
}

/* Form factor of an element to a parallel square whose centre is above it: four times that to a quarter,
 * whose corner is above it. */
static double square_factor(double a, double h)
{
    double x = a / h, r = sqrt(1 + x * x);
    return 4 * (2 * x / r * atan(x / r)) / (2 * PI);
}

TEST(square_emitters)
{
    double want[3];
    /* The normal points down: cross(p1 - p0, p2 - p0) = (2a, 0, 0) x (2a, 0, 2a) = (0, -4a^2, 0). */
    for (int big = 0; big < 2; big++) {
        double a = big ? 1 : 0.001, h = 2;
        for (int k = 0; k < 3; k++) want[k] = rho[k] * watts[k] * square_factor(a, h);
        double rel = big ? 1e-3 : 1e-5;
        square_light(a, h, "", "");
        EXPECT_NEAR(want, rel, 4096);
        square_light(a, h, "ReverseOrientation", "");
        EXPECT(black);
        square_light(a, h, "Scale -1 1 1", ""); /* mirrored: pbrt flips the normal, which stays outside */
        EXPECT_NEAR(want, rel, 4096);
        square_light(a, h, "ReverseOrientation", "\"bool twosided\" true");
        EXPECT_NEAR(want, rel, 8192);
        for (int k = 0; k < 3; k++) want[k] *= 2;
        square_light(a, h, "", "\"float scale\" 2");
        EXPECT_NEAR(want, rel, 4096);
    }
}

/* The flux does not depend on the number of lights: from far away any number gives the same radiance. */
TEST(flux_is_kept)
{
    double want[3];
    for (uint32_t n = 1; n <= 3000; n = n * 3 + 1) {
        for (int k = 0; k < 3; k++) want[k] = rho[k] / PI * watts[k] * 4e-6 / 4;
        square_light(0.001, 2, "", "");
        EXPECT_NEAR(want, 1e-5, n);
    }
}

TEST(disk_and_sphere_emitters)
{
    double want[3];
    floor_scene((const double[]){ 3, 1, 0.5 }, "", MATTE);
    add("AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [10 20 5]\n"
        "Translate 0 2 0 Rotate 90 1 0 0 Shape \"disk\" \"float radius\" 0.5 AttributeEnd\n");
    /* E = pi L r^2 / (r^2 + h^2) */
    for (int k = 0; k < 3; k++) want[k] = rho[k] * watts[k] * 0.25 / (0.25 + 4);
    EXPECT_NEAR(want, 2e-3, 8192);
    floor_scene((const double[]){ 3, 1, 0.5 }, "", MATTE);
    add("AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [10 20 5]\n"
        "Translate 0 2 0 Shape \"sphere\" \"float radius\" 0.5 AttributeEnd\n");
    for (int k = 0; k < 3; k++) want[k] = rho[k] * watts[k] * 0.25 / 4; /* E = pi L (r / h)^2 */
    EXPECT_NEAR(want, 5e-3, 20000);
}

/* The camera looks at the front or the back of an emitter that reflects nothing. */
TEST(emitters_are_seen)
{
    static const double glow[3] = { 10, 20, 5 };
    for (int side = 0; side < 2; side++)
        for (int reverse = 0; reverse < 2; reverse++)
            for (int two = 0; two < 2; two++) {
                begin("LookAt 0.3 %d 0.1  0.2 0 0  0 0 1\nCamera \"perspective\"\nFilm \"image\" \"integer "
                      "xresolution\" 1 "
                      "\"integer yresolution\" 1\nWorldBegin\nMaterial \"matte\" \"rgb Kd\" [0 0 0]\n",
                      side ? 2 : -2);
                add("AreaLightSource \"diffuse\" \"rgb L\" [10 20 5] \"bool twosided\" %s %s\n",
                    two ? "true" : "false", reverse ? "ReverseOrientation" : "");
                add("Shape \"trianglemesh\" \"point3 P\" [-1 0 -1  1 0 -1  1 0 1] \"integer indices\" [0 1 "
                    "2]\n");
                if (two || (side == 0) != reverse) EXPECT(glow);
                else EXPECT(black);
            }
}

/* ---- camera ---- */

/* The position seen in each pixel, projected by the formulas of the pbrt manual, must be the pixel's centre.
 */
static void check_projection(uint32_t w, uint32_t h, double fov, bool mirrored)
{
    double eye[3] = { 2, 5, -6 }, look[3] = { 0.5, 0, 0.5 }, up[3] = { 0.1, 1, 0 }, z[3], x[3], y[3],
           worst = 0;
    shot s;
    how opts = { .aovs = LC_AOV_P | LC_AOV_Z | LC_AOV_N | LC_AOV_ALBEDO, .spp = 1 };
    begin("%s LookAt %g %g %g %g %g %g %g %g %g\nCamera \"perspective\" \"float fov\" %g\nFilm \"image\" "
          "\"integer xresolution\" "
          "%u \"integer yresolution\" %u\nWorldBegin\n" MATTE "\n",
          mirrored ? "Scale -1 1 1" : "", eye[0], eye[1], eye[2], look[0], look[1], look[2], up[0], up[1],
          up[2], fov, w, h);
    add("Shape \"trianglemesh\" \"point3 P\" [-999 0 -999 0 0 1999 999 0 -999] \"integer indices\" [0 1 2]\n"
        "LightSource \"point\" \"point3 from\" [0 9 0]\n");
    if (!shoot(&s, &opts)) return;
    for (int k = 0; k < 3; k++) z[k] = look[k] - eye[k];
    normalize_d(z);
    normalize_d(up);
    cross_d(up, z, x);
    normalize_d(x);
    cross_d(z, x, y);
    if (mirrored)
        for (int k = 0; k < 3; k++) x[k] = -x[k];
    double half = tan(fov * PI / 360), side = w < h ? w : h;
    for (uint32_t py = 0; py < h; py++)
        for (uint32_t px = 0; px < w; px++) {
            double p[3] = { at(&s, "P.X", px, py) - eye[0], at(&s, "P.Y", px, py) - eye[1],
                            at(&s, "P.Z", px, py) - eye[2] };
            double cz = dot_d(p, z), u = w / 2.0 + dot_d(p, x) / cz / half * side / 2,
                   v = h / 2.0 - dot_d(p, y) / cz / half * side / 2;
            worst = fmax(worst, fmax(fabs(u - (px + 0.5)), fabs(v - (py + 0.5))));
            /* The error is a few roundings of 2^-24 of the triangle's size, 3000. */
            CHECKF(fabs(at(&s, "Z", px, py) - cz) < 5e-4, "Z %g, not %g", at(&s, "Z", px, py), cz);
            CHECK(at(&s, "N.Y", px, py) > 0.999999 && at(&s, "Albedo.G", px, py) == 0.5);
        }
    /* P has the same error, of which a pixel, 20 degrees / 33 wide and 5 units away, is a hundred times as
     * much. */
    CHECKF(worst < 1e-2, "%u x %u, fov %g: %g pixels off", w, h, fov, worst);
    drop(&s);
}

TEST(points_project_to_their_pixels)
{
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        check_projection(40, 30, 50, mirrored);
        check_projection(30, 40, 50, mirrored);
        check_projection(33, 33, 20, mirrored);
        check_projection(64, 8, 35, mirrored);
    }
}

/* A small emitting square in a black picture of 80 x 80 pixels is in the pixel worked out by hand: at (1,
 * 0.5, 4) in camera space, with a field of view of 90 degrees, it is at (0.25, 0.125) of the screen -1..1,
 * which is pixel (50, 35) from the top left. */
TEST(handedness)
{
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        shot s;
        how opts = { .spp = 1 };
        uint32_t n_lit = 0;
        begin("%s Camera \"perspective\" \"float fov\" 90\nFilm \"image\" \"integer xresolution\" 80 "
              "\"integer yresolution\" 80\n"
              "WorldBegin\nAreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"bool twosided\" true\n",
              mirrored ? "Scale -1 1 1" : "");
        /* The centre of pixel (50, 35) is at (0.2625, 0.1125) of the screen. A pixel is 0.025 of the screen
         * wide, which is 0.1 at z = 4. */
        add("Translate 1.05 0.45 4 Shape \"trianglemesh\" \"point3 P\" [-.04 -.04 0 .04 -.04 0 .04 .04 0 "
            "-.04 .04 0] "
            "\"integer indices\" [0 1 2 0 2 3]\n");
        if (!shoot(&s, &opts)) return;
        for (uint32_t i = 0; i < 80 * 80; i++) n_lit += lc_image_channel(s.image, "G")[i] > 0;
        CHECKF(n_lit == 1 && at(&s, "G", mirrored ? 29 : 50, 35) > 0, "%u lit pixels", n_lit);
        drop(&s);
    }
}

/* ---- the same bits ---- */

static const char *const planes[] = { "R",        "G",        "B",        "N.X",     "N.Y",      "N.Z",
                                      "P.X",      "P.Y",      "P.Z",      "Z",       "cut.size", "cut.error",
                                      "cut.rays", "Albedo.R", "Albedo.G", "Albedo.B" };
#define N_PLANES (sizeof planes / sizeof *planes)

/* A room with a glossy ball, 200 lights of three kinds and an area light; 61 x 43 pixels. */
static void busy_scene(void)
{
    uint64_t seed = 12345;
    begin("LookAt 0 1 -3.5  0 0.9 0  0 1 0\nCamera \"perspective\" \"float fov\" 60\n"
          "Film \"image\" \"integer xresolution\" 61 \"integer yresolution\" 43\nSampler \"random\" "
          "\"integer pixelsamples\" 2\n"
          "WorldBegin\n" MATTE "\n"
          "Shape \"trianglemesh\" \"point3 P\" [-2 0 -2 2 0 -2 2 0 2 -2 0 2 -2 2 2 2 2 2]\n"
          "\"integer indices\" [0 1 2 0 2 3 3 2 5 3 5 4]\n"
          "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [3 2 1] Translate 0 2.2 0 Rotate 90 1 0 0\n"
          "Shape \"disk\" \"float radius\" 0.4 AttributeEnd\n"
          "Material \"phong\" \"rgb Kd\" [0.3 0.3 0.2] \"rgb Ks\" [0.4 0.4 0.4] \"float exponent\" 40\n"
          "AttributeBegin Translate 0.2 0.5 0 Shape \"sphere\" \"float radius\" 0.5 AttributeEnd\n");
    for (int i = 0; i < 200; i++) {
        double v[4];
        for (int k = 0; k < 4; k++) {
            seed = seed * 6364136223846793005u + 1442695040888963407u;
            v[k] = (double)(seed >> 40) / (1 << 24);
        }
        if (i % 3 == 0)
            add("LightSource \"point\" \"point3 from\" [%.4f %.4f %.4f] \"rgb I\" [%.3f 0.1 0.05]\n",
                4 * v[0] - 2, 2 * v[1], 4 * v[2] - 2, v[3]);
        else if (i % 3 == 1)
            add("LightSource \"oriented\" \"point3 position\" [%.4f 2 %.4f] \"vector3 direction\" [%.2f -1 "
                "0] "
                "\"rgb I\" [0.1 0.2 0.2]\n",
                4 * v[0] - 2, 4 * v[1] - 2, v[2] - 0.5);
        else
            add("LightSource \"distant\" \"point3 from\" [%.3f %.3f -1] \"point3 to\" [0 0 0] \"rgb L\" "
                "[0.01 0.01 0.02]\n",
                v[0] - 0.5, v[1]);
    }
}

static const how busy = {
    .threads = 1, .aovs = LC_AOV_ALL, .error_ratio = 0.02f, .area_lights = 100, .n_reps = 4
};

TEST(same_bits_for_any_thread_count)
{
    static const uint32_t threads[] = { 1, 2, 7 };
    for (int method = 0; method < 2; method++) {
        shot first, s;
        how h = busy;
        h.method = method ? LC_METHOD_EXACT : LC_METHOD_LIGHTCUTS;
        busy_scene();
        if (!shoot(&first, &h)) return;
        CHECK(lc_image_n_channels(first.image) == N_PLANES && first.stats.nonfinite == 0 &&
              first.stats.points > 2000 && first.desc.width == 61);
        for (int i = 0; i < 3; i++) {
            h.threads = threads[i];
            if (!shoot(&s, &h)) continue;
            CHECKF(same_planes(first.image, s.image), "%u threads, method %d", h.threads, method);
            CHECK(s.stats.shadow_rays == first.stats.shadow_rays && s.stats.cut_max == first.stats.cut_max);
            drop(&s);
        }
        drop(&first);
    }
}

TEST(same_bits_on_any_instruction_set)
{
    shot first, s;
    how h = busy;
    h.isa = LC_ISA_SCALAR;
    busy_scene();
    if (!shoot(&first, &h)) return;
    EACH_ISA(isa)
    {
        h.isa = isa;
        if (!shoot(&s, &h)) continue;
        CHECKF(lc_context_isa(s.ctx) == isa, "%s", lc_isa_name(isa));
        CHECKF(same_planes(first.image, s.image), "%s", lc_isa_name(isa));
        drop(&s);
    }
    drop(&first);
}

TEST(crop_is_a_part_of_the_whole)
{
    static const int32_t crops[][4] = {
        { 0, 61, 0, 43 }, { 17, 40, 5, 29 }, { 60, 61, 42, 43 }, { 0, 1, 0, 43 }, { 30, 61, 20, 21 }
    };
    shot full, s;
    how h = busy;
    busy_scene();
    if (!shoot(&full, &h)) return;
    for (size_t i = 0; i < sizeof crops / sizeof *crops; i++) {
        const int32_t *c = crops[i];
        memcpy(h.crop, c, sizeof h.crop);
        h.threads = 2;
        if (!shoot(&s, &h)) continue;
        uint32_t w = (uint32_t)(c[1] - c[0]), rows = (uint32_t)(c[3] - c[2]);
        CHECK(s.desc.width == w && s.desc.height == rows && s.desc.x0 == c[0] && s.desc.y0 == c[2]);
        CHECK(s.desc.display_width == 61 && s.desc.display_height == 43);
        for (size_t k = 0; k < N_PLANES; k++)
            for (uint32_t y = 0; y < rows; y++) {
                const float *a = lc_image_channel(full.image, planes[k]) + (size_t)(y + (uint32_t)c[2]) * 61 +
                                 c[0];
                const float *b = lc_image_channel(s.image, planes[k]) + (size_t)y * w;
                CHECKF(!memcmp(a, b, w * sizeof *a), "crop %zu, %s, row %u", i, planes[k], y);
            }
        drop(&s);
    }
    drop(&full);
}

/* The mean error is below the error ratio, which is a bound of the error of each cluster, not of the total.
 */
TEST(lightcuts_is_near_exact)
{
    shot a, b;
    how h = busy;
    double worst = 0, sum = 0;
    busy_scene();
    if (!shoot(&a, &h)) return;
    h.method = LC_METHOD_EXACT;
    if (shoot(&b, &h)) {
        for (uint32_t y = 0; y < 43; y++)
            for (uint32_t x = 0; x < 61; x++) {
                double e = at(&b, "G", x, y), off = fabs(at(&a, "G", x, y) - e);
                if (e > 0) {
                    worst = fmax(worst, off / e);
                    sum += off / e;
                }
            }
        printf("  mean cut %.1f of 300, mean error %.4f, largest %.4f\n", a.stats.cut_mean, sum / (61 * 43),
               worst);
        CHECK(sum / (61 * 43) < 0.02 && a.stats.cut_mean < 250);
        drop(&b);
    }
    drop(&a);
}

int main(void)
{
    temp_begin();
    RUN(every_instruction_set_is_here);
    RUN(point_lights);
    RUN(attenuation);
    RUN(oriented_lights);
    RUN(distant_lights);
    RUN(mixed_lights);
    RUN(modified_phong);
    RUN(ward);
    RUN(both_sides_of_a_surface);
    RUN(film_scale_multiplies);
    RUN(light_scale_and_transform);
    RUN(shadows);
    RUN(square_emitters);
    RUN(flux_is_kept);
    RUN(disk_and_sphere_emitters);
    RUN(emitters_are_seen);
    RUN(points_project_to_their_pixels);
    RUN(handedness);
    RUN(same_bits_for_any_thread_count);
    RUN(same_bits_on_any_instruction_set);
    RUN(crop_is_a_part_of_the_whole);
    RUN(lightcuts_is_near_exact);
    temp_end();
    return test_done();
}
