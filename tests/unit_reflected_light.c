/* unit_reflected_light.c - what lobes and mirrors shed on other surfaces: the flux of their virtual lights
 * against an integral, how they shine; rooms with a mirror for a wall against rooms twice as large, which
 * have all twice; sheets of metal, behind which there is no light. */
#include "scene/scene.h"
#include "shade/dir_pack.h"
#include "shade/lobe.h"
#include "shade/point_init.h"
#include "shade/reflected.h"
#include "support/near.h"
#include "support/one_scene.h"
#include "support/ref_shine.h"
#include "tree/light_tree.h"

#define RND_KEY 4711
#include "support/rnd.h"

/* ---- flux ---- */

#define PLANE                                                                                     \
    "Film \"rgb\"\nWorldBegin\nLightSource \"point\" \"rgb I\" [1 1 1]\n%s\n"                     \
    "Shape \"trianglemesh\" \"point3 P\" [-9e3 -9e3 -1 9e3 -9e3 -1 9e3 9e3 -1 -9e3 9e3 -1]"       \
    " \"integer indices\" [0 1 2 0 2 3]\n"

/* The part of light that a surface reflects by its lobe, for light at a cosine of c, from one side. */
static double lobe_part(const lc_material *m, double c, double side)
{
    enum { MANY = 40000 };
    lc_point p;
    double sum = 0;
    const double across = sqrt(1 - c * c);
    const lc_f3 from = { (float)(across * cos(side)), (float)(across * sin(side)), (float)c };
    lc_point_init(&p, lc_f3_make(0, 0, 0), lc_f3_make(0, 0, 1), from, m, 1e-10f);
    memset(p.diffuse, 0, sizeof p.diffuse);
    for (int i = 0; i < MANY; i++) { /* evenly over the half sphere */
        const double z = rnd(), r = sqrt(1 - z * z), turn = 2 * LC_PI * rnd();
        const lc_light_rec far = { .pos = { (float)(r * cos(turn)), (float)(r * sin(turn)), (float)z } };
        sum += (double)lc_estimate_one(ctx->shade_kernels, &p, LC_LIGHT_DIRECTIONAL, &far, NULL).y;
    }
    return sum * 2 * LC_PI / MANY;
}

/* A rough lobe reflects less at grazing angles than Fresnel's equations say of its normal. */
TEST(a_lobe_reflects_what_it_sheds)
{
    static const float rough[] = { 0.15f, 0.3f, 0.6f, 1 }, cosine[] = { 0.1f, 0.3f, 0.6f, 1 };
    const lc_material kinds[] = {
        { .ks = { 0.5f, 0.5f, 0.5f }, .fresnel = LC_FRESNEL_SCHLICK },
        { .ks = { 1, 1, 1 }, .fresnel = LC_FRESNEL_DIELECTRIC, .eta = { 1.5f, 0, 0 } },
        { .ks = { 1, 1, 1 }, .fresnel = LC_FRESNEL_DIELECTRIC, .eta = { 2.2f, 0, 0 } },
        { .ks = { 1, 1, 1 }, .fresnel = LC_FRESNEL_CONDUCTOR, .eta = { 1, 1, 1 }, .k = { 2, 2, 2 } },
        { .ks = { 0.8f, 0.8f, 0.8f }, .fresnel = LC_FRESNEL_NONE },
    };
    double worst = 0;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        for (int k = 0; k < 16; k++) {
            lc_material m = kinds[i];
            m.lobe = LC_LOBE_GGX;
            m.roughness[0] = m.roughness[1] = rough[k / 4];
            const double c = (double)cosine[k % 4], got = (double)lc_lobe_reflected(&m, cosine[k % 4]).y,
                         want = (lobe_part(&m, c, 1.1) + lobe_part(&m, c, 2.7)) / 2;
            worst = fmax(worst, fabs(got - want) - 0.03 * want);
            CHECKF(near_abs(got, want, 0.015 + 0.03 * want), "kind %zu, roughness %g, cosine %g: %g of %g", i,
                   (double)m.roughness[0], c, got, want);
        }
    printf("    off by at most 3 %% and %.4f\n", worst);
}

