/* unit_lux.c - illuminance at sensors through the public calls: closed forms of a plane, a cylinder and a
 * sphere under points, discs, rectangles and skies; the error that is asked, at all sensors and not only the
 * pilots; the same bytes however they are computed; what is refused. */
#include "lightcuts.h"
#include "support/isas.h"
#include "support/logged.h"

#include <math.h>

#define PATH        "build/unit_lux.pbrt"
#define IES         "build/unit_lux.ies"
#define PI          3.14159265358979323846
#define MAX_SENSORS 4096

typedef struct {
    lc_quantity quantity;
    lc_method method;
    uint32_t width, height, threads, indirect;
    lc_isa isa;
    float error;
} way;

typedef struct {
    double lux[MAX_SENSORS];
    float rgb[3][MAX_SENSORS];
    lc_render_stats stats;
    lc_status status;
} field;

static lc_sensor sensors[MAX_SENSORS];

static void write_text(const char *path, const char *text)
{
    FILE *f = fopen(path, "w");
    if (!f || fputs(text, f) < 0 || fclose(f)) abort();
}

static void write_scene(const char *text)
{
    char whole[1 << 16];
    snprintf(whole, sizeof whole, "WorldBegin\n%s\n", text);
    write_text(PATH, whole);
}

static void measure(way w, field *out)
{
    lc_context *ctx = quiet_context_of(w.threads ? w.threads : 2, w.isa);
    lc_load_desc load = LC_LOAD_DESC_INIT;
    lc_sensors_desc d = LC_SENSORS_DESC_INIT;
    lc_render_desc r = LC_RENDER_DESC_INIT;
    lc_scene *scene = NULL;
    lc_image *image = NULL;
    lc_image_desc size = LC_IMAGE_DESC_INIT;
    d.quantity = w.quantity;
    d.width = w.width;
    d.height = w.height;
    d.sensors = w.quantity == LC_LUMINANCE ? NULL : sensors;
    load.sensors = &d;
    load.indirect_lights = w.indirect ? w.indirect : LC_NO_LIGHTS;
    r.method = w.method;
    r.error = w.error;
    r.max_cut = 0;
    r.dark_floor = LC_ASKED_DARK_FLOOR;
    memset(out, 0, sizeof *out);
    out->stats = (lc_render_stats)LC_RENDER_STATS_INIT;
    out->status = lc_scene_load(ctx, PATH, &load, &scene);
    if (!out->status) out->status = lc_render(ctx, scene, &r, &image, &out->stats);
    if (!out->status) lc_image_get_desc(image, &size);
    const size_t n = (size_t)size.width * size.height;
    if (n > MAX_SENSORS) abort();
    for (int k = 0; k < 3 && n; k++)
        memcpy(out->rgb[k], lc_image_channel(image, (const char *[]){ "R", "G", "B" }[k]), n * sizeof(float));
    for (size_t i = 0; i < n; i++)
        out->lux[i] = 0.2126 * (double)out->rgb[0][i] + 0.7152 * (double)out->rgb[1][i] +
                      0.0722 * (double)out->rgb[2][i];
    lc_image_destroy(image);
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
}

static void set_sensor(uint32_t i, double x, double y, double z, double nx, double ny, double nz)
{
    const double len = sqrt(nx * nx + ny * ny + nz * nz);
    sensors[i] = (lc_sensor){ { (float)x, (float)y, (float)z },
                              { (float)(nx / len), (float)(ny / len), (float)(nz / len) },
                              0 };
}

static field f;

static double one(lc_quantity quantity)
{
    measure((way){ .quantity = quantity, .method = LC_METHOD_EXACT, .width = 1, .height = 1 }, &f);
    return f.status ? NAN : f.lux[0];
}

#define EXPECT(got, want, tolerance) expect(got, want, tolerance, __LINE__)
static void expect(double got, double want, double tolerance, int line)
{
    CHECKF(fabs(got - want) <= tolerance * fabs(want), "line %d: %.9g, not %.9g", line, got, want);
}

/* 1000 cd straight down, 500 cd from 60 degrees to the horizon, between them linear in degrees. */
#define LAMP "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 1 1 2 0.4 0.4 0 1 1 10\n0 60 90\n0\n1000 500 500\n"

