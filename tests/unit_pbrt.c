/* unit_pbrt.c - pbrt files to the scene builder: transforms, scopes, the spellings of pbrt-v3 and v4, files
 * that include files, and the message and place of each error. Scenes are compared, before commit, with what
 * pbrt's format descriptions say, worked out by hand; colours of lights with pixels rendered by pbrt-v4. */
#include "prepare/commit.h"
#include "support/near.h"
#include "support/one_scene.h"
#include "support/watched_memory.h"

#define EXPECT_ERROR(text, message) EXPECT_FAILURE(parse_text(text), LC_ERR_PARSE, message)

#define TRI "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\n"

static lc_f3 vertex(size_t i) { return lc_f3_load(scene->pos + 3 * i); }

static lc_f3 kd_of_mesh(size_t i) { return scene->materials[scene->meshes[i].material_id].kd; }

/* ---- text ---- */

TEST(numbers)
{
    CHECK(parse_text("WorldBegin Translate -0 .5 1. " TRI) == LC_OK);
    CHECK(near3_abs(vertex(0), 0, 0.5, 1, 0));
    CHECK(parse_text("WorldBegin Translate +1 1e-008 -2E+1 " TRI) == LC_OK);
    CHECK(near3_abs(vertex(0), 1, 1e-8, -20, 1e-15));
    CHECK(parse_text("WorldBegin Translate 0.1 123456789012345678901234567890e-25 3.4028234e38 "
                     "LightSource \"distant\"") == LC_OK);
    EXPECT_ERROR("WorldBegin\nTranslate 1 nan 0",
                 "s.pbrt:2:13: error: Translate: expected a number, found 'nan'");
    EXPECT_ERROR("WorldBegin\nTranslate 1 -inf 0", "s.pbrt:2:13: error: not a number: '-inf'");
    EXPECT_ERROR("WorldBegin\n Translate 1 2 1e39", "s.pbrt:2:16: error: number out of range: '1e39'");
    EXPECT_ERROR("WorldBegin\n Translate 1 2 -1e39", "s.pbrt:2:16: error: number out of range: '-1e39'");
    EXPECT_ERROR("WorldBegin\nTranslate 1 2 1e999999999999",
                 "s.pbrt:2:15: error: number out of range: '1e999999999999'");
    EXPECT_ERROR("WorldBegin\nTranslate 1 2 0x10", "s.pbrt:2:15: error: not a number: '0x10'");
    EXPECT_ERROR("WorldBegin\nTranslate 1 2 1.2.3", "s.pbrt:2:15: error: not a number: '1.2.3'");
    EXPECT_ERROR("WorldBegin\nTranslate 1 2 .", "s.pbrt:2:15: error: not a number: '.'");
    EXPECT_ERROR("WorldBegin\nTranslate 1 2 3e", "s.pbrt:2:15: error: not a number: '3e'");
    EXPECT_ERROR("WorldBegin\nTranslate 1 2 1,5", "s.pbrt:2:15: error: not a number: '1,5'");
}

TEST(layout_of_text)
{
    CHECK(parse_text("\xef\xbb\xbf# mark first\r\nWorldBegin # comment\n"
                     "Shape\n \"trianglemesh\" \"  point3   P \"[0 0 0 # inside\n1 0 0 0 1 0] \"integer "
                     "indices\"[0 1 2]"
                     "#end") == LC_OK);
    CHECK(scene->n_tris == 1);
    CHECK(parse_text("Film \"image\" \"string filename\" \"a\\\"b\\\\c.exr\" WorldBegin") == LC_OK);
    CHECK(scene->film.filename && !strcmp(scene->film.filename, "a\"b\\c.exr"));
    EXPECT_ERROR("WorldBegin\n  Shape \"sphere\n\"", "s.pbrt:2:9: error: string without a closing quote");
    EXPECT_ERROR("WorldBegin\n  Shape \"a\\q\"", "s.pbrt:2:11: error: unknown escape sequence in a string");
    EXPECT_ERROR("WorldBegin\nShape \"sphere\" \"float radius\" [1 2", "s.pbrt:2:31: error: '[' without ']'");
    EXPECT_ERROR("WorldBegin\nShape \"sphere\" \"float radius\" [[1]]", "s.pbrt:2:32: error: '[' inside '['");
    EXPECT_ERROR("WorldBegin\nShape \"sphere\" \"radius\" 1",
                 "s.pbrt:2:16: error: expected a parameter \"type name\", found \"radius\"");
    EXPECT_ERROR("WorldBegin\nShape \"sphere\" \"float radius\"",
                 "s.pbrt:2:30: error: parameter 'radius' has no value");
    EXPECT_ERROR("WorldBegin\nShape \"sphere\" \"float radius\" \"x\"",
                 "s.pbrt:2:31: error: parameter 'radius' can't have the value 'x'");
    EXPECT_ERROR("WorldBegin\nShape \"trianglemesh\" \"point3 P\" [1 2 nan]",
                 "s.pbrt:2:38: error: parameter 'P' can't have the value 'nan'");
    EXPECT_ERROR("WorldBegin ]", "s.pbrt:1:12: error: statement: expected a directive, found ']'");
    EXPECT_ERROR("WorldBegin Sh*pe", "s.pbrt:1:14: error: unexpected character '*'");
}

/* Commas in brackets, as old exporters write them: one behind each value. */
TEST(commas)
{
    CHECK(parse_text("WorldBegin Translate [1, -2 ,3] Shape \"trianglemesh\"\n\"point3 P\" [0, 0,0 , 1,0 0\n"
                     "0,1, 0 # x, y\n,] \"integer indices\" [0,1,2] \"string a\" [\"x,y\", \"z\"]") == LC_OK);
    CHECK(scene->n_tris == 1 && near3_abs(vertex(0), 1, -2, 3, 0) && near3_abs(vertex(1), 2, -2, 3, 0) &&
          near3_abs(vertex(2), 1, -1, 3, 0));
    CHECK(note("comma") && note("comma")->count == 1);
    CHECKF(strstr(last_warning, "s.pbrt:1:24: warning:"), "%s", last_warning);
    CHECK(parse_text("WorldBegin " TRI) == LC_OK && !note("comma"));
    EXPECT_ERROR("WorldBegin\nTranslate 1, 2, 3", "s.pbrt:2:11: error: not a number: '1,'");
    EXPECT_ERROR("WorldBegin\nTranslate 1 , 2 , 3", "s.pbrt:2:13: error: unexpected character ','");
    EXPECT_ERROR("WorldBegin\nTranslate [1,,2]", "s.pbrt:2:14: error: unexpected character ','");
    EXPECT_ERROR("WorldBegin\nTranslate [,1 2]", "s.pbrt:2:12: error: unexpected character ','");
    EXPECT_ERROR("WorldBegin\nTranslate [1 2 3], Shape", "s.pbrt:2:18: error: unexpected character ','");
    EXPECT_ERROR("WorldBegin\nShape \"sphere\", \"float radius\" 1",
                 "s.pbrt:2:15: error: unexpected character ','");
}

