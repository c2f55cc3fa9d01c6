/* unit_look.c - textures, materials, environments, spots and luminaires by calls: the bytes of the same scene
 * from a file, every argument checked. */
#include "support/rendered.h"
#include "support/scene_text.h"
#include "support/test.h"
#include "support/watched_memory.h"

#include <math.h>

static lc_context *ctx;

static const float wall_at[] = { -2, -2, 3, 2, -2, 3, 2, 2, 3, -2, 2, 3 };
static const float behind_at[] = { -5, -5, 6, 5, -5, 6, 5, 5, 6, -5, 5, 6 };
static const uint32_t faces[] = { 0, 1, 2, 0, 2, 3 };
static const float uv[] = { 0, 0, 1, 0, 1, 1, 0, 1 };
static const float picture[] = { 1,   .2f, .1f, .3f, .8f, .2f, .9f, .9f, .3f,
                                 .1f, .1f, .7f, .5f, .5f, .5f, .6f, .2f, .9f };
static const float grey[] = { 1, .2f, .6f, .05f };
#define IES                                                                                                  \
    "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1.5 5 3 1 2 0 0 0\n1 1 100\n0 30 60 90 180\n0 45 90\n"              \
    "900 700 300 40 0\n800 500 400 60 10\n700 600 200 10 0\n"

typedef lc_status add_fn(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q);

/* A material on a wall; what adds to it, given the material and the wall. Pictures are in p.pfm, g.pfm,
 * l.ies. */
typedef struct look {
    const char *name, *before, *material, *shape;
    add_fn *add;
} look;

static lc_status texture(lc_scene *s, const float *texels, uint32_t w, uint32_t h, uint32_t n, uint32_t *id)
{
    lc_build_texture_desc t = LC_BUILD_TEXTURE_DESC_INIT;
    t.width = w;
    t.height = h;
    t.n_channels = n;
    t.kind = LC_BUILD_FLOATS;
    t.texels = texels;
    return lc_build_texture(s, &t, id);
}

static void set3(float *to, float a, float b, float c)
{
    to[0] = a;
    to[1] = b;
    to[2] = c;
}

static lc_status diffuse_picture(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    q->uv = uv;
    return texture(s, picture, 3, 2, 3, &m->diffuse_texture);
}

static lc_status repeated(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    lc_build_texture_desc t = LC_BUILD_TEXTURE_DESC_INIT;
    t.width = 3;
    t.height = 2;
    t.kind = LC_BUILD_FLOATS;
    t.texels = picture;
    t.repeat[0] = 2;
    t.repeat[1] = 3;
    t.offset[0] = .25;
    t.wrap = LC_BUILD_CLAMP;
    t.filter = LC_BUILD_TRILINEAR;
    t.scale = .5f;
    q->uv = uv;
    return lc_build_texture(s, &t, &m->diffuse_texture);
}

static lc_status ggx(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    (void)s;
    q->uv = uv;
    m->gloss = LC_GLOSS_GGX;
    set3(m->diffuse, .2f, .3f, .4f);
    set3(m->glossy, .5f, .4f, .3f);
    m->roughness[0] = .2f;
    m->roughness[1] = .4f;
    return LC_OK;
}

static lc_status rough_picture(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    q->uv = uv;
    m->gloss = LC_GLOSS_WARD;
    set3(m->glossy, .5f, .4f, .3f);
    return texture(s, grey, 2, 2, 1, &m->roughness_texture);
}

static lc_status coated(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    (void)s;
    (void)q;
    m->gloss = LC_GLOSS_GGX;
    m->fresnel = LC_REFLECT_DIELECTRIC;
    m->coat = 1;
    set3(m->glossy, 1, 1, 1);
    m->roughness[0] = m->roughness[1] = .3f;
    m->coat_thickness = .01f;
    m->coat_terms = 5;
    return LC_OK;
}

static lc_status mirror(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    (void)s;
    (void)q;
    m->specular = LC_BUILD_MIRROR;
    m->fresnel = LC_REFLECT_ALL;
    set3(m->glossy, .8f, .7f, .6f);
    return LC_OK;
}

static lc_status glass(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    (void)s;
    (void)q;
    m->specular = LC_BUILD_GLASS;
    set3(m->glossy, 1, 1, 1);
    set3(m->transmitted, 1, 1, 1);
    return LC_OK;
}

