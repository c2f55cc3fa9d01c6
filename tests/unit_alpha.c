/* unit_alpha.c - meshes with holes: which hits a ray passes through. Checkerboards are compared with the
 * checks computed here, constant alphas with their share of the rays, and rays traced together, by other
 * instruction sets or as shadow rays with a ray traced alone by the plain C kernel; in objects, too. */
#include "scene/surface.h"
#include "support/isas.h"
#include "support/one_scene.h"
#include "support/pictures.h"
#include "support/rnd.h"
#include "support/watched_memory.h"
#include "trace/bvh.h"

#define HEAD4                                                                                                \
    "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 40 Camera \"perspective\" \"float "     \
    "fov\" 90\nWorldBegin\n"                                                                                 \
    "LightSource \"point\"\n"
#define HEAD3                                                                                                \
    "Film \"image\" \"integer xresolution\" 40 \"integer yresolution\" 40 Camera \"perspective\" \"float "   \
    "fov\" 90\nWorldBegin\n"                                                                                 \
    "LightSource \"point\"\n"
/* A wall at z = 2, and the square -1..1 at z = 1 in front of it, four times smaller; on the square u grows to
 * the right and v upwards. */
#define WALL                                                                                                 \
    "Shape \"trianglemesh\" \"point3 P\" [-4 -4 2 4 -4 2 4 4 2 -4 4 2] \"integer indices\" [0 1 2 0 2 3]\n"
#define QUAD                                                                                                 \
    "Shape \"trianglemesh\" \"point3 P\" [-1 -1 1 1 -1 1 1 1 1 -1 1 1] \"integer indices\" [0 1 2 0 2 3] "
#define UV "\"point2 uv\" [0 0 1 0 1 1 0 1] "
#define ST "\"float st\" [0 0 1 0 1 1 0 1] "
/* 1 where floor(4 u) + floor(4 v) is even, else 0 */
#define CHECKS                                                                                               \
    "Texture \"c\" \"float\" \"checkerboard\" \"float uscale\" 4 \"float vscale\" 4 \"float tex1\" 1 "       \
    "\"float tex2\" 0\n"

static const lc_load_desc few_lights = {
    .size = sizeof few_lights, .area_lights = 64, .env_lights = 64, .n_reps = 1,
    .indirect_lights = LC_NO_LIGHTS
};

static bool load(const char *head, const char *body)
{
    return load_text(&few_lights, "%s%s", head, body) == LC_OK;
}

/* z of what is visible from the origin through (x, y, 1); 0: nothing. */
static double seen(double x, double y)
{
    lc_surface s;
    if (!lc_surface_hit(scene, lc_f3_make(0, 0, 0), lc_f3_normalize_d(x, y, 1), 0, &s)) return 0;
    return (double)s.pos.z;
}

static bool hidden(double x, double y, double z)
{
    const float org[3] = { 0, 0, 0 }, to[3] = { (float)x, (float)y, (float)z };
    const float *const target[3] = { to, to + 1, to + 2 };
    uint8_t got;
    scene->bvh->kernels->hidden(&scene->bvh->data, org, 1, target, false, &got, NULL);
    return got;
}

static bool opaque_at(double x, double y)
{
    int i = (int)floor((x + 1) * 2), j = (int)floor((y + 1) * 2);
    return (i + j) % 2 == 0;
}

static void check_checks(void)
{
    for (int i = 0; i < 1000; i++) {
        double x = rnd_in(-0.98, 0.98), y = rnd_in(-0.98, 0.98);
        if (fabs(x * 2 - floor(x * 2 + 0.5)) < 1e-3 || fabs(y * 2 - floor(y * 2 + 0.5)) < 1e-3) continue;
        CHECKF(fabs(seen(x, y) - (opaque_at(x, y) ? 1 : 2)) < 1e-5, "(%g, %g): %g", x, y, seen(x, y));
        CHECK(hidden(1.9 * x, 1.9 * y, 1.9) == opaque_at(x, y));
    }
}

