/* unit_glossy.c - what surfaces reflect into narrow lobes: directions drawn by a lobe and their density; a
 * metal plate beside a lit wall, diffuse or of metal, against an integral over the wall. */
#include "base/sample.h"
#include "scene/lit_point.h"
#include "scene/near_gather.h"
#include "scene/scene.h"
#include "shade/draw_lobe.h"
#include "shade/fresnel.h"
#include "shade/point_init.h"
#include "support/near.h"
#include "support/one_scene.h"

#define RND_KEY 77
#include "support/rnd.h"

#define V4 "Film \"rgb\"\n"

/* f cos of a light at infinity. */
static lc_f3 reflected(const lc_point *p, lc_f3 dir)
{
    const lc_light_rec rec = { .pos = { dir.x, dir.y, dir.z } };
    return lc_estimate_one(ctx->shade_kernels, p, LC_LIGHT_DIRECTIONAL, &rec, NULL);
}

/* ---- drawing ---- */

static lc_material random_material(int i)
{
    static const lc_lobe lobes[] = { LC_LOBE_GGX, LC_LOBE_GGX, LC_LOBE_PHONG, LC_LOBE_WARD };
    lc_material m = { .ks = { 0.5f, 0.6f, 0.7f }, .lobe = lobes[i % 4], .exponent = (float)rnd_in(2, 200) };
    m.roughness[0] = (float)rnd_in(0.1, 0.6);
    m.roughness[1] = i % 4 == 1 ? (float)rnd_in(0.1, 0.6) : m.roughness[0];
    m.tangent = rnd_unit();
    return m;
}

/* The mean over directions of value / density is the integral over all directions: of 1 where the density is
 * above 0, and of what the point reflects. */
TEST(density_is_of_what_is_drawn)
{
    enum { MANY = 1 << 16 };
    for (int i = 0; i < 40; i++) {
        const lc_material m = random_material(i);
        const lc_f3 n = rnd_unit(), view = lc_f3_normalize(lc_f3_add(n, lc_f3_scale(rnd_unit(), 0.9f)));
        lc_point p;
        double by_lobe = 0, even = 0, all = 0;
        lc_point_init(&p, lc_f3_make(0, 0, 0), n, view, &m, 1e-10f);
        for (uint32_t k = 0; k < MANY; k++) {
            double u[2];
            lc_sample_pair(lc_hash2(5, (uint64_t)i), k, u);
            const lc_f3 d = lc_lobe_draw(&p, u);
            CHECK(near_rel((double)lc_f3_dot(d, d), 1, 1e-5));
            if (lc_f3_dot(d, n) > 0) by_lobe += (double)reflected(&p, d).y / lc_lobe_density(&p, d) / MANY;
            const double z = 1 - 2 * u[0], r = sqrt(1 - z * z), turn = 2 * LC_PI * u[1];
            const lc_f3 e = lc_f3_make((float)(r * cos(turn)), (float)(r * sin(turn)), (float)z);
            if (lc_f3_dot(e, n) > 0) even += (double)reflected(&p, e).y * 4 * LC_PI / MANY;
            all += lc_lobe_density(&p, e) * 4 * LC_PI / MANY;
        }
        CHECKF(near_rel(all, 1, 0.02), "case %d: density's integral %g", i, all);
        CHECKF(near_rel(by_lobe, even, 0.02), "case %d: %g of %g", i, by_lobe, even);
    }
}

/* Facets that are seen need no weight but Fresnel's and masking: at most 1, at grazing angles, too. */
TEST(no_direction_counts_for_more_than_all)
{
    for (int i = 0; i < 20000; i++) {
        lc_material m = random_material(i % 2);
        const double steep = rnd_in(0, 1);
        const lc_f3 n = rnd_unit(), up = lc_f3_scale(n, (float)(steep * steep)),
                    view = lc_f3_normalize(lc_f3_add(up, rnd_unit()));
        const double u[2] = { rnd(), rnd() };
        lc_point p;
        if (!(lc_f3_dot(view, n) > 0.001f)) continue;
        m.roughness[0] = (float)rnd_in(0.01, 1);
        lc_point_init(&p, lc_f3_make(0, 0, 0), n, view, &m, 1e-10f);
        const lc_f3 d = lc_lobe_draw(&p, u);
        if (!(lc_f3_dot(d, n) > 0.001f)) continue;
        const double weight = (double)reflected(&p, d).z / lc_lobe_density(&p, d);
        CHECKF(weight <= 1.01, "case %d: %g", i, weight);
        const float c = lc_f3_dot(lc_f3_normalize(lc_f3_add(view, d)), view);
        const lc_f3 facets = lc_reflectance(&m, c, false);
        const double left = (double)(facets.z * lc_lobe_unmasked(&p, d));
        CHECKF(near_rel(weight, left, 0.02), "case %d: %g of %g", i, weight, left);
    }
}