static lc_status sheet(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    glass(s, m, q);
    m->specular = LC_BUILD_THIN_GLASS;
    return LC_OK;
}

static lc_status holes(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    (void)m;
    q->uv = uv;
    return texture(s, grey, 2, 2, 1, &q->alpha_texture);
}

static lc_status half(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    (void)s;
    (void)m;
    q->alpha = .5f;
    return LC_OK;
}

static lc_status translucent(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    (void)s;
    (void)q;
    set3(m->diffuse, .2f, .3f, .4f);
    set3(m->transmitted, .6f, .5f, .1f);
    return LC_OK;
}

static lc_status bumps(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    q->uv = uv;
    return texture(s, grey, 2, 2, 1, &m->bump_texture);
}

static lc_status sky(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    lc_build_environment_desc e = LC_BUILD_ENVIRONMENT_DESC_INIT;
    (void)m;
    (void)q;
    set3(e.scale, .5f, .6f, .7f);
    return lc_build_environment(s, &e);
}

static lc_status square_sky(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    static const float four[] = { 1, 0, 0, 0, 1, 0, 0, 0, 1, .5f, .5f, 0 };
    lc_build_environment_desc e = LC_BUILD_ENVIRONMENT_DESC_INIT;
    (void)m;
    (void)q;
    e.width = e.height = 2;
    e.texels = four;
    e.equal_area = 1;
    return lc_build_environment(s, &e);
}

static lc_status long_sky(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    const double turned[16] = { 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1 };
    lc_build_environment_desc e = LC_BUILD_ENVIRONMENT_DESC_INIT;
    (void)m;
    (void)q;
    e.width = 3;
    e.height = 2;
    e.texels = picture;
    memcpy(e.to_world, turned, sizeof turned);
    return lc_build_environment(s, &e);
}

static lc_status spot(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    (void)m;
    (void)q;
    l.kind = LC_BUILD_SPOT;
    l.position[1] = 1;
    l.direction[1] = -.5;
    l.direction[2] = 3;
    l.cone = 35;
    l.delta = 12;
    set3(l.intensity, 9, 8, 7);
    return lc_build_light(s, &l);
}

static lc_status luminaire_at(lc_scene *s, double lumens)
{
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    lc_build_luminaire_desc d = LC_BUILD_LUMINAIRE_DESC_INIT;
    d.text = IES;
    d.length = sizeof IES - 1;
    lc_status st = lc_build_luminaire(s, &d, &l.luminaire);
    l.kind = LC_BUILD_LUMINAIRE;
    l.position[0] = .5f;
    l.position[2] = 4.5f;
    l.direction[2] = -1;
    l.lumens = lumens;
    set3(l.intensity, .02f, .03f, .04f);
    return st ? st : lc_build_light(s, &l);
}

static lc_status luminaire(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    (void)m;
    (void)q;
    return luminaire_at(s, 0);
}

static lc_status bright_luminaire(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    (void)m;
    (void)q;
    return luminaire_at(s, 5000);
}

/* The mix takes the place of the material that `build` makes. */
static lc_status mixed_by(lc_scene *s, lc_build_mix_desc *d, lc_build_mesh_desc *q)
{
    lc_build_material_desc m[2] = { LC_BUILD_MATERIAL_DESC_INIT, LC_BUILD_MATERIAL_DESC_INIT };
    set3(m[0].diffuse, .9f, .1f, .2f);
    set3(m[1].diffuse, .1f, .2f, .9f);
    q->uv = uv;
    lc_status st = lc_build_material(s, &m[0], &d->materials[0]);
    if (!st) st = lc_build_material(s, &m[1], &d->materials[1]);
    return st ? st : lc_build_mix(s, d, &q->material);
}

static lc_status mix(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    (void)m;
    lc_build_mix_desc d = LC_BUILD_MIX_DESC_INIT;
    set3(d.share, .3f, .3f, .3f);
    return mixed_by(s, &d, q);
}

static lc_status mix_by_picture(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    (void)m;
    lc_build_mix_desc d = LC_BUILD_MIX_DESC_INIT;
    const lc_status st = texture(s, grey, 2, 2, 1, &d.share_texture);
    return st ? st : mixed_by(s, &d, q);
}

static lc_status glowing_picture(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    (void)m;
    q->uv = uv;
    set3(q->emission, 2, 3, 4);
    return texture(s, picture, 3, 2, 3, &q->emission_texture);
}