TEST(garbage)
{
    EXPECT_ERROR("", "s.pbrt:1:1: error: no WorldBegin in this file");
    EXPECT_ERROR("# nothing\n", "s.pbrt:2:1: error: no WorldBegin in this file");
    EXPECT_ERROR("\x89PNG\r\n\x1a\n", "s.pbrt:1:1: error: unexpected byte 0x89");
    CHECK(parse_bytes("\0\0\0\0", 4) == LC_ERR_PARSE);
    CHECKF(!strcmp(last_error, "s.pbrt:1:1: error: unexpected byte 0x00"), "%s", last_error);
    CHECK(parse_bytes("WorldBegin Shape \"a\0b\"", 22) == LC_ERR_PARSE);
    CHECKF(!strcmp(last_error, "s.pbrt:1:20: error: zero byte in a string"), "%s", last_error);
    CHECK(parse_text("WorldBegin\n Foo \"bar\" 1 [2 true] \"bool x\" true\n" TRI) == LC_OK);
    CHECK(note("unknown directive Foo") && scene->n_tris == 1);
    CHECKF(!strcmp(last_warning,
                   "s.pbrt:2:2: warning: unknown directive 'Foo': it and its parameters are skipped"),
           "%s", last_warning);
}

/* ---- transforms and scopes ---- */

TEST(transforms)
{
    CHECK(parse_text("WorldBegin Translate 1 2 3 Scale 2 2 2 " TRI) == LC_OK);
    CHECK(near3_abs(vertex(1), 3, 2, 3, 0));
    CHECK(parse_text("WorldBegin Rotate 90 0 0 2 " TRI) == LC_OK);
    CHECK(near3_abs(vertex(1), 0, 1, 0, 0) && near3_abs(vertex(2), -1, 0, 0, 0));
    CHECK(parse_text("WorldBegin Rotate 30 1 2 3 Rotate -30 1 2 3 " TRI) == LC_OK);
    CHECK(near3_abs(vertex(1), 1, 0, 0, 1e-6));
    CHECK(parse_text(
              "WorldBegin Transform [1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1] ConcatTransform [2 0 0 0 0 2 0 0 0 0 "
              "2 0 0 0 0 1]" TRI) == LC_OK);
    CHECK(near3_abs(vertex(1), 7, 6, 7, 0));
    CHECK(parse_text("WorldBegin Translate 1 0 0 CoordinateSystem \"here\" Identity CoordSysTransform "
                     "\"here\" " TRI) == LC_OK);
    CHECK(near3_abs(vertex(0), 1, 0, 0, 0));
    CHECK(parse_text("Translate 0 0 5 Camera \"perspective\" WorldBegin CoordSysTransform \"camera\" " TRI) ==
          LC_OK);
    CHECK(near3_abs(vertex(0), 0, 0, -5, 0));
    CHECK(parse_text("WorldBegin CoordSysTransform \"nowhere\" " TRI) == LC_OK);
    CHECK(note("unknown coordinate system nowhere"));
    CHECK(parse_text("TransformTimes 0 1 WorldBegin ActiveTransform EndTime Translate 9 9 9 ActiveTransform "
                     "All " TRI) == LC_OK);
    CHECK(near3_abs(vertex(0), 0, 0, 0, 0) && scene->n_moving == 1); /* in its own space */
    CHECK(parse_text("TransformTimes 0 1 WorldBegin ActiveTransform EndTime Translate 9 9 9 ActiveTransform "
                     "All LightSource \"point\" " TRI) == LC_OK);
    CHECK(note("motion of a light"));
    EXPECT_ERROR("WorldBegin\nRotate 1 0 0 0", "s.pbrt:2:1: error: Rotate about a zero axis");
    EXPECT_ERROR("LookAt 1 2 3 1 2 3 0 1 0 WorldBegin",
                 "s.pbrt:1:1: error: LookAt: eye and target coincide, or up is along the view");
    EXPECT_ERROR("WorldBegin Scale 1e30 1 1\nScale 1e30 1 1 " TRI,
                 "s.pbrt:2:16: error: vertex 1 is out of range after the transform");
}

TEST(look_at_and_camera)
{
    CHECK(
        parse_text("LookAt 1 2 3  1 2 8  0 1 0 Camera \"perspective\" \"float fov\" 60 "
                   "Film \"image\" \"integer xresolution\" [200] \"integer yresolution\" [100] WorldBegin") ==
        LC_OK);
    const lc_camera_desc *c = &scene->camera_desc;
    CHECK(scene->has_camera && near_abs(c->fov_degrees, 60, 0));
    /* The eye moves to the origin, +z stays +z, and x is to the right of it: the space is left-handed. */
    const double want[16] = { 1, 0, 0, -1, 0, 1, 0, -2, 0, 0, 1, -3, 0, 0, 0, 1 };
    for (int i = 0; i < 16; i++) CHECK(near_abs(c->world_to_camera[i], want[i], 1e-15));
    CHECK(near_abs(c->screen[0], -2, 0) && near_abs(c->screen[1], 2, 0) && near_abs(c->screen[2], -1, 0) &&
          near_abs(c->screen[3], 1, 0));
    CHECK(parse_text("Film \"image\" \"integer xresolution\" 100 \"integer yresolution\" 200 Scale -1 1 1 "
                     "Camera \"perspective\" WorldBegin " TRI) == LC_OK);
    CHECK(near_abs(scene->camera_desc.fov_degrees, 90, 0) && near_abs(scene->camera_desc.screen[2], -2, 0));
    CHECK(near_abs(scene->camera_desc.world_to_camera[0], -1, 0) && near3_abs(vertex(1), 1, 0, 0, 0));
    CHECK(parse_text("Camera \"orthographic\" \"float screenwindow\" [-2 2 -1 1] WorldBegin") == LC_OK);
    CHECK(scene->camera_desc.kind == LC_CAMERA_ORTHOGRAPHIC && near_abs(scene->camera_desc.screen[0], -2, 0));
    CHECK(
        parse_text(
            "Camera \"perspective\" \"float lensradius\" .1 \"float screenwindow\" [-2 2 -1 1] WorldBegin") ==
        LC_OK);
    CHECK(near_abs(scene->camera_desc.lens_radius, .1, 0) &&
          near_abs(scene->camera_desc.focal_distance, 1e6, 0) && scene->film.spp == 16);
    CHECK(parse_text("Camera \"realistic\" \"float aperturediameter\" 1 WorldBegin") == LC_OK &&
          note("camera realistic"));
    EXPECT_ERROR("Camera \"perspective\" \"float fov\" [180] WorldBegin",
                 "s.pbrt:1:22: error: parameter 'fov' is not an angle between 0 and 180");
    EXPECT_ERROR("Scale 0 1 1\nCamera \"perspective\" WorldBegin",
                 "s.pbrt:2:1: error: the camera's transform is singular");
}

