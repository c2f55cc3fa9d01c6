/* unit_material.c - pbrt's materials and spectra: the material that each class becomes, against pbrt's
 * defaults and formulas and published reflectances of metals; and the material where a ray meets a textured,
 * bumpy or mixed surface, against values worked out by hand. */
#include "prepare/commit.h"
#include "scene/surface.h"
#include "support/near.h"
#include "support/one_scene.h"
#include "support/watched_memory.h"

#define QUAD                                                                                                 \
    "Shape \"trianglemesh\" \"point3 P\" [-1 -1 2  1 -1 2  1 1 2  -1 1 2] \"integer indices\" [0 1 2 0 2 "   \
    "3] "                                                                                                    \
    "\"point2 uv\" [0 0 1 0 1 1 0 1]\n"
#define V4 "Film \"rgb\"\nCamera \"perspective\"\nWorldBegin\n"
#define V3 "Film \"image\"\nCamera \"perspective\"\nWorldBegin\n"

static lc_status load(const char *head, const char *text) { return parse_format("%s%s", head, text); }

/* The material of a mesh after `Material text`; the scene and its notes stay. */
static const lc_material *one(const char *head, const char *text)
{
    lc_status st = parse_format("%sMaterial %s\n" QUAD, head, text);
    CHECKF(st == LC_OK && scene->n_meshes == 1, "%s: %s", text, last_error);
    if (st || !scene->n_meshes) exit(1);
    return &scene->materials[scene->meshes[0].material_id];
}
#define ONE4(text) one(V4, text)
#define ONE3(text) one(V3, text)

static bool rough(const lc_material *m, double ax, double ay)
{
    return m->lobe == LC_LOBE_GGX && near_abs((double)m->roughness[0], ax, 1e-5) &&
           near_abs((double)m->roughness[1], ay, 1e-5);
}

/* Reflectance along the normal of the metal's three channels. */
static lc_f3 metal(const lc_material *m)
{
    return lc_f3_make((float)lc_metal_share((double)m->eta.x, (double)m->k.x),
                      (float)lc_metal_share((double)m->eta.y, (double)m->k.y),
                      (float)lc_metal_share((double)m->eta.z, (double)m->k.z));
}

/* The surface at (x, y) of the quad. */
static lc_surface at(double x, double y)
{
    lc_surface s = { .t = 0 };
    lc_load_desc desc = { .area_lights = 1, .env_lights = 1, .seed = 1, .n_reps = 1,
                               .indirect_lights = LC_NO_LIGHTS };
    if (!scene->bvh && lc_scene_commit(scene, &desc)) abort();
    CHECK(lc_surface_hit(scene, lc_f3_make(0, 0, 0), lc_f3_normalize_d(x, y, 2), 0, &s));
    return s;
}

/* ---- numbers ---- */

TEST(formulas)
{
    CHECK(near_abs(lc_roughness_alpha(LC_REMAP_NONE, 0.3), 0.3, 0) &&
          near_abs(lc_roughness_alpha(LC_REMAP_SQRT, 0.09), 0.3, 1e-15));
    /* pbrt-v3's RoughnessToAlpha(0.1) with the C library's logarithm */
    double x = log(0.1);
    CHECK(near_abs(lc_roughness_alpha(LC_REMAP_POLYNOMIAL, 0.1),
                   1.62142 + 0.819955 * x + 0.1734 * x * x + 0.0171201 * x * x * x +
                       0.000640711 * x * x * x * x,
                   1e-12));
    CHECK(near_abs(lc_roughness_alpha(LC_REMAP_POLYNOMIAL, 0), lc_roughness_alpha(LC_REMAP_POLYNOMIAL, 1e-3),
                   0));
    for (double r = 0; r < 1; r += 0.01)
        for (double n = 0.05; n < 3; n += 0.1) {
            double eta = n, k = -1;
            lc_metal_of_share(r, &eta, &k);
            CHECKF(k >= 0 && near_abs(lc_metal_share(eta, k), r, 1e-12), "%g %g: %g %g", r, n, eta, k);
            CHECK(k > 0 ? near_abs(eta, n, 0) : eta > 0);
        }
    double eta = 1, k;
    lc_metal_of_share(0.36, &eta, &k); /* pbrt's: k = 2 sqrt(r) / sqrt(1 - r) */
    CHECK(near_abs(eta, 1, 0) && near_abs(k, 1.5, 1e-12));
    lc_metal_of_share(7, &eta, &k);
    CHECK(k > 100 && k < 1000);
}

/* ---- v4 ---- */

TEST(diffuse)
{
    CHECK(near3_abs(ONE4("\"diffuse\"")->kd, .5, .5, .5, 0) && scene->n_notes == 0);
    const lc_material *m = ONE4(
        "\"diffusetransmission\" \"rgb reflectance\" [.2 .4 .6] \"rgb transmittance\" [.8 .6 .4] "
        "\"float scale\" .5");
    CHECK(near3_abs(m->kd, .1, .2, .3, 1e-6) && near3_abs(m->kt, .4, .3, .2, 1e-6) &&
          near3_abs(m->ks, 0, 0, 0, 0) && scene->n_notes == 0);
    m = ONE4("\"diffusetransmission\"");
    CHECK(near3_abs(m->kd, .25, .25, .25, 0) && near3_abs(m->kt, .25, .25, .25, 0) && !m->mirror);
    CHECK(near3_abs(ONE4("\"subsurface\" \"rgb reflectance\" [.7 .5 .3] \"float g\" .2")->kd, .7, .5, .3,
                    1e-6) &&
          note("material subsurface"));
    CHECK(scene->n_notes == 1);
    CHECK(ONE4("\"hair\"")->kd.x < 0.5f && note("material hair"));
}

