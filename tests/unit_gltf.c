/* unit_gltf.c - glTF scenes: what is made of meshes, nodes, materials, lights and cameras; the same scene in
 * pbrt's format gives the same picture; what is wrong is named with its place. */
#include "gltf/gltf.h"
#include "api/format.h"
#include "base/rng.h"
#include "io/base64.h"
#include "isa/isa.h"
#include "shade/point_init.h"
#include "support/jpeg_file.h"
#include "support/near.h"
#include "support/one_bound.h"
#include "support/one_scene.h"
#include "support/pictures.h"
#include "support/watched_memory.h"

/* ---- texts: ' stands for " ---- */

static char text[1 << 16];
static size_t text_len;

LC_PRINTF(1, 2)
static void put(const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    size_t from = text_len;
    text_len += (size_t)vsnprintf(text + text_len, sizeof text - text_len, fmt, args);
    va_end(args);
    if (text_len >= sizeof text) abort();
    for (; text[from]; from++)
        if (text[from] == '\'') text[from] = '"';
}

static void put_base64(const void *data, size_t n)
{
    char *digits;
    size_t len;
    FILE *f = open_memstream(&digits, &len);
    lc_base64_write(f, data, n);
    fclose(f);
    put("%s", digits);
    free(digits);
}

static lc_status parse(const void *data, size_t n)
{
    char *copy = malloc(n ? n : 1);
    memcpy(copy, data, n);
    scene_begin();
    lc_status st = lc_gltf_parse_memory(scene, "s.gltf", copy, n);
    free(copy);
    return st;
}

static lc_status parse_put(void) { return parse(text, text_len); }

LC_PRINTF(1, 2)
static lc_status parse_json(const char *fmt, ...)
{
    char json[8192];
    va_list args;
    va_start(args, fmt);
    vsnprintf(json, sizeof json, fmt, args);
    va_end(args);
    text_len = 0;
    put("%s", json);
    return parse_put();
}

#define ASSET "{'asset':{'version':'2.0'}"

/* A quad in z = 0 from (0,0) to (2,1), with normals and coordinates, as buffer 0: 4 positions at 0, 4 normals
 * at 48, 4 uv at 96, 6 indices of 16 bits at 128. Its accessors have these numbers, too. */
static void put_quad(void)
{
    static const float v[] = { 0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0, 0, 0, 1, 0,
                               0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 1, 1, 1, 0, 0, 0 };
    static const uint16_t index[] = { 0, 1, 2, 0, 2, 3 };
    uint8_t bytes[140];
    memcpy(bytes, v, 128);
    memcpy(bytes + 128, index, 12);
    put(",'buffers':[{'byteLength':140,'uri':'data:application/octet-stream;base64,");
    put_base64(bytes, sizeof bytes);
    put("'}],'bufferViews':[{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,'byteLength':48},"
        "{'buffer':0,'byteOffset':96,'byteLength':32},{'buffer':0,'byteOffset':128,'byteLength':12}],"
        "'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},"
        "{'bufferView':1,'componentType':5126,'count':4,'type':'VEC3'},"
        "{'bufferView':2,'componentType':5126,'count':4,'type':'VEC2'},"
        "{'bufferView':3,'componentType':5123,'count':6,'type':'SCALAR'}]");
}

/* The quad as mesh 0, with what else is in the file. */
LC_PRINTF(1, 2)
static lc_status parse_quad(const char *fmt, ...)
{
    char more[8192];
    va_list args;
    va_start(args, fmt);
    vsnprintf(more, sizeof more, fmt, args);
    va_end(args);
    text_len = 0;
    put(ASSET);
    put_quad();
    put("%s}", more);
    return parse_put();
}

#define QUAD_MESH                                                                                            \
    ",'meshes':[{'primitives':[{'attributes':{'POSITION':0,'NORMAL':1,'TEXCOORD_0':2},'indices':3,'"         \
    "material':0}]}]"
#define QUAD_NODE QUAD_MESH ",'nodes':[{'mesh':0}]"

static bool vertex_is(size_t i, double x, double y, double z)
{
    return i < scene->n_verts && near_abs((double)scene->pos[3 * i], x, 1e-6) &&
           near_abs((double)scene->pos[3 * i + 1], y, 1e-6) &&
           near_abs((double)scene->pos[3 * i + 2], z, 1e-6);
}

/* ---- geometry ---- */

TEST(nodes_move_their_meshes_and_what_is_below_them)
{
    CHECK(!parse_quad(
        QUAD_MESH ",'materials':[{}],'nodes':[{'children':[1],'translation':[10,0,0],'rotation':[0,0,2,2]},"
                  "{'mesh':0,'scale':[1,3,1]}],'scenes':[{},{'nodes':[0]}],'scene':1"));
    /* a quarter turn about z: (x, y) to (-y, x) */
    CHECK(scene->n_tris == 2 && scene->n_verts == 4 && vertex_is(1, 10, 2, 0) && vertex_is(2, 7, 2, 0));
    CHECK(!scene->meshes[0].flip && scene->normal[2] > 0 && fabsf(scene->normal[0]) < 1e-6f);
    CHECK(note("scenes") && note("camera") && scene->has_camera);
    CHECK(!parse_quad(QUAD_MESH
                      ",'materials':[{}],'nodes':[{'mesh':0,'matrix':[1,0,0,0,0,1,0,0,0,0,-1,0,0,0,5,1]}]"));
    CHECK(scene->meshes[0].flip && vertex_is(2, 2, 1, 5) && near_abs((double)scene->normal[2], -1, 1e-6));
}

