/* unit_textured.c - textures of scene files: the material where a ray meets a textured mesh, and a picture,
 * against the texels, coordinates and formulas of the statements, worked out by hand. */
#include "scene/surface.h"
#include "support/jpeg_file.h"
#include "support/near.h"
#include "support/one_scene.h"
#include "support/watched_memory.h"

static void write_file(const char *name, const void *data, size_t n) { file_write(temp_path(name), data, n); }

/* 2 x 2 pixels: red and green over blue and the grey of code 128. The file has blue, green, red of each, rows
 * from the top. */
static void write_tga(const char *name)
{
    static const uint8_t bytes[] = { 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 24, 32,
                                     0, 0, 255, 0, 255, 0, 255, 0, 0, 128, 128, 128 };
    write_file(name, bytes, sizeof bytes);
}

#define HEAD4 "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 40\n"
#define HEAD3 "Film \"image\" \"integer xresolution\" 40 \"integer yresolution\" 40\n"
#define CAMERA                                                                   \
    "Camera \"perspective\" \"float fov\" 90\nIntegrator \"directlighting\"\n" \
    "WorldBegin\nLightSource \"distant\"\n"
/* The square -1..1 at z = 1, which fills the picture; u grows to the right, as x does, and v upwards. */
#define QUAD                                                                                                 \
    "Shape \"trianglemesh\" \"point3 P\" [-1 -1 1 1 -1 1 1 1 1 -1 1 1] \"integer indices\" [0 1 2 0 2 3] "
#define UV4 "\"point2 uv\" [0 0 1 0 1 1 0 1]\n"
#define UV3 "\"float st\" [0 0 1 0 1 1 0 1]\n"
#define MATTE "Material \"matte\" \"texture Kd\" \"t\"\n"

static lc_status load(const char *head, const char *body)
{
    return load_text(NULL, "%s%s%s", head, CAMERA, body);
}

/* kd where the ray from the origin through (x, y, 1) arrives. pixel: width of a pixel, 0 for a point. */
static lc_f3 kd_at(double x, double y, double pixel)
{
    lc_surface s;
    lc_f3 dir = lc_f3_normalize_d(x, y, 1);
    if (!scene || !lc_surface_hit(scene, lc_f3_make(0, 0, 0), dir, pixel, &s)) return lc_f3_make(-1, -1, -1);
    return s.material.kd;
}

static bool rgb_is(lc_f3 v, double r, double g, double b) { return near3_abs(v, r, g, b, 1e-4); }

#define GREY 0.2158605 /* sRGB code 128 */

/* Each quarter of the square has the colour of one pixel of the image at its centre. */
static bool quarters(void)
{
    return rgb_is(kd_at(-.5, .5, 0), 1, 0, 0) && rgb_is(kd_at(.5, .5, 0), 0, 1, 0) &&
           rgb_is(kd_at(-.5, -.5, 0), 0, 0, 1) && rgb_is(kd_at(.5, -.5, 0), GREY, GREY, GREY);
}

TEST(imagemap_of_both_versions)
{
    write_tga("a.tga");
    CHECK(load(HEAD4, "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.tga\"\n"
                      "Material \"diffuse\" \"texture reflectance\" \"t\"\n" QUAD UV4) == LC_OK);
    CHECK(quarters() && scene->n_notes == 0);
    CHECK(rgb_is(kd_at(0, 0, 0), (1 + GREY) / 4, (1 + GREY) / 4, (1 + GREY) / 4)); /* all four meet */
    CHECK(load(HEAD3, "Texture \"t\" \"color\" \"imagemap\" \"string filename\" [\"a.tga\"] \"bool "
                      "trilinear\" \"true\"\n" MATTE QUAD UV3) == LC_OK);
    CHECK(quarters() && scene->n_notes == 0);
    /* A pixel as wide as the square has about the mean of the image, from level 1. */
    CHECK(fabs((double)kd_at(-.5, .5, 2).x - (1 + GREY) / 4) < 0.003); /* one of 256 codes */
    CHECK(load(HEAD3, "Texture \"t\" \"color\" \"imagemap\" \"string filename\" [\"a.tga\"] \"bool gamma\" "
                      "\"false\"\n" MATTE QUAD UV3) == LC_OK);
    CHECK(rgb_is(kd_at(.5, -.5, 0), 128 / 255.0, 128 / 255.0, 128 / 255.0) && note("texture filter EWA"));
    CHECK(load(HEAD4,
               "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.tga\" \"string encoding\" "
               "\"gamma 2\" "
               "\"float scale\" 0.5 \"bool invert\" true \"string filter\" \"point\"\n" MATTE QUAD UV4) ==
          LC_OK);
    double want = 1 - 0.5 * (128 / 255.0) * (128 / 255.0);
    CHECK(rgb_is(kd_at(.5, -.5, 0), want, want, want) && rgb_is(kd_at(-.9, .1, 0), 0.5, 1, 1));
}