TEST(coats)
{
    const lc_material *m = ONE4("\"coateddiffuse\" \"rgb reflectance\" [.1 .2 .3] \"float roughness\" .09 "
          "\"float eta\" 1.6 \"float thickness\" 1");
    CHECK(m->coat && m->fresnel == LC_FRESNEL_DIELECTRIC && near3_abs(m->eta, 1.6, 1.6, 1.6, 1e-6) &&
          near3_abs(m->ks, 1, 1, 1, 0));
    CHECK(!m->smooth && rough(m, .3, .3) && near3_abs(m->kd, .1, .2, .3, 1e-7) &&
          note("material coateddiffuse") && scene->n_notes == 1);
    /* light from all sides crosses it at 1 to 1.28 times its thickness */
    CHECKF(m->coat_depth[0] > 1 && m->coat_depth[0] < 1.28f && m->coat_depth[1] > 2 && m->coat_terms == 5,
           "%g %g %u", (double)m->coat_depth[0], (double)m->coat_depth[1], m->coat_terms);
    m = ONE4("\"coateddiffuse\" \"integer maxdepth\" 3");
    CHECK(m->coat_terms == 2 && m->coat_depth[0] > 0.01f && m->coat_depth[0] < 0.0128f);
    m = ONE4("\"coateddiffuse\" \"integer maxdepth\" 0 \"float thickness\" -1");
    CHECK(!(lc_f3_max(m->kd) > 0) && !(m->coat_depth[0] > 0));
    m = ONE4(
        "\"coateddiffuse\" \"float uroughness\" .09 \"float vroughness\" .36 \"bool remaproughness\" false");
    CHECK(rough(m, .09, .36) && scene->meshes[0].brushed && near3_abs(m->eta, 1.5, 1.5, 1.5, 0));
    m = ONE4("\"coateddiffuse\" \"rgb albedo\" [.5 .5 .5]");
    CHECK(rough(m, (double)LC_MIN_ROUGHNESS, (double)LC_MIN_ROUGHNESS) && m->smooth && note("coat albedo"));
    /* Both layers become one metal; of a dark one below, only the coat's reflectance is left. */
    m = ONE4("\"coatedconductor\" \"rgb conductor.eta\" [1.5 1.5 1.5] \"rgb conductor.k\" [0 0 0] \"float "
             "conductor.roughness\" .25");
    CHECK(!m->coat && m->fresnel == LC_FRESNEL_CONDUCTOR && rough(m, .5, .5) &&
          near3_abs(metal(m), .04, .04, .04, 1e-6));
    m = ONE4("\"coatedconductor\" \"rgb reflectance\" [.5 .5 .5] \"float interface.thickness\" .5");
    const double below = .5 * exp(-1), sum = .04 + .96 * .96 * below / (1 - .04 * below);
    CHECKF(near3_abs(metal(m), sum, sum, sum, 1e-3), "%g, not %g", (double)metal(m).x, sum);
    m = ONE4("\"coatedconductor\" \"rgb conductor.eta\" [1.5 1.5 1.5] \"rgb conductor.k\" [0 0 0] \"float "
             "conductor.roughness\" .25");
    CHECK(note("material coatedconductor"));
    m = ONE4("\"coatedconductor\"");
    lc_f3 coated = metal(m);
    CHECK(m->mirror && coated.x > 0.8f && coated.x > coated.y && coated.y > coated.z);
    m = ONE4("\"coatedconductor\" \"float interface.roughness\" .25");
    CHECK(!m->mirror && rough(m, .5, .5));
}

