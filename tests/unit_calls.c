/* unit_calls.c - what readers of files need of the calls that build a scene: media, patterns, pictures, suns,
 * lights by frames, cameras by matrices have the bytes of their file; notes, features and places; every
 * argument checked; memory that ends anywhere. */
#include "support/rendered.h"
#include "support/scene_text.h"
#include "support/test.h"
#include "support/watched_memory.h"

#include <math.h>

static lc_context *ctx;

static const float wall_at[] = { -4, -4, 5, 4, -4, 5, 4, 4, 5, -4, 4, 5 };
static const uint32_t faces[] = { 0, 1, 2, 0, 2, 3 };
static const float uv[] = { 0, 0, 1, 0, 1, 1, 0, 1 };
static const float texels[] = { 1,   .2f, .1f, .3f, .8f, .2f, .9f, .9f, .3f,
                                .1f, .1f, .7f, .5f, .5f, .5f, .6f, .2f, .9f };
static const float square[] = { 1, 0, .2f, 0, 1, .3f, .1f, 0, 1, .5f, .5f, 0 };
static const float box_at[] = {
    -1, -1, 2, 1, -1, 2, -1, 1, 2, 1, 1, 2, -1, -1, 4, 1, -1, 4, -1, 1, 4, 1, 1, 4
};
static const uint32_t box_faces[] = { 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                      2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };

/* What a case adds to the scene, its wall and its camera; *m is the wall's material. */
typedef struct made {
    lc_build_material_desc m;
    lc_build_mesh_desc wall;
    lc_build_camera_desc camera;
} made;
typedef lc_status add_fn(lc_scene *s, made *x);

static void set3(float *to, float a, float b, float c)
{
    to[0] = a;
    to[1] = b;
    to[2] = c;
}

static lc_status picture(lc_scene *s, const float *from, uint32_t w, uint32_t h, uint32_t *id)
{
    lc_build_picture_desc d = LC_BUILD_PICTURE_DESC_INIT;
    d.width = w;
    d.height = h;
    d.kind = LC_BUILD_FLOATS;
    d.texels = from;
    return lc_build_picture(s, &d, id);
}

static void set_box(lc_build_mesh_desc *d)
{
    d->n_vertices = 8;
    d->n_triangles = 12;
    d->positions = box_at;
    d->indices = box_faces;
}

/* ---- media ---- */

static lc_status fog(lc_scene *s, made *x)
{
    lc_build_medium_desc d = LC_BUILD_MEDIUM_DESC_INIT;
    (void)x;
    set3(d.absorption, .1f, .2f, .3f);
    set3(d.scattering, .2f, .1f, .1f);
    d.g = .5f;
    return lc_build_medium(s, &d, &x->camera.medium);
}

static lc_status cloud(lc_scene *s, made *x)
{
    static const float densities[] = { 1, 2, 3, 4, 0, 1, 2, .5f };
    lc_build_medium_desc d = LC_BUILD_MEDIUM_DESC_INIT;
    lc_build_mesh_desc box = LC_BUILD_MESH_DESC_INIT;
    uint32_t id;
    (void)x;
    set3(d.absorption, .1f, .1f, .2f);
    set3(d.scattering, .3f, .3f, .1f);
    d.densities = densities;
    for (int k = 0; k < 3; k++) {
        d.n[k] = 2;
        d.lo[k] = k == 2 ? 2 : -1;
        d.hi[k] = k == 2 ? 4 : 1;
    }
    set_box(&box);
    lc_status st = lc_build_medium(s, &d, &id);
    return st ? st : lc_build_boundary(s, &box, id, LC_NO_MEDIUM);
}

/* ---- patterns ---- */

static lc_status checks(lc_scene *s, made *x)
{
    lc_build_pattern_desc d = LC_BUILD_PATTERN_DESC_INIT;
    const double a[3] = { (double).9f, (double).2f, (double).1f },
                 b[3] = { (double).1f, (double).2f, (double).8f }; /* as files have them */
    d.kind = LC_PATTERN_CHECKER;
    d.repeat[0] = d.repeat[1] = 5;
    memcpy(d.in[0].value, a, sizeof a);
    memcpy(d.in[1].value, b, sizeof b);
    return lc_build_pattern(s, &d, &x->m.diffuse_texture);
}

static lc_status marble(lc_scene *s, made *x)
{
    lc_build_pattern_desc d = LC_BUILD_PATTERN_DESC_INIT;
    d.kind = LC_PATTERN_MARBLE;
    d.scale = 3;
    d.octaves = 4;
    d.variation = .4;
    return lc_build_pattern(s, &d, &x->m.diffuse_texture);
}

/* A picture times noise, as reflectance and as roughness. */
static lc_status product(lc_scene *s, made *x)
{
    lc_build_pattern_desc a = LC_BUILD_PATTERN_DESC_INIT, b = a, c = a;
    uint32_t id;
    a.kind = LC_PATTERN_PICTURE;
    a.wrap = LC_BUILD_CLAMP;
    b.kind = LC_PATTERN_FBM;
    b.n_channels = 1;
    c.kind = LC_PATTERN_SCALE;
    lc_status st = picture(s, texels, 3, 2, &a.picture);
    if (!st) st = lc_build_pattern(s, &a, &id);
    if (!st) st = lc_build_texture_value(s, id, &c.in[0]);
    if (!st) st = lc_build_pattern(s, &b, &id);
    if (!st) st = lc_build_texture_value(s, id, &c.in[2]);
    for (int k = 0; k < 3; k++) c.in[1].value[k] = 1;
    return st ? st : lc_build_pattern(s, &c, &x->m.diffuse_texture);
}

