/* unit_camera.c - rays of every camera against their definitions; pixel filters against integrals of the
 * functions in pbrt's books; stratification of the sampler's points; white balance against a picture by
 * pbrt-v4; and the cameras, filters and films that scene files describe. */
#include "base/sample.h"
#include "pbrt/state.h"
#include "scene/camera.h"
#include "support/one_scene.h"

static const double centre[2] = { 0.5, 0.5 };

static lc_camera_desc desc_of(lc_camera_kind kind)
{
    return (lc_camera_desc){ .kind = kind,
                             .world_to_camera = { 1, 0, 0, -1, 0, 1, 0, -2, 0, 0, 1, -3, 0, 0, 0, 1 },
                             .fov_degrees = 90,
                             .screen = { -2, 2, -1, 1 } };
}

static void check_ray(const lc_camera *c, double x, double y, const double lens[2], const double org[3],
                      const double dir[3])
{
    lc_f3 o, d;
    lc_camera_ray(c, x, y, lens, &o, &d);
    double len = sqrt(dir[0] * dir[0] + dir[1] * dir[1] + dir[2] * dir[2]);
    const double got[6] = { (double)o.x, (double)o.y, (double)o.z, (double)d.x, (double)d.y, (double)d.z };
    for (int k = 0; k < 3; k++) {
        CHECKF(fabs(got[k] - org[k]) < 1e-6, "pixel %g %g origin[%d] %g, not %g", x, y, k, got[k], org[k]);
        CHECKF(fabs(got[3 + k] - dir[k] / len) < 1e-6, "pixel %g %g direction[%d] %g, not %g", x, y, k,
               got[3 + k], dir[k] / len);
    }
}

#define V(...) ((const double[]){ __VA_ARGS__ })

TEST(rays)
{
    lc_camera c;
    lc_camera_desc d = desc_of(LC_CAMERA_PERSPECTIVE);
    CHECK(lc_camera_init(&c, &d, 200, 100));
    check_ray(&c, 100, 50, centre, V(1, 2, 3), V(0, 0, 1));
    check_ray(&c, 0, 0, centre, V(1, 2, 3), V(-2, 1, 1));
    check_ray(&c, 200, 100, V(0.9, 0.1), V(1, 2, 3), V(2, -1, 1));
    for (int i = 0; i < 9; i++) { /* and back */
        const double x = i % 3 * 90 + 3, y = i / 3 * 40 + 4;
        double px, py;
        lc_f3 o, dir;
        lc_camera_ray(&c, x, y, centre, &o, &dir);
        CHECK(lc_camera_project(&c, lc_f3_scale(dir, 7), &px, &py) && fabs(px - x) + fabs(py - y) < 1e-3);
        CHECK(!lc_camera_project(&c, lc_f3_neg(dir), &px, &py));
    }
    d = desc_of(LC_CAMERA_ORTHOGRAPHIC);
    CHECK(lc_camera_init(&c, &d, 200, 100) && fabs(c.pixel - 0.02) < 1e-12);
    check_ray(&c, 0, 0, centre, V(-1, 3, 3), V(0, 0, 1));
    check_ray(&c, 150, 100, centre, V(2, 1, 3), V(0, 0, 1));
    /* The top row looks up, the middle of a row along -x, a quarter of a row along +z. */
    d = desc_of(LC_CAMERA_LATLONG);
    CHECK(lc_camera_init(&c, &d, 200, 100));
    check_ray(&c, 17, 0, centre, V(1, 2, 3), V(0, 1, 0));
    check_ray(&c, 100, 50, centre, V(1, 2, 3), V(-1, 0, 0));
    check_ray(&c, 50, 50, centre, V(1, 2, 3), V(0, 0, 1));
    check_ray(&c, 25, 25, centre, V(1, 2, 3), V(sqrt(0.25), sqrt(0.5), sqrt(0.25)));
    d = desc_of(LC_CAMERA_EQUAL_AREA); /* +y is in the middle, -y in the corners */
    CHECK(lc_camera_init(&c, &d, 100, 100));
    check_ray(&c, 50, 50, centre, V(1, 2, 3), V(0, 1, 0));
    check_ray(&c, 100, 0, centre, V(1, 2, 3), V(0, -1, 0));
    check_ray(&c, 100, 50, centre, V(1, 2, 3), V(1, 0, 0));
    check_ray(&c, 50, 100, centre, V(1, 2, 3), V(0, 0, 1));
}