TEST(metals)
{
    /* Copper is the default. */
    const lc_material *m = ONE4("\"conductor\" \"float roughness\" .04");
    lc_f3 copper = metal(m);
    CHECK(!m->mirror && rough(m, .2, .2) && near3_abs(m->ks, 1, 1, 1, 0) && near3_abs(m->kd, 0, 0, 0, 0) &&
          scene->n_notes == 0);
    CHECKF(near3_abs(copper, .955, .638, .538, 0.03), "%g %g %g", (double)copper.x, (double)copper.y,
           (double)copper.z);
    m = ONE4("\"conductor\" \"spectrum eta\" \"metal-Cu-eta\" \"spectrum k\" \"metal-Cu-k\"");
    CHECK(m->mirror && !m->glass &&
          near3_abs(metal(m), (double)copper.x, (double)copper.y, (double)copper.z, 0));
    /* Linear Rec.709, from indices tabulated at 56 wavelengths, by the same colour matching functions in
     * another program. */
    static const struct { const char *name; double rgb[3];
    } known[] = {
        { "Ag", { .97, .96, .915 } },
        { "Au", { .993, .789, .337 } },
        { "Al", { .913, .922, .924 } },
        { "CuZn", { .90, .78, .45 } },
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        char text[256];
        snprintf(text, sizeof text,
                 "\"conductor\" \"spectrum eta\" \"metal-%s-eta\" \"spectrum k\" \"metal-%s-k\"",
                 known[i].name, known[i].name);
        lc_f3 got = metal(ONE4(text));
        CHECKF(near3_abs(got, known[i].rgb[0], known[i].rgb[1], known[i].rgb[2], 0.025) &&
                   scene->n_notes == 0,
               "%s: %g %g %g", known[i].name, (double)got.x, (double)got.y, (double)got.z);
    }
    m = ONE4("\"conductor\" \"rgb eta\" [1 2 3] \"rgb k\" [4 5 6] \"float roughness\" .25");
    CHECK(near3_abs(m->eta, 1, 2, 3, 0) && near3_abs(m->k, 4, 5, 6, 0));
    /* A constant spectrum gives its value in each channel. */
    m = ONE4("\"conductor\" \"spectrum eta\" [200 1.5 900 1.5] \"spectrum k\" [200 3 900 3]");
    CHECK(near3_abs(m->eta, 1.5, 1.5, 1.5, 1e-6) && near3_abs(m->k, 3, 3, 3, 1e-5));
    m = ONE4("\"conductor\" \"rgb reflectance\" [.9 .5 0] \"float roughness\" .25");
    CHECK(near3_abs(metal(m), .9, .5, 0, 1e-6) && near3_abs(m->eta, 1, 1, 1, 0) &&
          m->fresnel == LC_FRESNEL_CONDUCTOR);
    m = ONE3("\"metal\"");
    CHECK(near3_abs(metal(m), (double)copper.x, (double)copper.y, (double)copper.z, 0) && !m->mirror);
    CHECK(
        rough(m, lc_roughness_alpha(LC_REMAP_POLYNOMIAL, .01), lc_roughness_alpha(LC_REMAP_POLYNOMIAL, .01)));
    CHECK(ONE4("\"conductor\" \"spectrum eta\" \"metal-Xx-eta\"")->mirror && note("spectrum by name"));
    CHECK(load(V4, "Material \"conductor\" \"float roughness\" -1") == LC_ERR_PARSE &&
          strstr(last_error, "'roughness' is negative"));
    CHECK(ONE4("\"conductor\" \"float roughness\" 3")->roughness[0] >= LC_MAX_ROUGHNESS && note("roughness"));
    /* Below 0.001 a surface is smooth, as in pbrt. */
    m = ONE4("\"conductor\" \"float roughness\" .002 \"bool remaproughness\" false");
    CHECK(rough(m, .002, .002) && !m->mirror && scene->n_notes == 0);
    m = ONE4("\"conductor\" \"float uroughness\" .0002 \"float vroughness\" .1 "
             "\"bool remaproughness\" false");
    CHECK(rough(m, (double)LC_MIN_ROUGHNESS, .1) && !m->mirror && note("roughness"));
    CHECK(ONE4("\"conductor\" \"float roughness\" .0009 \"bool remaproughness\" false")->mirror &&
          scene->n_notes == 0);
}

TEST(glasses)
{
    const lc_material *m = ONE4("\"dielectric\"");
    CHECK(m->mirror && m->glass && !m->thin && m->fresnel == LC_FRESNEL_DIELECTRIC &&
          near3_abs(m->eta, 1.5, 1.5, 1.5, 0));
    CHECK(near3_abs(m->ks, 1, 1, 1, 0) && near3_abs(m->kt, 1, 1, 1, 0) && near3_abs(m->kd, 0, 0, 0, 0) &&
          scene->n_notes == 1 && note("glass"));
    CHECK(
        near3_abs(ONE4("\"dielectric\" \"spectrum eta\" \"glass-SF11\"")->eta, 1.7847, 1.7847, 1.7847, 1e-4));
    CHECK(near3_abs(ONE4("\"dielectric\" \"spectrum eta\" [200 1.6 900 1.6]")->eta, 1.6, 1.6, 1.6, 1e-6));
    CHECK(ONE4("\"thindielectric\" \"float eta\" 1.3")->thin && scene->n_notes == 0);
    CHECK(ONE4("\"dielectric\" \"float roughness\" .1")->glass && note("rough glass"));
    m = ONE3("\"glass\" \"rgb Kr\" [.1 .2 .3] \"rgb Kt\" [.4 .5 .6] \"float index\" 1.2");
    CHECK(m->glass && near3_abs(m->ks, .1, .2, .3, 1e-7) && near3_abs(m->kt, .4, .5, .6, 1e-7) &&
          near3_abs(m->eta, 1.2, 1.2, 1.2, 1e-6));
    CHECK(near3_abs(ONE3("\"glass\" \"float index\" 1.2 \"float eta\" 1.7")->eta, 1.7, 1.7, 1.7, 1e-6) &&
          scene->n_notes == 1);
    CHECK(ONE3("\"glass\" \"float uroughness\" .1")->glass && note("rough glass"));
    CHECK(load(V4, "Material \"dielectric\" \"float eta\" -2") == LC_ERR_PARSE &&
          strstr(last_error, "'eta' is no index"));
}