TEST(triangles_strips_and_fans)
{
    static const struct {
        int mode;
        uint32_t want[6];
    } cases[] = { { 4, { 0, 1, 2, 0, 2, 3 } }, { 5, { 0, 1, 2, 1, 3, 2 } }, { 6, { 1, 2, 0, 2, 3, 0 } } };
    for (size_t i = 0; i < 3; i++) {
        CHECK(!parse_quad(
            ",'meshes':[{'primitives':[{'attributes':{'POSITION':0},'mode':%d%s}]}],'nodes':[{'mesh':0}]",
            cases[i].mode, cases[i].mode == 4 ? ",'indices':3" : ""));
        CHECK(scene->n_tris == 2 && !memcmp(scene->index, cases[i].want, sizeof cases[i].want));
    }
    CHECK(!parse_quad(
        ",'meshes':[{'primitives':[{'attributes':{'POSITION':0},'mode':1}]}],'nodes':[{'mesh':0}]"));
    CHECK(!scene->n_tris && note("points and lines"));
    CHECK(
        parse_quad(
            ",'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':4}]}],'nodes':[{'mesh':0}]") ==
        LC_ERR_PARSE);
    CHECK(strstr(last_error, "4 is none of 4 accessors"));
}

TEST(sparse_and_normalized_accessors)
{
    CHECK(!parse_json(
        ASSET ",'nodes':[{'mesh':0}],'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}],"
              "'buffers':[{'byteLength':16,'uri':'data:;base64,AgAAAAAAgD8AAABAAABAQA=='}]," /* 2; 1 2 3 */
              "'bufferViews':[{'buffer':0,'byteLength':4},{'buffer':0,'byteOffset':4,'byteLength':12}],"
              "'accessors':[{'componentType':5126,'count':3,'type':'VEC3','sparse':{'count':1,"
              "'indices':{'bufferView':0,'componentType':5125},'values':{'bufferView':1}}}]}"));
    CHECK(scene->n_verts == 3 && vertex_is(0, 0, 0, 0) && vertex_is(2, 1, 2, 3));
    /* 127 -127 -128, 0 64 1, 0 0 0 as bytes four apart */
    CHECK(!parse_json(
        ASSET
        ",'nodes':[{'mesh':0}],'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}],"
        "'buffers':[{'byteLength':11,'uri':'data:;base64,f4GAAABAAQAAAAA='}],"
        "'bufferViews':[{'buffer':0,'byteLength':11,'byteStride':4}],"
        "'accessors':[{'bufferView':0,'componentType':5120,'normalized':true,'count':3,'type':'VEC3'}]}"));
    CHECK(scene->n_verts == 3 && vertex_is(0, 1, -1, -1) && vertex_is(1, 0, 64 / 127., 1 / 127.));
}

TEST(large_meshes_of_several_nodes_are_shared)
{
    static float strip[1000][3];
    text_len = 0;
    for (int i = 0; i < 1000; i++) strip[i][0] = (float)(i / 2), strip[i][1] = (float)(i % 2);
    put(ASSET ",'buffers':[{'byteLength':12000,'uri':'data:;base64,");
    put_base64(strip, sizeof strip);
    put("'}],'bufferViews':[{'buffer':0,'byteLength':12000}],'accessors':[{'bufferView':0,'componentType':"
        "5126,'count':1000,"
        "'type':'VEC3'}],'meshes':[{'primitives':[{'attributes':{'POSITION':0},'mode':5}]}],"
        "'nodes':[{'mesh':0},{'mesh':0,'translation':[0,5,0]},{'mesh':0,'scale':[1,0,1]}]}");
    CHECK(!parse_put());
    /* the third has no inverse and is copied */
    CHECK(scene->n_objects == 1 && scene->n_instances == 2 && scene->n_tris == 2 * 998);
    CHECK(scene->instances[1].to_world[7] > 4.9);
}

/* ---- materials ---- */

static const lc_material *material(const char *json)
{
    lc_status st = parse_quad(QUAD_NODE ",'materials':[%s]", json);
    CHECKF(!st, "%s: %s", json, last_error);
    return st ? NULL : &scene->materials[scene->meshes[0].material_id];
}

TEST(materials_are_lambert_and_ggx)
{
    const lc_material *m = material("{'pbrMetallicRoughness':{'baseColorFactor':[0.5,0.25,1,1],'"
                                    "metallicFactor':0,'roughnessFactor':0.5}}");
    CHECK(near_abs((double)m->kd.x, 0.5 * 0.96, 1e-6) && near_abs((double)m->kd.y, 0.25 * 0.96, 1e-6));
    CHECK(m->lobe == LC_LOBE_GGX && m->fresnel == LC_FRESNEL_DIELECTRIC && m->eta.x == 1.5f && m->ks.x == 1);
    CHECK(m->roughness[0] == 0.25f && m->roughness[1] == 0.25f);
    m = material("{'pbrMetallicRoughness':{'baseColorFactor':[0.5,0.25,1,1],'roughnessFactor':0.1}}");
    CHECK(m->fresnel == LC_FRESNEL_SCHLICK && m->kd.x == 0 && m->ks.x == 0.5f && m->ks.z == 1 && !m->mirror);
    m = material("{'pbrMetallicRoughness':{'metallicFactor':0.25,'baseColorFactor':[0.8,0.8,0.8,1]}}");
    CHECK(near_abs((double)m->kd.x, 0.75 * 0.96 * 0.8, 1e-6) &&
          near_abs((double)m->ks.x, 0.75 * 0.04 + 0.25 * 0.8, 1e-6));
    m = material("{'pbrMetallicRoughness':{'roughnessFactor':0}}");
    CHECK(m->mirror && m->ks.x == 1);
    m = material("{'pbrMetallicRoughness':{'metallicFactor':0},'extensions':{'KHR_materials_specular':{'"
                 "specularFactor':0}}}");
    CHECK(m->kd.x == 1 && !(m->ks.x > 0));
    m = material("{'pbrMetallicRoughness':{'metallicFactor':0},'extensions':{'KHR_materials_specular':{'"
                 "specularFactor':0.5,"
                 "'specularColorFactor':[1,0.5,0]},'KHR_materials_ior':{'ior':2}}}");
    CHECK(m->eta.x == 2 && m->ks.x == 0.5f && m->ks.y == 0.25f && !(m->ks.z > 0) &&
          near_abs((double)m->kd.x, 1 - 0.5 / 9, 1e-6));
    m = material("{'pbrMetallicRoughness':{'metallicFactor':0,'baseColorFactor':[0.2,0.4,0.6,1]},"
                 "'extensions':{'KHR_materials_transmission':{'transmissionFactor':1},'KHR_materials_volume':"
                 "{'thicknessFactor':1}}}");
    CHECK(m->glass && !m->thin && m->kt.y == 0.4f);
    m = material("{'pbrMetallicRoughness':{'metallicFactor':0},'extensions':{'KHR_materials_transmission':{'"
                 "transmissionFactor':0.25}}}");
    const lc_material_maps *maps = &scene->maps[scene->meshes[0].material_id];
    CHECK(maps->mix[0] != LC_NONE && maps->share.x == 0.25f && scene->materials[maps->mix[1]].thin);
    material("{'emissiveFactor':[1,0.5,0],'doubleSided':true,'extensions':{'KHR_materials_emissive_strength':"
             "{'emissiveStrength':20}}}");
    CHECK(scene->meshes[0].emission.x == 20 && scene->meshes[0].emission.y == 10 &&
          scene->meshes[0].two_sided);
    material("{'alphaMode':'BLEND','pbrMetallicRoughness':{'baseColorFactor':[1,1,1,0.25]}}");
    CHECK(scene->n_alphas == 1 && scene->alphas[0].alpha.value[0] == 0.25);
    material("{'alphaMode':'MASK','pbrMetallicRoughness':{'baseColorFactor':[1,1,1,0.25]}}");
    CHECK(scene->n_alphas == 1 && !(scene->alphas[0].alpha.value[0] > 0));
    material("{'pbrMetallicRoughness':{'baseColorFactor':[1,1,1,0.25]}}");
    CHECK(!scene->n_alphas);
}