static lc_status lobe(lc_scene *s, made *x)
{
    lc_build_pattern_desc d = LC_BUILD_PATTERN_DESC_INIT;
    set3(x->m.glossy, .5f, .4f, .3f);
    d.kind = LC_PATTERN_BILERP;
    d.n_channels = 1;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) d.in[i].value[k] = i & 1 ? 90 : 5;
    return lc_build_pattern(s, &d, &x->m.exponent_texture);
}

static lc_status brushed(lc_scene *s, made *x)
{
    lc_build_pattern_desc d = LC_BUILD_PATTERN_DESC_INIT;
    (void)s;
    x->m.gloss = LC_GLOSS_GGX;
    x->m.fresnel = LC_REFLECT_DIELECTRIC;
    x->m.coat = 1;
    x->m.coat_thickness = .01f;
    x->m.coat_terms = 5;
    set3(x->m.glossy, 1, 1, 1);
    x->m.roughness[1] = sqrtf(.25f);
    x->m.roughness_texture_v = LC_NO_TEXTURE;
    x->m.remap = LC_REMAP_ROOT;
    d.kind = LC_PATTERN_DOTS;
    d.n_channels = 1;
    d.repeat[0] = d.repeat[1] = 4;
    for (int k = 0; k < 3; k++) {
        d.in[0].value[k] = .04;
        d.in[1].value[k] = .3;
    }
    return lc_build_pattern(s, &d, &x->m.roughness_texture);
}

static lc_status metal(lc_scene *s, made *x)
{
    lc_build_pattern_desc d = LC_BUILD_PATTERN_DESC_INIT;
    set3(x->m.diffuse, 0, 0, 0);
    set3(x->m.glossy, 1, 1, 1);
    x->m.gloss = LC_GLOSS_GGX;
    x->m.fresnel = LC_REFLECT_CONDUCTOR;
    x->m.roughness[0] = x->m.roughness[1] = .3f;
    x->m.metal = 1;
    d.kind = LC_PATTERN_PICTURE;
    lc_status st = picture(s, texels, 3, 2, &d.picture);
    return st ? st : lc_build_pattern(s, &d, &x->m.glossy_texture);
}

static lc_status shadow(lc_scene *s, made *x)
{
    (void)s;
    x->wall.alpha = .75f;
    x->wall.shadow_alpha = .5f;
    return LC_OK;
}

static lc_status glow(lc_scene *s, made *x)
{
    set3(x->wall.emission, 2, 3, 4);
    return picture(s, texels, 3, 2, &x->wall.emission_picture);
}

/* ---- lights ---- */

static lc_status sun(lc_scene *s, made *x)
{
    lc_build_sun_desc d = LC_BUILD_SUN_DESC_INIT;
    (void)x;
    d.direction[0] = .3;
    d.direction[2] = -1;
    set3(d.irradiance, 3, 2, 1);
    d.angle = 4;
    d.n_lights = 20;
    return lc_build_sun(s, &d);
}

static lc_status shine(lc_scene *s, made *x)
{
    static const double turned[9] = { 0, 0, 1, 1, 0, 0, 0, 1, 0 };
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    (void)x;
    l.kind = LC_BUILD_GONIOMETRIC;
    set3(l.intensity, 9, 8, 7);
    l.equal_area = l.grey = 1;
    memcpy(l.frame, turned, sizeof turned);
    const lc_status st = picture(s, square, 2, 2, &l.map);
    return st ? st : lc_build_light(s, &l);
}

static lc_status beam(lc_scene *s, made *x)
{
    static const double sheared[9] = { 2, .5, .1, 0, 1, .2, 0, 0, 1 };
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    (void)x;
    l.kind = LC_BUILD_PROJECTOR;
    l.fov = 50;
    l.power = 40;
    memcpy(l.frame, sheared, sizeof sheared);
    const lc_status st = picture(s, texels, 3, 2, &l.map);
    return st ? st : lc_build_light(s, &l);
}

static lc_status soft(lc_scene *s, made *x)
{
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    (void)x;
    set3(l.intensity, 9, 8, 7);
    set3(l.attenuation, 1, .5f, .25f);
    return lc_build_light(s, &l);
}

static lc_status sky(lc_scene *s, made *x)
{
    static const double turned[16] = { 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1 };
    lc_build_environment_desc d = LC_BUILD_ENVIRONMENT_DESC_INIT;
    (void)x;
    d.illuminance = 8;
    memcpy(d.to_world, turned, sizeof turned);
    const lc_status st = picture(s, texels, 3, 2, &d.picture);
    return st ? st : lc_build_environment(s, &d);
}

