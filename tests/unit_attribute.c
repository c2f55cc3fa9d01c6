/* unit_attribute.c - pbrt-v4's Attribute and ColorSpace: what they change, where their scope ends, and the
 * message and place of each error. Colours are compared with the published matrices of the colour spaces. */
#include "support/near.h"
#include "support/one_scene.h"

/* To the digits that published matrices of colour spaces have. */
static bool rgb_is(lc_f3 v, double r, double g, double b) { return near3_abs(v, r, g, b, 2e-4); }

static lc_f3 kd(size_t i) { return scene->materials[i].kd; }

/* Largest distance of a mesh's vertices from the origin. */
static double radius(size_t mesh)
{
    double most = 0;
    for (size_t t = 0; t < scene->meshes[mesh].n_tris; t++) {
        size_t v = scene->index[3 * (scene->meshes[mesh].first_tri + t)];
        most = fmax(most, (double)lc_f3_len(lc_f3_load(scene->pos + 3 * v)));
    }
    return most;
}

TEST(defaults_of_shapes)
{
    CHECK(parse_text(
              "WorldBegin Shape \"sphere\" AttributeBegin Attribute \"shape\" \"float radius\" 3 \"bool "
              "foo\" true\n"
              "Shape \"sphere\" Shape \"sphere\" \"float radius\" 2 AttributeEnd Shape \"sphere\"") == LC_OK);
    CHECK(scene->n_meshes == 4 && scene->n_notes == 1); /* the one: round shapes; no shape has a foo */
    CHECK(near_abs(radius(0), 1, 1e-6) && near_abs(radius(1), 3, 1e-6) && near_abs(radius(2), 2, 1e-6) &&
          near_abs(radius(3), 1, 1e-6));
    CHECK(parse_text(
              "Attribute \"shape\" \"float radius\" 3 WorldBegin TransformBegin Attribute \"shape\" \"float "
              "radius\" 4 TransformEnd\n"
              "Shape \"sphere\"") == LC_OK);
    CHECK(near_abs(radius(0), 4, 1e-6)); /* TransformEnd does not end it; the later one counts */
    CHECK(parse_text("WorldBegin Attribute \"shape\" \"integer indices\" [0 1 2 0 2 3]\n"
                     "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0] Shape \"trianglemesh\" "
                     "\"point3 P\" [0 0 0 1 0 0 1 1 0]\n"
                     "\"integer indices\" [0 1 2]") == LC_OK);
    CHECK(scene->meshes[0].n_tris == 2 && scene->meshes[1].n_tris == 1);
    CHECK(parse_text("WorldBegin Attribute \"shape\" \"integer indices\" [] Shape \"sphere\"") == LC_OK);
}

TEST(defaults_of_materials)
{
    CHECK(parse_text(
              "WorldBegin Texture \"t\" \"spectrum\" \"constant\" \"rgb value\" [.7 .6 .5]\n"
              "Attribute \"material\" \"rgb reflectance\" [.1 .2 .3]\nMaterial \"diffuse\"\n"
              "Material \"diffuse\" \"texture reflectance\" \"t\"\nMaterial \"diffuse\" \"rgb reflectance\" "
              "[1 0 1]\n"
              "AttributeBegin Attribute \"material\" \"texture reflectance\" \"t\" Material \"diffuse\" "
              "AttributeEnd\n"
              "MakeNamedMaterial \"m\" \"string type\" \"diffuse\"\n"
              "Attribute \"material\" \"string type\" \"mirror\" MakeNamedMaterial \"n\"") == LC_OK);
    CHECK(scene->n_materials == 6 && scene->n_notes == 0);
    CHECK(rgb_is(kd(0), .1, .2, .3) && rgb_is(kd(1), .7, .6, .5) && rgb_is(kd(2), 1, 0, 1));
    CHECK(rgb_is(kd(3), .7, .6, .5) && rgb_is(kd(4), .1, .2, .3) && scene->materials[5].mirror);
}

TEST(defaults_of_lights_and_textures)
{
    CHECK(parse_text(
              "WorldBegin Attribute \"light\" \"rgb I\" [2 3 4] \"float scale\" 2 \"bool twosided\" true "
              "LightSource \"point\"\n"
              "AreaLightSource \"diffuse\" Attribute \"texture\" \"rgb value\" [.2 .4 .6] Attribute "
              "\"medium\" \"float scale\" 2\n"
              "Texture \"t\" \"spectrum\" \"constant\" Material \"diffuse\" \"texture reflectance\" \"t\" "
              "Shape \"sphere\"") == LC_OK);
    CHECK(rgb_is(scene->lights[0].intensity, 4, 6, 8) && scene->meshes[0].two_sided &&
          near_abs((double)scene->meshes[0].emission.x, 2, 2e-3));
    CHECK(rgb_is(kd(0), .2, .4, .6) && scene->n_notes == 1);
}

TEST(attribute_errors)
{
    EXPECT_FAILURE(parse_text("WorldBegin\n Attribute \"shapes\" \"float radius\" 3"), LC_ERR_PARSE,
                   "s.pbrt:2:12: error: Attribute of 'shapes', which is none of shape, light, material, "
                   "medium, texture");
    EXPECT_FAILURE(parse_text(
                       "WorldBegin\nAttribute \"shape\" \"float radius\" -3\nShape \"sphere\" Attribute "
                       "\"light\" \"rgb I\" [1 -1 1]\nLightSource \"point\""),
                   LC_ERR_PARSE, "s.pbrt:3:34: error: parameter 'I' is negative");
    CHECK(parse_text("WorldBegin Attribute \"shape\" \"float radius\"") == LC_ERR_PARSE);
}