/* 8 x 8 pixels: code 128 + 8 u on the left, as JPEG. */
static void put_jpeg(int level)
{
    static jpeg_plan plan;
    static jpeg_file file;
    plan = (jpeg_plan){ .width = 8, .height = 8, .n_parts = 1, .h = { 1 }, .v = { 1 } };
    for (int i = 0; i < 64; i++) plan.quant[i] = 8;
    plan.coefs[0][0][0] = level;
    jpeg_write(&file, &plan);
    put("data:image/jpeg;base64,");
    put_base64(file.data, file.n);
}

TEST(textures_are_images_times_factors)
{
    text_len = 0;
    put(ASSET);
    put_quad();
    put(QUAD_NODE ",'materials':[{'pbrMetallicRoughness':{'metallicFactor':0,'baseColorFactor':[1,0.5,1,1],'"
                  "baseColorTexture':"
                  "{'index':0,'extensions':{'KHR_texture_transform':{'offset':[0.5,0.25],'scale':[2,4]}}},"
                  "'roughnessFactor':0.5,'metallicRoughnessTexture':{'index':1}},"
                  "'extensions':{'KHR_materials_specular':{'specularFactor':1}}}],"
                  "'textures':[{'source':0},{'source':0,'sampler':0}],'samplers':[{'magFilter':9728,'wrapS':"
                  "33071,'wrapT':33071}],"
                  "'images':[{'uri':'");
    put_jpeg(60);
    put("'}]}");
    CHECKF(!parse_put(), "%s", last_error);
    const lc_material_maps *maps = &scene->maps[scene->meshes[0].material_id];
    const lc_tex_point p = { .uv = { 0.3, 0.3 } };
    double kd[3] = { 0 }, rough[3] = { 0 }, linear = pow((188 / 255. + 0.055) / 1.055, 2.4);
    CHECK(maps->kd != LC_NONE && maps->roughness[0] != LC_NONE && maps->ks == LC_NONE &&
          scene->textures.n_images == 2);
    lc_texture_eval(&scene->textures, maps->kd, &p, kd);
    lc_texture_eval(&scene->textures, maps->roughness[0], &p, rough);
    CHECK(near_abs(kd[0], linear * 0.96, 1e-6) && near_abs(kd[1], linear * 0.48, 1e-6));
    CHECK(near_abs(rough[0], pow(0.5 * 188 / 255, 2), 1e-6));
    /* uv of the second vertex is (1, 1): after the transform (2.5, 4.25), and v upwards */
    CHECK(near_abs((double)scene->uv[2], 2.5, 1e-6) && near_abs((double)scene->uv[3], 1 - 4.25, 1e-6));
    CHECK(note("texture coordinates"));
}

/* ---- lights and cameras ---- */

#define LIGHT(light)                                                                                         \
    ASSET ",'extensions':{'KHR_lights_punctual':{'lights':[" light                                           \
          "]}},'nodes':[{'rotation':[1,0,0,1],'translation':[1,2,3],"                                        \
          "'extensions':{'KHR_lights_punctual':{'light':0}}}]}"

TEST(lights_are_of_candela_and_lux_along_minus_z)
{
    CHECK(!parse_json(LIGHT("{'type':'point','intensity':7,'color':[1,0.5,0]}")));
    const lc_light *l = scene->lights;
    CHECK(scene->n_lights == 1 && l->kind == LC_LIGHT_POINT && l->intensity.x == 7 &&
          l->intensity.y == 3.5f && l->pos.z == 3);
    CHECK(l->atten[0] == 0 && l->atten[2] == 1);
    CHECK(!parse_json(LIGHT("{'type':'directional','intensity':3}")));
    l = scene->lights; /* a quarter turn about x takes -z to y */
    CHECK(scene->n_lights == 1 && l->kind == LC_LIGHT_DIRECTIONAL && l->intensity.x == 3 &&
          near_abs((double)l->dir.y, 1, 1e-6));
    CHECK(!parse_json(LIGHT("{'type':'laser'}")) && !scene->n_lights && note("light type") &&
          note("no lights"));
    CHECK(!parse_json(LIGHT("{'type':'point','range':2}")) && note("light range") && scene->n_lights == 1);
    CHECK(!parse_json(LIGHT("{'type':'spot','spot':{'innerConeAngle':0.9,'outerConeAngle':0.5}}")) &&
          note("spot angles"));
}

/* Radiant intensity in direction w: pi times the estimate for a white diffuser that faces the light at
 * distance 1. */