TEST(wrapping_and_mapping)
{
    write_tga("a.tga");
    CHECK(load(HEAD4, "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.tga\" \"float "
                      "uscale\" 2 \"float vscale\" 2 "
                      "\"string filter\" \"point\"\n" MATTE QUAD UV4) == LC_OK);
    CHECK(rgb_is(kd_at(-.75, .75, 0), 1, 0, 0) && rgb_is(kd_at(.25, .75, 0), 1, 0, 0) &&
          rgb_is(kd_at(.75, -.75, 0), GREY, GREY, GREY));
    CHECK(load(HEAD4, "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.tga\" \"float "
                      "uscale\" 2 \"float vscale\" 2 "
                      "\"string filter\" \"point\" \"string wrap\" \"black\"\n" MATTE QUAD UV4) == LC_OK);
    CHECK(rgb_is(kd_at(-.75, -.75, 0), 0, 0, 1) && rgb_is(kd_at(.25, .75, 0), 0, 0, 0));
    CHECK(load(HEAD4,
               "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.tga\" \"float udelta\" 5 "
               "\"string wrap\" \"clamp\"\n" MATTE QUAD UV4) == LC_OK);
    CHECK(rgb_is(kd_at(-.75, .75, 0), 0, 1, 0));
    /* pbrt-v4's planar mapping is in the texture's space, which is moved and scaled here. */
    CHECK(load(HEAD4, "AttributeBegin\nTranslate -1 -1 0\nScale 2 2 2\nTexture \"t\" \"spectrum\" "
                      "\"imagemap\" \"string filename\" "
                      "\"a.tga\" \"string mapping\" \"planar\"\nAttributeEnd\n" MATTE QUAD) == LC_OK);
    CHECK(quarters());
    /* pbrt-v3's is in world space. */
    CHECK(
        load(
            HEAD3,
            "AttributeBegin\nTranslate 9 9 9\nTexture \"t\" \"color\" \"imagemap\" \"string filename\" "
            "\"a.tga\" "
            "\"string mapping\" \"planar\" \"vector v1\" [.5 0 0] \"vector v2\" [0 .5 0] \"float udelta\" .5 "
            "\"float vdelta\" .5\nAttributeEnd\n" MATTE QUAD) == LC_OK);
    CHECK(quarters());
    /* The uv that pbrt gives to triangles without any. */
    CHECK(load(HEAD4, "Texture \"t\" \"spectrum\" \"uv\"\n" MATTE QUAD) == LC_OK);
    CHECK(rgb_is(kd_at(.5, -.5, 0), .75, .25, 0) && rgb_is(kd_at(-.5, .5, 0), .75, .5, 0));
}