/* ---- rays ---- */

static void add_to(void *user, const lc_near_end *end)
{
    double *sum = user;
    CHECK(end->width > 0);
    *sum += (double)end->to.y;
}

/* A diffuse part by the cosine within reach and a lobe at any distance are all that the point reflects: in a
 * ball that is within reach, and for the lobe in one that is not. */
TEST(lobes_have_rays_of_their_own)
{
    scene_write(V4 "WorldBegin\nLightSource \"point\" \"rgb I\" [1 1 1]\nMaterial \"diffuse\"\n"
                   "Shape \"sphere\" \"float radius\" [3]\n");
    lc_load_desc load = LC_LOAD_DESC_INIT;
    lc_scene *s = scene_from_file(ctx, &load, scene_path());
    CHECK(s);
    for (int i = 0; s && i < 30; i++) {
        lc_lit lit = { .weight = { 1, 1, 1 } };
        lc_point soft, whole;
        double sum = 0, want = 0;
        const bool far = i % 2, diffuse = i % 3;
        lc_material *m = &lit.surface.material;
        *m = random_material(i % 8 == 2 ? 2 : i / 2 % 2);
        if (diffuse) m->kd = lc_f3_make(0.3f, 0.3f, 0.3f);
        if (i >= 24) m->ks = lc_f3_scale(m->ks, 0.04f); /* so weak that not all of its rays are traced */
        lit.surface.n = lit.surface.ng = rnd_unit();
        lit.view = lc_f3_normalize(lc_f3_add(lit.surface.n, lc_f3_scale(rnd_unit(), 0.8f)));
        lc_point_init(&whole, lc_f3_make(0, 0, 0), lit.surface.n, lit.view, m, 1e-10f);
        const lc_f3 ks = m->ks;
        m->ks = lc_f3_make(0, 0, 0);
        lc_point_init(&soft, lc_f3_make(0, 0, 0), lit.surface.n, lit.view, m, 1e-10f);
        m->ks = ks;
        soft.near_d2 = far ? 1 : 100;
        soft.near_scale = far ? 1 : 0.01f;
        soft.lobe_by_rays = true;
        if (far) memset(whole.diffuse, 0, sizeof whole.diffuse);
        const lc_near_ends ends = { s, add_to, &sum };
        lc_near_gather(&ends, &lit, &soft, (lc_near_rays){ .key = (uint64_t)i, .n = 1 << 15 });
        for (uint32_t k = 0; k < 1 << 17; k++) {
            double u[2];
            lc_sample_pair(9, k, u);
            const double z = 1 - 2 * u[0], r = sqrt(1 - z * z), turn = 2 * LC_PI * u[1];
            const lc_f3 e = lc_f3_make((float)(r * cos(turn)), (float)(r * sin(turn)), (float)z);
            if (!(lc_f3_dot(e, lit.surface.n) > 0)) continue;
            want += (double)reflected(&whole, e).y * 4 * LC_PI / (1 << 17);
        }
        CHECKF(near_rel(sum, want, 0.02), "case %d: %g of %g", i, sum, want);
    }
    lc_scene_destroy(s);
}

/* ---- a plate beside a wall ---- */

#define SIDE 8
#define METAL_OF(reflectance, roughness)                                                                    \
    "Material \"conductor\" \"rgb reflectance\" " reflectance                                             \
    " \"bool remaproughness\" [false] \"float roughness\" [" roughness "]\n"
#define PLATE                                                                                               \
    V4 "LookAt -2 1.2 0 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" 1.5\n"                         \
       "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nPixelFilter \"box\"\n"         \
       "Integrator \"path\" \"integer maxdepth\" 2\nWorldBegin\n"                                         \
       "LightSource \"point\" \"rgb I\" [1 1 1] \"point3 from\" [.3 2.2 .8]\n"                           \
       METAL_OF("[.9 .9 .9]", "%g")                                                                         \
       "Shape \"trianglemesh\" \"point3 P\" [-1 0 -1 1 0 -1 1 0 1 -1 0 1]"                               \
       " \"integer indices\" [0 2 1 0 3 2]\n"                                                             \
       "%s\n"                                                                                              \
       "Shape \"trianglemesh\" \"point3 P\" [1.5 0 -2 1.5 0 2 1.5 3 2 1.5 3 -2]"                         \
       " \"integer indices\" [0 1 2 0 2 3]\n"