TEST(scopes)
{
    CHECK(parse_text("WorldBegin Material \"matte\" \"rgb Kd\" [.1 .2 .3] AttributeBegin Translate 1 0 0 "
                     "Material \"diffuse\" \"rgb reflectance\" [.4 .5 .6] ReverseOrientation "
                     "AreaLightSource \"diffuse\" \"rgb L\" [1 2 3] \"bool twosided\" true " TRI
                     "AttributeEnd " TRI) == LC_OK);
    CHECK(scene->n_meshes == 2);
    CHECK(near3_abs(vertex(0), 1, 0, 0, 0) && near3_abs(vertex(3), 0, 0, 0, 0));
    CHECK(near3_abs(kd_of_mesh(0), .4, .5, .6, 1e-7) && near3_abs(kd_of_mesh(1), .1, .2, .3, 1e-7));
    CHECK(scene->meshes[0].flip && !scene->meshes[1].flip);
    CHECK(near3_abs(scene->meshes[0].emission, 1, 2, 3, 0) &&
          near3_abs(scene->meshes[1].emission, 0, 0, 0, 0));
    CHECK(scene->meshes[0].two_sided && !scene->meshes[1].two_sided);
    CHECK(parse_text("WorldBegin TransformBegin Translate 1 0 0 Material \"matte\" \"rgb Kd\" [.1 .2 .3] "
                     "TransformEnd " TRI) == LC_OK);
    CHECK(near3_abs(vertex(0), 0, 0, 0, 0) && near3_abs(kd_of_mesh(0), .1, .2, .3, 1e-7));
    CHECK(parse_text("WorldBegin AttributeBegin\n" TRI) == LC_OK && note("scope without end"));
    EXPECT_ERROR("WorldBegin\n AttributeEnd", "s.pbrt:2:2: error: AttributeEnd without AttributeBegin");
    EXPECT_ERROR("WorldBegin AttributeBegin\nTransformEnd",
                 "s.pbrt:2:1: error: TransformEnd, but the AttributeBegin of line 1 is still open");
}

TEST(a_million_scopes)
{
    size_t n = 1000000, len = strlen("AttributeBegin ");
    char *text = malloc(n * len + 64), *p = text + sprintf(text, "WorldBegin ");
    for (size_t i = 0; i < n; i++) {
        memcpy(p, "AttributeBegin ", len);
        p += len;
    }
    CHECK(parse_bytes(text, (size_t)(p - text)) == LC_OK);
    free(text);
}

TEST(order_of_sections)
{
    EXPECT_ERROR("Shape \"sphere\"", "s.pbrt:1:1: error: Shape before WorldBegin");
    EXPECT_ERROR("WorldBegin\nFilm \"image\"", "s.pbrt:2:1: error: Film after WorldBegin");
    EXPECT_ERROR("WorldBegin\nWorldBegin", "s.pbrt:2:1: error: second WorldBegin");
    EXPECT_ERROR("Camera \"perspective\"\n", "s.pbrt:2:1: error: no WorldBegin in this file");
    CHECK(parse_text("WorldBegin " TRI "WorldEnd") == LC_OK && scene->n_notes == 0);
    CHECK(parse_text("WorldBegin " TRI "WorldEnd\nFilm \"image\"") == LC_OK && note("after WorldEnd"));
}

/* ---- options ---- */

/* max_pixels shrinks film and crop together. */
static void expect_shrunk(uint64_t max_pixels, uint32_t width, uint32_t height, const uint32_t crop[4])
{
    lc_load_desc desc = LC_LOAD_DESC_INIT;
    desc.indirect_lights = LC_NO_LIGHTS;
    desc.area_lights = desc.n_reps = 1;
    desc.max_pixels = max_pixels;
    CHECK(parse_text(
              "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 32 \"float cropwindow\" [.25 "
              ".5 0 .1]\n"
              "Camera \"perspective\" WorldBegin") == LC_OK);
    lc_scene_size_film(scene, &desc);
    CHECK(lc_scene_commit(scene, &desc) == LC_OK);
    CHECKF(scene->film.width == width && scene->film.height == height, "%u x %u", scene->film.width,
           scene->film.height);
    for (int i = 0; i < 4; i++) CHECKF(scene->film.crop[i] == crop[i], "crop[%d] %u", i, scene->film.crop[i]);
}

TEST(max_pixels)
{
    expect_shrunk(0, 64, 32, (const uint32_t[]){ 16, 32, 0, 4 });
    expect_shrunk(64 * 32, 64, 32, (const uint32_t[]){ 16, 32, 0, 4 });
    expect_shrunk(512, 32, 16, (const uint32_t[]){ 8, 16, 0, 2 });
    expect_shrunk(300, 24, 12, (const uint32_t[]){ 6, 12, 0, 2 });
    expect_shrunk(1, 1, 1, (const uint32_t[]){ 0, 1, 0, 1 });
}

TEST(film)
{
    CHECK(parse_text("WorldBegin") == LC_OK && scene->film.width == 1280 && scene->film.height == 720 &&
          scene->film.spp == 16);
    CHECK(parse_text("Film \"image\" \"integer xresolution\" [64] \"integer yresolution\" [32] \"float "
                     "cropwindow\" [.25 .5 0 .1] "
                     "\"float scale\" 2 \"string filename\" [\"x.exr\"] Sampler \"random\" \"integer "
                     "pixelsamples\" 3 WorldBegin") == LC_OK);
    CHECK(scene->film.width == 64 && scene->film.height == 32 && scene->film.spp == 3 && scene->n_notes == 0);
    CHECK(scene->film.crop[0] == 16 && scene->film.crop[1] == 32 && scene->film.crop[2] == 0 &&
          scene->film.crop[3] == 4);
    CHECK(near_abs((double)scene->film.scale, 2, 0) && !strcmp(scene->film.filename, "x.exr"));
    CHECK(parse_text("Film \"rgb\" \"float iso\" [200] \"integer pixelbounds\" [10 20 -5 2000] "
                     "Camera \"perspective\" \"float shutterclose\" .25 WorldBegin") == LC_OK);
    CHECK(near_abs((double)scene->film.scale, 0.5, 1e-7));
    CHECK(scene->film.crop[0] == 10 && scene->film.crop[1] == 20 && scene->film.crop[2] == 0 &&
          scene->film.crop[3] == 720);
    CHECK(parse_text("Sampler \"halton\" \"integer pixelsamples\" [64] WorldBegin") == LC_OK);
    CHECK(scene->film.spp == 16 && note("sampler pixelsamples"));
    CHECK(parse_text("Sampler \"stratified\" \"integer xsamples\" 1 \"integer ysamples\" 2 WorldBegin") ==
          LC_OK);
    CHECK(scene->film.spp == 2);
    EXPECT_ERROR("Film \"image\" \"integer xresolution\" [0] WorldBegin",
                 "s.pbrt:1:14: error: parameter 'xresolution' is not in 1..65535");
    EXPECT_ERROR("Film \"image\" \"integer xresolution\" [1.5] WorldBegin",
                 "s.pbrt:1:14: error: parameter 'xresolution' is not an integer");
    EXPECT_ERROR("Film \"image\" \"integer xresolution\" [65535] \"integer yresolution\" [65535] WorldBegin",
                 "s.pbrt:1:1: error: film of 65535 x 65535 pixels: each side must be 1 to 65535, the product "
                 "at most 268435456");
    EXPECT_ERROR("Film \"image\" \"float cropwindow\" [.5 .5 0 1] WorldBegin",
                 "s.pbrt:1:14: error: parameter 'cropwindow' is empty");
}