TEST(textures)
{
    CHECK(load(HEAD4, CHECKS WALL QUAD UV "\"texture alpha\" \"c\""));
    CHECK(scene->n_alphas == 1 && scene->n_notes == 0);
    check_checks();
    CHECK(load(HEAD3, CHECKS WALL QUAD ST "\"texture alpha\" \"c\""));
    check_checks();
    CHECK(load(HEAD4, CHECKS QUAD UV "\"texture alpha\" \"nothing\"\n" WALL));
    CHECK(scene->n_notes == 1);
}

TEST(numbers)
{
    CHECK(load(HEAD4, WALL QUAD "\"float alpha\" 1"));
    CHECK(scene->n_alphas == 0 && !scene->bvh->data.alpha && fabs(seen(0.1, 0.2) - 1) < 1e-5);
    CHECK(load(HEAD4, WALL QUAD "\"float alpha\" 0"));
    CHECK(scene->n_tris == 2 && scene->n_notes == 0 && fabs(seen(0.1, 0.2) - 2) < 1e-5 && !hidden(0, 0, 1.9));
    CHECK(load(HEAD4, WALL QUAD "\"float alpha\" 0.3"));
    int n = 0, n_shadow = 0;
    for (int i = 0; i < 10000; i++) {
        double x = rnd_in(-0.98, 0.98), y = rnd_in(-0.98, 0.98);
        n += seen(x, y) < 1.5;
        n_shadow += hidden(1.9 * x, 1.9 * y, 1.9);
    }
    /* A share of 0.3 of 10000 rays has a standard deviation of 46; 200 is more than four of them. */
    CHECKF(abs(n - 3000) < 200 && abs(n_shadow - 3000) < 200, "%d and %d of 10000", n, n_shadow);
    CHECK(load(HEAD3, WALL QUAD "\"float shadowalpha\" 0"));
    CHECK(fabs(seen(0.1, 0.2) - 1) < 1e-5 && !hidden(0.1, 0.2, 1.9));
    CHECK(load(HEAD3, CHECKS WALL QUAD ST "\"texture shadowalpha\" \"c\""));
    CHECK(fabs(seen(0.1, 0.6) - 1) < 1e-5 && hidden(0.1 * 1.9, 0.1 * 1.9, 1.9) &&
          !hidden(0.1 * 1.9, 0.6 * 1.9, 1.9));
}

TEST(emitters)
{
    CHECK(load(HEAD4, "AreaLightSource \"diffuse\"\n" QUAD "\"float alpha\" 0"));
    CHECK(scene->n_emissive_tris == 2 && scene->n_lights > 1 && seen(0, 0.1) <= 0 && scene->n_notes == 0);
    CHECK(load(HEAD4, CHECKS "AreaLightSource \"diffuse\"\n" QUAD UV "\"texture alpha\" \"c\""));
    CHECK(note("alpha of an area light") && seen(0.1, 0.1) > 0 && seen(0.1, 0.6) <= 0);
}

/* Writes a pile of 144 sheets, every other one with checks as holes, the others with checks of opacity 0.7
 * and 0.2, so that each ray passes through some of them. object: two instances of the pile. */
static void write_sheets(bool object)
{
    static char text[1 << 16];
    size_t n = 0;
    for (int i = 0; i < 144; i++)
        n += (size_t)snprintf(text + n, sizeof text - n,
                              "Shape \"trianglemesh\" \"point3 P\" [-1 -1 %g 1 -1 %g 1 1 %g -1 1 %g] "
                              "\"integer indices\" [0 1 2 0 2 3] " UV "\"texture alpha\" \"%s\"\n",
                              1 + 0.01 * i, 1 + 0.02 * i, 1.1 + 0.01 * i, 1 + 0.013 * i, i % 2 ? "c" : "m");
    scene_write(HEAD4 CHECKS
                "Texture \"m\" \"float\" \"mix\" \"texture tex1\" \"c\" \"float tex2\" 0.4\n%s%s%s",
                object ? "ObjectBegin \"o\"\n" : "", text,
                object ? "ObjectEnd ObjectInstance \"o\" Translate .3 .1 0 ObjectInstance \"o\"\n" : "");
}