TEST(one_luminaire_over_a_plane)
{
    write_text(IES, LAMP);
    write_scene("LightSource \"luminaire\" \"string filename\" \"unit_lux.ies\" \"point3 from\" [0 0 2]");
    for (int degrees = 0; degrees < 90; degrees += 7) {
        const double a = degrees * PI / 180, d = 2 / cos(a),
                     cd = degrees < 60 ? 1000 - 500 * degrees / 60.0 : 500;
        set_sensor(0, 2 * tan(a), 0, 0, 0, 0, 1);
        EXPECT(one(LC_ILLUMINANCE), cd * cos(a) / (d * d), 1e-5);
        EXPECT(one(LC_ILLUMINANCE_SCALAR), cd / (d * d), 1e-5);
        if (degrees) EXPECT(one(LC_ILLUMINANCE_CYLINDRICAL), cd * sin(a) / PI / (d * d), 1e-5);
        set_sensor(0, 2 * tan(a), 0, 0, -1, 0, 0); /* upright, towards the lamp */
        if (degrees) EXPECT(one(LC_ILLUMINANCE), cd * sin(a) / (d * d), 1e-5);
    }
    set_sensor(0, 0, 0, 0, 0, 0, -1);
    CHECK(!(one(LC_ILLUMINANCE) > 0)); /* from behind */
    EXPECT(one(LC_ILLUMINANCE_SCALAR), 1000 / 4.0, 1e-5);
    CHECK(one(LC_ILLUMINANCE_CYLINDRICAL) < 1e-3);
}

TEST(boxes_shade_sensors)
{
    write_text(IES, LAMP);
    write_scene("LightSource \"luminaire\" \"string filename\" \"unit_lux.ies\" \"point3 from\" [0 0 2]\n"
                "Shape \"trianglemesh\" \"integer indices\" [0 1 2] \"point3 P\" [-1 -1 1 1 -1 1 0 1 1]");
    set_sensor(0, 0, 0, 0, 0, 0, 1);
    CHECK(!(one(LC_ILLUMINANCE) > 0));
    CHECK(!(one(LC_ILLUMINANCE_SCALAR) > 0));
    set_sensor(0, 0, 0, 1, 0, 0, 1); /* in the plane of a surface: its upper side */
    EXPECT(one(LC_ILLUMINANCE), 1000, 1e-5);
}

/* A Lambertian luminaire's table in steps of a degree: linear between them it is 4e-5 too small at most. */
static void write_lambert(const char *opening)
{
    char text[8192];
    size_t n = (size_t)snprintf(text, sizeof text, "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 91 1 1 2 %s 1 1 10\n",
                                opening);
    for (int i = 0; i <= 90; i++) n += (size_t)snprintf(text + n, sizeof text - n, "%d\n", i);
    n += (size_t)snprintf(text + n, sizeof text - n, "0\n");
    for (int i = 0; i <= 90; i++)
        n += (size_t)snprintf(text + n, sizeof text - n, "%.6f\n", 1000 * cos(i * PI / 180));
    write_text(IES, text);
}

#define OPENING                                                                                              \
    "LightSource \"luminaire\" \"string filename\" \"unit_lux.ies\" \"point3 from\" [0 0 1] \"integer "      \
    "samples\" 1024"

/* Radiance 1000 cd over the area; E = pi L sin^2 below a disc's middle, [Ashdown] 2.8 below a rectangle's. */
TEST(luminous_openings)
{
    set_sensor(0, 0, 0, 0, 0, 0, 1);
    write_lambert("-1 0 0"); /* a disc of 1 m across */
    write_scene(OPENING);
    const double sine = 0.5 / sqrt(1.25), area = PI / 4, angle = atan(0.5);
    EXPECT(one(LC_ILLUMINANCE), PI * 1000 / area * sine * sine, 1e-3);
    EXPECT(one(LC_ILLUMINANCE_SCALAR), 2 * PI * 1000 / area * (1 - cos(angle)), 1e-3);
    EXPECT(one(LC_ILLUMINANCE_CYLINDRICAL), 2 * 1000 / area * (angle / 2 - sin(2 * angle) / 4), 2e-3);
    write_lambert("0.8 1.2 0");
    write_scene(OPENING);
    const double a = 0.4, b = 0.6, p = sqrt(1 + a * a), q = sqrt(1 + b * b);
    EXPECT(one(LC_ILLUMINANCE), 4 * 1000 / 0.96 / 2 * (a / p * atan(b / p) + b / q * atan(a / q)), 1e-3);
}