/* ---- v3 ---- */

TEST(plastics)
{
    double alpha = lc_roughness_alpha(LC_REMAP_POLYNOMIAL, .1);
    const lc_material *m = ONE3("\"plastic\" \"rgb Kd\" [.1 .2 .3] \"rgb Ks\" [.4 .5 .6]");
    CHECK(near3_abs(m->kd, .1, .2, .3, 1e-7) && near3_abs(m->ks, .4, .5, .6, 1e-7) &&
          near3_abs(m->eta, 1.5, 1.5, 1.5, 0) && !m->coat);
    CHECK(m->fresnel == LC_FRESNEL_DIELECTRIC && rough(m, alpha, alpha) && scene->n_notes == 0);
    m = ONE3("\"uber\" \"float index\" 1.4 \"float roughness\" .3 \"bool remaproughness\" \"false\"");
    CHECK(near3_abs(m->kd, .25, .25, .25, 0) && near3_abs(m->ks, .25, .25, .25, 0) && rough(m, .3, .3) &&
          scene->n_notes == 0);
    CHECK(near3_abs(m->eta, 1.4, 1.4, 1.4, 1e-6));
    CHECK(!ONE3("\"uber\" \"rgb Kr\" [.1 .1 .1]")->mirror && note("uber Kr, Kt"));
    m = ONE3("\"uber\" \"rgb Kd\" [0 0 0] \"rgb Ks\" [0 0 0] \"rgb Kr\" [1 1 1] \"rgb Kt\" [.5 .5 .5]");
    CHECK(m->mirror && m->glass && near3_abs(m->ks, 1, 1, 1, 0) && near3_abs(m->kt, .5, .5, .5, 0) &&
          scene->n_notes == 1 && note("glass"));
    m = ONE3("\"substrate\" \"rgb Kd\" [.5 .5 .5] \"rgb Ks\" [.2 .4 0] \"float uroughness\" .2 \"float "
             "vroughness\" .3");
    CHECK(near3_abs(m->kd, .4, .3, .5, 1e-7) && near3_abs(m->ks, .2, .4, 0, 1e-7) &&
          m->fresnel == LC_FRESNEL_SCHLICK && note("material substrate"));
    CHECK(rough(m, lc_roughness_alpha(LC_REMAP_POLYNOMIAL, .2), lc_roughness_alpha(LC_REMAP_POLYNOMIAL, .3)));
    m = ONE3("\"translucent\" \"rgb Kd\" [.8 .4 .2] \"rgb Ks\" [.4 .4 .4] \"rgb reflect\" [.25 .25 .25] "
             "\"rgb transmit\" [.75 .75 .75]");
    CHECK(near3_abs(m->kd, .2, .1, .05, 1e-7) && near3_abs(m->kt, .6, .3, .15, 1e-7) &&
          near3_abs(m->ks, .1, .1, .1, 1e-7) && note("translucent lobe"));
    m = ONE3("\"disney\" \"color color\" [.8 .4 .2] \"float metallic\" .5 \"float roughness\" .5 \"float "
             "anisotropic\" 1");
    CHECK(near3_abs(m->kd, .4, .2, .1, 1e-7) && near3_abs(m->ks, .42, .22, .12, 1e-6) && rough(m, .25, .25) &&
          note("material disney"));
    CHECK(
        near3_abs(ONE3("\"kdsubsurface\" \"rgb Kd\" [.1 .2 .3] \"float eta\" 1.33")->kd, .1, .2, .3, 1e-7) &&
        note("material kdsubsurface"));
}

/* ---- textures ---- */

/* The float texture r, equal to u. */
#define RAMP                                                                                                 \
    "Texture \"r\" \"float\" \"bilerp\" \"float v00\" 0 \"float v01\" 0 \"float v10\" 1 \"float v11\" 1\n"
/* The spectrum texture c, equal to (u, v, 0). */
#define UV "Texture \"c\" \"spectrum\" \"uv\"\n"