/* All rays of a pixel start on the lens, and meet where the ray through the lens's centre crosses the plane
 * in focus. */
TEST(lens)
{
    for (int kind = LC_CAMERA_PERSPECTIVE; kind <= LC_CAMERA_ORTHOGRAPHIC; kind++) {
        lc_camera c;
        lc_camera_desc d = desc_of((lc_camera_kind)kind);
        d.lens_radius = 0.25;
        d.focal_distance = 4;
        CHECK(lc_camera_init(&c, &d, 200, 100));
        for (int i = 0; i < 256; i++) {
            double u[2];
            lc_f3 o0, d0, o, dir;
            lc_sample_pair(77, (uint32_t)i, u);
            lc_camera_ray(&c, 30, 20, centre, &o0, &d0);
            lc_camera_ray(&c, 30, 20, u, &o, &dir);
            double t0 = (7 - (double)o0.z) / (double)d0.z, t = (7 - (double)o.z) / (double)dir.z;
            CHECK(fabs((double)o0.x + t0 * (double)d0.x - (double)o.x - t * (double)dir.x) < 1e-5);
            CHECK(fabs((double)o0.y + t0 * (double)d0.y - (double)o.y - t * (double)dir.y) < 1e-5);
            CHECK(hypot((double)(o.x - o0.x), (double)(o.y - o0.y)) <= 0.25 + 1e-6);
        }
    }
}

TEST(bad_cameras_are_refused)
{
    lc_camera c;
    lc_camera_desc d = desc_of(LC_CAMERA_PERSPECTIVE);
    d.fov_degrees = 180;
    CHECK(!lc_camera_init(&c, &d, 10, 10));
    d = desc_of(LC_CAMERA_ORTHOGRAPHIC);
    d.screen[1] = -2;
    CHECK(!lc_camera_init(&c, &d, 10, 10));
    d = desc_of(LC_CAMERA_PERSPECTIVE);
    d.lens_radius = 1;
    CHECK(!lc_camera_init(&c, &d, 10, 10)); /* no focal distance */
    d.focal_distance = NAN;
    CHECK(!lc_camera_init(&c, &d, 10, 10));
    d = desc_of(LC_CAMERA_LATLONG);
    d.world_to_camera[0] = 0;
    CHECK(!lc_camera_init(&c, &d, 10, 10));
}

/* Of 16 points one lies in each cell of a 4 x 4 grid; of 256 points one in each of 256 columns and rows. */
TEST(points_are_spread)
{
    for (uint64_t key = 1; key < 50; key++) {
        int cell[16] = { 0 }, column[256] = { 0 }, row[256] = { 0 };
        for (uint32_t i = 0; i < 256; i++) {
            double u[2];
            lc_sample_pair(lc_mix(key), i, u);
            CHECK(u[0] >= 0 && u[0] < 1 && u[1] >= 0 && u[1] < 1);
            if (i < 16) cell[(int)(u[0] * 4) * 4 + (int)(u[1] * 4)]++;
            column[(int)(u[0] * 256)]++;
            row[(int)(u[1] * 256)]++;
        }
        for (int k = 0; k < 16; k++) CHECK(cell[k] == 1);
        for (int k = 0; k < 256; k++) CHECK(column[k] == 1 && row[k] == 1);
    }
}

/* The filters as pbrt's books define them. */
static double true_filter(const lc_pixel_filter_desc *d, double r, double x)
{
    double v = fabs(2 * x / r), b = d->shape[0], c = d->shape[1];
    switch (d->kind) {
    case LC_PIXEL_BOX: return 1;
    case LC_PIXEL_TRIANGLE: return fmax(0, r - fabs(x));
    case LC_PIXEL_GAUSSIAN: return exp(-b * x * x) - exp(-b * r * r);
    case LC_PIXEL_SINC:
        return fabs(x) < 1e-5 ? 1 : sin(LC_PI * x) / (LC_PI * x) * (sin(LC_PI * x / b) / (LC_PI * x / b));
    case LC_PIXEL_MITCHELL: break;
    }
    if (v > 1)
        return ((-b - 6 * c) * v * v * v + (6 * b + 30 * c) * v * v + (-12 * b - 48 * c) * v +
                (8 * b + 24 * c)) /
               6;
    return ((12 - 9 * b - 6 * c) * v * v * v + (-18 + 12 * b + 6 * c) * v * v + (6 - 2 * b)) / 6;
}