/* The flux of a virtual light of intensity 1, by some directions at random over the half sphere. */
static double flux_of(const lc_light *l)
{
    enum { SOME = 64 };
    double sum = 0;
    for (int i = 0; i < SOME; i++) { /* towards the light, so against how it shines */
        const double z = -rnd(), r = sqrt(1 - z * z), turn = 2 * LC_PI * rnd(),
                     w[3] = { r * cos(turn), r * sin(turn), z };
        sum += -z * ref_shine(l, w, -z).exact;
    }
    return sum * 2 * LC_PI / SOME;
}

/* Half of a lamp's light falls on a plane, evenly spread over the cosine there. roughness: of the lobe that
 * lights are to stand for, 0: none. */
static void check_plane(const char *material, float roughness)
{
    enum { STEPS = 100 };
    lc_load_desc load = LC_LOAD_DESC_INIT;
    double lobe = 0, rest = 0, want_lobe = 0, want_rest = 0;
    load.indirect_lights = 15000;
    load.max_depth = 2;
    scene_write(PLANE, material);
    lc_scene *s = scene_from_file(ctx, &load, scene_path());
    CHECK(s);
    if (!s) return;
    for (size_t i = s->n_lights - s->indirect.n_lights; i < s->n_lights; i++) {
        const lc_light *l = &s->lights[i];
        const lc_f3 to_lamp = lc_f3_neg(lc_f3_normalize(l->pos));
        CHECKF(l->dir.z > 0.9999f, "light %zu: another way", i);
        if (lc_has_shine(l)) {
            lobe += (double)l->intensity.y * flux_of(l);
            CHECKF(near_abs((double)l->shine.roughness, (double)roughness, 1e-6), "light %zu: %g", i,
                   (double)l->shine.roughness);
            CHECKF(lc_f3_dot(lc_dir_unpack(l->shine.from), to_lamp) > 0.9999f, "light %zu: from where", i);
        } else rest += LC_PI * (double)l->intensity.y;
    }
    const lc_material *m = &s->materials[s->meshes[0].material_id];
    const bool metal = !(lc_f3_max(m->kd) > 0);
    CHECK(!s->tree->data.light_shine == !(roughness > 0));
    for (int k = 0; k < STEPS; k++) {
        const double c = (k + 0.5) / STEPS, part = lobe_part(m, c, 2.4 * k); /* a golden angle */
        want_lobe += 2 * LC_PI * part / STEPS;
        want_rest += 2 * LC_PI * (double)lc_lobes[m->lobe].albedo(m, (float)c).y / STEPS;
    }
    printf("    roughness %g: by the lobe %.4f of %.4f, otherwise %.4f of %.4f\n", (double)roughness, lobe,
           want_lobe, rest, want_rest);
    CHECKF(near_rel(lobe, metal ? want_lobe : 0, 0.02), "%g of %g", lobe, want_lobe);
    CHECKF(near_rel(rest, metal ? 0 : want_rest, 0.02), "%g of %g", rest, want_rest);
    lc_scene_destroy(s);
}

TEST(flux_is_what_the_lobe_reflects)
{
#define GIVEN "\"bool remaproughness\" false \"rgb reflectance\" [.7 .8 .7]"
    check_plane("Material \"conductor\" " GIVEN " \"float roughness\" [.1]", 0.2f);
    check_plane("Material \"conductor\" " GIVEN " \"float roughness\" [.5]", 0.5f);
    check_plane("Material \"conductor\" " GIVEN " \"float uroughness\" [.2] \"float vroughness\" [.6]",
                sqrtf(0.12f));
    check_plane("Material \"conductor\" " GIVEN " \"float roughness\" [.9]", 0.9f);
    check_plane("Material \"coateddiffuse\" " GIVEN " \"float roughness\" [.2]", 0);
}

