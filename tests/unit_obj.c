/* unit_obj.c - Wavefront OBJ and MTL: faces, indices, materials, images; what is wrong is named with its
 * place. */
#include "obj/obj.h"
#include "obj/state.h"
#include "support/jpeg_file.h"
#include "support/near.h"
#include "support/one_scene.h"
#include "support/pictures.h"
#include "support/watched_memory.h"

static lc_status parse_obj(const char *obj)
{
    size_t n = strlen(obj);
    char *copy = malloc(n ? n : 1);
    memcpy(copy, obj, n);
    scene_begin();
    lc_status st = lc_obj_parse_memory(scene, "s.obj", copy, n);
    free(copy);
    return st;
}

/* The files s.obj and s.mtl in the test's folder. */
static lc_status parse_both(const char *obj, const char *mtl)
{
    file_text(temp_path("s.mtl"), mtl);
    file_text(temp_path("s.obj"), obj);
    scene_begin();
    return lc_obj_parse(scene, temp_path("s.obj"));
}

#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

static bool triangles_are(const uint32_t *want, size_t n)
{
    if (scene->n_tris != n) return false;
    for (size_t i = 0; i < 3 * n; i++) { /* vertices by their place, as they are numbered anew */
        const float *p = scene->pos + 3 * (size_t)scene->index[i];
        static const float square[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
        if (memcmp(p, square[want[i]], sizeof square[0])) return false;
    }
    return true;
}

TEST(faces_by_positive_and_negative_indices)
{
    static const uint32_t two[] = { 0, 1, 2, 0, 2, 3 }, one[] = { 1, 2, 3 };
    CHECK(!parse_obj(SQUARE "f 1 2 3 4\n") && triangles_are(two, 2) && scene->n_verts == 4);
    CHECK(!parse_obj(SQUARE "f -4 -3 -2 -1") && triangles_are(two, 2));
    CHECK(!parse_obj("  " SQUARE "\n\r\n# f 1 2 3\n\tf 2 \\\n 3 \\\r\n4 # c\r\n") && triangles_are(one, 1));
    CHECK(!parse_obj(SQUARE "g a\nf 1 2 3\ns off\no b\nf 1 3 4\n") && triangles_are(two, 2) &&
          scene->n_meshes == 1);
    CHECK(!parse_obj(SQUARE "f 1 2\nl 1 2\nf 2 3 4") && triangles_are(one, 1) && note("face") &&
          note("curves"));
    CHECK(note("no lights") && scene->has_camera && scene->film.width == 800);
}

TEST(corners_with_normals_and_coordinates)
{
    CHECK(!parse_obj(SQUARE "vt 0.25 0.5\nvt 1\nvn 0 0 2\nf 1/1/1 2/2/1 3//1\nf 1/1/1 3//1 4/2\n"));
    CHECK(scene->n_tris == 2 && scene->n_verts == 4 && scene->meshes[0].has_normals);
    CHECK(scene->normal[2] == 2 && scene->index[0] == scene->index[3]);
    CHECK(!parse_obj(SQUARE "vn 0 0 1\nf 1//1 2//1 3//1\nf 1 3//1 4//1\n") && scene->n_verts == 5);
}

TEST(polygons_are_filled_from_a_corner_that_sees_all_of_them)
{
    double area = 0;
    /* an arrow whose notch is corner 3 */
    CHECK(!parse_obj("v 0 0 0\nv 2 0 0\nv .5 .5 0\nv 0 2 0\nf 1 2 3 4\nf 4 1 2 3\nf 2 3 4 1\n") &&
          !note("polygon"));
    CHECK(scene->n_tris == 6);
    for (size_t i = 0; i < scene->n_tris; i++) {
        const float *a = scene->pos + 3 * (size_t)scene->index[3 * i],
                    *b = scene->pos + 3 * (size_t)scene->index[3 * i + 1],
                    *c = scene->pos + 3 * (size_t)scene->index[3 * i + 2];
        area += fabs((double)((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))) / 2;
    }
    CHECKF(near_abs(area, 3, 1e-6), "%g", area);
    CHECK(
        !parse_obj(
            "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 3 4 0\nv 3 1 0\nv 1 1 0\nv 1 4 0\nv 0 4 0\nf 1 2 3 4 5 6 7 8\n") &&
        note("polygon"));
}

/* A polygon that winds round its middle twice is covered from no corner, which shows only half-way round each
 * of them: the triangles that are looked at are limited. */
TEST(work_for_polygons_is_limited)
{
    enum { N = 999 };
    static float pos[3 * N];
    static uint32_t corners[N][3];
    for (uint32_t i = 0; i < N; i++) {
        pos[3 * i] = (float)cos(4 * LC_PI * i / N);
        pos[3 * i + 1] = (float)sin(4 * LC_PI * i / N);
        corners[i][0] = i;
    }
    const uint64_t many = (uint64_t)1 << 40;
    uint64_t left = many;
    CHECK(lc_obj_fan_from(pos, corners, N, &left) == N);
    CHECKF(many - left > N * N / 4, "%llu looked at", (unsigned long long)(many - left));
    left = 64 * N;
    CHECK(lc_obj_fan_from(pos, corners, N, &left) == N && left == 0);
    left = 0; /* the first corner is looked at all the same */
    CHECK(lc_obj_fan_from(pos, corners, N, &left) == N);
    CHECK(lc_obj_fan_from(pos, corners, N / 2, &left) == 0 && left == 0);
}

TEST(materials_of_mtl)
{
    CHECK(!parse_both("mtllib s.mtl\n" SQUARE
                      "f 1 2 3\nusemtl two words\nf 1 2 3\nusemtl lamp\nf 1 2 3\nusemtl none\nf 1 2 3\n",
                      "newmtl two words\nKd .5 .25 0\nKs .2 .9 1\nNs 20\nd .5\nillum 2\nKa 1 1 1\n"
                      "newmtl lamp\nKe 3 2 1\nKd 1\nillum 1\nKs 1 1 1\nTr 0.25\nbump x\n"));
    CHECK(scene->n_meshes == 4 && note("unknown material") && note("MTL statement"));
    const lc_material *m = &scene->materials[scene->meshes[1].material_id];
    CHECK(m->lobe == LC_LOBE_PHONG && m->kd.x == 0.5f && m->ks.x == 0.2f && m->ks.y == 0.75f &&
          m->exponent == 20);
    CHECK(scene->n_alphas == 2 && scene->alphas[0].alpha.value[0] == 0.5 &&
          scene->alphas[1].alpha.value[0] == 0.75);
    CHECK(scene->meshes[2].emission.x == 3 && scene->meshes[2].emission.z == 1 &&
          !scene->meshes[2].two_sided);
    m = &scene->materials[scene->meshes[2].material_id];
    CHECK(m->kd.y == 1 && !(m->ks.x > 0));
    CHECK(scene->materials[scene->meshes[0].material_id].kd.x == 0.5f &&
          scene->meshes[3].material_id == scene->meshes[0].material_id);
    CHECK(!parse_both("mtllib gone.mtl\n" SQUARE "f 1 2 3\n", "") && note("mtllib") && scene->n_tris == 1);
}

/* Of many materials the last one of a name counts, and a name of none is the default one. */
TEST(materials_are_found_by_name)
{
    static char obj[40000], mtl[40000];
    size_t n = (size_t)snprintf(obj, sizeof obj, "mtllib s.mtl\n" SQUARE), m = 0;
    for (int i = 0; i < 600; i++)
        m += (size_t)snprintf(mtl + m, sizeof mtl - m, "newmtl name%d\nKd %g 0 0\n", i % 400,
                              (i + 1) / 1000.);
    for (int i = 0; i < 401; i += 25)
        n += (size_t)snprintf(obj + n, sizeof obj - n, "usemtl name%d\nf 1 2 3\n", i);
    CHECK(!parse_both(obj, mtl) && scene->n_meshes == 17);
    for (uint32_t i = 0; i < 16; i++) {
        const double last = (i * 25 < 200 ? i * 25 + 401 : i * 25 + 1) / 1000.;
        CHECK(near_abs((double)scene->materials[scene->meshes[i].material_id].kd.x, last, 1e-6));
    }
    CHECK(note("unknown material"));
    CHECK(near_abs((double)scene->materials[scene->meshes[16].material_id].kd.x, 0.5, 1e-6));
}

/* However often and under whatever names a library and an image are asked for, they are read once. */
TEST(libraries_and_images_are_read_once)
{
    static char obj[20000], mtl[40000];
    static jpeg_plan plan = { .width = 8, .height = 8, .n_parts = 1, .h = { 1 }, .v = { 1 } };
    static jpeg_file file;
    size_t n = 0, m = 0;
    for (int i = 0; i < 64; i++) plan.quant[i] = 8;
    jpeg_write(&file, &plan);
    file_write(temp_path("once.jpg"), file.data, file.n);
    for (int i = 0; i < 300; i++)
        m += (size_t)snprintf(mtl + m, sizeof mtl - m, "newmtl m%d\nmap_Kd %s%s\n", i, i % 3 ? "./" : "",
                              i % 2 ? "./once.jpg" : "once.jpg");
    for (int i = 0; i < 400; i++)
        n += (size_t)snprintf(obj + n, sizeof obj - n, "mtllib %ss.mtl\nusemtl m%d\n", i % 2 ? "./" : "",
                              i % 300);
    snprintf(obj + n, sizeof obj - n, SQUARE "f 1 2 3\n");
    CHECK(!parse_both(obj, mtl));
    CHECKF(scene->n_materials == 301 && scene->textures.n_images == 1, "%zu materials, %zu images",
           scene->n_materials, scene->textures.n_images);
}

TEST(more_libraries_than_there_are_in_use)
{
    static char obj[40000];
    size_t n = 0;
    for (int i = 0; i < 1001; i++) {
        char name[32];
        snprintf(name, sizeof name, "lib%d.mtl", i);
        file_text(temp_path(name), "");
        n += (size_t)snprintf(obj + n, sizeof obj - n, "mtllib lib%d.mtl\n", i);
    }
    snprintf(obj + n, sizeof obj - n, SQUARE "f 1 2 3\n");
    CHECK(parse_both(obj, "") == LC_ERR_UNSUPPORTED && strstr(last_error, "s.obj:1001:8: ") &&
          strstr(last_error, "1000 libraries"));
}

TEST(images_of_maps)
{
    static jpeg_plan plan = { .width = 8, .height = 8, .n_parts = 1, .h = { 1 }, .v = { 1 } };
    static jpeg_file file;
    double linear = pow((188 / 255. + 0.055) / 1.055, 2.4), kd[3];
    for (int i = 0; i < 64; i++) plan.quant[i] = 8;
    plan.coefs[0][0][0] = 60;
    jpeg_write(&file, &plan);
    mkdir(temp_path("tex"), 0700);
    file_write(temp_path("tex/a b.jpg"), file.data, file.n);
    CHECK(!parse_both("mtllib s.mtl\n" SQUARE
                      "vt 0 0\nvt 1 0\nvt 1 1\nusemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 2/2 3/3\n",
                      "newmtl a\nKd 0.5 1 1\nmap_Kd -s 2 2 2 -clamp on tex\\a b.jpg\nnewmtl b\nmap_Ke tex/a "
                      "b.jpg\nmap_Kd gone.png\n"));
    CHECK(note("map options") && note("texture image") && scene->textures.n_images == 1 &&
          scene->n_emission_maps == 1);
    const lc_tex_point p = { .uv = { 0.5, 0.5 } };
    lc_texture_eval(&scene->textures, scene->maps[scene->meshes[0].material_id].kd, &p, kd);
    CHECK(near_abs(kd[0], linear / 2, 1e-6) && near_abs(kd[1], linear, 1e-6));
    CHECK(scene->meshes[1].emission_map == 1 && scene->meshes[1].emission.x == 1 && scene->uv[3] == 0 &&
          scene->uv[5] == 1);
}

TEST(what_is_wrong_is_named_with_its_place)
{
    static const struct {
        const char *obj, *message;
    } bad[] = {
        { "v 1 2\n", "s.obj:1:6: error: 2 numbers, at least 3 are needed" },
        { "v 1 2 x\n", "s.obj:1:7: error: expected a number, found 'x'" },
        { "v 1 2 nan\n", "s.obj:1:7: error: expected a number, found 'nan'" },
        { "v 1 2 1e39\n", "s.obj:1:7: error: expected a number, found '1e39'" },
        { SQUARE "f 1 2 5", "s.obj:5:7: error: '5' names one of 4 that are there" },
        { SQUARE "f 1 2 0", "s.obj:5:7: error: '0' names one of 4 that are there" },
        { SQUARE "f 1 2 -5", "s.obj:5:7: error: '-5' names one of 4 that are there" },
        { SQUARE "f 1 2 99999999999999999999999",
          "s.obj:5:7: error: '99999999999999999999999' names one of 4 that are there" },
        { SQUARE "f 1 2 3/1", "s.obj:5:7: error: '3/1' names one of 0 that are there" },
        { SQUARE "f 1 2 3x", "s.obj:5:7: error: '3x' is no corner of a face" },
        { SQUARE "f 1 2 /3", "s.obj:5:7: error: '/3' names one of 0 that are there" },
        { SQUARE "f 1 2 -", "s.obj:5:7: error: '-' names one of 4 that are there" },
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        EXPECT_FAILURE(parse_obj(bad[i].obj), LC_ERR_PARSE, bad[i].message);
    CHECK(!parse_obj(SQUARE "f 1/ 2/ 3/\n") && scene->n_tris == 1); /* as some programs write */
    static char many[4096];
    size_t n = 0;
    for (int i = 0; i < 102; i++) n += (size_t)sprintf(many + n, "what %d\n", i);
    EXPECT_FAILURE(parse_obj(many), LC_ERR_PARSE, "s.obj:101:1: error: more than 100 unknown statements");
    CHECK(parse_both("mtllib s.mtl\n" SQUARE "f 1 2 3\n", "newmtl a\nKd 1 y\n") == LC_ERR_PARSE);
    CHECKF(strstr(last_error, "s.mtl:2:6: error: expected a number, found 'y'"), "%s", last_error);
}

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

/* The camera that is set sees what is there: the middle is lit by the lamp above, the corners are empty. */
TEST(the_camera_that_is_set_sees_the_scene)
{
    file_text(temp_path("s.mtl"), "newmtl lamp\nKe 5 5 5\nnewmtl grey\nKd .5 .5 .5\n");
    file_text(temp_path("s.obj"),
              "mtllib s.mtl\nv -1 0 -1\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 2 -1\nv -1 2 1\nv 1 2 1\nv 1 2 -1\n"
              "usemtl grey\nf 1 2 3 4\nusemtl lamp\nf 8 7 6 5\n");
    lc_image *image = picture(temp_path("s.obj"));
    double middle = pixel_at(image, "R", 400, 300), corner = pixel_at(image, "R", 0, 0);
    CHECKF(middle > 0.1 && middle < 2 && !(corner > 0), "%g %g", middle, corner);
    lc_image_destroy(image);
}

static lc_status parse_in(lc_context *other)
{
    lc_scene *s;
    lc_status st = lc_scene_create(other, &s);
    if (!st) st = lc_obj_parse(s, temp_path("s.obj"));
    lc_scene_destroy(s);
    return st;
}

TEST(memory_may_end_anywhere) { starve(parse_in, 15); }

int main(void)
{
    temp_begin();
    ctx = quiet_context(0);
    RUN(faces_by_positive_and_negative_indices);
    RUN(corners_with_normals_and_coordinates);
    RUN(polygons_are_filled_from_a_corner_that_sees_all_of_them);
    RUN(work_for_polygons_is_limited);
    RUN(materials_of_mtl);
    RUN(materials_are_found_by_name);
    RUN(libraries_and_images_are_read_once);
    RUN(more_libraries_than_there_are_in_use);
    RUN(images_of_maps);
    RUN(what_is_wrong_is_named_with_its_place);
    RUN(the_camera_that_is_set_sees_the_scene);
    RUN(memory_may_end_anywhere);
    one_scene_end();
    temp_end();
    return test_done();
}