TEST(ignored_politely)
{
    CHECK(
        parse_text(
            "Option \"bool wavefront\" true ColorSpace \"srgb\" Integrator \"path\" \"integer maxdepth\" [5] "
            "SurfaceIntegrator \"igi\" VolumeIntegrator \"single\" Renderer \"sampler\" Accelerator \"bvh\" "
            "PixelFilter \"box\" \"float xradius\" 1 WorldBegin") == LC_OK);
    CHECKF(scene->n_notes == 0, "%s", last_warning);
    CHECK(parse_text(
              "WorldBegin MakeNamedMedium \"m\" \"string type\" \"homogeneous\" MediumInterface \"m\" \"\" "
              "MediumInterface \"m\"") == LC_OK);
    CHECK(scene->n_notes == 0 && scene->media.n == 1 && scene->media.n_tris == 0);
    CHECK(parse_text("WorldBegin MediumInterface \"\" \"\" MediumInterface \"\"") == LC_OK &&
          scene->n_notes == 0);
    CHECK(parse_text("WorldBegin Shape \"sphere\" \"float foo\" [1 2 3] \"string bar\" [\"x\"]") == LC_OK);
    CHECK(note("parameter sphere.foo") && note("parameter sphere.bar"));
}

/* ---- materials ---- */

TEST(named_materials_and_textures)
{
    CHECK(parse_text("WorldBegin MakeNamedMaterial \"a\" \"string type\" \"matte\" \"color Kd\" [.1 .2 .3]\n"
                     "MakeNamedMaterial \"b\" \"string type\" [\"diffuse\"] \"rgb reflectance\" [.4 .5 .6]\n"
                     "Texture \"t\" \"spectrum\" \"constant\" \"rgb value\" [.7 .8 .9]\n"
                     "NamedMaterial \"b\" " TRI "NamedMaterial \"a\" " TRI
                     "Material \"matte\" \"texture Kd\" \"t\" " TRI) == LC_OK);
    CHECK(scene->n_notes == 0 && scene->n_meshes == 3);
    CHECK(near3_abs(kd_of_mesh(0), .4, .5, .6, 1e-7) && near3_abs(kd_of_mesh(1), .1, .2, .3, 1e-7));
    CHECK(near3_abs(kd_of_mesh(2), .7, .8, .9, 1e-7));
    CHECK(parse_text("WorldBegin NamedMaterial \"nix\" " TRI) == LC_OK && note("unknown material nix"));
    CHECK(near3_abs(kd_of_mesh(0), .5, .5, .5, 0));
    CHECK(parse_text("WorldBegin Material \"matte\" \"texture Kd\" \"nix\" " TRI) == LC_OK &&
          note("unknown texture nix"));
    CHECK(parse_text("WorldBegin Texture \"f\" \"float\" \"constant\" \"float value\" .5 "
                     "Texture \"i\" \"color\" \"imagemap\" \"string filename\" \"x.png\" "
                     "Texture \"s\" \"color\" \"scale\" \"texture tex\" \"i\" \"texture scale\" \"f\" "
                     "Material \"matte\" \"texture Kd\" \"s\" " TRI) == LC_OK);
    CHECK(near3_abs(kd_of_mesh(0), .25, .25, .25, 1e-7) && note("texture image"));
    EXPECT_ERROR("WorldBegin\nMakeNamedMaterial \"a\"",
                 "s.pbrt:2:1: error: MakeNamedMaterial 'a' has no \"string type\"");
    EXPECT_ERROR("WorldBegin\nTexture \"t\" \"string filename\" [ \"x\" ]",
                 "s.pbrt:2:31: error: Texture: expected a quoted name, found '['");
}

TEST(mirrors_and_depth)
{
    CHECK(parse_text("WorldBegin Material \"mirror\" " TRI "Material \"mirror\" \"rgb Kr\" [.1 .2 .3] " TRI
                     "MakeNamedMaterial \"m\" \"string type\" \"mirror\" \"rgb reflectance\" [.4 .5 1.5] "
                     "NamedMaterial \"m\" " TRI
                     "Texture \"t\" \"spectrum\" \"constant\" \"rgb value\" [.7 .8 .9] "
                     "Material \"mirror\" \"texture Kr\" \"t\" " TRI "Material \"matte\" " TRI) == LC_OK);
    CHECK(scene->n_notes == 1 && note("reflectance") && scene->n_meshes == 5 && scene->max_depth == 5);
    static const double want[4][3] = { { .9, .9, .9 }, { .1, .2, .3 }, { .4, .5, 1 }, { .7, .8, .9 } };
    for (int i = 0; i < 4; i++) {
        const lc_material *m = &scene->materials[scene->meshes[i].material_id];
        CHECK(m->mirror && near3_abs(m->ks, want[i][0], want[i][1], want[i][2], 1e-6) &&
              near3_abs(m->kd, 0, 0, 0, 0));
    }
    CHECK(!scene->materials[scene->meshes[4].material_id].mirror);
    static const struct { const char *text; uint32_t depth; } depths[] = {
        { "Integrator \"path\" \"integer maxdepth\" 3 WorldBegin", 3 },
        { "Integrator \"volpath\" \"float regularize\" 1 WorldBegin", 5 },
        { "SurfaceIntegrator \"directlighting\" \"integer maxdepth\" [12] WorldBegin", 12 },
        { "Integrator \"path\" \"integer maxdepth\" 3 Integrator \"whitted\" WorldBegin", 5 },
        { "Integrator \"path\" \"integer maxdepth\" 100000 WorldBegin", LC_MAX_DEPTH },
        { "Integrator \"path\" \"integer maxdepth\" 0 WorldBegin", 1 },
        { "Integrator \"path\" \"integer maxdepth\" -4 WorldBegin", 1 },
    };
    for (size_t i = 0; i < sizeof depths / sizeof *depths; i++) {
        CHECK(parse_text(depths[i].text) == LC_OK);
        CHECKF(scene->max_depth == depths[i].depth && (note("maxdepth") != NULL) == (i > 4), "%s",
               depths[i].text);
    }
    EXPECT_ERROR("Integrator \"path\" \"integer maxdepth\" 1.5 WorldBegin",
                 "s.pbrt:1:19: error: parameter 'maxdepth' is not an integer");
}

/* What pbrt's versions do where the file names no integrator. */
TEST(silent_integrator)
{
    static const struct { const char *text; bool paths; } cases[] = {
        { "Film \"rgb\" WorldBegin", true },
        { "Film \"image\" WorldBegin", true },
        { "WorldBegin", true },
        { "Film \"image\" VolumeIntegrator \"single\" WorldBegin", false },
        { "Film \"image\" Renderer \"sampler\" WorldBegin", false },
        { "Sampler \"bestcandidate\" WorldBegin", false },
        { "Sampler \"adaptive\" WorldBegin", false },
        { "WorldBegin Volume \"homogeneous\"", false },
        { "Film \"rgb\" Renderer \"sampler\" WorldBegin", true },
        { "Renderer \"sampler\" SurfaceIntegrator \"path\" WorldBegin", true },
        { "Integrator \"directlighting\" WorldBegin", false },
        { "Film \"rgb\" Integrator \"simplepath\" WorldBegin", true },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        CHECK(parse_text(cases[i].text) == LC_OK);
        CHECKF(scene->traces_paths == cases[i].paths && scene->max_depth == 5, "%s", cases[i].text);
    }
}