/* A spot shines on metal from one side: on the ceiling its light is about the mirror direction. */
TEST(paths_go_on_by_the_lobe)
{
    lc_load_desc load = LC_LOAD_DESC_INIT;
    double sum = 0, at = 0, off = 0;
    load.indirect_lights = 4000;
    load.max_depth = 3;
    scene_write("Film \"rgb\"\nWorldBegin\nLightSource \"spot\" \"rgb I\" [1 1 1]"
                " \"point3 from\" [-2 0 1] \"point3 to\" [0 0 -1] \"float coneangle\" 4"
                " \"float conedeltaangle\" 1\n"
                "Material \"conductor\" \"rgb reflectance\" [.9 .9 .9] \"float roughness\" [.1]"
                " \"bool remaproughness\" false\n"
                "Shape \"trianglemesh\" \"point3 P\" [-9 -9 -1 9 -9 -1 9 9 -1 -9 9 -1]"
                " \"integer indices\" [0 1 2 0 2 3]\nMaterial \"diffuse\"\n"
                "Shape \"trianglemesh\" \"point3 P\" [-9 -9 1.1 9 -9 1.1 9 9 1.1 -9 9 1.1]"
                " \"integer indices\" [0 1 2 0 2 3]\n");
    lc_scene *s = scene_from_file(ctx, &load, scene_path());
    CHECK(s);
    for (size_t i = s ? s->n_lights - s->indirect.n_lights : 0; s && i < s->n_lights; i++) {
        const lc_light *l = &s->lights[i];
        if (l->pos.z < 0) continue;
        sum += (double)l->intensity.y;
        at += (double)l->intensity.y * (double)l->pos.x;
        off += (double)l->intensity.y * fabs((double)l->pos.y);
    }
    printf("    on the ceiling at %.2f, %.2f to the sides\n", at / sum, off / sum);
    CHECKF(near_abs(at / sum, 2.1, 0.25) && off / sum < 0.5, "at %g, %g to the sides", at / sum, off / sum);
    lc_scene_destroy(s);
}

/* ---- pictures ---- */

#define SIDE 32

/* Radiance of the pixels, the mean of two seeds; false after a failure, which is counted. */
static bool picture(double *of)
{
    for (int i = 0; i < SIDE * SIDE; i++) of[i] = 0;
    for (uint64_t seed = 1; seed <= 2; seed++) {
        lc_load_desc load = LC_LOAD_DESC_INIT;
        lc_render_desc d = LC_RENDER_DESC_INIT;
        lc_image *image = NULL;
        load.indirect_lights = 12000;
        load.seed = seed;
        d.spp = 4;
        d.seed = seed;
        lc_scene *s = scene_from_file(ctx, &load, scene_path());
        const bool done = s && !lc_render(ctx, s, &d, &image, NULL);
        CHECK(done);
        for (int i = 0; done && i < SIDE * SIDE; i++) of[i] += (double)lc_image_channel(image, "G")[i] / 2;
        lc_image_destroy(image);
        lc_scene_destroy(s);
        if (!done) return false;
    }
    return true;
}

#define ROOM_HEAD                                                                                  \
    "Film \"rgb\" \"integer xresolution\" 32 \"integer yresolution\" 32\nPixelFilter \"box\"\n"    \
    "Integrator \"path\" \"integer maxdepth\" 14\nLookAt .3 1.5 2 2 %g 2 0 1 0\n"                  \
    "Camera \"perspective\" \"float fov\" 90\nWorldBegin\n"
#define LAMP "LightSource \"point\" \"rgb I\" [5 5 5] \"point3 from\" [%g 2.5 2.5]\n"
#define FLOOR \
    "Shape \"trianglemesh\" \"point3 P\" [%g 0 0 4 0 0 4 0 4 %g 0 4] \"integer indices\" [0 1 2 0 2 3]\n"
#define CEILING \
    "Shape \"trianglemesh\" \"point3 P\" [%g 3 0 4 3 0 4 3 4 %g 3 4] \"integer indices\" [0 1 2 0 2 3]\n"
#define SIDES                                                                                                \
    "Shape \"trianglemesh\" \"point3 P\" [%g 0 0 4 0 0 4 3 0 %g 3 0 %g 0 4 4 0 4 4 3 4 %g 3 4]"              \
    " \"integer indices\" [0 1 2 0 2 3 4 5 6 4 6 7]\n"
#define END \
    "Shape \"trianglemesh\" \"point3 P\" [%g 0 0 %g 0 4 %g 3 4 %g 3 0] \"integer indices\" [0 1 2 0 2 3]\n"
#define BLOCK                                                                                            \
    "Shape \"trianglemesh\" \"point3 P\" [%g 0 1 %g 0 1 %g 1.2 1 %g 1.2 1 %g 0 1.8 %g 0 1.8 %g 1.2 1.8"  \
    " %g 1.2 1.8] \"integer indices\" [0 1 2 0 2 3 4 5 6 4 6 7 0 3 7 0 7 4 1 2 6 1 6 5 3 2 6 3 6 7]\n"