/* Of three lights that share a table's light, one under a mirroring matrix. */
static lc_status fixture(lc_scene *s, made *x)
{
    static const float azimuth[] = { 0, 90, 180, 270, 360 }, polar[] = { 0, 60, 180 };
    static const float candela[] = { 900, 400, 0, 700, 300, 5, 500, 100, 0, 600, 200, 0, 900, 400, 0 };
    static const double mirrored[9] = { -1, 0, 0, 0, 0, 1, 0, -1, 0 };
    lc_build_luminaire_desc d = LC_BUILD_LUMINAIRE_DESC_INIT;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    (void)x;
    d.n_azimuth = 5;
    d.n_polar = 3;
    d.azimuth = azimuth;
    d.polar = polar;
    d.candela = candela;
    l.kind = LC_BUILD_LUMINAIRE;
    set3(l.intensity, .05f, .05f, .05f);
    memcpy(l.frame, mirrored, sizeof mirrored);
    const lc_status st = lc_build_luminaire(s, &d, &l.luminaire);
    return st ? st : lc_build_light(s, &l);
}

/* ---- the camera ---- */

static lc_status matrix(lc_scene *s, made *x)
{
    static const double scaled[16] = { 1, 0, .2, 0, 0, 1, 0, .1, 0, 0, 1, .5, 0, 0, 0, 1 };
    static const double window[4] = { -.5, 1, -1, .25 };
    (void)s;
    x->camera.fov = 60;
    memcpy(x->camera.world_to_camera, scaled, sizeof scaled);
    memcpy(x->camera.screen, window, sizeof window);
    return LC_OK;
}

#define MAP   "\"imagemap\" \"string filename\" \"p.pfm\""
#define BOX_P "\"point3 P\" [-1 -1 2 1 -1 2 -1 1 2 1 1 2 -1 -1 4 1 -1 4 -1 1 4 1 1 4]"
#define BOX_I "\"integer indices\" [0 2 1 1 2 3 4 5 6 5 7 6 0 1 4 1 5 4 2 6 3 3 6 7 0 4 2 2 4 6 1 3 5 3 7 5]"
#define GREY  "Material \"diffuse\"\n"

/* front: before WorldBegin; a file has the usual camera unless that has one. */
static const struct {
    const char *name, *front, *world, *shape;
    add_fn *add;
} cases[] = {
    { "fog",
      "MakeNamedMedium \"f\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [.1 .2 .3] \"rgb sigma_s\" [.2 "
      ".1 "
      ".1] \"float g\" .5\nMediumInterface \"\" \"f\"\nCamera \"perspective\" \"float fov\" 90\n",
      GREY, "", fog },
    { "cloud", "",
      "MakeNamedMedium \"c\" \"string type\" \"uniformgrid\" \"rgb sigma_a\" [.1 .1 .2] \"rgb sigma_s\" [.3 "
      ".3 "
      ".1] \"integer nx\" 2 \"integer ny\" 2 \"integer nz\" 2 \"float density\" [1 2 3 4 0 1 2 .5] \"point3 "
      "p0\" "
      "[-1 -1 2] \"point3 p1\" [1 1 4]\nAttributeBegin MediumInterface \"c\" \"\" Material \"interface\" "
      "Shape "
      "\"trianglemesh\" " BOX_P BOX_I " AttributeEnd\n" GREY,
      "", cloud },
    { "checks", "",
      "Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" 5 \"float vscale\" 5 \"rgb tex1\" [.9 .2 "
      ".1] "
      "\"rgb tex2\" [.1 .2 .8]\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n",
      "", checks },
    { "marble", "",
      "Texture \"t\" \"spectrum\" \"marble\" \"float scale\" 3 \"integer octaves\" 4 \"float variation\" .4\n"
      "Material \"diffuse\" \"texture reflectance\" \"t\"\n",
      "", marble },
    { "product", "",
      "Texture \"a\" \"spectrum\" " MAP
      " \"string wrap\" \"clamp\"\nTexture \"b\" \"float\" \"fbm\"\nTexture "
      "\"t\" \"spectrum\" \"scale\" \"texture tex\" \"a\" \"texture scale\" \"b\"\nMaterial \"diffuse\" "
      "\"texture reflectance\" \"t\"\n",
      "", product },
    { "lobe", "",
      "Texture \"t\" \"float\" \"bilerp\" \"float v00\" 5 \"float v01\" 90 \"float v10\" 5 \"float v11\" 90\n"
      "Material \"phong\" \"rgb Kd\" [.5 .5 .5] \"rgb Ks\" [.5 .4 .3] \"texture exponent\" \"t\"\n",
      "", lobe },
    { "brushed", "",
      "Texture \"t\" \"float\" \"dots\" \"float uscale\" 4 \"float vscale\" 4 \"float inside\" .04 \"float "
      "outside\" .3\nMaterial \"coateddiffuse\" \"texture uroughness\" \"t\" \"float vroughness\" .25\n",
      "", brushed },
    { "metal", "",
      "Texture \"t\" \"spectrum\" " MAP "\nMaterial \"conductor\" \"texture reflectance\" \"t\" \"float "
      "roughness\" .3 \"bool remaproughness\" false\n",
      "", metal },
    { "shadow", "", GREY, "\"float alpha\" .75 \"float shadowalpha\" .5", shadow },
    { "glow", "", GREY "AreaLightSource \"diffuse\" \"rgb L\" [2 3 4] \"string filename\" \"p.pfm\"\n", "",
      glow },
    { "sun", "",
      "LightSource \"sun\" \"vector3 direction\" [.3 0 -1] \"rgb E\" [3 2 1] \"float angle\" 4 \"integer "
      "lights\" 20\n" GREY,
      "", sun },
    { "shine", "",
      "AttributeBegin Transform [0 1 0 0 0 0 1 0 1 0 0 0 0 0 0 1] LightSource \"goniometric\" \"rgb I\" [9 8 "
      "7] \"string filename\" \"s.pfm\" AttributeEnd\n" GREY,
      "", shine },
    { "beam", "",
      "AttributeBegin Transform [2 0 0 0 .5 1 0 0 .1 .2 1 0 0 0 0 1] LightSource \"projection\" \"float "
      "fov\" "
      "50 \"float power\" 40 \"string mapname\" \"p.pfm\" AttributeEnd\n" GREY,
      "", beam },
    { "soft", "",
      "LightSource \"point\" \"rgb I\" [9 8 7] \"float A\" 1 \"float B\" .5 \"float C\" .25\n" GREY, "",
      soft },
    { "sky", "",
      "AttributeBegin Transform [0 1 0 0 0 0 1 0 1 0 0 0 0 0 0 1] LightSource \"infinite\" \"string "
      "mapname\" "
      "\"p.pfm\" \"float illuminance\" 4 AttributeEnd\n" GREY,
      "", sky },
    { "fixture", "",
      "AttributeBegin Transform [-1 0 0 0 0 0 -1 0 0 1 0 0 0 0 0 1] LightSource \"luminaire\" \"string "
      "filename\" "
      "\"l.ies\" \"rgb I\" [.05 .05 .05] AttributeEnd\n" GREY,
      "", fixture },
    { "matrix",
      "Identity Transform [1 0 0 0 0 1 0 0 .2 0 1 0 0 .1 .5 1] Camera \"perspective\" \"float fov\" 60 "
      "\"float "
      "screenwindow\" [-.5 1 -1 .25]\n",
      GREY, "", matrix },
};
#define N_CASES (sizeof cases / sizeof *cases)