static lc_status projector(lc_scene *s, lc_build_material_desc *m, lc_build_mesh_desc *q)
{
    (void)m;
    (void)q;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    l.kind = LC_BUILD_PROJECTOR;
    l.position[0] = .25f;
    l.fov = 60;
    set3(l.intensity, 9, 8, 7);
    const lc_status st = texture(s, picture, 3, 2, 3, &l.picture);
    return st ? st : lc_build_light(s, &l);
}

#define MAP(type, file, more)                                                                                \
    "Texture \"t\" \"" type "\" \"imagemap\" \"string filename\" \"" file "\" " more "\n"
#define PARTS                                                                                                \
    "MakeNamedMaterial \"x\" \"string type\" \"diffuse\" \"rgb reflectance\" [.9 .1 .2]\n"                   \
    "MakeNamedMaterial \"y\" \"string type\" \"diffuse\" \"rgb reflectance\" [.1 .2 .9]\n"
static const look looks[] = {
    { "diffuse picture", MAP("spectrum", "p.pfm", ""), "\"diffuse\" \"texture reflectance\" \"t\"", "",
      diffuse_picture },
    { "repeated picture",
      MAP("spectrum", "p.pfm",
          "\"float uscale\" 2 \"float vscale\" 3 \"float udelta\" .25 \"string wrap\" \"clamp\" \"string "
          "filter\" "
          "\"trilinear\" \"float scale\" .5"),
      "\"diffuse\" \"texture reflectance\" \"t\"", "", repeated },
    { "GGX", "",
      "\"ggx\" \"rgb Kd\" [.2 .3 .4] \"rgb Ks\" [.5 .4 .3] \"float uroughness\" .2 \"float vroughness\" .4",
      "", ggx },
    { "roughness", MAP("float", "g.pfm", ""),
      "\"ward\" \"rgb Kd\" [.5 .5 .5] \"rgb Ks\" [.5 .4 .3] \"texture roughness\" \"t\"", "", rough_picture },
    { "coat", "", "\"coateddiffuse\" \"float roughness\" .3 \"bool remaproughness\" false", "", coated },
    { "mirror", "", "\"mirror\" \"rgb reflectance\" [.8 .7 .6]", "", mirror },
    { "glass", "", "\"dielectric\"", "", glass },
    { "thin glass", "", "\"thindielectric\"", "", sheet },
    { "holes", MAP("float", "g.pfm", ""), "\"diffuse\"", "\"texture alpha\" \"t\"", holes },
    { "half", "", "\"diffuse\"", "\"float alpha\" .5", half },
    { "translucent", "",
      "\"diffusetransmission\" \"rgb reflectance\" [.2 .3 .4] \"rgb transmittance\" [.6 .5 .1]", "",
      translucent },
    { "bumps", MAP("float", "g.pfm", ""), "\"diffuse\" \"texture displacement\" \"t\"", "", bumps },
    { "sky", "LightSource \"infinite\" \"rgb L\" [.5 .6 .7]\n", "\"diffuse\"", "", sky },
    { "square sky", "LightSource \"infinite\" \"string filename\" \"s.pfm\"\n", "\"diffuse\"", "",
      square_sky },
    { "long sky",
      "AttributeBegin Transform [0 1 0 0 0 0 1 0 1 0 0 0 0 0 0 1] LightSource \"infinite\" \"string "
      "mapname\" "
      "\"p.pfm\" AttributeEnd\n",
      "\"diffuse\"", "", long_sky },
    { "spot",
      "LightSource \"spot\" \"rgb I\" [9 8 7] \"point3 from\" [0 1 0] \"point3 to\" [0 .5 3] \"float "
      "coneangle\" 35 "
      "\"float conedeltaangle\" 12\n",
      "\"diffuse\"", "", spot },
    { "luminaire",
      "LightSource \"luminaire\" \"string filename\" \"l.ies\" \"rgb I\" [.02 .03 .04] \"point3 from\" [.5 0 "
      "4.5]\n",
      "\"diffuse\"", "", luminaire },
    { "luminaire of so many lumens",
      "LightSource \"luminaire\" \"string filename\" \"l.ies\" \"rgb I\" [.02 .03 .04] \"point3 from\" [.5 0 "
      "4.5] "
      "\"float lumens\" 5000\n",
      "\"diffuse\"", "", bright_luminaire },
    { "mix", PARTS, "\"mix\" \"string materials\" [\"x\" \"y\"] \"float amount\" .3", "", mix },
    { "mix by a picture", MAP("float", "g.pfm", "") PARTS,
      "\"mix\" \"string materials\" [\"x\" \"y\"] \"texture amount\" \"t\"", "", mix_by_picture },
    { "emission by a picture",
      "AreaLightSource \"diffuse\" \"string filename\" \"p.pfm\" \"rgb L\" [2 3 4]\n", "\"diffuse\"", "",
      glowing_picture },
    { "projector",
      "AttributeBegin Translate .25 0 0 LightSource \"projection\" \"string filename\" \"p.pfm\" \"float "
      "fov\" 60 "
      "\"rgb I\" [9 8 7] AttributeEnd\n",
      "\"diffuse\"", "", projector },
};
#define N_LOOKS (sizeof looks / sizeof *looks)