TEST(textured)
{
    /* The value of a texture is remapped where it is looked up. */
    CHECK(load(V4, RAMP "Material \"conductor\" \"texture roughness\" \"r\"\n" QUAD) == LC_OK);
    lc_surface s = at(-.5, .5);
    CHECK(rough(&s.material, .5, .5) && !s.material.mirror);
    CHECK(load(V3, RAMP "Material \"plastic\" \"texture roughness\" \"r\"\n" QUAD) == LC_OK);
    s = at(-.8, .5);
    CHECKF(rough(&s.material, lc_roughness_alpha(LC_REMAP_POLYNOMIAL, .1),
                 lc_roughness_alpha(LC_REMAP_POLYNOMIAL, .1)),
           "%g", (double)s.material.roughness[0]);
    s = at(.9, .5);
    CHECK(rough(&s.material, 1, 1)); /* 1.5 in pbrt */
    CHECK(load(V4, UV "Material \"conductor\" \"texture reflectance\" \"c\" \"float roughness\" .5\n" QUAD) ==
          LC_OK);
    s = at(.6, -.4);
    CHECK(near3_abs(metal(&s.material), .8, .3, 0, 1e-6) && near3_abs(s.material.ks, 1, 1, 1, 0));
    CHECK(
        load(V4, UV
             "Material \"diffusetransmission\" \"texture reflectance\" \"c\" \"texture transmittance\" \"c\" "
             "\"float scale\" .5\n" QUAD) == LC_OK);
    s = at(.6, -.4);
    CHECK(near3_abs(s.material.kd, .4, .15, 0, 1e-6) && near3_abs(s.material.kt, .4, .15, 0, 1e-6) &&
          scene->n_notes == 0);
    CHECK(load(V3, UV "Material \"translucent\" \"texture Kd\" \"c\" \"rgb Ks\" [0 0 0] \"texture transmit\" "
                      "\"c\"\n" QUAD) == LC_OK);
    s = at(.6, -.4);
    CHECK(near3_abs(s.material.kd, .4, .15, 0, 1e-6) && near3_abs(s.material.kt, .64, .09, 0, 1e-6) &&
          scene->n_notes == 0);
    CHECK(load(V3, UV "Material \"substrate\" \"texture Kd\" \"c\" \"rgb Ks\" [.5 .5 .5]\n" QUAD) == LC_OK);
    CHECK(near3_abs(at(.6, -.4).material.kd, .4, .15, 0, 1e-6));
    CHECK(load(V4, RAMP "Material \"dielectric\" \"texture eta\" \"r\"\n" QUAD) == LC_OK &&
          note("textured parameter eta"));
}

/* ---- bumps ---- */

static bool points(lc_f3 n, double x, double y, double z)
{
    double len = sqrt(x * x + y * y + z * z);
    return near3_abs(n, x / len, y / len, z / len, 2e-6);
}

/* The camera looks along z. The quad's geometric normal is (0, 0, 1), so that the normal on the viewer's side
 * is (0, 0, -1). The height grows by 1 as u does, over two units of length. */
TEST(bumps)
{
    CHECK(load(V4, RAMP "Material \"diffuse\" \"texture displacement\" \"r\"\n" QUAD) == LC_OK &&
          scene->n_notes == 0);
    lc_surface s = at(.2, .3);
    CHECKF(points(s.n, .5, 0, -1) || points(s.n, -.5, 0, -1), "%g %g %g", (double)s.n.x, (double)s.n.y,
           (double)s.n.z);
    lc_f3 outside = s.n;
    CHECK(points(s.n, .5, 0, -1) && points(s.ng, 0, 0, -1)); /* a hill is a dent from behind */
    CHECK(load(V3, RAMP "ReverseOrientation Material \"matte\" \"texture bumpmap\" \"r\"\n" QUAD) == LC_OK &&
          scene->n_notes == 0);
    s = at(.2, .3);
    CHECK(points(s.n, -(double)outside.x, 0, (double)outside.z));
    CHECK(load(V4, RAMP "Material \"diffuse\" \"float displacement\" 3\n" QUAD) == LC_OK &&
          points(at(.2, .3).n, 0, 0, -1));
    /* The slope in space counts, not the one in uv. */
    CHECK(load(V4, "Texture \"x\" \"float\" \"bilerp\" \"string mapping\" \"planar\" \"vector3 v1\" [1 0 0] "
                   "\"vector3 v2\" [0 1 0] "
                   "\"float v01\" 1 \"float v10\" 0 \"float v11\" 1\nMaterial \"diffuse\" \"texture "
                   "displacement\" \"x\"\n" QUAD) == LC_OK);
    CHECK(points(at(.2, .3).n, 0, 1, -1));
    /* A mix has the bumps of the material that is chosen. */
    CHECK(load(V4,
               RAMP "MakeNamedMaterial \"a\" \"string type\" \"conductor\" \"texture displacement\" \"r\"\n"
                    "Material \"mix\" \"string materials\" [\"a\" \"a\"]\n" QUAD) == LC_OK &&
          points(at(.2, .3).n, .5, 0, -1));
}

/* Largest value of a picture of 20 x 20. */
static float brightest(const char *text)
{
    lc_render_desc desc = LC_RENDER_DESC_INIT;
    lc_load_desc load_desc = { .area_lights = 1, .env_lights = 1, .seed = 1, .n_reps = 1,
                               .indirect_lights = LC_NO_LIGHTS };
    lc_image *image;
    float most = 0;
    CHECK(load("Film \"rgb\" \"integer xresolution\" 20 \"integer yresolution\" 20\nCamera \"perspective\" "
               "\"float fov\" 50\n"
               "WorldBegin\n",
               text) == LC_OK);
    if (lc_scene_commit(scene, &load_desc) || lc_render(ctx, scene, &desc, &image, NULL)) abort();
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 400; i++)
            most = fmaxf(most, lc_image_channel(image, k == 0 ? "R" : k == 1 ? "G" : "B")[i]);
    lc_image_destroy(image);
    return most;
}

/* Lights behind the surface do not illuminate the viewer's side, even where a bump or an interpolated normal
 * faces them. */