#define IES                                                                                                  \
    "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 3 5 1 2 0 0 0\n1 1 100\n0 60 180\n0 90 180 270 360\n"             \
    "900 400 0\n700 300 5\n500 100 0\n600 200 0\n900 400 0\n"

static lc_status build(lc_context *c, add_fn *add, lc_scene **out)
{
    made x = { LC_BUILD_MATERIAL_DESC_INIT, LC_BUILD_MESH_DESC_INIT, LC_BUILD_CAMERA_DESC_INIT };
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    lc_build_film_desc film = LC_BUILD_FILM_DESC_INIT;
    lc_scene *s;
    lc_status st = lc_build_begin(c, &s);
    *out = s;
    if (st) return st;
    film.width = film.height = 16;
    set3(l.position, -.5f, 1, 0);
    set3(l.intensity, 4, 4, 4);
    x.wall.n_vertices = 4;
    x.wall.n_triangles = 2;
    x.wall.positions = wall_at;
    x.wall.indices = faces;
    x.wall.uv = uv;
    st = lc_build_paths(s, 0, 5);
    if (!st) st = lc_build_light(s, &l);
    if (!st) st = add(s, &x);
    if (!st) st = lc_build_material(s, &x.m, &x.wall.material);
    if (!st) st = lc_build_mesh(s, &x.wall);
    if (!st) st = lc_build_camera(s, &x.camera);
    return st ? st : lc_build_film(s, &film);
}

static lc_scene *from_file(size_t i)
{
    return scene_from_text(
        ctx, &(lc_load_desc){ .size = sizeof(lc_load_desc), .env_lights = 40, .area_lights = 20 },
        "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16\nSampler \"independent\" "
        "\"integer pixelsamples\" 1\nIntegrator \"directlighting\"\nPixelFilter \"box\"\n%s%sWorldBegin\n"
        "LightSource \"point\" \"rgb I\" [4 4 4] \"point3 from\" [-.5 1 0]\n%s"
        "Shape \"trianglemesh\" \"point3 P\" [-4 -4 5 4 -4 5 4 4 5 -4 4 5] \"integer indices\" [0 1 2 0 2 3] "
        "\"point2 uv\" [0 0 1 0 1 1 0 1] %s\n",
        cases[i].front, strstr(cases[i].front, "Camera") ? "" : "Camera \"perspective\" \"float fov\" 90\n",
        cases[i].world, cases[i].shape);
}

TEST(each_scene_by_calls_has_the_bytes_of_its_file)
{
    lc_load_desc load = LC_LOAD_DESC_INIT;
    load.env_lights = 40;
    load.area_lights = 20;
    pfm_write(temp_path("p.pfm"), 3, 2, texels);
    pfm_write(temp_path("s.pfm"), 2, 2, square);
    file_text(temp_path("l.ies"), IES);
    lc_image *before = NULL;
    for (size_t i = 0; i < N_CASES; i++) {
        lc_scene *s, *t = from_file(i);
        CHECKF(!build(ctx, cases[i].add, &s) && !lc_build_commit(s, &load), "%s: %s", cases[i].name,
               last_error);
        lc_image *a = rendered(ctx, s), *b = t ? rendered(ctx, t) : NULL;
        CHECKF(same_planes(a, b), "%s", cases[i].name);
        CHECKF(!same_planes(a, before), "%s is as the one before", cases[i].name);
        lc_image_destroy(before);
        before = a;
        lc_image_destroy(b);
        lc_scene_destroy(s);
        lc_scene_destroy(t);
    }
    lc_image_destroy(before);
}