#define DIFFUSE "Material \"diffuse\" \"rgb reflectance\" [.8 .8 .8]"
#define METAL METAL_OF("[.8 .8 .8]", ".3")

static const lc_f3 lamp = { 0.3f, 2.2f, 0.8f };

/* f cos / d^2 of the lamp at a place, towards a viewer. */
static double by_lamp(lc_f3 at, lc_f3 n, lc_f3 view, const lc_material *m)
{
    lc_point p;
    const lc_f3 way = lc_f3_sub(lamp, at);
    lc_point_init(&p, at, n, view, m, 1e-10f);
    return (double)reflected(&p, lc_f3_normalize(way)).y / (double)lc_f3_dot(way, way);
}

/* Radiance of the plate's middle: by the lamp, and by the wall. */
static double plate_by_integral(const lc_material *plate, const lc_material *wall, double *direct)
{
    enum { STEPS = 500 };
    const lc_f3 up = { 0, 1, 0 }, left = { -1, 0, 0 }, o = { 0, 0, 0 };
    const lc_f3 view = lc_f3_normalize(lc_f3_make(-2, 1.2f, 0));
    double sum = 0;
    lc_point p;
    lc_point_init(&p, o, up, view, plate, 1e-10f);
    for (int i = 0; i < STEPS; i++)
        for (int k = 0; k < STEPS; k++) {
            const lc_f3 at = { 1.5f, (float)(3 * (i + 0.5) / STEPS), (float)(4 * (k + 0.5) / STEPS - 2) };
            const lc_f3 dir = lc_f3_normalize(at);
            const double area = 12.0 / (STEPS * STEPS),
                         solid = area * (double)dir.x / (double)lc_f3_dot(at, at);
            sum += (double)reflected(&p, dir).y * by_lamp(at, left, lc_f3_neg(dir), wall) * solid;
        }
    *direct = by_lamp(o, up, view, plate);
    return sum + *direct;
}

static double mean(lc_scene *s, bool by_cuts)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    double sum = 0;
    d.method = by_cuts ? LC_METHOD_CUTS : LC_METHOD_EXACT;
    d.spp = 16;
    CHECK(!lc_render(ctx, s, &d, &image, NULL));
    for (int i = 0; image && i < SIDE * SIDE; i++) sum += (double)lc_image_channel(image, "G")[i];
    lc_image_destroy(image);
    return sum / (SIDE * SIDE);
}

static void check_plate(double roughness, const char *wall, uint32_t n_lights, double tolerance)
{
    lc_load_desc load = LC_LOAD_DESC_INIT;
    double direct;
    load.indirect_lights = n_lights;
    scene_write(PLATE, roughness, wall);
    lc_scene *s = scene_from_file(ctx, &load, scene_path());
    CHECK(s);
    if (!s) return;
    const double want = plate_by_integral(&s->materials[s->meshes[0].material_id],
                                          &s->materials[s->meshes[1].material_id], &direct),
                 exact = mean(s, false), cuts = mean(s, true);
    printf("    roughness %g, %u lights: %.5f, by cuts %.5f of %.5f, %.5f of it direct\n", roughness,
           n_lights, exact, cuts, want, direct);
    CHECKF(near_rel(exact, want, tolerance), "%g of %g", exact, want);
    CHECKF(near_rel(cuts, want, tolerance), "%g of %g", cuts, want);
    lc_scene_destroy(s);
}

/* However few virtual lights there are, and however far they are. */
TEST(metal_shows_a_wall)
{
    static const double roughness[] = { 0.06, 0.1, 0.3 };
    for (int i = 0; i < 3; i++) {
        check_plate(roughness[i], DIFFUSE, 300, 0.02);
        check_plate(roughness[i], DIFFUSE, 5000, 0.02);
    }
}

/* Metal that is seen in metal reflects the lamp by its lobe, not evenly. */
TEST(metal_shows_metal)
{
    check_plate(0.06, METAL, 5000, 0.04);
    check_plate(0.2, METAL, 5000, 0.04);
}

int main(void)
{
    ctx = quiet_context(2);
    temp_begin();
    RUN(density_is_of_what_is_drawn);
    RUN(no_direction_counts_for_more_than_all);
    RUN(lobes_have_rays_of_their_own);
    RUN(metal_shows_a_wall);
    RUN(metal_shows_metal);
    one_scene_end();
    temp_end();
    return test_done();
}