TEST(no_leaks)
{
#define BEHIND                                                                                               \
    "LightSource \"point\" \"point3 from\" [.2 .1 2.1]\nLightSource \"point\" \"point3 from\" [9 0 3]\n"     \
    "LightSource \"distant\" \"point3 from\" [3 0 1] \"point3 to\" [0 0 0]\n"
#define BUMPY                                                                                                \
    "Texture \"x\" \"float\" \"fbm\"\n"                                                                      \
    "Texture \"h\" \"float\" \"scale\" \"texture tex\" \"x\" \"float scale\" 9\n"                            \
    "Material \"diffuse\" \"texture displacement\" \"h\"\n"
    CHECKF(!(brightest(BUMPY BEHIND QUAD) > 0), "%g", (double)brightest(BUMPY BEHIND QUAD));
    CHECK(!(brightest(BEHIND "Shape \"trianglemesh\" \"point3 P\" [-1 -1 2  1 -1 2  1 1 2  -1 1 2] \"integer "
                             "indices\" [0 1 2 0 2 3] "
                             "\"normal N\" [-1 0 -.1  1 0 -.1  1 0 -.1  -1 0 -.1]\n") > 0));
    CHECK(brightest(BUMPY BEHIND "LightSource \"point\"\n" QUAD) > 0);
}

/* Normal maps of one texel, which holds the normal n as (1 + n) / 2. */
TEST(normal_maps)
{
    static const struct { float n[3]; bool reverse; double want[3];
    } cases[] = {
        { { 0, 0, 1 }, false, { 0, 0, -1 } },        { { .6f, 0, .8f }, false, { -.6, 0, -.8 } },
        { { 0, .6f, .8f }, false, { 0, -.6, -.8 } }, { { .6f, 0, .8f }, true, { .6, 0, -.8 } },
        { { .6f, 0, -.8f }, false, { 0, 0, -1 } }, /* below the surface: it is ignored */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        float rgb[3];
        for (int k = 0; k < 3; k++) rgb[k] = 0.5f + 0.5f * cases[i].n[k];
        pfm_write(temp_path("n.pfm"), 1, 1, rgb);
        CHECK(parse_text_file(V4 "%sMaterial \"diffuse\" \"string normalmap\" \"n.pfm\"\n" QUAD,
                              cases[i].reverse ? "ReverseOrientation " : "") == LC_OK &&
              scene->n_notes == 0);
        lc_f3 n = at(.2, .3).n;
        CHECKF(points(n, cases[i].want[0], cases[i].want[1], cases[i].want[2]), "%zu: %g %g %g", i,
               (double)n.x, (double)n.y, (double)n.z);
    }
    unlink(temp_path("n.pfm"));
    CHECK(parse_file(scene_path()) == LC_OK && note("texture image"));
}

/* ---- mixes ---- */

#define TWO4                                                                                                 \
    "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\" [.2 .4 0]\n"                    \
    "MakeNamedMaterial \"b\" \"string type\" \"diffuse\" \"rgb reflectance\" [.6 .8 1]\n"                    \
    "MakeNamedMaterial \"m\" \"string type\" \"conductor\"\n"

#define MIX3(second)                                                                                         \
    "Material \"mix\" \"string namedmaterial1\" \"a\" \"string namedmaterial2\" \"" second "\" "

/* Share of the quad's points whose material is a mirror. */
static double mirrors(void)
{
    int n = 0;
    for (int y = 0; y < 100; y++)
        for (int x = 0; x < 100; x++) n += at(-.99 + .0197 * x, -.98 + .0197 * y).material.mirror;
    return n / 1e4;
}