static double shine(const lc_light *l, double angle)
{
    const lc_material white = { .kd = { 1, 1, 1 } };
    lc_light_rec rec;
    lc_spot_rec spot;
    lc_point p;
    lc_f3 w = lc_f3_normalize_d(0, cos(angle), sin(angle)); /* the axis is y */
    lc_light_rec_init(&rec, l);
    lc_spot_rec_init(&spot, l->spot.cos_total, l->spot.cos_start, l->spot.map);
    lc_point_init(&p, lc_f3_add(l->pos, w), lc_f3_neg(w), lc_f3_neg(w), &white, 1e-10f);
    return (double)(one_spot_transfer(&p, &rec, &spot, scene->spot_maps).x * l->intensity.x) * LC_PI;
}

TEST(spots_fall_off_by_the_formula_of_the_extension)
{
    CHECK(!parse_json(
        LIGHT("{'type':'spot','intensity':5,'spot':{'innerConeAngle':0.2,'outerConeAngle':0.7}}")));
    const lc_light *l = scene->lights;
    CHECK(scene->n_lights == 1 && l->kind == LC_LIGHT_SPOT);
    for (int i = 0; i < 100; i++) {
        double angle = i * 0.01, s = 1 / (cos(0.2) - cos(0.7)),
               t = fmin(fmax((cos(angle) - cos(0.7)) * s, 0), 1);
        CHECKF(near_abs(shine(l, angle), 5 * t * t, 5e-5), "%g: %g, not %g", angle, shine(l, angle),
               5 * t * t);
    }
}

/* What the bound of a spot's profile needs: a ramp's colour is in 0..1, also for directions of any length. */
TEST(a_ramp_never_brightens)
{
    for (uint64_t i = 0; i < 100000; i++) {
        float to[3], rgb[3], length = (float)pow(10, 40 * lc_unit(lc_hash2(i, 9)) - 20);
        lc_light light = { .kind = LC_LIGHT_SPOT, .dir = { 0.6f, 0, 0.8f } };
        lc_spot_map ramp;
        light.spot.cos_total = (float)(2 * lc_unit(lc_hash2(i, 7)) - 1);
        light.spot.cos_start = i % 5 ? fminf(light.spot.cos_total + (float)lc_unit(lc_hash2(i, 8)), 1)
                                     : light.spot.cos_total;
        lc_spot_ramp(&light, &ramp);
        for (uint64_t k = 0; k < 3; k++)
            to[k] = (float)(2 * lc_unit(lc_hash2(i, k)) - 1) * (i % 50 ? length : 0);
        lc_spot_colour(&ramp, to, rgb);
        CHECK(rgb[0] >= 1.0f / 3 - 1e-6f && rgb[0] <= 1 && rgb[1] == rgb[0] && rgb[2] == rgb[0]);
    }
}

TEST(cameras_look_along_minus_z_and_set_the_height)
{
    CHECK(!parse_json(
        ASSET ",'cameras':[{'type':'perspective','perspective':{'yfov':1.2,'aspectRatio':2,'znear':1}}],"
              "'nodes':[{'camera':0,'translation':[1,2,3],'scale':[9,9,9]},{'camera':0}]}"));
    CHECK(scene->film.width == 800 && scene->film.height == 400 && note("cameras") && !note("camera"));
    const double *m = scene->camera_desc.world_to_camera;
    const double p[3] = { 2, 4, -4 }; /* in the camera's space (1, 2, 7) */
    for (int k = 0; k < 3; k++)
        CHECK(near_abs(m[4 * k] * p[0] + m[4 * k + 1] * p[1] + m[4 * k + 2] * p[2] + m[4 * k + 3],
                       k == 2 ? 7 : k + 1, 1e-9));
    lc_camera camera;
    double px, py;
    CHECK(lc_camera_init(&camera, &scene->camera_desc, 800, 400));
    /* the picture's upper edge is at yfov / 2 */
    CHECK(lc_camera_project(&camera, lc_f3_make(0, (float)tan(0.6), -1), &px, &py) &&
          near_abs(px, 400, 1e-3) && near_abs(py, 0, 1e-3));
    CHECK(lc_camera_project(&camera, lc_f3_make(0.1f, 0, -1), &px, &py) && px > 401);
    CHECK(!parse_json(
        ASSET ",'cameras':[{'type':'orthographic','orthographic':{'xmag':3,'ymag':6,'znear':0,'zfar':1}}],"
              "'nodes':[{'camera':0}]}"));
    CHECK(scene->film.height == 1600 && scene->camera_desc.kind == LC_CAMERA_ORTHOGRAPHIC &&
          scene->camera_desc.screen[3] == 6);
}

/* ---- the pair ---- */

static lc_image *picture(const char *path)
{
    lc_load_desc load = LC_LOAD_DESC_INIT;
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    load.indirect_lights = LC_NO_LIGHTS;
    lc_scene *s = scene_from_file(ctx, &load, path);
    d.spp = 1;
    CHECK(s && lc_render(ctx, s, &d, &image, NULL) == LC_OK);
    lc_scene_destroy(s);
    return image;
}

static void write_text(const char *name) { file_write(temp_path(name), text, text_len); }