/* A file is read once for each encoding, however often it is used; files that cannot be used are noted. */
TEST(files_and_notes)
{
    write_tga("a.tga");
    CHECK(load(HEAD4, "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.tga\"\n"
                      "Texture \"u\" \"float\" \"imagemap\" \"string filename\" \"a.tga\"\n"
                      "Texture \"w\" \"float\" \"imagemap\" \"string filename\" \"a.tga\" \"string "
                      "encoding\" \"linear\"\n"
                      "Texture \"x\" \"spectrum\" \"ptex\"\n" MATTE QUAD UV4) == LC_OK);
    CHECK(scene->textures.n == 4 && scene->textures.n_images == 2 && note("texture ptex"));
    lc_scene_info info = LC_SCENE_INFO_INIT;
    const char *name;
    uint64_t count, n_images = 0;
    lc_scene_get_info(scene, &info);
    CHECK(info.n_textures == 4 && info.n_images == 2 && info.image_bytes == 2 * 3 * 5);
    for (uint32_t k = 0; !lc_scene_get_texture_class(scene, k, &name, &count); k++)
        if (!strcmp(name, "imagemap")) n_images = count;
    CHECK(n_images == 3);
    CHECK(load(HEAD4, "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"gone.png\" \"float "
                      "scale\" .5\n" MATTE QUAD UV4) == LC_OK);
    CHECK(note("texture image") && rgb_is(kd_at(.5, .5, 0), .25, .25, .25) && !scene->uv);
    static const jpeg_plan grey = { .width = 8, .height = 8, .n_parts = 1, .h = { 1 }, .v = { 1 },
                                    .quant = { 8 }, .coefs = { { { 60 } } } };
    static jpeg_file jpeg;
    jpeg_write(&jpeg, &grey); /* 128 + 60 everywhere, as sRGB */
    write_file("j.jpg", jpeg.data, jpeg.n);
    CHECK(load(HEAD4,
               "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"j.jpg\"\n" MATTE QUAD UV4) ==
          LC_OK);
    double linear = pow((188 / 255.0 + .055) / 1.055, 2.4);
    CHECK(!scene->n_notes && rgb_is(kd_at(.5, .5, 0), linear, linear, linear));
    write_file("cut.tga", "\0\0\2\0\0\0\0\0\0\0\0\0\2\0\2\0\30\40abc", 21);
    CHECK(load(HEAD4,
               "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"cut.tga\"\n" MATTE QUAD UV4) ==
          LC_ERR_PARSE);
    CHECK(strstr(last_error, "cut.tga: error: damaged TGA file: pixels are missing at byte 21"));
    CHECK(load(HEAD4, "Texture \"t\" \"spectrum\" \"imagemap\"\n") == LC_ERR_PARSE &&
          strstr(last_error, "imagemap without"));
}

TEST(values_of_materials)
{
    lc_surface s;
    CHECK(
        load(HEAD4,
             "Texture \"e\" \"float\" \"mix\" \"float tex1\" 10 \"float tex2\" 30 \"texture amount\" \"m\"\n"
             "Texture \"m\" \"float\" \"constant\" \"float value\" .25\n") == LC_OK &&
        note("unknown texture m"));
    CHECK(
        load(HEAD4,
             "Texture \"m\" \"float\" \"bilerp\" \"float v00\" 0 \"float v10\" 1 \"float v01\" 0 \"float "
             "v11\" 1\n"
             "Texture \"e\" \"float\" \"mix\" \"float tex1\" 10 \"float tex2\" 30 \"texture amount\" \"m\"\n"
             "Texture \"c\" \"spectrum\" \"uv\"\n"
             "Texture \"k\" \"spectrum\" \"scale\" \"texture tex\" \"c\" \"float scale\" .5\n"
             "Material \"phong\" \"texture Kd\" \"c\" \"texture Ks\" \"k\" \"texture exponent\" \"e\"\n" QUAD
                 UV4) == LC_OK);
    CHECK(lc_surface_hit(scene, lc_f3_make(0, 0, 0), lc_f3_normalize_d(.5, -.5, 1), 0, &s));
    CHECK(rgb_is(s.material.kd, .75, .25, 0) && rgb_is(s.material.ks, .375, .125, 0) &&
          fabs((double)s.material.exponent - 25) < 1e-3);
    /* pbrt-v4's directionmix goes by the cosine between the normal, along z, and a direction, which the
     * matrix turns from 0 3 4 to 0 -4 3. */
    CHECK(load(HEAD4, "AttributeBegin Rotate 90 1 0 0\nTexture \"t\" \"spectrum\" \"directionmix\" \"vector3 "
                      "dir\" [0 3 4]\n"
                      "\"rgb tex1\" [1 .5 0] \"rgb tex2\" [0 0 1] AttributeEnd\n" MATTE QUAD) == LC_OK &&
          scene->n_notes == 0);
    CHECK(rgb_is(kd_at(.5, -.5, 0), .6, .3, .4));
    /* Reflectances are clamped to 0..1. */
    CHECK(load(HEAD3, "Texture \"c\" \"color\" \"checkerboard\" \"float uscale\" 2 \"float vscale\" 2 \"rgb "
                      "tex1\" [3 .5 -1]\n"
                      "MakeNamedMaterial \"n\" \"string type\" \"plastic\" \"texture Kd\" "
                      "\"c\"\nNamedMaterial \"n\"\n" QUAD UV3) == LC_OK);
    CHECK(rgb_is(kd_at(-.5, -.5, 0), 1, .5, 0) && rgb_is(kd_at(.5, -.5, 0), 0, 0, 0) && note("reflectance"));
}