TEST(mixes)
{
    CHECK(load(V4, TWO4 "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" .25\n" QUAD) ==
          LC_OK);
    CHECK(near3_abs(at(.3, .3).material.kd, .3, .5, .25, 1e-6) && scene->n_notes == 0);
    CHECK(load(V4, RAMP TWO4
               "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"texture amount\" \"r\"\n" QUAD) ==
          LC_OK);
    CHECK(near3_abs(at(.5, .3).material.kd, .5, .7, .75, 1e-6));
    /* In pbrt-v3 the amount is a colour, the share of the first material. */
    CHECK(load(V3, TWO4 MIX3("b") "\"rgb amount\" [1 .5 0]\n" QUAD) == LC_OK);
    CHECK(near3_abs(at(.3, .3).material.kd, .2, .6, 1, 1e-6));
    CHECK(load(V3, UV TWO4 MIX3("b") "\"texture amount\" \"c\"\n" QUAD) == LC_OK);
    CHECK(near3_abs(at(.5, .5).material.kd, .3, .5, 1, 1e-6));
    /* Each point has one material or the other, in the right proportion, and the same one each time. */
    CHECK(load(V4, TWO4 "Material \"mix\" \"string materials\" [\"a\" \"m\"] \"float amount\" .3\n" QUAD) ==
          LC_OK);
    double share = mirrors();
    CHECKF(near_abs(share, .3, 0.02) && near_abs(share, mirrors(), 0), "%g", share);
    CHECK(load(V4, TWO4 "Material \"mix\" \"string materials\" [\"a\" \"m\"] \"float amount\" 0\n" QUAD) ==
              LC_OK &&
          near_abs(mirrors(), 0, 0));
    CHECK(load(V4, TWO4 "Material \"mix\" \"string materials\" [\"a\" \"m\"] \"float amount\" 1\n" QUAD) ==
              LC_OK &&
          near_abs(mirrors(), 1, 0));
    /* Where the amount differs between channels, the mean over points is right. */
    CHECK(load(V3, TWO4 MIX3("m") "\"rgb amount\" [.9 .6 .3]\n" QUAD) == LC_OK);
    double sum[3] = { 0, 0, 0 };
    for (int i = 0; i < 10000; i++) {
        lc_material m = at(-.99 + .0197 * (i % 100), -.98 + .0197 * (i / 100)).material;
        sum[0] += (double)m.kd.x;
        sum[1] += (double)m.kd.y;
        sum[2] += (double)m.ks.z;
    }
    CHECKF(near_abs(sum[0] / 1e4, .18, .005) && near_abs(sum[1] / 1e4, .24, .01) &&
               near_abs(sum[2] / 1e4, .7, .02),
           "%g %g %g", sum[0], sum[1], sum[2]);
    /* Mixes of mixes, of unknown materials, of the invisible interface. */
    CHECK(load(V4, TWO4
               "MakeNamedMaterial \"x\" \"string type\" \"mix\" \"string materials\" [\"a\" \"m\"]\n"
               "Material \"mix\" \"string materials\" [\"x\" \"m\"] \"float amount\" .5\n" QUAD) == LC_OK &&
          near_abs(mirrors(), .75, 0.02));
    CHECK(load(V4, "Material \"mix\" \"string materials\" [\"p\" \"q\"]\n" QUAD) == LC_OK &&
          note("unknown material p") && note("unknown material q"));
    CHECK(load(V4, "MakeNamedMaterial \"i\" \"string type\" \"interface\"\nMaterial \"mix\" "
          "\"string materials\" [\"i\" \"i\"]\n" QUAD) == LC_OK);
    lc_material m = at(.3, .3).material;
    CHECK(m.glass && m.thin && near3_abs(m.eta, 1, 1, 1, 0) && near3_abs(m.kt, 1, 1, 1, 0));
    CHECK(load(V4, "Material \"mix\" \"string materials\" [\"a\"]") == LC_ERR_PARSE && strstr(last_error,
          "'materials' needs the names of two"));
    /* An opacity is a mix with nothing. */
    CHECK(load(V3, "Material \"uber\" \"rgb opacity\" [.25 .25 .25] \"rgb Kd\" [.5 .5 .5]\n" QUAD) == LC_OK &&
          near_abs(mirrors(), .75, 0.02));
    CHECK(load(V3, UV "Material \"uber\" \"texture opacity\" \"c\" \"rgb Kd\" [.5 .5 .5]\n" QUAD) == LC_OK &&
          scene->n_notes == 0);
}

TEST(deep_mixes)
{
    char text[8192], *end = text;
    end += sprintf(end, TWO4
                   "MakeNamedMaterial \"x0\" \"string type\" \"mix\" \"string materials\" [\"a\" \"m\"]\n");
    for (int i = 1; i < 40; i++)
        end += sprintf(
            end, "MakeNamedMaterial \"x%d\" \"string type\" \"mix\" \"string materials\" [\"x%d\" \"x%d\"]\n",
            i, i - 1, i - 1);
    sprintf(end, "NamedMaterial \"x39\"\n" QUAD);
    CHECK(load(V4, text) == LC_OK && note("mix depth") && near_abs(mirrors(), .5, 0.03));
}

/* ---- spectra ---- */

TEST(spectrum_files)
{
    file_text(temp_path("x.spd"), "# red and green\n300 .8 500,.8\n 500.01 .25\t# more\n900 2.5e-1");
    CHECK(parse_text_file(V4 "Material \"diffuse\" \"spectrum reflectance\" \"x.spd\"\n" QUAD) == LC_OK &&
          scene->n_notes == 0);
    lc_f3 kd = scene->materials[scene->meshes[0].material_id].kd;
    CHECKF(kd.z > 0.7f && kd.x < 0.3f && kd.y < 0.5f, "%g %g %g", (double)kd.x, (double)kd.y, (double)kd.z);
    CHECK(parse_text_file(
              V4 "Material \"diffuse\" \"spectrum reflectance\" [300 .8 500 .8 500.01 .25 900 .25]\n" QUAD) ==
          LC_OK);
    CHECK(near3_abs(scene->materials[scene->meshes[0].material_id].kd, (double)kd.x, (double)kd.y,
                    (double)kd.z, 0));
    CHECK(parse_text_file(V4 "Material \"diffuse\" \"spectrum reflectance\" \"y.spd\"\n" QUAD) == LC_OK &&
          note("spectrum by name"));
    static const struct { const char *text, *message; } faults[] = {
        { "400 1\n300 1\n", "y.spd:2:1: error: spectrum: wavelengths don't rise" },
        { "400 1\n500 x\n", "y.spd:2:1: error: spectrum: not a number: 'x'" },
        { "400 1\n500\n", "y.spd:3:1: error: spectrum: needs pairs of wavelength and value" },
        { "# none", "y.spd:1:1: error: spectrum: needs pairs of wavelength and value" },
        { "400 1e99", "y.spd:1:1: error: spectrum: not a number: '1e99'" },
    };
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
        file_text(temp_path("y.spd"), faults[i].text);
        CHECKF(parse_file(scene_path()) == LC_ERR_PARSE && strstr(last_error, faults[i].message), "%s",
               last_error);
    }
}