TEST(the_same_scene_in_both_formats_gives_the_same_picture)
{
    static jpeg_plan plan = {
        .width = 16, .height = 8, .n_parts = 3, .h = { 2, 1, 1 }, .v = { 1, 1, 1 }, .jfif = true
    };
    static jpeg_file jpeg;
    for (int i = 0; i < 64; i++) plan.quant[i] = 4;
    for (int i = 0; i < 3; i++)
        for (int b = 0; b < 2; b++)
            plan.coefs[i][b][0] = 90 - 60 * i, plan.coefs[i][b][1] = 50,
            plan.coefs[i][b][8] = 30 * i + 40 * b;
    jpeg_write(&jpeg, &plan);
    file_write(temp_path("t.jpg"), jpeg.data, jpeg.n);
    text_len = 0;
    put(ASSET);
    put_quad();
    put(",'meshes':[{'primitives':[{'attributes':{'POSITION':0,'TEXCOORD_0':2},'indices':3,'material':0}]},"
        "{'primitives':[{'attributes':{'POSITION':0},'indices':3,'material':1}]}],"
        "'materials':[{'pbrMetallicRoughness':{'metallicFactor':0,'baseColorTexture':{'index':0}},"
        "'extensions':{'KHR_materials_specular':{'specularFactor':0}}},"
        "{'pbrMetallicRoughness':{'metallicFactor':0,'baseColorFactor':[0.5,0.5,0.5,1]},'emissiveFactor':[1,"
        "0.5,0.25],"
        "'extensions':{'KHR_materials_specular':{'specularFactor':0},'KHR_materials_emissive_strength':{'"
        "emissiveStrength':8}}}],"
        "'textures':[{'source':0}],'images':[{'uri':'t.jpg'}],"
        "'cameras':[{'type':'perspective','perspective':{'yfov':0.8726646259971648,'aspectRatio':2,'znear':1}"
        "}],"
        "'extensions':{'KHR_lights_punctual':{'lights':[{'type':'point','intensity':3},{'type':'directional',"
        "'intensity':0.5}]}},"
        "'nodes':[{'mesh':0},{'mesh':1,'translation':[0,1,1],'rotation':[1,0,0,0],'scale':[1,0.5,1]},{'"
        "camera':0,'translation':[1,0.75,3]},"
        "{'translation':[0.5,0.5,1],'extensions':{'KHR_lights_punctual':{'light':0}}},{'extensions':{'KHR_"
        "lights_punctual':{'light':1}}}]}");
    write_text("pair.gltf");
    text_len = 0;
    put("Scale -1 1 1 LookAt 1 .75 3 1 .75 2 0 1 0 Camera 'perspective' 'float fov' 50\n"
        "Film 'rgb' 'integer xresolution' 800 'integer yresolution' 400 Integrator 'path' WorldBegin\n"
        "Texture 't' 'spectrum' 'imagemap' 'string filename' 't.jpg'\n"
        "Material 'diffuse' 'texture reflectance' 't'\n"
        "Shape 'trianglemesh' 'point3 P' [0 0 0 2 0 0 2 1 0 0 1 0] 'point2 uv' [0 0 1 0 1 1 0 1] 'integer "
        "indices' [0 1 2 0 2 3]\n"
        "AttributeBegin Material 'diffuse' 'rgb reflectance' [.5 .5 .5] AreaLightSource 'diffuse' 'rgb L' [8 "
        "4 2]\n"
        "Shape 'trianglemesh' 'point3 P' [0 1 1 2 1 1 2 .5 1 0 .5 1] 'integer indices' [0 1 2 0 2 3] "
        "AttributeEnd\n"
        "LightSource 'point' 'rgb I' [3 3 3] 'point3 from' [.5 .5 1]\n"
        "LightSource 'distant' 'rgb L' [.5 .5 .5] 'point3 from' [0 0 1] 'point3 to' [0 0 0]\n");
    write_text("pair.pbrt");
    lc_image *a = picture(temp_path("pair.gltf")), *b = picture(temp_path("pair.pbrt"));
    double worst = 0, sum = 0;
    for (uint32_t y = 0; y < 400; y++)
        for (uint32_t x = 0; x < 800; x++)
            for (int c = 0; c < 3; c++) {
                static const char *const names[] = { "R", "G", "B" };
                double v = pixel_at(a, names[c], x, y), w = pixel_at(b, names[c], x, y);
                worst = fmax(worst, fabs(v - w) / fmax(fmax(v, w), 1e-3));
                sum += v;
            }
    CHECKF(sum > 1e4 && worst < 1e-4, "the pictures differ by %g of a pixel, sum %g", worst, sum);
    lc_image_destroy(a);
    lc_image_destroy(b);
}

/* ---- chunks and files ---- */

static void put_u32(uint8_t *to, size_t at, uint32_t v)
{
    for (int i = 0; i < 4; i++) to[at + (size_t)i] = (uint8_t)(v >> 8 * i);
}

/* A .glb: the triangle (0,0,0) (1,0,0) (0,1,0), and a chunk of no known kind. */
static size_t make_glb(uint8_t *to)
{
    static const float v[9] = { 0, 0, 0, 1, 0, 0, 0, 1, 0 };
    text_len = 0;
    put(ASSET ",'nodes':[{'mesh':0}],'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}],'buffers':[{'"
              "byteLength':36}],"
              "'bufferViews':[{'buffer':0,'byteLength':36}],'accessors':[{'bufferView':0,'componentType':"
              "5126,'count':3,'type':'VEC3'}]}");
    while (text_len % 4) put(" ");
    size_t n = 20 + text_len + 8 + 36 + 8 + 4;
    memset(to, 0, n);
    memcpy(to, "glTF", 4);
    put_u32(to, 4, 2);
    put_u32(to, 8, (uint32_t)n);
    put_u32(to, 12, (uint32_t)text_len);
    memcpy(to + 16, "JSON", 4);
    memcpy(to + 20, text, text_len);
    put_u32(to, 20 + text_len, 36);
    memcpy(to + 24 + text_len, "BIN\0", 4);
    memcpy(to + 28 + text_len, v, 36);
    put_u32(to, 64 + text_len, 4);
    memcpy(to + 68 + text_len, "ELSE", 4);
    return n;
}