/* ---- readers ---- */

TEST(places_begin_messages_and_notes_are_counted)
{
    lc_scene *s;
    const char *text;
    lc_note note = LC_NOTE_INIT;
    lc_feature feature = LC_FEATURE_INIT;
    lc_scene_info info = LC_SCENE_INFO_INIT;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    char file[] = "a.xyz";
    CHECK(!lc_build_begin(ctx, &s) && lc_build_noted(s, &text) == 0 && !*text);
    CHECK(!lc_build_at(s, file, 7, 9));
    file[0] = 'b'; /* it was copied */
    CHECK(!lc_build_note(s, "cone", "cones are\nleft out") && !lc_build_note(s, "cone", "again"));
    CHECK(lc_build_noted(s, &text) == 2 && !strcmp(text, "a.xyz:7:9: cones are left out"));
    CHECK(!lc_scene_get_info(s, &info) && info.n_notes == 1 && !lc_scene_get_note(s, 0, &note));
    CHECK(note.count == 2 && !strcmp(note.kind, "cone"));
    CHECK(!lc_build_feature(s, "shape", "cone", LC_SUPPORT_IGNORED, "left out"));
    CHECK(!lc_build_feature(s, "shape", "cone", LC_SUPPORT_YES, NULL));
    CHECK(!lc_scene_get_feature(s, 0, &feature) && feature.count == 2 &&
          feature.support == LC_SUPPORT_IGNORED);
    l.intensity[0] = -1;
    log_clear();
    CHECK(lc_build_light(s, &l) == LC_ERR_PARSE && strstr(last_error, "a.xyz:7:9: error: "));
    CHECK(!lc_build_at(s, NULL, 1, 1));
    log_clear();
    CHECK(lc_build_light(s, &l) == LC_ERR_ARG && !strstr(last_error, "xyz"));
    for (int i = 0; i < 600; i++) {
        char kind[20];
        snprintf(kind, sizeof kind, "kind %d", i);
        CHECK(!lc_build_note(s, kind, "x") && !lc_build_feature(s, "a", kind, LC_SUPPORT_YES, NULL));
    }
    CHECK(!lc_scene_get_info(s, &info) && info.n_notes == 501);
    CHECK(!lc_scene_get_note(s, 500, &note) && !strcmp(note.kind, "other") && note.count == 101);
    lc_scene_destroy(s);
}

TEST(traits_values_and_what_shines_are_told)
{
    lc_scene *s;
    made x = { LC_BUILD_MATERIAL_DESC_INIT, LC_BUILD_MESH_DESC_INIT, LC_BUILD_CAMERA_DESC_INIT };
    lc_build_pattern_desc d = LC_BUILD_PATTERN_DESC_INIT;
    lc_build_value v;
    double mean[3];
    uint32_t plain = 0, map = 0, glass = 0, id = 0;
    const double shear[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 }, flat[16] = { 1 };
    CHECK(!lc_build_begin(ctx, &s) && !lc_build_is_lit(s));
    CHECK(lc_build_instance_fits(shear) && !lc_build_instance_fits(flat) && !lc_build_instance_fits(NULL));
    CHECK(!lc_build_material(s, &x.m, &plain) && lc_build_traits(s, plain) == 0 && !lc_build_traits(s, 9));
    CHECK(!checks(s, &x) && !lc_build_material(s, &x.m, &map));
    CHECK(lc_build_traits(s, map) == (LC_TRAIT_UV | LC_TRAIT_TEXTURED));
    x.m.specular = LC_BUILD_GLASS;
    x.m.diffuse_texture = LC_NO_TEXTURE;
    set3(x.m.transmitted, 1, 1, 1);
    CHECK(!lc_build_material(s, &x.m, &glass) && lc_build_traits(s, glass) == LC_TRAIT_CLEAR);
    CHECK(!lc_build_texture_value(s, 0, &v) && v.id == 0 && v.value[0] > .4 && v.value[0] < .6);
    d.in[0].value[1] = .25;
    CHECK(!lc_build_pattern(s, &d, &id) && !lc_build_texture_value(s, id, &v));
    CHECK(v.id == LC_NO_TEXTURE && v.value[1] >= .25 && v.value[1] <= .25);
    CHECK(!picture(s, square, 2, 2, &id) && !lc_build_picture_mean(s, id, mean));
    CHECK(fabs(mean[0] - .4) < 1e-6);
    CHECK(!soft(s, &x) && lc_build_is_lit(s));
    lc_scene_destroy(s);
}