TEST(materials)
{
    CHECK(parse_text("WorldBegin " TRI) == LC_OK && near3_abs(kd_of_mesh(0), .5, .5, .5, 0));
    CHECK(parse_text(
              "WorldBegin Material \"phong\" \"rgb Kd\" [.1 .2 .3] \"rgb Ks\" [.4 .5 .6] \"float exponent\" "
              "30 " TRI) == LC_OK);
    const lc_material *m = &scene->materials[scene->meshes[0].material_id];
    CHECK(near3_abs(m->kd, .1, .2, .3, 1e-7) && near3_abs(m->ks, .4, .5, .6, 1e-7) &&
          near_abs((double)m->exponent, 30, 0));
    CHECK(parse_text("WorldBegin Material \"plastic\" \"rgb Kd\" [.1 .2 .3] \"rgb Ks\" [1 1 1] " TRI) ==
          LC_OK);
    CHECK(near3_abs(kd_of_mesh(0), .1, .2, .3, 1e-7) && scene->n_notes == 0);
    CHECK(parse_text("WorldBegin Material \"fourier\" " TRI "Material \"strange\" " TRI) == LC_OK);
    CHECK(note("material fourier") && note("material strange") && near3_abs(kd_of_mesh(1), .5, .5, .5, 0));
    CHECK(parse_text("WorldBegin Material \"interface\" " TRI "Material \"none\" " TRI
                     "Material \"\" " TRI) == LC_OK);
    CHECK(scene->n_meshes == 0);
    CHECK(parse_text("WorldBegin Material \"none\" AreaLightSource \"area\" \"color L\" [1 1 1] " TRI) ==
          LC_OK);
    CHECK(scene->n_meshes == 1 && near3_abs(kd_of_mesh(0), 0, 0, 0, 0));
    CHECK(parse_text("WorldBegin Material \"matte\" \"float sigma\" 20 \"rgb Kd\" [2 -1 .5] " TRI) == LC_OK);
    CHECK(near3_abs(kd_of_mesh(0), 1, 0, .5, 0) && note("reflectance"));
    m = &scene->materials[scene->meshes[0].material_id];
    CHECK(m->lobe == LC_LOBE_OREN_NAYAR && near_abs((double)m->roughness[0], 20 * LC_PI / 180, 1e-6) &&
          near3_abs(m->ks, 1, 0, .5, 0));
    CHECK(parse_text(
              "WorldBegin Material \"ward\" \"rgb Kd\" [.1 .2 .3] \"rgb Ks\" [.4 .5 .6] \"float roughness\" "
              ".25 \"float vroughness\" "
              ".5 " TRI) == LC_OK);
    m = &scene->materials[scene->meshes[0].material_id];
    CHECK(near3_abs(m->kd, .1, .2, .3, 1e-7) && near3_abs(m->ks, .4, .5, .6, 1e-7) &&
          near_abs((double)m->roughness[0], .25, 0) && near_abs((double)m->roughness[1], .5, 0) &&
          scene->meshes[0].brushed && scene->n_notes == 0);
    CHECK(parse_text("WorldBegin Material \"ward\" " TRI) == LC_OK && !scene->meshes[0].brushed);
    m = &scene->materials[scene->meshes[0].material_id];
    CHECK(near_abs((double)m->roughness[0], .1, 1e-7) && near_abs((double)m->roughness[1], .1, 1e-7) &&
          near3_abs(m->ks, 0, 0, 0, 0));
    CHECK(parse_text("WorldBegin Material \"ward\" \"float uroughness\" 0 \"float vroughness\" 7 " TRI) ==
              LC_OK &&
          note("ward roughness"));
    m = &scene->materials[scene->meshes[0].material_id];
    CHECK(near_abs((double)m->roughness[0], (double)LC_MIN_ROUGHNESS, 0) &&
          near_abs((double)m->roughness[1], 1, 0));
    CHECK(parse_text("WorldBegin Material \"ggx\" \"rgb Ks\" [.4 .5 .6] \"float roughness\" .25 " TRI) ==
              LC_OK &&
          scene->n_notes == 0);
    m = &scene->materials[scene->meshes[0].material_id];
    CHECK(m->lobe == LC_LOBE_GGX && m->fresnel == LC_FRESNEL_SCHLICK &&
          near_abs((double)m->roughness[1], .25, 0));
    EXPECT_ERROR("WorldBegin Material \"ward\" \"float uroughness\" -1",
                 "s.pbrt:1:28: error: parameter 'uroughness' is negative");
    EXPECT_ERROR("WorldBegin Material \"phong\" \"float exponent\" -1",
                 "s.pbrt:1:29: error: parameter 'exponent' is negative");
    EXPECT_ERROR("WorldBegin Material \"matte\" \"rgb Kd\" [1 2]",
                 "s.pbrt:1:29: error: parameter 'Kd' has 2 values, not a multiple of 3");
}

/* ---- lights ---- */

TEST(point_lights)
{
    CHECK(parse_text(
              "WorldBegin Translate 1 0 0 LightSource \"point\" \"point from\" [1 2 3] \"color I\" [1 2 3] "
              "\"rgb scale\" [2 2 2]\n"
              "LightSource \"point\" \"point3 from\" [1 2 3] \"rgb I\" [2 2 2] \"float power\" 12.566370614 "
              "\"float scale\" 3\n"
              "LightSource \"point\" \"float A\" 1 \"float B\" 2 \"float C\" 0") == LC_OK);
    CHECK(scene->n_lights == 3 && scene->n_notes == 0);
    const lc_light *l = scene->lights;
    CHECK(l[0].kind == LC_LIGHT_POINT && near3_abs(l[0].pos, 2, 2, 3, 0) &&
          near3_abs(l[0].intensity, 2, 4, 6, 0));
    CHECK(l[0].atten[0] == 0 && l[0].atten[1] == 0 && l[0].atten[2] == 1);
    CHECK(near3_abs(l[1].intensity, 6, 6, 6, 1e-5));
    CHECK(l[2].atten[0] == 1 && l[2].atten[1] == 2 && l[2].atten[2] == 0 &&
          near3_abs(l[2].intensity, 1, 1, 1, 0));
    EXPECT_ERROR("WorldBegin\n LightSource \"point\" \"float C\" 0",
                 "s.pbrt:2:2: error: A, B and C are all 0");
    EXPECT_ERROR("WorldBegin\n LightSource \"point\" \"float B\" -1",
                 "s.pbrt:2:22: error: parameter 'B' is negative");
    EXPECT_ERROR("WorldBegin\n LightSource \"point\" \"rgb I\" [1 -1 1]",
                 "s.pbrt:2:22: error: parameter 'I' is negative");
}