TEST(uniform_sky)
{
    write_scene("LightSource \"infinite\" \"rgb L\" [2 2 2]");
    for (uint32_t i = 0; i < 4; i++) set_sensor(i, i, 0, 0, i % 2, i / 2, 1);
    static const struct {
        lc_quantity quantity;
        double want;
    } rows[] = { { LC_ILLUMINANCE, 2 * PI },
                 { LC_ILLUMINANCE_CYLINDRICAL, 2 * PI },
                 { LC_ILLUMINANCE_SCALAR, 8 * PI } };
    for (int k = 0; k < 3; k++) {
        measure((way){ rows[k].quantity, LC_METHOD_EXACT, .width = 2, .height = 2 }, &f);
        CHECK(!f.status);
        for (int i = 0; i < 4; i++) EXPECT(f.lux[i], rows[k].want, 5e-3);
    }
}

/* A room of 4 x 4 x 3 m whose walls reflect half: a closed form for a sphere would do; here bounced light is
 * between the first bounce's least and all of it. */
TEST(bounced_light_is_an_option)
{
    write_text(IES, LAMP);
    write_scene("LightSource \"luminaire\" \"string filename\" \"unit_lux.ies\" \"point3 from\" [0 0 1.4]\n"
                "Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\nReverseOrientation\n"
                "Shape \"trianglemesh\" \"integer indices\" [0 2 1 1 2 3 4 5 6 5 7 6 0 1 4 1 5 4 2 6 3 3 6 7 "
                "0 4 2 2 4 "
                "6 1 3 5 3 7 5] \"point3 P\" [-2 -2 -1.5 2 -2 -1.5 -2 2 -1.5 2 2 -1.5 -2 -2 1.5 2 -2 1.5 -2 "
                "2 1.5 2 2 1.5]");
    set_sensor(0, 0.5, 0.3, -0.7, 0, 0, 1);
    const double direct = one(LC_ILLUMINANCE);
    measure((way){ .method = LC_METHOD_EXACT, .width = 1, .height = 1, .indirect = 4096 }, &f);
    CHECKF(f.lux[0] > 1.05 * direct && f.lux[0] < 2.5 * direct, "%g beside %g", f.lux[0], direct);
    set_sensor(0, 0.5, 0.3, -0.7, 0, 0, -1); /* its underside sees the floor */
    CHECK(!(one(LC_ILLUMINANCE) > 0));
    measure((way){ .method = LC_METHOD_EXACT, .width = 1, .height = 1, .indirect = 4096 }, &f);
    CHECKF(f.lux[0] > 0.1 * direct && f.lux[0] < direct, "%g beside %g", f.lux[0], direct);
}

/* 2000 luminaires of four tables, turned and tilted, over boxes. */
static void write_hall(void)
{
    FILE *out = fopen(PATH, "w");
    if (!out) abort();
    write_lambert("0 0 0");
    fprintf(out, "WorldBegin\n");
    for (int i = 0; i < 2000; i++)
        fprintf(
            out,
            "AttributeBegin\nTranslate %g %g %g\nRotate %d 0 0 1\nRotate %d 1 0 0\nLightSource \"luminaire\" "
            "\"string filename\" \"unit_lux.ies\" \"float scale\" [%g]\nAttributeEnd\n",
            i % 50 * 0.8, i / 50 * 0.8, 3 + i % 7 * 0.3, i * 37 % 360, i * 11 % 40, 0.2 + i % 5);
    for (int i = 0; i < 60; i++) {
        const double x = i * 7 % 40, y = i * 13 % 32, h = 0.5 + i % 5 * 0.4;
        fprintf(
            out,
            "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3 0 1 5 0 5 4] \"point3 P\" [%g %g %g %g "
            "%g %g %g %g %g %g %g %g %g %g 0 %g %g 0]\n",
            x, y, h, x + 1.5, y, h, x + 1.5, y + 2.5, h, x, y + 2.5, h, x, y, x + 1.5, y);
    }
    fclose(out);
}

static double share_within(const field *got, const field *truth, uint32_t n, double error)
{
    double mean = 0, within = 0;
    for (uint32_t i = 0; i < n; i++) mean += truth->lux[i] / n;
    for (uint32_t i = 0; i < n; i++)
        within += fabs(got->lux[i] - truth->lux[i]) <=
                  error * fmax(truth->lux[i], (double)LC_ASKED_DARK_FLOOR * mean);
    return 100 * within / n;
}

static void grid_in_hall(void)
{
    for (uint32_t i = 0; i < 64 * 64; i++) {
        set_sensor(i, i % 64 * 0.62 + 0.1, i / 64 * 0.5 + 0.1, 0.85, 0, 0, 1);
        sensors[i].reach = 3;
    }
}