static double smooth(double x, double y) { return 1 + 0.5 * cos(1.3 * x + 0.2) * (y + 0.3) + 0.2 * x * y; }

/* The mean over samples is the integral of filter times function over that of the filter. */
TEST(filters)
{
    const lc_pixel_filter_desc filters[] = {
        { LC_PIXEL_BOX, { 0.5, 0.7 }, { 0, 0 } },      { LC_PIXEL_TRIANGLE, { 2, 1 }, { 0, 0 } },
        { LC_PIXEL_GAUSSIAN, { 1.5, 1.5 }, { 2, 0 } }, { LC_PIXEL_MITCHELL, { 2, 3 }, { 1, 0 } },
    };
    for (size_t f = 0; f < sizeof filters / sizeof *filters; f++) {
        const lc_pixel_filter_desc *d = &filters[f];
        static lc_pixel_filter table;
        double sum = 0, weight = 0, want = 0, all = 0;
        CHECK(lc_pixel_filter_init(&table, d));
        for (uint32_t i = 0; i < 1 << 18; i++) {
            double u[2], x[2];
            lc_sample_pair(5, i, u);
            lc_pixel_filter_sample(&table, u, x);
            CHECK(fabs(x[0]) <= d->radius[0] && fabs(x[1]) <= d->radius[1]);
            sum += smooth(x[0], x[1]);
            weight++;
        }
        for (int i = 0; i < 512; i++)
            for (int j = 0; j < 512; j++) {
                double x = ((i + 0.5) / 256 - 1) * d->radius[0], y = ((j + 0.5) / 256 - 1) * d->radius[1];
                double w = true_filter(d, d->radius[0], x) * true_filter(d, d->radius[1], y);
                want += w * smooth(x, y);
                all += w;
            }
        CHECKF(fabs(sum / weight - want / all) < 2e-3, "filter %zu: %g, not %g", f, sum / weight, want / all);
    }
    static lc_pixel_filter table;
    lc_pixel_filter_desc bad = { LC_PIXEL_BOX, { 0, 1 }, { 0, 0 } };
    CHECK(!lc_pixel_filter_init(&table, &bad));
    bad = (lc_pixel_filter_desc){ LC_PIXEL_GAUSSIAN, { 1, 1 }, { NAN, 0 } };
    CHECK(!lc_pixel_filter_init(&table, &bad));
    bad = (lc_pixel_filter_desc){ LC_PIXEL_BOX, { 1, 2147483300.0 }, { 0, 0 } };
    CHECK(!lc_pixel_filter_init(&table, &bad));
}

/* Against the colour of a grey surface under a white light in a picture by pbrt-v4 with this white balance.
 */
TEST(white_balance)
{
    static const double want[3] = { 0.828, 1.022, 1.369 };
    float m[9];
    CHECK(lc_pbrt_white_balance(5000, m));
    for (int i = 0; i < 3; i++) {
        double got = (double)(m[3 * i] + m[3 * i + 1] + m[3 * i + 2]);
        CHECKF(fabs(got - want[i]) < 0.006, "channel %d: %g, not %g", i, got, want[i]);
    }
    CHECK(!lc_pbrt_white_balance(3999, m) && !lc_pbrt_white_balance(NAN, m) &&
          !lc_pbrt_white_balance(1e9, m));
}

static lc_status load(const char *text)
{
    lc_load_desc few = LC_LOAD_DESC_INIT;
    few.indirect_lights = LC_NO_LIGHTS;
    return load_text(&few, "%s", text);
}

#define V3 "Film \"image\" \"integer xresolution\" 8 \"integer yresolution\" 8 "
#define V4 "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8 "
#define REST "Camera \"perspective\" WorldBegin "