TEST(directed_lights)
{
    CHECK(
        parse_text(
            "WorldBegin Rotate 90 0 1 0 Translate 0 0 1 LightSource \"oriented\" \"point3 position\" [0 0 1] "
            "\"vector3 direction\" [0 0 5] \"rgb I\" [1 2 3]\n"
            "LightSource \"distant\" \"point from\" [0 5 0] \"point to\" [0 0 0] \"rgb L\" [3 2 1]\n"
            "LightSource \"distant\" \"float illuminance\" 7") == LC_OK);
    const lc_light *l = scene->lights;
    CHECK(scene->n_lights == 3 && l[0].kind == LC_LIGHT_ORIENTED && l[1].kind == LC_LIGHT_DIRECTIONAL);
    CHECK(near3_abs(l[0].pos, 2, 0, 0, 0) && near3_abs(l[0].dir, 1, 0, 0, 0) &&
          near3_abs(l[0].intensity, 1, 2, 3, 0));
    CHECK(near3_abs(l[1].dir, 0, -1, 0, 0) && near3_abs(l[1].intensity, 3, 2, 1, 0));
    CHECK(near3_abs(l[2].dir, 1, 0, 0, 0) && near3_abs(l[2].intensity, 7, 7, 7, 0));
    EXPECT_ERROR("WorldBegin\nLightSource \"oriented\" \"vector direction\" [0 0 0]",
                 "s.pbrt:2:1: error: the light's direction is zero or out of range");
    CHECK(parse_text("WorldBegin LightSource \"lamp\" LightSource \"beam\" LightSource \"lamp\"") == LC_OK);
    CHECK(scene->n_lights == 0 && note("light lamp")->count == 2 && note("light beam"));
}

/* The colours of lights relative to "rgb I" [1 1 1], as measured in pixels that pbrt-v4 rendered. */
TEST(spectral_lights)
{
    CHECK(parse_text(
              "Film \"rgb\" WorldBegin LightSource \"point\" \"blackbody I\" 6500\n"
              "LightSource \"point\" \"blackbody I\" [3000] LightSource \"point\" \"spectrum I\" [300 5 900 "
              "5]\n"
              "LightSource \"point\" \"spectrum I\" \"stdillum-D65\"") == LC_OK);
    const lc_light *l = scene->lights;
    CHECK(scene->n_lights == 4);
    CHECKF(near3_abs(l[0].intensity, 1.043, 0.984, 1.035, 0.01), "%g %g %g", (double)l[0].intensity.x,
           (double)l[0].intensity.y, (double)l[0].intensity.z);
    CHECKF(near3_abs(l[1].intensity, 1.771, 0.844, 0.272, 0.02), "%g %g %g", (double)l[1].intensity.x,
           (double)l[1].intensity.y, (double)l[1].intensity.z);
    CHECK(near3_abs(l[2].intensity, 1.205, 0.948, 0.909, 0.001));
    CHECK(near3_abs(l[3].intensity, 1, 1, 1, 1e-3) && scene->n_notes == 0);
    CHECK(parse_text("Film \"image\" WorldBegin LightSource \"point\" \"blackbody I\" [6500 2]\n"
                     "LightSource \"point\" \"spectrum I\" [300 5 900 5]") == LC_OK);
    /* In pbrt-v3 the peak of a black body's curve is 1, and a constant spectrum of 5 has a luminance of 5. */
    CHECK(lc_luminance(scene->lights[0].intensity) > 1.6f && lc_luminance(scene->lights[0].intensity) < 2);
    CHECK(near_abs((double)lc_luminance(scene->lights[1].intensity), 5, 1e-4));
    CHECK(parse_text("WorldBegin Material \"matte\" \"spectrum Kd\" [400 .3 700 .3] " TRI) == LC_OK);
    CHECK(near3_abs(kd_of_mesh(0), .3, .3, .3, 1e-6));
    EXPECT_ERROR("WorldBegin LightSource \"point\" \"blackbody I\" -5",
                 "s.pbrt:1:32: error: parameter 'I' is a temperature out of range");
    EXPECT_ERROR("WorldBegin LightSource \"point\" \"spectrum I\" [400 1 300 1]",
                 "s.pbrt:1:32: error: parameter 'I' has wavelengths that don't rise");
}

/* ---- shapes ---- */

TEST(triangle_meshes)
{
    CHECK(parse_text(
              "WorldBegin Scale 1 2 -1 Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] "
              "\"point P\" [0 0 0 1 0 0 1 1 0 0 1 0] \"normal N\" [0 1 1 0 0 1 0 0 1 0 0 1] \"float uv\" [0 "
              "0 1 0 1 1 0 1]") == LC_OK);
    CHECK(scene->n_tris == 2 && scene->n_verts == 4 && scene->n_notes == 0);
    CHECK(scene->meshes[0].flip && scene->meshes[0].has_normals);
    CHECK(near3_abs(lc_f3_normalize(lc_f3_load(scene->normal)), 0, 1 / sqrt(5), -2 / sqrt(5), 1e-6));
    CHECK(near3_abs(lc_f3_normalize(lc_f3_load(scene->normal + 3)), 0, 0, -1, 1e-6));
    CHECK(parse_text(
              "WorldBegin ReverseOrientation Scale -1 1 1 Shape \"trianglemesh\" \"point P\" [0 0 0 1 0 0 0 "
              "1 0] "
              "\"normal N\" [0 0 1 0 0 1 0 0 1]") == LC_OK);
    CHECK(!scene->meshes[0].flip && near3_abs(lc_f3_normalize(lc_f3_load(scene->normal)), 0, 0, -1, 0));
    EXPECT_ERROR("WorldBegin\nShape \"trianglemesh\"",
                 "s.pbrt:2:1: error: trianglemesh without vertices \"point3 P\"");
    EXPECT_ERROR("WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0]",
                 "s.pbrt:2:1: error: trianglemesh without \"integer indices\"");
    EXPECT_ERROR(
        "WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 3]",
        "s.pbrt:2:53: error: index 2 is 3, not one of 3 vertices");
    EXPECT_ERROR(
        "WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1]",
        "s.pbrt:2:53: error: parameter 'indices' is not made of triples");
    EXPECT_ERROR("WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 1]",
                 "s.pbrt:2:53: error: 1 normals for 3 vertices");
}

/* Volume between the triangles and the origin: positive when their normals point away from the origin. */
static double volume(void)
{
    double sum = 0;
    for (size_t t = 0; t < scene->n_tris; t++) {
        lc_f3 v[3];
        for (size_t k = 0; k < 3; k++) v[k] = vertex(scene->index[3 * t + k]);
        double d = (double)lc_f3_dot(v[0], lc_f3_cross(v[1], v[2])) / 6;
        sum += scene->meshes[scene->tri_mesh[t]].flip ? -d : d;
    }
    return sum;
}