#define SCREEN \
    "Shape \"trianglemesh\" \"point3 P\" [%g 2 2 %g 2 3 %g 3 3 %g 3 2] \"integer indices\" [0 1 2 0 2 3]\n"

#define MIRROR "Material \"conductor\" \"rgb reflectance\" [1 1 1] \"float roughness\" 0"

static void block(char *at, double x0, double x1) { sprintf(at, BLOCK, x0, x1, x1, x0, x0, x1, x1, x0); }

/* The room from x = 0 to 4, at 0 a mirror; or twice as large, without it. With a screen between the lamp and
 * the mirror. */
static void write_room(bool twice, const char *floor, double look_at, bool screen)
{
    const double x = twice ? -4 : 0;
    char lamps[300], screens[500], blocks[2][500] = { "", "" };
    int n = sprintf(lamps, LAMP, 1.0), of_screens = sprintf(screens, SCREEN, 0.6, 0.6, 0.6, 0.6);
    if (twice) sprintf(lamps + n, LAMP, -1.0);
    if (twice) sprintf(screens + of_screens, SCREEN, -0.6, -0.6, -0.6, -0.6);
    block(blocks[0], 1.8, 2.6);
    if (twice) block(blocks[1], -2.6, -1.8);
    scene_write(ROOM_HEAD "%s%s\n" FLOOR "Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n%s%s%s" CEILING
                          "Material \"diffuse\" \"rgb reflectance\" [.3 .3 .3]\n" SIDES END "%s\n" END,
                look_at, lamps, floor, x, x, screen ? screens : "", blocks[0], blocks[1], x, x, x, x, x, x,
                4.0, 4.0, 4.0, 4.0, twice ? "" : MIRROR, x, x, x, x);
}

/* How far the room with the mirror is from the one twice as large. */
static void check_room(const char *floor, double look_at, bool screen, double together, double apart)
{
    enum { OF = 8, BLOCKS = SIDE / OF };
    static double mirrored[SIDE * SIDE], twice[SIDE * SIDE];
    double a[BLOCKS * BLOCKS] = { 0 }, b[BLOCKS * BLOCKS] = { 0 }, sum_a = 0, sum_b = 0, worst = 0;
    write_room(false, floor, look_at, screen);
    if (!picture(mirrored)) return;
    write_room(true, floor, look_at, screen);
    if (!picture(twice)) return;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const int at = i / SIDE / OF * BLOCKS + i % SIDE / OF;
        sum_a += mirrored[i];
        sum_b += twice[i];
        a[at] += mirrored[i];
        b[at] += twice[i];
    }
    for (int k = 0; k < BLOCKS * BLOCKS; k++)
        if (fabs(a[k] / b[k] - 1) > fabs(worst)) worst = a[k] / b[k] - 1;
    printf("    a mirror in place of half a room: %+.2f %%, of blocks at most %+.2f %%\n",
           100 * (sum_a / sum_b - 1), 100 * worst);
    CHECKF(near_rel(sum_a, sum_b, together), "%g of %g", sum_a, sum_b);
    CHECKF(fabs(worst) < apart, "a block is off by %g", worst);
}

TEST(a_mirror_shows_the_room_once_more)
{
    check_room("Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]", 1.3, false, 0.02, 0.05);
}

/* Its floor reflects what the mirror shows; a lamp there it would not. */
TEST(metal_before_a_mirror)
{
    check_room("Material \"conductor\" \"rgb reflectance\" [.8 .8 .8] \"float roughness\" [.2]", .9, true,
               0.02, 0.05);
}

/* ---- by way of a mirror ---- */

/* A plate, lit by a dark wall that a lamp below lights; the wall and the lamp are mirrored, or beside it
 * there is a mirror of 0.6 that shows them. */
#define BY_A_MIRROR \
    "Film \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 4\nLookAt -2 1.2 0 0 0 0 0 1 0\n" \
    "Camera \"perspective\" \"float fov\" 2\nIntegrator \"path\" \"integer maxdepth\" 3\nWorldBegin\n" \
    "LightSource \"point\" \"rgb I\" [%g %g %g] \"point3 from\" [%g -1 0]\n" \
    "Material \"diffuse\" \"rgb reflectance\" [.1 .1 .1]\n" \
    "Shape \"trianglemesh\" \"point3 P\" [%g 0 -2 %g 0 2 %g 3 2 %g 3 -2]" \
    " \"integer indices\" [0 1 2 0 2 3]\n" \
    "Material \"conductor\" \"rgb reflectance\" [.8 .8 .8] \"float roughness\" [.06]" \
    " \"bool remaproughness\" false\n" \
    "Shape \"trianglemesh\" \"point3 P\" [-.9 0 -9 1.49 0 -9 1.49 0 9 -.9 0 9]" \
    " \"integer indices\" [0 2 1 0 3 2]\n%s"