static lc_status add_quad(lc_scene *s, lc_build_mesh_desc *q, uint32_t material, const float *at)
{
    q->n_vertices = 4;
    q->n_triangles = 2;
    q->positions = at;
    q->indices = faces;
    q->material = material;
    return lc_build_mesh(s, q);
}

static lc_status build(lc_context *c, add_fn *add, lc_scene **out)
{
    lc_build_material_desc plain = LC_BUILD_MATERIAL_DESC_INIT, m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_mesh_desc wall = LC_BUILD_MESH_DESC_INIT, behind = LC_BUILD_MESH_DESC_INIT;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    lc_build_camera_desc camera = LC_BUILD_CAMERA_DESC_INIT;
    lc_build_film_desc film = LC_BUILD_FILM_DESC_INIT;
    lc_load_desc load = LC_LOAD_DESC_INIT;
    uint32_t a, b;
    lc_scene *s;
    lc_status st = lc_build_begin(c, &s);
    *out = s;
    if (st) return st;
    film.width = film.height = 16;
    load.env_lights = 40;
    camera.from[0] = .5;
    set3(l.position, -.5f, 1, 0);
    set3(l.intensity, 4, 4, 4);
    st = lc_build_material(s, &plain, &a);
    if (!st) st = add_quad(s, &behind, a, behind_at);
    if (!st) st = lc_build_light(s, &l);
    if (!st) st = add(s, &m, &wall);
    if (!st) st = lc_build_material(s, &m, &b);
    if (!st) st = add_quad(s, &wall, wall.material ? wall.material : b, wall_at);
    if (!st) st = lc_build_camera(s, &camera);
    if (!st) st = lc_build_film(s, &film);
    return st ? st : lc_build_commit(s, &load);
}

static lc_scene *from_file(const look *k)
{
    lc_load_desc load = LC_LOAD_DESC_INIT;
    load.env_lights = 40;
    return scene_from_text(
        ctx, &load,
        "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16\nSampler \"independent\" "
        "\"integer pixelsamples\" 1\nIntegrator \"directlighting\"\nLookAt .5 0 0 0 0 1 0 1 0 Camera "
        "\"perspective\" \"float fov\" 90\nWorldBegin\nMaterial \"diffuse\"\n"
        "Shape \"trianglemesh\" \"point3 P\" [-5 -5 6 5 -5 6 5 5 6 -5 5 6] \"integer indices\" [0 1 2 0 2 "
        "3]\n"
        "LightSource \"point\" \"rgb I\" [4 4 4] \"point3 from\" [-.5 1 0]\n%sMaterial %s\n"
        "Shape \"trianglemesh\" \"point3 P\" [-2 -2 3 2 -2 3 2 2 3 -2 2 3] \"integer indices\" [0 1 2 0 2 3] "
        "\"point2 uv\" [0 0 1 0 1 1 0 1] %s\n",
        k->before, k->material, k->shape);
}