/* More than 256 parameters in force are an error at the first one too many; the end of a block makes room
 * again, so that a scene may have any number of Attributes. */
TEST(no_end_of_attributes)
{
    char *text = malloc(1 << 20), *at = text + sprintf(text, "WorldBegin ");
    for (int i = 0; i < 1000; i++)
        at += sprintf(at,
                      "AttributeBegin Attribute \"shape\" \"float radius\" %d Shape \"disk\" AttributeEnd\n",
                      i + 1);
    CHECK(parse_text(text) == LC_OK && scene->n_meshes == 1000 && near_abs(radius(999), 1000, 1e-3));
    at = text + sprintf(text, "WorldBegin\n");
    for (int i = 0; i < 257; i++) at += sprintf(at, "Attribute \"shape\" \"float radius\" 2\n");
    CHECK(parse_text(text) == LC_ERR_PARSE &&
          strstr(last_error, "s.pbrt:258:19: error: more than 256 parameters"));
    at = text + sprintf(text, "WorldBegin Attribute \"shape\" \"point3 P\" [");
    for (int i = 0; i < 1366; i++) at += sprintf(at, "0 0 0 ");
    sprintf(at, "]");
    CHECK(parse_text(text) == LC_ERR_PARSE &&
          strstr(last_error, "s.pbrt:1:30: error: more than 256 parameters"));
    free(text);
}

static const char *const matte = "Material \"diffuse\" \"rgb reflectance\" ";

static void expect_colours(const char *space, const char *rgb, const double light[3], const double albedo[3])
{
    CHECK(parse_format("WorldBegin ColorSpace \"%s\" %s%s LightSource \"point\" \"rgb I\" %s", space, matte,
                       rgb, rgb) == LC_OK);
    CHECKF(rgb_is(kd(0), albedo[0], albedo[1], albedo[2]), "%s %s: %g %g %g", space, rgb, (double)kd(0).x,
           (double)kd(0).y, (double)kd(0).z);
    lc_f3 i = scene->lights[0].intensity;
    CHECKF(rgb_is(i, light[0], light[1], light[2]), "%s %s: %g %g %g", space, rgb, (double)i.x, (double)i.y,
           (double)i.z);
}
#define SAME(space, rgb, ...)                                                                                \
    expect_colours(space, rgb, (const double[]){ __VA_ARGS__ }, (const double[]){ __VA_ARGS__ })

/* Published matrices: BT.2087 for Rec. 2020, Apple's P3 with D65, the Academy's AP0. */
TEST(colour_spaces)
{
    SAME("srgb", "[.1 .2 .3]", .1, .2, .3);
    SAME("sRGB", "[.1 .2 .3]", .1, .2, .3);
    SAME("rec2020", "[1 1 1]", 1, 1, 1);
    SAME("Rec2020", "[.2 .3 .25]", .1375809, .3128634, .2458787);
    SAME("dci-p3", "[.5 .5 .5]", .5, .5, .5);
    SAME("dci-p3", "[.3 .4 .5]", .2775060, .4042057, .5117911);
    CHECK(scene->n_notes == 0);
    expect_colours("aces2065-1", "[1 1 1]", (const double[]){ 1.047103, .994543, .915318 },
                   (const double[]){ 1, 1, 1 });
    CHECK(note("reflectance") == NULL && scene->n_notes == 0);
    SAME("rec2020", "[0 .5 0]", 0, .56645, 0);
    CHECK(note("gamut of rec2020") && note("gamut of rec2020")->count == 2);
    SAME("xyz", "[.1 .2 .3]", .1, .2, .3);
    CHECK(note("colour space xyz"));
}

TEST(spaces_end_with_their_block)
{
    CHECK(parse_text(
              "ColorSpace \"rec2020\" WorldBegin AttributeBegin ColorSpace \"srgb\" Material \"diffuse\" "
              "\"rgb reflectance\" [.2 .3 .25]\n"
              "AttributeEnd Material \"diffuse\" \"rgb reflectance\" [.2 .3 .25]\n"
              "Attribute \"material\" \"rgb reflectance\" [.2 .3 .25] ColorSpace \"srgb\" Material "
              "\"diffuse\"\n"
              "Material \"diffuse\" \"rgb reflectance\" [.2 .3 .25]") == LC_OK);
    CHECK(rgb_is(kd(0), .2, .3, .25) && rgb_is(kd(1), .1375809, .3128634, .2458787));
    /* The colour space in force at the Attribute counts, not the one at the Material. */
    CHECK(rgb_is(kd(2), .1375809, .3128634, .2458787) && rgb_is(kd(3), .2, .3, .25));
}

int main(void)
{
    ctx = quiet_context(1);
    RUN(defaults_of_shapes);
    RUN(defaults_of_materials);
    RUN(defaults_of_lights_and_textures);
    RUN(attribute_errors);
    RUN(no_end_of_attributes);
    RUN(colour_spaces);
    RUN(spaces_end_with_their_block);
    one_scene_end();
    return test_done();
}