#define SIDE_MIRROR                                                                         \
    "Material \"conductor\" \"rgb reflectance\" [.6 .6 .6] \"float roughness\" 0\n"       \
    "Shape \"trianglemesh\" \"point3 P\" [1.5 0 -9 1.5 0 9 1.5 9 9 1.5 9 -9]"            \
    " \"integer indices\" [0 1 2 0 2 3]\n"

static double plate(double strength, double lamp_x, double wall_x, const char *mirror)
{
    lc_load_desc load = LC_LOAD_DESC_INIT;
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    double sum = 0;
    load.indirect_lights = 4000;
    d.spp = 16;
    scene_write(BY_A_MIRROR, strength, strength, strength, lamp_x, wall_x, wall_x, wall_x, wall_x, mirror);
    lc_scene *s = scene_from_file(ctx, &load, scene_path());
    CHECK(s && !lc_render(ctx, s, &d, &image, NULL));
    for (int i = 0; image && i < 16; i++) sum += (double)lc_image_channel(image, "G")[i] / 16;
    lc_image_destroy(image);
    lc_scene_destroy(s);
    return sum;
}

TEST(metal_shows_what_a_mirror_shows)
{
    const double by_mirror = plate(8, -1.5, -3, SIDE_MIRROR), without = plate(0.6 * 8, 4.5, 6, "");
    printf("    %.5f of %.5f\n", by_mirror, without);
    CHECKF(near_rel(by_mirror, without, 0.05), "%g of %g", by_mirror, without);
}

/* ---- behind ---- */

/* A lamp shines along a sheet of metal; sensors look at its back. */
TEST(nothing_shines_through_a_sheet)
{
    enum { N = 16 };
    static lc_sensor sensor[N];
    lc_load_desc load = LC_LOAD_DESC_INIT;
    lc_sensors_desc d = LC_SENSORS_DESC_INIT;
    lc_render_desc r = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    scene_write("WorldBegin\nLightSource \"point\" \"point3 from\" [-4 0 .8] \"rgb I\" [9 9 9]\n"
                "Material \"conductor\" \"rgb reflectance\" [.9 .9 .9] \"float roughness\" [.3]\n"
                "Shape \"trianglemesh\" \"point3 P\" [-5 -5 0 5 -5 0 5 5 0 -5 5 0]"
                " \"integer indices\" [0 1 2 0 2 3]\n");
    for (int i = 0; i < N; i++) /* below and, the last one, above */
        sensor[i] = (lc_sensor){ .position = { 4, 0, i + 1 < N ? -0.03f * (float)(1 + i * i) : 1 },
                                 .normal = { -1, 0, 0 } };
    d.width = N;
    d.height = 1;
    d.sensors = sensor;
    load.sensors = &d;
    load.indirect_lights = 5000;
    r.method = LC_METHOD_EXACT;
    lc_scene *s = scene_from_file(ctx, &load, scene_path());
    CHECK(s && !lc_render(ctx, s, &r, &image, NULL));
    const float *g = image ? lc_image_channel(image, "G") : NULL;
    for (int i = 0; g && i + 1 < N; i++)
        CHECKF(g[i] < 1e-4f * g[N - 1], "%g below the sheet: %g, above %g", (double)sensor[i].position[2],
               (double)g[i], (double)g[N - 1]);
    CHECK(g && g[N - 1] > 0);
    lc_image_destroy(image);
    lc_scene_destroy(s);
}

int main(void)
{
    ctx = quiet_context(2);
    temp_begin();
    RUN(a_lobe_reflects_what_it_sheds);
    RUN(flux_is_what_the_lobe_reflects);
    RUN(paths_go_on_by_the_lobe);
    RUN(a_mirror_shows_the_room_once_more);
    RUN(metal_before_a_mirror);
    RUN(metal_shows_what_a_mirror_shows);
    RUN(nothing_shines_through_a_sheet);
    one_scene_end();
    temp_end();
    return test_done();
}