TEST(each_look_by_calls_has_the_bytes_of_its_file)
{
    const float four[] = { 1, 0, 0, 0, 1, 0, 0, 0, 1, .5f, .5f, 0 };
    float three[12];
    for (int i = 0; i < 12; i++) three[i] = grey[i / 3];
    pfm_write(temp_path("p.pfm"), 3, 2, picture);
    pfm_write(temp_path("g.pfm"), 2, 2, three);
    pfm_write(temp_path("s.pfm"), 2, 2, four);
    file_text(temp_path("l.ies"), IES);
    lc_image *before = NULL;
    for (size_t i = 0; i < N_LOOKS; i++) {
        lc_scene *s, *t = from_file(&looks[i]);
        CHECKF(!build(ctx, looks[i].add, &s), "%s: %s", looks[i].name, last_error);
        lc_image *a = rendered(ctx, s), *b = t ? rendered(ctx, t) : NULL;
        CHECKF(same_planes(a, b), "%s", looks[i].name);
        CHECKF(!same_planes(a, before), "%s is as the one before", looks[i].name);
        lc_image_destroy(before);
        before = a;
        lc_image_destroy(b);
        lc_scene_destroy(s);
        lc_scene_destroy(t);
    }
    lc_image_destroy(before);
}

/* A camera and a film, and the same in a file. */
typedef struct view {
    const char *name, *text;
    lc_build_camera_desc camera;
    lc_build_film_desc film;
} view;

#define FILM(more) "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16 " more "\n"
#define LOOK       "LookAt .5 0 0 0 0 1 0 1 0 "
#define CAMERA_OF(kind, fov, width, lens, focus, mirrored)                                                   \
    {                                                                                                        \
        sizeof(lc_build_camera_desc), { .5, 0, 0 }, { 0, 0, 1 }, { 0, 1, 0 }, fov, kind, width, lens, focus, \
            mirrored, LC_NO_MEDIUM, { 0 },                                                                   \
        {                                                                                                    \
            0                                                                                                \
        }                                                                                                    \
    }
#define PLAIN CAMERA_OF(LC_BUILD_PERSPECTIVE, 90, 2, 0, 1, 0)
#define FILM_OF(...)                                                                                         \
    {                                                                                                        \
        .size = sizeof(lc_build_film_desc), .width = 16, .height = 16, .spp = 4, .scale = 1, __VA_ARGS__     \
    }
static const view views[] = {
    { "orthographic", FILM("") LOOK "Camera \"orthographic\" \"float screenwindow\" [-1.5 1.5 -1.5 1.5]\n",
      CAMERA_OF(LC_BUILD_ORTHOGRAPHIC, 90, 3, 0, 1, 0), FILM_OF() },
    { "lens",
      FILM("") LOOK
      "Camera \"perspective\" \"float fov\" 50 \"float lensradius\" .2 \"float focaldistance\" 2\n",
      CAMERA_OF(LC_BUILD_PERSPECTIVE, 50, 2, .2, 2, 0), FILM_OF() },
    { "panorama", FILM("") LOOK "Camera \"spherical\" \"string mapping\" \"equirectangular\"\n",
      CAMERA_OF(LC_BUILD_PANORAMA, 90, 2, 0, 1, 0), FILM_OF() },
    { "equal area", FILM("") LOOK "Camera \"spherical\" \"string mapping\" \"equalarea\"\n",
      CAMERA_OF(LC_BUILD_EQUAL_AREA, 90, 2, 0, 1, 0), FILM_OF() },
    { "mirrored", FILM("") "Scale -1 1 1 " LOOK "Camera \"perspective\" \"float fov\" 60\n",
      CAMERA_OF(LC_BUILD_PERSPECTIVE, 60, 2, 0, 1, 1), FILM_OF() },
    { "crop", FILM("\"integer pixelbounds\" [2 9 3 15]") LOOK "Camera \"perspective\"\n", PLAIN,
      FILM_OF(.crop = { 2, 9, 3, 15 }) },
    { "gaussian", FILM("") LOOK "Camera \"perspective\"\nPixelFilter \"gaussian\"\n", PLAIN,
      FILM_OF(.filter = LC_BUILD_GAUSSIAN) },
    { "mitchell",
      FILM("") LOOK
      "Camera \"perspective\"\nPixelFilter \"mitchell\" \"float B\" .2 \"float C\" .4 \"float xradius\" 3\n",
      PLAIN, FILM_OF(.filter = LC_BUILD_MITCHELL, .radius = { 3, 0 }, .shape = { .2, .4 }) },
    { "sinc", FILM("") LOOK "Camera \"perspective\"\nPixelFilter \"sinc\"\n", PLAIN,
      FILM_OF(.filter = LC_BUILD_SINC) },
};