TEST(chunks_of_glb)
{
    uint8_t glb[2048], bad[2048];
    size_t n = make_glb(glb), json = text_len;
    CHECKF(!parse(glb, n) && scene->n_tris == 1 && vertex_is(2, 0, 1, 0), "%s", last_error);
#define BAD(offset, value, message)                                                                          \
    memcpy(bad, glb, n);                                                                                     \
    put_u32(bad, offset, value);                                                                             \
    EXPECT_FAILURE(parse(bad, n), LC_ERR_PARSE, "s.gltf: error: " message)
    BAD(0, 0x46546c68, "not a glTF file: it begins neither as .glb does nor as JSON");
    BAD(8, (uint32_t)n + 1, "damaged .glb file: it is shorter than its header says");
    BAD(12, 0xfffffff0, "damaged .glb file: the JSON chunk is longer than the file");
    BAD(12, (uint32_t)json - 1, "damaged .glb file: the JSON chunk's length is not a multiple of 4");
    BAD(16, 0x004e4942, "damaged .glb file: the first chunk is not JSON");
    BAD(20 + json, 0xfffffff0, "damaged .glb file: the binary chunk is longer than the file");
    memcpy(bad, glb, n);
    put_u32(bad, 4, 1);
    EXPECT_FAILURE(parse(bad, n), LC_ERR_UNSUPPORTED,
                   "s.gltf: error: glTF version 1 is not read, version 2 is");
    EXPECT_FAILURE(parse(glb, 19), LC_ERR_PARSE, "s.gltf: error: damaged .glb file: the header is cut off");
    for (size_t i = 0; i < n; i++) CHECK(parse(glb, i) != LC_OK && n_errors == 1);
}

static lc_status load_named(const char *name, const char *data, size_t n)
{
    file_write(temp_path(name), data, n);
    scene_begin();
    return lc_format_parse(scene, temp_path(name));
}

TEST(files_are_found_in_the_folder_and_below_only)
{
    static const char json[] = ASSET
        ",'buffers':[{'byteLength':36,'uri':'%s'}],'bufferViews':[{'buffer':0,'byteLength':36}],"
        "'accessors':[{'bufferView':0,'componentType':5126,'count':3,'type':'VEC3'}],"
        "'nodes':[{'mesh':0}],'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}]}";
    static const struct {
        const char *uri, *message;
    } bad[] = {
        { "../x%20y.bin", "'../x%20y.bin' is not the name of a file in the scene's folder or below" },
        { "a/../../x%20y.bin", "is not the name of a file in the scene's folder or below" },
        { "%2e%2e/x%20y.bin", "is not the name of a file in the scene's folder or below" },
        { "/etc/hostname", "is not the name of a file in the scene's folder or below" },
        { "file:x%20y.bin", "is not the name of a file in the scene's folder or below" },
        { "x%00y.bin", "is not the name of a file in the scene's folder or below" },
        { "gone.bin", "gone.bin': No such file or directory" },
        { "data:;base64,AAA", "a data URI: 3 digits of base64 are not made of fours" },
        { "data:;base64,AA-A", "a data URI: no base64 at its digit 2" },
        { "data:,AAAA", "a data URI that is not base64" },
        { "data:;base64,AAAA", "a buffer of 36 bytes has only 3" },
    };
    const float v[9] = { 0, 0, 0, 1, 0, 0, 0, 1, 0 };
    file_write(temp_path("x y.bin"), v, sizeof v);
    text_len = 0;
    put(json, "./a/../x%20y.bin");
    mkdir(temp_path("a"), 0700);
    CHECKF(!load_named("s.gltf", text, text_len) && scene->n_tris == 1, "%s", last_error);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        text_len = 0;
        put(json, bad[i].uri);
        CHECK(load_named("s.gltf", text, text_len) != LC_OK);
        CHECKF(strstr(last_error, bad[i].message) && strstr(last_error, "s.gltf:1:") && n_errors == 1, "%s",
               last_error);
    }
    text_len = 0;
    put(json, "x%20y.bin");
    EXPECT_FAILURE(parse_put(), LC_ERR_PARSE,
                   "s.gltf:1:62: error: 'x%20y.bin': this scene may not open files");
}

/* ---- what is wrong ---- */

TEST(what_is_wrong_is_named_with_its_place)
{
    static const struct {
        const char *json, *message;
    } bad[] = {
        { "{}", "s.gltf:1:1: error: this JSON is not glTF: it has no 'asset'" },
        { "{'asset':{}}", "s.gltf:1:10: error: 'asset' has no 'version'" },
        { "{'asset':1}", "s.gltf:1:10: error: 'asset': expected an object" },
        { ASSET ",'nodes':{}}", "s.gltf:1:36: error: 'nodes': expected an array" },
        { ASSET ",'nodes':[1]}", "s.gltf:1:37: error: expected an object" },
        { ASSET ",'scene':1,'scenes':[{}]}", "s.gltf:1:36: error: 1 is none of 1 scenes" },
        { ASSET ",'nodes':[{'mesh':-1}]}", "s.gltf:1:45: error: -1 is none of 0 meshes" },
        { ASSET ",'nodes':[{'mesh':'a'}]}", "s.gltf:1:45: error: 'mesh': expected a number" },
        { ASSET ",'nodes':[{'children':[1]},{'children':[0]}]}",
          "s.gltf:1:37: error: node 0 is above itself" },
        { ASSET ",'nodes':[{'children':[0]}]}", "s.gltf:1:37: error: node 0 is above itself" },
        { ASSET ",'nodes':[{'children':[2]},{'children':[2]},{}]}",
          "s.gltf:1:67: error: node 2 is the child of node 0 and of node 1" },
        { ASSET ",'nodes':[{}],'scenes':[{'nodes':[0,0]}]}",
          "s.gltf:1:37: error: the scene names a node twice" },
        { ASSET ",'nodes':[{'matrix':[1,2]}]}", "s.gltf:1:47: error: 'matrix': 2 numbers, not 16" },
        { ASSET ",'nodes':[{'matrix':[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]}]}",
          "s.gltf:1:37: error: the matrix of a node is a projection" },
        { ASSET ",'nodes':[{'translation':[0,0,1e31]}]}",
          "s.gltf:1:57: error: 1e+31 is not in -1e+30 .. 1e+30" },
        { ASSET ",'extensionsRequired':['XX_new']}",
          "s.gltf:1:50: error: the file requires the extension 'XX_new', which is not read" },
        { ASSET ",'extensionsRequired':['KHR_draco_mesh_compression']}",
          "s.gltf:1:50: error: the file requires the extension 'KHR_draco_mesh_compression', which is not "
          "read; "
          "decompress the file, for example with 'gltf-pipeline -i IN -o OUT'" },
        { ASSET ",'extensionsRequired':['EXT_meshopt_compression']}",
          "s.gltf:1:50: error: the file requires the extension 'EXT_meshopt_compression', which is not read; "
          "decompress the file, for example with 'gltfpack -i IN -o OUT -noq'" },
        { "{'asset':{'version':'1.0'}}",
          "s.gltf:1:10: error: glTF version '1.0' is not read, version 2.0 is" },
        { ASSET ",'cameras':[{'type':'perspective','perspective':{}}],'nodes':[{'camera':0}]}",
          "s.gltf:1:39: error: a perspective camera without yfov" },
        { ASSET ",'nodes':[{'extensions':{'KHR_lights_punctual':{'light':0}}}]}",
          "s.gltf:1:83: error: 0 is none of 0 lights" },
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        lc_status st = parse_json("%s", bad[i].json);
        CHECKF(st == LC_ERR_PARSE || st == LC_ERR_UNSUPPORTED, "%s", bad[i].json);
        EXPECT_FAILURE(st, st, bad[i].message);
    }
}