/* Most of the 4096 sensors are no pilots. */
TEST(what_is_asked_holds)
{
    static field truth, got;
    write_hall();
    grid_in_hall();
    for (lc_quantity q = LC_ILLUMINANCE; q <= LC_ILLUMINANCE_SCALAR; q++) {
        measure((way){ q, LC_METHOD_EXACT, 64, 64, .isa = LC_ISA_BEST }, &truth);
        measure((way){ q, LC_METHOD_CUTS, 64, 64, .error = 0.01f }, &got);
        CHECK(!truth.status && !got.status);
        const double share = share_within(&got, &truth, 64 * 64, 0.01);
        printf("  quantity %d: %.1f %% within 1 %%, pilots say %.1f %%; %.0f of 2000 lights\n", (int)q, share,
               (double)got.stats.calibration.achieved, got.stats.cut_mean);
        CHECKF(share > 93 && share <= 100, "%g", share);
        CHECKF(got.stats.cut_mean < 1500, "%g", got.stats.cut_mean);
    }
}

TEST(the_same_bytes)
{
    static field first, other;
    write_hall();
    grid_in_hall();
    const way w = { LC_ILLUMINANCE_CYLINDRICAL, LC_METHOD_CUTS, 32, 20, 1, .error = 0.02f,
                    .isa = LC_ISA_SCALAR };
    measure(w, &first);
    EACH_ISA(isa)
    {
        way v = w;
        v.isa = isa;
        v.threads = 1 + (uint32_t)isa % 3;
        measure(v, &other);
        CHECKF(!memcmp(first.rgb, other.rgb, sizeof first.rgb), "%s", lc_isa_name(isa));
    }
}

TEST(luminance_is_without_exposure)
{
    write_text(PATH,
               "LookAt 0 0 0 0 0 1 0 1 0\nCamera \"perspective\"\n"
               "Film \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 4 \"float iso\" 400\n"
               "WorldBegin\nAreaLightSource \"diffuse\" \"rgb L\" [5 5 5] \"bool twosided\" true\n"
               "Shape \"trianglemesh\" \"integer indices\" [0 1 2] \"point3 P\" [-9 -9 1 9 -9 1 0 9 1]\n");
    measure((way){ .quantity = LC_LUMINANCE, .method = LC_METHOD_EXACT }, &f);
    CHECK(!f.status);
    for (int i = 0; i < 16; i++) EXPECT(f.lux[i], 5, 1e-5);
}

static void refuse(way w, const char *message)
{
    log_clear();
    measure(w, &f);
    EXPECT_FAILURE(f.status, LC_ERR_ARG, message);
}

TEST(wrong_sensors_are_refused)
{
    write_scene("LightSource \"point\"");
    for (uint32_t i = 0; i < 4; i++) set_sensor(i, i, 0, 0, 0, 0, 1);
    const way w = { .width = 2, .height = 2 };
    sensors[2].position[1] = NAN;
    refuse(w, "error: sensor 2: its position is not finite or too far");
    sensors[2].position[1] = 1e13f;
    refuse(w, "error: sensor 2: its position is not finite or too far");
    sensors[2].position[1] = 0;
    sensors[3].normal[2] = 0.9f;
    refuse(w, "error: sensor 3: its normal is not of length 1");
    sensors[3].normal[2] = 1;
    sensors[0].reach = -1;
    refuse(w, "error: sensor 0: its reach is out of range");
    sensors[0].reach = 0;
    refuse((way){ .width = 0, .height = 2 }, "error: sensors: there are none, or more than 268435456");
    refuse((way){ .width = 65535, .height = 65535 },
           "error: sensors: there are none, or more than 268435456");
    refuse((way){ .quantity = (lc_quantity)4, .width = 1, .height = 1 }, "error: sensors: no such quantity");
    measure(w, &f);
    CHECK(!f.status);
}

int main(void)
{
    RUN(every_instruction_set_is_here);
    RUN(one_luminaire_over_a_plane);
    RUN(boxes_shade_sensors);
    RUN(luminous_openings);
    RUN(uniform_sky);
    RUN(bounced_light_is_an_option);
    RUN(what_is_asked_holds);
    RUN(the_same_bytes);
    RUN(luminance_is_without_exposure);
    RUN(wrong_sensors_are_refused);
    return test_done();
}