TEST(illuminants)
{
    CHECK(load(V4, "LightSource \"point\" \"spectrum I\" \"stdillum-D65\" LightSource \"point\" \"spectrum "
                   "I\" \"stdillum-A\" "
                   "LightSource \"point\" \"blackbody I\" 2856 LightSource \"point\" \"spectrum I\" "
                   "\"illum-acesD60\"") == LC_OK);
    const lc_light *l = scene->lights;
    CHECK(scene->n_notes == 0 && scene->n_lights == 4);
    CHECK(near3_abs(l[0].intensity, 1, 1, 1, 1e-3));
    /* Illuminant A is the black body of 2856 K. */
    CHECK(near3_abs(l[1].intensity, (double)l[2].intensity.x, (double)l[2].intensity.y,
                    (double)l[2].intensity.z, 0.02));
    for (int i = 0; i < 4; i++) CHECK(near_abs((double)lc_luminance(l[i].intensity), 1, 1e-5));
}

/* ---- the list of what a scene uses ---- */

static bool feature(const char *kind, const char *name, uint64_t count, lc_support support, const char *text)
{
    lc_feature f = LC_FEATURE_INIT;
    for (uint32_t i = 0; !lc_scene_get_feature(scene, i, &f); i++)
        if (!strcmp(f.kind, kind) && !strcmp(f.name, name))
            return f.count == count && f.support == support && strstr(f.text, text);
    return false;
}

TEST(features)
{
    lc_feature f = LC_FEATURE_INIT;
    CHECK(
        load("PixelFilter \"mitchell\" Film \"rgb\" \"float foo\" 1 Option \"bool x\" true Camera "
             "\"perspective\"\n",
             "WorldBegin Material \"diffuse\"\n" QUAD QUAD "Shape \"sphere\"\nShape \"nurbs\"\n"
             "MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\nMaterial \"hair\" Material \"hair\" \"rgb "
             "color\" [.1 .1 .1]\n"
             "Texture \"t\" \"float\" \"checkerboard\"\nLightSource \"point\" LightSource \"nova\"\n"
             "AreaLightSource \"diffuse\" MediumInterface \"a\" \"b\" Texture \"t\" \"float\" \"x\\ny\"\n") ==
        LC_OK);
    CHECK(feature("filter", "mitchell", 1, LC_SUPPORT_YES, ""));
    CHECK(feature("film", "rgb", 1, LC_SUPPORT_APPROXIMATED, "'foo' of 'rgb' is ignored"));
    CHECK(feature("directive", "Option", 1, LC_SUPPORT_IGNORED, "options") &&
          feature("camera", "perspective", 1, LC_SUPPORT_YES, ""));
    CHECK(feature("material", "diffuse", 2, LC_SUPPORT_YES, "") &&
          feature("material", "hair", 2, LC_SUPPORT_APPROXIMATED, "s.pbrt:"));
    CHECK(feature("shape", "trianglemesh", 2, LC_SUPPORT_YES, "") &&
          feature("shape", "sphere", 1, LC_SUPPORT_APPROXIMATED, "of triangles"));
    CHECK(feature("shape", "nurbs", 1, LC_SUPPORT_IGNORED, "skipped") &&
          feature("texture", "checkerboard", 1, LC_SUPPORT_YES, ""));
    CHECK(feature("texture", "x?y", 1, LC_SUPPORT_APPROXIMATED, "constant"));
    CHECK(feature("light", "point", 1, LC_SUPPORT_YES, "") &&
          feature("light", "nova", 1, LC_SUPPORT_IGNORED, "skipped"));
    CHECK(feature("area light", "diffuse", 1, LC_SUPPORT_YES, "") &&
          feature("medium", "MediumInterface", 1, LC_SUPPORT_APPROXIMATED, "no such medium"));
    CHECK(lc_scene_get_feature(scene, (uint32_t)scene->n_features, &f) == LC_ERR_ARG);
}

/* ---- memory ---- */

static lc_status parse_starved(lc_context *c)
{
    static const char text[] = V3 RAMP UV TWO4
        "MakeNamedMaterial \"x\" \"string type\" \"mix\" \"string namedmaterial1\" \"a\" "
        "\"string namedmaterial2\" \"b\" \"texture amount\" \"c\"\nNamedMaterial \"x\"\n" QUAD
        "Material \"uber\" \"texture opacity\" \"c\" \"texture Kd\" \"c\" "
        "\"texture roughness\" \"r\"\n" QUAD;
    return parse_text_in(c, text);
}

TEST(every_allocation_may_fail) { starve(parse_starved, 10); }

int main(void)
{
    ctx = quiet_context(1);
    temp_begin();
    RUN(formulas);
    RUN(diffuse);
    RUN(coats);
    RUN(metals);
    RUN(glasses);
    RUN(plastics);
    RUN(textured);
    RUN(bumps);
    RUN(no_leaks);
    RUN(normal_maps);
    RUN(mixes);
    RUN(deep_mixes);
    RUN(spectrum_files);
    RUN(illuminants);
    RUN(features);
    RUN(every_allocation_may_fail);
    one_scene_end();
    temp_end();
    return test_done();
}