TEST(spheres)
{
    CHECK(
        parse_text(
            "WorldBegin AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] Shape \"sphere\" \"float radius\" 2") ==
        LC_OK);
    CHECK(note("shape sphere") && near_abs(volume(), 4.0 / 3 * LC_PI * 8, 0.1));
    double power = 0; /* emission times area: equal to that of the true sphere */
    for (size_t t = 0; t < scene->n_tris; t++) {
        lc_f3 a = vertex(scene->index[3 * t]), b = vertex(scene->index[3 * t + 1]),
              c = vertex(scene->index[3 * t + 2]);
        power += 0.5 * (double)lc_f3_len(lc_f3_cross(lc_f3_sub(b, a), lc_f3_sub(c, a))) *
                 (double)scene->meshes[0].emission.x;
        CHECK((double)lc_f3_dot(lc_f3_load(scene->normal + 3 * (size_t)scene->index[3 * t]), a) > 0);
    }
    CHECKF(near_abs(power, 16 * LC_PI, 1e-3), "%g", power);
    for (size_t i = 0; i < scene->n_verts; i++) CHECK(near_abs((double)lc_f3_len(vertex(i)), 2, 1e-6));
    CHECK(parse_text("WorldBegin Scale -1 1 1 Shape \"sphere\"") == LC_OK &&
          near_abs(volume(), 4.0 / 3 * LC_PI, 0.02));
    CHECK(scene->meshes[0].flip && (double)lc_f3_dot(lc_f3_load(scene->normal), vertex(0)) > 0);
    CHECK(parse_text("WorldBegin ReverseOrientation Shape \"sphere\"") == LC_OK &&
          near_abs(volume(), -4.0 / 3 * LC_PI, 0.02));
    CHECK((double)lc_f3_dot(lc_f3_load(scene->normal), vertex(0)) < 0);
    CHECK(
        parse_text("WorldBegin Shape \"sphere\" \"float zmin\" -0.5 \"float zmax\" 2 \"float phimax\" 180") ==
        LC_OK);
    CHECK(near_abs((double)scene->bounds.lo.z, -0.5, 0) && near_abs((double)scene->bounds.hi.z, 1, 0));
    CHECK(near_abs((double)scene->bounds.lo.y, 0, 1e-6) && near_abs((double)scene->bounds.lo.x, -1, 1e-3));
    CHECK(parse_text("WorldBegin Shape \"sphere\" \"float radius\" 0") == LC_OK && scene->n_tris == 0);
    CHECK(note("shape without area"));
}

TEST(many_spheres_are_coarser)
{
    char *text = malloc(3000 * 16 + 64), *p = text + sprintf(text, "WorldBegin ");
    for (int i = 0; i < 3000; i++) p += sprintf(p, "Shape \"sphere\" ");
    CHECK(parse_text(text) == LC_OK && scene->n_meshes == 3000);
    CHECK(scene->meshes[0].n_tris == 128 * 63 * 2 && scene->meshes[64].n_tris == 64 * 31 * 2);
    CHECK(scene->meshes[256].n_tris == 32 * 15 * 2 && scene->meshes[1024].n_tris == 16 * 7 * 2);
    CHECK(scene->meshes[2999].n_tris == 8 * 3 * 2 && scene->n_tris < 1200000);
    CHECK(scene->n_notes == 2 && note("shape sphere")->count == 3000 &&
          note("coarse round shapes")->count < 2990);
    free(text);
}

TEST(disks)
{
    CHECK(parse_text("WorldBegin Shape \"disk\" \"float height\" 1 \"float radius\" 2") == LC_OK);
    CHECK(near_abs((double)scene->bounds.lo.z, 1, 0) && near_abs((double)scene->bounds.hi.x, 2, 0));
    CHECK(scene->n_tris == 128 &&
          near_abs(volume(), 4 * LC_PI / 3, 0.01)); /* a cone with its apex at the origin: it faces +z */
    CHECK(parse_text(
              "WorldBegin Shape \"disk\" \"float height\" 1 \"float innerradius\" .5 \"float phimax\" 90") ==
          LC_OK);
    CHECK(scene->n_tris == 64 && near_abs(volume(), LC_PI * 0.75 / 12, 0.001));
}

TEST(unknown_shapes)
{
    CHECK(parse_text("WorldBegin Shape \"nurbs\" \"float width\" 1 Shape \"nurbs\"") == LC_OK);
    CHECK(scene->n_tris == 0 && note("shape nurbs")->count == 2 && scene->n_notes == 1);
}

TEST(instances)
{
    CHECK(parse_text(
              "WorldBegin Translate 0 0 1 ObjectBegin \"o\" Translate 1 0 0 Material \"matte\" \"rgb Kd\" "
              "[.1 .1 .1] " TRI "ObjectEnd Identity Scale -1 1 1 ObjectInstance \"o\" Identity Translate 0 "
              "5 0 ObjectInstance \"o\" " TRI) == LC_OK);
    CHECK(scene->n_meshes == 3 && scene->n_notes == 0);
    CHECK(near3_abs(vertex(0), -1, 0, 1, 0) && near3_abs(vertex(3), 1, 5, 1, 0) &&
          near3_abs(vertex(6), 0, 5, 0, 0));
    CHECK(scene->meshes[0].flip && !scene->meshes[1].flip);
    CHECK(near3_abs(kd_of_mesh(1), .1, .1, .1, 1e-7) && near3_abs(kd_of_mesh(2), .5, .5, .5, 0));
    CHECK(parse_text("WorldBegin ObjectInstance \"x\"") == LC_OK && note("unknown object x"));
    EXPECT_ERROR("WorldBegin ObjectEnd", "s.pbrt:1:12: error: ObjectEnd without ObjectBegin");
    EXPECT_ERROR("WorldBegin ObjectBegin \"a\"\nObjectBegin \"b\"",
                 "s.pbrt:2:1: error: ObjectBegin inside ObjectBegin");
    EXPECT_ERROR("WorldBegin ObjectBegin \"a\" AttributeBegin\nObjectEnd",
                 "s.pbrt:2:1: error: ObjectEnd, but the AttributeBegin of line 1 is still open");
}

/* ---- files ---- */

static void write_file(const char *name, const char *text) { file_text(temp_path(name), text); }

static lc_status parse_named(const char *name) { return parse_file(temp_path(name)); }

static void expect_file_error(const char *name, lc_status status, const char *where, const char *message)
{
    char want[1024];
    snprintf(want, sizeof want, "%s/%s: error: %s", temp_folder, where, message);
    EXPECT_FAILURE(parse_named(name), status, want);
}

#define PLY                                                                                                  \
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"        \
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"

TEST(includes)
{
    CHECK(!mkdir(temp_path("sub"), 0777));
    write_file("main.pbrt", "WorldBegin\nInclude \"sub/a\" " TRI);
    write_file("sub/a.pbrt",
               "Include \"b.pbrt\"\nTranslate 1 0 0 " TRI "Shape \"plymesh\" \"string filename\" \"m.ply\"\n"
               "Shape \"plymesh\" \"string filename\" \"sub/m.ply\"");
    write_file("sub/b.pbrt", "Translate 0 1 0 # no newline at the end");
    write_file("sub/m.ply", PLY);
    CHECKF(parse_named("main.pbrt") == LC_OK, "%s", last_error);
    CHECK(scene->n_tris == 4 && near3_abs(vertex(0), 1, 1, 0, 0));
    write_file("b.pbrt", "Translate 0 0 7"); /* beside the main file, which comes first */
    CHECK(parse_named("main.pbrt") == LC_OK && near3_abs(vertex(0), 1, 0, 7, 0));
    write_file("twice.pbrt", "WorldBegin Include \"tri.pbrt\" Include \"tri.pbrt\"");
    write_file("tri.pbrt", TRI);
    CHECK(parse_named("twice.pbrt") == LC_OK && scene->n_tris == 2);
}