TEST(accessors_beyond_their_bytes_are_refused)
{
    static const struct {
        const char *accessor, *view, *message;
    } bad[] = {
        { "'componentType':5126,'count':300,'type':'VEC3'", "", "bytes 0 to 3600 of a buffer view of 36" },
        { "'componentType':5126,'count':4294967295,'type':'VEC3'", "",
          "an accessor's count is out of range" },
        { "'componentType':5126,'count':0,'type':'VEC3'", "", "an accessor's count is out of range" },
        { "'componentType':5126,'count':3,'type':'VEC3','byteOffset':4", "",
          "bytes 4 to 40 of a buffer view of 36" },
        { "'componentType':5126,'count':3,'type':'VEC3','byteOffset':9007199254740991", "",
          "of a buffer view of 36" },
        { "'componentType':5126,'count':3,'type':'VEC3','byteOffset':1.5", "", "expected an integer" },
        { "'componentType':5130,'count':3,'type':'VEC3'", "", "an accessor of no known componentType" },
        { "'componentType':5126,'count':3,'type':'MAT4'", "",
          "an accessor of no type SCALAR, VEC2, VEC3 or VEC4" },
        { "'componentType':5126,'count':3,'type':'VEC2'", "", "2 components, not 3" },
        { "'componentType':5126,'count':3,'type':'VEC3'", ",'byteStride':4",
          "elements of 12 bytes, 4 bytes apart" },
        { "'componentType':5126,'count':3,'type':'VEC3'", ",'byteOffset':1",
          "bytes 1 to 37 of a buffer of 36" },
        { "'componentType':5126,'count':3,'type':'VEC3','sparse':{'count':4}", "", "4 sparse elements of 3" },
        { "'componentType':5126,'count':3,'type':'VEC3','sparse':{'count':1,'indices':{'bufferView':0,'"
          "componentType':5126}}",
          "", "sparse indices of no known componentType" },
        { "'componentType':5126,'count':3,'type':'VEC3','sparse':{'count':1,'indices':{'bufferView':0,'"
          "componentType':5125},"
          "'values':{'bufferView':0}}",
          "", "sparse element 4294967295 of 3" },
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        CHECK(parse_json(ASSET
                         ",'nodes':[{'mesh':0}],'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}],"
                         "'buffers':[{'byteLength':36,'uri':'data:;base64,/////"
                         "wAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA'}],"
                         "'bufferViews':[{'buffer':0,'byteLength':36%s}],'accessors':[{'bufferView':0,%s}]}",
                         bad[i].view, bad[i].accessor) == LC_ERR_PARSE);
        CHECKF(strstr(last_error, bad[i].message) && n_errors == 1, "%s", last_error);
    }
    CHECK(
        parse_quad(
            ",'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':0}]}],'nodes':[{'mesh':0}]") ==
        LC_ERR_PARSE);
    CHECK(strstr(last_error, "indices are not unsigned integers"));
    CHECK(parse_quad(",'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':3,'extensions':{'KHR_"
                     "draco_mesh_compression':{}}}]}],"
                     "'nodes':[{'mesh':0}]") == LC_OK);
    CHECK(parse_json(ASSET
                     ",'nodes':[{'mesh':0}],'accessors':[{'componentType':5126,'count':3,'type':'VEC3'}],'"
                     "meshes':[{'primitives':"
                     "[{'attributes':{'POSITION':0},'extensions':{'KHR_draco_mesh_compression':{}}}]}]}") ==
          LC_ERR_UNSUPPORTED);
    CHECK(strstr(last_error, "KHR_draco_mesh_compression is not read; decompress the file"));
    CHECK(
        parse_json(ASSET
                   ",'nodes':[{'mesh':0}],'accessors':[{'componentType':5126,'count':1000000,'type':'VEC3'}],"
                   "'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}]}") == LC_ERR_PARSE);
    CHECK(strstr(last_error, "more zeros than the file has bytes"));
    CHECK(parse_json(
              ASSET
              ",'nodes':[{'mesh':0}],'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1}]}],"
              "'buffers':[{'byteLength':40,'uri':'data:;base64,"
              "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAADAA=='}]," /* 36 zeros; 0 0 3 0 */
              "'bufferViews':[{'buffer':0,'byteLength':36},{'buffer':0,'byteOffset':36,'byteLength':4}],"
              "'accessors':[{'bufferView':0,'componentType':5126,'count':3,'type':'VEC3'},"
              "{'bufferView':1,'componentType':5121,'count':3,'type':'SCALAR'}]}") == LC_ERR_PARSE);
    CHECKF(strstr(last_error, "index 2 is 3, not one of 3 vertices"), "%s", last_error);
}

TEST(chains_of_nodes_are_no_recursion)
{
    char *json = malloc(4000000);
    size_t n = (size_t)sprintf(json, "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[");
    for (int i = 1; i < 100000; i++) n += (size_t)sprintf(json + n, "{\"children\":[%d]},", i);
    n += (size_t)sprintf(json + n, "{}]}");
    CHECK(!parse(json, n));
    free(json);
}