static bool filter_is(lc_pixel_filter_kind kind, double rx, double ry, double a, double b)
{
    const lc_pixel_filter_desc *f = &scene->film.filter;
    return f->kind == kind &&
           fabs(f->radius[0] - rx) + fabs(f->radius[1] - ry) + fabs(f->shape[0] - a) + fabs(f->shape[1] - b) <
               1e-12;
}

TEST(scene_files)
{
    CHECK(load(V3 REST) == LC_OK && filter_is(LC_PIXEL_BOX, .5, .5, 0, 0));
    CHECK(load(V4 REST) == LC_OK && filter_is(LC_PIXEL_GAUSSIAN, 1.5, 1.5, 2, 0));
    CHECK(load("PixelFilter \"gaussian\" " V3 REST) == LC_OK && filter_is(LC_PIXEL_GAUSSIAN, 2, 2, 2, 0));
    CHECK(load("PixelFilter \"gaussian\" \"float sigma\" 1 \"float xradius\" 3 " V4 REST) == LC_OK &&
          filter_is(LC_PIXEL_GAUSSIAN, 3, 1.5, .5, 0));
    CHECK(load("PixelFilter \"mitchell\" \"float B\" 0 \"float xwidth\" 3 " V3 REST) == LC_OK &&
          filter_is(LC_PIXEL_MITCHELL, 3, 2, 0, 1.0 / 3));
    CHECK(load("PixelFilter \"sinc\" \"float tau\" 2 " V4 REST) == LC_OK &&
          filter_is(LC_PIXEL_SINC, 4, 4, 2, 0));
    CHECK(load("PixelFilter \"magic\" " V4 REST) == LC_OK && filter_is(LC_PIXEL_GAUSSIAN, 1.5, 1.5, 2, 0) &&
          scene->n_notes == 1);
    CHECK(load("PixelFilter \"box\" \"float ywidth\" [2147483300] " V3 REST) == LC_ERR_PARSE);
    CHECK(load("PixelFilter \"box\" \"float xradius\" [0] " V3 REST) == LC_ERR_PARSE);
    CHECK(load(V4 "Camera \"spherical\" WorldBegin") == LC_OK && scene->camera.kind == LC_CAMERA_EQUAL_AREA);
    CHECK(load(V4 "Camera \"spherical\" \"string mapping\" \"equirectangular\" WorldBegin") == LC_OK &&
          scene->camera.kind == LC_CAMERA_LATLONG);
    CHECK(load(V4 "Camera \"spherical\" \"string mapping\" \"flat\" WorldBegin") == LC_ERR_PARSE);
    CHECK(load(V3 "Camera \"environment\" WorldBegin") == LC_OK &&
          scene->camera.kind == LC_CAMERA_LATLONG);
    CHECK(load(V3 "Camera \"perspective\" \"float lensradius\" -1 WorldBegin") == LC_ERR_PARSE);
    CHECK(load("Sampler \"halton\" \"integer pixelsamples\" 64 " V3 REST) == LC_OK && scene->film.spp == 16 &&
          scene->n_notes == 1);
    CHECK(load(V3 "Sampler \"halton\" \"integer pixelsamples\" 64 Camera \"perspective\" \"float "
                  "lensradius\" 1 WorldBegin") == LC_OK &&
          scene->film.spp == 16);
    CHECK(load("Film \"rgb\" \"float whitebalance\" 5000 " REST) == LC_OK &&
          fabsf(scene->film.white[0] + scene->film.white[1] + scene->film.white[2] - 0.828f) < 0.006f);
    CHECK(load("Film \"rgb\" \"float whitebalance\" 100 " REST) == LC_ERR_PARSE);
    CHECK(load("Film \"rgb\" \"string sensor\" \"canon_eos_100d\" " REST) == LC_OK && scene->n_notes == 1);
}

int main(void)
{
    ctx = quiet_context(1);
    temp_begin();
    RUN(rays);
    RUN(lens);
    RUN(bad_cameras_are_refused);
    RUN(points_are_spread);
    RUN(filters);
    RUN(white_balance);
    RUN(scene_files);
    one_scene_end();
    temp_end();
    return test_done();
}