/* Scenes are often passed on without some of their files: the others are read. */
TEST(missing_files)
{
    write_file("lost.pbrt",
               "WorldBegin\n Shape \"plymesh\" \"string filename\" \"x.ply\" " TRI "Include \"x\" " TRI);
    CHECK(parse_named("lost.pbrt") == LC_OK && scene->n_meshes == 2);
    CHECK(note("missing mesh") && strstr(note("missing mesh")->text, "lost.pbrt:2:18: '") &&
          strstr(note("missing mesh")->text, "/x.ply': no such file"));
    CHECK(note("missing file") &&
          strstr(note("missing file")->text, "/x': no such file; what it holds is left out"));
    char want[512];
    write_file("lost2.pbrt", "Include \"x\" WorldBegin");
    snprintf(want, sizeof want, "cannot open '%s/x': No such file or directory", temp_folder);
    expect_file_error("lost2.pbrt", LC_ERR_IO, "lost2.pbrt:1:9", want);
}

TEST(include_errors)
{
    write_file("self.pbrt", "WorldBegin\n  Include \"self.pbrt\"");
    expect_file_error("self.pbrt", LC_ERR_PARSE, "self.pbrt:2:11", "'self.pbrt' includes itself");
    write_file("ping.pbrt", "WorldBegin Include \"pong.pbrt\"");
    write_file("pong.pbrt", "\nInclude \"./ping.pbrt\"");
    expect_file_error("ping.pbrt", LC_ERR_PARSE, "pong.pbrt:2:9", "'./ping.pbrt' includes itself");
    write_file("folder.pbrt", "WorldBegin Include \"/\"");
    expect_file_error("folder.pbrt", LC_ERR_IO, "folder.pbrt:1:20", "cannot open '/': is a directory");
    write_file("device.pbrt", "WorldBegin Include \"/dev/null\"");
    expect_file_error("device.pbrt", LC_ERR_IO, "device.pbrt:1:20",
                      "cannot open '/dev/null': is not a regular file");
    EXPECT_FAILURE(parse_file("/nonexistent.pbrt"), LC_ERR_IO,
                   "error: cannot open '/nonexistent.pbrt': No such file or directory");
    write_file("inner.pbrt", "Translate 1 2\n");
    write_file("outer.pbrt", "WorldBegin Include \"inner.pbrt\" 3");
    expect_file_error("outer.pbrt", LC_ERR_PARSE, "inner.pbrt:2:1",
                      "Translate: expected a number, found the end of the file");
}

TEST(includes_that_double)
{
    char name[32], text[128];
    for (int i = 0; i < 40; i++) {
        snprintf(name, sizeof name, "d%d.pbrt", i);
        snprintf(text, sizeof text, "Include \"d%d.pbrt\" Include \"d%d.pbrt\"\n", i + 1, i + 1);
        write_file(name, i < 39 ? text : "");
    }
    CHECK(parse_named("d0.pbrt") == LC_ERR_PARSE);
    CHECKF(strstr(last_error, "more than 100000 files included"), "%s", last_error);
    for (int i = 0; i < 70; i++) {
        snprintf(name, sizeof name, "e%d.pbrt", i);
        snprintf(text, sizeof text, "Include \"e%d.pbrt\"\n", i + 1);
        write_file(name, text);
    }
    expect_file_error("e0.pbrt", LC_ERR_PARSE, "e63.pbrt:1:9", "files included more than 64 deep");
}

/* One that includes 1000 times one that includes 99 times another: 100,000 in all, and one more. */
TEST(as_many_includes_as_allowed)
{
    static char text[1000 * 32];
    char *to = text;
    for (int i = 0; i < 99; i++) to += sprintf(to, "Include \"leaf.pbrt\"\n");
    write_file("leaf.pbrt", "");
    write_file("branch.pbrt", text);
    for (int more = 0; more < 2; more++) {
        to = text + sprintf(text, more ? "Include \"leaf.pbrt\"\n" : "");
        for (int i = 0; i < 1000; i++) to += sprintf(to, "Include \"branch.pbrt\"\n");
        sprintf(to, "WorldBegin\n");
        write_file("root.pbrt", text);
        CHECKF((parse_named("root.pbrt") == LC_OK) == !more, "%s", last_error);
    }
    CHECKF(strstr(last_error, "more than 100000 files included"), "%s", last_error);
}

/* ---- memory ---- */

static lc_status parse_starved(lc_context *c) { return parse_file_in(c, temp_path("all.pbrt")); }

TEST(every_allocation_may_fail)
{
    write_file(
        "all.pbrt",
        "Film \"image\" \"string filename\" \"f\" Camera \"perspective\" WorldBegin Include \"tri.pbrt\"\n"
        "MakeNamedMaterial \"a\" \"string type\" \"glass\" Texture \"t\" \"color\" \"constant\"\n"
        "Attribute \"shape\" \"float radius\" 2 \"string s\" \"x\" ColorSpace \"rec2020\"\n"
        "Material \"diffuse\" \"rgb reflectance\" [1 0 0]\n"
        "CoordinateSystem \"c\" AttributeBegin Scale 2 2 2 AttributeEnd LightSource \"point\" "
        "ObjectBegin \"o\" Shape \"sphere\" ObjectEnd ObjectInstance \"o\"\n"
        "Shape \"plymesh\" \"string filename\" \"sub/m.ply\" Shape \"disk\" \"float x\" 1");
    starve(parse_starved, 20);
}

int main(void)
{
    ctx = quiet_context(0);
    temp_begin();
    RUN(numbers);
    RUN(layout_of_text);
    RUN(commas);
    RUN(garbage);
    RUN(transforms);
    RUN(look_at_and_camera);
    RUN(scopes);
    RUN(a_million_scopes);
    RUN(order_of_sections);
    RUN(max_pixels);
    RUN(film);
    RUN(ignored_politely);
    RUN(named_materials_and_textures);
    RUN(silent_integrator);
    RUN(materials);
    RUN(mirrors_and_depth);
    RUN(point_lights);
    RUN(directed_lights);
    RUN(spectral_lights);
    RUN(triangle_meshes);
    RUN(spheres);
    RUN(many_spheres_are_coarser);
    RUN(disks);
    RUN(unknown_shapes);
    RUN(instances);
    RUN(includes);
    RUN(missing_files);
    RUN(include_errors);
    RUN(includes_that_double);
    RUN(as_many_includes_as_allowed);
    RUN(every_allocation_may_fail);
    one_scene_end();
    temp_end();
    return test_done();
}