TEST(a_rotation_of_zero_is_none_and_a_byte_order_mark_is_noted)
{
    CHECK(!parse_quad(QUAD_MESH ",'materials':[{}],'nodes':[{'mesh':0,'rotation':[0,0,0,0]}]") &&
          note("rotation") && vertex_is(2, 2, 1, 0));
    CHECK(!parse("\xef\xbb\xbf{\"asset\":{\"version\":\"2.0\"}}", 30) && note("byte order mark"));
    CHECK(!parse_json(
        ASSET ",'extensionsUsed':['XX_other','KHR_lights_punctual'],'animations':[{}],'skins':[{}]}"));
    CHECK(note("extension XX_other") && note("animations") && note("skins") &&
          !note("extension KHR_lights_punctual"));
}

TEST(other_formats_are_named)
{
    static const struct {
        const char *name, *head, *what;
    } files[] = {
        { "a.usda", "#usda 1.0\n", "a USD file" },
        { "a.usdc", "PXR-USDC\1\2", "a USD file" },
        { "a.usdz", "PK\3\4....", "a USD file" },
        { "a.zip", "PK\3\4....", "a ZIP archive" },
        { "a.fbx", "Kaydara FBX Binary  ", "an FBX file" },
        { "a.blend", "BLENDER-v300", "a Blender file" },
        { "a.dae", "<?xml version=\"1.0\"?>\n<COLLADA>", "a COLLADA file" },
        { "a.xml", "\xef\xbb\xbf<scene version=\"0.6.0\">", "a Mitsuba file" },
        { "a.stl", "solid cube\nfacet", "an STL file" },
        { "b.stl", "binary STL", "an STL file" },
        { "a.3ds", "MM\1\2\3\4\5\6\7", "a 3DS file" },
        { "a.abc", "Ogawa\xff", "an Alembic file" },
        { "a.wrl", "#VRML V2.0", "a VRML file" },
        { "a.png", "\x89PNG\r\n\x1a\n", "a picture" },
        { "a.ifc", "ISO-10303-21;\n", "an IFC file" },
        { "a.step", "ISO-10303-21;\n", "a STEP file" },
        { "old.blend", "\x1f\x8b\x08", "a Blender file" },
        { "any.name", "3D Geometry File Format ", "a Rhino file" },
        { "a.pov", "camera {}", "a POV-Ray file" },
        { "a.svg", "<svg xmlns=\"x\">", "a picture" },
        { "utf16.pbrt", "\xff\xfeW", "text in UTF-16, not in UTF-8" },
    };
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char message[700];
        lc_status st = load_named(files[i].name, files[i].head, strlen(files[i].head));
        snprintf(message, sizeof message, "%s: error: this is %s; lightcuts reads pbrt, glTF and OBJ",
                 temp_path(files[i].name), files[i].what);
        EXPECT_FAILURE(st, LC_ERR_UNSUPPORTED, message);
    }
    CHECK(load_named("a.ies", "Free label line one\nTILT=NONE\n", 30) == LC_ERR_UNSUPPORTED &&
          strstr(last_error, "this is an IES photometric file; lightcuts reads pbrt, glTF and OBJ; "
                             "a scene has it as LightSource \"luminaire\""));
    CHECK(load_named("a.ply", "ply\nformat ascii 1.0\n", 21) == LC_ERR_UNSUPPORTED &&
          strstr(last_error, "this is a PLY file; lightcuts reads pbrt, glTF and OBJ; a scene has it as "
                             "Shape \"plymesh\""));
    CHECK(load_named("any.name", "a\0b", 3) == LC_ERR_UNSUPPORTED &&
          strstr(last_error, "this is not text; "));
    CHECK(load_named("a.pbrt", "a\0b", 3) == LC_ERR_PARSE && strstr(last_error, "a.pbrt:1:"));
    CHECK(!load_named("any.name", "\n {\"asset\":{\"version\":\"2.0\"}}", 29));
    CHECK(!load_named("any.name", "# c\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 36) && scene->n_tris == 1);
    CHECK(load_named("a.glb", "nothing", 7) == LC_ERR_PARSE && strstr(last_error, "not a glTF file"));
    CHECK(load_named("a.pbrt", "WorldEnd", 8) == LC_ERR_PARSE && strstr(last_error, "before WorldBegin"));
}

/* For starve: the parse of a scene of the fuzzer's corpus. */
static lc_status parse_full(lc_context *other)
{
    lc_scene *s;
    lc_status st = lc_scene_create(other, &s);
    if (!st) st = lc_gltf_parse(s, "fuzz/corpus/gltf/full.gltf");
    lc_scene_destroy(s);
    return st;
}

TEST(memory_may_end_anywhere) { starve(parse_full, 60); }

int main(void)
{
    temp_begin();
    ctx = quiet_context(0);
    RUN(nodes_move_their_meshes_and_what_is_below_them);
    RUN(triangles_strips_and_fans);
    RUN(sparse_and_normalized_accessors);
    RUN(large_meshes_of_several_nodes_are_shared);
    RUN(materials_are_lambert_and_ggx);
    RUN(textures_are_images_times_factors);
    RUN(lights_are_of_candela_and_lux_along_minus_z);
    RUN(spots_fall_off_by_the_formula_of_the_extension);
    RUN(a_ramp_never_brightens);
    RUN(cameras_look_along_minus_z_and_set_the_height);
    RUN(the_same_scene_in_both_formats_gives_the_same_picture);
    RUN(chunks_of_glb);
    RUN(files_are_found_in_the_folder_and_below_only);
    RUN(what_is_wrong_is_named_with_its_place);
    RUN(accessors_beyond_their_bytes_are_refused);
    RUN(chains_of_nodes_are_no_recursion);
    RUN(a_rotation_of_zero_is_none_and_a_byte_order_mark_is_noted);
    RUN(other_formats_are_named);
    RUN(memory_may_end_anywhere);
    one_scene_end();
    temp_end();
    return test_done();
}