/* Roughness may be a texture. The direction of anisotropic roughness is that of u; isotropic roughness needs
 * no uv. */
TEST(ward)
{
    lc_surface s;
    CHECK(load(HEAD4, "Texture \"e\" \"float\" \"bilerp\" \"float v00\" 0 \"float v10\" 1 \"float v01\" 0 "
                      "\"float v11\" 2\n"
                      "Material \"ward\" \"rgb Ks\" [.5 .5 .5] \"texture uroughness\" \"e\" \"float "
                      "vroughness\" .3\n" QUAD UV4) == LC_OK);
    CHECK(lc_surface_hit(scene, lc_f3_make(0, 0, 0), lc_f3_normalize_d(.5, -.5, 1), 0, &s));
    CHECK(rgb_is(lc_f3_make(s.material.roughness[0], s.material.roughness[1], 0), .9375, .3, 0));
    CHECK(fabs(fabs((double)s.material.tangent.x) - 1) < 1e-6);
    CHECK(lc_surface_hit(scene, lc_f3_make(0, 0, 0), lc_f3_normalize_d(-.999, -.9, 1), 0, &s));
    CHECK(rgb_is(lc_f3_make(s.material.roughness[0], s.material.roughness[1], 0), LC_MIN_ROUGHNESS, .3,
                 0)); /* raised to the least roughness */
    CHECK(load(HEAD4, "Material \"ward\" \"float roughness\" .3\n" QUAD UV4) == LC_OK && !scene->uv);
    CHECK(load(HEAD4, "Material \"ward\" \"float uroughness\" .3\n" QUAD) == LC_OK);
    CHECK(lc_surface_hit(scene, lc_f3_make(0, 0, 0), lc_f3_normalize_d(.5, -.5, 1), 0, &s) &&
          rgb_is(s.material.tangent, 0, 0, 0));
    /* On a sphere u runs around the axis. */
    CHECK(load(HEAD4, "Material \"ward\" \"float uroughness\" .3\nTranslate 0 0 3\nRotate 90 1 0 0\nShape "
                      "\"sphere\"\n") == LC_OK);
    CHECK(lc_surface_hit(scene, lc_f3_make(0, 0, 0), lc_f3_normalize_d(.01, .01, 1), 0, &s));
    CHECK(fabs(fabs((double)s.material.tangent.x) - 1) < 2e-3 && fabs((double)s.material.tangent.y) < 1e-5);
}

/* Coordinates from PLY files, of spheres, disks and instances. */
TEST(coordinates_of_shapes)
{
    static const char ply[] =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\n"
        "end_header\n-1 -1 1 .5 .5\n1 -1 1 .25 .5\n1 1 1 .25 .75\n3 0 1 2\n";
    write_file("m.ply", ply, sizeof ply - 1);
    CHECK(load(HEAD4, "Texture \"t\" \"spectrum\" \"uv\"\n" MATTE
                      "Shape \"plymesh\" \"string filename\" \"m.ply\"\n") == LC_OK);
    CHECK(rgb_is(kd_at(.5, -.5, 0), .25 * .5 + .5 * .25 + .25 * .25, .5 * .75 + .25 * .75, 0));
    CHECK(load(HEAD4, "Texture \"t\" \"spectrum\" \"uv\"\n" MATTE "ObjectBegin \"o\"\n" QUAD UV4
                      "ObjectEnd\nScale .5 .5 .5\n"
                      "ObjectInstance \"o\"\n") == LC_OK);
    CHECK(rgb_is(kd_at(.5, -.5, 0), .75, .25, 0));
    /* The sphere's pole points up, so that v is 0 at the bottom; the side that faces the camera has u = 1/4
     * or 3/4. */
    CHECK(load(HEAD4, "Texture \"t\" \"spectrum\" \"uv\"\n" MATTE
                      "Translate 0 0 3\nRotate -90 1 0 0\nShape \"sphere\"\n") == LC_OK);
    lc_f3 middle = kd_at(.001, .001, 0), up = kd_at(0.0003, .17, 0);
    CHECK(fabs((double)middle.x - .25) < .01 || fabs((double)middle.x - .75) < .01);
    CHECK(fabs((double)middle.y - .5) < .01 && up.y > middle.y);
    CHECK(load(HEAD4, "Texture \"t\" \"spectrum\" \"uv\"\n" MATTE
                      "Translate 0 0 1\nShape \"disk\" \"float innerradius\" .5\n") == LC_OK);
    lc_f3 out = kd_at(0, .99, 0), in = kd_at(.001, .51, 0);
    CHECK(fabs((double)out.y) < .05 && fabs((double)in.y - 1) < .05 && fabs((double)in.x - .25) < .02);
}