/* One picture as reflectance, emission, sky and beam: whoever comes second has a copy. */
TEST(a_picture_may_be_used_for_all_at_once)
{
    lc_scene *s;
    made x = { LC_BUILD_MATERIAL_DESC_INIT, LC_BUILD_MESH_DESC_INIT, LC_BUILD_CAMERA_DESC_INIT };
    lc_build_environment_desc e = LC_BUILD_ENVIRONMENT_DESC_INIT;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    lc_build_pattern_desc d = LC_BUILD_PATTERN_DESC_INIT;
    lc_load_desc load = LC_LOAD_DESC_INIT;
    load.env_lights = load.area_lights = 20;
    CHECK(!build(ctx, glow, &s));
    e.picture = l.map = d.picture = x.wall.emission_picture = 0;
    set3(x.wall.emission, 1, 1, 1);
    l.kind = LC_BUILD_PROJECTOR;
    d.kind = LC_PATTERN_PICTURE;
    x.wall.n_vertices = 4;
    x.wall.n_triangles = 2;
    x.wall.positions = wall_at;
    x.wall.indices = faces;
    CHECK(!lc_build_environment(s, &e) && !lc_build_environment(s, &e) && !lc_build_light(s, &l));
    CHECK(!lc_build_pattern(s, &d, &x.m.diffuse_texture) && !lc_build_material(s, &x.m, &x.wall.material));
    CHECK(!lc_build_mesh(s, &x.wall) && !lc_build_commit(s, &load));
    lc_image_destroy(rendered(ctx, s));
    lc_scene_destroy(s);
}