static lc_scene *view_by_calls(const view *v)
{
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_mesh_desc wall = LC_BUILD_MESH_DESC_INIT;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    lc_scene *s;
    uint32_t id;
    if (lc_build_begin(ctx, &s)) return NULL;
    wall.uv = uv;
    set3(l.position, -.5f, 1, 0);
    lc_status st = texture(s, picture, 3, 2, 3, &m.diffuse_texture);
    if (!st) st = lc_build_material(s, &m, &id);
    if (!st) st = add_quad(s, &wall, id, wall_at);
    if (!st) st = lc_build_light(s, &l);
    if (!st) st = lc_build_camera(s, &v->camera); /* before the film: the screen window follows it */
    if (!st) st = lc_build_film(s, &v->film);
    if (!st) st = lc_build_commit(s, NULL);
    CHECKF(!st, "%s: %s", v->name, last_error);
    return s;
}

TEST(each_camera_and_film_by_calls_has_the_bytes_of_its_file)
{
    char text[2000];
    uint64_t before = 0;
    pfm_write(temp_path("p.pfm"), 3, 2, picture);
    for (size_t i = 0; i < sizeof views / sizeof *views; i++) {
        snprintf(text, sizeof text,
                 "%sSampler \"independent\" \"integer pixelsamples\" 4\nIntegrator \"directlighting\"\n%s"
                 "WorldBegin\n" MAP("spectrum", "p.pfm",
                                    "") "Material \"diffuse\" \"texture reflectance\" \"t\"\n"
                                        "LightSource \"point\" \"rgb I\" [1 1 1] \"point3 from\" [-.5 1 0]\n"
                                        "Shape \"trianglemesh\" \"point3 P\" [-2 -2 3 2 -2 3 2 2 3 -2 2 3] "
                                        "\"integer indices\" [0 1 2 0 2 "
                                        "3] \"point2 uv\" [0 0 1 0 1 1 0 1]\n",
                 views[i].text, strstr(views[i].text, "PixelFilter") ? "" : "PixelFilter \"box\"\n");
        lc_scene *s = view_by_calls(&views[i]), *t = scene_from_text(ctx, NULL, "%s", text);
        lc_image *a = rendered(ctx, s), *b = t ? rendered(ctx, t) : NULL;
        lc_render_desc d = LC_RENDER_DESC_INIT;
        lc_identity id = { 0, 0 };
        CHECKF(same_planes(a, b), "%s", views[i].name);
        CHECKF(!lc_render_identity(ctx, s, &d, &id) && id.scene != before, "%s: identity", views[i].name);
        before = id.scene;
        lc_image_destroy(a);
        lc_image_destroy(b);
        lc_scene_destroy(s);
        lc_scene_destroy(t);
    }
}