TEST(instruction_sets)
{
    for (int object = 0; object < 2; object++) {
        uint32_t n_hidden = 0, n_all = 0;
        write_sheets(object);
        CHECK(load_file(&few_lights, scene_path()) == LC_OK && scene->n_instances == (object ? 2 : 0));
        for (int i = 0; i < 200; i++) {
            const float org[3] = { (float)rnd_in(-1, 1), (float)rnd_in(-1, 1), (float)rnd_in(0.5, 3) };
            float t[3][64];
            const float *const target[3] = { t[0], t[1], t[2] };
            uint8_t first[64], got[64], one;
            for (int j = 0; j < 64; j++)
                for (int k = 0; k < 3; k++)
                    t[k][j] = (float)(k == 2 ? org[2] + (float)rnd_in(-0.02, 0.02) : (float)rnd_in(-1, 1));
            EACH_ISA(isa) {
                const lc_trace_kernels *k = &lc_isa_kernels(isa)->trace;
                k->hidden(&scene->bvh->data, org, 64, target, false, got, NULL);
                if (isa == LC_ISA_SCALAR) memcpy(first, got, sizeof got);
                CHECK(!memcmp(first, got, sizeof got));
                for (uint32_t j = 0; j < 64; j++) {
                    const float *const alone[3] = { t[0] + j, t[1] + j, t[2] + j };
                    const float d[3] = { t[0][j] - org[0], t[1][j] - org[1], t[2][j] - org[2] };
                    lc_hit a, b;
                    k->hidden(&scene->bvh->data, org, 1, alone, false, &one, NULL);
                    CHECK(one == first[j]);
                    lc_isa_kernels(LC_ISA_SCALAR)->trace.closest(&scene->bvh->data, org, d, FLT_MAX, &a);
                    k->closest(&scene->bvh->data, org, d, FLT_MAX, &b);
                    CHECK(!memcmp(&a, &b, sizeof a));
                    /* Camera rays and shadow rays pass through the same hits. */
                    if (a.tri == LC_NONE || a.t > 1.001f || (a.t > 0.001f && a.t < 0.999f))
                        CHECK(one == (a.t < 1 && a.tri != LC_NONE));
                }
            }
            for (int j = 0; j < 64; j++) {
                n_hidden += first[j];
                n_all++;
            }
        }
        CHECKF(n_hidden > n_all / 10 && n_hidden < n_all - n_all / 10, "%u of %u", n_hidden, n_all);
    }
}

TEST(pictures)
{
    lc_image *first = NULL;
    write_sheets(true);
    for (int i = 0; i < 3; i++) {
        lc_render_desc how = LC_RENDER_DESC_INIT;
        lc_context *other = quiet_context_of(i == 1 ? 7 : 1, i ? LC_ISA_BEST : LC_ISA_SCALAR);
        lc_scene *s = scene_from_file(other, &few_lights, scene_path());
        lc_image *image = NULL;
        CHECK(s && lc_render(i ? other : ctx, s, &how, &image, NULL) == LC_OK);
        if (first) CHECK(same_planes(first, image));
        if (i) lc_image_destroy(image);
        else first = image;
        lc_scene_destroy(s);
        lc_context_destroy(other);
    }
    lc_image_destroy(first);
}

static lc_status load_sheets(lc_context *c) { return load_file_in(c, &few_lights, scene_path()); }

TEST(every_allocation_may_fail)
{
    write_sheets(true);
    starve(load_sheets, 40);
}

int main(void)
{
    ctx = quiet_context(0);
    temp_begin();
    RUN(every_instruction_set_is_here);
    RUN(textures);
    RUN(numbers);
    RUN(emitters);
    RUN(instruction_sets);
    RUN(pictures);
    RUN(every_allocation_may_fail);
    one_scene_end();
    temp_end();
    return test_done();
}