TEST(an_object_may_follow_the_instances_of_another)
{
    lc_scene *s;
    made x = { LC_BUILD_MATERIAL_DESC_INIT, LC_BUILD_MESH_DESC_INIT, LC_BUILD_CAMERA_DESC_INIT };
    const double unit[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
    uint32_t a, b;
    CHECK(!build(ctx, soft, &s));
    set_box(&x.wall);
    CHECK(!lc_build_object(s, &a) && !lc_build_mesh(s, &x.wall) && !lc_build_instance(s, a, unit));
    CHECK(lc_build_mesh(s, &x.wall) == LC_ERR_ARG && strstr(last_error, "instances"));
    CHECK(!lc_build_object(s, &b) && !lc_build_mesh(s, &x.wall) && !lc_build_instance(s, b, unit));
    CHECK(!lc_build_instance(s, a, unit) && !lc_build_commit(s, NULL));
    lc_image_destroy(rendered(ctx, s));
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    l.kind = LC_BUILD_SPOT;
    CHECK(!lc_scene_set_light(s, 0, &l));
    l.falloff = LC_FALLOFF_SQUARED;
    REFUSED(lc_scene_set_light(s, 0, &l), "falloff");
    l.kind = LC_BUILD_GONIOMETRIC;
    REFUSED(lc_scene_set_light(s, 0, &l), "goniometric");
    lc_scene_destroy(s);
}

TEST(the_usual_camera_sees_the_scene)
{
    lc_scene *s;
    lc_image *image;
    float most = 0;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    l.position[2] = 9; /* that camera is on the other side of the wall */
    CHECK(!build(ctx, soft, &s) && !lc_build_light(s, &l) && !lc_build_usual_camera(s) &&
          !lc_build_commit(s, NULL));
    image = rendered(ctx, s);
    const float *g = image ? lc_image_channel(image, "G") : NULL;
    for (int i = 0; g && i < 256; i++) most = fmaxf(most, g[i]);
    CHECK(most > 0 && lc_build_usual_camera(s) == LC_ERR_ARG);
    lc_image_destroy(image);
    lc_scene_destroy(s);
}

/* ---- wrong arguments ---- */

TEST(wrong_pictures_patterns_and_materials_are_named)
{
    lc_scene *s;
    uint32_t id, one;
    lc_build_picture_desc p = LC_BUILD_PICTURE_DESC_INIT, p_used;
    lc_build_pattern_desc d = LC_BUILD_PATTERN_DESC_INIT, d_used;
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT, m_used;
    lc_build_mesh_desc q = LC_BUILD_MESH_DESC_INIT, q_used;
    double mean[3];
    CHECK(!lc_build_begin(ctx, &s));
    p.width = 3;
    p.height = 2;
    p.kind = LC_BUILD_FLOATS;
    p.texels = texels;
    WRONG(lc_build_picture(s, &p_used, &id), p, width = 0, "width");
    WRONG(lc_build_picture(s, &p_used, &id), p, n_channels = 5, "n_channels");
    WRONG(lc_build_picture(s, &p_used, &id), p, kind = (lc_build_texels)5, "kind");
    WRONG(lc_build_picture(s, &p_used, &id), p, texels = NULL, "texels");
    WRONG(lc_build_picture(s, &p_used, &id), p, gamma = -1, "gamma");
    REFUSED(lc_build_picture(s, &p, NULL), "id");
    REFUSED(lc_build_picture_mean(s, 0, mean), "picture");
    CHECK(!lc_build_picture(s, &p, &id) && id == 0);
    REFUSED(lc_build_picture_mean(s, 0, NULL), "mean");
    WRONG(lc_build_pattern(s, &d_used, &id), d, kind = (lc_build_pattern_kind)14, "kind");
    WRONG(lc_build_pattern(s, &d_used, &id), d, n_channels = 2, "n_channels");
    WRONG(lc_build_pattern(s, &d_used, &id), d, in[3].id = 0, "in:");
    WRONG(lc_build_pattern(s, &d_used, &id), d, in[1].value[2] = (double)INFINITY, "in:");
    WRONG(lc_build_pattern(s, &d_used, &id), d, kind = LC_PATTERN_PICTURE, "picture");
    WRONG(lc_build_pattern(s, &d_used, &id), d, mapping = (lc_build_mapping)4, "mapping");
    WRONG(lc_build_pattern(s, &d_used, &id), d, wrap = (lc_build_wrap)3, "wrap");
    WRONG(lc_build_pattern(s, &d_used, &id), d, filter = (lc_build_filter)3, "filter");
    WRONG(lc_build_pattern(s, &d_used, &id), d, octaves = 33, "octaves");
    WRONG(lc_build_pattern(s, &d_used, &id), d, grey[0] = (double)NAN, "grey");
    WRONG(lc_build_pattern(s, &d_used, &id), d, scale = (double)NAN, "scale");
    WRONG(lc_build_pattern(s, &d_used, &id), d, variation = (double)NAN, "variation");
    WRONG(lc_build_pattern(s, &d_used, &id), d, offset[1] = (double)NAN, "offset");
    WRONG(lc_build_pattern(s, &d_used, &id), d, v2[1] = (double)NAN, "v2");
    WRONG(lc_build_pattern(s, &d_used, &id), d, to_texture[11] = (double)NAN, "to_texture");
    REFUSED(lc_build_pattern(s, &d, NULL), "id");
    REFUSED(lc_build_texture_value(s, 0, &d.in[0]), "texture");
    CHECK(!lc_build_pattern(s, &d, &one) && one == 0);
    REFUSED(lc_build_texture_value(s, 0, NULL), "out");
    WRONG(lc_build_material(s, &m_used, &id), m, exponent_texture = 0, "exponent_texture");
    WRONG(lc_build_material(s, &m_used, &id), m, roughness_texture_v = 7, "roughness_texture_v");
    WRONG(lc_build_material(s, &m_used, &id), m, remap = (lc_build_remap)3, "remap");
    CHECK(!lc_build_material(s, &m, &q.material));
    WRONG(lc_build_mesh(s, &q_used), q, emission_picture = 1, "emission_picture");
    WRONG(lc_build_mesh(s, &q_used), q, emission_texture = 0, "emission_texture");
    WRONG(lc_build_mesh(s, &q_used), q, shadow_texture = 0, "shadow_texture");
    WRONG(lc_build_mesh(s, &q_used), q, shadow_alpha = 2, "shadow_alpha");
    lc_scene_destroy(s);
}

TEST(wrong_lights_and_skies_are_named)
{
    lc_scene *s;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT, l_used;
    lc_build_sun_desc d = LC_BUILD_SUN_DESC_INIT, d_used;
    lc_build_environment_desc e = LC_BUILD_ENVIRONMENT_DESC_INIT, e_used;
    CHECK(!lc_build_begin(ctx, &s) && !picture(s, texels, 3, 2, &e.picture));
    WRONG(lc_build_light(s, &l_used), l, attenuation[2] = 0, "attenuation");
    l.kind = LC_BUILD_SPOT;
    WRONG(lc_build_light(s, &l_used), l, falloff = (lc_build_falloff)2, "falloff");
    l.kind = LC_BUILD_GONIOMETRIC;
    REFUSED(lc_build_light(s, &l), "map");
    l.map = 0;
    WRONG(lc_build_light(s, &l_used), l, equal_area = 1, "equal_area");
    WRONG(lc_build_light(s, &l_used), l, power = -1, "power");
    WRONG(lc_build_light(s, &l_used), l, frame[0] = 1, "direction"); /* singular: it turns z to 0 */
    l.frame[8] = 1;
    REFUSED(lc_build_light(s, &l), "singular");
    l.kind = LC_BUILD_PROJECTOR;
    REFUSED(lc_build_light(s, &l), "singular");
    l.frame[0] = l.frame[4] = 1;
    WRONG(lc_build_light(s, &l_used), l, map = 3, "map");
    CHECK(!lc_build_light(s, &l));
    WRONG(lc_build_sun(s, &d_used), d, direction[2] = 0, "direction");
    WRONG(lc_build_sun(s, &d_used), d, irradiance[1] = -1, "irradiance");
    WRONG(lc_build_sun(s, &d_used), d, n_lights = 0, "n_lights");
    WRONG(lc_build_sun(s, &d_used), d, angle = 91, "angle");
    WRONG(lc_build_environment(s, &e_used), e, picture = 1, "picture");
    WRONG(lc_build_environment(s, &e_used), e, equal_area = 1, "equal_area");
    WRONG(lc_build_environment(s, &e_used), e, illuminance = -1, "illuminance");
    WRONG(lc_build_environment(s, &e_used), e, to_world[0] = (double)NAN, "to_world");
    lc_scene_destroy(s);
}

TEST(wrong_tables_are_named)
{
    static const float rising[] = { 0, 90, 180 }, falling[] = { 90, 0, 180 }, dark[9] = { 0, 0, -1 };
    static const double angle[] = { 5, 2 }, factor[] = { 1, 1 };
    lc_scene *s;
    uint32_t id;
    lc_build_luminaire_desc d = LC_BUILD_LUMINAIRE_DESC_INIT, d_used;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT, l_used;
    CHECK(!lc_build_begin(ctx, &s));
    d.n_azimuth = d.n_polar = 3;
    d.azimuth = d.polar = rising;
    d.candela = texels;
    WRONG(lc_build_luminaire(s, &d_used, &id), d, n_azimuth = 1, "azimuth");
    WRONG(lc_build_luminaire(s, &d_used, &id), d, polar = falling, "polar");
    WRONG(lc_build_luminaire(s, &d_used, &id), d, candela = NULL, "candela");
    WRONG(lc_build_luminaire(s, &d_used, &id), d, candela = dark, "candela");
    WRONG(lc_build_luminaire(s, &d_used, &id), d, axis[0] = 1, "axis");
    WRONG(lc_build_luminaire(s, &d_used, &id), d, lumens = -1, "lumens");
    WRONG(lc_build_luminaire(s, &d_used, &id), d, n_tilt = 2, "n_tilt");
    d.tilt_angle = angle;
    d.tilt_factor = factor;
    WRONG(lc_build_luminaire(s, &d_used, &id), d, n_tilt = 2, "tilt_angle");
    CHECK(!lc_build_luminaire(s, &d, &l.luminaire));
    l.kind = LC_BUILD_LUMINAIRE;
    WRONG(lc_build_light(s, &l_used), l, parts = 0, "parts");
    lc_scene_destroy(s);
}

TEST(wrong_media_cameras_and_calls_of_readers_are_named)
{
    static const float density[] = { 1, -1 };
    lc_scene *s;
    uint32_t id, far_faces[3] = { 0, 1, 8 };
    lc_build_medium_desc d = LC_BUILD_MEDIUM_DESC_INIT, d_used;
    lc_build_mesh_desc box = LC_BUILD_MESH_DESC_INIT, box_used;
    lc_build_camera_desc c = LC_BUILD_CAMERA_DESC_INIT, c_used;
    lc_build_film_desc f = LC_BUILD_FILM_DESC_INIT, f_used;
    CHECK(!lc_build_begin(ctx, &s));
    WRONG(lc_build_medium(s, &d_used, &id), d, absorption[0] = -1, "sigma");
    WRONG(lc_build_medium(s, &d_used, &id), d, g = 1, "g is not");
    REFUSED(lc_build_medium(s, &d, NULL), "id");
    d.densities = density;
    WRONG(lc_build_medium(s, &d_used, &id), d, n[0] = 1, "n:");
    d.n[0] = d.n[1] = d.n[2] = 1;
    WRONG(lc_build_medium(s, &d_used, &id), d, n[2] = 2, "densities");
    WRONG(lc_build_medium(s, &d_used, &id), d, hi[1] = 0, "box");
    WRONG(lc_build_medium(s, &d_used, &id), d, to_world[0] = 0, "singular");
    CHECK(!lc_build_medium(s, &d, &id) && id == 0);
    set_box(&box);
    REFUSED(lc_build_boundary(s, &box, 1, 0), "inside");
    REFUSED(lc_build_boundary(s, &box, 0, 1), "outside");
    WRONG(lc_build_boundary(s, &box_used, 0, LC_NO_MEDIUM), box, positions = NULL, "positions");
    WRONG(lc_build_boundary(s, &box_used, 0, LC_NO_MEDIUM), box, indices = NULL, "indices");
    box.n_triangles = 1;
    WRONG(lc_build_boundary(s, &box_used, 0, LC_NO_MEDIUM), box, indices = far_faces, "indices");
    WRONG(lc_build_camera(s, &c_used), c, medium = 1, "medium");
    WRONG(lc_build_camera(s, &c_used), c, screen[0] = 1, "screen");
    WRONG(lc_build_camera(s, &c_used), c, world_to_camera[0] = 1, "singular");
    WRONG(lc_build_film(s, &f_used), f, white[8] = NAN, "white");
    REFUSED(lc_build_paths(s, 1, 0), "max_depth");
    REFUSED(lc_build_note(s, NULL, "x"), "kind");
    REFUSED(lc_build_feature(s, "x", NULL, LC_SUPPORT_YES, NULL), "name");
    REFUSED(lc_build_feature(s, "x", "y", (lc_support)3, NULL), "support");
    CHECK(lc_build_at(NULL, "x", 1, 1) == LC_ERR_ARG && !lc_build_noted(NULL, NULL) &&
          !lc_build_is_lit(NULL));
    lc_scene_destroy(s);
}

/* ---- memory ---- */

static size_t starved;

static lc_status build_starved(lc_context *c)
{
    lc_scene *s;
    lc_status st = build(c, cases[starved].add, &s);
    if (!st) st = lc_build_at(s, "file.xyz", 1, 2);
    if (!st) st = lc_build_note(s, "kind", "text");
    if (!st) st = lc_build_feature(s, "kind", "name", LC_SUPPORT_APPROXIMATED, "text");
    lc_scene_destroy(s);
    return st;
}

TEST(every_allocation_may_fail)
{
    for (starved = 0; starved < N_CASES; starved++) starve(build_starved, 8);
}

int main(void)
{
    temp_begin();
    ctx = quiet_context_of(2, LC_ISA_BEST);
    RUN(each_scene_by_calls_has_the_bytes_of_its_file);
    RUN(places_begin_messages_and_notes_are_counted);
    RUN(traits_values_and_what_shines_are_told);
    RUN(a_picture_may_be_used_for_all_at_once);
    RUN(an_object_may_follow_the_instances_of_another);
    RUN(the_usual_camera_sees_the_scene);
    RUN(wrong_pictures_patterns_and_materials_are_named);
    RUN(wrong_lights_and_skies_are_named);
    RUN(wrong_tables_are_named);
    RUN(wrong_media_cameras_and_calls_of_readers_are_named);
    RUN(every_allocation_may_fail);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