TEST(wrong_textures_and_materials_are_named)
{
    lc_scene *s;
    uint32_t three, one, id;
    float bad[18];
    lc_build_texture_desc t = LC_BUILD_TEXTURE_DESC_INIT, t_used;
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT, m_used;
    CHECK(!lc_build_begin(ctx, &s));
    t.width = 3;
    t.height = 2;
    t.kind = LC_BUILD_FLOATS;
    t.texels = picture;
    memcpy(bad, picture, sizeof bad);
    bad[17] = NAN;
    WRONG(lc_build_texture(s, &t_used, &id), t, width = 0, "width");
    WRONG(lc_build_texture(s, &t_used, &id), t, height = 70000, "height");
    WRONG(lc_build_texture(s, &t_used, &id), t, n_channels = 2, "n_channels");
    WRONG(lc_build_texture(s, &t_used, &id), t, kind = (lc_build_texels)5, "kind");
    WRONG(lc_build_texture(s, &t_used, &id), t, texels = NULL, "texels");
    WRONG(lc_build_texture(s, &t_used, &id), t, texels = bad, "texels");
    WRONG(lc_build_texture(s, &t_used, &id), t, repeat[1] = 0, "repeat");
    WRONG(lc_build_texture(s, &t_used, &id), t, offset[0] = (double)NAN, "offset");
    WRONG(lc_build_texture(s, &t_used, &id), t, wrap = (lc_build_wrap)-1, "wrap");
    WRONG(lc_build_texture(s, &t_used, &id), t, filter = (lc_build_filter)9, "filter");
    WRONG(lc_build_texture(s, &t_used, &id), t, scale = -1, "scale");
    REFUSED(lc_build_texture(s, &t, NULL), "id");
    CHECK(!lc_build_texture(s, &t, &three) && !texture(s, grey, 2, 2, 1, &one) && three == 0 && one == 1);
    WRONG(lc_build_material(s, &m_used, &id), m, transmitted[2] = 2, "transmitted");
    WRONG(lc_build_material(s, &m_used, &id), m, gloss = 9, "gloss");
    WRONG(lc_build_material(s, &m_used, &id), m, fresnel = 9, "fresnel");
    WRONG(lc_build_material(s, &m_used, &id), m, specular = (lc_build_specular)4, "specular");
    WRONG(lc_build_material(s, &m_used, &id), m, coat_thickness = NAN, "coat_thickness");
    WRONG(lc_build_material(s, &m_used, &id), m, coat_thickness = -1, "coat_thickness");
    WRONG(lc_build_material(s, &m_used, &id), m, diffuse_texture = 2, "diffuse_texture");
    WRONG(lc_build_material(s, &m_used, &id), m, bump_texture = three, "bump_texture");
    WRONG(lc_build_material(s, &m_used, &id), m, roughness_texture = three, "roughness_texture");
    WRONG(lc_build_material(s, &m_used, &id), m, normal_texture = 7, "normal_texture");
    m.gloss = LC_GLOSS_GGX;
    WRONG(lc_build_material(s, &m_used, &id), m, roughness[1] = 0, "roughness");
    m.fresnel = LC_REFLECT_CONDUCTOR;
    WRONG(lc_build_material(s, &m_used, &id), m, k[1] = -1, "eta and k");
    m.specular = LC_BUILD_GLASS;
    WRONG(lc_build_material(s, &m_used, &id), m, eta[0] = .001f, "eta");
    m.specular = LC_BUILD_MIRROR;
    WRONG(lc_build_material(s, &m_used, &id), m, eta[2] = NAN, "eta");
    CHECK(!lc_build_material(s, &m, &id) && id == 0);
    lc_build_mesh_desc q = LC_BUILD_MESH_DESC_INIT, q_used;
    float far_uv[8] = { 0, INFINITY };
    q.n_vertices = 4;
    q.positions = wall_at;
    WRONG(lc_build_mesh(s, &q_used), q, alpha = 1.5f, "alpha");
    WRONG(lc_build_mesh(s, &q_used), q, alpha_texture = three, "alpha_texture");
    WRONG(lc_build_mesh(s, &q_used), q, uv = far_uv, "uv");
    lc_scene_destroy(s);
}

TEST(wrong_lights_and_environments_are_named)
{
    lc_scene *s;
    uint32_t id;
    lc_build_environment_desc e = LC_BUILD_ENVIRONMENT_DESC_INIT, e_used;
    lc_build_luminaire_desc d = LC_BUILD_LUMINAIRE_DESC_INIT, d_used;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT, l_used;
    CHECK(!lc_build_begin(ctx, &s));
    e.width = 3;
    e.height = 2;
    e.texels = picture;
    WRONG(lc_build_environment(s, &e_used), e, width = 0, "width");
    WRONG(lc_build_environment(s, &e_used), e, equal_area = 1, "equal_area");
    WRONG(lc_build_environment(s, &e_used), e, scale[1] = -1, "scale");
    WRONG(lc_build_environment(s, &e_used), e, scale[1] = 1e14f, "scale");
    WRONG(lc_build_environment(s, &e_used), e, to_world[5] = 0, "to_world");
    d.text = IES;
    d.length = sizeof IES - 1;
    WRONG(lc_build_luminaire(s, &d_used, &id), d, text = NULL, "text");
    WRONG(lc_build_luminaire(s, &d_used, &id), d, length = 60, "lc_build_luminaire:");
    WRONG(lc_build_luminaire(s, &d_used, &id), d, length = (uint64_t)1 << 40, "length");
    WRONG(lc_build_luminaire(s, &d_used, &id), d, eulumdat = 1, "lc_build_luminaire:");
    REFUSED(lc_build_luminaire(s, &d, NULL), "id");
    l.kind = LC_BUILD_LUMINAIRE;
    REFUSED(lc_build_light(s, &l), "luminaire");
    CHECK(!lc_build_luminaire(s, &d, &id) && id == 0);
    WRONG(lc_build_light(s, &l_used), l, across[0] = 0, "across");
    WRONG(lc_build_light(s, &l_used), l, across[2] = 1e9, "across");
    WRONG(lc_build_light(s, &l_used), l, lumens = -1, "lumens");
    l.kind = LC_BUILD_SPOT;
    WRONG(lc_build_light(s, &l_used), l, cone = 0, "cone");
    WRONG(lc_build_light(s, &l_used), l, delta = 31, "delta");
    WRONG(lc_build_light(s, &l_used), l, direction[2] = 0, "direction");
    l.kind = LC_BUILD_PROJECTOR;
    REFUSED(lc_build_light(s, &l), "picture");
    CHECK(!texture(s, picture, 3, 2, 3, &l.picture));
    WRONG(lc_build_light(s, &l_used), l, fov = 180, "fov");
    WRONG(lc_build_light(s, &l_used), l, across[0] = 0, "across");
    CHECK(!lc_build_light(s, &l));
    lc_scene_destroy(s);
}