/* The quarters of the picture have the colours of the image's pixels, divided by pi for a light of 1. */
TEST(picture)
{
    write_tga("a.tga");
    CHECK(load(HEAD4, "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.tga\" \"string "
                      "filter\" \"point\"\n" MATTE QUAD UV4) == LC_OK);
    lc_render_desc desc = LC_RENDER_DESC_INIT;
    lc_image *image;
    desc.aovs = LC_AOV_ALBEDO;
    desc.spp = 1; /* the samples of more reach into the next pixel */
    CHECK(lc_render(ctx, scene, &desc, &image, NULL) == LC_OK);
    static const double want[4][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { GREY, GREY, GREY } };
    static const char *const names[2][3] = { { "R", "G", "B" }, { "Albedo.R", "Albedo.G", "Albedo.B" } };
    for (size_t i = 0; i < 1600; i++) {
        size_t x = i % 40, y = i / 40;
        for (int c = 0; c < 3; c++) {
            double w = want[(y >= 20) * 2 + (x >= 20)][c];
            double colour = (double)lc_image_channel(image, names[0][c])[i],
                   albedo = (double)lc_image_channel(image, names[1][c])[i];
            CHECKF(fabs(albedo - w) < 1e-5 && fabs(colour * LC_PI - w) < 1e-5,
                   "pixel %zu, %zu channel %d: %g %g", x, y, c, colour * LC_PI, albedo);
        }
    }
    lc_image_destroy(image);
}

/* ---- memory ---- */

static lc_status load_starved(lc_context *c) { return load_file_in(c, NULL, scene_path()); }

/* With an image of each format, texture coordinates, and a texture of textures. */
TEST(every_allocation_may_fail)
{
    static const char hdr[] = "#?RADIANCE\n\n-Y 1 +X 1\nabc\x80", pfm[] = "Pf 1 1 -1\n\0\0\x80\x3f";
    lc_image *image;
    lc_image_desc size = LC_IMAGE_DESC_INIT;
    size.width = size.height = 3;
    CHECK(lc_image_create(ctx, &size, &image) == LC_OK);
    for (int c = 0; c < 3; c++)
        CHECK(lc_image_add_channel(image, c == 0 ? "R" : c == 1 ? "G" : "B", NULL) == LC_OK);
    CHECK(lc_image_write(image, temp_path("m.png")) == LC_OK &&
          lc_image_write(image, temp_path("m.exr")) == LC_OK);
    lc_image_destroy(image);
    write_tga("a.tga");
    write_file("m.hdr", hdr, sizeof hdr - 1);
    write_file("m.pfm", pfm, sizeof pfm - 1);
    CHECK(
        load(HEAD4,
             "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.tga\"\n"
             "Texture \"u\" \"float\" \"imagemap\" \"string filename\" \"m.png\"\n"
             "Texture \"v\" \"spectrum\" \"imagemap\" \"string filename\" \"m.hdr\"\n"
             "Texture \"w\" \"spectrum\" \"imagemap\" \"string filename\" \"m.pfm\"\n"
             "Texture \"x\" \"spectrum\" \"imagemap\" \"string filename\" \"m.exr\"\n"
             "Texture \"y\" \"spectrum\" \"mix\" \"texture tex1\" \"t\" \"texture amount\" \"u\"\n" MATTE QUAD
                 UV4 "ObjectBegin \"o\"\n" QUAD UV4
             "ObjectEnd\nObjectInstance \"o\"\nShape \"disk\"\n") == LC_OK);
    CHECK(scene->textures.n_images == 5);
    starve(load_starved, 50);
}

int main(void)
{
    ctx = quiet_context(1);
    temp_begin();
    RUN(imagemap_of_both_versions);
    RUN(wrapping_and_mapping);
    RUN(files_and_notes);
    RUN(values_of_materials);
    RUN(ward);
    RUN(coordinates_of_shapes);
    RUN(picture);
    RUN(every_allocation_may_fail);
    one_scene_end();
    temp_end();
    return test_done();
}