TEST(wrong_mixes_cameras_and_films_are_named)
{
    lc_scene *s;
    uint32_t id, one;
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_mix_desc d = LC_BUILD_MIX_DESC_INIT, d_used;
    lc_build_camera_desc c = LC_BUILD_CAMERA_DESC_INIT, c_used;
    lc_build_film_desc f = LC_BUILD_FILM_DESC_INIT, f_used;
    lc_build_mesh_desc q = LC_BUILD_MESH_DESC_INIT, q_used;
    CHECK(!lc_build_begin(ctx, &s) && !texture(s, grey, 2, 2, 1, &one));
    REFUSED(lc_build_mix(s, &d, &id), "materials");
    CHECK(!lc_build_material(s, &m, &id));
    WRONG(lc_build_mix(s, &d_used, &id), d, share[2] = 2, "share");
    WRONG(lc_build_mix(s, &d_used, &id), d, share_texture = 7, "share_texture");
    WRONG(lc_build_mix(s, &d_used, NULL), d, share[0] = 0, "id");
    for (int i = 0; i < 16; i++) CHECK(!lc_build_mix(s, &d, &d.materials[0]));
    REFUSED(lc_build_mix(s, &d, &id), "16 deep");
    WRONG(lc_build_camera(s, &c_used), c, kind = (lc_build_camera_kind)4, "kind");
    c.kind = LC_BUILD_ORTHOGRAPHIC;
    WRONG(lc_build_camera(s, &c_used), c, width = 0, "width");
    WRONG(lc_build_camera(s, &c_used), c, lens_radius = -1, "lens_radius");
    WRONG(lc_build_camera(s, &c_used), c, focal_distance = NAN, "focal_distance");
    WRONG(lc_build_film(s, &f_used), f, filter = (lc_build_pixel_filter)5, "filter");
    WRONG(lc_build_film(s, &f_used), f, radius[1] = 100, "film");
    WRONG(lc_build_film(s, &f_used), f, radius[0] = (double)NAN, "film");
    WRONG(lc_build_film(s, &f_used), f, shape[1] = (double)NAN, "film");
    WRONG(lc_build_film(s, &f_used), f, crop[1] = 5000, "film");
    q.n_vertices = 4;
    q.positions = wall_at;
    WRONG(lc_build_mesh(s, &q_used), q, emission_texture = one, "emission_texture");
    WRONG(lc_build_mesh(s, &q_used), q, emission_texture = 9, "emission_texture");
    lc_scene_destroy(s);
}

static size_t starved;

/* Without the commit, which unit_build and unit_env starve. */
static lc_status build_starved(lc_context *c)
{
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_mesh_desc wall = LC_BUILD_MESH_DESC_INIT;
    uint32_t id = 0;
    lc_scene *s;
    lc_status st = lc_build_begin(c, &s);
    if (!st) st = looks[starved].add(s, &m, &wall);
    if (!st) st = lc_build_material(s, &m, &id);
    if (!st) st = add_quad(s, &wall, id, wall_at);
    lc_scene_destroy(s);
    return st;
}

TEST(every_allocation_may_fail)
{
    for (starved = 0; starved < N_LOOKS; starved++) starve(build_starved, 5);
}

int main(void)
{
    temp_begin();
    ctx = quiet_context_of(2, LC_ISA_BEST);
    RUN(each_look_by_calls_has_the_bytes_of_its_file);
    RUN(each_camera_and_film_by_calls_has_the_bytes_of_its_file);
    RUN(wrong_textures_and_materials_are_named);
    RUN(wrong_mixes_cameras_and_films_are_named);
    RUN(wrong_lights_and_environments_are_named);
    RUN(every_allocation_may_fail);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
